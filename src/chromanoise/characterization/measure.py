"""From raw frames to the noise of each plane of a camera, in the way of EMVA 1288."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.characterization.results import (
    Characterization,
    LevelNoise,
    PlaneNoise,
)
from chromanoise.characterization.spatial import (
    SpatialVariance,
    hot_pixels,
    spatial_variance,
)
from chromanoise.characterization.statistics import (
    LightSample,
    PlaneSample,
    averaged,
    light_sample,
    planes_of,
)
from chromanoise.characterization.verdict import model_verdict
from chromanoise.errors import InputError
from chromanoise.io.frames.frame import Frame, FrameLevel, FrameSet
from chromanoise.sensor import Mosaic, PhotonTransfer, TransferFit, photon_transfer_fit

_LEAST_DARK_DN2 = 0.24  # below it the dark noise is mostly quantization: EMVA 1288
_SAME_TIME = 0.01  # of an exposure time, within which a dark belongs to a flat
_MOST_APART = 0.2  # of the mean, by which flats of one level may differ
_MOST_AVERAGED = 16  # frames of a level from which fixed patterns are computed
_HALF = 0.5  # of saturation, at which PRNU is measured
_PLATEAU = 0.1  # of the largest variance, below which a level is saturated
_LINEAR = (0.05, 0.95)  # of saturation, between which linearity is judged
_DYNAMIC_RANGE_E = 0.5  # added to the dark noise: EMVA 1288, eq. of the absolute threshold

Sampler = Callable[[Sequence[Frame], tuple[int, int]], LightSample]
"""A function that computes the statistics of frames, or returns those of an earlier run."""


def characterized(
    frames: FrameSet,
    *,
    sampled: Sampler = light_sample,
    progress: Callable[[int, int], None] = lambda _done, _all: None,
) -> Characterization:
    """Noise of each plane of a camera from its frames, with a verdict on the linear model.

    Parameters
    ----------
    frames
        Levels of light with two or more flats each, and darks.
    sampled
        Computes the statistics of the frames of one light; `chromanoise.characterization.resumed`
        keeps them for a later run.
    progress
        Called with the number of frames read so far and their total.

    Raises
    ------
    InputError
        If frames differ in size, a level has one flat, its flats differ by more than 20 %, darks
        are brighter than flats, or the levels give no photon transfer (`photon_transfer_fit`).

    Notes
    -----
    EMVA 1288, release 4.0 Linear: K, dark noise, QE, saturation and linearity from the temporal
    variances (chapter 6), DSNU and PRNU from averaged frames (chapter 8); PRNU with its high-pass
    filter, at the level nearest to half of saturation.
    """
    _refuse_mixed(frames)
    tile = (1, 1) if frames.mosaic is None else _tile(frames.mosaic)
    lights = _lights(frames, tile, sampled, progress)
    names = plane_names(frames.mosaic)
    tables = [_table(frames, lights, i, f"{frames.source}, {name}") for i, name in enumerate(names)]
    fits = [photon_transfer_fit(table) for table in tables]
    middle = _middle(frames, lights, fits)
    flat_means = _averages(middle.flats, tile)
    dark_level = middle if middle.darks else next((x for x in frames.levels if x.darks), None)
    dark_means = None if dark_level is None else _averages(dark_level.darks, tile)
    lit, planes = _lit(frames, lights), []
    for i, (name, fit) in enumerate(zip(names, fits, strict=True)):
        own = {key: light.planes[i] for key, light in lights.items()}
        of_flat, count = own[_key(middle.flats)], _averaged_count(middle.flats)
        flat = spatial_variance(flat_means[i], of_flat, frames=count, high_pass=True)
        dark = dark_filtered = hot = None
        if dark_means is not None and dark_level is not None:
            of_dark = own[_key(dark_level.darks)]
            count = _averaged_count(dark_level.darks)
            dark, dark_filtered = (
                spatial_variance(dark_means[i], of_dark, frames=count, high_pass=filtered)
                for filtered in (False, True)
            )
            hot = hot_pixels(dark_means[i])
        planes.append(
            _plane(
                frames,
                lit,
                own,
                fit,
                name=name,
                middle=middle,
                flat=flat,
                dark=dark,
                dark_filtered=dark_filtered,
                hot=hot,
            )
        )
    first = frames.levels[0].flats or frames.levels[0].darks
    covariance = lights[_key(middle.flats)].covariance_dn2
    sd = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return Characterization(
        source=frames.source,
        camera=first[0].camera,
        iso=first[0].iso,
        bits=first[0].bits,
        mosaic=None if frames.mosaic is None else named_mosaic(frames.mosaic),
        planes=tuple(planes),
        correlation=covariance / np.outer(sd, sd),
        covariance_dn2=np.array([lights[_key(level.flats)].covariance_dn2 for level in lit]),
        verdict=model_verdict(frames, lights, planes, covariance / np.outer(sd, sd)),
        notes=(*frames.notes, *_hidden_notes(frames, lights, names)),
    )


def _hidden_notes(
    frames: FrameSet, lights: Mapping[Key, LightSample], names: Sequence[str]
) -> list[str]:
    hidden = [
        name
        for i, name in enumerate(names)
        if _hidden_by_rounding(frames, {key: light.planes[i] for key, light in lights.items()})
    ]
    if not hidden:
        return []
    return [
        f"{', '.join(hidden)}: the dark noise is below 0.49 DN, so rounding hides DSNU, row noise, "
        "column noise and dark current"
    ]


def plane_names(mosaic: Mosaic | None) -> tuple[str, ...]:
    """Names of the planes, in the order of the pixels of a period; repeated channels are numbered.

    Examples
    --------
    >>> from chromanoise.sensor import bayer
    >>> plane_names(bayer()), plane_names(None)
    (('R', 'G1', 'G2', 'B'), ('mono',))
    """
    if mosaic is None:
        return ("mono",)
    channels = [name for row in mosaic.pattern for name in row]
    seen: dict[str, int] = {}
    names = []
    for channel in channels:
        seen[channel] = seen.get(channel, 0) + 1
        names.append(channel if channels.count(channel) == 1 else f"{channel}{seen[channel]}")
    return tuple(names)


def named_mosaic(mosaic: Mosaic) -> Mosaic:
    """The mosaic with the names of the planes."""
    names, width = plane_names(mosaic), len(mosaic.pattern[0])
    return Mosaic(tuple(names[i : i + width] for i in range(0, len(names), width)))


def _tile(mosaic: Mosaic) -> tuple[int, int]:
    return len(mosaic.pattern), len(mosaic.pattern[0])


# ---- temporal ----

Key = tuple[str, ...]


def _key(frames: Sequence[Frame]) -> Key:
    return tuple(f"{frame.path}[{frame.index}]" for frame in frames)


def _refuse_mixed(frames: FrameSet) -> None:
    if not any(level.flats for level in frames.levels):
        raise InputError(frames.source, "must have frames with light", found="has dark frames only")
    every = [frame for level in frames.levels for frame in (*level.flats, *level.darks)]
    for frame in every[1:]:
        if frame.shape != every[0].shape:
            raise InputError(
                frame.name,
                f"must have the size of {every[0].name}, {every[0].shape[1]} x "
                f"{every[0].shape[0]} pixels",
                value=frame.shape,
                found=f"has {frame.shape[1]} x {frame.shape[0]}",
            )
    for level in frames.levels:
        if len(level.flats) == 1:
            raise InputError(
                level.flats[0].name,
                "must have a second flat of the same light for a temporal variance",
                value=1,
                found=f"it is the only flat of {level.name}",
            )


def _lights(
    frames: FrameSet,
    tile: tuple[int, int],
    sampled: Sampler,
    progress: Callable[[int, int], None],
) -> dict[Key, LightSample]:
    """The statistics of each set of frames, read once."""
    groups: dict[Key, tuple[Frame, ...]] = {}
    for level in frames.levels:
        for group in (level.flats, level.darks):
            if len(group) > 1:
                groups.setdefault(_key(group), group)
    whole, done, lights = sum(map(len, groups.values())), 0, {}
    for key, group in groups.items():
        progress(done, whole)
        light = sampled(group, tile)
        _refuse_apart(group, light)
        lights[key] = light
        done += len(group)
    progress(whole, whole)
    return lights


def _refuse_apart(group: Sequence[Frame], light: LightSample) -> None:
    for plane in light.planes:
        means = plane.frame_means_dn
        low, high = int(np.argmin(means)), int(np.argmax(means))
        noise = 10 * math.sqrt(plane.mean_variance_dn2 * len(means))
        if means[high] - means[low] > max(_MOST_APART * abs(means[high]), noise):
            raise InputError(
                group[high].name,
                f"must have the light of {group[low].name}, with which it is grouped",
                value=means[high],
                found=f"has a mean of {means[high]:.6g} DN, and the other {means[low]:.6g} DN",
                remedy="say in capture.toml which frames belong together",
            )


def _lit(frames: FrameSet, lights: Mapping[Key, LightSample]) -> list[FrameLevel]:
    """The levels with flats, from dark to bright, all planes together."""

    def light(level: FrameLevel) -> float:
        return sum(plane.mean_dn for plane in lights[_key(level.flats)].planes)

    return sorted((level for level in frames.levels if level.flats), key=light)


def _darks(frames: FrameSet, lights: Mapping[Key, LightSample]) -> dict[Key, FrameLevel]:
    """Each set of darks once, with a level that has it."""
    found: dict[Key, FrameLevel] = {}
    for level in frames.levels:
        if level.darks and _key(level.darks) in lights:
            found.setdefault(_key(level.darks), level)
    return found


def _matched(lit: Sequence[FrameLevel], darks: Mapping[Key, FrameLevel]) -> bool:
    """Whether each lit level has a dark of its exposure time."""
    times = [level.time_ms for level in darks.values() if level.time_ms]
    return len(times) == len(darks) > 0 and all(
        level.time_ms is not None
        and any(abs(time - level.time_ms) <= _SAME_TIME * level.time_ms for time in times)
        for level in lit
    )


def _table(
    frames: FrameSet, lights: Mapping[Key, LightSample], plane: int, source: str
) -> PhotonTransfer:
    """Means and variances of one plane: the lit levels from dark to bright, then the darks."""
    lit, darks = _lit(frames, lights), _darks(frames, lights)
    samples = [lights[_key(level.flats)].planes[plane] for level in lit]
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


# ---- one plane ----


@dataclass(frozen=True, slots=True, kw_only=True)
class _Value:
    """A number and its standard error."""

    value: float | None = None
    se: float | None = None


def _root(variance: float, se: float, scale: float, relative_se: float) -> _Value:
    """Root of a variance over a scale; 0 where the variance is negative by chance."""
    least = max(variance, se, 0.0)
    value = math.sqrt(max(variance, 0.0)) / scale
    own = se / (2 * math.sqrt(least) * scale) if least else 0.0
    return _Value(value=value, se=math.hypot(own, value * relative_se))


def _plane(
    frames: FrameSet,
    lit: Sequence[FrameLevel],
    own: Mapping[Key, PlaneSample],
    fit: TransferFit,
    *,
    name: str,
    middle: FrameLevel,
    flat: SpatialVariance,
    dark: SpatialVariance | None,
    dark_filtered: SpatialVariance | None,
    hot: int | None,
) -> PlaneNoise:
    gain, relative = fit.gain_dn_per_e, fit.gain_se / fit.gain_dn_per_e
    dark_of = _dark_of(frames, own)
    prnu = dsnu = _Value()
    hidden = _hidden_by_rounding(frames, own)
    if dark is not None and dark_filtered is not None:
        dsnu = _Value() if hidden else _root(dark.variance_dn2, dark.se_dn2, gain, relative)
        above = own[_key(middle.flats)].mean_dn - dark_of(middle)[0]
        prnu = _root(
            flat.variance_dn2 - dark_filtered.variance_dn2,
            math.hypot(flat.se_dn2, dark_filtered.se_dn2),
            above,
            0.0,
        )
    row, column = (
        _Value() if hidden else _shared(own, frames, which, gain, relative)
        for which in ("row", "column")
    )
    black = _black_level(own, frames, fit, 0.0 if dsnu.value is None else dsnu.value * gain)
    full, capacity = _full_well(lit, own, fit, dark_of)
    levels = _levels(lit, own, fit, dark_of)
    noise = fit.read_noise_e
    ranged = full.value is not None and noise is not None
    return PlaneNoise(
        name=name,
        gain_dn_per_e=gain,
        gain_dn_per_e_se=fit.gain_se,
        dark_noise_e=noise,
        dark_noise_e_se=fit.read_noise_se,
        black_level_dn=fit.black_dn,
        black_level_dn_se=black,
        saturation_dn=fit.saturation_dn,
        saturation_capacity_e=capacity,
        full_well_e=full.value,
        full_well_e_se=full.se,
        dynamic_range_db=20 * math.log10(full.value / (noise + _DYNAMIC_RANGE_E))  # type: ignore[operator]
        if ranged
        else None,
        qe=fit.qe,
        qe_se=fit.qe_se,
        linearity_error_percent=_linearity_error(lit, own, fit, dark_of),
        dark_current_e_per_s=None if hidden else fit.dark_current_e_per_s,
        dark_current_e_per_s_se=None if hidden else fit.dark_current_se,
        dsnu_e=dsnu.value,
        dsnu_e_se=dsnu.se,
        prnu=prnu.value,
        prnu_se=prnu.se,
        row_noise_e=row.value,
        row_noise_e_se=row.se,
        column_noise_e=column.value,
        column_noise_e_se=column.se,
        hot_pixels=hot,
        bend_z=fit.bend_z,
        levels=levels,
        fit=fit,
    )


DarkOf = Callable[[FrameLevel], tuple[float, float | None]]


def _dark_of(frames: FrameSet, own: Mapping[Key, PlaneSample]) -> DarkOf:
    """Dark mean and variance of a level: its own darks, those of its time, or all. [DN], [DN^2]"""
    groups = {
        _key(level.darks): level
        for level in frames.levels
        if level.darks and _key(level.darks) in own
    }

    def found(level: FrameLevel) -> tuple[float, float | None]:
        if not groups:
            return min(one.mean_dn for one in own.values()), None
        keys = [_key(level.darks)] if _key(level.darks) in own and level.darks else []
        if not keys and level.time_ms is not None:
            keys = [
                key
                for key, one in groups.items()
                if one.time_ms is not None
                and abs(one.time_ms - level.time_ms) <= _SAME_TIME * level.time_ms
            ]
        samples = [own[key] for key in keys or groups]
        return (
            float(np.mean([one.mean_dn for one in samples])),
            float(np.mean([one.variance_dn2 for one in samples])),
        )

    return found


def _hidden_by_rounding(frames: FrameSet, own: Mapping[Key, PlaneSample]) -> bool:
    """Whether the dark noise is so low that rounding hides what is small in the dark.

    EMVA 1288, release 4.0: a dark variance below 0.24 DN^2 is mostly quantization.
    """
    darks = [own[_key(level.darks)] for level in frames.levels if _key(level.darks) in own]
    return bool(darks) and min(one.variance_dn2 for one in darks) < _LEAST_DARK_DN2


def _shared(
    own: Mapping[Key, PlaneSample], frames: FrameSet, which: str, gain: float, relative: float
) -> _Value:
    """Noise that all pixels of a row, or of a column, share in the dark, from all darks."""
    darks = [own[_key(level.darks)] for level in frames.levels if _key(level.darks) in own]
    samples = list({id(one): one for one in darks}.values())
    if not samples:
        return _Value()
    # equal weights: errors from few rows are those of chance, and would favor small variances
    mean = float(np.mean([getattr(one, f"{which}_dn2") for one in samples]))
    errors = np.array([getattr(one, f"{which}_se_dn2") for one in samples])
    return _root(mean, math.sqrt(float(errors @ errors)) / errors.size, gain, relative)


def _black_level(
    own: Mapping[Key, PlaneSample], frames: FrameSet, fit: TransferFit, dsnu_dn: float
) -> float | None:
    """Standard error of the mean code without light at exposure time 0. [DN]"""
    groups = {
        _key(level.darks): level.time_ms for level in frames.levels if _key(level.darks) in own
    }
    if fit.black_dn is None or not groups:
        return None
    variances = np.array([own[key].mean_variance_dn2 for key in groups])
    pixels = next(iter(own.values())).pixels
    noise_dn2 = min(own[key].variance_dn2 for key in groups) + dsnu_dn**2
    weights = np.full(variances.size, 1 / variances.size)
    known = [time for time in groups.values() if time is not None]
    if len(known) == variances.size and len(set(known)) > 1:
        times = np.array(known)
        weights = (times == times.min()) / (times == times.min()).sum()
        if len(set(known)) > 2:
            away = times - times.mean()
            weights = 1 / times.size - times.mean() * away / float(away @ away)
    rounding = 0.5 * (math.exp(-2 * math.pi**2 * noise_dn2) / math.pi) ** 2
    return math.sqrt(float(weights**2 @ variances) + dsnu_dn**2 / pixels + rounding)


def _full_well(
    lit: Sequence[FrameLevel],
    own: Mapping[Key, PlaneSample],
    fit: TransferFit,
    dark_of: DarkOf,
) -> tuple[_Value, float | None]:
    """Electrons at which codes end, and EMVA's saturation capacity. [e-]

    Above saturation the variance collapses and the mean stays: that mean is the end. Without such a
    level it is the mean of largest variance, known to within the next level.
    """
    if fit.full_well_e is None or fit.saturation_dn is None:
        return _Value(), None
    gain, relative = fit.gain_dn_per_e, fit.gain_se / fit.gain_dn_per_e
    samples = [own[_key(level.flats)] for level in lit]
    top = max(one.variance_dn2 for one in samples)
    at = [one.mean_dn - dark_of(level)[0] for level, one in zip(lit, samples, strict=True)]
    flat = [
        i
        for i, one in enumerate(samples)
        if one.variance_dn2 < _PLATEAU * top and one.mean_dn > fit.saturation_dn
    ]
    if flat:
        brightest = max(flat, key=lambda i: samples[i].mean_dn)
        black = dark_of(lit[0])[0] if fit.black_dn is None else fit.black_dn
        value = (samples[brightest].mean_dn - black) / gain  # dark electrons fill the well too
        return _Value(value=value, se=value * relative), fit.full_well_e
    k = int(np.argmin([abs(one.mean_dn - fit.saturation_dn) for one in samples]))
    spacing = (at[min(k + 1, len(at) - 1)] - at[max(k - 1, 0)]) / gain
    value = fit.full_well_e
    return _Value(value=value, se=math.hypot(value * relative, spacing / math.sqrt(12))), value


def _linearity_error(
    lit: Sequence[FrameLevel],
    own: Mapping[Key, PlaneSample],
    fit: TransferFit,
    dark_of: DarkOf,
) -> float | None:
    """Largest deviation from a line by relative least squares, 5 to 95 % of saturation. [%]

    Over photons where they are told, else over the exposure time.
    """
    light = [level.photons_per_pixel for level in lit]
    if None in light:
        light = [level.time_ms for level in lit]
    if None in light or len(set(light)) < 3:
        return None
    x = np.array(light, float)
    y = np.array([own[_key(level.flats)].mean_dn - dark_of(level)[0] for level in lit])
    dark_at_end = dark_of(lit[-1])[0]
    end = y.max() if fit.saturation_dn is None else fit.saturation_dn - dark_at_end
    used = (y >= _LINEAR[0] * end) & (y <= _LINEAR[1] * end)
    if used.sum() < 3:
        return None
    slope, offset = np.polynomial.polynomial.polyfit(x[used], y[used], 1, w=1 / y[used])[::-1]
    line = offset + slope * x[used]
    return float(np.abs(100 * (y[used] - line) / line).max())


def _levels(
    lit: Sequence[FrameLevel],
    own: Mapping[Key, PlaneSample],
    fit: TransferFit,
    dark_of: DarkOf,
) -> tuple[LevelNoise, ...]:
    noises = []
    for i, level in enumerate(lit):
        sample, (dark_mean, dark_variance) = own[_key(level.flats)], dark_of(level)
        predicted = fit.gain_dn_per_e * (sample.mean_dn - dark_mean) + (dark_variance or 0.0)
        noises.append(
            LevelNoise(
                name=level.name,
                frames=len(level.flats),
                time_ms=level.time_ms,
                photons_per_pixel=level.photons_per_pixel,
                mean_dn=sample.mean_dn,
                variance_dn2=sample.variance_dn2,
                variance_se_dn2=sample.variance_dn2 * math.sqrt(2 / (sample.samples - 1)),
                predicted_variance_dn2=predicted,
                dark_mean_dn=None if dark_variance is None else dark_mean,
                dark_variance_dn2=dark_variance,
                fitted=bool(fit.fitted[i]),
                clipped_share=sample.top_share,
                correlation_right=sample.correlation_right,
                correlation_down=sample.correlation_down,
                drift_z=sample.drift_z,
            )
        )
    return tuple(noises)


# ---- averaged frames ----


def _middle(
    frames: FrameSet, lights: Mapping[Key, LightSample], fits: Sequence[TransferFit]
) -> FrameLevel:
    """The level nearest to half of saturation of the plane that saturates first."""
    lit = _lit(frames, lights)
    brightest = max(range(len(fits)), key=lambda i: lights[_key(lit[-1].flats)].planes[i].mean_dn)
    fit = fits[brightest]
    means = [lights[_key(level.flats)].planes[brightest].mean_dn for level in lit]
    black = fit.black_dn if fit.black_dn is not None else min(means)
    end = max(means) if fit.saturation_dn is None else fit.saturation_dn
    return min(
        zip(lit, means, strict=True),
        key=lambda one: abs(one[1] - black - _HALF * (end - black)),
    )[0]


def _averages(group: Sequence[Frame], tile: tuple[int, int]) -> list[Float[Array, "h w"]]:
    return planes_of(averaged(group[: _averaged_count(group)], tile), tile)


def _averaged_count(group: Sequence[Frame]) -> int:
    return min(len(group), _MOST_AVERAGED)
