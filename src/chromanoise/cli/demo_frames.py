"""``chromanoise demo-frames``."""

import re
from pathlib import Path
from typing import Any

import click

from chromanoise._files import OWN_FILES, refuse_unwritable
from chromanoise.characterization import VirtualCamera, photon_transfer_frames
from chromanoise.characterization.virtual_frames import FRAME_FORMATS
from chromanoise.cli.options import WHOLE
from chromanoise.cli.parsing import command
from chromanoise.errors import InputError

_COLOR = {"R": 0.7, "G": 1.0, "B": 0.6}  # sensitivities of a color camera under white light


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
    "--full-well-e", type=float, default=12_000, show_default=True, help="Full well [e-]."
)
@click.option("--read-noise-e", type=float, default=3, show_default=True, help="Read noise [e-].")
@click.option("--qe", type=float, default=0.5, show_default=True, help="QE [e-/photon].")
@click.option(
    "--dark-current-e-per-s",
    type=float,
    default=30,
    show_default=True,
    help="Dark current [e-/s]; the longest exposure is 100 ms.",
)
@click.option(
    "--prnu", type=float, default=0.008, show_default=True, help="PRNU, relative, e.g. 0.01."
)
@click.option("--dsnu-e", type=float, default=1.5, show_default=True, help="DSNU [e-].")
@click.option(
    "--row-noise-e",
    type=float,
    default=0.5,
    show_default=True,
    help="Row noise: standard deviation of the offset of a row, new in each frame [e-].",
)
@click.option(
    "--column-noise-e",
    type=float,
    default=0,
    show_default=True,
    help="Column noise: standard deviation of the offset of a column, new in each frame [e-].",
)
@click.option(
    "--hot-pixels",
    type=WHOLE,
    default=0,
    show_default=True,
    help="Number of pixels with 1000 e-/s of additional dark current.",
)
@click.option(
    "--bend",
    type=float,
    default=0,
    show_default=True,
    help="Relative fall of the gain from dark to full well, e.g. 0.1.",
)
@click.option(
    "--drift",
    type=float,
    default=0,
    show_default=True,
    help="Relative change of the light from one frame to the next.",
)
@click.option(
    "--neighbor-correlation",
    type=float,
    default=0,
    show_default=True,
    help="Correlation of the noise of neighboring pixels, as after denoising in the camera.",
)
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
