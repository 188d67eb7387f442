"""Sets of frames of one light, their statistics, and the photon transfer table of a plane."""

import math
import os
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from chromanoise.apps.camera.statistics import (
    LEAST_CLIPPED,
    SURE_Z,
    LightSample,
    PlaneSample,
    scaled_sample,
)
from chromanoise.base import Array, InputError, Integer
from chromanoise.io.frames import FrameLevel, FrameSet, RawFrame, refuse_few, refuse_mixed
from chromanoise.sensor import SAME_TIME, PhotonTransfer

_MOST_BYTES = 400_000_000  # of frames that threads keep in memory
_FEWEST_STEPS = 8  # codes between the lowest and highest, from which a step is concluded
_MOST_APART = 0.2  # of the mean, by which flats of one level may differ

Sampler = Callable[[Sequence[RawFrame], tuple[int, int]], LightSample]
"""A function that computes the statistics of frames, or returns those of an earlier run."""

Result = TypeVar("Result")
Key = tuple[str, ...]
"""Names of the frames of one light."""


def key_of(frames: Sequence[RawFrame]) -> Key:
    """The names of the frames with their folders, by which their statistics are found."""
    return tuple(f"{frame.path}[{frame.part}][{frame.index}]" for frame in frames)


def refuse_unusable(frames: FrameSet) -> None:
    """Refuse sets without flats or with frames of two sizes, and levels with one flat or dark.

    Raises
    ------
    InputError
        If there is one.
    """
    if not any(level.flats and not level.spatial for level in frames.levels):
        raise InputError(frames.source, "must have frames with light", found="has dark frames only")
    refuse_mixed(frames.source, [f for one in frames.levels for f in one.frames])
    refuse_few(frames.source, frames.levels, ("flats", "darks"))


def lights_of(
    frames: FrameSet,
    tile: tuple[int, int],
    sampled: Sampler,
    progress: Callable[[int, int], None],
) -> dict[Key, LightSample]:
    """The statistics of each set of frames, read once."""
    groups: dict[Key, tuple[RawFrame, ...]] = {}
    for level in frames.levels:
        for group in (level.flats, level.darks):
            if len(group) > 1:
                groups.setdefault(key_of(group), group)
    whole, done, lights = sum(map(len, groups.values())), 0, {}
    progress(done, whole)
    with closing(in_threads(lambda group: sampled(group, tile), [*groups.values()])) as samples:
        for (key, group), light in zip(groups.items(), samples, strict=True):
            _refuse_apart(group, light)
            lights[key] = light
            done += len(group)
            progress(done, whole)
    _refuse_bright_darks(frames, lights)
    return lights


def in_threads(
    function: Callable[[tuple[RawFrame, ...]], Result], groups: Sequence[tuple[RawFrame, ...]]
) -> Generator[Result]:
    """The results of a function of the frames of each group, in turn, computed on all cores."""
    bytes_each = 8 * math.prod(groups[0][0].shape)
    workers = max(1, min(os.cpu_count() or 1, _MOST_BYTES // bytes_each))
    pool = ThreadPoolExecutor(workers)
    try:
        yield from pool.map(function, groups)
    finally:
        pool.shutdown(cancel_futures=True)


def _refuse_bright_darks(frames: FrameSet, lights: Mapping[Key, LightSample]) -> None:
    """Refuse darks that are brighter than the flats of their level: they are exchanged."""
    for level in frames.levels:
        flats, darks = (lights.get(key_of(group)) for group in (level.flats, level.darks))
        if flats is None or darks is None:
            continue
        for flat, dark in zip(flats.planes, darks.planes, strict=True):
            noise = math.sqrt(flat.mean_variance_dn2 + dark.mean_variance_dn2)
            if dark.mean_dn - flat.mean_dn > 10 * noise + 1:
                raise InputError(
                    level.darks[0].name,
                    f"must be darker than the flat {level.flats[0].name}",
                    value=dark.mean_dn,
                    found=f"has a mean of {dark.mean_dn:.6g} DN, the flat {flat.mean_dn:.6g} DN",
                    remedy="say in capture.toml which frames are flats and which are darks",
                )


def code_step(lights: Mapping[Key, LightSample]) -> tuple[int, int]:
    """Step and offset of codes that are offset + multiples of the step; else 1 and 0. [DN]

    Parameters
    ----------
    lights
        Statistics of all frames.
    """
    planes = [plane for light in lights.values() for plane in light.planes]
    lowest = min(plane.bottom_dn for plane in planes)
    step = math.gcd(*(one.step_dn for one in planes), *(one.bottom_dn - lowest for one in planes))
    if step < 2 or max(one.top_dn - one.bottom_dn for one in planes) < _FEWEST_STEPS * step:
        return 1, 0
    return step, lowest % step


def in_true_codes(
    frames: FrameSet, lights: Mapping[Key, LightSample]
) -> tuple[FrameSet, dict[Key, LightSample]]:
    """Frames and statistics in the codes of the converter, if stored codes are multiples of a step.

    If codes of 12 bits are stored in the upper bits of 16, the step is 16.

    Parameters
    ----------
    frames, lights
        All frames, and their statistics as stored.

    Raises
    ------
    InputError
        If a frame has a code above the largest one of its bits.
    """
    step, offset = code_step(lights)
    bits = _true_bits(frames, lights, step)
    if step == 1:
        return frames, dict(lights)

    def shifted(group: tuple[RawFrame, ...]) -> tuple[RawFrame, ...]:
        return tuple(
            replace(
                one,
                read=_Shifted(frame=one, step_dn=step, offset_dn=offset),
                bits=bits,
                black_level_dn=None
                if one.black_level_dn is None
                else (one.black_level_dn - offset) / step,
            )
            for one in group
        )

    levels = tuple(
        replace(one, flats=shifted(one.flats), darks=shifted(one.darks)) for one in frames.levels
    )
    start = f"{offset} + " if offset else ""
    note = f"all codes are {start}multiples of {step} and are divided by it: 1 DN is one such step"
    note += "" if bits is None else f", codes of {bits} bits"
    return (
        replace(frames, levels=levels, notes=(*frames.notes, note)),
        {key: light.in_steps(step, offset) for key, light in lights.items()},
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Shifted:
    """Reads the codes of a frame as (code - offset) / step."""

    frame: RawFrame
    step_dn: int
    offset_dn: int

    def __call__(self) -> Integer[Array, "h w"]:
        codes = self.frame.codes()
        return (codes - codes.dtype.type(self.offset_dn)) // codes.dtype.type(self.step_dn)


def _true_bits(frames: FrameSet, lights: Mapping[Key, LightSample], step_dn: int) -> int | None:
    """Bits of the converter; ``None`` if no frame states its bits.

    The stated bits are those of the stored codes, unless the stored codes are too large for them.
    """
    groups = {
        key_of(group): group
        for level in frames.levels
        for group in (level.flats, level.darks)
        if group
    }
    bits = next((group[0].bits for group in groups.values() if group[0].bits), None)
    if bits is None:
        return None
    tops = {key: max(plane.top_dn for plane in lights[key].planes) for key in groups}
    largest = 2**bits - 1
    stored = max(tops.values()) <= largest
    for key, top in tops.items():
        if not stored and top // step_dn > largest:
            raise InputError(
                groups[key][0].name,
                f"must have codes of at most {largest} for {bits} bits",
                value=top,
                found=f"has a code of {top}",
                remedy="correct bits in capture.toml",
            )
    return (largest // step_dn).bit_length() if stored else bits


def unclipped(frames: FrameSet, lights: Mapping[Key, LightSample]) -> FrameSet:
    """The frames without flats that are clipped at code 0, and without any darks if one is clipped.

    The variance of a clipped dark is too small, and its mean is too large.

    Parameters
    ----------
    frames, lights
        All frames, and their statistics.

    Raises
    ------
    InputError
        If all flats are clipped.
    """
    dark = any(clipped_share(lights[key_of(one.darks)]) for one in frames.levels if one.darks)
    kept = [
        replace(one, darks=()) if dark else one
        for one in frames.levels
        if not (one.flats and clipped_share(lights[key_of(one.flats)]))
    ]
    levels = tuple(one for one in kept if one.flats or one.darks)
    if not any(one.flats and not one.spatial for one in levels):
        raise InputError(
            frames.source,
            "must have frames with light that are not clipped at code 0",
            found="has none",
            remedy="take frames with more light, or frames whose black level is not subtracted",
        )
    return replace(frames, levels=levels)


def clipped_share(light: LightSample) -> float:
    """Largest share of the pixels of a plane that are clipped at code 0; 0 if it is small. [1]

    Parameters
    ----------
    light
        Statistics of frames of one light.
    """
    shares = [
        plane.bottom_share
        for plane in light.planes
        if plane.bottom_dn == 0 and plane.variance_dn2 > 0
    ]
    return max((share for share in shares if share > LEAST_CLIPPED), default=0.0)


def _refuse_apart(group: Sequence[RawFrame], light: LightSample) -> None:
    for plane in light.planes:
        means = plane.frame_means_dn
        low, high = int(np.argmin(means)), int(np.argmax(means))
        noise = 10 * math.sqrt(plane.mean_variance_dn2 * len(means))
        if means[high] - means[low] > max(_MOST_APART * abs(means[high]), noise):
            raise InputError(
                group[high].name,
                f"must have the same light as {group[low].name}, with which it is grouped",
                value=means[high],
                found=f"has a mean of {means[high]:.6g} DN, and the other has {means[low]:.6g} DN",
                remedy="state in capture.toml which frames belong together",
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class LightChange:
    """A statistically significant change of the light between the flats of one level.

    Attributes
    ----------
    share
        Largest minus smallest mean signal above dark, divided by the largest. [1]
    low, high
        The frames with the smallest and the largest mean.
    above_black
        Whether the mean code without light is known; otherwise ``share`` is computed from the mean
        codes.
    """

    share: float
    low: RawFrame
    high: RawFrame
    above_black: bool


def light_changes(frames: FrameSet, lights: Mapping[Key, LightSample]) -> dict[Key, LightChange]:
    """The levels between whose flats the light changed significantly, by the names of the flats.

    Parameters
    ----------
    frames, lights
        All frames, and their statistics.

    Notes
    -----
    The mean of a frame also varies with the offset, the row noise and the column noise of the
    camera. This variance is measured on the darks, because in flats a change of the light adds
    shading to row and column noise. A change counts if it and the signal above dark exceed 5 times
    their standard errors.
    """
    base_of, owns = bases(frames, lights), _of_planes(lights)
    offsets = [_offset_variance(frames, own) for own in owns]
    found = {}
    for level in frames.levels:
        if not level.flats:
            continue
        samples = lights[key_of(level.flats)].planes
        i = max(range(len(samples)), key=lambda plane: samples[plane].mean_dn)
        means, base = samples[i].frame_means_dn, base_of(level)
        error = math.sqrt(2 * (samples[i].rest_dn2 / samples[i].pixels + offsets[i]))
        low, high = int(np.argmin(means)), int(np.argmax(means))
        black = 0.0 if base is None else base[i][0]
        if min(means[high] - means[low], samples[i].mean_dn - black) > SURE_Z * error:
            found[key_of(level.flats)] = LightChange(
                share=(means[high] - means[low]) / (means[high] - black),
                low=level.flats[low],
                high=level.flats[high],
                above_black=base is not None,
            )
    return found


def _of_planes(lights: Mapping[Key, LightSample]) -> list[dict[Key, PlaneSample]]:
    """The statistics of each plane."""
    count = len(next(iter(lights.values())).planes)
    return [{key: light.planes[i] for key, light in lights.items()} for i in range(count)]


def _offset_variance(frames: FrameSet, own: Mapping[Key, PlaneSample]) -> float:
    """Variance of the mean of a frame without light; without darks, of the darkest flat. [DN^2]"""
    darks = dark_samples(frames, own)
    if not darks:
        darkest = min(own.values(), key=lambda one: one.mean_dn)
        return len(darkest.frame_means_dn) * darkest.mean_variance_dn2
    counts = np.array([len(one.frame_means_dn) for one in darks])
    found = np.array([np.var(one.frame_means_dn, ddof=1) for one in darks])
    chance = counts * np.array([one.mean_variance_dn2 for one in darks])
    return max(*(float((counts - 1) @ one) / int((counts - 1).sum()) for one in (found, chance)))


Bases = Callable[[FrameLevel], list[tuple[float, float]] | None]
"""Mean and variance of each plane of a level without light, if known. [DN], [DN^2]"""


def bases(frames: FrameSet, lights: Mapping[Key, LightSample]) -> Bases:
    """Mean and variance of each plane without light, of any level; ``None`` if not known.

    Without darks, the mean is the black level that the frames state, and the variance 0.

    Parameters
    ----------
    frames, lights
        All frames, and their statistics.
    """
    if not darks_of(frames):
        black = frames.black_level_dn
        known = None if black is None else [(black, 0.0)] * len(_of_planes(lights))
        return lambda _level: known
    each = [dark_of_levels(frames, own) for own in _of_planes(lights)]
    return lambda level: [dark_of(level) for dark_of in each]


def at_one_light(
    frames: FrameSet, lights: Mapping[Key, LightSample], tile: tuple[int, int]
) -> dict[Key, LightSample]:
    """The statistics, after scaling to one light of the flats between which the light changed.

    Parameters
    ----------
    frames, lights
        All frames, and their statistics.
    tile
        Rows and columns of the period of the mosaic.
    """
    found, base_of = dict(lights), bases(frames, lights)
    changed = light_changes(frames, lights)
    for level in frames.levels:
        key, base = key_of(level.flats), base_of(level)
        if key not in changed or base is None:
            continue
        lowest = [min(plane.frame_means_dn) for plane in lights[key].planes]
        if all(mean > black for mean, (black, _) in zip(lowest, base, strict=True)):
            found[key] = scaled_sample(level.flats, tile, lights[key], base)
    return found


def lit_levels(frames: FrameSet, lights: Mapping[Key, LightSample]) -> list[FrameLevel]:
    """The levels with flats, from dark to bright, all planes together."""

    def light(level: FrameLevel) -> float:
        return sum(plane.mean_dn for plane in lights[key_of(level.flats)].planes)

    levels = (level for level in frames.levels if level.flats and not level.spatial)
    return sorted(levels, key=light)


def darks_of(frames: FrameSet) -> dict[Key, FrameLevel]:
    """Each set of darks of the photon transfer once, with a level that has it.

    Those of spatial series are used only where there are no others.
    """
    levels = [level for level in frames.levels if level.darks]
    temporal = [level for level in levels if not level.spatial]
    found: dict[Key, FrameLevel] = {}
    for level in temporal or levels:
        found.setdefault(key_of(level.darks), level)
    return found


def _matched(lit: Sequence[FrameLevel], darks: Mapping[Key, FrameLevel]) -> bool:
    """Whether each lit level has a dark of its exposure time."""
    times = [level.time_ms for level in darks.values() if level.time_ms]
    return len(times) == len(darks) > 0 and all(
        level.time_ms is not None
        and any(abs(time - level.time_ms) <= SAME_TIME * level.time_ms for time in times)
        for level in lit
    )


def transfer_table(
    frames: FrameSet, lights: Mapping[Key, LightSample], plane: int, source: str
) -> PhotonTransfer:
    """Means and variances of one plane: the lit levels from dark to bright, then the darks."""
    lit, darks = lit_levels(frames, lights), darks_of(frames)
    samples = [lights[key_of(level.flats)].planes[plane] for level in lit]
    samples += [lights[key].planes[plane] for key in darks]
    dark = np.array([False] * len(lit) + [True] * len(darks))
    levels = [*lit, *darks.values()]
    matched = _matched(lit, darks)
    photons = [level.photons_per_pixel for level in lit]
    known = None not in photons
    return PhotonTransfer(
        mean_dn=np.array([one.mean_dn for one in samples]),
        variance_dn2=np.array([one.variance_dn2 for one in samples]),
        dark=dark,
        samples=np.array([one.samples for one in samples]),
        source=source,
        time_ms=np.array([level.time_ms for level in levels], float) if matched else None,
        mean_se_dn=np.sqrt([one.mean_variance_dn2 for one in samples]),
        photons=np.array([*photons, *(0.0 for _ in darks)], float) if known else None,
    )


def dark_samples(frames: FrameSet, own: Mapping[Key, PlaneSample]) -> list[PlaneSample]:
    """The statistics of each set of darks, once."""
    return [own[key] for key in darks_of(frames)]


DarkOf = Callable[[FrameLevel], tuple[float, float]]
"""Mean and variance of a level without light. [DN], [DN^2]"""


def dark_of_levels(frames: FrameSet, own: Mapping[Key, PlaneSample]) -> DarkOf:
    """Dark mean and variance of a level: its own darks, those of its time, or all. [DN], [DN^2]

    Without darks, those of the darkest level.
    """
    groups = darks_of(frames)
    darkest = min(own.values(), key=lambda one: one.mean_dn)

    def found(level: FrameLevel) -> tuple[float, float]:
        if not groups:
            return darkest.mean_dn, darkest.variance_dn2
        keys = [key_of(level.darks)] if level.darks else []
        if not keys and level.time_ms is not None:
            keys = [
                key
                for key, one in groups.items()
                if one.time_ms is not None
                and abs(one.time_ms - level.time_ms) <= SAME_TIME * level.time_ms
            ]
        samples = [own[key] for key in keys or groups]
        return (
            float(np.mean([one.mean_dn for one in samples])),
            float(np.mean([one.variance_dn2 for one in samples])),
        )

    return found
