"""``chromanoise simulate``."""

from pathlib import Path
from typing import Any

import click

from chromanoise import __version__
from chromanoise._check import InputError, distinct
from chromanoise._files import refuse_unwritable, whole_folder
from chromanoise.cli.options import (
    EXPOSURE,
    only,
    sensor_and_light,
    the_exposure,
    the_light,
    the_sensors,
)
from chromanoise.cli.output import write_json
from chromanoise.exposure import Situation
from chromanoise.imaging import Picture, picture_summary, rendered, write_png, write_xyz_tiff
from chromanoise.scene import Cube, builtin_cube, read_cube


@click.command()
@click.argument("cube", metavar="CUBE")
@click.option("--sensor", "sensors", multiple=True, required=True, help="Name or CSV; repeatable.")
@sensor_and_light
@click.option("--seed", type=int, default=0, show_default=True, help="Of the noise.")
@click.option("--clip", is_flag=True, help="Hold electrons between 0 and full well.")
@click.option("--key", help="Name of the array in a MAT or NPZ file.")
@click.option("--shape", metavar="ROWSxCOLUMNS", help="Of a cube stored as a 2-D array.")
@click.option("--wavelengths", metavar="FIRST:LAST", help="[nm], where the file does not say.")
@click.option("--scale", type=float, help="Reflectance per stored unit, e.g. 0.0001.")
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    default=Path("out/simulate"),
    show_default=True,
    help="Folder for <sensor>.png, <sensor>.xyz.tiff and summary.json.",
)
def simulate(
    cube: str, sensors: tuple[str, ...], seed: int, clip: bool, out: Path, **options: Any
) -> None:
    """Render CUBE through each sensor to a noisy color picture, all channels at every pixel.

    CUBE is a hyperspectral reflectance cube: ENVI (.hdr or its data file), MAT v5, NPZ or NPY,
    or builtin:checker.
    """
    refuse_unwritable(out)
    source = _the_cube(cube, options)
    illuminant, white = the_light(options)
    cameras = the_sensors(sensors, options)
    distinct("names of --sensor", [camera.name for camera in cameras])
    pictures = [
        rendered(
            source,
            Situation(
                sensor=camera,
                exposure=the_exposure(white, camera, **only(options, EXPOSURE)),
                illuminant=illuminant,
                level_lux=white.level_lux,
            ),
            seed=seed,
            beyond=options["beyond"],
            clip=clip,
        )
        for camera in cameras
    ]
    with whole_folder(out) as folder:
        for picture in pictures:
            write_png(folder / f"{picture.sensor.name}.png", picture.srgb)
            write_xyz_tiff(folder / f"{picture.sensor.name}.xyz.tiff", picture.xyz)
        summary = {
            "version": __version__,
            "cube": source.source,
            "pictures": [picture_summary(picture) for picture in pictures],
        }
        write_json(summary, str(folder / "summary.json"))
    for picture in pictures:
        _tell(picture, out)


_CURES = ("key", "shape", "wavelengths", "scale")


def _the_cube(name: str, options: dict[str, Any]) -> Cube:
    if name.startswith("builtin:"):
        cures = [f"--{key}" for key in _CURES if options[key] is not None]
        if cures:
            raise InputError(f"{name} says all of itself; leave {' and '.join(cures)} away")
        return builtin_cube(name)
    return read_cube(
        name,
        key=options["key"],
        shape=_pair("--shape", options["shape"], "x", int),
        wavelengths=_pair("--wavelengths", options["wavelengths"], ":", float),
        scale=options["scale"],
    )


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


def _tell(picture: Picture, out: Path) -> None:
    sensor = picture.sensor
    click.echo(
        f"{out}/{sensor.name}.png: {picture.exposure.time_s * 1e3:.4g} ms, mean "
        + ", ".join(f"{n} {e:.0f} e-" for n, e in zip(sensor.names, picture.mean_e, strict=True))
    )
    for name, share in zip(sensor.names, picture.above_full_well, strict=True):
        if share > 0:
            what = "held there" if picture.clipped else "not clipped; --clip holds them there"
            told = f"{100 * share:.1f} % of {name} lies above full well ({what})"
            click.echo(f"{sensor.name}: {told}", err=True)
    for note in picture.notes:
        click.echo(f"{sensor.name}: {note}", err=True)
