"""Sensor space: dual basis, contravariant coordinates (eq. 3-4), angles, VIF, ellipses."""

from chromanoise._lazy import lazy_names
from chromanoise.geometry.angles import NearestMix as NearestMix
from chromanoise.geometry.angles import angles_between_deg as angles_between_deg
from chromanoise.geometry.angles import angles_to_axes_deg as angles_to_axes_deg
from chromanoise.geometry.angles import nearest_mix as nearest_mix
from chromanoise.geometry.angles import variance_inflation as variance_inflation
from chromanoise.geometry.contravariant import contravariant as contravariant
from chromanoise.geometry.contravariant import spectral_snr as spectral_snr
from chromanoise.geometry.ellipse import PlaneView as PlaneView
from chromanoise.geometry.ellipse import ellipse_half_axes as ellipse_half_axes
from chromanoise.geometry.ellipse import ellipse_outline as ellipse_outline
from chromanoise.geometry.ellipse import plane_view as plane_view
from chromanoise.geometry.ellipse import unit_circle as unit_circle
from chromanoise.geometry.frame import DualBasis as DualBasis
from chromanoise.geometry.frame import dual_and_orthonormal_bases as dual_and_orthonormal_bases
from chromanoise.geometry.frame import dual_frame as dual_frame
from chromanoise.geometry.frame import reconstructed_light as reconstructed_light

__getattr__, __dir__ = lazy_names(__name__, Frame="DualBasis")
