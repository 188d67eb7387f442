"""Packaged tables from published sources; ``SOURCES.toml`` lists origin and processing."""

import csv
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import resources

from chromanoise.base import dataclass
from chromanoise.spectra.curves import Spectra
from chromanoise.spectra.provenance import Provenance, formula_provenances, table_provenances
from chromanoise.spectra.readers import spectra_from_text

_CAMERAS = "cameras"
OWN_PEAKS = (
    "each channel is divided by its own peak: color SNR loss, noise and colors are not those of "
    "the camera"
)
"""The defect of curves without relative heights."""


@cache
def sources() -> Mapping[str, Provenance]:
    """The provenance of each packaged table; of the table of all cameras, that of each camera."""
    tables = table_provenances(_packaged("SOURCES.toml"), "SOURCES.toml", house=True)
    shared = tables.pop(_CAMERAS)
    return {**tables, **{name: _of_camera(shared, one) for name, one in camera_facts().items()}}


def _of_camera(shared: Provenance, facts: "CameraFacts") -> Provenance:
    pitch = {} if facts.pitch_um is None else {"pitch_um": facts.pitch_um}
    speeds = [*camera_noise().get(facts.name, {})]
    noise = f"read noise at ISO {speeds[0]:g}-{speeds[-1]:g}" if speeds else "read noise unknown"
    size = f"{facts.pitch_um:g} um" if pitch else "pitch unknown"
    parts = (size, f"base ISO {facts.base_iso}", noise, f"curves by {facts.laboratory}")
    return replace(
        shared,
        name=facts.name,
        what=f"{facts.camera} ({facts.year}): {', '.join(parts)}",
        defects=f"{OWN_PEAKS}; {shared.defects}" if facts.has_own_peaks else shared.defects,
        mosaic=facts.mosaic,
        pixel=pitch,
        pixel_source="maker's specification" if pitch else "",
    )


@cache
def formulas() -> Mapping[str, Provenance]:
    """The provenance, by name, of what has no table of its own."""
    return formula_provenances(_packaged("FORMULAS.toml"), "FORMULAS.toml")


@cache
def packaged_table(name: str) -> Spectra:
    """The packaged table ``name``.csv with its source."""
    entry = next(one for one in sources().values() if one.table == name)
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
    """The curves of a packaged table, with their catalog name as source in messages.

    Of the table of all cameras, the columns of one: ``NAME:CHANNEL``.
    """
    table = packaged_table(provenance.table)
    if provenance.table != _CAMERAS:
        return replace(table, source=provenance.name)
    parts = [name.partition(":") for name in table.names]
    here = [i for i, (camera, _, _) in enumerate(parts) if camera == provenance.name]
    return replace(
        table,
        values=table.values[:, here],
        names=tuple(parts[i][2] for i in here),
        source=provenance.name,
    )


@dataclass(frozen=True, kw_only=True)
class CameraFacts:
    """What is known of a camera beside its curves.

    Attributes
    ----------
    name
        The name in the catalog.
    camera
        Maker and model.
    year
        When it came to market.
    laboratory
        Who measured its curves.
    pitch_um
        Pitch of the pixels; ``None`` if unknown. [um]
    base_iso
        The lowest ISO speed that is not extended. [1]
    mosaic
        As `Provenance.mosaic`.
    has_own_peaks
        Whether each channel is divided by its own peak, so that their relative heights are lost.
    """

    name: str
    camera: str
    year: int
    laboratory: str
    pitch_um: float | None
    base_iso: int
    mosaic: str
    has_own_peaks: bool


@cache
def camera_facts() -> Mapping[str, CameraFacts]:
    """The facts of each camera, by its name in the catalog."""
    rows = csv.DictReader(_packaged("camera_facts.csv").splitlines())
    return {
        row["name"]: CameraFacts(
            name=row["name"],
            camera=row["camera"],
            year=int(row["year"]),
            laboratory=row["laboratory"],
            pitch_um=float(row["pitch_um"]) if row["pitch_um"] else None,
            base_iso=int(row["base_iso"]),
            mosaic=row["mosaic"],
            has_own_peaks=row["own_peaks"] == "yes",
        )
        for row in rows
    }


@cache
def camera_noise() -> Mapping[str, Mapping[float, float]]:
    """Per camera and ISO speed, the signal at which read noise and shot noise are equal.

    The signal is 1 at saturation. Cameras and ISO speeds without a number are left out.
    """
    found: dict[str, dict[float, float]] = {}
    for row in csv.DictReader(_packaged("camera_noise.csv").splitlines()):
        found.setdefault(row["name"], {})[float(row["iso"])] = float(row["equal_noise"])
    return found


def _packaged(name: str) -> str:
    return resources.files(__name__).joinpath(name).read_text(encoding="utf-8")
