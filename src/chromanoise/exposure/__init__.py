"""Expected electrons (eq. 1-2), exposure settings, and rules for equal exposure."""

from chromanoise._lazy import lazy_names
from chromanoise.exposure.cubes import band_weights as band_weights
from chromanoise.exposure.electrons import (
    Exposure as Exposure,
    expected_electrons as expected_electrons,
    exposure_factor as exposure_factor,
    measurement_vectors as measurement_vectors,
    refuse_f_number as refuse_f_number,
    saturating_exposure as saturating_exposure,
    time_to_saturation as time_to_saturation,
)
from chromanoise.exposure.operating_point import (
    OperatingPoint as OperatingPoint,
    conditions as conditions,
    level_in_words as level_in_words,
    light_and_exposure as light_and_exposure,
    patch_scene as patch_scene,
    white_scene as white_scene,
)
from chromanoise.exposure.rules import (
    EQUAL_TERMS as EQUAL_TERMS,
    equal_exposure as equal_exposure,
    equal_light as equal_light,
    equal_saturation as equal_saturation,
)

__getattr__, __dir__, __all__ = lazy_names(__name__)
