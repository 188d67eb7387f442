"""Objectives of many candidates in one or more scenes, and their derivatives."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol, get_args, runtime_checkable

import numpy as np

from chromanoise.apps.design.batch import (
    FAST,
    FULL,
    NOISE_WEIGHTED,
    Block,
    Choices,
    DesignScene,
    noise_in,
    scene_arrays,
)
from chromanoise.apps.design.objectives import OBJECTIVES, Candidate, Objective, value_of
from chromanoise.apps.design.parameters import Candidates
from chromanoise.base import Array, Bool, Float, Inexact, InputError, Integer, check
from chromanoise.color import penalized_matrix
from chromanoise.geometry import dual_and_orthonormal_bases
from chromanoise.noise import OperatingPoint, noise_sources
from chromanoise.study import electrons_at, matrix_makers


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


OverScenes = Literal["worst", "mean"]
"""Which value counts of those of all scenes."""
_AT_ONCE = 256  # candidates, which fit the cache
_COMPLEX_STEP = 1e-30
_DIFFERENCE_STEP = 1e-5  # of the range of a parameter
_ENDS = ("low", "high")
_FULLNESS = "share_of_full_well"
_LEAST_INDEPENDENCE = 1e-5  # 1 / VIF; below it normal equations lose too many digits
_LEAST_SIGNAL_E = 1e-100  # of a perfect white; the square of its inverse is finite


@runtime_checkable
class Space(Protocol):
    """A design space: values of parameters to candidates, as `DesignSpace`."""

    @property
    def parameters(self) -> Sequence[Any]:
        """The parameters, with ``low`` and ``high``."""

    def candidates(self, values: Inexact[Array, "m d"]) -> Candidates:
        """The candidates of values of the parameters; complex for complex values."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Objectives:
    """Objectives of candidates in scenes.

    The fast objectives are computed for the whole batch by the kernels, and equal those of the
    library to rounding. The result for a candidate does not depend on the others, on
    their number or on the number of threads.

    Attributes
    ----------
    scenes
        The scenes, with one wavelength grid.
    objectives
        Names from `chromanoise.apps.design.objectives.OBJECTIVES`.
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
        if self.threads is not None and self.threads < 1:
            raise InputError("threads", "must be at least 1", value=self.threads)
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
        """`values` of each scene.

        Parameters
        ----------
        candidates
            The designs.
        """
        if not len(candidates):
            raise InputError("candidates", "must hold at least one", found="there is none")
        self._demand_grid(candidates.qe.shape[1])
        return np.array([_values(self, one, candidates, self.objectives) for one in self.scenes])

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
        index, library = np.asarray(choices, np.int64), np.asarray(curves, np.float64)
        self._demand_grid(len(library))
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
        found = [
            _values(self, one, Choices(index=index, library=library), self.objectives)
            for one in self.scenes
        ]
        return self._over_scenes(np.array(found))

    def share_of_full_well(self, candidates: Candidates) -> Float[Array, " m"]:
        """Electrons of a perfect white over full well or top code, fullest channel and scene. [1]

        Parameters
        ----------
        candidates
            As `values`.
        """
        own = replace(self, objectives=(_FULLNESS,), over_scenes="worst")
        return own.values(candidates)[:, 0]

    def values_and_fullness(
        self, candidates: Candidates
    ) -> tuple[Float[Array, "m q"], Float[Array, " m"]]:
        """`values` and `share_of_full_well`, computed together.

        Parameters
        ----------
        candidates
            As `values`.
        """
        names = tuple(dict.fromkeys((*self.objectives, _FULLNESS)))
        found = replace(self, objectives=names).values_of_scenes(candidates)
        fullness = found[..., names.index(_FULLNESS)].max(axis=0)
        return self._over_scenes(found[..., : len(self.objectives)]), fullness

    def has_exact_gradients(self, noise_weight_is_free: bool) -> bool:
        """Whether `gradient` is exact for all objectives, by kernels and without differences.

        Parameters
        ----------
        noise_weight_is_free
            Whether the weight of the noise in the matrix is a free number.
        """
        return all(
            scene.in_batches and _is_fast(scene, noise_weight_is_free, name)
            for scene in self.scenes
            for name in self.objectives
        )

    def gradient(
        self, space: Space, values: Float[Array, " d"]
    ) -> tuple[Float[Array, " q"], Float[Array, "q d"]]:
        """The objectives at one point of a design space, and their derivatives.

        Parameters
        ----------
        space
            The design space.
        values
            Its parameters, within their bounds.

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
        return self._slopes_over_scenes(*self._slopes(space, values))

    def linearization(self, space: Space, values: Float[Array, " d"]) -> "Linearization":
        """`gradient`, and what limits of a search need besides.

        Parameters
        ----------
        space, values
            As `gradient`.
        """
        own = replace(self, objectives=(_FULLNESS,), over_scenes="worst")
        names = tuple(dict.fromkeys((*self.objectives, _FULLNESS)))
        found, slope = replace(self, objectives=names)._slopes(space, values)
        q, at = len(self.objectives), names.index(_FULLNESS)
        share, rise = own._slopes_over_scenes(found[:, at : at + 1], slope[:, at : at + 1])
        objectives, jacobian = self._slopes_over_scenes(found[:, :q], slope[:, :q])
        apart: list[Array] = []
        if "least_separation" in self.objectives and self.over_scenes == "worst":
            turned = _turned(space, values)
            with np.errstate(all="ignore"):
                apart = [
                    Block(scene, turned, noise_in(scene, turned)).separations
                    for scene in self.scenes
                ]
        separations = np.vstack([np.zeros((0, values.size)), *apart])
        return Linearization(
            objectives=objectives,
            objectives_jacobian=jacobian,
            fullness=float(share[0]),
            fullness_slope=rise[0],
            separations=separations[:, 0].real,
            separations_jacobian=separations.imag / _COMPLEX_STEP,
        )

    def _slopes(
        self, space: Space, values: Float[Array, " d"]
    ) -> tuple[Float[Array, "s q"], Float[Array, "s q d"]]:
        """The objectives of each scene, and their derivatives."""
        at = np.asarray(values, dtype=np.float64)
        d, q = at.size, len(self.objectives)
        found = np.empty((len(self.scenes), q))
        slope = np.empty((len(self.scenes), q, d))
        turned = _turned(space, at)
        around: tuple[Array, Array] | None = None
        for s, scene in enumerate(self.scenes):
            exact = np.zeros(q, dtype=bool)
            if scene.in_batches:
                raw, independence = _fast(1, scene, turned, self.objectives)
                found[s], slope[s] = raw[0].real, raw.imag.T / _COMPLEX_STEP
                weighted = turned.noise_weight is not None
                exact[:] = [_is_fast(scene, weighted, name) for name in self.objectives]
                exact &= bool((independence >= _LEAST_INDEPENDENCE).all())
            if not exact.all():
                around = self._differences(space, at) if around is None else around
                found[s] = np.where(exact, found[s], around[0][s])
                slope[s] = np.where(exact[:, None], slope[s], around[1][s])
        return found, np.where(np.isfinite(found)[..., None] & np.isfinite(slope), slope, 0.0)

    def _slopes_over_scenes(
        self, found: Float[Array, "s q"], slope: Float[Array, "s q d"]
    ) -> tuple[Float[Array, " q"], Float[Array, "q d"]]:
        if self.over_scenes == "mean":
            return found.mean(axis=0), slope.mean(axis=0)
        active = np.where(self._higher, found.argmin(axis=0), found.argmax(axis=0))
        each = np.arange(found.shape[1])
        return found[active, each], slope[active, each]

    def _differences(
        self, space: Space, at: Float[Array, " d"]
    ) -> tuple[Float[Array, "s q"], Float[Array, "s q d"]]:
        """The objectives of each scene, and differences within the bounds."""
        low, high = (np.array([getattr(one, end) for one in space.parameters]) for end in _ENDS)
        step = np.diag(_DIFFERENCE_STEP * (high - low))
        above, below = np.minimum(at + step, high), np.maximum(at - step, low)
        found = self.values_of_scenes(space.candidates(np.vstack([at, above, below])))
        count = at.size
        with np.errstate(invalid="ignore"):
            rise = found[:, 1 : count + 1] - found[:, count + 1 :]
        width = np.diag(above) - np.diag(below)
        return found[:, 0], np.swapaxes(rise / width[:, None], 1, 2)

    @property
    def _higher(self) -> Bool[Array, " q"]:
        return np.array([one.better == "higher" for one in self.entries])

    def _over_scenes(self, values: Float[Array, "s m q"]) -> Float[Array, "m q"]:
        if self.over_scenes == "mean":
            return values.mean(axis=0)
        return np.where(self._higher, values.min(axis=0), values.max(axis=0))

    def _demand_grid(self, n: int) -> None:
        grid = self.scenes[0].point.illuminant.grid
        if n != grid.n:
            raise InputError(
                "QE of candidates",
                f"must have the {grid.n} wavelengths of the scenes",
                value=n,
                found=f"has {n}",
            )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Linearization:
    """Objectives at one point of a design space, and their derivatives.

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

    objectives: Float[Array, " q"]
    objectives_jacobian: Float[Array, "q d"]
    fullness: float
    fullness_slope: Float[Array, " d"]
    separations: Float[Array, " l"]
    separations_jacobian: Float[Array, "l d"]


def _turned(space: Space, values: Float[Array, " d"]) -> Candidates:
    """One copy of the candidate per parameter, with an imaginary step in that parameter."""
    return space.candidates(values + 1j * _COMPLEX_STEP * np.eye(len(values)))


def _is_fast(scene: DesignScene, noise_weight_is_free: bool, name: str) -> bool:
    """Whether it is computed in batches; not so SNR10 of a matrix that depends on the light."""
    adapts = scene.maker.method.over_light is not None or noise_weight_is_free
    return name in FAST and not (name == "snr10_lux" and adapts)


def _values(
    evaluator: Objectives, scene: DesignScene, batch: Candidates, names: tuple[str, ...]
) -> Float[Array, "m q"]:
    """The objectives in one scene."""
    found, independence = _fast(evaluator.threads, scene, batch, names)
    lost = np.flatnonzero(~(independence >= _LEAST_INDEPENDENCE))
    if lost.size:
        some = batch.some(lost).resolved()
        matrices, vora = _by_singular_values(scene, some)
        found[lost] = _fast(evaluator.threads, scene, some, names, matrices)[0]
        if "vora" in names:
            found[lost, names.index("vora")] = vora
    for q, name in enumerate(names):
        if not _is_fast(scene, batch.noise_weight is not None, name):
            found[:, q] = _library_values(scene, batch.resolved(), OBJECTIVES[name])
    return found


def _fast(
    threads: int | None,
    scene: DesignScene,
    batch: Candidates,
    names: tuple[str, ...],
    matrices: Array | None = None,
) -> tuple[Inexact[Array, "m q"], Float[Array, " m"]]:
    """Values, and 1 over the largest VIF of the equations; NaN for objectives that are not fast."""
    m, weighted = len(batch), batch.noise_weight is not None
    if weighted and scene.method not in NOISE_WEIGHTED:
        raise InputError(
            f"matrix of scene {scene.name}".rstrip(),
            f"must be one of {', '.join(NOISE_WEIGHTED)} where the weight of the noise is free",
            value=scene.matrix,
        )
    if matrices is None and not scene.in_batches:
        matrices = _matrices(scene, batch.resolved())
    found, independence = np.full((m, len(names)), np.nan, batch.dtype), np.ones(m)
    columns = [q for q, name in enumerate(names) if _is_fast(scene, weighted, name)]
    # real blocks have one size, so that the bits of a candidate do not depend on the others
    size = m if batch.dtype.kind == "c" else _AT_ONCE

    noise = noise_in(scene, batch)

    def work(first: int) -> None:
        last = min(first + size, m)
        rows: Any = slice(first, last)
        if last - first < size:
            rows = np.minimum(np.arange(first, first + size), m - 1)
        with np.errstate(all="ignore"):
            given = None if matrices is None else matrices[rows]
            at = Block(scene, batch.some(rows), noise[:, rows], given)
            for q in columns:
                values = _finished(OBJECTIVES[names[q]], FAST[names[q]](at), at.fullness)
                found[first:last, q] = values[: last - first]
        independence[first:last] = at.independence[: last - first]

    starts = range(0, m, size)
    with ThreadPoolExecutor(max(1, min(threads or os.cpu_count() or 1, len(starts)))) as pool:
        list(pool.map(work, starts))
    return found, independence


def _finished(objective: Objective, value: Array, fullness: Array) -> Inexact[Array, " m"]:
    """A column with `Objective.undefined` in place of NaN, and where a channel is saturated."""
    lost = np.isnan(value.real)
    if not objective.of_saturated:
        lost |= ~(fullness.real <= FULL)
    return np.where(lost, objective.undefined, value)


def _by_singular_values(
    scene: DesignScene, candidates: Candidates
) -> tuple[Float[Array, "m 3 p"], Float[Array, " m"]]:
    """Matrices and Vora values; NaN and -inf where a channel measures nothing."""
    arrays = scene_arrays(scene)
    dark = (candidates.qe.max(axis=1) == 0).any(axis=1)
    qe = np.where(dark[:, None, None], np.eye(*candidates.qe.shape[1:]), candidates.qe)
    dual, span = dual_and_orthonormal_bases(qe * arrays.basis[:, None])
    overlap = np.swapaxes(span, 1, 2) @ arrays.orthonormal_axes
    vora = np.where(dark, -np.inf, (overlap**2).sum(axis=(1, 2)) / 3)
    if scene.method != "kernel":
        return _matrices(scene, candidates), vora
    time_s = scene.point.exposure.time_s
    gain = np.ones(len(dark)) if candidates.time_s is None else candidates.time_s / time_s
    matrices = arrays.axes.T @ dual / gain[:, None, None]
    return np.where(dark[:, None, None], np.nan, matrices), vora


def _matrices(scene: DesignScene, candidates: Candidates) -> Float[Array, "m 3 p"]:
    """The matrices one by one; NaN where a channel measures nothing."""
    return np.array([_matrix(scene, candidates, i) for i in range(len(candidates))])


def _matrix(scene: DesignScene, candidates: Candidates, i: int) -> Float[Array, "3 p"]:
    point = _point(scene, candidates, i)
    sensor, p = point.sensor, len(point.sensor.names)
    if not _has_signal(point):
        return np.full((3, p), np.nan)
    share, weight = candidates.pixel_share, candidates.noise_weight
    if scene.method not in NOISE_WEIGHTED or (share is None and weight is None):
        return scene.maker(point).matrix
    arrays, gain = scene_arrays(scene), point.exposure.time_s / scene.point.exposure.time_s
    seen, mean_e, white_e = (
        gain * (rows @ sensor.qe)
        for rows in (arrays.training_e, arrays.training_mean_e, arrays.white_e)
    )
    law = noise_sources(sensor, point.exposure).law()
    variance = mean_e + law.floor_e2 + law.square * (seen**2).sum(axis=0)
    if share is not None:
        variance = variance / (p * share[i])
    return penalized_matrix(
        f"{scene.matrix} for {sensor.name}",
        seen,
        arrays.training_xyz,
        np.diag((scene.noise_weight if weight is None else weight[i]) * variance),
        scale=np.where(white_e > 0, white_e, 1.0),
    )


def _library_values(
    scene: DesignScene, candidates: Candidates, objective: Objective
) -> Float[Array, " m"]:
    """One objective by the library's function, candidate by candidate."""
    if candidates.pixel_share is not None and objective.of_noise:
        raise InputError(
            f"objective {objective.name}",
            "cannot be combined with free pixel shares",
            remedy="fix the shares, or take snr_y_db or noise_delta_e",
        )
    return np.array(
        [_library_value(scene, candidates, i, objective) for i in range(len(candidates))]
    )


def _library_value(
    scene: DesignScene, candidates: Candidates, i: int, objective: Objective
) -> float:
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


def _point(scene: DesignScene, candidates: Candidates, i: int) -> OperatingPoint:
    time_s = None if candidates.time_s is None else float(candidates.time_s[i])
    pixel = {name: float(values[i]) for name, values in candidates.pixel.items()}
    return candidate_point(scene, candidates.qe[i], time_s=time_s, **pixel)
