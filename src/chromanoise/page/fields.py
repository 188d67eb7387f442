"""The controls of the page: one description for each key of a study, made from its schema.

A new field of a study appears on the page by itself, with a label, a unit and a range that are read
from its schema. `_REFINED` has better ones, and `ELSEWHERE` the keys with a control of their own.
"""

import re
from collections.abc import Iterator, Mapping
from typing import Any

from chromanoise.analysis.priors import PRIORS
from chromanoise.catalog.entries import catalog_entries, catalog_folder
from chromanoise.color import SPACES, TONES
from chromanoise.properties import Property
from chromanoise.sensor import MOSAIC_NAMES, PIXEL, PIXEL_NOISE
from chromanoise.spectra import METRICS, OBSERVERS
from chromanoise.study.document import BALANCE_WORDS, study_schema

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
    "light": ("Light", "File of the light"),
    "exposure": ("Exposure", "Lens"),
    "sensors": ("Sensors", "Filters"),
    "sensors.label": ("Sensors", ""),
    "sensors.pixel": ("Sensors", "Noise"),
    "sensors.pixel.file": ("Sensors", "Pixel"),
    "sensors.pixel.pitch_um": ("Sensors", "Pixel"),
    "sensors.pixel.full_well_e": ("Sensors", "Pixel"),
    "sensors.pixel.binning": ("Sensors", "Pixel"),
    "sensors.pixel.binning_mode": ("Sensors", "Pixel"),
    "sensors.pixel.bits": ("Sensors", "Readout"),
    "sensors.pixel.gain_dn_per_e": ("Sensors", "Readout"),
    "sensors.pixel.black_error_e": ("Sensors", "Readout"),
    "sensors.crosstalk": ("Sensors", "Crosstalk"),
    "sensors.crosstalk_stage": ("Sensors", "Crosstalk"),
    "sensors.mosaic": ("Sensors", "Crosstalk"),
    "sensors.beyond": ("Sensors", "File of the curves"),
    "sensors.answers": ("Sensors", "File of the curves"),
    "sensors.negatives": ("Sensors", "File of the curves"),
    "prior": ("Color matrix", ""),
    "metric": ("Reader", ""),
    "observer": ("Reader", ""),
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

_BEFORE = "none; e.g. ircut-650"
_LOGARITHMIC: Data = {"scale": "log"}


def _control(one: Property, part: str) -> Data:
    """The control of a property in a part: its label, its slider if it has one, what it needs."""
    slider = dict(zip(("low", "high", "step"), one.slider or (), strict=False))
    return {
        "label": one.label[:1].upper() + one.label[1:],
        **slider,
        **(_LOGARITHMIC if one.logarithmic and slider.get("low", 0) > 0 else {}),
        **({"needs": [f"{part}.{name}" for name in one.needs]} if one.needs else {}),
    }


_REFINED: Mapping[str, Data] = {
    "title": {"label": "Title"},
    "seed": {"label": "Seed of the noise", "low": 0, "high": 99, "step": 1},
    "metric": {"label": "Metric: spectra in", "options": list(METRICS)},
    "observer": {"label": "Observer", "options": list(OBSERVERS), "file": "spectrum"},
    "prior": {"label": "Prior of trained matrices", "options": list(PRIORS), "file": "spectrum"},
    "exposure.magnification": {
        "label": "Magnification of the lens",
        "low": -1.0,
        "high": 0.0,
        "step": 0.01,
        "hint": "distant scene",
    },
    "light.per": {"label": "The file counts"},
    "light.column": {"label": "Column of the file"},
    "light.wavelength_unit": {"label": "Unit of the wavelengths"},
    "light.negatives": {"label": "Small negative values"},
    "sensors.label": {"label": "Label", "hint": "its name"},
    "sensors.pixel.file": {"label": "File of the pixel", "hint": "none", "file": "pixel"},
    **{
        f"sensors.pixel.{name}": _control(one, "sensors.pixel")
        | ({"hint": "reference"} if name == "temperature_c" else {})
        for name, one in PIXEL.items()
    },
    "sensors.pixel.binning": {"label": "Binned pixels", "low": 1, "high": 16, "step": 1},
    "sensors.pixel.binning_mode": {"label": "Binning mode", "needs": ["sensors.pixel.binning"]},
    "sensors.pixel.bits": {
        "label": "Bits of the converter",
        "hint": "none",
        "low": 8,
        "high": 16,
        "step": 1,
    },
    "sensors.pixel.gain_dn_per_e": {
        "label": "Gain K",
        "low": 0.001,
        "high": 100.0,
        "step": 0.02,
        **_LOGARITHMIC,
        "hint": "from bits",
    },
    "sensors.crosstalk": {
        "label": "Crosstalk to the neighbors",
        "unit": "1",
        "low": 0.0,
        "high": 0.5,
        "step": 0.01,
        "file": "crosstalk",
        "example": "0, 0.02, 0\n0.02, 0.92, 0.02\n0, 0.02, 0",
    },
    "sensors.crosstalk_stage": {"label": "Crosstalk of", "needs": ["sensors.crosstalk"]},
    "sensors.mosaic": {
        "label": "Mosaic of the neighbors",
        "suggestions": list(MOSAIC_NAMES),
        "needs": ["sensors.crosstalk"],
        "hint": "its own; e.g. bayer, RG/GB",
    },
    "sensors.filter": {"label": "Filter on the sensor", "file": "spectrum", "hint": _BEFORE},
    "sensors.channel_filters": {"label": "Filter of channel", "file": "spectrum", "hint": _BEFORE},
    "sensors.filter_wavelength_unit": {
        "label": "Unit of the filter's wavelengths",
        "needs": ["sensors.filter"],
    },
    "sensors.shift_ircut_nm": {
        "label": "Shift of the filter on the sensor",
        "low": -50.0,
        "high": 50.0,
        "step": 1.0,
        "needs": ["sensors.filter"],
    },
    "sensors.ircut_nm": {"label": "IR-cut edge", "low": 600.0, "high": 1050.0, "step": 5.0},
    "sensors.shift_nm": {"label": "Shift of the filters", "low": -50.0, "high": 50.0, "step": 1.0},
    "sensors.answers.peak_qe": {
        "label": "Peak QE of relative curves",
        "unit": "1",
        "low": 0.05,
        "high": 1.0,
        "step": 0.01,
    },
    "sensors.answers.scale": {"label": "QE values are"},
    "sensors.answers.level": {"label": "Curves are"},
    "sensors.answers.per": {"label": "Curves are per"},
    "sensors.answers.wavelength_unit": {"label": "Unit of the wavelengths"},
    "sensors.beyond": {"label": "Outside the range of the curves"},
    "sensors.negatives": {"label": "Small negative values"},
    "reflectances.chart": {"label": "Chart", "file": "spectrum", "hint": "the ColorChecker"},
    "reflectances.patch": {
        "label": "Patch",
        "file": "spectrum",
        "hint": "perfect white; e.g. 0.18",
    },
    "reflectances.pairs": {"label": "Pairs for a machine", "file": "spectrum", "hint": "all pairs"},
    "reflectances.scale": {"label": "Reflectances are"},
    "reflectances.wavelength_unit": {"label": "Unit of the wavelengths"},
    "reflectances.beyond": {"label": "Outside the range of the curves"},
    "pictures.scale": {
        "label": "Reflectance per stored unit",
        "low": 1e-5,
        "high": 10.0,
        **_LOGARITHMIC,
    },
    "pictures.bad_pixels": {"label": "Invalid reflectances"},
    "pictures.clip": {"label": "Clip electrons in the picture"},
    **{f"pictures.{name}": _control(PIXEL[name], "pictures") for name in PIXEL_NOISE},
    "outputs.analyses": {"label": "Every stage, per matrix"},
    "outputs.budget": {"label": "SNR budget"},
    "outputs.clip": {"label": "Clip electrons (without budget)"},
    "outputs.merit": {"label": "Figures of merit"},
    "outputs.chart": {"label": "Every patch of the chart"},
    "outputs.space": {"label": "Noise of gray in", "options": list(SPACES)},
    "outputs.matrix": {"label": "Each matrix, its error and noise"},
    "outputs.pipeline.run": {"label": "Noise after each step"},
    "outputs.pipeline.white_balance": {
        "suggestions": [*BALANCE_WORDS, "D65"],
        "hint": "gray, D65, or gains",
    },
    "outputs.pipeline.white_balance_pixels": {
        "label": "Gray pixels for the gains",
        "low": 10,
        "high": 10**6,
        "step": 0.1,
        **_LOGARITHMIC,
        "hint": "exact",
    },
    "outputs.pipeline.exposure_gain": {"low": 0.1, "high": 10.0, "step": 0.02, **_LOGARITHMIC},
    "outputs.pipeline.saturation": {"label": "Color saturation", "low": 0.0, "high": 2.0},
    "outputs.pipeline.tone": {"label": "Tone curve", "suggestions": [*TONES, "2.2"]},
    "outputs.pipeline.luma": {"label": "Luma"},
    "outputs.pipeline.iso": {"label": "ISO settings", "hint": "e.g. 100, 200, 400"},
    "outputs.pipeline.base_iso": {
        "label": "Base ISO",
        "low": 10.0,
        "high": 3200.0,
        **_LOGARITHMIC,
    },
    "outputs.pipeline.iso_read_noise_e": {"label": "Read noise at each ISO", "hint": "the same"},
}
_NEEDING = {"outputs.pipeline": "outputs.pipeline.run"}
_SUFFIXES = re.compile(r"_(?:um|e|c|k|nm|e_per_s|dn_per_e|lux|ms)$")
_STEPS = 100


def described_fields() -> list[Data]:
    """One description for each key of a study that has a control on the page, in their order.

    ``key`` has no index (``sensors.pixel.dsnu_e``). ``kind`` is number, choice, flag, text or
    channels (a text for each channel); ``file`` is what a file in place of the value holds.
    ``needs`` is a key without which this one has no effect.
    """
    leaves = _leaves()
    keys = dict.fromkeys(key for key in (*_REFINED, *leaves) if key in leaves)
    return [_described(key, leaves[key]) for key in keys if not _is_elsewhere(key)]


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
    refined = {"suggestions": None, **_REFINED.get(key, {})}
    suggestions = refined.pop("suggestions")
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
        described["suggestions"] = _filters() if key in _FILTERED else suggestions or []
        described["numeric"] = bool(types & {"number", "array"})
        described["many"] = "array" in types
    return described


_FILTERED = ("sensors.filter", "sensors.channel_filters")


def _begins(key: str, beginning: str) -> bool:
    return not beginning or f"{key}.".startswith(f"{beginning}.")


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
