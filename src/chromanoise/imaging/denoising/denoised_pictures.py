"""Denoising between capture and color: electrons or raw codes to planes, and back.

Planes are denoised in strips of rows on several threads; the result is bit-identical for any
number.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, Float32, Int, inv
from chromanoise.imaging.blocks import Scratch, new_rows
from chromanoise.imaging.capture import Camera, Capture
from chromanoise.imaging.demosaic import channel_tile
from chromanoise.imaging.demosaic_methods import chart_electrons
from chromanoise.imaging.denoising.electron_planes import (
    DenoisingMethod,
    NoisyPlanes,
    packed,
    unpacked,
)
from chromanoise.imaging.develop import developed
from chromanoise.imaging.render import (
    ALL_CORES,
    RawPicture,
    acquired,
    colored,
    rendered,
    rendered_electrons,
)
from chromanoise.imaging.shared_rows import Work, filled, threads_of
from chromanoise.noise import OperatingPoint, after_counting, noise_sources
from chromanoise.sensor import Mosaic, VarianceLaw
from chromanoise.spectra import Cube

_FEWEST_ROWS = 128


def denoised_planes(
    planes: NoisyPlanes, method: DenoisingMethod, *, work: Work = ALL_CORES
) -> Float32[Array, "h w p"]:
    """The planes after a denoising method. [e-]

    Parameters
    ----------
    planes
        Noisy values and their noise.
    work
        Threads and rows per strip; an executor is not used, because the planes are in memory here.
        The result is bit-identical for any setting.

    Notes
    -----
    A strip is denoised with ``reach_px`` rows on each side, so that its rows have the values of the
    whole picture. Strips begin at multiples of ``grid_px``.
    """
    height, width, count = planes.values_e.shape
    out = new_rows((height, width, count), np.float32)
    if method.reach_px is None:
        blocks = [(0, height)]
    else:
        threads = threads_of(work)
        rows = work.tile_rows or max(_FEWEST_ROWS, 2 * method.reach_px, -(-height // threads))
        rows = -(-rows // method.grid_px) * method.grid_px
        blocks = [(start, min(start + rows, height)) for start in range(0, height, rows)]
    filled(_denoised_strip, (planes, method), blocks, (out,), replace(work, executor=None))
    return out


def _denoised_strip(
    plan: tuple[NoisyPlanes, DenoisingMethod],
    start: int,
    stop: int,
    scratch: Scratch,
    out: Float32[Array, "rows w p"],
) -> Any:
    """Fill ``out`` with the rows ``start`` to ``stop``."""
    planes, method = plan
    if method.reach_px is not None:
        planes = planes.rows(start, stop, reach_px=method.reach_px, grid_px=method.grid_px)
    out[:] = method.denoise(planes)[slice(*(planes.needed or (start, stop)))]


_NEIGHBORS = 0.95
"""Correlation of neighboring pixels, as in `PicturePrior`; its power r at a distance of r."""


def planes_of_electrons(
    values_e: Float32[Array, "h w p"], operating_point: OperatingPoint
) -> NoisyPlanes:
    """The planes of a picture with all channels at every pixel.

    Parameters
    ----------
    values_e
        Noisy electrons. [e-]
    operating_point
        Sensor, exposure and light: they give the noise, and the covariance of the ColorChecker.

    Raises
    ------
    InputError
        If the sensor's grid is not within 400-1050 nm, the range of the chart data.

    Notes
    -----
    With crosstalk X after counting, the values must be those before it, which ``without_coupling``
    gives: X^-1 S. The read noise R is then X^-1 R X^-T, of which the diagonal is used.
    """
    noise = noise_sources(operating_point.sensor, operating_point.exposure)
    coupling = after_counting(operating_point.sensor.crosstalk)
    chart = chart_electrons(operating_point)
    law = noise.law()
    if coupling is not None:
        inverse = inv("crosstalk", coupling)
        chart = chart @ inverse.T
        readout = noise.read_out_e2
        mixed = readout * np.square(inverse).sum(axis=1)
        law = replace(law, floor_e2=law.floor_e2 - readout + mixed)
    return _planes(values_e, chart, law, operating_point.sensor.names)


def planes_of_mosaic(
    raw_e: Float32[Array, "h w"],
    operating_point: OperatingPoint,
    mosaic: Mosaic,
    *,
    step_e: float | None = None,
) -> NoisyPlanes:
    """The planes of a raw picture: one per place of the mosaic's tile.

    Parameters
    ----------
    raw_e
        Noisy electrons, one value per pixel. [e-]
    operating_point
        As `planes_of_electrons`.
    mosaic
        The channel of each pixel.
    step_e
        Electrons per code of the converter; that of the sensor if ``None``. [e-]

    Raises
    ------
    InputError
        As `planes_of_electrons`, or if the mosaic lacks a channel of the sensor.

    Notes
    -----
    Crosstalk after counting correlates neighbors; here their noise counts as independent.
    """
    sensor = operating_point.sensor
    tile = channel_tile(mosaic, sensor.names)
    planes_e, channels = packed(raw_e, tile)
    noise = noise_sources(sensor, operating_point.exposure)
    if step_e is not None:
        noise = replace(noise, step_e=step_e)
    chart = chart_electrons(operating_point)[:, channels]
    planes = _planes(planes_e, chart, noise.law(), mosaic.place_names)
    return replace(planes, prior_e2=planes.prior_e2 * place_correlation(tile))


def place_correlation(tile: Int[Array, "ty tx"]) -> Float[Array, "k k"]:
    """Correlation of the pixels of a tile over typical scenes, due to their distance alone. [1]

    Examples
    --------
    >>> place_correlation(np.array([[0, 1]]))
    array([[1.  , 0.95],
           [0.95, 1.  ]])
    """
    places = np.indices(tile.shape).reshape(2, -1).T
    apart = np.linalg.norm(places[:, None] - places[None], axis=-1)
    return np.asarray(_NEIGHBORS**apart)


def _planes(
    values_e: Float32[Array, "h w p"],
    chart_e: Float[Array, "k p"],
    law: VarianceLaw,
    names: tuple[str, ...],
) -> NoisyPlanes:
    away = chart_e - chart_e.mean(axis=0)
    return NoisyPlanes(
        values_e=values_e,
        law=law,
        prior_e2=away.T @ away / (len(chart_e) - 1),
        prior_mean_e=np.maximum(chart_e.mean(axis=0), 0.0),
        names=names,
    )


def denoised_electrons(
    values_e: Float32[Array, "h w p"],
    operating_point: OperatingPoint,
    method: DenoisingMethod,
    *,
    work: Work = ALL_CORES,
) -> Float32[Array, "h w p"]:
    """Electrons of all channels at every pixel after denoising. [e-]

    Parameters
    ----------
    values_e
        Noisy electrons. [e-]
    operating_point
        As `planes_of_electrons`.
    work
        Threads, and rows per strip.

    Raises
    ------
    InputError
        As `planes_of_electrons`, or if the method does not accept the picture.
    """
    coupling = after_counting(operating_point.sensor.crosstalk)
    if coupling is None:
        return denoised_planes(planes_of_electrons(values_e, operating_point), method, work=work)
    inverse = inv("crosstalk", coupling).astype(np.float32)
    counted = planes_of_electrons(values_e @ inverse.T, operating_point)
    return denoised_planes(counted, method, work=work) @ coupling.T.astype(np.float32)


def denoised_mosaic(
    raw: RawPicture, method: DenoisingMethod, *, work: Work = ALL_CORES
) -> Float32[Array, "h w"]:
    """Electrons of a raw picture after denoising, one value per pixel. [e-]

    Parameters
    ----------
    raw
        Codes, converter and operating point.
    method, work
        As `denoised_electrons`.

    Raises
    ------
    InputError
        As `planes_of_mosaic`, or if the method does not accept the picture.
    """
    adc, point = raw.adc, raw.operating_point
    raw_e = (raw.codes.astype(np.float32) - np.float32(adc.black_level_dn)) * np.float32(
        adc.gain_e_per_dn
    )
    planes = planes_of_mosaic(raw_e, point, raw.mosaic, step_e=adc.gain_e_per_dn)
    clean = denoised_planes(planes, method, work=work)
    return unpacked(clean, raw.mosaic.shape, raw.codes.shape)


def captured_with(
    cube: Cube,
    camera: Camera,
    method: DenoisingMethod | None,
    *,
    frame: int,
    work: Work,
    noisy: bool = True,
) -> Capture:
    """Capture one image; with a method, its electrons are denoised before they become color.

    Parameters
    ----------
    cube
        Reflectances of each pixel.
    camera
        The sensor in use and the settings of the pictures, checked.
    method
        Of `DENOISING`; ``None`` for no denoising.
    frame
        Number of the image in a burst.
    work
        Threads or executor for the computation.
    noisy
        As `rendered`; raw codes always have noise.

    Raises
    ------
    InputError
        As `rendered`, `acquired`, `planes_of_electrons` and the method.
    """
    settings, point = camera.settings, camera.operating_point
    common: dict[str, Any] = {
        "seed": settings.seed,
        "frame": frame,
        "beyond": settings.beyond,
        "bad_pixels": settings.bad_pixels,
        "work": work,
    }
    of_color: dict[str, Any] = {"clip": settings.clip, "noisy": noisy, **common}
    here = replace(work, executor=None)  # what follows the capture is in this memory
    raw = picture = values = None
    if settings.raw:
        raw = acquired(cube, point, mosaic=camera.mosaic, adc=camera.adc, **common)
        if camera.bank is not None:
            if method is None:
                here = Work(threads=work.threads, folder=work.folder)
            else:
                values = denoised_mosaic(raw, method, work=here)
            picture = developed(raw, camera.bank, matrix=camera.matrix, electrons=values, work=here)
    elif method is None:
        picture = rendered(cube, point, matrix=camera.matrix, **of_color)
    else:
        electrons = rendered_electrons(cube, point, **of_color)
        values = denoised_electrons(electrons.values_e, point, method, work=here)
        picture = colored(replace(electrons, values_e=values), matrix=camera.matrix, work=here)
    name = None if method is None else method.name
    if picture is not None and name is not None:
        picture = replace(picture, notes=(*picture.notes, f"denoised: {name}"))
    return Capture(camera=camera, raw=raw, picture=picture, denoised_by=name)
