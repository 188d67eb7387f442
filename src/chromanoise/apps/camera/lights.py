"""Sets of frames of one light, their statistics, and the photon transfer table of a plane."""

import math
import os
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from functools import cached_property, partial
from typing import TypeVar

import numpy as np

from chromanoise.apps.camera.statistics import (
    LEAST_CLIPPED,
    SURE_Z,
    LightSample,
    PlaneSample,
    scaled_sample,
)
from chromanoise.base import Array, InputError, Integer, dataclass, keep_freed_memory
from chromanoise.io.frames import FrameLevel, FrameSet, RawFrame, refuse_few, refuse_mixed
from chromanoise.sensor import LEAST_DARK_DN2, SAME_TIME, PhotonTransfer

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


def groups_of(levels: Iterable[FrameLevel]) -> list[tuple[RawFrame, ...]]:
    """The flats and the darks of each level, where it has them."""
    return [group for level in levels for group in (level.flats, level.darks) if group]


@dataclass(frozen=True, kw_only=True, eq=False)
class Lights:
    """A set of frames with the statistics of each light.

    Attributes
    ----------
    frames
        The levels of light, and how they were grouped.
    samples
        Statistics by the names of the frames of a light (`key_of`).
    """

    frames: FrameSet
    samples: Mapping[Key, LightSample]

    def of(self, group: Sequence[RawFrame]) -> LightSample:
        """The statistics of flats or darks."""
        return self.samples[key_of(group)]

    @cached_property
    def tile(self) -> tuple[int, int]:
        """Rows and columns of the period of the mosaic. [px]"""
        return (1, 1) if self.frames.mosaic is None else self.frames.mosaic.shape

    @cached_property
    def flats(self) -> list[FrameLevel]:
        """The levels with flats."""
        return [level for level in self.frames.levels if level.flats]

    @cached_property
    def lit(self) -> list[FrameLevel]:
        """The levels of the photon transfer, from dark to bright, all planes together."""
        levels = (level for level in self.flats if not level.spatial)
        return sorted(levels, key=lambda one: sum(p.mean_dn for p in self.of(one.flats).planes))

    @cached_property
    def darks(self) -> dict[Key, FrameLevel]:
        """Each set of darks of the photon transfer once, with a level that has it.

        Those of spatial series are used only where there are no others.
        """
        levels = [level for level in self.frames.levels if level.darks]
        temporal = [level for level in levels if not level.spatial]
        found: dict[Key, FrameLevel] = {}
        for level in temporal or levels:
            found.setdefault(key_of(level.darks), level)
        return found

    @cached_property
    def spatial(self) -> set[Key]:
        """The flats and darks of spatial series."""
        return {
            key_of(group) for group in groups_of(one for one in self.frames.levels if one.spatial)
        }

    @cached_property
    def planes(self) -> "list[PlaneLights]":
        """The same of each plane of the mosaic."""
        count = len(next(iter(self.samples.values())).planes)
        return [PlaneLights(lights=self, number=i) for i in range(count)]


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaneLights:
    """One plane of all frames.

    Attributes
    ----------
    number
        Of the plane, from 0.
    """

    lights: Lights
    number: int

    def of(self, group: Sequence[RawFrame]) -> PlaneSample:
        """The statistics of flats or darks."""
        return self.lights.of(group).planes[self.number]

    @cached_property
    def every(self) -> list[PlaneSample]:
        """The statistics of all lights."""
        return [light.planes[self.number] for light in self.lights.samples.values()]

    @cached_property
    def darks(self) -> list[PlaneSample]:
        """The statistics of each set of darks, once."""
        return [self.of(level.darks) for level in self.lights.darks.values()]

    @cached_property
    def hidden(self) -> bool:
        """Whether the dark noise is so low that rounding hides small effects in the dark.

        EMVA 1288, release 4.0: a dark variance below 0.24 DN^2 is mostly quantization.
        """
        variances = [one.variance_dn2 for one in self.darks]
        return min(variances, default=math.inf) < LEAST_DARK_DN2

    def dark_of(self, level: FrameLevel) -> tuple[float, float]:
        """Dark mean and variance of a level: its own darks, those of its time, or all.

        Without darks, those of the darkest level. [DN], [DN^2]
        """
        groups = self.lights.darks.values()
        if not groups:
            darkest = min(self.every, key=lambda one: one.mean_dn)
            return darkest.mean_dn, darkest.variance_dn2
        used = [level] if level.darks else [one for one in groups if _same_time(one, level)]
        samples = [self.of(one.darks) for one in used or groups]
        mean = np.mean([one.mean_dn for one in samples])
        return float(mean), float(np.mean([one.variance_dn2 for one in samples]))


def _same_time(dark: FrameLevel, level: FrameLevel) -> bool:
    """Whether a dark has the exposure time of a level."""
    if dark.time_ms is None or level.time_ms is None:
        return False
    return abs(dark.time_ms - level.time_ms) <= SAME_TIME * level.time_ms


def lights_of(frames: FrameSet, sampled: Sampler, progress: Callable[[int, int], None]) -> Lights:
    """The statistics of each set of frames, read once.

    Raises
    ------
    InputError
        If there are no flats or frames of two sizes, a level has one flat or one dark, its flats
        differ, or its darks are brighter than its flats.
    """
    if not any(level.flats and not level.spatial for level in frames.levels):
        raise InputError(frames.source, "must have frames with light", found="has dark frames only")
    refuse_mixed(frames.source, [f for one in frames.levels for f in one.frames])
    refuse_few(frames.source, frames.levels, ("flats", "darks"))
    groups = {key_of(group): group for group in groups_of(frames.levels)}
    found: dict[Key, LightSample] = {}
    lights = Lights(frames=frames, samples=found)
    whole, done = sum(map(len, groups.values())), 0
    progress(done, whole)
    every = in_threads(lambda group: sampled(group, lights.tile), [*groups.values()])
    with closing(every) as samples:
        for (key, group), light in zip(groups.items(), samples, strict=True):
            _refuse_apart(group, light)
            found[key] = light
            done += len(group)
            progress(done, whole)
    _refuse_bright_darks(lights)
    return lights


def in_threads(
    function: Callable[[tuple[RawFrame, ...]], Result], groups: Sequence[tuple[RawFrame, ...]]
) -> Generator[Result]:
    """The results of a function of the frames of each group, in turn, computed on all cores."""
    bytes_each = 8 * math.prod(groups[0][0].shape)
    workers = max(1, min(os.cpu_count() or 1, _MOST_BYTES // bytes_each))
    keep_freed_memory()
    pool = ThreadPoolExecutor(workers)
    try:
        yield from pool.map(function, groups)
    finally:
        pool.shutdown(cancel_futures=True)


def _refuse_bright_darks(lights: Lights) -> None:
    """Refuse darks that are brighter than the flats of their level: they are exchanged."""
    for level in lights.flats:
        flats, darks = (lights.samples.get(key_of(group)) for group in (level.flats, level.darks))
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


def _code_step(lights: Lights) -> tuple[int, int]:
    """Step and offset of codes that are offset + multiples of the step; else 1 and 0. [DN]"""
    planes = [plane for light in lights.samples.values() for plane in light.planes]
    lowest = min(plane.bottom_dn for plane in planes)
    step = math.gcd(*(one.step_dn for one in planes), *(one.bottom_dn - lowest for one in planes))
    if step < 2 or max(one.top_dn - one.bottom_dn for one in planes) < _FEWEST_STEPS * step:
        return 1, 0
    return step, lowest % step


def in_true_codes(lights: Lights) -> Lights:
    """Frames and statistics in the codes of the converter, if stored codes are multiples of a step.

    If codes of 12 bits are stored in the upper bits of 16, the step is 16.

    Parameters
    ----------
    lights
        All frames, and their statistics as stored.

    Raises
    ------
    InputError
        If a frame has a code above the largest one of its bits.
    """
    step, offset = _code_step(lights)
    bits = _true_bits(lights, step)
    if step == 1:
        return lights

    def shifted(frame: RawFrame) -> RawFrame:
        black = frame.black_level_dn
        return replace(
            frame,
            read=partial(_in_steps, frame, step, offset),
            bits=bits,
            black_level_dn=None if black is None else (black - offset) / step,
        )

    frames = lights.frames
    levels = tuple(
        replace(one, flats=tuple(map(shifted, one.flats)), darks=tuple(map(shifted, one.darks)))
        for one in frames.levels
    )
    start = f"{offset} + " if offset else ""
    note = f"all codes are {start}multiples of {step} and are divided by it: 1 DN is one such step"
    note += "" if bits is None else f", codes of {bits} bits"
    return Lights(
        frames=replace(frames, levels=levels, notes=(*frames.notes, note)),
        samples={key: light.in_steps(step, offset) for key, light in lights.samples.items()},
    )


def _in_steps(frame: RawFrame, step_dn: int, offset_dn: int) -> Integer[Array, "h w"]:
    """The codes of a frame as (code - offset) / step."""
    codes = frame.codes()
    return (codes - codes.dtype.type(offset_dn)) // codes.dtype.type(step_dn)


def _true_bits(lights: Lights, step_dn: int) -> int | None:
    """Bits of the converter; ``None`` if no frame states its bits.

    The stated bits are those of the stored codes, unless the stored codes are too large for them.
    """
    groups = groups_of(lights.frames.levels)
    bits = next((group[0].bits for group in groups if group[0].bits), None)
    if bits is None:
        return None
    tops = {group[0]: max(plane.top_dn for plane in lights.of(group).planes) for group in groups}
    largest = 2**bits - 1
    if max(tops.values()) <= largest:
        return (largest // step_dn).bit_length()
    for frame, top in tops.items():
        if top // step_dn > largest:
            raise InputError(
                frame.name,
                f"must have codes of at most {largest} for {bits} bits",
                value=top,
                found=f"has a code of {top}",
                remedy="correct bits in capture.toml",
            )
    return bits


def unclipped(lights: Lights) -> Lights:
    """The frames without flats that are clipped at code 0, and without any darks if one is clipped.

    The variance of a clipped dark is too small, and its mean is too large.

    Raises
    ------
    InputError
        If all flats are clipped.
    """
    frames = lights.frames
    dark = any(clipped_share(lights.of(one.darks)) for one in frames.levels if one.darks)
    kept = [
        replace(one, darks=()) if dark else one
        for one in frames.levels
        if not (one.flats and clipped_share(lights.of(one.flats)))
    ]
    levels = tuple(one for one in kept if one.flats or one.darks)
    if not any(one.flats and not one.spatial for one in levels):
        raise InputError(
            frames.source,
            "must have frames with light that are not clipped at code 0",
            found="has none",
            remedy="take frames with more light, or frames whose black level is not subtracted",
        )
    return replace(lights, frames=replace(frames, levels=levels))


def clipped_share(light: LightSample) -> float:
    """Largest share of the pixels of a plane that are clipped at code 0; 0 if it is small. [1]"""
    shares = [
        plane.bottom_share
        for plane in light.planes
        if plane.bottom_dn == 0 and plane.variance_dn2 > 0
    ]
    return max((share for share in shares if share > LEAST_CLIPPED), default=0.0)


def _refuse_apart(group: Sequence[RawFrame], light: LightSample) -> None:
    for plane in light.planes:
        means = plane.frame_means_dn
        low, high = means.index(min(means)), means.index(max(means))
        noise = 10 * math.sqrt(plane.mean_variance_dn2 * len(means))
        if means[high] - means[low] > max(_MOST_APART * abs(means[high]), noise):
            raise InputError(
                group[high].name,
                f"must have the same light as {group[low].name}, with which it is grouped",
                value=means[high],
                found=f"has a mean of {means[high]:.6g} DN, and the other has {means[low]:.6g} DN",
                remedy="state in capture.toml which frames belong together",
            )


@dataclass(frozen=True, kw_only=True)
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


def light_changes(lights: Lights) -> dict[Key, LightChange]:
    """The levels between whose flats the light changed significantly, by the names of the flats.

    Notes
    -----
    The mean of a frame also varies with the offset, the row noise and the column noise of the
    camera. This variance is measured on the darks, because in flats a change of the light adds
    shading to row and column noise. A change counts if it and the signal above dark exceed 5 times
    their standard errors.
    """
    offsets = [_offset_variance(plane) for plane in lights.planes]
    found = {}
    for level in lights.flats:
        samples = lights.of(level.flats).planes
        i = max(range(len(samples)), key=lambda plane: samples[plane].mean_dn)
        means, base = samples[i].frame_means_dn, _bases(lights, level)
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


def _offset_variance(plane: PlaneLights) -> float:
    """Variance of the mean of a frame without light; without darks, of the darkest flat. [DN^2]"""
    darks = plane.darks
    if not darks:
        darkest = min(plane.every, key=lambda one: one.mean_dn)
        return len(darkest.frame_means_dn) * darkest.mean_variance_dn2
    counts = np.array([len(one.frame_means_dn) for one in darks])
    found = np.array([np.var(one.frame_means_dn, ddof=1) for one in darks])
    chance = counts * np.array([one.mean_variance_dn2 for one in darks])
    return max(*(float((counts - 1) @ one) / int((counts - 1).sum()) for one in (found, chance)))


def _bases(lights: Lights, level: FrameLevel) -> list[tuple[float, float]] | None:
    """Mean and variance of each plane of a level without light; ``None`` if not known.

    Without darks, the mean is the black level that the frames state, and the variance 0.
    """
    if lights.darks:
        return [plane.dark_of(level) for plane in lights.planes]
    black = lights.frames.black_level_dn
    return None if black is None else [(black, 0.0)] * len(lights.planes)


def at_one_light(lights: Lights) -> Lights:
    """The statistics, after scaling to one light of the flats between which the light changed."""
    found, changed = dict(lights.samples), light_changes(lights)
    for level in lights.flats:
        key, base = key_of(level.flats), _bases(lights, level)
        if key not in changed or base is None:
            continue
        lowest = [min(plane.frame_means_dn) for plane in found[key].planes]
        if all(mean > black for mean, (black, _) in zip(lowest, base, strict=True)):
            found[key] = scaled_sample(level.flats, lights.tile, found[key], base)
    return replace(lights, samples=found)


def transfer_table(plane: PlaneLights, name: str) -> PhotonTransfer:
    """Means and variances of one plane: the lit levels from dark to bright, then the darks.

    Exposure times are used if each lit level has a dark of its time, photons if all have them.
    """
    lit, darks = plane.lights.lit, plane.lights.darks.values()
    levels = [*lit, *darks]
    samples = [plane.of(level.flats) for level in lit] + plane.darks
    matched = bool(darks) and all(dark.time_ms for dark in darks)
    matched = matched and all(any(_same_time(dark, level) for dark in darks) for level in lit)
    photons = [level.photons_per_pixel for level in lit]
    return PhotonTransfer(
        mean_dn=np.array([one.mean_dn for one in samples]),
        variance_dn2=np.array([one.variance_dn2 for one in samples]),
        dark=np.arange(len(levels)) >= len(lit),
        samples=np.array([one.samples for one in samples]),
        source=f"{plane.lights.frames.source}, {name}",
        time_ms=np.array([level.time_ms for level in levels], float) if matched else None,
        mean_se_dn=np.sqrt([one.mean_variance_dn2 for one in samples]),
        photons=None if None in photons else np.array([*photons, *[0.0] * len(darks)], float),
    )
