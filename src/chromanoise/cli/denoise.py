"""``chromanoise denoise``."""

from pathlib import Path
from typing import Any

import click

from chromanoise._files import refuse_unwritable, whole_folder
from chromanoise.cli.options import (
    WHOLE,
    matrix_option,
    with_settings,
)
from chromanoise.cli.output import write_json
from chromanoise.cli.parsing import RenamedOption, command, pair
from chromanoise.denoising import DENOISING
from chromanoise.imaging import DEMOSAICING, Work
from chromanoise.io.frames.dump import DUMP_TYPES
from chromanoise.sensor import MOSAIC_NAMES
from chromanoise.study import (
    denoised_picture,
    frames_of_pictures,
    prepared_denoising,
    refuse_other_denoised,
    write_denoised,
)


@command()
@with_settings("denoise")
@click.argument("pictures", nargs=-1, required=True, metavar="PICTURE")
@click.option(
    "--sensor",
    help="A name of `chromanoise catalog sensors`, or a file: its channels give the color, its "
    "pixel gives the noise. Without it only raw codes are written.",
)
@click.option(
    "--denoise",
    cls=RenamedOption,
    old="--method",
    type=click.Choice(list(DENOISING)),
    default="guided",
    show_default=True,
    help="Denoising method.",
)
@matrix_option
@click.option(
    "--lux",
    type=float,
    help="Illuminance [lx]. [default: estimated from the mean of the picture]",
)
@click.option(
    "--time-ms",
    type=float,
    help="Exposure time [ms]. [default: from the file, else solved from --saturate]",
)
@click.option(
    "--mosaic",
    metavar="NAME|ROWS|none",
    help=f"Channel of each pixel from the first one on: {', '.join(MOSAIC_NAMES)}, rows, e.g. "
    "RG/GB or 'R G/IR B', or none for a monochrome sensor. [default: from the file, else the "
    "sensor's own]",
)
@click.option(
    "--demosaic",
    type=click.Choice(list(DEMOSAICING)),
    help="Demosaicing method of the color. [default: bilinear]",
)
@click.option(
    "--bits", type=WHOLE, help="Bits of the codes, 8 to 16. [default: from the file, else --pixel]"
)
@click.option(
    "--black-level",
    type=WHOLE,
    help="Code without light. [default: from the file, else --pixel]",
)
@click.option(
    "--white-level",
    type=float,
    help="Lowest saturated code. [default: from the file, else the largest code]",
)
@click.option(
    "--shape", metavar="ROWSxCOLUMNS", help="Rows and columns of a raw dump (.raw, .bin)."
)
@click.option(
    "--stored",
    type=click.Choice(list(DUMP_TYPES)),
    help="Type of the codes of a raw dump; uint16 is little-endian. [default: uint16]",
)
@click.option("--threads", type=WHOLE, help="Number of threads. [default: one per core]")
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    default=Path("out/denoise"),
    show_default=True,
    help="Folder for the pictures and summary.json.",
)
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
