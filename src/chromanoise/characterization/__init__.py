"""A camera's noise from its own raw frames, what is written about it, and a virtual camera."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.characterization.curves import PlaneCurves, plane_curves
    from chromanoise.characterization.data_sheets import (
        emva_sheet,
        emva_sheet_xml,
        photon_transfer_csv,
    )
    from chromanoise.characterization.kept_statistics import resumed
    from chromanoise.characterization.matrix_check import (
        MatrixCheck,
        variance_through,
        variance_through_file,
    )
    from chromanoise.characterization.measure import characterized
    from chromanoise.characterization.merged_pixel import pixel_of, pixel_toml
    from chromanoise.characterization.noise_models import (
        color_of_plane,
        darktable_json,
        libcamera_json,
        noise_profile_json,
        noise_profile_line,
        noise_profiles_json,
    )
    from chromanoise.characterization.own_json import (
        characterization_from_json,
        is_characterization,
    )
    from chromanoise.characterization.results import (
        QUANTITIES,
        SPREADS,
        Characterization,
        LevelNoise,
        ModelVerdict,
        PlaneNoise,
        Quantity,
        characterization_as_json,
        plane_names,
    )
    from chromanoise.characterization.sources import (
        characterization_of,
        characterize,
        characterized_table,
        read_source,
    )
    from chromanoise.characterization.statistics import (
        LightSample,
        PlaneSample,
        light_sample,
    )
    from chromanoise.characterization.training_camera import camera_noise
    from chromanoise.characterization.virtual_camera import (
        USUAL_CAMERA,
        PlaneTruth,
        VirtualCamera,
    )
    from chromanoise.characterization.virtual_frames import photon_transfer_frames

__all__ = [
    "QUANTITIES",
    "SPREADS",
    "USUAL_CAMERA",
    "Characterization",
    "LevelNoise",
    "LightSample",
    "MatrixCheck",
    "ModelVerdict",
    "PlaneCurves",
    "PlaneNoise",
    "PlaneSample",
    "PlaneTruth",
    "Quantity",
    "VirtualCamera",
    "camera_noise",
    "characterization_as_json",
    "characterization_from_json",
    "characterization_of",
    "characterize",
    "characterized",
    "characterized_table",
    "color_of_plane",
    "darktable_json",
    "emva_sheet",
    "emva_sheet_xml",
    "is_characterization",
    "libcamera_json",
    "light_sample",
    "noise_profile_json",
    "noise_profile_line",
    "noise_profiles_json",
    "photon_transfer_csv",
    "photon_transfer_frames",
    "pixel_of",
    "pixel_toml",
    "plane_curves",
    "plane_names",
    "read_source",
    "resumed",
    "variance_through",
    "variance_through_file",
]
__getattr__, __dir__ = lazy_names(__name__)
