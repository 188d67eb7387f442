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

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Bool,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    check,
    dataclass,
    decibel,
    defined,
    inv,
    notebook,
    svd,
    unit_columns,
    variances_along,
    warn_of_old_name,
)
from chromanoise.color import LAB, XYZ, ColorMatrix
from chromanoise.geometry import DualBasis, dual_frame, variance_inflation
from chromanoise.metrics.shapley import allowed_sets, shapley_of_many
from chromanoise.metrics.snr_chain import (
    CORRELATION,
    CROSSTALK,
    FILTERS,
    INFRARED,
    QUANTIZATION,
    READ_NOISE,
    REST,
    WEIGHTS,
    Chain,
    Channels,
    Seen,
    causes_of,
    chain_snrs_db,
    coarsely_rounded,
    gain_if_removed_db,
    may_be_rounded,
    merged,
    more_noise,
    noise_causes,
    of_coordinate_db,
    order_of,
    units_that_come_out,
)
from chromanoise.noise import (
    Exposure,
    after_counting,
    counted_electrons,
    exposure_factor,
    measurement_vectors,
    noise_sources,
    refuse_other_grid,
    with_noise,
)
from chromanoise.sensor import (
    PATTERN,
    Crosstalk,
    Sensor,
    pixels_of,
    without_crosstalk,
)
from chromanoise.spectra import (
    INFRARED_FROM_NM,
    Scene,
    color_axes,
    flat_field,
    is_infrared,
    light as scene_light,
)


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


def counting_snr_db(
    light: Float[Array, " n"], change: Float[Array, "*k n"], photons_per_unit_light: float
) -> Float[Array, "*k"]:
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
    >>> lamp = np.array([4.0, 0.0, 6.0])
    >>> float(counting_snr_db(lamp, lamp, 10.0))        # 100 photons
    20.0
    """
    squares = change**2 / np.where(light > 0, light, 1.0)
    photons = photons_per_unit_light * squares[..., light > 0].sum(axis=-1)
    return decibel(np.asarray(np.sqrt(photons)))


def without_infrared(scene: Scene) -> Scene:
    """The same scene behind an ideal IR-cut filter at `INFRARED_FROM_NM`."""
    visible = ~is_infrared(scene.illuminant.grid)
    return replace(scene, reflectance=scene.reflectance * visible)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Lit:
    """A sensor in one light: what all its budgets share."""

    scene: Scene
    sensor: Sensor
    exposure: Exposure

    def __post_init__(self) -> None:
        refuse_other_grid(self.scene, self.sensor)

    @cached_property
    def light(self) -> Float[Array, " n"]:
        """Photons, in the unit of `chromanoise.spectra.light`."""
        return scene_light(self.scene, "quanta")

    @property
    def is_visible(self) -> Bool[Array, " n"]:
        """The wavelengths that an ideal IR-cut passes."""
        return ~is_infrared(self.sensor.grid)

    @cached_property
    def basis(self) -> Float[Array, "n p"]:
        """F of eq. 3, of photons. [e- per unit of light]"""
        return measurement_vectors(self.sensor, self.exposure, "quanta")

    @cached_property
    def all_e(self) -> Float[Array, " p"]:
        """Mean electrons. [e-]"""
        return self.light @ self.basis

    @cached_property
    def visible_e(self) -> Float[Array, " p"]:
        """Mean electrons without the infrared. [e-]"""
        return (self.light * self.is_visible) @ self.basis

    @cached_property
    def photons_per_unit_light(self) -> float:
        """Photons on the pixels of all channels, p k of eq. 2; k for channels that are stacked on
        one pixel. [s um2 nm]
        """
        pixel, step_nm = self.sensor.pixel, self.sensor.grid.step_nm
        return pixels_of(self.sensor) * exposure_factor(self.exposure, pixel, step_nm)

    @property
    def photons_db(self) -> Float[Array, ""]:
        """SNR of the photons on all pixels. [dB]"""
        return counting_snr_db(self.light, self.light, self.photons_per_unit_light)

    @cached_property
    def pure(self) -> "_Lit | None":
        """The sensor without crosstalk; ``None`` if it has none, or an unknown one."""
        found = None if self.sensor.crosstalk is None else without_crosstalk(self.sensor)
        return None if found is None else replace(self, sensor=found)


def weights_one_by_one(axis: Float[Array, "*c n"], frame: DualBasis) -> Float[Array, "*c p"]:
    """Weights of the channels for ``axis``, h.f / |f|^2, neglecting the overlap of the channels.

    Examples
    --------
    >>> from chromanoise.geometry import dual_frame
    >>> f = np.array([[2.0, 0.0], [0.0, 1.0]])
    >>> weights_one_by_one(np.ones(2), dual_frame(f, names=("a", "b"), metric="quanta"))
    array([0.5, 1. ])
    """
    return axis @ frame.basis / (frame.basis**2).sum(axis=0)


def _seen(electrons: Float[Array, "*c p"]) -> Seen:
    return Seen(signal_e=electrons, noise_e=electrons)


def _repeated(electrons: Float[Array, " p"], rows: Float[Array, "c p"]) -> Float[Array, "c p"]:
    return np.broadcast_to(electrons, (len(rows), electrons.size))


def _chosen(names: Sequence[str], keep: Bool[Array, " c"]) -> tuple[str, ...]:
    return tuple(name for name, kept in zip(names, keep, strict=True) if kept)


def _of_some(chain: Chain, keep: Bool[Array, " c"]) -> Chain:
    """The chain of some of its coordinates."""
    return chain if keep.all() else merged(lambda arrays: arrays[0][keep], chain)


def _chain(
    lit: _Lit,
    frame: DualBasis,
    rows: Array,
    channels: Callable[[_Lit, DualBasis, Array], Channels],
    photons_db: Float[Array, "*c"],
) -> Chain:
    """The chain of the sensor, and of the same without crosstalk: R X gives the same color."""
    sensor, exposure, pure, before = lit.sensor, lit.exposure, lit.pure, None
    if sensor.crosstalk is not None and pure is not None:
        basis = measurement_vectors(pure.sensor, exposure, frame.metric)
        own = dual_frame(basis, names=pure.sensor.names, metric=frame.metric)
        before = channels(pure, own, rows @ sensor.crosstalk.matrix)
    found = channels(lit, frame, rows)
    return Chain(
        photons_db=np.broadcast_to(photons_db, len(found.row)),
        channels=found,
        before_crosstalk=before,
        noise=noise_sources(sensor, exposure),
        crosstalk=sensor.crosstalk,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Asked:
    """Coordinates of one sensor whose budgets have the same causes.

    Attributes
    ----------
    coordinates
        Their names, as those of the leading axis of the chain.
    readings
        One sentence per cause.
    own_readings
        Those of each coordinate.
    rest_reading
        The sentence of "rest", of the index of a coordinate and of the rest in dB.
    snr_db
        SNR of each coordinate where the chain does not end there: where the signal is a change.
        [dB]
    has_infrared
        Whether the infrared is a cause.
    """

    coordinates: tuple[str, ...]
    chain: Chain
    readings: dict[str, str]
    own_readings: Sequence[dict[str, str]]
    rest_reading: Callable[[int, float], str]
    snr_db: Float[Array, " c"] | None = None
    has_infrared: bool = True

    @cached_property
    def causes(self) -> tuple[str, ...]:
        """Those that are switched."""
        return causes_of(self.chain, infrared=self.has_infrared)

    @cached_property
    def is_rounded(self) -> bool:
        """Whether quantization comes after all other noise."""
        return coarsely_rounded(self.chain)

    @property
    def structure(self) -> tuple[Any, ...]:
        """What chains that are evaluated together have in common."""
        chain = self.chain
        # the digits of a rounded mean depend on the others
        alone = id(chain) if may_be_rounded(chain) else 0
        own_class = bool(chain.noise.pixel.own_noise)  # of a user, which may compare as it likes
        return (
            *(self.causes, alone, chain.is_change, chain.behind_cut is None),
            chain.channels.row.shape[-1],
            id(chain.noise) if own_class else chain.noise,
            id(chain.crosstalk),
        )


@np.errstate(divide="ignore", invalid="ignore")  # an SNR of 0 or infinity has no gain
def _budgets(asked: Sequence[_Asked]) -> list[dict[str, Budget]]:
    """The budgets of each, which have one structure: costs, gains, and the rest to the SNR."""
    first = asked[0]
    chain = merged(np.concatenate, *(one.chain for one in asked))
    causes, every = first.causes, frozenset(first.causes)
    order = order_of(causes, rounded=first.is_rounded)
    sets = allowed_sets(causes, order)
    on = every if chain.is_change else every - {INFRARED}  # infrared is signal at the end
    further = (on, on - {WEIGHTS}, on - {CORRELATION}, noise_causes(chain))
    worth = chain_snrs_db(chain, (*sets, *further))
    ends_db, now_db, no_weights_db, uncorrelated_db, best_db = worth[:, len(sets) - 1 :].T
    snr_db = now_db
    if first.snr_db is not None:
        snr_db = np.concatenate([one.snr_db for one in asked if one.snr_db is not None])
    rest_db = ends_db - snr_db
    costs_db = np.column_stack([-shapley_of_many(worth[:, : len(sets)], causes, order), rest_db])
    known = {
        FILTERS: None,
        WEIGHTS: no_weights_db - now_db,
        CORRELATION: uncorrelated_db - now_db,
        REST: rest_db,
    }
    sought_db = of_coordinate_db(chain, now_db)
    gains_db = [
        known[name] if name in known else gain_if_removed_db(chain, name, on, sought_db)
        for name in (*causes, REST)
    ]
    gains = [[None] * len(snr_db) if one is None else one.tolist() for one in gains_db]
    numbers = zip(
        *(chain.photons_db.tolist(), costs_db.tolist(), zip(*gains, strict=True)),
        *(best_db.tolist(), snr_db.tolist()),
        strict=True,
    )
    return [
        {name: _made(one, i, *next(numbers)) for i, name in enumerate(one.coordinates)}
        for one in asked
    ]


def _made(
    asked: _Asked,
    i: int,
    photons_db: float,
    costs_db: Sequence[float],
    gains_db: Sequence[float | None],
    optimal_linear_snr_db: float,
    snr_db: float,
) -> Budget:
    """The budget of one of the coordinates."""
    rest = {REST: asked.rest_reading(i, costs_db[-1])}
    readings = asked.readings | asked.own_readings[i] | rest
    return Budget(
        coordinate=asked.coordinates[i],
        photons_db=photons_db,
        costs=tuple(
            Cost(
                cause=name,
                cost_db=cost_db,
                gain_if_removed_db=defined(gain_db),
                reading=readings[name],
            )
            for name, cost_db, gain_db in zip(
                (*asked.causes, REST), costs_db, gains_db, strict=True
            )
        ),
        optimal_linear_snr_db=optimal_linear_snr_db,
        snr_db=snr_db,
    )


def _readings(
    chain: Chain, frame: DualBasis, lit: _Lit
) -> tuple[dict[str, str], list[dict[str, str]]]:
    """One sentence per cause that explains it in terms of the sensor; those of each coordinate."""
    all_e = lit.all_e
    vif = variance_inflation(frame)
    worst = int(np.argmax(vif))
    counted = counted_electrons(all_e, after_counting(chain.crosstalk))
    sources = {**chain.noise.by_source(all_e), PATTERN: chain.noise.pattern_e2(counted)}
    values = np.stack(list(sources.values()))
    variance = values.sum(axis=0)
    whitened = np.sqrt(np.where(variance > 0, variance, 1.0))  # avoids 0 / 0
    channels = chain.channels
    best, own = channels.with_infrared.sought_e / whitened, channels.single_row * whitened
    cosine = (best * own).sum(axis=-1) / np.sqrt((best**2).sum(axis=-1) * (own**2).sum(axis=-1))
    psi = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    collected = all_e.sum()
    passed = collected / (lit.photons_per_unit_light * lit.light.sum())
    infrared = 1 - lit.visible_e.sum() / collected
    part = dict(zip(sources, (100 * values.sum(axis=1) / variance.sum()).tolist(), strict=True))
    more = {
        name: f"{part[name]:.1f} % of the mean noise variance" for name in more_noise(chain.noise)
    }
    if coarsely_rounded(chain):
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
        before = chain.before_crosstalk.with_infrared.noise_e[0]
        moved = moved_share(chain.crosstalk, before)
        more[CROSSTALK] = f"{100 * moved:.1f} % of the electrons leave their channel"
    elif chain.crosstalk is not None:
        unmixed = "the crosstalk matrix is singular: its loss is in this row and in filters"
    shared = {
        **more,
        FILTERS: f"{100 * passed:.0f} % of the photons become electrons",
        READ_NOISE: f"{part[READ_NOISE]:.1f} % of the mean noise variance is readout",
        CORRELATION: unmixed,
        INFRARED: f"{100 * infrared:.0f} % of the electrons come from beyond "
        f"{INFRARED_FROM_NM:.0f} nm",
    }
    text = "this color needs a channel mix {:.0f} deg from the lowest-noise one"
    return shared, [{WEIGHTS: text.format(each)} for each in psi.tolist()]


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


CONTRAVARIANT = "M^"
"""What the name of a contravariant coordinate begins with, before that of its channel."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BudgetRequest:
    """Coordinates whose budgets are asked for, of one sensor in one light.

    Attributes
    ----------
    scene
        A scene of one point (`flat_field`); for L*, a* and b* e.g. a gray, whose white is a perfect
        white in the same light.
    sensor, exposure
        The sensor and its exposure settings.
    matrix
        Its color matrix: the kernel matrix of that sensor and exposure (eq. 6), or for L*, a* and
        b* any matrix to X, Y, Z.
    coordinates
        Names of color coordinates of the matrix, contravariant coordinates as M^R, or L*, a*, b*.

    Raises
    ------
    InputError
        If the scene has several points, there is no such coordinate, the channels of the matrix are
        not those of the sensor, or for L*, a* and b* its coordinates are not X, Y, Z.
    """

    scene: Scene
    sensor: Sensor
    exposure: Exposure
    matrix: ColorMatrix
    coordinates: tuple[str, ...]

    def __post_init__(self) -> None:
        points = self.scene.reflectance.shape[:-1]
        if points:
            need, found = "must have one point", f"has {' x '.join(map(str, points))} points"
            raise InputError("scene of a budget", need, value=points, found=found)
        check.same_names("budget", sensor=self.sensor.names, matrix=self.matrix.channels)
        every = (
            *self.matrix.coordinates,
            *LAB.coordinates,
            *(f"{CONTRAVARIANT}{name}" for name in self.sensor.names),
        )
        for one in self.coordinates:
            check.among("coordinate", one, every)
        if set(self.coordinates) & set(LAB.coordinates):
            check.same_names("budget in CIELAB", needed=XYZ, matrix=self.matrix.coordinates)


def budgets_of(requests: Sequence[BudgetRequest]) -> list[dict[str, Budget]]:
    """The budgets of each request by coordinate, computed at once, without those that have none.

    A color coordinate has none where it has no SNR, a contravariant coordinate where its channel is
    a mix of others or has no light. L*, a* or b* has none where X, Y or Z of the sensor's white is
    not above 0, where changes of the light cannot change the three coordinates independently, or
    where the measured change is zero or has the opposite sign: a single channel has no a*, and a
    matrix may reverse a change.

    Parameters
    ----------
    requests
        Sensors, in their light, and coordinates.

    Notes
    -----
    L*, a* and b* to first order: sigma^2 = r D r^T with r = J C (JCGM 102:2011, 6.2), as
    `chromanoise.color.first_order`.
    """
    found: list[dict[str, Budget]] = [{} for _ in requests]
    groups: dict[tuple[Any, ...], list[tuple[dict[str, Budget], _Asked]]] = {}
    for own, request in zip(found, requests, strict=True):
        for one in _asked(request):
            groups.setdefault(one.structure, []).append((own, one))
    for group in groups.values():
        first = group[0][1]
        order = order_of(first.causes, rounded=first.is_rounded)
        size = first.chain.channels.row.size * len(allowed_sets(first.causes, order))
        step = max(1, _VALUES_PER_CHUNK // size)
        for i in range(0, len(group), step):
            part = group[i : i + step]
            for (own, _), made in zip(part, _budgets([one for _, one in part]), strict=True):
                own.update(made)
    return found


_VALUES_PER_CHUNK = 100_000  # they stay in the processor's cache


def _asked(request: BudgetRequest) -> Iterator[_Asked]:
    """The coordinates of a request that have a budget, with their chains."""
    lit = _Lit(scene=request.scene, sensor=request.sensor, exposure=request.exposure)
    names, matrix = request.coordinates, request.matrix
    if lab := [LAB.coordinates.index(name) for name in names if name in LAB.coordinates]:
        yield from _lab_asked(lit, matrix, lab)
    if colors := [matrix.coordinates.index(name) for name in names if name in matrix.coordinates]:
        yield from _color_asked(lit, matrix, colors)
    channels = [
        i for i, name in enumerate(request.sensor.names) if f"{CONTRAVARIANT}{name}" in names
    ]
    if channels:
        yield from _contravariant_asked(lit, matrix.frame, channels)


def _budget(
    scene: Scene, sensor: Sensor, exposure: Exposure, matrix: ColorMatrix, coordinate: str
) -> Budget | None:
    request = BudgetRequest(
        scene=scene, sensor=sensor, exposure=exposure, matrix=matrix, coordinates=(coordinate,)
    )
    return budgets_of([request])[0].get(coordinate)


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
    return _budget(scene, sensor, exposure, matrix, coordinate)


def _color_asked(lit: _Lit, matrix: ColorMatrix, index: Sequence[int]) -> Iterator[_Asked]:
    axes = color_axes(lit.sensor.grid, matrix.metric, matrix.observer)[:, index]

    def channels(of: _Lit, frame: DualBasis, rows: Float[Array, "c p"]) -> Channels:
        all_e, visible_e = _repeated(of.all_e, rows), _repeated(of.visible_e, rows)
        return Channels(
            without_infrared=_seen(all_e),
            with_infrared=Seen(signal_e=visible_e, noise_e=all_e),
            row=rows,
            single_row=weights_one_by_one(axes.T, frame),
        )

    chain = _chain(lit, matrix.frame, matrix.matrix[index], channels, lit.photons_db)
    own = chain.channels
    cut = _seen(own.with_infrared.signal_e)
    chain = replace(chain, behind_cut=replace(own, without_infrared=cut, with_infrared=cut))
    usable = (own.row @ lit.all_e, own.row @ lit.visible_e, own.single_row @ lit.visible_e)
    names = [matrix.coordinates[i] for i in index]

    def rest_reading(i: int, rest_db: float) -> str:
        passed = round(100 * (1 - 10 ** (rest_db / 20)), 1) + 0.0  # avoids -0.0
        return f"{passed:.1f} % of {chosen[i]} is infrared that the matrix lets through"

    keep = np.min(usable, axis=0) > 0
    chosen = _chosen(names, keep)
    if chosen:
        chain = _of_some(chain, keep)
        readings, own_readings = _readings(chain, matrix.frame, lit)
        yield _Asked(
            coordinates=chosen,
            chain=chain,
            readings=readings,
            own_readings=own_readings,
            rest_reading=rest_reading,
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
    lit = _Lit(scene=scene, sensor=sensor, exposure=exposure)
    asked = _contravariant_asked(lit, frame, [sensor.names.index(channel)])
    return next((budget for one in asked for budget in _budgets([one])[0].values()), None)


def _contravariant_asked(lit: _Lit, frame: DualBasis, index: Sequence[int]) -> Iterator[_Asked]:
    names = lit.sensor.names

    def channels(of: _Lit, own: DualBasis, _: Array) -> Channels:
        row = own.inverse_gram[index]
        seen = _seen(_repeated(of.all_e, row))
        return Channels(
            without_infrared=seen,
            with_infrared=seen,
            row=row,
            single_row=np.eye(len(names))[index],
        )

    chain = _chain(lit, frame, frame.inverse_gram, channels, lit.photons_db)
    is_defined = np.isfinite(variance_inflation(frame)[index]) & _has_signal(chain.channels)
    pure = chain.before_crosstalk
    known = np.ones(len(index), dtype=bool)
    if pure is not None:
        known = _has_signal(pure, least=_ROUNDING)
    for is_known in (True, False):
        keep = is_defined & (known == is_known)
        chosen = _chosen([names[i] for i in index], keep)
        if not chosen:
            continue
        some = _of_some(chain, keep)
        some = some if is_known else replace(some, before_crosstalk=None)
        readings, own_readings = _readings(some, frame, lit)
        for name, own in zip(chosen, own_readings, strict=True):
            own[WEIGHTS] = f"{name} alone, of all {len(names)} channels"
            if not is_known:
                own[CORRELATION] = (
                    f"without crosstalk {CONTRAVARIANT}{name} has no SNR: its loss is in this row "
                    "and in filters"
                )
        yield _Asked(
            coordinates=tuple(f"{CONTRAVARIANT}{name}" for name in chosen),
            chain=some,
            has_infrared=False,
            readings=readings,
            own_readings=own_readings,
            rest_reading=lambda *_: "nothing is left",
        )


def _has_signal(of: Channels, *, least: float = 0.0) -> Bool[Array, " c"]:
    """Whether contravariant coordinates, and their channels alone, have a signal.

    ``least`` is the share of all electrons that a channel must exceed.
    """
    electrons = of.with_infrared.signal_e
    alone = (of.single_row * electrons).sum(axis=-1)
    found = (of.row * electrons).sum(axis=-1) != 0
    return np.asarray(found & (alone > least * electrons.sum(axis=-1)))


_ROUNDING = 1e-10  # of the sum of absolute terms: below, a sum is rounding


def faintest_change(
    light: Float[Array, " n"], axes: Float[Array, "n c"], step: Float[Array, "*k c"]
) -> Float[Array, "*k n"] | None:
    """The change of light with the lowest photon-counting SNR that changes a color by ``step``.

    Parameters
    ----------
    light
        L, mean photons per wavelength, >= 0.
    axes
        H, one column per color coordinate.
    step
        dx, the change of the color H^T L; many changes are found at once.

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
    return root * ((((step / lengths) @ vt.T) / singular) @ u.T)


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
    return _budget(scene, sensor, exposure, matrix, coordinate)


def _lab_asked(lit: _Lit, matrix: ColorMatrix, index: Sequence[int]) -> Iterator[_Asked]:
    scene, sensor = lit.scene, lit.sensor
    of_white = replace(lit, scene=flat_field(scene.illuminant, level_lux=scene.level_lux))
    white = matrix.matrix @ of_white.all_e
    if not (white > 0).all():
        return
    every = LAB.jacobian(matrix.matrix @ lit.all_e, white)
    slopes, axes = every[index], color_axes(sensor.grid, "quanta", matrix.observer)
    steps = inv(f"slopes of CIELAB of {sensor.name}", every).T[index]
    changes = faintest_change(lit.light, axes, steps)
    if changes is None:
        return

    def channels(of: _Lit, frame: DualBasis, rows: Float[Array, "3 p"]) -> Channels:
        cut, whole = (changes * of.is_visible) @ of.basis, changes @ of.basis
        own_axes = color_axes(sensor.grid, frame.metric, matrix.observer)
        one_by_one = weights_one_by_one(own_axes.T, frame)

        def change(signal_e: Float[Array, "c p"], noise_e: Float[Array, " p"]) -> Seen:
            return Seen(signal_e=signal_e, noise_e=_repeated(noise_e, cut), is_change=True)

        return Channels(
            without_infrared=change(cut, of.visible_e),
            with_infrared=change(whole, of.all_e),
            row=_sum_of(slopes[..., None] * rows),
            single_row=_sum_of(slopes[..., None] * one_by_one),
        )

    photons_db = counting_snr_db(lit.light, changes, lit.photons_per_unit_light)
    chain = _chain(lit, matrix.frame, matrix.matrix, channels, photons_db)
    white_cut = matrix.matrix @ of_white.visible_e
    if (white_cut > 0).all():
        slopes_cut = LAB.jacobian(matrix.matrix @ lit.visible_e, white_cut)[index]
        row_cut = _sum_of(slopes_cut[..., None] * matrix.matrix)
        cut = chain.channels.without_infrared
        chain = replace(chain, behind_cut=replace(chain.channels, with_infrared=cut, row=row_cut))
    keep = _followed(chain)
    chosen = _chosen([LAB.coordinates[i] for i in index], keep)
    if not chosen:
        return
    chain = _of_some(chain, keep)
    noise = with_noise(lit.all_e, sensor, lit.exposure).covariance
    readings, own_readings = _readings(chain, matrix.frame, lit)
    colorimeter = lit.photons_per_unit_light / (lit.light @ (axes @ slopes[keep].T) ** 2)
    pays_db = chain.photons_db - 10 * np.log10(colorimeter)
    for own, each_db in zip(own_readings, pays_db.tolist(), strict=True):
        own[WEIGHTS] += f"; a perfect colorimeter pays {each_db:.1f} dB"
    units = units_that_come_out(chain).tolist()
    yield _Asked(
        coordinates=chosen,
        chain=chain,
        readings=readings,
        own_readings=own_readings,
        rest_reading=lambda i, _: f"one unit of {chosen[i]} comes out as {units[i]:.2f}",
        snr_db=-10 * np.log10(variances_along(chain.channels.row, noise)),
    )


def _sum_of(terms: Float[Array, "*k c p"]) -> Float[Array, "*k p"]:
    """Their sum; 0 where they cancel to rounding, as X/Xn - Y/Yn does for a single channel."""
    total = terms.sum(axis=-2)
    return np.where(np.abs(total) > _ROUNDING * np.abs(terms).sum(axis=-2), total, 0.0)


def _followed(chain: Chain) -> Bool[Array, " c"]:
    """Whether a coordinate follows the change, and every readout of the chain detects it.

    Weights that neglect the overlap of channels may reverse the sign; only the size counts there.
    """
    of, found = chain.channels, np.ones(len(chain.photons_db), dtype=bool)
    for seen in (of.without_infrared, of.with_infrared):
        own, single = (
            _sum_of((row * seen.signal_e)[..., None])[..., 0] for row in (of.row, of.single_row)
        )
        found &= (own > 0) & (single != 0)
    return found
