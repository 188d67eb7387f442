"""Pairs of patches that a reader must tell apart."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Int
from chromanoise.errors import InputError
from chromanoise.spectra.curves import Spectra


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PatchPairs:
    """Reflectances, and which two of them form each pair.

    Attributes
    ----------
    patches
        The reflectances, one column per patch. [1]
    indices
        Columns of the two patches of each pair.

    Raises
    ------
    InputError
        If there is no pair, or an index is not that of a patch.
    """

    patches: Spectra
    indices: Int[Array, "m 2"]

    def __post_init__(self) -> None:
        count = len(self.patches.names)
        indices = np.asarray(self.indices, dtype=np.int64)
        if indices.ndim != 2 or indices.shape[1] != 2 or len(indices) == 0:
            raise InputError(
                "pairs",
                "must hold at least one pair of patches",
                value=indices.shape,
                found=f"{self.patches.source} has {count} patch{'' if count == 1 else 'es'}",
            )
        outside = (indices < 0) | (indices >= count)
        if outside.any():
            raise InputError(
                "pairs", f"must be indices from 0 to {count - 1}", value=int(indices[outside][0])
            )
        object.__setattr__(self, "indices", _check.frozen(indices))

    @property
    def names(self) -> tuple[tuple[str, str], ...]:
        """Names of the two patches of each pair."""
        patches = self.patches.names
        return tuple((patches[i], patches[j]) for i, j in self.indices)


def all_pairs(patches: Spectra) -> PatchPairs:
    """Each patch with each other one: 276 pairs for the 24 patches of a ColorChecker.

    Parameters
    ----------
    patches
        At least two reflectances.

    Raises
    ------
    InputError
        If there are fewer than two.
    """
    pairs = list(combinations(range(len(patches.names)), 2))
    return PatchPairs(patches=patches, indices=np.array(pairs, dtype=np.int64).reshape(-1, 2))
