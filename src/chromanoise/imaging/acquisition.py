# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""One noisy acquisition of a run of pixels: from expected electrons to electrons after readout.

In physical order: PRNU, dark electrons, shot noise and read noise (`noise_blocks`), DSNU, and row,
column and telegraph noise. The mean of the dark electrons is subtracted, as sensors do with their
shielded pixels.

Functions without annotations are compiled, serial, and release the GIL; ``draw`` is
a `Draw`.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.blocks import RUN
from chromanoise.imaging.kernel_cache import kernel
from chromanoise.imaging.noise_blocks import draw_light, draw_readout, room_for
from chromanoise.imaging.noise_draws import normal_quantile
from chromanoise.imaging.philox import (
    COLUMN,
    LEVEL,
    LIGHT,
    PER_CALL,
    PIXEL_GAIN,
    PIXEL_LEVELS,
    PIXEL_OFFSET,
    READING,
    READOUT,
    ROW,
    groups_of,
    word_at,
    words_at,
)

_F = np.float32
_ZERO, _ONE = _F(0.0), _F(1.0)
_TO_SHARE, _LOW, _ONE_BIT = _F(2.0**-32), np.uint64(0xFFFFFFFF), np.uint64(1)


@kernel(error_model="numpy")
@no_type_check
def room_for_run(channels):
    """Scratch of a run: words, channels being rounded up to 4, and what noise needs."""
    return np.empty(groups_of(channels) * PER_CALL * RUN, np.uint32), room_for(RUN * channels)


@kernel(inline="always")
@no_type_check
def row_offset_e(at_row, draw):
    """What all pixels of a row share: row noise and black-level error."""
    if draw.row_e > _ZERO:
        row_e = draw.row_e * normal_of(at_row, ROW, draw.frame, 0, draw.key)
        return draw.black_error_e + row_e
    return draw.black_error_e


@kernel(error_model="numpy")
@no_type_check
def column_offsets_e(channels, columns, draw):
    """Column noise (channels, columns) f4; no columns without any.

    The colors of a mosaic share the offset of a column (one channel); channels at every pixel are
    read in columns of their own.
    """
    if draw.column_e == _ZERO:
        return np.empty((channels, 0), np.float32)
    offsets = np.empty((channels, columns), np.float32)
    for c in range(channels):
        for i in range(columns):
            offsets[c, i] = draw.column_e * normal_of(i, COLUMN, draw.frame, c, draw.key)
    return offsets


@kernel(inline="always")
@no_type_check
def readout_offset_e(pixel, channel, column_e, draw):
    """Column noise ``column_e`` and telegraph noise of one pixel."""
    offset, at, none = column_e, np.uint64(pixel), np.uint64(0)
    if draw.levels_e > _ZERO:
        for reading in range(draw.readings):
            own = channel + reading * READING
            which = word_at(at, np.uint64(PIXEL_LEVELS), none, own, draw.key) & _LOW
            if _F(which) * _TO_SHARE < draw.level_share:
                word = word_at(at, np.uint64(LEVEL), draw.frame, own, draw.key)
                up = (word & _ONE_BIT) == _ONE_BIT
                offset = offset + (draw.levels_e if up else -draw.levels_e)
    return offset


@kernel(error_model="numpy")
@no_type_check
def add_readout_offsets(values, several, draw):
    """Add row, column and telegraph noise to a picture (rows, columns, p) f4, in place.

    several: whether all channels of a pixel are read, not only that of a mosaic.
    """
    rows, columns, p = values.shape
    columns_e = column_offsets_e(p if several else 1, columns, draw)
    for row in range(rows):
        row_e = row_offset_e(row, draw)
        for column in range(columns):
            for c in range(p):
                own = c if several else 0
                column_e = columns_e[own, column] if columns_e.size > 0 else _ZERO
                at = row * columns + column
                values[row, column, c] += row_e + readout_offset_e(at, c, column_e, draw)


@kernel(error_model="numpy")
@no_type_check
def acquire(mean, pixel, n, channels, draw, row_e, columns_e, room, electrons):
    """Electrons (n * p,) from mean (n * p,): p values of ``n`` pixels, one after the other.

    channels (p, n or more) int64: which channel each value is; one, the one over each pixel, or
    all. pixel: number of the first one in the whole picture. columns_e: `column_offsets_e` from the
    column of this one on.
    """
    words, block = room
    lanes = n * channels.shape[0]
    # without noise, adding and subtracting dark electrons has no effect
    dark_e = draw.dark_e if draw.noisy else _ZERO
    if draw.gain > _ZERO or dark_e > _ZERO:
        _imperfect_means(mean, pixel, n, channels, draw, dark_e)
    if draw.noisy:
        _fill_words(pixel, n, channels, LIGHT, draw, words)
        waiting = draw_light(mean, words, lanes, draw.reading_e, block, electrons)
        if waiting > 0:
            _fill_words(pixel, n, channels, READOUT, draw, words)
            draw_readout(words, waiting, lanes, draw.reading_e, block, electrons)
    else:
        for j in range(lanes):
            electrons[j] = mean[j]
        if draw.reading_e > _ZERO:
            _fill_words(pixel, n, channels, READOUT, draw, words)
            draw_readout(words, lanes, lanes, draw.reading_e, block, electrons)
    offsets = draw.pattern_e > _ZERO or columns_e.size > 0 or draw.levels_e > _ZERO
    if dark_e > _ZERO or offsets or row_e != _ZERO:
        _imperfect_readout(electrons, pixel, n, channels, draw, row_e - dark_e, columns_e)


@kernel(error_model="numpy")
@no_type_check
def _imperfect_means(mean, pixel, n, channels, draw, dark_e):
    """Sensitivity that differs from pixel to pixel, then the dark electrons.

    channels (p, n) int64: which one each of the p values of a pixel is.
    """
    for c in range(channels.shape[0]):
        for i in range(n):
            gain = _ONE
            if draw.gain > _ZERO:
                z = normal_of(pixel + i, PIXEL_GAIN, 0, channels[c, i], draw.key)
                gain = max(_ONE + draw.gain * z, _ZERO)
            mean[c * n + i] = mean[c * n + i] * gain + dark_e


@kernel(error_model="numpy")
@no_type_check
def _imperfect_readout(electrons, pixel, n, channels, draw, shared_e, columns_e):
    """DSNU, and row, column and telegraph noise."""
    for c in range(channels.shape[0]):
        for i in range(n):
            column_e = columns_e[c, i] if columns_e.size > 0 else _ZERO
            offset = shared_e + readout_offset_e(pixel + i, channels[c, i], column_e, draw)
            if draw.pattern_e > _ZERO:
                z = normal_of(pixel + i, PIXEL_OFFSET, 0, channels[c, i], draw.key)
                offset = offset + draw.pattern_e * z
            electrons[c * n + i] = electrons[c * n + i] + offset


@kernel(inline="always")
@no_type_check
def normal_of(pixel, purpose, frame, channel, key):
    """A standard normal variate (f4) that belongs to a pixel, or a row, a purpose and a channel."""
    word = word_at(np.uint64(pixel), np.uint64(purpose), np.uint64(frame), channel, key)
    return normal_quantile(np.uint32(word))


@kernel(error_model="numpy")
@no_type_check
def _fill_words(pixel, n, channels, purpose, draw, words):
    """A word for each value, in their order."""
    if channels.shape[0] == 1:
        _words_of_one(pixel, channels[0, :n], purpose, draw.frame, draw.key, words)
        return
    for c in range(0, channels.shape[0], PER_CALL):
        w0, w1 = words[c * n : (c + 1) * n], words[(c + 1) * n : (c + 2) * n]
        w2, w3 = words[(c + 2) * n : (c + 3) * n], words[(c + 3) * n : (c + 4) * n]
        group = np.uint64(c // PER_CALL)
        _words_of_group(pixel, group, purpose, draw.frame, draw.key, w0, w1, w2, w3)


@kernel(error_model="numpy")
@no_type_check
def _words_of_group(pixel, group, purpose, frame, key, w0, w1, w2, w3):
    """Words of four channels of as many pixels as ``w0`` has."""
    for i in range(w0.size):
        four = words_at(np.uint64(pixel + i), np.uint64(purpose), frame, group, key)
        w0[i] = four[0]
        w1[i] = four[1]
        w2[i] = four[2]
        w3[i] = four[3]


@kernel(error_model="numpy")
@no_type_check
def _words_of_one(pixel, channel, purpose, frame, key, words):
    """The word of the one channel of each pixel: that which it has when all are rendered."""
    for i in range(channel.size):
        words[i] = word_at(np.uint64(pixel + i), np.uint64(purpose), frame, channel[i], key)
