"""SNR budget of L*, a* and b*: from all photons to one unit of a CIELAB coordinate.

A white has a* = 0, so the signal is not a* itself but a change of it: the SNR here is one unit over
the standard deviation, 1 / sigma, to first order at a given color. The signal is a change of the
light that changes this coordinate by one and leaves the other two constant. Of all such changes
`faintest_change` is used: the one with the lowest SNR for an ideal detector that counts every
photon with its wavelength. So no cause includes a loss that no detector could avoid. Photon
counting gives sqrt(p N) where the change is the light itself: the start of
`chromanoise.metrics.budget`.

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
gain here, because it scales signal and noise down together. Orders and losses are computed as in
`chromanoise.metrics.budget`.

The infrared carries almost no signal here, because H is almost zero there.
"""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import RANK_TOLERANCE, inv, svd, unit_columns
from chromanoise._shapes import Float
from chromanoise.color import LAB, ColorMatrix
from chromanoise.color.matrices import XYZ
from chromanoise.exposure import Exposure, expected_electrons, measurement_vectors
from chromanoise.geometry import DualBasis, dual_frame
from chromanoise.metrics.budget import weights_one_by_one
from chromanoise.metrics.budget_chain import (
    INFRARED,
    REST,
    WEIGHTS,
    Budget,
    Chain,
    Channels,
    Seen,
    causes_of,
    chain_budget,
    chain_snr_db,
    counting_snr_db,
    noise_causes,
    photons_on_pixels,
    rounded_share,
    shared_readings,
    without_infrared,
)
from chromanoise.noise import after_counting, noise_sources, with_noise
from chromanoise.scene import Scene, flat_field, light
from chromanoise.sensor import Sensor, without_crosstalk
from chromanoise.spectra import color_axes, is_infrared

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
    root = np.sqrt(_check.non_negative("light", "photons", light))
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
    _check.one_of("coordinate", coordinate, LAB.coordinates)
    _check.same_names("budget", sensor=sensor.names, matrix=matrix.channels)
    _check.same_names("budget in CIELAB", needed=XYZ, matrix=matrix.coordinates)
    point = _point(scene, sensor, exposure, matrix)
    if point is None:
        return None
    i = LAB.coordinates.index(coordinate)
    step = inv(f"slope of {coordinate} of {sensor.name}", point.slope)[:, i]
    change = faintest_change(point.light, point.axes, step)
    if change is None:
        return None
    chain = _chain(point, sensor, exposure, matrix, change, i)
    if not _followed(chain):
        return None
    row = chain.channels.row
    seen = chain.channels.with_infrared
    share = rounded_share(seen, chain.noise) if after_counting(chain.crosstalk) is None else 1.0
    gain = float(row @ (share * seen.signal_e))
    noise = with_noise(point.all_e, sensor, exposure).covariance
    return chain_budget(
        chain,
        coordinate,
        causes_of(chain),
        _readings(chain, matrix, point, coordinate, gain),
        optimal_linear_snr_db=chain_snr_db(chain, noise_causes(chain) | {INFRARED}),
        snr_db=-10 * float(np.log10(row @ noise @ row)),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Point:
    """One color: its light [photons], its electrons, and the Jacobian of CIELAB there."""

    light: Float[Array, " n"]
    axes: Float[Array, "n 3"]
    observer: str
    photons_per_unit_light: float
    all_e: Float[Array, " p"]
    visible_e: Float[Array, " p"]
    slope: Float[Array, "3 3"]


def _point(scene: Scene, sensor: Sensor, exposure: Exposure, matrix: ColorMatrix) -> _Point | None:
    """``None`` where X, Y or Z of the sensor's white is not above 0."""
    white_scene = flat_field(scene.illuminant, level_lux=scene.level_lux)
    white = matrix.matrix @ expected_electrons(white_scene, sensor, exposure)
    if not (white > 0).all():
        return None
    all_e = expected_electrons(scene, sensor, exposure)
    return _Point(
        light=light(scene, "quanta"),
        axes=color_axes(sensor.grid, "quanta", matrix.observer),
        observer=matrix.observer,
        photons_per_unit_light=photons_on_pixels(sensor, exposure),
        all_e=all_e,
        visible_e=expected_electrons(without_infrared(scene), sensor, exposure),
        slope=LAB.jacobian(matrix.matrix @ all_e, white),
    )


def _chain(
    point: _Point,
    sensor: Sensor,
    exposure: Exposure,
    matrix: ColorMatrix,
    change: Float[Array, " n"],
    i: int,
) -> Chain:
    crosstalk, before = sensor.crosstalk, None
    pure = without_crosstalk(sensor) if crosstalk is not None else None
    if crosstalk is not None and pure is not None:
        basis = measurement_vectors(pure, exposure, matrix.metric)
        frame = dual_frame(basis, names=pure.names, metric=matrix.metric)
        rows = matrix.matrix @ crosstalk.matrix
        before = _channels(point, pure, exposure, (rows, frame), change, i)
    return Chain(
        photons_db=counting_snr_db(point.light, change, point.photons_per_unit_light),
        channels=_channels(point, sensor, exposure, (matrix.matrix, matrix.frame), change, i),
        before_crosstalk=before,
        noise=noise_sources(sensor, exposure),
        crosstalk=crosstalk,
    )


def _channels(
    point: _Point,
    sensor: Sensor,
    exposure: Exposure,
    readout: tuple[Float[Array, "3 p"], DualBasis],
    change: Float[Array, " n"],
    i: int,
) -> Channels:
    """Signals and weights of one coordinate, for the rows of a matrix and the frame of a sensor."""
    rows, frame = readout
    basis = measurement_vectors(sensor, exposure, "quanta")
    visible = ~is_infrared(sensor.grid)
    cut, whole = (change * visible) @ basis, change @ basis
    noise_e, visible_e = point.light @ basis, (point.light * visible) @ basis
    axes = color_axes(sensor.grid, frame.metric, point.observer)
    one_by_one = [weights_one_by_one(axis, frame) for axis in axes.T]
    return Channels(
        without_infrared=Seen(signal_e=cut, noise_e=visible_e, sought_e=cut, is_change=True),
        with_infrared=Seen(signal_e=whole, noise_e=noise_e, sought_e=whole, is_change=True),
        row=_sum_of(point.slope[i, :, None] * rows),
        single_row=_sum_of(point.slope[i, :, None] * np.stack(one_by_one)),
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


def _readings(
    chain: Chain, matrix: ColorMatrix, point: _Point, coordinate: str, gain: float
) -> dict[str, str]:
    photons = point.photons_per_unit_light * float(point.light.sum())
    readings = shared_readings(
        chain, matrix.frame, photons=photons, all_e=point.all_e, visible_e=point.visible_e
    )
    h = point.axes @ point.slope[LAB.coordinates.index(coordinate)]
    perfect = 10 * float(np.log10(point.photons_per_unit_light / (h**2 @ point.light)))
    readings[WEIGHTS] += f"; a perfect colorimeter pays {chain.photons_db - perfect:.1f} dB"
    readings[REST] = f"one unit of {coordinate} comes out as {gain:.2f}"
    return readings
