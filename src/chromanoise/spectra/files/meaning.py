"""From what stands in a file to curves in nm: units, scale, quantity, and what stays open."""

import re
from typing import Literal

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.spectra.curves import Spectra
from chromanoise.spectra.files.defects import defects_of
from chromanoise.spectra.files.merging import Sorted, gaps_nm, on_common, sorted_points, step_nm
from chromanoise.spectra.files.questions import questions_of
from chromanoise.spectra.files.understood import (
    Answers,
    Column,
    Found,
    Level,
    Per,
    Quantity,
    Understood,
    Unit,
)

_WORDS: tuple[tuple[Quantity, str], ...] = (
    ("QE", r"(?<![a-z])qe(?![a-z])|quantum.efficiency|e-?/photon|electrons per photon"),
    ("response", r"responsivity|sensitivit|spectral response|\ba/w\b"),
    ("reflectance", r"reflect"),
    ("transmittance", r"transmi[ts]|ir[- ]?cut filter"),
    (
        "power",
        r"irradiance|radiance|power|(?<![a-z])spd(?![a-z])|\bflux|\bw\s*/?\s*m\^?-?2|extraterrestrial"
        r"|emission|illuminant|\blamp",
    ),
)
_PERCENT = r"%|(?<![a-z])(percent|pct)(?![a-z])"
_DEVIATION = r"(?i)(?<![a-z])(standard[ _]deviation|std|stdev|s\.?d\.?|sigma|uncertainty)(?![a-z])"
_NM = r"(?i)(?<![a-z])(nm|nanomet\w*)(?![a-z])"
_UM = r"(?i)(?<![a-z])(um|µm|μm|microns?|micromet\w*)(?![a-z])"
_MOST_UM, _LEAST_NM = 20.0, 100.0
_FRACTION_AT_MOST, _PERCENT_AT_MOST = 1.5, 100.0


def meaning_of(found: Found, answers: Answers) -> Understood:
    """What a file's columns are, with the user's answers where the file is silent.

    Raises
    ------
    InputError
        If the unit of the wavelengths cannot be told, a curve has fewer than two points, or the
        numbers contradict what the file says of them.
    """
    columns, deviations = _chosen(found, answers)
    unit, unit_note = _wavelength_unit(found, answers, columns)
    quantity = _quantity(found, answers, columns)
    scale, factor, scale_note = _scale(found, answers, columns, quantity)
    points = [sorted_points(column, unit, found.source) for column in columns]
    level = _level(found, answers, columns)
    common, cut = on_common(points, answers.beyond, found.source)
    curves = _spectra(found, common, points, factor, quantity)
    notes = (*found.notes, *unit_note, *scale_note, *_merge_notes(points), *cut)
    spread = [sorted_points(column, unit, found.source) for column in deviations]
    told = Understood(
        curves=curves,
        format=found.format,
        delimiter=found.delimiter,
        decimal=found.decimal,
        wavelength_unit=unit,
        scale=scale,
        factor=factor,
        step_nm=step_nm(curves.wavelength_nm),
        gaps_nm=_gaps_nm(curves, points),
        merged=sum(p.merged for p in points),
        quantity=quantity,
        level=level,
        per=_per(found, answers, columns, quantity),
        deviations=_deviations(found, curves, spread, factor),
        notes=notes,
        defects=(
            *found.defects,
            *defects_of(curves, quantity, scale, points, level=level, beyond=answers.beyond),
        ),
        questions=(),
        own_form=found.heading == "wavelength_nm",
        said_source=found.said_source,
        said_notes=found.said_notes,
    )
    return questions_of(told, found.named, answers)


def _chosen(found: Found, answers: Answers) -> tuple[list[Column], list[Column]]:
    """The curves that are wanted, and the columns of their standard deviations."""
    spread = [c for c in found.columns if re.search(_DEVIATION, f"{c.name} {c.unit}")]
    curves = [c for c in found.columns if c not in spread]
    if not curves:
        curves, spread = spread, []
    names = [c.name for c in curves]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise _check.InputError(f"{found.source}: the curve {name!r} stands twice; rename one")
    for name in answers.columns:
        if name not in names:
            raise _check.InputError(
                f"{found.source}: has no curve {name!r}; it has {', '.join(names[:20])}"
            )
    if answers.columns:
        curves = [curves[names.index(name)] for name in dict.fromkeys(answers.columns)]
    return curves, spread


def _wavelength_unit(
    found: Found, answers: Answers, columns: list[Column]
) -> tuple[Unit, tuple[str, ...]]:
    known = [c.wavelength for c in columns if c.wavelength.size]
    if not known:
        raise _check.InputError(f"{found.source}: its curves have no points")
    low = min(float(at.min()) for at in known)
    high = max(float(at.max()) for at in known)
    if low <= 0:
        raise _check.InputError(f"{found.source}: a wavelength must be > 0, but one is {low:g}")
    said: Unit | None = found.wavelength_unit
    if re.search(_UM, found.heading):
        said = "um"
    elif re.search(_NM, found.heading):
        said = "nm"
    unit = answers.wavelength_unit or said
    if answers.wavelength_unit is None and unit == "nm" and high < _MOST_UM:
        raise _check.InputError(
            f"{found.source}: its wavelengths are {low:g}-{high:g} nm by its heading; are they in "
            "nm? if they are in um, say --um"
        )
    if unit is not None:
        return unit, ()
    if high < _MOST_UM:
        return "um", (f"wavelengths of {low:g}-{high:g} are taken as um",)
    if low >= _LEAST_NM:
        return "nm", (f"wavelengths of {low:g}-{high:g} are taken as nm",)
    raise _check.InputError(
        f"{found.source}: wavelengths of {low:g}-{high:g} may be nm or um; say --nm or --um"
    )


def _quantity(found: Found, answers: Answers, columns: list[Column]) -> Quantity | None:
    if answers.quantity or found.quantity:
        return answers.quantity or found.quantity
    heads = " ".join([found.heading, *(f"{c.name} {c.unit}" for c in columns)])
    for text in (heads.lower(), found.words.lower()):
        for quantity, words in _WORDS:
            if re.search(words, text):
                return quantity
    return None


def _scale(
    found: Found, answers: Answers, columns: list[Column], quantity: Quantity | None
) -> tuple[Literal["fraction", "percent", "as written"], float, tuple[str, ...]]:
    if answers.scale:
        return answers.scale, (0.01 if answers.scale == "percent" else 1.0), ()
    if quantity in ("power", "response"):
        return "as written", 1.0, ()
    heads = " ".join(f"{c.name} {c.unit}" for c in columns).lower()
    highest = max(float(c.values.max(initial=0.0)) for c in columns)
    if re.search(_PERCENT, heads):
        return "percent", 0.01, ("its heading says percent: divided by 100",)
    if highest <= _FRACTION_AT_MOST:
        return "fraction", 1.0, ()
    lowest = min(float(c.values.max(initial=0.0)) for c in columns)
    said = re.search(_PERCENT, found.words.lower())
    if highest <= _PERCENT_AT_MOST and lowest <= 1 and not said:
        return "fraction", 1.0, ()  # a curve of fractions beside it: no file mixes the two
    if highest <= _PERCENT_AT_MOST and said:
        return (
            "percent",
            0.01,
            (f"highest value {highest:g}, and its text says percent: divided by 100",),
        )
    if highest <= _PERCENT_AT_MOST and quantity is not None:
        note = f"no {quantity} is {highest:g}: taken as percent, divided by 100"
        return "percent", 0.01, (note,)
    return "as written", 1.0, ()


def _level(found: Found, answers: Answers, columns: list[Column]) -> Level | None:
    if answers.level or found.level:
        return answers.level or found.level
    if answers.peak_qe is not None:
        return "relative"
    text = " ".join([found.heading, found.words, *(f"{c.name} {c.unit}" for c in columns)]).lower()
    if re.search(r"relative|normali[sz]ed|arbitrary|\ba\.?u\.?(?![a-z])", text):
        return "relative"
    return "absolute" if re.search(r"absolute|e-?/photon|\ba/w\b", text) else None


def _per(
    found: Found, answers: Answers, columns: list[Column], quantity: Quantity | None
) -> Per | None:
    if answers.per or found.per:
        return answers.per or found.per
    text = " ".join([found.heading, *(f"{c.name} {c.unit}" for c in columns)]).lower()
    if quantity == "QE" or re.search(r"photon|quanta", text):
        return "photon"
    if "light counted per photon" in found.words:
        return "photon"
    units = " ".join(c.unit for c in columns).lower()  # W as a name is a white channel
    watt = re.search(r"\bm?w\b|\bj\b", units)
    words = re.search(r"watt|\ba/w\b|power|radiance|energy", f"{text} {found.words.lower()}")
    return "energy" if quantity in ("power", "response") and (watt or words) else None


def _spectra(
    found: Found,
    common: tuple[Array, Array],
    points: list[Sorted],
    factor: float,
    quantity: Quantity | None,
) -> Spectra:
    return Spectra(
        wavelength_nm=common[0],
        values=common[1] * factor,
        names=tuple(p.name for p in points),
        quantity=quantity or "spectra",
        unit="e-/photon" if quantity == "QE" else "1",
        source=found.source,
    )


def _gaps_nm(curves: Spectra, points: list[Sorted]) -> tuple[tuple[float, float], ...]:
    """Those of all curves, and of each alone."""
    each = (gap for at in points for gap in gaps_nm(at.wavelength_nm))
    return tuple(sorted({*gaps_nm(curves.wavelength_nm), *each}))


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
    merged = sum(p.merged for p in points)
    if merged:
        notes.append(f"{merged} repeated wavelengths merged to their mean")
    return tuple(notes)
