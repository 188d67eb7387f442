"""Write a color matrix for other programs: CSV, JSON, CLF, camera-profile JSON.

CLF and the camera profile contain the white-normalized matrix. It maps raw divided by the raw of a
perfect white to XYZ with Y = 1 for that white, as in a raw converter after white balance.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from chromanoise import __version__, _check
from chromanoise._check import Array
from chromanoise._csv_cells import csv_comment, csv_text
from chromanoise._linalg import inv, matrix_rank
from chromanoise._shapes import Float
from chromanoise.color import ColorMatrix
from chromanoise.errors import InputError


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MadeMatrix:
    """A matrix with the conditions for which it was made.

    Attributes
    ----------
    sensor, illuminant
        Names of the sensor and the illuminant.
    level_lux, time_s, f_number, pitch_um
        The exposure and the pixel for which it was made. [lx], [s], [1], [um]
    matrix
        From raw electrons to XYZ. [lx/e-]
    white_e
        Expected electrons of a perfect white. [e-]
    white_lux
        Illuminance Y of the white. [lx]
    notes
        Notes, e.g. that curves are a reconstruction.
    """

    sensor: str
    illuminant: str
    level_lux: float
    time_s: float
    f_number: float
    pitch_um: float
    matrix: ColorMatrix
    white_e: Float[Array, " p"]
    white_lux: float
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        _check.same_length("channels", matrix=len(self.matrix.channels), white=self.white_e.size)
        _check.positive("white_lux", "lx", self.white_lux)
        _check.freeze(self, "white_e")


def balanced(made: MadeMatrix) -> Float[Array, "c p"]:
    """The matrix from raw over the raw of the white to XYZ over the Y of the white."""
    return np.asarray(made.matrix.matrix * made.white_e / made.white_lux)


def matrix_csv(made: MadeMatrix) -> str:
    """One row per color coordinate, in lx/e-; comments describe the matrix."""
    rows = zip(made.matrix.coordinates, made.matrix.matrix.tolist(), strict=True)
    table = csv_text([["lx/e-", *made.matrix.channels], *([name, *row] for name, row in rows)])
    facts = _facts(made).items()
    return "".join([*(csv_comment(name, str(value)) for name, value in facts), table])


def matrix_json(made: MadeMatrix) -> str:
    """All data: the matrix in lx/e- and white-normalized, its channels and how it was made."""
    data: dict[str, Any] = {
        **_facts(made),
        "channels": list(made.matrix.channels),
        "coordinates": list(made.matrix.coordinates),
        "matrix_lux_per_e": made.matrix.matrix.tolist(),
        "white_e": made.white_e.tolist(),
        "balanced": balanced(made).tolist(),
    }
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def matrix_clf(made: MadeMatrix) -> str:
    """Common LUT Format 3 (Academy S-2014-006): one 3 x 3 matrix, read by OpenColorIO.

    Raises
    ------
    InputError
        If the sensor does not have three channels.
    """
    _refuse_not_three(made, "CLF")
    rows = "\n".join("    " + " ".join(map(repr, row)) for row in balanced(made).tolist())
    identity = f"chromanoise-{made.sensor}-{made.matrix.made_by.split()[0]}"
    described = "\n".join(
        f"  <Description>{escape(f'{name}: {value}')}</Description>"
        for name, value in _facts(made).items()
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ProcessList xmlns="urn:AMPAS:CLF:v3.0" compCLFversion="3.0" id={quoteattr(identity)}>\n'
        f"{described}\n"
        f"  <InputDescriptor>{escape(made.sensor)}, raw over white</InputDescriptor>\n"
        "  <OutputDescriptor>CIE XYZ, Y = 1 for white</OutputDescriptor>\n"
        '  <Matrix inBitDepth="32f" outBitDepth="32f">\n'
        '   <Array dim="3 3">\n'
        f"{rows}\n"
        "   </Array>\n"
        "  </Matrix>\n"
        "</ProcessList>\n"
    )


def matrix_profile_json(made: MadeMatrix) -> str:
    """The matrix as JSON with the field names of a DNG camera profile.

    ``ColorMatrix1`` maps XYZ to camera native (raw over the largest raw of the white),
    ``AsShotNeutral`` is the white in it, ``CameraToXYZ`` maps white-balanced raw to XYZ.

    Raises
    ------
    InputError
        If the sensor does not have three channels, or the matrix has no inverse.

    Notes
    -----
    Adobe, Digital Negative Specification 1.7 (2023), chapter 6.
    """
    _refuse_not_three(made, "a camera profile")
    to_xyz, neutral = balanced(made), made.white_e / made.white_e.max()
    what = f"{made.matrix.made_by} matrix of {made.sensor}"
    if matrix_rank(what, to_xyz) < 3:
        raise InputError(
            what, "must have an inverse for a camera profile", remedy="export it as CSV or JSON"
        )
    data: dict[str, Any] = {
        "header": {"schema": "chromanoise camera profile", **_facts(made)},
        "ColorMatrix1": (neutral[:, None] * inv(what, to_xyz)).tolist(),
        "AsShotNeutral": neutral.tolist(),
        "CameraToXYZ": to_xyz.tolist(),
    }
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def matrix_writer(path: str, subject: str = "path") -> Callable[[MadeMatrix], str]:
    """The writer of the format that the ending of a name states.

    Parameters
    ----------
    path
        Name of the file: ``.csv``, ``.json``, ``.clf`` or ``.dcp.json``.
    subject
        What an error names.

    Raises
    ------
    InputError
        If the name has another ending.

    Examples
    --------
    >>> matrix_writer("camera.CLF").__name__
    'matrix_clf'
    """
    for ending, writer in _WRITERS.items():
        if path.lower().endswith(ending):
            return writer
    raise InputError(subject, f"must end in {', '.join(_WRITERS)}", value=path, remedy="rename it")


_WRITERS: dict[str, Callable[[MadeMatrix], str]] = {
    ".dcp.json": matrix_profile_json,
    ".csv": matrix_csv,
    ".json": matrix_json,
    ".clf": matrix_clf,
}


def _facts(made: MadeMatrix) -> dict[str, Any]:
    return {
        "version": __version__,
        "sensor": made.sensor,
        "made_by": made.matrix.made_by,
        "metric": made.matrix.metric,
        "observer": made.matrix.observer,
        "illuminant": made.illuminant,
        "level_lux": made.level_lux,
        "time_ms": 1e3 * made.time_s,
        "f_number": made.f_number,
        "pitch_um": made.pitch_um,
        "notes": "; ".join(made.notes),
    }


def _refuse_not_three(made: MadeMatrix, what: str) -> None:
    if len(made.matrix.channels) != 3:
        raise InputError(
            made.sensor,
            f"must have 3 channels for {what}",
            value=made.matrix.channels,
            found=f"has {len(made.matrix.channels)}: {', '.join(made.matrix.channels)}",
            remedy="export the matrix as CSV or JSON",
        )
