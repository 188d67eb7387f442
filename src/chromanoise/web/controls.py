"""The controls of the page, made from the keys of a study, and the choices that they offer.

A new field of a study appears on the page by itself, with the label, unit and range of its
declaration, or else with those of its schema. `ELSEWHERE` has the keys with a control of their own.
Choices are names, and the ranges of the sliders.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from functools import lru_cache
from typing import Any

from chromanoise.base import InputError, __version__
from chromanoise.charts import DRAWINGS, SECTIONS, sensor_values
from chromanoise.color import SPACES
from chromanoise.imaging.denoising import DENOISING
from chromanoise.io.spectra import Answers
from chromanoise.noise import EQUAL_TERMS
from chromanoise.spectra import BUILTIN_CUBES, DEFAULT_GRID, INFRARED_FROM_NM, METRICS
from chromanoise.study import (
    DEFAULT_METHOD,
    KEYS,
    METHODS,
    PRIORS,
    QUANTITIES,
    SWEEPS,
    MatrixMethod,
    catalog_entries,
    catalog_folder,
    resolve_illuminant,
    resolve_sensor,
    study_schema,
)
from chromanoise.web.page_studies import MOST_MATRICES, MOST_SENSORS

Data = dict[str, Any]

_SHOWN = "the control at the head of its group"
_ASKED = "asked when the file is dropped, or edited in the study file"
_RUN = "set in the study file: the picture of the page has all channels at every pixel"
ELSEWHERE: Mapping[str, str] = {
    "schema": "the version of the format, not a choice",
    "sensors.name": "the list at the head of each sensor",
    "light.illuminant": _SHOWN,
    "light.level_lux": _SHOWN,
    "light.beyond": "asked where the light ends early",
    "exposure.equal": _SHOWN,
    "exposure.time_ms": _SHOWN,
    "exposure.saturate": _SHOWN,
    "exposure.f_number": _SHOWN,
    "matrices": "one control for each matrix",
    "outputs.reader": _SHOWN,
    "outputs.pareto": "set in the study file: the page shows the curve of every study",
    "pictures.cube": _SHOWN,
    "pictures.beyond": _SHOWN,
    "pictures.key": _ASKED,
    "pictures.shape": _ASKED,
    "pictures.wavelengths": _ASKED,
    "pictures.denoise": "the list above the picture",
    "pictures.mosaic": _RUN,
    "pictures.demosaic": _RUN,
    "pictures.raw_only": _RUN,
    "pictures.bits": _RUN,
    "pictures.black_level": _RUN,
    "pictures.formats": _RUN,
    "pictures.frames": _RUN,
    "sweeps": "the panel of two parameters",
}
"""Keys of a study without a description here, each with the reason."""

_PLACES: Mapping[str, tuple[str, str]] = {  # by the beginning of a key: section and group
    "": ("Run", ""),
    "metric": ("Reader", ""),
    "observer": ("Reader", ""),
    "prior": ("Color matrix", ""),
    "exposure": ("Exposure", "Lens"),
    "light": ("Light", "File of the light"),
    "sensors.label": ("Sensors", ""),
    "sensors.pixel.file": ("Sensors", "Pixel"),
    "sensors.pixel.pitch_um": ("Sensors", "Pixel"),
    "sensors.pixel.full_well_e": ("Sensors", "Pixel"),
    "sensors.pixel.binning": ("Sensors", "Pixel"),
    "sensors.pixel.binning_mode": ("Sensors", "Pixel"),
    "sensors.pixel": ("Sensors", "Noise"),
    "sensors.pixel.bits": ("Sensors", "Readout"),
    "sensors.pixel.gain_dn_per_e": ("Sensors", "Readout"),
    "sensors.pixel.black_error_e": ("Sensors", "Readout"),
    "sensors.crosstalk": ("Sensors", "Crosstalk"),
    "sensors.crosstalk_stage": ("Sensors", "Crosstalk"),
    "sensors.mosaic": ("Sensors", "Crosstalk"),
    "sensors": ("Sensors", "Filters"),
    "sensors.answers": ("Sensors", "File of the curves"),
    "sensors.beyond": ("Sensors", "File of the curves"),
    "sensors.negatives": ("Sensors", "File of the curves"),
    "reflectances": ("Scene", "Own reflectances"),
    "pictures": ("Scene", "Camera of the picture"),
    "outputs": ("Run", "Outputs"),
    "outputs.pipeline": ("Run", "Pipeline"),
}
SECTION_HINTS: Mapping[str, str] = {
    "Sensors": "Each sensor has its own pixel, crosstalk and filters; all else is shared.",
    "Run": "For the command line and the report; not shown in these charts.",
}
"""Hints of sections."""

_HINTS = {"sensors.pixel.temperature_c": "reference"}
_EXAMPLES = {"sensors.crosstalk": "0, 0.02, 0\n0.02, 0.92, 0.02\n0, 0.02, 0"}
_KEYS = {re.sub(r"\.[*0]", "", key): one for key, one in KEYS.items()}
_NEEDING = {"outputs.pipeline": "outputs.pipeline.run"}
_SUFFIXES = re.compile(r"_(?:um|e|c|k|nm|e_per_s|dn_per_e|lux|ms)$")
_STEPS = 100


def described_fields() -> list[Data]:
    """One description for each key of a study that has a control on the page, in their order.

    ``key`` has no index (``sensors.pixel.dsnu_e``). ``kind`` is number, choice, flag, text or
    channels (a text for each channel); ``file`` is what a file in place of the value holds.
    ``needs`` is a key without which this one has no effect.
    """
    described = [
        _described(key, schema) for key, schema in _leaves().items() if not _is_elsewhere(key)
    ]
    groups = list(_PLACES.values())
    return sorted(described, key=lambda one: groups.index((one["section"], one["group"])))


def study_defaults() -> Data:
    """The default of each key of a study that holds one text, number or flag."""
    found = {key: one.get("default") for key, one in _leaves().items()}
    return {key: value for key, value in found.items() if isinstance(value, str | int | float)}


def _is_elsewhere(key: str) -> bool:
    return any(f"{key}.".startswith(f"{one}.") for one in ELSEWHERE)


def _leaves() -> dict[str, Data]:
    """The schema of each key of a study that holds a value."""
    schema = study_schema()
    parts = schema["$defs"]

    def inside(fields: Data, prefix: str) -> Iterator[tuple[str, Data]]:
        for name, one in fields.items():
            options = [one, one.get("items", {}), *one.get("anyOf", ())]
            named = [option["$ref"] for option in options if "$ref" in option]
            if named:
                part = parts[named[0].rpartition("/")[2]]
                yield from inside(part["properties"], f"{prefix}{name}.")
            else:
                yield f"{prefix}{name}", one

    return dict(inside(schema["properties"], ""))


def _described(key: str, schema: Data) -> Data:
    options = [one for one in schema.get("anyOf", [schema]) if one.get("type") != "null"]
    types = {one["type"] for one in options}
    refined = _refined(key)
    suggestions = refined.pop("suggestions", [])
    words = refined.pop("options", None) or options[0].get("enum")
    place = max((one for one in _PLACES if _begins(key, one)), key=len)
    described: Data = {
        "key": key,
        "section": _PLACES[place][0],
        "group": _PLACES[place][1],
        "label": _SUFFIXES.sub("", key.rpartition(".")[2]).replace("_", " ").capitalize(),
        "what": schema.get("description", ""),
        "kind": _kind(types, words, refined),
        "default": schema.get("default"),
        "needs": _needs(key),
        **refined,
    }
    if described["kind"] == "number":
        described = _ranges(options, described, whole="integer" in types)
    if described["kind"] == "choice":
        described["options"] = words
    if described["kind"] in ("text", "channels"):
        described["suggestions"] = _filters() if key in _FILTERED else suggestions
        described["numeric"] = bool(types & {"number", "array"})
        described["many"] = "array" in types
    return described


_FILTERED = ("sensors.filter", "sensors.channel_filters")


def _begins(key: str, beginning: str) -> bool:
    return not beginning or f"{key}.".startswith(f"{beginning}.")


def _refined(key: str) -> Data:
    """What the class of a key says about its control."""
    one = _KEYS[key]
    if one.interface is None:
        return {}
    interface, part = one.interface, key.rpartition(".")[0]
    chosen = bool(one.names) and (not one.others or bool(interface.file))
    found = {
        "label": interface.label,
        **dict(zip(("low", "high", "step"), interface.slider or (), strict=False)),
        "scale": "log" if interface.logarithmic else "",
        "hint": _HINTS.get(key, interface.hint or ""),
        "file": interface.file,
        "example": _EXAMPLES.get(key, ""),
        "needs": [f"{part}.{name}" for name in interface.needs],
        "options" if chosen else "suggestions": [*one.names, *interface.suggestions],
    }
    return {name: value for name, value in found.items() if value not in ("", [])}


def _needs(key: str) -> list[str]:
    own = (one for start, one in _NEEDING.items() if _begins(key, start))
    return [one for one in own if one != key]


def _kind(types: set[str], words: Any, refined: Data) -> str:
    if words:
        return "choice"
    if types == {"boolean"}:
        return "flag"
    if types == {"object"}:
        return "channels"
    alone = types <= {"number", "integer"} or "high" in refined
    return "number" if alone else "text"


def _ranges(options: list[Data], described: Data, *, whole: bool) -> Data:
    """The description with unit, ends, scale and step of its slider."""
    unit = re.search(r"\[([^\]]+)\]", described["what"])
    ends = {"low": options[0].get("minimum", 0.0), "high": options[0].get("maximum", 100.0)}
    low, high = ((ends | described)[name] for name in ends)
    scale = described.get("scale", "linear")
    step = 0.05 if scale == "log" else 1 if whole else (high - low) / _STEPS
    return {
        "unit": unit.group(1) if unit else "1",
        "scale": scale,
        "step": step,
        "whole": whole,
        **described,
        "low": low,
        "high": high,
    }


def _filters() -> list[str]:
    """Filters with a fixed name, and examples of those with a parameter."""
    names = [entry.provenance.name for entry in catalog_entries("filters", folder=catalog_folder())]
    return [*(name for name in names if "<" not in name), *_EDGES]


_EDGES = ("ircut-650", "ircut-700")


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
            {"name": one.name, "what": one.what, "needs": [name for name, _ in one.absent_packages]}
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
    """Sensors and cameras of the catalog that need no further settings."""
    found = []
    folder = catalog_folder()
    of_sensors, cameras = (catalog_entries(kind, folder=folder) for kind in ("sensors", "cameras"))
    for entry in (*of_sensors, *cameras):
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
