"""Caches of bounded size for computed values."""

import threading
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

from cachetools import LRUCache, cached

T = TypeVar("T")


class Remembered(Generic[T]):
    """A cache that drops the least recently used values."""

    def __init__(self, most: int) -> None:
        remembered = cached(LRUCache(most), key=lambda key, make: key, lock=threading.Lock())
        self._of: Callable[[Hashable, Callable[[], T]], T] = remembered(lambda key, make: make())

    def of(self, key: Hashable, make: Callable[[], T]) -> T:
        """The value of a key, computed if it is missing; two threads may both compute it."""
        return self._of(key, make)
