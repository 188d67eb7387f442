"""A study, run step by step: each step's result is plain data of its own."""

import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from chromanoise import __version__
from chromanoise._check import InputError, distinct
from chromanoise.color import SPACES
from chromanoise.exposure import Situation, white_scene
from chromanoise.imaging import Work, picture_summary, rendered, write_png, write_xyz_tiff
from chromanoise.scene.envi import DATA_SUFFIXES, envi_pair
from chromanoise.study.analysis import analyzed
from chromanoise.study.bands import bands_as_json, crossover_bands
from chromanoise.study.chart import chart_as_json, chart_noise
from chromanoise.study.comparison import compared, comparison_as_json, crossovers
from chromanoise.study.export import analyses_as_json, budgets_as_json
from chromanoise.study.makers import matrix_makers
from chromanoise.study.perceived import grey_noise, grey_noise_as_json
from chromanoise.study.quantities import QUANTITIES
from chromanoise.study.runs.document import PicturePart, Study, SweepPart
from chromanoise.study.runs.named import cube_of, situations_of
from chromanoise.study.sweeps import SWEEPS, swept_values
from chromanoise.study.words import is_file_name

Result = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One part of a run.

    Attributes
    ----------
    name
        Of its file, without ending.
    what
        In words.
    run
        Does it: writes pictures into the folder that it is given, and returns plain data.
    """

    name: str
    what: str
    run: Callable[[Path], Result]


def study_steps(study: Study, *, work: Work | None = None) -> list[Step]:
    """All that a study asks for, in order: analysis per matrix, sweeps, pictures.

    Raises
    ------
    InputError
        If a name names nothing or a file cannot be read; before anything is computed.
    """
    situations = situations_of(study)
    distinct("names of sensors", [situation.sensor.name for situation in situations])
    makers = matrix_makers(study.matrices, study.metric, prior=study.prior)  # type: ignore[arg-type]
    for part in study.pictures:
        cube_of(part)
    return [*_steps(study, situations, makers, work or Work())]


def _steps(study: Study, situations: list[Situation], makers: Any, work: Work) -> Iterator[Step]:
    for name in makers:
        yield Step(
            name=f"analysis-{_file_name(name)}",
            what=f"every stage with the {name} matrix",
            run=partial(_analysis, study, situations, makers[name]),
        )
    for i, sweep in enumerate(study.sweeps, 1):
        yield Step(
            name=f"sweep-{i}-{sweep.vary}-{sweep.quantity}",
            what=f"{QUANTITIES[sweep.quantity].what} over {SWEEPS[sweep.vary].what}",
            run=partial(_sweep, study, situations, makers, sweep),
        )
    for i, picture in enumerate(study.pictures, 1):
        yield Step(
            name=f"pictures-{i}",
            what=f"{picture.cube} through every sensor",
            run=partial(_pictures, study, situations, makers, picture, i, work),
        )


def study_hash(study: Study) -> str:
    """What decides all digits: the version, the study, and what stands in the files that it names.

    Raises
    ------
    InputError
        If one of the files cannot be read.
    """
    told = [__version__, study_as_json(study), file_digests(study)]
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def file_digests(study: Study) -> dict[str, str]:
    """SHA-256 of every file that a study names; of a folder or a pair, of all that belongs to it.

    Raises
    ------
    InputError
        If one of the files cannot be read.
    """
    words = [study.light.illuminant, *(s.name for s in study.sensors)]
    files = [Path(word) for word in words if is_file_name(word)]
    for picture in study.pictures:
        if not picture.cube.startswith("builtin:"):
            files += cube_files(Path(picture.cube))
    return {str(file): _digest(file) for file in dict.fromkeys(files)}


def cube_files(path: Path) -> list[Path]:
    """The file of a cube and what belongs to it: header and data, all that a folder holds."""
    if path.is_dir():
        return sorted(p for p in path.rglob("*") if p.is_file())
    pair = [path]
    if path.suffix.lower() in ("", ".hdr", *DATA_SUFFIXES) and path.exists():
        pair = list(envi_pair(path) or pair)
    return pair


def _digest(file: Path) -> str:
    try:
        with file.open("rb") as opened:
            return hashlib.file_digest(opened, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror})") from None


def study_as_json(study: Study) -> Result:
    """The study as plain data, all defaults said."""
    return study.model_dump(mode="json", by_alias=True)


def provenance(study: Study) -> Result:
    """What every output carries: who made it of what."""
    return {
        "version": __version__,
        "study": study_as_json(study),
        "seed": study.seed,
        "files": file_digests(study),
        "hash": study_hash(study),
    }


def _analysis(study: Study, situations: list[Situation], maker: Any, folder: Path) -> Result:
    analyses = [analyzed(white_scene(s), s.sensor, s.exposure, matrix=maker(s)) for s in situations]
    told = analyses_as_json(analyses)
    for own, analysis in zip(told["sensors"], analyses, strict=True):
        if study.outputs.budget:
            own |= budgets_as_json(analysis)
        if study.outputs.chart:
            own["chart"] = chart_as_json(chart_noise(analysis))
        if study.outputs.space:
            noise = grey_noise(analysis, SPACES[study.outputs.space])
            own["grey_noise"] = grey_noise_as_json(noise)
    return told


def _sweep(
    study: Study, situations: list[Situation], makers: Any, part: SweepPart, folder: Path
) -> Result:
    sweep, quantity = SWEEPS[part.vary], QUANTITIES[part.quantity]
    values = swept_values(sweep, part.first, part.last, part.points)
    curves = compared(situations, makers, values, sweep=sweep, quantity=quantity)
    told = comparison_as_json(curves, crossovers(situations, makers, curves))
    if part.all_priors:
        bands = crossover_bands(
            situations,
            study.matrices,
            values,
            metric=study.metric,  # type: ignore[arg-type]
            sweep=sweep,
            quantity=quantity,
        )
        told["bands"] = bands_as_json(bands)
    return told


def _pictures(
    study: Study,
    situations: list[Situation],
    makers: Any,
    part: PicturePart,
    number: int,
    work: Work,
    folder: Path,
) -> Result:
    cube = cube_of(part)
    told = []
    for situation in situations:
        for name, maker in makers.items():
            picture = rendered(
                cube,
                situation,
                matrix=maker(situation),
                seed=study.seed,
                frame=number - 1,
                clip=part.clip,
                beyond=part.beyond,
                work=work,
            )
            stem = f"picture-{number}-{situation.sensor.name}-{_file_name(name)}"
            write_png(folder / f"{stem}.png", picture.srgb)
            write_xyz_tiff(folder / f"{stem}.xyz.tiff", picture.xyz)
            files = [f"{stem}.png", f"{stem}.xyz.tiff"]
            told.append({"matrix": name, "files": files} | picture_summary(picture))
    return {"cube": part.cube, "pictures": told}


def _file_name(matrix: str) -> str:
    return matrix.replace("=", "-").replace("/", "-")
