"""What a command or a function refused: fields, or one sentence of one form."""

import re
from contextlib import contextmanager
from dataclasses import fields

import numpy as np
import pytest

from chromanoise.base.errors import InputError, Setting, errors_in


class Outcome(tuple):
    """Exit code, standard output and standard error of a command, as a tuple of three.

    Attributes
    ----------
    errors
        The single `InputError`s that ended it; none where the parser of options refused.
    """

    def __new__(cls, code, out, err, *, errors=()):
        made = super().__new__(cls, (code, out, err))
        made.errors = errors
        return made


def refused(outcome, *parts, remedy_setting=None, **fields):
    """Exit code 2, nothing printed, and one line per error that holds ``parts``.

    Parameters
    ----------
    outcome
        Of a command: (code, out, err); for ``fields`` an `Outcome`.
    parts
        Names of options, files and values in standard error.
    remedy_setting
        Name of a setting in the remedy of one of the errors.
    fields
        Of the same error: subject, value, where, setting.
    """
    code, out, err = outcome
    assert code == 2, err
    assert out == ""
    lines = err.splitlines()
    assert lines, "no sentence"
    assert all(line.startswith("chromanoise: ") for line in lines), err
    errors = getattr(outcome, "errors", ())
    assert len(lines) <= max(1, len(errors)), err
    assert "Traceback" not in err
    for part in parts:
        assert part in err, err
    if fields or remedy_setting is not None:
        assert any(_agrees(error, remedy_setting, None, fields) for error in errors), [
            vars(error) for error in errors
        ]


@contextmanager
def refused_input(*, setting=None, requirement=None, **fields):
    """An `InputError` with these fields, in one line; ``setting`` names a setting of its remedy."""
    with pytest.raises(InputError) as caught:
        yield caught
    errors = errors_in(caught.value)
    assert not any("\n" in str(error) for error in errors)
    assert any(_agrees(error, setting, requirement, fields) for error in errors), [
        vars(error) for error in errors
    ]


def refusal_of(read, path, **options):
    """The `InputError` with which a reader refuses a file, in one line that names the file."""
    with refused_input() as caught:
        read(path, **options)
    assert str(path) in str(caught.value)
    return caught.value


def _agrees(error, setting, requirement, fields):
    settings = [one.name for one in error.remedy if isinstance(one, Setting)]
    names = [*settings, *(name.rpartition(".")[2] for name in settings)]
    return (
        all(getattr(error, name) == value for name, value in fields.items())
        and (setting is None or setting in names)
        and (requirement is None or re.search(requirement, error.requirement) is not None)
    )


def same_bits(one, other):
    """Whether two arrays, or all arrays of two records, are the same to the last bit."""
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other) and one.tobytes() == other.tobytes()
    arrays = [f.name for f in fields(one) if isinstance(getattr(one, f.name), np.ndarray)]
    return all(same_bits(getattr(one, name), getattr(other, name)) for name in arrays)
