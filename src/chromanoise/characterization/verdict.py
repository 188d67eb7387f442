"""Whether frames follow the linear model: variance = K mean + dark variance, white in space."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.characterization.lights import Key, clipped_share, key_of, light_changes
from chromanoise.characterization.results import ModelVerdict, PlaneNoise
from chromanoise.characterization.statistics import BAND_PIXELS, LEAST_CLIPPED, SURE_Z, LightSample
from chromanoise.io.frames.frame import FrameLevel, FrameSet

_WIDE_DN2 = 4.0  # above it few pixels share the largest code
_LEAST_BEND = 0.02  # change of the slope over the fit that is worth telling
_LEAST_CORRELATION = 0.01
_LEAST_DRIFT = 1e-3  # of the mean
_LEAST_PIXELS = 20  # of a clipped frame that have the same code
_LEAST_DEVIATION = 0.02  # of the variance


def model_verdict(
    given: FrameSet,
    frames: FrameSet,
    lights: Mapping[Key, LightSample],
    planes: Sequence[PlaneNoise],
    correlation: Float[Array, "p p"],
) -> ModelVerdict:
    """Chi-square of the linear law, and a sentence on each fault that is beyond chance.

    Parameters
    ----------
    given, frames, lights
        All frames, those that were evaluated, and their statistics by the names of the frames.
    planes
        Results of the planes.
    correlation
        Temporal correlation between the planes of a cell.
    """
    z = [_deviations(plane) for plane in planes]
    worst_plane = max(range(len(planes)), key=lambda i: float(np.abs(z[i]).max(initial=0.0)))
    fitted = [level for level in planes[worst_plane].levels if level.fitted]
    worst = int(np.abs(z[worst_plane]).argmax()) if fitted else 0
    sentences = [
        *bend_sentences(planes),
        *_deviating(frames, planes, z),
        *_neighbors(frames, lights, planes),
        *_channels(planes, correlation, _pixels(lights)),
        *_clipped_at_0(given, lights),
        *_lights(frames, lights, planes),
    ]
    return ModelVerdict(
        holds=not sentences,
        chi2_per_level=float(np.mean([plane.fit.chi2_per_row for plane in planes])),
        worst_level=fitted[worst].name if fitted else "",
        worst_z=float(z[worst_plane][worst]) if fitted else 0.0,
        sentences=tuple(sentences),
    )


def _deviations(plane: PlaneNoise) -> Array:
    """Variance minus fit over its standard error, of the levels that were fitted."""
    lit = len(plane.levels)
    return np.asarray(plane.fit.residual_z[:lit][plane.fit.fitted[:lit]])


def bend_sentences(planes: Sequence[PlaneNoise]) -> Iterator[str]:
    """A sentence on each plane whose variance is no straight line over the mean.

    Parameters
    ----------
    planes
        Results of the planes.
    """
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


def _deviating(frames: FrameSet, planes: Sequence[PlaneNoise], z: Sequence[Array]) -> Iterator[str]:
    for plane, own in zip(planes, z, strict=True):
        fitted = [level for level in plane.levels if level.fitted]
        if not own.size or abs(plane.bend_z or 0.0) > SURE_Z:
            continue
        k = int(np.abs(own).argmax())
        level = fitted[k]
        share = level.variance_dn2 / max(level.predicted_variance_dn2, 1e-300) - 1
        if abs(own[k]) > SURE_Z and abs(share) > _LEAST_DEVIATION:
            names = _names(_level(frames, level.name).flats)
            yield (
                f"{plane.name}: the variance of {names} is {100 * share:+.1f} % off the straight "
                f"line ({own[k]:+.1f} standard errors): the light differs between the frames, or "
                "the frames are processed"
            )


def _neighbors(
    frames: FrameSet, lights: Mapping[Key, LightSample], planes: Sequence[PlaneNoise]
) -> Iterator[str]:
    """Correlation of neighbors, at the brightest level that was fitted."""
    for plane in planes:
        fitted = [level for level in plane.levels if level.fitted and level.clipped_share < 0.5]
        if not fitted:
            continue
        level = fitted[-1]
        pixels = _pixels(lights)
        least = max(_LEAST_CORRELATION, SURE_Z / math.sqrt(pixels))
        for where, value in (
            ("in a row", level.correlation_right),
            ("in a column", level.correlation_down),
        ):
            if abs(value) > least:
                yield (
                    f"{plane.name}: the noise of neighbors {where} has a correlation of "
                    f"{value:+.3f} in {_names(_level(frames, level.name).flats)}: the frames are "
                    "denoised, resampled or compressed, or charge spreads between pixels"
                )


def _channels(
    planes: Sequence[PlaneNoise], correlation: Float[Array, "p p"], pixels: int
) -> Iterator[str]:
    least = max(_LEAST_CORRELATION, SURE_Z / math.sqrt(pixels))
    for i, one in enumerate(planes):
        for j in range(i):
            if abs(correlation[i, j]) > least:
                yield (
                    f"{planes[j].name} and {one.name}: the noise of the two planes has a "
                    f"correlation of {correlation[i, j]:+.3f}, but the model assumes independent "
                    "channels"
                )


def _clipped_at_0(frames: FrameSet, lights: Mapping[Key, LightSample]) -> Iterator[str]:
    """Darks and flats that are clipped at code 0."""
    for kind, lost in (("darks", "no darks are used"), ("flats", "these levels are not used")):
        groups = [group for level in frames.levels if (group := getattr(level, kind))]
        shares = {key_of(group): clipped_share(lights[key_of(group)]) for group in groups}
        clipped = [group for group in groups if shares[key_of(group)]]
        if clipped:
            worst = max(clipped, key=lambda group: shares[key_of(group)])
            yield (
                f"up to {100 * shares[key_of(worst)]:.2g} % of the pixels of "
                f"{len({key_of(group) for group in clipped})} sets of {kind} have code 0 "
                f"({worst[0].name}): clipping makes their variance too small, so {lost}"
            )


def _lights(
    frames: FrameSet, lights: Mapping[Key, LightSample], planes: Sequence[PlaneNoise]
) -> Iterator[str]:
    """Light that drifts, and flats that clip."""
    every = light_changes(frames, lights).values()
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
    pixels = _pixels(lights)
    for plane in planes:
        for one in plane.levels:
            many = one.clipped_share * pixels > _LEAST_PIXELS
            clipped = one.clipped_share > LEAST_CLIPPED and many
            if one.fitted and clipped and one.variance_dn2 > _WIDE_DN2:
                yield (
                    f"{plane.name}: {100 * one.clipped_share:.2g} % of the pixels of "
                    f"{_level(frames, one.name).flats[0].name} are at its top code: it is clipped"
                )


def _level(frames: FrameSet, name: str) -> FrameLevel:
    return next(level for level in frames.levels if level.name == name and level.flats)


def _pixels(lights: Mapping[Key, LightSample]) -> int:
    pixels = min(light.planes[0].pixels for light in lights.values())
    return min(pixels, BAND_PIXELS)


def _names(group: Sequence[object]) -> str:
    names = [str(getattr(one, "name", one)) for one in group]
    return names[0] if len(names) == 1 else f"{names[0]} and {names[-1]}"
