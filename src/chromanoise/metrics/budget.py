"""SNR budget: the loss per cause, from all incident photons to one color coordinate.

Causes of loss are switched on one after the other. The loss of a cause is its mean loss over
all allowed orders (Shapley value): the filters come first, and the weights of the coordinate come
before the correlation of the channels; all others may come anywhere after the filters.
So the losses add up exactly, no order is preferred, and a cause without effect has a loss of 0.

============ =============================================== ==================================
cause        off                                             on
============ =============================================== ==================================
filters      every photon is an electron of every channel    the sensor's quantum efficiencies
read noise   none                                            the pixel's
crosstalk    the channels without it                         light of the neighbors in each pixel
weights      the best linear readout, D^-1 mu                the coordinate's own weights h.f/|f|^2
correlation  channels weighted one by one                    channels unmixed: times G^-1
infrared     electrons from the infrared count as signal     they are noise without signal
============ =============================================== ==================================

Dark current, quantization, row noise, DSNU, PRNU, crosstalk and the pattern of crosstalk are causes
only if the sensor has them. The pattern exists in a mosaic in which pixels of one channel have
different neighbors, and only together with the cause crosstalk.

For L*, a* and b*, where the signal is a change of the color, see `chromanoise.metrics.lab_budget`.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.color import ColorMatrix
from chromanoise.exposure import Exposure, expected_electrons, measurement_vectors
from chromanoise.geometry import DualBasis, dual_frame, variance_inflation
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
    Channels,
    Cost,
    Seen,
    causes_of,
    chain_budget,
    chain_snr_db,
    counting_snr_db,
    noise_causes,
    photons_on_pixels,
    shared_readings,
    without_infrared,
)
from chromanoise.metrics.shapley import Switches, shapley_values
from chromanoise.noise import noise_sources
from chromanoise.scene import Scene, light
from chromanoise.sensor import Sensor, without_crosstalk
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
    _check.among("coordinate", coordinate, matrix.coordinates)
    _check.same_names("budget", sensor=sensor.names, matrix=matrix.channels)
    i = matrix.coordinates.index(coordinate)
    got = _electrons(scene, sensor, exposure)
    axis = color_axes(sensor.grid, matrix.metric, matrix.observer)[:, i]

    def channels(of: _Electrons, frame: DualBasis, row: Float[Array, " p"]) -> Channels:
        return Channels(
            without_infrared=_seen(of.all_e),
            with_infrared=Seen(signal_e=of.visible_e, noise_e=of.all_e, sought_e=of.all_e),
            row=row,
            single_row=weights_one_by_one(axis, frame),
        )

    chain = _chain(got, sensor, channels, matrix.frame, matrix.matrix[i])
    own = chain.channels
    usable = (own.row @ got.all_e, own.row @ got.visible_e, own.single_row @ got.visible_e)
    if not min(usable) > 0:
        return None
    causes = causes_of(chain)
    readings = _readings(chain, matrix.frame, got)
    all_light = chain_snr_db(chain, frozenset(causes) - {INFRARED})  # at the end all is signal
    rest = chain_snr_db(chain, frozenset(causes)) - all_light
    readings[REST] = _rest_reading(rest, coordinate)
    return chain_budget(
        chain,
        coordinate,
        causes,
        readings,
        optimal_linear_snr_db=chain_snr_db(chain, noise_causes(chain)),
        snr_db=all_light,
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
    _check.among("channel", channel, sensor.names)
    _check.same_names("budget", sensor=sensor.names, frame=frame.names)
    i = sensor.names.index(channel)
    got = _electrons(scene, sensor, exposure)

    def channels(of: _Electrons, _: DualBasis, row: Float[Array, " p"]) -> Channels:
        seen, alone = _seen(of.all_e), np.eye(len(sensor.names))[i]
        return Channels(without_infrared=seen, with_infrared=seen, row=row, single_row=alone)

    chain = _chain(got, sensor, channels, frame, frame.inverse_gram[i])
    defined = np.isfinite(variance_inflation(frame)[i]) and chain.channels.row @ got.all_e != 0
    if not (defined and got.all_e[i] > 0):
        return None
    causes = causes_of(chain, infrared=False)
    readings = _readings(chain, frame, got)
    readings[WEIGHTS] = f"{channel} alone, of all {len(sensor.names)} channels"
    readings[REST] = "nothing is left"
    return chain_budget(
        chain,
        f"M^{channel}",
        causes,
        readings,
        optimal_linear_snr_db=chain_snr_db(chain, noise_causes(chain)),
        snr_db=chain_snr_db(chain, frozenset(causes)),
    )


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Electrons:
    """Photons on all pixels, and the electrons that the channels collect from them."""

    scene: Scene
    exposure: Exposure
    photons: float
    photons_db: float
    all_e: Float[Array, " p"]
    visible_e: Float[Array, " p"]


def _electrons(scene: Scene, sensor: Sensor, exposure: Exposure) -> _Electrons:
    photons, factor = light(scene, "quanta"), photons_on_pixels(sensor, exposure)
    return _Electrons(
        scene=scene,
        exposure=exposure,
        photons=factor * float(photons.sum()),
        photons_db=counting_snr_db(photons, photons, factor),
        all_e=expected_electrons(scene, sensor, exposure),
        visible_e=expected_electrons(without_infrared(scene), sensor, exposure),
    )


def _seen(electrons: Float[Array, " p"]) -> Seen:
    return Seen(signal_e=electrons, noise_e=electrons, sought_e=electrons)


def _chain(
    got: _Electrons,
    sensor: Sensor,
    channels: Callable[[_Electrons, DualBasis, Float[Array, " p"]], Channels],
    frame: DualBasis,
    row: Float[Array, " p"],
) -> Chain:
    """The chain of the sensor, and of the same without crosstalk: R X gives the same color."""
    crosstalk, before = sensor.crosstalk, None
    pure = without_crosstalk(sensor) if crosstalk is not None else None
    if crosstalk is not None and pure is not None:
        basis = measurement_vectors(pure, got.exposure, frame.metric)
        own = dual_frame(basis, names=pure.names, metric=frame.metric)
        before = channels(_electrons(got.scene, pure, got.exposure), own, row @ crosstalk.matrix)
    return Chain(
        photons_db=got.photons_db,
        channels=channels(got, frame, row),
        before_crosstalk=before,
        noise=noise_sources(sensor, got.exposure),
        crosstalk=crosstalk,
    )


def _readings(chain: Chain, frame: DualBasis, got: _Electrons) -> dict[str, str]:
    return shared_readings(
        chain, frame, photons=got.photons, all_e=got.all_e, visible_e=got.visible_e
    )


def _rest_reading(rest_db: float, coordinate: str) -> str:
    infrared = round(100 * (1 - 10 ** (rest_db / 20)), 1) + 0.0  # avoids -0.0
    return f"{infrared:.1f} % of {coordinate} is infrared that the matrix lets through"
