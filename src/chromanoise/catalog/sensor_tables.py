"""Sensors from tables with provenance: typed in from data sheets, carried by colour-science."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import get_args

import numpy as np

from chromanoise._colour_science import colour_science
from chromanoise.errors import InputError, Setting
from chromanoise.io.spectra import Answers, ParsedSpectra, qe_of
from chromanoise.io.spectra.parsed import Quantity
from chromanoise.sensor.mosaic import mosaic_named
from chromanoise.sensor.pixel import PAPER_PIXEL, Pixel
from chromanoise.sensor.sensor import Sensor
from chromanoise.spectra import Grid, Spectra, means_on_grid, refuse_outside
from chromanoise.spectra.tables import catalogue_curves, catalogue_tables, formulas
from chromanoise.spectra.tables.provenance import Provenance

DEVICE_NAMES = tuple(catalogue_tables("sensor"))
"""Sensors whose curves are typed in from data sheets."""

CAMERA_NAMES = tuple(
    name for name, told in formulas().items() if told.carried_as and not told.table
)
"""Cameras that colour-science carries."""


def device_named(name: str, grid: Grid, answers: Answers, pixel: Mapping[str, float]) -> Sensor:
    """The device of the catalogue; what its table cannot tell is asked as of a file.

    Raises
    ------
    InputError
        If the table ends short of the grid or is relative, and ``answers`` does not say more.
    """
    told = catalogue_tables("sensor")[name]
    return sensor_from_table(told, catalogue_curves(told), grid, answers=answers, pixel=pixel)


def camera_named(name: str, grid: Grid, answers: Answers, pixel: Mapping[str, float]) -> Sensor:
    """The camera that colour-science carries, its curves relative and without an infrared.

    Raises
    ------
    InputError
        Until ``answers`` says how light is counted, what the highest QE is and what follows.
    """
    told = formulas()[name]
    return sensor_from_table(told, camera_curves(told), grid, answers=answers, pixel=pixel)


def camera_curves(provenance: Provenance) -> Spectra:
    """The relative curves of a camera, as colour-science carries them."""
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
    """The sensor of a table with provenance, its defects and what was assumed in its notes.

    Parameters
    ----------
    provenance
        What is known of the table.
    curves
        Its channels.
    grid
        Where they are wanted.
    answers
        What the table cannot tell: ``beyond`` its end, ``peak_qe`` of relative curves, ``per``.
    pixel
        Instead of what its source says of the pixel, by the names of `Pixel`.

    Raises
    ------
    InputError
        If something must be answered first, or a QE lies outside 0 .. 1.
    """
    named = replace(curves, source=provenance.name)
    qe = qe_of(_understood(provenance, named, answers), answers)
    refuse_outside(qe, high=1.0, remedy=Setting("peak_qe"))
    resampled = means_on_grid(qe, grid, beyond=answers.beyond)
    own, assumed = _pixel(provenance, pixel)
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
            *assumed,
            *resampled.notes,
        ),
    )


def _understood(provenance: Provenance, curves: Spectra, answers: Answers) -> ParsedSpectra:
    """The table as a file that tells all that its provenance does."""
    quantity = provenance.quantity
    if quantity not in get_args(Quantity):
        raise InputError(
            provenance.name,
            "must hold QE or response to be a sensor",
            value=quantity,
            found=f"holds {quantity}",
        )
    return ParsedSpectra(
        curves=curves,
        format="table",
        delimiter="",
        decimal="",
        wavelength_unit="nm",
        scale="as written",
        factor=1.0,
        step_nm=None,
        gaps_nm=(),
        merged=0,
        quantity=quantity,  # type: ignore[arg-type]
        level=provenance.level,
        per=provenance.per or ("photon" if quantity == "QE" else answers.per),
        deviations=None,
        notes=(),
        defects=(),
        questions=(),
    )


def _pixel(provenance: Provenance, given: Mapping[str, float]) -> tuple[Pixel, tuple[str, ...]]:
    """What the source says of the pixel; the paper's stands in for the rest, and is told."""
    known = {**provenance.pixel, **given}
    missing = [field.name for field in fields(Pixel) if field.name not in known]
    pixel = replace(PAPER_PIXEL, **known)
    if not missing:
        return pixel, ()
    stands_in = f"the paper's pixel stands in for {', '.join(missing)} of {provenance.name}"
    return pixel, (stands_in,)
