"""Sensors from tables with provenance: from data sheets, and cameras of colour-science."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import get_args

import numpy as np

from chromanoise._colour_science import colour_science
from chromanoise.errors import InputError, Setting
from chromanoise.io.spectra import Answers, ParsedSpectra, qe_of
from chromanoise.io.spectra.parsed import Quantity
from chromanoise.sensor.mosaic import mosaic_named
from chromanoise.sensor.pixel import PAPER_PIXEL, PIXEL, PIXEL_REQUIRED, Pixel
from chromanoise.sensor.sensor import Sensor
from chromanoise.spectra import Grid, Spectra, means_on_grid, refuse_outside
from chromanoise.spectra.tables import catalog_tables, formulas
from chromanoise.spectra.tables.provenance import Provenance

DEVICE_NAMES = tuple(catalog_tables("sensor"))
"""Sensors whose curves are copied from data sheets."""

CAMERA_NAMES = tuple(
    name
    for name, provenance in formulas().items()
    if provenance.carried_as and not provenance.table
)
"""Cameras that colour-science includes."""


def camera_curves(provenance: Provenance) -> Spectra:
    """The relative curves of a camera of colour-science."""
    measured = colour_science().MSDS_CAMERA_SENSITIVITIES[provenance.carried_as]
    return Spectra(
        wavelength_nm=np.asarray(measured.wavelengths, dtype=np.float64),
        values=np.asarray(measured.values, dtype=np.float64),
        names=tuple(label[0].upper() for label in measured.labels),
        quantity=provenance.quantity,
        unit=provenance.unit,
        source=provenance.name,
    )


def sensor_from_table(
    provenance: Provenance,
    curves: Spectra,
    grid: Grid,
    *,
    answers: Answers,
    pixel: Mapping[str, float],
) -> Sensor:
    """The sensor of a table with provenance; its notes list defects and assumptions.

    Parameters
    ----------
    provenance
        The provenance of the table.
    curves
        The curves of its channels.
    grid
        The target grid.
    answers
        Metadata that the table lacks: extrapolation ``beyond`` its ends, ``peak_qe`` of relative
        curves, ``per``.
    pixel
        Values that override those of the source, by the names of `Pixel`.

    Raises
    ------
    InputError
        If required metadata is missing, or a QE lies outside 0 .. 1.
    """
    named = replace(curves, source=provenance.name)
    qe = qe_of(_understood(provenance, named, answers), answers)
    refuse_outside(qe, high=1.0, remedy=Setting("peak_qe"))
    resampled = means_on_grid(qe, grid, beyond=answers.beyond)
    known = {**provenance.pixel, **pixel}
    own = replace(PAPER_PIXEL, **known)
    return Sensor(
        name=provenance.name,
        grid=grid,
        qe=resampled.values,
        names=resampled.names,
        pixel=own,
        mosaic=mosaic_named(provenance.mosaic) if provenance.mosaic else None,
        origin="measured",
        notes=(
            provenance.source,
            *([] if provenance.defects.strip(" .").lower() == "none" else [provenance.defects]),
            *assumed_pixel(provenance.name, own, known),
            *resampled.notes,
        ),
    )


def _understood(provenance: Provenance, curves: Spectra, answers: Answers) -> ParsedSpectra:
    """The table as if it were parsed from a file with the metadata of its provenance."""
    quantity = provenance.quantity
    if quantity not in get_args(Quantity):
        need = "must hold QE or response to be a sensor"
        raise InputError(provenance.name, need, value=quantity, found=f"holds {quantity}")
    return ParsedSpectra(
        curves=curves,
        format="table",
        wavelength_unit="nm",
        scale="as written",
        quantity=quantity,  # type: ignore[arg-type]
        level=provenance.level,
        per=provenance.per or ("photon" if quantity == "QE" else answers.per),
    )


def assumed_pixel(name: str, pixel: Pixel, known: Collection[str]) -> tuple[str, ...]:
    """A note on the values of the paper's pixel that are assumed, in numbers, if there are any.

    Parameters
    ----------
    name
        Name of the sensor.
    pixel
        Its pixel.
    known
        Names of the fields that are known.

    Examples
    --------
    >>> assumed_pixel("my.csv", PAPER_PIXEL, {"pitch_um"})
    ('full well and read noise of my.csv not given: using 10000 e-, 10 e-',)
    """
    missing = [field for field in PIXEL_REQUIRED if field not in known]
    if not missing:
        return ()
    values = ", ".join(f"{getattr(pixel, field):g} {PIXEL[field].unit}" for field in missing)
    words = [PIXEL[field].label for field in missing]
    listed = " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
    return (f"{listed} of {name} {_USING}{values}",)


def is_assumed(sensor: Sensor, name: str) -> bool:
    """Whether a value of the sensor's pixel is that of the paper's pixel for want of its own.

    Parameters
    ----------
    sensor
        Of the catalog or a file.
    name
        One of `chromanoise.sensor.PIXEL_REQUIRED`.
    """
    return any(
        _USING in note and PIXEL[name].label in note.partition(" of ")[0] for note in sensor.notes
    )


_USING = "not given: using "
