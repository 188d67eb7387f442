"""What neither a file nor its user has said, as questions with the options that answer them."""

from collections.abc import Iterator
from dataclasses import replace

from chromanoise.spectra.files.defects import looks_normalized
from chromanoise.spectra.files.understood import Answers, Question, Understood

_INFRARED_END_NM = 1050.0


def questions_of(told: Understood, named: bool, answers: Answers) -> Understood:
    """The same with its open questions."""
    asked = (
        *_quantity(told),
        *_scale(told, answers),
        *_level(told),
        *_per(told),
        *_columns(told, named, answers),
        *_beyond(told, answers),
    )
    return replace(told, questions=asked)


def _quantity(told: Understood) -> Iterator[Question]:
    if told.quantity is None:
        yield Question(
            about="quantity",
            asks="what are the curves?",
            options="--quantity QE, response, reflectance, transmittance or power",
        )


def _scale(told: Understood, answers: Answers) -> Iterator[Question]:
    if answers.scale or told.quantity in ("power", "response"):
        return
    highest = float(told.curves.values.max()) / told.factor
    unclear = told.scale == "fraction" and highest > 1
    if unclear or told.scale == "as written":
        yield Question(
            about="scale",
            asks=f"the highest value is {highest:g}: are they fractions or percent?",
            options="--fraction or --percent",
        )


def _level(told: Understood) -> Iterator[Question]:
    ratio = told.quantity in ("reflectance", "transmittance")
    if told.level or told.quantity == "power" or (ratio and not looks_normalized(told.curves)):
        return
    yield Question(
        about="level",
        asks="are the curves absolute, or relative (e.g. to their peak)?",
        options="--absolute or --relative",
    )


def _per(told: Understood) -> Iterator[Question]:
    if told.per is None and told.quantity in (None, "power", "response"):
        yield Question(
            about="per",
            asks="is light counted as energy (W) or in photons?",
            options="--energy or --photons",
        )


def _columns(told: Understood, named: bool, answers: Answers) -> Iterator[Question]:
    if not named and len(told.curves.names) > 1 and not answers.columns:
        yield Question(
            about="columns",
            asks="the file does not name its columns: is each a curve, or is one a deviation?",
            options=f"--column {told.curves.names[0]!r}",
        )


def _beyond(told: Understood, answers: Answers) -> Iterator[Question]:
    end = float(told.curves.wavelength_nm[-1])
    if end < _INFRARED_END_NM and answers.beyond == "refuse":
        yield Question(
            about="beyond",
            asks=f"the curves end at {end:g} nm: what follows up to 1050 nm?",
            options="--beyond zero, hold or refuse",
        )
