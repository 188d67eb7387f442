"""Denoised pictures of other cameras, and their files."""

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._inputs import true_path
from chromanoise._shapes import Float, Float32, UInt16
from chromanoise.analysis.color_matrices import MatrixMaker
from chromanoise.denoising import (
    CodeNoise,
    DenoisedRaw,
    at_brightness,
    denoised_raw,
)
from chromanoise.errors import InputError, Setting
from chromanoise.exposure import OperatingPoint
from chromanoise.imaging import DEMOSAICING, Work, developed
from chromanoise.imaging.demosaic import channel_tile
from chromanoise.imaging.render import ALL_CORES, Picture, RawPicture
from chromanoise.imaging.row_files import tiff_rows
from chromanoise.imaging.writers import mosaic_description, write_png, write_xyz_tiff
from chromanoise.io.frames import RawFrame
from chromanoise.io.frames.stored import StoredPlane
from chromanoise.sensor import (
    Adc,
    Mosaic,
)
from chromanoise.study.denoising_plan import DenoisingPlan, Electrons
from chromanoise.study.records import refuse_other_record

_FEWEST_SIGMAS = 5.0
_MOST_BELOW = 0.01
_FITTING = (0.8, 1.5)
_TOP_CODE = 2**16 - 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class DenoisedPicture:
    """A raw picture of another camera after denoising.

    Attributes
    ----------
    values_e
        Electrons of each pixel. [e-]
    codes
        The same as codes, rounded; ``None`` of a picture in electrons. [DN]
    picture
        Color; ``None`` without a sensor.
    noise
        Scale and noise of the picture before denoising.
    mosaic
        The channel of each pixel.
    summary
        Inputs, noise, method, clipped shares, residual and notes as plain data.
    plan
        What was denoised.
    """

    values_e: Float32[Array, "h w"]
    codes: UInt16[Array, "h w"] | None
    picture: Picture | None
    noise: CodeNoise
    mosaic: Mosaic
    summary: Mapping[str, Any]
    plan: DenoisingPlan

    def to_dict(self) -> dict[str, Any]:
        """The summary."""
        return dict(self.summary)

    def __repr__(self) -> str:
        height, width = self.values_e.shape
        return (
            f"<DenoisedPicture: {self.plan.stem} {height} x {width} by {self.plan.method.name}, "
            f"noise: {self.noise.source}>"
        )


def denoised_picture(plan: DenoisingPlan, *, work: Work = ALL_CORES) -> DenoisedPicture:
    """A picture of another camera after denoising, and its color if the sensor is known.

    Parameters
    ----------
    plan
        Result of `prepared_denoising`.
    work
        Threads and rows per strip.

    Raises
    ------
    InputError
        If a file cannot be read, its codes contradict the black level, or as `denoised_raw`.

    Notes
    -----
    The result is rounded to codes and clipped at 0 and the top code; saturated pixels keep their
    code. Without an illuminance, that of the operating point is the one at which the mean of the
    ColorChecker is the mean of the picture.
    """
    first, noise, mosaic = plan.pictures[0], plan.noise, plan.mosaic
    codes, clipped = None, {}
    if isinstance(first, RawFrame):
        codes = _codes(first, plan.bits)
        raw_e, clipped = noise.electrons(codes), _clipped(codes, noise)
    else:
        raw_e = first.values_e
    point = plan.operating_point
    if point is not None and not plan.is_bright:
        point = at_brightness(point, mosaic, raw_e, noise)
    others = (
        (
            one.values_e if isinstance(one, Electrons) else noise.electrons(_codes(one, plan.bits)),
            _relative_exposure(first, one),
        )
        for one in plan.pictures[1:]
    )
    done = denoised_raw(
        raw_e, mosaic, noise, plan.method, operating_point=point, others=others, work=work
    )
    del raw_e
    made, outside = (None, 0.0) if codes is None else _rounded(done.values_e, plan)
    notes = [*plan.notes, *_misfit_notes(done, noise)]
    picture = None
    if point is not None and plan.maker is not None:
        try:
            picture = _developed(plan, plan.maker, point, done.values_e, work)
        except InputError as error:
            notes.append(f"no color: {error}")
    summary = plan.record() | {
        "height_px": done.values_e.shape[0],
        "width_px": done.values_e.shape[1],
        "mosaic": [list(row) for row in mosaic.pattern],
        "frames": done.frames,
        "exposures": [_relative_exposure(first, one) for one in plan.pictures],
        **clipped,
        "outside_codes_share": outside,
        "residual": _by_plane(done.names, done.residual),
        "measured_noise": _by_plane(done.names, done.measured),
        "level_lux": None if point is None else point.level_lux,
        "notes": notes,
    }
    return DenoisedPicture(
        values_e=done.values_e,
        codes=made,
        picture=picture,
        noise=noise,
        mosaic=mosaic,
        summary=summary,
        plan=plan,
    )


def _by_plane(names: tuple[str, ...], values: Float[Array, " k"]) -> dict[str, float | None]:
    """A value per plane as plain data; ``None`` where there is none."""
    return {
        name: None if np.isnan(value) else value
        for name, value in zip(names, values.tolist(), strict=True)
    }


def _codes(frame: RawFrame, bits: int | None) -> Array:
    codes = frame.codes()
    most = int(codes.max())
    for code in (int(codes.min()), most):
        if not 0 <= code <= _TOP_CODE:
            raise InputError(
                frame.name,
                f"must hold codes from 0 to {_TOP_CODE}",
                value=code,
                found=f"holds {code}",
            )
    if bits is not None and most >= 2**bits:
        raise InputError(
            "bits",
            f"must hold the codes of {frame.name}",
            value=bits,
            found=f"{bits} bits end at {2**bits - 1}, and the largest code is {most}",
            remedy=Setting("bits", (most.bit_length(),)),
        )
    return codes


def _relative_exposure(first: RawFrame | Electrons, one: RawFrame | Electrons) -> float:
    """Exposure time over that of the first; 1 where a file does not state it."""
    times = [each.time_ms if isinstance(each, RawFrame) else None for each in (first, one)]
    return 1.0 if times[0] is None or times[1] is None else times[1] / times[0]


def _clipped(codes: Array, noise: CodeNoise) -> dict[str, float]:
    """Shares of pixels at code 0, and at and above the white level.

    Raises
    ------
    InputError
        If the black level cannot be right: noise alone puts less than 1e-6 of the pixels further
        than 5 standard deviations below it.
    """
    lowest = noise.black_level_dn - _FEWEST_SIGMAS * float(
        np.sqrt(np.max(noise.law.floor_e2)) / noise.gain_e_per_dn
    )
    at_0 = np.count_nonzero(codes == 0)
    below = np.count_nonzero(codes < lowest) - (at_0 if lowest > 0 else 0)
    if below > _MOST_BELOW * codes.size:
        raise InputError(
            "black_level",
            f"must be such that noise explains the codes below it ({noise.source})",
            value=noise.black_level_dn,
            found=f"{100 * below / codes.size:.3g} % of the pixels lie more than "
            f"{_FEWEST_SIGMAS:g} standard deviations of the dark noise below "
            f"{noise.black_level_dn:g} DN",
            remedy=Setting("black_level"),
        )
    white = noise.saturation_dn
    return {
        "code_0_share": at_0 / codes.size,
        "saturated_share": 0.0 if white is None else np.count_nonzero(codes >= white) / codes.size,
    }


def _rounded(
    values_e: Float32[Array, "h w"], plan: DenoisingPlan
) -> tuple[UInt16[Array, "h w"], float]:
    """Codes of the result, and the share of the pixels that were outside their range."""
    top = _TOP_CODE if plan.bits is None else 2**plan.bits - 1
    exact = np.rint(plan.noise.codes(values_e))
    outside = np.count_nonzero((exact < 0) | (exact > top)) / exact.size
    return np.clip(exact, 0, top).astype(np.uint16), outside


def _misfit_notes(done: DenoisedRaw, noise: CodeNoise) -> list[str]:
    """Warnings where the picture has less or more noise than expected, or none is measured."""
    low, high = _FITTING
    notes = []
    unknown = [done.names[i] for i in np.flatnonzero(np.isnan(done.measured))]
    if unknown:
        notes.append(
            f"the noise of {', '.join(unknown)} was not measured: the picture is too small, or has "
            "too few areas without saturated pixels"
        )
    for flags, text in (
        (
            done.measured < low,
            "which detail cannot explain: check gain, read noise and black level",
        ),
        (
            done.measured > high,
            "which fine detail in all of the picture can explain, or a wrong gain, read noise, "
            "black level, shape, mosaic or byte order",
        ),
    ):
        odd = [f"{done.names[i]} {done.measured[i]:.2f}" for i in np.flatnonzero(flags)]
        if odd:
            notes.append(
                f"where the picture is smoothest, neighboring pixels differ by {', '.join(odd)} "
                f"times what the expected noise gives, {text} ({noise.source})"
            )
    return notes


def _developed(
    plan: DenoisingPlan,
    maker: MatrixMaker,
    point: OperatingPoint,
    values_e: Float32[Array, "h w"],
    work: Work,
) -> Picture:
    mosaic, names = plan.mosaic, point.sensor.names
    bank = DEMOSAICING[plan.study.pictures[0].demosaic or "bilinear"](mosaic, point)
    tile = channel_tile(mosaic, names)
    rows, columns = tile.shape
    places = [divmod(i, columns) for i in range(tile.size)]
    means = np.array([values_e[r::rows, c::columns].mean(dtype=np.float64) for r, c in places])
    raw = RawPicture(
        operating_point=point,
        seed=0,
        frame=0,
        mosaic=mosaic,
        adc=Adc(bits=16, gain_e_per_dn=plan.noise.gain_e_per_dn),
        codes=np.broadcast_to(np.uint16(0), values_e.shape),  # not read: the electrons are given
        mean_e=np.array([means[tile.ravel() == i].mean() for i in range(len(names))]),
        above_full_well=np.zeros(len(names)),
        notes=(f"denoised: {plan.method.name}",),
    )
    return developed(
        raw, bank, matrix=maker(point), electrons=values_e, work=replace(work, executor=None)
    )


_ENDINGS = (".denoised.tiff", ".denoised.dng", ".png", ".xyz.tiff")


def refuse_other_denoised(plan: DenoisingPlan, folder: Path) -> None:
    """Raise an error if a folder holds other results, or outputs would replace a picture.

    Parameters
    ----------
    plan
        Of the picture to be written.
    folder
        Its folder.

    Raises
    ------
    InputError
        If it does.
    """
    inputs = {true_path(one.path) for one in plan.pictures if isinstance(one, RawFrame)}
    for ending in _ENDINGS:
        if true_path(folder / f"{plan.stem}{ending}") in inputs:
            raise InputError(
                "folder",
                "must not hold the picture under the name of a result",
                value=str(folder),
                remedy="name another folder",
            )
    refuse_other_record(folder, plan.record())


def write_denoised(result: DenoisedPicture, folder: Path) -> tuple[list[str], list[str]]:
    """Write the codes as TIFF and DNG, the color as PNG and XYZ.

    Parameters
    ----------
    result
        A denoised picture.
    folder
        Of the files.

    Returns
    -------
    files, not_written
        Names of the files, and notes on a DNG that cannot be written.

    Raises
    ------
    InputError
        If a file cannot be written.

    Notes
    -----
    The DNG is a copy of an uncompressed DNG with the codes replaced: all tags stay, also
    NoiseProfile, which is that of the picture before denoising.
    """
    files, notes, stem = [], [], result.plan.stem
    if result.codes is not None:
        path = folder / f"{stem}.denoised.tiff"
        _write_codes(path, result.codes, result.plan)
        files.append(path.name)
        copied = folder / f"{stem}.denoised.dng"
        first = result.plan.pictures[0]
        if isinstance(first, RawFrame) and first.path.suffix.lower() == ".dng":
            if _write_copy(copied, first, result.codes):
                files.append(copied.name)
            else:
                notes.append("no DNG: its codes are compressed or linearized")
    if result.picture is not None:
        write_png(folder / f"{stem}.png", result.picture.srgb)
        observer = result.picture.matrix.observer
        write_xyz_tiff(folder / f"{stem}.xyz.tiff", result.picture.xyz, observer=observer)
        files += [f"{stem}.png", f"{stem}.xyz.tiff"]
    return files, notes


def _write_codes(path: Path, codes: UInt16[Array, "h w"], plan: DenoisingPlan) -> None:
    point, noise = plan.operating_point, plan.noise
    description = mosaic_description(
        sensor_name=plan.stem if point is None else point.sensor.name,
        bits=plan.bits,
        black_level_dn=noise.black_level_dn,
        gain_e_per_dn=noise.gain_e_per_dn,
        mosaic=plan.mosaic,
    )
    with tiff_rows(
        path,
        shape=codes.shape,
        dtype="uint16",
        photometric="minisblack",
        description=description,
    ) as put:
        put(0, codes)


def _write_copy(path: Path, frame: RawFrame, codes: UInt16[Array, "h w"]) -> bool:
    """Copy an uncompressed DNG with other codes; ``False`` for other files."""
    plane = frame.read
    if not isinstance(plane, StoredPlane) or plane.stored.itemsize != codes.itemsize:
        return False
    shutil.copyfile(frame.path, path)
    with path.open("r+b") as file:
        file.seek(plane.offset)
        file.write(codes.astype(plane.stored).data)
    return True
