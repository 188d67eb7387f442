"""What a command or a function refused: fields, or one sentence of one form."""

import re
from contextlib import contextmanager

import pytest

from chromanoise.errors import InputError, Setting, errors_in


def refused(outcome, *parts):
    """Exit code 2 and one sentence that holds ``parts``, nothing else."""
    code, out, err = outcome
    assert code == 2
    assert out == ""
    assert err.startswith("chromanoise: ")
    assert err.count("\n") == 1
    assert "Traceback" not in err
    for part in parts:
        assert part in err


@contextmanager
def refused_input(*, setting=None, requirement=None, **fields):
    """An `InputError` with these fields; ``setting`` names one of the settings of its remedy."""
    with pytest.raises(InputError) as caught:
        yield caught
    errors = errors_in(caught.value)
    assert any(_agrees(error, setting, requirement, fields) for error in errors), [
        vars(error) for error in errors
    ]


def _agrees(error, setting, requirement, fields):
    names = [one.name for one in error.remedy if isinstance(one, Setting)]
    return (
        all(getattr(error, name) == value for name, value in fields.items())
        and (setting is None or setting in names)
        and (requirement is None or re.search(requirement, error.requirement) is not None)
    )
