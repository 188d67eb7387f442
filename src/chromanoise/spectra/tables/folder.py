"""A user's own folder of tables, with the same provenance as the package's own."""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from chromanoise import _check
from chromanoise._inputs import regular_file
from chromanoise.errors import InputError
from chromanoise.spectra.curves import Spectra
from chromanoise.spectra.readers import read_spectra_csv
from chromanoise.spectra.tables.provenance import Provenance, table_provenances

SOURCES = "SOURCES.toml"
_KINDS = ("sensor", "illuminant", "reflectance", "filter")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,79}")
_LARGEST_BYTES = 2**20


@dataclass(frozen=True, slots=True, kw_only=True)
class UserTable:
    """A table of a user's folder.

    Attributes
    ----------
    provenance
        What its section of SOURCES.toml says.
    path
        The table.
    """

    provenance: Provenance
    path: Path


def user_tables(folder: Path) -> Mapping[str, UserTable]:
    """The tables of a folder of CSV files and a SOURCES.toml, by name.

    Parameters
    ----------
    folder
        ``NAME.csv`` (``wavelength_nm,name,...``) for each section ``[NAME]`` of its SOURCES.toml.

    Raises
    ------
    InputError
        If there is no such folder, SOURCES.toml cannot be understood, a table has no section, a
        section no table, or a name is none.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: is no folder of a catalogue; name one that holds {SOURCES}")
    source = folder / SOURCES
    told = table_provenances(_text(source), str(source))
    tables = {name: _table(folder, name, provenance) for name, provenance in told.items()}
    for path in sorted(folder.glob("*.csv")):
        if path.stem not in tables:
            raise InputError(
                f"{path}: has no provenance; give it a section [{path.stem}] in {source}"
            )
    return tables


def user_curves(table: UserTable) -> Spectra:
    """The curves of a user's table, named by it.

    Raises
    ------
    InputError
        If the table cannot be read; file, line and column are told.
    """
    told = table.provenance
    return read_spectra_csv(table.path, quantity=told.quantity, unit=told.unit)


def _table(folder: Path, name: str, provenance: Provenance) -> UserTable:
    where = f"{folder / SOURCES}: [{name}]"
    if not _NAME.fullmatch(name):
        raise InputError(
            f"{where}: a name is made of letters, digits, - and _, for it names a file beside it"
        )
    _check.one_of(f"kind in {where}", provenance.kind, _KINDS)
    if provenance.kind == "illuminant" and provenance.per is None:
        raise InputError(f'{where} must say how it counts light: per = "energy" or per = "photon"')
    path = folder / f"{name}.csv"
    if not path.is_file():
        raise InputError(f"{where}: its table {path.name} is not beside it")
    if Path(os.path.realpath(path)).parent != Path(os.path.realpath(folder)):
        raise InputError(f"{path}: leads out of its folder; copy the table into it")
    return UserTable(provenance=provenance, path=path)


def _text(path: Path) -> str:
    try:
        if regular_file(path).st_size > _LARGEST_BYTES:
            raise InputError(f"{path}: is larger than 1 MiB, too large to tell of sources")
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: not a UTF-8 text file (byte {error.start} is not text)"
        ) from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
