"""The JSON of rawtoaces: a header, and ``spectral_data`` with ``index`` and ``data``."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from chromanoise.errors import InputError
from chromanoise.io.spectra.parsed import Column, Found, Level
from chromanoise.io.spectra.tables import number_in

_LARGEST = 1e30


def read_rawtoaces(whole: Mapping[str, Any], source: str) -> Found:
    """Read the curves of a camera or an illuminant in the format of rawtoaces.

    Raises
    ------
    InputError
        If ``spectral_data`` is missing or has another form.

    Notes
    -----
    rawtoaces multiplies the camera's curves by radiant power, so they count light per energy.
    """
    spectral = _member(whole, "spectral_data", source)
    data = _member(_member(spectral, "data", source), "main", source)
    rows = [_row(at, values, source) for at, values in data.items()]
    sizes = sorted({str(len(row) - 1) for row in rows})
    if len(rows) < 2 or len(sizes) != 1:
        raise InputError(
            source,
            "must have 2 wavelengths with the same number of values",
            value=len(rows),
            found=f"{len(rows)} have {', '.join(sizes) or 'none'}",
            where="key 'spectral_data.data.main'",
        )
    table = np.array(rows, dtype=np.float64)
    names = _names(spectral, table.shape[1] - 1, source)
    facts = _facts(whole)
    level: Level | None = "relative" if spectral.get("units") == "relative" else None
    return Found(
        source=source,
        format="rawtoaces JSON",
        columns=tuple(
            Column(name=name, unit="", wavelength=table[:, 0], values=table[:, k + 1])
            for k, name in enumerate(names)
        ),
        words=" ".join(facts.values()),
        wavelength_unit="nm",
        quantity="response" if len(names) == 3 else "power",
        per="energy",
        level=level,
        notes=(
            *(f"the file says: {key}: {fact[:200]}" for key, fact in list(facts.items())[:20]),
            "light is counted as energy, as rawtoaces does",
        ),
    )


def _facts(whole: Mapping[str, Any]) -> dict[str, str]:
    header = whole.get("header")
    return {k: str(v) for k, v in header.items() if v} if isinstance(header, dict) else {}


def _member(of: Mapping[str, Any], name: str, source: str) -> dict[str, Any]:
    member = of.get(name)
    if not isinstance(member, dict):
        raise InputError(
            source,
            f"must have the object {name!r}, as a rawtoaces file with spectral_data.data.main",
            value=member,
        )
    return member


def _row(at: str, values: Any, source: str) -> list[float]:
    cells = values if isinstance(values, list) else [values]
    real = [v for v in cells if isinstance(v, int | float) and not isinstance(v, bool)]
    wavelength = number_in(at)
    if wavelength != wavelength or len(real) != len(cells) or not cells:
        raise InputError(
            source,
            "must be a wavelength with a list of numbers",
            value=values,
            where=f"entry {at[:40]!r} of spectral_data.data.main",
        )
    row = [wavelength, *(_float(v) for v in real)]
    if not all(abs(v) <= _LARGEST for v in row):
        raise InputError(
            source,
            "must be finite and at most 1e30",
            value=values,
            where=f"entry {at[:40]!r} of spectral_data.data.main",
            remedy="correct it",
        )
    return row


def _float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:
        return float("inf")


def _names(spectral: dict[str, Any], curves: int, source: str) -> tuple[str, ...]:
    index = spectral.get("index")
    names = index.get("main") if isinstance(index, dict) else None
    if names is None:
        return tuple(str(k + 1) for k in range(curves))
    if not isinstance(names, list) or len(names) != curves:
        raise InputError(
            source,
            f"must name the {curves} values of each wavelength",
            value=names,
            where="key 'spectral_data.index.main'",
        )
    return tuple(str(name) for name in names)
