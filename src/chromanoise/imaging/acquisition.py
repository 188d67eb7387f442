# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""One noisy acquisition of a run of pixels: from expected electrons to those that are read.

In the order of the light: sensitivity that differs from pixel to pixel, dark electrons, shot noise
and read noise (`noise_blocks`), offsets that differ from pixel to pixel and from row to row.

Functions without annotations are compiled, serial and free of the interpreter's lock; ``draw`` is
a `Draw`.
"""

from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.blocks import RUN
from chromanoise.imaging.noise_blocks import noise_of_block, room_for
from chromanoise.imaging.philox import LIGHT, PIXEL_GAIN, PIXEL_OFFSET, ROW, words_at
from chromanoise.imaging.variates import normal_quantile

_F = np.float32
_ZERO, _ONE = _F(0.0), _F(1.0)


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def room_for_run(channels):
    """Scratch of a run: words of shot and read noise, words to spare, what noise needs."""
    lanes = RUN * channels
    shot, read = np.empty(lanes, np.uint32), np.empty(lanes, np.uint32)
    return shot, read, np.empty((2, RUN), np.uint32), room_for(lanes)


@njit(cache=True, nogil=True, inline="always")
@no_type_check
def row_offset_e(at_row, draw):
    """What all pixels of a row share."""
    if draw.row_noise_e > _ZERO:
        return draw.row_noise_e * _normal(at_row, ROW, draw.frame, 0, draw.key)
    return _ZERO


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def acquire_mosaic(mean, pixel, channel, draw, row_e, room, electrons):
    """One value of each pixel, of the channel over it: electrons (n,) from mean and channel (n,).

    pixel: number of the first one in the whole picture.
    """
    shot, read, _, block = room
    n = mean.size
    if draw.noisy:
        _words_of_mosaic(pixel, n, channel, draw.frame, draw.key, shot, read)
    _acquire(mean, shot, read, block, pixel, n, channel.reshape(1, -1), draw, row_e, electrons)


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def acquire_channels(mean, pixel, n, every, draw, row_e, room, electrons):
    """All channels of ``n`` pixels, one after the other: electrons (n * p,) from mean (n * p,).

    every (p, n or more) int64: the number of the channel, for each of its values.
    """
    shot, read, spare, block = room
    if draw.noisy:
        _words_of_all(pixel, n, every.shape[0], draw.frame, draw.key, shot, read, spare)
    _acquire(mean, shot, read, block, pixel, n, every, draw, row_e, electrons)


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _acquire(mean, shot, read, room, pixel, n, channels, draw, row_e, electrons):
    """Channels (p, n or more) int64: which one each of the p values of a pixel is."""
    lanes = n * channels.shape[0]
    if draw.prnu > _ZERO or draw.dark_e > _ZERO:
        _imperfect_means(mean, pixel, n, channels, draw)
    if draw.noisy:
        noise_of_block(mean, shot, read, lanes, draw.read_noise_e, room, electrons)
    else:
        for j in range(lanes):
            electrons[j] = mean[j]
    if draw.dsnu_e > _ZERO or row_e != _ZERO:
        _imperfect_readout(electrons, pixel, n, channels, draw, row_e)


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _imperfect_means(mean, pixel, n, channels, draw):
    """Sensitivity that differs from pixel to pixel, then the dark electrons.

    channels (p, n) int64: which one each of the p values of a pixel is.
    """
    for c in range(channels.shape[0]):
        for i in range(n):
            gain = _ONE
            if draw.prnu > _ZERO:
                z = _normal(pixel + i, PIXEL_GAIN, 0, channels[c, i], draw.key)
                gain = max(_ONE + draw.prnu * z, _ZERO)
            mean[c * n + i] = mean[c * n + i] * gain + draw.dark_e


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _imperfect_readout(electrons, pixel, n, channels, draw, row_e):
    """The dark signal that differs from pixel to pixel, and what the row shares."""
    for c in range(channels.shape[0]):
        for i in range(n):
            offset = row_e
            if draw.dsnu_e > _ZERO:
                z = _normal(pixel + i, PIXEL_OFFSET, 0, channels[c, i], draw.key)
                offset = offset + draw.dsnu_e * z
            electrons[c * n + i] = electrons[c * n + i] + offset


@njit(cache=True, nogil=True, inline="always")
@no_type_check
def _normal(pixel, purpose, frame, channel, key):
    """A standard normal variate (f4) that belongs to a pixel, or a row, a purpose and a channel."""
    pair = np.uint64(channel >> 1)
    words = words_at(np.uint64(pixel), np.uint64(purpose), np.uint64(frame), pair, key)
    return normal_quantile(np.uint32(words[0] if channel & 1 == 0 else words[2]))


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _words_of_pair(pixel, pair, frame, key, shot, read, odd_shot, odd_read):
    """Words of two channels of as many pixels as ``shot`` has."""
    purpose = np.uint64(LIGHT)
    for i in range(shot.size):
        w0, w1, w2, w3 = words_at(np.uint64(pixel + i), purpose, frame, np.uint64(pair), key)
        shot[i] = w0
        read[i] = w1
        odd_shot[i] = w2
        odd_read[i] = w3


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _words_of_all(pixel, n, p, frame, key, shot, read, spare):
    """Words of every channel of ``n`` pixels, one channel after the other."""
    for c in range(0, p, 2):
        even, odd = slice(c * n, (c + 1) * n), slice((c + 1) * n, (c + 2) * n)
        if c + 1 < p:
            _words_of_pair(pixel, c // 2, frame, key, shot[even], read[even], shot[odd], read[odd])
        else:
            _words_of_pair(
                pixel, c // 2, frame, key, shot[even], read[even], spare[0, :n], spare[1, :n]
            )


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _words_of_mosaic(pixel, n, channel, frame, key, shot, read):
    """Words of the one channel of each pixel: those that it has when all are rendered."""
    purpose = np.uint64(LIGHT)
    for i in range(n):
        c = channel[i]
        w0, w1, w2, w3 = words_at(np.uint64(pixel + i), purpose, frame, np.uint64(c >> 1), key)
        odd = (c & 1) == 1
        shot[i] = w2 if odd else w0
        read[i] = w3 if odd else w1
