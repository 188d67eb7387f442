"""Dataclasses of chromanoise behave as those of the standard library, which is the oracle here."""

import copy
import dataclasses
import gc
import inspect
import pickle
import weakref
from dataclasses import KW_ONLY, FrozenInstanceError, field, fields, replace
from functools import cached_property

import pytest
from hypothesis import given, strategies as st

from chromanoise.base import dataclass, kept

KINDS = {
    "keywords": {"frozen": True, "kw_only": True},
    "positional": {"frozen": True},
    "identity": {"frozen": True, "eq": False},
    "mutable": {},
    "quiet": {"frozen": True, "repr": False},
}
CALLS = st.tuples(
    st.lists(st.integers(0, 3), max_size=4),
    st.dictionaries(st.sampled_from("abcdx"), st.integers(0, 3), max_size=4),
)


def both(kind):
    """The same class made here and by the standard library."""

    def made(decorator):
        @decorator(**KINDS[kind])
        class Point:
            a: int
            b: int = 2
            _: KW_ONLY
            c: list = field(default_factory=list, compare=False)
            d: int = field(default=1, repr=False)

            def __post_init__(self):
                if self.a == 3:
                    raise ValueError("3")

        return Point

    return made(dataclass), made(dataclasses.dataclass)


def outcome(make, *args, **named):
    try:
        return make(*args, **named)
    except (TypeError, ValueError) as error:
        return type(error)


@pytest.mark.parametrize("kind", KINDS)
@given(one=CALLS, other=CALLS)
def test_it_is_made_shown_compared_and_hashed_as_a_standard_one(kind, one, other):
    ours, standard = (
        [outcome(cls, *args, **named) for args, named in (one, other)] for cls in both(kind)
    )
    for found, expected in zip(ours, standard, strict=True):
        if isinstance(expected, type):
            assert found is expected
            continue
        assert dataclasses.asdict(found) == dataclasses.asdict(expected)
        if kind != "quiet":
            assert repr(found) == repr(expected)
        assert replace(found, a=0, c=[1]).c == [1]
    if not any(isinstance(one, type) for one in standard):
        assert (ours[0] == ours[1]) == (standard[0] == standard[1])
        if kind not in ("mutable", "identity"):
            assert (hash(ours[0]) == hash(ours[1])) == (hash(standard[0]) == hash(standard[1]))


@pytest.mark.parametrize("kind", KINDS)
def test_its_class_looks_as_a_standard_one(kind):
    ours, standard = both(kind)
    assert inspect.signature(ours) == inspect.signature(standard).replace(
        return_annotation=inspect.Signature.empty,
        parameters=[
            one.replace(default=[]) if one.name == "c" else one
            for one in inspect.signature(standard).parameters.values()
        ],
    )
    assert [one.name for one in fields(ours)] == [one.name for one in fields(standard)]
    assert (ours.__hash__ is None) == (standard.__hash__ is None)


def test_only_a_frozen_one_refuses_new_values():
    frozen, mutable = both("positional")[0](1), both("mutable")[0](1)
    for change in (lambda: setattr(frozen, "a", 2), lambda: delattr(frozen, "a")):
        with pytest.raises(FrozenInstanceError):
            change()
    mutable.a = 2
    assert (frozen.a, mutable.a) == (1, 2)


@dataclass(frozen=True, kw_only=True)
class Base:
    """A class that other classes extend."""

    size: int = 1


@dataclasses.dataclass(frozen=True, kw_only=True)
class Standard(Base):
    """Of a user, with the standard decorator."""

    length: int


@dataclass(frozen=True, kw_only=True)
class Own(Base):
    """Of this library."""

    length: int


@pytest.mark.parametrize("kind", [Standard, Own])
def test_a_class_extends_it_and_its_values_are_copied_and_pickled(kind):
    one = kind(length=2)
    assert (one.size, one.length) == (1, 2)
    for again in (copy.deepcopy(one), pickle.loads(pickle.dumps(one)), replace(one)):
        assert again == one
    with pytest.raises(FrozenInstanceError):
        one.length = 3
    with pytest.raises(TypeError, match="length"):
        kind(size=2)


def test_a_property_that_is_kept_changes_neither_equality_nor_hash():
    @dataclass(frozen=True)
    class Length:
        size: float

        @cached_property
        def double(self):
            return 2 * self.size

    asked, other = Length(1.0), Length(1.0)
    assert asked.double == 2.0
    assert asked == other
    assert hash(asked) == hash(other)


def test_a_subclass_by_the_standard_decorator_is_compared_by_all_its_fields():
    @dataclass(frozen=True, kw_only=True)
    class Base:
        a: int

    assert Base(a=1) == Base(a=1)

    @dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
    class Own(Base):
        b: int

    assert Own(a=1, b=2) == Own(a=1, b=2)
    assert Own(a=1, b=2) != Own(a=1, b=3)
    assert len({Own(a=1, b=2), Own(a=1, b=3)}) == 2


def test_what_is_kept_of_an_object_is_computed_once_and_goes_with_it():
    @dataclass(frozen=True, eq=False)
    class Light:
        level: float

    asked = []

    @kept
    def times(light, factor):
        asked.append(factor)
        return factor * light.level if isinstance(factor, int) else factor

    one, equal = Light(2.0), Light(2.0)
    assert [times(light, 2) for light in (one, one, equal, one)] == [4.0] * 4
    assert asked == [2, 2]
    assert [times(one, factor) for factor in (3, 2, 3)] == [6.0, 4.0, 6.0]
    assert asked == [2, 2, 3]
    for factor in range(100):  # what is kept of one object has a limit
        times(one, factor)
    asked.clear()
    assert times(one, 0) == 0.0
    assert asked == [0]
    assert times(one, [2]) == times(one, [2])  # without a hash nothing is kept
    assert asked == [0, [2], [2]]
    gone = weakref.ref(one)
    del one
    gc.collect()
    assert gone() is None
