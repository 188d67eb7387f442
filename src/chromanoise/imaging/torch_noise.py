"""Noisy training data for PyTorch, an optional extra: ``pip install 'chromanoise[torch]'``.

PyTorch is imported when an object of this module is made.
"""

from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.imaging.training_noise import NoiseSampler, Unit


class NoisyDataset:
    """A map-style data set for ``torch.utils.data.DataLoader`` over clean pictures.

    Item i is (noisy, clean, variance): float32 tensors, (h, w) for a mosaic and (p, h, w) for
    pictures (h, w, p).

    Parameters
    ----------
    pictures
        Clean linear raw pictures: anything with a length and an index, such as a list of arrays,
        tensors or ``np.memmap``.
    sampler
        Adds the noise.
    unit
        Unit of the pictures, see `NoiseSampler`.
    iso, time_s
        As the call of `NoiseSampler`, the same for all items. [1], [s]
    repeats
        How often each picture occurs, each time with new noise. The length of the data set is
        the number of pictures times ``repeats``; item i is picture i modulo their number.

    Raises
    ------
    InputError
        If PyTorch is not installed, there is no picture, or ``repeats`` is below 1.

    Notes
    -----
    The noise of item i depends on the sampler's seed and on i only, so it is the same with any
    number of workers and in any order. A worker process uses one thread. For new noise in
    each epoch, set `epoch` before the workers start.
    """

    def __init__(
        self,
        pictures: Sequence[Any],
        sampler: NoiseSampler,
        *,
        unit: Unit,
        iso: float | None = None,
        time_s: float | None = None,
        repeats: int = 1,
    ) -> None:
        _torch()
        if len(pictures) == 0:
            raise InputError("pictures", "must hold at least one picture", value=0)
        if repeats < 1:
            raise InputError("repeats", "must be at least 1", value=repeats)
        self.pictures, self.sampler, self.unit = pictures, sampler, unit
        self.iso, self.time_s, self.repeats = iso, time_s, repeats
        self.epoch = 0
        """Number of the epoch: each has new noise."""

    def __len__(self) -> int:
        return len(self.pictures) * self.repeats

    def __getitem__(self, index: int) -> tuple[Any, Any, Any]:
        if not -len(self) <= index < len(self):
            raise IndexError(f"item {index} of a data set of {len(self)}")
        index = int(index) % len(self)
        torch = _torch()
        working = torch.utils.data.get_worker_info() is not None
        sampler = replace(self.sampler, threads=1) if working else self.sampler
        sample = sampler(
            np.asarray(self.pictures[index % len(self.pictures)]),
            unit=self.unit,
            item=self.epoch * len(self) + index,
            iso=self.iso,
            time_s=self.time_s,
        )
        found = [_tensor(torch, one) for one in (sample.noisy, sample.clean, sample.variance)]
        return found[0], found[1], found[2]


class AddCameraNoise:
    """A transform from a clean tensor to (noisy, variance); each call has the next item's noise.

    Parameters
    ----------
    sampler
        Adds the noise.
    unit
        Unit of the tensors, see `NoiseSampler`.
    iso, time_s
        As the call of `NoiseSampler`. [1], [s]
    first_item
        Number of the first call's item. Workers that each have a copy of the transform need
        different numbers; `NoisyDataset` does not.

    Raises
    ------
    InputError
        If PyTorch is not installed.
    """

    def __init__(
        self,
        sampler: NoiseSampler,
        *,
        unit: Unit,
        iso: float | None = None,
        time_s: float | None = None,
        first_item: int = 0,
    ) -> None:
        _torch()
        self.sampler, self.unit, self.iso, self.time_s = sampler, unit, iso, time_s
        self.item = first_item

    def __call__(self, clean: Any, *, item: int | None = None) -> tuple[Any, Any]:
        """The noisy tensor and the variance of each value.

        Parameters
        ----------
        clean
            (h, w) of a mosaic, or (p, h, w) with all channels of the camera.
        item
            Number of the item; ``None`` for the next one.

        Returns
        -------
        tuple of two tensors

        Raises
        ------
        InputError
            As the call of `NoiseSampler`.
        """
        torch = _torch()
        if item is None:
            item, self.item = self.item, self.item + 1
        values = clean.detach().cpu().numpy()
        picture = np.moveaxis(values, 0, -1) if values.ndim == 3 else values
        sample = self.sampler(picture, unit=self.unit, item=item, iso=self.iso, time_s=self.time_s)
        return _tensor(torch, sample.noisy), _tensor(torch, sample.variance)


def _tensor(torch: Any, values: Array) -> Any:
    """A tensor with the channels first."""
    first = np.moveaxis(values, -1, 0) if values.ndim == 3 else values
    return torch.from_numpy(np.array(first, order="C"))  # a copy: transforms may work in place


def _torch() -> Any:
    try:
        return import_module("torch")
    except ImportError:
        raise InputError(
            "data sets of PyTorch",
            "need the package torch, which is not installed",
            remedy=("install it with pip install 'chromanoise[torch]'", "use cn.noise.sampler"),
        ) from None
