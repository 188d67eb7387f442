"""Light that a sensor needs: SNR10 in lux, and the noise-based speed of ISO 12232."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from chromanoise.base import Array, Float, InputError, check, dataclass
from chromanoise.color import ColorMatrix
from chromanoise.noise import (
    Exposure,
    NoiseSources,
    after_counting,
    counted_electrons,
    expected_electrons,
    noise_sources,
    saturated,
    signal_limit_e,
)
from chromanoise.sensor import Sensor, VarianceLaw
from chromanoise.spectra import Illuminant, flat_field


@dataclass(frozen=True, kw_only=True)
class NoiseSpeedModel:
    """Weights of luminance and color noise in an edition of ISO 12232.

    Attributes
    ----------
    edition
        Name of the edition, given in results.
    luminance_weights
        Y = w_R R + w_G G + w_B B of linear output RGB.
    red_weight, blue_weight
        Weights of the variances of R - Y and B - Y.
    constant
        S = constant / H. [lx s]
    """

    edition: str
    luminance_weights: tuple[float, float, float]
    red_weight: float
    blue_weight: float
    constant: float = 10.0

    def __post_init__(self) -> None:
        weights = check.non_negative("luminance_weights", "1", self.luminance_weights)
        if abs(weights.sum() - 1.0) > 1e-3:
            total = float(weights.sum())
            raise InputError(
                "luminance_weights",
                "must add up to 1",
                value=total,
                found=f"add up to {total:g}",
                remedy="divide by that",
            )
        check.not_negative("red_weight", "1", self.red_weight)
        check.not_negative("blue_weight", "1", self.blue_weight)
        check.positive("constant", "lx s", self.constant)


ISO_12232_2019 = NoiseSpeedModel(
    edition="ISO 12232:2019",
    luminance_weights=(0.2125, 0.7154, 0.0721),
    red_weight=0.279,
    blue_weight=0.088,
)
"""Noise sigma_D^2 = sigma_Y^2 + 0.279 sigma_(R-Y)^2 + 0.088 sigma_(B-Y)^2, Rec. 709 luminance.

Constants as given in the literature, not checked against the text of the standard.
"""


def light_for_snr(
    signal_e: Float[Array, "*px p"],
    row: Float[Array, " p"],
    *,
    snr: float,
    read_noise_e: float,
    prnu: float = 0.0,
) -> Float[Array, "*px"]:
    """Factor on the light of ``signal_e`` at which a matrix row reaches ``snr``; inf if never. [1]

    Parameters
    ----------
    signal_e
        Electrons per channel for one unit of light, e.g. one lux; unclipped. [e-]
    row
        One row of the color matrix. [color per e-]
    snr
        Amplitude ratio, not dB: 10 for SNR10. [1]
    read_noise_e
        Standard deviation of the reading without light. [e-]
    prnu
        Standard deviation of the sensitivity over the pixels. [1]

    Raises
    ------
    InputError
        If electrons are negative, ``snr`` is not above 0 or lengths differ.

    Notes
    -----
    Mean and variance of the row are E (y.s) and E sum y_i^2 s_i + s_rn^2 sum y_i^2 (eq. 7), so
    E^2 (y.s)^2 - q^2 E sum y_i^2 s_i - q^2 s_rn^2 sum y_i^2 = 0. Both lower coefficients are
    <= 0: one root is positive, and nothing cancels in it. PRNU takes q^2 PRNU^2 sum (y_i s_i)^2
    from the first coefficient; where nothing remains, no light is enough.

    Examples
    --------
    One channel, one electron per lux, no read noise: SNR 10 needs 100 electrons.

    >>> float(light_for_snr(np.array([1.0]), np.array([1.0]), snr=10, read_noise_e=0.0))
    100.0
    """
    per_light = check.non_negative("signal_e", "e-", signal_e)
    weights = check.finite("row of the matrix", "1/e-", row)
    check.same_length("channels", signal_e=per_light.shape[-1], row=weights.size)
    read_e = check.not_negative("read_noise_e", "e-", read_noise_e)
    law = VarianceLaw(
        floor_e2=read_e**2, slope_e=1.0, square=check.not_negative("prnu", "1", prnu) ** 2
    )
    return _light_of(per_light, weights[None], (1.0,), snr=snr, law=law)


def illuminance_for_snr(
    sensor: Sensor,
    illuminant: Illuminant,
    exposure: Exposure,
    matrix: ColorMatrix,
    *,
    snr: float = 10.0,
    coordinate: str = "Y",
    reflectance: float = 0.18,
) -> float | None:
    """Illuminance on a gray scene at which a color coordinate reaches ``snr``: SNRx. [lx]

    ``None`` where no light is enough: a channel saturates at a lower level, or the coordinate has
    no signal.

    Parameters
    ----------
    sensor, illuminant, exposure
        The sensor, its lamp, and its exposure settings.
    matrix
        From raw to color with white balance, the same at every light level; for a matrix that
        depends on the level, as LMMSE, use `illuminance_for_snr_adapted`.
    snr
        Amplitude ratio, not dB; the industry uses 10, and 1 gives the noise-equivalent light.
    coordinate
        A row of ``matrix``; "Y" gives YSNR10.
    reflectance
        Of the gray card.

    Raises
    ------
    InputError
        If ``snr`` or ``reflectance`` is not above 0, or sensor, lamp and matrix do not match.

    Notes
    -----
    SNR10: Alakarhu, "Image sensors and image quality in mobile phones", Proc. International Image
    Sensor Workshop (2007): 18 % gray, after white balance and color matrix. Noise of eq. 7.
    """
    per_lux = _gray_electrons_per_lux(sensor, illuminant, exposure, reflectance)
    level = _level_of_row(per_lux, sensor, exposure, matrix, coordinate, snr)
    return _unless_saturated(level, per_lux, sensor, exposure)


def illuminance_for_snr_adapted(
    sensor: Sensor,
    illuminant: Illuminant,
    exposure: Exposure,
    matrix_at: Callable[[float], ColorMatrix],
    *,
    snr: float = 10.0,
    coordinate: str = "Y",
    reflectance: float = 0.18,
    steps_per_decade: int = 16,
) -> float | None:
    """SNRx of a matrix that depends on the light level. [lx]

    With such a matrix the SNR may rise and fall with the level. The result is the lowest
    illuminance above which ``snr`` is reached at every level up to saturation; ``None`` where the
    level of saturation does not reach it. For one matrix at all levels this equals
    `illuminance_for_snr`.

    Parameters
    ----------
    sensor, illuminant, exposure
        As `illuminance_for_snr`.
    matrix_at
        The matrix for an illuminance on the scene in lux, e.g.
        ``lambda lux: lmmse(sensor, exposure, training, level_lux=lux)``.
    snr, coordinate, reflectance
        As `illuminance_for_snr`.
    steps_per_decade
        Number of levels per decade that are checked, from saturation downwards; a dip of the SNR
        between two of them is missed.

    Raises
    ------
    InputError
        As `illuminance_for_snr`, or if ``steps_per_decade`` is below 1.

    Notes
    -----
    A level is enough where the matrix for this level reaches ``snr`` with no more light
    (`light_for_snr`). The search ends at the shot-noise limit without read noise,
    SNR^2 <= E sum s_i. Bisection to 1e-13; at the returned level ``snr`` is reached.

    Examples
    --------
    With any matrix, a single channel without read noise needs 100 electrons for SNR 10.

    >>> from chromanoise.color import kernel_matrix
    >>> from chromanoise.sensor import Pixel
    >>> from chromanoise.spectra import Grid, equal_energy
    >>> grid = Grid.uniform(400, 700, 10)
    >>> mono = Sensor(name="mono", grid=grid, qe=np.full((grid.n, 1), 0.5), names=("W",),
    ...               pixel=Pixel(pitch_um=3.0, full_well_e=10_000.0, read_noise_e=0.0))
    >>> at = Exposure(time_s=0.01)
    >>> lux = illuminance_for_snr_adapted(mono, equal_energy(grid), at,
    ...                                   lambda lux: kernel_matrix(mono, at))
    >>> gray = flat_field(equal_energy(grid), level_lux=lux, reflectance=0.18)
    >>> expected_electrons(gray, mono, at).round(9)
    array([100.])
    """
    per_lux = _gray_electrons_per_lux(sensor, illuminant, exposure, reflectance)
    check.at_least_one("steps_per_decade", steps_per_decade)

    def enough(lux: float) -> bool:
        return _level_of_row(per_lux, sensor, exposure, matrix_at(lux), coordinate, snr) <= lux

    if not per_lux.max() > 0:
        return None
    brightest = signal_limit_e(sensor, exposure) / float(per_lux.max())
    if not brightest > 0:
        return None
    least = 0.5 * check.positive("snr", "1", snr) ** 2 / float(per_lux.sum())
    return _lowest_kept(enough, least, brightest, step=10.0 ** (1.0 / steps_per_decade))


def noise_speed(
    sensor: Sensor,
    illuminant: Illuminant,
    rgb_matrix: Float[Array, "3 p"],
    *,
    snr: float = 10.0,
    model: NoiseSpeedModel = ISO_12232_2019,
) -> float | None:
    """ISO 12232 noise-based speed, S = 10 lx s / H, with H where gray reaches ``snr``. [1]

    ``None`` where no exposure is enough, as in `illuminance_for_snr`.

    Parameters
    ----------
    sensor
        The sensor; its pixel defines electrons per lx s on the focal plane and the read noise.
    illuminant
        The standard uses daylight (D55) or studio tungsten.
    rgb_matrix
        From raw to linear RGB of Rec. 709. Each row is scaled to the gray, so its scale has no
        effect. Rows of ones for a monochrome sensor.
    snr
        10 for the "first acceptable" picture (S_noise10), 40 for the "first excellent" (S_noise40).
    model
        Edition and weights of the standard.

    Raises
    ------
    InputError
        If ``snr`` is not above 0, or a row of ``rgb_matrix`` does not give gray a positive value.

    Notes
    -----
    ISO 12232:2019, 6.3, formulae (4) and (5). The standard divides by the incremental gain of the
    picture's encoding; on gray R = G = B share its slope, so that linear signals give the same.
    The result is for a single pixel, without demosaicing, and without dark current, because the
    exposure has no time.
    """
    # at f/0.5 the illuminance of focal plane and white scene are equal: 4 f#^2 = 1
    focal_plane = Exposure(time_s=1.0, f_number=0.5)
    per_lxs = _gray_electrons_per_lux(sensor, illuminant, focal_plane, 1.0)
    check.same_length("channels", sensor=per_lxs.size, rgb_matrix=rgb_matrix.shape[1])
    gray = check.finite("rgb_matrix", "1/e-", rgb_matrix) @ per_lxs
    if not (gray > 0).all():
        raise InputError(
            "rgb_matrix",
            "must give gray a value > 0 in R, G and B",
            value=float(gray.min()),
            found=f"{'RGB'[int(gray.argmin())]} is {gray.min():g}",
            remedy=f"check the order of rows and channels ({', '.join(sensor.names)})",
        )
    red, green, blue = rgb_matrix / gray[:, None]
    y = np.asarray(model.luminance_weights) @ np.array([red, green, blue])
    rows, shares = np.stack([y, red - y, blue - y]), (1.0, model.red_weight, model.blue_weight)
    timeless = replace(sensor, pixel=replace(sensor.pixel, dark_current_e_per_s=0.0))
    level = _light(per_lxs, rows, shares, timeless, snr=snr)
    exposure_lxs = _unless_saturated(float(level), per_lxs, sensor)
    return None if exposure_lxs is None else model.constant / exposure_lxs


def _light(
    per_light: Array,
    rows: Float[Array, "k p"],
    shares: tuple[float, ...],
    sensor: Sensor,
    exposure: Exposure | None = None,
    *,
    snr: float,
) -> Array:
    """The positive root of E^2 a - q^2 b E - q^2 c = 0 for the signal of the first of ``rows``.

    Its noise is the sum of the variances of all rows, times ``shares``.
    """
    noise, coupling = noise_sources(sensor, exposure), after_counting(sensor.crosstalk)
    per_light = counted_electrons(per_light, coupling)
    pattern = noise.pattern_e2(per_light) @ (np.asarray(shares) @ rows**2)
    law = noise.law()
    if noise.pattern is not None and noise.pattern.counted:
        pattern = pattern * (1 + law.square)
    if coupling is not None:
        rows, law = _before_coupling(rows, shares, noise, coupling)
    return _light_of(per_light, rows, shares, snr=snr, law=law, pattern_e2=pattern)


def _light_of(
    per_light: Array,
    rows: Float[Array, "k p"],
    shares: tuple[float, ...],
    *,
    snr: float,
    law: VarianceLaw,
    pattern_e2: float | Array = 0.0,
) -> Array:
    signal, weights = rows[0], np.asarray(shares) @ rows**2
    q = check.positive("snr", "1", snr)
    floor = law.floor_e2 * weights.sum()
    seen = per_light @ signal
    fixed = law.square * (per_light**2 @ weights) + pattern_e2
    gain = seen**2 - q**2 * fixed
    shot = q**2 * (per_light @ weights)
    reached = shot + np.sqrt(shot**2 + 4.0 * np.maximum(gain, 0.0) * q**2 * floor)
    visible = (seen > 0) & (gain > 0)  # a negative color is not a signal
    return np.asarray(np.where(visible, reached / np.where(visible, 2.0 * gain, 1.0), np.inf))


def _before_coupling(
    rows: Float[Array, "k p"],
    shares: tuple[float, ...],
    noise: NoiseSources,
    coupling: Float[Array, "p p"],
) -> tuple[Array, VarianceLaw]:
    """Rows and noise before crosstalk X that follows counting: r (X n) = (r X) n.

    The noise of the readout is not mixed by X: it is scaled to the weights of the rows r X.
    """
    mixed = rows @ coupling
    readout, law = noise.read_out_e2, noise.law()
    of_rows, of_mixed = (np.asarray(shares) @ (each**2).sum(axis=1) for each in (rows, mixed))
    return mixed, replace(law, floor_e2=law.floor_e2 - readout + readout * of_rows / of_mixed)


def _gray_electrons_per_lux(
    sensor: Sensor, illuminant: Illuminant, exposure: Exposure, reflectance: float
) -> Array:
    rho = check.positive("reflectance", "1", reflectance)
    scene = flat_field(illuminant, level_lux=1.0, reflectance=rho)
    return expected_electrons(scene, sensor, exposure)


def _level_of_row(
    per_lux: Array,
    sensor: Sensor,
    exposure: Exposure,
    matrix: ColorMatrix,
    coordinate: str,
    snr: float,
) -> float:
    """Illuminance that a row of one matrix needs, saturation ignored. [lx]"""
    check.same_names("illuminance_for_snr", sensor=sensor.names, matrix=matrix.channels)
    check.among("coordinate", coordinate, matrix.coordinates)
    row = matrix.matrix[matrix.coordinates.index(coordinate)]
    return float(_light(per_lux, row[None], (1.0,), sensor, exposure, snr=snr))


def _lowest_kept(
    enough: Callable[[float], bool], least: float, brightest: float, *, step: float
) -> float | None:
    """The lowest level above which all levels are enough: search downwards, then bisection."""
    low, high = brightest, brightest
    while enough(low):
        low, high = low / step, low
        if low < least:  # no level below can be enough
            break
    if low == brightest:
        return None
    while high / low > 1.0 + 1e-13:
        middle = float(np.sqrt(low * high))
        if not low < middle < high:
            break
        low, high = (low, middle) if enough(middle) else (middle, high)
    return high


def _unless_saturated(
    level: float, per_light: Array, sensor: Sensor, exposure: Exposure | None = None
) -> float | None:
    if not np.isfinite(level) or saturated(level * per_light, sensor, exposure).any():
        return None
    return level
