"""The noise of a camera in codes: what a sampler of training data needs, per channel of a mosaic.

`Pixel` has one design for all channels and one gain. A camera that was measured, or calibrated in
the way of ELD, has a gain and a read noise for each channel, and changes them with the ISO setting.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError, Setting
from chromanoise.sensor.adc import adc_of
from chromanoise.sensor.eld_noise import ReadNoiseShape, eld_noise
from chromanoise.sensor.mosaic import Mosaic
from chromanoise.sensor.noise_source import PixelReading
from chromanoise.sensor.pixel import PIXEL, PIXEL_NOISE
from chromanoise.sensor.read_noise import (
    LARGEST_LAMBDA,
    LEAST_LAMBDA,
    MOST_DN,
    MOST_E,
    LogLinearNoise,
    ReadNoiseLaw,
    ReadNoiseTable,
    above_zero,
    tukey_lambda_variance,
)
from chromanoise.sensor.sensor import Sensor

_MOST_GAIN = 1e9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CameraNoise:
    """Noise of a camera at one ISO setting, and how it changes with the gain.

    code = black level + K (electrons - mean dark electrons), rounded and clipped to 0 .. top code.

    Attributes
    ----------
    names
        The ``p`` channels.
    gain_dn_per_e
        Gain K of each channel at ``iso``, > 0. [DN/e-]
    read_noise_e
        Standard deviation of the readout of each channel at ``iso``, rounding not included. [e-]
    black_level_dn
        Mean code without light, of each channel. [DN]
    top_code_dn
        Largest code: the white level. [DN]
    mosaic
        The channel of each pixel; ``None`` for a monochrome camera, or for one that measures all
        channels in each pixel.
    iso
        ISO setting of ``gain_dn_per_e``; ``None`` if not known. [1]
    full_well_e
        Electrons at which a pixel saturates, dark electrons included; ``None`` if the top code is
        lower. [e-]
    dark_current_e_per_s
        Dark electrons per second; their mean is subtracted from the codes. [e-/s]
    dsnu_e
        Standard deviation of the dark signal over the pixels. [e-]
    prnu
        Standard deviation of the sensitivity over the pixels. [1]
    row_noise_e
        Standard deviation of the offset that all pixels of a row share, new in each frame. [e-]
    column_noise_e
        The same of the pixels of a column. [e-]
    rtn_share, rtn_amplitude_e
        Random telegraph noise: share of the pixels that switch between two levels, and the
        difference between the levels. [1], [e-]
    tail_lambda
        Shapes of the Tukey lambda distribution of the read noise, one of which is used per item;
        empty for normal read noise. The variance is ``read_noise_e`` squared for every shape. [1]
    read_noise_law, row_noise_law, column_noise_law, dsnu_law
        Noise in DN as a function of the gain. Without ``read_noise_law``, a camera has only one
        ISO setting; without the others, row noise, column noise and DSNU in electrons are equal at
        all gains.
    gain_range_dn_per_e
        Lowest and highest gain drawn for an item; ``None`` if items use that at ``iso``. [DN/e-]
    black_offsets_dn
        Measured deviations of the black levels (ELD's color bias), (n, p): each item uses one of
        the n rows. ``None`` for no deviation. [DN]

    Raises
    ------
    InputError
        If a number is out of range, the channels are not those of the mosaic, or the lengths
        differ.

    Notes
    -----
    Names as in EMVA 1288, release 4.0; tails, laws and color bias as Wei, Fu, Yang & Huang, CVPR
    (2020).

    Examples
    --------
    >>> from chromanoise.sensor import ReadNoiseSum, bayer
    >>> camera = CameraNoise(names=("R", "G", "B"), mosaic=bayer(), top_code_dn=1023, iso=100,
    ...     gain_dn_per_e=np.array([0.25, 0.25, 0.25]), read_noise_e=np.array([3.0, 3.0, 3.0]),
    ...     black_level_dn=np.array([64.0, 64.0, 64.0]),
    ...     read_noise_law=ReadNoiseSum(after_gain_dn=0.6, before_gain_e=1.8))
    >>> camera.at_iso(400).gain_dn_per_e, camera.at_iso(400).read_noise_e.round(3)
    (array([1., 1., 1.]), array([1.897, 1.897, 1.897]))
    """

    names: tuple[str, ...]
    gain_dn_per_e: Float[Array, " p"]
    read_noise_e: Float[Array, " p"]
    black_level_dn: Float[Array, " p"]
    top_code_dn: float
    mosaic: Mosaic | None = None
    iso: float | None = None
    full_well_e: float | None = None
    dark_current_e_per_s: float = 0.0
    dsnu_e: float = 0.0
    prnu: float = 0.0
    row_noise_e: float = 0.0
    column_noise_e: float = 0.0
    rtn_share: float = 0.0
    rtn_amplitude_e: float = 0.0
    tail_lambda: tuple[float, ...] = ()
    read_noise_law: ReadNoiseLaw | None = None
    row_noise_law: LogLinearNoise | ReadNoiseTable | None = None
    column_noise_law: ReadNoiseTable | None = None
    dsnu_law: ReadNoiseTable | None = None
    gain_range_dn_per_e: tuple[float, float] | None = None
    black_offsets_dn: Float[Array, "n p"] | None = None

    def __post_init__(self) -> None:
        names = _check.distinct("channel names", self.names)
        if not names:
            raise InputError("channel names", "must name at least one channel", value=())
        object.__setattr__(self, "names", names)
        if self.mosaic is not None and set(self.mosaic.names) != set(names):
            raise InputError(
                "mosaic",
                f"must have the channels {', '.join(names)}",
                value=self.mosaic.names,
                found=f"has {', '.join(self.mosaic.names)}",
            )
        gain = self._per_channel("gain_dn_per_e", "DN/e-", _MOST_GAIN)
        above_zero("gain_dn_per_e", "DN/e-", gain)
        self._per_channel("read_noise_e", "e-", MOST_E)
        top = _check.within("top_code_dn", "DN", self.top_code_dn, 1, MOST_DN)
        if int(top) != top:
            raise InputError("top_code_dn", "must be a whole number [DN]", value=top)
        black = self._per_channel("black_level_dn", "DN", MOST_DN)
        if (black >= top).any():
            raise InputError(
                "black_level_dn",
                f"must be below the top code of {top:g} [DN]",
                value=float(black[black >= top][0]),
            )
        if self.iso is not None:
            _check.within("iso", "1", self.iso, 1e-3, 1e9)
        if self.full_well_e is not None:
            _check.within("full_well_e", "e-", self.full_well_e, 1e-3, MOST_E)
        for name in _PLAIN:
            PIXEL[name].demand(name, getattr(self, name))
        self._check_laws()

    def _check_laws(self) -> None:
        shapes = tuple(float(one) for one in self.tail_lambda)
        for one in shapes:
            _check.within("tail_lambda", "1", one, LEAST_LAMBDA, LARGEST_LAMBDA)
        object.__setattr__(self, "tail_lambda", shapes)
        law = self.read_noise_law
        if isinstance(law, LogLinearNoise) and law.tukey_scale and not shapes:
            raise InputError(
                "tail_lambda", "must be given, because the read noise is a Tukey lambda scale"
            )
        if self.gain_range_dn_per_e is not None:
            low, high = (float(one) for one in self.gain_range_dn_per_e)
            _check.within("lowest gain", "DN/e-", low, 1e-9, _MOST_GAIN)
            _check.within("highest gain", "DN/e-", high, low, _MOST_GAIN)
            if law is None:
                raise InputError(
                    "read_noise_law",
                    "must be given, because items have different gains",
                    remedy=Setting("read_noise_law"),
                )
        if self.black_offsets_dn is not None:
            offsets = _check.finite("black_offsets_dn", "DN", self.black_offsets_dn)
            if offsets.ndim != 2 or not offsets.size or offsets.shape[1] != len(self.names):
                raise InputError(
                    "black_offsets_dn",
                    f"must have rows of {len(self.names)} values, one per channel",
                    value=offsets.shape,
                    found=f"has shape {offsets.shape}",
                )
            object.__setattr__(self, "black_offsets_dn", _check.frozen(offsets))

    def _per_channel(self, name: str, unit: str, most: float) -> Array:
        values = _check.non_negative(name, unit, getattr(self, name))
        if values.shape != (len(self.names),):
            raise InputError(
                name,
                f"must have one value for each of {len(self.names)} channels [{unit}]",
                value=values.shape,
                found=f"has shape {values.shape}",
            )
        if (values > most).any():
            raise InputError(name, f"must be at most {most:g} [{unit}]", value=float(values.max()))
        object.__setattr__(self, name, _check.frozen(values))
        return values

    def at_iso(self, iso: float) -> "CameraNoise":
        """The camera at another ISO setting, to which the gain is proportional.

        Parameters
        ----------
        iso
            ISO setting, > 0; any number. [1]

        Returns
        -------
        CameraNoise
            With the gain and the read noise of this setting; noise that scatters about its law
            has its median.

        Raises
        ------
        InputError
            If the ISO setting of the camera, or the law of its read noise, is not known.

        Notes
        -----
        ISO 12232 (2019): the analog gain, and so K of EMVA 1288, is proportional to the setting.
        The black level in DN does not depend on it.
        """
        iso = _check.within("iso", "1", iso, 1e-3, 1e9)
        if self.iso is None:
            raise InputError(
                "iso",
                "must be absent for a camera whose own ISO is not known",
                value=iso,
                remedy="give the camera its ISO",
            )
        if iso == self.iso:
            return replace(self, gain_range_dn_per_e=None)
        return replace(self.at_gain(self.gain_dn_per_e * (iso / self.iso)), iso=iso)

    def at_gain(
        self,
        gain_dn_per_e: Float[Array, " p"],
        *,
        read_score: float = 0.0,
        row_score: float = 0.0,
        tail_lambda: float | None = None,
    ) -> "CameraNoise":
        """The camera at another gain.

        Parameters
        ----------
        gain_dn_per_e
            Gain per channel. [DN/e-]
        read_score, row_score
            Deviation of the logarithm of the noise from its law, in standard deviations. [1]
        tail_lambda
            The shape of the read noise; ``None`` for the first of the camera.

        Returns
        -------
        CameraNoise
            With one shape, and no range of gains.

        Raises
        ------
        InputError
            If the law of the read noise is not known, or a gain is outside its table.

        Notes
        -----
        A read noise given as a Tukey lambda scale s is s sqrt(variance of scale 1): see Joiner &
        Rosenblatt, JASA 66 (1971) 394.
        """
        if self.read_noise_law is None:
            raise InputError(
                "iso",
                "must be that of the camera, because its read noise at other gains is not known",
                value=None,
                found=f"differs from {self.iso:g}" if self.iso is not None else "differs",
                remedy="give read_noise_law, e.g. of read_noise_sum",
            )
        gain = above_zero("gain_dn_per_e", "DN/e-", gain_dn_per_e)
        law, shapes = self.read_noise_law, self.tail_lambda
        if tail_lambda is not None:
            shapes = (tail_lambda,)
        read_dn = law.noise_dn(gain, score=read_score)
        if isinstance(law, LogLinearNoise) and law.tukey_scale:
            read_dn = read_dn * math.sqrt(tukey_lambda_variance(shapes[0]))
        row_e = self.row_noise_e
        if self.row_noise_law is not None:
            row_dn = self.row_noise_law.noise_dn(gain, score=row_score)
            row_e = float(np.mean(row_dn / gain))
        others = {"dsnu_e": self.dsnu_law, "column_noise_e": self.column_noise_law}
        given: dict[str, Any] = {
            name: float(np.mean(one.noise_dn(gain) / gain)) for name, one in others.items() if one
        }
        ratio = float(gain[0] / self.gain_dn_per_e[0])
        return replace(
            self,
            iso=None if self.iso is None else self.iso * ratio,
            gain_dn_per_e=gain,
            read_noise_e=read_dn / gain,
            row_noise_e=row_e,
            **given,
            tail_lambda=shapes[:1],
            gain_range_dn_per_e=None,
        )

    def draw_settings(self, rng: np.random.Generator, *, iso: float | None = None) -> "CameraNoise":
        """The camera at the settings of one item: gain, noises about their laws, shape, offsets.

        Parameters
        ----------
        rng
            Random stream of the item.
        iso
            ISO setting; ``None`` for a gain of the range, or, without a range, the camera's own.

        Returns
        -------
        CameraNoise
            With one gain, one shape and one row of offsets. ln(K) is uniform over the range.

        Raises
        ------
        InputError
            As `at_iso` and `at_gain`.

        Notes
        -----
        Wei, Fu, Yang & Huang, CVPR (2020), section 4.2: joint sampling of the parameters.
        """
        uniform, read_score, row_score = rng.random(), *rng.standard_normal(2)
        shape_share, offset_share = rng.random(2)
        shape = _chosen(self.tail_lambda, shape_share)
        own = self
        if iso is not None and self.iso is None:
            own = self.at_iso(iso)  # refused there
        elif iso is not None and self.iso is not None and iso != self.iso:
            gain = self.gain_dn_per_e * (_check.within("iso", "1", iso, 1e-3, 1e9) / self.iso)
            own = replace(self._scattered(gain, read_score, row_score, shape), iso=iso)
        elif iso is None and self.gain_range_dn_per_e is not None:
            low, high = (math.log(one) for one in self.gain_range_dn_per_e)
            first = math.exp(low + uniform * (high - low))
            gain = self.gain_dn_per_e * (first / self.gain_dn_per_e[0])
            own = self._scattered(gain, read_score, row_score, shape)
        elif shape is not None:
            own = replace(self, tail_lambda=(shape,), gain_range_dn_per_e=None)
        if own.black_offsets_dn is None or len(own.black_offsets_dn) == 1:
            return own
        row = int(offset_share * len(own.black_offsets_dn))
        return replace(own, black_offsets_dn=own.black_offsets_dn[row : row + 1])

    def _scattered(
        self, gain: Array, read_score: float, row_score: float, shape: float | None
    ) -> "CameraNoise":
        return self.at_gain(
            gain, read_score=float(read_score), row_score=float(row_score), tail_lambda=shape
        )

    @classmethod
    def from_sensor(cls, sensor: Sensor) -> "CameraNoise":
        """The camera of a sensor: its pixel and its converter.

        Parameters
        ----------
        sensor
            With a mosaic, or with all channels in each pixel. Without the bits or the gain of the
            converter the assumptions are those of `adc_of`.

        Returns
        -------
        CameraNoise
            Without an ISO. The dark current is that at the pixel's temperature; the error of the
            black level is one row of offsets.

        Raises
        ------
        InputError
            If the pixel is the sum of several readings.

        Notes
        -----
        EMVA 1288, release 4.0, the linear camera model: K = 1 / (electrons per code).
        """
        pixel = sensor.pixel
        names = sensor.names if sensor.mosaic is None else sensor.mosaic.names
        if pixel.summed_readings != 1:
            raise InputError(
                f"sensor {sensor.name}",
                "must be read once per pixel",
                value=pixel.summed_readings,
                found=f"sums {pixel.summed_readings} readings",
                remedy="bin by charge",
            )
        adc = adc_of(sensor.converter, pixel)
        reading = PixelReading(pixel=pixel)
        error_dn = pixel.black_error_e / adc.gain_e_per_dn
        return cls(
            names=names,
            mosaic=sensor.mosaic,
            gain_dn_per_e=np.full(len(names), 1 / adc.gain_e_per_dn),
            read_noise_e=np.full(len(names), reading.sd("reading")),
            black_level_dn=np.full(len(names), float(adc.black_level_dn)),
            top_code_dn=float(adc.top_code),
            full_well_e=pixel.full_well_e,
            dark_current_e_per_s=pixel.dark_electrons_e(time_s=1.0),
            dsnu_e=reading.sd("pattern"),
            prnu=reading.sd("gain"),
            row_noise_e=reading.sd("row"),
            column_noise_e=reading.sd("column"),
            rtn_share=pixel.rtn_share,
            rtn_amplitude_e=pixel.rtn_amplitude_e,
            black_offsets_dn=np.full((1, len(names)), error_dn) if error_dn else None,
        )

    @classmethod
    def from_eld(
        cls,
        params: Mapping[str, Any],
        *,
        black_level_dn: float,
        top_code_dn: float,
        read: ReadNoiseShape = "tukey-lambda",
        profile: str = "Profile-1",
    ) -> "CameraNoise":
        """The camera of a calibration in the format of ELD.

        Parameters
        ----------
        params
            The dictionary of a file ``camera_params/*.npy``: ``Kmin`` and ``Kmax`` [DN/e-],
            ``G_shape`` (shapes of the Tukey lambda distribution), ``color_bias`` (rows of R, G1,
            B, G2 [DN], optional) and, below the name of the profile, ``G_scale`` (Tukey lambda),
            ``g_scale`` (normal) and ``R_scale`` (rows, optional): each ``slope``, ``bias`` and
            ``sigma`` of ln(noise in DN) over ln(K).
        black_level_dn, top_code_dn
            Of the camera; ELD's format does not contain them. [DN]
        read
            Which distribution the read noise has.
        profile
            Name of the profile.

        Returns
        -------
        CameraNoise
            A Bayer mosaic of R, G1, G2 and B; for each item, ln(K) is drawn uniformly between
            ln(Kmin) and ln(Kmax). Its own gain is the geometric mean of Kmin and Kmax.

        Raises
        ------
        InputError
            If a key is missing or a value is not as described.

        Notes
        -----
        Wei, Fu, Yang & Huang, CVPR (2020), eqs. 2, 8-11: shot noise, Tukey lambda noise, row noise
        and quantization, each as a function of K. The quantization noise, uniform over one step,
        is here the rounding to codes.
        """
        gains, of_eld = eld_noise(params, read=read, profile=profile)
        gain = math.sqrt(math.prod(gains))
        start = cls(
            names=("R", "G1", "G2", "B"),
            mosaic=Mosaic((("R", "G1"), ("G2", "B"))),
            gain_dn_per_e=np.full(4, gain),
            read_noise_e=np.zeros(4),
            black_level_dn=np.full(4, float(black_level_dn)),
            top_code_dn=float(top_code_dn),
            **of_eld,
        )
        own = start.at_gain(start.gain_dn_per_e)
        return replace(own, tail_lambda=start.tail_lambda, gain_range_dn_per_e=gains)


_PLAIN = tuple(name for name in PIXEL_NOISE if name in {one.name for one in fields(CameraNoise)})


def _chosen(shapes: Sequence[float], share: float) -> float | None:
    return shapes[int(share * len(shapes))] if shapes else None
