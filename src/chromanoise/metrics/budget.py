"""SNR budgets: the cost per cause, from all incident photons to one color coordinate.

Causes of loss are switched on one after the other. The cost of a cause is its mean loss over
all allowed orders (Shapley value): the filters come first, the weights of the coordinate come
before the correlation of the channels, and crosstalk comes last; all others may come anywhere
between. So the costs add up exactly, and a cause without effect has a cost of 0.

Crosstalk comes last because what it does to a color is known only where everything else is known.
The best linear readout of all channels may gain by it (a channel that gets light of its neighbors
has more electrons, and after counting nothing is lost), while a color that is made of unmixed
channels loses. Averaged over orders with and without weights and unmixing, its row had the sign of
a gain where the SNR falls. Last, its row is the change of the SNR itself, and all other rows are
those of the same sensor without crosstalk: what crosstalk makes worse, as the noise that unmixing
multiplies, is in its row alone. Its fixed pattern exists only together with it, and follows it.

The gain of removing a cause is another question: the SNR of a sensor without this one cause, and
with all others, minus the SNR now. These gains do not add up: of two equal
causes each costs half of what both take, and removing one alone gains less or more than that.

============ =====================================================================================
cause        removed
============ =====================================================================================
filters      no gain is given: a sensor without filters has no color
noise source the source is 0: no read noise, no dark electrons, codes without steps
crosstalk    the channels before mixing, its fixed pattern gone, and a matrix that gives the same
             color: a kernel matrix is that of these channels. M^R is that of these channels
weights      the best linear readout, for X, Y, Z and M^R with the SNR ``optimal_linear_snr_db``
correlation  the channels weighted one by one, which is a wrong color where they overlap
infrared     an ideal IR-cut at 700 nm in front, with the same matrix; L*, a*, b* in that light
rest         its cost, as it comes last
============ =====================================================================================

============ =============================================== ==================================
cause        off                                             on
============ =============================================== ==================================
filters      every photon is an electron of every channel    the sensor's quantum efficiencies
read noise   none                                            the pixel's
crosstalk    the channels without it, the same color         light of the neighbors in each pixel
weights      the best linear readout, D^-1 mu                the coordinate's own weights h.f/|f|^2
correlation  channels weighted one by one                    channels unmixed: times G^-1
infrared     electrons from the infrared count as signal     they are noise without signal
============ =============================================== ==================================

Dark current, quantization, row noise, DSNU, PRNU, crosstalk and the pattern of crosstalk are causes
only if the sensor has them. The pattern exists in a mosaic in which pixels of one channel have
different neighbors, and only together with the cause crosstalk.

`lab_budget` goes from all photons to one unit of L*, a* or b*. A white has a* = 0, so the signal is
not a* itself but a change of it: the SNR here is one unit over the standard deviation, 1 / sigma,
to first order at a given color. The signal is a change of the light that changes this coordinate by
one and leaves the other two constant. Of all such changes `faintest_change` is used: the one with
the lowest SNR for an ideal detector that counts every photon with its wavelength. So no cause
includes a loss that no detector could avoid. Photon counting gives sqrt(p N) where the change is
the light itself, as above.

============ =============================================== ==================================
cause        off                                             on
============ =============================================== ==================================
filters      every photon is counted with its wavelength     the sensor's quantum efficiencies
read noise   none                                            the pixel's
weights      the best linear readout, D^-1 dmu               the coordinate's own weights h.f/|f|^2
correlation  channels weighted one by one                    channels unmixed: J C
infrared     an ideal IR-cut at 700 nm                       its electrons add noise
============ =============================================== ==================================

h = H J^T is the coordinate's gradient with respect to light, J the Jacobian of CIELAB at the
sensor's own mean, with the sensor's own white. The remainder, "rest", is the error of the color
matrix: the measured change is r.dmu units instead of one. A matrix that desaturates colors has a
gain here, because it scales signal and noise down together. Orders, costs and gains are computed
as above.

The infrared carries almost no signal here, because H is almost zero there.
"""

from collections.abc import Callable, Container, Sequence
from dataclasses import replace
from functools import cache
from typing import ClassVar

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    check,
    congruence,
    dataclass,
    decibel,
    defined,
    diagonal,
    inv,
    notebook,
    pinv,
    svd,
    unit_columns,
    warn_of_old_name,
)
from chromanoise.color import LAB, XYZ, ColorMatrix
from chromanoise.geometry import DualBasis, dual_frame, variance_inflation
from chromanoise.noise import (
    Exposure,
    NoiseSources,
    after_counting,
    counted_electrons,
    expected_electrons,
    exposure_factor,
    measurement_vectors,
    noise_sources,
    with_noise,
)
from chromanoise.sensor import (
    ALL,
    PATTERN,
    READ,
    READ_OUT,
    SHOT,
    SOURCES,
    Crosstalk,
    Drawn,
    Sensor,
    pixels_of,
    without_crosstalk,
)
from chromanoise.spectra import INFRARED_FROM_NM, Scene, color_axes, flat_field, is_infrared, light

Switches = frozenset[str]


def shapley_values(
    value: Callable[[Switches], float],
    players: Sequence[str],
    precedence: Sequence[tuple[str, str]] = (),
) -> dict[str, float]:
    """Each player's mean contribution to ``value`` over all allowed orders of arrival.

    Parameters
    ----------
    value
        Function from a set of players to its value.
    players
        Distinct names of the players.
    precedence
        Pairs (first, second): orders in which the second comes earlier are not allowed.

    Raises
    ------
    InputError
        If no order satisfies the precedence.

    Notes
    -----
    Shapley, "A value for n-person games", Contributions to the Theory of Games II (1953); with
    precedence Faigle & Kern, Int. J. Game Theory 21 (1992) 249-266.

    Examples
    --------
    >>> worth = {frozenset(): 0.0, frozenset("a"): 1.0, frozenset("b"): 2.0, frozenset("ab"): 5.0}
    >>> shapley_values(worth.__getitem__, "ab")
    {'a': 2.0, 'b': 3.0}
    >>> shapley_values(worth.__getitem__, "ab", precedence=[("a", "b")])
    {'a': 1.0, 'b': 4.0}
    """
    worth = cache(value)
    return {
        name: sum(share * (worth(after) - worth(after - {name})) for after, share in steps)
        for name, steps in _steps(tuple(players), tuple(precedence)).items()
    }


@cache
def allowed_sets(
    players: tuple[str, ...], precedence: tuple[tuple[str, str], ...] = ()
) -> tuple[Switches, ...]:
    """All sets of players that arrive first in some allowed order, from the empty set on.

    Parameters
    ----------
    players, precedence
        As `shapley_values`.

    Raises
    ------
    InputError
        If no order satisfies the precedence.

    Examples
    --------
    >>> [sorted(each) for each in allowed_sets(("a", "b"), (("a", "b"),))]
    [[], ['a'], ['a', 'b']]
    """
    found: dict[Switches, None] = {frozenset(): None}
    queue: list[Switches] = [frozenset()]
    needed = {name: {first for first, second in precedence if second == name} for name in players}
    for before in queue:
        for name in players:
            after = before | {name}
            if name not in before and after not in found and needed[name] <= before:
                found[after] = None
                queue.append(after)
    if frozenset(players) not in found:
        raise InputError(
            "precedence",
            f"must allow an order of {', '.join(players)}",
            value=precedence,
            found="allows none",
        )
    return tuple(found)


@cache
def _steps(
    players: tuple[str, ...], precedence: tuple[tuple[str, str], ...]
) -> dict[str, tuple[tuple[Switches, float], ...]]:
    """For each player: the sets that it completes, and the share of the orders in which it does.

    Orders are counted by the sets that they pass, instead of one by one: 11 players have 40 million
    orders, but 2,048 sets.
    """
    sets = allowed_sets(players, precedence)  # smaller sets come first
    allowed = frozenset(sets)
    ways_to = {sets[0]: 1}
    for after in sets[1:]:
        ways_to[after] = sum(ways_to[after - {n}] for n in after if after - {n} in allowed)
    ways_on = {sets[-1]: 1}
    for before in reversed(sets[:-1]):
        following = (before | {n} for n in players if n not in before)
        ways_on[before] = sum(ways_on[after] for after in following if after in allowed)
    total = ways_to[sets[-1]]
    return {
        name: tuple(
            (after, ways_to[after - {name}] * ways_on[after] / total)
            for after in sets
            if name in after and after - {name} in allowed
        )
        for name in players
    }


FILTERS, READ_NOISE, WEIGHTS = "filters", READ, "weights"
CORRELATION, INFRARED, REST = "correlation", "infrared", "rest"
CROSSTALK = "crosstalk"
CAUSES = (FILTERS, READ_NOISE, WEIGHTS, CORRELATION, INFRARED)
"""The causes of every budget; `causes_of` adds those of the sensor's own noise sources."""
_SLOPE_STEP = 1e-3
QUANTIZATION = next(one.cause for one in SOURCES if one.drawn == "rounding")


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What one cause costs as the sensor is, and what removing it would gain.

    Attributes
    ----------
    cause
        One of ``CAUSES``, a noise source of the sensor, "crosstalk", or "rest".
    cost_db
        Its Shapley value: the costs add up; negative where the cause raises the SNR. [dB]
    gain_if_removed_db
        SNR without this one cause, and with all others, minus the SNR; negative where the SNR would
        fall. The gains do not add up. ``None`` where removing it leaves no SNR, and for the
        filters. [dB]
    reading
        One sentence that explains the cost in terms of the sensor.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("cause", "cost_db", "gain_if_removed_db"),
        JsonKey("loss_db", "cost_db"),
        "reading",
    )

    cause: str
    cost_db: float
    gain_if_removed_db: float | None
    reading: str

    @property
    def loss_db(self) -> float:
        """Old name of ``cost_db``. [dB]"""
        warn_of_old_name("loss_db", "cost_db")
        return self.cost_db


@dataclass(frozen=True, kw_only=True)
class Budget:
    """The SNR budget of one coordinate, starting from all photons.

    Attributes
    ----------
    coordinate
        X, Y or Z; M^R for the contravariant coordinate of channel R; L*, a* or b*.
    photons_db
        SNR of an ideal detector that counts every photon on the p pixels with its wavelength:
        sqrt(p N) where the signal is the light itself. [dB]
    costs
        One per cause and the rest; their sum is ``photons_db`` minus ``snr_db``.
    optimal_linear_snr_db
        The best SNR of any linear readout of the real channels. [dB]
    snr_db
        SNR of the coordinate; for L*, a* and b* one unit over its standard deviation. [dB]
    """

    KEYS: ClassVar[JsonKeys] = (
        *("coordinate", "photons_db", "costs"),
        JsonKey("bound_db", "optimal_linear_snr_db"),
        "snr_db",
    )

    coordinate: str
    photons_db: float
    costs: tuple[Cost, ...]
    optimal_linear_snr_db: float
    snr_db: float

    def _repr_html_(self) -> str:
        start = ["all photons on the pixels", f"{self.photons_db:.2f}", "", "every photon counted"]
        end = [f"SNR of {self.coordinate}", f"{self.snr_db:.2f}", "", ""]
        causes = [
            [
                cost.cause,
                f"{-cost.cost_db:+.2f}",
                "" if cost.gain_if_removed_db is None else f"{cost.gain_if_removed_db:+.2f}",
                cost.reading,
            ]
            for cost in self.costs
        ]
        best = self.optimal_linear_snr_db
        return notebook.shown(
            f"Budget of {self.coordinate}; no linear readout exceeds {best:.2f} dB",
            notebook.table(["", "dB", "gain if removed [dB]", "why"], [start, *causes, end]),
        )


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

    signal_e: Float[Array, " p"]
    noise_e: Float[Array, " p"]
    is_change: bool = False

    @property
    def sought_e(self) -> Float[Array, " p"]:
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
    row: Float[Array, " p"]
    single_row: Float[Array, " p"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Chain:
    """All that the causes switch between.

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

    photons_db: float
    channels: Channels
    before_crosstalk: Channels | None
    noise: NoiseSources
    crosstalk: Crosstalk | None = None
    behind_cut: Channels | None = None


def rounded_share(seen: Seen, noise: NoiseSources) -> Float[Array, " p"]:
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


def _is_rounded(chain: Chain) -> bool:
    """Whether rounding depends on the other noise: the step of a channel exceeds its noise."""
    if after_counting(chain.crosstalk) is not None:
        return False
    return any(
        chain.noise.rounding_is_coarse(seen.noise_e).any()
        for of in (chain.channels, chain.before_crosstalk)
        if of is not None
        for seen in (of.with_infrared, of.without_infrared)
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
    values = replace(chain.noise, pattern=None).by_source(np.ones(1))
    own = {name for name in _more_noise(chain.noise) if values[name].any()}
    own |= set() if chain.noise.pattern is None else {PATTERN}
    more = tuple(name for name in _more_noise(chain.noise) if name in own)
    mixed = (CROSSTALK,) if chain.before_crosstalk is not None else ()
    end = CAUSES[2:] if infrared else CAUSES[2:-1]
    return (*CAUSES[:2], *more, *mixed, *end)


def _more_noise(noise: NoiseSources) -> list[str]:
    """The sources besides shot noise and read noise."""
    return [one.cause for one in noise.sources if one.cause not in (SHOT, READ)]


def noise_causes(chain: Chain) -> frozenset[str]:
    """The causes of the best linear readout: filters, crosstalk and all noise of the pixel.

    The infrared is a part of the signal, unless that is a change of the light.
    """
    excluded = {WEIGHTS, CORRELATION}
    if not chain.channels.with_infrared.is_change:
        excluded.add(INFRARED)
    return frozenset(causes_of(chain)) - excluded


def counting_snr_db(
    light: Float[Array, " n"], change: Float[Array, " n"], photons_per_unit_light: float
) -> float:
    """SNR of a change of light for a detector that counts every photon with its wavelength. [dB]

    Parameters
    ----------
    light
        Mean light per wavelength, >= 0; where it is 0, the change must be 0 too.
    change
        The signal, in the unit of ``light``.
    photons_per_unit_light
        Photons on all pixels together. [photons per unit of light]

    Notes
    -----
    Photon counts are independent Poisson variables, so the squared SNRs of the wavelengths add:
    sum of (k dL)^2 / (k L). For dL = L it is sqrt(k sum L), the square root of the photons.

    Examples
    --------
    >>> counting_snr_db(np.array([4.0, 0.0, 6.0]), np.array([4.0, 0.0, 6.0]), 10.0)  # 100 photons
    20.0
    """
    squares = change**2 / np.where(light > 0, light, 1.0)
    snr = np.sqrt(photons_per_unit_light * squares[light > 0].sum())
    return float(decibel(np.asarray(snr)))


def without_infrared(scene: Scene) -> Scene:
    """The same scene behind an ideal IR-cut filter at `INFRARED_FROM_NM`."""
    visible = ~is_infrared(scene.illuminant.grid)
    return replace(scene, reflectance=scene.reflectance * visible)


def chain_snr_db(chain: Chain, on: Switches) -> float:
    """SNR of the readout with the given causes switched on. [dB]"""
    return float(chain_snrs_db(chain, [on])[0])


def chain_snrs_db(chain: Chain, sets: Sequence[Switches]) -> Float[Array, " s"]:
    """SNR of the readout for each set of causes. [dB]"""
    result = np.full(len(sets), chain.photons_db)
    groups: dict[tuple[bool, ...], list[int]] = {}
    rounded = _is_rounded(chain)
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
        result[rows] = _snrs_db(seen, row, coupling, noise, own, rounded=rounded)
    return result


def _added_e2(
    noise: NoiseSources,
    mean_e: Float[Array, " p"],
    sets: Sequence[Switches],
    drawn: Container[Drawn] = ALL,
) -> Float[Array, "s p"]:
    """Variance of sources that each set switches on, without shot noise. [e-^2]"""
    values = noise.by_source(mean_e)
    names = [one.cause for one in noise.sources if one.drawn in drawn and one.cause != SHOT]
    on = np.array([[name in each for name in names] for each in sets])
    return (on[..., None] * np.stack([values[name] for name in names])).sum(axis=1)


def _snrs_db(
    seen: Seen,
    row: Float[Array, " p"] | None,
    coupling: Float[Array, "p p"] | None,
    noise: NoiseSources,
    sets: Sequence[Switches],
    *,
    rounded: bool,
) -> Float[Array, " s"]:
    """SNR of a row, or of the best linear readout where it is ``None``. [dB]"""
    if coupling is not None:
        return _coupled_snrs_db(seen, row, coupling, noise, sets)
    variance = seen.noise_e + _added_e2(noise, seen.noise_e, sets)
    signal_e, sought_e = seen.signal_e, seen.sought_e
    if rounded:  # after all other noise: `chain_budget`
        on = np.array([QUANTIZATION in each for each in sets])[:, None]
        share = np.where(on, rounded_share(seen, noise), 1.0)
        variance = np.where(on, noise.rounded(seen.noise_e)[1], variance)
        signal_e, sought_e = share * signal_e, share * sought_e
    rows = sought_e / np.where(variance > 0, variance, 1.0) if row is None else row[None]
    signal = np.abs((rows * signal_e).sum(axis=1))
    return np.asarray(decibel(signal / np.sqrt((rows**2 * variance).sum(axis=1))))


def _coupled_snrs_db(
    seen: Seen,
    row: Float[Array, " p"] | None,
    coupling: Float[Array, "p p"],
    noise: NoiseSources,
    sets: Sequence[Switches],
) -> Float[Array, " s"]:
    """The same with crosstalk after counting, which correlates the readings. [dB]"""
    counted = counted_electrons(seen.noise_e, coupling)
    inside = counted + _added_e2(noise, counted, sets, ALL - READ_OUT)
    after = _added_e2(noise, counted, sets, READ_OUT)
    if row is None:
        covariance = congruence(coupling, diagonal(inside)) + diagonal(after)
        rows = pinv("noise with crosstalk", covariance) @ seen.sought_e
    else:
        rows = row[None]
    variance = ((rows @ coupling) ** 2 * inside + rows**2 * after).sum(axis=1)
    return np.asarray(decibel(np.abs(rows @ seen.signal_e) / np.sqrt(variance)))


def chain_budget(
    chain: Chain,
    coordinate: str,
    causes: tuple[str, ...],
    readings: dict[str, str],
    *,
    snr_db: float,
    counted_infrared: bool = False,
) -> Budget:
    """The costs and gains of all causes; the difference that remains to ``snr_db`` is the rest.

    Parameters
    ----------
    chain
        The chain of ``coordinate``.
    causes
        The causes that are switched: `causes_of`.
    readings
        One sentence per cause and for "rest".
    snr_db
        As `Budget`. [dB]
    counted_infrared
        Whether the SNR counts the electrons of the infrared as signal.
    """
    order = (*((FILTERS, later) for later in causes[1:]), (WEIGHTS, CORRELATION))
    if _is_rounded(chain):  # what a coarse step loses depends on the noise that is rounded
        noise = (READ_NOISE, *_more_noise(chain.noise))
        before = (name for name in noise if name not in (QUANTIZATION, PATTERN))
        order += tuple((name, QUANTIZATION) for name in before if name in causes)
    if CROSSTALK in causes:
        order += tuple((name, CROSSTALK) for name in causes if name not in (CROSSTALK, PATTERN))
        order += ((CROSSTALK, PATTERN),) if PATTERN in causes else ()
    sets = allowed_sets(causes, order)
    worth = dict(zip(sets, chain_snrs_db(chain, sets).tolist(), strict=True))
    shares = shapley_values(worth.__getitem__, causes, order)
    rest = worth[frozenset(causes)] - snr_db
    found = {name: -shares[name] for name in causes} | {REST: rest}
    gains = _gains_db(chain, causes, counted_infrared=counted_infrared) | {REST: rest}
    return Budget(
        coordinate=coordinate,
        photons_db=chain.photons_db,
        costs=tuple(
            Cost(
                cause=name,
                cost_db=cost_db,
                gain_if_removed_db=defined(gains[name]),
                reading=readings[name],
            )
            for name, cost_db in found.items()
        ),
        optimal_linear_snr_db=chain_snr_db(chain, noise_causes(chain)),
        snr_db=snr_db,
    )


def _gains_db(
    chain: Chain, causes: tuple[str, ...], *, counted_infrared: bool
) -> dict[str, float | None]:
    """SNR without each cause, and with all others, minus the SNR. [dB]"""
    on = frozenset(causes) - ({INFRARED} if counted_infrared else set())
    now = _coordinate_snr_db(chain, on)

    def gain_db(cause: str) -> float | None:
        if cause == FILTERS:
            return None
        if cause in (WEIGHTS, CORRELATION):
            return chain_snr_db(chain, on - {cause}) - chain_snr_db(chain, on)
        less = _without(chain, cause)
        return None if less is None else _coordinate_snr_db(less, on) - now

    return {cause: gain_db(cause) for cause in causes}


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


def _coordinate_snr_db(chain: Chain, on: Switches) -> float:
    """SNR of the coordinate: where the signal is a change, of one unit that comes out. [dB]"""
    found = chain_snr_db(chain, on)
    if not chain.channels.with_infrared.is_change:
        return found
    return found - float(decibel(np.asarray(abs(_units_that_come_out(chain)))))


def _units_that_come_out(chain: Chain) -> float:
    """How many units of the coordinate come out, where the signal is one unit. [1]"""
    seen = chain.channels.with_infrared
    share = rounded_share(seen, chain.noise) if after_counting(chain.crosstalk) is None else 1.0
    return float(chain.channels.row @ (share * seen.signal_e))


def shared_readings(chain: Chain, frame: DualBasis, got: "_Electrons") -> dict[str, str]:
    """One sentence per cause that explains it in terms of the sensor.

    Parameters
    ----------
    chain, frame
        The chain and the frame of the sensor.
    got
        What the sensor gets of the scene.
    """
    all_e, visible_e, photons = got.all_e, got.visible_e, got.photons
    vif = variance_inflation(frame)
    worst = int(np.argmax(vif))
    counted = counted_electrons(all_e, after_counting(chain.crosstalk))
    sources = {**chain.noise.by_source(all_e), PATTERN: chain.noise.pattern_e2(counted)}
    variance = sum(sources.values(), 0.0 * all_e)
    whitened = np.sqrt(np.where(variance > 0, variance, 1.0))  # avoids 0 / 0
    channels = chain.channels
    best, own = channels.with_infrared.sought_e / whitened, channels.single_row * whitened
    psi = np.degrees(np.arccos(np.clip(best @ own / np.sqrt((best @ best) * (own @ own)), -1, 1)))
    infrared = 1 - visible_e.sum() / all_e.sum()
    part = {name: float(100 * each.mean() / variance.mean()) for name, each in sources.items()}
    more = {
        name: f"{part[name]:.1f} % of the mean noise variance" for name in _more_noise(chain.noise)
    }
    if _is_rounded(chain):
        before_e2 = float((variance - sources[QUANTIZATION]).mean())
        after_e2 = float(chain.noise.rounded(all_e)[1].mean())
        more[QUANTIZATION] = (
            f"rounding to steps of {chain.noise.step_e:.3g} e-, after all other noise is added, "
            f"changes the rms noise from {before_e2**0.5:.3g} to {after_e2**0.5:.3g} e-"
        )
    unmixed = (
        f"unmixing multiplies {frame.names[worst]}'s own noise by {vif[worst]:.1f} (VIF), "
        f"condition {frame.condition:.1f}, metric {frame.metric}"
    )
    if chain.crosstalk is not None and chain.before_crosstalk is not None:
        before = chain.before_crosstalk.with_infrared.noise_e
        moved = moved_share(chain.crosstalk, before)
        more[CROSSTALK] = f"{100 * moved:.1f} % of the electrons leave their channel"
    elif chain.crosstalk is not None:
        unmixed = "the crosstalk matrix is singular: its loss is in this row and in filters"
    return {
        **more,
        FILTERS: f"{100 * all_e.sum() / photons:.0f} % of the photons become electrons",
        READ_NOISE: f"{part[READ_NOISE]:.1f} % of the mean noise variance is readout",
        WEIGHTS: f"this color needs a channel mix {psi:.0f} deg from the lowest-noise one",
        CORRELATION: unmixed,
        INFRARED: f"{100 * infrared:.0f} % of the electrons come from beyond "
        f"{INFRARED_FROM_NM:.0f} nm",
    }


def moved_share(crosstalk: Crosstalk, before_e: Float[Array, " p"]) -> float:
    """Share of the electrons that crosstalk moves to other channels or loses. [1]

    Parameters
    ----------
    before_e
        Electrons of one pixel of each channel without it. [e-]

    Examples
    --------
    Channels that exchange a tenth of equal light: each ends with what it had.

    >>> exchange = Crosstalk(matrix=np.array([[0.9, 0.1], [0.1, 0.9]]), pixels=(1, 1))
    >>> round(moved_share(exchange, np.array([50.0, 50.0])), 12)
    0.1
    """
    electrons = np.asarray(crosstalk.pixels) * before_e
    return float(1.0 - np.diagonal(crosstalk.matrix) @ electrons / electrons.sum())


def color_budget(
    scene: Scene, sensor: Sensor, exposure: Exposure, matrix: ColorMatrix, coordinate: str = "Y"
) -> Budget | None:
    """The budget of one color coordinate of a kernel matrix, or ``None`` where it has no SNR.

    Parameters
    ----------
    scene
        A scene of one point (`flat_field`).
    sensor, exposure
        The sensor and its exposure settings.
    matrix
        The kernel matrix of that sensor and exposure (eq. 6).
    coordinate
        X, Y or Z.

    Raises
    ------
    InputError
        If the matrix has no such coordinate, or its channels are not the sensor's.
    """
    check.among("coordinate", coordinate, matrix.coordinates)
    check.same_names("budget", sensor=sensor.names, matrix=matrix.channels)
    i = matrix.coordinates.index(coordinate)
    got = _electrons(scene, sensor, exposure)
    axis = color_axes(sensor.grid, matrix.metric, matrix.observer)[:, i]

    def channels(of_sensor: Sensor, frame: DualBasis, row: Float[Array, " p"]) -> Channels:
        of = _electrons(scene, of_sensor, exposure)
        return Channels(
            without_infrared=_seen(of.all_e),
            with_infrared=Seen(signal_e=of.visible_e, noise_e=of.all_e),
            row=row,
            single_row=weights_one_by_one(axis, frame),
        )

    row = matrix.matrix[i]
    chain = _chain(sensor, exposure, matrix.frame, row, channels, got.photons_db)
    own, cut = chain.channels, _seen(got.visible_e)
    chain = replace(chain, behind_cut=replace(own, without_infrared=cut, with_infrared=cut))
    usable = (own.row @ got.all_e, own.row @ got.visible_e, own.single_row @ got.visible_e)
    if not min(usable) > 0:
        return None
    causes = causes_of(chain)
    readings = shared_readings(chain, matrix.frame, got)
    all_light = chain_snr_db(chain, frozenset(causes) - {INFRARED})  # at the end all is signal
    rest_db = chain_snr_db(chain, frozenset(causes)) - all_light
    passed = round(100 * (1 - 10 ** (rest_db / 20)), 1) + 0.0  # avoids -0.0
    readings[REST] = f"{passed:.1f} % of {coordinate} is infrared that the matrix lets through"
    return chain_budget(
        chain,
        coordinate,
        causes,
        readings,
        snr_db=all_light,
        counted_infrared=True,
    )


def contravariant_budget(
    scene: Scene, sensor: Sensor, exposure: Exposure, frame: DualBasis, channel: str
) -> Budget | None:
    """The budget of one contravariant coordinate, or ``None`` where it is undefined.

    Here infrared light counts as signal, and "weights" is the step from the best linear readout of
    all channels to this channel alone.

    Parameters
    ----------
    scene
        A scene of one point (`flat_field`).
    sensor, exposure
        The sensor and its exposure settings.
    frame
        The frame of that sensor and exposure.
    channel
        Name of the channel.

    Raises
    ------
    InputError
        If there is no such channel, or the channels of the frame differ from the sensor's.
    """
    check.among("channel", channel, sensor.names)
    check.same_names("budget", sensor=sensor.names, frame=frame.names)
    i = sensor.names.index(channel)
    got = _electrons(scene, sensor, exposure)

    def channels(of_sensor: Sensor, own: DualBasis, _: Array) -> Channels:
        seen = _seen(_electrons(scene, of_sensor, exposure).all_e)
        return Channels(
            without_infrared=seen,
            with_infrared=seen,
            row=own.inverse_gram[i],
            single_row=np.eye(len(sensor.names))[i],
        )

    chain = _chain(sensor, exposure, frame, frame.inverse_gram, channels, got.photons_db)
    if not (np.isfinite(variance_inflation(frame)[i]) and _has_signal(chain.channels, i)):
        return None
    pure = chain.before_crosstalk
    unknown = pure is not None and not _has_signal(pure, i, least=_ROUNDING)
    chain = replace(chain, before_crosstalk=None) if unknown else chain
    causes = causes_of(chain, infrared=False)
    readings = shared_readings(chain, frame, got)
    if unknown:
        readings[CORRELATION] = (
            f"without crosstalk M^{channel} has no SNR: its loss is in this row and in filters"
        )
    readings[WEIGHTS] = f"{channel} alone, of all {len(sensor.names)} channels"
    readings[REST] = "nothing is left"
    return chain_budget(
        chain,
        f"M^{channel}",
        causes,
        readings,
        snr_db=chain_snr_db(chain, frozenset(causes)),
    )


def _has_signal(of: Channels, i: int, *, least: float = 0.0) -> bool:
    """Whether a contravariant coordinate, and its channel alone, have a signal.

    ``least`` is the share of all electrons that a channel must exceed.
    """
    electrons = of.with_infrared.signal_e
    return bool(of.row @ electrons != 0 and electrons[i] > least * electrons.sum())


def weights_one_by_one(axis: Float[Array, " n"], frame: DualBasis) -> Float[Array, " p"]:
    """Weights of the channels for ``axis``, h.f / |f|^2, neglecting the overlap of the channels.

    Examples
    --------
    >>> from chromanoise.geometry import dual_frame
    >>> f = np.array([[2.0, 0.0], [0.0, 1.0]])
    >>> weights_one_by_one(np.ones(2), dual_frame(f, names=("a", "b"), metric="quanta"))
    array([0.5, 1. ])
    """
    return axis @ frame.basis / (frame.basis**2).sum(axis=0)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Electrons:
    """Light of a scene, and the electrons that the channels collect from it.

    Attributes
    ----------
    light
        Photons, in the unit of `chromanoise.spectra.light`.
    photons_per_unit_light
        Photons on the pixels of all channels, p k of eq. 2; k for channels that are stacked on one
        pixel. [s um2 nm]
    all_e, visible_e
        Mean electrons with and without the infrared. [e-]
    """

    light: Float[Array, " n"]
    photons_per_unit_light: float
    all_e: Float[Array, " p"]
    visible_e: Float[Array, " p"]

    @property
    def photons(self) -> float:
        """Photons on all pixels together."""
        return self.photons_per_unit_light * float(self.light.sum())

    @property
    def photons_db(self) -> float:
        """Their SNR. [dB]"""
        return counting_snr_db(self.light, self.light, self.photons_per_unit_light)


def _electrons(scene: Scene, sensor: Sensor, exposure: Exposure) -> _Electrons:
    per_pixel = exposure_factor(exposure, sensor.pixel, sensor.grid.step_nm)
    return _Electrons(
        light=light(scene, "quanta"),
        photons_per_unit_light=pixels_of(sensor) * per_pixel,
        all_e=expected_electrons(scene, sensor, exposure),
        visible_e=expected_electrons(without_infrared(scene), sensor, exposure),
    )


def _seen(electrons: Float[Array, " p"]) -> Seen:
    return Seen(signal_e=electrons, noise_e=electrons)


def _chain(
    sensor: Sensor,
    exposure: Exposure,
    frame: DualBasis,
    rows: Array,
    channels: Callable[[Sensor, DualBasis, Array], Channels],
    photons_db: float,
) -> Chain:
    """The chain of the sensor, and of the same without crosstalk: R X gives the same color."""
    crosstalk, before = sensor.crosstalk, None
    pure = without_crosstalk(sensor) if crosstalk is not None else None
    if crosstalk is not None and pure is not None:
        basis = measurement_vectors(pure, exposure, frame.metric)
        own = dual_frame(basis, names=pure.names, metric=frame.metric)
        before = channels(pure, own, rows @ crosstalk.matrix)
    return Chain(
        photons_db=photons_db,
        channels=channels(sensor, frame, rows),
        before_crosstalk=before,
        noise=noise_sources(sensor, exposure),
        crosstalk=crosstalk,
    )


_ROUNDING = 1e-10  # of the sum of absolute terms: below, a sum is rounding


def faintest_change(
    light: Float[Array, " n"], axes: Float[Array, "n c"], step: Float[Array, " c"]
) -> Float[Array, " n"] | None:
    """The change of light with the lowest photon-counting SNR that changes a color by ``step``.

    Parameters
    ----------
    light
        L, mean photons per wavelength, >= 0.
    axes
        H, one column per color coordinate.
    step
        dx, the change of the color H^T L.

    Returns
    -------
    change
        dL, in the unit of ``light``; ``None`` where changes of the light cannot change all
        coordinates independently.

    Raises
    ------
    InputError
        If an entry of ``light`` is negative or not finite.

    Notes
    -----
    Photon counting detects dL with SNR^2 ~ sum dL^2 / L. Lagrange: the least such sum under
    H^T dL = dx has 2 dL / L = H lambda, so dL = L * (H (H^T diag(L) H)^-1 dx). It is computed as
    the shortest vector dL / sqrt(L) by singular values.

    Examples
    --------
    >>> lamp = np.array([4.0, 0.0, 1.0])
    >>> faintest_change(lamp, np.ones((3, 1)), np.array([5.0])).round(12)     # the light itself
    array([4., 0., 1.])
    """
    root = np.sqrt(check.non_negative("light", "photons", light))
    directions, lengths = unit_columns(axes * root[:, None])
    u, singular, vt = svd("axes of color in light", directions, full_matrices=False)
    rank = int((singular > RANK_TOLERANCE * singular[0]).sum())
    if rank < axes.shape[1]:
        return None
    return root * (u @ ((vt @ (step / lengths)) / singular))


def lab_budget(
    scene: Scene, sensor: Sensor, exposure: Exposure, matrix: ColorMatrix, coordinate: str = "a*"
) -> Budget | None:
    """The budget of L*, a* or b* of one point, or ``None`` where it is undefined.

    It is undefined where X, Y or Z of the sensor's white is not above 0, where changes of the light
    cannot change the three coordinates independently, or where the measured change is zero or has
    the opposite sign: a single channel has no a*, and a matrix may reverse a change.

    Parameters
    ----------
    scene
        A scene of one point, e.g. a gray (`flat_field`); its white is a perfect white in the same
        light.
    sensor, exposure
        The sensor and its exposure settings.
    matrix
        Any color matrix to X, Y, Z; "correlation" is the step from weights that neglect the
        overlap of the channels to this matrix.
    coordinate
        L*, a* or b*.

    Raises
    ------
    InputError
        If there is no such coordinate, the rows of the matrix are not X, Y, Z, or its channels are
        not those of the sensor.

    Notes
    -----
    First order: sigma^2 = r D r^T with r = J C (JCGM 102:2011, 6.2), as
    `chromanoise.color.first_order`.
    """
    check.one_of("coordinate", coordinate, LAB.coordinates)
    check.same_names("budget", sensor=sensor.names, matrix=matrix.channels)
    check.same_names("budget in CIELAB", needed=XYZ, matrix=matrix.coordinates)
    white_scene = flat_field(scene.illuminant, level_lux=scene.level_lux)
    white = matrix.matrix @ expected_electrons(white_scene, sensor, exposure)
    if not (white > 0).all():
        return None
    i, got = LAB.coordinates.index(coordinate), _electrons(scene, sensor, exposure)
    slopes = LAB.jacobian(matrix.matrix @ got.all_e, white)
    slope, axes = slopes[i], color_axes(sensor.grid, "quanta", matrix.observer)
    step = inv(f"slope of {coordinate} of {sensor.name}", slopes)[:, i]
    change = faintest_change(got.light, axes, step)
    if change is None:
        return None

    def channels(of_sensor: Sensor, frame: DualBasis, rows: Float[Array, "3 p"]) -> Channels:
        basis = measurement_vectors(of_sensor, exposure, "quanta")
        visible = ~is_infrared(sensor.grid)
        cut, whole = (change * visible) @ basis, change @ basis
        noise_e, visible_e = got.light @ basis, (got.light * visible) @ basis
        axes = color_axes(sensor.grid, frame.metric, matrix.observer)
        one_by_one = [weights_one_by_one(axis, frame) for axis in axes.T]
        return Channels(
            without_infrared=Seen(signal_e=cut, noise_e=visible_e, is_change=True),
            with_infrared=Seen(signal_e=whole, noise_e=noise_e, is_change=True),
            row=_sum_of(slope[:, None] * rows),
            single_row=_sum_of(slope[:, None] * np.stack(one_by_one)),
        )

    photons_db = counting_snr_db(got.light, change, got.photons_per_unit_light)
    chain = _chain(sensor, exposure, matrix.frame, matrix.matrix, channels, photons_db)
    if not _followed(chain):
        return None
    row, seen = chain.channels.row, chain.channels.without_infrared
    white_cut = matrix.matrix @ expected_electrons(without_infrared(white_scene), sensor, exposure)
    if (white_cut > 0).all():
        slope_cut = LAB.jacobian(matrix.matrix @ got.visible_e, white_cut)[i]
        row_cut = _sum_of(slope_cut[:, None] * matrix.matrix)
        cut = replace(chain.channels, with_infrared=seen, row=row_cut)
        chain = replace(chain, behind_cut=cut)
    noise = with_noise(got.all_e, sensor, exposure).covariance
    readings = shared_readings(chain, matrix.frame, got)
    colorimeter = got.photons_per_unit_light / ((axes @ slope) ** 2 @ got.light)
    pays_db = photons_db - 10 * float(np.log10(colorimeter))
    readings[WEIGHTS] += f"; a perfect colorimeter pays {pays_db:.1f} dB"
    units = _units_that_come_out(chain)
    readings[REST] = f"one unit of {coordinate} comes out as {units:.2f}"
    return chain_budget(
        chain,
        coordinate,
        causes_of(chain),
        readings,
        snr_db=-10 * float(np.log10(row @ noise @ row)),
    )


def _sum_of(terms: Float[Array, "c p"]) -> Float[Array, " p"]:
    """Their sum; 0 where they cancel to rounding, as X/Xn - Y/Yn does for a single channel."""
    total = terms.sum(axis=0)
    return np.where(np.abs(total) > _ROUNDING * np.abs(terms).sum(axis=0), total, 0.0)


def _followed(chain: Chain) -> bool:
    """Whether the coordinate follows the change, and every readout of the chain detects it.

    Weights that neglect the overlap of channels may reverse the sign; only the size counts there.
    """
    of = chain.channels
    signals = np.stack([of.without_infrared.signal_e, of.with_infrared.signal_e], axis=1)
    own, single = (_sum_of(row[:, None] * signals) for row in (of.row, of.single_row))
    return bool((own > 0).all() and (single != 0).all())
