"""Characterization of a camera: from frames or a table to the noise of each plane and a verdict.

The methods are those of EMVA 1288. The verdict states whether the frames follow the linear model:
variance = K mean + dark variance, white in space. The statistics of the frames are kept in a file,
so that a stopped run continues where it ended.
"""

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from chromanoise.apps.camera.characterization import (
    Characterization,
    LevelNoise,
    ModelVerdict,
    PlaneNoise,
    plane_names,
)
from chromanoise.apps.camera.lights import (
    Key,
    Lights,
    PlaneLights,
    Sampler,
    at_one_light,
    clipped_share,
    in_threads,
    in_true_codes,
    key_of,
    light_changes,
    lights_of,
    transfer_table,
    unclipped,
)
from chromanoise.apps.camera.planes import FixedNoise, level_noise, plane_noise, plane_of_fit
from chromanoise.apps.camera.statistics import (
    BAND_PIXELS,
    LEAST_CLIPPED,
    LEAST_SIDE,
    SURE_Z,
    FixedPattern,
    LightSample,
    PlaneSample,
    fixed_patterns,
    hot_pixels,
    light_sample,
    mean_shared,
    spatial_variance,
)
from chromanoise.base import (
    Array,
    Float,
    InputError,
    __version__,
    inputs,
    plain,
    refuse_absent_package,
    write_whole,
)
from chromanoise.io.frames import FrameLevel, FrameSet, RawFrame, read_frame_set
from chromanoise.io.pixels import is_photon_transfer_text, read_photon_transfer_csv
from chromanoise.sensor import Mosaic, PhotonTransfer, TransferFit, photon_transfer_fit

_MADE_BY = {"schema": "chromanoise frame statistics", "version": __version__}
_MOST_BYTES = 100_000_000


def resumed(path: Path) -> Sampler:
    """A function for `characterized` that keeps its results in a file.

    The file is rewritten after each light. Results are reused only for the same frames: same
    paths, sizes and modification times. Several threads may call the function.

    Parameters
    ----------
    path
        The file; made if it does not exist.

    Raises
    ------
    InputError
        If the file exists and is of another kind or version, or was changed.
    """
    kept, writing = _read(path) if os.path.lexists(path) else {}, Lock()

    def sampled(frames: Sequence[RawFrame], tile: tuple[int, int]) -> LightSample:
        key = _key(frames, tile)
        if key not in kept:
            found = light_sample(frames, tile)
            with writing:
                kept[key] = plain(found)
                data = {**_MADE_BY, "lights": kept}
                data["content"] = inputs.content_hash(data)
                write_whole(path, json.dumps(data).encode())
            return found
        one = kept[key]
        planes = [
            PlaneSample(**plane | {"frame_means_dn": tuple(plane["frame_means_dn"])})
            for plane in one["planes"]
        ]
        return LightSample(planes=tuple(planes), covariance_dn2=np.array(one["covariance_dn2"]))

    return sampled


def _key(frames: Sequence[RawFrame], tile: tuple[int, int]) -> str:
    digest = hashlib.sha256(repr(tile).encode())
    for frame in frames:
        facts = frame.path.stat()
        place = f"{inputs.true_path(frame.path)}|{frame.part}|{frame.index}"
        digest.update(f"{place}|{facts.st_size}|{facts.st_mtime_ns}\n".encode())
    return digest.hexdigest()


def _read(path: Path) -> dict[str, Any]:
    data = inputs.json_file(path, most_bytes=_MOST_BYTES)
    if not isinstance(data, dict) or {name: data.get(name) for name in _MADE_BY} != _MADE_BY:
        raise InputError(
            str(path),
            f"must hold statistics of frames of version {__version__}",
            remedy="give the file of an earlier run, or one that does not exist",
        )
    if data.get("content") != inputs.content_hash(data):
        raise InputError(
            str(path),
            "must be as the earlier run wrote it",
            found="was changed since, as its content hash shows",
            remedy=("restore it", "name a file that does not exist"),
        )
    return dict(data["lights"])


_WIDE_DN2 = 4.0  # above it few pixels share the largest code
_LEAST_BEND = 0.02  # change of the slope over the fit that is worth telling
_LEAST_CORRELATION = 0.01
_LEAST_DRIFT = 1e-3  # of the mean
_LEAST_PIXELS = 20  # of a clipped frame that have the same code
_LEAST_DEVIATION = 0.02  # of the variance


def model_verdict(
    given: Lights,
    lights: Lights,
    planes: Sequence[PlaneNoise],
    correlation: Float[Array, "p p"],
) -> ModelVerdict:
    """Chi-square of the linear law, and a sentence on each fault that is beyond chance.

    Parameters
    ----------
    given, lights
        All frames, and those that were evaluated.
    correlation
        Temporal correlation between the planes of a cell.
    """
    worst, worst_z = max(map(_worst_level, planes), key=lambda found: abs(found[1]))
    sentences = [
        *bend_sentences(planes),
        *_deviating(lights, planes),
        *_neighbors(lights, planes),
        *_channels(planes, correlation, _least_correlation(lights)),
        *_clipped_at_0(given),
        *_lights(lights, planes),
    ]
    return ModelVerdict(
        holds=not sentences,
        chi2_per_level=float(np.mean([plane.fit.chi2_per_row for plane in planes])),
        worst_level="" if worst is None else worst.name,
        worst_z=worst_z,
        sentences=tuple(sentences),
    )


def _worst_level(plane: PlaneNoise) -> tuple[LevelNoise | None, float]:
    """The fitted level that deviates most from the fit, and by how many standard errors."""
    every = zip(plane.levels, plane.fit.residual_z.tolist(), strict=False)
    fitted = [(level, z) for level, z in every if level.fitted]
    return max(fitted, key=lambda found: abs(found[1]), default=(None, 0.0))


def bend_sentences(planes: Sequence[PlaneNoise]) -> Iterator[str]:
    """A sentence on each plane whose variance is no straight line over the mean."""
    for plane in planes:
        low, high = plane.fit.low_light_gain_dn_per_e, plane.fit.high_light_gain_dn_per_e
        if plane.bend_z is None or low is None or high is None:
            continue
        if abs(plane.bend_z) > SURE_Z and abs(high / low - 1) > _LEAST_BEND:
            yield (
                f"{plane.name}: the variance is not a straight line: its slope is {low:.4g} DN/e- "
                f"at low light and {high:.4g} DN/e- at the end of the fit ({plane.bend_z:+.1f} "
                "standard errors), so one K does not describe it"
            )


def _deviating(lights: Lights, planes: Sequence[PlaneNoise]) -> Iterator[str]:
    for plane in planes:
        level, z = _worst_level(plane)
        if level is None or abs(plane.bend_z or 0.0) > SURE_Z:
            continue
        share = level.variance_dn2 / max(level.predicted_variance_dn2, 1e-300) - 1
        if abs(z) > SURE_Z and abs(share) > _LEAST_DEVIATION:
            yield (
                f"{plane.name}: the variance of {_flats(lights, level)} is {100 * share:+.1f} % "
                f"off the straight line ({z:+.1f} standard errors): the light differs between "
                "the frames, or the frames are processed"
            )


def _neighbors(lights: Lights, planes: Sequence[PlaneNoise]) -> Iterator[str]:
    """Correlation of neighbors, at the brightest level that was fitted."""
    for plane in planes:
        fitted = [level for level in plane.levels if level.fitted and level.clipped_share < 0.5]
        for level in fitted[-1:]:
            for where, value in (
                ("in a row", level.correlation_right),
                ("in a column", level.correlation_down),
            ):
                if abs(value) > _least_correlation(lights):
                    yield (
                        f"{plane.name}: the noise of neighbors {where} has a correlation of "
                        f"{value:+.3f} in {_flats(lights, level)}: the frames are denoised, "
                        "resampled or compressed, or charge spreads between pixels"
                    )


def _channels(
    planes: Sequence[PlaneNoise], correlation: Float[Array, "p p"], least: float
) -> Iterator[str]:
    for i, one in enumerate(planes):
        for j in range(i):
            if abs(correlation[i, j]) > least:
                yield (
                    f"{planes[j].name} and {one.name}: the noise of the two planes has a "
                    f"correlation of {correlation[i, j]:+.3f}, but the model assumes independent "
                    "channels"
                )


def _clipped_at_0(lights: Lights) -> Iterator[str]:
    """Darks and flats that are clipped at code 0."""
    for kind, lost in (("darks", "no darks are used"), ("flats", "these levels are not used")):
        groups = {
            key_of(group): group for one in lights.frames.levels if (group := getattr(one, kind))
        }
        shares = {key: clipped_share(lights.samples[key]) for key in groups}
        clipped = [key for key, share in shares.items() if share]
        if clipped:
            worst = max(clipped, key=shares.__getitem__)
            yield (
                f"up to {100 * shares[worst]:.2g} % of the pixels of {len(clipped)} sets of {kind} "
                f"have code 0 ({groups[worst][0].name}): clipping makes their variance too small, "
                f"so {lost}"
            )


def _lights(lights: Lights, planes: Sequence[PlaneNoise]) -> Iterator[str]:
    """Light that drifts, and flats that clip."""
    every = light_changes(lights).values()
    changes = [change for change in every if change.share > _LEAST_DRIFT]
    if changes:
        worst = max(changes, key=lambda one: one.share)
        done = (
            "the signals above dark were scaled to one mean before the variance was computed"
            if worst.above_black
            else "shading and PRNU therefore add to the variance; the frames were not scaled to "
            "one mean, because the black level is not known"
        )
        yield (
            f"the light changed between frames of {len(changes)} levels, by up to "
            f"{100 * worst.share:.2g} % ({worst.low.name} and {worst.high.name}); {done}"
        )
    least = max(LEAST_CLIPPED, _LEAST_PIXELS / _pixels(lights))
    for plane in planes:
        for one in plane.levels:
            if one.fitted and one.clipped_share > least and one.variance_dn2 > _WIDE_DN2:
                yield (
                    f"{plane.name}: {100 * one.clipped_share:.2g} % of the pixels of "
                    f"{_group(lights, one)[0].name} are at its top code: it is clipped"
                )


def _pixels(lights: Lights) -> int:
    """Pixels of a plane of which correlations and clipping are known."""
    return min(BAND_PIXELS, *(one.planes[0].pixels for one in lights.samples.values()))


def _least_correlation(lights: Lights) -> float:
    return max(_LEAST_CORRELATION, SURE_Z / math.sqrt(_pixels(lights)))


def _group(lights: Lights, noise: LevelNoise) -> tuple[RawFrame, ...]:
    return next(level.flats for level in lights.flats if level.name == noise.name)


def _flats(lights: Lights, noise: LevelNoise) -> str:
    """The names of the flats of a level: the first and the last one."""
    names = [one.name for one in _group(lights, noise)]
    return names[0] if len(names) == 1 else f"{names[0]} and {names[-1]}"


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
        Computes the statistics of the frames of one light; `chromanoise.apps.camera.resumed`
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
    refuse_absent_package("numba", "characterize", extra="compiled")
    given = in_true_codes(lights_of(frames, sampled, progress))
    lights = at_one_light(unclipped(given))
    frames, names = lights.frames, plane_names(lights.frames.mosaic)
    black = None if lights.darks else frames.black_level_dn
    fits = [
        _fit(transfer_table(own, name), black)
        for own, name in zip(lights.planes, names, strict=True)
    ]
    middles = [_middle(own, fit) for own, fit in zip(lights.planes, fits, strict=True)]
    patterns = _patterns(lights, middles)
    fixed = [
        _fixed_noise(own, patterns, middle)
        for own, middle in zip(lights.planes, middles, strict=True)
    ]
    planes = [*map(plane_noise, lights.planes, fits, fixed, names)]
    first = frames.levels[0].flats or frames.levels[0].darks
    covariance = lights.of(middles[0].flats).covariance_dn2
    sd = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    correlation = covariance / np.outer(sd, sd)
    return Characterization(
        source=frames.source,
        camera=first[0].camera,
        iso=first[0].iso,
        bits=first[0].bits,
        mosaic=None if frames.mosaic is None else named_mosaic(frames.mosaic),
        planes=tuple(planes),
        correlation=correlation,
        covariance_dn2=np.array([lights.of(level.flats).covariance_dn2 for level in lights.lit]),
        verdict=model_verdict(given, lights, planes, correlation),
        notes=(*frames.notes, *_notes(lights, planes, fixed)),
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


def _notes(
    lights: Lights, planes: Sequence[PlaneNoise], fixed: Sequence[FixedNoise]
) -> Iterator[str]:
    """What the darks and the size of the planes leave unknown."""
    black = lights.frames.black_level_dn
    measured = [one.black_level_dn for one in planes if one.black_level_dn is not None]
    if not lights.darks and black is None:
        yield (
            "the black level is not known: take darks, or state black_level_dn in capture.toml "
            "(0 if the camera subtracts it)"
        )
    elif not lights.darks:
        yield f"no darks are used: the black level is the stated {black:g} DN"
    elif black is not None and any(abs(one - black) > 1 for one in measured):
        span = " to ".join(f"{one:.4g}" for one in sorted({min(measured), max(measured)}))
        yield (
            f"the stated black level of {black:g} DN is not used: the darks have {span} DN; "
            "correct it, or check whether the darks belong to the flats"
        )
    hidden = [one.name for one, own in zip(planes, lights.planes, strict=True) if own.hidden]
    if hidden:
        yield (
            f"{', '.join(hidden)}: the dark noise is below 0.49 DN, so rounding hides DSNU, row "
            "noise, column noise and dark current"
        )
    shaded = [one.name for one, own in zip(planes, fixed, strict=True) if not own.flat.filtered]
    if shaded:
        yield (
            f"{', '.join(shaded)}: PRNU includes shading, because planes of less than {LEAST_SIDE} "
            "rows or columns are not high-pass filtered"
        )


# ---- fixed patterns ----

Patterns = Mapping[tuple[Key, int], FixedPattern]
"""Fixed patterns by the names of the frames and the number of the plane."""


def _middle(own: PlaneLights, fit: TransferFit) -> FrameLevel:
    """The level, of a spatial series if there is one, nearest to half of the saturation."""
    lit, spatial = own.lights.lit, [level for level in own.lights.flats if level.spatial]
    means = [own.of(level.flats).mean_dn for level in lit]
    black = fit.black_dn if fit.black_dn is not None else min(means)
    end = max(means) if fit.saturation_dn is None else fit.saturation_dn
    half = _HALF * (end - black)
    return min(spatial or lit, key=lambda one: abs(own.of(one.flats).mean_dn - black - half))


def _darks_of(frames: FrameSet, middle: FrameLevel) -> tuple[RawFrame, ...]:
    """The darks of a level; else those of a spatial series, or the first ones, if there are any."""
    others = sorted(frames.levels, key=lambda one: not one.spatial)
    return middle.darks or next((one.darks for one in others if one.darks), ())


def _patterns(lights: Lights, middles: Sequence[FrameLevel]) -> Patterns:
    """The patterns of flats and darks at the middle level of each plane, read once."""
    wanted: dict[Key, tuple[tuple[RawFrame, ...], set[int]]] = {}
    for i, middle in enumerate(middles):
        for group in (middle.flats, _darks_of(lights.frames, middle)):
            if group:
                wanted.setdefault(key_of(group), (group, set()))[1].add(i)

    def of_planes(group: tuple[RawFrame, ...]) -> dict[tuple[Key, int], FixedPattern]:
        key = key_of(group)
        averaged = group[: _MOST_SPATIAL if key in lights.spatial else _MOST_AVERAGED]
        patterns = fixed_patterns(averaged, lights.tile, sorted(wanted[key][1]))
        return {(key, i): pattern for i, pattern in patterns.items()}

    found: dict[tuple[Key, int], FixedPattern] = {}
    for patterns in in_threads(of_planes, [group for group, _ in wanted.values()]):
        found |= patterns
    return found


def _fixed_noise(own: PlaneLights, patterns: Patterns, middle: FrameLevel) -> FixedNoise:
    """The spatial variances of a plane, and its hot pixels, from its patterns."""
    darks = _darks_of(own.lights.frames, middle)
    flat, flats = patterns[key_of(middle.flats), own.number], own.of(middle.flats)
    if not darks:
        return FixedNoise(flat=spatial_variance(flat, flats, high_pass=True))
    dark, alone = patterns[key_of(darks), own.number], own.of(darks)
    steady = _with_rows_of_all_darks(own, darks)
    return FixedNoise(
        flat=spatial_variance(flat, flats, high_pass=True, dark=alone),
        dark=spatial_variance(dark, steady, high_pass=False),
        dark_filtered=spatial_variance(dark, steady, high_pass=True),
        dark_alone=spatial_variance(dark, alone, high_pass=False),
        hot=hot_pixels(dark, alone),
    )


def _with_rows_of_all_darks(own: PlaneLights, group: Sequence[RawFrame]) -> PlaneSample:
    """The statistics of darks, with the row and column noise of all darks.

    Two frames have few rows and columns, and this noise does not depend on the exposure time, so it
    is averaged over all darks. A spatial series has many frames, so their own temporal noise is
    subtracted, as in the standard.
    """
    if key_of(group) in own.lights.spatial:
        return own.of(group)
    row, row_se = mean_shared(own.darks, "row")
    column, column_se = mean_shared(own.darks, "column")
    return replace(
        own.of(group),
        row_dn2=row,
        row_se_dn2=row_se,
        column_dn2=column,
        column_se_dn2=column_se,
    )


_HEAD_BYTES = 4096
_TABLES = (".csv", ".tsv", ".txt", ".dat")


def characterize(
    *frames: str | Path | FrameSet | PhotonTransfer,
    resume: str | Path | None = None,
    progress: Callable[[int, int], None] = lambda _done, _all: None,
) -> Characterization:
    """Noise of a camera from its own raw frames: flats of several levels of light, and darks.

    Parameters
    ----------
    frames
        A folder, files, one table of means and variances, or what `read_source` made of them. A
        folder with ``capture.toml`` needs no guessing.
    resume
        File for the statistics of the frames read so far, from which a later call goes on.
    progress
        Called with the number of frames read and their total.

    Returns
    -------
    Characterization
        Gain, dark noise, full well, QE, DSNU, PRNU ... of each plane of the mosaic, each with its
        error, and a verdict on the linear model.

    Raises
    ------
    InputError
        If a frame cannot be read, frames do not belong together, or they give no photon transfer.

    Notes
    -----
    EMVA Standard 1288, release 4.0 Linear (2021).

    Examples
    --------
    >>> import chromanoise as cn
    >>> camera = cn.characterize("frames")                          # doctest: +SKIP
    >>> camera.planes[0].gain_dn_per_e, camera.verdict.sentences    # doctest: +SKIP
    """
    source: object = frames[0] if len(frames) == 1 else None
    if not isinstance(source, FrameSet | PhotonTransfer):
        words = [one for one in frames if isinstance(one, str | Path)]
        if len(words) < len(frames) or not words:
            raise InputError(
                "frames",
                "must be a folder, files, or one FrameSet",
                value=[type(one).__name__ for one in frames],
            )
        source = read_source(words)
    if isinstance(source, PhotonTransfer):
        return characterized_table(source)
    sampled = light_sample if resume is None else resumed(Path(resume))
    return characterized(source, sampled=sampled, progress=progress)


def read_source(words: Sequence[Path | str]) -> FrameSet | PhotonTransfer:
    """Frames, or one table of means and variances.

    Parameters
    ----------
    words
        As `chromanoise.io.frames.read_frame_set`, or one table in a form of
        `chromanoise.io.pixels.read_photon_transfer_csv`.

    Raises
    ------
    InputError
        As these readers.
    """
    if len(words) == 1 and is_table(Path(words[0]).expanduser()):
        return read_photon_transfer_csv(Path(words[0]).expanduser())
    return read_frame_set(words)


def is_table(path: Path) -> bool:
    """Whether a file is a table of means and variances, by its ending and its heading."""
    if path.suffix.lower() not in _TABLES or not path.is_file():
        return False
    with path.open("rb") as file:
        return is_photon_transfer_text(file.read(_HEAD_BYTES).decode("utf-8", errors="replace"))


def characterized_table(table: PhotonTransfer) -> Characterization:
    """One plane from a table: without fixed patterns, row noise and correlations.

    Raises
    ------
    InputError
        As `chromanoise.sensor.photon_transfer_fit`.
    """
    fit = photon_transfer_fit(table)
    lit = np.flatnonzero(~table.dark)
    lit = lit[np.argsort(table.mean_dn[lit], kind="stable")]
    levels = [_level_of_table(table, int(row), fit) for row in lit]
    plane = plane_of_fit(fit, name="mono", levels=tuple(levels))
    used = np.abs(fit.residual_z) * fit.fitted
    worst = int(used.argmax())
    sentences = tuple(bend_sentences([plane]))
    return Characterization(
        source=table.source,
        camera="",
        iso=None,
        bits=None,
        mosaic=None,
        planes=(plane,),
        correlation=np.eye(1),
        covariance_dn2=table.variance_dn2[lit][:, None, None],
        verdict=ModelVerdict(
            holds=not sentences,
            chi2_per_level=fit.chi2_per_row,
            worst_level=f"row {worst + 1}",
            worst_z=float(fit.residual_z[worst]),
            sentences=sentences,
        ),
        notes=(f"a table of {lit.size} means and variances: no fixed patterns and no row noise",),
    )


def _level_of_table(table: PhotonTransfer, row: int, fit: TransferFit) -> LevelNoise:
    dark, darkest = _dark(table, row), int(table.mean_dn.argmin())
    base = float(table.mean_dn[darkest]), float(table.variance_dn2[darkest])
    light = {
        name: None if values is None else float(values[row])
        for name, values in (("time_ms", table.time_ms), ("photons_per_pixel", table.photons))
    }
    return level_noise(
        f"row {row + 1}",
        float(table.mean_dn[row]),
        float(table.variance_dn2[row]),
        None if table.samples is None else float(table.samples[row]),
        base if dark is None else dark,
        fit.gain_dn_per_e,
        dark_measured=dark is not None,
        frames=2,
        **light,
        fitted=bool(fit.fitted[row]),
        **dict.fromkeys(("clipped_share", "correlation_right", "correlation_down", "drift_z"), 0.0),
    )


def _dark(table: PhotonTransfer, row: int) -> tuple[float, float] | None:
    """Dark mean and variance of a row: its own columns, the dark of its time, or all darks."""
    if table.dark_mean_dn is not None and table.dark_variance_dn2 is not None:
        return float(table.dark_mean_dn[row]), float(table.dark_variance_dn2[row])
    if not table.dark.any():
        return None
    chosen = table.dark
    if table.time_ms is not None:
        away = np.where(table.dark, np.abs(table.time_ms - table.time_ms[row]), np.inf)
        chosen = away == away.min()
    return float(table.mean_dn[chosen].mean()), float(table.variance_dn2[chosen].mean())
