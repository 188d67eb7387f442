"""Objectives of many candidates in one or more scenes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Inexact
from chromanoise.analysis import electrons_at, matrix_makers
from chromanoise.design.candidates import Candidates
from chromanoise.design.objectives import OBJECTIVES, Candidate, Objective, value_of
from chromanoise.design.scenes import DesignScene, candidate_point
from chromanoise.errors import InputError
from chromanoise.noise import signal_limit_e

OVER_SCENES = ("worst", "mean")
_STEP = 1e-6  # of the range of a parameter, for central differences


class Space(Protocol):
    """A design space: values of parameters to candidates (`chromanoise.design.DesignSpace`)."""

    parameters: Sequence[Any]

    def candidates(self, values: Inexact[Array, "m d"]) -> Candidates:
        """The candidates of values of the parameters; complex for complex values."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evaluator:
    """Computes objectives of candidates.

    Attributes
    ----------
    scenes
        The scenes, with one wavelength grid.
    objectives
        Names from `chromanoise.design.objectives.OBJECTIVES`.
    over_scenes
        ``worst`` or ``mean`` of each objective over the scenes.

    Raises
    ------
    InputError
        If there is no scene or no objective, a name is unknown, or the grids differ.
    """

    scenes: tuple[DesignScene, ...]
    objectives: tuple[str, ...]
    over_scenes: Literal["worst", "mean"] = "worst"

    def __post_init__(self) -> None:
        for what, given in (("scenes", self.scenes), ("objectives", self.objectives)):
            if not given:
                raise InputError(what, "must hold at least one", found="is empty")
        for name in _check.distinct("objectives", self.objectives):
            _check.one_of("objective", name, tuple(OBJECTIVES))
        _check.one_of("over_scenes", self.over_scenes, OVER_SCENES)
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

        A value that is not defined, as that of a saturated candidate, is -inf or inf: the worst one.

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
        self._refuse(candidates)
        return np.array([self._library_values(scene, candidates) for scene in self.scenes])

    def share_of_full_well(self, candidates: Candidates) -> Float[Array, " m"]:
        """Electrons of a perfect white over full well or top code, fullest channel and scene. [1]

        Parameters
        ----------
        candidates
            As `values`.
        """
        self._refuse(candidates)
        shares = np.array(
            [
                [_share_of_full_well(_point(scene, candidates, i)) for i in range(len(candidates))]
                for scene in self.scenes
            ]
        )
        return shares.max(axis=0)

    def gradient(
        self, space: Space, values: Float[Array, " d"]
    ) -> tuple[Float[Array, " q"], Float[Array, "q d"]]:
        """The objectives at one point of a design space, and their derivatives.

        Parameters
        ----------
        space
            The design space.
        values
            Its parameters.
        """
        step = _STEP * np.array([one.high - one.low for one in space.parameters])
        at = np.asarray(values, dtype=np.float64)
        around = np.concatenate([at[None], at + np.diag(step), at - np.diag(step)])
        found = self.values(space.candidates(around))
        d = at.size
        return found[0], ((found[1 : d + 1] - found[d + 1 :]) / (2 * step[:, None])).T

    def _over_scenes(self, values: Float[Array, "s m q"]) -> Float[Array, "m q"]:
        if self.over_scenes == "mean":
            return values.mean(axis=0)
        higher = np.array([one.better == "higher" for one in self.entries])
        return np.where(higher, values.min(axis=0), values.max(axis=0))

    def _library_values(self, scene: DesignScene, candidates: Candidates) -> Float[Array, "m q"]:
        return np.array(
            [
                [value_of(one, _candidate(scene, candidates, i)) for one in self.entries]
                for i in range(len(candidates))
            ]
        )

    def _refuse(self, candidates: Candidates) -> None:
        if len(candidates) == 0:
            raise InputError("candidates", "must hold at least one", found="there is none")
        grid = self.scenes[0].point.illuminant.grid
        if candidates.qe.shape[1] != grid.n:
            raise InputError(
                "QE of candidates",
                f"must have the {grid.n} wavelengths of the scenes",
                value=candidates.qe.shape,
                found=f"has {candidates.qe.shape[1]}",
            )


def _candidate(scene: DesignScene, candidates: Candidates, i: int) -> Candidate:
    point = _point(scene, candidates, i)
    maker = scene.maker
    if candidates.noise_weight is not None:
        name = f"noise-regularized={float(candidates.noise_weight[i])!r}"
        maker = matrix_makers([name], scene.metric, prior=scene.prior)[name]
    return Candidate(point=point, matrix=maker(point), maker=maker)


def _point(scene: DesignScene, candidates: Candidates, i: int) -> Any:
    given = {
        name: None if (values := getattr(candidates, name)) is None else values[i]
        for name in ("time_s", "read_noise_e", "prnu")
    }
    return candidate_point(scene, candidates.qe[i], **given)


def _share_of_full_well(point: Any) -> float:
    return float(electrons_at(point).max() / signal_limit_e(point.sensor, point.exposure))
