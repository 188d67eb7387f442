"""A characterization as one HTML file, and as a folder with every form of its noise model."""

import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from chromanoise import __version__
from chromanoise._files import whole_folder
from chromanoise._palette import CHANNELS, NEUTRALS
from chromanoise.characterization import (
    QUANTITIES,
    SPREADS,
    Characterization,
    LevelNoise,
    PlaneNoise,
    characterization_as_json,
    darktable_json,
    emva_sheet,
    emva_sheet_xml,
    libcamera_json,
    noise_profile_json,
    noise_profile_line,
    photon_transfer_csv,
    pixel_toml,
)
from chromanoise.errors import InputError
from chromanoise.report.bundle import filled_template

_CHARTS = {
    "photon_transfer": (
        "Photon transfer",
        "Temporal variance against the signal. The slope of the line is the gain K; open symbols "
        "are levels above 70 % of saturation, which were not fitted.",
    ),
    "snr": (
        "Signal-to-noise ratio",
        "Points: measured. Line: linear model. Dashed: shot noise only, the limit of any camera.",
    ),
    "linearity": ("Linearity", "Signal against light, with the fitted line."),
    "linearity_deviation": (
        "Deviation from linearity",
        "Relative deviation from the fitted line, at the levels from 5 to 95 % of saturation.",
    ),
    "predicted_variance": (
        "Predicted and measured variance",
        "At each level: K times the signal plus the dark variance, against the measured variance.",
    ),
    "variance_residuals": (
        "Residuals of the variance",
        "Measured minus predicted, in standard errors. 99.7 % of the points of a linear camera lie "
        "in the band.",
    ),
}
_INK_OF = {
    **{pair[0].lower(): f"var(--{name})" for name, pair in NEUTRALS.items()},
    **{pair[0].lower(): f"var(--channel-{name})" for name, pair in CHANNELS.items()},
}
_OWN_FILES = re.compile(
    r"(noise_profile|darktable|libcamera)\.json|noise_profile\.txt"
    r"|(data_sheet|photon_transfer)_.+\.(txt|xml|csv)"
)


def characterization_report(result: Characterization) -> str:
    """The report as self-contained HTML, without network access.

    Parameters
    ----------
    result
        A characterization.

    Returns
    -------
    str
        Verdict, parameters of each plane with their errors, the curves of EMVA 1288 as SVG, the
        levels, and how frames were grouped.
    """
    from chromanoise.figures import characterization_figures  # matplotlib is slow to import

    charts = [
        {"name": name, "heading": _CHARTS[name][0], "shows": _CHARTS[name][1], "svg": svg}
        for name, figure in characterization_figures(result).items()
        for svg in (_inline_svg(figure, name, _CHARTS[name][0]),)
    ]
    return filled_template(
        "characterization.html.j2",
        title=result.camera or result.source,
        facts=_facts(result),
        verdict=result.verdict,
        summary=_summary(result),
        planes=[plane.name for plane in result.planes],
        parameters=_table(result.planes, patterns=False),
        patterns=_table(result.planes, patterns=True),
        charts=charts,
        correlation=[[_number(v, 3) for v in row] for row in result.correlation.tolist()],
        levels=[(plane.name, [_level(one) for one in plane.levels]) for plane in result.planes],
        notes=[*result.notes, *_fit_notes(result.planes)],
    )


def write_characterization(result: Characterization, folder: Path | str) -> tuple[Path, ...]:
    """Write every form of the noise model into a folder, which appears as a whole or not at all.

    Parameters
    ----------
    result
        A characterization.
    folder
        Made if it does not exist; other files in it stay.

    Returns
    -------
    tuple of Path
        The written files: ``pixel.toml``, ``characterization.json``, ``report.html``; of each
        plane ``data_sheet_NAME.txt``, ``data_sheet_NAME.xml`` and ``photon_transfer_NAME.csv``; and
        ``noise_profile.json``, ``noise_profile.txt``, ``darktable.json`` and ``libcamera.json``, if
        the values that they need are known. The notes in the JSON and in the report name those that
        were not written, with the reason.

    Raises
    ------
    InputError
        If the folder is a file, cannot be written, is being written by another process, or holds a
        file of another characterization that this one does not replace; also as `pixel_of`.
    """
    folder = Path(folder)
    texts, missing = _optional_files(result)
    for plane, name in zip(result.planes, file_names(result.planes), strict=True):
        texts[f"data_sheet_{name}.txt"] = emva_sheet(result, plane)
        texts[f"data_sheet_{name}.xml"] = emva_sheet_xml(result, plane)
        texts[f"photon_transfer_{name}.csv"] = photon_transfer_csv(plane)
    noted = replace(result, notes=(*result.notes, *missing))
    texts["pixel.toml"] = pixel_toml(result)
    texts["characterization.json"] = _json(characterization_as_json(noted))
    texts["report.html"] = characterization_report(noted)
    with whole_folder(folder, "characterize") as scratch:
        _refuse_left_over(folder, texts)
        for name, text in texts.items():
            (scratch / name).write_bytes(text.encode("utf-8", "replace"))
    return tuple(folder / name for name in sorted(texts))


def file_names(planes: Sequence[PlaneNoise]) -> tuple[str, ...]:
    """A part of a file name for each plane: its name where that is safe and not taken yet.

    Parameters
    ----------
    planes
        Planes of a characterization.
    """
    names: list[str] = []
    for i, plane in enumerate(planes):
        name = re.sub(r"[^A-Za-z0-9_-]", "_", plane.name)[:40] or "plane"
        taken = {other.casefold() for other in names}
        names.append(f"{name}_{i}" if name.casefold() in taken else name)
    return tuple(names)


def omitted_files(result: Characterization) -> list[str]:
    """A sentence for each file that `write_characterization` does not write, with the reason.

    Parameters
    ----------
    result
        A characterization.
    """
    return _optional_files(result)[1]


def _optional_files(result: Characterization) -> tuple[dict[str, str], list[str]]:
    """The files whose values are known, and a sentence for each of the others."""
    makers: dict[str, Callable[[Characterization], str]] = {
        "noise_profile.json": lambda one: _json(noise_profile_json(one)),
        "noise_profile.txt": noise_profile_line,
        "darktable.json": lambda one: _json(darktable_json(one)),
        "libcamera.json": lambda one: _json(libcamera_json(one)),
    }
    texts, missing = {}, []
    for name, maker in makers.items():
        try:
            texts[name] = maker(result)
        except InputError as error:
            missing.append(f"{name} is not written: {error}")
    return texts, missing


def _refuse_left_over(folder: Path, texts: Mapping[str, str]) -> None:
    there = folder.iterdir() if folder.is_dir() else ()
    left = sorted(p.name for p in there if _OWN_FILES.fullmatch(p.name) and p.name not in texts)
    if left:
        raise InputError(
            str(folder),
            "must not mix two characterizations",
            value=left[0],
            found=f"holds {', '.join(left[:5])}, which this characterization does not replace",
            remedy=("remove these files", "name another folder"),
        )


def _json(data: Mapping[str, Any]) -> str:
    return json.dumps(data, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def _inline_svg(figure: Any, name: str, title: str) -> str:
    """A figure as SVG inside HTML, in the colors of the page, with ids of its own."""
    from chromanoise.figures.writing import figure_bytes

    for part in (figure.patch, *(ax.patch for ax in figure.axes)):
        part.set_visible(False)
    text = figure_bytes(figure, "svg").decode("utf-8")
    text = re.sub(r"<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.S)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'(url\(#|href="#)', rf"\1{name}-", text)
    for color, variable in _INK_OF.items():
        text = text.replace(color, variable)
    head = f'<svg role="img" aria-label="{title}" '
    return re.sub(r"<svg ", head, re.sub(r' (width|height)="[\d.]+pt"', "", text, count=2), count=1)


_PATTERNS = (*SPREADS, "hot_pixels")


def _table(planes: Sequence[PlaneNoise], *, patterns: bool) -> list[tuple[str, str, list[str]]]:
    """Name, unit and values of the fixed patterns, or of all other quantities."""
    return [
        (
            f"{one.name[0].upper()}{one.name[1:]}",
            one.shown_unit.replace("e-", "e⁻"),
            [_measured(*one.shown(plane)) for plane in planes],
        )
        for one in QUANTITIES
        if (one.field in _PATTERNS) == patterns
    ]


def _measured(value: float | None, error: float | None) -> str:
    """A value with its error, to two digits of the error; four digits without one."""
    if value is None or not math.isfinite(value):
        return "–"
    if error is None or not math.isfinite(error) or error <= 0:
        return _plain_number(value)
    decimals = max(0, 1 - math.floor(math.log10(error)))
    if decimals > 12:
        return _plain_number(value)
    return f"{value:.{decimals}f} ± {error:.{decimals}f}".replace("-", "\N{MINUS SIGN}")


def _plain_number(value: float) -> str:
    if abs(value) < 1e4:
        return _number(value, 4)
    return f"{value:.0f}".replace("-", "\N{MINUS SIGN}")


def _fit_notes(planes: Sequence[PlaneNoise]) -> list[str]:
    """The notes of the photon transfer fits, with the name of the plane."""
    return [f"plane {plane.name}: {note}" for plane in planes for note in plane.fit.notes]


def _number(value: float | None, digits: int) -> str:
    if value is None or not math.isfinite(value):
        return "–"
    return f"{value:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def _level(level: LevelNoise) -> list[str]:
    values = (level.mean_dn, level.variance_dn2, level.variance_se_dn2)
    shown = [_number(one, 6) for one in (*values[:2], level.predicted_variance_dn2)]
    shown.insert(2, _number(values[2], 2))
    light = [_number(level.time_ms, 5), _number(level.photons_per_pixel, 5)]
    more = [_number(100 * level.clipped_share, 2), _number(level.correlation_right, 2)]
    more += [_number(level.correlation_down, 2), _number(level.drift_z, 2)]
    return [level.name, str(level.frames), *light, *shown, "yes" if level.fitted else "no", *more]


def _facts(result: Characterization) -> str:
    facts = [result.source]
    facts += [] if result.iso is None else [f"ISO {result.iso:g}"]
    facts += [] if result.bits is None else [f"{result.bits} bits"]
    if result.mosaic is not None:
        facts.append("mosaic " + " / ".join(" ".join(row) for row in result.mosaic.pattern))
    return " · ".join([*facts, f"chromanoise {__version__}"])


def _summary(result: Characterization) -> str:
    verdict = result.verdict
    return (
        f"Chi-square of the variance against the linear model: "
        f"{_number(verdict.chi2_per_level, 3)} per level. "
        f"Largest deviation: {_number(verdict.worst_z, 3)} standard errors, at "
        f"{verdict.worst_level}."
    )
