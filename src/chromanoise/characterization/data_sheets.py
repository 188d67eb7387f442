"""Data sheets of EMVA 1288 for one plane: text, XML, and the table of the photon transfer."""

import math
from dataclasses import dataclass
from decimal import Decimal
from xml.etree import ElementTree

from chromanoise.characterization.planes import dynamic_range_db, threshold_e
from chromanoise.characterization.results import Characterization, LevelNoise, PlaneNoise

STANDARD = "EMVA Standard 1288, Release 4.0 Linear"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Row:
    """A value of the sheet: its name in text, its section and names in XML, value and error."""

    name: str
    section: str
    tag: str
    short: str
    symbol: str
    unit: str
    value: float
    error: float | None = None
    percent: bool = False


def emva_sheet(result: Characterization, plane: PlaneNoise) -> str:
    """The data sheet of one plane as text, a value with its unit per line, with all digits.

    Parameters
    ----------
    result
        The characterization that the plane belongs to.
    plane
        The plane.

    Notes
    -----
    EMVA Standard 1288, Release 4.0 Linear (2021), chapters 2 and 10: u_e.min = sqrt(sigma_d^2 +
    1 / (12 K^2)) + 1/2, SNR_max = sqrt(u_e.sat), DR = u_e.sat / u_e.min, photons = electrons / QE;
    u_e.sat = QE u_p.sat is the saturation capacity, at the largest variance. The full well, of a
    level above saturation, is an addition. `chromanoise.io.pixels.read_emva_sheet` reads it; ``#``
    starts a comment. Values that are not known are left out; ratios have the unit 1.
    """
    lines = [f"# {STANDARD}", *_heading(result, plane)]
    for row in _rows(result, plane):
        below = "# below 0, as its error allows: " if row.value < 0 else ""
        error = "" if row.error is None else f"  # +- {row.error:.2g}"
        lines.append(f"{below}{row.name} = {_digits(row.value)} {row.unit}{error}")
    return "\n".join([*lines, ""])


def emva_sheet_xml(result: Characterization, plane: PlaneNoise) -> str:
    """The data sheet of one plane as XML, in the form of the reference code of the standard.

    Parameters
    ----------
    result
        The characterization that the plane belongs to.
    plane
        The plane.

    Notes
    -----
    The standard defines no XML. The form is that of ``Results1288.xml`` in the package emva1288
    1.0.2 (https://github.com/EMVA1288/emva1288): the root ``results`` holds sections, each section
    quantities by the names of that package, and each quantity ``short``, ``symbol``, ``unit`` and
    ``value``; QE and PRNU are in %. ``standard_error``, ``full_well``, the section ``converter``
    and the attributes of the root are additions; readers of that form ignore them.
    `chromanoise.io.pixels.read_emva_sheet` reads it with all digits.
    """
    facts = {"standard": STANDARD, "camera": result.camera, "plane": plane.name}
    facts |= {} if result.iso is None else {"iso": f"{result.iso:g}"}
    root = ElementTree.Element("results", {key: _printable(value) for key, value in facts.items()})
    sections: dict[str, ElementTree.Element] = {}
    for row in _rows(result, plane):
        if row.section not in sections:
            sections[row.section] = ElementTree.SubElement(root, row.section)
        entry = ElementTree.SubElement(sections[row.section], row.tag)
        shift = 2 if row.percent else 0
        for tag, text in (
            ("short", row.short),
            ("symbol", row.symbol),
            ("unit", "%" if row.percent else row.unit),
            ("value", _digits(row.value, shift)),
        ):
            ElementTree.SubElement(entry, tag).text = text
        if row.error is not None:
            ElementTree.SubElement(entry, "standard_error").text = _digits(row.error, shift)
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def photon_transfer_csv(plane: PlaneNoise) -> str:
    """The levels of one plane as a table that `read_photon_transfer_csv` reads to the last digit.

    Parameters
    ----------
    plane
        The plane.

    Notes
    -----
    Columns: ``mean_dn``, ``variance_dn2``; ``samples``, the number of samples that gives the stated
    standard error, n = 1 + 2 (variance / error)^2; ``time_ms`` and ``photons_per_pixel`` where all
    levels have them; ``dark_mean_dn`` and ``dark_variance_dn2`` where all levels have darks.
    """
    levels = plane.levels
    columns: dict[str, list[float | None]] = {
        "mean_dn": [level.mean_dn for level in levels],
        "variance_dn2": [level.variance_dn2 for level in levels],
        "samples": [_samples(level) for level in levels],
        "time_ms": [level.time_ms for level in levels],
        "photons_per_pixel": [level.photons_per_pixel for level in levels],
        "dark_mean_dn": [level.dark_mean_dn for level in levels],
        "dark_variance_dn2": [level.dark_variance_dn2 for level in levels],
    }
    dark = columns["dark_mean_dn"], columns["dark_variance_dn2"]
    if any(None in column for column in dark):
        columns.pop("dark_mean_dn"), columns.pop("dark_variance_dn2")
    known = {
        name: [value for value in column if value is not None] for name, column in columns.items()
    }
    full = {name: column for name, column in known.items() if len(column) == len(levels)}
    rows = zip(*full.values(), strict=True)
    lines = [",".join(full), *(",".join(_digits(value) for value in row) for row in rows)]
    return "\n".join([*lines, ""])


def _samples(level: LevelNoise) -> float | None:
    """Samples that give the standard error of the variance; ``None`` without an error. [1]"""
    if not level.variance_se_dn2 > 0 or not level.variance_dn2 > 0:
        return None
    samples = 1 + 2 * (level.variance_dn2 / level.variance_se_dn2) ** 2
    return samples if 2 <= samples <= 1e12 else None


def _heading(result: Characterization, plane: PlaneNoise) -> list[str]:
    lines = [f"# camera: {_printable(result.camera) or 'not known'}", f"# plane: {plane.name}"]
    lines += [] if result.iso is None else [f"# ISO: {result.iso:g}"]
    holds = "holds" if result.verdict.holds else "does not hold"
    return [*lines, f"# The linear camera model {holds}."]


def _rows(result: Characterization, plane: PlaneNoise) -> list[_Row]:
    """The values of the summary sheet that are known."""
    gain, dark, well = plane.gain_dn_per_e, plane.dark_noise_e, plane.saturation_capacity_e
    least, dark_dn2 = threshold_e(gain, dark), plane.dark_variance_dn2
    values: dict[str, tuple[float | None, float | None]] = {
        "QE": (plane.qe, plane.qe_se),
        "K": (gain, plane.gain_dn_per_e_se),
        "sigma_d": (dark, plane.dark_noise_e_se),
        "sigma_y_dark": (None if dark_dn2 is None else math.sqrt(dark_dn2), None),
        "u_e_sat": (well, None),
        "full_well": (plane.full_well_e, plane.full_well_e_se),
        "u_e_min": (least, None),
        "u_p_sat": (_photons(well, plane.qe), None),
        "u_p_min": (_photons(least, plane.qe), None),
        "SNR_max_dB": (10 * math.log10(well) if well and well > 0 else None, None),
        "DR_dB": (dynamic_range_db(well, least), None),
        "DSNU1288": (plane.dsnu_e, plane.dsnu_e_se),
        "PRNU1288": (plane.prnu, plane.prnu_se),
        "LE": (plane.linearity_error_percent, None),
        "u_I_mean": (plane.dark_current_e_per_s, plane.dark_current_e_per_s_se),
        "black_level": (plane.black_level_dn, plane.black_level_dn_se),
        "bits": (result.bits, None),
    }
    return [
        _Row(
            name=name,
            section=section,
            tag=tag,
            short=short,
            symbol=symbol,
            unit=unit,
            value=value,
            error=error,
            percent=tag in ("QE", "PRNU1288"),
        )
        for section, tag, name, symbol, unit, short in _FORM
        for value, error in (values[tag],)
        if value is not None and math.isfinite(value)
    ]


_FORM = (  # section and name in XML, name in text, symbol, unit, meaning
    ("sensitivity", "QE", "QE", "eta", "1", "Quantum efficiency"),
    ("sensitivity", "K", "K", "K", "DN/e-", "System gain"),
    ("sensitivity", "sigma_d", "sigma_d", "sigma_d", "e-", "Temporal dark noise"),
    ("sensitivity", "sigma_y_dark", "sigma_y.dark", "sigma_y.dark", "DN", "Temporal dark noise"),
    ("sensitivity", "u_e_sat", "mu_e.sat", "mu_e.sat", "e-", "Saturation capacity"),
    ("sensitivity", "full_well", "full well", "full well", "e-", "Electrons of a saturated level"),
    ("sensitivity", "u_e_min", "mu_e.min", "mu_e.min", "e-", "Absolute sensitivity threshold"),
    ("sensitivity", "u_p_sat", "mu_p.sat", "mu_p.sat", "p", "Saturation capacity"),
    ("sensitivity", "u_p_min", "mu_p.min", "mu_p.min", "p", "Absolute sensitivity threshold"),
    ("sensitivity", "SNR_max_dB", "SNR_max", "SNR_max.dB", "dB", "Maximum signal-to-noise ratio"),
    ("sensitivity", "DR_dB", "DR", "DR.dB", "dB", "Dynamic range"),
    ("spatial", "DSNU1288", "DSNU1288", "DSNU_1288", "e-", "Dark signal non-uniformity"),
    ("spatial", "PRNU1288", "PRNU1288", "PRNU_1288", "1", "Photo response non-uniformity"),
    ("linearity", "LE", "LE", "LE", "%", "Largest linearity error"),
    ("dark_current", "u_I_mean", "mu_I.mean", "mu_I.mean", "e-/s", "Dark current from mean"),
    ("converter", "black_level", "black level", "mu_y.dark", "DN", "Black level"),
    ("converter", "bits", "bits", "bits", "bit", "Bits of the converter"),
)


def _photons(electrons: float | None, qe: float | None) -> float | None:
    return electrons / qe if electrons is not None and qe else None


def _digits(value: float, shift: int = 0) -> str:
    """All digits of a number, times 10^shift without rounding, so that it is read back exactly."""
    if isinstance(value, int):
        return str(value)
    return str(Decimal(repr(float(value))).scaleb(shift)) if shift else repr(float(value))


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else "?" for letter in text)
