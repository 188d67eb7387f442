"""The pictures of a study for its report."""

from dataclasses import dataclass

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import UInt8
from chromanoise.charts import Shown
from chromanoise.imaging import Work
from chromanoise.study import Study
from chromanoise.study.pictures import prepared_cameras, taken_pictures


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sight:
    """One cube through every sensor.

    Attributes
    ----------
    cube
        As the study names it.
    denoised
        Name of the denoising method; empty for the noisy picture.
    matrix
        With which the colors are made.
    sensors
        Names, one per picture.
    pictures
        8-bit sRGB; none where the study asks for codes without color.
    """

    cube: str
    matrix: str
    sensors: tuple[str, ...]
    pictures: tuple[UInt8[Array, "h w 3"], ...]
    denoised: str = ""

    def __post_init__(self) -> None:
        if self.pictures:
            _check.same_length("pictures", sensors=len(self.sensors), pictures=len(self.pictures))


def sights_of(of: Shown, *, work: Work | None = None) -> tuple[Sight, ...]:
    """The first frame of each cube of a study through every sensor, with the first matrix.

    A cube whose pictures are denoised has two sights: before and after.

    Parameters
    ----------
    of
        The study with its results.
    work
        Threads and memory of the computation; ``None`` for the default.

    Raises
    ------
    InputError
        If a cube cannot be read, or holds what is no reflectance.
    """
    names = tuple(one.sensor.label for one in of.operating_points)
    matrix, maker = next(iter(of.makers.items()))
    sights = []
    for number, part in enumerate(of.study.pictures):
        cube, cameras = prepared_cameras(
            of.study, number, list(of.operating_points), {matrix: maker}
        )
        for method in dict.fromkeys((None, part.denoise)):
            study = _denoised_by(of.study, number, method)
            taken = taken_pictures(study, number, cube, cameras, work=work or Work(), frames=1)
            colors = (one.capture.picture for one in taken)
            pictures = tuple(picture.srgb for picture in colors if picture is not None)
            sights.append(
                Sight(
                    cube=part.cube,
                    matrix=matrix,
                    sensors=names,
                    pictures=pictures,
                    denoised=method or "",
                )
            )
    return tuple(sights)


def _denoised_by(study: Study, number: int, method: str | None) -> Study:
    """The study with one denoising method for a part of its pictures (from 0)."""
    parts = list(study.pictures)
    parts[number] = parts[number].model_copy(update={"denoise": method})
    return study.model_copy(update={"pictures": tuple(parts)})
