"""Packaged tables from published sources; ``SOURCES.toml`` lists origin and processing."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import resources

from chromanoise.spectra.curves import Spectra
from chromanoise.spectra.provenance import Provenance, formula_provenances, table_provenances
from chromanoise.spectra.readers import spectra_from_text


@cache
def sources() -> Mapping[str, Provenance]:
    """The provenance of each packaged table."""
    return table_provenances(_packaged("SOURCES.toml"), "SOURCES.toml", house=True)


@cache
def formulas() -> Mapping[str, Provenance]:
    """The provenance, by name, of what a formula or colour-science provides."""
    return formula_provenances(_packaged("FORMULAS.toml"), "FORMULAS.toml")


@cache
def packaged_table(name: str) -> Spectra:
    """The packaged table ``name``.csv with its source."""
    entry = sources()[name]
    return spectra_from_text(
        _packaged(f"{name}.csv"), source=entry.source, quantity=entry.quantity, unit=entry.unit
    )


def catalog_tables(kind: str) -> dict[str, Provenance]:
    """The packaged tables of one kind, by their names in the catalog.

    Examples
    --------
    >>> catalog_tables("illuminant")["G173"].table
    'astm_g173_global'
    """
    return {entry.name: entry for entry in sources().values() if entry.kind == kind}


def catalog_curves(provenance: Provenance) -> Spectra:
    """The curves of a packaged table, with their catalog name as source in messages."""
    return replace(packaged_table(provenance.table), source=provenance.name)


def _packaged(name: str) -> str:
    return resources.files(__name__).joinpath(name).read_text(encoding="utf-8")
