"""The pictures of a study: their settings and cameras, prepared before the computation."""

from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from chromanoise.analysis.color_matrices import MatrixMaker
from chromanoise.catalog.objects import shown_word
from chromanoise.denoising import DENOISING, captured_with
from chromanoise.exposure import OperatingPoint
from chromanoise.imaging import Work
from chromanoise.imaging.capture import (
    Camera,
    Capture,
    CaptureSettings,
    camera_for,
    capture_summary,
    write_capture,
)
from chromanoise.scene import Cube
from chromanoise.sensor import PIXEL_NOISE, PixelOverrides, mosaic_named
from chromanoise.study.assembly import NOTHING_GIVEN, Given, cube_of, keyed
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
            **{name: getattr(part, name) for name in PIXEL_NOISE},
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
    given: Given = NOTHING_GIVEN,
) -> tuple[Cube, dict[str, list[Camera]]]:
    """The cube, and the cameras of each matrix, of a part of the pictures (from 0).

    Parameters
    ----------
    study
        The study.
    number
        Which part, from 0.
    operating_points
        Operating points of the sensors.
    makers
        Methods of color matrices by name.
    given
        Objects in place of names.

    Raises
    ------
    InputError
        If the cube cannot be read, or as `capture_settings_of` and `camera_for`.
    """
    refuse_shared_file_names(operating_points)
    part, key = study.pictures[number], f"pictures.{number}"
    cube = cube_of(part, key=key, given=given)
    with _keyed(key):
        settings = capture_settings_of(part, seed=study.seed, key=key)
        return cube, {
            name: [camera_for(cube, each, maker(each), settings) for each in operating_points]
            for name, maker in makers.items()
        }


def _keyed(key: str) -> AbstractContextManager[None]:
    """An error inside names the keys of a part of the pictures."""
    own = {name: f"{key}.{name}" for name in PicturePart.model_fields}
    own |= {"black_level_dn": f"{key}.black_level", "names of formats": f"{key}.formats"}
    own |= {"binning_mode": "sensors.0.pixel.binning_mode"}
    return keyed(key, lambda name: own.get(name, name), own)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TakenPicture:
    """One picture of a study.

    Attributes
    ----------
    matrix
        Name of its color matrix.
    capture
        Its codes, its color, or both.
    stem
        Name of its files without their endings.
    files, not_written
        Names of the files that were written, and notes on those that could not be.
    """

    matrix: str
    capture: Capture
    stem: str
    files: list[str]
    not_written: list[str]

    @property
    def record(self) -> dict[str, Any]:
        """The picture as plain data: its matrix, settings, statistics and files."""
        data = {"matrix": self.matrix} | capture_summary(self.capture, self.files)
        return data | {"not_written": self.not_written}


def taken_pictures(
    study: Study,
    number: int,
    cube: Cube,
    cameras: Mapping[str, list[Camera]],
    *,
    work: Work,
    folder: Path | None = None,
    stem: str = "picture-{number}-{sensor}-{matrix}",
    frames: int | None = None,
) -> Iterator[TakenPicture]:
    """Each picture of a part (from 0) as soon as it is taken and, if a folder is given, written.

    Parameters
    ----------
    study, number, cube, cameras
        The study, the part, and the result of `prepared_cameras` for it.
    work
        Threads or executor for the computation.
    folder
        Folder for the files; ``None`` to write none.
    stem
        Names of the files; the frame is added where the part has several.
    frames
        Number of frames, the first ones; ``None`` for those of the part.

    Raises
    ------
    InputError
        If the cube holds what is no reflectance, or a file cannot be written.
    """
    part = study.pictures[number]
    first = sum(one.frames for one in study.pictures[:number])  # no two parts share their noise
    work = replace(work, folder=folder)
    method = None if part.denoise is None else DENOISING[part.denoise]
    for i in range(len(study.sensors)):
        for name, own in cameras.items():
            sensor = file_word(own[i].operating_point.sensor.name)
            start = stem.format(number=number + 1, sensor=sensor, matrix=file_word(name))
            for frame in range(part.frames if frames is None else frames):
                with _keyed(f"pictures.{number}"):
                    capture = captured_with(cube, own[i], method, frame=first + frame, work=work)
                full = start + (f"-{frame:04d}" if part.frames > 1 else "")
                files, missing = write_capture(folder, full, capture) if folder else ([], [])
                yield TakenPicture(
                    matrix=name, capture=capture, stem=full, files=files, not_written=missing
                )
                del capture  # before the next one needs memory


def pictures_taken(
    study: Study,
    number: int,
    cube: Cube,
    cameras: Mapping[str, list[Camera]],
    *,
    work: Work,
    folder: Path | None,
) -> Pictures:
    """All pictures of a part (from 0), in memory, or summaries of those that were written.

    Raises
    ------
    InputError
        As `taken_pictures`.
    """
    summaries, kept = [], []
    points: dict[str, OperatingPoint] = {}
    for one in taken_pictures(study, number, cube, cameras, work=work, folder=folder):
        point = one.capture.camera.operating_point
        points[point.sensor.name] = point
        summaries.append(one.record)
        if folder is None:
            kept.append(one.capture)
        del one  # before the next one needs memory
    return Pictures(
        cube=shown_word(study.pictures[number].cube),
        points=tuple(points.values()),
        summaries=tuple(summaries),
        captures=tuple(kept),
    )
