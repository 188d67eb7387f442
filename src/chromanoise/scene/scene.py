"""Reflectances under a lamp: the L of eq. 2."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.spectra import Illuminant, Metric, photon_irradiance
from chromanoise.spectra.metric import photons_per_unit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scene:
    """Points of known reflectance under one illuminant.

    Attributes
    ----------
    illuminant
        The lamp, at one lux.
    level_lux
        Illuminance on the scene: the paper's N_lux. [lx]
    reflectance
        On the illuminant's grid, any number of points before it; 0 .. 1 for matte things, more
        where something fluoresces or shines.

    Raises
    ------
    InputError
        If the level is not positive, a reflectance is negative, or the grids differ.
    """

    illuminant: Illuminant
    level_lux: float
    reflectance: Float[Array, "*px n"]

    def __post_init__(self) -> None:
        _check.positive("level_lux", "lx", self.level_lux)
        _check.within("level_lux", "lx", self.level_lux, 1e-15, 1e15)
        rho = _check.non_negative("reflectance of the scene", "1", self.reflectance)
        _check.same_length(
            "wavelengths", illuminant=self.illuminant.grid.n, reflectance=rho.shape[-1]
        )
        object.__setattr__(self, "reflectance", _check.frozen(rho))


def flat_field(illuminant: Illuminant, *, level_lux: float, reflectance: float = 1.0) -> Scene:
    """One point of the same reflectance at every wavelength: the paper's test scene."""
    flat = np.full(illuminant.grid.n, float(reflectance))
    return Scene(illuminant=illuminant, level_lux=level_lux, reflectance=flat)


def light(scene: Scene, metric: Metric) -> Float[Array, "*px n"]:
    """The vector L of eq. 2, N_lux i(lambda) rho(lambda), in the unit of the metric."""
    photons = scene.level_lux * photon_irradiance(scene.illuminant) * scene.reflectance
    return photons / photons_per_unit(scene.illuminant.grid, metric)
