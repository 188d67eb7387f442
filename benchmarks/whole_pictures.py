"""Cubes of some GB in memory to electrons, to codes, to color: against reading, C and numpy."""

from collections.abc import Callable
from statistics import median

from bandwidth import reading
from c_kernel import NoKernelError, c_paths, compiled
from plain_numpy import numpy_paths
from races import Ratio, Times, raced, ratio
from subject import BANDS, SEED, engine, large_cubes, operating_point, outputs_for, plans_of
from table import Row, Skipped

from chromanoise.imaging import Work, acquired, electrons_of_cube, rendered
from chromanoise.spectra import Cube

PATHS = {
    "electrons": ("electrons only", 0.70),
    "raw": ("mosaic + noise + ADC", 0.65),
    "color": ("all to XYZ and sRGB, 4-channel noise", 0.50),
}
_ASKED_OF_NUMPY, _ASKED_OF_C = 5.0, 0.8
_READ = "read"


def pictures_race(height: int, width: int, *, rounds: int, threads: int) -> tuple[Times, list[str]]:
    """Times of all that takes part, by names like ``BIP C raw``, and why some do not."""
    contenders: dict[str, Callable[[], object]] = {}
    missing: list[str] = []
    try:
        photograph = compiled()
    except NoKernelError as reason:
        photograph = None
        missing.append(str(reason))
    for order, cube in zip(("BIP", "BSQ"), large_cubes(height, width), strict=True):
        plans, out = plans_of(cube), outputs_for(height, width)
        contenders[f"{order} {_READ}"] = reading(cube.stored, threads)
        teams = {"here": engine(plans, out, threads)}
        if photograph is not None:
            teams["C"] = c_paths(photograph, plans, outputs_for(height, width), threads)
        if order == "BIP":
            teams["numpy"] = numpy_paths(plans, outputs_for(height, width), threads)
            teams["fresh"] = _fresh(cube, threads)
        for team, paths in teams.items():
            for path, work in paths.items():
                contenders[f"{order} {team} {path}"] = work
    return raced(contenders, rounds=rounds), missing


def _fresh(cube: Cube, threads: int) -> dict[str, Callable[[], object]]:
    """The public functions, which give new arrays at each call."""
    at, work = operating_point(), Work(threads=threads)
    return {
        "electrons": lambda: electrons_of_cube(cube, at, work=work),
        "raw": lambda: acquired(cube, at, seed=SEED, work=work),
        "color": lambda: rendered(cube, at, seed=SEED, work=work),
    }


def gigabytes_per_second(times: Times, order: str, pixels: int) -> float:
    """Read bandwidth of the machine in the same rounds, median."""
    return pixels * BANDS * 4 / median(times[f"{order} {_READ}"]) / 1e9


def picture_rows(times: Times, missing: list[str], pixels: int) -> list[Row | Skipped]:
    """Of reading first, then what numpy, C and fresh arrays take."""
    rows: list[Row | Skipped] = []

    def row(name: str, asked: float | None, measured: Ratio, own: str, unit: str = "x") -> None:
        rate = f"{median(times[own]) * 1e9 / pixels:.1f} ns/pixel"
        rows.append(Row(name, asked, measured, rate, unit))

    def of_reading(who: str) -> Ratio:
        return ratio(times, f"{who[:3]} {_READ}", who)

    for path, (name, asked) in PATHS.items():
        for order in ("BIP", "BSQ"):
            own = f"{order} here {path}"
            row(f"{name}, {order}: of reading", asked, of_reading(own), own, "%")
    own = "BIP here color"
    row("all, BIP: against tiled numpy", _ASKED_OF_NUMPY, ratio(times, "BIP numpy color", own), own)
    for path in ("electrons", "raw"):
        name, own = PATHS[path][0], f"BIP here {path}"
        row(f"{name}, BIP: against tiled numpy", None, ratio(times, f"BIP numpy {path}", own), own)
    rows += [Skipped("C kernel", reason) for reason in missing]
    for order in () if missing else ("BIP", "BSQ"):
        for path, (name, _) in PATHS.items():
            own, theirs = f"{order} here {path}", f"{order} C {path}"
            asked = _ASKED_OF_C if path == "color" else None
            row(f"{name}, {order}: speed of a C kernel", asked, ratio(times, theirs, own), own)
            row(f"{name}, {order}: C kernel of reading", None, of_reading(theirs), theirs, "%")
    for path, (name, _) in PATHS.items():
        own = f"BIP fresh {path}"
        row(f"{name}, BIP: of reading, into fresh arrays", None, of_reading(own), own, "%")
    return rows
