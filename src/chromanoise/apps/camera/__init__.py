"""A camera's noise from its own raw frames, what is written about it, and a virtual camera."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.apps.camera.camera_figures import (
        characterization_figures as characterization_figures,
        draw_characterization as draw_characterization,
        draw_linearity as draw_linearity,
        draw_linearity_deviation as draw_linearity_deviation,
        draw_photon_transfer as draw_photon_transfer,
        draw_predicted_variance as draw_predicted_variance,
        draw_snr as draw_snr,
        draw_variance_residuals as draw_variance_residuals,
    )
    from chromanoise.apps.camera.characterization import (
        QUANTITIES as QUANTITIES,
        SPREADS as SPREADS,
        Characterization as Characterization,
        LevelNoise as LevelNoise,
        ModelVerdict as ModelVerdict,
        PlaneNoise as PlaneNoise,
        Quantity as Quantity,
        characterization_as_json as characterization_as_json,
        characterization_from_json as characterization_from_json,
        is_characterization as is_characterization,
        plane_names as plane_names,
    )
    from chromanoise.apps.camera.exports import (
        MatrixCheck as MatrixCheck,
        color_of_plane as color_of_plane,
        darktable_json as darktable_json,
        emva_sheet as emva_sheet,
        emva_sheet_xml as emva_sheet_xml,
        libcamera_json as libcamera_json,
        noise_profile_json as noise_profile_json,
        noise_profile_line as noise_profile_line,
        noise_profiles_json as noise_profiles_json,
        photon_transfer_csv as photon_transfer_csv,
        variance_through as variance_through,
        variance_through_file as variance_through_file,
    )
    from chromanoise.apps.camera.measure import (
        characterize as characterize,
        characterized as characterized,
        characterized_table as characterized_table,
        read_source as read_source,
        resumed as resumed,
    )
    from chromanoise.apps.camera.measured_pixel import (
        camera_noise as camera_noise,
        pixel_of as pixel_of,
        pixel_toml as pixel_toml,
    )
    from chromanoise.apps.camera.planes import (
        PlaneCurves as PlaneCurves,
        plane_curves as plane_curves,
    )
    from chromanoise.apps.camera.statistics import (
        LightSample as LightSample,
        PlaneSample as PlaneSample,
        light_sample as light_sample,
    )
    from chromanoise.apps.camera.virtual_camera import (
        FRAME_FORMATS,
        PROPERTIES,
        USUAL_CAMERA as USUAL_CAMERA,
        PlaneTruth as PlaneTruth,
        VirtualCamera as VirtualCamera,
        photon_transfer_frames as photon_transfer_frames,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
