"""A virtual camera: raw frames drawn from known noise, to test a characterization with them.

The camera is drawn source by source, from photons to codes, and uses no formula of the photon
transfer. One pixel with the mean electrons mu of light and d of dark current reads

    code = round(black level + K (f(min(N, full well)) + read + DSNU + row + column + telegraph)),

limited to 0 and 2^bits - 1, where N is Poisson with the mean mu + d, and
f(e) = e - bend e^2 / (2 full well).

`photon_transfer_frames` writes a photon transfer of a virtual camera as a folder of frames.
"""

import io
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from itertools import count
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from chromanoise.apps.camera.characterization import dynamic_range_db, plane_names, threshold_e
from chromanoise.base import (
    Array,
    Float,
    InputError,
    Int,
    Property,
    Setting,
    UInt16,
    check,
    dataclass,
    optional_package,
    properties_of,
    stream,
    whole_folder,
)
from chromanoise.sensor import (
    PIXEL,
    PIXEL_NOISE,
    READ_OUT,
    Mosaic,
    PartialPixel,
    Pixel,
    PixelReading,
    mosaic_named,
)

_PRNU, _DSNU, _HOT, _LIGHT, _DARK, _READ, _ROWS, _COLUMNS, _SWITCHING, _LEVELS = range(10)
"""Random streams."""

_MOST_SIDE, _MOST_PIXELS = 65_535, 1 << 28
_GEOMETRY = ("pitch_um",)  # properties of a pixel that have no effect on codes
_QUIET = Pixel(pitch_um=1.0, full_well_e=12_000.0, read_noise_e=0.0)


@dataclass(frozen=True, kw_only=True)
class PlaneTruth(PartialPixel):
    """True values of one plane of a virtual camera, named as in `PlaneNoise`.

    The noise of `Pixel`, with the dark current at the temperature of the camera, and:

    Attributes
    ----------
    name
        The channel: ``R``, ``G1``, ``G2``, ``B``; ``mono`` without a mosaic.
    gain_dn_per_e
        System gain at low light. [DN/e-]
    dark_noise_e
        Temporal noise at exposure time 0, rounding not included. [e-]
    black_level_dn
        Mean code of the plane's pixels at exposure time 0. [DN]
    saturation_dn, full_well_e
        Largest mean code, set by the full well or the largest code, and its electrons. [DN], [e-]
    dynamic_range_db
        20 log10 of the full well over the absolute sensitivity threshold (`PlaneNoise`). [dB]
    qe
        Electrons per photon, mean over the plane's pixels. [e-/photon]
    dsnu_of_pixels_e, prnu_of_pixels
        Standard deviations of the pixels that were drawn. [e-], [1]
    hot_pixels
        In this plane. [1]
    """

    name: str
    gain_dn_per_e: float
    dark_noise_e: float
    black_level_dn: float
    saturation_dn: float
    full_well_e: float
    dynamic_range_db: float
    qe: float
    dsnu_of_pixels_e: float
    prnu_of_pixels: float
    hot_pixels: int


@dataclass(frozen=True, kw_only=True)
class VirtualCamera(PartialPixel):
    """A camera whose noise is known. Every non-ideality is 0 by default.

    The properties of `Pixel` but the pitch, and those below. The mean of the dark electrons stays
    in the codes. By default the full well is 12,000 e- and the read noise 0.

    Attributes
    ----------
    shape
        Rows and columns. [px]
    mosaic
        Channels as in `chromanoise.sensor.mosaic_named`, e.g. ``RG/GB``; ``None`` for monochrome.
    gain_dn_per_e
        System gain K at low light: one number, or one per channel of the mosaic in the order of
        their first appearance. [DN/e-]
    bits
        Bits of the codes, 8 to 16.
    black_level_dn
        Code without light. [DN]
    qe
        Electrons per photon of a channel with sensitivity 1. [e-/photon]
    sensitivity
        Sensitivity of the channels relative to ``qe``: one number, or one per channel. [1]
    hot_pixels, hot_pixel_e_per_s
        Number of pixels with excess dark current, and the excess of each. [1], [e-/s]
    bend
        Share by which the gain falls from 0 to the full well: at e electrons it is
        K (1 - bend e / full_well_e). [1]
    drift
        Relative change of the light from one frame to the next: frame n has (1 + drift)^n times the
        light. [1]
    shading
        Share by which the light falls from the center to the corners, with the square of the
        distance; the mean over the frame is unchanged. [1]
    neighbor_correlation
        Correlation of the shot and read noise of adjacent pixels of one plane, as after denoising
        in the camera: each plane's noise is blurred by (a, 1 - 2a, a) along rows and columns, which
        also lowers its variance. 0 to 0.6. [1]
    seed
        Seed of all random numbers: an integer >= 0.

    Raises
    ------
    InputError
        If a number is out of range, the pitch is given, the black level is not below the largest
        code, there is not one gain or sensitivity per channel, or the frame is smaller than two
        periods of the mosaic.

    Notes
    -----
    Fixed patterns (PRNU, DSNU, hot pixels, pixels with telegraph noise) depend on the seed and the
    shape only. Each source of noise in each frame has its own random stream, so that frames can be
    drawn in any order. The model of the camera is that of EMVA 1288, release 4.0, sections 2 to 4.

    Examples
    --------
    >>> camera = VirtualCamera(shape=(2, 3), gain_dn_per_e=0.5, black_level_dn=64)
    >>> camera.frame(electrons=0.0, time_ms=10.0)
    array([[64, 64, 64],
           [64, 64, 64]], dtype=uint16)
    """

    shape: tuple[int, int] = (240, 320)
    mosaic: str | None = None
    gain_dn_per_e: float | tuple[float, ...] = 0.25
    bits: int = 12
    black_level_dn: float = 0.0
    qe: Annotated[
        float,
        Property(
            label="QE", unit="e-/photon", least=1e-6, most=1.0,
            help="QE [e-/photon].",
        ),
    ] = 0.5  # fmt: skip
    sensitivity: float | tuple[float, ...] = 1.0
    dark_current_e_per_s: Annotated[
        float | None,
        replace(
            PIXEL["dark_current_e_per_s"],
            help="Dark current [e-/s]; the longest exposure is 100 ms.",
        ),
    ] = None  # fmt: skip
    hot_pixels: int = 0
    hot_pixel_e_per_s: Annotated[
        float,
        Property(
            label="excess of a hot pixel", unit="e-/s", least=0.0, most=1e9,
            help="Additional dark current of each hot pixel [e-/s].",
        ),
    ] = 1000.0  # fmt: skip
    bend: Annotated[
        float,
        Property(
            label="bend", unit="1", least=0.0, most=0.9,
            help="Relative fall of the gain from dark to full well, e.g. 0.1.",
        ),
    ] = 0.0  # fmt: skip
    drift: Annotated[
        float,
        Property(
            label="drift", unit="1", least=-0.1, most=0.1,
            help="Relative change of the light from one frame to the next.",
        ),
    ] = 0.0  # fmt: skip
    shading: Annotated[
        float,
        Property(
            label="shading", unit="1", least=0.0, most=0.9,
            help="Relative fall of the light from the center to the corners.",
        ),
    ] = 0.0  # fmt: skip
    neighbor_correlation: Annotated[
        float,
        Property(
            label="correlation of neighbors", unit="1", least=0.0, most=0.6,
            help="Correlation of the noise of neighboring pixels, as after denoising in the "
            "camera.",
        ),
    ] = 0.0  # fmt: skip
    seed: int = 0

    def __post_init__(self) -> None:
        for name in _GEOMETRY:
            if getattr(self, name) is not None:
                raise InputError(name, "must be omitted, because codes do not depend on it")
        for name, one in properties_of(type(self)).items():  # type: ignore[arg-type] # Hashable
            value = getattr(self, name)
            if value is None and name not in _GEOMETRY:
                object.__setattr__(self, name, getattr(_QUIET, name))
            elif value is not None:
                object.__setattr__(self, name, one.demand(name, value))
        for name, one in PIXEL.items():
            idle = one.needs and not any(getattr(self, needed) for needed in one.needs)
            if idle and getattr(self, name) != getattr(_QUIET, name):
                labels = " or ".join(PIXEL[needed].label for needed in one.needs)
                raise InputError(
                    name,
                    f"must be given only for a camera with {labels}",
                    value=getattr(self, name),
                    found="there is none",
                    remedy=(*map(Setting, one.needs), "omit it"),
                )
        _ = self.reading  # refuses a pixel that cannot be
        object.__setattr__(self, "bits", check.whole("bits", self.bits, 8, 16))
        object.__setattr__(self, "seed", check.whole("seed", self.seed, 0, (1 << 128) - 1))
        object.__setattr__(self, "shape", self._checked_shape())
        hot = check.whole("hot_pixels", self.hot_pixels, 0, math.prod(self.shape))
        object.__setattr__(self, "hot_pixels", hot)
        black_dn = check.within("black_level_dn", "DN", self.black_level_dn, 0, self.top_code - 1)
        object.__setattr__(self, "black_level_dn", black_dn)
        for name, most in (("gain_dn_per_e", 1e6), ("sensitivity", 1.0)):
            object.__setattr__(self, name, self._per_channel(name, 1e-6, most))

    @property
    def pattern(self) -> Mosaic:
        """The mosaic; one channel, ``mono``, without one."""
        return Mosaic((("mono",),)) if self.mosaic is None else mosaic_named(self.mosaic)

    @property
    def reading(self) -> PixelReading:
        """A reading of the pixel without dark electrons and rounding."""
        values = {name: getattr(self, name) for name in PIXEL if name not in _GEOMETRY}
        return PixelReading(pixel=replace(_QUIET, **values))

    @property
    def top_code(self) -> int:
        """The largest code, 2^bits - 1. [DN]"""
        return (1 << self.bits) - 1

    def frame(
        self,
        *,
        photons_per_pixel: float | None = None,
        electrons: float | None = None,
        time_ms: float,
        dark: bool = False,
        number: int = 0,
    ) -> UInt16[Array, "h w"]:
        """The codes of one frame. [DN]

        Parameters
        ----------
        photons_per_pixel
            Mean number of photons on a pixel during the exposure, before ``drift``. [1]
        electrons
            Instead of photons: mean electrons of a channel with sensitivity 1. [e-]
        time_ms
            Exposure time; it sets the dark electrons. [ms]
        dark
            Whether the frame has no light; then photons and electrons must not be given.
        number
            Number of the frame: frames with different numbers have independent noise.

        Raises
        ------
        InputError
            If the light is not given exactly once, or a number is out of range.
        """
        check.whole("number", number, 0, 1_000_000_000)
        dark_e = self._dark_electrons(check.within("time_ms", "ms", time_ms, 0.0, 1e8))
        photons = self._photons(photons_per_pixel, electrons, dark, number)
        light_e = photons * self.qe * self._light_map()
        reading = self.reading
        expected_e = self._response_e(light_e + dark_e)
        charge_e = stream(self.seed, _LIGHT, number).poisson(light_e).astype(np.float64)
        charge_e += stream(self.seed, _DARK, number).poisson(dark_e)
        noise_e = self._response_e(charge_e) - expected_e
        noise_e += self._normal(_READ, number, self.shape, reading.sd("reading"))
        signal_e = expected_e + self._blurred(noise_e) + self._offsets_e()
        rows, columns = self.shape
        signal_e += self._normal(_ROWS, number, (rows, 1), reading.sd("row"))
        signal_e += self._normal(_COLUMNS, number, (1, columns), reading.sd("column"))
        signal_e += self._level_offsets_e(number)
        codes = np.rint(self.black_level_dn + self._channel_map(self.gain_dn_per_e) * signal_e)
        return np.asarray(np.clip(codes, 0, self.top_code).astype(np.uint16))

    def planes(self) -> tuple[PlaneTruth, ...]:
        """The true values of each plane, in the order of the pixels of one period."""
        high, wide = self.pattern.shape
        gains, response = self._channel_map(self.gain_dn_per_e), self._pixel_sensitivity()
        light, offsets_e, hot = self.qe * self._light_map(), self._offsets_e(), self._hot_map()
        reading, a = self.reading, _blur_share(self.neighbor_correlation)
        kept = (2 * a**2 + (1 - 2 * a) ** 2) ** 2
        others_e2 = reading.coefficient("floor_e2", READ_OUT, but=("reading",))
        dark_noise_e = math.sqrt(kept * reading.sd("reading") ** 2 + others_e2)
        noise = {name: getattr(self, name) for name in PIXEL_NOISE}
        noise["dark_current_e_per_s"] = reading.pixel.dark_electrons_e(time_s=1.0)
        planes = []
        for i, name in enumerate(plane_names(self.pattern)):
            own = np.s_[i // wide :: high, i % wide :: wide]
            gain = float(gains[own][0, 0])
            full_well_e, saturation_dn = self._saturation(gain, reading.pixel.full_well_e)
            least_e = threshold_e(gain, dark_noise_e)
            planes.append(
                PlaneTruth(
                    **noise,
                    name=name,
                    gain_dn_per_e=gain,
                    dark_noise_e=dark_noise_e,
                    black_level_dn=self.black_level_dn + gain * float(offsets_e[own].mean()),
                    saturation_dn=saturation_dn,
                    full_well_e=full_well_e,
                    dynamic_range_db=dynamic_range_db(full_well_e, least_e) or 0.0,
                    qe=float(light[own].mean()),
                    dsnu_of_pixels_e=float(offsets_e[own].std()),
                    prnu_of_pixels=float(response[own].std()),
                    hot_pixels=int(hot[own].sum()),
                )
            )
        return tuple(planes)

    def _saturation(self, gain: float, well_e: float) -> tuple[float, float]:
        """Electrons and mean code at saturation: by the full well, or by the largest code."""
        bend = self.bend
        at_well_dn = self.black_level_dn + gain * well_e * (1 - bend / 2)
        if at_well_dn <= self.top_code:
            return well_e, at_well_dn
        reached_e = (self.top_code - self.black_level_dn) / gain  # electrons of a straight response
        root = math.sqrt(1 - 2 * bend * reached_e / well_e)
        return 2 * reached_e / (1 + root), float(self.top_code)

    def _checked_shape(self) -> tuple[int, int]:
        shape: Any = self.shape
        if len(shape) != 2:
            raise InputError("shape", "must be rows and columns [px]", value=shape)
        rows, columns = (
            check.whole("shape", side, 2 * least, _MOST_SIDE)
            for side, least in zip(shape, self.pattern.shape, strict=True)
        )
        if rows * columns > _MOST_PIXELS:
            raise InputError("shape", f"must hold at most {_MOST_PIXELS} pixels", value=shape)
        return rows, columns

    def _per_channel(self, name: str, least: float, greatest: float) -> float | tuple[float, ...]:
        given = getattr(self, name)
        unit = "DN/e-" if name == "gain_dn_per_e" else "1"
        if np.ndim(given) == 0:
            return check.within(name, unit, given, least, greatest)
        channels = self.pattern.names
        if len(given) != len(channels):
            raise InputError(
                name,
                f"must be one number, or one for each of {', '.join(channels)}",
                value=tuple(given),
                found=f"has {len(given)}",
            )
        return tuple(check.within(name, unit, each, least, greatest) for each in given)

    def _photons(
        self, photons: float | None, electrons: float | None, dark: bool, number: int
    ) -> float:
        """Photons per pixel of this frame, drift included."""
        given = {"photons_per_pixel": photons, "electrons": electrons}
        known = {name: value for name, value in given.items() if value is not None}
        if len(known) != (0 if dark else 1):
            demand = "must not be given with dark" if dark else "must be given exactly once"
            found = f"is given as {' and '.join(known)}" if known else "is missing"
            raise InputError("the light", demand, value=known, found=found)
        if dark:
            return 0.0
        ((name, value),) = known.items()
        light = check.within(name, "1", value, 0.0, 1e12) / (self.qe if name == "electrons" else 1)
        drift = math.exp(min(number * math.log1p(self.drift), 700.0))
        return check.within("photons_per_pixel with drift", "1", light * drift, 0.0, 1e15)

    def _dark_electrons(self, time_ms: float) -> Float[Array, "h w"]:
        pixel = self.reading.pixel
        current = pixel.dark_electrons_e(time_s=1.0) + self.hot_pixel_e_per_s * self._hot_map()
        return np.asarray(1e-3 * time_ms * current)

    def _light_map(self) -> Float[Array, "h w"]:
        """Electrons of each pixel over ``qe`` times the mean photons: channel, shading, PRNU."""
        return np.asarray(
            self._channel_map(self.sensitivity) * self._shading_map() * self._pixel_sensitivity()
        )

    def _pixel_sensitivity(self) -> Float[Array, "h w"]:
        return np.maximum(1 + self._normal(_PRNU, 0, self.shape, self.reading.sd("gain")), 0.0)

    def _offsets_e(self) -> Float[Array, "h w"]:
        """What is the same in every frame: DSNU and the error of the black level."""
        own_e = self._normal(_DSNU, 0, self.shape, self.reading.sd("pattern"))
        return np.asarray(own_e + self.reading.pixel.black_error_e)

    def _level_offsets_e(self, number: int) -> Float[Array, "h w"]:
        """Offsets of the pixels with telegraph noise; 0 for the others."""
        share, away_e = self.reading.levels
        if not share:
            return np.zeros(self.shape)
        switching = stream(self.seed, _SWITCHING).random(self.shape) < share
        up = stream(self.seed, _LEVELS, number).integers(0, 2, self.shape)
        return np.asarray(switching * away_e * (2 * up - 1))

    def _hot_map(self) -> Int[Array, "h w"]:
        """1 at hot pixels."""
        hot = np.zeros(math.prod(self.shape), dtype=np.int64)
        if self.hot_pixels:
            rng = stream(self.seed, _HOT)
            hot[rng.choice(hot.size, self.hot_pixels, replace=False, shuffle=False)] = 1
        return hot.reshape(self.shape)

    def _shading_map(self) -> Float[Array, "h w"]:
        if not self.shading:
            return np.ones(self.shape)
        y, x = (np.linspace(-1.0, 1.0, side)[:, None] for side in self.shape)
        falling = 1 - self.shading * (y**2 + x.T**2) / 2
        return np.asarray(falling / falling.mean())

    def _channel_map(self, values: float | tuple[float, ...]) -> Float[Array, "h w"]:
        """The value of each pixel's channel."""
        channels = self.pattern.names
        of = dict(zip(channels, np.broadcast_to(values, len(channels)), strict=True))
        tile = np.array([[of[name] for name in row] for row in self.pattern.pattern])
        rows, columns = self.shape
        tiles = (-(-rows // tile.shape[0]), -(-columns // tile.shape[1]))
        return np.tile(tile, tiles)[:rows, :columns]

    def _response_e(self, charge_e: Float[Array, "h w"]) -> Float[Array, "h w"]:
        """Electrons that a straight response would need for the same code."""
        well_e = self.reading.pixel.full_well_e
        kept = np.minimum(charge_e, well_e)
        return np.asarray(kept - self.bend * kept**2 / (2 * well_e))

    def _blurred(self, noise_e: Float[Array, "h w"]) -> Float[Array, "h w"]:
        """The noise blurred within each plane; opposite edges of the frame are neighbors."""
        a = _blur_share(self.neighbor_correlation)
        if not a:
            return noise_e
        for axis, step in enumerate(self.pattern.shape):
            beside = np.roll(noise_e, step, axis) + np.roll(noise_e, -step, axis)
            noise_e = (1 - 2 * a) * noise_e + a * beside
        return noise_e

    def _normal(
        self, source: int, number: int, shape: tuple[int, int], sd: float
    ) -> Float[Array, "h w"]:
        if not sd:
            return np.zeros(shape)
        return np.asarray(sd * stream(self.seed, source, number).standard_normal(shape))


def _blur_share(correlation: float) -> float:
    """The a at which white noise blurred by (a, 1 - 2a, a) has this correlation of neighbors.

    Solves 2a (1 - 2a) = correlation (2a^2 + (1 - 2a)^2).
    """
    c = correlation
    return (2 * c + 1 - math.sqrt(1 - 2 * c**2)) / (6 * c + 4)


PROPERTIES = {
    name: one for name, one in properties_of(VirtualCamera).items() if name not in _GEOMETRY
}
"""The properties of a virtual camera by name."""
USUAL_CAMERA = VirtualCamera(
    read_noise_e=3, dark_current_e_per_s=30, dsnu_e=1.5, prnu=0.008, row_noise_e=0.5
)
"""A camera with the noise of many."""


FRAME_FORMATS = ("npy", "tiff", "pgm", "fits")
"""File formats of `photon_transfer_frames`."""

_MOST_LEVELS, _MOST_FRAMES = 200, 100


def photon_transfer_frames(
    camera: VirtualCamera,
    *,
    folder: Path,
    levels: int = 16,
    frames: int = 2,
    darks: int = 2,
    file_format: str = "npy",
    varied: str = "time",
    longest_time_ms: float = 100.0,
    brightest: float = 1.1,
) -> tuple[Path, ...]:
    """Write flats from dark to saturation with matched darks; return the paths of the frames.

    The levels are evenly spaced. Beside the frames, ``capture.toml`` states mosaic, bits and, for
    each level, its frames, exposure time and photons; ``truth.toml`` holds the camera and the true
    values of each plane (`PlaneTruth`). The folder is written as a whole or not at all; other
    files in it stay.

    Parameters
    ----------
    folder
        Output folder; files of the same names are replaced.
    levels
        Number of levels, 2 to 200.
    frames, darks
        Flats per level, 2 to 100, and darks per level, 1 to 100.
    file_format
        ``npy``, ``tiff``, ``pgm`` (binary, 16 bits where the codes have more than 8) or ``fits``
        (needs astropy).
    varied
        ``time``: the light is constant and the exposure time grows, as the standard prefers, so
        that dark current and linearity can be measured. ``light``: the time is constant.
    longest_time_ms
        Exposure time of the last level. [ms]
    brightest
        Light of the last level, relative to that at which the mean of the least sensitive channel
        reaches saturation. [1]

    Raises
    ------
    InputError
        If a number is out of range, the format is unknown or its package missing, or the folder
        cannot be written.

    Notes
    -----
    EMVA 1288, release 4.0, section 6: flats and darks of equally spaced exposures.
    """
    check.one_of("file_format", file_format, FRAME_FORMATS)
    written = _FORMATS[file_format]
    check.one_of("varied", varied, ("time", "light"))
    check.within("longest_time_ms", "ms", longest_time_ms, 1e-3, 1e7)
    check.within("brightest", "1", brightest, 0.01, 10.0)
    check.whole("levels", levels, 2, _MOST_LEVELS)
    check.whole("frames", frames, 2, _MOST_FRAMES)
    check.whole("darks", darks, 1, _MOST_FRAMES)
    truth = camera.planes()
    photons = brightest * max(plane.full_well_e / plane.qe for plane in truth)
    lines = ["# Frames of a virtual camera; truth.toml has its true values."]
    lines += _pairs({"mosaic": camera.mosaic, "bits": camera.bits})
    paths, numbers = [], count()
    with whole_folder(folder, "demo-frames") as scratch:
        for i in range(1, levels + 1):
            light = photons * (i / levels)
            time_ms = longest_time_ms * (i / levels if varied == "time" else 1.0)
            files: dict[str, list[str]] = {}
            for kind, many in (("flat", frames), ("dark", darks)):
                of_kind = {"dark": True} if kind == "dark" else {"photons_per_pixel": light}
                names = [f"level-{i:02}-{kind}-{k}.{file_format}" for k in range(1, many + 1)]
                for name in names:
                    codes = camera.frame(**of_kind, time_ms=time_ms, number=next(numbers))
                    (scratch / name).write_bytes(written(codes, camera))
                files[f"{kind}s"] = names
                paths += [folder / name for name in names]
            entry = {**files, "time_ms": time_ms, "photons_per_pixel": light}
            lines += ["", "[[levels]]", *_pairs(entry)]
        (scratch / "capture.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
        (scratch / "truth.toml").write_text(_truth_toml(camera, truth), encoding="utf-8")
    return tuple(paths)


# ---- files ----

Codes = UInt16[Array, "h w"]


def _bytes_of(write: Callable[[io.BytesIO], Any]) -> bytes:
    kept = io.BytesIO()
    write(kept)
    return kept.getvalue()


def _npy(codes: Codes, _: VirtualCamera) -> bytes:
    return _bytes_of(lambda file: np.save(file, codes))


def _tiff(codes: Codes, _: VirtualCamera) -> bytes:
    from tifffile import imwrite

    facts: dict[str, Any] = {"photometric": "minisblack", "software": "chromanoise"}
    return _bytes_of(lambda file: imwrite(file, codes, metadata=None, **facts))


def _pgm(codes: Codes, camera: VirtualCamera) -> bytes:
    """Netpbm's PGM, binary: most significant byte first, 1 byte per code up to 255."""
    rows, columns = codes.shape
    header = f"P5\n{columns} {rows}\n{camera.top_code}\n".encode()
    return header + codes.astype(">u2" if camera.top_code > 255 else "u1").tobytes()


def _fits(codes: Codes, _: VirtualCamera) -> bytes:
    fits = optional_package(
        "astropy.io.fits",
        "file_format",
        extra="fits",
        value="fits",
        otherwise=("use another format",),
    )
    return _bytes_of(fits.PrimaryHDU(codes).writeto)


_FORMATS: Mapping[str, Callable[[Codes, VirtualCamera], bytes]] = {
    "npy": _npy,
    "tiff": _tiff,
    "pgm": _pgm,
    "fits": _fits,
}


def _truth_toml(camera: VirtualCamera, truth: tuple[PlaneTruth, ...]) -> str:
    lines = ["# True values of a virtual camera: its settings, and each plane.", "", "[camera]"]
    lines += _pairs(asdict(camera))
    for plane in truth:
        lines += ["", "[[planes]]", *_pairs(asdict(plane))]
    return "\n".join(lines) + "\n"


def _pairs(values: Mapping[str, Any]) -> list[str]:
    """Lines of TOML, which writes lists, strings and finite numbers as JSON does."""
    known = {name: value for name, value in values.items() if value is not None}
    return [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in known.items()]
