"""In tests, calls with arrays and numbers are checked: types, shapes, axes of one name."""

from dataclasses import dataclass

import jaxtyping
import numpy as np
import pytest
from beartype.roar import BeartypeCallHintViolation

from chromanoise import noise
from chromanoise.base.shapes import Float

Array = np.ndarray
checked = jaxtyping.jaxtyped(typechecker=None)  # as the import hook of conftest.py applies it


@checked
def product(one: Float[Array, "n m"], other: Float[Array, "m p"]) -> Float[Array, "n p"]:
    return one @ other


@checked
def cut(one: Float[Array, "n"]) -> Float[Array, "n"]:
    return one[1:]


@checked
def outer(one: Float[Array, "n"]) -> float:
    return float(product(np.ones((2, 3)), np.ones((3, 4))).sum() * one.sum())


@checked
def scaled(one: Float[Array, "n"], by: float) -> int:
    return by * one.size


@checked
def half(one: int) -> int | None:
    return one / 2


@checked
@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    one: Float[Array, "n"]
    other: tuple[Float[Array, "n"], ...] | None = None


def ones(*shape):
    return np.ones(shape)


@pytest.mark.parametrize(
    "call",
    [
        lambda: product(ones(2, 3), ones(2, 3)),  # m is 3, then 2
        lambda: product(ones(2, 3), ones(3)),
        lambda: product(ones(2, 3), np.ones((3, 4), dtype=int)),
        lambda: cut(ones(3)),  # the result
        lambda: scaled(ones(3), "a"),
        lambda: scaled(ones(3), 1.5),  # the result
        lambda: half(3),
        lambda: Pair(one=ones(3), other=(ones(2),)),
        # of the library, which the import hook has wrapped
        lambda: checked(noise.raw_covariance.__wrapped__)(ones(3).tolist(), read_noise_e=1.0),
    ],
)
def test_a_wrong_type_or_shape_ends_a_call(call):
    with pytest.raises(BeartypeCallHintViolation):
        call()


def test_axes_are_named_anew_in_each_call():
    assert product(ones(2, 3), ones(3, 4)).shape == (2, 4)
    assert product(ones(5, 6), ones(6, 7)).shape == (5, 7)
    assert outer(ones(9)) == 2 * 4 * 3 * 9
    assert scaled(ones(3), 2) == 6  # an int may stand for a float
    assert Pair(one=ones(3), other=(ones(3), ones(3))).one.shape == (3,)
