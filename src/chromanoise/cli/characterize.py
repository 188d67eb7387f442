"""The commands ``chromanoise characterize`` and ``chromanoise demo-frames``."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from chromanoise.apps.camera import (
    FRAME_FORMATS,
    PROPERTIES,
    QUANTITIES,
    USUAL_CAMERA,
    Characterization,
    VirtualCamera,
    characterize as characterized,
    photon_transfer_frames,
    read_source,
    variance_through_file,
)
from chromanoise.base import OWN_FILES, InputError, plain, refuse_unwritable, true_path
from chromanoise.cli.options import (
    WHOLE,
    Decorated as Command,
    command,
    notes_option,
    out_option,
    own_option,
)
from chromanoise.cli.output import (
    fail_if_option,
    json_option,
    leave_if_failed,
    print_lines,
    progress_of,
    refuse_taken_inputs,
    terminal,
    write_json,
)
from chromanoise.cli.terminal_tables import empty_table, print_notes
from chromanoise.io.frames import FrameSet, RawFrame
from chromanoise.sensor import PhotonTransfer
from chromanoise.study import JudgedResult, conditions_of, failures_of


@command()
@click.argument("frames", nargs=-1, required=True, metavar="FOLDER|FILES")
@out_option("Folder for pixel.toml, data sheets, noise profiles, tables and report.html.")
@click.option(
    "--resume",
    type=click.Path(path_type=Path, dir_okay=False),
    help="File that keeps the statistics of the frames read so far; a later run continues from it.",
)
@click.option(
    "--matrix",
    metavar="FILE",
    help="Color matrix through which predicted and measured variance are compared: CSV, JSON, "
    "CLF, DNG, DCP.",
)
@json_option
@fail_if_option
@notes_option
def characterize(
    frames: tuple[str, ...],
    out: Path | None,
    resume: Path | None,
    matrix: str | None,
    json_target: str | None,
    fail_if: tuple[str, ...],
    whole_notes: bool,
) -> None:
    """Noise of a camera from its own raw frames, by the methods of EMVA 1288.

    FOLDER holds flats at several levels of light, two or more per level, and darks: camera raw,
    DNG, TIFF, FITS, NPY, NPZ, PGM or gray PNG, or the descriptor of an EMVA 1288 measurement. A
    file capture.toml in it states which frames belong together.
    """
    asked = conditions_of(fail_if, [JudgedResult(kind=Characterization)])
    refuse_taken_inputs({"--json": json_target}, frames, {})
    if out is not None:
        refuse_unwritable(out)
    given = None
    if matrix is not None:
        from chromanoise.io import read_matrix
        from chromanoise.study import file_of

        given = read_matrix(file_of(matrix))
    read = read_source(frames)
    _refuse_replaced(read, frames, {"--json": json_target, "--resume": resume, "--out": out})
    with progress_of("frames", _count(read), "frames") as advance:
        before = 0

        def advanced(done: int, _all: int) -> None:
            nonlocal before
            advance(done - before)
            before = done

        result = characterized(read, resume=resume, progress=advanced)
    failed = failures_of(asked, lambda: [result.to_dict()])
    check = None
    if given is not None:
        check = variance_through_file(result, given)
    written: tuple[Path, ...] = ()
    omitted: list[str] = []
    if out is not None:
        from chromanoise.web import omitted_files, write_characterization

        written, omitted = write_characterization(result, out), omitted_files(result)
    if json_target:
        checked = {"matrix_check": {"source": matrix, **plain(check)}} if check else {}
        write_json(result.to_dict() | checked, json_target)
    if json_target != "-":
        _print(result, whole_notes=whole_notes)
        if check is not None:
            errors = zip(check.names, 100 * check.mean_error, strict=True)
            print_lines(
                [
                    f"Relative error of the predicted variance after {matrix}, mean of "
                    f"{sum(check.fitted)} levels: "
                    + ", ".join(f"{name} {error:+.2f} %" for name, error in errors),
                    *(given.notes if given else ()),
                ]
            )
        if written:
            print_lines([f"Written to {out}: {', '.join(path.name for path in written)}", *omitted])
    leave_if_failed(failed)


def _frames_of(read: FrameSet | PhotonTransfer) -> list[RawFrame]:
    levels = read.levels if isinstance(read, FrameSet) else ()
    return [frame for level in levels for frame in (*level.flats, *level.darks)]


def _count(read: FrameSet | PhotonTransfer) -> int:
    return max(1, len({id(frame) for frame in _frames_of(read)}))


def _refuse_replaced(
    read: FrameSet | PhotonTransfer,
    words: Sequence[str],
    targets: Mapping[str, str | Path | None],
) -> None:
    """Refuse outputs that would replace a frame, the list of frames, a table, or each other."""
    every = {true_path(frame.path) for frame in _frames_of(read)}
    inputs = {*every, true_path(Path(read.source)), *(true_path(Path(word)) for word in words)}
    folders = {path.parent for path in every}
    seen: dict[Path, str] = {}
    for option, target in targets.items():
        if target is None or target == "-":
            continue
        path = true_path(Path(target))
        demand, remedy = "", "name another one"
        if path in inputs or (option == "--out" and path in folders):
            demand = "must not be a frame, the list of frames or their folder"
        elif path in seen:
            demand, remedy = f"must not be that of {seen[path]}", "name another file"
        if demand:
            raise InputError(option, demand, value=str(target), remedy=remedy)
        seen[path] = option


def _print(result: Characterization, *, whole_notes: bool) -> None:
    verdict = result.verdict
    holds = "The linear model holds" if verdict.holds else "The linear model does not hold"
    print_lines(
        [
            f"{holds}: chi-square {verdict.chi2_per_level:.2f} per level, largest deviation "
            f"{verdict.worst_z:+.1f} standard errors ({verdict.worst_level}).",
            *(f"{sentence[0].upper()}{sentence[1:]}." for sentence in verdict.sentences),
        ]
    )
    title = f"Noise of {result.camera or result.source} (EMVA 1288)"
    grid = empty_table(title, ("",), [plane.name for plane in result.planes])
    for quantity in QUANTITIES:
        cells = [_cell(*quantity.shown(plane)) for plane in result.planes]
        if any(cell != "-" for cell in cells):
            grid.add_row(f"{quantity.name} [{quantity.shown_unit or '1'}]", *cells)
    terminal().print(grid)
    notes = [("", note) for note in result.notes]
    notes += [("", note) for plane in result.planes for note in plane.fit.notes]
    print_notes(notes, whole=whole_notes)


def _cell(value: float | None, error: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.4g}" if error is None else f"{value:.4g} +- {error:.2g}"


_COLOR = {"R": 0.7, "G": 1.0, "B": 0.6}  # sensitivities of a color camera under white light


def _camera_options(command: Command) -> Command:
    """Add the options of the frames, and one for each property of the camera."""
    options: dict[str, tuple[Any, ...]] = {
        flag: (kind, default, text, True, "Frames") for flag, kind, default, text in _NUMBERS
    }
    for name, one in PROPERTIES.items():
        usual = getattr(USUAL_CAMERA, name)
        default = None if usual is None else f"{usual:g}"
        flag = f"--{name.replace('_', '-')}"
        text = one.help.partition("; default:")[0]
        options[flag] = (float, default, text, one.common, "Camera")
    for flag, (kind, default, text, common, heading) in reversed(options.items()):
        command = own_option(
            *flag.split(),
            type=kind,
            default=default,
            show_default=True,
            help=text,
            common=common,
            heading=heading,
        )(command)
    return command


class _Shape(click.ParamType):
    """Rows and columns."""

    name = "ROWSxCOLUMNS"

    def get_metavar(self, *_: Any, **__: Any) -> str:
        return self.name

    def convert(self, value: Any, *_: Any) -> tuple[int, int]:
        found = re.fullmatch(r"([0-9]{1,9})[xX]([0-9]{1,9})", value)
        if found is None:
            raise InputError("--shape", "must be ROWSxCOLUMNS, e.g. 240x320", value=value)
        return int(found[1]), int(found[2])


_NUMBERS: tuple[tuple[str, click.ParamType | type, Any, str], ...] = (
    ("--levels", WHOLE, 16, "Levels of light."),
    ("--frames", WHOLE, 2, "Flats per level."),
    ("--darks", WHOLE, 2, "Darks per level."),
    ("--shape", _Shape(), "240x320", "Size of the frames [px]."),
    ("--seed", WHOLE, 0, "Seed of the noise."),
    (
        "--format file_format",
        click.Choice(FRAME_FORMATS),
        "npy",
        "File format of the frames; fits needs astropy.",
    ),
    ("--bits", WHOLE, 12, "Bits per code."),
    ("--gain-dn-per-e", float, 0.3, "System gain K [DN/e-]."),
    ("--black-level black_level_dn", float, 64, "Mean code without light [DN]."),
    ("--hot-pixels", WHOLE, 0, "Number of pixels with additional dark current."),
)
"""Options of the frames: names, type, default and help."""


@command()
@out_option("Folder for the frames, capture.toml and truth.toml.", required=True)
@own_option(
    "--mosaic",
    metavar="NAME|ROWS",
    heading="Frames",
    help="Channels of a color camera, e.g. RG/GB or 'R G/IR B'. [default: monochrome]",
)
@_camera_options
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
    return replace(
        camera, sensitivity=tuple(_COLOR.get(name, 1.0) for name in camera.pattern.names)
    )
