"""Errors as data: what cannot be used, what is required, what came, and what to do.

The library fills the fields in its own terms. A shell renders them in its own: the command line
names its option, a study file its line and key, the page its control. `str` gives the sentence of
Python, with parameters as keywords.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

_LONGEST_VALUE = 80


@dataclass(frozen=True, slots=True)
class Setting:
    """A parameter that resolves an error when the user sets it.

    Attributes
    ----------
    name
        Of the parameter in Python (``beyond``); in a study its key (``sensors.0.beyond``).
    values
        The values that resolve it; empty where only the user knows the value.
    """

    name: str
    values: tuple[str | float, ...] = ()

    def __str__(self) -> str:
        """As Python takes it: ``set beyond='zero' or 'hold'``."""
        values = " or ".join(repr(value) for value in self.values)
        return f"set {self.name}={values}" if values else f"set {self.name}"


Remedy = str | Setting
Render = Callable[[Setting], str]


class InputError(ValueError):
    """Input that cannot be used.

    Parameters
    ----------
    subject
        What is wrong: a parameter (``read_noise_e``), a file (``cam.csv``), a thing.
    requirement
        What must hold, with the unit: ``must be finite and >= 0 [e-]``. Without it, ``subject`` is
        the whole sentence.
    value
        What came instead; ``None`` where nothing did.
    found
        The same as a clause (``ends at 780 nm``), where ``is {value}`` would not do; ``None`` where
        the requirement needs none.
    where
        The place in the subject: ``line 12``, ``channel G``, ``index (1,)``.
    remedy
        What to do: settings, or instructions for what no setting resolves.
    setting
        The key of the study whose value is wrong, as ``exposure.time_ms``; empty outside of one.

    Examples
    --------
    >>> str(InputError("full_well_e", "must be finite and > 0 [e-]", value=-3.0))
    'full_well_e must be finite and > 0 [e-], but is -3'
    >>> ends = Setting("beyond", ("zero", "hold"))
    >>> str(InputError("cam.csv", "must reach 1050 nm", found="ends at 780 nm", remedy=ends))
    "cam.csv must reach 1050 nm, but ends at 780 nm; set beyond='zero' or 'hold'"
    >>> str(InputError("cam.csv", "holds no number", value="n/a", where="line 12"))
    "cam.csv, line 12: holds no number, but is 'n/a'"
    """

    subject: str
    requirement: str
    value: Any
    found: str | None
    where: str
    remedy: tuple[Remedy, ...]
    setting: str

    def __init__(
        self,
        subject: str,
        requirement: str = "",
        *,
        value: Any = None,
        found: str | None = "",
        where: str = "",
        remedy: Remedy | Sequence[Remedy] = (),
        setting: str = "",
    ) -> None:
        super().__init__(subject, requirement)
        self.subject, self.requirement = subject, requirement
        self.value, self.found, self.where = value, found, where
        self.remedy = (remedy,) if isinstance(remedy, str | Setting) else tuple(remedy)
        self.setting = setting

    def __reduce__(self) -> tuple[Any, ...]:
        """All fields cross from a worker process."""
        return _rebuilt, (type(self), dict(self.__dict__))

    def __str__(self) -> str:
        """The sentence in terms of Python."""
        return self.sentence()

    def sentence(self, *, subject: str | None = None, render: Render = str) -> str:
        """One sentence: what, where, which value, what to do.

        Parameters
        ----------
        subject
            How the shell calls what is wrong; ``None`` for `subject`.
        render
            How the shell tells a setting.

        Returns
        -------
        str
        """
        text = self.subject if subject is None else subject
        if self.where:
            text += f", {self.where}"
        if self.requirement:
            plain = self.requirement.startswith("must ") and not self.where
            text += f"{' ' if plain else ': '}{self.requirement}"
        if self.found:
            text += f", but {self.found}"
        elif self.found is not None and self.value is not None:
            text += f", but is {_shown(self.value)}"
        if self.remedy:
            told = [render(one) if isinstance(one, Setting) else one for one in self.remedy]
            text += f"; {', or '.join(told)}"
        return text

    @property
    def setting_name(self) -> str:
        """The last name in `setting`: ``formats`` of ``pictures.0.formats.1``."""
        names = [step for step in self.setting.split(".") if not step.isdigit()]
        return names[-1] if names else ""

    def called(self, subject: str) -> "InputError":
        """The same error with another name of its subject.

        Parameters
        ----------
        subject
            The name.

        Returns
        -------
        InputError
        """
        return _rebuilt(type(self), self.__dict__ | {"subject": subject})

    def inside(self, setting: str, names: Callable[[str], str]) -> "InputError":
        """The same error where a key of a study gave the value.

        Parameters
        ----------
        setting
            The key, as ``sensors.0.name``.
        names
            From a parameter of the library to its key of the study.

        Returns
        -------
        InputError
        """
        remedy = tuple(
            Setting(names(one.name), one.values) if isinstance(one, Setting) else one
            for one in self.remedy
        )
        return _rebuilt(type(self), self.__dict__ | {"setting": setting, "remedy": remedy})


class StudyError(InputError):
    """All errors of a study at once.

    Attributes
    ----------
    errors
        Each of them; its ``setting`` is a key of the study.
    in_place
        Whether the sentences name the file and line of each.
    """

    errors: tuple[InputError, ...]
    in_place: bool

    def __init__(
        self, errors: Sequence[InputError], sentences: Sequence[str] | None = None
    ) -> None:
        told = [str(error) for error in errors] if sentences is None else sentences
        super().__init__("\n".join(told))
        self.errors, self.in_place = tuple(errors), sentences is not None


def errors_in(error: InputError) -> tuple[InputError, ...]:
    """The single errors that an error holds."""
    return error.errors if isinstance(error, StudyError) else (error,)


def _rebuilt(kind: type[InputError], fields: dict[str, Any]) -> InputError:
    error = kind.__new__(kind, fields["subject"], fields["requirement"])
    error.__dict__.update(fields)
    return error


def _shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}..."
