"""Interpret the content of a file: units, scale, quantity, and open questions."""

import re
from collections import Counter
from dataclasses import replace
from typing import cast, get_args

import numpy as np

from chromanoise.base import Array, InputError, Setting, did_you_mean
from chromanoise.io.source_files import errors_within, refused
from chromanoise.io.spectra.cell_tables import DIGITIZED
from chromanoise.io.spectra.declared import (
    is_wavelength_heading,
    quantity_of_key,
    scale_of_key,
    unit_that_fits,
    wavelength_unit_of,
)
from chromanoise.io.spectra.parsed import (
    SENSITIVE_NM,
    Answers,
    Column,
    Found,
    Level,
    ParsedSpectra,
    Per,
    Quantity,
    Scaled,
    Sorted,
    Unit,
    gaps_nm,
    on_common,
    sorted_points,
    step_nm,
)
from chromanoise.io.spectra.questions import defects_of, questions_of
from chromanoise.spectra import Spectra, are_small_negatives

_WORDS: tuple[tuple[Quantity, str], ...] = (
    ("QE", r"(?<![a-z])qe(?![a-z])|quantum.?efficiency|e-?/(photon|ph)\b|electrons per photon"),
    ("response", r"responsivity|sensitivit|\bresponse\b|\ba\s*/\s*w\b"),
    ("reflectance", r"reflect"),
    ("transmittance", r"transmi[ts]|throughput|ir[- ]?cut filter"),
    (
        "power",
        r"irradiance|radiance|power|(?<![a-z])spd(?![a-z])|\bflux|\bw\s*/?\s*m\^?-?2|extraterrestrial"
        r"|emission|illuminant|\blamp|\b(flam|photlam)\b",
    ),
)
_PERCENT = r"%|(?<![a-z])(percent|pct)(?![a-z])|[\[(]\s*0\s*(\.\.|-|to)\s*100(\.0*)?\s*[\])]"
_DEVIATION = (
    r"(?i)(?<![a-z])(standard[ _]deviation|std|stdev|s\.?d\.?|sigma|uncertainty|errors?)(?![a-z])"
)
_ABSORBANCE = r"(?i)absorban|optical.density|\blog ?\(? ?1 ?/ ?[rt]\b"
_MOST_UM, _LEAST_NM = 20.0, 100.0
_MOSTLY = 0.5  # of the steps, ascending minus descending
FRACTION_AT_MOST = 1.5
"""The largest value of a curve of fractions, an outlier included; larger ones may be percent."""
_PERCENT_AT_MOST = 100.0
_MOST_SENTENCES = 3
_UNNAMED = "its columns have no names: each is taken as a curve, none as a standard deviation"


def meaning_of(found: Found, answers: Answers) -> ParsedSpectra:
    """Interpret the columns of a file, using the answers of the user for missing metadata.

    Raises
    ------
    InputError
        If the unit of the wavelengths is unknown, a curve has fewer than two points, or the
        numbers contradict the metadata of the file, or the curves are absorbances.
    """
    columns, deviations = _chosen(found, answers)
    _refuse_absorbances(found, columns)
    unit, unit_note = _wavelength_unit(found, answers, columns)
    quantity = _quantity(found, answers, columns)
    points = [sorted_points(column, unit, found.source) for column in columns]
    scale, factor, scale_note = _scale(found, answers, columns, points, quantity)
    level = _level(found, answers, columns)
    common, cut = on_common(points, answers.beyond, found.source)
    spectra = Spectra(
        wavelength_nm=common[0],
        values=common[1] * factor,
        names=tuple(p.name for p in points),
        quantity=quantity or "spectra",
        unit="e-/photon" if quantity == "QE" else "1",
        source=found.source,
    )
    curves, zeroed = _without_small_negatives(spectra, answers)
    lists = (curves.wavelength_nm, *(one.wavelength_nm for one in points))
    gaps = {gap for at in lists for gap in gaps_nm(at)}
    notes = (
        *(*found.notes, *unit_note, *scale_note, *_merge_notes(points), *cut, *zeroed),
        *([] if found.named or len(columns) < 2 or answers.columns else [_UNNAMED]),
    )
    spread = [sorted_points(column, unit, found.source) for column in deviations]
    parsed = ParsedSpectra(
        curves=curves,
        format=found.format,
        delimiter=found.delimiter,
        decimal=found.decimal,
        wavelength_unit=unit,
        scale=scale,
        factor=factor,
        step_nm=step_nm(curves.wavelength_nm),
        gaps_nm=tuple(sorted(gaps)),
        merged=max(p.merged for p in points),
        quantity=quantity,
        level=level,
        per=_per(found, answers, columns, quantity),
        deviations=_deviations(found, curves, spread, factor),
        notes=notes,
        defects=(
            *_few(found.defects),
            *defects_of(curves, quantity, scale, points, level=level),
        ),
        own_form=found.heading == "wavelength_nm",
        units=tuple(one.unit for one in columns),
        said_source=found.said_source,
        said_notes=found.said_notes,
    )
    return questions_of(parsed, found.words, answers)


def _chosen(found: Found, answers: Answers) -> tuple[list[Column], list[Column]]:
    """The selected curves, and the columns of their standard deviations."""
    curves: list[Column] = []
    spread: list[Column] = []
    for column in found.columns:
        own = spread if re.search(_DEVIATION, f"{column.name} {column.unit}") else curves
        own.append(column)
    if not curves:
        curves, spread = spread, []
    names = [c.name for c in curves]
    repeated = [name for name, count in Counter(names).items() if count > 1]
    if repeated:
        need, first = "must have different names for its curves", repeated[0]
        raise refused(found.source, need, first, f"{first!r} is repeated", remedy="rename one")
    for name in answers.columns:
        if name not in names:
            need, held = f"must have the curve {name!r}", f"has {', '.join(names[:20])}"
            raise refused(found.source, need, tuple(names), held, remedy=Setting("columns"))
    if answers.columns:
        curves = [curves[names.index(name)] for name in dict.fromkeys(answers.columns)]
    return curves, spread


def _refuse_absorbances(found: Found, columns: list[Column]) -> None:
    heads = [f"{c.name} [{c.unit}]" if c.unit else c.name for c in columns]
    if all(re.search(_ABSORBANCE, head) for head in heads):
        need = "must hold transmittances, reflectances or light, not absorbances"
        remedy = "convert each absorbance A to a transmittance, 10^-A"
        raise refused(found.source, need, heads[0], remedy=remedy)


def _wavelength_unit(
    found: Found, answers: Answers, columns: list[Column]
) -> tuple[Unit, tuple[str, ...]]:
    """The declared unit, else the answer, else the only unit that fits the numbers."""
    known = [c.wavelength for c in columns if c.wavelength.size]
    if not known:
        raise refused(found.source, "has curves without points")
    low = min(float(at.min()) for at in known)
    high = max(float(at.max()) for at in known)
    if low <= 0:
        raise refused(found.source, "wavelengths must be > 0", low, f"one is {low:g}")
    declared, answer = _declared_unit(found), answers.wavelength_unit
    span = f"{low:g}-{high:g}"
    other = _contradicted(declared, low, high)
    if declared and other:
        if answer is None:
            required = "wavelengths must be plausible in their unit"
            held = f"{span} {declared}, as its heading declares, look like {other}"
            cure = Setting("wavelength_unit", (other, declared))
            raise refused(found.source, required, declared, held, remedy=cure)
        declared = answer if answer == other else declared  # the numbers contradict the heading
    if answer and declared and answer != declared:
        need = f"must be {declared!r}, as {found.source} declares"
        raise refused("wavelength_unit", need, answer, remedy=("omit it", "correct the file"))
    if declared or answer:
        return declared or answer or "nm", ()
    listed = is_wavelength_heading(found.heading) or found.format.endswith(DIGITIZED)
    fitting = unit_that_fits(low, high)
    points = fitting == "nm" and len(found.columns) == 1  # clicked in any order
    if not listed and not points and not all(map(_is_ordered, known)):
        raise _unit_wanted(found, span)
    numbered = all(bool((at == np.round(at)).all()) for at in known)  # rows 1, 2, 3
    if fitting is None or (fitting == "um" and numbered):
        raise _unit_wanted(found, span)
    return fitting, (f"wavelengths of {span} are taken as {fitting}",)


def _contradicted(declared: Unit | None, low: float, high: float) -> Unit | None:
    """The unit that is more plausible for the numbers than the declared one; None if none is."""
    if declared == "nm" and high < _MOST_UM:
        return "um"
    if declared == "um" and low >= _LEAST_NM:
        return "nm"
    return "nm" if declared == "angstrom" and unit_that_fits(low, high) == "nm" else None


def _unit_wanted(found: Found, span: str) -> InputError:
    need, units = "must declare the unit of its wavelengths", get_args(Unit)
    remedy = Setting("wavelength_unit", units)
    return refused(found.source, need, span, f"{span} have none", remedy=remedy)


def _is_ordered(at: Array) -> bool:
    """Whether most steps have the same sign; unordered numbers may not be wavelengths."""
    signs = np.sign(np.diff(at))
    return bool(abs(signs.sum()) >= _MOSTLY * np.count_nonzero(signs))


def _declared_unit(found: Found) -> Unit | None:
    """The unit that format, heading or key declares; contradicting ones raise an error."""
    key = found.keys.get("wavelength_unit")
    with errors_within(found.source):
        units = {
            "its format": found.wavelength_unit,
            "its heading": wavelength_unit_of(found.heading),
            "its key": wavelength_unit_of(f"[{key}]") if key else None,
        }
    said = {where: unit for where, unit in units.items() if unit}
    if len(set(said.values())) > 1:
        units_text = ", ".join(f"{unit} by {where}" for where, unit in said.items())
        need, held = "must declare one unit of wavelengths", f"declares {units_text}"
        raise refused(found.source, need, units_text, held, remedy="correct one")
    return next(iter(said.values()), None)


def _quantity(found: Found, answers: Answers, columns: list[Column]) -> Quantity | None:
    given = answers.quantity or found.quantity or quantity_of_key(found.keys)
    if given:
        return given
    for quantity, words in _WORDS:
        if re.search(words, _heads(found, columns)):
            return quantity
    return None


def _heads(found: Found, columns: list[Column]) -> str:
    """Headings and declared units in lower case; other text is not interpreted."""
    heads = (f"{c.name} [{c.unit}]" if c.unit else c.name for c in columns)
    return " ; ".join([*heads, found.keys.get("unit", "")]).lower()


def _scale(
    found: Found,
    answers: Answers,
    columns: list[Column],
    points: list[Sorted],
    quantity: Quantity | None,
) -> tuple[Scaled, float, tuple[str, ...]]:
    said = answers.scale or found.scale
    if said:
        return said, (0.01 if said == "percent" else 1.0), ()
    _refuse_some(columns, r"\ba\s*/\s*w\b", "A/W", found.source)
    if quantity in ("power", "response"):
        return "as written", 1.0, ()
    highs = [_highest(p) for p in points]
    highest = max(highs)
    declared = scale_of_key(found.keys)
    percent = [c for c in columns if re.search(_PERCENT, f"{c.name} [{c.unit}]".lower())]
    if declared is None:
        _refuse_some(columns, _PERCENT, "percent", found.source)
    if declared == "percent" or percent:
        return "percent", 0.01, ("declared as percent: divided by 100",)
    if declared == "fraction":
        return "fraction", 1.0, ()
    if highest <= FRACTION_AT_MOST:
        return "fraction", 1.0, ()
    if highest <= _PERCENT_AT_MOST and min(highs) <= 1:
        return "fraction", 1.0, ()  # another curve is in fractions, and files do not mix the two
    if highest <= _PERCENT_AT_MOST and quantity is not None:
        note = f"a {quantity} of {highest:g} can only be in percent: divided by 100"
        return "percent", 0.01, (note,)
    return "as written", 1.0, ()


def _refuse_some(columns: list[Column], words: str, unit: str, source: str) -> None:
    """Refuse curves of which some, but not all, have a unit by their headings."""
    has = [bool(re.search(words, f"{one.name} [{one.unit}]".lower())) for one in columns]
    if any(has) and not all(has):
        own, other = columns[has.index(True)].name, columns[has.index(False)].name
        need = "must have all curves in one unit"
        held = f"{own} is in {unit} by its heading and {other} is not"
        remedy = ("give all curves one unit", Setting("columns"))
        raise refused(source, need, (own, other), held, remedy=remedy)


def _highest(points: Sorted) -> float:
    """The highest value at 400-1050 nm, or at any wavelength if none is there; at least 0."""
    at = points.wavelength_nm
    here = points.values[(at >= SENSITIVE_NM[0]) & (at <= SENSITIVE_NM[1])]
    return float((here if here.size else points.values).max(initial=0.0))


def _level(found: Found, answers: Answers, columns: list[Column]) -> Level | None:
    given = answers.level or found.level or ("relative" if answers.peak_qe is not None else None)
    word = _word_of_key(found, "level", get_args(Level))
    if given or word:
        return given or cast("Level", word)
    heads = _heads(found, columns)
    if re.search(r"relative|\brel\b|normali[sz]ed|arbitrary|\ba\.?u\.?(?![a-z])", heads):
        return "relative"
    return "absolute" if re.search(r"absolute|e-?/photon|\ba\s*/\s*w\b", heads) else None


def _per(
    found: Found, answers: Answers, columns: list[Column], quantity: Quantity | None
) -> Per | None:
    given, word = answers.per or found.per, _word_of_key(found, "per", get_args(Per))
    if given or word:
        return given or cast("Per", word)
    heads = _heads(found, columns)
    if quantity == "QE" or re.search(r"photon|quanta|photlam", heads):
        return "photon"
    units = " ; ".join([*(c.unit for c in columns), found.keys.get("unit", "")]).lower()
    watt = re.search(r"\bm?w\b|\bj\b|\bflam\b", units)  # W as a name is a white channel
    named = f"{heads} {found.keys.get('quantity', '').lower()}"
    words = re.search(r"watt|\ba\s*/\s*w\b|power|radiance|energy", named)
    return "energy" if quantity in ("power", "response") and (watt or words) else None


def _word_of_key(found: Found, key: str, choices: tuple[str, ...]) -> str:
    """The choice that a key declares; empty for other facts, but a misspelt choice is refused."""
    word = found.keys.get(key, "").lower()
    if not word or word in choices:
        return word
    remedy = did_you_mean(word, choices, "", cutoff=0.75)
    if remedy:
        raise refused(found.source, f"{key} must be {' or '.join(choices)}", word, remedy=remedy)
    return ""


def _without_small_negatives(curves: Spectra, answers: Answers) -> tuple[Spectra, tuple[str, ...]]:
    """The curves with small negative values set to 0, if the user chose that."""
    small = are_small_negatives(curves.values)
    if answers.negatives == "refuse" or not small.any():
        return curves, ()
    note = (
        f"{int(small.sum())} small negative values taken as 0, the lowest "
        f"{curves.values[small].min():.3g}"
    )
    return replace(curves, values=np.where(small, 0.0, curves.values)), (note,)


def _few(sentences: tuple[str, ...]) -> tuple[str, ...]:
    """The first sentences, and the number of the others."""
    more = len(sentences) - _MOST_SENTENCES
    if more <= 1:
        return sentences
    return (*sentences[:_MOST_SENTENCES], f"and {more} more like these")


def _deviations(
    found: Found, curves: Spectra, spread: list[Sorted], factor: float
) -> Spectra | None:
    if not spread:
        return None
    at = curves.wavelength_nm
    values = np.stack([np.interp(at, p.wavelength_nm, p.values) for p in spread], axis=1)
    return Spectra(
        wavelength_nm=at,
        values=values * factor,
        names=tuple(f"{p.name} ({k + 1})" for k, p in enumerate(spread)),
        quantity=f"standard deviation of {curves.quantity}",
        unit=curves.unit,
        source=found.source,
    )


def _merge_notes(points: list[Sorted]) -> tuple[str, ...]:
    notes = []
    unsorted = [p.name for p in points if p.unsorted]
    if unsorted:
        notes.append(f"rows sorted by wavelength: {', '.join(unsorted[:8])}")
    merged = [p.merged for p in points]
    if any(merged):
        many = f"up to {max(merged)}" if len(set(merged)) > 1 else f"{merged[0]}"
        notes.append(f"{many} repeated wavelengths merged to their mean")
    return tuple(notes)
