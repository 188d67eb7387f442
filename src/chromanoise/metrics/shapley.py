"""Shapley values: the mean contribution of each player over all allowed orders of arrival."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from chromanoise.base import Array, Float, InputError, Int

Switches = frozenset[str]
"""The players that have arrived, or the causes that are switched on."""


def shapley_values(
    value: Callable[[Switches], float],
    players: Sequence[str],
    precedence: Sequence[tuple[str, str]] = (),
) -> dict[str, float]:
    """Each player's mean contribution to ``value`` over all allowed orders of arrival.

    Parameters
    ----------
    value
        Function from a set of players to its value.
    players
        Distinct names of the players.
    precedence
        Pairs (first, second): orders in which the second comes earlier are not allowed.

    Raises
    ------
    InputError
        If no order satisfies the precedence.

    Notes
    -----
    Shapley, "A value for n-person games", Contributions to the Theory of Games II (1953); with
    precedence Faigle & Kern, Int. J. Game Theory 21 (1992) 249-266.

    Examples
    --------
    >>> worth = {frozenset(): 0.0, frozenset("a"): 1.0, frozenset("b"): 2.0, frozenset("ab"): 5.0}
    >>> shapley_values(worth.__getitem__, "ab")
    {'a': 2.0, 'b': 3.0}
    >>> shapley_values(worth.__getitem__, "ab", precedence=[("a", "b")])
    {'a': 1.0, 'b': 4.0}
    """
    names, before = tuple(players), tuple(precedence)
    if not names:
        return {}
    worth = np.array([value(each) for each in allowed_sets(names, before)])
    return dict(zip(names, shapley_of_many(worth, names, before).tolist(), strict=True))


def shapley_of_many(
    worth: Float[Array, "*k s"], players: tuple[str, ...], precedence: tuple[tuple[str, str], ...]
) -> Float[Array, "*k c"]:
    """`shapley_values` of many games, from the worth of their `allowed_sets` in this order."""
    steps = _steps(players, precedence)
    return np.stack(
        [
            # no product of matrices: its last digits depend on the number of games
            ((worth[..., one.after] - worth[..., one.before]) * one.share).sum(axis=-1)
            for one in steps
        ],
        axis=-1,
    )


@cache
def allowed_sets(
    players: tuple[str, ...], precedence: tuple[tuple[str, str], ...] = ()
) -> tuple[Switches, ...]:
    """All sets of players that arrive first in some allowed order, from the empty set on.

    Parameters
    ----------
    players, precedence
        As `shapley_values`.

    Raises
    ------
    InputError
        If no order satisfies the precedence.

    Examples
    --------
    >>> [sorted(each) for each in allowed_sets(("a", "b"), (("a", "b"),))]
    [[], ['a'], ['a', 'b']]
    """
    found: dict[Switches, None] = {frozenset(): None}
    queue: list[Switches] = [frozenset()]
    needed = {name: {first for first, second in precedence if second == name} for name in players}
    for before in queue:
        for name in players:
            after = before | {name}
            if name not in before and after not in found and needed[name] <= before:
                found[after] = None
                queue.append(after)
    if frozenset(players) not in found:
        raise InputError(
            "precedence",
            f"must allow an order of {', '.join(players)}",
            value=precedence,
            found="allows none",
        )
    return tuple(found)


class _Steps(NamedTuple):
    """The sets that a player completes, as indices of those after and before it, and the share of
    the orders in which it does.
    """

    after: Int[Array, " n"]
    before: Int[Array, " n"]
    share: Float[Array, " n"]


@cache
def _steps(players: tuple[str, ...], precedence: tuple[tuple[str, str], ...]) -> tuple[_Steps, ...]:
    """The steps of each player.

    Orders are counted by the sets that they pass, instead of one by one: 11 players have 40 million
    orders, but 2,048 sets.
    """
    sets = allowed_sets(players, precedence)  # smaller sets come first
    place = {each: i for i, each in enumerate(sets)}
    ways_to = {sets[0]: 1}
    for after in sets[1:]:
        ways_to[after] = sum(ways_to[after - {n}] for n in after if after - {n} in place)
    ways_on = {sets[-1]: 1}
    for before in reversed(sets[:-1]):
        following = (before | {n} for n in players if n not in before)
        ways_on[before] = sum(ways_on[after] for after in following if after in place)
    total = ways_to[sets[-1]]
    found = []
    for name in players:
        own = [(one - {name}, one) for one in sets if name in one and one - {name} in place]
        found.append(
            _Steps(
                after=np.array([place[after] for _, after in own]),
                before=np.array([place[before] for before, _ in own]),
                share=np.array([ways_to[before] * ways_on[after] / total for before, after in own]),
            )
        )
    return tuple(found)
