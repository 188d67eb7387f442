"""A user's own folder of tables, with the same provenance as the package's own."""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from chromanoise import _check
from chromanoise.errors import InputError
from chromanoise.spectra.curves import Spectra
from chromanoise.spectra.readers import read_spectra_csv, small_text
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
        The section of SOURCES.toml for this table.
    path
        The CSV file.
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
        If there is no such folder, SOURCES.toml cannot be read, a table has no section, a section
        has no table, or a name is not allowed.
    """
    if not folder.is_dir():
        raise InputError(
            str(folder), "is not a catalog folder", remedy=f"name a folder that holds {SOURCES}"
        )
    source = folder / SOURCES
    provenances = table_provenances(small_text(source, _LARGEST_BYTES), str(source))
    tables = {name: _table(folder, name, provenance) for name, provenance in provenances.items()}
    for path in sorted(folder.glob("*.csv")):
        if path.stem not in tables:
            raise InputError(
                str(path), "has no provenance", remedy=f"add a section [{path.stem}] to {source}"
            )
    return tables


def user_curves(table: UserTable) -> Spectra:
    """The curves of a user's table.

    Raises
    ------
    InputError
        If the table cannot be read; the message names file, line and column.
    """
    known = table.provenance
    return read_spectra_csv(table.path, quantity=known.quantity, unit=known.unit)


def _table(folder: Path, name: str, provenance: Provenance) -> UserTable:
    source, where = str(folder / SOURCES), f"section [{name}]"
    if not _NAME.fullmatch(name):
        raise InputError(
            source,
            "the name must consist of letters, digits, - and _, because it is also a file name",
            value=name,
            where=where,
        )
    _check.among(f"kind in {source}, {where}", provenance.kind, _KINDS)
    if provenance.kind == "illuminant" and provenance.per is None:
        raise InputError(
            source,
            "must declare how light is counted",
            where=where,
            remedy=('write per = "energy"', 'write per = "photon"'),
        )
    path = folder / f"{name}.csv"
    if not path.is_file():
        raise InputError(source, f"its table {path.name} is not in the same folder", where=where)
    if Path(os.path.realpath(path)).parent != Path(os.path.realpath(folder)):
        raise InputError(
            str(path), "leads out of its folder", remedy="copy the table into the folder"
        )
    return UserTable(provenance=provenance, path=path)
