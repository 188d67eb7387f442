"""Conditions by which a result fails, as of ``--fail-if "snr_y_db < 30"``.

A condition names a key of the JSON of a result, whole or by its last parts. The schema of the
result finds the key before anything is computed. Of several keys with the same last parts, those
with the fewest lists around them are meant.
"""

import operator
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from chromanoise.base import (
    ANY_NAME,
    LIST,
    DescribedKey,
    InputError,
    dataclass,
    described_keys,
    did_you_mean,
)
from chromanoise.io import Result
from chromanoise.study.sweeps import QUANTITIES

_SIGNS: dict[str, tuple[Callable[[float, float], bool], str]] = {
    "<=": (operator.le, "at or below"),
    ">=": (operator.ge, "at or above"),
    "==": (operator.eq, "at"),
    "!=": (operator.ne, "at any number but"),
    "<": (operator.lt, "below"),
    ">": (operator.gt, "above"),
}
_FORM = re.compile(rf"\s*([^\s<>=!]+)\s*({'|'.join(_SIGNS)})\s*([^\s<>=!]+)\s*")
_NAMES_OF_ENTRIES = ("label", "sensor", "name", "patch", "coordinate")

Path = tuple[str, ...]
_Rank = tuple[bool, bool, int]  # whether it is the quantity, whether a word is any name, lists


@dataclass(frozen=True, kw_only=True)
class JudgedResult:
    """What is known of a result before it is computed.

    Attributes
    ----------
    kind
        Its class, whose schema has the keys.
    quantity
        Name of the quantity that a comparison compares; empty for other results.
    """

    kind: type[Result]
    quantity: str = ""


@dataclass(frozen=True, kw_only=True)
class Condition:
    """A condition, with the places of its key.

    Attributes
    ----------
    text
        As it was given.
    key, sign, number
        Which value is compared with which number, and how; ``<`` for smaller ones.
    places
        Per result the path of the key; ``None`` for a result that is not judged.
    """

    text: str
    key: str
    sign: str
    number: float
    places: tuple[Path | None, ...]

    def failures(self, results: Sequence[Mapping[str, Any]], steps: Sequence[str]) -> list[str]:
        """One sentence on the numbers that meet the condition, one on those that are undefined.

        Parameters
        ----------
        results
            The JSON of each result.
        steps
            Name of the step of each result.

        Raises
        ------
        InputError
            If the results do not have the key, or it is no number.
        """
        met: list[str] = []
        undefined: list[str] = []
        found = 0
        for path, data, step in zip(self.places, results, steps, strict=True):
            by_owner: dict[str, list[tuple[str, str, float | None]]] = {}
            for owner, place, at, value in () if path is None else _values(data, path):
                by_owner.setdefault(owner, []).append((place, at, self._number(value)))
            found += len(by_owner)
            for owner, values in by_owner.items():
                who = " in ".join(word for word in (owner, step) if word)
                clause, is_met = self._clause(values)
                if clause:
                    (met if is_met else undefined).append(f"{who}: {clause}" if who else clause)
        if not found:
            raise InputError(
                "--fail-if",
                "must name a key that the result has",
                value=self.key,
                found=f"this result has no {self.key}",
                remedy=("check the last part of the key", "add the option that computes it"),
            )
        asks = f"and --fail-if asks to fail {_SIGNS[self.sign][1]} {self.number:.15g}"
        sentences = [f"{', '.join(met)}, {asks}"] if met else []
        cannot = f'so --fail-if "{self.text}" cannot be judged and fails'
        return sentences + ([f"{', '.join(undefined)}, {cannot}"] if undefined else [])

    def _clause(self, values: Sequence[tuple[str, str, float | None]]) -> tuple[str, bool]:
        """What is wrong with the numbers of one sensor, and whether one meets the condition."""
        holds = _SIGNS[self.sign][0]
        met = [one for one in values if one[2] is not None and holds(one[2], self.number)]
        shown = met or [one for one in values if one[2] is None]
        if not shown:
            return "", False
        place, at, worst = max(shown, key=lambda one: abs((one[2] or 0.0) - self.number))
        more = f" (and {len(shown) - 1} more)" if len(shown) > 1 else ""
        name = place if len(values) > 1 and not at else self.key
        if worst is None:
            return f"{name}{at} is not defined{more}", False
        short = f"{worst:.4g}"
        text = short if holds(float(short), self.number) else repr(worst)
        return f"{name}{at} is {text}{more}", True

    def _number(self, value: Any) -> float | None:
        if isinstance(value, str):
            raise _no_number(self.key)
        return None if value is None else float(value)


def conditions_of(texts: Sequence[str], results: Sequence[JudgedResult]) -> list[Condition]:
    """Conditions with the places of their keys.

    Parameters
    ----------
    texts
        Each ``KEY < NUMBER``; the signs are <, <=, >, >=, == and !=.
    results
        Those that will be judged, in order.

    Raises
    ------
    InputError
        If a text is no condition, or no result can have its key.
    """
    return [_condition_of(text, results) for text in texts]


def failures_of(
    conditions: Sequence[Condition],
    results: Callable[[], Sequence[Mapping[str, Any]]],
    steps: Sequence[str] = ("",),
) -> list[str]:
    """One sentence per condition that is met, or that cannot be judged.

    Parameters
    ----------
    conditions
        As `conditions_of` returned them before the results were computed.
    results, steps
        A function that gives the JSON of each of its results; the names of their steps, or empty.

    Raises
    ------
    InputError
        If the results do not have a key, or it is no number.
    """
    data = results() if conditions else ()
    return [sentence for one in conditions for sentence in one.failures(data, steps)]


def _condition_of(text: str, results: Sequence[JudgedResult]) -> Condition:
    parts = _FORM.fullmatch(text)
    try:
        key, sign, number = parts.groups() if parts else ("", "", "")
        limit = float(number)
    except ValueError:
        limit = float("nan")
    if not abs(limit) < float("inf"):
        raise InputError(
            "--fail-if",
            'must be "KEY < NUMBER", with one of <, <=, >, >=, == and !=',
            value=text,
            remedy='e.g. "snr_y_db < 30"',
        )
    found = [_matches(key, one) for one in results]
    ranks = [min((rank for rank, _ in one), default=None) for one in found]
    best = min((rank for rank in ranks if rank is not None), default=None)
    if best is None:
        raise _unknown(key, results)
    places: list[Path | None] = []
    for one in found:
        paths = list(dict.fromkeys(path for rank, path in one if rank == best))
        if len(paths) > 1:
            names = [".".join(step for step in path if step != LIST) for path in paths]
            raise InputError(
                "--fail-if",
                "must name one key of the result",
                value=key,
                found=f"{key} is the end of {len(names)} keys",
                remedy=f"give {' or '.join(names[:4])}",
            )
        places.append(paths[0] if paths else None)
    return Condition(text=text, key=key, sign=sign, number=limit, places=tuple(places))


def _matches(key: str, result: JudgedResult) -> list[tuple[_Rank, Path]]:
    """The paths that a key may mean; those of the least rank are meant."""
    words = _plain(key).split(".")
    found: list[tuple[_Rank, Path]] = []
    for one in described_keys(result.kind.json_schema()):
        match = _match(words, one.path)
        if match is not None and one.is_number:
            is_free, path = match
            found.append(((False, is_free, path.count(LIST)), path))
    if not found and result.quantity:
        quantity = QUANTITIES[result.quantity]
        if _plain(key) in (quantity.key, _plain(quantity.name)):
            found.append(((True, False, 0), vars(result.kind)["OF_QUANTITY"]))
    return found


def _plain(name: str) -> str:
    return name.replace("-", "_").lower()


def _match(words: list[str], path: Path) -> tuple[bool, Path] | None:
    """Whether a word stands for any name, and the path with that name; ``None`` for another key."""
    steps = [i for i, step in enumerate(path) if step != LIST]
    ends = [(False, steps, words)]
    if path[-1:] == (ANY_NAME,) and len(steps) > 1:
        ends.append((False, steps[:-1], words))
        whole = _plain(path[steps[-2]])
        stem, _, unit = whole.rpartition("_")  # snr_y_db for snr_db.Y
        inner = re.fullmatch(rf"{re.escape(stem)}_(.+)_{re.escape(unit)}", words[-1])
        ends += [(True, steps, [*words[:-1], whole, inner[1]])] if inner else []
    for is_joined, places, given in ends:
        if len(given) > len(places):
            continue
        named = dict(zip(places[-len(given) :], given, strict=True))
        free = [i for i in named if path[i] == ANY_NAME]
        fits = all(i in free or _plain(path[i]) == word for i, word in named.items())
        if fits and min(named) not in free:
            filled = (named[i] if i in free else step for i, step in enumerate(path))
            return bool(free) and not is_joined, tuple(filled)
    return None


def _unknown(key: str, results: Sequence[JudgedResult]) -> InputError:
    """The error for a key that no result has, or that is no number."""
    known: list[str] = []
    for result in results:
        keys = described_keys(result.kind.json_schema())
        if any(_match(_plain(key).split("."), one.path) for one in keys):
            return _no_number(key)
        known += [QUANTITIES[result.quantity].key] if result.quantity else []
        known += [name for one in keys if one.is_number for name in _names_of(one)]
    return InputError(
        "--fail-if",
        "must name a key of the result",
        value=key,
        remedy=did_you_mean(
            key,
            list(dict.fromkeys(known)),
            "see `chromanoise schema`",
            cutoff=0.6,
        ),
    )


def _names_of(one: DescribedKey) -> tuple[str, str]:
    """The last part of a key, and the key without the list of sensors."""
    within = one.path[one.path.index(LIST) + 1 :] if LIST in one.path[:-1] else one.path
    *_, last = (step for step in one.path if step not in (LIST, ANY_NAME))
    return last, ".".join(step for step in within if step not in (LIST, ANY_NAME))


def _no_number(key: str) -> InputError:
    demand = "must name a key that is a number"
    return InputError("--fail-if", demand, value=key, found=f"{key} is text")


def _values(data: Mapping[str, Any], path: Path) -> Iterator[tuple[str, str, str, Any]]:
    """Each value at a path: its sensor, its place, its point of a sweep, and the value."""
    owner = str(data.get("label") or data.get("sensor") or "")
    first = path.index(LIST) if LIST in path[:-1] and not owner else -1
    for names, index, value in _walked(data, path):
        who = names[first] if first >= 0 else owner
        yield who, ".".join(names[first + 1 :]), _at(data, index), value


def _walked(data: Any, path: Path) -> Iterator[tuple[Path, tuple[int, ...], Any]]:
    """Each value at a path, with the names of the steps to it and its place in arrays."""
    if data is None:
        yield tuple("" if step == LIST else step for step in path), (), None
    elif not path:
        entries = data if isinstance(data, list) else []
        for i, one in enumerate(entries):
            yield from (((), (i, *index), value) for _, index, value in _walked(one, ()))
        if not isinstance(data, list):
            yield (), (), data
    else:
        for name, one in _inner(data, path[0]):
            for names, index, value in _walked(one, path[1:]):
                yield (name, *names), index, value


def _inner(data: Any, step: str) -> Iterator[tuple[str, Any]]:
    """The entries of a list, or the values of an object under a name or all names."""
    if step == LIST and isinstance(data, list):
        yield from zip(names_of_entries(data), data, strict=True)
    elif isinstance(data, dict):
        exact = [name for name in data if step in (ANY_NAME, name)]
        for name in exact or [name for name in data if _plain(name) == _plain(step)]:
            yield name, data[name]


def _at(data: Mapping[str, Any], index: tuple[int, ...]) -> str:
    """Where the value of a comparison is: `` at lux 0.01``; nothing for other results."""
    swept = [data[name] for name in ("second", "sweep") if name in data][-len(index) :]
    if not index or len(swept) != len(index):
        return ""
    points = [(one["name"], one["values"][i]) for one, i in zip(swept, index, strict=True)]
    return f" at {', '.join(f'{name} {value:.4g}' for name, value in points)}"


def names_of_entries(entries: Sequence[Any]) -> list[str]:
    """The names of the entries of a list, with that of the matrix where several have one name.

    Parameters
    ----------
    entries
        Of JSON. An entry without a name is called by its number.

    Examples
    --------
    >>> names_of_entries([{"name": "R"}, {"name": "G"}, 3.0])
    ['R', 'G', '2']
    """
    parts = [one if isinstance(one, dict) else {} for one in entries]
    names = [
        next((str(one[key]) for key in _NAMES_OF_ENTRIES if one.get(key)), str(i))
        for i, one in enumerate(parts)
    ]
    if len({*names}) < len(names):
        pairs = enumerate(zip(names, parts, strict=True))
        names = [f"{name} ({one.get('matrix', i)})" for i, (name, one) in pairs]
    return names
