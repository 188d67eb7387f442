"""The fast objectives of many candidates at once: the last axis of arrays is that of candidates.

Complex arrays give derivatives (the complex step of Squire & Trapp, SIAM Rev. 40 (1998) 110). So
every function is analytic, and comparisons read the real part.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from chromanoise.apps.design.objectives import SNR10
from chromanoise.apps.design.parameters import Candidates, noise_of
from chromanoise.base import Array, Float, Inexact, InputError, Integer, qr, svd, unit_columns
from chromanoise.color import balanced_cielab, shares
from chromanoise.noise import OperatingPoint, demand_independent_channels, measurement_vectors
from chromanoise.sensor import code_range_e
from chromanoise.spectra import Metric, Scene, Spectra, chart_on, color_axes, is_infrared, light
from chromanoise.study import (
    DEFAULT_METHOD,
    DEFAULT_PRIOR,
    GRAY,
    MatrixMaker,
    matrix_makers,
    pairs_of,
    training_named,
)

NOISE_WEIGHTED = ("least-squares", "lmmse", "noise-regularized")
"""Matrices that differ in the weight of the noise alone."""
FULL = 1 + 1e-12
"""Share of full well above which a channel is saturated, as `chromanoise.noise.saturated`."""
_ROUNDING = 1e-16  # of the largest singular value of a training set
_LEAST_COLOR = 1e-6  # of Y of a white


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
        A name from `chromanoise.study.METHODS`, with its parameter: ``ridge=0.01``.
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
        _ = self.maker
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

    @property
    def method(self) -> str:
        """The name of the color matrix without its parameter."""
        return self.matrix.partition("=")[0].strip()

    @property
    def noise_weight(self) -> float:
        """Weight of the noise in a matrix of `NOISE_WEIGHTED`."""
        return dict(self.maker.parameters).get("weight", float(self.method == "lmmse"))

    @property
    def in_batches(self) -> bool:
        """Whether the matrices of many candidates are computed at once."""
        return self.method in (*NOISE_WEIGHTED, "ridge", "kernel")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SceneArrays:
    """What a batch of candidates needs of a scene. Electrons are those of a QE of 1.

    Attributes
    ----------
    white_e, infrared_e
        Electrons per wavelength of a perfect white, and of its part from 700 nm on. [e-]
    chart_e, paired_e
        Of the patches of the chart, and of those of the pairs. [e-]
    pairs
        Indices of the two patches of each pair.
    training_e, training_xyz
        The training set, weighted by the roots of its shares and reduced to as many rows as are
        independent, with their X, Y, Z: sums over the set are sums over these rows. [e-], [lx]
    training_mean_e
        Mean of the training set. [e-]
    basis
        The measurement vector f of a QE of 1. [e- per unit of light]
    axes
        The color axes H.
    orthonormal_axes
        An orthonormal basis of their span.
    white_and_axes_e, orthonormal_e
        Electrons of a white and f times each axis; f times the basis.
    chart_lab
        L*, a*, b* of the chart for the observer.
    white_y
        Y of a perfect white for the observer. [lx]
    """

    white_e: Float[Array, " n"]
    infrared_e: Float[Array, " n"]
    chart_e: Float[Array, "k n"]
    paired_e: Float[Array, "l n"]
    pairs: Integer[Array, "pairs 2"]
    training_e: Float[Array, "t n"]
    training_xyz: Float[Array, "t 3"]
    training_mean_e: Float[Array, " n"]
    basis: Float[Array, " n"]
    axes: Float[Array, "n 3"]
    white_and_axes_e: Float[Array, "4 n"]
    orthonormal_axes: Float[Array, "n 3"]
    orthonormal_e: Float[Array, "3 n"]
    chart_lab: Float[Array, "k 3"]
    white_y: float


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

    def lit(reflectance: Float[Array, "k n"], metric: Metric) -> Float[Array, "k n"]:
        own = Scene(illuminant=point.illuminant, level_lux=point.level_lux, reflectance=reflectance)
        return light(own, metric)

    def electrons(reflectance: Float[Array, "k n"]) -> Float[Array, "k n"]:
        return photons * lit(reflectance, "quanta")

    def xyz(reflectance: Float[Array, "k n"]) -> Float[Array, "k 3"]:
        return lit(reflectance, "energy") @ color_axes(grid, "energy", point.observer)

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
        paired_e=electrons(own_pairs.patches.values.T),
        pairs=own_pairs.indices,
        training_e=size[kept, None] * vt[kept],
        training_xyz=u[:, kept].T @ (root * xyz(rho)),
        training_mean_e=share @ electrons(rho),
        basis=basis,
        axes=axes,
        white_and_axes_e=np.vstack([electrons(white), axes.T * basis]),
        orthonormal_axes=orthonormal,
        orthonormal_e=orthonormal.T * basis,
        chart_lab=balanced_cielab(chart_xyz / white_xyz),
        white_y=float(white_xyz[1]),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Choices(Candidates):
    """Candidates whose channels are curves of a library.

    Inner products with the curves are computed once, not for each candidate.

    Attributes
    ----------
    index
        Columns of ``library``, one per channel.
    library
        The curves. [e-/photon]
    products
        Of what with the curves, by name; filled on first use.
    """

    qe: Any = None
    index: Integer[Array, "m p"]
    library: Float[Array, "n filters"]
    products: dict[str, Array] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.index)

    def some(self, which: Any) -> Candidates:
        """As `Candidates.some`."""
        return replace(self, index=self.index[which])

    def resolved(self) -> Candidates:
        """As `Candidates.resolved`."""
        return Candidates(qe=np.moveaxis(self.library[:, self.index], 0, 1))

    def product(self, name: str, of: Callable[[], Array]) -> Array:
        """A product with the curves."""
        if name not in self.products:
            self.products[name] = of()
        return self.products[name]


def noise_in(scene: DesignScene, candidates: Candidates) -> Inexact[Array, "5 m"]:
    """Law of the variance, electrons of a full channel, and factor on all electrons.

    Parameters
    ----------
    scene, candidates
        ``m`` candidates in a scene.
    """
    exposure, sensor = scene.point.exposure, scene.point.sensor
    time_s = candidates.time_s
    time_s = np.full(len(candidates), exposure.time_s) if time_s is None else time_s
    *law, dark_e = noise_of(sensor, time_s, candidates.pixel)
    well_e, range_e = sensor.pixel.full_well_e - dark_e, code_range_e(sensor)
    full_e = np.where(well_e.real < range_e, well_e, range_e)
    return np.stack([*law, full_e, time_s / exposure.time_s])


class Block:
    """What some candidates show in a scene; each part is computed on first use.

    Parameters
    ----------
    scene
        The scene.
    candidates
        ``m`` candidates of ``p`` channels.
    noise
        Of `noise_in`.
    matrices
        Color matrices (m 3 p) in place of those of the scene.
    """

    def __init__(
        self,
        scene: DesignScene,
        candidates: Candidates,
        noise: Inexact[Array, "5 m"],
        matrices: Array | None = None,
    ) -> None:
        self.scene, self.candidates, self.arrays = scene, candidates, scene_arrays(scene)
        *self.law, self.full_e, self.gain = noise
        self._same_gain = candidates.time_s is None
        share, m = candidates.pixel_share, len(candidates)
        self.spread: Array | float = 1.0
        if share is not None:
            self.spread = 1.0 / (share.shape[1] * share.T)
        self.independence = np.ones(m)
        """1 over the largest variance inflation of the equations that were solved."""
        self._seen: dict[str, Array] = {}
        if matrices is not None:
            self.matrix = np.moveaxis(matrices, 0, -1)

    def seen(self, name: str) -> Inexact[Array, "p rows m"]:
        """Electrons, or other inner products with rows of `SceneArrays`."""
        if name not in self._seen:
            rows, own = np.atleast_2d(getattr(self.arrays, name)), self.candidates
            if isinstance(own, Choices):
                table = own.product(name, lambda: rows @ own.library)
                found = np.stack([table[:, channel] for channel in own.index.T])
            else:
                found = rows @ self._qe.transpose(1, 2, 0)
            self._seen[name] = found if self._same_gain else self.gain * found
        return self._seen[name]

    @cached_property
    def _qe(self) -> Inexact[Array, "m p n"]:
        return np.ascontiguousarray(self.candidates.qe.transpose(0, 2, 1))

    @property
    def white_e(self) -> Inexact[Array, "p m"]:
        """Electrons of a perfect white. [e-]"""
        return self.seen("white_and_axes_e")[:, 0]

    @cached_property
    def fullness(self) -> Inexact[Array, " m"]:
        """Electrons of a white as a share of full well, fullest channel."""
        share = _highest(self.white_e) / self.full_e
        return np.where(self.full_e.real > 0, share, np.inf)

    def variance(self, mean: Inexact[Array, "p *r m"], squared: Any = None) -> Array:
        """Variance of electrons by the law of each candidate, from mean and mean square. [e-^2]"""
        floor, slope, square = self.law
        spread = self.spread
        if mean.ndim == 3 and not isinstance(spread, float):
            spread = spread[:, None]
        return (floor + slope * mean + square * (mean**2 if squared is None else squared)) * spread

    @cached_property
    def inverse_gram(self) -> Inexact[Array, "p p m"]:
        """The inverse of the inner products of the measurement vectors."""
        from chromanoise.apps.design.kernels import weighted_gram

        own, basis = self.candidates, self.arrays.basis
        if isinstance(own, Choices):
            curves = basis[:, None] * own.library
            table = own.product("gram", lambda: curves.T @ curves)
            gram = np.ascontiguousarray(table[own.index.T[:, None], own.index.T])
        else:
            gram = np.empty((own.qe.shape[2],) * 2 + (len(own),), self._qe.dtype)
            weighted_gram(self._qe, basis**2, gram)
        return self._inverse(self.gain**2 * gram)

    def _inverse(self, gram: Inexact[Array, "p p m"]) -> Inexact[Array, "p p m"]:
        from chromanoise.apps.design.kernels import inverse

        inverse(gram, self.independence)
        return gram

    @cached_property
    def matrix(self) -> Inexact[Array, "3 p m"]:
        """The color matrix."""
        if self.scene.method == "kernel":
            return np.einsum(
                "cjm,cdm->jdm", self.seen("white_and_axes_e")[:, 1:], self.inverse_gram
            )
        training_e = self.seen("training_e")
        gram = np.einsum("ctm,dtm->cdm", training_e, training_e)
        diagonal = np.einsum("ccm->cm", gram)  # a view
        if self.scene.method == "ridge":
            strength = dict(self.scene.maker.parameters)["strength"]
            diagonal += strength / len(gram) * diagonal.sum(axis=0)
        else:
            mean_e = self.seen("training_mean_e")[:, 0]
            own = self.candidates.noise_weight
            weight = self.scene.noise_weight if own is None else own
            diagonal += weight * self.variance(mean_e, diagonal.copy())
        inverse = self._inverse(gram)
        seen = np.einsum("tj,ctm->cjm", self.arrays.training_xyz, training_e)
        return np.einsum("cjm,cdm->jdm", seen, inverse)

    @cached_property
    def white_xyz(self) -> Inexact[Array, "3 m"]:
        """The color of a white; NaN where X, Y or Z is not above 0."""
        white = np.einsum("jcm,cm->jm", self.matrix, self.white_e)
        return np.where((white.real > 0).all(axis=0), white, np.nan)

    @cached_property
    def chart(self) -> tuple[Array, Array]:
        """L*, a*, b* of the chart (3 k m), and the slopes of the cube roots by shares of white."""
        return self._cielab(0.0)

    @cached_property
    def chart_with_black(self) -> tuple[Array, Array]:
        """The same with the error of the black level."""
        black_e = self.scene.point.sensor.pixel.black_error_e
        return self._cielab(black_e) if black_e else self.chart

    def _cielab(self, black_e: float) -> tuple[Array, Array]:
        from chromanoise.apps.design.kernels import cielab

        own = self.matrix / self.white_xyz[:, None]
        share = np.ascontiguousarray(np.einsum("jcm,ckm->jkm", own, self.seen("chart_e")))
        share += black_e * own.sum(axis=1)[:, None]
        lab, slope = np.empty_like(share), np.empty_like(share)
        cielab(share, lab, slope)
        return lab, slope

    @cached_property
    def noise_of_chart(self) -> Inexact[Array, "k m"]:
        """Variance in CIELAB of each patch, first order: the trace of J S J^T."""
        total: Any = 0.0
        slope = self.chart_with_black[1] / self.white_xyz[:, None]
        variance = self.variance(self.seen("chart_e"))
        for channel, own in enumerate(variance):
            x, y, z = slope * self.matrix[:, channel, None]
            total = total + own * ((116 * y) ** 2 + (500 * (x - y)) ** 2 + (200 * (y - z)) ** 2)
        return total

    @cached_property
    def separations(self) -> Inexact[Array, "pairs m"]:
        """D_M of each pair of patches."""
        electrons = self.seen("paired_e")
        variance = 0.5 * self.variance(electrons)
        one, other = self.arrays.pairs.T
        total: Any = 0.0
        for e, own in zip(electrons, variance, strict=True):
            apart, noise = (e[one] - e[other]) ** 2, own[one] + own[other]
            without = np.where(apart.real > 0, np.inf, 0.0)
            total = total + np.where(noise.real > 0, apart / noise, without)
        return np.sqrt(total)

    @property
    def paired_is_full(self) -> Any:
        """NaN where a patch of the pairs saturates a channel, else 0."""
        full = self.seen("paired_e").real > FULL * self.full_e.real
        return np.where(full.any(axis=(0, 1)), np.nan, 0.0)


def _highest(values: Inexact[Array, "r m"]) -> Inexact[Array, " m"]:
    if values.dtype.kind != "c":
        return values.max(axis=0)
    return np.take_along_axis(values, values.real.argmax(axis=0)[None], axis=0)[0]


def _distance(lab: Array, truth: Array) -> Array:
    """The square of the color difference."""
    return ((lab - truth.T[..., None]) ** 2).sum(axis=0)


def _snr_y_db(at: Block) -> Array:
    weight, white_e = at.matrix[1], at.white_e
    y = (weight * white_e).sum(axis=0)
    snr = y * y / (weight**2 * at.variance(white_e)).sum(axis=0)
    return np.where(y.real > _LEAST_COLOR * at.arrays.white_y, 10.0 * np.log10(snr), np.nan)


def _snr10_lux(at: Block) -> Array:
    """From a quadratic equation; NaN where a channel saturates first."""
    per_lux, weight = at.white_e * (GRAY / at.scene.point.level_lux), at.matrix[1]
    floor, slope, square = (SNR10**2 * one for one in at.law)
    squared = weight**2 * at.spread
    seen = (weight * per_lux).sum(axis=0)
    gain = seen**2 - square * (squared * per_lux**2).sum(axis=0)
    shot = slope * (squared * per_lux).sum(axis=0)
    root = np.sqrt(shot**2 + 4.0 * gain * floor * squared.sum(axis=0))
    lux = (shot + root) / (2.0 * gain)
    fits = (lux * _highest(per_lux)).real <= FULL * at.full_e.real
    return np.where((seen.real > 0) & (gain.real > 0) & fits, lux, np.nan)


def _noise_delta_e(at: Block) -> Array:
    return np.sqrt(at.noise_of_chart.mean(axis=0))


def _total_delta_e(at: Block) -> Array:
    bias = _distance(at.chart_with_black[0], at.arrays.chart_lab)
    return np.sqrt((at.noise_of_chart + bias).mean(axis=0))


def _delta_e(at: Block) -> Array:
    return np.sqrt(_distance(at.chart[0], at.arrays.chart_lab)).mean(axis=0)


def _ciede2000(at: Block) -> Array:
    from chromanoise.apps.design.kernels import ciede2000

    lab, _ = at.chart
    found = np.empty_like(lab[0])
    ciede2000(at.arrays.chart_lab, lab, found)
    return found.mean(axis=0)


def _vora(at: Block) -> Array:
    """The share of an orthonormal basis of the observer in the span of the channels."""
    axes = at.seen("orthonormal_e")
    return np.einsum("cjm,cdm,djm->m", axes, at.inverse_gram, axes) / 3


def _infrared_share(at: Block) -> Array:
    share = at.seen("infrared_e")[:, 0] / at.white_e
    return _highest(np.where(at.white_e.real > 0, share, np.nan))


def _least_separation(at: Block) -> Array:
    return -_highest(-at.separations) + at.paired_is_full


def _mean_separation(at: Block) -> Array:
    return at.separations.mean(axis=0) + at.paired_is_full


FAST: dict[str, Callable[[Block], Array]] = {
    "snr_y_db": _snr_y_db,
    "noise_delta_e": _noise_delta_e,
    "total_delta_e": _total_delta_e,
    "delta_e": _delta_e,
    "ciede2000": _ciede2000,
    "vora": _vora,
    "snr10_lux": _snr10_lux,
    "least_separation": _least_separation,
    "mean_separation": _mean_separation,
    "infrared_share": _infrared_share,
    "share_of_full_well": lambda at: at.fullness,
}
"""Objectives that are computed for a whole batch, by name; NaN where one is not defined."""
