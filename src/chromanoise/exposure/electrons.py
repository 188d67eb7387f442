"""Eq. 1-2: expected electrons of a scene in each channel."""

from dataclasses import dataclass

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.scene import Scene, light
from chromanoise.sensor import Pixel, Sensor, code_range_e
from chromanoise.spectra import Metric
from chromanoise.spectra.metric import photons_per_unit

FASTEST_F_NUMBER = 0.5
"""The least f-number of a lens in air, by the sine condition."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Exposure:
    """Exposure time, f-number and magnification of an exposure.

    Attributes
    ----------
    time_s
        Exposure time t_i. [s]
    f_number
        f_# of the lens.
    magnification
        ``None`` for the paper's distant Lambertian scene, 1 / (4 f#^2) of the illuminance.
        A number m selects the camera equation 1 / (1 + 4 f#^2 (1 + |m|)^2) instead, which at
        f/1.8 and m = 0 is 0.32 dB darker.

    Raises
    ------
    InputError
        If a value is not positive, or out of the range of double precision.
    """

    time_s: float
    f_number: float = 1.8
    magnification: float | None = None

    def __post_init__(self) -> None:
        _check.positive("time_s", "s", self.time_s)
        _check.within("time_s", "s", self.time_s, 1e-15, 1e12)
        refuse_f_number(self.f_number)
        if self.magnification is not None:
            _check.within("magnification", "1", self.magnification, -1e6, 1e6)


def refuse_f_number(f_number: float) -> None:
    """Raise an error if no lens in air has this f-number.

    Parameters
    ----------
    f_number
        Aperture of the lens. [1]

    Raises
    ------
    InputError
        If it is below 0.5, where the sine of the half angle of the light cone, 1/(2 f#), would
        exceed 1, or above 1e6.
    """
    if not FASTEST_F_NUMBER <= f_number <= 1e6:
        raise InputError(
            "f_number",
            f"must be {FASTEST_F_NUMBER:g} to 1e+06",
            value=float(f_number),
            remedy=f"no lens in air is faster than f/{FASTEST_F_NUMBER:g} (sine condition)",
        )


def exposure_factor(exposure: Exposure, pixel: Pixel, step_nm: float) -> float:
    """The factor k of eq. 2: t a^2 delta-lambda / (4 f#^2). [s um2 nm]

    Parameters
    ----------
    exposure
        Time and lens.
    pixel
        The pixel.
    step_nm
        Step of the wavelengths. [nm]

    Examples
    --------
    >>> pixel = Pixel(pitch_um=10, full_well_e=10_000, read_noise_e=10)
    >>> round(exposure_factor(Exposure(time_s=0.0324, f_number=1.8), pixel, 1.0), 6)
    0.25
    """
    return exposure.time_s * pixel.pitch_um**2 * step_nm * _image_illuminance(exposure)


def _image_illuminance(exposure: Exposure) -> float:
    """Illuminance on the pixel divided by the illuminance on a white scene."""
    if exposure.magnification is None:
        return 1.0 / (4.0 * exposure.f_number**2)
    return 1.0 / (1.0 + 4.0 * exposure.f_number**2 * (1.0 + abs(exposure.magnification)) ** 2)


def measurement_vectors(sensor: Sensor, exposure: Exposure, metric: Metric) -> Float[Array, "n p"]:
    """The matrix F of eq. 3: one column f_i = k QE_i per channel, so that M = F^T L.

    Parameters
    ----------
    sensor
        The sensor.
    exposure
        Time and lens.
    metric
        The unit in which L is a vector; in ``energy``, f carries lambda / (h c) as well.
        [e- per unit of L]
    """
    k = exposure_factor(exposure, sensor.pixel, sensor.grid.step_nm)
    return k * sensor.qe * photons_per_unit(sensor.grid, metric)[:, None]


def expected_electrons(scene: Scene, sensor: Sensor, exposure: Exposure) -> Float[Array, "*px p"]:
    """Expected electrons per channel, M = k QE^T L (eq. 2). [e-]

    Parameters
    ----------
    scene
        Light from the scene.
    sensor
        The sensor.
    exposure
        Time and lens.

    Raises
    ------
    InputError
        If scene and sensor are not on the same grid.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 1-2. The integral is a plain sum, as there.
    """
    refuse_other_grid(scene, sensor)
    return light(scene, "quanta") @ measurement_vectors(sensor, exposure, "quanta")


def time_to_saturation(
    scene: Scene,
    sensor: Sensor,
    *,
    f_number: float = 1.8,
    share: float = 0.99,
    magnification: float | None = None,
) -> float:
    """The time at which the most sensitive channel reaches ``share`` of its range. [s]

    Its range is the full well, which dark electrons fill too, or the top code of the converter,
    whichever is reached first (`chromanoise.sensor.white_level_e`).

    Parameters
    ----------
    scene
        Scene; its brightest point determines the time.
    sensor
        The sensor.
    f_number, magnification
        As `Exposure`.
    share
        Share of full well or top code; the paper uses 0.99.

    Raises
    ------
    InputError
        If no channel receives light.
    """
    share = _check.positive("share", "1", share)
    if share > 1:
        raise InputError(
            "share",
            "must be at most 1 [share of full well]",
            value=share,
            remedy="divide percent by 100",
        )
    per_second = expected_electrons(
        scene, sensor, Exposure(time_s=1.0, f_number=f_number, magnification=magnification)
    )
    dark_per_second = sensor.pixel.dark_electrons_e(time_s=1.0)
    if not per_second.max() > 0:
        raise InputError(
            f"sensor {sensor.name}", "must see light of the scene", found="no channel sees any"
        )
    most = float(per_second.max())
    to_full_well = sensor.pixel.full_well_e / (most + dark_per_second)
    return share * min(to_full_well, code_range_e(sensor) / most)


def saturating_exposure(
    scene: Scene,
    sensor: Sensor,
    *,
    f_number: float = 1.8,
    share: float = 0.99,
    magnification: float | None = None,
) -> Exposure:
    """The exposure with the time of `time_to_saturation`.

    Parameters
    ----------
    scene
        Light from the scene.
    sensor
        The sensor.
    f_number
        Aperture of the lens. [1]
    share
        Share of full well that the most sensitive channel reaches. [1]
    magnification
        Magnification of the lens; ``None``: a distant scene. [1]
    """
    time_s = time_to_saturation(
        scene, sensor, f_number=f_number, share=share, magnification=magnification
    )
    return Exposure(time_s=time_s, f_number=f_number, magnification=magnification)


def refuse_other_grid(scene: Scene, sensor: Sensor) -> None:
    """Check that scene and sensor have the same wavelength grid."""
    if scene.illuminant.grid != sensor.grid:
        lit, own = scene.illuminant.grid, sensor.grid
        raise InputError(
            "grid",
            "must be the same for scene and sensor",
            value=(lit, own),
            found=f"the illuminant {scene.illuminant.name} is on {lit} and {sensor.name} on {own}",
        )
