"""All noise sources of a pixel in closed form (eq. 7 and EMVA 1288).

`chromanoise.sensor.noise_sources` lists them.

The pattern of crosstalk is that between the places of a mosaic at which one channel has different
neighbors. Before counting, PRNU acts on each M_k: its variance is PRNU^2 times the mean of M_k^2.

Temporal noise differs from frame to frame. Spatial noise is a fixed pattern: the same in every
frame, so that the mean of a burst keeps it. One reading over a flat field shows both.

Of binned pixels the values of `Pixel` are those of the sum (`chromanoise.sensor.binned`), and so
are all variances here.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from chromanoise.base import (
    Array,
    Bool,
    Float,
    InputError,
    Int,
    Setting,
    check,
    congruence,
    dataclass,
    diagonal,
    inv,
    kept,
)
from chromanoise.noise.exposure import Exposure
from chromanoise.noise.measurement import Measurement
from chromanoise.noise.readout import (
    Moments,
    Readout,
    additive_rounding_fails,
    largest_code_share,
    read_moments,
)
from chromanoise.sensor import (
    ALL,
    FIXED,
    PATTERN,
    READ,
    READ_OUT,
    SHOT,
    Crosstalk,
    NoiseKind,
    NoiseSource,
    PixelReading,
    Sensor,
    VarianceLaw,
    of_one_reading,
    quantization_step_e,
    white_level_e,
)


@dataclass(frozen=True, kw_only=True, eq=False)
class CrosstalkPattern:
    """Fixed pattern of crosstalk: mean of each place of a mosaic minus the mean of its channel.

    Attributes
    ----------
    shares
        Electrons of each place minus the mean of its channel, per electron of each channel: per
        electron read for crosstalk before counting, per electron counted for crosstalk after it.
        [1]
    channel
        Channel of each place.
    counted
        Whether the places count different numbers of electrons (crosstalk before counting);
        otherwise equal counts are mixed differently (crosstalk after counting).
    """

    shares: Float[Array, "k p"]
    channel: Int[Array, " k"]
    counted: bool

    def __post_init__(self) -> None:
        check.freeze(self, "shares", "channel")

    def variance_e2(self, mean_e: Float[Array, "*px p"]) -> Float[Array, "*px p"]:
        """Mean over the places of each channel of the squared deviation. [e-^2]

        Parameters
        ----------
        mean_e
            Expected electrons of all channels. [e-]
        """
        member = self.channel[:, None] == np.arange(self.shares.shape[1])
        return (mean_e @ self.shares.T) ** 2 @ (member / member.sum(axis=0))

    def means_e(self, mean_e: Float[Array, "*px p"], channel: int) -> Float[Array, "*px n"]:
        """Expected electrons at each place of one channel. [e-]

        Parameters
        ----------
        mean_e
            Expected electrons of all channels. [e-]
        channel
            Index of the channel.
        """
        mean, own = np.asarray(mean_e), self.shares[self.channel == channel]
        return np.maximum(mean[..., channel, None] + mean @ own.T, 0.0)  # rounding in the dark


@lru_cache(maxsize=64)  # of crosstalk that many analyses share
def crosstalk_pattern(crosstalk: Crosstalk | None) -> CrosstalkPattern | None:
    """The fixed pattern of crosstalk; ``None`` if all places of each channel have equal shares.

    Also ``None`` without a mosaic, and if crosstalk before counting cannot be inverted, because the
    light of the neighbors is then unknown.

    Parameters
    ----------
    crosstalk
        Crosstalk of the sensor; ``None`` without any.
    """
    away = None if crosstalk is None else crosstalk.deviations
    if crosstalk is None or crosstalk.places is None or away is None:
        return None
    counted, shares = not crosstalk.is_after_counting, away.reshape(-1, away.shape[-1])
    if counted:
        unmixing = crosstalk.inverse
        if unmixing is None:
            return None
        shares = shares @ unmixing
    return CrosstalkPattern(shares=shares, channel=crosstalk.places.tile.ravel(), counted=counted)


_ONE_CODE = 0.999  # share of the readings
_STEPS_OF_ONE_CODE = 5.0  # below as many standard deviations per step no code has that share
_MOST_LEVELS = 101  # more levels of telegraph noise are as good as normal noise
_LEAST_SHARE = 1e-15  # of a level that counts
_WEAK = 1e-3  # a channel with less of the electrons of the strongest one decides no color
_UNBOUNDED = Readout()
LEAST_DITHER = 0.4
"""Noise over the step of a converter: less bends the mean code by over 2 exp(-2 pi^2 0.4^2). [1]"""


@dataclass(frozen=True, kw_only=True)
class NoiseSources(PixelReading):
    """The variance of one reading, source by source, at one exposure.

    Attributes
    ----------
    pattern
        The pattern of crosstalk over the places of a mosaic; ``None`` without any.
    readings
        Rounded readings that are summed (`chromanoise.sensor.binned`); all values are those of the
        sum. 1 where nothing is rounded.

    Examples
    --------
    EMVA 1288: 100 e- of light, 20 of the dark, 5 e- of readout, 2 e- of DSNU.

    >>> from chromanoise.sensor import Pixel
    >>> pixel = Pixel(pitch_um=5, full_well_e=10_000, read_noise_e=5.0, dsnu_e=2.0)
    >>> noise = NoiseSources(pixel=pixel, dark_e=20.0)
    >>> noise.variance_e2(np.array([100.0]))
    array([149.])
    >>> noise.variance_e2(np.array([100.0]), "temporal")
    array([145.])
    """

    pattern: CrosstalkPattern | None = None
    readings: int = 1

    def by_source(self, mean_e: Float[Array, "*px p"]) -> Mapping[str, Float[Array, "*px p"]]:
        """Variance per source, in the order of ``sources``; those that are 0 included. [e-^2]

        Parameters
        ----------
        mean_e
            Expected electrons of the light, >= 0. [e-]
        """
        mean = np.asarray(mean_e, dtype=np.float64)
        pattern = self.pattern_e2(mean)
        square = mean**2
        if self.pattern is not None and self.pattern.counted:
            square = square + pattern
        powers = {"floor_e2": np.ones_like(mean), "slope_e": mean, "square": square}
        nothing = np.zeros_like(mean)
        found = {
            one.cause: value * powers[one.term] if (value := self._value(one)) else nothing
            for one in self.sources
        }
        return found | {PATTERN: pattern}

    def _value(self, one: NoiseSource) -> float:
        return float(one.value(self)) if self.has(one) else 0.0

    def pattern_e2(self, mean_e: Float[Array, "*px p"]) -> Float[Array, "*px p"]:
        """Variance of the pattern of crosstalk per channel; 0 without a pattern. [e-^2]

        Parameters
        ----------
        mean_e
            As `by_source`.
        """
        mean = np.asarray(mean_e, dtype=np.float64)
        return np.zeros_like(mean) if self.pattern is None else self.pattern.variance_e2(mean)

    def after_counting_e2(
        self, counted_e: Float[Array, "*px p"], kind: NoiseKind = "total"
    ) -> Float[Array, "*px p"] | float:
        """The part of `variance_e2` that crosstalk after counting does not mix: readout and
        pattern. [e-^2]

        Parameters
        ----------
        counted_e, kind
            As `variance_e2`. [e-]
        """
        floor = self.read_out_e2
        return floor if kind == "temporal" else floor + self.pattern_e2(counted_e)

    @cached_property
    def read_out_e2(self) -> float:
        """Variance that the readout adds, after any crosstalk. [e-^2]"""
        return self.coefficient("floor_e2", READ_OUT)

    def floor_e2(self, kind: NoiseKind = "total") -> float:
        """Variance without light. [e-^2]

        Parameters
        ----------
        kind
            Total noise of a reading, or temporal noise only.
        """
        return float(self.law(kind).floor_e2)

    def variance_e2(
        self, mean_e: Float[Array, "*px p"], kind: NoiseKind = "total"
    ) -> Float[Array, "*px p"]:
        """Variance of one reading across a flat field, or only its temporal part. [e-^2]

        The variance of the linear model, with step^2 / 12 for rounding; see `rounded`.

        Parameters
        ----------
        mean_e
            Expected electrons of the light, >= 0. [e-]
        kind
            ``total``, or ``temporal`` without DSNU, PRNU and the pattern of crosstalk.

        Raises
        ------
        InputError
            If an entry of ``mean_e`` is negative or not finite.
        """
        mean = check.non_negative("mean_e", "e-", mean_e)
        variance = mean + self.floor_e2(kind)
        return variance + self._fixed_e2(mean) if kind == "total" else variance

    def _fixed_e2(self, mean: Float[Array, "*px p"]) -> Float[Array, "*px p"] | float:
        """Variance of the fixed patterns that grow with the light: PRNU and crosstalk. [e-^2]"""
        square = self.law().square
        own = square * mean**2 if square else 0.0
        if self.pattern is None:
            return own
        pattern = self.pattern_e2(mean)
        return own + (1 + square * self.pattern.counted) * pattern

    def law(self, kind: Literal["total", "temporal", "spatial"] = "total") -> VarianceLaw:
        """The variance of one reading as a law of the light, without the pattern of crosstalk.

        Parameters
        ----------
        kind
            All noise, what changes from frame to frame, or what is the same in every frame.
        """
        laws = self._laws
        found = laws.get(kind)
        if found is None:
            ways = FIXED if kind == "spatial" else ALL
            but = FIXED if kind == "temporal" else ()
            found = laws[kind] = VarianceLaw(
                floor_e2=self.coefficient("floor_e2", ways, but),
                slope_e=self.coefficient("slope_e", ways, but),
                square=self.coefficient("square", ways, but),
            )
        return found

    @cached_property
    def _laws(self) -> dict[str, VarianceLaw]:
        return {}

    def added_variance_e2(self, mean_e: Float[Array, "*px p"]) -> Float[Array, "*px p"] | float:
        """The variance that does not come from counting: all but shot noise and dark electrons.

        The quantization is not included either, where it is computed as rounding. [e-^2]

        Parameters
        ----------
        mean_e
            Expected electrons of each channel. [e-]
        """
        constant = self.coefficient("floor_e2", ALL, ("count", "rounding"))
        return constant + self._fixed_e2(np.asarray(mean_e))

    def rounding_is_coarse(self, mean_e: Float[Array, "*px p"]) -> Bool[Array, "*px p"]:
        """Where rounding does not add the variance step^2 / 12, because the step exceeds the noise.

        Parameters
        ----------
        mean_e
            Expected electrons of the light, >= 0. [e-]
        """
        mean = np.asarray(mean_e, dtype=np.float64)
        if not self.step_e:
            return np.zeros(mean.shape, dtype=bool)
        # most pixels have one level
        counted, readout, sd = self.without_levels.of_one_reading(mean)
        light = mean / self.readings
        return additive_rounding_fails(
            light, counted_e=counted, read_noise_e=sd, step_e=readout.step_e
        )

    def rounded(
        self, mean_e: Float[Array, "*px p"], kind: NoiseKind = "total"
    ) -> tuple[Float[Array, "*px p"], Float[Array, "*px p"]]:
        """Bias and variance of one reading, rounding included. [e-, e-^2]

        The bias is that of rounding only, without the error of the black level. Where
        `rounding_is_coarse` is true, both are exact; elsewhere the bias is 0 and the variance is
        `variance_e2`.

        Parameters
        ----------
        mean_e, kind
            As `variance_e2`.

        Examples
        --------
        With 100 e- per code nearly all readings are 0, so the variance is far below 100^2 / 12.

        >>> from chromanoise.sensor import PAPER_PIXEL        # 10 e- of read noise
        >>> coarse = NoiseSources(pixel=PAPER_PIXEL, step_e=100.0)
        >>> bias, variance = coarse.rounded(np.array([20.0]))
        >>> bias.round(2), variance.round(1)
        (array([-19.68]), array([32.4]))
        """
        variance = np.array(self.variance_e2(mean_e, kind))
        mean, bias = np.asarray(mean_e, dtype=np.float64), np.zeros_like(variance)
        if not self.step_e:
            return bias, variance
        own = self if kind == "total" else self.temporal
        coarse = own.rounding_is_coarse(mean)
        if own.pattern is not None:
            alone = replace(own, pattern=None)
            for i in np.flatnonzero(coarse.any(axis=tuple(range(mean.ndim - 1)))):
                means, at = own.pattern.means_e(mean, int(i)), coarse[..., i]
                away, each = alone.rounded(means)
                read_e, spread = means + away, each.mean(axis=-1)
                bias[..., i] = np.where(at, read_e.mean(axis=-1) - mean[..., i], 0.0)
                variance[..., i] = np.where(at, spread + read_e.var(axis=-1), variance[..., i])
        elif coarse.any():
            counted, readout, sd = own.smooth.of_one_reading(mean)
            read = own.moments_of_one_reading(counted[coarse], readout, sd[coarse])
            bias[coarse] = own.readings * read.mean - mean[coarse] - own.black_error_e
            variance[coarse] = own.readings * read.variance
        return bias, variance

    def gives_one_code(self, mean_e: Float[Array, "*px p"]) -> Bool[Array, "*px p"]:
        """Where more than 99.9 % of the readings are the same code, so that they show no noise.

        Parameters
        ----------
        mean_e
            Expected electrons of the light, >= 0. [e-]
        """
        mean = np.asarray(mean_e, dtype=np.float64)
        found = np.zeros(mean.shape, dtype=bool)
        if not self.step_e:
            return found
        counted, readout, sd = self.without_levels.of_one_reading(mean)
        near = counted + sd**2 < (readout.step_e / _STEPS_OF_ONE_CODE) ** 2
        if near.any():
            found[near] = (
                largest_code_share(
                    counted[near], read_noise_e=sd[near], readout=readout, shifts=self.shifts
                )
                > _ONE_CODE
            )
        return found

    def of_one_reading(
        self, mean_e: Float[Array, "*px p"], of_sum: Readout = _UNBOUNDED
    ) -> tuple[Float[Array, "*px p"], Readout, Float[Array, "*px p"]]:
        """Counted electrons, readout and added noise of each reading of a sum of readings. [e-]

        As in raw pictures, the mean dark signal is subtracted and the error of the black level
        added before the converter rounds.

        Parameters
        ----------
        mean_e
            Expected electrons of the light. [e-]
        of_sum
            Bounds of the sum after the subtraction of the mean dark signal, full well before it,
            of which each reading has an equal part; the step is that of the converter, unless
            another is given. [e-]
        """
        n, offset_e = self.readings, (self.black_error_e - self.dark_e) / self.readings
        readout = Readout(
            black_e=of_sum.black_e / n,
            full_well_e=of_sum.full_well_e / n + offset_e,
            step_e=of_sum.step_e or self.step_e / np.sqrt(n),
            offset_e=offset_e,
        )
        sd = np.sqrt(np.broadcast_to(self.added_variance_e2(mean_e) / n, mean_e.shape))
        return mean_e / n + self.dark_e / n, readout, sd

    @property
    def shifts(self) -> tuple[tuple[float, float], ...]:
        """Levels of one of the ``readings``: their shares of pixels and frames, and places. [e-]

        Of readings that are summed without rounding each has its own level. One level where there
        is no telegraph noise, or so many that they are normal noise: see `smooth`.
        """
        share, away_e = self.levels
        summed = int(self.pixel.summed_readings)
        n, away_e = summed // self.readings, away_e / math.sqrt(summed)
        if not share:
            return ((1.0, 0.0),)
        if n == 1:
            return ((1 - share, 0.0), (share / 2, away_e), (share / 2, -away_e))
        of_one = np.zeros(2 * n + 1)
        of_one[[0, 1, -1]] = 1 - share, share / 2, share / 2
        shares = np.fft.fftshift(np.fft.irfft(np.fft.rfft(of_one) ** n, of_one.size))
        likely = np.flatnonzero(shares > _LEAST_SHARE)
        if likely.size > _MOST_LEVELS:
            return ((1.0, 0.0),)
        return tuple(zip(shares[likely].tolist(), (away_e * (likely - n)).tolist(), strict=True))

    @property
    def without_levels(self) -> "NoiseSources":
        """The sources without telegraph noise."""
        return replace(self, without=self.without | {"levels"})

    @property
    def smooth(self) -> "NoiseSources":
        """The sources that are added as one normal variable to each of the levels (`shifts`)."""
        return self if len(self.shifts) == 1 else self.without_levels

    def moments_of_one_reading(
        self, counted_e: Float[Array, "*px p"], readout: Readout, sd_e: Float[Array, "*px p"]
    ) -> Moments:
        """Moments of one reading, averaged over the levels of telegraph noise.

        Parameters
        ----------
        counted_e, readout, sd_e
            As `of_one_reading` of the `smooth` sources gives them. [e-]
        """
        each = []
        for weight, shift_e in self.shifts:
            shifted = replace(readout, offset_e=readout.offset_e + shift_e)
            each.append((weight, read_moments(counted_e, read_noise_e=sd_e, readout=shifted)))
        if len(each) == 1:
            return each[0][1]

        def mean_of(value: Callable[[Moments], Array]) -> Array:
            return np.asarray(sum(weight * value(one) for weight, one in each))

        mean = mean_of(lambda one: one.mean)
        return Moments(
            mean=mean,
            variance=mean_of(lambda one: one.variance + (one.mean - mean) ** 2),
            bias=mean_of(lambda one: one.bias),
            black_share=np.minimum(mean_of(lambda one: one.black_share), 1.0),
            full_share=np.minimum(mean_of(lambda one: one.full_share), 1.0),
        )

    @property
    def one_reading(self) -> "NoiseSources":
        """The sources of each of the readings that are summed, without the pattern."""
        n = self.readings
        return replace(
            self,
            pixel=of_one_reading(self.pixel, n),
            step_e=self.step_e / np.sqrt(n),
            dark_e=self.dark_e / n,
            pattern=None,
            readings=1,
        )

    @property
    def black_error_e(self) -> float:
        """Bias of every reading. [e-]"""
        return self.pixel.black_error_e

    @property
    def temporal(self) -> "NoiseSources":
        """The sources without the fixed patterns, which are the same in every frame."""
        return replace(self, without=self.without | FIXED, pattern=None)

    def without_source(self, cause: str) -> "NoiseSources":
        """The same reading of a sensor that lacks one source.

        Parameters
        ----------
        cause
            Of one of ``sources`` besides shot noise.

        Examples
        --------
        >>> from chromanoise.sensor import Pixel
        >>> pixel = Pixel(pitch_um=5, full_well_e=10_000, read_noise_e=5.0, dsnu_e=2.0)
        >>> noise = NoiseSources(pixel=pixel, dark_e=20.0)
        >>> noise.without_source("read noise").floor_e2(), noise.without_source("DSNU").floor_e2()
        (24.0, 45.0)
        """
        known = {one.cause: one.drawn for one in self.sources if one.cause != SHOT}
        drawn = known[check.among("source of noise", cause, tuple(known))]
        if drawn == "count":
            return replace(self, dark_e=0.0)
        if drawn == "rounding":
            return replace(self, step_e=0.0, readings=1)
        if drawn == "place":
            return replace(self, pattern=None)
        return replace(self, without_causes=self.without_causes | {cause})

    @property
    def has_fixed_pattern(self) -> bool:
        """Whether a source is the same in every frame."""
        fixed = (one for one in self.sources if one.drawn in FIXED and self.has(one))
        return self.pattern is not None or any(one.value(self) for one in fixed)

    @property
    def beyond_shot_and_read(self) -> bool:
        """Whether there is any source besides shot noise and read noise, or a bias."""
        more = any(
            one.value(self)
            for one in self.sources
            if one.cause not in (SHOT, READ) and self.has(one)
        )
        return more or self.pattern is not None or bool(self.black_error_e)


def noise_sources(sensor: Sensor, exposure: Exposure | None = None) -> NoiseSources:
    """The noise sources of a sensor at one exposure.

    Parameters
    ----------
    sensor
        Its pixel and its converter.
    exposure
        The exposure, whose time determines the dark electrons; not needed without dark current.

    Raises
    ------
    InputError
        If the pixel has a dark current and no exposure is given.
    """
    # the functions of a user's sources may depend on what changes
    make = _made_anew if sensor.pixel.own_noise else _noise_sources
    return make(sensor, exposure)


def _made_anew(sensor: Sensor, exposure: Exposure | None) -> NoiseSources:
    pixel = sensor.pixel
    if exposure is None and pixel.dark_current_e_per_s:
        raise InputError(
            "exposure",
            "must be given for a pixel with dark current",
            value=None,
            found=f"is missing, and {sensor.name} has {pixel.dark_current_e_per_s:g} e-/s",
        )
    step_e = quantization_step_e(sensor.converter, pixel)
    return NoiseSources(
        pixel=pixel,
        dark_e=0.0 if exposure is None else pixel.dark_electrons_e(time_s=exposure.time_s),
        step_e=step_e,
        pattern=crosstalk_pattern(sensor.crosstalk),
        readings=int(pixel.summed_readings) if step_e else 1,
    )


_noise_sources = kept(_made_anew)


def demand_independent_channels(sensor: Sensor) -> None:
    """Check that no crosstalk after counting correlates the channels.

    Clipped values and the exact distribution are computed channel by channel.

    Raises
    ------
    InputError
        If it does.
    """
    if after_counting(sensor.crosstalk) is not None:
        raise InputError(
            "crosstalk_stage",
            "must be light where values are clipped or noise comes from its exact distribution",
            value="charge",
            found=f"crosstalk after counting correlates the channels of {sensor.name}",
            remedy=Setting("crosstalk_stage", ("light",)),
        )


def raw_covariance(
    mean_e: Float[Array, "*px p"], *, read_noise_e: float
) -> Float[Array, "*px p p"]:
    """Covariance of the raw channels: shot noise plus read noise, independent per channel. [e-^2]

    Parameters
    ----------
    mean_e
        Expected electrons per channel, >= 0. [e-]
    read_noise_e
        Standard deviation of the readout, >= 0. [e-]

    Raises
    ------
    InputError
        If an entry of ``mean_e`` is negative or not finite.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 7: var(S) = M + s_rn^2.

    Examples
    --------
    >>> raw_covariance(np.array([100.0, 25.0]), read_noise_e=10.0)
    array([[200.,   0.],
           [  0., 125.]])
    """
    mean = check.non_negative("mean_e", "e-", mean_e)
    read = check.not_negative("read_noise_e", "e-", read_noise_e)
    return diagonal(mean + read**2)


def with_noise(
    mean_e: Float[Array, "*px p"],
    sensor: Sensor,
    exposure: Exposure | None = None,
    *,
    kind: NoiseKind = "total",
    linear: bool = False,
) -> Measurement:
    """The raw measurement: expected electrons and covariance, without clipping as in the paper.

    Where the step of the converter exceeds the noise, the mean includes the bias of rounding, and
    mean and variance are exact (`NoiseSources.rounded`).

    Parameters
    ----------
    mean_e
        Expected electrons of the light per channel, >= 0. [e-]
    sensor, exposure
        As `noise_sources`.
    kind
        ``total``, or ``temporal`` without DSNU, PRNU and the pattern of crosstalk.
    linear
        Whether to use the variance step^2 / 12 for rounding also where the step exceeds the noise.
        For values that this model defines: dynamic ranges and noise profiles.

    Raises
    ------
    InputError
        As `noise_sources` and `NoiseSources.variance_e2`.

    Notes
    -----
    With crosstalk X after counting, ``mean_e`` is X M and the covariance X D(M) X^T + R, with the
    variances R that X does not mix: read noise, quantization, row noise, the pattern of crosstalk.
    This is the covariance of a pixel that has all channels, and of averages over areas of many
    pixels of a mosaic. A single pixel of a mosaic receives electrons from several neighbors whose
    noise is independent, so its variance is smaller: ``reading_variance`` is S D + R, with the
    squared shares S.
    """
    noise, coupling = noise_sources(sensor, exposure), after_counting(sensor.crosstalk)
    counted, reading = counted_electrons(mean_e, coupling), None
    if linear or coupling is not None:
        variance = noise.variance_e2(counted, kind)
    else:
        bias, variance = noise.rounded(mean_e, kind)
        mean_e = mean_e + bias if bias.any() else mean_e
    after = 0.0 if coupling is None else noise.after_counting_e2(counted, kind)
    if coupling is not None and sensor.crosstalk is not None and sensor.crosstalk.places:
        reading = (variance - after) @ sensor.crosstalk.squares.T + after
    return Measurement(
        mean=mean_e,
        covariance=_coupled(variance, coupling, after),
        names=sensor.names,
        kind="raw",
        unit="e-",
        reading_variance=reading,
    )


def mean_noise_covariance(
    mean_e: Float[Array, "*px k p"],
    share: Float[Array, " k"],
    sensor: Sensor,
    exposure: Exposure | None = None,
    *,
    light: float | Float[Array, " l"] = 1.0,
) -> Float[Array, "*few p p"]:
    """The covariance of `with_noise`, averaged over a set of lights. [e-^2]

    Parameters
    ----------
    mean_e
        Expected electrons of each light of the set, >= 0; one set, or one per pixel. [e-]
    share
        Weight of each light; the sum is 1.
    sensor, exposure
        As `noise_sources`.
    light
        Factor on ``mean_e``, or of one set several factors, with one covariance each. [1]

    Raises
    ------
    InputError
        As `with_noise`.

    Examples
    --------
    >>> from chromanoise.sensor.pixel import PAPER_PIXEL
    >>> from chromanoise.spectra import Grid
    >>> one = Sensor(name="one", grid=Grid.uniform(500, 520, 10), qe=np.full((3, 1), 0.5),
    ...              names=("W",), pixel=PAPER_PIXEL)
    >>> mean_noise_covariance(np.array([[100.0], [300.0]]), np.array([0.5, 0.5]), one)
    array([[300.]])
    """
    noise, coupling = noise_sources(sensor, exposure), after_counting(sensor.crosstalk)
    counted = check.non_negative("mean_e", "e-", counted_electrons(mean_e, coupling))
    mean, square = share @ counted, share @ counted**2
    factor = np.asarray(light)[..., None]
    law = noise.law()
    variance = factor * mean + law.floor_e2 + law.square * factor**2 * square
    after: Float[Array, "*few p"] | float = noise.read_out_e2
    if noise.pattern is not None:
        pattern = factor**2 * (share @ noise.pattern_e2(counted))
        variance = variance + pattern * (1 + law.square * noise.pattern.counted)
        after = after + pattern
    return _coupled(variance, coupling, after)


def after_counting(crosstalk: Crosstalk | None) -> Float[Array, "p p"] | None:
    """The matrix of crosstalk that correlates the readings; ``None`` without any. [1]

    Parameters
    ----------
    crosstalk
        Crosstalk of the sensor; ``None`` without any.
    """
    return crosstalk.matrix if crosstalk is not None and crosstalk.is_after_counting else None


def counted_electrons(
    mean_e: Float[Array, "*px p"], coupling: Float[Array, "p p"] | None
) -> Float[Array, "*px p"]:
    """Expected electrons that the pixels count: X^-1 M with crosstalk X `after_counting`. [e-]

    Parameters
    ----------
    mean_e
        Expected electrons of each channel. [e-]
    coupling
        Matrix of `after_counting`; ``None`` without any.
    """
    if coupling is None:
        return np.asarray(mean_e, dtype=np.float64)
    return np.maximum(mean_e @ inv("crosstalk", coupling).T, 0.0)  # rounding of a dark channel


def _coupled(
    variance_e2: Float[Array, "*px p"],
    coupling: Float[Array, "p p"] | None,
    after_e2: Float[Array, "*px p"] | float,
) -> Float[Array, "*px p p"]:
    """Covariance of the readings; their variance without mixing contains `after_counting_e2`."""
    if coupling is None:
        return diagonal(variance_e2)
    after = diagonal(np.broadcast_to(after_e2, variance_e2.shape))
    return congruence(coupling, diagonal(variance_e2) - after) + after


def saturated(
    mean_e: Float[Array, "*px p"], sensor: Sensor, exposure: Exposure | None = None
) -> Bool[Array, "*px p"]:
    """True where the expected electrons exceed the white level, so that the SNR is undefined.

    Dark electrons of the exposure, where given, fill the well too (`white_level_e`).

    Parameters
    ----------
    mean_e
        Expected electrons of each channel. [e-]
    """
    return np.asarray(mean_e) > signal_limit_e(sensor, exposure) * (1 + 1e-12)


def one_code(
    mean_e: Float[Array, "*px p"], sensor: Sensor, exposure: Exposure | None = None
) -> Bool[Array, "*px p"]:
    """True where practically every reading is the same code, so that the SNR is undefined.

    False for channels with less than a thousandth of the electrons of the strongest channel: for
    them, the code without light is the correct reading.

    Parameters
    ----------
    mean_e
        Expected electrons of each channel. [e-]
    sensor, exposure
        As `noise_sources`.
    """
    return noise_sources(sensor, exposure).gives_one_code(mean_e) & _is_lit(mean_e)


def _is_lit(mean_e: Float[Array, "*px p"]) -> Bool[Array, "*px p"]:
    mean = np.asarray(mean_e, dtype=np.float64)
    return np.asarray((mean > 0) & (mean >= _WEAK * mean.max(axis=-1, keepdims=True)))


def coarsely_converted(
    mean_e: Float[Array, "*px p"], sensor: Sensor, exposure: Exposure | None = None
) -> Bool[Array, "*px p"]:
    """True where the mean code does not follow the light, as the converter's step hides the noise.

    That is, where the noise before rounding is below `LEAST_DITHER` of the step. False for the weak
    channels of `one_code`.

    Parameters
    ----------
    mean_e, sensor, exposure
        As `one_code`.
    """
    noise = noise_sources(sensor, exposure)
    if not noise.step_e:
        return np.zeros(np.shape(mean_e), dtype=bool)
    before_e2 = noise.variance_e2(mean_e, "total") - noise.step_e**2 / 12
    return np.asarray((before_e2 < (LEAST_DITHER * noise.step_e) ** 2) & _is_lit(mean_e))


def signal_limit_e(sensor: Sensor, exposure: Exposure | None = None) -> float:
    """`white_level_e` at an exposure, whose time determines the dark electrons. [e-]"""
    pixel = sensor.pixel
    dark_e = 0.0 if exposure is None else pixel.dark_electrons_e(time_s=exposure.time_s)
    return white_level_e(sensor, dark_e=dark_e)
