"""Report of the denoising benchmark: a folder with one HTML file and its pictures."""

from collections.abc import Callable, Sequence
from pathlib import Path

from chromanoise._files import whole_folder
from chromanoise.denoising import DENOISING, BenchmarkCell, verdict_sentences
from chromanoise.denoising.benchmark import PIXELS_PER_DEGREE
from chromanoise.errors import InputError
from chromanoise.imaging import png_bytes
from chromanoise.report.bundle import filled_template

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
    cells
        Result of `chromanoise.study.denoising_cells.denoising_benchmark`.
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
