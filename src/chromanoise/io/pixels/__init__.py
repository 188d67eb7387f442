"""Pixel parameters from TOML, EMVA 1288 data sheets, noise profiles, photon-transfer tables."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.pixels.emva import (
        pixel_from_emva as pixel_from_emva,
        read_emva_sheet as read_emva_sheet,
    )
    from chromanoise.io.pixels.noise_profiles import (
        RelativeNoise as RelativeNoise,
        is_noise_profile_text,
        pixel_from_darktable as pixel_from_darktable,
        read_darktable_noise as read_darktable_noise,
        read_noise_profile as read_noise_profile,
    )
    from chromanoise.io.pixels.photon_transfer_csv import (
        is_photon_transfer_text,
        read_photon_transfer_csv as read_photon_transfer_csv,
    )
    from chromanoise.io.pixels.pixel_toml import (
        errors_in_file,
        finite_number,
        is_pixel_toml_text,
        pixel_source_toml as pixel_source_toml,
        read_pixel_toml as read_pixel_toml,
        source_text,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
