"""The pictures of a study: their settings and cameras, prepared before the computation."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from chromanoise.analysis.color_matrices import MatrixMaker
from chromanoise.exposure import OperatingPoint
from chromanoise.imaging import Work
from chromanoise.imaging.capture import (
    Camera,
    Capture,
    CaptureSettings,
    any_picture,
    camera_for,
    capture_summary,
    captured,
    write_capture,
)
from chromanoise.scene import Cube
from chromanoise.sensor import PixelOverrides, mosaic_named
from chromanoise.study.assembly import cube_of, keyed
from chromanoise.study.document import PicturePart, Study
from chromanoise.study.file_names import file_word, refuse_shared_file_names
from chromanoise.study.results import Pictures


def capture_settings_of(
    part: PicturePart, *, seed: int, key: str = "pictures.0"
) -> CaptureSettings:
    """What a part of a study asks of its pictures.

    Parameters
    ----------
    part
        Of a study.
    seed
        Of all noise that is drawn.
    key
        Of the part, for errors.

    Raises
    ------
    InputError
        If a mosaic or a format is unknown, or a format is of what is not made.
    """
    mosaic = None
    if part.mosaic is not None and part.mosaic != "sensor":
        with keyed(f"{key}.mosaic"):
            mosaic = mosaic_named(part.mosaic)
    return CaptureSettings(
        mosaic=mosaic,
        raw=part.mosaic is not None,
        demosaic=None if part.raw_only else part.demosaic or "bilinear",
        pixel=PixelOverrides(
            bits=part.bits,
            black_level_dn=part.black_level,
            dark_current_e_per_s=part.dark_current_e_per_s,
            dsnu_e=part.dsnu_e,
            prnu=part.prnu,
            row_noise_e=part.row_noise_e,
        ),
        seed=seed,
        clip=part.clip,
        beyond=part.beyond,
        bad_pixels=part.bad_pixels,
        formats=part.formats,
    )


def prepared_cameras(
    study: Study,
    number: int,
    operating_points: list[OperatingPoint],
    makers: Mapping[str, MatrixMaker],
) -> tuple[Cube, dict[str, list[Camera]]]:
    """The cube, and the cameras of each matrix, of a part of the pictures (from 0).

    Raises
    ------
    InputError
        If the cube cannot be read, or as `capture_settings_of` and `camera_for`.
    """
    refuse_shared_file_names(operating_points)
    part, key = study.pictures[number], f"pictures.{number}"
    cube = cube_of(part, key=key)
    own = {name: f"{key}.{name}" for name in PicturePart.model_fields}
    own |= {"black_level_dn": f"{key}.black_level", "names of formats": f"{key}.formats"}
    own |= {"binning_mode": "sensors.0.pixel.binning_mode"}
    with keyed(key, lambda name: own.get(name, name), own):
        asked = capture_settings_of(part, seed=study.seed, key=key)
        return cube, {
            name: [camera_for(cube, each, maker(each), asked) for each in operating_points]
            for name, maker in makers.items()
        }


def first_frame(study: Study, number: int) -> int:
    """Of a part of the pictures (from 0): no two parts of a study share their noise."""
    return sum(part.frames for part in study.pictures[:number])


def pictures_taken(
    study: Study,
    number: int,
    cube: Cube,
    cameras: Mapping[str, list[Camera]],
    *,
    work: Work,
    folder: Path | None,
) -> Pictures:
    """Take the pictures of a part (from 0), and write them if a folder is given.

    Raises
    ------
    InputError
        If the cube holds what is no reflectance, or a file cannot be written.
    """
    part, summaries, kept = study.pictures[number], [], []
    points: dict[str, OperatingPoint] = {}
    for name, taken in captures(study, number, cube, cameras, work=work):
        points[taken.camera.operating_point.sensor.name] = taken.camera.operating_point
        if folder is None:
            summaries.append(picture_record(name, taken))
            kept.append(taken)
            continue
        sensor = taken.camera.operating_point.sensor.name
        stem = f"picture-{number + 1}-{file_word(sensor)}-{file_word(name)}"
        frame = any_picture(taken).frame - first_frame(study, number)
        files, missing = write_capture(
            folder, stem + (f"-{frame:04d}" if part.frames > 1 else ""), taken
        )
        summaries.append(picture_record(name, taken, files, missing))
    return Pictures(
        cube=part.cube,
        points=tuple(points.values()),
        summaries=tuple(summaries),
        captures=tuple(kept),
    )


def picture_record(
    matrix: str, taken: Capture, files: Sequence[str] = (), not_written: Sequence[str] = ()
) -> dict[str, Any]:
    """A picture as plain data: its matrix, settings and statistics.

    Parameters
    ----------
    matrix
        Name of the matrix.
    taken
        The picture.
    files, not_written
        Names of its files, and notes on those that could not be written.
    """
    record = {"matrix": matrix} | capture_summary(taken, list(files))
    return record | {"not_written": list(not_written)}


def captures(
    study: Study, number: int, cube: Cube, cameras: Mapping[str, list[Camera]], *, work: Work
) -> Iterator[tuple[str, Capture]]:
    """Each picture of a part (from 0) as it is taken, with the name of its matrix.

    Raises
    ------
    InputError
        If the cube holds what is no reflectance.
    """
    first, frames = first_frame(study, number), study.pictures[number].frames
    for i in range(len(study.sensors)):
        for name, own in cameras.items():
            for frame in range(first, first + frames):
                yield name, captured(cube, own[i], frame=frame, work=work)
