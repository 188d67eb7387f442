"""Report of the denoising benchmark: a folder with one HTML file and its pictures."""

from collections.abc import Sequence
from pathlib import Path

from chromanoise._files import whole_folder
from chromanoise.denoising import DENOISING, BenchmarkCell, verdict_sentences
from chromanoise.errors import InputError
from chromanoise.imaging import png_bytes
from chromanoise.report.templates import filled_template

_COLUMNS = (
    ("CIEDE2000", "mean", lambda cell: cell.quality.ciede2000_mean, 2),
    ("CIEDE2000", "95th percentile", lambda cell: cell.quality.ciede2000_p95, 2),
    ("S-CIELAB", "mean", lambda cell: cell.quality.scielab_mean, 2),
    ("CIEDE2000 from true colors", "mean", lambda cell: cell.true_ciede2000_mean, 2),
    ("PSNR", "dB", lambda cell: cell.quality.psnr_db, 2),
    ("SSIM", "", lambda cell: cell.quality.ssim, 3),
    ("SNR of Y", "dB, lost detail as noise", lambda cell: cell.snr_y_db, 1),
    (
        "SNR of Y, flat regions",
        "dB",
        lambda cell: None if cell.flats is None else cell.flats.snr_y_db,
        1,
    ),
    ("rise of luminance edges", "px, 10 to 90 %", lambda cell: _rise_px(cell), 2),
    ("time", "s", lambda cell: cell.seconds, 2),
)


def write_denoising_report(cells: Sequence[BenchmarkCell], folder: Path) -> Path:
    """Write ``index.html`` and a PNG of each picture into a folder, as a whole or not at all.

    Parameters
    ----------
    cells
        Result of `chromanoise.study.denoising_benchmark`.
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
    with whole_folder(folder) as target:
        shown = []
        for number, (place, here) in enumerate(places.items(), 1):
            stem = f"{number:03d}"
            (target / f"{stem}-reference.png").write_bytes(png_bytes(here[0].reference_srgb))
            for cell in here:
                (target / f"{stem}-{cell.method}.png").write_bytes(png_bytes(cell.srgb))
            shown.append(_shown(place, here, stem))
        (target / "index.html").write_text(_page(shown, cells), "utf-8")
    return folder / "index.html"


def _page(shown: list[dict[str, object]], cells: Sequence[BenchmarkCell]) -> str:
    used = dict.fromkeys(cell.method for cell in cells)
    return filled_template(
        "denoising.html.j2",
        verdicts=verdict_sentences(cells),
        methods=[(name, DENOISING[name].what) for name in used],
        columns=[(name, unit) for name, unit, _, _ in _COLUMNS],
        places=shown,
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
            *((cell.method, f"{stem}-{cell.method}.png") for cell in cells),
        ],
        "rows": [
            (cell.method, [_text(of(cell), digits) for _, _, of, digits in _COLUMNS])
            for cell in cells
        ],
    }


def _rise_px(cell: BenchmarkCell) -> float | None:
    """Mean rise distance of the luminance edges. [px]"""
    rises = [
        edge.rise_px
        for name, edge in cell.edges.items()
        if edge is not None and name.startswith("luminance")
    ]
    return sum(rises) / len(rises) if rises else None


def _text(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f}"
