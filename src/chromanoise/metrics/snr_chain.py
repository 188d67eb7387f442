"""The SNR of color coordinates, with any set of the causes of a budget switched on.

Signals, noise and weights have one row per coordinate, so that coordinates of many sensors with
equal noise are evaluated at once. `chromanoise.metrics.budget` says what each cause switches.
"""

from collections.abc import Callable, Container, Sequence
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from chromanoise.base import Array, Float, congruence, dataclass, decibel, diagonal, pinv
from chromanoise.metrics.shapley import Switches
from chromanoise.noise import NoiseSources, after_counting, counted_electrons
from chromanoise.sensor import ALL, PATTERN, READ, READ_OUT, SHOT, SOURCES, Crosstalk, Drawn

FILTERS, READ_NOISE, WEIGHTS = "filters", READ, "weights"
CORRELATION, INFRARED, REST = "correlation", "infrared", "rest"
CROSSTALK = "crosstalk"
CAUSES = (FILTERS, READ_NOISE, WEIGHTS, CORRELATION, INFRARED)
"""The causes of every budget; `causes_of` adds those of the sensor's own noise sources."""
_SLOPE_STEP = 1e-3
QUANTIZATION = next(one.cause for one in SOURCES if one.drawn == "rounding")


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """Electrons of the signal, and electrons that contribute shot noise.

    Attributes
    ----------
    signal_e
        Electrons of the signal. [e-]
    noise_e
        Electrons whose shot noise counts. [e-]
    is_change
        Whether signals are changes of the electrons, which coarse rounding multiplies by the slope
        of the rounded mean. Otherwise signals are electrons, which it replaces by the rounded mean.
    """

    signal_e: Float[Array, "*k p"]
    noise_e: Float[Array, "*k p"]
    is_change: bool = False

    @property
    def sought_e(self) -> Float[Array, "*k p"]:
        """The signal for which the best linear readout is optimized: all electrons, or a change."""
        return self.signal_e if self.is_change else self.noise_e


@dataclass(frozen=True, kw_only=True, eq=False)
class Channels:
    """Signals, noise and weights of the channels, after crosstalk or before it.

    Attributes
    ----------
    without_infrared, with_infrared
        Signal and noise with the cause "infrared" off, and on.
    row
        The coordinate's row of the color matrix, applied to the unmixed channels.
    single_row
        The coordinate's weights where the overlap of the channels is neglected.
    """

    without_infrared: Seen
    with_infrared: Seen
    row: Float[Array, "*k p"]
    single_row: Float[Array, "*k p"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Chain:
    """All that the causes switch between, of one or many coordinates of sensors with equal noise.

    Attributes
    ----------
    photons_db
        SNR at the start of the chain: `counting_snr_db`. [dB]
    channels
        The channels of the sensor.
    before_crosstalk
        The channels with the cause "crosstalk" off; ``None`` without that cause.
    behind_cut
        The channels behind an ideal IR-cut; ``None`` where infrared is no cause, or the coordinate
        is undefined there.
    noise
        The noise sources of each pixel.
    crosstalk
        Of the sensor; no cause if it cannot be inverted, as the curves without it are unknown.
    """

    photons_db: Float[Array, "*k"]
    channels: Channels
    before_crosstalk: Channels | None
    noise: NoiseSources
    crosstalk: Crosstalk | None = None
    behind_cut: Channels | None = None

    @property
    def is_change(self) -> bool:
        """Whether the signals are changes of the light: as `Seen.is_change`."""
        return self.channels.with_infrared.is_change


_Record = TypeVar("_Record", Seen, Channels, Chain)


def merged(of_arrays: Callable[[Sequence[Array]], Array], *records: _Record) -> _Record:
    """Records of one structure as one, whose arrays are ``of_arrays`` of theirs."""
    found: dict[str, Any] = {}
    for one in fields(records[0]):
        values = [getattr(record, one.name) for record in records]
        if isinstance(values[0], np.ndarray):
            found[one.name] = of_arrays(values)
        elif isinstance(values[0], Seen | Channels):
            found[one.name] = merged(of_arrays, *values)
    return replace(records[0], **found)


def rounded_share(seen: Seen, noise: NoiseSources) -> Float[Array, "*k p"]:
    """Ratio of the signal of each channel after rounding to that before; 1 for a fine step. [1]

    Parameters
    ----------
    seen
        Electrons of the signal and of the noise.
    noise
        The noise sources of each pixel.
    """
    mean = seen.noise_e
    if not noise.rounding_is_coarse(mean).any():
        return np.ones_like(mean)
    if not seen.is_change:
        return 1 + noise.rounded(mean)[0] / np.where(mean > 0, mean, 1.0)
    step = _SLOPE_STEP * np.sqrt(1 + mean)
    below, above = np.maximum(mean - step, 0.0), mean + step
    return 1 + (noise.rounded(above)[0] - noise.rounded(below)[0]) / (above - below)


def coarsely_rounded(chain: Chain) -> bool:
    """Whether rounding depends on the other noise: the step of a channel exceeds its noise."""
    if not chain.noise.step_e or after_counting(chain.crosstalk) is not None:
        return False
    return any(
        chain.noise.rounding_is_coarse(seen.noise_e).any()
        for of in (chain.channels, chain.before_crosstalk)
        if of is not None
        for seen in (of.with_infrared, of.without_infrared)
    )


def may_be_rounded(chain: Chain) -> bool:
    """Whether a chain is `coarsely_rounded` without some of its causes."""
    if not chain.noise.step_e:
        return False
    left_out = ALL - {"count", "rounding"}
    bare = replace(chain.noise, without=left_out, dark_e=0.0, pattern=None)
    every = (chain.channels, chain.before_crosstalk, chain.behind_cut)
    return any(
        coarsely_rounded(
            replace(chain, channels=of, before_crosstalk=None, crosstalk=None, noise=bare)
        )
        for of in every
        if of is not None
    )


def causes_of(chain: Chain, *, infrared: bool = True) -> tuple[str, ...]:
    """The causes of a budget: those of every sensor, and the noise sources that this one has.

    Parameters
    ----------
    chain
        The chain of a coordinate.
    infrared
        Whether the budget separates the infrared.
    """
    noise = chain.noise
    own = {one.cause for one in noise.sources if one.value(noise)}
    own |= set() if noise.pattern is None else {PATTERN}
    more = tuple(name for name in more_noise(noise) if name in own)
    mixed = (CROSSTALK,) if chain.before_crosstalk is not None else ()
    end = CAUSES[2:] if infrared else CAUSES[2:-1]
    return (*CAUSES[:2], *more, *mixed, *end)


def more_noise(noise: NoiseSources) -> list[str]:
    """The sources besides shot noise and read noise."""
    return [one.cause for one in noise.sources if one.cause not in (SHOT, READ)]


def noise_causes(chain: Chain) -> frozenset[str]:
    """The causes of the best linear readout: filters, crosstalk and all noise of the pixel.

    The infrared is a part of the signal, unless that is a change of the light.
    """
    excluded = {WEIGHTS, CORRELATION}
    if not chain.is_change:
        excluded.add(INFRARED)
    return frozenset(causes_of(chain)) - excluded


def order_of(causes: tuple[str, ...], *, rounded: bool) -> tuple[tuple[str, str], ...]:
    """Pairs of causes of which the first comes earlier."""
    order = (*((FILTERS, later) for later in causes[1:]), (WEIGHTS, CORRELATION))
    if rounded:  # what a coarse step loses depends on the noise that is rounded
        ends = (PATTERN, CROSSTALK, WEIGHTS, CORRELATION, INFRARED)
        noise = (name for name in causes[1:] if name not in (QUANTIZATION, *ends))
        order += tuple((name, QUANTIZATION) for name in noise if QUANTIZATION in causes)
    if CROSSTALK in causes:
        order += tuple((name, CROSSTALK) for name in causes if name not in (CROSSTALK, PATTERN))
        order += ((CROSSTALK, PATTERN),) if PATTERN in causes else ()
    return order


def chain_snrs_db(chain: Chain, sets: Sequence[Switches]) -> Float[Array, "*k s"]:
    """SNR of the readout for each set of causes. [dB]"""
    result = np.repeat(np.asarray(chain.photons_db)[..., None], len(sets), axis=-1)
    groups: dict[tuple[bool, ...], list[int]] = {}
    rounded = coarsely_rounded(chain)
    for i, on in enumerate(sets):
        if FILTERS in on:
            key = tuple(
                cause in on for cause in (CROSSTALK, PATTERN, INFRARED, WEIGHTS, CORRELATION)
            )
            groups.setdefault(key, []).append(i)
    for (mixed, pattern, infrared, weights, unmixed), rows in groups.items():
        before = None if mixed else chain.before_crosstalk
        channels = before or chain.channels
        seen = channels.with_infrared if infrared else channels.without_infrared
        weighted = channels.row if unmixed else channels.single_row
        row = weighted if weights else None
        coupling, noise = None, replace(chain.noise, pattern=None)
        if before is None:
            coupling = after_counting(chain.crosstalk)
            noise = chain.noise if pattern else noise
        own = [sets[i] for i in rows]
        result[..., rows] = _snrs_db(seen, row, coupling, noise, own, rounded=rounded)
    return result


def _added_e2(
    noise: NoiseSources,
    mean_e: Float[Array, "*k p"],
    sets: Sequence[Switches],
    drawn: Container[Drawn] = ALL,
) -> Float[Array, "*k s p"]:
    """Variance of sources that each set switches on, without shot noise. [e-^2]"""
    values = noise.by_source(mean_e)
    names = [one.cause for one in noise.sources if one.drawn in drawn]
    total = np.zeros((*mean_e.shape[:-1], len(sets), mean_e.shape[-1]))
    for name in names:
        if values[name].any():
            on = np.array([name in each for each in sets])
            total += on[:, None] * values[name][..., None, :]
    return total


def _snrs_db(
    seen: Seen,
    row: Float[Array, "*k p"] | None,
    coupling: Float[Array, "p p"] | None,
    noise: NoiseSources,
    sets: Sequence[Switches],
    *,
    rounded: bool,
) -> Float[Array, "*k s"]:
    """SNR of a row, or of the best linear readout where it is ``None``. [dB]"""
    if coupling is not None:
        return _coupled_snrs_db(seen, row, coupling, noise, sets)
    variance = seen.noise_e[..., None, :] + _added_e2(noise, seen.noise_e, sets)
    signal_e, sought_e = seen.signal_e[..., None, :], seen.sought_e[..., None, :]
    if rounded:  # after all other noise: `order_of`
        on = np.array([QUANTIZATION in each for each in sets])[:, None]
        share = np.where(on, rounded_share(seen, noise)[..., None, :], 1.0)
        variance = np.where(on, noise.rounded(seen.noise_e)[1][..., None, :], variance)
        signal_e, sought_e = share * signal_e, share * sought_e
    best = sought_e / np.where(variance > 0, variance, 1.0)
    rows = best if row is None else row[..., None, :]
    signal = np.abs((rows * signal_e).sum(axis=-1))
    return decibel(signal / np.sqrt((rows**2 * variance).sum(axis=-1)))


def _coupled_snrs_db(
    seen: Seen,
    row: Float[Array, "*k p"] | None,
    coupling: Float[Array, "p p"],
    noise: NoiseSources,
    sets: Sequence[Switches],
) -> Float[Array, "*k s"]:
    """The same with crosstalk after counting, which correlates the readings. [dB]"""
    counted = counted_electrons(seen.noise_e, coupling)
    inside = counted[..., None, :] + _added_e2(noise, counted, sets, ALL - READ_OUT)
    after = _added_e2(noise, counted, sets, READ_OUT)
    if row is None:
        covariance = congruence(coupling, diagonal(inside)) + diagonal(after)
        best = pinv("noise with crosstalk", covariance)
        rows = (best @ seen.sought_e[..., None, :, None])[..., 0]
    else:
        rows = row[..., None, :]
    variance = ((rows @ coupling) ** 2 * inside + rows**2 * after).sum(axis=-1)
    signal = np.abs((rows * seen.signal_e[..., None, :]).sum(axis=-1))
    return decibel(signal / np.sqrt(variance))


def gain_if_removed_db(
    chain: Chain, cause: str, on: Switches, now_db: Float[Array, " k"]
) -> Float[Array, " k"] | None:
    """SNR without a cause, and with all others, minus the SNR. [dB]"""
    less = _without(chain, cause)
    if less is None:
        return None
    return of_coordinate_db(less, chain_snrs_db(less, (on,))[:, 0]) - now_db


def _without(chain: Chain, cause: str) -> Chain | None:
    """The chain of the same sensor without crosstalk, infrared or one source of noise."""
    if cause not in (CROSSTALK, INFRARED):
        return replace(chain, noise=chain.noise.without_source(cause))
    if cause == INFRARED:
        cut = chain.behind_cut
        return None if cut is None else replace(chain, channels=cut, before_crosstalk=None)
    pure, noise = chain.before_crosstalk, replace(chain.noise, pattern=None)
    if pure is None:
        return None
    return replace(chain, channels=pure, before_crosstalk=None, noise=noise, crosstalk=None)


def of_coordinate_db(chain: Chain, snr_db: Float[Array, " k"]) -> Float[Array, " k"]:
    """SNR of the coordinate: where the signal is a change, of one unit that comes out. [dB]"""
    return snr_db - decibel(np.abs(units_that_come_out(chain))) if chain.is_change else snr_db


def units_that_come_out(chain: Chain) -> Float[Array, "*k"]:
    """How many units of the coordinate come out, where the signal is one unit. [1]"""
    seen = chain.channels.with_infrared
    share = rounded_share(seen, chain.noise) if after_counting(chain.crosstalk) is None else 1.0
    return (chain.channels.row * share * seen.signal_e).sum(axis=-1)
