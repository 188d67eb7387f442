"""Expected electrons (eq. 1-2), exposure settings, and rules for equal exposure."""

from chromanoise.exposure.cubes import band_weights
from chromanoise.exposure.electrons import (
    Exposure,
    expected_electrons,
    exposure_factor,
    measurement_vectors,
    refuse_f_number,
    saturating_exposure,
    time_to_saturation,
)
from chromanoise.exposure.operating_point import (
    OperatingPoint,
    conditions,
    level_in_words,
    light_and_exposure,
    patch_scene,
    white_scene,
)
from chromanoise.exposure.rules import EQUAL_TERMS, equal_exposure, equal_light, equal_saturation

__all__ = [
    "EQUAL_TERMS",
    "Exposure",
    "OperatingPoint",
    "band_weights",
    "conditions",
    "equal_exposure",
    "equal_light",
    "equal_saturation",
    "expected_electrons",
    "exposure_factor",
    "level_in_words",
    "light_and_exposure",
    "measurement_vectors",
    "patch_scene",
    "refuse_f_number",
    "saturating_exposure",
    "time_to_saturation",
    "white_scene",
]
