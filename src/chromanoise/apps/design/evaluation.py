"""Evaluation of candidate sensors: the scenes of a design, and the objectives of a batch in them.

A scene fixes light, exposure and color matrix. Its arrays are computed once for all batches.
"""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any, Literal, Protocol, get_args, runtime_checkable

import numpy as np

from chromanoise.apps.design.objectives import FAST, OBJECTIVES, Candidate, Objective, value_of
from chromanoise.apps.design.parameters import Candidates, bounds_of, noise_of
from chromanoise.base import (
    Array,
    Bool,
    Float,
    Inexact,
    InputError,
    Integer,
    check,
    dataclass,
    qr,
    svd,
    unit_columns,
)
from chromanoise.color import balanced_cielab, penalized_matrix, shares
from chromanoise.geometry import dual_and_orthonormal_bases
from chromanoise.noise import (
    OperatingPoint,
    demand_independent_channels,
    measurement_vectors,
    noise_sources,
)
from chromanoise.sensor import code_range_e
from chromanoise.spectra import Metric, Scene, Spectra, chart_on, color_axes, is_infrared, light
from chromanoise.study import (
    DEFAULT_METHOD,
    DEFAULT_PRIOR,
    MatrixMaker,
    electrons_at,
    matrix_makers,
    pairs_of,
    training_named,
)

_ROUNDING = 1e-16  # of the largest singular value of a training set


@dataclass(frozen=True, kw_only=True, eq=False)
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

    @cached_property
    def maker(self) -> MatrixMaker:
        """The method of the color matrix."""
        return matrix_makers([self.matrix], self.metric, prior=self.prior)[self.matrix.strip()]

    @property
    def method(self) -> str:
        """Name of the method of the color matrix, without its parameter."""
        return self.matrix.partition("=")[0].strip()

    @property
    def noise_weight(self) -> float | None:
        """Weight of the noise in the color matrix; ``None`` for a method without one. [1]"""
        if self.method not in _WEIGHTED:
            return None
        return dict(self.maker.parameters).get("weight", float(self.method == "lmmse"))


@dataclass(frozen=True, kw_only=True, eq=False)
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


OverScenes = Literal["worst", "mean"]
"""Which value counts of those of all scenes."""
_WEIGHTED = ("least-squares", "lmmse", "noise-regularized")
_COMPLEX_STEP = 1e-30
_DIFFERENCE_STEP = 1e-5  # of the range of a parameter
_LEAST_INDEPENDENCE = 1e-5  # 1 / VIF; below it normal equations lose too many digits
_LEAST_SIGNAL_E = 1e-100  # of a perfect white; the square of its inverse is finite
_FULL = 1 + 1e-12  # as `chromanoise.noise.saturated`
_FEWEST_BLOCKS = 4  # of one thread


@runtime_checkable
class Space(Protocol):
    """A design space: values of parameters to candidates, as `DesignSpace`."""

    @property
    def parameters(self) -> Sequence[Any]:
        """The parameters, with ``low`` and ``high``."""

    def candidates(self, values: Inexact[Array, "m d"]) -> Candidates:
        """The candidates of values of the parameters; complex for complex values."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Objectives:
    """Objectives of candidates in scenes.

    The fast objectives are computed for the whole batch by the kernels, and equal those of the
    library to rounding. The result for a candidate does not depend on the others, on
    their number or on the number of threads.

    Attributes
    ----------
    scenes
        The scenes, with one wavelength grid.
    over_scenes
        ``worst`` or ``mean`` of each objective over the scenes.
    threads
        Number of threads; ``None`` for one per core.

    Raises
    ------
    InputError
        If there is no scene or no objective, a name is unknown, or the grids differ.
    """

    scenes: tuple[DesignScene, ...]
    objectives: tuple[str, ...]
    over_scenes: OverScenes = "worst"
    threads: int | None = None

    def __post_init__(self) -> None:
        for what, given in (("scenes", self.scenes), ("objectives", self.objectives)):
            if not given:
                raise InputError(what, "must hold at least one", found="is empty")
        names = [check.one_of("objective", name, tuple(OBJECTIVES)) for name in self.objectives]
        object.__setattr__(self, "objectives", check.distinct("objectives", names))
        check.one_of("over_scenes", self.over_scenes, get_args(OverScenes))
        check.at_least_one("threads", self.threads)
        grids = {scene.point.illuminant.grid for scene in self.scenes}
        if len(grids) > 1:
            raise InputError(
                "scenes",
                "must have one wavelength grid",
                value=tuple(grids),
                found=f"have {', '.join(map(str, grids))}",
            )

    @property
    def entries(self) -> tuple[Objective, ...]:
        """The objectives as entries of the table."""
        return tuple(OBJECTIVES[name] for name in self.objectives)

    def values(self, candidates: Candidates) -> Float[Array, "m q"]:
        """The objectives in their own units; never NaN.

        An undefined value, such as that of a saturated candidate, is the worst one, -inf or inf.

        Parameters
        ----------
        candidates
            At least one, on the grid of the scenes.

        Raises
        ------
        InputError
            If there is none, the grids differ, or a scene does not support what was chosen.
        """
        return self._over_scenes(self.values_of_scenes(candidates))

    def values_of_scenes(self, candidates: Candidates) -> Float[Array, "s m q"]:
        """`values` of each scene."""
        return self._real(_given(self, candidates), self.objectives)

    def values_of_choices(
        self, choices: Integer[Array, "m p"], curves: Float[Array, "n filters"]
    ) -> Float[Array, "m q"]:
        """`values` of sensors whose channels are chosen from a library.

        Electrons and inner products are computed once per curve, so that a candidate costs no sums
        over the wavelengths.

        Parameters
        ----------
        choices
            Columns of ``curves``, one per channel.
        curves
            The library. [e-/photon]

        Raises
        ------
        InputError
            As `values`, or if a choice is not a column.
        """
        return self._over_scenes(self._real(_chosen(self, choices, curves), self.objectives))

    def values_and_fullness(
        self, candidates: Candidates
    ) -> tuple[Float[Array, "m q"], Float[Array, " m"]]:
        """`values`, and the electrons of a perfect white over full well or top code. [1]

        The latter are those of the channel and the scene that have most.

        Parameters
        ----------
        candidates
            As `values`.
        """
        found = self._real(_given(self, candidates), self._with_fullness)
        fullness = found[..., self._with_fullness.index("share_of_full_well")].max(axis=0)
        return self._over_scenes(found[..., : len(self.objectives)]), fullness

    def has_exact_gradients(self, noise_weight_is_free: bool) -> bool:
        """Whether `gradient` is exact for all objectives, by kernels and without differences.

        Parameters
        ----------
        noise_weight_is_free
            Whether the weight of the noise in the matrix is a free number.
        """
        return all(
            _matrix_group(scene) and _is_fast(scene, noise_weight_is_free, name)
            for scene in self.scenes
            for name in self.objectives
        )

    def gradient(
        self, space: Space, values: Float[Array, "*m d"]
    ) -> tuple[Float[Array, "*m q"], Float[Array, "*m q d"]]:
        """The objectives at points of a design space, and their derivatives.

        Parameters
        ----------
        values
            The parameters of each, within their bounds.

        Returns
        -------
        values, jacobian
            The derivative of the worst scene where the worst one counts. 0 where an objective is
            not defined.

        Notes
        -----
        Fast objectives: exact, by a complex step (Squire & Trapp, SIAM Rev. 40 (1998) 110). Central
        differences with a step of 1e-5 of the range of the parameter for the others, for matrices
        that are not linear in the training set, and for all objectives of a sensor whose channels
        are nearly dependent. At a bound the difference is one-sided, so that no point beyond the
        bounds is evaluated.
        """
        turned = _given(self, _turned(space, values))
        return self._slopes_over_scenes(*self._slopes(space, values, turned))

    def linearization(self, space: Space, values: Float[Array, "*m d"]) -> "Linearization":
        """`gradient`, and what limits of a search need besides.

        Parameters
        ----------
        space, values
            As `gradient`.
        """
        own = replace(self, objectives=("share_of_full_well",), over_scenes="worst")
        names = self._with_fullness
        turned = _given(self, _turned(space, values))
        shape, each = values.shape, []
        if "least_separation" in self.objectives and self.over_scenes == "worst":
            each = [_separations(scene, turned, shape) for scene in self.scenes]
        others = tuple(name for name in names if not (each and OBJECTIVES[name].rows == "paired"))
        found, slope = replace(self, objectives=others)._slopes(space, values, turned)
        if each:
            found, slope = _with_separations(names, others, found, slope, each)
        q, at = len(self.objectives), names.index("share_of_full_well")
        share, rise = own._slopes_over_scenes(found[..., at : at + 1], slope[..., at : at + 1, :])
        objectives, jacobian = self._slopes_over_scenes(found[..., :q], slope[..., :q, :])
        apart = [(np.zeros((*shape[:-1], 0)), np.zeros((*shape[:-1], 0, shape[-1]))), *each]
        return Linearization(
            objectives=objectives,
            objectives_jacobian=jacobian,
            fullness=share[..., 0],
            fullness_slope=rise[..., 0, :],
            separations=np.concatenate([one for one, _ in apart], axis=-1),
            separations_jacobian=np.concatenate([one for _, one in apart], axis=-2),
        )

    def _slopes(
        self, space: Space, values: Float[Array, "*m d"], turned: "SensorBatch"
    ) -> tuple[Float[Array, "s *m q"], Float[Array, "s *m q d"]]:
        """The objectives of each scene, and their derivatives."""
        at = np.asarray(values, dtype=np.float64)
        d, q = at.shape[-1], len(self.objectives)
        rows = at.reshape(-1, d)
        found = np.empty((len(self.scenes), len(rows), q))
        slope = np.empty((len(self.scenes), len(rows), q, d))
        exact = np.zeros(found.shape, dtype=bool)
        for s, scene in enumerate(self.scenes):
            if _matrix_group(scene):
                raw, independence = _fast(self, scene, turned, self.objectives)
                found[s] = raw[::d].real
                slope[s] = raw.imag.reshape(-1, d, q).swapaxes(1, 2) / _COMPLEX_STEP
                exact[s] = [_is_fast(scene, turned.weighted, name) for name in self.objectives]
                independent = (independence >= _LEAST_INDEPENDENCE).reshape(-1, d)
                exact[s] &= independent.all(axis=1, keepdims=True)
        lost = np.flatnonzero(~exact.all(axis=(0, 2)))
        if lost.size:
            value, rise = self._differences(space, rows[lost])
            found[:, lost] = np.where(exact[:, lost], found[:, lost], value)
            slope[:, lost] = np.where(exact[:, lost, :, None], slope[:, lost], rise)
        slope = np.where(np.isfinite(found)[..., None] & np.isfinite(slope), slope, 0.0)
        shape = (len(self.scenes), *at.shape[:-1], q)
        return found.reshape(shape), slope.reshape(*shape, d)

    def _slopes_over_scenes(
        self, found: Float[Array, "s *m q"], slope: Float[Array, "s *m q d"]
    ) -> tuple[Float[Array, "*m q"], Float[Array, "*m q d"]]:
        if self.over_scenes == "mean":
            return found.mean(axis=0), slope.mean(axis=0)
        active = np.where(self._higher, found.argmin(axis=0), found.argmax(axis=0))[None]
        return (
            np.take_along_axis(found, active, axis=0)[0],
            np.take_along_axis(slope, active[..., None], axis=0)[0],
        )

    def _differences(
        self, space: Space, at: Float[Array, "m d"]
    ) -> tuple[Float[Array, "s m q"], Float[Array, "s m q d"]]:
        """The objectives of each scene, and differences within the bounds."""
        low, high = bounds_of(space.parameters)
        step, (m, d) = np.diag(_DIFFERENCE_STEP * (high - low)), at.shape
        above, below = np.minimum(at[:, None] + step, high), np.maximum(at[:, None] - step, low)
        points = np.concatenate([at[:, None], above, below], axis=1).reshape(-1, d)
        found = self.values_of_scenes(space.candidates(points))
        found = found.reshape(len(found), m, 2 * d + 1, -1)
        with np.errstate(invalid="ignore"):
            rise = found[:, :, 1 : d + 1] - found[:, :, d + 1 :]
        width = (above - below)[:, np.arange(d), np.arange(d), None]
        return found[:, :, 0], np.swapaxes(rise / width, 2, 3)

    @property
    def _with_fullness(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys((*self.objectives, "share_of_full_well")))

    @property
    def _higher(self) -> Bool[Array, " q"]:
        return np.array([one.better == "higher" for one in self.entries])

    def _over_scenes(self, values: Float[Array, "s m q"]) -> Float[Array, "m q"]:
        if self.over_scenes == "mean":
            return values.mean(axis=0)
        return np.where(self._higher, values.min(axis=0), values.max(axis=0))

    def _real(self, batch: "SensorBatch", names: tuple[str, ...]) -> Float[Array, "s m q"]:
        return np.array([_values(self, scene, batch, names) for scene in self.scenes])


@dataclass(frozen=True, kw_only=True, eq=False)
class Linearization:
    """Objectives at points of a design space, and their derivatives.

    Attributes
    ----------
    objectives, objectives_jacobian
        As `Objectives.gradient`.
    fullness, fullness_slope
        `share_of_full_well` of the fullest scene.
    separations, separations_jacobian
        D_M of every pair of patches in every scene, the least of which is ``least_separation``:
        this objective has kinks, its parts have none. Empty without this objective, and where the
        mean over scenes counts.
    """

    objectives: Float[Array, "*m q"]
    objectives_jacobian: Float[Array, "*m q d"]
    fullness: Float[Array, "*m"]
    fullness_slope: Float[Array, "*m d"]
    separations: Float[Array, "*m l"]
    separations_jacobian: Float[Array, "*m l d"]


@dataclass(frozen=True, kw_only=True, eq=False)
class SensorBatch:
    """Candidates, or choices from a library with what else was chosen.

    ``of`` returns some of them as candidates.
    """

    m: int
    p: int
    dtype: np.dtype
    qe: Array
    choices: Array
    curves: Array | None
    more: Candidates
    of: Callable[[Any], Candidates]

    @property
    def weighted(self) -> bool:
        """Whether the weight of the noise in the matrix is one of the free numbers."""
        return self.more.noise_weight is not None


def _turned(space: Space, values: Float[Array, "*m d"]) -> Candidates:
    """One copy of each candidate per parameter, with an imaginary step in that parameter."""
    d = values.shape[-1]
    copies = values[..., None, :] + 1j * _COMPLEX_STEP * np.eye(d)
    return space.candidates(copies.reshape(-1, d))


def _given(evaluator: Objectives, candidates: Candidates) -> SensorBatch:
    """The batch of candidates, checked."""
    if len(candidates) == 0:
        raise InputError("candidates", "must hold at least one", found="there is none")
    _demand_grid(evaluator, candidates.qe.shape[1])
    dtype = candidates.dtype
    m, _, p = candidates.qe.shape
    return SensorBatch(
        m=m,
        p=p,
        dtype=dtype,
        qe=_own(candidates.qe.transpose(0, 2, 1), dtype),
        choices=np.zeros((0, p), np.int64),
        curves=None,
        more=candidates,
        of=candidates.some,
    )


def _chosen(evaluator: Objectives, choices: Array, curves: Array) -> SensorBatch:
    """The batch of choices, checked."""
    index, library = _own(choices, np.int64), np.asarray(curves, np.float64)
    _demand_grid(evaluator, len(library))
    if index.ndim != 2 or not index.size:
        raise InputError(
            "choices", "must be (candidates, channels)", found=f"has shape {index.shape}"
        )
    outside = (index < 0) | (index >= library.shape[1])
    if outside.any():
        raise InputError(
            "choices",
            f"must be columns of the library, 0 to {library.shape[1] - 1}",
            value=int(index[outside][0]),
        )
    (m, p), n = index.shape, len(library)

    def of(which: Any) -> Candidates:
        return Candidates(qe=np.moveaxis(library[:, index[which]], 0, 1))

    return SensorBatch(
        m=m,
        p=p,
        dtype=np.dtype(np.float64),
        qe=np.zeros((0, p, n)),
        choices=index,
        curves=library,
        more=Candidates(qe=np.zeros((0, n, p))),
        of=of,
    )


def _demand_grid(evaluator: Objectives, n: int) -> None:
    grid = evaluator.scenes[0].point.illuminant.grid
    if n != grid.n:
        raise InputError(
            "QE of candidates",
            f"must have the {grid.n} wavelengths of the scenes",
            value=n,
            found=f"has {n}",
        )


def _is_fast(scene: DesignScene, noise_weight_is_free: bool, name: str) -> bool:
    """Whether the kernels compute it; not so SNR10 of a matrix that depends on the light."""
    adapts = scene.maker.method.over_light is not None or noise_weight_is_free
    return OBJECTIVES[name].fast and not (name == "snr10_lux" and adapts)


def _values(
    evaluator: Objectives, scene: DesignScene, batch: SensorBatch, names: tuple[str, ...]
) -> Float[Array, "m q"]:
    """The objectives in one scene."""
    found, independence = _fast(evaluator, scene, batch, names)
    lost = np.flatnonzero(~(independence >= _LEAST_INDEPENDENCE))
    if lost.size:
        some = _given(evaluator, batch.of(lost))
        matrices, vora = _by_singular_values(scene, some)
        found[lost] = _fast(evaluator, scene, some, names, matrices)[0]
        if "vora" in names:
            found[lost, names.index("vora")] = vora
    for q, name in enumerate(names):
        if not _is_fast(scene, batch.weighted, name):
            _refuse_shares(OBJECTIVES[name], batch.more)
            own = batch.of(slice(None))
            found[:, q] = [_library_value(scene, own, i, OBJECTIVES[name]) for i in range(batch.m)]
    return found


def _fast(
    evaluator: Objectives,
    scene: DesignScene,
    batch: SensorBatch,
    names: tuple[str, ...],
    matrices: Array | None = None,
) -> tuple[Inexact[Array, "m q"], Float[Array, " m"]]:
    """Values, and 1 over the largest VIF of the equations; NaN for objectives that are not fast."""
    from chromanoise.apps.design import kernels

    columns = [name for name in names if _is_fast(scene, batch.weighted, name)]
    wanted = np.array([name in columns for name in FAST])
    groups = {OBJECTIVES[name].rows or "" for name in columns}
    rows = _rows(scene, frozenset(groups | {_matrix_group(scene)}))
    sensor, more, m, p, dtype = scene.point.sensor, batch.more, batch.m, batch.p, batch.dtype
    gain, law, dark_e, spread = _noise(scene, batch)
    well_e, range_e = sensor.pixel.full_well_e - dark_e, code_range_e(sensor)
    full_e = np.where(well_e.real < range_e, well_e, range_e)
    method, strength, weight = _method(scene, more)
    if method == kernels.GIVEN and matrices is None:
        matrices = _matrices(scene, batch)
    if matrices is not None:
        method = kernels.GIVEN
    out = np.empty((len(kernels.COLUMNS), m), dtype)
    used = np.zeros((0, 3, p), dtype) if matrices is None else _own(matrices, dtype)
    table, gram = np.zeros((0, 0)), np.zeros((0, 0))
    if batch.curves is not None:
        n = len(batch.curves)
        table = np.ascontiguousarray(batch.curves.T @ rows.rows_e[:, :n].T)
        gram = np.ascontiguousarray((batch.curves.T * rows.squared[:n]) @ batch.curves)
    arrays = scene_arrays(scene)
    given = (
        batch.qe,
        batch.choices,
        gain,
        law,
        full_e * _FULL,
        _each(more.noise_weight, weight, m, dtype),
        spread,
        rows.rows_e,
        rows.squared,
        table,
        gram,
        rows.layout,
        rows.pairs,
        rows.training_xyz,
        rows.truth,
        method,
        np.array([strength, arrays.white_y, sensor.pixel.black_error_e, scene.point.level_lux]),
        wanted,
        used,
        out,
    )
    _run(evaluator.threads, -(-m // kernels.LANES), lambda a, b: kernels.evaluate(a, b, *given))
    fullness = np.where(full_e.real > 0, out[FAST.index("share_of_full_well")] * _FULL, np.inf)
    found = np.full((m, len(names)), np.nan, dtype)
    for name in columns:
        value = out[FAST.index(name)]
        found[:, names.index(name)] = _finished(OBJECTIVES[name], value, fullness)
    return found, out[-1].real


def _noise(scene: DesignScene, batch: SensorBatch) -> tuple[Array, Array, Array, Array]:
    """Gain of all electrons, law of the variance, dark electrons, factors on the variance."""
    exposure, more = scene.point.exposure, batch.more
    m, p, dtype = batch.m, batch.p, batch.dtype
    time_s = _each(more.time_s, exposure.time_s, m, dtype)
    noise = noise_of(scene.point.sensor, time_s, more.pixel)
    spread = np.ones((m, p), dtype)
    if more.pixel_share is not None:
        spread = _own(1.0 / (p * more.pixel_share), dtype)
    return time_s / exposure.time_s, _own(noise[:3], dtype), noise[3], spread


def _separations(
    scene: DesignScene, turned: SensorBatch, shape: tuple[int, ...]
) -> tuple[Float[Array, "*m pairs"], Float[Array, "*m pairs d"]]:
    """D_M of each pair at values of a shape, and its derivatives."""
    from chromanoise.apps.design import kernels

    arrays = scene_arrays(scene)
    rows_e = arrays.chart_e if arrays.paired_e is None else arrays.paired_e
    gain, law, _, spread = _noise(scene, turned)
    seen = turned.qe.real @ rows_e.T + 1j * (turned.qe.imag @ rows_e.T)
    e = gain * np.moveaxis(seen, 0, -1)  # channel, patch, parameter
    variance = kernels.variance_of(law, ..., e, e * e) * (0.5 * spread.T[:, None])
    (p, patches), d = e.shape[:2], shape[-1]
    one, other = arrays.pairs.T
    e, variance = (np.moveaxis(part.reshape(p, patches, -1, d), 2, 0) for part in (e, variance))
    at, noise = e[..., 0].real, variance[..., 0].real  # point, channel, patch
    apart, noise = at[..., one] - at[..., other], noise[..., one] + noise[..., other]
    with np.errstate(divide="ignore", invalid="ignore"):
        without = np.where(apart != 0, np.inf, 0.0)
        found = np.sqrt(np.where(noise > 0, apart**2 / noise, without).sum(axis=1))
        of_apart = apart / (noise * found[:, None])
        of_noise = -0.5 * of_apart * apart / noise
    slope = np.zeros((len(at), len(one), d))
    turns = (part.imag / _COMPLEX_STEP for part in (e, variance))
    weights = of_apart, of_noise
    kernels.add_slopes(
        _own(arrays.pairs, np.int64), *(_own(x, float) for x in (*weights, *turns)), slope
    )
    return found.reshape(*shape[:-1], -1), slope.reshape(*shape[:-1], -1, d)


def _with_separations(
    names: tuple[str, ...],
    others: tuple[str, ...],
    found: Float[Array, "s *m k"],
    slope: Float[Array, "s *m k d"],
    apart: Sequence[tuple[Array, Array]],
) -> tuple[Float[Array, "s *m q"], Float[Array, "s *m q d"]]:
    """Columns of all names: those of the others, and the least and mean D_M of the pairs."""
    fullness = found[..., others.index("share_of_full_well")]
    columns = {name: (found[..., i], slope[..., i, :]) for i, name in enumerate(others)}
    least = [(each.min(axis=-1), each.argmin(axis=-1)[..., None, None]) for each, _ in apart]
    of_pairs = {
        "least_separation": (
            [value for value, _ in least],
            [
                np.take_along_axis(rise, place, axis=-2)[..., 0, :]
                for (_, rise), (_, place) in zip(apart, least, strict=True)
            ],
        ),
        "mean_separation": (
            [each.mean(axis=-1) for each, _ in apart],
            [rise.mean(axis=-2) for _, rise in apart],
        ),
    }
    for name, (values, rises) in of_pairs.items():
        value, rise = _finished(OBJECTIVES[name], np.array(values), fullness), np.array(rises)
        good = np.isfinite(value)[..., None] & np.isfinite(rise)
        columns[name] = value, np.where(good, rise, 0.0)
    return (
        np.stack([columns[name][0] for name in names], axis=-1),
        np.stack([columns[name][1] for name in names], axis=-2),
    )


def _finished(objective: Objective, value: Array, fullness: Array) -> Inexact[Array, " m"]:
    """A column in its own unit, with `Objective.undefined` in place of NaN."""
    if objective.name == "share_of_full_well":
        return fullness
    if objective.name == "snr_y_db":
        with np.errstate(divide="ignore", invalid="ignore"):
            value = 10.0 * np.log10(value)
    lost = np.isnan(value.real)
    if not objective.of_saturated:
        lost |= ~(fullness.real <= _FULL)
    return np.where(lost, objective.undefined, value)


def _run(threads: int | None, blocks: int, work: Callable[[int, int], Any]) -> None:
    """Ranges of blocks, one per thread."""
    many = max(1, min(threads or os.cpu_count() or 1, blocks // _FEWEST_BLOCKS))
    if many == 1:
        work(0, blocks)
        return
    ends = [blocks * i // many for i in range(many + 1)]
    with ThreadPoolExecutor(many) as pool:
        list(pool.map(work, ends[:-1], ends[1:]))


def _each(values: Array | None, otherwise: float, m: int, dtype: np.dtype) -> Inexact[Array, " m"]:
    if values is None:
        return np.full(m, otherwise, dtype)
    return _own(values, dtype)


def _own(values: Array, dtype: Any) -> Array:
    """Contiguous and writable, a copy where needed: kernels are compiled for such arrays only."""
    return np.require(values, dtype, ["C", "W"])


@dataclass(frozen=True, kw_only=True, eq=False)
class _Rows:
    """The rows of a scene that some objectives need, and where each group begins."""

    rows_e: Array
    squared: Array
    layout: Array
    pairs: Array
    training_xyz: Array
    truth: Array


@lru_cache(maxsize=64)
def _rows(scene: DesignScene, groups: frozenset[str]) -> _Rows:
    from chromanoise.apps.design import kernels

    arrays, n = scene_arrays(scene), scene.point.illuminant.grid.n
    own_pairs = arrays.paired_e is not None
    needed = groups | ({"chart"} if "paired" in groups and not own_pairs else set())
    of_group: dict[str, Array | None] = {
        "infrared": arrays.infrared_e[None],
        "chart": arrays.chart_e,
        "paired": arrays.paired_e,
        "training": np.vstack([arrays.training_e, arrays.training_mean_e]),
        "axes": arrays.axes.T * arrays.basis,
        "orthonormal": arrays.orthonormal_axes.T * arrays.basis,
    }
    parts, layout, count = [arrays.white_e[None]], [], 1
    for group in kernels.GROUPS:
        rows = of_group[group]
        if rows is None or group not in needed:
            layout.append(-1)
            continue
        layout.append(count)
        parts.append(rows)
        count += len(rows)
    padding = -n % kernels.TOGETHER
    lab = arrays.chart_lab
    return _Rows(
        rows_e=_own(np.pad(np.vstack(parts), ((0, 0), (0, padding))), np.float64),
        squared=np.pad(arrays.basis**2, (0, padding)),
        layout=np.array([*layout, count]),
        pairs=_own(arrays.pairs, np.int64),
        training_xyz=_own(arrays.training_xyz, np.float64),
        truth=_own(np.column_stack([lab, np.hypot(lab[:, 1], lab[:, 2])]), np.float64),
    )


def _matrix_group(scene: DesignScene) -> str:
    if scene.method in (*_WEIGHTED, "ridge"):
        return "training"
    return "axes" if scene.method == "kernel" else ""


def _method(scene: DesignScene, more: Candidates) -> tuple[int, float, float]:
    """Method of the kernels, strength of ridge, weight of the noise."""
    from chromanoise.apps.design import kernels

    weight = scene.noise_weight
    if more.noise_weight is not None and weight is None:
        raise InputError(
            f"matrix of scene {scene.name}".rstrip(),
            f"must be one of {', '.join(_WEIGHTED)} where the weight of the noise is free",
            value=scene.matrix,
        )
    if weight is not None:
        return kernels.NOISE_WEIGHTED, 0.0, weight
    if scene.method == "ridge":
        return kernels.RIDGE, dict(scene.maker.parameters)["strength"], 0.0
    return (kernels.KERNEL if scene.method == "kernel" else kernels.GIVEN), 0.0, 0.0


def _by_singular_values(
    scene: DesignScene, batch: SensorBatch
) -> tuple[Float[Array, "m 3 p"], Float[Array, " m"]]:
    """Matrices and Vora values; NaN and -inf where a channel measures nothing."""
    candidates, arrays = batch.of(slice(None)), scene_arrays(scene)
    dark = ((candidates.qe * arrays.basis[:, None]) ** 2).sum(axis=1).min(axis=1) == 0
    qe = np.where(dark[:, None, None], np.eye(*candidates.qe.shape[1:]), candidates.qe)
    dual, span = dual_and_orthonormal_bases(qe * arrays.basis[:, None])
    overlap = np.swapaxes(span, 1, 2) @ arrays.orthonormal_axes
    vora = np.where(dark, -np.inf, (overlap**2).sum(axis=(1, 2)) / 3)
    if _matrix_group(scene) != "axes":
        return _matrices(scene, batch), vora
    gain = _each(candidates.time_s, scene.point.exposure.time_s, batch.m, batch.dtype)
    matrices = arrays.axes.T @ dual / (gain / scene.point.exposure.time_s)[:, None, None]
    return np.where(dark[:, None, None], np.nan, matrices), vora


def _matrices(scene: DesignScene, batch: SensorBatch) -> Float[Array, "m 3 p"]:
    """The matrices one by one; NaN where a channel measures nothing."""
    candidates = batch.of(slice(None))
    return np.array([_matrix(scene, candidates, i) for i in range(batch.m)])


def _matrix(scene: DesignScene, candidates: Candidates, i: int) -> Float[Array, "3 p"]:
    point = _point(scene, candidates, i)
    sensor, p = point.sensor, len(point.sensor.names)
    if not _has_signal(point):
        return np.full((3, p), np.nan)
    weight = scene.noise_weight
    is_of_scene = candidates.noise_weight is None and candidates.pixel_share is None
    if is_of_scene or weight is None:
        return scene.maker(point).matrix
    if candidates.noise_weight is not None:
        weight = float(candidates.noise_weight[i])
    arrays, gain = scene_arrays(scene), point.exposure.time_s / scene.point.exposure.time_s
    seen, mean_e, white_e = (
        gain * (rows @ sensor.qe)
        for rows in (arrays.training_e, arrays.training_mean_e, arrays.white_e)
    )
    law = noise_sources(sensor, point.exposure).law()
    variance = mean_e + law.floor_e2 + law.square * (seen**2).sum(axis=0)
    if candidates.pixel_share is not None:
        variance = variance / (p * candidates.pixel_share[i])
    return penalized_matrix(
        f"{scene.matrix} for {sensor.name}",
        seen,
        arrays.training_xyz,
        np.diag(weight * variance),
        scale=np.where(white_e > 0, white_e, 1.0),
    )


def _library_value(
    scene: DesignScene, candidates: Candidates, i: int, objective: Objective
) -> float:
    """An objective of one candidate by the library's function."""
    point, maker = _point(scene, candidates, i), scene.maker
    if not _has_signal(point):
        return objective.undefined
    if candidates.noise_weight is not None:
        name = f"noise-regularized={float(candidates.noise_weight[i])!r}"
        maker = matrix_makers([name], scene.metric, prior=scene.prior)[name]
    return value_of(objective, Candidate(point=point, matrix=maker(point), maker=maker))


def _has_signal(point: OperatingPoint) -> bool:
    """Whether every channel counts electrons of a perfect white."""
    return bool((electrons_at(point) > _LEAST_SIGNAL_E).all())


def _refuse_shares(objective: Objective, more: Candidates) -> None:
    if more.pixel_share is not None and objective.of_noise:
        raise InputError(
            f"objective {objective.name}",
            "cannot be combined with free pixel shares",
            remedy="fix the shares, or take snr_y_db or noise_delta_e",
        )


def _point(scene: DesignScene, candidates: Candidates, i: int) -> OperatingPoint:
    time_s = None if candidates.time_s is None else float(candidates.time_s[i])
    pixel = {name: float(values[i]) for name, values in candidates.pixel.items()}
    return candidate_point(scene, candidates.qe[i], time_s=time_s, **pixel)
