"""What a machine can tell apart: distances of pairs of patches in raw values and after the matrix.

The paper judges a sensor by the noise of luminance, for an eye. A classifier reads raw values: no
invertible matrix costs it anything, and a fourth channel is lost only in three color coordinates.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import matrix_rank
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.operating_point import Stages, stages_at
from chromanoise.analysis.undefined import defined
from chromanoise.color import ColorMatrix
from chromanoise.exposure import OperatingPoint
from chromanoise.metrics import (
    exact_separation_probability,
    gaussian_pair_probabilities,
    independent_coordinates,
    pair_distances,
    separation_probability,
)
from chromanoise.noise import (
    Measurement,
    Readout,
    channel_distribution,
    few_electrons,
    noise_sources,
)
from chromanoise.spectra import PatchPairs, all_pairs, chart_on, chart_title

RAW, COLOR = "raw", "color"
RAW_WITHOUT, COLOR_WITHOUT = "raw_without_brightness", "color_without_brightness"
READINGS = (RAW, COLOR, RAW_WITHOUT, COLOR_WITHOUT)
"""What a machine reads: raw values or color coordinates, and whether brightness is evidence."""
NEAR_CHANCE = 0.6
"""Below this probability of the right answer a reader decides nearly by chance, which is 0.5."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Separation:
    """Distance and separation probability of each pair of patches, for an ideal reader.

    Attributes
    ----------
    pairs
        The patches and their pairs.
    title
        The patches in words.
    distance
        D_M per reading of `READINGS` and pair. [1]
    probability
        Probability that an ideal reader names the right one of two equally frequent patches. Raw
        values: from the exact distribution of few electrons (`few_electrons`), unless crosstalk
        after counting correlates the channels; else for Gaussian noise with the covariance of each
        patch. Color: that of raw values if the matrix is invertible, else for Gaussian noise, and
        at most that of raw values. Without brightness: Phi(D_M / 2), and at most that with it.
    """

    pairs: PatchPairs
    title: str
    distance: Mapping[str, Float[Array, " m"]]
    probability: Mapping[str, Float[Array, " m"]]

    def median_distance(self, reading: str) -> float:
        """Median D_M of the pairs for a reading of `READINGS`. [1]"""
        return float(np.median(self.distance[reading]))

    def median_probability(self, reading: str) -> float:
        """Median separation probability of the pairs for a reading of `READINGS`."""
        return float(np.median(self.probability[reading]))

    @property
    def worst(self) -> int:
        """Index of the pair with the least distance in raw values."""
        return int(np.argmin(self.distance[RAW]))


def separation_of(analysis: Analysis) -> Separation | None:
    """Separation of the pairs under the light and exposure of an analysis.

    Parameters
    ----------
    analysis
        The analysis, with its pairs; without them all pairs of its chart.

    Returns
    -------
    Separation or None
        ``None`` where a patch saturates a channel.

    Raises
    ------
    InputError
        If the reflectances do not cover the grid.
    """
    point, pairs = analysis.point, pairs_of(analysis.point)
    patches = pairs.patches
    at = stages_at(point, analysis.matrix, reflectance=patches.values.T, readout=analysis.readout)
    if at.saturated.any():
        return None
    distance = _distances(at, pairs)
    probability = {name: separation_probability(distance[name]) for name in READINGS}
    probability[RAW] = _raw_probabilities(at, pairs)
    if matrix_rank("the color matrix", analysis.matrix.matrix) == len(at.raw.names):
        probability[COLOR] = probability[RAW]  # an invertible matrix changes nothing
    else:
        gaussian = gaussian_pair_probabilities(_color(at), pairs.indices)
        # no matrix adds evidence; variances of few electrons would, if they were Gaussian
        probability[COLOR] = np.minimum(gaussian, probability[RAW])
    for without, reading in ((RAW_WITHOUT, RAW), (COLOR_WITHOUT, COLOR)):
        probability[without] = np.minimum(probability[without], probability[reading])
    title = chart_title(point.chart) if point.pairs is None else patches.source
    return Separation(pairs=pairs, title=title, distance=distance, probability=probability)


def median_distances(
    point: OperatingPoint,
    matrix: ColorMatrix,
    reading: str,
    *,
    level_lux: Float[Array, " k"] | None = None,
    lux_per_e: Float[Array, "k c p"] | None = None,
) -> Float[Array, "*lv"]:
    """Median D_M of the pairs at many light levels; NaN where a patch saturates a channel. [1]

    Parameters
    ----------
    point, matrix
        Sensor, exposure and light; the color matrix.
    reading
        One of `READINGS`.
    level_lux, lux_per_e
        As `stages_at`.
    """
    _check.one_of("reading", reading, READINGS)
    pairs = pairs_of(point)
    at = stages_at(
        point,
        matrix,
        level_lux=level_lux,
        reflectance=pairs.patches.values.T,
        lux_per_e=lux_per_e if reading in (COLOR, COLOR_WITHOUT) else None,
    )
    found = _distance(at, pairs, reading)
    return np.where(at.saturated.any(axis=(-1, -2)), np.nan, np.median(found, axis=-1))


@dataclass(frozen=True, slots=True, kw_only=True)
class PairOutcome:
    """How well one pair of patches is separated.

    Attributes
    ----------
    names
        Names of the two patches; ``None`` for the median of all pairs.
    distance
        D_M. [1]
    probability
        Probability that an ideal reader names the right patch.
    """

    names: tuple[str, str] | None
    distance: float
    probability: float

    @property
    def near_chance(self) -> bool:
        """Whether the probability is below `NEAR_CHANCE`."""
        return self.probability < NEAR_CHANCE


@dataclass(frozen=True, slots=True, kw_only=True)
class RawOutcome:
    """The median and the worst pair for one entry of `READINGS`.

    Attributes
    ----------
    median
        Median distance, with the probability of the pair (or two pairs) in the middle.
    worst
        The pair with the least distance.
    """

    median: PairOutcome
    worst: PairOutcome


def raw_outcomes(analysis: Analysis) -> dict[str, RawOutcome] | None:
    """Median and worst pair in raw values, with brightness (`RAW`) and without (`RAW_WITHOUT`).

    Much faster than `separation_of`: only the probabilities of these pairs are computed.

    Parameters
    ----------
    analysis
        As `separation_of`.

    Returns
    -------
    dict or None
        ``None`` where a patch saturates a channel.
    """
    pairs = pairs_of(analysis.point)
    at = stages_at(
        analysis.point,
        analysis.matrix,
        reflectance=pairs.patches.values.T,
        readout=analysis.readout,
    )
    if at.saturated.any():
        return None
    return {reading: _outcome(at, pairs, reading) for reading in (RAW, RAW_WITHOUT)}


def _outcome(at: Stages, pairs: PatchPairs, reading: str) -> RawOutcome:
    distance = _distance(at, pairs, reading)
    order = np.argsort(distance, kind="stable")
    middle = order[(len(order) - 1) // 2 : len(order) // 2 + 1]
    few = np.append(order[:1], middle)
    probability = _raw_probabilities(at, replace(pairs, indices=pairs.indices[few]))
    if reading == RAW_WITHOUT:
        probability = np.minimum(probability, separation_probability(distance[few]))
    first, second = pairs.names[order[0]]
    return RawOutcome(
        median=PairOutcome(
            names=None,
            distance=float(np.median(distance)),
            probability=float(probability[1:].mean()),
        ),
        worst=PairOutcome(
            names=(first, second),
            distance=float(distance[order[0]]),
            probability=float(probability[0]),
        ),
    )


def pairs_of(point: OperatingPoint) -> PatchPairs:
    """The pairs of an operating point; without them all pairs of its chart."""
    if point.pairs is not None:
        return point.pairs
    return all_pairs(chart_on(point.illuminant.grid, point.chart))


def _distances(at: Stages, pairs: PatchPairs) -> dict[str, Float[Array, "*lv m"]]:
    return {name: _distance(at, pairs, name) for name in READINGS}


def _distance(at: Stages, pairs: PatchPairs, reading: str) -> Float[Array, "*lv m"]:
    patches = at.raw if reading in (RAW, RAW_WITHOUT) else _color(at)
    return pair_distances(patches, pairs.indices, brightness=reading in (RAW, COLOR))


def _color(at: Stages) -> Measurement:
    """What the matrix leaves; the color itself where each level has a matrix of its own."""
    if at.lux_per_e is not None:
        invertible = matrix_rank("the color matrices", at.lux_per_e) == len(at.raw.names)
        return at.raw if np.all(invertible) else at.color
    return independent_coordinates(at.raw, at.matrix.matrix)


def _raw_probabilities(at: Stages, pairs: PatchPairs) -> Float[Array, " m"]:
    """From the exact distribution where both patches have few electrons in all channels."""
    crosstalk = at.point.sensor.crosstalk
    noise = noise_sources(at.point.sensor, at.point.exposure)
    few = np.asarray(few_electrons(at.expected_e, noise).all(axis=-1))
    exact = np.asarray(few[pairs.indices].all(axis=1))
    if crosstalk is not None and crosstalk.stage == "charge":
        exact[:] = False
    found = np.empty(len(exact))
    if not exact.all():
        found[~exact] = gaussian_pair_probabilities(at.raw, pairs.indices[~exact])
    if exact.any():
        own, place = np.unique(pairs.indices[exact], return_inverse=True)
        channels = [
            channel_distribution(at.expected_e[own], i, noise, at.readout or Readout())
            for i in range(len(at.raw.names))
        ]
        found[exact] = exact_separation_probability(channels, place.reshape(-1, 2))
    return found


def separation_as_json(separation: Separation | None) -> dict[str, Any] | None:
    """The medians with their probabilities, and the worst pair; ``None`` where saturated."""
    if separation is None:
        return None
    found: dict[str, Any] = {"of": separation.title, "pairs": len(separation.pairs.indices)}
    for name in READINGS:
        found[f"median_{name}"] = defined(separation.median_distance(name))
        found[f"median_{name}_probability"] = separation.median_probability(name)
    worst = separation.worst
    found["worst_pair"] = {"names": list(separation.pairs.names[worst])}
    for name in READINGS:
        found["worst_pair"][name] = defined(float(separation.distance[name][worst]))
        found["worst_pair"][f"{name}_probability"] = float(separation.probability[name][worst])
    return found
