"""Shapley values, with optional precedence constraints."""

from collections.abc import Callable, Sequence
from functools import cache
from itertools import permutations

from chromanoise.errors import InputError

Switches = frozenset[str]


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
    orders = _orders(tuple(players), tuple(precedence))
    if not orders:
        raise InputError(
            "precedence",
            f"must allow an order of {', '.join(players)}",
            value=tuple(precedence),
            found="allows none",
        )
    worth = cache(value)  # many orders contain the same sets
    shares = dict.fromkeys(players, 0.0)
    for order in orders:
        for place, name in enumerate(order):
            before = frozenset(order[:place])
            shares[name] += (worth(before | {name}) - worth(before)) / len(orders)
    return shares


@cache
def _orders(
    players: tuple[str, ...], precedence: tuple[tuple[str, str], ...]
) -> tuple[tuple[str, ...], ...]:
    """All allowed orders of arrival."""
    return tuple(
        order
        for order in permutations(players)
        if all(order.index(first) < order.index(second) for first, second in precedence)
    )
