# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Poisson variates of means below 20 electrons, from one word, in the same time at every mean.

A count of mean M is the sum of a count of the largest multiple of 1/2 e- in M, drawn from a table,
and a count of the rest. The table is that of the alias method: the high 6 bits of the word select
one of 64 columns of equal chance, in which at most two counts share the low 26 bits. The position
within the part of a count is uniform, and draws the count of the rest. All chances are multiples
of 2^-32.

Walker, "An efficient method for generating discrete random variables with general distributions",
ACM Trans. Math. Softw. 3 (1977), 253-256, doi:10.1145/355744.355749.
"""

import math
from decimal import Decimal
from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.noise_draws import FEW_E
from chromanoise.imaging.simd import fused

_F = np.float32
_CELL_E = 0.5
_CELLS = int(FEW_E / _CELL_E)
_COLUMNS, _PART_BITS = 64, 26
_PART = 1 << _PART_BITS


def _chances(mean: float) -> list[int]:
    """Chances of 0 to 63 electrons in units of 2^-32; their sum is 2^32."""
    chance = [float(Decimal(-mean).exp())]
    for k in range(1, _COLUMNS):
        chance.append(chance[-1] * mean / k)
    units = [round(one * _COLUMNS * _PART) for one in chance]
    units[int(mean)] += _COLUMNS * _PART - sum(units)
    return units


def _aliases(units: list[int]) -> list[int]:
    """Of each column: length of the part of its own count, times 64, plus the other count."""
    left = list(units)
    short = [k for k, size in enumerate(left) if size < _PART]
    long = [k for k, size in enumerate(left) if size > _PART]
    entries = list(range(_COLUMNS))  # columns of one count
    while short:
        k, other = short.pop(), long[-1]
        entries[k] = left[k] * _COLUMNS + other
        left[other] -= _PART - left[k]
        if left[other] <= _PART:
            long.pop()
            if left[other] < _PART:
                short.append(other)
    return entries


ALIASES = np.array(
    [entry for cell in range(_CELLS) for entry in _aliases(_chances(cell * _CELL_E))], np.uint32
).view(np.int32)
"""64 columns, by the high 6 bits of the word, for each multiple of 1/2 e- below 20 e-."""

_PER_E, _E_PER_CELL = _F(1 / _CELL_E), _F(_CELL_E)
_LAST_CELL = _F(_CELLS - 1)
_LOW = np.uint32(_PART - 1)
_OTHER = np.uint32(_COLUMNS - 1)
_SIX, _AT = np.uint32(6), np.uint32(_PART_BITS)
_ZERO, _HALF, _ONE, _WHOLE = _F(0.0), _F(0.5), _F(1.0), np.int32(_PART)


@njit(inline="always", error_model="numpy")
@no_type_check
def cell_of(mean):
    """Which multiple of 1/2 e- is drawn from the table (i4); the last or the first for others."""
    cell = mean * _PER_E
    cell = cell if cell > _ZERO else _ZERO  # also for not a number
    return np.int32(cell if cell < _LAST_CELL else _LAST_CELL)


@njit(inline="always", error_model="numpy")
@no_type_check
def start_of(cell):
    """Mean (f4) of a cell."""
    return _F(cell) * _E_PER_CELL


@njit(inline="always", error_model="numpy")
@no_type_check
def place_of(cell, word):
    """Where in the table the column of a word lies (i4)."""
    return np.int32(np.int32(cell << np.int32(6)) + np.int32(word >> _AT))


@njit(inline="always", error_model="numpy")
@no_type_check
def leading_count(entry, word):
    """Count (i4) by the entry of a column, and a uniform share (f4) between 0 and 1."""
    entry = np.uint32(entry)
    own, at = np.int32(entry >> _SIX), np.int32(word & _LOW)
    is_own = at < own
    count = np.int32(word >> _AT) if is_own else np.int32(entry & _OTHER)
    start = np.int32(0) if is_own else own
    size = own if is_own else np.int32(_WHOLE - own)
    return count, (_F(np.int32(at - start)) + _HALF) / _F(size)


_E = tuple(_F((-1.0) ** k / math.factorial(k)) for k in range(8))
_P2, _P3, _P4, _P5, _P6, _P7, _P8 = (_F(1 / k) for k in range(2, 9))


@njit(inline="always", error_model="numpy")
@no_type_check
def few_more(mean, share):
    """Poisson variate (f4) of mean 0 to 1/2 (f4) at the upper share (f4); chances err by 1e-7."""
    m2 = mean * mean
    low = fused(fused(mean, _E[3], _E[2]), m2, fused(mean, _E[1], _E[0]))
    high = fused(fused(mean, _E[7], _E[6]), m2, fused(mean, _E[5], _E[4]))
    c1 = fused(high, m2 * m2, low) * mean
    c2 = c1 * mean * _P2
    c3 = c2 * mean * _P3
    c4 = c3 * mean * _P4
    c5 = c4 * mean * _P5
    c6 = c5 * mean * _P6
    c7 = c6 * mean * _P7
    above = fused(c7, mean * _P8, c7)  # chance of 7 or more
    count = _ONE if share < above else _ZERO
    above += c6
    count += _ONE if share < above else _ZERO
    above += c5
    count += _ONE if share < above else _ZERO
    above += c4
    count += _ONE if share < above else _ZERO
    above += c3
    count += _ONE if share < above else _ZERO
    above += c2
    count += _ONE if share < above else _ZERO
    above += c1
    count += _ONE if share < above else _ZERO
    return count
