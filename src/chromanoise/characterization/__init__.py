"""A camera's noise from its own raw frames, what is written about it, and a virtual camera."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.characterization.curves import (
        PlaneCurves as PlaneCurves,
        plane_curves as plane_curves,
    )
    from chromanoise.characterization.data_sheets import (
        emva_sheet as emva_sheet,
        emva_sheet_xml as emva_sheet_xml,
        photon_transfer_csv as photon_transfer_csv,
    )
    from chromanoise.characterization.kept_statistics import resumed as resumed
    from chromanoise.characterization.matrix_check import (
        MatrixCheck as MatrixCheck,
        variance_through as variance_through,
        variance_through_file as variance_through_file,
    )
    from chromanoise.characterization.measure import characterized as characterized
    from chromanoise.characterization.merged_pixel import (
        pixel_of as pixel_of,
        pixel_toml as pixel_toml,
    )
    from chromanoise.characterization.noise_models import (
        color_of_plane as color_of_plane,
        darktable_json as darktable_json,
        libcamera_json as libcamera_json,
        noise_profile_json as noise_profile_json,
        noise_profile_line as noise_profile_line,
        noise_profiles_json as noise_profiles_json,
    )
    from chromanoise.characterization.own_json import (
        characterization_from_json as characterization_from_json,
        is_characterization as is_characterization,
    )
    from chromanoise.characterization.results import (
        QUANTITIES as QUANTITIES,
        SPREADS as SPREADS,
        Characterization as Characterization,
        LevelNoise as LevelNoise,
        ModelVerdict as ModelVerdict,
        PlaneNoise as PlaneNoise,
        Quantity as Quantity,
        characterization_as_json as characterization_as_json,
        plane_names as plane_names,
    )
    from chromanoise.characterization.sources import (
        characterization_of as characterization_of,
        characterize as characterize,
        characterized_table as characterized_table,
        read_source as read_source,
    )
    from chromanoise.characterization.statistics import (
        LightSample as LightSample,
        PlaneSample as PlaneSample,
        light_sample as light_sample,
    )
    from chromanoise.characterization.training_camera import camera_noise as camera_noise
    from chromanoise.characterization.virtual_camera import (
        USUAL_CAMERA as USUAL_CAMERA,
        PlaneTruth as PlaneTruth,
        VirtualCamera as VirtualCamera,
    )
    from chromanoise.characterization.virtual_frames import (
        photon_transfer_frames as photon_transfer_frames,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
