"""``chromanoise denoise-bench``."""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import click

from chromanoise import __version__, _check
from chromanoise._files import refuse_unwritable, renamed
from chromanoise.cli.options import WHOLE, with_settings
from chromanoise.cli.output import json_option, json_text, print_lines, write_outputs
from chromanoise.cli.parsing import RenamedOption, command
from chromanoise.cli.progress import progress_of
from chromanoise.denoising import (
    DENOISING,
    BenchmarkCell,
    BenchmarkScene,
    benchmark_scene,
    markdown_table,
    verdict_sentences,
)
from chromanoise.errors import InputError
from chromanoise.imaging import DEMOSAICING, Work
from chromanoise.study.assembly import cube_of
from chromanoise.study.denoising_cells import (
    BENCHMARK_CAMERAS,
    BENCHMARK_LEVELS_LUX,
    BENCHMARK_SCENES,
    denoising_benchmark,
)
from chromanoise.study.document import PicturePart

_MOST_PROCESSES = 64


def _levels(_: click.Context, __: click.Parameter, text: str) -> list[float]:
    try:
        levels = [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(
            "--levels", "must be illuminances in lx with commas between them", value=text
        ) from None
    return [_check.positive("--levels", "lx", level) for level in levels]


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
    help="Denoising method; repeatable. [default: all]",
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
@click.option(
    "-o", "--out", type=click.Path(path_type=Path), help="Folder for the report and its pictures."
)
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
    chosen = methods or tuple(DENOISING)
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
        from chromanoise.report import write_denoising_report

        write_denoising_report(cells, out)
    write_outputs((json_target, lambda: json_text(_record(cells))))
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
