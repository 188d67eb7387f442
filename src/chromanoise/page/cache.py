"""What was computed and may be asked again: the latest, and never more than so much."""

import threading
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

from cachetools import LRUCache, cached

T = TypeVar("T")


class Remembered(Generic[T]):
    """Values by key; the least lately used go first."""

    def __init__(self, most: int) -> None:
        remembered = cached(LRUCache(most), key=lambda key, make: key, lock=threading.Lock())
        self._of: Callable[[Hashable, Callable[[], T]], T] = remembered(lambda key, make: make())

    def of(self, key: Hashable, make: Callable[[], T]) -> T:
        """The value of a key, made if it is not there; two threads may both make one."""
        return self._of(key, make)
