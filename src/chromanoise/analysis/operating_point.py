"""Electrons and measurements of one sensor at every stage, for many levels and patches.

All computations of SNR use this module: the analysis of one patch, sweeps over the light level and
the patches of a chart.
"""

from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.color import UNBOUNDED, ColorMatrix, ElectronSource, NoisyColor, colored, scene_xyz
from chromanoise.exposure import OperatingPoint, expected_electrons
from chromanoise.geometry import contravariant
from chromanoise.metrics import optimal_linear_snr_db, signal_snr_db
from chromanoise.noise import (
    Measurement,
    Moments,
    Readout,
    demand_independent_channels,
    noise_sources,
    one_code,
    raw_measurement,
    saturated,
    sensor_moments,
    with_noise,
)
from chromanoise.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stages:
    """Measurements at every stage; the leading axes are light levels, then patches.

    Attributes
    ----------
    point, matrix
        Sensor, exposure and light; the color matrix.
    scene
        The patches; the level of the scene is 1 lx where ``level_lux`` is given.
    level_lux
        Illuminances of the leading axis; ``None`` for the one level of ``point``. [lx]
    readout
        Clipping and rounding of the values; ``None`` for none.
    expected_e
        Expected electrons per channel, before clipping. [e-]
    raw
        The electrons after readout, with covariance.
    clipping
        Exact moments of the readout; ``None`` without one.
    lux_per_e
        One matrix per level, used in place of ``matrix``; ``None`` to use ``matrix``. [lx/e-]
    """

    point: OperatingPoint
    matrix: ColorMatrix
    scene: Scene
    level_lux: Float[Array, " k"] | None
    readout: Readout | None
    expected_e: Float[Array, "*px p"]
    raw: Measurement
    clipping: Moments | None
    lux_per_e: Float[Array, "k c p"] | None

    def __post_init__(self) -> None:
        _check.freeze(self, "expected_e")

    @property
    def saturated(self) -> Bool[Array, "*px p"]:
        """True where the expected electrons of a channel exceed the white level."""
        return saturated(self.expected_e, self.point.sensor, self.point.exposure)

    @property
    def one_code(self) -> Bool[Array, "*px p"]:
        """True where practically every reading of a channel is the same code of the converter."""
        return one_code(self.expected_e, self.point.sensor, self.point.exposure)

    @property
    def without_snr(self) -> Bool[Array, "*px"]:
        """True where no SNR of a color is defined: a channel is saturated, or gives one code."""
        return np.asarray((self.saturated | self.one_code).any(axis=-1))

    @property
    def temporal_raw(self) -> Measurement:
        """The electrons after readout without fixed-pattern noise (DSNU, PRNU, crosstalk)."""
        sensor, exposure = self.point.sensor, self.point.exposure
        noise = noise_sources(sensor, exposure)
        if not noise.has_fixed_pattern:
            return self.raw
        if self.readout is None:
            return with_noise(self.expected_e, sensor, exposure, kind="temporal")
        moments = sensor_moments(self.expected_e, noise.temporal, self.readout)
        return raw_measurement(moments, sensor.names)

    @property
    def truth_xyz(self) -> Float[Array, "*px 3"]:
        """X, Y, Z for the observer of the matrix. [lx]"""
        truth = scene_xyz(self.scene, self.matrix.metric, self.matrix.observer)
        return _at_levels(truth, self.level_lux)

    @property
    def contravariant(self) -> Measurement:
        """Contravariant coordinates (eq. 3)."""
        return contravariant(self.raw, self.matrix.frame)

    @property
    def color(self) -> Measurement:
        """Color coordinates with covariance (eq. 5). [lx]"""
        if self.lux_per_e is None:
            return colored(self.raw, self.matrix)
        _check.same_names("color", raw=self.raw.names, matrix=self.matrix.channels)
        patches = (1,) * (self.scene.reflectance.ndim - 1)
        levels, *size = self.lux_per_e.shape
        each = self.lux_per_e.reshape(levels, *patches, *size)
        return Measurement(
            mean=(each @ self.raw.mean[..., None])[..., 0],
            covariance=each @ self.raw.covariance @ np.swapaxes(each, -1, -2),
            names=self.matrix.coordinates,
            kind="".join(self.matrix.coordinates),
            unit="lx",
            metric=self.matrix.metric,
        )

    @property
    def color_snr_db(self) -> Float[Array, "*px c"]:
        """SNR of each color coordinate; NaN where it is undefined or has no signal. [dB]"""
        full = self.without_snr[..., None]
        if full.all():
            return np.full((*full.shape[:-1], len(self.matrix.coordinates)), np.nan)
        return np.where(full, np.nan, signal_snr_db(self.color, self.truth_xyz))

    @property
    def optimal_linear_snr_db(self) -> Float[Array, "*px"]:
        """SNR of the best linear readout; NaN where it is undefined. [dB]"""
        full = self.without_snr
        if full.all():
            return np.full(full.shape, np.nan)
        return np.where(full, np.nan, optimal_linear_snr_db(self.raw))


def electrons_at(
    point: OperatingPoint,
    *,
    level_lux: Float[Array, " k"] | None = None,
    reflectance: float | Float[Array, "*patches n"] = 1.0,
) -> Float[Array, "*px p"]:
    """Expected electrons of patches at many light levels, with a fixed exposure (eq. 2). [e-]

    Parameters
    ----------
    point
        Sensor, exposure and light.
    level_lux
        Illuminances, >= 0: the first axis of the result. ``None`` for the level of ``point``,
        without that axis. [lx]
    reflectance
        One number for all wavelengths, or values on the grid of the light (last axis), preceded by
        any axes of patches.

    Raises
    ------
    InputError
        If a level or a reflectance is negative, or light and sensor are not on one grid.
    """
    scene = _scene(point, level_lux, reflectance)
    return _at_levels(expected_electrons(scene, point.sensor, point.exposure), level_lux)


def stages_at(
    point: OperatingPoint,
    matrix: ColorMatrix,
    *,
    level_lux: Float[Array, " k"] | None = None,
    reflectance: float | Float[Array, "*patches n"] = 1.0,
    readout: Readout | None = None,
    lux_per_e: Float[Array, "k c p"] | None = None,
) -> Stages:
    """Compute every stage at an operating point: electrons, raw, contravariant, color coordinates.

    Parameters
    ----------
    point
        Sensor, exposure and light.
    matrix
        Color matrix.
    level_lux, reflectance
        As `electrons_at`.
    readout
        Clipping and rounding, with exact moments; ``None`` for eq. 7, unclipped.
    lux_per_e
        One matrix per level, used in place of ``matrix``. [lx/e-]

    Raises
    ------
    InputError
        As `electrons_at`, if there is not one matrix per level, or if a readout is given and
        crosstalk after counting correlates the channels.
    """
    levels = None if level_lux is None else _check.non_negative("level_lux", "lx", level_lux)
    if lux_per_e is not None:
        count = 0 if levels is None else levels.size
        _check.same_length("levels", level_lux=count, lux_per_e=len(lux_per_e))
    scene = _scene(point, levels, reflectance)
    expected = _at_levels(expected_electrons(scene, point.sensor, point.exposure), levels)
    clipping = None
    if readout is not None:
        demand_independent_channels(point.sensor)
        noise = noise_sources(point.sensor, point.exposure)
        clipping = sensor_moments(expected, noise, readout)
    return Stages(
        point=point,
        matrix=matrix,
        scene=scene,
        level_lux=levels,
        readout=readout,
        expected_e=expected,
        raw=raw_measurement(clipping, point.sensor.names)
        if clipping
        else with_noise(expected, point.sensor, point.exposure),
        clipping=clipping,
        lux_per_e=lux_per_e,
    )


def noisy_color_at(stages: Stages, white: Float[Array, " 3"]) -> NoisyColor:
    """The colors of the patches with their electron counts, for `chromanoise.color.propagate`.

    Its exact method needs independent channels (`demand_independent_channels`).

    Parameters
    ----------
    stages
        Stages with one matrix for all levels.
    white
        XYZ of a perfect white, measured by the sensor. [lx]
    """
    source = ElectronSource(
        mean_e=stages.expected_e,
        matrix=stages.matrix.matrix,
        noise=noise_sources(stages.point.sensor, stages.point.exposure),
        readout=stages.readout or UNBOUNDED,
    )
    return NoisyColor(xyz=_with_black_error(stages), white=white, source=source)


def _with_black_error(stages: Stages) -> Measurement:
    """The color as it is read: an error of the black level adds to its mean, not to its signal."""
    black_e = stages.point.sensor.pixel.black_error_e
    if not black_e or stages.clipping is not None:  # the moments of the readout include it
        return stages.color
    shift = black_e * stages.matrix.matrix.sum(axis=1)
    return replace(stages.color, mean=stages.color.mean + shift)


def _scene(
    point: OperatingPoint,
    level_lux: Float[Array, " k"] | None,
    reflectance: float | Float[Array, "*patches n"],
) -> Scene:
    rho = np.asarray(reflectance, dtype=np.float64)
    flat = np.full(point.illuminant.grid.n, rho) if rho.ndim == 0 else rho
    return Scene(
        illuminant=point.illuminant,
        level_lux=point.level_lux if level_lux is None else 1.0,
        reflectance=flat,
    )


def _at_levels(
    of_one_lux: Float[Array, "*patches p"], level_lux: Float[Array, " k"] | None
) -> Float[Array, "*px p"]:
    """Electrons and colors are proportional to the light."""
    if level_lux is None:
        return of_one_lux
    return np.multiply.outer(level_lux, of_one_lux)
