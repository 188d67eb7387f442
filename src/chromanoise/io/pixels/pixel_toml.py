"""A pixel as TOML, and checks that all text files of a pixel share.

Every value of the TOML file is optional; ``--pixel FILE`` takes it. Each fault of a file is an
error of its own.
"""

import json
import re
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from chromanoise.base import InputError, check, did_you_mean
from chromanoise.io.source_files import has, refused, small_text
from chromanoise.sensor import PIXEL, PIXEL_REQUIRED, Converter, PixelSource

_LARGEST_BYTES = 64 * 2**20


def source_text(path: Path) -> str:
    """The text of a small UTF-8 file.

    Raises
    ------
    InputError
        If the file cannot be read, is too large, or is not text.
    """
    need = f"must be at most {_LARGEST_BYTES // 2**20} MiB to describe a pixel"
    return small_text(path, _LARGEST_BYTES, need, "save it as UTF-8")


def in_file(error: InputError, path: Path) -> InputError:
    """The error with the file as its subject; the former subject becomes a place in the file.

    Parameters
    ----------
    error
        An error about the file, about a part of it (``pitch_um of sheet.txt``), or about a value.

    Examples
    --------
    >>> error = InputError("pitch_um of a.txt", "must be finite and > 0 [um]", value=0.0)
    >>> str(in_file(error, Path("sheets/a.txt")))
    'sheets/a.txt, pitch_um: must be finite and > 0 [um], but is 0'
    """
    if error.subject == str(path):
        return error
    part = "" if error.subject == path.name else error.subject.removesuffix(f" of {path.name}")
    return error.within(str(path), part)


@contextmanager
def errors_in_file(path: Path) -> Iterator[None]:
    """Turn errors that are raised inside into errors about the file, with `in_file`."""
    try:
        yield
    except InputError as error:
        raise in_file(error, path) from None


def finite_number(value: Any) -> float | None:
    """``value`` as a float if it is a finite number of JSON, else ``None``."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if abs(number) < float("inf") else None


PIXEL_SCHEMA = "chromanoise pixel"
PIXEL_SCHEMA_VERSION = 1

_UNIT_OF = {
    **{name: PIXEL[name].unit for name in PIXEL_REQUIRED},
    "gain_e_per_dn": "e-/DN",
    "bits": "1",
    "black_level_dn": "DN",
    **{name: one.unit for name, one in PIXEL.items() if name not in PIXEL_REQUIRED},
    "qe": "e-/photon",
    "qe_at_nm": "nm",
}
_GAIN = "gain_dn_per_e"
_TEXT = ("schema", "schema_version", "source", "notes")
_KEYS = (*_UNIT_OF, _GAIN, *_TEXT)
_SCHEMA_LINE = re.compile(r"(?m)^[ \t]*schema[ \t]*=")
_MOST_CHARACTERS = 2**20
_HEAD = f"""\
schema = "{PIXEL_SCHEMA}"
schema_version = {PIXEL_SCHEMA_VERSION}
"""


def is_pixel_toml_text(text: str) -> bool:
    r"""Whether a line of the text begins with ``schema =``.

    Examples
    --------
    >>> is_pixel_toml_text('schema = "chromanoise pixel"\n'), is_pixel_toml_text("K = 2 DN/e-")
    (True, False)
    """
    return _SCHEMA_LINE.search(text) is not None


def pixel_source_toml(source: PixelSource) -> str:
    r"""The values of a source as TOML, with all digits; `read_pixel_toml` reads it.

    Parameters
    ----------
    source
        The values; those that are ``None`` are left out. A converter (``adc``) is written as its
        bits, gain and black level.

    Examples
    --------
    >>> print(pixel_source_toml(PixelSource(source="a sheet", read_noise_e=2.4)), end="")
    schema = "chromanoise pixel"
    schema_version = 1
    source = "a sheet"
    read_noise_e = 2.4 # e-
    """
    known = {name: getattr(source, name) for name in _UNIT_OF}
    if source.adc is not None and source.bits is None:
        known |= {name: getattr(source.adc, name) for name in ("bits", "gain_e_per_dn")}
        known["black_level_dn"] = source.adc.black_level_dn
    lines = [
        f"{name} = {_number(value)} # {_UNIT_OF[name]}"
        for name, value in known.items()
        if value is not None
    ]
    notes = [f"  {_text(note)}," for note in source.notes]
    listed = ["notes = [", *notes, "]"] if notes else []
    return "\n".join([f"{_HEAD}source = {_text(source.source)}", *lines, *listed, ""])


def read_pixel_toml(path: Path | str) -> PixelSource:
    """The pixel of a TOML file.

    Parameters
    ----------
    path
        A file with ``schema = "chromanoise pixel"``, ``schema_version = 1`` and any of the
        properties of `chromanoise.sensor.Pixel`, ``gain_e_per_dn`` or ``gain_dn_per_e``, ``bits``,
        ``black_level_dn``, ``qe``, ``qe_at_nm``, ``source`` and ``notes``.

    Raises
    ------
    InputError
        If the file cannot be read, is not TOML, has another schema or an unknown key, gives the
        gain twice, or a value is not a number in the range of real pixels.
    """
    path = Path(path)
    held = _tables(path)
    _refuse_other_schema(held, path)
    _refuse_unknown(held, path)
    notes = _texts(held.get("notes", []), path, "notes")
    source = _texts([held.get("source", path.name)], path, "source")[0]
    with errors_in_file(path):
        values = _values(held, path)
        black = values.pop("black_level_dn", None)
        whole = None if black is None else round(black)
        if black is not None and whole != black:
            notes.append(f"{path.name}: black level of {black:g} DN rounded to {whole}")
        found = PixelSource(source=path.name, black_level_dn=whole, **values)
        Converter(
            bits=found.bits, gain_e_per_dn=found.gain_e_per_dn, black_level_dn=found.black_level_dn
        )
    return replace(found, source=source, notes=tuple(notes))


def _tables(path: Path) -> dict[str, Any]:
    text = source_text(path)
    if len(text) > _MOST_CHARACTERS:
        raise has(
            path, f"must have at most {_MOST_CHARACTERS} characters to describe a pixel", len(text)
        )
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise refused(path, f"is not TOML ({error})") from None
    except (RecursionError, ValueError):  # a number of thousands of digits is a ValueError
        raise refused(path, "is nested too deeply or holds a number that is too long") from None


def _refuse_other_schema(held: dict[str, Any], path: Path) -> None:
    wanted = {"schema": PIXEL_SCHEMA, "schema_version": PIXEL_SCHEMA_VERSION}
    for key, value in wanted.items():
        own = held.get(key)
        if own != value or isinstance(own, bool):
            need = f"must be {json.dumps(value)} for a pixel in TOML"
            found = "is missing" if key not in held else ""
            remedy = f"write {key} = {json.dumps(value)}"
            raise refused(path, need, own, found, where=key, remedy=remedy)


def _refuse_unknown(held: dict[str, Any], path: Path) -> None:
    for key in held:
        if key not in _KEYS:
            need = "is not a key of a pixel"
            remedy = did_you_mean(key, _KEYS, f"known: {', '.join(_KEYS)}")
            raise refused(path, need, where=check.printable(key), remedy=remedy)


def _values(held: dict[str, Any], path: Path) -> dict[str, Any]:
    """The numbers, with the gain in e-/DN."""
    values: dict[str, Any] = {}
    for key in (*_UNIT_OF, _GAIN):
        if key not in held:
            continue
        number = finite_number(held[key])
        if number is None:
            raise refused(path, "must be a finite number", held[key], where=key)
        if key in PIXEL:
            PIXEL[key].demand(f"{key} of {path.name}", number)
        else:
            check.not_negative(f"{key} of {path.name}", _UNIT_OF.get(key, ""), number)
        values[key] = number
    if _GAIN in values:
        if "gain_e_per_dn" in values:
            need = "must be given once"
            found = f"gain_e_per_dn and {_GAIN} are both given"
            remedy = "keep one of the two"
            raise refused(
                path, need, (held["gain_e_per_dn"], held[_GAIN]), found, where="gain", remedy=remedy
            )
        gain = check.positive(f"{_GAIN} of {path.name}", "DN/e-", values.pop(_GAIN))
        values["gain_e_per_dn"] = 1 / gain
    if "bits" in values:
        bits = values["bits"]
        if not float(bits).is_integer():
            raise refused(path, "must be a whole number", bits, where="bits")
        values["bits"] = int(bits)
    return values


def _texts(values: Any, path: Path, where: str) -> list[str]:
    if not isinstance(values, list) or not all(isinstance(value, str) for value in values):
        must = "must be text" if where == "source" else "must be a list of texts"
        raise refused(path, must, values, where=where)
    return list(values)


def _number(value: float) -> str:
    return repr(int(value)) if isinstance(value, int) else repr(float(value))


def _text(text: str) -> str:
    """A basic string of TOML: a JSON string, with the letter DEL escaped."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
