"""A photon transfer of a virtual camera, written as a folder of frames."""

import importlib
import io
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._files import whole_folder
from chromanoise._shapes import UInt16
from chromanoise.characterization.virtual_camera import PlaneTruth, VirtualCamera, whole
from chromanoise.errors import InputError

FRAME_FORMATS = ("npy", "tiff", "pgm", "fits")
"""File formats of `photon_transfer_frames`."""

_MOST_LEVELS, _MOST_FRAMES = 200, 100


@dataclass(frozen=True, slots=True, kw_only=True)
class _Level:
    """Exposure of one level, and the numbers of its frames by file name."""

    time_ms: float
    photons_per_pixel: float
    flats: Mapping[str, int]
    darks: Mapping[str, int]


def photon_transfer_frames(
    camera: VirtualCamera,
    *,
    folder: Path,
    levels: int = 16,
    frames: int = 2,
    darks: int = 2,
    file_format: str = "npy",
    varied: str = "time",
    longest_time_ms: float = 100.0,
    brightest: float = 1.1,
) -> tuple[Path, ...]:
    """Write flats from dark to saturation with matched darks; return the paths of the frames.

    The levels are evenly spaced. Beside the frames, ``capture.toml`` states mosaic, bits and, for
    each level, its frames, exposure time and photons; ``truth.toml`` holds the camera and the true
    values of each plane (`PlaneTruth`). The folder is written as a whole or not at all; other
    files in it stay.

    Parameters
    ----------
    camera
        The camera.
    folder
        Output folder; files of the same names are replaced.
    levels
        Number of levels, 2 to 200.
    frames, darks
        Flats per level, 2 to 100, and darks per level, 1 to 100.
    file_format
        ``npy``, ``tiff``, ``pgm`` (binary, 16 bits where the codes have more than 8) or ``fits``
        (needs astropy).
    varied
        ``time``: the light is constant and the exposure time grows, as the standard prefers, so
        that dark current and linearity can be measured. ``light``: the time is constant.
    longest_time_ms
        Exposure time of the last level. [ms]
    brightest
        Light of the last level, relative to that at which the mean of the least sensitive channel
        reaches saturation. [1]

    Raises
    ------
    InputError
        If a number is out of range, the format is unknown or its package missing, or the folder
        cannot be written.

    Notes
    -----
    EMVA 1288, release 4.0, section 6: flats and darks of equally spaced exposures.
    """
    _check.one_of("file_format", file_format, FRAME_FORMATS)
    written = _FORMATS[file_format]
    _check.one_of("varied", varied, ("time", "light"))
    _check.within("longest_time_ms", "ms", longest_time_ms, 1e-3, 1e7)
    _check.within("brightest", "1", brightest, 0.01, 10.0)
    whole("levels", levels, 2, _MOST_LEVELS)
    whole("frames", frames, 2, _MOST_FRAMES)
    whole("darks", darks, 1, _MOST_FRAMES)
    truth = camera.planes()
    photons = brightest * max(plane.full_well_e / plane.qe for plane in truth)
    planned = []
    for i in range(1, levels + 1):
        share = i / levels
        first = (i - 1) * (frames + darks)
        planned.append(
            _Level(
                time_ms=longest_time_ms * (share if varied == "time" else 1.0),
                photons_per_pixel=photons * share,
                flats=_names(f"level-{i:02}-flat", frames, first, file_format),
                darks=_names(f"level-{i:02}-dark", darks, first + frames, file_format),
            )
        )
    paths = []
    with whole_folder(folder, "demo-frames") as scratch:
        for name, codes in _drawn(camera, planned):
            (scratch / name).write_bytes(written(codes, camera))
            paths.append(folder / name)
        (scratch / "capture.toml").write_text(_capture_toml(camera, planned), encoding="utf-8")
        (scratch / "truth.toml").write_text(_truth_toml(camera, truth), encoding="utf-8")
    return tuple(paths)


def _drawn(camera: VirtualCamera, planned: list[_Level]) -> Iterator[tuple[str, Array]]:
    """Name and codes of each frame."""
    for level in planned:
        for name, number in level.flats.items():
            light = level.photons_per_pixel
            yield (
                name,
                camera.frame(photons_per_pixel=light, time_ms=level.time_ms, number=number),
            )
        for name, number in level.darks.items():
            yield name, camera.frame(time_ms=level.time_ms, dark=True, number=number)


def _names(stem: str, count: int, first: int, ending: str) -> dict[str, int]:
    return {f"{stem}-{i + 1}.{ending}": first + i for i in range(count)}


# ---- files ----

Codes = UInt16[Array, "h w"]


def _npy(codes: Codes, _: VirtualCamera) -> bytes:
    kept = io.BytesIO()
    np.save(kept, codes)
    return kept.getvalue()


def _tiff(codes: Codes, _: VirtualCamera) -> bytes:
    from tifffile import imwrite

    kept = io.BytesIO()
    imwrite(kept, codes, photometric="minisblack", metadata=None, software="chromanoise")
    return kept.getvalue()


def _pgm(codes: Codes, camera: VirtualCamera) -> bytes:
    """Netpbm's PGM, binary: most significant byte first, 1 byte per code up to 255."""
    rows, columns = codes.shape
    header = f"P5\n{columns} {rows}\n{camera.top_code}\n".encode()
    return header + codes.astype(">u2" if camera.top_code > 255 else "u1").tobytes()


def _fits(codes: Codes, _: VirtualCamera) -> bytes:
    try:
        fits = importlib.import_module("astropy.io.fits")
    except ImportError:
        raise InputError(
            "file_format",
            "fits needs the package astropy",
            remedy=("install it with: pip install 'chromanoise[fits]'", "use another format"),
        ) from None
    kept = io.BytesIO()
    fits.PrimaryHDU(codes).writeto(kept)
    return kept.getvalue()


_FORMATS: Mapping[str, Callable[[Codes, VirtualCamera], bytes]] = {
    "npy": _npy,
    "tiff": _tiff,
    "pgm": _pgm,
    "fits": _fits,
}


def _capture_toml(camera: VirtualCamera, planned: list[_Level]) -> str:
    lines = ["# Frames of a virtual camera; truth.toml has its true values."]
    lines += _pairs({"mosaic": camera.mosaic, "bits": camera.bits})
    for level in planned:
        entry: dict[str, Any] = {"flats": list(level.flats), "darks": list(level.darks)}
        entry |= {"time_ms": level.time_ms, "photons_per_pixel": level.photons_per_pixel}
        lines += ["", "[[levels]]", *_pairs(entry)]
    return "\n".join(lines) + "\n"


def _truth_toml(camera: VirtualCamera, truth: tuple[PlaneTruth, ...]) -> str:
    lines = ["# True values of a virtual camera: its settings, and each plane.", "", "[camera]"]
    lines += _pairs(asdict(camera))
    for plane in truth:
        lines += ["", "[[planes]]", *_pairs(asdict(plane))]
    return "\n".join(lines) + "\n"


def _pairs(values: Mapping[str, Any]) -> list[str]:
    return [f"{name} = {_toml(value)}" for name, value in values.items() if value is not None]


def _toml(value: Any) -> str:
    """A value as TOML, which writes lists and strings as JSON does, and finite numbers too."""
    return json.dumps(value, ensure_ascii=False)
