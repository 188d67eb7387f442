"""The chain from all photons to one coordinate, with a switch for every cause of loss.

This module holds what all budgets share: the causes and their order, the result types, and the SNR
of the readout for a set of active causes. `chromanoise.metrics.budget` defines signal, noise and
weights for X, Y, Z and the contravariant coordinates, `chromanoise.metrics.lab_budget` for L*, a*,
b*.
"""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check, _notebook
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.exposure import Exposure, exposure_factor
from chromanoise.geometry import Frame, variance_inflation
from chromanoise.metrics.shapley import Switches, shapley_values
from chromanoise.scene import Scene
from chromanoise.sensor import Sensor, pixels_of
from chromanoise.spectra import INFRARED_FROM_NM
from chromanoise.units import decibel

FILTERS, READ_NOISE, WEIGHTS = "filters", "read noise", "weights"
CORRELATION, INFRARED, REST = "correlation", "infrared", "rest"
CAUSES = (FILTERS, READ_NOISE, WEIGHTS, CORRELATION, INFRARED)
_PRECEDENCE = (*((FILTERS, later) for later in CAUSES[1:]), (WEIGHTS, CORRELATION))


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """The loss of SNR that one cause makes.

    Attributes
    ----------
    cause
        One of `CAUSES`, or "rest".
    loss_db
        Its Shapley value; negative where the cause raises the SNR. [dB]
    reading
        One sentence that explains the loss in terms of the sensor.
    """

    cause: str
    loss_db: float
    reading: str


@dataclass(frozen=True, slots=True, kw_only=True)
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

    coordinate: str
    photons_db: float
    costs: tuple[Cost, ...]
    optimal_linear_snr_db: float
    snr_db: float

    def _repr_html_(self) -> str:
        start = ["all photons on the pixels", f"{self.photons_db:.2f}", "every photon counted"]
        end = [f"SNR of {self.coordinate}", f"{self.snr_db:.2f}", ""]
        causes = [[cost.cause, f"{-cost.loss_db:+.2f}", cost.reading] for cost in self.costs]
        best = self.optimal_linear_snr_db
        return _notebook.shown(
            f"Budget of {self.coordinate}; no linear readout exceeds {best:.2f} dB",
            _notebook.table(["", "dB", "why"], [start, *causes, end]),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seen:
    """Electrons of the signal, and electrons that contribute shot noise.

    Attributes
    ----------
    signal_e
        Electrons of the signal. [e-]
    noise_e
        Electrons whose shot noise counts. [e-]
    sought_e
        The signal for which the best linear readout is optimized. [e-]
    """

    signal_e: Float[Array, " p"]
    noise_e: Float[Array, " p"]
    sought_e: Float[Array, " p"]

    def __post_init__(self) -> None:
        _check.freeze(self, "signal_e", "noise_e", "sought_e")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chain:
    """Signals, noise and weights that the causes switch between.

    Attributes
    ----------
    photons_db
        SNR at the start of the chain: `counting_snr_db`. [dB]
    without_infrared, with_infrared
        Signal and noise with the cause "infrared" off, and on.
    row
        The coordinate's row of the color matrix, applied to the unmixed channels.
    single_row
        The coordinate's weights where the overlap of the channels is neglected.
    read_variance_e2
        Variance of the read noise of each pixel. [e-^2]
    """

    photons_db: float
    without_infrared: Seen
    with_infrared: Seen
    row: Float[Array, " p"]
    single_row: Float[Array, " p"]
    read_variance_e2: float

    def __post_init__(self) -> None:
        _check.freeze(self, "row", "single_row")


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


def photons_on_pixels(sensor: Sensor, exposure: Exposure) -> float:
    """Photons on the pixels of all channels per unit of light and wavelength. [s um2 nm]

    p k of eq. 2, or k for channels that are stacked on one pixel.
    """
    return pixels_of(sensor) * exposure_factor(exposure, sensor.pixel, sensor.grid.step_nm)


def without_infrared(scene: Scene) -> Scene:
    """The same scene behind an ideal IR-cut filter at `INFRARED_FROM_NM`."""
    visible = scene.illuminant.grid.wavelength_nm <= INFRARED_FROM_NM
    return Scene(
        illuminant=scene.illuminant,
        level_lux=scene.level_lux,
        reflectance=scene.reflectance * visible,
    )


def chain_snr_db(chain: Chain, on: Switches) -> float:
    """SNR of the readout with the given causes switched on. [dB]"""
    if FILTERS not in on:
        return chain.photons_db
    seen = chain.with_infrared if INFRARED in on else chain.without_infrared
    variance = seen.noise_e + (chain.read_variance_e2 if READ_NOISE in on else 0.0)
    row = seen.sought_e / np.where(variance > 0, variance, 1.0)
    if WEIGHTS in on:
        row = chain.row if CORRELATION in on else chain.single_row
    return float(decibel(np.asarray(abs(row @ seen.signal_e) / np.sqrt(row**2 @ variance))))


def chain_budget(
    chain: Chain,
    coordinate: str,
    causes: tuple[str, ...],
    readings: dict[str, str],
    *,
    optimal_linear_snr_db: float,
    snr_db: float,
) -> Budget:
    """The losses of all causes; the difference that remains to ``snr_db`` is the rest.

    Parameters
    ----------
    chain
        The chain of ``coordinate``.
    causes
        The causes from `CAUSES` that are switched.
    readings
        One sentence per cause and for "rest".
    optimal_linear_snr_db, snr_db
        As `Budget`. [dB]
    """
    allowed = [(first, second) for first, second in _PRECEDENCE if {first, second} <= set(causes)]
    shares = shapley_values(lambda on: chain_snr_db(chain, on), causes, allowed)
    rest = chain_snr_db(chain, frozenset(causes)) - snr_db
    costs = [Cost(cause=c, loss_db=-shares[c], reading=readings[c]) for c in causes]
    return Budget(
        coordinate=coordinate,
        photons_db=chain.photons_db,
        costs=(*costs, Cost(cause=REST, loss_db=rest, reading=readings[REST])),
        optimal_linear_snr_db=optimal_linear_snr_db,
        snr_db=snr_db,
    )


def shared_readings(
    chain: Chain, frame: Frame, *, photons: float, all_e: Array, visible_e: Array
) -> dict[str, str]:
    """One sentence per cause that explains it in terms of the sensor.

    Parameters
    ----------
    chain, frame
        The chain and the frame of the sensor.
    photons
        On all pixels together.
    all_e, visible_e
        Mean electrons with and without the infrared. [e-]
    """
    vif = variance_inflation(frame)
    worst = int(np.argmax(vif))
    variance = all_e + chain.read_variance_e2
    whitened = np.sqrt(np.where(variance > 0, variance, 1.0))  # avoids 0 / 0
    best, own = chain.with_infrared.sought_e / whitened, chain.single_row * whitened
    psi = np.degrees(np.arccos(np.clip(best @ own / np.sqrt((best @ best) * (own @ own)), -1, 1)))
    infrared = 1 - visible_e.sum() / all_e.sum()
    read = chain.read_variance_e2 / variance.mean()
    return {
        FILTERS: f"{100 * all_e.sum() / photons:.0f} % of the photons become electrons",
        READ_NOISE: f"{100 * read:.1f} % of the mean noise variance is readout",
        WEIGHTS: f"this color needs a channel mix {psi:.0f} deg from the lowest-noise one",
        CORRELATION: f"unmixing multiplies the variance of {frame.names[worst]} by "
        f"{vif[worst]:.1f}, condition {frame.condition:.1f}",
        INFRARED: f"{100 * infrared:.0f} % of the electrons come from beyond "
        f"{INFRARED_FROM_NM:.0f} nm",
    }
