"""IES TM-27: one spectrum of a lamp in XML (``.spdx``)."""

import re
from typing import Any

import numpy as np

from chromanoise.errors import InputError
from chromanoise.io.spectra.parsed import Column, Found, Level, Per, Quantity, has
from chromanoise.io.spectra.tables import finite_number
from chromanoise.io.xml_text import xml_root

_QUANTITIES: dict[str, Quantity] = {
    "reflectance": "reflectance", "r-factor": "reflectance",
    "transmittance": "transmittance", "t-factor": "transmittance",
    "exitance": "power", "flux": "power", "intensity": "power", "irradiance": "power",
    "radiance": "power", "relative": "power",
}  # fmt: skip
_QUANTITY = r"(QE|response|reflectance|transmittance|power) \["
_PER = r".*?\blight counted per (photon|energy)\b"
_LEVEL = r".*?\blevel: (absolute|relative)\b"
_SCALE = r".*?\bscale: (fraction|as written)\b"
_NAMES = ("Manufacturer", "CatalogNumber", "Description")


def read_tm27(text: str, source: str) -> Found:
    """Read a TM-27 file; a document type raises an error, so that no entities are expanded.

    Raises
    ------
    InputError
        If it is not TM-27, or a value is not a number; the message names the line of an XML error.

    Notes
    -----
    ANSI/IES TM-27-20, "Standard Format for the Electronic Transfer of Spectral Data"; a
    ``relative`` spectrum is one of power.
    """
    root = xml_root(text, source)
    if not root.tag.rpartition("}")[2].upper().startswith("IESTM27"):
        raise InputError(
            source,
            "is XML, but not IES TM-27",
            value=root.tag,
            found=f"its root is {root.tag[:60]}",
        )
    parts = {e.tag.rpartition("}")[2]: (e.text or "").strip() for e in root.iter()}
    points = [e for e in root.iter() if e.tag.rpartition("}")[2] == "SpectralData"]
    if len(points) < 2:
        raise has(source, "must have at least 2 SpectralData", len(points))
    rows = [
        [finite_number(text, source, f"SpectralData {k}") for text in texts]
        for k, texts in enumerate(((e.get("wavelength", ""), e.text or "") for e in points), 1)
    ]
    table = np.array(rows, dtype=np.float64)
    quantity_word = parts.get("SpectralQuantity", "").lower()
    comments = parts.get("Comments", "")
    quantity = _QUANTITIES.get(quantity_word) or _ours(_QUANTITY, comments)
    ratio = quantity == "QE"  # electrons per photon
    per: Per | None = "photon" if ratio else _ours(_PER, comments)
    level: Level | None = _ours(_LEVEL, comments)
    if quantity == "power" and quantity_word != "other":
        per, level = per or "energy", "relative" if quantity_word == "relative" else "absolute"
    name = " - ".join(parts[n] for n in _NAMES if parts.get(n)) or "spectrum"
    kept = ("SpectralQuantity", "BandwidthFWHM", "BandwidthCorrected", "Comments")
    return Found(
        source=source,
        format="IES TM-27",
        columns=(Column(name=name, wavelength=table[:, 0], values=table[:, 1]),),
        words=quantity_word,
        wavelength_unit="nm",
        quantity=quantity,
        per=per,
        level=level,
        scale=_ours(_SCALE, comments),
        notes=tuple(f"the file says: {k} {parts[k][:200]}" for k in kept if parts.get(k)),
    )


def _ours(pattern: str, comments: str) -> Any:
    """The metadata in the comments of a file of this library that TM-27 has no field for."""
    match = re.match(pattern, comments)
    return match[1] if match else None
