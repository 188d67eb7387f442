"""Root-polynomial color correction: curved, yet blind to exposure; with its noise."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import RANK_TOLERANCE
from chromanoise.color.matrices import XYZ
from chromanoise.color.training import Training, training_response
from chromanoise.exposure import Exposure
from chromanoise.noise import Measurement
from chromanoise.sensor import Sensor
from chromanoise.spectra import Metric


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RootPolynomial:
    """A matrix from root-polynomial terms of the raw electrons to color.

    Attributes
    ----------
    matrix
        One row per color coordinate, one column per term. [lx/e-]
    channels
        Names of the raw channels.
    coordinates
        Names of the rows.
    degree
        1: the channels; 2: also the root of each product of two channels.
    made_by
        Method and training set.
    metric
        In which light is a vector; the fit does not depend on it.
    """

    matrix: Float[Array, "c q"]
    channels: tuple[str, ...]
    coordinates: tuple[str, ...]
    degree: int
    made_by: str
    metric: Metric

    def __post_init__(self) -> None:
        matrix = _check.finite(f"{self.made_by} matrix", "lx/e-", self.matrix)
        p, pairs = len(self.channels), len(_pairs(len(self.channels), self.degree))
        _check.same_length("coordinates", names=len(self.coordinates), matrix=matrix.shape[0])
        _check.same_length("terms", channels_and_roots=p + pairs, matrix=matrix.shape[1])
        object.__setattr__(self, "matrix", _check.frozen(matrix))


def rooted(raw_mean: Float[Array, "*px p"], *, degree: int = 2) -> Float[Array, "*px q"]:
    """The channels and, at degree 2, the root of each product of two of them. [e-]

    Parameters
    ----------
    raw_mean
        Electrons, >= 0. [e-]
    degree
        1 or 2.

    Raises
    ------
    InputError
        If an entry is negative, or the degree is neither 1 nor 2.

    Notes
    -----
    Finlayson, Mackiewicz & Hurlbert, "Color correction using root-polynomial regression", IEEE
    Trans. Image Process. 24 (2015), 1460, https://doi.org/10.1109/TIP.2015.2405336, section III.

    Examples
    --------
    >>> rooted(np.array([1.0, 4.0, 9.0]))
    array([1., 4., 9., 2., 3., 6.])
    """
    mean = _check.non_negative("raw_mean", "e-", raw_mean)
    roots = [np.sqrt(mean[..., i]) * np.sqrt(mean[..., j]) for i, j in _pairs_of(mean, degree)]
    return np.concatenate([mean, *(root[..., None] for root in roots)], axis=-1)


def root_jacobian(raw_mean: Float[Array, "*px p"], *, degree: int = 2) -> Float[Array, "*px q p"]:
    """How each term of `rooted` changes with each channel. [1]

    Raises
    ------
    InputError
        If a channel is not above 0 where a root is taken: its slope is infinite there.

    Examples
    --------
    >>> root_jacobian(np.array([1.0, 4.0]))      # d sqrt(ab) = sqrt(b/a)/2 da + sqrt(a/b)/2 db
    array([[1.  , 0.  ],
           [0.  , 1.  ],
           [1.  , 0.25]])
    """
    mean = _check.non_negative("raw_mean", "e-", raw_mean)
    pairs = _pairs_of(mean, degree)
    if pairs and not (mean > 0).all():
        first = tuple(int(i) for i in np.argwhere(mean <= 0)[0])
        raise _check.InputError(
            f"the noise of a root needs raw_mean > 0 [e-], but it is 0 at index {first}; "
            "take degree 1 or a linear matrix there"
        )
    p = mean.shape[-1]
    jacobian = np.zeros((*mean.shape[:-1], p + len(pairs), p))
    jacobian[..., :p, :] = np.eye(p)
    for row, (i, j) in enumerate(pairs, start=p):
        ratio = np.sqrt(mean[..., j]) / np.sqrt(mean[..., i])
        jacobian[..., row, i], jacobian[..., row, j] = 0.5 * ratio, 0.5 / ratio
    return jacobian


def root_polynomial(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    degree: int = 2,
) -> RootPolynomial:
    """Root-polynomial correction of least color error over a training set.

    Parameters
    ----------
    sensor, exposure
        What looks, and how.
    training
        At least as many reflectances as terms, p + p (p - 1) / 2.
    level_lux
        Illuminance on the set; the fit does not depend on it. [lx]
    metric
        Recorded; the fit does not depend on it.
    degree
        1 (least squares) or 2.

    Raises
    ------
    InputError
        If set and sensor are not on one grid, or the set is smaller than the number of terms.

    Notes
    -----
    Finlayson, Mackiewicz & Hurlbert (2015), as `rooted`. Every term is of first order in light,
    so scaling the exposure scales XYZ.
    """
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    terms, white = rooted(seen.electrons, degree=degree), rooted(seen.white_e, degree=degree)
    if len(terms) < terms.shape[1]:
        raise _check.InputError(
            f"a root polynomial of {terms.shape[1]} terms needs as many reflectances, but "
            f"{training.source} has {len(terms)}; take a larger set or degree 1"
        )
    scale, root = np.where(white > 0, white, 1.0), np.sqrt(seen.share)[:, None]
    solution, *_ = np.linalg.lstsq(root * terms / scale, root * seen.xyz, rcond=RANK_TOLERANCE)
    return RootPolynomial(
        matrix=solution.T / scale,
        channels=sensor.names,
        coordinates=XYZ,
        degree=degree,
        made_by=f"root polynomial of degree {degree} ({training.source})",
        metric=metric,
    )


def root_polynomial_color(raw: Measurement, model: RootPolynomial) -> Measurement:
    """Color and its first-order covariance, through the Jacobian of the roots. [lx]

    The mean is that of the noiseless raw: the bias of a root, of second order in the noise, is
    not in it.

    Raises
    ------
    InputError
        If the channels differ, or a mean is negative, or is 0 where a root is taken.
    """
    _check.same_names("color", raw=raw.names, model=model.channels)
    slope = model.matrix @ root_jacobian(raw.mean, degree=model.degree)
    covariance = slope @ raw.covariance @ np.swapaxes(slope, -1, -2)
    return Measurement(
        mean=rooted(raw.mean, degree=model.degree) @ model.matrix.T,
        covariance=0.5 * (covariance + np.swapaxes(covariance, -1, -2)),
        names=model.coordinates,
        kind="".join(model.coordinates),
        unit="lx",
        metric=model.metric,
    )


def _pairs_of(mean: Float[Array, "*px p"], degree: int) -> list[tuple[int, int]]:
    return _pairs(mean.shape[-1], degree)


def _pairs(p: int, degree: int) -> list[tuple[int, int]]:
    """Which channels meet under a root."""
    if degree not in (1, 2):
        raise _check.InputError(f"degree of a root polynomial must be 1 or 2, but is {degree}")
    return list(combinations(range(p), 2)) if degree == 2 else []
