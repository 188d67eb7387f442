"""Training data from sRGB pictures: conversion to linear raw and back, and PyTorch classes.

Each step of the conversion can be switched off: tone curve, sRGB curve, color matrix, gains,
mosaic. PyTorch is an optional extra, ``pip install 'chromanoise[torch]'``, and is imported when an
object that uses it is made.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from chromanoise.apps.training.training_noise import NoiseSampler, Unit
from chromanoise.base import Array, Float, InputError, check, dataclass, inv, optional_package
from chromanoise.color import srgb_from_linear
from chromanoise.imaging import FilterBank, channel_tile, demosaicked
from chromanoise.sensor import Mosaic

_TOE = 0.0031308 * 12.92  # end of the line of the sRGB curve
_HIGHLIGHT = 0.9  # from here on a gain below 1 keeps white at white
_RGB = ("R", "G", "B")


@dataclass(frozen=True, kw_only=True, eq=False)
class Rendering:
    """How a camera turns raw values into an sRGB picture, in the order of the fields.

    Attributes
    ----------
    red_gain, blue_gain
        White balance: factors of R and B, > 0; that of G is 1. [1]
    brightness
        Factor of all channels, > 0. [1]
    camera_to_srgb
        Matrix from white-balanced camera RGB to linear sRGB; ``None`` for no matrix. Rows that sum
        to 1 keep white. [1]
    srgb_curve
        Whether values are encoded by the curve of IEC 61966-2-1.
    tone_curve
        Whether contrast is raised by the curve 3 x^2 - 2 x^3.

    Raises
    ------
    InputError
        If a factor is not above 0, or the matrix is not 3 x 3, finite and invertible.

    Notes
    -----
    Brooks, Mildenhall, Xue, Chen, Sharlet & Barron, "Unprocessing images for learned raw
    denoising", CVPR (2019), section 3. They raise contrast after the encoding, as here.
    """

    red_gain: float = 1.0
    blue_gain: float = 1.0
    brightness: float = 1.0
    camera_to_srgb: Float[Array, "3 3"] | None = None
    srgb_curve: bool = True
    tone_curve: bool = True

    def __post_init__(self) -> None:
        for name in ("red_gain", "blue_gain", "brightness"):
            check.within(name, "1", getattr(self, name), 1e-3, 1e3)
        if self.camera_to_srgb is not None:
            matrix = check.finite("camera_to_srgb", "1", self.camera_to_srgb)
            check.shape("camera_to_srgb", matrix, matrix.shape == (3, 3), "must be 3 x 3")
            inv("camera_to_srgb", matrix)
            object.__setattr__(self, "camera_to_srgb", check.frozen(matrix))


def draw_rendering(
    rng: np.random.Generator, *, camera_to_srgb: Float[Array, "3 3"] | None = None
) -> Rendering:
    """A random rendering, with the gains that Brooks et al. found in photographs.

    Parameters
    ----------
    rng
        Random stream, e.g. ``chromanoise.base.rng.stream(seed, item)``.
    camera_to_srgb
        As `Rendering`.

    Returns
    -------
    Rendering
        Red gain uniform from 1.9 to 2.4, blue gain from 1.5 to 1.9; 1 / brightness normal with
        mean 0.8 and standard deviation 0.1, from 0.4 to 1.2.

    Notes
    -----
    Brooks et al., CVPR (2019), section 3.2.
    """
    inverse = float(np.clip(rng.normal(0.8, 0.1), 0.4, 1.2))
    return Rendering(
        red_gain=float(rng.uniform(1.9, 2.4)),
        blue_gain=float(rng.uniform(1.5, 1.9)),
        brightness=1 / inverse,
        camera_to_srgb=camera_to_srgb,
    )


def unprocess(
    srgb: Float[Array, "h w 3"], rendering: Rendering, *, mosaic: Mosaic | None = None
) -> Float[Array, "h w *channels"]:
    """Linear raw values of an sRGB picture, 0 at black and 1 at white.

    Parameters
    ----------
    srgb
        0 .. 1; divide the codes of an 8-bit picture by 255.
    rendering
        The rendering that made the picture; its steps are undone from the last to the first.
    mosaic
        The channel of each pixel, of R, G (or G1, G2) and B; ``None`` for all three channels.

    Returns
    -------
    (h, w) array, or (h, w, 3) without a mosaic
        From 0 to 1: colors outside the camera's gamut are clipped.

    Raises
    ------
    InputError
        If the picture is not (h, w, 3) with values from 0 to 1, or the mosaic has other channels.

    Notes
    -----
    Brooks et al., CVPR (2019), section 3: inverse tone curve 1/2 - sin(asin(1 - 2 x) / 3), inverse
    sRGB curve, inverse matrix, inverse gains. Where all channels are above 0.9, gains below 1
    fade to 1, so that white, which may have been clipped, stays white.

    Examples
    --------
    >>> plain = Rendering(tone_curve=False, red_gain=2.0)
    >>> unprocess(np.full((1, 1, 3), 0.5), plain).round(3)
    array([[[0.107, 0.214, 0.214]]])
    """
    picture = check.fraction("srgb", "1", srgb)
    check.shape("srgb", picture, _has_three_channels(picture), "must be (rows, columns, 3)")
    if rendering.tone_curve:
        picture = 0.5 - np.sin(np.arcsin(1.0 - 2.0 * picture) / 3.0)
    if rendering.srgb_curve:
        picture = linear_from_srgb(picture)
    if rendering.camera_to_srgb is not None:
        picture = picture @ inv("camera_to_srgb", rendering.camera_to_srgb).T
    picture = np.clip(_with_gains(picture, 1 / _gains(rendering)), 0.0, 1.0)
    return picture if mosaic is None else mosaicked(picture, mosaic)


def process(
    raw: Float[Array, "h w *channels"],
    rendering: Rendering,
    *,
    demosaicing: FilterBank | None = None,
) -> Float[Array, "h w 3"]:
    """An sRGB picture of linear raw values, 0 .. 1; the inverse of `unprocess`.

    Parameters
    ----------
    raw
        0 at black and 1 at white: (h, w) of a mosaic, or (h, w, 3).
    rendering
        Its steps are applied from the first to the last.
    demosaicing
        Linear method for a mosaic of R, G and B, in this order, e.g.
        ``bilinear_filters(bayer(), ("R", "G", "B"))``.

    Returns
    -------
    (h, w, 3) array
        Clipped to 0 .. 1 before the curves.

    Raises
    ------
    InputError
        If a mosaic has no demosaicing, the demosaicing has other channels, or a value is not
        finite.

    Notes
    -----
    Brooks et al., CVPR (2019), section 3.

    Examples
    --------
    >>> plain = Rendering(tone_curve=False, red_gain=2.0)
    >>> process(unprocess(np.full((1, 1, 3), 0.5), plain), plain).round(6)
    array([[[0.5, 0.5, 0.5]]])
    """
    picture = check.finite("raw", "1", raw)
    if picture.ndim == 2:
        if demosaicing is None or demosaicing.names != _RGB:
            raise InputError(
                "demosaicing",
                "must give R, G and B of a mosaic",
                value=None if demosaicing is None else demosaicing.names,
                found="is missing" if demosaicing is None else None,
                remedy='use bilinear_filters(bayer(), ("R", "G", "B"))',
            )
        picture = demosaicked(picture, demosaicing)
    shapes = "must be (rows, columns) or (rows, columns, 3)"
    check.shape("raw", picture, _has_three_channels(picture), shapes)
    picture = picture * _gains(rendering)
    if rendering.camera_to_srgb is not None:
        picture = picture @ rendering.camera_to_srgb.T
    picture = np.clip(picture, 0.0, 1.0)
    if rendering.srgb_curve:
        picture = np.clip(srgb_from_linear(picture), 0.0, 1.0)
    if rendering.tone_curve:
        picture = (3.0 - 2.0 * picture) * picture**2
    return picture


def linear_from_srgb(encoded: Float[Array, "*px"]) -> Float[Array, "*px"]:
    """Linear values of encoded sRGB.

    Parameters
    ----------
    encoded
        Values from 0 to 1. [1]

    Returns
    -------
    (*px) array

    Notes
    -----
    IEC 61966-2-1 (1999).

    Examples
    --------
    >>> linear_from_srgb(np.array([0.0, 0.46135, 1.0])).round(4)
    array([0.  , 0.18, 1.  ])
    """
    power = ((np.maximum(encoded, _TOE) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= _TOE, encoded / 12.92, power)


def mosaicked(picture: Float[Array, "h w 3"], mosaic: Mosaic) -> Float[Array, "h w"]:
    """The picture reduced to the one channel that a mosaic measures in each pixel.

    Parameters
    ----------
    picture
        R, G and B.
    mosaic
        Of the channels R, G and B; G1 and G2 are green too.

    Returns
    -------
    (h, w) array

    Raises
    ------
    InputError
        If the mosaic has other channels.

    Notes
    -----
    Bayer, US patent 3,971,065 (1976).

    Examples
    --------
    >>> from chromanoise.sensor import bayer
    >>> mosaicked(np.full((2, 2, 3), [1.0, 2.0, 3.0]), bayer())
    array([[1., 2.],
           [2., 3.]])
    """
    green = {"G1": "G", "G2": "G"}
    plain = Mosaic(tuple(tuple(green.get(one, one) for one in row) for row in mosaic.pattern))
    tile = channel_tile(plain, _RGB)
    rows, columns = np.arange(picture.shape[0])[:, None], np.arange(picture.shape[1])
    return picture[rows, columns, tile[rows % tile.shape[0], columns % tile.shape[1]]]


def _has_three_channels(picture: Array) -> bool:
    return picture.ndim == 3 and picture.shape[2] == 3


def _gains(rendering: Rendering) -> Array:
    return rendering.brightness * np.array([rendering.red_gain, 1.0, rendering.blue_gain])


def _with_gains(picture: Array, gains: Array) -> Array:
    """The picture times the gains, of which those below 1 fade to 1 in the highlights."""
    gray = picture.mean(axis=-1, keepdims=True)
    share = np.clip((gray - _HIGHLIGHT) / (1.0 - _HIGHLIGHT), 0.0, 1.0) ** 2
    kept = np.maximum(gains, share + (1.0 - share) * gains)
    return picture * kept


class NoisyDataset:
    """A map-style data set for ``torch.utils.data.DataLoader`` over clean pictures.

    Item i is (noisy, clean, variance): float32 tensors, (h, w) for a mosaic and (p, h, w) for
    pictures (h, w, p).

    Parameters
    ----------
    pictures
        Clean linear raw pictures: anything with a length and an index, such as a list of arrays,
        tensors or ``np.memmap``.
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
    each epoch, set ``epoch`` before the workers start.
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
        check.at_least_one("repeats", repeats)
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
    otherwise = ("use cn.apps.training.sampler",)
    return optional_package("torch", "a data set of PyTorch", extra="torch", otherwise=otherwise)
