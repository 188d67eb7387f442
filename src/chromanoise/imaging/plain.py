"""Small pictures in plain numpy, with the bits of the compiled kernels.

The first picture of an installation would wait for the compiler ten times as long as for its
pixels. Therefore small pictures are computed here until they have cost as much as compiling.

Every product, sum, quotient and root stands in the same order and precision as in the compiled
kernel, so the two agree bit for bit. ``a b + c`` in one rounding is made from float64. The
functions with the name of a kernel take its arguments: `raw_rows`, `color_rows`,
`color_of_electrons`, `demosaic_block`, `fill_noise`.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from chromanoise.base import Array, Float32, Float64, Int64, UInt8, UInt16
from chromanoise.imaging.blocks import (
    COLUMN,
    ENCODED,
    FEW_E,
    LANES,
    LEVEL,
    LIGHT,
    LOG_TERMS,
    PIXEL_GAIN,
    PIXEL_LEVELS,
    PIXEL_OFFSET,
    QUANTILE_ABOVE,
    QUANTILE_BELOW,
    READING,
    READOUT,
    ROW,
    SMOOTH_E,
    STRANDS,
    TILE,
    Converter,
    Draw,
    RowsInMemory,
    Well,
)

F = np.float32
_PART_PIXELS = 1 << 12
_LOW_WORD, _HALF_WORD = np.uint64(0xFFFFFFFF), np.uint64(32)
_LOST, _MIDDLE = (1 << 29) - 1, 1 << 28  # of the bits of float64, those that float32 lacks


@np.errstate(all="ignore")  # invalid reflectances are refused or replaced later
def electron_rows(stored: RowsInMemory, out: Float32[Array, "rows w p"]) -> None:
    """Expected electrons of all channels, as `fused_kernels.electron_rows`."""
    for some, part in _parts(stored, *out.shape[:2]):
        out[some] = _means(part, out[some].shape[:2], _every_channel(*out[some].shape))


def _every_channel(rows: int, columns: int, p: int) -> Int64[Array, "rows w p"]:
    return np.broadcast_to(np.arange(p), (rows, columns, p))


@np.errstate(all="ignore")  # what is no reflectance is refused or mended later
def raw_rows(
    stored: RowsInMemory,
    tile: Int64[Array, "ty tx"],
    first_row: int,
    draw: Draw,
    adc: Converter,
    codes: UInt16[Array, "rows w"],
    counts: Float64[Array, "rows 3 p"],
) -> None:
    """Codes of a mosaic, as `fused_kernels.raw_rows`."""
    for some, part in _parts(stored, *codes.shape):
        _raw_part(part, tile, first_row + some.start, draw, adc, codes[some], counts[some])


def _raw_part(
    stored: RowsInMemory,
    tile: Int64[Array, "ty tx"],
    first_row: int,
    draw: Draw,
    adc: Converter,
    codes: UInt16[Array, "rows w"],
    counts: Float64[Array, "rows 3 p"],
) -> None:
    rows, columns = codes.shape
    at = (first_row + np.arange(rows)[:, None]) % tile.shape[0]
    channel = tile[at, np.arange(columns) % tile.shape[1]]
    mean = _means(stored, codes.shape, channel[..., None])[..., 0]
    period = max(STRANDS // tile.shape[1], 1) * tile.shape[1]
    for row in range(rows):
        _count_means(mean[row], channel[row], period, counts[row, 0])
    electrons = _acquired(mean[..., None], channel[..., None], first_row, draw)[..., 0]
    held = np.minimum(electrons, adc.most_e)
    code = np.floor(held * adc.dn_per_e + adc.black_dn + F(0.5))
    codes[...] = np.minimum(np.where(code > 0, code, F(0)), adc.top_dn)
    above = electrons > adc.most_e
    for c in range(counts.shape[2]):
        counts[:, 1, c] += (above & (channel == c)).sum(axis=1)


@np.errstate(all="ignore")  # what is no reflectance is refused or mended later
def color_rows(
    stored: RowsInMemory,
    first_row: int,
    draw: Draw,
    well: Well,
    matrices: Float32[Array, "6 p"],
    table: UInt8[Array, " entries"],
    xyz: Float32[Array, "rows w 3"],
    srgb: UInt8[Array, "rows w 3"],
    counts: Float64[Array, "rows 3 p"],
) -> None:
    """Every channel at every pixel, then color, as `fused_kernels.color_rows`."""
    for some, part in _parts(stored, *xyz.shape[:2]):
        electrons = _electrons_of_part(
            part, xyz[some].shape[:2], first_row + some.start, draw, well, counts[some]
        )
        color_of_electrons(electrons, matrices, table, xyz[some], srgb[some])


def _electrons_of_part(
    stored: RowsInMemory,
    shape: tuple[int, int],
    first_row: int,
    draw: Draw,
    well: Well,
    counts: Float64[Array, "rows 3 p"],
) -> Float32[Array, "rows w p"]:
    (rows, columns), p = shape, counts.shape[2]
    channel = _every_channel(rows, columns, p)
    mean = _means(stored, shape, channel)
    for row in range(rows):
        for c in range(p):
            total = counts[row, 0, c : c + 1]
            for first in range(0, columns, TILE):
                part = np.zeros(1)
                light = mean[row, first : first + TILE, c]
                _count_means(light, np.zeros(light.size, np.int64), STRANDS, part)
                total += part
    electrons = _acquired(mean, channel, first_row, draw)
    counts[:, 1] += (electrons > well.most_e).sum(axis=1)
    if well.held:
        electrons = np.minimum(np.maximum(electrons, F(0)), well.most_e)
    return electrons


def _parts(stored: RowsInMemory, rows: int, columns: int) -> Iterator[tuple[slice, RowsInMemory]]:
    """Rows whose numbers stay in the cache."""
    step = max(1, _PART_PIXELS // columns)
    for start in range(0, rows, step):
        flat = stored.flat[start * stored.lay.row_pitch :]
        yield slice(start, min(start + step, rows)), stored._replace(flat=flat)


@np.errstate(all="ignore")  # what is no reflectance is refused or mended later
def color_of_electrons(
    electrons: Float32[Array, "rows w p"],
    matrices: Float32[Array, "6 p"],
    table: UInt8[Array, " entries"],
    xyz: Float32[Array, "rows w 3"],
    srgb: UInt8[Array, "rows w 3"],
) -> None:
    """Eq. 5 for rows of electrons, as `acquisition.color_of_electrons`."""
    total = electrons[..., :1] * matrices[:, 0]
    for c in range(1, electrons.shape[2]):
        total = fused(electrons[..., c : c + 1], matrices[:, c], total)
    xyz[...] = total[..., :3]
    within = np.minimum(np.where(total[..., 3:] > 0, total[..., 3:], F(0)), F(1))
    srgb[...] = table[(within * F(ENCODED - 1) + F(0.5)).astype(np.int32)]


def demosaic_block(
    surrounded: Float32[Array, "rows2 w2"],
    starts: Int64[Array, "ty tx p1"],
    tap_rows: Int64[Array, " taps"],
    tap_columns: Int64[Array, " taps"],
    weights: Float32[Array, " taps"],
    first_row: int,
    out: Float32[Array, "rows w p"],
) -> None:
    """Linear demosaicing, as `demosaic_kernels.demosaic_block`."""
    ty, tx, _ = starts.shape
    rows, columns, p = out.shape
    out[...] = 0
    for y, x, c in np.ndindex(ty, tx, p):
        top = (y - first_row) % ty
        one = out[top::ty, x::tx, c]
        for t in range(starts[y, x, c], starts[y, x, c + 1]):
            j, i = top + tap_rows[t], x + tap_columns[t]
            one += weights[t] * surrounded[j : j + rows - top : ty, i : i + columns - x : tx]


def _means(
    stored: RowsInMemory, shape: tuple[int, int], channel: Int64[Array, "rows w p"]
) -> Float32[Array, "rows w p"]:
    """Expected electrons of these channels of each pixel; marks the extremes of ``stored.seen``."""
    size, lay = stored.flat.itemsize, stored.lay
    steps = tuple(size * step for step in (lay.row_pitch, lay.pixel_pitch, lay.band_pitch))
    block = np.lib.stride_tricks.as_strided(stored.flat, (*shape, lay.bands), steps)
    values = block.astype(F)
    stored.seen[0] = np.fmin(stored.seen[0], np.fmin.reduce(values, axis=None))
    stored.seen[LANES] = np.fmax(stored.seen[LANES], np.fmax.reduce(values, axis=None))
    lanes = 1 if lay.pixel_pitch == 1 else LANES
    totals = np.zeros((lanes, *channel.shape), F)
    for band in range(lay.bands):
        weight = stored.weights[:, band][channel]
        lane = band % lanes
        totals[lane] = fused(values[..., band, None], weight, totals[lane])
    while len(totals) > 1:  # halves onto halves
        totals = totals[: len(totals) // 2] + totals[len(totals) // 2 :]
    return totals[0]


def _count_means(
    mean: Float32[Array, " w"],
    channel: Int64[Array, " w"],
    strands: int,
    counts: Float64[Array, " p"],
) -> None:
    """Add the means of a row to those of their channels, by partial sums of each tile."""
    for first in range(0, mean.size, TILE):
        some = mean[first : first + TILE].astype(np.float64)
        partial = np.zeros(min(strands, some.size))
        for start in range(0, some.size, strands):
            here = some[start : start + strands]
            partial[: here.size] += here
        np.add.at(counts, channel[first : first + partial.size], partial)


def _acquired(
    mean: Float32[Array, "rows w p"],
    channel: Int64[Array, "rows w p"],
    first_row: int,
    draw: Draw,
) -> Float32[Array, "rows w p"]:
    """Electrons after readout, as `acquisition.acquire`."""
    rows, columns, p = mean.shape
    row = first_row + np.arange(rows)[:, None, None]
    pixel = row * columns + np.arange(columns)[:, None]
    dark_e = draw.dark_e if draw.noisy else F(0)

    def normal(purpose: int, at: Array = pixel, of: Array = channel, frame: int = 0) -> Array:
        return normal_quantiles(words_of(at, purpose, frame, of, int(draw.key)))

    def words(purpose: int) -> Array:
        return words_of(pixel, purpose, int(draw.frame), channel, int(draw.key))

    if draw.gain > 0:
        gain = np.maximum(F(1) + draw.gain * normal(PIXEL_GAIN), F(0))
        mean = mean * gain + dark_e
    elif dark_e > 0:
        mean = mean + dark_e
    readout = draw.reading_e > 0
    if draw.noisy:
        electrons = electrons_of(mean, words, draw.reading_e)
    elif readout:
        electrons = mean + draw.reading_e * normal_quantiles(words(READOUT))
    else:
        electrons = mean.copy()
    offset: Array = np.full((rows, 1, 1), draw.black_error_e)
    if draw.row_e > 0:
        offset = offset + draw.row_e * normal(ROW, row, np.zeros_like(row), int(draw.frame))
    offset = offset - dark_e
    if draw.column_e > 0:
        column = np.arange(columns)[:, None]
        each = np.arange(p)[None, :]
        shared: Array = draw.column_e * normal(COLUMN, column, each, int(draw.frame))
    else:
        shared = np.zeros((columns, p), F)
    shared = np.broadcast_to(shared, mean.shape)
    if draw.levels_e > 0:
        for reading in range(draw.readings):
            own = channel + reading * READING
            which = words_of(pixel, PIXEL_LEVELS, 0, own, int(draw.key))
            up = words_of(pixel, LEVEL, int(draw.frame), own, int(draw.key)) & 1 == 1
            level = np.where(up, draw.levels_e, -draw.levels_e)
            has = which.astype(F) * F(2.0**-32) < draw.level_share
            shared = np.where(has, shared + level, shared)
    offset = offset + shared
    if draw.pattern_e > 0:
        offset = offset + draw.pattern_e * normal(PIXEL_OFFSET)
    return electrons + offset


def words_of(pixel: Any, purpose: int, frame: int, channel: Any, seed: int) -> Array:
    """The random word of each pixel and channel (uint32), as `noise_draws.word_at`."""
    pixel, channel = np.asarray(pixel, np.uint64), np.asarray(channel, np.uint64)
    high = pixel >> _HALF_WORD | np.uint64(purpose << 16)
    counter = np.broadcast_arrays(
        pixel & _LOW_WORD, high, np.uint64(frame), channel >> np.uint64(2)
    )
    four = philox4x32(counter, (seed & 0xFFFFFFFF, seed >> 32))
    which = np.broadcast_to(channel & np.uint64(3), four[0].shape)
    return np.choose(which.astype(np.intp), four).astype(np.uint32)


def fill_noise(
    mean: Float32[Array, "n p"],
    electrons: Float32[Array, "n p"],
    start: int,
    stop: int,
    tile_width: int,
    origin: int,
    width: int,
    frame: np.uint64,
    seed: np.uint64,
    read_noise_e: np.float32,
) -> int:
    """Fill pixels ``start`` to ``stop``, unless means are refused; how many are."""
    here = mean[start:stop]
    refused = int(np.count_nonzero(~((here >= 0) & (here < np.inf))))
    if refused == 0:
        row, column = np.divmod(np.arange(start, stop)[:, None], tile_width)
        pixel, channel = origin + row * width + column, np.arange(mean.shape[1])

        def words(purpose: int) -> Array:
            return words_of(pixel, purpose, int(frame), channel, int(seed))

        electrons[start:stop] = electrons_of(here, words, read_noise_e)
    return refused


def electrons_of(
    mean: Float32[Array, "..."],
    words: Callable[[int], Array],
    read_noise_e: np.float32,
) -> Float32[Array, "..."]:
    """Shot noise and read noise; ``words`` gives those of `LIGHT` and of `READOUT`."""
    light, electrons = words(LIGHT), np.empty_like(mean)
    many, smooth = mean >= FEW_E, read_noise_e >= SMOOTH_E
    z = normal_quantiles(light[many])
    if smooth:
        electrons[many] = _many_read_electrons(mean[many], read_noise_e, z)
    else:
        electrons[many] = _many_electrons(mean[many], z)
    if not many.all():
        electrons[~many] = _few_electrons(mean[~many], light[~many])
    apart = ~many if smooth else np.full(mean.shape, read_noise_e > 0)
    if apart.any():
        electrons[apart] += read_noise_e * normal_quantiles(words(READOUT)[apart])
    return electrons


def philox4x32(counter: Sequence[Any], key: tuple[int, int]) -> tuple[Any, ...]:
    """Ten rounds over arrays of uint64 that hold 32-bit words (Salmon et al., SC11, 2011)."""
    c0, c1, c2, c3 = (np.asarray(c, np.uint64) for c in counter)
    k0, k1 = (int(k) for k in key)
    for _ in range(10):
        a, b = np.uint64(0xD2511F53) * c0, np.uint64(0xCD9E8D57) * c2
        c0, c1, c2, c3 = (
            (b >> _HALF_WORD) ^ c1 ^ np.uint64(k0),
            b & _LOW_WORD,
            (a >> _HALF_WORD) ^ c3 ^ np.uint64(k1),
            a & _LOW_WORD,
        )
        k0, k1 = (k0 + 0x9E3779B9) & 0xFFFFFFFF, (k1 + 0xBB67AE85) & 0xFFFFFFFF
    return c0, c1, c2, c3


def fused(a: Any, b: Any, c: Any) -> Array:
    """A b + c rounded once.

    The product is exact in float64. Where their sum lies in the middle between two float32, it is
    moved to the side of what it has lost, as rounding to odd does: Boldo & Melquiond, "Emulation
    of a FMA and correctly rounded sums", IEEE TC 57 (2008) 462.
    """
    product, term = np.multiply(a, b, dtype=np.float64), np.asarray(c, np.float64)
    total = np.asarray(product + term)
    doubtful = (total.view(np.int64) & _LOST) == _MIDDLE
    if doubtful.any():
        p, t, s = (np.broadcast_to(one, total.shape)[doubtful] for one in (product, term, total))
        back = s - p
        rest = (p - (s - back)) + (t - back)
        total[doubtful] = np.where(rest == 0, s, np.nextafter(s, np.copysign(np.inf, rest)))
    return total.astype(F)


def normal_quantiles(words: Array) -> Array:
    """Standard normal variates of 32-bit words, in float32."""
    signed = words.view(np.int32)
    tail = ((signed ^ (signed >> 31)).astype(F) + F(0.5)) * F(2.0**-32)
    away = F(1) - (tail + tail)
    y = (tail + tail) * (F(1) + away)
    exponent = (y.view(np.int32) - np.int32(0x3F3504F3)) >> 23
    f = (y.view(np.int32) - (exponent << 23)).view(F) - F(1)
    f2 = f * f
    high, low = (_fused_quartet(terms, f, f2) for terms in (LOG_TERMS[4:], LOG_TERMS[:4]))
    log = fused(high, f2 * f2, low)
    w = fused(exponent.astype(F), -F(0.6931471805599453), -(log * f))
    z = away * _fused_sextet(QUANTILE_ABOVE, w) / _fused_sextet(QUANTILE_BELOW, w)
    return np.where(signed < 0, z, -z)


def _quartet(c: Sequence[float], x: Array, x2: Array) -> Array:
    """A polynomial of four coefficients, lowest first."""
    c0, c1, c2, c3 = (x.dtype.type(one) for one in c)
    return (c0 + c1 * x) + (c2 + c3 * x) * x2


def _fused_pair(c: Sequence[float], x: Array) -> Array:
    return fused(x, F(c[1]), F(c[0]))


def _fused_quartet(c: Sequence[float], x: Array, x2: Array) -> Array:
    """As `_quartet`, each product fused with its sum."""
    return fused(_fused_pair(c[2:], x), x2, _fused_pair(c[:2], x))


def _fused_sextet(c: Sequence[float], x: Array) -> Array:
    """A polynomial of six coefficients, lowest first."""
    x2 = x * x
    return fused(_fused_pair(c[4:], x), x2 * x2, _fused_quartet(c[:4], x, x2))


def _many_electrons(mean: Array, z: Array) -> Array:
    """Cornish-Fisher to the order mean^-3/2, in float32."""
    root = np.sqrt(mean)
    i, s, whole = F(1) / root, z * z, np.floor(mean)
    second = z * _fused_pair([-1 / 36, -1 / 72], s)
    third = fused(s, _fused_pair([7 / 810, 1 / 270], s), F(-8 / 405))
    fourth = z * fused(s, _fused_pair([-137 / 38880, -23 / 17280], s), F(671 / 38880))
    away = fused(root, z, _fused_pair([1 / 3, 1 / 6], s))
    away = fused(i, fused(i, fused(i, fourth, third), second), away)
    return np.maximum(whole + np.floor((mean - whole) + away), F(0))


def _many_read_electrons(mean: Array, read_noise_e: np.float32, z: Array) -> Array:
    """Cornish-Fisher of electrons plus read noise to the order variance^-1, in float32."""
    variance = mean + read_noise_e * read_noise_e
    inverse = F(1) / variance
    i, q, s = np.sqrt(inverse), mean * inverse, z * z
    first = z * fused(-q, _fused_pair([-5 / 36, 2 / 36], s), _fused_pair([-3 / 24, 1 / 24], s))
    constant, linear, square = (
        fused(s, _fused_pair(c[1:], s), F(c[0]))
        for c in (
            [3 / 120, -6 / 120, 1 / 120],
            [2 / 24, -5 / 24, 1 / 24],
            [17 / 324, -53 / 324, 12 / 324],
        )
    )
    second = fused(-q, fused(-q, square, linear), constant)
    away = fused(i, fused(i, second, first), _fused_pair([-1 / 6, 1 / 6], s))
    return mean + fused(q, away, variance * i * z)


def _few_electrons(mean: Array, words: Array) -> Array:
    """The distribution function summed from 0 electrons on, in float64."""
    mean = mean.astype(np.float64)
    e = [(-1.0) ** k / math.factorial(k) for k in range(12)]
    x = mean * (1.0 / 32.0)
    x2 = x * x
    x4 = x2 * x2
    low, middle, high = (_quartet(e[k : k + 4], x, x2) for k in (0, 4, 8))
    chance = low + (middle + high * x4) * x4
    for _ in range(5):
        chance = chance * chance
    left = (words + 0.5) * 2.0**-32 - chance
    electrons = np.zeros_like(mean)
    for k in range(1, 77):
        electrons += left >= 0
        chance = chance * (mean * (1.0 / k))
        left = left - chance
    return electrons.astype(F)
