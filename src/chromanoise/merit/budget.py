"""Where the SNR goes: from all photons that hit the pixels to one color coordinate, cause by cause.

Five causes are switched on one after the other, and each is charged the mean of what it costs over
all orders that make sense: the filters come before all that they make possible, and the weights of
the coordinate before the unmixing that refines them; read noise and infrared may come at any time
after the filters. So the shares add up exactly, no order is preferred, and a cause that changes
nothing costs nothing.

============ =============================================== ==================================
cause        off                                             on
============ =============================================== ==================================
filters      every photon is an electron of every channel    the sensor's quantum efficiencies
read noise   none                                            the pixel's
weights      the best linear readout, D^-1 mu                the coordinate's own weights h.f/|f|^2
correlation  channels weighted one by one                    channels unmixed: times G^-1
infrared     electrons from the infrared count as signal     they are noise without signal
============ =============================================== ==================================
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from jaxtyping import Float

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.color import ColorMatrix
from chromanoise.exposure import Exposure, expected_electrons, exposure_factor
from chromanoise.geometry import Frame, variance_inflation
from chromanoise.scene import Scene, light
from chromanoise.sensor import Sensor
from chromanoise.spectra import INFRARED_FROM_NM, color_axes
from chromanoise.units import decibel

FILTERS, READ_NOISE, WEIGHTS = "filters", "read noise", "weights"
CORRELATION, INFRARED, REST = "correlation", "infrared", "rest"
CAUSES = (FILTERS, READ_NOISE, WEIGHTS, CORRELATION, INFRARED)
_PRECEDENCE = (*((FILTERS, later) for later in CAUSES[1:]), (WEIGHTS, CORRELATION))

Switches = frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """What one cause costs.

    Attributes
    ----------
    cause
        One of `CAUSES`, or "rest".
    loss_db
        Its Shapley value; negative where it helps. [dB]
    reading
        What it is in terms of the sensor, in one sentence.
    """

    cause: str
    loss_db: float
    reading: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """From all photons down to one coordinate.

    Attributes
    ----------
    coordinate
        X, Y or Z, or M^R for the contravariant coordinate of channel R.
    photons_db
        SNR of counting every photon that hits the p pixels: sqrt(p N). [dB]
    costs
        One per cause and the rest; their sum is ``photons_db`` minus ``snr_db``.
    bound_db
        The best SNR of any linear readout of the real channels. [dB]
    snr_db
        Of the coordinate. [dB]
    """

    coordinate: str
    photons_db: float
    costs: tuple[Cost, ...]
    bound_db: float
    snr_db: float


def shapley_values(
    value: Callable[[Switches], float],
    players: Sequence[str],
    precedence: Sequence[tuple[str, str]] = (),
) -> dict[str, float]:
    """Each player's mean contribution to ``value`` over all allowed orders of arrival.

    Parameters
    ----------
    value
        Of any set of players.
    players
        Distinct names.
    precedence
        Pairs (first, second): orders in which the second comes earlier do not count.

    Raises
    ------
    InputError
        If no order obeys the precedence.

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
    orders = [
        order
        for order in permutations(players)
        if all(order.index(first) < order.index(second) for first, second in precedence)
    ]
    if not orders:
        raise _check.InputError(f"no order of {', '.join(players)} obeys the precedence")
    shares = dict.fromkeys(players, 0.0)
    for order in orders:
        for place, name in enumerate(order):
            before = frozenset(order[:place])
            shares[name] += (value(before | {name}) - value(before)) / len(orders)
    return shares


def color_budget(
    scene: Scene, sensor: Sensor, exposure: Exposure, matrix: ColorMatrix, coordinate: str = "Y"
) -> Budget | None:
    """The budget of one color coordinate of a kernel matrix, or ``None`` where it has no SNR.

    Parameters
    ----------
    scene
        A single point (`flat_field`).
    sensor, exposure
        What looks at it, and how.
    matrix
        The kernel matrix of that sensor and exposure (eq. 6).
    coordinate
        X, Y or Z.

    Raises
    ------
    InputError
        If the matrix has no such coordinate, or its channels are not the sensor's.
    """
    _check.one_of("coordinate", coordinate, matrix.coordinates)
    _check.same_names("budget", sensor=sensor.names, matrix=matrix.channels)
    i = matrix.coordinates.index(coordinate)
    basis = matrix.frame.basis
    axis = color_axes(sensor.grid, matrix.metric)[:, i]
    single_row = axis @ basis / (basis**2).sum(axis=0)
    chain = _chain(scene, sensor, exposure, matrix.matrix[i], single_row)
    usable = (chain.row @ chain.all_e, chain.row @ chain.visible_e, single_row @ chain.visible_e)
    if not min(usable) > 0:
        return None
    readings = _readings(chain, sensor, matrix.frame)
    rest = _snr_db(chain, frozenset(CAUSES)) - _snr_db(chain, frozenset(CAUSES) - {INFRARED})
    readings[REST] = _rest_reading(rest, coordinate)
    return _budget(chain, coordinate, CAUSES, readings)


def contravariant_budget(
    scene: Scene, sensor: Sensor, exposure: Exposure, frame: Frame, channel: str
) -> Budget | None:
    """The budget of one contravariant coordinate, or ``None`` where it is not defined.

    Here the infrared is signal like any other light, and "weights" is the step from the best
    readout of all channels to the one channel alone.

    Parameters
    ----------
    scene
        A single point (`flat_field`).
    sensor, exposure
        What looks at it, and how.
    frame
        Of that sensor and exposure.
    channel
        Whose coordinate.

    Raises
    ------
    InputError
        If there is no such channel, or the frame is of other channels.
    """
    _check.one_of("channel", channel, sensor.names)
    _check.same_names("budget", sensor=sensor.names, frame=frame.names)
    i = sensor.names.index(channel)
    alone = np.eye(len(sensor.names))[i]
    chain = _chain(scene, sensor, exposure, frame.inverse_gram[i], alone)
    defined = np.isfinite(variance_inflation(frame)[i]) and chain.row @ chain.all_e != 0
    if not (defined and chain.all_e[i] > 0):
        return None
    readings = _readings(chain, sensor, frame)
    readings[WEIGHTS] = f"{channel} alone, of all {len(sensor.names)} channels"
    readings[REST] = "nothing is left"
    return _budget(chain, f"M^{channel}", CAUSES[:-1], readings)


def _budget(
    chain: "_Chain", coordinate: str, causes: tuple[str, ...], readings: dict[str, str]
) -> Budget:
    allowed = [(first, second) for first, second in _PRECEDENCE if {first, second} <= set(causes)]
    shares = shapley_values(lambda on: _snr_db(chain, on), causes, allowed)
    snr_db = _snr_db(chain, frozenset(causes) - {INFRARED})  # all light counts in the end
    rest = _snr_db(chain, frozenset(causes)) - snr_db
    costs = [Cost(cause=c, loss_db=-shares[c], reading=readings[c]) for c in causes]
    return Budget(
        coordinate=coordinate,
        photons_db=_snr_db(chain, frozenset()),
        costs=(*costs, Cost(cause=REST, loss_db=rest, reading=readings[REST])),
        bound_db=_snr_db(chain, frozenset({FILTERS, READ_NOISE})),
        snr_db=snr_db,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Chain:
    """Means and weights between which the causes switch."""

    photons: float
    all_e: Float[Array, " p"]
    visible_e: Float[Array, " p"]
    row: Float[Array, " p"]
    single_row: Float[Array, " p"]
    read_variance: float

    def variance(self, read_noise: bool) -> Float[Array, " p"]:
        return self.all_e + (self.read_variance if read_noise else 0.0)


def _chain(
    scene: Scene,
    sensor: Sensor,
    exposure: Exposure,
    row: Float[Array, " p"],
    single_row: Float[Array, " p"],
) -> _Chain:
    visible = sensor.grid.wavelength_nm <= INFRARED_FROM_NM
    seen = Scene(
        illuminant=scene.illuminant,
        level_lux=scene.level_lux,
        reflectance=scene.reflectance * visible,
    )
    k = exposure_factor(exposure, sensor.pixel, sensor.grid.step_nm)
    return _Chain(
        photons=k * float(light(scene, "quanta").sum()),
        all_e=expected_electrons(scene, sensor, exposure),
        visible_e=expected_electrons(seen, sensor, exposure),
        row=row,
        single_row=single_row,
        read_variance=sensor.pixel.read_noise_e**2,
    )


def _snr_db(chain: _Chain, on: Switches) -> float:
    """SNR of the readout that the switches describe. [dB]"""
    if FILTERS not in on:
        return 10 * math.log10(chain.all_e.size * chain.photons)
    variance = chain.variance(READ_NOISE in on)
    signal = chain.visible_e if INFRARED in on else chain.all_e
    row = chain.all_e / np.where(variance > 0, variance, 1.0)
    if WEIGHTS in on:
        row = chain.row if CORRELATION in on else chain.single_row
    return float(decibel(np.asarray(abs(row @ signal) / np.sqrt(row**2 @ variance))))


def _readings(chain: _Chain, sensor: Sensor, frame: Frame) -> dict[str, str]:
    vif = variance_inflation(frame)
    worst = int(np.argmax(vif))
    variance = chain.variance(True)
    whitened = np.sqrt(np.where(variance > 0, variance, 1.0))  # a silent channel weighs nothing
    best, own = chain.all_e / whitened, chain.single_row * whitened
    psi = np.degrees(np.arccos(np.clip(best @ own / np.sqrt((best @ best) * (own @ own)), -1, 1)))
    electrons = chain.all_e.sum() / (chain.photons * chain.all_e.size)
    infrared = 1 - chain.visible_e.sum() / chain.all_e.sum()
    read = chain.read_variance / chain.variance(True).mean()
    return {
        FILTERS: f"{100 * electrons:.0f} % of the photons become electrons",
        READ_NOISE: f"{100 * read:.1f} % of the mean noise variance is readout",
        WEIGHTS: f"the color's weights stand {psi:.0f} deg from the best readout, noise whitened",
        CORRELATION: f"unmixing multiplies the variance of {sensor.names[worst]} by "
        f"{vif[worst]:.1f}, condition {frame.condition:.1f}",
        INFRARED: f"{100 * infrared:.0f} % of the electrons come from beyond "
        f"{INFRARED_FROM_NM:.0f} nm",
    }


def _rest_reading(rest_db: float, coordinate: str) -> str:
    infrared = round(100 * (1 - 10 ** (rest_db / 20)), 1) + 0.0  # no minus before a zero
    return f"{infrared:.1f} % of {coordinate} is infrared that the matrix lets through"
