"""Read a file of spectra: choose the reader and turn its exceptions into errors."""

import codecs
import re
import warnings
import zipfile
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from chromanoise.base import InputError, regular_file
from chromanoise.io.envi import envi_library, envi_pair, read_envi_library
from chromanoise.io.matlab import is_matlab
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.delimited import is_cgats, read_cgats, read_delimited, read_workbook
from chromanoise.io.spectra.instruments import is_asd, read_asd, read_fits, read_isetcam, read_tm27
from chromanoise.io.spectra.interpretation import meaning_of
from chromanoise.io.spectra.jcamp import is_jcamp, read_jcamp
from chromanoise.io.spectra.json_curves import read_json
from chromanoise.io.spectra.parsed import ASK, Answers, Found, ParsedSpectra

_LARGEST_BYTES = 4 * 2**20
_SHORT_BYTES = 8 * 2**10  # of a text whose curves are kept; they take up to 20 times as much
_LARGEST_LIBRARY_BYTES = 32 * 2**20
_MOST_CURVES = 10_000
_MOST_HIGH = 0.1
_CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f]")
BINARY_FORMATS: tuple[tuple[Callable[[bytes], bool], Callable[[Path, bytes], Found]], ...] = (
    (is_matlab, lambda path, _: read_isetcam(path)),
    (is_asd, read_asd),
    (lambda content: content.startswith(b"SIMPLE  ="), read_fits),
)
"""How each binary format is recognized by its bytes, and its reader of path and bytes."""

TEXT_FORMATS: tuple[tuple[Callable[[str], bool], Callable[[str, str], Found]], ...] = (
    (lambda text: text.lstrip().startswith("{"), read_json),
    (lambda text: text.lstrip().startswith("<"), read_tm27),
    (is_jcamp, read_jcamp),
    (is_cgats, read_cgats),
    (lambda _: True, read_delimited),
)
"""How each format of text is recognized, and its reader of text and name; the first one reads."""

_EXPORT = "export the curves as CSV"
_AVASOFT = "export it as ASCII in AvaSoft"
_KINDS: tuple[tuple[bytes, str, str], ...] = (
    (b"\x89PNG\r\n\x1a\n", "a PNG picture", "digitize its curves, and save them as CSV"),
    (b"\xff\xd8\xff", "a JPEG picture", "digitize its curves, and save them as CSV"),
    (b"GIF8", "a GIF picture", "digitize its curves, and save them as CSV"),
    (b"II*\0", "a TIFF picture", "digitize its curves, and save them as CSV"),
    (b"MM\0*", "a TIFF picture", "digitize its curves, and save them as CSV"),
    (b"%PDF-", "a PDF document", "copy or digitize its curves, and save them as CSV"),
    (b"{\\rtf", "an RTF document", "save it as plain text"),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an old Office file (.xls)", "save it as .xlsx or CSV"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"BZh", "a bzip2 archive", "unpack it first"),
    (b"\xfd7zXZ\0", "an xz archive", "unpack it first"),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", "unpack it first"),
    (b"SQLite format 3\0", "an SQLite database", _EXPORT),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 or MATLAB 7.3 file", "save it with -v7, or as CSV"),
    (b"CDF\x01", "a NetCDF file", _EXPORT),
    (b"CDF\x02", "a NetCDF file", _EXPORT),
    (b"\x93NUMPY", "a NumPy array (.npy)", "write wavelengths and values with numpy.savetxt"),
    (b"PAR1", "a Parquet file", _EXPORT),
    (b"\x80\x04\x95", "a Python pickle", _EXPORT),
    (b"AVS8", "a binary file of AvaSoft 8 (Avantes)", _AVASOFT),
    (b"\0\0\x8cB", "a binary file of AvaSoft 7 (Avantes)", _AVASOFT),
    (b"\0\0pB", "a binary file of AvaSoft 6 (Avantes)", _AVASOFT),
    (b"\n\n\xfe\xfe", "a Bruker OPUS file", "export it as a data point table"),
    (b"WDF1", "a Renishaw WiRE file", _EXPORT),
    (b"Spectral Data File", "a Thermo OMNIC file (.spa)", _EXPORT),
    (b"\x7fELF", "a program (ELF)", "name a file of curves"),
    (b"MZ", "a program (.exe)", "name a file of curves"),
)
_HTML = (b"<!doctype html", b"<html")
_START = 512


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
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            content = _content(path)
            is_short_text = len(content) <= _SHORT_BYTES and b"\0" not in content
            if is_short_text and not content.lstrip().startswith(b"ENVI"):  # names another file
                return _kept(str(path), content, answers)
            return _meaning(_found(path, content), answers)
    except InputError:
        raise
    except OSError as error:
        raise refused(path, f"cannot be read ({error.strerror or error})") from None
    except MemoryError:
        raise refused(path, "is too large for the memory of this machine") from None
    except Exception:  # parsers raise arbitrary exceptions with unhelpful messages
        raise refused(
            path,
            "cannot be read as a file of spectra: it is damaged, truncated or of an unknown format",
            remedy=("save it again", "save it as CSV"),
        ) from None


def _meaning(found: Found, answers: Answers) -> ParsedSpectra:
    if len(found.columns) > _MOST_CURVES:
        need = f"must have at most {_MOST_CURVES} curves"
        raise has(found.source, need, len(found.columns), remedy="split them")
    return meaning_of(found, answers)


@lru_cache(maxsize=1024)  # a study is checked first, then computed: its files are parsed once
def _kept(path: str, content: bytes, answers: Answers) -> ParsedSpectra:
    return _meaning(_found(Path(path), content), answers)


def _content(path: Path) -> bytes:
    library = regular_file(path).st_size > _LARGEST_BYTES and envi_pair(path) is not None
    _refuse_large(path, _LARGEST_LIBRARY_BYTES if library else _LARGEST_BYTES)
    return path.read_bytes()


def _refuse_large(path: Path, largest: int) -> None:
    size = regular_file(path).st_size
    if size > largest:
        need = f"must be at most {largest // 2**20} MiB for a table of spectra"
        found = f"is {size / 2**20:.0f} MiB"
        raise refused(path, need, size, found, remedy="remove what is not a curve")


def _found(path: Path, content: bytes) -> Found:
    for is_binary, read_binary in BINARY_FORMATS:
        if is_binary(content):
            return read_binary(path, content)
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
    found = next(read for is_text, read in TEXT_FORMATS if is_text(text))(text, str(path))
    return replace(found, notes=(*notes, *found.notes))


def kind_of(content: bytes) -> tuple[str, str] | None:
    r"""The kind of a file by its first bytes, and a remedy; None if it may be text.

    Examples
    --------
    >>> kind_of(b"\x89PNG\r\n\x1a\n..."), kind_of(b"nm,R\n400,0.1\n")
    (('a PNG picture', 'digitize its curves, and save them as CSV'), None)
    """
    for start, name, remedy in _KINDS:
        if content.startswith(start):
            return name, remedy
    if content[1:2] == b"K" and content[3:4] == b"\x80":
        return "a Thermo Galactic file (.spc)", _EXPORT
    if content[:_START].lstrip().lower().startswith(_HTML):
        return "an HTML page", "download the file that it links to, or save its table as CSV"
    return None


def kind_of_zip(names: list[str]) -> tuple[str, str] | None:
    """The kind of a ZIP archive by the names in it; None for a workbook.

    Examples
    --------
    >>> kind_of_zip(["r.npy"])[0], kind_of_zip(["xl/workbook.xml"])
    ('NumPy arrays (.npz)', None)
    """
    if any(name.startswith("xl/") for name in names):
        return None
    if names and all(name.endswith(".npy") for name in names):
        return "NumPy arrays (.npz)", "write wavelengths and values with numpy.savetxt"
    if any(name.startswith("ps_") and name.endswith(".xml") for name in names):
        return "an Ocean Optics file (.ProcSpec)", "save it as tab-delimited text in SpectraSuite"
    if "content.xml" in names:
        return "an OpenDocument file (.ods)", "save it as .xlsx or CSV"
    if any(name.startswith("word/") for name in names):
        return "a Word document", "save its table as CSV"
    return "a ZIP archive", "unpack it first"


def _refuse_kind(path: Path, kind: tuple[str, str] | None) -> None:
    if kind is not None:
        name, remedy = kind
        raise has(path, "is not a file of spectra", name, "is", remedy=remedy)


def _decoded(path: Path, content: bytes) -> tuple[str, tuple[str, ...]]:
    """The text, and a note if the file does not declare its character encoding."""
    coding, notes = _coding(content)
    try:
        text = content.decode(coding)
    except UnicodeDecodeError as error:
        raise refused(
            path, "is not UTF-8 text", where=f"byte {error.start}", remedy="save it as CSV UTF-8"
        ) from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise refused(path, "has null bytes, so it is not a text file", where=f"line {line}")
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
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        if high <= _MOST_HIGH * len(content) and not _CONTROL.search(content):
            why = f"because it is not valid UTF-8 ({high} bytes above 127)"
            return "cp1252", (f"read as Windows-1252, {why}",)
    return "utf-8-sig", ()
