"""Sensor space: dual basis, contravariant coordinates (eq. 3-4), angles, VIF, ellipses."""

from chromanoise._lazy import old_names
from chromanoise.geometry.angles import (
    NearestMix,
    angles_between_deg,
    angles_to_axes_deg,
    nearest_mix,
    variance_inflation,
)
from chromanoise.geometry.contravariant import contravariant, spectral_snr
from chromanoise.geometry.ellipse import (
    PlaneView,
    ellipse_half_axes,
    ellipse_outline,
    plane_view,
    unit_circle,
)
from chromanoise.geometry.frame import (
    DualBasis,
    dual_and_orthonormal_bases,
    dual_frame,
    reconstructed_light,
)

__all__ = [
    "DualBasis",
    "NearestMix",
    "PlaneView",
    "angles_between_deg",
    "angles_to_axes_deg",
    "contravariant",
    "dual_and_orthonormal_bases",
    "dual_frame",
    "ellipse_half_axes",
    "ellipse_outline",
    "nearest_mix",
    "plane_view",
    "reconstructed_light",
    "spectral_snr",
    "unit_circle",
    "variance_inflation",
]
__getattr__ = old_names(__name__, Frame="DualBasis")
