"""Questions about metadata that a file and its user have not given, and defects of its curves.

A preview of a file shows the questions; `qe_of` and `power_of`, which convert curves to QE per
photon and to power, raise errors with the same text. Defects are detected from the numbers of the
curves.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from chromanoise.base import InputError, Render, Setting, photons_per_joule
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.parsed import (
    SENSITIVE_NM,
    Answers,
    Level,
    ParsedSpectra,
    Quantity,
    Question,
    Scale,
    Scaled,
    Sorted,
    gaps_nm,
)
from chromanoise.spectra import SMALL_NEGATIVES, Spectra

_CHART_PATCHES = 24
_PUBLISHED_WHITE = 0.881
_VISIBLE_NM = (500.0, 650.0)
_RATIOS = ("QE", "reflectance", "transmittance")


_RELATIVE = "the curves look relative"


def defects_of(
    curves: Spectra,
    quantity: Quantity | None,
    scale: Scaled,
    points: Sequence[Sorted],
    *,
    level: Level | None,
) -> tuple[str, ...]:
    """One sentence per kind of defect: sign, height, order of channels, gaps.

    Only wavelengths of 400-1050 nm are checked, because no others are used, unless the file has
    fewer than two of these.

    Notes
    -----
    The white of a ColorChecker reflects 0.881: L* 95.19 for D50 (X-Rite, charts made since
    November 2014), and Y = ((L* + 16) / 116)^3.
    """
    curves = judged(curves)
    return (
        *_conflicts(points),
        *_out_of_range(curves, quantity, scale),
        *_outliers(curves, quantity),
        *(_normalized(curves) if level is None else ()),
        *_white_below_green(curves),
        *_dark_white_patch(curves, quantity),
        *_guard_values(curves),
        *_rounded_wavelengths(curves),
        *_gaps(points),
    )


def judged(curves: Spectra) -> Spectra:
    """The curves at 400-1050 nm, where sensors use them; all if fewer than two points are there.

    Examples
    --------
    >>> curves = Spectra(wavelength_nm=np.array([350.0, 400.0, 500.0]), unit="1", source="s",
    ...                  values=np.array([[-9.0], [0.1], [0.2]]), names=("a",), quantity="QE")
    >>> judged(curves).values.ravel()
    array([0.1, 0.2])
    """
    at = curves.wavelength_nm
    here = (at >= SENSITIVE_NM[0]) & (at <= SENSITIVE_NM[1])
    if here.all() or np.count_nonzero(here) < 2:
        return curves
    return replace(curves, wavelength_nm=at[here], values=curves.values[here])


def defects_of_a_light(defects: tuple[str, ...]) -> tuple[str, ...]:
    """The defects that matter for a light, whose values are always relative.

    Examples
    --------
    >>> defects_of_a_light(("the highest value is exactly 1: the curves look relative", "2 gaps"))
    ('2 gaps',)
    """
    return tuple(defect for defect in defects if not defect.endswith(_RELATIVE))


def looks_normalized(curves: Spectra) -> bool:
    """Whether the highest value is exactly one, as in curves normalized to their maximum.

    Examples
    --------
    >>> looks_normalized(Spectra(wavelength_nm=np.array([400.0, 500.0]), unit="1", source="s",
    ...                          values=np.array([[0.2], [1.0]]), names=("a",), quantity="QE"))
    True
    """
    return float(curves.values.max()) in (1.0, 100.0)


def _conflicts(points: Sequence[Sorted]) -> Iterator[str]:
    wrong = [point for point in points if point.conflicts_nm]
    if wrong:
        others = f" and of {len(wrong) - 1} more curves" if len(wrong) > 1 else ""
        yield (
            f"different values at the same wavelength, first of {wrong[0].name} at "
            f"{wrong[0].conflicts_nm[0]:g} nm ({len(wrong[0].conflicts_nm)} in all){others}"
        )


def _out_of_range(curves: Spectra, quantity: Quantity | None, scale: Scaled) -> Iterator[str]:
    negative = curves.values < 0
    if negative.any():
        yield f"{_count(negative)} below 0, {_first(curves, negative)}"
    above = curves.values > 1
    if above.any() and (quantity in _RATIOS or scale == "fraction"):
        yield f"{_count(above)} above 1, {_first(curves, above)}"


def _outliers(curves: Spectra, quantity: Quantity | None) -> Iterator[str]:
    """Values of hundreds among fractions, as in bands that water absorbs."""
    wild = curves.values > 100
    if quantity == "power" or not wild.any():
        return
    usual = float(np.quantile(curves.values, 0.95))
    if usual <= 1.5:
        at = curves.wavelength_nm[wild.any(axis=1)]
        yield (
            f"{_count(wild)} above 100 at {at[0]:g}-{at[-1]:g} nm, but 95 % below {usual:.2g}: "
            "outliers"
        )


def _count(bad: np.ndarray) -> str:
    return f"{int(bad.sum())} of {bad.size} values are"


def _first(curves: Spectra, bad: np.ndarray) -> str:
    row, column = (int(i) for i in np.argwhere(bad)[0])
    value = curves.values[row, column]
    return f"first {value:.6g} of {curves.names[column]} at {curves.wavelength_nm[row]:g} nm"


def _normalized(curves: Spectra) -> Iterator[str]:
    if looks_normalized(curves):
        row, column = np.unravel_index(int(curves.values.argmax()), curves.values.shape)
        yield (
            f"the highest value is exactly {curves.values.max():g} ({curves.names[column]} at "
            f"{curves.wavelength_nm[row]:g} nm): {_RELATIVE}"
        )


def _channel(curves: Spectra, words: str) -> np.ndarray | None:
    """The only curve whose name begins with one of these words, e.g. ``g``, ``G1`` or ``gAR01``."""
    pattern = rf"(?:{words})(?![a-z])"
    here = [i for i, name in enumerate(curves.names) if re.match(pattern, _small_first(name))]
    return curves.values[:, here[0]] if len(here) == 1 else None


def _small_first(name: str) -> str:
    return name.lower() if name.isupper() or name.istitle() else name[:1].lower() + name[1:]


def _white_below_green(curves: Spectra) -> Iterator[str]:
    white, green = _channel(curves, "w|white|clear|pan"), _channel(curves, "g|green")
    if white is None or green is None:
        return
    over = (green > 1.01 * white) & (green > 0.3 * green.max())
    if over.any():
        at = curves.wavelength_nm[over]
        share = float(np.max(green[over] / np.maximum(white[over], 1e-9 * green.max()))) - 1
        yield (
            f"green exceeds white by up to {100 * share:.0f} % at {at[0]:g}-{at[-1]:g} nm "
            f"({at.size} wavelengths): no filter adds light, so they come from different sources"
        )


def _dark_white_patch(curves: Spectra, quantity: Quantity | None) -> Iterator[str]:
    visible = (curves.wavelength_nm >= _VISIBLE_NM[0]) & (curves.wavelength_nm <= _VISIBLE_NM[1])
    if quantity != "reflectance" or len(curves.names) != _CHART_PATCHES or not visible.any():
        return
    levels = curves.values[visible].mean(axis=0)
    brightest = int(levels.argmax())
    off = float(levels[brightest]) / _PUBLISHED_WHITE - 1
    if abs(off) > 0.03:
        side = "below" if off < 0 else "above"
        yield (
            f"24 patches, but the brightest ({curves.names[brightest]}) reflects "
            f"{levels[brightest]:.2f} at 500-650 nm, {abs(100 * off):.0f} % "
            f"{side} the white of a ColorChecker; rescale before comparing"
        )


def _guard_values(curves: Spectra) -> Iterator[str]:
    at = curves.wavelength_nm
    for end, beside in ((0, 1), (-1, -2)):
        if curves.values[end].any() or not curves.values[beside].any():
            continue
        step = abs(float(at[beside] - at[end]))
        if step > 1.5 * float(np.median(np.diff(at))):
            yield f"a lone 0 at {at[end]:g} nm, {step:g} nm from its neighbor, looks like a guard"


def _rounded_wavelengths(curves: Spectra) -> Iterator[str]:
    at = curves.wavelength_nm
    steps = np.unique(np.diff(at))
    whole = bool((at == np.round(at)).all())
    if whole and at.size > 10 and steps.size == 2 and steps[1] - steps[0] == 1 and steps[0] > 1:
        mean = float((at[-1] - at[0]) / (at.size - 1))
        steps_text = f"{steps[0]:g} and {steps[1]:g} for {mean:.2f}"
        yield f"wavelengths look rounded to whole nm: steps of {steps_text}"


def _gaps(points: Sequence[Sorted]) -> Iterator[str]:
    """One sentence for all gaps within the wavelengths that sensors use."""
    gaps = sorted(
        {
            (start, stop)
            for point in points
            for start, stop in gaps_nm(point.wavelength_nm)
            if stop > SENSITIVE_NM[0] and start < SENSITIVE_NM[1]
        },
        key=lambda gap: (gap[0] - gap[1], gap[0]),
    )
    if not gaps:
        return
    start, stop = gaps[0]
    what = f"a gap from {start:g} to {stop:g} nm"
    if len(gaps) > 1:
        what = f"{len(gaps)} gaps, the widest from {start:g} to {stop:g} nm"
    yield f"{what}: linear interpolation is uncertain there"


_PER = Setting("per", ("energy", "photon"))
_READING = (
    r"(?i)(?:.*: )?(?:dark|background|ref|reference)"
    r"(?: (?:spectrum|scan|reading|signal|counts|intensity|\d+))?"
)
_NO_RESPONSE = (
    r"(?i)m[aw]/.*|[µμu]a/.*|counts?(?:/.*)?|adu(?:/.*)?|dn(?:/.*)?|lsb(?:/.*)?|[mµμu]?v(?:/.*)?|"
    r"[mµμun]?a|e-?|electrons?|photons?|permille|‰|nm"
)
_MENTIONED = r"(?i)\b(qe|quantum efficiency|responsivity|sensitivity|reflect\w*|transmi\w*|A/W)\b"


Use = Literal["sensor", "light", "filter", "reflectance"]
"""The purpose for which curves are read."""


class UndeclaredError(InputError):
    """Raised for questions that must be answered before the curves of a file can be used.

    Parameters
    ----------
    questions
        All questions; ``remedy`` contains their settings in the same order.

    Examples
    --------
    >>> light = Question("columns", "which curve?", (Setting("columns"),))
    >>> str(UndeclaredError("lamp.csv", (light,)))
    'lamp.csv: which curve? set columns'
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
        cures = iter(one if isinstance(one, str) else render(one) for one in self.remedy)
        needed = [" or ".join(next(cures) for _ in range(count)) for count in self.counts]
        text = self.subject if subject is None else subject
        pause = "" if self.requirement.endswith("?") else ";"
        return f"{text}: {self.requirement}{pause} {', and '.join(needed)}"


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
    words
        The free text of the file. A question may quote it, but it answers none.
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
            "columns",
            f"the file has the columns {', '.join(names[:8])}, and {reading!r} looks like a "
            "reading for correcting the other columns: which columns are the curves?",
            (Setting("columns"),),
        )
    if parsed.per is None and not _documented(parsed):
        yield Question(
            "per", "it does not declare whether its response is per energy or per photon", (_PER,)
        )
    if parsed.level == "relative" or (parsed.level is None and looks_normalized(parsed.curves)):
        if answers.peak_qe is None:
            yield _peak(parsed)
    elif parsed.level is None and parsed.quantity != "QE" and not _documented(parsed):
        yield Question(
            "level",
            "it does not declare whether its values are absolute or relative",
            (Setting("level", get_args(Level)),),
        )


def light_questions(parsed: ParsedSpectra) -> Iterator[Question]:
    """Questions about an illuminant: which curve to use, and energy or photons."""
    names = parsed.curves.names
    if len(names) != 1:
        yield Question(
            "columns",
            f"it holds {len(names)} curves, {', '.join(names[:8])}: which is the light?",
            (Setting("columns"),),
        )
    if parsed.per is None:
        yield Question(
            "per", "it does not declare whether light is counted as energy or in photons", (_PER,)
        )


def _documented(parsed: ParsedSpectra) -> bool:
    """A table headed ``wavelength_nm``: absolute QE per photon unless it declares otherwise."""
    return parsed.own_form and parsed.quantity is None


def _peak(parsed: ParsedSpectra) -> Question:
    if parsed.level == "relative":
        asks = "its curves are relative; what is the highest QE?"
        return Question("peak_qe", asks, (Setting("peak_qe"),))
    asks = "its highest value is exactly 1 or 100; what is the highest QE, or are the values QE?"
    settings = (Setting("peak_qe"), Setting("level", ("absolute",)))
    return Question("peak_qe", asks, settings)


def _quantity(parsed: ParsedSpectra, words: str) -> Iterator[Question]:
    if parsed.quantity is None and not _documented(parsed):
        found = re.search(_MENTIONED, words)
        hint = f" (its text mentions {found[1]!r}, but free text is not used)" if found else ""
        yield Question(
            "quantity",
            f"what are the curves, for another use than a sensor?{hint}",
            (Setting("quantity", get_args(Quantity)),),
        )


def scale_questions(parsed: ParsedSpectra, answers: Answers) -> Iterator[Question]:
    """Whether values are fractions or percent, where neither file nor user declares it."""
    if answers.scale or parsed.quantity in ("power", "response"):
        return
    highest = float(judged(parsed.curves).values.max()) / parsed.factor
    unclear = parsed.scale == "fraction" and highest > 1
    if unclear or parsed.scale == "as written":
        yield Question(
            "scale",
            f"the highest value is {highest:g}: are they fractions or percent?",
            (Setting("scale", get_args(Scale)),),
        )


def _negatives(parsed: ParsedSpectra, answers: Answers) -> Iterator[Question]:
    negative = judged(parsed.curves).values < 0
    if answers.negatives == "refuse" and negative.any():
        yield Question(
            "negatives",
            f"{int(negative.sum())} values are negative: set small ones to 0?",
            (SMALL_NEGATIVES,),
        )


def _beyond(parsed: ParsedSpectra, answers: Answers) -> Iterator[Question]:
    low, high = (float(end) for end in parsed.curves.wavelength_nm[[0, -1]])
    if answers.beyond == "refuse" and (low > SENSITIVE_NM[0] or high < SENSITIVE_NM[1]):
        yield Question(
            "beyond",
            f"the curves cover {low:g}-{high:g} nm of 400-1050 nm: how should they be "
            "extrapolated?",
            (Setting("beyond", ("zero", "hold")),),
        )


_ELEMENTARY_CHARGE_C = 1.602176634e-19


def qe_of(parsed: ParsedSpectra, answers: Answers) -> Spectra:
    """Convert curves to electrons per photon; the notes list assumptions.

    Parameters
    ----------
    answers
        The answers of the user; ``peak_qe`` scales relative curves.

    Raises
    ------
    InputError
        If the file contains another quantity.
    UndeclaredError
        If questions must be answered first; ``remedy`` holds the settings.

    Notes
    -----
    A response S per energy equals S h c / lambda per photon. A response in A/W is also divided by
    the elementary charge e: QE = S h c / (e lambda).

    Examples
    --------
    >>> curves = Spectra(wavelength_nm=np.array([400.0, 800.0]), values=np.array([[.5], [1.0]]),
    ...                  names=("mono",), quantity="response", unit="1", source="a sheet")
    >>> parsed = ParsedSpectra(
    ...     curves=curves, format="text", wavelength_unit="nm", scale="as written",
    ...     quantity="response", level="relative", per="energy")
    >>> qe_of(parsed, Answers(peak_qe=0.6)).values.ravel()  # equal per photon at both
    array([0.6, 0.6])
    """
    source = parsed.curves.source
    if parsed.quantity in ("reflectance", "transmittance", "power"):
        required = "must hold quantum efficiencies or responses, for a sensor"
        raise has(source, required, parsed.quantity, "holds")
    asked = tuple(sensor_questions(parsed, answers))
    _refuse_open(parsed, (*scale_questions(parsed, answers), *asked) if asked else ())
    for name, unit in zip(parsed.curves.names, parsed.units, strict=False):
        if re.fullmatch(_NO_RESPONSE, unit):
            required, cure = "must be in A/W, percent or electrons per photon", "convert it"
            raise refused(source, required, unit, f"{name} is in {unit}", remedy=cure)
    curves, notes = parsed.curves, _said(parsed)
    if parsed.per == "energy":
        per_photon = 1.0 / photons_per_joule(curves.wavelength_nm)[:, None] / _ELEMENTARY_CHARGE_C
        curves = replace(curves, values=curves.values * per_photon)
        notes = (*notes, "counted per energy: divided by the photons in it")
    if parsed.level == "relative" or (parsed.level is None and looks_normalized(parsed.curves)):
        highest = float(curves.values.max())
        assert answers.peak_qe is not None  # asked for by `sensor_questions`
        if highest <= 0:
            raise refused(curves.source, "must have a value above 0", highest, "all are 0 or less")
        curves = replace(curves, values=curves.values * (answers.peak_qe / highest))
        notes = (*notes, f"relative curves, scaled to a highest QE of {answers.peak_qe:g}")
    elif parsed.level is None:
        why = "a table headed wavelength_nm" if parsed.quantity is None else "the file declares QE"
        notes = (*notes, f"{_name(parsed)}: {why}, taken as absolute QE per photon")
    return replace(curves, quantity="QE", unit="e-/photon", notes=(*curves.notes, *notes))


def _refuse_open(parsed: ParsedSpectra, questions: Iterable[Question]) -> None:
    """Raise an error if there are open questions; its message lists all of them."""
    open_questions = tuple(questions)
    if open_questions:
        raise UndeclaredError(parsed.curves.source, open_questions)


def power_of(parsed: ParsedSpectra) -> Spectra:
    """Convert one curve to relative power over wavelength, for `illuminant_from`.

    Raises
    ------
    InputError
        If the light is given per wavenumber.
    UndeclaredError
        If the file has several curves, or does not declare whether light is counted as energy or in
        photons; ``remedy`` holds the settings.
    """
    curves = parsed.curves
    _refuse_open(parsed, light_questions(parsed))
    if parsed.wavelength_unit == "1/cm":
        need = "must give light per wavelength"
        found = "gives it per wavenumber in 1/cm, which is not a constant number of nm"
        remedy = "convert it to light per nm"
        raise refused(curves.source, need, parsed.wavelength_unit, found, remedy=remedy)
    notes = _said(replace(parsed, defects=defects_of_a_light(parsed.defects)))
    if parsed.per == "photon":
        curves = power_of_photons(curves)
    return replace(curves, quantity="power", unit="relative", notes=(*curves.notes, *notes))


def power_of_photons(curves: Spectra) -> Spectra:
    """Convert curves of photons to relative power, with linear interpolation in photons.

    Parameters
    ----------
    curves
        Relative photons per wavelength. They are interpolated to every nanometer before they are
        multiplied by the photon energy, because a line in photons is not a line in power.

    Notes
    -----
    A photon has the energy h c / lambda, here normalized to 1 at the shortest wavelength.

    Examples
    --------
    >>> flat = Spectra(wavelength_nm=np.array([400.0, 800.0]), values=np.ones((2, 1)),
    ...                names=("lamp",), quantity="power", unit="1", source="a lamp")
    >>> power = power_of_photons(flat)
    >>> float(power.values[power.wavelength_nm == 500, 0].round(12)[0])       # 400/500
    0.8
    """
    known = curves.wavelength_nm
    at = np.union1d(known, np.arange(np.ceil(known[0]), known[-1]))
    photons = np.stack([np.interp(at, known, curve) for curve in curves.values.T], axis=1)
    energy = 1.0 / photons_per_joule(at)[:, None]
    return replace(
        curves,
        wavelength_nm=at,
        values=photons * energy / energy.max(),
        quantity="power",
        unit="relative",
        notes=(*curves.notes, f"{curves.source}: counted in photons, multiplied by their energy"),
    )


def _said(parsed: ParsedSpectra) -> tuple[str, ...]:
    """Notes and defects, each prefixed with the name of the file."""
    return tuple(f"{_name(parsed)}: {text}" for text in (*parsed.notes, *parsed.defects))


def _name(parsed: ParsedSpectra) -> str:
    return Path(parsed.curves.source).name
