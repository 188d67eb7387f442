"""Noise as training data: noisy pictures from clean linear raw ones, with their variance.

An item of a data set has its own noise, which depends on seed and item only: not on the number of
workers, the order of items, or the number of threads.
"""

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import lru_cache
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    Float32,
    InputError,
    Setting,
    check,
    dataclass,
    refuse_absent_package,
    renamed_keywords,
    stream,
)
from chromanoise.imaging import channel_tile, new_rows
from chromanoise.noise import Moments, coded_moments, held_moments, over_counts
from chromanoise.sensor import CameraNoise, tukey_lambda_variance

Unit = Literal["electron", "white", "dn"]
"""Unit of a clean picture: electrons; 0 at black and 1 at the top code; or codes."""

_SMOOTH_E = 0.75  # as in noise_draws: read noise that one word draws together with the electrons
_FEW_E = 20.0  # as in noise_draws: mean below which electrons are counted by themselves
_FEW_BY_READ_E = ((_SMOOTH_E, 1.0, 1.5, 2.0, 2.65), (_FEW_E, 17.0, 12.75, 10.0, 5.0))
_ITEM_BITS, _SEED_BITS, _PATTERN_BITS, _LANE_BITS = 48, 64, 32, 26
_MOST_ROWS = 1 << 24
_CHUNK_LANES = 1 << 17  # values per task of a thread
_KEPT_PATTERNS = 4
_SETTINGS = 5  # name of the random stream of an item's settings
_EMPTY = np.empty((0, 0), np.float32)
_NOISE_OF = {
    "dark": "dark_current_e_per_s",
    "prnu": "prnu",
    "dsnu": "dsnu_e",
    "row": "row_noise_e",
    "column": "column_noise_e",
    "telegraph": "rtn_share",
}
"""The value of a camera that is 0 if a part is switched off."""


class _Use(NamedTuple):
    """Which parts of the noise are drawn, for the kernels."""

    shot: bool
    read: bool
    row: bool
    quantize: bool
    clamp: bool
    together: bool
    tails: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class NoisySample:
    """A clean picture with noise, in the unit of the clean picture.

    Attributes
    ----------
    noisy
        The noisy picture, float32. Below black the values are negative.
    variance
        Variance of each value of ``noisy`` about its mean, before clipping, float32; the mean is
        the clean value plus the item's black offset. [unit^2]
    clean
        The clean picture, float32.
    unit
        Unit of the three.
    camera
        The settings of this item: gain, read noise, row noise, shape of the tails, black offset.

    Notes
    -----
    The variance is that over frames and over pixels: M + D + (PRNU M)^2 + s^2 + DSNU^2 + row^2 +
    column^2 + telegraph noise in e-^2, plus 1/12 DN^2 for rounding, of the parts that are switched
    on. The rounding term is exact where the other noise is 1.5 DN or more;
    `NoiseSampler.exact_moments` is always exact.
    """

    noisy: Float32[Array, "..."]
    variance: Float32[Array, "..."]
    clean: Float32[Array, "..."]
    unit: Unit
    camera: CameraNoise


@dataclass(frozen=True, kw_only=True)
class NoiseSampler:
    """Adds a camera's noise to clean linear raw pictures; made by `sampler`.

    Attributes
    ----------
    shot, read, dark, prnu, dsnu, row, column, telegraph, quantize, clamp
        Whether each part is used, as `sampler`.
    seed
        0 to 2^64 - 1.
    threads
        Number of threads; ``None`` for one per core. The result does not depend on it.
    """

    camera: CameraNoise
    shot: bool = True
    read: bool = True
    dark: bool = True
    prnu: bool = True
    dsnu: bool = True
    row: bool = True
    column: bool = True
    telegraph: bool = True
    quantize: bool = True
    clamp: bool = True
    seed: int = 0
    threads: int | None = None

    def __post_init__(self) -> None:
        check.whole_of_bits("seed", self.seed, _SEED_BITS)
        check.at_least_one("threads", self.threads)

    def __call__(
        self,
        clean: Float[Array, "h w *channels"],
        *,
        unit: Unit,
        item: int = 0,
        iso: float | None = None,
        time_s: float | None = None,
        pattern: int = 0,
        origin: tuple[int, int] = (0, 0),
    ) -> NoisySample:
        """A noisy picture and its variance.

        Parameters
        ----------
        clean
            Expected values: a raw mosaic (h, w), or all channels of the camera in each pixel
            (h, w, p). Not below black.
        unit
            ``electron``; ``white`` for 0 at the black level and 1 at the top code; ``dn`` for
            codes, black level included.
        item
            Number of the item, 0 to 2^48 - 1: each has its own noise.
        iso
            ISO setting; ``None`` for the camera's own, or for one drawn from its range of gains.
        time_s
            Exposure time, needed where the camera has dark current. [s]
        pattern
            Number of the sensor whose PRNU and DSNU are used, 0 to 2^32 - 1. The same number gives
            the same fixed pattern in every item.
        origin
            Row and column of the picture's first pixel on the sensor: of the mosaic and of the
            fixed pattern. [px]

        Returns
        -------
        NoisySample

        Raises
        ------
        InputError
            If a clean value is below black or not finite, if its shape is not as above, if the
            ISO or the time is missing, if a number is out of range, or if numba is not installed.

        Notes
        -----
        EMVA 1288, release 4.0, with the read noise of Wei, Fu, Yang & Huang, CVPR (2020); random
        words and quantile functions as `chromanoise.imaging.noisy_electrons`.

        Examples
        --------
        >>> camera = CameraNoise(names=("W",), gain_dn_per_e=np.array([1.0]), top_code_dn=4095,
        ...     read_noise_e=np.array([3.0]), black_level_dn=np.array([64.0]))
        >>> add_noise = sampler(camera, quantize=False, clamp=False)
        >>> sample = add_noise(np.full((100, 100), 91.0), unit="electron", item=7)
        >>> float(sample.variance[0, 0]), bool(abs(sample.noisy.var() - 100) < 10)
        (100.0, True)
        """
        refuse_absent_package("numba", "training noise", extra="compiled")
        from chromanoise.apps.training.training_kernels import add_noise

        settings = self._settings(item, iso)
        camera, dark_e = self._used(settings, time_s)
        given = _picture(clean, camera)
        row, column = _checked_origin(origin)
        lanes = self._lanes(camera, unit, given.shape, (row, column), dark_e)
        flat = np.ascontiguousarray(given, dtype=np.float32).reshape(given.shape[0], -1)
        noisy, variance = new_rows(flat.shape, np.float32), new_rows(flat.shape, np.float32)
        use, noise = self._use(camera), self._noise(camera, dark_e)
        place = _Place(self.seed, row, column * _depth(given), flat.shape)
        maps = _maps(camera, place, pattern, item)
        key, number = np.uint64(self.seed), np.uint64(item)

        def fill(rows: tuple[int, int]) -> int:
            pictures = (flat, noisy, variance)
            return int(add_noise(*pictures, *rows, lanes, maps, use, noise, row, number, key))

        if self._in_rows(fill, flat.shape):
            _refuse_clean(given, lanes, unit, row)
        shape = given.shape
        return NoisySample(
            noisy=noisy.reshape(shape),
            variance=variance.reshape(shape),
            clean=flat.reshape(shape),
            unit=unit,
            camera=settings,
        )

    def exact_moments(
        self,
        clean: Float[Array, "h w *channels"],
        *,
        unit: Unit,
        item: int = 0,
        iso: float | None = None,
        time_s: float | None = None,
        origin: tuple[int, int] = (0, 0),
    ) -> Moments:
        """Exact mean and variance of the noisy values, rounded and clipped. [unit], [unit^2]

        Parameters
        ----------
        clean, unit, item, iso, time_s, origin
            As the call.

        Returns
        -------
        Moments
            Over frames and over pixels; ``bias`` is the mean minus the clean value, and the shares
            are those clipped to code 0 and to the largest code.

        Raises
        ------
        InputError
            As the call, or if the read noise has a Tukey lambda distribution or shot noise is
            switched off.

        Notes
        -----
        A sum over counts of the moments of the censored, rounded normal distribution, of which
        PRNU, DSNU and row noise are part; see `chromanoise.noise.read_moments`. It takes far longer
        than a sample: about a microsecond for each likely count of each different value.
        EMVA 1288, release 4.0.
        """
        camera, dark_e = self._used(self._settings(item, iso), time_s)
        use = self._use(camera)
        if use.tails or not use.shot:
            raise InputError(
                "exact_moments",
                "needs shot noise and normal read noise",
                found="the read noise has tails" if use.tails else "shot noise is switched off",
                remedy=Setting("shot", (True,)) if not use.tails else "use NoisySample.variance",
            )
        given = _picture(clean, camera)
        place = _checked_origin(origin)
        lanes = self._lanes(camera, unit, given.shape, place, dark_e).astype(np.float64)
        flat = np.asarray(given, dtype=np.float64).reshape(given.shape[0], -1)
        rows = (np.arange(flat.shape[0]) + place[0]) % lanes.shape[1]
        zero, per_unit, gain, read, dark_code, black, top = lanes[:7, rows]
        light = check.non_negative("clean", "e-", (flat - zero) * per_unit)
        noise = self._noise(camera, dark_e).astype(np.float64)
        added = (noise[1] * light) ** 2 + noise[2] ** 2 + camera.dsnu_e**2
        share, level_e = _levels(camera)
        added = added + _item_e2(camera) - share * level_e**2
        spread = np.sqrt(added + (read**2 if use.read else 0.0))
        levels = ((1 - share, 0.0), (share / 2, level_e), (share / 2, -level_e))
        each = []
        for weight, shift_e in levels if share else levels[:1]:
            at = dark_code + shift_e * gain
            cases = np.stack([light, gain, spread, at, black, top]).reshape(6, -1)
            different, back = np.unique(cases, axis=1, return_inverse=True)
            found = np.array([_read_out(*one, dark_e=dark_e, use=use) for one in different.T]).T
            each.append((weight, found[:, np.ravel(back)].reshape(4, *flat.shape)))
        mean, _, low, high = np.sum([weight * one for weight, one in each], axis=0)
        variance = np.sum([w * (one[1] + (one[0] - mean) ** 2) for w, one in each], axis=0)
        mean = mean / per_unit + zero
        shape = given.shape
        return Moments(
            mean=mean.reshape(shape),
            variance=(variance / per_unit**2).reshape(shape),
            bias=(mean - flat).reshape(shape),
            black_share=low.reshape(shape),
            full_share=high.reshape(shape),
        )

    def _settings(self, item: int, iso: float | None) -> CameraNoise:
        """The camera for an item."""
        check.whole_of_bits("item", item, _ITEM_BITS)
        return self.camera.draw_settings(stream(self.seed, _SETTINGS, item), iso=iso)

    def _used(self, settings: CameraNoise, time_s: float | None) -> tuple[CameraNoise, float]:
        """The camera without the parts that are switched off, and the mean of dark electrons."""
        parts = _NOISE_OF.items()
        off: dict[str, Any] = {value: 0.0 for part, value in parts if not getattr(self, part)}
        camera = replace(settings, **off) if off else settings
        if camera.dark_current_e_per_s == 0:
            return camera, 0.0
        if time_s is None:
            raise InputError(
                "time_s",
                "must be given for a camera with dark current [s]",
                found="is missing",
                remedy=(Setting("time_s"), Setting("dark", (False,))),
            )
        dark_e = check.within("time_s", "s", time_s, 0.0, 1e9) * camera.dark_current_e_per_s
        return camera, check.within("dark electrons", "e-", dark_e, 0.0, 1e9)

    def _use(self, camera: CameraNoise) -> _Use:
        read = self.read and bool(camera.read_noise_e.any())
        tails = read and bool(camera.tail_lambda)
        return _Use(
            shot=self.shot,
            read=read,
            row=camera.row_noise_e > 0,
            quantize=self.quantize,
            clamp=self.clamp,
            together=read and not tails and float(camera.read_noise_e.min()) >= _SMOOTH_E,
            tails=tails,
        )

    def _noise(self, camera: CameraNoise, dark_e: float) -> Float32[Array, "5"]:
        shape = camera.tail_lambda[0] if camera.tail_lambda else 0.0
        least = float(camera.read_noise_e.min())
        few_e = counted_below_e(least) if self._use(camera).together else _FEW_E
        return np.array([dark_e, camera.prnu, camera.row_noise_e, shape, few_e], np.float32)

    def _lanes(
        self,
        camera: CameraNoise,
        unit: Unit,
        shape: tuple[int, ...],
        origin: tuple[int, int],
        dark_e: float,
    ) -> Float32[Array, "10 tile lanes"]:
        """The constants of each lane of each row of the mosaic, see `add_noise`."""
        check.one_of("unit", unit, get_args(Unit))
        channel = _channels(camera, shape, origin[1])
        gain, black = camera.gain_dn_per_e, camera.black_level_dn
        top = np.full_like(gain, camera.top_code_dn)
        if camera.full_well_e is not None:
            top = np.minimum(top, np.round(black + gain * (camera.full_well_e - dark_e)))
        if (top <= black).any():
            raise InputError(
                "time_s",
                "must leave room for light above the dark electrons [s]",
                value=dark_e,
                found=f"gives {dark_e:g} dark electrons, which fill the full well",
                remedy="use a shorter time",
            )
        use = self._use(camera)
        read = camera.read_noise_e if use.read else np.zeros_like(gain)
        offset = np.zeros_like(gain) if camera.black_offsets_dn is None else camera.black_offsets_dn
        zero = black if unit == "dn" else np.zeros_like(gain)
        units = {"electron": np.ones_like(gain), "dn": 1 / gain}
        per_unit = units.get(unit, (camera.top_code_dn - black) / gain)
        fixed = read**2 + dark_e + camera.dsnu_e**2 + camera.row_noise_e**2 + _item_e2(camera)
        fixed = fixed + (1 / 12 / gain**2 if use.quantize else 0.0)
        scale = math.sqrt(tukey_lambda_variance(camera.tail_lambda[0])) if use.tails else 1.0
        dark_code = black + np.ravel(offset)
        codes = [dark_code, black, top, fixed, 1 / (gain * per_unit), 1 / per_unit**2]
        rows = np.stack([zero, per_unit, gain, read / scale, *codes])
        return np.ascontiguousarray(rows[:, channel], dtype=np.float32)

    def _in_rows(self, fill: Any, shape: tuple[int, int]) -> int:
        """The sum of ``fill`` over chunks of rows, on the threads."""
        height, width = shape
        chunk = max(1, _CHUNK_LANES // max(width, 1))
        parts = [(start, min(start + chunk, height)) for start in range(0, height, chunk)]
        workers = min(self.threads or os.cpu_count() or 1, len(parts))
        if workers < 2:
            return fill((0, height)) if height else 0
        with ThreadPoolExecutor(workers) as pool:
            return sum(pool.map(fill, parts))


class _Place(NamedTuple):
    """Rows and lanes of a sensor, from the first ones on, and the seed of what is drawn there."""

    seed: int
    row: int
    lane: int
    shape: tuple[int, int]


def _pattern(
    place: _Place, number: int, purpose: int, spread: float, least: float = -math.inf
) -> Float32[Array, "h w"]:
    """Offsets of the lanes, or their sensitivity, by the number of a sensor or an item."""
    from chromanoise.apps.training.training_kernels import draw_pattern

    values = np.empty(place.shape, np.float32)
    at = np.int64(purpose), np.int64(place.row), np.int64(place.lane)
    key = np.uint64(place.seed)
    draw_pattern(np.float32(spread), np.float32(least), *at, np.uint64(number), key, values)
    return values


_fixed_pattern = lru_cache(_KEPT_PATTERNS)(_pattern)


def _maps(
    camera: CameraNoise, place: _Place, pattern: int, item: int
) -> tuple[Float32[Array, "gh gw"], Float32[Array, "oh ow"], Float32[Array, "ih iw"]]:
    """Sensitivity and dark offset of each lane, and the offsets of an item; empty if not used."""
    from chromanoise.imaging import PIXEL_GAIN, PIXEL_OFFSET

    check.whole_of_bits("pattern", pattern, _PATTERN_BITS)
    prnu, dsnu_e = camera.prnu, camera.dsnu_e
    return (
        _fixed_pattern(place, pattern, PIXEL_GAIN, prnu, 0.0) if prnu else _EMPTY,
        _fixed_pattern(place, pattern, PIXEL_OFFSET, dsnu_e) if dsnu_e else _EMPTY,
        _item_map(camera, place, pattern, item),
    )


def _item_map(
    camera: CameraNoise, place: _Place, pattern: int, item: int
) -> Float32[Array, "ih iw"]:
    """Column offsets and levels of telegraph noise of an item."""
    from chromanoise.apps.training.training_kernels import draw_levels
    from chromanoise.imaging import COLUMN

    found = _EMPTY
    if camera.column_noise_e:
        line = place._replace(row=0, lane=0, shape=(1, place.shape[1]))
        found = _pattern(line, item, COLUMN, camera.column_noise_e)
    share, level_e = _levels(camera)
    if share:
        offsets = np.zeros(place.shape, np.float32)
        at = np.int64(place.row), np.int64(place.lane), np.uint64(pattern), np.uint64(item)
        draw_levels(np.float32(share), np.float32(level_e), *at, np.uint64(place.seed), offsets)
        found = offsets + found if found.size else offsets
    return found


def _levels(camera: CameraNoise) -> tuple[float, float]:
    """Share of the pixels with two levels [1], and half the difference of the two. [e-]"""
    return camera.rtn_share, camera.rtn_amplitude_e / 2


def _item_e2(camera: CameraNoise) -> float:
    """Variance of the offsets of one item that are not those of its rows. [e-^2]"""
    share, level_e = _levels(camera)
    return camera.column_noise_e**2 + share * level_e**2


@renamed_keywords(levels="telegraph")
def sampler(
    camera: CameraNoise,
    *,
    shot: bool = True,
    read: bool = True,
    dark: bool = True,
    prnu: bool = True,
    dsnu: bool = True,
    row: bool = True,
    column: bool = True,
    telegraph: bool = True,
    quantize: bool = True,
    clamp: bool = True,
    seed: int = 0,
    threads: int | None = None,
) -> NoiseSampler:
    """A function that adds a camera's noise to clean linear raw pictures.

    Parameters
    ----------
    camera
        The noise model, e.g. of `CameraNoise.from_sensor` or `CameraNoise.from_eld`.
    shot, read
        Whether there is shot noise of the light, and read noise.
    dark
        Whether dark electrons are counted; their mean is subtracted.
    prnu, dsnu
        Whether sensitivity and dark signal differ from pixel to pixel.
    row, column, telegraph
        Whether there is row noise, column noise, and random telegraph noise.
    quantize
        Whether the codes are rounded to whole numbers.
    clamp
        Whether the codes are clipped to 0 and to the top code, or the full well if it is lower.
    seed
        0 to 2^64 - 1.
    threads
        Number of threads; one per core by default. The result does not depend on it.

    Returns
    -------
    NoiseSampler

    Raises
    ------
    InputError
        If seed or threads are out of range.

    Notes
    -----
    The camera model of EMVA 1288, release 4.0; tails and row noise as Wei, Fu, Yang & Huang, CVPR
    (2020).

    Examples
    --------
    >>> camera = CameraNoise(names=("W",), gain_dn_per_e=np.array([0.5]), top_code_dn=1023,
    ...     read_noise_e=np.array([2.0]), black_level_dn=np.array([64.0]))
    >>> add_noise = sampler(camera, shot=False, read=False)
    >>> add_noise(np.full((1, 1), 5.0), unit="electron").noisy        # 2.5 DN is rounded to 3 DN
    array([[6.]], dtype=float32)
    """
    if not isinstance(camera, CameraNoise):
        raise InputError(
            "camera",
            "must be a CameraNoise",
            value=type(camera).__name__,
            found=f"is a {type(camera).__name__}",
            remedy="make one by CameraNoise.from_sensor, or by "
            "chromanoise.apps.camera.camera_noise",
        )
    return NoiseSampler(
        camera=camera,
        shot=shot,
        read=read,
        dark=dark,
        prnu=prnu,
        dsnu=dsnu,
        row=row,
        column=column,
        telegraph=telegraph,
        quantize=quantize,
        clamp=clamp,
        seed=seed,
        threads=threads,
    )


def counted_below_e(read_noise_e: float) -> float:
    """Mean below which electrons are drawn without read noise, which is then added. [e-]

    From this mean on one word draws the sum of electrons and read noise by an expansion
    (`read_quantile_of_many`), whose chances err by at most 5e-6, compared with the exact sums.

    Parameters
    ----------
    read_noise_e
        Standard deviation, at least 0.75. [e-]

    Examples
    --------
    >>> counted_below_e(0.75), counted_below_e(2.0), counted_below_e(3.0)
    (20.0, 10.0, 0.0)
    """
    return float(np.interp(read_noise_e, *_FEW_BY_READ_E, right=0.0))


def _read_out(
    light: float,
    gain: float,
    spread: float,
    dark_code: float,
    black: float,
    top: float,
    *,
    dark_e: float,
    use: _Use,
) -> Array:
    """Mean, variance and clipped shares of one value in electrons above black."""
    shift = dark_code / gain - dark_e  # electrons of code 0 are -shift
    low, high = (0.0, top / gain) if use.clamp else (-math.inf, math.inf)

    def given_count(count: Array) -> Array:
        bounds = {"black_e": low, "full_well_e": high}
        if use.quantize:
            return coded_moments(count + shift, read_noise_e=spread, step_e=1 / gain, **bounds)
        return held_moments(count + shift, read_noise_e=spread, **bounds)

    mean, variance, black_share, full_share = over_counts(np.array([light + dark_e]), given_count)
    shares = np.clip([black_share[0], full_share[0]], 0.0, 1.0)
    return np.array([mean[0] - black / gain, variance[0], *shares])


def _picture(clean: Array, camera: CameraNoise) -> Array:
    given = np.asarray(clean)
    if given.dtype.kind not in "fui":
        raise InputError("clean", "must hold numbers", value=str(given.dtype))
    planes = len(camera.names)
    if camera.mosaic is None and planes > 1:
        allowed, shapes = given.ndim == 3 and given.shape[2] == planes, f"(h, w, {planes})"
    else:
        allowed = given.ndim == 2 or (given.ndim == 3 and given.shape[2] == planes)
        shapes = f"(h, w) or (h, w, {planes})"
    names = ", ".join(camera.names)
    whole = allowed and min(given.shape) > 0
    check.shape(
        "clean", given, whole, f"must have the shape {shapes} of a camera with channels {names}"
    )
    fits = given.shape[0] < _MOST_ROWS and not given[:1].size >> _LANE_BITS
    most = f"must have fewer than 2^24 rows and 2^{_LANE_BITS} values in a row"
    check.shape("clean", given, fits, most)
    return given


def _depth(picture: Array) -> int:
    return picture.shape[2] if picture.ndim == 3 else 1


def _channels(camera: CameraNoise, shape: tuple[int, ...], first_column: int) -> Array:
    """Index of the channel of each lane, for each row of the mosaic."""
    if len(shape) == 3:
        return np.tile(np.arange(shape[2]), shape[1])[None, :]
    if camera.mosaic is None:
        return np.zeros((1, shape[1]), dtype=np.int64)
    tile = channel_tile(camera.mosaic, camera.names)
    return tile[:, (np.arange(shape[1]) + first_column) % tile.shape[1]]


def _checked_origin(origin: tuple[int, int]) -> tuple[int, int]:
    row, column = origin
    check.whole_of_bits("origin", row, 23)
    check.whole_of_bits("origin", column, 23)
    return int(row), int(column)


def _refuse_clean(given: Array, lanes: Array, unit: Unit, first_row: int) -> None:
    """Raise the error about clean values that are below black or not finite."""
    rows = (np.arange(given.shape[0]) + first_row) % lanes.shape[1]
    black = lanes[0, rows].reshape(given.shape)
    bad = ~(np.isfinite(given) & (given >= black) & (given < 1e30))
    first = tuple(int(i) for i in np.argwhere(bad)[0]) if bad.any() else (0,) * given.ndim
    name = {"electron": "e-", "white": "1", "dn": "DN"}[unit]
    least = float(np.broadcast_to(black, given.shape)[first])
    raise InputError(
        "clean",
        f"must be finite and not below the black level, {least:g} {name}".removesuffix(" 1"),
        value=float(given[first]),
        found=f"is not at {int(bad.sum())} of {given.size} values; the first is "
        f"{float(given[first]):g} at index {first} (from 0)",
        remedy="clip the clean picture to black",
    )
