"""Reports other than that of a study: characterization, denoising benchmark, demo.

A characterization is one HTML file, or a folder with every form of its noise model. The report of
the benchmark is a folder with one HTML file and its pictures. The page of ``chromanoise demo`` has
verdict, pictures, tables, equations, figures and downloads.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from chromanoise.apps.camera import (
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
from chromanoise.apps.denoising_benchmark import PIXELS_PER_DEGREE, BenchmarkCell, verdict_sentences
from chromanoise.apps.paper import (
    PRINTED_TIMES_MS,
    RGB_12,
    RGBW_12,
    WELL_SHARE,
    Reproduction,
    as_printed,
    luminance_budget,
    paper_tables,
    set_aside_reasons,
    table_5_finding,
    verdict,
)
from chromanoise.base import (
    CHANNELS,
    NEUTRALS,
    InputError,
    __version__,
    channel_color,
    json_text,
    whole_folder,
)
from chromanoise.charts import cause_label, explanation_as_json
from chromanoise.imaging import Picture, png_bytes
from chromanoise.imaging.denoising import DENOISING
from chromanoise.io import number_text
from chromanoise.study import RECONSTRUCTION
from chromanoise.web.report_bundle import (
    data_address,
    environment,
    filled_template,
    with_paper_symbols,
)

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

    Returns
    -------
    str
        Verdict, parameters of each plane with their errors, the curves of EMVA 1288 as SVG, the
        levels, and how frames were grouped.
    """
    from chromanoise.apps.camera import characterization_figures  # matplotlib is slow to import

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
    texts["characterization.json"] = json_text(characterization_as_json(noted), indent=1)
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
    """A sentence for each file that `write_characterization` does not write, with the reason."""
    return _optional_files(result)[1]


def _optional_files(result: Characterization) -> tuple[dict[str, str], list[str]]:
    """The files whose values are known, and a sentence for each of the others."""
    makers: dict[str, Callable[[Characterization], str]] = {
        "noise_profile.json": lambda one: json_text(noise_profile_json(one), indent=1),
        "noise_profile.txt": noise_profile_line,
        "darktable.json": lambda one: json_text(darktable_json(one), indent=1),
        "libcamera.json": lambda one: json_text(libcamera_json(one), indent=1),
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


def _inline_svg(figure: Any, name: str, title: str) -> str:
    """A figure as SVG inside HTML, in the colors of the page, with ids of its own."""
    from chromanoise.charts import figure_bytes

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


Value = Callable[[BenchmarkCell], float | None]

_COLUMNS: tuple[tuple[str, str, Value, int, int], ...] = (  # name, unit, value, digits, best is
    ("CIEDE2000", "mean", lambda cell: cell.quality.ciede2000_mean, 2, -1),
    ("CIEDE2000", "95th percentile", lambda cell: cell.quality.ciede2000_p95, 2, -1),
    ("S-CIELAB", "mean", lambda cell: cell.quality.scielab_mean, 2, -1),
    ("CIEDE2000", "from true colors", lambda cell: cell.true_ciede2000_mean, 2, -1),
    ("false color at edges", "Delta C", lambda cell: _false_color(cell), 2, -1),
    ("PSNR", "dB", lambda cell: cell.quality.psnr_db, 2, 1),
    ("SSIM", "", lambda cell: cell.quality.ssim, 3, 1),
    ("SNR of Y with lost detail", "dB", lambda cell: cell.snr_y_db, 1, 1),
    ("SNR of Y on flats", "dB", lambda cell: _flat_snr_db(cell), 1, 1),
    ("edge rise", "px", lambda cell: cell.rise_px, 2, 0),
    ("time", "s", lambda cell: cell.seconds, 3, 0),
)
"""Best is -1 for the least value, 1 for the largest, and 0 where none is marked."""


def write_denoising_report(cells: Sequence[BenchmarkCell], folder: Path) -> Path:
    """Write ``index.html`` and a PNG of each picture into a folder, as a whole or not at all.

    Parameters
    ----------
    folder
        Made if it does not exist; files of the same names are replaced, others stay.

    Returns
    -------
    Path
        The HTML file.

    Raises
    ------
    InputError
        If there is no cell, or the folder cannot be written.
    """
    if not cells:
        raise InputError("cells", "must hold at least one cell", value=0)
    places: dict[tuple[str, str, float], list[BenchmarkCell]] = {}
    for cell in cells:
        places.setdefault(cell.place, []).append(cell)
    with whole_folder(folder, "denoise-bench") as target:
        shown = []
        for number, (place, here) in enumerate(places.items(), 1):
            stem = f"{number:03d}"
            (target / f"{stem}-reference.png").write_bytes(png_bytes(here[0].reference_srgb))
            for cell, name in zip(here, _names(here), strict=True):
                (target / _file(stem, name)).write_bytes(png_bytes(cell.srgb))
            shown.append(_shown(place, here, stem))
        (target / "index.html").write_text(_page(shown, cells), "utf-8")
    return folder / "index.html"


def _page(shown: list[dict[str, object]], cells: Sequence[BenchmarkCell]) -> str:
    used = dict.fromkeys(cell.method for cell in cells)
    return filled_template(
        "denoising.html.j2",
        verdicts=verdict_sentences(cells),
        methods=[(name, DENOISING[name].what, DENOISING[name].baseline) for name in used],
        columns=[(name, unit) for name, unit, _, _, _ in _COLUMNS],
        conditions=_conditions(cells),
        places=shown,
        pixels_per_degree=f"{PIXELS_PER_DEGREE:g}",
    )


def _conditions(cells: Sequence[BenchmarkCell]) -> str:
    """Exposure, light and seed in a sentence."""
    settings = [cell.settings for cell in cells]
    times = sorted({f"{one['time_ms']:.4g}" for one in settings}, key=float)
    seeds = sorted({str(cell.seed) for cell in cells}, key=int)
    first = settings[0]
    return (
        f"Illuminant {first['illuminant']}, f/{first['f_number']:g}, {' or '.join(times)} ms, "
        f"{first['matrix']} matrix, read noise {first['read_noise_e']:g} e-, noise seed "
        f"{', '.join(seeds)}."
    )


def _shown(
    place: tuple[str, str, float], cells: Sequence[BenchmarkCell], stem: str
) -> dict[str, object]:
    """What the page shows of one scene, sensor and light."""
    scene, sensor, lux = place
    height, width, _ = cells[0].reference_srgb.shape
    return {
        "heading": f"{scene.removeprefix('builtin:')}, {sensor}, {lux:g} lx",
        "width": width,
        "height": height,
        "pictures": [
            ("without noise", f"{stem}-reference.png"),
            *((name, _file(stem, name)) for name in _names(cells)),
        ],
        "rows": _rows(cells),
    }


def _rows(cells: Sequence[BenchmarkCell]) -> list[tuple[str, list[tuple[str, bool]]]]:
    """Per method its name, and of each column the text and whether it is the best."""
    texts = []
    for _, _, value, digits, better in _COLUMNS:
        found = [value(cell) for cell in cells]
        known = [one * better for one in found if one is not None]
        is_best = [one is not None and better != 0 and one * better == max(known) for one in found]
        texts.append(list(zip([_text(one, digits) for one in found], is_best, strict=True)))
    return [(name, [column[i] for column in texts]) for i, name in enumerate(_names(cells))]


def _flat_snr_db(cell: BenchmarkCell) -> float | None:
    """SNR of Y on the flat regions, if the scene has some. [dB]"""
    return None if cell.flats is None else cell.flats.snr_y_db


def _false_color(cell: BenchmarkCell) -> float | None:
    """Mean error of chroma near edges."""
    return None if cell.quality.false_color is None else cell.quality.false_color.near_edges


def _names(cells: Sequence[BenchmarkCell]) -> list[str]:
    """The methods, with the seed where there are several."""
    several = len({cell.seed for cell in cells}) > 1
    return [f"{cell.method}, seed {cell.seed}" if several else cell.method for cell in cells]


def _file(stem: str, name: str) -> str:
    """Name of the picture of a cell."""
    return f"{stem}-{name.replace(', ', '-').replace(' ', '-')}.png"


def _text(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f}"


_EXPLAINED = ("electrons", "raw", "contravariant", "spectral", "color", "bound", "budget")
_GROUPS = {  # of downloads, in their order: heading, and the files by their endings
    "Pages": (".html",),
    "Tables as data": (".json", ".csv"),
    "Figures and pictures": (".svg", ".pdf", ".png"),
}


def demo_page(
    result: Reproduction,
    pictures: tuple[Picture, Picture],
    figures: Mapping[str, str],
    captions: Mapping[str, str],
    files: Sequence[Path] = (),
) -> str:
    """The page as self-contained HTML, without network access.

    Parameters
    ----------
    result
        The tables and the study behind them.
    pictures
        The same scene through both sensors.
    figures, captions
        SVG text and one sentence per figure, by the figure's name.
    files
        The files beside the page, which it offers to download.
    """
    made = environment()
    made.filters["symbols"] = with_paper_symbols
    made.filters["db"] = lambda value: number_text(value).replace("-", "\N{MINUS SIGN}")
    made.filters["printed"] = as_printed
    made.filters["cause"] = lambda cause: cause_label(cause, "Y")
    return made.get_template("demo.html.j2").render(
        version=__version__,
        mark=channel_color("B"),
        result=result,
        verdict=verdict(result.study),
        table_5=table_5_finding(result.study),
        set_aside=set_aside_reasons(result.study),
        note=RECONSTRUCTION,
        well_percent=100 * WELL_SHARE,
        times=[
            (name, printed, 1e3 * result.study.times_s[name])
            for name, printed in PRINTED_TIMES_MS.items()
        ],
        tables=paper_tables(result),
        budgets=[
            (column, luminance_budget(result.study.columns[column])) for column in (RGBW_12, RGB_12)
        ],
        explanations=[(name, explanation_as_json(name)) for name in _EXPLAINED],
        downloads=_downloads(files),
        pictures=[
            (picture, data_address(png_bytes(picture.srgb), "image/png")) for picture in pictures
        ],
        figures=[
            (
                name,
                data_address(svg.encode(), "image/svg+xml"),
                f"{_numbered(name)} {captions[name]}",
            )
            for name, svg in figures.items()
        ],
    )


def _numbered(name: str) -> str:
    """Figure 3. of figure-03-measurement."""
    return f"Figure {int(name.split('-')[1])}."


def _downloads(files: Sequence[Path]) -> list[tuple[str, list[tuple[str, list[tuple[str, str]]]]]]:
    """Files by group and name: under each name its address and size in each format."""
    groups = []
    for heading, endings in _GROUPS.items():
        named: dict[str, list[tuple[str, str]]] = {}
        for file in sorted(files):
            if file.suffix in endings:
                named.setdefault(file.stem, []).append((file.name, _size(file.stat().st_size)))
        if named:
            groups.append((heading, list(named.items())))
    return groups


def _size(count: int) -> str:
    """A number of bytes.

    Examples
    --------
    >>> _size(20), _size(20480), _size(2_500_000)
    ('1 kB', '20 kB', '2.5 MB')
    """
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{max(1, round(count / 1e3))} kB"
