"""Questions about metadata that neither a file nor its user has given, with their settings.

A preview of a file shows the questions; `qe_of` and `power_of` raise errors with the same text.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal, get_args

from chromanoise.errors import InputError, Render, Setting
from chromanoise.io.spectra.defects import judged, looks_normalized
from chromanoise.io.spectra.parsed import Answers, Level, ParsedSpectra, Quantity, Question, Scale
from chromanoise.spectra.curves import SMALL_NEGATIVES

_GRID_NM = (400.0, 1050.0)
_PER = Setting("per", ("energy", "photon"))
_READING = (
    r"(?i)(?:.*: )?(?:dark|background|ref|reference)"
    r"(?: (?:spectrum|scan|reading|signal|counts|intensity|\d+))?"
)
_MENTIONED = r"(?i)\b(qe|quantum efficiency|responsivity|sensitivity|reflect\w*|transmi\w*|A/W)\b"


Use = Literal["sensor", "light", "filter", "reflectance"]
"""The purpose for which curves are read."""


class UndeclaredError(InputError):
    """Raised for questions that must be answered before the curves of a file can be used.

    Parameters
    ----------
    subject
        The file.
    questions
        All questions; ``remedy`` contains their settings in the same order.

    Examples
    --------
    >>> light = Question(about="columns", asks="which curve?", settings=(Setting("columns"),))
    >>> str(UndeclaredError("lamp.csv", (light,)))
    'lamp.csv: which curve?; set columns'
    """

    counts: tuple[int, ...]

    def __init__(self, subject: str, questions: Sequence[Question]) -> None:
        super().__init__(
            subject,
            "; ".join(question.asks for question in questions),
            remedy=[one for question in questions for one in question.settings],
        )
        self.counts = tuple(len(question.settings) for question in questions)

    def sentence(self, *, subject: str | None = None, render: Render = str) -> str:
        """As in `InputError`, but with the settings of all questions, which all need answers."""
        settings = iter(one for one in self.remedy if isinstance(one, Setting))
        needed = [
            " or ".join(render(next(settings)) for _ in range(count)) for count in self.counts
        ]
        text = self.subject if subject is None else subject
        return f"{text}: {self.requirement}; {', and '.join(needed)}"


def use_of(quantity: Quantity | None) -> Use:
    """The use of curves with this quantity; without a quantity, a sensor."""
    others: dict[Quantity | None, Use] = {
        "power": "light",
        "transmittance": "filter",
        "reflectance": "reflectance",
    }
    return others.get(quantity, "sensor")


def questions_of(parsed: ParsedSpectra, words: str, answers: Answers) -> ParsedSpectra:
    """The parsed file with the open questions of the use that its quantity implies.

    Parameters
    ----------
    parsed
        The parsed file.
    words
        The free text of the file. A question may quote it, but it answers none.
    answers
        The user's answers.
    """
    use = use_of(parsed.quantity)
    own = tuple(sensor_questions(parsed, answers)) if use == "sensor" else ()
    questions = (
        *(_quantity(parsed, words) if own else ()),
        *scale_questions(parsed, answers),
        *own,
        *(light_questions(parsed) if use == "light" else ()),
        *_negatives(parsed, answers),
        *_beyond(parsed, answers),
    )
    return replace(parsed, questions=questions)


def sensor_questions(parsed: ParsedSpectra, answers: Answers) -> Iterator[Question]:
    """Questions about a sensor: which curves, per photon or per energy, and their scale."""
    names = parsed.curves.names
    reading = next((name for name in names if re.fullmatch(_READING, name)), None)
    if reading is not None and len(names) > 1 and not answers.columns:
        yield Question(
            about="columns",
            asks=f"the file has the columns {', '.join(names[:8])}, and {reading!r} looks like a "
            "reading for correcting the other columns: which columns are the curves?",
            settings=(Setting("columns"),),
        )
    if parsed.per is None and not _documented(parsed):
        yield Question(
            about="per",
            asks="it does not declare whether its response is per energy or per photon",
            settings=(_PER,),
        )
    if parsed.level == "relative" or (parsed.level is None and looks_normalized(parsed.curves)):
        if answers.peak_qe is None:
            yield _peak(parsed)
    elif parsed.level is None and parsed.quantity != "QE" and not _documented(parsed):
        yield Question(
            about="level",
            asks="it does not declare whether its values are absolute or relative",
            settings=(Setting("level", get_args(Level)),),
        )


def light_questions(parsed: ParsedSpectra) -> Iterator[Question]:
    """Questions about an illuminant: which curve to use, and energy or photons."""
    names = parsed.curves.names
    if len(names) != 1:
        yield Question(
            about="columns",
            asks=f"it holds {len(names)} curves, {', '.join(names[:8])}: which is the light?",
            settings=(Setting("columns"),),
        )
    if parsed.per is None:
        yield Question(
            about="per",
            asks="it does not declare whether light is counted as energy or in photons",
            settings=(_PER,),
        )


def _documented(parsed: ParsedSpectra) -> bool:
    """A table headed ``wavelength_nm``: absolute QE per photon unless it declares otherwise."""
    return parsed.own_form and parsed.quantity is None


def _peak(parsed: ParsedSpectra) -> Question:
    if parsed.level == "relative":
        asks = "its curves are relative; what is the highest QE?"
        return Question(about="peak_qe", asks=asks, settings=(Setting("peak_qe"),))
    asks = "its highest value is exactly 1 or 100; what is the highest QE, or are the values QE?"
    settings = (Setting("peak_qe"), Setting("level", ("absolute",)))
    return Question(about="peak_qe", asks=asks, settings=settings)


def _quantity(parsed: ParsedSpectra, words: str) -> Iterator[Question]:
    if parsed.quantity is None and not _documented(parsed):
        found = re.search(_MENTIONED, words)
        hint = f" (its text mentions {found[1]!r}, but free text is not used)" if found else ""
        yield Question(
            about="quantity",
            asks=f"what are the curves, for another use than a sensor?{hint}",
            settings=(Setting("quantity", get_args(Quantity)),),
        )


def scale_questions(parsed: ParsedSpectra, answers: Answers) -> Iterator[Question]:
    """Whether values are fractions or percent, where neither file nor user declares it."""
    if answers.scale or parsed.quantity in ("power", "response"):
        return
    highest = float(judged(parsed.curves).values.max()) / parsed.factor
    unclear = parsed.scale == "fraction" and highest > 1
    if unclear or parsed.scale == "as written":
        yield Question(
            about="scale",
            asks=f"the highest value is {highest:g}: are they fractions or percent?",
            settings=(Setting("scale", get_args(Scale)),),
        )


def _negatives(parsed: ParsedSpectra, answers: Answers) -> Iterator[Question]:
    negative = judged(parsed.curves).values < 0
    if answers.negatives == "refuse" and negative.any():
        yield Question(
            about="negatives",
            asks=f"{int(negative.sum())} values are negative: set small ones to 0?",
            settings=(SMALL_NEGATIVES,),
        )


def _beyond(parsed: ParsedSpectra, answers: Answers) -> Iterator[Question]:
    low, high = (float(end) for end in parsed.curves.wavelength_nm[[0, -1]])
    if answers.beyond == "refuse" and (low > _GRID_NM[0] or high < _GRID_NM[1]):
        yield Question(
            about="beyond",
            asks=f"the curves cover {low:g}-{high:g} nm of 400-1050 nm: how should they be "
            "extrapolated?",
            settings=(Setting("beyond", ("zero", "hold")),),
        )
