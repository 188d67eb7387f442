"""Options for a cube whose file does not declare everything."""

from collections.abc import Callable, Mapping
from typing import Any

import click

from chromanoise.catalog.resolve import file_of
from chromanoise.cli.parsing import pair
from chromanoise.errors import InputError

_OPTIONS = (
    click.option("--key", help="Name of the array in a MAT, NPZ, HDF5, NetCDF or Zarr cube."),
    click.option("--shape", metavar="ROWSxCOLUMNS", help="Shape of a cube stored as a 2-D array."),
    click.option(
        "--wavelengths",
        metavar="FIRST:LAST|FILE",
        help="Wavelengths of the bands, if the cube does not declare them: evenly spaced [nm], or "
        "a text file that lists one per band (nm, or the unit in its heading).",
    ),
    click.option(
        "--scale", "scale", type=float, help="Reflectance per stored unit of the cube, e.g. 0.0001."
    ),
)


def cube_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of a cube to a command."""
    for option in reversed(_OPTIONS):
        function = option(function)
    return function


def parsed_cube_options(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The values of those of `cube_options` that are text of several values."""
    return {
        "shape": pair("--shape", settings["shape"], "x", int),
        "wavelengths": _wavelengths(settings["wavelengths"]),
    }


def _wavelengths(text: str | None) -> tuple[float, float] | str | None:
    """The two ends of an even series, or the name of a file."""
    try:
        return pair("--wavelengths", text, ":", float)
    except InputError:
        if text and file_of(text).exists():
            return text
        raise InputError(
            "--wavelengths", "must be FIRST:LAST in nm, or a file that lists them", value=text
        ) from None
