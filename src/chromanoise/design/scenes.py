"""The scenes of a design: light and exposure, the color matrix, and the arrays of a batch."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from chromanoise._check import Array
from chromanoise._linalg import qr, svd, unit_columns
from chromanoise._shapes import Float, Integer
from chromanoise.analysis import DEFAULT_METHOD, MatrixMaker, matrix_makers
from chromanoise.analysis.priors import DEFAULT_PRIOR, training_named
from chromanoise.analysis.separation import pairs_of
from chromanoise.color.differences import balanced_cielab
from chromanoise.color.training import shares
from chromanoise.errors import InputError
from chromanoise.exposure import OperatingPoint, measurement_vectors
from chromanoise.noise import demand_independent_channels
from chromanoise.scene import Scene, light
from chromanoise.spectra import Metric, Spectra, chart_on, color_axes, is_infrared

_ROUNDING = 1e-16  # of the largest singular value of a training set


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DesignScene:
    """Light, exposure and color matrix with which every candidate of a design is evaluated.

    Attributes
    ----------
    point
        Light, exposure, observer and chart. Its sensor gives the pixel and the converter; its
        curves are replaced by those of a candidate.
    name
        Name of the scene.
    matrix
        A name from `chromanoise.analysis.METHODS`, with its parameter: ``ridge=0.01``.
    metric
        Metric of the space of spectra.
    prior
        Training set of a trained matrix: a name, or reflectances on the grid.

    Raises
    ------
    InputError
        If there is no such matrix or prior, light and sensor have different grids, or crosstalk
        after counting correlates the channels.
    """

    point: OperatingPoint
    name: str = ""
    matrix: str = DEFAULT_METHOD
    metric: Metric = "quanta"
    prior: str | Spectra = DEFAULT_PRIOR

    def __post_init__(self) -> None:
        matrix_makers([self.matrix], self.metric, prior=self.prior)
        demand_independent_channels(self.point.sensor)
        lit, own = self.point.illuminant.grid, self.point.sensor.grid
        if lit != own:
            raise InputError(
                f"scene {self.name}",
                "must have the grid of the sensor",
                value=lit,
                found=f"is on {lit} and {self.point.sensor.name} on {own}",
            )

    @property
    def maker(self) -> MatrixMaker:
        """The method of the color matrix."""
        return matrix_makers([self.matrix], self.metric, prior=self.prior)[self.matrix.strip()]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SceneArrays:
    """What a batch of candidates needs of a scene. Electrons are those of a QE of 1.

    Attributes
    ----------
    white_e, infrared_e
        Electrons per wavelength of a perfect white, and of its part from 700 nm on. [e-]
    chart_e
        Of the patches of the chart. [e-]
    paired_e
        Of the patches of the pairs; ``None`` where they are those of the chart. [e-]
    pairs
        Indices of the two patches of each pair.
    training_e, training_xyz
        The training set, weighted by the roots of its shares and reduced to as many rows as are
        independent, with their X, Y, Z: sums over the set are sums over these rows. [e-], [lx]
    training_mean_e
        Mean of the training set. [e-]
    basis
        The measurement vector f of a QE of 1. [e- per unit of light]
    axes, orthonormal_axes
        The color axes H, and an orthonormal basis of their span.
    chart_lab
        L*, a*, b* of the chart for the observer.
    white_y
        Y of a perfect white for the observer. [lx]
    """

    white_e: Float[Array, " n"]
    infrared_e: Float[Array, " n"]
    chart_e: Float[Array, "k n"]
    paired_e: Float[Array, "l n"] | None
    pairs: Integer[Array, "pairs 2"]
    training_e: Float[Array, "t n"]
    training_xyz: Float[Array, "t 3"]
    training_mean_e: Float[Array, " n"]
    basis: Float[Array, " n"]
    axes: Float[Array, "n 3"]
    orthonormal_axes: Float[Array, "n 3"]
    chart_lab: Float[Array, "k 3"]
    white_y: float


def candidate_point(
    scene: DesignScene,
    qe: Float[Array, "n p"],
    *,
    time_s: float | None = None,
    **pixel: float,
) -> OperatingPoint:
    """The operating point of a scene with another sensor in place of its own.

    Parameters
    ----------
    scene
        Light, exposure, pixel and converter.
    qe
        Electrons per photon, crosstalk before counting included. [e-/photon]
    time_s
        In place of that of the scene. [s]
    pixel
        Fields of `chromanoise.sensor.Pixel` in place of those of the scene.
    """
    point = scene.point
    own, p = point.sensor, qe.shape[1]
    same = p == len(own.names)
    sensor = replace(
        own,
        qe=qe,
        names=own.names if same else tuple(f"channel {i + 1}" for i in range(p)),
        mosaic=own.mosaic if same else None,
        crosstalk=None,
        pixel=replace(own.pixel, **pixel),
    )
    exposure = point.exposure if time_s is None else replace(point.exposure, time_s=float(time_s))
    return replace(point, sensor=sensor, exposure=exposure)


@lru_cache(maxsize=32)
def scene_arrays(scene: DesignScene) -> SceneArrays:
    """The arrays of a scene, computed once."""
    point, grid = scene.point, scene.point.illuminant.grid
    one = replace(
        point.sensor,
        qe=np.ones((grid.n, 1)),
        names=("all",),
        mosaic=None,
        stacked=False,
        crosstalk=None,
    )
    photons = measurement_vectors(one, point.exposure, "quanta")[:, 0]
    basis = measurement_vectors(one, point.exposure, scene.metric)[:, 0]

    def electrons(reflectance: Float[Array, "k n"]) -> Float[Array, "k n"]:
        return photons * light(_scene(point, reflectance), "quanta")

    def xyz(reflectance: Float[Array, "k n"]) -> Float[Array, "k 3"]:
        return light(_scene(point, reflectance), "energy") @ color_axes(
            grid, "energy", point.observer
        )

    chart = chart_on(grid, point.chart).values.T
    white = np.ones((1, grid.n))
    infrared = is_infrared(grid).astype(np.float64)
    own_pairs = pairs_of(point)
    training = training_named(scene.prior, point.illuminant, point.observer)
    share, rho = shares(training), training.reflectance
    root = np.sqrt(share)[:, None]
    u, size, vt = svd("training set", root * electrons(rho), full_matrices=False)
    kept = size > _ROUNDING * size[0]
    axes = color_axes(grid, scene.metric, point.observer)
    orthonormal, _ = qr("color axes", unit_columns(axes)[0])
    white_xyz, chart_xyz = xyz(white)[0], xyz(chart)
    return SceneArrays(
        white_e=electrons(white)[0],
        infrared_e=electrons(infrared[None])[0],
        chart_e=electrons(chart),
        paired_e=None if point.pairs is None else electrons(own_pairs.patches.values.T),
        pairs=own_pairs.indices,
        training_e=size[kept, None] * vt[kept],
        training_xyz=u[:, kept].T @ (root * xyz(rho)),
        training_mean_e=share @ electrons(rho),
        basis=basis,
        axes=axes,
        orthonormal_axes=orthonormal,
        chart_lab=balanced_cielab(chart_xyz / white_xyz),
        white_y=float(white_xyz[1]),
    )


def _scene(point: OperatingPoint, reflectance: Float[Array, "k n"]) -> Scene:
    return Scene(illuminant=point.illuminant, level_lux=point.level_lux, reflectance=reflectance)
