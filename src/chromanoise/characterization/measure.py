"""From raw frames to the noise of each plane of a camera, by the methods of EMVA 1288."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from chromanoise.characterization.lights import (
    Key,
    Sampler,
    at_one_light,
    dark_samples,
    darks_of,
    in_threads,
    in_true_codes,
    key_of,
    lights_of,
    lit_levels,
    refuse_unusable,
    transfer_table,
    unclipped,
)
from chromanoise.characterization.planes import hidden_by_rounding, plane_noise
from chromanoise.characterization.results import Characterization, PlaneNoise, plane_names
from chromanoise.characterization.spatial import (
    LEAST_SIDE,
    FixedPattern,
    SpatialVariance,
    fixed_pattern,
    hot_pixels,
    spatial_variance,
)
from chromanoise.characterization.statistics import (
    LightSample,
    PlaneSample,
    light_sample,
    mean_shared,
    summed,
)
from chromanoise.characterization.verdict import model_verdict
from chromanoise.errors import InputError
from chromanoise.io.frames.frame import FrameLevel, FrameSet, RawFrame
from chromanoise.sensor import Mosaic, PhotonTransfer, TransferFit, photon_transfer_fit

_MOST_AVERAGED = 16  # frames of a level from which fixed patterns are computed
_MOST_SPATIAL = 1 << 15  # the same for a spatial series: sums have 32 bits
_HALF = 0.5  # of saturation, at which PRNU is measured


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
        are brighter than flats, or the levels allow no photon transfer fit (`photon_transfer_fit`).

    Notes
    -----
    EMVA 1288, release 4.0 Linear: K, dark noise, QE, saturation and linearity from the temporal
    variances (chapter 6), DSNU and PRNU from averaged frames (chapter 8). PRNU is computed with the
    high-pass filter of the standard, from the spatial series (without one: from the level) nearest
    to half of saturation.
    """
    refuse_unusable(frames)
    tile = (1, 1) if frames.mosaic is None else frames.mosaic.shape
    given, lights = in_true_codes(frames, lights_of(frames, tile, sampled, progress))
    frames = unclipped(given, lights)
    lights = at_one_light(frames, lights, tile)
    names = plane_names(frames.mosaic)
    black = None if darks_of(frames) else frames.black_level_dn
    tables = [
        transfer_table(frames, lights, i, f"{frames.source}, {name}")
        for i, name in enumerate(names)
    ]
    fits = [_fit(table, black) for table in tables]
    lit, planes = lit_levels(frames, lights), []
    spatial = [level for level in frames.levels if level.flats and level.spatial]
    middles = [_middle(lit, spatial or lit, lights, i, fit) for i, fit in enumerate(fits)]
    patterns = _patterns(frames, middles, tile)
    unfiltered = []
    for i, (name, fit, middle) in enumerate(zip(names, fits, middles, strict=True)):
        own = {key: light.planes[i] for key, light in lights.items()}
        darks = _darks_of(frames, middle)
        flat = _spatial(patterns, own, middle.flats, i, high_pass=True, darks=darks)
        dark = dark_filtered = dark_alone = hot = None
        if darks:
            steady = {key_of(darks): _with_rows_of_all_darks(frames, own, darks)}
            dark, dark_filtered = (
                _spatial(patterns, steady, darks, i, high_pass=filtered)
                for filtered in (False, True)
            )
            dark_alone = _spatial(patterns, own, darks, i, high_pass=False)
            hot = hot_pixels(patterns[key_of(darks), i], own[key_of(darks)])
        unfiltered += [] if flat.filtered else [name]
        planes.append(
            plane_noise(
                frames,
                lit,
                own,
                fit,
                name=name,
                flat=flat,
                dark=dark,
                dark_alone=dark_alone,
                dark_filtered=dark_filtered,
                hot=hot,
            )
        )
    middle = middles[0]
    first = frames.levels[0].flats or frames.levels[0].darks
    covariance = lights[key_of(middle.flats)].covariance_dn2
    sd = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return Characterization(
        source=frames.source,
        camera=first[0].camera,
        iso=first[0].iso,
        bits=first[0].bits,
        mosaic=None if frames.mosaic is None else named_mosaic(frames.mosaic),
        planes=tuple(planes),
        correlation=covariance / np.outer(sd, sd),
        covariance_dn2=np.array([lights[key_of(level.flats)].covariance_dn2 for level in lit]),
        verdict=model_verdict(given, frames, lights, planes, covariance / np.outer(sd, sd)),
        notes=(
            *frames.notes,
            *_black_notes(frames, planes),
            *_hidden_notes(frames, lights, names),
            *_shading_notes(unfiltered),
        ),
    )


def _fit(table: PhotonTransfer, black_dn: float | None) -> TransferFit:
    """The photon transfer; without QE, and with a note, where the photons cannot be right.

    Frames that were denoised give a QE above 1; the verdict names them.
    """
    try:
        return photon_transfer_fit(table, black_dn=black_dn)
    except InputError as error:
        if table.photons is None or "photons" not in error.where:
            raise
        note = f"{table.source}: no QE: it {error.found}, which is not possible"
        known = replace(table, photons=None, notes=(*table.notes, note))
        return photon_transfer_fit(known, black_dn=black_dn)


def named_mosaic(mosaic: Mosaic) -> Mosaic:
    """The mosaic with the names of the planes."""
    names, (_, width) = mosaic.place_names, mosaic.shape
    return Mosaic(tuple(names[i : i + width] for i in range(0, len(names), width)))


def _hidden_notes(
    frames: FrameSet, lights: Mapping[Key, LightSample], names: Sequence[str]
) -> list[str]:
    hidden = [
        name
        for i, name in enumerate(names)
        if hidden_by_rounding(frames, {key: light.planes[i] for key, light in lights.items()})
    ]
    if not hidden:
        return []
    return [
        f"{', '.join(hidden)}: the dark noise is below 0.49 DN, so rounding hides DSNU, row noise, "
        "column noise and dark current"
    ]


def _black_notes(frames: FrameSet, planes: Sequence[PlaneNoise]) -> list[str]:
    black = frames.black_level_dn
    if darks_of(frames):
        measured = [one.black_level_dn for one in planes if one.black_level_dn is not None]
        if black is None or not measured or max(abs(one - black) for one in measured) <= 1:
            return []
        span = " to ".join(f"{one:.4g}" for one in sorted({min(measured), max(measured)}))
        return [
            f"the stated black level of {black:g} DN is not used: the darks have {span} DN; "
            "correct it, or check whether the darks belong to the flats"
        ]
    if black is None:
        return [
            "the black level is not known: take darks, or state black_level_dn in capture.toml "
            "(0 if the camera subtracts it)"
        ]
    return [f"no darks are used: the black level is the stated {black:g} DN"]


def _shading_notes(names: Sequence[str]) -> list[str]:
    if not names:
        return []
    return [
        f"{', '.join(names)}: PRNU includes shading, because planes of less than {LEAST_SIDE} "
        "rows or columns are not high-pass filtered"
    ]


# ---- fixed patterns ----

Patterns = Mapping[tuple[Key, int], FixedPattern]
"""Fixed patterns by the names of the frames and the number of the plane."""


def _middle(
    lit: Sequence[FrameLevel],
    among: Sequence[FrameLevel],
    lights: Mapping[Key, LightSample],
    plane: int,
    fit: TransferFit,
) -> FrameLevel:
    """The level that is nearest to half of the saturation of a plane."""

    def mean(level: FrameLevel) -> float:
        return lights[key_of(level.flats)].planes[plane].mean_dn

    means = [mean(level) for level in lit]
    black = fit.black_dn if fit.black_dn is not None else min(means)
    end = max(means) if fit.saturation_dn is None else fit.saturation_dn
    return min(among, key=lambda one: abs(mean(one) - black - _HALF * (end - black)))


def _darks_of(frames: FrameSet, middle: FrameLevel) -> tuple[RawFrame, ...]:
    """The darks of a level; else those of a spatial series, or the first ones, if there are any."""
    others = sorted(frames.levels, key=lambda one: not one.spatial)
    return middle.darks or next((one.darks for one in others if one.darks), ())


def _patterns(
    frames: FrameSet, middles: Sequence[FrameLevel], tile: tuple[int, int]
) -> dict[tuple[Key, int], FixedPattern]:
    """The patterns of flats and darks at the middle level of each plane, read once."""
    wanted: dict[Key, tuple[tuple[RawFrame, ...], set[int]]] = {}
    for i, middle in enumerate(middles):
        for group in (middle.flats, _darks_of(frames, middle)):
            if group:
                wanted.setdefault(key_of(group), (group, set()))[1].add(i)
    series = {
        key_of(group)
        for level in frames.levels
        if level.spatial
        for group in (level.flats, level.darks)
    }

    def of_planes(group: tuple[RawFrame, ...]) -> dict[tuple[Key, int], FixedPattern]:
        key = key_of(group)
        averaged = group[: _MOST_SPATIAL if key in series else _MOST_AVERAGED]
        totals = summed(averaged, tile)
        return {(key, i): fixed_pattern(totals[i], len(averaged)) for i in wanted[key][1]}

    found: dict[tuple[Key, int], FixedPattern] = {}
    for patterns in in_threads(of_planes, [group for group, _ in wanted.values()]):
        found |= patterns
    return found


def _spatial(
    patterns: Patterns,
    own: Mapping[Key, PlaneSample],
    group: Sequence[RawFrame],
    plane: int,
    *,
    high_pass: bool,
    darks: Sequence[RawFrame] = (),
) -> SpatialVariance:
    key = key_of(group)
    return spatial_variance(
        patterns[key, plane],
        own[key],
        high_pass=high_pass,
        dark=own[key_of(darks)] if darks else None,
    )


def _with_rows_of_all_darks(
    frames: FrameSet, own: Mapping[Key, PlaneSample], group: Sequence[RawFrame]
) -> PlaneSample:
    """The statistics of darks, with the row and column noise of all darks.

    Two frames have few rows and columns, and this noise does not depend on the exposure time, so it
    is averaged over all darks. A spatial series has many frames, so their own temporal noise is
    subtracted, as in the standard.
    """
    if any(level.spatial and level.darks == group for level in frames.levels):
        return own[key_of(group)]
    (row, row_se), (column, column_se) = (
        mean_shared(dark_samples(frames, own), which) for which in ("row", "column")
    )
    return replace(
        own[key_of(group)],
        row_dn2=row,
        row_se_dn2=row_se,
        column_dn2=column,
        column_se_dn2=column_se,
    )
