"""Expected electrons (eq. 1-2), exposure settings, and rules for equal exposure."""

from chromanoise._lazy import lazy_names
from chromanoise.exposure.cubes import band_weights as band_weights
from chromanoise.exposure.electrons import Exposure as Exposure
from chromanoise.exposure.electrons import expected_electrons as expected_electrons
from chromanoise.exposure.electrons import exposure_factor as exposure_factor
from chromanoise.exposure.electrons import measurement_vectors as measurement_vectors
from chromanoise.exposure.electrons import refuse_f_number as refuse_f_number
from chromanoise.exposure.electrons import saturating_exposure as saturating_exposure
from chromanoise.exposure.electrons import time_to_saturation as time_to_saturation
from chromanoise.exposure.operating_point import OperatingPoint as OperatingPoint
from chromanoise.exposure.operating_point import conditions as conditions
from chromanoise.exposure.operating_point import level_in_words as level_in_words
from chromanoise.exposure.operating_point import light_and_exposure as light_and_exposure
from chromanoise.exposure.operating_point import patch_scene as patch_scene
from chromanoise.exposure.operating_point import white_scene as white_scene
from chromanoise.exposure.rules import EQUAL_TERMS as EQUAL_TERMS
from chromanoise.exposure.rules import equal_exposure as equal_exposure
from chromanoise.exposure.rules import equal_light as equal_light
from chromanoise.exposure.rules import equal_saturation as equal_saturation

__getattr__, __dir__ = lazy_names(__name__)
