"""Contenders take turns, round after round: what else the machine does falls on all of them."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median

Times = Mapping[str, list[float]]
"""Seconds of each contender, one number per round."""


@dataclass(frozen=True, slots=True)
class Ratio:
    """Of two contenders, taken within each round: the median of the rounds, and their range."""

    middle: float
    lowest: float
    highest: float


def raced(
    contenders: Mapping[str, Callable[[], object]],
    *,
    rounds: int = 5,
    warm: bool = True,
    clock: Callable[[], float] = time.perf_counter,
) -> Times:
    """Times of ``rounds`` rounds after one to warm up; each round starts with another one."""
    names = list(contenders)
    times: dict[str, list[float]] = {name: [] for name in names}
    if warm:
        for work in contenders.values():
            work()
    for number in range(rounds):
        first = number % len(names)
        for name in names[first:] + names[:first]:
            start = clock()
            contenders[name]()
            times[name].append(clock() - start)
    return times


def ratio(times: Times, above: str, below: str) -> Ratio:
    """How many times as long as ``below`` takes ``above``."""
    each = [a / b for a, b in zip(times[above], times[below], strict=True)]
    return Ratio(median(each), min(each), max(each))
