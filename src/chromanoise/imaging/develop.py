"""Development of raw codes to a color image, and the noise of the result."""

from dataclasses import asdict, replace
from typing import Any

import numpy as np

from chromanoise.base import Array, Float32, InputError, UInt8, UInt16, check, dataclass
from chromanoise.color import ColorMatrix, kernel_matrix
from chromanoise.imaging.blocks import Scratch, release
from chromanoise.imaging.demosaic import FilterBank, demosaicked_rows, surrounded_rows, taps_of
from chromanoise.imaging.demosaic_methods import (
    around_places,
    demosaicked_covariance,
    flat_field_means,
    flat_field_noise,
)
from chromanoise.imaging.kernel_cache import kernel_of
from chromanoise.imaging.plans import srgb_table
from chromanoise.imaging.render import ALL_CORES, Picture, RawPicture, picture_by_rows
from chromanoise.imaging.shared_rows import Work
from chromanoise.noise import (
    Measurement,
    OperatingPoint,
    expected_electrons,
    noise_sources,
    through,
    with_noise,
)
from chromanoise.sensor import Adc, Converter
from chromanoise.spectra import Scene


@dataclass(frozen=True, kw_only=True, eq=False)
class _Development:
    """All data that a block of a mosaic needs for its conversion to color."""

    values: UInt16[Array, "h w"] | Float32[Array, "h w"]
    black: np.float32
    gain_e: np.float32
    bank: FilterBank
    matrices: Float32[Array, "6 p"]


def developed(
    raw: RawPicture,
    bank: FilterBank,
    *,
    matrix: ColorMatrix | None = None,
    electrons: Float32[Array, "h w"] | None = None,
    work: Work = ALL_CORES,
) -> Picture:
    """The color image of raw codes: electrons, then demosaicing, then the color matrix.

    Parameters
    ----------
    bank
        Linear demosaicing, e.g. `bilinear_filters(raw.mosaic, raw.operating_point.sensor.names)`.
    matrix
        Matrix from electrons to XYZ; the kernel (eq. 6, quanta) if ``None``.
    electrons
        Electrons of each pixel, as denoising changes them; those of the codes if ``None``. [e-]
    work
        Threads and rows per block; an executor is not used, because the codes are in memory here.

    Raises
    ------
    InputError
        If the filters are for another mosaic or other channels, the image is smaller than a tile
        of the mosaic, or the matrix gives no luminance for this illuminant.
    """
    operating_point = raw.operating_point
    check.same_names("development", sensor=operating_point.sensor.names, filters=bank.names)
    if bank.mosaic != raw.mosaic:
        raise InputError(
            "filters",
            f"must be made for the mosaic of the picture, {raw.mosaic.pattern}",
            value=bank.mosaic.pattern,
            found=f"are made for {bank.mosaic.pattern}",
        )
    from_codes = electrons is None

    def plan(matrices: Float32[Array, "6 p"]) -> _Development:
        return _Development(
            values=raw.codes if electrons is None else electrons,
            black=np.float32(raw.adc.black_level_dn if from_codes else 0.0),
            gain_e=np.float32(raw.adc.gain_e_per_dn if from_codes else 1.0),
            bank=bank,
            matrices=matrices,
        )

    shape = (raw.codes.shape[0], raw.codes.shape[1])
    picture = picture_by_rows(raw, shape, _developed_block, plan, matrix, work, clipped=True)
    return replace(picture, notes=(*raw.notes, f"demosaicked: {bank.made_by}"))


def _developed_block(
    plan: _Development,
    start: int,
    stop: int,
    scratch: Scratch,
    xyz: Float32[Array, "rows w 3"],
    srgb: UInt8[Array, "rows w 3"],
) -> Any:
    """Fill ``xyz`` and ``srgb`` with the rows ``start`` to ``stop``."""
    values = surrounded_rows(plan.values, plan.bank, start, stop)
    release(plan.values)
    raw_e = (values - plan.black) * plan.gain_e
    electrons = demosaicked_rows(raw_e, taps_of(plan.bank), start)
    color_of_electrons = kernel_of("acquisition", "color_of_electrons", electrons.size)
    color_of_electrons(electrons, plan.matrices, srgb_table(), xyz, srgb)


def developed_color(
    scene: Scene,
    operating_point: OperatingPoint,
    bank: FilterBank,
    adc: Adc,
    *,
    matrix: ColorMatrix | None = None,
) -> tuple[tuple[Measurement, ...], ...]:
    """XYZ of a flat scene after demosaicing, with its covariance: one per place of the tile. [lx]

    Neighbors share raw pixels, so their noise is correlated; `noise_power_spectrum` gives this
    correlation.

    Parameters
    ----------
    scene
        A single point (`flat_field`).
    operating_point, bank, matrix
        As used to develop the image.
    adc
        Converter of the codes, in place of the sensor's own.

    Raises
    ------
    InputError
        If the channels of the filters are not those of the sensor.

    Notes
    -----
    C K D K^T C^T with the diagonal D of `with_noise` and the filters K. The pattern of crosstalk is
    part of the means of the places, not of D. Clipping is neglected. Row noise, which correlates
    neighbors, is treated as independent. Crosstalk after counting is computed from its kernel
    (`flat_field_noise`).
    """
    sensor = replace(operating_point.sensor, converter=Converter(**asdict(adc)))
    check.same_names("development", sensor=sensor.names, filters=bank.names)
    point = operating_point
    matrix = matrix or kernel_matrix(point.sensor, point.exposure, observer=point.observer)
    mean_e = expected_electrons(scene, sensor, operating_point.exposure)
    raw = with_noise(
        mean_e,
        sensor,
        operating_point.exposure,
    )
    covariances = flat_field_noise(
        demosaicked_covariance,
        bank,
        mean_e,
        sensor,
        operating_point.exposure,
    )
    means = around_places(bank, flat_field_means(bank, raw.mean, sensor))
    seen = np.einsum("abcij,abij->abc", bank.kernels, means)
    if noise_sources(sensor, operating_point.exposure).pattern is None:
        seen = np.broadcast_to(raw.mean, seen.shape)  # without rounding
    return tuple(
        tuple(
            through(
                Measurement(
                    mean=mean,
                    covariance=covariance,
                    names=raw.names,
                    kind="demosaicked",
                    unit="e-",
                ),
                matrix.matrix,
                names=matrix.coordinates,
                kind="XYZ",
                unit="lx",
                metric=matrix.metric,
            )
            for mean, covariance in zip(*row, strict=True)
        )
        for row in zip(seen, covariances, strict=True)
    )
