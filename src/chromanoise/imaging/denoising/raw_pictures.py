"""Denoising of raw pictures of any camera: noise of their codes, planes, and merging of bursts.

The noise comes from a pixel, or from the noise profile of a DNG, and the noise model is checked
against the picture. Frames of one scene are merged by their variance; pixels where something moved
are rejected.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np

from chromanoise.base import (
    Array,
    Bool,
    Float,
    Float32,
    InputError,
    Setting,
    Shaped,
    check,
    dataclass,
)
from chromanoise.imaging.demosaic import channel_tile
from chromanoise.imaging.demosaic_methods import chart_electrons
from chromanoise.imaging.denoising.denoised_pictures import (
    denoised_planes,
    place_correlation,
    planes_of_mosaic,
)
from chromanoise.imaging.denoising.electron_planes import (
    DenoisingMethod,
    NoisyPlanes,
    packed,
    unpacked,
)
from chromanoise.imaging.render import ALL_CORES
from chromanoise.imaging.shared_rows import Work
from chromanoise.noise import NoiseSources, OperatingPoint
from chromanoise.sensor import Mosaic, VarianceLaw, shot_and_dark


@dataclass(frozen=True, kw_only=True, eq=False)
class CodeNoise:
    """Scale and noise of the codes of a raw picture, in electrons.

    Attributes
    ----------
    gain_e_per_dn
        Electrons per code. [e-/DN]
    black_level_dn
        Code without light. [DN]
    saturation_dn
        Lowest saturated code; ``None`` if it is not known. [DN]
    temporal
        Variance that changes from frame to frame, per channel; a law without channels counts for
        all of them.
    spatial
        Variance that is the same in every frame, per channel.
    source
        Where the noise comes from.

    Raises
    ------
    InputError
        If a value is not finite or negative, or the white level is not above black.
    """

    names: tuple[str, ...]
    gain_e_per_dn: float
    black_level_dn: float
    saturation_dn: float | None
    temporal: VarianceLaw
    spatial: VarianceLaw
    source: str

    def __post_init__(self) -> None:
        check.positive("gain_e_per_dn", "e-/DN", self.gain_e_per_dn)
        check.not_negative("black_level", "DN", self.black_level_dn)
        for name in ("temporal", "spatial"):
            object.__setattr__(self, name, getattr(self, name).of_planes(len(self.names)))
        if self.saturation_dn is not None:
            _range_dn(self.black_level_dn, self.saturation_dn)

    @property
    def law(self) -> VarianceLaw:
        """Variance of one reading, per channel."""
        return self.temporal + self.spatial

    def electrons(self, codes: Shaped[Array, "h w"]) -> Float32[Array, "h w"]:
        """Electrons of codes. [e-]

        Parameters
        ----------
        codes
            Codes of the converter. [DN]
        """
        values = codes.astype(np.float32)
        values -= np.float32(self.black_level_dn)
        values *= np.float32(self.gain_e_per_dn)
        return values

    def codes(self, values_e: Float32[Array, "h w"]) -> Float32[Array, "h w"]:
        """Codes of electrons, neither rounded nor clipped. [DN]

        Parameters
        ----------
        values_e
            Electrons. [e-]
        """
        return np.asarray(
            values_e / np.float32(self.gain_e_per_dn) + np.float32(self.black_level_dn)
        )

    def to_dict(self) -> dict[str, Any]:
        """The noise as plain data; S and O only where the white level is known."""
        data: dict[str, Any] = {
            "source": self.source,
            "gain_dn_per_e": 1 / self.gain_e_per_dn,
            "black_level_dn": self.black_level_dn,
            "white_level_dn": self.saturation_dn,
            "prnu": math.sqrt(np.max(self.spatial.square)),
        }
        data["channels"] = {
            name: self._of_channel(self.law.take(i)) for i, name in enumerate(self.names)
        }
        return data

    def _of_channel(self, law: VarianceLaw) -> dict[str, float]:
        floor, slope, _ = law.coefficients.tolist()
        data = {"floor_e2": floor, "slope_e": slope, "noise_without_light_e": floor**0.5}
        if self.saturation_dn is None:
            return data
        range_e = _range_dn(self.black_level_dn, self.saturation_dn) * self.gain_e_per_dn
        shot, dark = shot_and_dark(law.in_units_of(range_e)).tolist()
        return data | {"S": shot, "O": dark}


def code_noise(
    sources: NoiseSources,
    names: Sequence[str],
    *,
    black_level_dn: float,
    saturation_dn: float | None,
    source: str,
) -> CodeNoise:
    """The noise of raw codes, from the noise sources of a pixel.

    Parameters
    ----------
    sources
        Of the pixel; ``step_e`` is the gain of the codes.
    black_level_dn, saturation_dn, source
        As `CodeNoise`.

    Raises
    ------
    InputError
        As `CodeNoise`.

    Examples
    --------
    >>> from chromanoise.sensor import Pixel
    >>> pixel = Pixel(pitch_um=3, full_well_e=9000, read_noise_e=3.0)
    >>> noise = code_noise(NoiseSources(pixel=pixel, step_e=2.0), ("W",), black_level_dn=64,
    ...                    saturation_dn=None, source="an example")
    >>> noise.law.floor_e2.round(3), noise.electrons(np.array([[164]]))
    (array([9.333]), array([[200.]], dtype=float32))
    """
    return CodeNoise(
        names=tuple(names),
        gain_e_per_dn=sources.step_e,
        black_level_dn=float(black_level_dn),
        saturation_dn=saturation_dn,
        temporal=sources.law("temporal"),
        spatial=sources.law("spatial"),
        source=source,
    )


def code_noise_of_profile(
    profile: Mapping[str, tuple[float, float]],
    names: Sequence[str],
    *,
    black_level_dn: float,
    white_level_dn: float,
    source: str,
) -> CodeNoise:
    """The noise of raw codes, from a noise profile: variance = S x + O.

    Parameters
    ----------
    profile
        S and O of each channel, with x = 0 at black and 1 at the white level. [1]
    black_level_dn, white_level_dn
        Codes of x = 0 and x = 1. [DN]
    source
        As `CodeNoise`.

    Raises
    ------
    InputError
        As `CodeNoise`, or if S is not above 0 or O is negative.

    Notes
    -----
    DNG 1.4, tag 51041. With R codes from black to white the variance of a code is S R y + O R^2 at
    y codes above black. Counted electrons have a variance equal to their mean, so S R codes
    are one electron. Where the channels differ in S (codes multiplied after the converter), one
    electron is the mean of their S R, and the slope of their law differs from 1.

    Examples
    --------
    >>> noise = code_noise_of_profile({"W": (0.0025, 0.01)}, ("W",), black_level_dn=55,
    ...                               white_level_dn=255, source="an example")
    >>> noise.gain_e_per_dn, noise.law.floor_e2
    (2.0, array([1600.]))
    """
    pairs = np.array([profile[name] for name in names])
    for name, (shot, dark) in zip(names, pairs.tolist(), strict=True):
        check.positive(f"S of channel {name} of {source}", "1", shot)
        check.not_negative(f"O of channel {name} of {source}", "1", dark)
    range_dn = _range_dn(black_level_dn, white_level_dn)
    gain = 1 / (pairs[:, 0].mean() * range_dn)
    of_range = VarianceLaw(floor_e2=pairs[:, 1], slope_e=pairs[:, 0])
    return CodeNoise(
        names=tuple(names),
        gain_e_per_dn=float(gain),
        black_level_dn=float(black_level_dn),
        saturation_dn=float(white_level_dn),
        temporal=of_range.in_units_of(1 / (range_dn * gain)),
        spatial=VarianceLaw(),
        source=source,
    )


def _range_dn(black_level_dn: float, white_level_dn: float) -> float:
    """Codes from black to white, above 0. [DN]"""
    if not black_level_dn < white_level_dn < math.inf:
        raise InputError(
            "white_level",
            f"must be finite and above the black level {black_level_dn:g} [DN]",
            value=white_level_dn,
            remedy=(Setting("black_level"), Setting("white_level")),
        )
    return white_level_dn - black_level_dn


_ROWS = 64  # tested together, to save memory
_LEAST_E2 = 1e-12  # of planes without read noise, at pixels without light


@dataclass(frozen=True, kw_only=True, eq=False)
class BurstFrame:
    """Another frame of a burst.

    Attributes
    ----------
    values_e
        Its values, in its own electrons. [e-]
    exposure
        Its exposure over that of the first frame: of times, or of times and gains of the light.
        [1]
    """

    values_e: Float32[Array, "h w p"]
    exposure: float = 1.0

    def __post_init__(self) -> None:
        check.positive("exposure of a frame", "1", self.exposure)


@dataclass(frozen=True, kw_only=True, eq=False)
class Burst:
    """Merged frames.

    Attributes
    ----------
    planes
        The merged values, in electrons of the first frame, and their noise where all frames were
        used. Input of any denoising method.
    used
        Share of the weights that was used at each pixel: 1 where all frames agree. 0 where every
        frame is saturated; the values there are those of the first frame.
    """

    planes: NoisyPlanes
    used: Float32[Array, "h w p"]
    frames: int


def merged_frames(
    first: NoisyPlanes,
    others: Iterable[BurstFrame],
    *,
    fixed: VarianceLaw | None = None,
    saturation_e: float | None = None,
    false_alarm: float = 1e-3,
    window_px: int = 3,
) -> Burst:
    """The mean of the frames of a burst, weighted by the inverse of their temporal variance.

    The frames are read in one pass, one in memory at a time: ``others`` may be a generator.

    Parameters
    ----------
    first
        The reference frame and its noise. The result shows the scene as it was in this frame.
    others
        The other frames, with the same pixels; a mosaic as `packed`.
    fixed
        Part of ``first.law`` that is the same in every frame: DSNU^2 and PRNU^2, as
        ``NoiseSources.law("spatial")``; by default only the square.
    saturation_e
        Values of a frame at or above it are not used, in its own electrons. By default there is no
        saturation. [e-]
    false_alarm
        Probability that a frame is rejected at a pixel although nothing moved. [1]
    window_px
        Side of the window, odd, over which the test sums the differences: a larger one detects
        weaker differences, but rejects more of the surroundings. [pixels]

    Raises
    ------
    InputError
        If a frame has another shape or a value that is not finite, the fixed part is larger than
        the law, there is no temporal noise, or a number is out of range.

    Notes
    -----
    Values are divided by the relative exposure t, so their temporal variance at a mean m of the
    first frame is (floor - fixed) / t^2 + slope m / t. The weights are its inverse at
    ``first.prior_mean_e``: weights from the noisy value of a pixel would bias the mean. So the law
    of the result has a closed form. PRNU and DSNU are the same in all frames, so merging does not
    reduce them.

    A frame is tested against the first: the sum over window and planes of the squared difference
    over its variance has a chi-square distribution where nothing moved. It is rejected at a pixel
    above the value of which ``false_alarm`` is the probability. The mean in the variance is that of
    both frames at the pixel; PRNU has no part in a difference. The distribution is that of
    Gaussian noise: at 1 electron and a read noise of 1 electron, 2.8e-3 of the pixels are rejected
    instead of 1e-3 (4 planes, 3 x 3 pixels); at 10 electrons, 1e-3. Where the first frame is
    saturated, no test is possible.

    Weights: Hasinoff, Durand & Freeman, "Noise-optimal capture for high dynamic range photography",
    CVPR (2010).

    Examples
    --------
    >>> one = NoisyPlanes(
    ...     values_e=np.full((3, 3, 1), 98, np.float32), prior_e2=np.eye(1),
    ...     law=VarianceLaw(floor_e2=100.0, slope_e=1.0, square=0.25),
    ...     prior_mean_e=np.array([100.0]), names=("W",))
    >>> both = merged_frames(one, [BurstFrame(values_e=np.full((3, 3, 1), 102, np.float32))])
    >>> both.planes.values_e[0, 0], both.planes.law.coefficients.ravel()
    (array([100.], dtype=float32), array([50.  ,  0.5 ,  0.25]))
    """
    fixed = VarianceLaw(square=first.law.square) if fixed is None else fixed
    fixed = fixed.of_planes(len(first.names))
    if not ((first.law - fixed).variance_e2(first.prior_mean_e) > 0).all():
        raise InputError(
            "temporal noise of the planes",
            "must be above 0 at the mean of typical scenes",
            value=0.0,
            remedy="give a read noise above 0",
        )
    check.within("false_alarm", "1", false_alarm, 1e-12, 0.5)
    if window_px < 1 or window_px % 2 == 0:
        raise InputError("window_px", "must be odd and at least 1 [pixels]", value=window_px)
    sums = _Sums(first, fixed, saturation_e, false_alarm, window_px)
    for number, frame in enumerate(chain([BurstFrame(values_e=first.values_e)], others), start=1):
        if frame.values_e.shape != first.values_e.shape:
            raise InputError(
                f"frame {number} of the burst",
                f"must have the {first.values_e.shape} rows, columns and planes of the first",
                value=frame.values_e.shape,
                found=f"has {frame.values_e.shape}",
            )
        check.finite(f"frame {number} of the burst", "e-", frame.values_e)
        sums.add(frame)
    return sums.burst()


class _Sums:
    """Running sums over the frames of a burst, of the values that are used.

    A value is used if it is not saturated, where its frame agrees with the first one.
    """

    def __init__(
        self,
        first: NoisyPlanes,
        fixed: VarianceLaw,
        saturation_e: float | None,
        false_alarm: float,
        window_px: int,
    ) -> None:
        self._first, self._fixed, self._temporal = first, fixed, first.law - fixed
        self._saturation_e = np.inf if saturation_e is None else saturation_e
        self._limits = _limits(false_alarm, window_px**2 * len(first.names))
        self._window_px = window_px
        self._frames, self._merged = 0, VarianceLaw()
        self._values, self._used = (np.zeros(first.values_e.shape) for _ in range(2))
        # of the weights w at relative exposures t: w, w / t
        self._weights = np.zeros((2, len(first.names)))

    def add(self, frame: BurstFrame) -> None:
        """Add a frame where it is used."""
        law = self._temporal.in_units_of(frame.exposure)
        w = 1.0 / law.variance_e2(self._first.prior_mean_e)
        share = w / frame.exposure
        for start in range(0, len(self._values), _ROWS):
            rows = slice(start, start + _ROWS)
            values = frame.values_e[rows]
            used = self._is_used(frame, start, start + len(values))
            self._values[rows] += np.where(used, values * share, 0.0)
            self._used[rows] += np.where(used, w, 0.0)
        self._weights += (w, share)
        self._merged += law.scaled(w**2)
        self._frames += 1

    def _is_used(self, frame: BurstFrame, start: int, stop: int) -> Bool[Array, "rows w p"]:
        """Whether each value of the rows ``start`` to ``stop`` is used."""
        before = max(start - self._window_px // 2, 0)
        rows = slice(before, stop + self._window_px // 2)
        own, values = self._first.values_e[rows], frame.values_e[rows]
        usable = values < self._saturation_e
        both = usable & (own < self._saturation_e)
        squares = np.where(both, self._squares(own, values, frame.exposure), 0.0)
        found, count = (_window_sums(one, self._window_px) for one in (squares, both))
        agrees = found <= self._limits[count.round().astype(int)]
        return (usable & agrees[..., None])[start - before : stop - before]

    def _squares(
        self, own: Float32[Array, "h w p"], values: Float32[Array, "h w p"], t: float
    ) -> Float[Array, "h w p"]:
        """Squared difference of a frame from the first one, over its variance. [1]"""
        light = np.maximum((own + values) / (1.0 + t), 0.0)
        offsets = VarianceLaw(floor_e2=self._fixed.floor_e2 * (1.0 / t - 1.0) ** 2)
        law = self._temporal.in_units_of(t) + self._temporal + offsets
        return np.asarray((values / t - own) ** 2 / np.maximum(law.variance_e2(light), _LEAST_E2))

    def burst(self) -> Burst:
        """The merged frames."""
        first, (w, share) = self._first, self._weights
        values = np.array(first.values_e)
        np.divide(self._values, self._used, out=values, where=self._used > 0, casting="same_kind")
        self._used /= w
        law = self._merged.scaled(1.0 / w**2) + self._fixed.in_units_of(w / share)
        planes = replace(first, values_e=values, law=law)
        return Burst(planes=planes, used=self._used.astype(np.float32), frames=self._frames)


def _window_sums(values: Shaped[Array, "h w p"], window_px: int) -> Float[Array, "h w"]:
    """Sum over the planes and the pixels of a window; beyond the borders are no pixels."""
    from scipy.ndimage import correlate1d

    ones = np.ones(window_px)
    rows = correlate1d(values.sum(axis=-1, dtype=float), ones, axis=0, mode="constant")
    return np.asarray(correlate1d(rows, ones, axis=1, mode="constant"))


def _limits(false_alarm: float, most: int) -> Float[Array, " n"]:
    """The chi-square of which ``false_alarm`` is the probability, for 0 to ``most`` squares."""
    from scipy.special import chdtri

    return np.concatenate([[np.inf], chdtri(np.arange(1, most + 1), false_alarm)])


_SPREAD = 0.6
"""Standard deviation of a channel over its mean: 0.4 to 0.7 for the ColorChecker."""
_CHANNELS = 0.9
"""Correlation of two channels: 0.65 to 0.99 for the ColorChecker."""
_ROWS_AT_ONCE = 256
_BLOCK = 16
"""Rows and columns of a block of a plane in which noise is measured. [pixels]"""
_FEWEST_BLOCKS = 20
_FURTHEST = 5.0
"""Standard errors by which the mean of a picture may be below black."""
_TENTH_Z = -1.2816
"""The value below which a tenth of a standard normal distribution lies."""
_DIFFERENCE_POWER = 36.0
"""Sum of the squares of the second difference along rows and columns."""
_DIFFERENCE_CORRELATION = (1 + 2 * (4 / 6) ** 2 + 2 * (1 / 6) ** 2) ** 2
"""Sum of the squared autocorrelation of that difference."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DenoisedRaw:
    """A raw picture after denoising.

    Attributes
    ----------
    values_e
        Electrons; those of the picture where it is saturated. [e-]
    names
        Planes: the places of the mosaic's tile.
    residual
        Root mean square of picture minus result over the noise of the picture, per plane; NaN
        where no value is used. [1]
    measured
        Noise of the picture where it is smoothest over its expected noise, per plane; NaN where
        there are no such places. [1]
    frames
        Number of merged frames.
    """

    values_e: Float32[Array, "h w"]
    names: tuple[str, ...]
    residual: Float[Array, " k"]
    measured: Float[Array, " k"]
    frames: int


def at_brightness(
    operating_point: OperatingPoint,
    mosaic: Mosaic,
    raw_e: Float32[Array, "h w"],
    noise: CodeNoise,
) -> OperatingPoint:
    """The operating point at which the ColorChecker has the mean of a picture.

    Parameters
    ----------
    operating_point
        Sensor, light and exposure; the illuminance is replaced.
    mosaic
        The channel of each pixel.
    raw_e
        The picture. [e-]
    noise
        Of the picture. Its standard error is the least mean that is used.

    Raises
    ------
    InputError
        If the mean of the picture is further below 0 than noise explains, or as
        `planes_of_mosaic`.
    """
    channels = channel_tile(mosaic, operating_point.sensor.names).ravel()
    chart = chart_electrons(operating_point)[:, channels].mean()
    scale = _mean_above_black(raw_e, noise)[0] / float(chart)
    return replace(operating_point, level_lux=operating_point.level_lux * scale)


def neutral_planes(raw_e: Float32[Array, "h w"], mosaic: Mosaic, noise: CodeNoise) -> NoisyPlanes:
    """The planes of a raw picture of an unknown sensor, with a prior of nearly gray scenes.

    Parameters
    ----------
    raw_e
        The picture. [e-]
    mosaic
        The channel of each pixel.

    Raises
    ------
    InputError
        If the mean of the picture is further below 0 than noise explains, or the mosaic has other
        channels than the noise.

    Notes
    -----
    The prior mean is that of each plane, at least its standard error in the dark. Each plane varies
    by 0.6 of its mean, and two channels have a correlation of 0.9, about as the ColorChecker.
    Neighbors are as in `planes_of_mosaic`.
    """
    _, error_e = _mean_above_black(raw_e, noise)
    tile = channel_tile(mosaic, noise.names)
    planes_e, channels = packed(raw_e, tile)
    mean = np.maximum(planes_e.mean(axis=(0, 1), dtype=np.float64), error_e)
    same = np.equal.outer(channels, channels)
    alike = np.where(same, 1.0, _CHANNELS) * place_correlation(tile)
    return NoisyPlanes(
        values_e=planes_e,
        law=noise.law.take(channels),
        prior_e2=np.outer(mean, mean) * _SPREAD**2 * alike,
        prior_mean_e=mean,
        names=mosaic.place_names,
    )


def denoised_raw(
    raw_e: Float32[Array, "h w"],
    mosaic: Mosaic,
    noise: CodeNoise,
    method: DenoisingMethod,
    *,
    operating_point: OperatingPoint | None = None,
    others: Iterable[tuple[Float32[Array, "h w"], float]] = (),
    work: Work = ALL_CORES,
) -> DenoisedRaw:
    """A raw picture, or a burst of them, after denoising.

    Parameters
    ----------
    raw_e
        The picture, or the first one. [e-]
    mosaic
        The channel of each pixel.
    operating_point
        Its sensor gives the covariance of the planes; `neutral_planes` without it.
    others
        Further pictures of a burst in their own electrons, each with its exposure over that of the
        first. [e-], [1]
    work
        As `denoised_planes`.

    Raises
    ------
    InputError
        As `neutral_planes`, `planes_of_mosaic`, `merged_frames` and the method.
    """
    tile = channel_tile(mosaic, noise.names)
    channels = tile.ravel()
    if operating_point is None:
        planes = neutral_planes(raw_e, mosaic, noise)
    else:
        known = planes_of_mosaic(raw_e, operating_point, mosaic, step_e=0.0)
        planes = replace(known, law=noise.law.take(channels))
    most_e = np.float32(np.inf)
    if noise.saturation_dn is not None:
        most_e = noise.electrons(np.array([[noise.saturation_dn]]))[0, 0]
    kept = planes.values_e >= most_e
    frames = [BurstFrame(values_e=packed(e, tile)[0], exposure=t) for e, t in others]
    if frames:
        burst = merged_frames(
            planes,
            frames,
            fixed=noise.spatial.take(channels),
            saturation_e=float(most_e),
        )
        planes, kept = burst.planes, burst.used == 0
    clean = denoised_planes(planes, method, work=work)
    clean[kept] = planes.values_e[kept]
    return DenoisedRaw(
        values_e=unpacked(clean, mosaic.shape, (raw_e.shape[0], raw_e.shape[1])),
        names=planes.names,
        residual=residual_ratio(planes, clean, kept),
        measured=measured_noise_ratio(planes, kept),
        frames=1 + len(frames),
    )


def residual_ratio(
    planes: NoisyPlanes, clean_e: Float32[Array, "h w p"], omitted: Bool[Array, "h w p"]
) -> Float[Array, " p"]:
    """Root mean square of what denoising removed over the standard deviation of the noise. [1]

    It is 1 where all noise was removed, lower where some noise remains, and higher where detail was
    removed or the picture has more noise than assumed.

    Parameters
    ----------
    planes
        Noisy values and their noise.
    clean_e
        Values after denoising. [e-]
    omitted
        Values that are not used.

    Returns
    -------
    ratio
        Per plane; NaN where no value is used or has noise.

    Examples
    --------
    >>> from chromanoise.sensor import VarianceLaw
    >>> planes = NoisyPlanes(
    ...     values_e=np.array([[[7.0], [13.0]]], np.float32), prior_e2=np.eye(1),
    ...     law=VarianceLaw(floor_e2=9.0), prior_mean_e=np.ones(1), names=("W",))
    >>> residual_ratio(planes, np.full((1, 2, 1), 10, np.float32), np.zeros((1, 2, 1), bool))
    array([1.])
    """
    sums, counts = np.zeros(len(planes.names)), np.zeros(len(planes.names))
    for start in range(0, len(clean_e), _ROWS_AT_ONCE):
        rows = slice(start, start + _ROWS_AT_ONCE)
        variance = planes.variance_e2(clean_e[rows])
        used = ~omitted[rows] & (variance > 0)
        squares = (planes.values_e[rows] - clean_e[rows]).astype(np.float64) ** 2
        sums += np.divide(squares, variance, out=np.zeros_like(squares), where=used).sum((0, 1))
        counts += used.sum((0, 1))
    return np.sqrt(np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0))


def measured_noise_ratio(planes: NoisyPlanes, omitted: Bool[Array, "h w p"]) -> Float[Array, " p"]:
    """Noise of a picture where it is smoothest over its expected noise. [1]

    It does not depend on a denoising method. It is 1 where the expected noise is right, and lower
    where it is too high. Detail everywhere in the picture raises it.

    Parameters
    ----------
    planes
        Noisy values and their noise.
    omitted
        Values that are not used.

    Returns
    -------
    ratio
        Standard deviations, per plane; NaN with fewer than 20 blocks of 16 x 16 used values.

    Notes
    -----
    The mean square of the second difference along rows and columns, 36 times the variance
    (Immerkaer, Computer Vision and Image Understanding 64 (1996), 300-302), in blocks. Of the
    blocks, the value below which a tenth lies is compared with that of noise alone, whose mean
    square has a relative variance of 2 a / n with n values and a the sum of the squared
    autocorrelation of the difference.
    """
    height, width, count = planes.values_e.shape
    found: list[list[Float[Array, " m"]]] = [[] for _ in range(count)]
    for top in range(0, height - _BLOCK - 1, _BLOCK):
        rows = slice(top, top + _BLOCK + 2)
        used = np.logical_not(omitted[rows].any(axis=0)).reshape(width, count)
        for i in range(count):
            values = planes.values_e[rows, :, i].astype(np.float64)
            across = values[:, :-2] - 2 * values[:, 1:-1] + values[:, 2:]
            second = across[:-2] - 2 * across[1:-1] + across[2:]
            whole = (width - 2) // _BLOCK * _BLOCK
            squares = (second[:, :whole] ** 2).reshape(_BLOCK, -1, _BLOCK).mean(axis=(0, 2))
            means = values[1:-1, 1 : 1 + whole].reshape(_BLOCK, -1, _BLOCK).mean(axis=(0, 2))
            flags = used[1 : 1 + whole, i].reshape(-1, _BLOCK).all(axis=1)
            variance = planes.variance_e2(np.repeat(means[:, None], count, axis=1))[:, i]
            flags &= variance > 0
            found[i].append(squares[flags] / (_DIFFERENCE_POWER * variance[flags]))
    of_noise = 1 + _TENTH_Z * math.sqrt(2 * _DIFFERENCE_CORRELATION) / _BLOCK
    blocks = [np.concatenate(each) if each else np.zeros(0) for each in found]
    return np.array(
        [
            math.sqrt(np.quantile(each, 0.1) / of_noise) if each.size >= _FEWEST_BLOCKS else np.nan
            for each in blocks
        ]
    )


def _mean_above_black(raw_e: Float32[Array, "h w"], noise: CodeNoise) -> tuple[float, float]:
    """Mean of a picture, at least its standard error in the dark, and that error. [e-]

    Raises
    ------
    InputError
        If the mean is further below 0 than 5 standard errors and half a code.
    """
    mean = float(raw_e.mean(dtype=np.float64))
    error_e = math.sqrt(np.max(noise.law.floor_e2) / raw_e.size)
    if mean < -_FURTHEST * error_e - noise.gain_e_per_dn / 2 or not max(mean, error_e) > 0:
        raise InputError(
            "mean of the picture",
            "must not be below the black level by more than noise explains",
            value=mean,
            found=f"is {mean:.4g} e- from it",
            remedy=Setting("black_level"),
        )
    return max(mean, error_e), error_e
