"""Training sets for color matrices: reflectances, and their electrons and colors."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from chromanoise.base import Array, Float, InputError, check, dataclass, eigh, kept
from chromanoise.noise import Exposure, expected_electrons, mean_noise_covariance
from chromanoise.sensor import Sensor
from chromanoise.spectra import (
    DEFAULT_OBSERVER,
    INFRARED_FROM_NM,
    Illuminant,
    Metric,
    Scene,
    color_axes,
    colorchecker,
    flat_field,
    known_observer,
    light,
)

_FEWEST_E = 1e-280  # of a white; noise over fewer electrons overflows double precision
_KEPT_VARIANCE = 1e-12  # of the largest component of a smoothness prior; less is rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class Training:
    """``k`` reflectances under one lamp, to which a color matrix is fitted.

    Attributes
    ----------
    illuminant
        The lamp, at one lux; its grid is that of the reflectances.
    reflectance
        One row per reflectance, >= 0. [1]
    names
        Name of each reflectance.
    source
        Where the reflectances come from.
    weights
        Weight of each reflectance, >= 0, in any unit; ``None`` for equal weights.
    notes
        Processing steps after loading.
    observer
        The observer whose X, Y, Z a matrix is fitted to, from `chromanoise.spectra.OBSERVERS`.

    Raises
    ------
    InputError
        If there is no reflectance, one is negative, the shapes do not match, or there is no
        observer of that name.
    """

    illuminant: Illuminant
    reflectance: Float[Array, "k n"]
    names: tuple[str, ...]
    source: str
    weights: Float[Array, " k"] | None = None
    notes: tuple[str, ...] = ()
    observer: str = DEFAULT_OBSERVER

    def __post_init__(self) -> None:
        object.__setattr__(self, "observer", known_observer(self.observer))
        where = f"reflectance of {self.source}"
        rho = check.non_negative(where, "1", self.reflectance)
        full = rho.ndim == 2 and rho.shape[0] > 0
        check.shape(where, rho, full, "must have shape (reflectances, wavelengths)")
        check.same_length(
            "wavelengths", illuminant=self.illuminant.grid.n, reflectance=rho.shape[1]
        )
        check.same_length("reflectances", names=len(self.names), reflectance=rho.shape[0])
        object.__setattr__(self, "names", check.distinct(f"names of {self.source}", self.names))
        check.keep(self, reflectance=rho)
        if self.weights is None:
            return
        weights = check.non_negative(f"weights of {self.source}", "1", self.weights)
        check.same_length("reflectances", names=len(self.names), weights=weights.size)
        check.positive(f"sum of the weights of {self.source}", "1", float(weights.sum()))
        check.keep(self, weights=weights)


@dataclass(frozen=True, kw_only=True, eq=False)
class TrainingResponse:
    """Electrons of the sensor and X, Y, Z of an observer for a training set.

    Attributes
    ----------
    share
        Weight of each reflectance; the sum is 1.
    electrons
        Expected electrons, without noise. [e-]
    xyz
        X, Y, Z for the observer. [lx]
    white_e, white_xyz
        The same for a perfect white. [e-], [lx]
    noise_e2
        Noise covariance of the channels, averaged over the set. [e-^2]
    observer
        The observer of the training set.
    """

    share: Float[Array, " k"]
    electrons: Float[Array, "k p"]
    xyz: Float[Array, "k 3"]
    white_e: Float[Array, " p"]
    white_xyz: Float[Array, " 3"]
    noise_e2: Float[Array, "p p"]
    observer: str = DEFAULT_OBSERVER

    @property
    def scale(self) -> Float[Array, " p"]:
        """Electrons of the white, 1 where there are none; makes equations well conditioned."""
        return np.where(self.white_e > 0, self.white_e, 1.0)

    @property
    def weighted(self) -> tuple[Float[Array, "k p"], Float[Array, "k 3"]]:
        """Electrons and X, Y, Z times the roots of the shares: sums of squares are means."""
        root = np.sqrt(self.share)[:, None]
        return root * self.electrons, root * self.xyz

    def __post_init__(self) -> None:
        check.same_length("reflectances", electrons=len(self.electrons), xyz=len(self.xyz))
        check.same_length("channels", white=self.white_e.size, electrons=self.electrons.shape[1])
        check.freeze(self, "share", "electrons", "xyz", "white_e", "white_xyz", "noise_e2")


def chart_training(illuminant: Illuminant) -> Training:
    """The 24 patches of a ColorChecker, measured from 400 to 1050 nm.

    Raises
    ------
    InputError
        If the illuminant's grid extends beyond 400-1050 nm.
    """
    chart = colorchecker(illuminant.grid)
    return Training(
        illuminant=illuminant,
        reflectance=chart.values.T,
        names=chart.names,
        source="ColorChecker",
        notes=chart.notes,
    )


def smooth_training(
    illuminant: Illuminant, *, mean: float = 0.5, sd: float = 0.1, width_nm: float = 50.0
) -> Training:
    """Reflectances with exactly the mean and covariance of a smoothness prior.

    Around a gray of ``mean``, K_ij = sd^2 exp(-(l_i - l_j)^2 / (2 width^2)). The set is not random:
    the principal components of K are added with the signs of a Hadamard matrix, whose columns are
    orthogonal and sum to zero, so the set has no sampling error.

    Parameters
    ----------
    illuminant
        The lamp; its grid is that of the prior.
    mean, sd
        Mean gray and standard deviation at every wavelength. [1]
    width_nm
        Correlation length of the reflectances. [nm]

    Raises
    ------
    InputError
        If a reflectance is outside 0 .. 1.

    Notes
    -----
    Components below 1e-12 of the largest are omitted.

    Examples
    --------
    >>> from chromanoise.spectra import Grid, equal_energy
    >>> prior = smooth_training(equal_energy(Grid.uniform(500, 600, 50)), sd=0.1, width_nm=50)
    >>> np.cov(prior.reflectance.T, bias=True).round(6)      # 0.01, 0.01 e^-1/2, 0.01 e^-2
    array([[0.01    , 0.006065, 0.001353],
           [0.006065, 0.01    , 0.006065],
           [0.001353, 0.006065, 0.01    ]])
    """
    at = illuminant.grid.wavelength_nm
    width = check.positive("width_nm of the smoothness prior", "nm", width_nm)
    spread = check.not_negative("sd of the smoothness prior", "1", sd)
    prior = np.exp(-0.5 * ((at[:, None] - at) / width) ** 2)
    variance, directions = eigh("smoothness prior", prior)
    kept = variance > _KEPT_VARIANCE * variance[-1]
    components = (directions[:, kept] * np.sqrt(variance[kept])).T
    signs = _balanced_signs(len(components))
    reflectance = mean + spread * signs @ components
    outside = max(-float(reflectance.min()), float(reflectance.max()) - 1.0)
    if outside > 0:
        raise InputError(
            f"smoothness prior of mean {mean:g} and sd {sd:g}",
            "must stay within reflectances of 0 to 1",
            value=outside,
            found=f"exceeds them by {outside:.3g}",
            remedy=("take a smaller sd", "a mean nearer to 0.5"),
        )
    return Training(
        illuminant=illuminant,
        reflectance=reflectance,
        names=tuple(f"smooth {i}" for i in range(len(reflectance))),
        source=f"smoothness prior, mean {mean:g}, sd {sd:g}, {width_nm:g} nm",
    )


def nir_diverse(
    training: Training,
    *,
    levels: Sequence[float] = (0.0, 0.5, 1.0),
    edge_nm: float = INFRARED_FROM_NM,
) -> Training:
    """Each reflectance, and copies with other near-infrared values, which are visual metamers.

    Beyond ``edge_nm`` the copies replace the measured values by a straight line from each of
    ``levels`` to each of ``levels``. So light there carries no color information for a matrix that
    is fitted to the set.

    Parameters
    ----------
    training
        A training set whose grid extends beyond ``edge_nm``.
    levels
        Reflectances at the edge and at the end of the grid. [1]
    edge_nm
        End of the visible range. [nm]

    Raises
    ------
    InputError
        If fewer than two wavelengths lie beyond the edge.
    """
    at = training.illuminant.grid.wavelength_nm
    beyond = at > edge_nm
    if beyond.sum() < 2:
        raise InputError(
            "grid of the training set",
            f"must have two wavelengths beyond {edge_nm:g} nm for near-infrared metamers",
            value=training.illuminant.grid,
            found=f"is {training.illuminant.grid}",
            remedy="take one that reaches to 1050 nm",
        )
    ramp = (at[beyond] - at[beyond][0]) / (at[beyond][-1] - at[beyond][0])
    lines = list(product(levels, repeat=2))
    variants = np.repeat(training.reflectance[None], 1 + len(lines), axis=0)
    for variant, (a, b) in zip(variants[1:], lines, strict=True):
        variant[:, beyond] = a + (b - a) * ramp
    tags = ["", *(f", NIR {a:g} to {b:g}" for a, b in lines)]
    weights = training.weights
    return replace(
        training,
        reflectance=variants.reshape(-1, at.size),
        names=tuple(name + tag for tag in tags for name in training.names),
        source=f"{training.source}, NIR-diverse",
        weights=None if weights is None else np.tile(weights, len(tags)),
        notes=(*training.notes, f"each also with {len(lines)} lines beyond {edge_nm:g} nm"),
    )


def shares(training: Training) -> Float[Array, " k"]:
    """Weight of each reflectance, with sum 1."""
    k = len(training.names)
    weights = np.ones(k) if training.weights is None else training.weights
    return np.asarray(weights / weights.sum())


def light_second_moment(
    training: Training, *, level_lux: float, metric: Metric = "quanta"
) -> Float[Array, "n n"]:
    """K = E[L L^T] of the light from the set, about zero and not about its mean.

    Parameters
    ----------
    level_lux
        Illuminance on the set. [lx]
    metric
        Metric of the space of spectra. [(unit of light)^2]
    """
    rows = light(_scene(training, level_lux), metric)
    return np.asarray(rows.T @ (shares(training)[:, None] * rows))


def training_response(
    training: Training, sensor: Sensor, exposure: Exposure, *, level_lux: float
) -> TrainingResponse:
    """Electrons, colors and mean noise of a training set, without clipping as in the paper.

    D is the covariance averaged over the set: diag(E[M]) + s_rn^2 for shot noise and read noise,
    as shot noise is linear in light.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the scene. [lx]

    Raises
    ------
    InputError
        If the set and the sensor have different grids, or a channel collects too few electrons
        from the lamp's light.
    """
    seen = _seen(training, level_lux)
    electrons = expected_electrons(seen.scene, sensor, exposure)
    white_e = expected_electrons(seen.white, sensor, exposure)
    for name, mean_e in zip(sensor.names, white_e, strict=True):
        if 0 < mean_e < _FEWEST_E:
            raise InputError(
                f"channel {name} of {sensor.name}",
                f"must collect at least {_FEWEST_E:g} e- of a white to train a matrix",
                value=float(mean_e),
                found=f"collects {mean_e:.3g} in {training.illuminant.name}",
                remedy=(
                    "choose more light, a longer time or a wider aperture",
                    "omit the channel",
                ),
            )
    return TrainingResponse(
        share=seen.share,
        electrons=electrons,
        xyz=seen.xyz,
        white_e=white_e,
        white_xyz=seen.white_xyz,
        noise_e2=mean_noise_covariance(electrons, seen.share, sensor, exposure),
        observer=training.observer,
    )


class _Seen(NamedTuple):
    """A training set and its white at a light level, and their X, Y, Z. [lx]"""

    scene: Scene
    white: Scene
    share: Float[Array, " k"]
    xyz: Float[Array, "k 3"]
    white_xyz: Float[Array, " 3"]


@kept  # the same for all sensors of a comparison
def _seen(training: Training, level_lux: float) -> _Seen:
    scene = _scene(training, level_lux)
    white = flat_field(training.illuminant, level_lux=level_lux)
    axes = color_axes(training.illuminant.grid, "energy", training.observer)
    xyz, white_xyz = (check.frozen(light(one, "energy") @ axes) for one in (scene, white))
    return _Seen(scene, white, check.frozen(shares(training)), xyz, white_xyz)


def _scene(training: Training, level_lux: float) -> Scene:
    return Scene(
        illuminant=training.illuminant, level_lux=level_lux, reflectance=training.reflectance
    )


def _balanced_signs(columns: int) -> Float[Array, "k r"]:
    """+1 and -1 in orthogonal columns that sum to zero (Sylvester's construction)."""
    signs = np.ones((1, 1))
    while len(signs) <= columns:
        signs = np.kron(np.array([[1.0, 1.0], [1.0, -1.0]]), signs)
    return signs[:, 1 : columns + 1]
