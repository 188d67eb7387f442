"""``chromanoise simulate``."""

import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from chromanoise.base import __version__, claimed_folder, refuse_unwritable
from chromanoise.cli.options import (
    WHOLE,
    command,
    copy_option,
    matrix_option,
    notes_option,
    out_option,
    own_option,
    threads_option,
    with_settings,
)
from chromanoise.cli.output import leave_if_copied, progress_of, short_note, write_json
from chromanoise.imaging import Work, any_picture, cluster, is_held
from chromanoise.noise import conditions
from chromanoise.spectra import row_source
from chromanoise.study import (
    Study,
    TakenPicture,
    makers_of,
    operating_points_of,
    prepared_cameras,
    refuse_other_pictures,
    study_as_json,
    study_of,
    taken_pictures,
)


@command()
@with_settings("render")
@click.argument("cube", metavar="CUBE")
@own_option(
    "--sensor",
    "sensors",
    heading="Sensor",
    multiple=True,
    required=True,
    help="A name of `chromanoise catalog sensors`, or a file; repeatable.",
)
@matrix_option
@threads_option
@own_option(
    "--tile",
    type=WHOLE,
    common=False,
    help="Rows in memory at a time. [default: 8 MB to 1 GB]",
)
@own_option(
    "--scheduler",
    common=False,
    metavar="ADDRESS|local",
    help="Compute on a dask cluster; the result is bit-identical.",
)
@out_option("Folder for the pictures and summary.json.", default="out/simulate")
@notes_option
@copy_option
def simulate(
    cube: str,
    sensors: tuple[str, ...],
    matrix: str,
    out: Path,
    threads: int | None,
    tile: int | None,
    scheduler: str | None,
    whole_notes: bool,
    copy_as: str | None,
    **settings: Any,
) -> None:
    """Render a noisy picture of CUBE with each sensor: raw codes of a mosaic, color, or both.

    CUBE is a name of `chromanoise catalog scenes`, e.g. builtin:checker, or a hyperspectral
    reflectance cube: ENVI (.hdr or its data file), MAT, HDF5, NetCDF, Zarr, multi-page TIFF, a
    folder of one PNG per band, NPZ or NPY. It may be larger than memory. The same arguments give
    the same pictures on any number of threads, tiles or machines. A folder with pictures of other
    arguments is refused.
    """
    study = study_of("render", sensors, settings, matrices=[matrix], cube=cube)
    leave_if_copied(copy_as, study)
    refuse_unwritable(out)
    refuse_other_pictures(study, out)
    work = Work(threads=threads, tile_rows=tile)
    sentence, lines = _taken(study, work, out, scheduler)
    click.echo(sentence)
    for line, notes in lines:
        click.echo(line)
        for note in notes:
            click.echo(note if whole_notes else short_note(note), err=True)


def _taken(
    study: Study, work: Work, out: Path, scheduler: str | None
) -> tuple[str, list[tuple[str, list[str]]]]:
    """Take and write the pictures: a sentence on all, and for each a line and its notes."""
    points = operating_points_of(study)
    makers = makers_of(study)
    cube, cameras = prepared_cameras(study, 0, points, makers)
    frames = study.pictures[0].frames
    rows = row_source(cube.stored).shape[0] * frames * len(points)
    summaries: list[dict[str, Any]] = []
    lines: list[tuple[str, list[str]]] = []
    with ExitStack() as stack:
        claimed = stack.enter_context(claimed_folder(out, "simulate"))
        folder = stack.enter_context(claimed.scratch())
        if scheduler:
            executor = stack.enter_context(cluster(scheduler, workers=work.threads))
            work = replace(work, executor=executor, same_machine=scheduler == "local")
        advance = stack.enter_context(progress_of("the pictures", rows, "rows"))
        start = time.perf_counter()
        work = replace(work, progress=advance)
        for taken in taken_pictures(
            study, 0, cube, cameras, work=work, folder=folder, stem="{sensor}"
        ):
            claimed.refuse_taken(taken.files)
            # only the seconds differ between runs
            seconds, start = time.perf_counter() - start, time.perf_counter()
            summaries.append(taken.record | {"seconds": seconds})
            lines.append((_line(taken, out), _notes(taken)))
            del taken  # before the next one needs memory
        summary = {
            "version": __version__,
            "study": study_as_json(study),
            "cube": study.pictures[0].cube,
            "pictures": summaries,
        }
        write_json(summary, str(folder / "summary.json"))
    click.echo(f"at {conditions(points)}", err=True)
    return _sentence(summaries), lines


def _sentence(summaries: Sequence[Mapping[str, Any]]) -> str:
    """How many pictures there are, and the largest share of a channel above full well."""
    count = f"{len(summaries)} picture{'' if len(summaries) == 1 else 's'}"
    share, channel, label = max(
        (share, channel, one["label"])
        for one in summaries
        for channel, share in one["above_full_well_share"].items()
    )
    if not share:
        return f"{count}: no pixel is above full well."
    most = f"{100 * share:.1f} % of the pixels of a channel"
    return f"{count}: up to {most} are above full well ({channel} of {label})."


def _line(taken: TakenPicture, out: Path) -> str:
    point = taken.capture.camera.operating_point
    means = zip(point.sensor.names, any_picture(taken.capture).mean_e, strict=True)
    text = ", ".join(f"{name} {e:.0f} e-" for name, e in means)
    files = ", ".join(taken.files)
    return f"{out}/{files}: {point.exposure.time_s * 1e3:.4g} ms, mean {text}"


def _notes(taken: TakenPicture) -> list[str]:
    """Notes on a picture; for a burst, only on its first frame."""
    capture = taken.capture
    picture, names = any_picture(capture), capture.camera.operating_point.sensor.names
    if picture.frame > 0:
        return []
    what = "clipped there" if is_held(capture) else "not clipped; --clip does so"
    above = [
        f"{100 * share:.1f} % of {name} lies above full well ({what})"
        for name, share in zip(names, picture.above_full_well, strict=True)
        if share > 0
    ]
    return [f"{taken.stem}: {note}" for note in (*above, *picture.notes, *taken.not_written)]
