"""Reflectances under an illuminant: L of eq. 2."""

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
        The illuminant, at one lux.
    level_lux
        Illuminance on the scene: N_lux in the paper. [lx]
    reflectance
        Reflectances on the illuminant's grid (last axis), for any number of points; 0 .. 1 for
        matte surfaces, above 1 for fluorescence or gloss.

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
    """One point with the same reflectance at every wavelength: the test scene of the paper.

    Parameters
    ----------
    illuminant
        The light.
    level_lux
        Illuminance on the scene. [lx]
    reflectance
        Reflectance at every wavelength. [1]
    """
    flat = np.full(illuminant.grid.n, float(reflectance))
    return Scene(illuminant=illuminant, level_lux=level_lux, reflectance=flat)


def light(scene: Scene, metric: Metric) -> Float[Array, "*px n"]:
    """The vector L of eq. 2, N_lux i(lambda) rho(lambda), in the unit of the metric.

    Parameters
    ----------
    scene
        Light from the scene.
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    """
    photons = scene.level_lux * photon_irradiance(scene.illuminant) * scene.reflectance
    return photons / photons_per_unit(scene.illuminant.grid, metric)
