"""Color matrices and crosstalk tables in files: CSV, JSON, CLF, camera profiles (DNG, DCP, JSON).

A file to read holds one of two kinds of color matrix. ``electrons``: raw electrons to XYZ in lx/e-,
as `matrix_csv` writes it. ``balanced``: raw over the raw of a perfect white to XYZ with Y = 1 for
that white, or to linear sRGB, as camera makers give it. A DNG or DCP profile maps XYZ to camera
values.

CLF and the camera profile are written with the white-normalized matrix. It maps raw divided by the
raw of a perfect white to XYZ with Y = 1 for that white, as in a raw converter after white balance.

A crosstalk matrix or kernel is read from a table of text.
"""

import csv
import io
import re
import struct
from collections.abc import Callable, Iterable, Mapping
from html import escape
from pathlib import Path
from typing import Any, Literal

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    Setting,
    __version__,
    check,
    csv_comment,
    csv_text,
    dataclass,
    inputs,
    inv,
    json_text,
    matrix_rank,
    text_of_cell,
    text_of_comment,
)
from chromanoise.color import ColorMatrix
from chromanoise.io.source_files import errors_within, refused, small_text, xml_root
from chromanoise.sensor import Crosstalk, Mosaic, crosstalk_of_kernel

Kind = Literal["electrons", "balanced", "from-xyz"]
Target = Literal["XYZ", "sRGB"]

_LARGEST_FACT = 1e30  # of a time, pitch, f-number and level that a header names
_MOST_BYTES = 1_000_000
_MOST_PROFILE_BYTES = 2_000_000_000
MATRIX_ENDINGS = (".csv", ".txt", ".tsv", ".json", ".clf", ".xml", ".dng", ".dcp")
_CLF_NAMESPACE = re.compile(r"^\{.*\}")
# ColorMatrix1 to 3 and CalibrationIlluminant1 to 3 of DNG 1.6
_COLOR_MATRIX, _CALIBRATION = (50721, 50722, 52531), (50778, 50779, 52529)
_LIGHTS = {  # of Exif 2.32, LightSource: name and color temperature [K]
    1: ("daylight", 5500),
    2: ("fluorescent", 4230),
    3: ("tungsten", 2856),
    4: ("flash", 5500),
    9: ("fine weather", 5500),
    10: ("cloudy weather", 6500),
    11: ("shade", 7500),
    12: ("daylight fluorescent", 6430),
    13: ("day white fluorescent", 5000),
    14: ("cool white fluorescent", 4150),
    15: ("white fluorescent", 3450),
    17: ("A", 2856),
    18: ("B", 4874),
    19: ("C", 6774),
    20: ("D55", 5503),
    21: ("D65", 6504),
    22: ("D75", 7504),
    23: ("D50", 5003),
    24: ("ISO studio tungsten", 3200),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class GivenMatrix:
    """A color matrix of a file.

    Attributes
    ----------
    kind
        ``electrons``: raw electrons to XYZ [lx/e-]; ``balanced``: raw over the raw of a white;
        ``from-xyz``: XYZ to camera values (DNG, chapter 6).
    target
        What the rows give: XYZ, or linear sRGB.
    values
        3 rows and one column per channel; one row per channel and 3 columns for ``from-xyz``.
    channels
        Names of the channels; empty if the file has none: then in the order of the sensor.
    light_time
        Exposure for which an ``electrons`` matrix was made, t a^2 / f#^2; ``None`` if unknown.
        [s um2]
    kelvin
        Color temperature of the calibration of a profile; ``None`` if unknown. [K]
    observer
        Observer of X, Y, Z; empty if the file does not name it.
    sensor, illuminant
        For which it was made; empty if the file does not name them.
    level_lux
        Illuminance for which it was made; ``None`` if unknown. [lx]
    notes
        Which of several matrices of the file it is.

    Raises
    ------
    InputError
        If an entry is not finite, the shape does not fit, or the exposure is not above 0.
    """

    source: str
    kind: Kind
    target: Target
    values: Float[Array, "a b"]
    channels: tuple[str, ...] = ()
    light_time: float | None = None
    kelvin: float | None = None
    observer: str = ""
    sensor: str = ""
    illuminant: str = ""
    level_lux: float | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        values = check.finite(f"matrix of {self.source}", "1", self.values)
        rows = values.shape[1] if self.kind == "from-xyz" else values.shape[0]
        if values.ndim != 2 or rows != 3:
            wide = self.kind == "from-xyz"
            what = "3 columns (X, Y, Z)" if wide else "3 rows (X, Y, Z or R, G, B)"
            found = f"has shape {values.shape}"
            raise refused(f"matrix of {self.source}", f"must have {what}", values.shape, found)
        if self.light_time is not None:
            check.positive(f"t a^2 / f#^2 of {self.source}", "s um2", self.light_time)
        object.__setattr__(self, "values", check.frozen(values))


def is_matrix_file(word: str) -> bool:
    """Whether a word names a file of a matrix, by its ending.

    Examples
    --------
    >>> is_matrix_file("mine.dcp"), is_matrix_file("ridge=0.01")
    (True, False)
    """
    return word.lower().endswith(MATRIX_ENDINGS)


def matrix_of_array(values: Any, name: str) -> GivenMatrix:
    """A matrix of numbers, raw electrons to X, Y, Z.

    Parameters
    ----------
    values
        3 rows and one column per channel, in the order of the sensor. [lx/e-]
    name
        Name of the matrix.

    Raises
    ------
    InputError
        If the values are not numbers, one is not finite, or there are not 3 rows.
    """
    return GivenMatrix(source=name, kind="electrons", target="XYZ", values=_array(name, values))


def read_matrix(path: Path) -> GivenMatrix:
    """The color matrix of a file, by its content.

    Parameters
    ----------
    path
        CSV, JSON, CLF, DNG or DCP.

    Raises
    ------
    InputError
        If the file cannot be read, or holds no matrix of this kind.
    """
    size = inputs.regular_file(path).st_size
    with path.open("rb") as file:
        start = file.read(4)
        if start in (b"II*\0", b"MM\0*", b"IIRC", b"MMCR"):
            if size > _MOST_PROFILE_BYTES:
                raise refused(path, "must have at most 2 GB", size)
            return _profile(path, file)
        if size > _MOST_BYTES:
            raise refused(path, f"must have at most {_MOST_BYTES} bytes as a matrix", size)
        try:
            text = (start + file.read()).decode("utf-8-sig")
        except UnicodeDecodeError:
            raise refused(
                path, "must be CSV, JSON, CLF, DNG or DCP", found="is neither text nor TIFF"
            ) from None
    stripped = text.lstrip()
    if stripped.startswith("{"):
        return _json(str(path), text)
    if stripped.startswith("<"):
        return _clf(str(path), text)
    return _csv(str(path), text)


def _csv(source: str, text: str) -> GivenMatrix:
    said = re.findall(r"^#\s*(\w+):\s*(.*)$", text, flags=re.MULTILINE)
    facts = {key: text_of_comment(value) for key, value in said}
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    try:
        rows = [[cell.strip() for cell in row] for row in csv.reader(io.StringIO("\n".join(lines)))]
    except csv.Error as error:
        raise refused(source, f"is not CSV ({error})") from None
    if len(rows) < 3:
        raise refused(source, "must hold a matrix of 3 rows", len(rows))
    head = rows[0]
    if are_numbers(head):  # numbers only
        return GivenMatrix(
            source=source, kind="balanced", target="sRGB", values=_array(source, rows)
        )
    names = [row[0] for row in rows[1:]]
    targets: dict[tuple[str, ...], Target] = {("X", "Y", "Z"): "XYZ", ("R", "G", "B"): "sRGB"}
    if tuple(names) not in targets:
        need = "must have the rows X, Y, Z (or R, G, B for linear sRGB)"
        raise refused(source, need, names, f"has {', '.join(names)[:80]}")
    absolute = head[0] == "lx/e-"
    return GivenMatrix(
        source=source,
        kind="electrons" if absolute else "balanced",
        target=targets[tuple(names)],
        values=_array(source, [row[1:] for row in rows[1:]]),
        channels=tuple(map(text_of_cell, head[1:])),
        light_time=_light_time(source, facts) if absolute else None,
        **_made_for(source, facts),
    )


_KINDS: dict[str, Kind] = {
    "matrix_lux_per_e": "electrons",
    "balanced": "balanced",
    "CameraToXYZ": "balanced",
    "ColorMatrix1": "from-xyz",
}
"""Kinds of matrices by their keys in JSON; the first that a file has is used."""


def _json(source: str, text: str) -> GivenMatrix:
    held = inputs.json_of(text, source)
    channels = held.get("channels", [])
    if not isinstance(channels, list):
        raise refused(source, "must list the names of its channels", channels)
    channels = tuple(map(str, channels))
    for key, kind in _KINDS.items():
        if key not in held:
            continue
        absolute = kind == "electrons"
        header = held if absolute else held.get("header", held)
        lights = {
            name: str(held.get(f"CalibrationIlluminant{name[-1]}", "unknown light"))
            for name in ("ColorMatrix1", "ColorMatrix2", "ColorMatrix3")
            if kind == "from-xyz" and held.get(name)
        }
        return GivenMatrix(
            source=source,
            kind=kind,
            target="XYZ",
            values=_array(source, held[key]),
            channels=channels,
            light_time=_light_time(source, held) if absolute else None,
            notes=_choice(source, lights, key),
            **_made_for(source, header if isinstance(header, dict) else {}),
        )
    keys = ", ".join(map(str, list(held)[:8]))[:80]
    need = "must hold matrix_lux_per_e, balanced, CameraToXYZ or ColorMatrix1"
    raise refused(source, need, list(held)[:8], f"holds {keys or 'nothing'}")


def _clf(source: str, text: str) -> GivenMatrix:
    root = xml_root(text, source)
    nodes = [node for node in root.iter() if _CLF_NAMESPACE.sub("", str(node.tag)) != "Description"]
    steps = [n for n in root if "BitDepth" in " ".join(n.attrib)]
    arrays = [node for node in nodes if _CLF_NAMESPACE.sub("", str(node.tag)) == "Array"]
    if len(arrays) != 1 or len(steps) != 1:
        found = f"has {len(steps)} steps and {len(arrays)} arrays"
        raise refused(source, "must be a CLF of one matrix", len(steps), found)
    (step,), words = steps, (arrays[0].text or "").split()
    depths = {step.attrib.get("inBitDepth"), step.attrib.get("outBitDepth")}
    if not depths <= {"16f", "32f"}:
        raise refused(source, "must have inBitDepth and outBitDepth 32f", sorted(map(str, depths)))
    size = arrays[0].attrib.get("dim", "").split()[:2]
    if size not in (["3", "3"], ["3", "4"]) or len(words) != 3 * int(size[1]):
        raise refused(source, "must have an array of dim 3 3", size)
    values = _array(source, [words[i * int(size[1]) :][: int(size[1])] for i in range(3)])
    if values.shape[1] == 4 and values[:, 3].any():
        raise refused(source, "must have no offsets", values[:, 3].tolist())
    said = " ".join(
        (n.text or "") for n in root.iter() if str(n.tag).endswith("OutputDescriptor")
    ).lower()
    target: Target = "sRGB" if "rgb" in said and "xyz" not in said else "XYZ"
    return GivenMatrix(source=source, kind="balanced", target=target, values=values[:, :3])


def _profile(path: Path, file: Any) -> GivenMatrix:
    """Color matrices of a DNG or DCP: the entries of the first directory of a TIFF."""
    source = str(path)
    file.seek(0)
    header = file.read(8)
    order = "<" if header[:2] == b"II" else ">"
    tags: dict[int, list[float]] = {}
    try:
        file.seek(struct.unpack(order + "I", header[4:])[0])
        (count,) = struct.unpack(order + "H", file.read(2))
        entries = file.read(12 * count)
        for i in range(count):
            tag, kind, size, place = struct.unpack(order + "HHII", entries[12 * i : 12 * i + 12])
            if tag in _COLOR_MATRIX and kind == 10 and size <= 12:
                file.seek(place)
                if not size or size % 3:
                    raise refused(
                        source, "must have 3 numbers per channel in its color matrix", size
                    )
                pairs = struct.unpack(order + "ii" * size, file.read(8 * size))
                tags[tag] = [n / d for n, d in zip(pairs[::2], pairs[1::2], strict=True)]
            elif tag in _CALIBRATION and kind == 3:
                raw = entries[12 * i + 8 : 12 * i + 10]
                tags[tag] = [float(struct.unpack(order + "H", raw)[0])]
    except (struct.error, ZeroDivisionError) as error:
        raise refused(source, f"is a damaged camera profile ({error})") from None
    if _COLOR_MATRIX[0] not in tags:
        raise refused(source, "must hold a ColorMatrix1 to be a color matrix", found="has none")
    lights = {
        f"ColorMatrix{i}": (tag, _LIGHTS.get(int(tags.get(light, [0])[0])))
        for i, (tag, light) in enumerate(zip(_COLOR_MATRIX, _CALIBRATION, strict=True), 1)
        if tag in tags
    }
    used = max(lights, key=lambda name: (lights[name][1] or ("", 0))[1])
    tag, light = lights[used]
    names = {
        name: f"{one[0]}, {one[1]} K" if one else "unknown light"
        for name, (_, one) in lights.items()
    }
    return GivenMatrix(
        source=source,
        kind="from-xyz",
        target="XYZ",
        values=np.array(tags[tag]).reshape(-1, 3),
        kelvin=None if light is None else light[1],
        notes=_choice(source, names, used),
    )


def _choice(source: str, lights: Mapping[str, str], used: str) -> tuple[str, ...]:
    """A note on a file of several matrices: which one is used, and which are not."""
    others = [f"{name} ({light})" for name, light in lights.items() if name != used]
    if not others:
        return ()
    verb = "is" if len(others) == 1 else "are"
    return (
        f"{source} has {len(lights)} matrices, each for another light: {used} ({lights[used]}) is "
        f"used; {' and '.join(others)} {verb} not used; matrices are not interpolated for other "
        "lights",
    )


def _made_for(source: str, facts: Mapping[str, Any]) -> dict[str, Any]:
    """Observer, sensor and light that the header of a file names."""
    named = {key: str(facts.get(key, "")).strip() for key in ("observer", "sensor", "illuminant")}
    return {**named, "level_lux": _fact(source, facts, "level_lux")}


def _light_time(source: str, facts: Mapping[str, Any]) -> float | None:
    """T a^2 / f#^2 of the header of a file; ``None`` where it lacks one of them. [s um2]"""
    time_ms, pitch_um, f_number = (
        _fact(source, facts, key) for key in ("time_ms", "pitch_um", "f_number")
    )
    if time_ms is None or pitch_um is None or f_number is None:
        return None
    return 1e-3 * time_ms * pitch_um**2 / f_number**2


def _fact(source: str, facts: Mapping[str, Any], key: str) -> float | None:
    """A positive number of the header of a file; ``None`` where it lacks it."""
    said = facts.get(key)
    if said is None or said == "":
        return None
    try:
        number = 0.0 if isinstance(said, bool) else float(said)
    except (TypeError, ValueError, OverflowError):
        number = 0.0
    if not 1 / _LARGEST_FACT <= number <= _LARGEST_FACT:
        need, where = f"must be a number of 1e-30 to {_LARGEST_FACT:g}", f"{key} of the matrix"
        raise refused(source, need, said, where=where, remedy=("correct it", "remove it"))
    return number


def are_numbers(cells: Iterable[str]) -> bool:
    """Whether each cell is a number."""
    try:
        [float(cell) for cell in cells]
    except ValueError:
        return False
    return True


def _array(source: str, rows: Any) -> Float[Array, "a b"]:
    try:
        values = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise refused(
            source, "must hold a matrix of numbers", found=f"does not ({str(error)[:80]})"
        ) from None
    if values.ndim != 2 or not values.size:
        found = f"holds an array of shape {values.shape}"
        raise refused(source, "must hold a matrix of rows and columns", values.shape, found)
    return values


@dataclass(frozen=True, kw_only=True, eq=False)
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
        check.same_length("channels", matrix=len(self.matrix.channels), white=self.white_e.size)
        check.positive("white_lux", "lx", self.white_lux)
        check.freeze(self, "white_e")


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
    return json_text(data)


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
        f"  <Description>{escape(f'{name}: {value}', quote=False)}</Description>"
        for name, value in _facts(made).items()
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ProcessList xmlns="urn:AMPAS:CLF:v3.0" compCLFversion="3.0" id="{escape(identity)}">\n'
        f"{described}\n"
        f"  <InputDescriptor>{escape(made.sensor, quote=False)}, raw over white</InputDescriptor>\n"
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
        raise refused(
            what, "must have an inverse for a camera profile", remedy="export it as CSV or JSON"
        )
    data: dict[str, Any] = {
        "header": {"schema": "chromanoise camera profile", **_facts(made)},
        "ColorMatrix1": (neutral[:, None] * inv(what, to_xyz)).tolist(),
        "AsShotNeutral": neutral.tolist(),
        "CameraToXYZ": to_xyz.tolist(),
    }
    return json_text(data)


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
    raise refused(subject, f"must end in {', '.join(_WRITERS)}", path, remedy="rename it")


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
        need = f"must have 3 channels for {what}"
        found = f"has {len(made.matrix.channels)}: {', '.join(made.matrix.channels)}"
        remedy = "export the matrix as CSV or JSON"
        raise refused(made.sensor, need, made.matrix.channels, found, remedy=remedy)


_MOST_BYTES_OF_CROSSTALK = 100_000


def read_crosstalk(path: Path, names: tuple[str, ...], mosaic: Mosaic | None) -> Crosstalk:
    """The crosstalk in a file: a matrix with a heading of channel names, or a kernel of neighbors.

    Parameters
    ----------
    path
        Comma, semicolon, tab or space between numbers; lines that start with ``#`` are comments.
        A matrix names the channels in its first line, each row optionally in its first column:
        row i holds the shares of each channel that channel i receives. Numbers without names are
        a kernel: the shares of the light of one pixel that end around it.
    names
        The channels of the sensor.
    mosaic
        Its mosaic: needed for a kernel, and counts the pixels of each channel for a matrix.

    Raises
    ------
    InputError
        If the file is no such table, its channels differ from the sensor's, a kernel is given
        without mosaic, or a channel gives more light than it has.
    """
    table = crosstalk_table(path)
    if table.columns:
        return _matrix(path, table, names, mosaic)
    if mosaic is None:
        need = "must name the channels in its first line, or be a kernel for a mosaic"
        found = "has numbers only, and the sensor has no mosaic"
        raise refused(path, need, table.values.shape, found, remedy=Setting("mosaic"))
    with errors_within(path):
        return crosstalk_of_kernel(table.values, mosaic, names)


@dataclass(frozen=True, kw_only=True, eq=False)
class CrosstalkTable:
    """The numbers of a crosstalk file, before they are applied to a sensor.

    Attributes
    ----------
    columns, rows
        Names of the channels of each column and row; empty for a kernel.
    values
        Shares of the light; a matrix has as many rows as columns. [1]
    """

    columns: tuple[str, ...]
    rows: tuple[str, ...]
    values: Float[Array, "r c"]


def crosstalk_table(path: Path) -> CrosstalkTable:
    """The numbers of a crosstalk file; their range is checked with the sensor.

    Parameters
    ----------
    path
        As for `read_crosstalk`.

    Raises
    ------
    InputError
        If the file is no table of numbers, or a matrix with names is not square.
    """
    rows = _rows(path)
    if are_numbers(rows[0]):
        if len({len(row) for row in rows}) > 1:
            raise refused(path, "must have rows of equal length", len(rows))
        return CrosstalkTable(columns=(), rows=(), values=_numbers(path, rows, first=0))
    head, body = rows[0], rows[1:]
    has_labels = bool(body) and not are_numbers(body[0][:1])
    cells = [row[1:] if has_labels else row for row in body]
    columns = head[1:] if cells and len(head) == len(cells[0]) + 1 else head
    if len(cells) != len(columns) or any(len(row) != len(columns) for row in cells):
        need = f"must have {len(columns)} rows of {len(columns)} numbers"
        raise refused(path, need, [len(row) for row in cells])
    return CrosstalkTable(
        columns=tuple(columns),
        rows=tuple(row[0] for row in body) if has_labels else tuple(columns),
        values=_numbers(path, cells, first=1),
    )


def _rows(path: Path) -> list[list[str]]:
    most = _MOST_BYTES_OF_CROSSTALK
    text = small_text(path, most, f"must have at most {most} bytes")
    lines = [line.strip() for line in text.splitlines()]
    used = [line for line in lines if line and not line.startswith("#")]
    if not used:
        raise refused(path, "must hold a table of numbers", found="is empty")
    mark = next((mark for mark in (",", ";", "\t") if mark in used[0]), None)
    return [[cell.strip() for cell in line.split(mark)] for line in used]


def _matrix(
    path: Path, table: CrosstalkTable, names: tuple[str, ...], mosaic: Mosaic | None
) -> Crosstalk:
    for what, given in (("columns", table.columns), ("rows", table.rows)):
        if sorted(given) != sorted(names):
            need = f"must have {what} for the channels {', '.join(names)}"
            raise refused(path, need, given, f"has {', '.join(given)[:80]}")
    order_rows = [table.rows.index(name) for name in names]
    order_columns = [table.columns.index(name) for name in names]
    pixels = (1,) * len(names)
    if mosaic is not None and sorted(mosaic.names) == sorted(names):
        flat = [channel for row in mosaic.pattern for channel in row]
        pixels = tuple(flat.count(name) for name in names)
    with errors_within(path):
        return Crosstalk(matrix=table.values[np.ix_(order_rows, order_columns)], pixels=pixels)


def _numbers(path: Path, rows: list[list[str]], *, first: int) -> Float[Array, "r c"]:
    for line, row in enumerate(rows, start=first + 1):
        for cell in row:
            if not are_numbers([cell]):
                raise refused(path, "must hold numbers", cell, where=f"row {line} of the table")
    return np.array([[float(cell) for cell in row] for row in rows])
