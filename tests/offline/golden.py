"""Random studies of the page, and where two replies to one question differ."""

import json
import math
import random

SENSORS = (
    *("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut", "model-rgb", "model-rgbw"),
    *("model-rgb-ircut", "model-rgbir", "model-cmy-ircut", "model-ryb-ircut", "mt9m131"),
    *("model-three-layer", "nikon-d850", "sony-ilce-7m4", "sigma-sd-merrill", "model-rccb"),
)
LIGHTS = (
    "E",
    "A",
    "G173",
    "3200K",
    "halogen",
    "led-white",
    "LED850",
    "A+0.5xLED850",
    "D65",
    "FL11",
)
MATRICES = (
    "kernel",
    "least-squares",
    "lmmse",
    "ridge=0.01",
    "white-preserving",
    "noise-regularized=1",
)
FILTERS = (None, "ircut-650", "ircut-700/20", "ircut-schott")
LIGHT_LUX = (0.01, 0.3, 1.0, 10.0, 200.0)


def studies(count, seed=0):
    """Random studies, some of which are refused."""
    draw = random.Random(seed)
    return [_study(draw) for _ in range(count)]


def _study(draw):
    light = {
        "illuminant": draw.choice(LIGHTS),
        "level_lux": draw.choice(LIGHT_LUX) * draw.uniform(0.5, 2),
    }
    if light["illuminant"] in ("D65", "FL11"):
        light["beyond"] = draw.choice(("zero", "hold"))
    sensors = []
    for name in draw.sample(SENSORS, draw.choice((1, 2, 2, 3))):
        sensor = {"name": name}
        if draw.random() < 0.4:
            sensor["pixel"] = {
                "read_noise_e": round(draw.uniform(0, 20), 2),
                "pitch_um": round(draw.uniform(0.8, 10), 2),
                "full_well_e": round(draw.uniform(500, 60000)),
            }
        if name == "sigma-sd-merrill":
            sensor["answers"] = {"peak_qe": 0.5, "beyond": "zero", "per": "photon"}
        if chosen := draw.choice(FILTERS):
            sensor["filter"] = chosen
        sensors.append(sensor)
    study = {"light": light, "sensors": sensors, "matrices": [draw.choice(MATRICES)]}
    if draw.random() < 0.4:
        study["exposure"] = {"time_ms": round(draw.uniform(0.1, 60), 2)}
    return study


def differences(ours, theirs, *, within, at=""):
    """Where two values of JSON differ: (place, ours, theirs), numbers by more than a share."""
    if isinstance(ours, dict) and isinstance(theirs, dict) and ours.keys() == theirs.keys():
        for key in ours:
            yield from differences(ours[key], theirs[key], within=within, at=f"{at}.{key}")
    elif isinstance(ours, list) and isinstance(theirs, list) and len(ours) == len(theirs):
        for i, (one, other) in enumerate(zip(ours, theirs, strict=True)):
            yield from differences(one, other, within=within, at=f"{at}.{i}")
    elif isinstance(ours, float) or isinstance(theirs, float):
        same = isinstance(theirs, int | float) and isinstance(ours, int | float)
        if not same or not math.isclose(ours, theirs, rel_tol=within, abs_tol=within):
            yield at, ours, theirs
    elif ours != theirs:
        yield at, ours, theirs


def question(study):
    """The body that asks everything of a study."""
    return json.dumps({"study": study})
