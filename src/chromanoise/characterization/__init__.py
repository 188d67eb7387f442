"""Noise of a camera from its own frames, and what is written about it."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.characterization.curves import PlaneCurves, plane_curves
    from chromanoise.characterization.data_sheets import (
        emva_sheet,
        emva_sheet_xml,
        photon_transfer_csv,
    )
    from chromanoise.characterization.json_form import characterization_as_json
    from chromanoise.characterization.merged_pixel import pixel_of, pixel_toml
    from chromanoise.characterization.noise_models import (
        color_of_plane,
        darktable_json,
        libcamera_json,
        noise_profile_json,
        noise_profile_line,
    )
    from chromanoise.characterization.results import (
        Characterization,
        LevelNoise,
        ModelVerdict,
        PlaneNoise,
    )

__all__ = [
    "Characterization",
    "LevelNoise",
    "ModelVerdict",
    "PlaneCurves",
    "PlaneNoise",
    "characterization_as_json",
    "color_of_plane",
    "darktable_json",
    "emva_sheet",
    "emva_sheet_xml",
    "libcamera_json",
    "noise_profile_json",
    "noise_profile_line",
    "photon_transfer_csv",
    "pixel_of",
    "pixel_toml",
    "plane_curves",
]
__getattr__, __dir__ = lazy_names(__name__)
