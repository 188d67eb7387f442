"""Color matrices: the kernel CCM of eq. 6, matrices fitted to training sets, and Kodak's Psi.

Every method is called as ``method(sensor, exposure, training, level_lux=..., metric=...)``, some
with a further parameter, and returns a `ColorMatrix` in lx/e-. All methods except `kernel` minimize
E|C M - XYZ|^2 over the set plus a penalty, so their matrix does not depend on the metric; only the
frame stored with it does.

Psi is Kodak's noise gain of a matrix (`noise_gain`); `bounded_psi` is the best matrix below a given
Psi.
"""

from dataclasses import replace

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Float,
    InputError,
    check,
    covariance_root,
    dataclass,
    decibel,
    lstsq,
    notebook,
    pinv,
    qr,
    svd,
    whitening,
    with_short_repr,
)
from chromanoise.color.spaces import balanced_cielab, cie1976_difference
from chromanoise.color.training import Training, TrainingResponse, training_response
from chromanoise.geometry import DualBasis, dual_frame
from chromanoise.noise import (
    Exposure,
    Measurement,
    mean_noise_covariance,
    measurement_vectors,
    through,
    with_noise,
)
from chromanoise.sensor import Sensor, refuse_blind_channels
from chromanoise.spectra import DEFAULT_OBSERVER, Metric, Scene, color_axes, known_observer, light

XYZ = ("X", "Y", "Z")


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class ColorMatrix:
    """A matrix from raw electrons to color, and how it was made.

    Attributes
    ----------
    matrix
        One row per color coordinate, one column per channel. [lx/e-]
    channels
        Names of the columns.
    coordinates
        Names of the rows.
    made_by
        Method of the fit, and its equation.
    metric
        Metric of the space of spectra.
    frame
        The sensor's frame; its rank and condition show how reliable the matrix is.
    observer
        The observer whose X, Y, Z the matrix gives, from `chromanoise.spectra.OBSERVERS`.
    notes
        Warnings: made for another sensor or light, or of low rank.

    Raises
    ------
    InputError
        If an entry is not finite, the shape is not that of coordinates and channels, or there is no
        observer of that name.
    """

    matrix: Float[Array, "c p"]
    channels: tuple[str, ...]
    coordinates: tuple[str, ...]
    made_by: str
    metric: Metric
    frame: DualBasis
    observer: str = DEFAULT_OBSERVER
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "observer", known_observer(self.observer))
        what, shape = f"{self.made_by} matrix", (len(self.coordinates), len(self.channels))
        checked = check.finite(what, "lx/e-", self.matrix)
        need = f"must have shape {shape}, one row per coordinate and one column per channel"
        check.shape(what, checked, checked.shape == shape, need)
        check.keep(self, matrix=checked)

    def _repr_html_(self) -> str:
        rows = [
            [name, *(f"{weight:.5g}" for weight in row)]
            for name, row in zip(self.coordinates, self.matrix, strict=True)
        ]
        frame = self.frame
        return notebook.shown(
            f"Color matrix [lx/e-], {self.made_by}, in {self.metric}; condition "
            f"{frame.condition:.4g}, rank {frame.rank} of {len(self.channels)}",
            notebook.table(["", *self.channels], rows),
        )


def kernel_matrix(
    sensor: Sensor,
    exposure: Exposure,
    metric: Metric = "quanta",
    observer: str = DEFAULT_OBSERVER,
) -> ColorMatrix:
    """The kernel color matrix, H^T F (F^T F)^-1: the color of the reconstructed spectrum.

    Parameters
    ----------
    sensor
        p channels; where they are linearly dependent, the pseudo-inverse is used.
    exposure
        Scales F, so that the matrix converts electrons to lux.
    metric
        In which light is a vector; the matrix depends on it.
    observer
        A name from `chromanoise.spectra.OBSERVERS`.

    Raises
    ------
    InputError
        If a channel is zero at every wavelength, or there is no observer of that name.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 6.
    """
    refuse_blind_channels(sensor)
    basis = measurement_vectors(sensor, exposure, metric)  # F
    frame = dual_frame(basis, names=sensor.names, metric=metric)
    axes = color_axes(sensor.grid, metric, observer)  # H
    return ColorMatrix(
        matrix=axes.T @ frame.dual,
        channels=sensor.names,
        coordinates=XYZ,
        made_by="kernel (eq. 6)",
        metric=metric,
        frame=frame,
        observer=observer,
    )


def scene_xyz(
    scene: Scene, metric: Metric = "quanta", observer: str = DEFAULT_OBSERVER
) -> Float[Array, "*px 3"]:
    """X, Y, Z of the light for an observer: H^T L. [lx]

    Parameters
    ----------
    scene
        The light from the scene.
    metric
        Does not change the result beyond rounding.
    observer
        A name from `chromanoise.spectra.OBSERVERS`.

    Raises
    ------
    InputError
        If there is no observer of that name.
    """
    return light(scene, metric) @ color_axes(scene.illuminant.grid, metric, observer)


def colored(raw: Measurement, matrix: ColorMatrix) -> Measurement:
    """Color and its covariance C D C^T (eq. 5 with eq. 4). [lx]

    Parameters
    ----------
    raw
        Mean and covariance of the raw channels. [e-]
    matrix
        The color matrix. [lx/e-]

    Raises
    ------
    InputError
        If the channels of ``raw`` are not those of ``matrix``, in the same order.
    """
    check.same_names("color", raw=raw.names, matrix=matrix.channels)
    return through(
        raw,
        matrix.matrix,
        names=matrix.coordinates,
        kind="".join(matrix.coordinates),
        unit="lx",
        metric=matrix.metric,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class ParetoCurve:
    """Color error against noise, one matrix per weight of the noise.

    Attributes
    ----------
    weight
        0 is least squares, 1 LMMSE.
    matrix
        One per weight. [lx/e-]
    color_error_rms
        RMS error of X, Y and Z together over the training set, without noise. [lx]
    noise_rms
        Standard deviation of X, Y and Z together, averaged over the set. [lx]
    delta_e
        Mean CIE 1976 color difference over the set, sensor and observer each balanced on their own
        white; ``None`` where X, Y or Z of the sensor's white is not above 0. [1]
    snr_y_db
        Luminance SNR of a perfect white. [dB]
    """

    weight: Float[Array, " q"]
    matrix: Float[Array, "q 3 p"]
    color_error_rms: Float[Array, " q"]
    noise_rms: Float[Array, " q"]
    delta_e: tuple[float | None, ...]
    snr_y_db: Float[Array, " q"]

    def __post_init__(self) -> None:
        check.same_length("weights", weight=self.weight.size, matrix=len(self.matrix))
        check.same_length("weights", weight=self.weight.size, delta_e=len(self.delta_e))
        check.freeze(self, "weight", "matrix", "color_error_rms", "noise_rms", "snr_y_db")


def kernel(
    sensor: Sensor,
    exposure: Exposure,
    training: Training | None,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    observer: str = DEFAULT_OBSERVER,
) -> ColorMatrix:
    """The kernel matrix of eq. 6, which depends on neither the training set nor the light level.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the scene. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    observer
        A name from `chromanoise.spectra.OBSERVERS`; other methods take that of the training set.
    """
    return kernel_matrix(sensor, exposure, metric, observer)


def least_squares(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
) -> ColorMatrix:
    """The matrix of least color error over the training set, noise ignored: E|C M - XYZ|^2.

    Where channels are linearly dependent, the solution with the smallest gains relative to white.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the scene. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.

    Raises
    ------
    InputError
        If set and sensor have different grids, or a channel is zero at every wavelength.
    """
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    made_by = f"least squares ({training.source})"
    return _penalized(sensor, exposure, metric, seen, np.zeros_like(seen.noise_e2), made_by)


def white_preserving(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
) -> ColorMatrix:
    """Least squares among the matrices that are exact on the perfect white.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the scene. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.

    Raises
    ------
    InputError
        As `least_squares`, and if no channel receives light from the lamp.

    Notes
    -----
    Finlayson & Drew, "White-point preserving color correction" (CIC5, 1997). Solved in the null
    space of the constraint, which gives the same matrix as its Lagrange (KKT) system.
    """
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    check.positive(
        f"white of {sensor.name} in {training.illuminant.name}", "e-", seen.white_e.max()
    )
    root = np.sqrt(seen.share)[:, None]
    relative = seen.electrons / seen.scale  # the white is a row of ones
    ones = (seen.white_e > 0).astype(np.float64)
    direction = ones / np.linalg.norm(ones)
    free = svd("white", direction[None])[2][1:].T  # spans the null space of the white
    fixed = np.outer(seen.white_xyz, ones / ones.sum())
    made_by = f"white-preserving ({training.source})"
    left, right = root * (relative @ free), root * (seen.xyz - relative @ fixed.T)
    rest, *_ = lstsq(_over_white(made_by, sensor, seen), left, right, rcond=RANK_TOLERANCE)
    matrix = (fixed + (free @ rest).T) / seen.scale
    framed = kernel_matrix(sensor, exposure, metric, seen.observer)
    return replace(framed, matrix=matrix, made_by=made_by)


def lmmse(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
) -> ColorMatrix:
    """The matrix of least expected squared error, color and noise together, at one light level.

    Parameters
    ----------
    training
        The prior, K = E[L L^T] over the set.
    level_lux
        Illuminance on the set; D is the mean covariance of the readings there. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.

    Raises
    ------
    InputError
        As `least_squares`.

    Notes
    -----
    C = H^T K F (F^T K F + D)^-1, the Wiener filter (Shimano, "Recovery of spectral reflectances
    of objects being imaged without prior knowledge", IEEE Trans. Image Process. 15 (2006), 1848).
    """
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    made_by = f"LMMSE at {level_lux:g} lx ({training.source})"
    return _penalized(sensor, exposure, metric, seen, seen.noise_e2, made_by)


def lmmse_over_light(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    level_lux: Float[Array, " k"],
    *,
    weight: float = 1.0,
) -> Float[Array, "k 3 p"]:
    """The matrices of `lmmse` for many light levels at once. [lx/e-]

    The light level only scales the training set, so the set is reduced to p equations once.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminances on the set, > 0. [lx]
    weight
        Weight of the noise, as in `noise_regularized`. [1]

    Raises
    ------
    InputError
        As `least_squares`, or if a level is not positive or the weight negative.
    """
    levels = check.non_negative("level_lux", "lx", level_lux)
    check.positive("smallest level_lux", "lx", float(levels.min()))
    share = check.not_negative("weight of the noise", "1", weight)
    seen = training_response(training, sensor, exposure, level_lux=1.0)
    scale, (electrons, xyz) = seen.scale, seen.weighted
    what = _over_white("LMMSE over light", sensor, seen)
    q, r = qr(what, electrons / scale)
    light = levels[:, None, None]
    noise = mean_noise_covariance(seen.electrons, seen.share, sensor, exposure, light=levels)
    left = np.concatenate([light * r, covariance_root(what, share * noise) / scale], axis=1)
    nothing = np.zeros((levels.size, scale.size, 3))
    right = np.concatenate([light * (q.T @ xyz), nothing], axis=1)
    solution = pinv(what, left, rcond=RANK_TOLERANCE) @ right
    return np.asarray(np.swapaxes(solution, -1, -2) / scale)


def ridge(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    strength: float,
) -> ColorMatrix:
    """Least squares with a penalty on the gains, equal for all channels.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the scene. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    strength
        Strength s of the penalty s tr(E[M M^T])/p |C|^2, relative to the mean squared electrons;
        0 is least squares. [1]

    Raises
    ------
    InputError
        As `least_squares`, and if the strength is negative.
    """
    share = check.not_negative("strength of ridge", "1", strength)
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    square = float((seen.share @ seen.electrons**2).mean())
    made_by = f"ridge {strength:g} ({training.source})"
    penalty = share * square * np.eye(len(sensor.names))
    return _penalized(sensor, exposure, metric, seen, penalty, made_by)


def noise_regularized(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    weight: float,
) -> ColorMatrix:
    """The matrix of least squared color error plus ``weight`` times noise variance, both in XYZ.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the scene. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    weight
        Weight of tr(C D C^T), D the covariance of the readings averaged over the set: 0 is least
        squares, 1 LMMSE. [1]

    Raises
    ------
    InputError
        As `least_squares`, and if the weight is negative.

    Notes
    -----
    Vora & Herley, "Trade-offs between color saturation and noise sensitivity in image sensors"
    (ICIP 1998), with shot noise in D.
    """
    check.not_negative("weight of the noise", "1", weight)
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    made_by = f"noise weighted {weight:g} at {level_lux:g} lx ({training.source})"
    return _penalized(sensor, exposure, metric, seen, weight * seen.noise_e2, made_by)


def pareto(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    weights: Float[Array, " q"],
    *,
    level_lux: float,
) -> ParetoCurve:
    """The curve of color error against noise, by one singular value decomposition.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    weights
        Weights of the noise, as in `noise_regularized`. [1, (q,)]
    level_lux
        Illuminance on the scene. [lx]

    Raises
    ------
    InputError
        If a weight is negative, set and sensor have different grids, or no channel receives light.

    Notes
    -----
    In noise-whitened channels A W = U s V^T with W^T D W = 1, and
    C(w) = B^T U diag(s / (s^2 + w)) V^T W^T.
    """
    weight = check.non_negative("weights of the noise", "1", weights)
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    if not seen.white_e.max() > 0:
        raise InputError(
            f"sensor {sensor.name}",
            "must have a channel that sees the lamp, as its white is preserved",
            value=training.illuminant.name,
            found=f"sees no light of {training.illuminant.name}",
            remedy="take another lamp",
        )
    matrices = _along(seen, weight, _over_white("Pareto curve", sensor, seen))
    error = seen.electrons @ np.swapaxes(matrices, -1, -2) - seen.xyz
    luminance = matrices[:, 1]
    white_noise = with_noise(seen.white_e, sensor, exposure).covariance
    white_variance = np.einsum("qp,pr,qr->q", luminance, white_noise, luminance)
    return ParetoCurve(
        weight=weight,
        matrix=matrices,
        color_error_rms=np.sqrt(np.einsum("k,qkc->q", seen.share, error**2)),
        noise_rms=np.sqrt(np.einsum("qcp,pr,qcr->q", matrices, seen.noise_e2, matrices)),
        delta_e=_mean_delta_e(seen, matrices),
        snr_y_db=decibel(np.abs(luminance @ seen.white_e) / np.sqrt(white_variance)),
    )


def training_color_error(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    matrix: ColorMatrix,
    *,
    level_lux: float,
) -> float | None:
    """Mean CIE 1976 color difference of a matrix over a training set, as in `pareto`. [1]

    ``None`` where X, Y or Z of the sensor's white is not above 0.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    matrix
        A color matrix of that sensor; the true colors are those of its observer.
    level_lux
        Illuminance on the set. [lx]

    Raises
    ------
    InputError
        If set and sensor have different grids.
    """
    training = replace(training, observer=matrix.observer)
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    return _mean_delta_e(seen, matrix.matrix[None])[0]


def _penalized(
    sensor: Sensor,
    exposure: Exposure,
    metric: Metric,
    seen: TrainingResponse,
    penalty_e2: Float[Array, "p p"],
    made_by: str,
) -> ColorMatrix:
    """C of least E|C M - XYZ|^2 + tr(C P C^T), with the covariance P as ``penalty_e2``."""
    what = _over_white(made_by, sensor, seen)
    matrix = penalized_matrix(what, *seen.weighted, penalty_e2, scale=seen.scale)
    framed = kernel_matrix(sensor, exposure, metric, seen.observer)
    return replace(framed, matrix=matrix, made_by=made_by)


def penalized_matrix(
    what: str,
    electrons: Float[Array, "k p"],
    xyz: Float[Array, "k 3"],
    penalty_e2: Float[Array, "p p"],
    *,
    scale: Float[Array, " p"],
) -> Float[Array, "3 p"]:
    """C of least |M C^T - XYZ|^2 + tr(C P C^T), with the covariance P as ``penalty_e2``. [lx/e-]

    Solved as stacked equations, because the normal equations would square the condition number.

    Parameters
    ----------
    what
        Name of the equations in error messages.
    electrons, xyz
        The training set, each row times the root of its share. [e-], [lx]
    penalty_e2
        Covariance that penalizes gains. [e-^2]
    scale
        Electrons per channel, relative to which singular values are compared. [e-]

    Raises
    ------
    InputError
        If a number is not finite.
    """
    left = np.vstack([electrons, covariance_root(what, penalty_e2)]) / scale
    right = np.vstack([xyz, np.zeros((scale.size, 3))])
    solution, *_ = lstsq(what, left, right, rcond=RANK_TOLERANCE)
    return np.asarray(solution.T / scale)


def _over_white(made_by: str, sensor: Sensor, seen: TrainingResponse) -> str:
    """Name of the equations of a matrix in error messages."""
    return f"{made_by} for {sensor.name}, whose white has at least {seen.white_e.min():.3g} e-"


def _along(seen: TrainingResponse, weight: Float[Array, " q"], what: str) -> Array:
    """The matrices of least E|C M - XYZ|^2 + w tr(C D C^T)."""
    white = whitening(what, seen.noise_e2)  # 0 without noise, where there is no signal either
    electrons, xyz = seen.weighted
    u, s, vt = svd(what, electrons @ white, full_matrices=False)
    kept = s > RANK_TOLERANCE * s[0]
    gain = np.where(kept, s, 0.0) / np.where(kept, s**2 + weight[:, None], 1.0)
    return np.asarray(((xyz.T @ u) * gain[:, None, :]) @ vt @ white.T)


def _mean_delta_e(seen: TrainingResponse, matrices: Array) -> tuple[float | None, ...]:
    whites = matrices @ seen.white_e
    known = (whites > 0).all(axis=1) & (seen.white_xyz > 0).all()
    white = np.where(whites > 0, whites, 1.0)[:, None]
    balanced = seen.electrons @ np.swapaxes(matrices, -1, -2) / white
    truth = balanced_cielab(seen.xyz / np.where(seen.white_xyz > 0, seen.white_xyz, 1.0))
    errors = cie1976_difference(truth, balanced_cielab(balanced))
    means = (errors @ seen.share).tolist()
    return tuple(mean if defined else None for mean, defined in zip(means, known, strict=True))


_HALVINGS = 64  # of a bracket in logarithms, down to rounding


def bounded_psi(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    limit: float,
) -> ColorMatrix:
    """Least squares among the matrices whose noise gain Psi on the white is at most ``limit``.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the scene. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    limit
        Upper limit of `noise_gain` of the `white_normalized` matrix. [1]

    Raises
    ------
    InputError
        As `least_squares`, if the limit is not positive or the white has an X, Y or Z of 0.

    Notes
    -----
    US 5,609,978 (Kodak), whose Psi and its limit of 6.5 are for rows in RGB; here rows are X, Y and
    Z over those of the white. The problem is convex: each row is a ridge solution whose strength
    times its norm is the common multiplier over the square of the white, found by bisection from
    the side within the limit.
    """
    check.positive("limit of Psi", "1", limit)
    free = least_squares(sensor, exposure, training, level_lux=level_lux, metric=metric)
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    normalized = white_normalized(free.matrix, seen.white_e, seen.white_xyz)
    made_by = f"Psi at most {limit:g} ({training.source})"
    if noise_gain(normalized) <= limit:
        return replace(free, made_by=made_by)
    rows = _rows_within(seen, limit)
    matrix = rows * seen.white_xyz[:, None] / seen.scale
    return replace(free, matrix=matrix, made_by=made_by)


def white_normalized(
    matrix: Float[Array, "c p"], white_e: Float[Array, " p"], white_xyz: Float[Array, " c"]
) -> Float[Array, "c p"]:
    """The matrix from raw relative to white to color relative to white.

    Its rows sum to 1 where the matrix preserves the white.

    Parameters
    ----------
    matrix
        The color matrix. [lx/e-]
    white_e
        Electrons of the white in each channel. [e-]
    white_xyz
        X, Y, Z of the white. [lx]

    Raises
    ------
    InputError
        If a coordinate of the white is not above 0.

    Examples
    --------
    >>> white_normalized(np.array([[0.5, 0.1]]), np.array([1.0, 10.0]), np.array([2.0]))
    array([[0.25, 0.5 ]])
    """
    if not (white_xyz > 0).all():
        found = white_xyz.tolist()
        raise InputError(
            "white_xyz",
            "must be > 0 in every coordinate to normalize a matrix",
            value=found,
            found=f"is {found}",
            remedy="take a lamp with light at all visible wavelengths",
        )
    return np.asarray(matrix * white_e / white_xyz[:, None])


def noise_gain(matrix: Float[Array, "c p"]) -> float:
    """Kodak's Psi: the sum of the norms of the rows, noise out for equal unit noise in. [1]

    Parameters
    ----------
    matrix
        White-normalized color matrix (`white_normalized`). [1]

    Notes
    -----
    US 5,609,978 (Kodak); docs/numbers.md lists the numbers of its three filter sets.

    Examples
    --------
    >>> noise_gain(np.array([[3.0, -4.0], [0.0, 1.0]]))
    6.0
    """
    return float(np.linalg.norm(matrix, axis=1).sum())


def _rows_within(seen: TrainingResponse, limit: float) -> Float[Array, "3 p"]:
    """The white-normalized rows of least E|C M - XYZ|^2 whose norms add up to ``limit``."""
    electrons, xyz = seen.weighted
    u, s, vt = svd(
        "training set relative to the white", electrons / seen.scale, full_matrices=False
    )
    kept = np.where(s > RANK_TOLERANCE * s[0], s, 0.0)  # dependent channels amplify rounding
    answer = kept * ((xyz / seen.white_xyz).T @ u)  # V^T E[x y]
    emptying = seen.white_xyz**2 * np.linalg.norm(answer, axis=1)  # multipliers

    def rows(log_share: float) -> Float[Array, "3 p"]:
        pull = np.exp(log_share) * emptying.max() / seen.white_xyz**2
        return _pulled(answer, s, pull) @ vt

    low, high = np.log(1e-18), 0.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if noise_gain(rows(middle)) > limit else (low, middle)
    return rows(high)


def _pulled(
    answer: Float[Array, "3 r"], s: Float[Array, " r"], pull: Float[Array, " 3"]
) -> Float[Array, "3 r"]:
    """Per row the minimum of (n - n0)^T S (n - n0) / 2 + pull |n|, S = diag(s^2), S n0 = answer.

    Stationary where n = answer / (s^2 + r) with r |n| = pull; r |n| rises with r.
    """
    left = pull < np.linalg.norm(answer, axis=1) * (1 - 1e-15)
    low, high = np.full(3, np.log(1e-30)), np.full(3, np.log(1e30))
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        strength = np.exp(middle)
        norm = np.linalg.norm(answer / (s**2 + strength[:, None]), axis=1)
        short = strength * norm < pull
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return np.asarray(left[:, None] * answer / (s**2 + np.exp(high)[:, None]))
