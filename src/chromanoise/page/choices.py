"""The choices on the page: names, and the ranges of the sliders."""

from collections.abc import Mapping
from dataclasses import asdict
from functools import lru_cache
from typing import Any

from chromanoise import __version__
from chromanoise.analysis.color_matrices import DEFAULT_METHOD, METHODS, MatrixMethod
from chromanoise.analysis.comparison.quantities import QUANTITIES
from chromanoise.analysis.comparison.sweeps import SWEEPS
from chromanoise.analysis.priors import PRIORS
from chromanoise.catalog.entries import catalog_entries, catalog_folder
from chromanoise.catalog.resolve import resolve_illuminant, resolve_sensor
from chromanoise.charts import DRAWINGS
from chromanoise.charts.electrons import sensor_values
from chromanoise.charts.sections import SECTIONS
from chromanoise.color import SPACES
from chromanoise.denoising import DENOISING
from chromanoise.errors import InputError
from chromanoise.exposure import EQUAL_TERMS
from chromanoise.io.spectra import Answers
from chromanoise.page.fields import SECTION_HINTS, described_fields, study_defaults
from chromanoise.page.studies import MOST_MATRICES, MOST_SENSORS
from chromanoise.scene import BUILTIN_CUBES
from chromanoise.spectra import DEFAULT_GRID, INFRARED_FROM_NM, METRICS
from chromanoise.study.document import study_schema

_FORMULAS = ("3200K", "5000K", "6500K", "LED660")  # examples of lamps given by a formula
_SLIDERS = (
    ("light.level_lux", "Light level", "lx", 0.01, 10_000.0, "log", 0.01),
    ("light.infrared", "Infrared in the light", "W/W", 0.0, 5.0, "linear", 0.05),
    ("exposure.time_ms", "Exposure time", "ms", 0.1, 1000.0, "log", 0.01),
    ("exposure.saturate", "Share of full well", "1", 0.05, 1.0, "linear", 0.01),
    ("exposure.f_number", "f-number", "f/#", 1.0, 16.0, "log", 0.01),
)
_RANGES: Mapping[str, tuple[float, float]] = {  # of a new heat map, where no control has them
    "lux": (0.01, 10_000.0),
    "dark-current-e-per-s": (1.0, 1000.0),
    "temperature-c": (-20.0, 80.0),
    "bits": (8.0, 16.0),
    "kelvin": (2000.0, 10_000.0),
}


@lru_cache(maxsize=1)
def choices() -> dict[str, Any]:
    """Names of sensors, lights, scenes and matrices, controls, and sections.

    Steps of logarithmic sliders are of log10.
    """
    sliders = [
        dict(zip(("key", "label", "unit", "low", "high", "scale", "step"), one, strict=True))
        for one in _SLIDERS
    ]
    fields = described_fields()
    ranges: dict[str, tuple[float, float]] = {
        one["key"].rpartition(".")[2].replace("_", "-"): (one["low"], one["high"])
        for one in (*sliders, *fields)
        if "low" in one
    } | dict(_RANGES)
    return {
        "version": __version__,
        "sensors": _sensors(),
        "illuminants": _illuminants(),
        "illuminant_ends_nm": _ends_nm(),
        "scenes": list(BUILTIN_CUBES),
        "denoising": [
            {"name": one.name, "what": one.what}
            for one in DENOISING.values()
            if not one.baseline  # baselines are other packages, for `denoise-bench`
        ],
        "matrices": [
            {"name": name, "parameter": _parameter(one) if one.parameter else None}
            for name, one in METHODS.items()
        ],
        "priors": list(PRIORS),
        "spaces": list(SPACES),
        "metrics": list(METRICS),
        "terms": list(EQUAL_TERMS),
        "parts": list(DRAWINGS),
        "sweeps": [
            {"name": one.name, "what": one.what, "unit": one.unit, "first": low, "last": high}
            for one in SWEEPS.values()
            for low, high in (ranges[one.name],)
        ],
        "quantities": [{"name": one.name, "what": one.what} for one in QUANTITIES.values()],
        "coordinates": ["X", "Y", "Z", "L*", "a*", "b*"],
        "infrared_from_nm": INFRARED_FROM_NM,
        "infrared_lights": ["LED850", "LED940"],
        "sliders": sliders,
        "fields": fields,
        "defaults": study_defaults() | {"matrices": DEFAULT_METHOD},
        "most": {
            "sensors": MOST_SENSORS,
            "matrices": MOST_MATRICES,
            "seeds": study_schema()["properties"]["seed"]["exclusiveMaximum"],
        },
        "hints": dict(SECTION_HINTS),
        "sections": [asdict(section) for section in SECTIONS],
    }


def _parameter(method: MatrixMethod) -> dict[str, Any]:
    """The control of the parameter of a color matrix."""
    low, high, start = method.usual
    return {
        "label": method.label,
        "low": low,
        "high": high,
        "start": start,
        "scale": "log",
        "step": 0.02,
    }


def _sensors() -> list[dict[str, Any]]:
    """Sensors of the catalog that need no further settings."""
    found = []
    for entry in catalog_entries("sensors", folder=catalog_folder()):
        try:
            sensor = resolve_sensor(entry.provenance.name)
        except InputError:
            continue  # its table lacks metadata
        named = {"name": sensor.name, "what": entry.provenance.what}
        found.append(named | sensor_values(sensor))
    return found


def _illuminants() -> list[str]:
    """Illuminants by name: first those that cover 400-1050 nm, then those that end before."""
    ends = _ends_nm()
    names = [
        entry.provenance.name for entry in catalog_entries("illuminants", folder=catalog_folder())
    ]
    usable = []
    for name in (*names, *_FORMULAS):
        try:
            resolve_illuminant(name, answers=Answers(beyond="zero" if name in ends else "refuse"))
        except InputError:
            continue
        usable.append(name)
    return sorted(dict.fromkeys(usable), key=lambda name: name in ends)


def _ends_nm() -> dict[str, float]:
    """The last wavelength of the illuminants whose tables end within 400-1050 nm. [nm]"""
    entries = catalog_entries("illuminants", folder=catalog_folder())
    ranges = {entry.provenance.name: entry.provenance.range_nm for entry in entries}
    return {
        name: ends[1] for name, ends in ranges.items() if ends and ends[1] < DEFAULT_GRID.stop_nm
    }
