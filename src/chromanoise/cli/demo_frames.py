"""``chromanoise demo-frames``."""

import re
from pathlib import Path
from typing import Any

import click

from chromanoise._files import OWN_FILES, refuse_unwritable
from chromanoise.characterization import USUAL_CAMERA, VirtualCamera, photon_transfer_frames
from chromanoise.characterization.virtual_camera import PROPERTIES
from chromanoise.characterization.virtual_frames import FRAME_FORMATS
from chromanoise.cli.options import WHOLE, Command
from chromanoise.cli.parsing import command
from chromanoise.errors import InputError

_COLOR = {"R": 0.7, "G": 1.0, "B": 0.6}  # sensitivities of a color camera under white light


def _property_options(command: Command) -> Command:
    """Add an option for each property of the camera."""
    for name, one in reversed([*PROPERTIES.items()]):
        usual = getattr(USUAL_CAMERA, name)
        command = click.option(
            f"--{name.replace('_', '-')}",
            type=float,
            default=None if usual is None else f"{usual:g}",
            show_default=True,
            help=one.help.partition("; default:")[0],
        )(command)
    return command


def _shape(_: Any, __: Any, given: str) -> tuple[int, int]:
    found = re.fullmatch(r"([0-9]{1,9})[xX]([0-9]{1,9})", given)
    if found is None:
        raise InputError("--shape", "must be ROWSxCOLUMNS, e.g. 240x320", value=given)
    return int(found[1]), int(found[2])


@command()
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    required=True,
    help="Folder for the frames, capture.toml and truth.toml.",
)
@click.option(
    "--mosaic",
    metavar="NAME|ROWS",
    help="Channels of a color camera, e.g. RG/GB or 'R G/IR B'. [default: monochrome]",
)
@click.option("--levels", type=WHOLE, default=16, show_default=True, help="Levels of light.")
@click.option("--frames", type=WHOLE, default=2, show_default=True, help="Flats per level.")
@click.option("--darks", type=WHOLE, default=2, show_default=True, help="Darks per level.")
@click.option(
    "--shape",
    metavar="ROWSxCOLUMNS",
    default="240x320",
    show_default=True,
    callback=_shape,
    help="Size of the frames [px].",
)
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="Seed of the noise.")
@click.option(
    "--format",
    "file_format",
    type=click.Choice(FRAME_FORMATS),
    default="npy",
    show_default=True,
    help="File format of the frames; fits needs astropy.",
)
@click.option("--bits", type=WHOLE, default=12, show_default=True, help="Bits per code.")
@click.option(
    "--gain-dn-per-e", type=float, default=0.3, show_default=True, help="System gain K [DN/e-]."
)
@click.option(
    "--black-level",
    "black_level_dn",
    type=float,
    default=64,
    show_default=True,
    help="Mean code without light [DN].",
)
@click.option(
    "--hot-pixels",
    type=WHOLE,
    default=0,
    show_default=True,
    help="Number of pixels with additional dark current.",
)
@_property_options
def demo_frames(
    out: Path, levels: int, frames: int, darks: int, file_format: str, **settings: Any
) -> None:
    """Raw frames of a virtual camera with known noise, to try a characterization.

    Flats from dark to saturation and matched darks, with capture.toml, which describes the frames,
    and truth.toml, which holds the true values.
    """
    refuse_unwritable(out)
    if out.is_dir() and any(path.name != OWN_FILES for path in out.iterdir()):
        raise InputError(
            "--out",
            "must be an empty folder or a new one, so that no frames are mixed",
            value=str(out),
            found=f"{out} holds files",
            remedy="name another folder",
        )
    camera = _camera(**settings)
    written = photon_transfer_frames(
        camera, folder=out, levels=levels, frames=frames, darks=darks, file_format=file_format
    )
    rows, columns = camera.shape
    click.echo(f"{out}: {len(written)} frames of {columns} x {rows} pixels, capture.toml")
    click.echo(f"{out / 'truth.toml'}: the true values")


def _camera(*, mosaic: str | None, **settings: Any) -> VirtualCamera:
    """The camera; the channels R, G and B of a mosaic differ in their sensitivity."""
    camera = VirtualCamera(mosaic=mosaic, **settings)
    if mosaic is None:
        return camera
    channels = camera.pattern.names
    sensitivity = tuple(_COLOR.get(name, 1.0) for name in channels)
    return VirtualCamera(mosaic=mosaic, sensitivity=sensitivity, **settings)
