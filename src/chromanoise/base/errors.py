"""Errors as data: the invalid input, the requirement, the value received, and the remedy.

The library fills the fields with its own parameter names. Each interface renders them in its own
terms: the command line names the option, a study file the line and key, the page the control.
`str` gives the message for Python, with parameters as keywords.
"""

import json
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

from chromanoise.base.immutable import dataclass

_LONGEST_VALUE = 80


@dataclass(frozen=True)
class Setting:
    """A parameter that resolves an error when the user sets it.

    Attributes
    ----------
    name
        Name of the parameter in Python (``beyond``) or its key in a study (``sensors.0.beyond``).
    values
        The values that resolve the error; empty if only the user knows the value.
    omit
        Whether the error is resolved by omitting the parameter instead.
    """

    name: str
    values: tuple[str | float, ...] = ()
    omit: bool = False

    def __str__(self) -> str:
        """The setting in Python syntax: ``set beyond='zero' or 'hold'``, ``omit clip``."""
        if self.omit:
            return f"omit {self.name}"
        values = " or ".join(repr(value) for value in self.values)
        return f"set {self.name}={values}" if values else f"set {self.name}"


Remedy = str | Setting
Render = Callable[[Setting], str]


def known_name(word: str, known: Collection[str]) -> str:
    """The known name that a word is, where ``_`` and ``-`` are equal; a word that is none itself.

    A word that is a known name keeps it, so that names that differ in ``_`` and ``-`` alone remain
    two; any other word for several of them is none.

    Parameters
    ----------
    word, known
        The name, and those that exist.

    Examples
    --------
    >>> known_name("read_noise_e", ["lux", "read-noise-e"]), known_name("x_y", ["lux"])
    ('read-noise-e', 'x_y')
    """
    if word in known:
        return word
    meant = [one for one in known if one.replace("_", "-") == word.replace("_", "-")]
    return meant[0] if len(meant) == 1 else word


def did_you_mean(
    word: str,
    known: Sequence[str],
    otherwise: str,
    *,
    most: int = 3,
    cutoff: float = 0.4,
    plain: Callable[[str], str] = str.lower,
) -> str:
    """The remedy for an unknown name: the known names that resemble it, the nearest first.

    Parameters
    ----------
    word, known
        The name, and those that exist.
    otherwise
        The remedy if none resembles it.
    most, cutoff
        Greatest number of suggestions, and their least similarity (`difflib`), 0 to 1.
    plain
        The form in which names are compared.

    Examples
    --------
    >>> did_you_mean("Analyse", ["run", "analyze"], "see the help")
    'did you mean analyze?'
    >>> did_you_mean("x", ["run", "analyze"], "see the help")
    'see the help'
    """
    compared = {one: plain(one) for one in known}
    near = get_close_matches(plain(word), list(compared.values()), n=most, cutoff=cutoff)
    meant = [one for text in dict.fromkeys(near) for one in compared if compared[one] == text]
    return f"did you mean {' or '.join(meant)}?" if meant else otherwise


class InputError(ValueError):
    """Input that cannot be used.

    Parameters
    ----------
    subject
        What is invalid: a parameter (``read_noise_e``), a file (``cam.csv``) or another object.
    requirement
        The condition that is violated, with its unit: ``must be finite and >= 0 [e-]``.
    value
        The value received; ``None`` if there is none.
    found
        The value described by a clause (``ends at 780 nm``), used instead of ``is {value}``;
        ``None`` if the message does not mention the value.
    where
        Position within the subject: ``line 12``, ``channel G``, ``index (1,)``.
    remedy
        What the user can do: settings, or instructions where no setting resolves the error.
    setting
        Key of the invalid value in the study, e.g. ``exposure.time_ms``; empty outside a study.

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
        requirement: str,
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
        """Pickle all fields, so that an error can be sent from a worker process."""
        return _rebuilt, (type(self), dict(self.__dict__))

    def __str__(self) -> str:
        """The message for Python."""
        return self.sentence()

    def sentence(self, *, subject: str | None = None, render: Render = str) -> str:
        """The message in one sentence: subject, position, requirement, value and remedy.

        Parameters
        ----------
        subject
            Name of the subject in the interface; ``None`` for `subject`.
        render
            Converts a setting to text, e.g. to an option of the command line.

        Returns
        -------
        str
        """
        text = self.subject if subject is None else subject
        if self.where:
            text += f", {self.where}"
        plain = self.requirement.startswith("must ") and not self.where
        text += f"{' ' if plain else ': '}{self.requirement}"
        if self.found:
            text += f", but {self.found}"
        elif self.found is not None and self.value is not None:
            text += f", but is {_shown(self.value)}"
        if self.remedy:
            remedies = [render(one) if isinstance(one, Setting) else one for one in self.remedy]
            text += f"; {', or '.join(remedies)}"
        return text

    @property
    def setting_name(self) -> str:
        """The last name in `setting`: ``formats`` for ``pictures.0.formats.1``."""
        names = [step for step in self.setting.split(".") if not step.isdigit()]
        return names[-1] if names else ""

    def called(self, subject: str) -> "InputError":
        """The same error with another subject.

        Returns
        -------
        InputError
        """
        return _rebuilt(type(self), self.__dict__ | {"subject": subject})

    def within(self, subject: str, place: str | None = None) -> "InputError":
        """The same error about a part of something, usually of a file.

        Parameters
        ----------
        subject
            The whole, usually the file.
        place
            The part; ``None`` for the present subject, empty for none.

        Returns
        -------
        InputError

        Examples
        --------
        >>> print(InputError("pitch_um", "must be > 0 [um]", value=0.0).within("sheet.txt"))
        sheet.txt, pitch_um: must be > 0 [um], but is 0
        """
        parts = (self.subject if place is None else place, self.where)
        where = ", ".join(part for part in parts if part)
        return _rebuilt(type(self), self.__dict__ | {"subject": subject, "where": where})

    def inside(
        self, setting: str, names: Callable[[str], str], instead: Mapping[str, str] | None = None
    ) -> "InputError":
        """The same error for a value given by a key of a study.

        Parameters
        ----------
        setting
            The key, e.g. ``sensors.0.name``.
        names
            Maps a parameter of the library to its key in the study.
        instead
            What to do in place of parameters that have no key.

        Returns
        -------
        InputError
        """
        other = instead or {}
        remedy = tuple(
            one
            if not isinstance(one, Setting)
            else other.get(one.name) or replace(one, name=names(one.name))
            for one in self.remedy
        )
        return _rebuilt(type(self), self.__dict__ | {"setting": setting, "remedy": remedy})


def no_place_for(
    subject: str, requirement: str, value: Any, *remedy: Remedy, setting: str = ""
) -> InputError:
    """The error for a setting that is given where it has no effect, or contradicts another one.

    Parameters
    ----------
    subject, requirement, value, setting
        As `InputError`; the message does not mention the value.
    remedy
        To omit it, if nothing else is said.

    Examples
    --------
    >>> print(no_place_for("clip", "must not be given with a mosaic", True))
    clip must not be given with a mosaic; omit it
    """
    remedies = remedy or ("omit it",)
    return InputError(
        subject, requirement, value=value, found=None, remedy=remedies, setting=setting
    )


class StudyError(InputError):
    """All errors of a study at once.

    Attributes
    ----------
    errors
        The single errors; the ``setting`` of each is a key of the study.
    places
        Where the value of each error is given: ``study.toml:2``, or the change that holds it; empty
        for a study that is not a file.

    Examples
    --------
    >>> dark = InputError("lux", "must be > 0 [lx]", value=0.0, setting="light.level_lux")
    >>> error = StudyError([dark], ["study.toml:2"])
    >>> error.errors[0].setting, error.places
    ('light.level_lux', ('study.toml:2',))
    >>> print(error)
    study.toml:2: light.level_lux: lux must be > 0 [lx], but is 0
    """

    errors: tuple[InputError, ...]
    places: tuple[str, ...]

    def __init__(self, errors: Sequence[InputError], places: Sequence[str] = ()) -> None:
        found = f"has {len(errors)}"
        super().__init__("the study", "must have no errors", value=len(errors), found=found)
        self.errors, self.places = tuple(errors), tuple(places)

    def sentence(self, *, subject: str | None = None, render: Render = str) -> str:
        """The messages of all errors, one line each.

        Parameters
        ----------
        subject
            Without effect: each error names its own.
        render
            Converts a setting to text, where the study is not a file.
        """
        return "\n".join(self.sentences(render=render))

    def sentences(self, *, render: Render = str) -> list[str]:
        """The message of each error, equal ones once; in a file, after its place and key.

        Parameters
        ----------
        render
            Converts a setting to text, where the study is not a file.

        Returns
        -------
        list of str
        """
        if self.places:
            return [in_study(*one) for one in zip(self.errors, self.places, strict=True)]
        return list(dict.fromkeys(error.sentence(render=render) for error in self.errors))


def refusal(errors: Sequence[InputError], places: Sequence[str] = ()) -> InputError:
    """All errors of a study as one that can be raised: a single one without a place is itself.

    Parameters
    ----------
    errors, places
        As `StudyError`.
    """
    return errors[0] if len(errors) == 1 and not places else StudyError(errors, places)


def in_study(error: InputError, place: str) -> str:
    """The sentence of an error in the terms of a study file: the place, the key and its settings.

    Parameters
    ----------
    error
        Its ``setting`` is a key of the study.
    place
        File and line, or the change that holds the value.

    Returns
    -------
    str
    """
    key = _short(error.setting) or "the study"
    begin = f"{place}: {key}"
    if error.subject != (error.setting_name or key):
        return f"{begin}: {error.sentence(render=setting_of_study)}"
    text = error.sentence(subject="", render=setting_of_study).lstrip(" :,")
    return f"{begin}: {text}"


def setting_of_study(setting: Setting) -> str:
    """A remedy in the terms of a study file: ``set sensors.0.beyond = "zero" or "hold"``."""
    if setting.omit:
        return str(setting)
    values = " or ".join(
        f"{value:g}" if isinstance(value, float) else json.dumps(value, ensure_ascii=False)
        for value in setting.values
    )
    return f"set {setting.name} = {values}" if values else f"set {setting.name}"


def _short(key: str) -> str:
    return key if len(key) <= _LONGEST_VALUE else f"{key[:_LONGEST_VALUE]}..."


def errors_in(error: InputError) -> tuple[InputError, ...]:
    """The single errors in an error.

    Parameters
    ----------
    error
        One error, or that of a study.
    """
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
