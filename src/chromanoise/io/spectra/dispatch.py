"""Read a file of spectra: choose the reader and turn its exceptions into errors."""

import codecs
import re
import warnings
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from chromanoise._inputs import regular_file
from chromanoise.errors import InputError
from chromanoise.io.matlab import is_matlab
from chromanoise.io.spectra.asd import is_asd, read_asd
from chromanoise.io.spectra.cgats import is_cgats, read_cgats
from chromanoise.io.spectra.delimited import read_delimited
from chromanoise.io.spectra.envi import envi_pair
from chromanoise.io.spectra.envi_library import envi_library, read_envi_library
from chromanoise.io.spectra.fits import read_fits
from chromanoise.io.spectra.interpretation import meaning_of
from chromanoise.io.spectra.isetcam import read_isetcam
from chromanoise.io.spectra.jcamp import is_jcamp, read_jcamp
from chromanoise.io.spectra.json_forms import read_json
from chromanoise.io.spectra.kinds import kind_of, kind_of_zip
from chromanoise.io.spectra.parsed import ASK, Answers, Found, ParsedSpectra
from chromanoise.io.spectra.tm27 import read_tm27
from chromanoise.io.spectra.workbook import read_workbook

_LARGEST_BYTES = 4 * 2**20
_LARGEST_LIBRARY_BYTES = 32 * 2**20
_MOST_CURVES = 10_000
_MOST_HIGH = 0.1
_CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f]")


def read_curves(path: Path | str | Found, *, answers: Answers = ASK) -> ParsedSpectra:
    r"""Read the curves of a file, and report how the file was parsed.

    Supported are delimited text with the usual separators, digitized curves, JCAMP-DX ``.jdx``,
    ISETCam and Psychtoolbox ``.mat``, ASD ``.asd``, cameras of Jiang et al. ``.mat``, JSON of this
    library, of rawtoaces, of DCamProf (ssf-data) or in plain lists, CGATS and Argyll ``.sp``, IES
    TM-27 ``.spdx``, ENVI spectral libraries ``.sli`` with ``.hdr``, FITS tables, and ``.xlsx``. The
    content of the file selects the reader, not its name.

    Parameters
    ----------
    path
        The file, of 4 MiB at most, or 32 MiB for a library with an ENVI header; or curves that
        are in memory.
    answers
        Metadata that the file lacks.

    Returns
    -------
    ParsedSpectra
        The curves, with unit and level and how they were determined.

    Raises
    ------
    InputError
        If the file cannot be read; the message names the file, and the line of a text file.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder) / "lamp.csv"
    ...     _ = file.write_text("Wavelength [um];QE (%)\n0,4;12,5\n0,5;50,0\n")
    ...     read = read_curves(file)
    >>> read.curves.wavelength_nm, read.curves.values.ravel(), read.delimiter, read.decimal
    (array([400., 500.]), array([0.125, 0.5  ]), 'semicolon', ',')
    """
    if isinstance(path, Found):
        return _meaning(path, answers)
    path = Path(path)
    with _errors_of(path):
        return _meaning(_found(path, _content(path)), answers)


def _meaning(found: Found, answers: Answers) -> ParsedSpectra:
    if len(found.columns) > _MOST_CURVES:
        raise InputError(
            found.source,
            f"must have at most {_MOST_CURVES} curves",
            value=len(found.columns),
            found=f"has {len(found.columns)}",
            remedy="split them",
        )
    return meaning_of(found, answers)


def _content(path: Path) -> bytes:
    library = regular_file(path).st_size > _LARGEST_BYTES and envi_pair(path) is not None
    _refuse_large(path, _LARGEST_LIBRARY_BYTES if library else _LARGEST_BYTES)
    return path.read_bytes()


def _refuse_large(path: Path, largest: int) -> None:
    size = regular_file(path).st_size
    if size > largest:
        raise InputError(
            str(path),
            f"must be at most {largest // 2**20} MiB for a table of spectra",
            value=size,
            found=f"is {size / 2**20:.0f} MiB",
            remedy="remove what is not a curve",
        )


def _found(path: Path, content: bytes) -> Found:
    if is_matlab(content):
        return read_isetcam(path)
    if is_asd(content):
        return read_asd(path, content)
    if content.startswith(b"SIMPLE  ="):
        return read_fits(path, content)
    library = envi_library(path, content)
    if library is not None:
        _refuse_large(library[1], _LARGEST_LIBRARY_BYTES)
        return read_envi_library(*library)
    _refuse_kind(path, kind_of(content))
    if content.startswith(b"PK\x03\x04"):
        with zipfile.ZipFile(path) as archive:
            _refuse_kind(path, kind_of_zip(archive.namelist()))
        return read_workbook(path)
    text, notes = _decoded(path, content)
    found = _of_text(text, str(path))
    return replace(found, notes=(*notes, *found.notes))


def _of_text(text: str, source: str) -> Found:
    start = text.lstrip()[:1]
    if start == "{":
        return read_json(text, source)
    if start == "<":
        return read_tm27(text, source)
    if is_jcamp(text):
        return read_jcamp(text, source)
    if is_cgats(text):
        return read_cgats(text, source)
    return read_delimited(text, source)


def _refuse_kind(path: Path, kind: tuple[str, str] | None) -> None:
    if kind is not None:
        raise InputError(
            str(path),
            "is not a file of spectra",
            value=kind[0],
            found=f"is {kind[0]}",
            remedy=kind[1],
        )


def _decoded(path: Path, content: bytes) -> tuple[str, tuple[str, ...]]:
    """The text, and a note if the file does not declare its character encoding."""
    coding, notes = _coding(content)
    try:
        text = content.decode(coding)
    except UnicodeDecodeError as error:
        raise InputError(
            str(path),
            "is not UTF-8 text",
            where=f"byte {error.start}",
            remedy="save it as CSV UTF-8",
        ) from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise InputError(
            str(path), "has null bytes, so it is not a text file", where=f"line {line}"
        )
    return text, notes


def _coding(content: bytes) -> tuple[str, tuple[str, ...]]:
    """The encoding: UTF-8, unless a mark or the bytes show UTF-16 or Windows-1252."""
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16", ()
    for coding, zeros in (("utf-16-le", content[1::2]), ("utf-16-be", content[::2])):
        # every other byte is zero in UTF-16 of European letters, and none in UTF-8
        count = zeros.count(0)
        if len(content) % 2 == 0 and count == content.count(0) and count > 0.8 * len(zeros) > 1:
            return coding, (f"read as {coding.upper()}, which the file does not declare",)
    high = len(content.translate(None, bytes(range(128))))
    if _is_utf8(content) or high > _MOST_HIGH * len(content) or _CONTROL.search(content):
        return "utf-8-sig", ()
    return "cp1252", (
        f"read as Windows-1252, because it is not valid UTF-8 ({high} bytes above 127)",
    )


def _is_utf8(content: bytes) -> bool:
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


@contextmanager
def _errors_of(path: Path) -> Iterator[None]:
    """Turn any exception of a parser into an `InputError`."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except InputError:
        raise
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror or error})") from None
    except MemoryError:
        raise InputError(str(path), "is too large for the memory of this machine") from None
    except Exception:  # parsers raise arbitrary exceptions with unhelpful messages
        raise InputError(
            str(path),
            "cannot be read as a file of spectra: it is damaged, truncated or of an unknown format",
            remedy=("save it again", "save it as CSV"),
        ) from None
