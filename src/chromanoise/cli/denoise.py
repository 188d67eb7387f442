"""The commands ``chromanoise denoise`` and ``chromanoise denoise-bench``."""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import click

from chromanoise.apps.denoising_benchmark import (
    BENCHMARK_CAMERAS,
    BENCHMARK_LEVELS_LUX,
    BENCHMARK_SCENES,
    BenchmarkCell,
    BenchmarkScene,
    benchmark_scene,
    denoising_benchmark,
    markdown_table,
    verdict_sentences,
)
from chromanoise.base import (
    InputError,
    __version__,
    check,
    refuse_unwritable,
    renamed,
    whole_folder,
)
from chromanoise.cli.options import (
    WHOLE,
    RenamedOption,
    command,
    matrix_option,
    out_option,
    own_option,
    pair,
    threads_option,
    with_settings,
)
from chromanoise.cli.output import (
    as_json,
    json_option,
    print_lines,
    progress_of,
    write_json,
    write_outputs,
)
from chromanoise.imaging import DEMOSAICING, Work
from chromanoise.imaging.denoising import DENOISING
from chromanoise.io.frames import DUMP_TYPES
from chromanoise.sensor import MOSAIC_NAMES
from chromanoise.study import (
    PicturePart,
    cube_of,
    denoised_picture,
    frames_of_pictures,
    prepared_denoising,
    refuse_other_denoised,
    write_denoised,
)

_detail_option = partial(own_option, common=False, heading="Picture")


@command()
@with_settings("denoise")
@click.argument("pictures", nargs=-1, required=True, metavar="PICTURE")
@own_option(
    "--sensor",
    heading="Sensor",
    help="A name of `chromanoise catalog sensors`, or a file: its channels give the color, its "
    "pixel gives the noise. Without it only raw codes are written.",
)
@click.option(
    "--denoise",
    cls=RenamedOption,
    old="--method",
    heading="Picture",
    type=click.Choice(list(DENOISING)),
    default="guided",
    show_default=True,
    help="Denoising method.",
)
@matrix_option
@own_option(
    "--lux",
    type=float,
    help="Illuminance [lx]. [default: estimated from the mean of the picture]",
)
@own_option(
    "--time-ms",
    type=float,
    help="Exposure time [ms]. [default: from the file, else auto exposure]",
)
@own_option(
    "--mosaic",
    metavar="NAME|ROWS|none",
    help=f"Channel of each pixel from the first one on: {', '.join(MOSAIC_NAMES)}, rows, e.g. "
    "RG/GB or 'R G/IR B', or none for a monochrome sensor. [default: from the file, else the "
    "sensor's own]",
)
@_detail_option(
    "--demosaic",
    type=click.Choice(list(DEMOSAICING)),
    help="Demosaicing method of the color. [default: bilinear]",
)
@_detail_option(
    "--bits",
    type=WHOLE,
    help="Bits of the codes, 8 to 16. [default: from the file, else --pixel]",
)
@_detail_option(
    "--black-level",
    type=WHOLE,
    help="Code without light. [default: from the file, else --pixel]",
)
@_detail_option(
    "--white-level",
    type=float,
    help="Lowest saturated code. [default: from the file, else the largest code]",
)
@_detail_option(
    "--shape",
    metavar="ROWSxCOLUMNS",
    help="Rows and columns of a raw dump (.raw, .bin).",
)
@_detail_option(
    "--stored",
    type=click.Choice(list(DUMP_TYPES)),
    help="Type of the codes of a raw dump; uint16 is little-endian. [default: uint16]",
)
@threads_option
@out_option("Folder for the pictures and summary.json.", default="out/denoise")
def denoise(
    pictures: tuple[str, ...],
    sensor: str | None,
    denoise: str,
    matrix: str,
    white_level: float | None,
    shape: str | None,
    stored: str | None,
    threads: int | None,
    out: Path,
    **settings: Any,
) -> None:
    """Denoise a raw picture of any camera with its known noise; several PICTUREs form a burst.

    PICTURE is a raw file as for `chromanoise characterize`: DNG or camera raw, TIFF, FITS, NPY,
    PGM, or a raw dump. Its noise is that of --pixel or --sensor, if gain and read noise are known,
    or else the NoiseProfile of a DNG. Nothing else is assumed about the camera. The codes are
    written as TIFF, and as DNG if PICTURE is an uncompressed DNG; with --sensor also the color, as
    PNG and XYZ. Without --lux the illuminance is estimated: the one at which a ColorChecker would
    have the mean of the picture.
    """
    refuse_unwritable(out)
    frames = frames_of_pictures(pictures, shape=pair("--shape", shape, "x", int), stored=stored)
    plan = prepared_denoising(
        frames, sensor, settings, denoise=denoise, matrix=matrix, white_level=white_level
    )
    refuse_other_denoised(plan, out)
    with whole_folder(out, "denoise") as folder:
        result = denoised_picture(plan, work=Work(threads=threads))
        files, not_written = write_denoised(result, folder)
        summary = {**result.summary, "files": files, "not_written": not_written}
        write_json(summary, str(folder / "summary.json"))
    click.echo(f"{out}/{', '.join(files)}: noise of {result.noise.source}")
    for note in (*_shares(summary), *summary["notes"], *not_written):
        click.echo(note, err=True)


def _shares(summary: dict[str, Any]) -> list[str]:
    named = {
        "code_0_share": "of the pixels have code 0",
        "saturated_share": "of the pixels are saturated and keep their code",
        "outside_codes_share": "of the denoised values are clipped to the range of the codes",
    }
    lines = [
        f"{100 * summary[name]:.3g} % {text}" for name, text in named.items() if summary.get(name)
    ]
    for name, text in (
        ("measured_noise", "measured over expected noise where the picture is smoothest"),
        ("residual", "removed over expected noise"),
    ):
        known = {plane: value for plane, value in summary[name].items() if value is not None}
        if known:
            values = ", ".join(f"{plane} {value:.2f}" for plane, value in known.items())
            lines.append(f"{text}: {values}")
    return lines


_MOST_PROCESSES = 64


def _levels(_: click.Context, __: click.Parameter, text: str) -> list[float]:
    try:
        levels = [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(
            "--levels", "must be illuminances in lx with commas between them", value=text
        ) from None
    return [check.positive("--levels", "lx", level) for level in levels]


@command()
@with_settings("render", only=("key", "shape", "wavelengths", "scale"))
@click.argument("cubes", nargs=-1, metavar="[CUBE...]")
@click.option(
    "--sensor",
    "cameras",
    multiple=True,
    metavar="NAME[:MOSAIC]",
    help="A sensor of the catalog, with all channels at every pixel or with a mosaic; "
    f"repeatable. [default: {', '.join(BENCHMARK_CAMERAS)}]",
)
@click.option(
    "--levels",
    metavar="LUX[,LUX...]",
    default=",".join(f"{lux:g}" for lux in BENCHMARK_LEVELS_LUX),
    callback=_levels,
    show_default=True,
    help="Illuminances [lx], illuminant E.",
)
@click.option(
    "--denoise",
    "methods",
    cls=RenamedOption,
    old="--method",
    multiple=True,
    type=click.Choice(list(DENOISING)),
    help="Denoising method; repeatable. [default: all whose packages are installed]",
)
@click.option(
    "--demosaic",
    type=click.Choice(list(DEMOSAICING)),
    default="bilinear",
    show_default=True,
    help="Demosaicing method after denoising, for sensors with a mosaic.",
)
@click.option(
    "--crop", type=WHOLE, help="Use only the middle of a scene, a square with this side [px]."
)
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="Seed of the noise.")
@click.option("--processes", type=WHOLE, default=1, show_default=True, help="Number of processes.")
@out_option("Folder for the report and its pictures.")
@json_option
def denoise_bench(
    cubes: tuple[str, ...],
    cameras: tuple[str, ...],
    levels: list[float],
    methods: tuple[str, ...],
    demosaic: str,
    crop: int | None,
    seed: int,
    processes: int,
    out: Path | None,
    json_target: str | None,
    **of_cubes: Any,
) -> None:
    """Compare denoising methods on scenes, sensors and light levels.

    CUBE is a built-in scene or a file, as for `chromanoise simulate`; by default all built-in
    scenes. Each method denoises the same noisy picture, and its result is compared with the
    noise-free picture: CIEDE2000, S-CIELAB, PSNR, SSIM, false color, noise on flat regions,
    sharpness of slanted edges, time. The exposure is the paper's, f/1.8 and 11.94 ms; above 10 lx
    the time is shorter, so that no pixel saturates.
    """
    if not 1 <= processes <= _MOST_PROCESSES:
        raise InputError("--processes", f"must be 1 to {_MOST_PROCESSES}", value=processes)
    if out is not None:
        refuse_unwritable(out)
    absent = {name: one.absent_packages for name, one in DENOISING.items() if one.absent_packages}
    chosen = methods or tuple(name for name in DENOISING if name not in absent)
    if not methods:
        for name, ((package, extra), *_) in absent.items():
            said = f"not compared: {name}, which needs {package}; install chromanoise[{extra}]"
            click.echo(said, err=True)
    sensors = cameras or BENCHMARK_CAMERAS
    scenes = [_scene(cube, crop, of_cubes) for cube in cubes or BENCHMARK_SCENES]
    count = len(scenes) * len(sensors) * len(levels) * len(chosen)
    with ExitStack() as stack:
        work = Work()
        if processes > 1:
            pool = ProcessPoolExecutor(processes, mp_context=get_context("spawn"))
            work = Work(executor=stack.enter_context(pool))
        advance = stack.enter_context(progress_of("the benchmark", count, "cells"))
        cells = denoising_benchmark(
            scenes,
            sensors,
            levels,
            chosen,
            seeds=(seed,),
            demosaic=demosaic,
            work=work,
            progress=advance,
        )
    if out is not None:
        from chromanoise.web import write_denoising_report

        write_denoising_report(cells, out)
    write_outputs(as_json(json_target, lambda: _record(cells)))
    if json_target != "-":
        print_lines([*markdown_table(cells).splitlines(), "", *verdict_sentences(cells)])


def _scene(cube: str, crop: int | None, of_cubes: dict[str, Any]) -> BenchmarkScene:
    part = PicturePart(cube=cube, **of_cubes)
    stored = cube_of(part)
    name = cube if cube.startswith("builtin:") else Path(cube).name
    try:
        return benchmark_scene(stored, crop_px=crop, name=name)
    except InputError as error:
        raise renamed(error, "crop_px", "--crop") from None


def _record(cells: Sequence[BenchmarkCell]) -> dict[str, object]:
    return {"version": __version__, "cells": [cell.record for cell in cells]}
