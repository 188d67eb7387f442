"""How fast this machine reads a cube: nothing but a sum, which the compiler makes of wide loads."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numba import njit

_PIECE = 1 << 23  # words of 8 bytes that a thread takes at a time, as the engine does


@njit(cache=True, nogil=True)
def _sum(words: np.ndarray, start: int, stop: int) -> int:
    total = np.uint64(0)
    for word in words[start:stop]:
        total += word
    return total


def reading(stored: np.ndarray, threads: int) -> Callable[[], int]:
    """A function that reads the whole array once, on so many threads."""
    flat = stored.reshape(-1) if stored.flags.c_contiguous else np.moveaxis(stored, 2, 0).ravel()
    words = flat[: flat.size // 2 * 2].view(np.uint64)
    starts = range(0, words.size, _PIECE)

    def read() -> int:
        with ThreadPoolExecutor(threads) as pool:
            parts = pool.map(lambda s: _sum(words, s, min(s + _PIECE, words.size)), starts)
            return sum(int(part) for part in parts)

    return read
