# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""One noisy acquisition of a run of pixels: from expected electrons to electrons after readout.

In physical order: PRNU, dark electrons, shot noise and read noise (`noise_blocks`), DSNU, and row
noise. The mean of the dark electrons is subtracted, as sensors do with their shielded pixels.

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


@kernel(inline="always")
@no_type_check
def readout_offset_e(pixel, column, channel, several, draw):
    """Column noise and telegraph noise of one pixel.

    The colors of a mosaic share the offset of a column; ``several`` channels at every pixel are
    read in columns of their own.
    """
    offset = _ZERO
    if draw.column_e > _ZERO:
        own = channel if several else 0
        offset = draw.column_e * normal_of(column, COLUMN, draw.frame, own, draw.key)
    if draw.level_share > _ZERO:
        at, none = np.uint64(pixel), np.uint64(0)
        which = word_at(at, np.uint64(PIXEL_LEVELS), none, channel, draw.key) & _LOW
        if _F(which) * _TO_SHARE < draw.level_share:
            word = word_at(at, np.uint64(LEVEL), draw.frame, channel, draw.key)
            up = (word & _ONE_BIT) == _ONE_BIT
            offset = offset + (draw.level_e if up else -draw.level_e)
    return offset


@kernel(inline="always")
@no_type_check
def has_readout_offsets(draw):
    """Whether `readout_offset_e` is ever other than 0."""
    return draw.column_e > _ZERO or draw.level_share > _ZERO


@kernel(error_model="numpy")
@no_type_check
def acquire(mean, pixel, column, n, channels, draw, row_e, room, electrons):
    """Electrons (n * p,) from mean (n * p,): p values of ``n`` pixels, one after the other.

    channels (p, n or more) int64: which channel each value is; one, the one over each pixel, or
    all. pixel, column: number of the first one in the whole picture, and its column.
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
    offsets = draw.pattern_e > _ZERO or has_readout_offsets(draw)
    if dark_e > _ZERO or offsets or row_e != _ZERO:
        _imperfect_readout(electrons, pixel, column, n, channels, draw, row_e - dark_e)


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
def _imperfect_readout(electrons, pixel, column, n, channels, draw, shared_e):
    """DSNU, and row, column and telegraph noise."""
    more, several = has_readout_offsets(draw), channels.shape[0] > 1
    for c in range(channels.shape[0]):
        for i in range(n):
            offset = shared_e
            if more:
                own_e = readout_offset_e(pixel + i, column + i, channels[c, i], several, draw)
                offset = offset + own_e
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
