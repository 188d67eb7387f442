"""The page remembers the values that were used last, and forgets failures."""

import pytest

from chromanoise.web.page_studies import Remembered


def test_a_value_is_made_once_while_it_is_among_the_latest():
    made = []
    held = Remembered(2)

    def value(key):
        return held.of(key, lambda: made.append(key) or key.upper())

    assert [value(key) for key in "abacab"] == ["A", "B", "A", "C", "A", "B"]
    assert made == ["a", "b", "c", "b"]  # c took the place of b, because a was used after b


def test_a_failure_is_not_remembered():
    held = Remembered(2)
    with pytest.raises(ZeroDivisionError):
        held.of("a", lambda: 1 / 0)
    assert held.of("a", lambda: 3) == 3


def test_a_value_may_be_made_while_another_is():
    held = Remembered(2)
    assert held.of("a", lambda: held.of("b", lambda: 1) + 1) == 2
