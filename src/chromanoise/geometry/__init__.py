"""Sensor space: dual basis, contravariant coordinates (eq. 3-4), angles, VIF, ellipses."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.geometry.angles import (
        NearestMix as NearestMix,
        angles_between_deg as angles_between_deg,
        angles_to_axes_deg as angles_to_axes_deg,
        nearest_mix as nearest_mix,
        variance_inflation as variance_inflation,
    )
    from chromanoise.geometry.dual_basis import (
        DualBasis as DualBasis,
        contravariant as contravariant,
        dual_and_orthonormal_bases as dual_and_orthonormal_bases,
        dual_frame as dual_frame,
        reconstructed_light as reconstructed_light,
        spectral_snr as spectral_snr,
    )
    from chromanoise.geometry.ellipse import (
        PlaneView as PlaneView,
        ellipse_half_axes as ellipse_half_axes,
        ellipse_outline as ellipse_outline,
        plane_view as plane_view,
        unit_circle as unit_circle,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__, Frame="DualBasis")
