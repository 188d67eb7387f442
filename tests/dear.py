"""Cases of a test that take long: `make evidence` runs them, the suite the others."""

from typing import Any

import pytest


def dear(*cases: Any) -> list[Any]:
    """Values of a parametrized test, or tuples of them, as evidence."""
    each = (one if isinstance(one, tuple) else (one,) for one in cases)
    return [pytest.param(*one, marks=pytest.mark.evidence) for one in each]


def dear_if(is_dear: Any, cases: Any) -> list[Any]:
    """All cases in their order; those of which a function is true as evidence."""
    return [dear(one)[0] if is_dear(one) else one for one in cases]
