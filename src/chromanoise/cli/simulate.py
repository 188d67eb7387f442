"""``chromanoise simulate``."""

import time
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from chromanoise import __version__
from chromanoise._check import distinct
from chromanoise._files import refuse_unwritable, whole_folder
from chromanoise.analysis import matrix_makers
from chromanoise.catalog.resolve import file_of
from chromanoise.cli.copying import print_copy, simulate_told
from chromanoise.cli.options import (
    EXPOSURE,
    WHOLE,
    copy_option,
    matrix_option,
    only,
    prior_option,
    sensor_and_light,
    the_exposure,
    the_light,
    the_sensors,
)
from chromanoise.cli.output import write_json
from chromanoise.cli.progress import progress_of
from chromanoise.errors import InputError
from chromanoise.exposure import Situation
from chromanoise.imaging import DEMOSAICING, Work
from chromanoise.imaging.distributed import cluster
from chromanoise.imaging.shots import (
    FORMATS,
    MOST_FRAMES,
    Asked,
    Shot,
    any_picture,
    is_held,
    prepared,
    shot,
    shot_summary,
    write_shot,
)
from chromanoise.io.cubes import read_cube
from chromanoise.scene import Cube, builtin_cube
from chromanoise.scene.rows import row_source
from chromanoise.sensor import MOSAIC_NAMES, PixelOverrides, mosaic_named
from chromanoise.study import file_word

_REAL_PIXELS = ("dark_current_e_per_s", "dsnu_e", "prnu", "row_noise_e")


@click.command()
@click.argument("cube", metavar="CUBE")
@click.option(
    "--sensor",
    "sensors",
    multiple=True,
    required=True,
    help="A name of `chromanoise catalog sensors`, or a file; repeatable.",
)
@sensor_and_light
@matrix_option
@prior_option
@click.option(
    "--mosaic",
    metavar="NAME|ROWS",
    help=f"Raw codes of one channel per pixel: sensor (its own), {', '.join(MOSAIC_NAMES)}, or "
    "rows as RG/GB or 'R G/IR B'. Without it all channels are at every pixel, as in the paper.",
)
@click.option(
    "--demosaic",
    type=click.Choice(list(DEMOSAICING)),
    help="How the mosaic becomes color; gradient and lmmse learn from the ColorChecker. "
    "[default: bilinear]",
)
@click.option("--raw-only", is_flag=True, help="Codes of the mosaic, no color.")
@click.option("--bits", type=WHOLE, help="Of the ADC, 8 to 16. [default: of --pixel, else 12]")
@click.option("--black-level", type=WHOLE, help="Code of no light. [default: of --pixel, else 0]")
@click.option("--frames", type=WHOLE, default=1, show_default=True, help="Pictures of a burst.")
@click.option(
    "--seed",
    type=WHOLE,
    default=0,
    show_default=True,
    help="Of the noise; sensors of other names draw other noise.",
)
@click.option("--clip", is_flag=True, help="Hold electrons between 0 and full well.")
@click.option(
    "--dark-current-e-per-s",
    type=float,
    help="Dark current [e-/s]; its mean is taken off, and lowers the full well. "
    "[default: of --pixel, else 0; also for the next three]",
)
@click.option("--dsnu-e", type=float, help="Dark signal non-uniformity [e-].")
@click.option("--prnu", type=float, help="Photo response non-uniformity, e.g. 0.01.")
@click.option("--row-noise-e", type=float, help="Noise that a row shares [e-].")
@click.option(
    "--format",
    "formats",
    metavar="NAME[,NAME...]",
    help=f"Of {', '.join(FORMATS)}. [default: png,xyz, and raw,dng of a mosaic]",
)
@click.option("--key", help="Name of the array in a MAT, NPZ, HDF5, NetCDF or Zarr cube.")
@click.option("--shape", metavar="ROWSxCOLUMNS", help="Of a cube stored as a 2-D array.")
@click.option(
    "--wavelengths",
    metavar="FIRST:LAST|FILE",
    help="Of the bands, where the cube does not declare them: evenly spaced [nm], or a text file "
    "that lists one per band (nm, or the unit in its heading).",
)
@click.option("--scale", type=float, help="Reflectance per stored unit, e.g. 0.0001.")
@click.option(
    "--bad-pixels",
    type=click.Choice(["refuse", "zero"]),
    default="refuse",
    show_default=True,
    help="What is no reflectance (NaN, negative, above 2): refuse it, or take 0 and say so.",
)
@click.option("--threads", type=WHOLE, help="Working at once. [default: one per core]")
@click.option(
    "--tile", type=WHOLE, help="Rows that are held at a time. [default: what fills 8 MB to 1 GB]"
)
@click.option(
    "--scheduler",
    metavar="ADDRESS|local",
    help="Work on a dask cluster instead; the result has the same bits.",
)
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    default=Path("out/simulate"),
    show_default=True,
    help="Folder for the pictures and summary.json.",
)
@copy_option
def simulate(cube: str, sensors: tuple[str, ...], out: Path, **options: Any) -> None:
    """Take a noisy picture of CUBE with each sensor: raw codes of a mosaic, color, or both.

    CUBE is a hyperspectral reflectance cube: ENVI (.hdr or its data file), MAT, HDF5, NetCDF,
    Zarr, multi-page TIFF, a folder of one PNG per band, NPZ or NPY; or builtin:checker. It may be
    larger than memory. The same arguments give the same pictures on any number of threads, tiles
    or machines.
    """
    asked = _asked(options)
    if options["copy_as"] is not None:
        study = simulate_told(click.get_current_context().params, cube=cube, **_reading(options))
        print_copy(options["copy_as"], study)
        return
    refuse_unwritable(out)
    source = _the_cube(cube, options)
    situations = _situations(sensors, options)
    makers = matrix_makers([options["method"]], options["metric"], prior=options["prior"])
    (maker,) = makers.values()
    cameras = [prepared(source, each, maker(each), asked) for each in situations]
    summaries, told = [], []
    with ExitStack() as stack:
        folder = stack.enter_context(whole_folder(out))
        work = Work(threads=options["threads"], tile_rows=options["tile"])
        if options["scheduler"]:
            executor = stack.enter_context(
                cluster(options["scheduler"], workers=options["threads"])
            )
            here = options["scheduler"] == "local"
            work = replace(work, executor=executor, same_machine=here)
        rows = row_source(source.stored).shape[0] * options["frames"] * len(cameras)
        advance = stack.enter_context(progress_of("the pictures", rows, "rows"))
        work = replace(work, progress=advance)
        for camera in cameras:
            for frame in range(options["frames"]):
                start = time.perf_counter()
                taken = shot(source, camera, frame=frame, work=work)
                name = file_word(camera.situation.sensor.name)
                stem = name + (f"-{frame:04d}" if options["frames"] > 1 else "")
                files, notes = write_shot(folder, stem, taken)
                # the seconds are all that another run changes
                taking = {"seconds": time.perf_counter() - start, "not_written": notes}
                summaries.append(shot_summary(taken, files) | taking)
                told.append((_line(taken, out, files), _notes(taken, stem, notes)))
        summary = {"version": __version__, "cube": source.source, "pictures": summaries}
        write_json(summary, str(folder / "summary.json"))
    for line, own in told:
        click.echo(line)
        for note in own:
            click.echo(note, err=True)


def _asked(options: dict[str, Any]) -> Asked:
    if not 1 <= options["frames"] <= MOST_FRAMES:
        raise InputError(f"--frames must be 1 to {MOST_FRAMES}, but is {options['frames']}")
    _refuse_idle(options)
    own = options["mosaic"] == "sensor"
    return Asked(
        mosaic=None if own or options["mosaic"] is None else mosaic_named(options["mosaic"]),
        raw=options["mosaic"] is not None,
        demosaic=None if options["raw_only"] else options["demosaic"] or "bilinear",
        pixel=PixelOverrides(
            bits=options["bits"],
            black_level_dn=options["black_level"],
            **only(options, _REAL_PIXELS),
        ),
        seed=options["seed"],
        clip=options["clip"],
        beyond=options["beyond"],
        bad_pixels=options["bad_pixels"],
        formats=None if options["formats"] is None else tuple(options["formats"].split(",")),
    )


_OF_MOSAIC = ("demosaic", "raw_only", "bits", "black_level")


def _refuse_idle(options: dict[str, Any]) -> None:
    """An option that would change nothing was meant to change something."""
    idle = [key for key in _OF_MOSAIC if options[key] is not None and options[key] is not False]
    if options["mosaic"] is None and idle:
        told = " and ".join(f"--{key.replace('_', '-')}" for key in idle)
        raise InputError(f"{told}: only a mosaic has that; name one with --mosaic")
    if options["mosaic"] is not None and options["clip"]:
        raise InputError("--clip: a converter holds its codes anyway; leave it away with --mosaic")
    if options["raw_only"] and options["demosaic"]:
        raise InputError("--raw-only and --demosaic exclude each other; give one of them")


def _situations(sensors: tuple[str, ...], options: dict[str, Any]) -> list[Situation]:
    illuminant, white = the_light(options)
    cameras = the_sensors(sensors, options)
    distinct("names of --sensor", [camera.name for camera in cameras])
    distinct("file names of --sensor", [file_word(camera.name) for camera in cameras])
    return [
        Situation(
            sensor=camera,
            exposure=the_exposure(white, camera, **only(options, EXPOSURE)),
            illuminant=illuminant,
            level_lux=white.level_lux,
        )
        for camera in cameras
    ]


_CURES = ("key", "shape", "wavelengths", "scale")


def _the_cube(name: str, options: dict[str, Any]) -> Cube:
    if name.startswith("builtin:"):
        cures = [f"--{key}" for key in _CURES if options[key] is not None]
        if cures:
            raise InputError(f"{name} says all of itself; leave {' and '.join(cures)} away")
        return builtin_cube(name)
    how = _reading(options)
    if isinstance(how["wavelengths"], str):
        how["wavelengths"] = file_of(how["wavelengths"])
    return read_cube(name, **how)


def _reading(options: dict[str, Any]) -> dict[str, Any]:
    """How the cube's file is to be read."""
    return {
        "key": options["key"],
        "shape": _pair("--shape", options["shape"], "x", int),
        "wavelengths": _wavelengths(options["wavelengths"]),
        "scale": options["scale"],
    }


def _wavelengths(text: str | None) -> tuple[float, float] | str | None:
    """The two ends of an even series, or the name of a file."""
    try:
        return _pair("--wavelengths", text, ":", float)
    except InputError:
        if text and file_of(text).exists():
            return text
        raise InputError(
            f"--wavelengths takes FIRST:LAST in nm or a file that lists them, but {text!r} is "
            "neither"
        ) from None


def _pair(option: str, text: str | None, separator: str, kind: Any) -> Any:
    if text is None:
        return None
    parts = text.split(separator)
    try:
        first, second = (kind(part) for part in parts)
    except ValueError:
        raise InputError(
            f"{option} takes two numbers with {separator!r} between them, but is {text!r}"
        ) from None
    return first, second


def _line(taken: Shot, out: Path, files: list[str]) -> str:
    situation = taken.camera.situation
    means = zip(situation.sensor.names, any_picture(taken).mean_e, strict=True)
    told = ", ".join(f"{name} {e:.0f} e-" for name, e in means)
    return f"{out}/{', '.join(files)}: {situation.exposure.time_s * 1e3:.4g} ms, mean {told}"


def _notes(taken: Shot, stem: str, not_written: list[str]) -> list[str]:
    """What is worth knowing, once for a burst."""
    picture, names = any_picture(taken), taken.camera.situation.sensor.names
    if picture.frame > 0:
        return []
    what = "held there" if is_held(taken) else "not clipped; --clip holds them there"
    above = [
        f"{100 * share:.1f} % of {name} lies above full well ({what})"
        for name, share in zip(names, picture.above_full_well, strict=True)
        if share > 0
    ]
    return [f"{stem}: {note}" for note in (*above, *picture.notes, *not_written)]
