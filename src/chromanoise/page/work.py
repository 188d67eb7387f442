"""Two threads that compute, and a queue that cannot grow without bound."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from chromanoise.page.asked import QuestionError

T = TypeVar("T")

WORKERS = 2
MOST_WAITING = 48


class Workers:
    """A pool of two threads; what would have to wait behind too many is refused at once."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(WORKERS, thread_name_prefix="chromanoise")
        self._waiting = 0

    async def done(self, job: Callable[[], T]) -> T:
        """What the job returns.

        Raises
        ------
        QuestionError
            With status 503, if too many are waiting already.
        """
        if self._waiting >= MOST_WAITING:
            raise QuestionError(("", "more is asked than can be computed; ask again"), status=503)
        self._waiting += 1
        task = asyncio.get_running_loop().run_in_executor(self._pool, job)
        task.add_done_callback(self._left)  # also when nobody waits for it any more
        return await asyncio.shield(task)

    def close(self) -> None:
        """Finish what runs, forget what waits."""
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _left(self, task: "asyncio.Future[T]") -> None:
        self._waiting -= 1
        if not task.cancelled():
            task.exception()  # asked for, so that no log tells of one that nobody waits for
