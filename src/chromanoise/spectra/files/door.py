"""The one door for files of spectra: which reader a file wants, and how its faults are told."""

import codecs
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from chromanoise import _check
from chromanoise._inputs import regular_file
from chromanoise.spectra.files.cgats import is_cgats, read_cgats
from chromanoise.spectra.files.delimited import read_delimited
from chromanoise.spectra.files.isetcam import is_matlab, read_isetcam
from chromanoise.spectra.files.meaning import meaning_of
from chromanoise.spectra.files.rawtoaces import read_rawtoaces
from chromanoise.spectra.files.tm27 import read_tm27
from chromanoise.spectra.files.understood import ASK, Answers, Found, Understood
from chromanoise.spectra.files.workbook import read_workbook

_LARGEST_BYTES = 4 * 2**20
_HDF5 = b"\x89HDF\r\n\x1a\n"


def read_curves(path: Path | str, *, answers: Answers = ASK) -> Understood:
    r"""The curves of a file, and what was understood of it.

    Delimited text with any of the usual separators, digitized curves, ISETCam ``.mat``,
    rawtoaces ``.json``, CGATS and Argyll ``.sp``, IES TM-27 ``.spdx``, and ``.xlsx``. The file's
    content decides, not its name.

    Parameters
    ----------
    path
        The file, of 4 MiB at most.
    answers
        What its user knows and the file does not say.

    Raises
    ------
    InputError
        If nothing can be understood; the file, and the line where there are lines, are told.

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
    path = Path(path)
    with _faults_told(path):
        return meaning_of(_found(path, _content(path)), answers)


def _content(path: Path) -> bytes:
    size = regular_file(path).st_size
    if size > _LARGEST_BYTES:
        raise _check.InputError(
            f"{path}: {size / 2**20:.0f} MiB is too large for a table of spectra "
            f"({_LARGEST_BYTES // 2**20} MiB at most); leave out what is no curve"
        )
    return path.read_bytes()


def _found(path: Path, content: bytes) -> Found:
    if is_matlab(content):
        return read_isetcam(path)
    if content.startswith(_HDF5):
        raise _check.InputError(f"{path}: is an HDF5 or MATLAB 7.3 file; save it with -v7")
    if content.startswith(b"PK\x03\x04"):
        return read_workbook(path)
    text = _decoded(path, content)
    start = text.lstrip()[:1]
    if start == "{":
        return read_rawtoaces(text, str(path))
    if start == "<":
        return read_tm27(text, str(path))
    if is_cgats(text):
        return read_cgats(text, str(path))
    return read_delimited(text, str(path))


def _decoded(path: Path, content: bytes) -> str:
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError as error:
        raise _check.InputError(
            f"{path}: not a UTF-8 text file (byte {error.start} is not text); save it as CSV UTF-8"
        ) from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise _check.InputError(f"{path}: line {line} holds null bytes, so it is no text file")
    return text


@contextmanager
def _faults_told(path: Path) -> Iterator[None]:
    """Turns whatever a parser throws at a bad file into one sentence."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except _check.InputError:
        raise
    except OSError as error:
        raise _check.InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except MemoryError:
        raise _check.InputError(f"{path}: too large for this machine's memory") from None
    except Exception as error:  # parsers throw anything
        told = _check.reason(error)
        raise _check.InputError(
            f"{path}: not a readable file of spectra{f' ({told})' if told else ''}; it is damaged "
            "or cut short, save it again"
        ) from None
