"""Every channel at every pixel: linear demosaicing of any periodic mosaic.

A linear method is a table of filters, one for each position in the tile and each channel, so its
noise has a closed form (`demosaic_methods`). This module defines the table, its application to a
raw image, and the two methods that need no statistical model of images.
"""

from collections.abc import Sequence

import numpy as np

from chromanoise.base import Array, Float, Float32, InputError, Int, Num, Setting, check, dataclass
from chromanoise.imaging.kernel_cache import kernel_of
from chromanoise.sensor import MOSAIC_NAMES, Mosaic, mosaic_named


@dataclass(frozen=True, kw_only=True, eq=False)
class FilterBank:
    """A linear demosaicing method for one mosaic.

    Attributes
    ----------
    mosaic
        The channel of each pixel; its tile starts at row 0, column 0 of the image.
    names
        The ``p`` channels, in the order of the result.
    kernels
        Weights of the k x k pixels around a pixel, per row and column of the tile and channel.
        [1]
    made_by
        Name of the method in results.

    Raises
    ------
    InputError
        If the kernels do not match the mosaic and the names, or have an even size.
    """

    mosaic: Mosaic
    names: tuple[str, ...]
    kernels: Float[Array, "ty tx p k k"]
    made_by: str

    def __post_init__(self) -> None:
        kernels = check.finite(f"kernels of {self.made_by}", "1", self.kernels)
        tile = channel_tile(self.mosaic, self.names)
        side = kernels.shape[-1]
        if kernels.shape != (*tile.shape, len(self.names), side, side) or side % 2 == 0:
            raise InputError(
                f"kernels of {self.made_by}",
                f"must be {(*tile.shape, len(self.names))} filters of k x k with an odd k",
                value=kernels.shape,
                found=f"have shape {kernels.shape}",
            )
        object.__setattr__(self, "kernels", check.frozen(kernels))

    @property
    def radius(self) -> int:
        """Radius of the filters. [pixels]"""
        return self.kernels.shape[-1] // 2


def channel_tile(mosaic: Mosaic, names: Sequence[str]) -> Int[Array, "ty tx"]:
    """Index in ``names`` of the channel at each position in the tile.

    Parameters
    ----------
    names
        Channels in the order of the result; each must occur in the mosaic.

    Raises
    ------
    InputError
        If a channel of the mosaic is not in ``names``, or the reverse.

    Examples
    --------
    >>> channel_tile(Mosaic((("R", "G"), ("G", "B"))), ("R", "G", "B"))
    array([[0, 1],
           [1, 2]])
    """
    wanted = check.distinct("channel names", names)
    for name in mosaic.names:
        check.among("mosaic channel", name, wanted)
    for name in wanted:
        if name not in mosaic.names:
            raise InputError(
                f"channel {name!r}",
                f"must be in the mosaic ({', '.join(mosaic.names)}) to be interpolated",
                found="is over no pixel of it",
                remedy=Setting("mosaic", _mosaics_of(wanted)),
            )
    return np.array([[wanted.index(name) for name in row] for row in mosaic.pattern])


def _mosaics_of(names: Sequence[str]) -> tuple[str, ...]:
    """The named mosaics with exactly these channels."""
    return tuple(one for one in MOSAIC_NAMES if set(mosaic_named(one).names) == set(names))


def channels_around(tile: Int[Array, "ty tx"], radius: int) -> Int[Array, "ty tx k k"]:
    """Channels in the window of side ``2 radius + 1`` around each position in the tile.

    Examples
    --------
    >>> channels_around(np.array([[0, 1]]), 1)[0, 0]
    array([[1, 0, 1],
           [1, 0, 1],
           [1, 0, 1]])
    """
    offsets = np.arange(-radius, radius + 1)
    rows = (np.arange(tile.shape[0])[:, None] + offsets) % tile.shape[0]
    columns = (np.arange(tile.shape[1])[:, None] + offsets) % tile.shape[1]
    return tile[rows[:, None, :, None], columns[None, :, None, :]]


def channel_period(tile: Int[Array, "ty tx"], channel: int) -> tuple[int, int]:
    """Period of one channel in rows and columns: that of the tile or a divisor of it.

    Examples
    --------
    White of a sparse array repeats after 2 x 2 pixels, although the tile has 4 x 4.

    >>> from chromanoise.sensor import rgbw_sparse_4x4
    >>> channel_period(channel_tile(rgbw_sparse_4x4(), ("R", "G", "B", "W")), 3)
    (2, 2)
    """
    here = tile == channel
    shifts = [
        next(s for s in range(1, n + 1) if n % s == 0 and (np.roll(here, s, axis) == here).all())
        for axis, n in enumerate(here.shape)
    ]
    return shifts[0], shifts[1]


def bilinear_filters(mosaic: Mosaic, names: Sequence[str] | None = None) -> FilterBank:
    """Interpolation of each channel separately, with weights that fall linearly with distance.

    Parameters
    ----------
    names
        Channels in the order of the result; by default that of first appearance in the mosaic.

    Raises
    ------
    InputError
        If ``names`` are not the channels of the mosaic.

    Notes
    -----
    Where a channel repeats after s rows and t columns, the weights of its pixels are
    (1 - |dy|/s) (1 - |dx|/t) over their sum. The window |dy| < s, |dx| < t always contains
    each position of the channel in its period. For one such position the weights sum to 1 and have
    no first moment (bilinear interpolation on a grid), so constants and ramps are exact for any
    number of positions. The measured channel of a pixel is unchanged. For a Bayer
    array these are the classical filters.

    Examples
    --------
    Green at a red pixel is the mean of its four neighbors.

    >>> from chromanoise.sensor import bayer
    >>> bilinear_filters(bayer(), ("R", "G", "B")).kernels[0, 0, 1] * 4
    array([[0., 1., 0.],
           [1., 0., 1.],
           [0., 1., 0.]])
    """
    wanted = tuple(names or mosaic.names)
    tile = channel_tile(mosaic, wanted)
    radius = max(tile.shape) - 1
    around = channels_around(tile, radius)
    kernels = [_tent(around == c, channel_period(tile, c)) for c in range(len(wanted))]
    return bank_of("bilinear", mosaic, wanted, np.stack(kernels, axis=2))


def malvar_filters(mosaic: Mosaic, names: Sequence[str] | None = None) -> FilterBank:
    """The gradient-corrected filters of Malvar, He & Cutler for a Bayer array, as published.

    Parameters
    ----------
    mosaic
        2 x 2, one channel on a diagonal and two others beside it, in any of the four positions.
    names
        As `bilinear_filters`.

    Raises
    ------
    InputError
        If the mosaic is no Bayer array.

    Notes
    -----
    Malvar, He & Cutler, "High-quality linear interpolation for demosaicing of Bayer-patterned
    color images", ICASSP (2004), figure 2; gains 1/2, 5/8 and 3/4.

    Examples
    --------
    Red at a blue pixel: 6, 2 and -3/2 eighths.

    >>> from chromanoise.sensor import bayer
    >>> malvar_filters(bayer(), ("R", "G", "B")).kernels[1, 1, 0] * 8
    array([[ 0. ,  0. , -1.5,  0. ,  0. ],
           [ 0. ,  2. ,  0. ,  2. ,  0. ],
           [-1.5,  0. ,  6. ,  0. , -1.5],
           [ 0. ,  2. ,  0. ,  2. ,  0. ],
           [ 0. ,  0. , -1.5,  0. ,  0. ]])
    """
    wanted = tuple(names or mosaic.names)
    if not is_bayer(mosaic):
        raise InputError(
            "mosaic",
            "must be a Bayer array (2 x 2, one channel on a diagonal, two others beside it) for "
            "Malvar's filters",
            value=mosaic.pattern,
            found=f"is {'/'.join(' '.join(row) for row in mosaic.pattern)}",
            remedy=Setting("demosaic", ("gradient",)),
        )
    tile = channel_tile(mosaic, wanted)
    around = channels_around(tile, 1)
    kernels = np.zeros((2, 2, 3, 5, 5))
    for a, b, c in np.ndindex(2, 2, 3):
        kernels[a, b, c] = _malvar(around[a, b] == c)
    return bank_of("Malvar-He-Cutler", mosaic, wanted, kernels)


def is_bayer(mosaic: Mosaic) -> bool:
    """Whether one of three channels is on a diagonal of a 2 x 2 tile, and two are off it."""
    if [len(row) for row in mosaic.pattern] != [2, 2] or len(mosaic.names) != 3:
        return False
    (a, b), (c, d) = mosaic.pattern
    return a == d or b == c


def demosaicked(raw_e: Float[Array, "h w"], bank: FilterBank) -> Float[Array, "h w p"]:
    """All channels of a raw image in float64: the reference for the compiled kernels.

    Parameters
    ----------
    raw_e
        One number per pixel. [e-]

    Raises
    ------
    InputError
        If the image is smaller than one tile of the mosaic, or contains NaN or infinity.

    Notes
    -----
    Outside the border the image is mirrored and shifted to the nearest pixel of the same channel;
    for a period of 2 this is the mirror image without repetition of the border pixel.

    Examples
    --------
    >>> from chromanoise.sensor import bayer
    >>> raw = np.array([[10.0, 20.0], [20.0, 30.0]])  # a flat field of R 10, G 20, B 30
    >>> demosaicked(raw, bilinear_filters(bayer()))[1, 0]
    array([10., 20., 30.])
    """
    raw = check.finite("raw_e", "e-", raw_e)
    padded = raw[border_pixels(raw.shape, bank)]
    windows = np.lib.stride_tricks.sliding_window_view(padded, bank.kernels.shape[-2:])
    ty, tx, p = bank.kernels.shape[:3]
    out = np.empty((*raw.shape, p))
    for a, b in np.ndindex(ty, tx):
        filters = bank.kernels[a, b]
        np.einsum("hwij,cij->hwc", windows[a::ty, b::tx], filters, out=out[a::ty, b::tx])
    return out


def border_pixels(shape: tuple[int, int], bank: FilterBank) -> tuple[Array, Array]:
    """Row and column indices that pad an image by ``bank.radius`` pixels on each side.

    Indexing the image with the pair (an open mesh, as `numpy.ix_`) gives the padded image.

    Raises
    ------
    InputError
        If the picture is smaller than one tile of the mosaic.

    Examples
    --------
    >>> from chromanoise.sensor import bayer
    >>> border_pixels((3, 4), bilinear_filters(bayer()))[1]
    array([[1, 0, 1, 2, 3, 2]])
    """
    period = bank.kernels.shape[:2]
    if shape[0] < period[0] or shape[1] < period[1]:
        raise InputError(
            "the picture",
            f"must hold one tile of the mosaic ({period[0]} x {period[1]}), so that every "
            "channel is measured",
            value=tuple(shape),
            found=f"is {shape[0]} x {shape[1]}",
            remedy=("take the raw mosaic", "take a larger picture"),
        )
    rows, columns = (mirrored(n, t, bank.radius) for n, t in zip(shape, period, strict=True))
    return rows[:, None], columns[None, :]


def bank_of(made_by: str, mosaic: Mosaic, names: tuple[str, ...], kernels: Array) -> FilterBank:
    """A filter bank whose kernels have their margin of zeros removed.

    Examples
    --------
    >>> kernels = np.zeros((1, 1, 1, 5, 5))
    >>> kernels[..., 2, 2] = 1.0
    >>> bank_of("as it is", Mosaic((("W",),)), ("W",), kernels).radius
    0
    """
    used = np.argwhere((kernels != 0).any(axis=(0, 1, 2))) - kernels.shape[-1] // 2
    reach = int(np.abs(used).max(initial=0))
    inner = slice(kernels.shape[-1] // 2 - reach, kernels.shape[-1] // 2 + reach + 1)
    return FilterBank(
        mosaic=mosaic, names=names, kernels=kernels[..., inner, inner], made_by=made_by
    )


def mirrored(count: int, period: int, radius: int) -> Int[Array, " padded"]:
    """Indices in the image for -radius .. count + radius - 1, each of the same phase."""
    places = np.arange(-radius, count + radius)
    for i in np.flatnonzero((places < 0) | (places >= count)):
        mirror = -places[i] if places[i] < 0 else 2 * (count - 1) - places[i]
        alike = np.arange(places[i] % period % count, count, period)
        places[i] = alike[np.abs(alike - mirror).argmin()]
    return places


def _tent(here: Array, period: tuple[int, int]) -> Float[Array, "ty tx k k"]:
    """Weights of the pixels of one channel (``here``) that fall linearly to 0 at its period."""
    radius = here.shape[-1] // 2
    away = np.abs(np.arange(-radius, radius + 1))
    rows, columns = (np.maximum(1.0 - away / s, 0.0) for s in period)
    weights = here * (rows[:, None] * columns)
    own = here[..., radius, radius]
    weights[own] = 0.0
    weights[own, radius, radius] = 1.0
    return weights / weights.sum(axis=(-2, -1), keepdims=True)


def _malvar(here: Array) -> Float[Array, "5 5"]:
    """The published filter for a channel, selected by its positions in the 3 x 3 window."""
    kernel = np.zeros((5, 5))
    if here[1, 1]:
        kernel[2, 2] = 8.0
    elif here[1, 0] and here[0, 1]:  # green at red or blue
        kernel[2] = kernel[:, 2] = (-1.0, 2.0, 4.0, 2.0, -1.0)
    elif here[0, 0]:  # red at blue, blue at red
        kernel[2] = kernel[:, 2] = (-1.5, 0.0, 6.0, 0.0, -1.5)
        kernel[1, 1] = kernel[1, 3] = kernel[3, 1] = kernel[3, 3] = 2.0
    else:  # red or blue at green, written for neighbors to the left and right
        kernel[:, 2] = (0.5, 0.0, 5.0, 0.0, 0.5)
        kernel[2] = (-1.0, 4.0, 5.0, 4.0, -1.0)
        kernel[1, 1] = kernel[1, 3] = kernel[3, 1] = kernel[3, 3] = -1.0
        kernel = kernel if here[1, 0] else kernel.T
    return kernel / 8.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Taps:
    """The nonzero weights of a filter bank as one list.

    Attributes
    ----------
    starts
        Index of the first tap of each filter, and the end of the last filter.
    rows, columns
        Position of each tap in the window, from its upper left corner.
    weights
        Weight of each tap.
    radius
        Radius of the filters. [pixels]
    """

    starts: Int[Array, "ty tx p1"]
    rows: Int[Array, " taps"]
    columns: Int[Array, " taps"]
    weights: Float32[Array, " taps"]
    radius: int


def taps_of(bank: FilterBank) -> Taps:
    """The filter bank in the form that the kernel uses.

    Examples
    --------
    >>> from chromanoise.sensor import bayer
    >>> taps_of(bilinear_filters(bayer(), ("R", "G", "B"))).starts[0, 0]  # 1 + 4 + 4 pixels
    array([0, 1, 5, 9])
    """
    count = (bank.kernels != 0).sum(axis=(-2, -1))
    ends = np.cumsum(count).reshape(count.shape)
    starts = np.concatenate([ends[..., :1] - count[..., :1], ends], axis=-1)
    at = np.argwhere(bank.kernels != 0)
    return Taps(
        starts=starts.astype(np.int64),
        rows=at[:, 3].copy(),
        columns=at[:, 4].copy(),
        weights=bank.kernels[bank.kernels != 0].astype(np.float32),
        radius=bank.radius,
    )


def surrounded_rows(
    raw: Num[Array, "h w"], bank: FilterBank, start: int, stop: int
) -> Float32[Array, "rows w2"]:
    """Rows ``start`` to ``stop`` of a raw image, padded by the radius of the filters.

    The values are electrons or codes; float32 represents both.

    Raises
    ------
    InputError
        If the image is smaller than one tile of the mosaic.

    Examples
    --------
    >>> from chromanoise.sensor import bayer
    >>> surrounded_rows(np.array([[1.0, 2.0], [3.0, 4.0]]), bilinear_filters(bayer()), 1, 2)
    array([[2., 1., 2., 1.],
           [4., 3., 4., 3.],
           [2., 1., 2., 1.]], dtype=float32)
    """
    rows, columns = border_pixels(raw.shape, bank)
    return raw[rows[start : stop + 2 * bank.radius], columns].astype(np.float32)


def demosaicked_rows(
    surrounded: Float32[Array, "rows2 w2"], taps: Taps, first_row: int
) -> Float32[Array, "rows w p"]:
    """All channels of a block of rows, float32. [e-]

    Parameters
    ----------
    surrounded
        Result of `surrounded_rows`. [e-]
    first_row
        Row of the image at which the block starts; it determines the position in the tile.

    Examples
    --------
    >>> from chromanoise.sensor import bayer
    >>> bank, raw = bilinear_filters(bayer()), np.array([[10.0, 20.0], [20.0, 30.0]])
    >>> demosaicked_rows(surrounded_rows(raw, bank, 1, 2), taps_of(bank), 1)[0, 1]
    array([10., 20., 30.], dtype=float32)
    """
    rows, columns = (n - 2 * taps.radius for n in surrounded.shape)
    out = np.empty((rows, columns, taps.starts.shape[2] - 1), np.float32)
    demosaic_block = kernel_of("demosaic_kernels", "demosaic_block", out.size)
    demosaic_block(surrounded, taps.starts, taps.rows, taps.columns, taps.weights, first_row, out)
    return out
