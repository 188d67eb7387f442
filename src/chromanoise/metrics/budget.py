"""SNR budget: the loss per cause, from all incident photons to one color coordinate.

Five causes of loss are switched on one after the other. The loss of a cause is its mean loss over
all allowed orders (Shapley value): the filters come first, and the weights of the coordinate come
before the correlation of the channels; read noise and infrared may come anywhere after the filters.
So the losses add up exactly, no order is preferred, and a cause without effect has a loss of 0.

============ =============================================== ==================================
cause        off                                             on
============ =============================================== ==================================
filters      every photon is an electron of every channel    the sensor's quantum efficiencies
read noise   none                                            the pixel's
weights      the best linear readout, D^-1 mu                the coordinate's own weights h.f/|f|^2
correlation  channels weighted one by one                    channels unmixed: times G^-1
infrared     electrons from the infrared count as signal     they are noise without signal
============ =============================================== ==================================

For L*, a* and b*, where the signal is a change of the color, see `chromanoise.metrics.lab_budget`.
"""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.color import ColorMatrix
from chromanoise.exposure import Exposure, expected_electrons
from chromanoise.geometry import Frame, variance_inflation
from chromanoise.metrics.budget_chain import (
    CAUSES,
    CORRELATION,
    FILTERS,
    INFRARED,
    READ_NOISE,
    REST,
    WEIGHTS,
    Budget,
    Chain,
    Cost,
    Seen,
    chain_budget,
    chain_snr_db,
    counting_snr_db,
    photons_on_pixels,
    shared_readings,
    without_infrared,
)
from chromanoise.metrics.shapley import Switches, shapley_values
from chromanoise.scene import Scene, light
from chromanoise.sensor import Sensor
from chromanoise.spectra import color_axes

__all__ = [
    "CAUSES",
    "CORRELATION",
    "FILTERS",
    "INFRARED",
    "READ_NOISE",
    "REST",
    "WEIGHTS",
    "Budget",
    "Cost",
    "Switches",
    "color_budget",
    "contravariant_budget",
    "shapley_values",
]


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
    _check.one_of("coordinate", coordinate, matrix.coordinates)
    _check.same_names("budget", sensor=sensor.names, matrix=matrix.channels)
    i = matrix.coordinates.index(coordinate)
    got = _electrons(scene, sensor, exposure)
    axis = color_axes(sensor.grid, matrix.metric)[:, i]
    single_row = weights_one_by_one(axis, matrix.frame)
    visible = Seen(signal_e=got.visible_e, noise_e=got.all_e, sought_e=got.all_e)
    chain = _chain(got, matrix.matrix[i], single_row, visible)
    usable = (chain.row @ got.all_e, chain.row @ got.visible_e, single_row @ got.visible_e)
    if not min(usable) > 0:
        return None
    readings = _readings(chain, matrix.frame, got)
    own = chain_snr_db(
        chain, frozenset(CAUSES) - {INFRARED}
    )  # at the end all light counts as signal
    readings[REST] = _rest_reading(chain_snr_db(chain, frozenset(CAUSES)) - own, coordinate)
    bound = chain_snr_db(chain, frozenset({FILTERS, READ_NOISE}))
    return chain_budget(
        chain, coordinate, CAUSES, readings, optimal_linear_snr_db=bound, snr_db=own
    )


def contravariant_budget(
    scene: Scene, sensor: Sensor, exposure: Exposure, frame: Frame, channel: str
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
    _check.one_of("channel", channel, sensor.names)
    _check.same_names("budget", sensor=sensor.names, frame=frame.names)
    i = sensor.names.index(channel)
    got = _electrons(scene, sensor, exposure)
    seen = Seen(signal_e=got.all_e, noise_e=got.all_e, sought_e=got.all_e)
    chain = _chain(got, frame.inverse_gram[i], np.eye(len(sensor.names))[i], seen)
    defined = np.isfinite(variance_inflation(frame)[i]) and chain.row @ got.all_e != 0
    if not (defined and got.all_e[i] > 0):
        return None
    readings = _readings(chain, frame, got)
    readings[WEIGHTS] = f"{channel} alone, of all {len(sensor.names)} channels"
    readings[REST] = "nothing is left"
    own = chain_snr_db(chain, frozenset(CAUSES[:-1]))
    bound = chain_snr_db(chain, frozenset({FILTERS, READ_NOISE}))
    coordinate = f"M^{channel}"
    return chain_budget(
        chain, coordinate, CAUSES[:-1], readings, optimal_linear_snr_db=bound, snr_db=own
    )


def weights_one_by_one(axis: Float[Array, " n"], frame: Frame) -> Float[Array, " p"]:
    """Weights of the channels for ``axis``, h.f / |f|^2, neglecting the overlap of the channels.

    Examples
    --------
    >>> from chromanoise.geometry import dual_frame
    >>> f = np.array([[2.0, 0.0], [0.0, 1.0]])
    >>> weights_one_by_one(np.ones(2), dual_frame(f, names=("a", "b"), metric="quanta"))
    array([0.5, 1. ])
    """
    return axis @ frame.basis / (frame.basis**2).sum(axis=0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Electrons:
    """Photons on all pixels, and the electrons that the channels collect from them."""

    photons: float
    photons_db: float
    all_e: Float[Array, " p"]
    visible_e: Float[Array, " p"]
    read_variance_e2: float


def _electrons(scene: Scene, sensor: Sensor, exposure: Exposure) -> _Electrons:
    photons, factor = light(scene, "quanta"), photons_on_pixels(sensor, exposure)
    return _Electrons(
        photons=factor * float(photons.sum()),
        photons_db=counting_snr_db(photons, photons, factor),
        all_e=expected_electrons(scene, sensor, exposure),
        visible_e=expected_electrons(without_infrared(scene), sensor, exposure),
        read_variance_e2=sensor.pixel.read_noise_e**2,
    )


def _chain(
    got: _Electrons, row: Float[Array, " p"], single_row: Float[Array, " p"], infrared_on: Seen
) -> Chain:
    return Chain(
        photons_db=got.photons_db,
        without_infrared=Seen(signal_e=got.all_e, noise_e=got.all_e, sought_e=got.all_e),
        with_infrared=infrared_on,
        row=row,
        single_row=single_row,
        read_variance_e2=got.read_variance_e2,
    )


def _readings(chain: Chain, frame: Frame, got: _Electrons) -> dict[str, str]:
    return shared_readings(
        chain, frame, photons=got.photons, all_e=got.all_e, visible_e=got.visible_e
    )


def _rest_reading(rest_db: float, coordinate: str) -> str:
    infrared = round(100 * (1 - 10 ** (rest_db / 20)), 1) + 0.0  # avoids -0.0
    return f"{infrared:.1f} % of {coordinate} is infrared that the matrix lets through"
