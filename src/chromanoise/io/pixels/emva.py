"""A pixel from the values of an EMVA 1288 data sheet, with units and consistency checks.

EMVA Standard 1288, Release 4.0 Linear (2021): the camera model of its chapter 2, the summary sheet
of its chapter 10. The checks are relations that the values must satisfy.
"""

import math
import re
from collections.abc import Callable, Mapping
from decimal import Decimal, InvalidOperation
from math import sqrt
from pathlib import Path

from chromanoise.base import check, dataclass, json_of
from chromanoise.io.pixels.pixel_toml import errors_in_file, finite_number, source_text
from chromanoise.io.source_files import errors_within, refused, xml_root
from chromanoise.sensor import PIXEL_FILES, ROUNDING_DN2, Adc, PixelSource

_TOLERANCE = 0.05  # values of a sheet are rounded, and are measured separately


def contradictions(values: Mapping[str, float], source: str) -> tuple[str, ...]:
    """The relations between values of a sheet that do not hold, one sentence each.

    Parameters
    ----------
    values
        The values, by the keys of `chromanoise.io.pixels.emva`; electrons, photons, DN/e-, ratios.
    source
        The name of the sheet.

    Notes
    -----
    EMVA Standard 1288, Release 4.0 Linear (2021), chapter 2: SNR_max^2 = u_e.sat, DR = u_e.sat /
    u_e.min, u_e.min = sqrt(sigma_d^2 + 1/(12 K^2)) + 1/2, electrons = QE photons.

    Examples
    --------
    >>> contradictions({"saturation": 10_000.0, "snr_max": 50.0}, "a sheet")
    ('a sheet: SNR_max^2 = 2500, but u_e.sat [e-] gives 1e+04; one is wrong',)
    """
    n = dict(values)
    if "snr_max" in n:
        n["snr_max"] **= 2
    notes = []
    for (stated, *needs), what, other, expected in _LAWS:
        if n.keys() >= {stated, *needs} and not alike(n[stated], expected(n)):
            found = f"{what} = {n[stated]:.4g}, but {other} gives {expected(n):.4g}"
            notes.append(f"{source}: {found}; one is wrong")
    codes = 2 ** n["bits"] - 1 if 8 <= n.get("bits", 0) <= 16 else 0.0
    top = n.get("gain", 0.0) * n.get("saturation", 0.0) + n.get("black", 0.0)
    if codes and top > (1 + _TOLERANCE) * codes:
        notes.append(
            f"{source}: the full well gives code {top:.4g}, above the top code {codes:.0f}; gain, "
            "full well and bits are probably from different camera modes"
        )
    return tuple(notes)


def _threshold_e(n: Mapping[str, float]) -> float:
    return sqrt(n["read_noise"] ** 2 + ROUNDING_DN2 / n["gain"] ** 2) + 0.5


_Law = tuple[tuple[str, ...], str, str, Callable[[Mapping[str, float]], float]]
_LAWS: tuple[_Law, ...] = (  # needed values, of which the first is stated; what gives it
    (("snr_max", "saturation"), "SNR_max^2", "u_e.sat [e-]", lambda n: n["saturation"]),
    (
        ("dynamic_range", "saturation", "threshold"),
        "DR",
        "u_e.sat / u_e.min",
        lambda n: n["saturation"] / max(n["threshold"], 1e-300),
    ),
    (
        ("dynamic_range", "saturation", "read_noise", "gain"),
        "DR",
        "u_e.sat over the threshold of sigma_d",
        lambda n: n["saturation"] / _threshold_e(n),
    ),
    (
        ("threshold", "read_noise", "gain"),
        "u_e.min [e-]",
        "sqrt(sigma_d^2 + 1/(12 K^2)) + 1/2",
        _threshold_e,
    ),
    (
        ("dark_noise", "read_noise", "gain"),
        "sigma_y.dark [e-]",
        "sqrt(sigma_d^2 + 1/(12 K^2))",
        lambda n: sqrt(n["read_noise"] ** 2 + ROUNDING_DN2 / n["gain"] ** 2),
    ),
    (
        ("saturation", "photons_full", "qe"),
        "u_e.sat [e-]",
        "QE u_p.sat",
        lambda n: n["qe"] * n["photons_full"],
    ),
    (
        ("threshold", "photons_threshold", "qe"),
        "u_e.min [e-]",
        "QE u_p.min",
        lambda n: n["qe"] * n["photons_threshold"],
    ),
)


def alike(a: float, b: float) -> bool:
    """Whether two values of a sheet agree, within 5 % of the larger."""
    return abs(a - b) <= _TOLERANCE * max(abs(a), abs(b))


_VALUES = {  # names, without signs and blanks; units
    "qe": ("qe eta quantumefficiency", "% 1"),
    "qe_at_nm": ("wavelength lambda centroidwavelength peakwavelength qewavelength", "nm"),
    "gain": ("k gain systemgain overallsystemgain conversiongain", "DN/e- e-/DN"),
    "gain_inverse": ("1k inversek inversesystemgain inversegain", "e-/DN"),
    "read_noise": ("sigmad darknoise temporaldarknoise readnoise readoutnoise", "e- DN"),
    "dark_noise": ("sigmaydark", "DN e-"),
    "full_well": ("fullwell fullwellcapacity", "e-"),
    "saturation": ("muesat uesat saturationcapacity", "e-"),
    "threshold": ("muemin uemin absolutesensitivitythreshold sensitivitythreshold", "e- p"),
    "photons_full": ("mupsat upsat", "p"),
    "photons_threshold": ("mupmin upmin", "p"),
    "dynamic_range": ("dr drdb dynamicrange", "dB bit 1"),
    "snr_max": (
        "snrmax snrmaxdb maximumsnr maximumsignaltonoiseratio signaltonoiseratio",
        "dB bit 1",
    ),
    "dsnu": ("dsnu dsnu1288 su1288dark", "e- DN"),
    "prnu": ("prnu prnu1288", "% 1"),
    "dark_current": ("mui muimean muc ui uimean darkcurrent", "e-/s DN/s"),
    "dark_current_of_variance": ("muivar uivar", "e-/s DN/s"),
    "pitch": ("pixelpitch pixelsize pitch", "um"),
    "bits": ("bits bitdepth adcbits adc", "bit"),
    "black": ("blacklevel offset blackoffset muydark uydark", "DN"),
}
_KEY_OF = {alias: key for key, (names, _) in _VALUES.items() for alias in names.split()}

_UNITS = {
    "e-": "e- e e⁻ electron electrons",
    "DN": "dn lsb adu digit",
    "DN/e-": "dn/e- dn/e adu/e- adu/e lsb/e- lsb/e dn/e⁻",
    "e-/DN": "e-/dn e/dn e-/adu e/adu e-/lsb e/lsb e⁻/dn",
    "e-/s": "e-/s e/s e⁻/s electrons/s",
    "DN/s": "dn/s adu/s lsb/s",
    "p": "p photon photons",
    "%": "% percent",
    "1": "1 e-/photon e-/p e/photon",
    "dB": "db",
    "bit": "bit bits",
    "um": "um µm μm micron microns",
    "nm": "nm",
}
_UNIT_OF = {alias: unit for unit, aliases in _UNITS.items() for alias in aliases.split()}

_LINE = re.compile(
    r"(?P<name>[^\[\]:=;,\t]+?)\s*(?:\[(?P<left>[^\]]*)\])?\s*[:=;,\t]\s*"
    r"(?P<value>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?P<right>[\s;,\t\[%a-zA-Zµμ].*)?"
)
_UNSIGNED_LINE = re.compile(r"(?P<name>.*[^\s:=])\s+[-+]?[\d.]+([eE][-+]?\d+)?\s*(?P<unit>\S+)")


@dataclass(frozen=True)
class _Value:
    """One number of the sheet, with its name, unit and place (line and name) in the sheet."""

    name: str
    number: float
    unit: str
    where: str


def read_emva_sheet(path: Path | str) -> PixelSource:
    """The pixel of an EMVA 1288 data sheet typed into a file, one value with its unit per line.

    Parameters
    ----------
    path
        A file of lines ``name = value unit``, ``name: value unit``, ``name [unit] = value`` or
        ``name,value,unit``, in which ``#`` starts a comment; a JSON object that maps a name to
        ``{"value": .., "unit": ".."}``; or XML in the form of the package emva1288, as
        `chromanoise.apps.camera.emva_sheet_xml` writes it. Names are symbols of the standard,
        e.g. ``sigma_d``, or terms, e.g. ``temporal dark noise``.

    Raises
    ------
    InputError
        If the file cannot be read, or a known value is repeated, has no unit or a wrong unit, or
        is out of range.

    Notes
    -----
    Values are checked against each other: SNR_max^2 = u_e.sat, DR = u_e.sat / u_e.min, u_e.min =
    sqrt(sigma_d^2 + 1/(12 K^2)) + 1/2, electrons = QE photons. The notes report deviations of more
    than 5 %; values are not corrected. If the sheet has no full well, it is the saturation
    capacity, at which the variance peaks.
    """
    path = Path(path)
    text = source_text(path)
    rows = _FORMS.get(text.lstrip()[:1], _text_rows)(text, path)
    with errors_in_file(path):
        return pixel_from_emva(
            {name: (number, unit) for name, number, unit, _ in rows},
            source=path.name,
            where={name: place for name, _, _, place in rows},
        )


def pixel_from_emva(
    values: Mapping[str, tuple[float, str]],
    *,
    source: str = "data sheet",
    where: Mapping[str, str] | None = None,
) -> PixelSource:
    """The pixel of the named values of an EMVA 1288 data sheet.

    Parameters
    ----------
    values
        Number and unit of each name, e.g. ``{"sigma_d": (2.4, "e-")}``.
    source
        The name of the source, for messages and notes.
    where
        The place of each name, for messages.

    Raises
    ------
    InputError
        As for `read_emva_sheet`.

    Examples
    --------
    >>> read = pixel_from_emva({"K": (0.5, "DN/e-"), "sigma_d": (4.0, "DN"), "PRNU": (1.0, "%")})
    >>> read.gain_e_per_dn, read.read_noise_e, read.prnu
    (2.0, 8.0, 0.01)
    """
    places = where or {}
    found: dict[str, _Value] = {}
    unused = []
    for name, (number, unit) in values.items():
        key = _key(name)
        if key is None:
            unused.append(name)
            continue
        place = ", ".join(part for part in (places.get(name, ""), name[:40]) if part)
        with errors_within(source, place):
            value = _valued(key, name, number, unit, place)
        first = found.setdefault(key, value)
        if first.unit != value.unit or not alike(first.number, value.number):
            need = f"must agree with {first.name} = {first.number:g} {first.unit}"
            held = f"is {value.number:g} {value.unit}"
            remedy = "keep one of the two"
            raise refused(source, need, value.number, held, where=value.where, remedy=remedy)
    of_variance = found.pop("dark_current_of_variance", None)
    if of_variance is not None and found.setdefault("dark_current", of_variance) != of_variance:
        unused.append(of_variance.name)  # the standard prefers the mean
    if not found:
        names = [name[:40] for name in unused[:5]]
        need = "must hold a value of an EMVA 1288 sheet, e.g. sigma_d = 2.4 e-"
        held = f"names {', '.join(names) or 'nothing'}"
        raise refused(source, need, names, held, remedy=f"give {PIXEL_FILES}")
    return _pixel_source(found, unused, source)


def _text_rows(text: str, path: Path) -> list[tuple[str, float, str, str]]:
    rows: dict[str, tuple[str, float, str, str]] = {}
    for i, raw in enumerate(text.splitlines(), 1):
        line = raw.split("#")[0].strip().strip(",;")
        if not line:
            continue
        where, name = f"line {i}", re.split(r"[\[:=;,\t]", line)[0].strip()
        unsigned = _UNSIGNED_LINE.fullmatch(line)
        if unsigned and unsigned["unit"].lower() in _UNIT_OF:  # read noise 2.5 e-
            name = unsigned["name"]
        matched = _LINE.fullmatch(line)
        if matched is None:
            if _key(name) is None:
                continue  # a heading, or words about the camera
            need = "must be a value with its unit"
            remedy = f"write {name[:40]} = number unit, with a decimal point"
            raise refused(path, need, line[:60], where=where, remedy=remedy)
        name = matched["name"].strip().strip('"')
        if name in rows:
            need = "must have each name once"
            found = f"{name[:40]!r} is repeated"
            raise refused(path, need, name[:40], found, where=where, remedy="keep one")
        unit = matched["left"] or (matched["right"] or "").strip(' ;,\t[]"')
        rows[name] = name, float(matched["value"]), unit, where
    return list(rows.values())


def _json_rows(text: str, path: Path) -> list[tuple[str, float, str, str]]:
    rows = []
    for name, entry in json_of(text, str(path)).items():
        if _key(name) is None:
            continue
        number = finite_number(entry.get("value")) if isinstance(entry, dict) else None
        unit = entry.get("unit", "") if isinstance(entry, dict) else ""
        if number is None or not isinstance(unit, str):
            need = 'must be {"value": number, "unit": "..."}, as {"value": 2.4, "unit": "e-"}'
            raise refused(path, need, entry, where=name[:40])
        rows.append((name, number, unit, ""))
    return rows


def _xml_rows(text: str, path: Path) -> list[tuple[str, float, str, str]]:
    """The values of XML: root ``results``, sections, values named by their tags."""
    root = xml_root(text, str(path))
    if root.tag != "results":
        raise refused(path, "must have the root 'results' to be a data sheet", root.tag[:60])
    rows: list[tuple[str, float, str, str]] = []
    for entry in (entry for section in root for entry in section):
        known = _key(entry.tag) is not None and not any(row[0] == entry.tag for row in rows)
        if not known or entry.find("value") is None:
            continue
        unit, word = (entry.findtext(tag, "").strip() for tag in ("unit", "value"))
        unit = _bare_unit("" if unit == "None" else unit)
        if word.lower() in ("nan", "none"):
            continue  # not measured
        if not unit and _key(entry.tag) in ("snr_max", "dynamic_range"):
            unit = "1"
        number = _decimal(word)
        if number is None:
            raise refused(path, "must be a finite number", word[:60], where=entry.tag)
        if number < 0:
            continue  # below 0, as its error allows; the text has such a value in a comment
        if unit == "%":
            number, unit = number.scaleb(-2), "1"
        rows.append((entry.tag, float(number), unit, ""))
    return rows


def _decimal(word: str) -> Decimal | None:
    try:
        number = Decimal(word)
    except InvalidOperation:
        return None
    return number if number.is_finite() and math.isfinite(float(number)) else None


_FORMS = {"{": _json_rows, "<": _xml_rows}
"""Readers by the first character of a sheet."""


def _key(name: str) -> str | None:
    """The key for a name in the sheet; Greek letters, dots, dashes and spaces are normalized."""
    return _KEY_OF.get(_plain(name))


def _plain(name: str) -> str:
    plain = name.lower()
    for letter, word in (("µ", "mu"), ("μ", "mu"), ("σ", "sigma"), ("η", "eta"), ("λ", "lambda")):
        plain = plain.replace(letter, word)
    return re.sub(r"[^a-z0-9]", "", plain)


def _bare_unit(unit: str) -> str:
    r"""A unit without the marks of LaTeX, as the reference code of the standard writes it.

    Examples
    --------
    >>> _bare_unit("$e^-/s$"), _bare_unit(r"\%"), _bare_unit("DN/e-")
    ('e-/s', '%', 'DN/e-')
    """
    return re.sub(r"[$\\^{}]", "", unit).strip()


def _valued(key: str, name: str, number: float, unit: str, where: str) -> _Value:
    allowed = _VALUES[key][1].split()
    if key == "bits" and not unit.strip():
        unit = "bit"
    known = _UNIT_OF.get(_bare_unit(unit).lower())
    if known not in allowed:
        had = f"has the unit {unit[:20]!r}" if unit.strip() else "has no unit"
        raise refused(name, f"must be in {' or '.join(allowed)}", unit, had)
    check.within(name, known, number, 0.0, 1e15)
    if known == "%":
        return _Value(name, number / 100, "1", where)
    if known in ("dB", "bit") and key != "bits":
        check.within(name, known, number, 0.0, 300.0)
        return _Value(name, 10 ** (number / 20) if known == "dB" else 2**number, "1", where)
    if key == "gain" and known == "e-/DN":
        inverse = check.positive(name, known, number)
        return _Value(name, 1 / inverse, "DN/e-", where)
    return _Value(name, number, known, where)


def _pixel_source(found: Mapping[str, _Value], unused: list[str], source: str) -> PixelSource:
    gain = _gain(found, source)
    electrons = {key: _electrons(found.get(key), gain, source) for key in ("read_noise", "dsnu")}
    current = _electrons(found.get("dark_current"), gain, source)
    prnu = found.get("prnu")
    well = found.get("full_well") or found.get("saturation")
    whole, level, adc_notes = _codes(found.get("bits"), found.get("black"), source)
    adc = None
    if gain is not None and whole is not None:
        with errors_within(source):
            adc = Adc(bits=whole, gain_e_per_dn=1 / gain, black_level_dn=level or 0)
    silent = [
        name
        for name, known in (("dark current", current), ("DSNU", electrons["dsnu"]), ("PRNU", prnu))
        if known is None
    ]
    notes = []
    if well is not None and "full_well" not in found:
        notes = [f"{source}: {well.name}, the saturation capacity, is taken for the full well"]
    if gain and adc is None:
        notes.append(
            f"{source}: bits not given: the gain of {1 / gain:.4g} e-/DN sets the quantization "
            "noise, without a top code; pictures take the fewest bits that reach the full well"
        )
    notes += (
        [f"{source}: {', '.join(silent)} not given, taken as 0 unless an option gives them"]
        if silent
        else []
    )
    notes += [f"{source}: not used: {', '.join(n[:40] for n in unused[:8])}"] if unused else []
    return PixelSource(
        source=source,
        pitch_um=_number(found, "pitch"),
        full_well_e=None if well is None else well.number,
        read_noise_e=electrons["read_noise"],
        gain_e_per_dn=1 / gain if gain else None,
        bits=whole,
        black_level_dn=level,
        adc=adc,
        dark_current_e_per_s=current,
        dsnu_e=electrons["dsnu"],
        prnu=prnu.number if prnu else None,
        qe=_number(found, "qe"),
        qe_at_nm=_number(found, "qe_at_nm"),
        notes=(*notes, *adc_notes, *contradictions(_in_electrons(found, gain), source)),
    )


def _number(found: Mapping[str, _Value], key: str) -> float | None:
    return found[key].number if key in found else None


def _gain(found: Mapping[str, _Value], source: str) -> float | None:
    """K. [DN/e-]"""
    for key in ("gain", "gain_inverse"):
        if key in found:
            with errors_within(source, found[key].where):
                number = check.positive(key, found[key].unit, found[key].number)
            return number if key == "gain" else 1 / number
    return None


def _electrons(value: _Value | None, gain: float | None, source: str) -> float | None:
    """The value in electrons (per second); the gain converts codes to electrons."""
    if value is None or value.unit.startswith("e-"):
        return value.number if value else None
    if gain is None:
        need = f"needs the gain where it is in {value.unit}"
        raise refused(source, need, where=value.where, remedy="add K = number DN/e-")
    return value.number / gain


def _codes(
    bits: _Value | None, black: _Value | None, source: str
) -> tuple[int | None, int | None, tuple[str, ...]]:
    """Bits and black level as whole numbers, and notes on how they were obtained."""
    if bits is not None and not float(bits.number).is_integer():
        raise refused(source, "must be a whole number", bits.number, where=bits.where)
    whole = int(bits.number) if bits else None
    if black is None:
        notes = (
            (f"{source}: black level not given, taken as 0 DN unless an option gives it",)
            if bits
            else ()
        )
        return whole, None, notes
    notes = ()
    if not black.number.is_integer():
        notes = (f"{source}: black level of {black.number:g} DN rounded to a whole code",)
    return whole, round(black.number), notes


def _in_electrons(found: Mapping[str, _Value], gain: float | None) -> dict[str, float]:
    """The values that can be checked against each other, in the units of `contradictions`."""
    values = {key: value.number for key, value in found.items()}
    if "full_well" in values:
        values.setdefault("saturation", values["full_well"])
    if gain is not None:
        values["gain"] = gain
    for key in ("read_noise", "dark_noise"):
        if key in found and found[key].unit == "DN":
            del values[key]
            if gain is not None:
                values[key] = found[key].number / gain
    if "threshold" in found and found["threshold"].unit == "p":
        values["photons_threshold"] = values.pop("threshold")
    return values
