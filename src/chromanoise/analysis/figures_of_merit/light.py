"""Figures of merit of a sensor in its light: speed, levels, visual noise, color matrix."""

from dataclasses import replace
from functools import partial

import numpy as np

from chromanoise._check import Array
from chromanoise._linalg import congruence
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.color_matrices import MatrixFunction
from chromanoise.analysis.color_space_noise import GRAY
from chromanoise.analysis.figures_of_merit.entries import (
    Merit,
    Viewing,
    merit_or_reason,
    refuse_full,
    white_color,
    white_electrons,
)
from chromanoise.color import LINEAR_SRGB, LUV
from chromanoise.exposure import OperatingPoint
from chromanoise.imaging import FilterBank, bilinear_filters, flat_field_noise, noise_power_spectrum
from chromanoise.metrics import (
    ISO_12232_2019,
    ISO_15739_2017,
    MatrixReport,
    color_sensitivity_bits,
    illuminance_for_snr,
    illuminance_for_snr_adapted,
    matrix_report,
    noise_speed,
    tonal_range_bits,
    visual_noise_from_spectrum,
    visual_noise_of_white,
)
from chromanoise.metrics.visual_noise import pixels_per_degree
from chromanoise.noise import after_counting, counted_electrons, signal_limit_e, with_noise
from chromanoise.sensor import Sensor, code_step_e

_PLANE = 128  # side of the Fourier plane on which visual noise is averaged
_SAME_MATRIX = 1e-9  # two matrices that differ by less are one
_SPEEDS = ((10, "first acceptable"), (40, "first excellent"))


# speed: the least light for an SNR


def speed_merits(analysis: Analysis, maker: MatrixFunction | None) -> tuple[Merit, ...]:
    """SNR10 of the matrix in use, of one that adapts, and the noise-based speeds."""
    card = f"{100 * GRAY:.0f} % gray, this exposure"
    never = f"no light is enough: a channel saturates first, or Y of a gray ({card}) is no signal"
    adapts = maker is not None and _adapts(analysis.point, maker)
    fixed = merit_or_reason(
        "snr10",
        f"SNR10 of Y, {card}, matrix kept",
        "lx",
        "Alakarhu, IISW 2007",
        of=lambda: illuminance_for_snr(
            analysis.sensor,
            analysis.scene.illuminant,
            analysis.exposure,
            analysis.matrix,
            reflectance=GRAY,
        ),
        never=never,
    )
    adapted = merit_or_reason(
        "snr10_adapted",
        f"SNR10 of Y, {card}, matrix adapted",
        "lx",
        "Alakarhu, IISW 2007",
        of=lambda: _adapted_light(analysis.point, maker) if maker and adapts else None,
        never=never if adapts else "this matrix does not adapt to the light; see the one kept",
    )
    return (fixed, adapted, *_noise_speeds(analysis))


def _noise_speeds(analysis: Analysis) -> tuple[Merit, ...]:
    """Per lux second on the focal plane of the lamp of the analysis."""

    def speed(snr: int) -> float | None:
        white = white_color(analysis)
        matrix = analysis.matrix.matrix
        to_rgb = LINEAR_SRGB.jacobian(white, white) @ matrix
        return noise_speed(analysis.sensor, analysis.scene.illuminant, to_rgb, snr=snr)

    return tuple(
        merit_or_reason(
            f"noise_speed_{snr}",
            f"noise-based speed S{snr} ({quality}) in {analysis.scene.illuminant.name}",
            "1",
            ISO_12232_2019.edition,
            of=partial(speed, snr),
            never=f"no exposure is enough: a channel saturates before SNR {snr}",
        )
        for snr, quality in _SPEEDS
    )


def _adapted_light(operating_point: OperatingPoint, maker: MatrixFunction) -> float | None:
    return illuminance_for_snr_adapted(
        operating_point.sensor,
        operating_point.illuminant,
        operating_point.exposure,
        lambda lux: maker(replace(operating_point, level_lux=lux)),
        reflectance=GRAY,
    )


def _adapts(operating_point: OperatingPoint, maker: MatrixFunction) -> bool:
    brighter = replace(operating_point, level_lux=2.0 * operating_point.level_lux)
    here, there = maker(operating_point).matrix, maker(brighter).matrix
    return bool(np.abs(there - here).max() > _SAME_MATRIX * np.abs(here).max())


# levels that a pixel distinguishes


def level_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """From black to the white of this exposure, or to the white level if that is lower."""
    sensor, exposure, white_e = analysis.sensor, analysis.exposure, white_electrons(analysis)
    top_e = np.clip(white_e, 0.0, max(signal_limit_e(sensor, exposure), 0.0))
    dark = with_noise(np.zeros_like(white_e), sensor, exposure, kind="temporal", linear=True)
    dark_noise_e, shot = np.sqrt(dark.variance), _shot_noise_per_electron(sensor, white_e)
    step_e = code_step_e(sensor.converter, sensor.pixel)

    def of_channel(i: int) -> float:
        # the levels of a reading are those of the counts that have as much shot noise
        counted_e, noise_e = np.asarray(top_e[i] / shot[i]), float(dark_noise_e[i] / shot[i])
        step = float(step_e / shot[i])
        return float(tonal_range_bits(counted_e, read_noise_e=noise_e, step_e=step))

    ranges = (
        merit_or_reason(
            f"tonal_range_{channel}",
            f"tonal range of {channel}, black to white",
            "bit",
            "DxOMark, per pixel",
            of=partial(of_channel, i),
        )
        for i, channel in enumerate(analysis.sensor.names)
    )
    sensitivity = merit_or_reason(
        "color_sensitivity",
        "color sensitivity, black to white",
        "bit",
        "DxOMark, per pixel",
        of=lambda: _color_sensitivity(sensor, top_e, float(dark_noise_e[0])),
        never="crosstalk after counting correlates the channels",
    )
    return (*ranges, sensitivity)


def _shot_noise_per_electron(sensor: Sensor, white_e: Float[Array, " p"]) -> Float[Array, " p"]:
    """Variance of the light's shot noise over the mean reading; 1 for counts. [e-]"""
    coupling = after_counting(sensor.crosstalk)
    if coupling is None or sensor.crosstalk is None:
        return np.ones_like(white_e)
    shot = sensor.crosstalk.squares @ counted_electrons(white_e, coupling)
    return np.where(white_e > 0, shot / np.where(white_e > 0, white_e, 1.0), 1.0)


def _color_sensitivity(
    sensor: Sensor, top_e: Float[Array, " p"], dark_noise_e: float
) -> float | None:
    """The sum of tonal ranges, which holds for independent channels only."""
    if after_counting(sensor.crosstalk) is not None:
        return None
    step_e = code_step_e(sensor.converter, sensor.pixel)
    return float(color_sensitivity_bits(top_e, read_noise_e=dark_noise_e, step_e=step_e))


# visual noise of a gray, from the closed-form noise power spectrum


def visual_merits(analysis: Analysis, viewing: Viewing) -> tuple[Merit, ...]:
    """Visual noise with every channel in each pixel, and through bilinear demosaicing.

    Demosaicing needs pixels with independent noise, without crosstalk after counting.
    """
    card = f"visual noise of {100 * GRAY:.0f} % gray"
    return (
        merit_or_reason(
            "visual_noise",
            f"{card}, all channels in each pixel",
            "CIELUV",
            ISO_15739_2017.edition,
            of=lambda: _pixel_noise(analysis, viewing),
        ),
        merit_or_reason(
            "visual_noise_bilinear",
            f"{card}, bilinear demosaicing",
            "CIELUV",
            ISO_15739_2017.edition,
            of=lambda: _mosaic_noise(analysis, viewing),
            never=f"{analysis.sensor.name} has no mosaic to interpolate",
        ),
    )


def _pixel_noise(analysis: Analysis, viewing: Viewing) -> float:
    to_xyz, to_luv, noise_e2 = _gray_noise(analysis)
    return visual_noise_of_white(
        congruence(to_xyz, noise_e2),
        to_luv,
        pixels_per_degree=viewed_pixels_per_degree(viewing),
        samples=_PLANE,
    ).total


def _mosaic_noise(analysis: Analysis, viewing: Viewing) -> float | None:
    sensor = analysis.sensor
    if sensor.mosaic is None:
        return None
    to_xyz, to_luv, _ = _gray_noise(analysis)
    bank, spectrum = bilinear_filters(sensor.mosaic, sensor.names), _plane_spectrum
    gray_e = GRAY * white_electrons(analysis)
    raw = flat_field_noise(spectrum, bank, gray_e, sensor, analysis.exposure)
    return visual_noise_from_spectrum(
        to_xyz @ raw @ to_xyz.T,
        to_luv,
        pixels_per_degree=viewed_pixels_per_degree(viewing),
    ).total


def _plane_spectrum(bank: FilterBank, variance_e2: Array) -> Float[Array, "h w p p"]:
    return noise_power_spectrum(bank, variance_e2, (_PLANE, _PLANE))


def _gray_noise(
    analysis: Analysis,
) -> tuple[Float[Array, "3 p"], Float[Array, "3 3"], Float[Array, "p p"]]:
    """Of the gray: raw to XYZ over the sensor's white, from there to L*u*v*, raw covariance."""
    refuse_full(analysis)
    white = white_color(analysis)
    noise = with_noise(GRAY * white_electrons(analysis), analysis.sensor, analysis.exposure)
    to_luv = LUV.jacobian(np.full(3, GRAY), np.ones(3))
    return analysis.matrix.matrix / white[:, None], to_luv, noise.covariance


def viewed_pixels_per_degree(viewing: Viewing) -> float:
    """Pixels in one degree of visual angle. [1/deg]"""
    return pixels_per_degree(distance_mm=viewing.distance_mm, pixel_pitch_mm=viewing.pixel_pitch_mm)


# the matrix


def matrix_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """Noise gain and condition of the white-balanced matrix."""

    def report() -> MatrixReport:
        return matrix_report(
            analysis.matrix,
            analysis.sensor,
            analysis.exposure,
            analysis.scene.illuminant,
            level_lux=analysis.scene.level_lux,
        )

    return (
        merit_or_reason(
            "psi", "noise gain Psi", "1", "Kodak, US 5,609,978", of=lambda: report().psi
        ),
        merit_or_reason(
            "condition",
            "condition of the white-balanced matrix",
            "1",
            "singular values",
            of=lambda: report().condition,
            never="the matrix does not have full rank: a coordinate is a mix of others",
        ),
    )
