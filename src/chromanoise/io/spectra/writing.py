"""Write sensors and spectra for other programs: CSV, camera JSON, IES TM-27.

Numbers are written with all significant digits, so reading them restores the same values.
"""

import os
from collections.abc import Mapping
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import __version__, csv_comment, csv_text, json_text
from chromanoise.io.source_files import refused
from chromanoise.sensor import PIXEL_REQUIRED, Mosaic, Sensor
from chromanoise.spectra import Spectra

_TM27_QUANTITIES = (
    *("flux", "absorptance", "transmittance", "reflectance", "intensity", "irradiance"),
    *("radiance", "exitance", "R-Factor", "T-Factor", "relative", "other"),
)
_TM27_FACTS = {"level": "level: ", "per": "light counted per ", "scale": "scale: "}
QE_FACTS = {"level": "absolute", "per": "photon", "scale": "fraction"}
"""Facts of the curves of a sensor, for `spectra_csv`."""


def sensor_spectra(sensor: Sensor) -> Spectra:
    """The curves of a sensor, as spectra. [e-/photon]"""
    return Spectra(
        wavelength_nm=sensor.grid.wavelength_nm,
        values=sensor.qe,
        names=sensor.names,
        quantity="QE",
        unit="e-/photon",
        source=sensor.name,
        notes=sensor.notes,
    )


def spectra_csv(spectra: Spectra, facts: Mapping[str, str] | None = None) -> str:
    """``wavelength_nm,name,..`` and one row per wavelength; comments contain the metadata.

    `read_curves` reads quantity, unit and facts from these comments.

    Parameters
    ----------
    spectra
        The spectra to write.
    facts
        Other facts: level, per and scale, with the values of `Found`.

    Raises
    ------
    InputError
        If a name cannot be the heading of a column in a CSV.
    """
    for name in spectra.names:
        if name.strip() != name or len(name.splitlines()) != 1 or "\0" in name:
            need = "must have names without outer spaces and line ends, to head columns of a CSV"
            found = f"has {name!r}"
            raise refused(spectra.source, need, name, found, remedy=("rename it", "write JSON"))
    comments = {
        "version": __version__,
        "source": _but_folder(spectra.source),
        "quantity": spectra.quantity,
        "unit": spectra.unit,
        "wavelength_unit": "nm",
        **(facts or {}),
        "notes": "; ".join(spectra.notes),
    }
    rows = zip(spectra.wavelength_nm.tolist(), spectra.values.tolist(), strict=True)
    table = csv_text([["wavelength_nm", *spectra.names], *([at, *row] for at, row in rows)])
    return "".join([*(csv_comment(key, value) for key, value in comments.items()), table])


def sensor_csv(sensor: Sensor) -> str:
    """The QE of each channel under ``wavelength_nm,R,..``, as `read_sensor_csv` reads it.

    Pixel, mosaic and origin are written as comments, which readers ignore; the pixel must be given
    again when the file is read. `sensor_json` preserves all data.

    Raises
    ------
    InputError
        As for `spectra_csv`.
    """
    pixel = sensor.pixel
    return spectra_csv(
        sensor_spectra(sensor),
        {
            **QE_FACTS,
            "origin": sensor.origin,
            "mosaic": mosaic_text(sensor.mosaic),
            **{key: repr(getattr(pixel, key)) for key in PIXEL_REQUIRED},
        },
    )


def sensor_rawtoaces_json(
    sensor: Sensor, *, created: str, manufacturer: str = "", license_name: str = "unstated"
) -> str:
    """R, G and B of the sensor in the camera format of rawtoaces: per energy, maximum 1.

    Parameters
    ----------
    sensor
        It must have channels R, G and B; others are omitted.
    created
        Date and time of the document, RFC 3339, e.g. ``2026-01-31T12:00:00Z``.
    manufacturer
        The manufacturer of the camera.
    license_name
        The license of the curves.

    Raises
    ------
    InputError
        If a channel is missing, all curves are zero, or a wavelength is not a whole number of nm.

    Notes
    -----
    Schema 1.0.0 of rawtoaces-data. rawtoaces multiplies its curves with spectra of power, so QE,
    electrons per photon, is multiplied by the wavelength, because photons per joule are
    proportional to lambda. All channels have the same factor, so their ratios are preserved; the
    absolute scale is lost.
    """
    header = rawtoaces_header(
        sensor.name,
        created=created,
        comments="; ".join((f"origin of curves: {sensor.origin}", *sensor.notes)),
        description="camera spectral sensitivity, QE times wavelength, relative",
        manufacturer=manufacturer,
        license_name=license_name,
    )
    return rawtoaces_json(photons_as_energy(sensor_spectra(sensor)), header)


def photons_as_energy(spectra: Spectra) -> Spectra:
    """Convert curves per photon to curves per energy (times lambda), up to a constant factor."""
    values = spectra.values * spectra.wavelength_nm[:, None]
    return replace(spectra, values=values, unit="relative, per energy")


def rawtoaces_json(per_energy: Spectra, header: Mapping[str, Any]) -> str:
    """R, G and B of curves per energy, in the camera format of rawtoaces, with maximum 1.

    Parameters
    ----------
    per_energy
        It must have channels R, G and B; others are omitted.
    header
        The header of the document in schema 1.0.0 of rawtoaces-data.

    Raises
    ------
    InputError
        As for `sensor_rawtoaces_json`.
    """
    source = per_energy.source
    missing = [name for name in "RGB" if name not in per_energy.names]
    if missing:
        need = "must have channels R, G and B for rawtoaces"
        found = f"{', '.join(missing)} is missing among {', '.join(per_energy.names)}"
        raise refused(source, need, per_energy.names, found, remedy="write the JSON of the sensor")
    wavelength = per_energy.wavelength_nm
    odd = wavelength != np.round(wavelength)
    if odd.any():
        part = float(wavelength[odd][0])
        raise refused(
            source, "must have wavelengths of whole nm for rawtoaces", part, f"has {part:g} nm"
        )
    values = per_energy.values[:, [per_energy.names.index(name) for name in "RGB"]]
    if not values.max() > 0:
        need = "must have R, G and B above 0 for a relative scale"
        raise refused(source, need, float(values.max()), "all are 0")
    rows = (values / values.max()).tolist()
    data = {f"{at:.0f}": row for at, row in zip(wavelength.tolist(), rows, strict=True)}
    document = {
        "header": dict(header),
        "spectral_data": {
            "units": "relative",
            "reflection_geometry": None,
            "transmission_geometry": None,
            "bandwidth_FWHM": None,
            "bandwidth_corrected": None,
            "index": {"main": ["R", "G", "B"]},
            "data": {"main": data},
        },
    }
    return json_text(document, indent=1)


def spectra_spdx(
    spectra: Spectra, name: str, *, created: str, facts: Mapping[str, str] | None = None
) -> str:
    """One curve as IES TM-27-14, an XML file with the suffix ``.spdx``.

    Parameters
    ----------
    spectra
        The spectra to write.
    name
        The name of the curve.
    created
        Date of the document, e.g. ``2026-01-31``; the clock is not used, so that the same input
        gives the same file.
    facts
        As for `spectra_csv`; they are written into the comments.

    Raises
    ------
    InputError
        If there is no such curve, or a text has characters that XML forbids.

    Notes
    -----
    ANSI/IES TM-27-14. A quantity that is not in its list is written as ``other``, with the quantity
    and its unit in the comments.
    """
    if name not in spectra.names:
        need = f"must have the curve {name!r}"
        raise refused(spectra.source, need, spectra.names, f"has {', '.join(spectra.names)}")
    words = spectra.quantity.lower()
    quantity = {q.lower(): q for q in _TM27_QUANTITIES}.get(words, "other")
    what = f"{spectra.quantity} [{spectra.unit}]"
    said = [f"{_TM27_FACTS[key]}{value}" for key, value in (facts or {}).items()]
    comments = "; ".join((what, *said, f"source: {_but_folder(spectra.source)}", *spectra.notes))
    header = {
        "Description": name,
        "DocumentCreator": f"chromanoise {__version__}",
        "DocumentCreationDate": created,
        "Comments": comments,
    }
    column = spectra.values[:, spectra.names.index(name)].tolist()
    data = (
        f'    <SpectralData wavelength="{at!r}">{value!r}</SpectralData>'
        for at, value in zip(spectra.wavelength_nm.tolist(), column, strict=True)
    )
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<IESTM2714 xmlns="http://www.ies.org/iestm2714" version="1.0">',
        "  <Header>",
        *(f"    <{key}>{_xml(value)}</{key}>" for key, value in header.items()),
        "  </Header>",
        "  <SpectralDistribution>",
        f"    <SpectralQuantity>{quantity}</SpectralQuantity>",
        *data,
        "  </SpectralDistribution>",
        "</IESTM2714>",
    ]
    return "\n".join(lines) + "\n"


def rawtoaces_header(
    model: str,
    *,
    created: str,
    comments: str,
    description: str = "camera spectral sensitivity, relative",
    manufacturer: str = "",
    license_name: str = "unstated",
) -> dict[str, Any]:
    """The header of a camera in the schema 1.0.0 of rawtoaces-data."""
    return {
        "schema_version": "1.0.0",
        "manufacturer": manufacturer or None,
        "model": model,
        "type": "camera",
        "description": description,
        "document_creator": f"chromanoise {__version__}",
        "document_creation_date": created,
        "unique_identifier": None,
        "measurement_equipment": None,
        "laboratory": None,
        "comments": comments,
        "license": license_name,
    }


def mosaic_text(mosaic: Mosaic | None) -> str:
    """The rows of the pattern, separated by ``/``; ``none`` if each pixel has all channels."""
    return "/".join(" ".join(row) for row in mosaic.pattern) if mosaic else "none"


def _but_folder(source: str) -> str:
    """The source without its folder, if it is a path."""
    path = Path(source)
    there = os.path.isfile(source)  # noqa: PTH113 - also accepts names that are too long
    return path.name if path.is_absolute() or there else source


def _xml(text: str) -> str:
    """The text escaped for XML; a character that XML 1.0 forbids raises an error."""
    for letter in text:
        code = ord(letter)
        if (
            (code < 0x20 and letter not in "\t\n\r")
            or 0xD800 <= code < 0xE000
            or code >> 1 == 0x7FFF
        ):
            need = "must have only characters that XML allows"
            raise refused(repr(text[:40]), need, letter, f"has {letter!r}", remedy="rename it")
    return escape(" ".join(text.split()), quote=False)
