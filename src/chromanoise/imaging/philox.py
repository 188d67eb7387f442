"""Philox4x32-10: random words as a function of seed, pixel, purpose, frame and channel only.

A cipher turns the 64-bit key and the 128-bit counter into four words of 32 bits. There is no
state, so the order of tiles, threads and machines is arbitrary. The counter:

====  =======  ==================================================================
word  bits     what
====  =======  ==================================================================
0     0 .. 31  pixel index, low half
1     0 .. 15  pixel index, high half: 2^48 pixels
1     16 .. 31 purpose: ``LIGHT``, ``PIXEL_GAIN`` ..., so that options that are
               switched on leave the words of all other noise as they were
2     0 .. 31  frame
3     0 .. 13  group of four channels: channel // 4
3     16 .. 29 number of the reading in a sum; the rest is 0
====  =======  ==================================================================

The key is the seed, low half first. The pixel index counts along the rows of the whole picture.
The four words belong to the four channels of the group, in their order.

Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11 (2011),
doi:10.1145/2063384.2063405.

Functions without annotations are compiled; a word is a uint64 whose high half is ignored, for the
wide multiplication of the processor.
"""

from typing import no_type_check

import numpy as np
from numba import njit

LIGHT, READOUT, PIXEL_GAIN, PIXEL_OFFSET, ROW, COLUMN, PIXEL_LEVELS, LEVEL = range(8)
"""Purposes: shot noise, also with read noise as one sum; read noise by itself; PRNU; DSNU; rows;
columns; which pixels have two levels, and which level a reading has."""

PER_CALL = 4
"""Number of channels that share one call of the cipher, one word each."""
READING = 1 << 18
"""Added to a channel for each further reading of a sum."""

_WORD = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)
_PURPOSE_AT = np.uint64(16)
_MULTIPLY_0 = np.uint64(0xD2511F53)
_MULTIPLY_1 = np.uint64(0xCD9E8D57)
_WEYL_0 = np.uint64(0x9E3779B9)
_WEYL_1 = np.uint64(0xBB67AE85)


@njit(inline="always")
@no_type_check
def _two_rounds(c0, c1, c2, c3, k0, k1):
    """Two rounds of the cipher; only the low halves of what goes in and comes out matter."""
    a = (c0 & _WORD) * _MULTIPLY_0
    b = (c2 & _WORD) * _MULTIPLY_1
    d0 = (b >> _HALF) ^ c1 ^ k0
    d2 = (a >> _HALF) ^ c3 ^ k1
    e = (d0 & _WORD) * _MULTIPLY_0
    f = (d2 & _WORD) * _MULTIPLY_1
    return (
        (f >> _HALF) ^ b ^ (k0 + _WEYL_0),
        f,
        (e >> _HALF) ^ a ^ (k1 + _WEYL_1),
        e,
    )


@njit(inline="always")
@no_type_check
def philox4x32(c0, c1, c2, c3, k0, k1):
    """Four words (c0 .. c3: the counter, k0, k1: the key), each in the low half of a uint64.

    The rounds stand one after the other because a loop here keeps the loop around it from
    being vectorized.
    """
    two = np.uint64(2)
    w0, w1, w2, w3 = _two_rounds(c0, c1, c2, c3, k0, k1)
    k0, k1 = k0 + two * _WEYL_0, k1 + two * _WEYL_1
    w0, w1, w2, w3 = _two_rounds(w0, w1, w2, w3, k0, k1)
    k0, k1 = k0 + two * _WEYL_0, k1 + two * _WEYL_1
    w0, w1, w2, w3 = _two_rounds(w0, w1, w2, w3, k0, k1)
    k0, k1 = k0 + two * _WEYL_0, k1 + two * _WEYL_1
    w0, w1, w2, w3 = _two_rounds(w0, w1, w2, w3, k0, k1)
    k0, k1 = k0 + two * _WEYL_0, k1 + two * _WEYL_1
    w0, w1, w2, w3 = _two_rounds(w0, w1, w2, w3, k0, k1)
    return w0 & _WORD, w1 & _WORD, w2 & _WORD, w3 & _WORD


@njit(inline="always")
@no_type_check
def groups_of(channels):
    """So many groups these channels need."""
    return (channels + PER_CALL - 1) // PER_CALL


@njit(inline="always")
@no_type_check
def words_at(pixel, purpose, frame, group, seed):
    """The four words of a pixel (all arguments uint64) for one purpose, frame and group."""
    high = (pixel >> _HALF) | (purpose << _PURPOSE_AT)
    return philox4x32(pixel, high, frame, group, seed & _WORD, seed >> _HALF)


@njit(inline="always")
@no_type_check
def word_at(pixel, purpose, frame, channel, seed):
    """The one word of a pixel that belongs to a channel (int64)."""
    w0, w1, w2, w3 = words_at(pixel, purpose, frame, np.uint64(channel >> 2), seed)
    odd, later = (channel & 1) == 1, (channel & 2) == 2
    low, high = (w1 if odd else w0), (w3 if odd else w2)
    return high if later else low
