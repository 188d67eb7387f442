"""What a machine can tell from raw values: separation, contrast detection and information.

The paper judges a sensor by the noise of luminance, for an eye. A classifier reads raw values: no
invertible matrix costs it anything, and a fourth channel is lost only in three color coordinates.
The results also show the light at which contrast detection is reliable, and where a camera loses
information about spectra.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cache, partial
from typing import ClassVar, Literal, get_args

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    JsonKey,
    JsonKeys,
    check,
    dataclass,
    diagonal,
    matrix_rank,
    pinv,
    svd,
    with_short_repr,
)
from chromanoise.color import ColorMatrix, shares
from chromanoise.metrics import (
    contrast_detection_probability,
    exact_contrast_detection_probability,
    exact_separation_probability,
    gaussian_pair_probabilities,
    independent_coordinates,
    information_bits,
    pair_distances,
    separation_probability,
)
from chromanoise.noise import (
    Measurement,
    OperatingPoint,
    Readout,
    after_counting,
    channel_distribution,
    clipping_readout,
    counted_readout,
    demand_independent_channels,
    few_electrons,
    held_moments,
    mean_noise_covariance,
    noise_sources,
    saturated,
    signal_limit_e,
    with_noise,
)
from chromanoise.sensor import Converter
from chromanoise.spectra import PatchPairs, Spectra, all_pairs, chart_on, chart_title, is_infrared
from chromanoise.study.analysis import Analysis, Stages, electrons_at, stages_at
from chromanoise.study.color_matrices import DEFAULT_PRIOR, training_named

BRIGHT, DARK = 0.18, 0.12
"""Reflectances of the two grays: Weber contrast 0.5."""
TOLERANCE = 0.5
"""The contrast of two readings must be within 50 % of that of the scene."""
TARGET = 0.9
"""Probability at which a contrast counts as detected reliably."""

_MANY_E = 200.0  # of each channel, from which on Y is Gaussian
_LEAST_E = 1e-3  # of the bright gray, where the search for a level starts
_LEVELS = 61
_HALVINGS = 30


@dataclass(frozen=True, kw_only=True, eq=False)
class ContrastDetection:
    """Probability that one pixel shows the contrast of two grays within the tolerance.

    Attributes
    ----------
    channels
        Per raw channel, without clipping: from the exact distribution of few electrons
        (`few_electrons`), unless crosstalk after counting correlates the channels; else for
        Gaussian noise.
    luminance
        Of Y after the color matrix, for Gaussian noise; NaN where a channel has fewer than
        200 electrons of a gray, or Y is not above 0.
    level_lux
        Least illuminance from which on the best raw channel reaches `TARGET`, the time kept; NaN
        if it does not before a channel saturates. [lx]
    """

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("bright_reflectance", lambda _: BRIGHT, text="Of the brighter gray. [1]"),
        JsonKey("dark_reflectance", lambda _: DARK, text="Of the darker gray. [1]"),
        JsonKey("contrast", lambda _: "weber", text="Definition of the contrast."),
        JsonKey("tolerance", lambda _: TOLERANCE, text="Allowed error of the contrast. [1]"),
        "channels",
        "luminance",
        JsonKey("target", lambda _: TARGET, text="Probability of ``target_lux``. [1]"),
        JsonKey("target_lux", "level_lux"),
    )

    channels: dict[str, float]
    luminance: float
    level_lux: float


def contrast_detection_of(analysis: Analysis) -> ContrastDetection | None:
    """Contrast detection at the operating point of an analysis; ``None`` where a gray saturates.

    Parameters
    ----------
    analysis
        With sensor, exposure, light and matrix.
    """
    point = analysis.point
    if saturated(_grays(point)[0], point.sensor, point.exposure).any():
        return None
    channels = _channel_probabilities(point, 1.0)
    return ContrastDetection(
        channels=dict(zip(point.sensor.names, map(float, channels), strict=True)),
        luminance=_of_luminance(analysis),
        level_lux=_least_level(point),
    )


def best_channel_probability(point: OperatingPoint, matrix: ColorMatrix) -> float:
    """Contrast detection of the best raw channel; NaN where a gray saturates."""
    if saturated(_grays(point)[0], point.sensor, point.exposure).any():
        return math.nan
    return float(_channel_probabilities(point, 1.0).max())


def _grays(point: OperatingPoint) -> Float[Array, "2 p"]:
    """Expected electrons of the bright and of the dark gray. [e-]"""
    return np.multiply.outer(np.array([BRIGHT, DARK]), electrons_at(point))


def _channel_probabilities(point: OperatingPoint, times: float) -> Float[Array, " p"]:
    """Of each channel, with ``times`` the light of the point."""
    mean = times * _grays(point)
    sd = np.sqrt(with_noise(mean, point.sensor, point.exposure).variance)
    found = np.zeros(mean.shape[1])
    noise = noise_sources(point.sensor, point.exposure)
    few = few_electrons(mean, noise).all(axis=0)
    if after_counting(point.sensor.crosstalk) is not None:
        few = np.zeros_like(few)
    seen = mean[1] > 0
    many = seen & ~few
    if many.any():
        (bright, dark), (bright_sd, dark_sd) = mean[:, many], sd[:, many]
        found[many] = contrast_detection_probability(
            bright, dark, bright_sd=bright_sd, dark_sd=dark_sd, tolerance=TOLERANCE
        )
    for i in np.flatnonzero(seen & few):
        readings = channel_distribution(mean, int(i), noise)
        found[i] = exact_contrast_detection_probability(readings, mean[:, i], tolerance=TOLERANCE)
    return found


def _of_luminance(analysis: Analysis) -> float:
    reflectance = np.multiply.outer([BRIGHT, DARK], np.ones(analysis.point.illuminant.grid.n))
    color = stages_at(analysis.point, analysis.matrix, reflectance=reflectance).color
    at = color.names.index("Y")
    mean, sd = color.mean[:, [at]], np.sqrt(color.variance[:, [at]])
    many = (_grays(analysis.point) >= _MANY_E).all()
    if not (many and (mean > 0).all() and (sd > 0).all()):
        return math.nan
    found = contrast_detection_probability(
        mean[0], mean[1], bright_sd=sd[0], dark_sd=sd[1], tolerance=TOLERANCE
    )
    return float(found[0])


def _least_level(point: OperatingPoint) -> float:
    """Illuminance above which every level up to saturation reaches the target. [lx]"""
    most_e = float(_grays(point)[0].max())
    limit_e = signal_limit_e(point.sensor, point.exposure)
    if not 0 < most_e < np.inf or limit_e <= _LEAST_E:
        return math.nan

    def reached(times: float) -> bool:
        return bool(_channel_probabilities(point, times).max() >= TARGET)

    steps = np.geomspace(_LEAST_E / most_e, limit_e / most_e, _LEVELS)
    if not reached(steps[-1]):
        return math.nan
    at = _LEVELS - 1
    while at > 0 and reached(steps[at - 1]):
        at -= 1
    if at == 0:
        return float(steps[0] * point.level_lux)
    low, high = np.log(steps[at - 1]), np.log(steps[at])
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if reached(np.exp(middle)) else (middle, high)
    return float(np.exp(high) * point.level_lux)


About = Literal["spectrum", "visible"]
"""Whether infrared electrons are signal, or noise where visible ones do not predict them."""

_KEPT = 1e-10  # singular values of the visible electrons below this share of the largest are 0
_CONSTANT = 1e-20  # share of the variance before clipping below which a reading is constant
_NO_NOISE_E2 = 1e-12  # in place of 0, where it decides only which values are clipped


@dataclass(frozen=True, kw_only=True, eq=False)
class InformationStep:
    """Information after one step of a camera.

    Attributes
    ----------
    name
        ``electrons``, ``clipping``, ``quantization``, ``white balance`` or ``color matrix``.
    bits
        Information of one pixel of all channels. [bit]
    lost_bits
        Information that this step loses, >= 0 but for rounding. [bit]
    """

    KEYS: ClassVar[JsonKeys] = (JsonKey("step", "name"), "bits", "lost_bits")

    name: str
    bits: Float[Array, "*levels"]
    lost_bits: Float[Array, "*levels"]

    def __post_init__(self) -> None:
        check.freeze(self, "bits", "lost_bits")


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class InformationChain:
    """Information about a prior of spectra after each step of a camera (`information_chain`).

    Attributes
    ----------
    point
        Sensor, exposure and light.
    level_lux
        Illuminances of the leading axis of every step; ``None`` for the one level of ``point``.
        [lx]
    about
        ``spectrum``, or ``visible`` where infrared electrons are noise.
    prior
        Source of the reflectances.
    steps
        In the order of the camera.
    """

    KEYS: ClassVar[JsonKeys] = ("about", "prior", "steps")

    point: OperatingPoint
    level_lux: Float[Array, " k"] | None
    about: About
    prior: str
    steps: tuple[InformationStep, ...]

    @property
    def bits(self) -> dict[str, Float[Array, "*levels"]]:
        """Information after each step, by its name. [bit]"""
        return {step.name: step.bits for step in self.steps}


def information_chain(
    point: OperatingPoint,
    matrix: ColorMatrix | None = None,
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
    level_lux: Float[Array, " k"] | None = None,
    information_about: About = "spectrum",
    clipped: bool = True,
) -> InformationChain:
    """Information of the raw channels about a prior of spectra, after each step of a camera.

    Parameters
    ----------
    point
        Sensor, exposure and light.
    matrix
        The color matrix; ``None`` ends the chain before it.
    prior
        A name from `PRIORS`, or reflectances on the grid of the light.
    level_lux
        Illuminances, the leading axis of the result; ``None`` for the level of ``point``. [lx]
    information_about
        ``spectrum``: all electrons are signal. ``visible``: the signal is what the electrons have
        in common with those of the light up to 700 nm; infrared electrons that are no linear
        function of the visible ones are noise.
    clipped
        Whether the values are clipped at black and at the white level.

    Raises
    ------
    InputError
        If the prior or the kind of information is not known, the matrix is not for these channels,
        or values are clipped and crosstalk after counting correlates them.

    Notes
    -----
    Each step has the signal covariance S and the noise covariance N of a linear reader, and the
    information that Gaussian signal and noise of these covariances have (`information_bits`):

    * electrons: S of the expected electrons over the prior; N without quantization, averaged over
      the prior.
    * clipping, at black (0) and at the white level: the reading c of the noisy electrons x is split
      as c = G x + d with G = Cov(c, x) Cov(x)^-1, so that d does not correlate with x (Bussgang
      1952). S becomes G S G^T, and N becomes G N G^T + Cov(d). The distortion d counts as noise
      that is independent of the signal, so information never rises. The moments are those of the
      reflectances of the prior, each with Gaussian noise of its own. Where x is Gaussian, G is the
      share of values that are not clipped, and the result is the information of the best linear
      reader. A Gaussian distribution of the signal is not assumed here, because it contains
      negative light, whose clipping at black would be a loss that no picture has.
    * quantization: step^2 / 12 more noise for values that are not clipped (Widrow & Kollar,
      *Quantization Noise* (2008), section 4). Where the step exceeds the noise, this holds for a
      linear reader only: a reader that uses the probability of each code may know more or less.
    * white balance: one gain per channel, which loses nothing.
    * color matrix: only the row space of the matrix is left.

    J. J. Bussgang, MIT RLE report 216 (1952); Cover & Thomas, *Elements of Information Theory*
    (2006), section 8.5 and 9.4.

    Examples
    --------
    The color matrix reduces four channels to three, and loses the fourth.

    >>> from chromanoise.color import kernel_matrix
    >>> from chromanoise.study import operating_points_of, study_from_data
    >>> study = study_from_data({"sensors": [{"name": "onyx-rgbw"}]}, source="")
    >>> point = operating_points_of(study)[0]                    # 10 lx, illuminant E
    >>> chain = information_chain(point, kernel_matrix(point.sensor, point.exposure))
    >>> [(step.name, round(float(step.lost_bits), 2) + 0.0) for step in chain.steps[1:]]
    [('clipping', 0.0), ('quantization', 0.0), ('white balance', 0.0), ('color matrix', 5.28)]
    >>> round(float(chain.bits["electrons"]), 2)
    11.66
    """
    check.one_of("information_about", information_about, get_args(About))
    sensor, exposure = point.sensor, point.exposure
    if matrix is not None:
        check.same_names("color matrix", sensor=sensor.names, matrix=matrix.channels)
    training = training_named(prior, point.illuminant, point.observer)
    share, rho = shares(training), training.reflectance
    seen = electrons_at(point, level_lux=level_lux, reflectance=rho)
    predicted = known = _deviations(seen, share)
    if information_about == "visible":
        visible_rho = np.where(is_infrared(point.illuminant.grid), 0.0, rho)
        visible = electrons_at(point, reflectance=visible_rho)
        predicted = _projected(known, _deviations(visible, share))
    electrons = replace(sensor, converter=Converter())
    signal = _moment(predicted, predicted)
    noise = mean_noise_covariance(seen, share, electrons, exposure)
    noise = noise + _moment(known - predicted, known - predicted)
    found = [("electrons", information_bits(signal, noise))]
    unclipped = np.ones(len(sensor.names))
    if clipped:
        gain, distortion, unclipped = _clipping(point, seen, share)
        signal, noise = (gain @ s @ np.swapaxes(gain, -1, -2) for s in (signal, noise))
        noise = noise + distortion
        found.append(("clipping", information_bits(signal, noise)))
    step_e = noise_sources(sensor, exposure).step_e
    noise = noise + diagonal(step_e**2 / 12 * unclipped)
    found.append(("quantization", information_bits(signal, noise)))
    white_e = electrons_at(point)
    balance = np.diag(1.0 / np.where(white_e > 0, white_e, 1.0))
    found.append(("white balance", information_bits(signal, noise, balance)))
    if matrix is not None:
        found.append(("color matrix", information_bits(signal, noise, matrix.matrix)))
    before = [found[0][1], *(bits for _, bits in found[:-1])]
    return InformationChain(
        point=point,
        level_lux=level_lux,
        about=information_about,
        prior=training.source,
        steps=tuple(
            InformationStep(name=name, bits=bits, lost_bits=_lost(last, bits))
            for (name, bits), last in zip(found, before, strict=True)
        ),
    )


def information_chains(analysis: Analysis) -> tuple[InformationChain, ...]:
    """The chain about the whole spectrum and about its visible part, at one operating point.

    Values are clipped, unless crosstalk after counting correlates them. Empty where a channel is
    saturated on the white.

    Parameters
    ----------
    analysis
        With sensor, exposure, light and matrix.
    """
    white_e = electrons_at(analysis.point)
    if saturated(white_e, analysis.sensor, analysis.exposure).any():
        return ()
    return tuple(
        information_chain(
            analysis.point,
            analysis.matrix,
            information_about=about,
            clipped=after_counting(analysis.sensor.crosstalk) is None,
        )
        for about in get_args(About)
    )


def raw_information(point: OperatingPoint, level_lux: Float[Array, " k"] | None = None) -> Array:
    """Information of the raw values about the whole spectrum, without clipping. [bit]

    Parameters
    ----------
    point, level_lux
        As `information_chain`.
    """
    return information_chain(point, level_lux=level_lux, clipped=False).bits["white balance"]


def _lost(before: Array, after: Array) -> Float[Array, "*levels"]:
    """The difference; 0 where both are infinite."""
    endless = np.isposinf(before) & np.isposinf(after)
    return np.asarray(np.where(endless, 0.0, before - np.where(endless, 0.0, after)))


def _deviations(values: Float[Array, "*levels k p"], share: Array) -> Float[Array, "*levels k p"]:
    """Distance from the mean of the set, times the root of the share of each member."""
    mean = share @ values
    return np.asarray(np.sqrt(share)[:, None] * (values - mean[..., None, :]))


def _moment(a: Float[Array, "*levels k p"], b: Float[Array, "*levels k q"]) -> Array:
    return np.swapaxes(a, -1, -2) @ b


def _projected(
    values: Float[Array, "*levels k p"], onto: Float[Array, "k q"]
) -> Float[Array, "*levels k p"]:
    """The part of the columns that is a linear function of other columns."""
    length = np.linalg.norm(onto, axis=0)
    columns, singular, _ = svd(
        "visible electrons of the prior",
        onto / np.where(length > 0, length, 1.0),
        full_matrices=False,
    )
    kept = columns[:, singular > _KEPT * singular.max(initial=0.0)]
    return np.asarray(kept @ (kept.T @ values))


def _clipping(
    point: OperatingPoint, seen: Float[Array, "*levels k p"], share: Float[Array, " k"]
) -> tuple[Float[Array, "*levels p p"], Float[Array, "*levels p p"], Float[Array, "*levels p"]]:
    """Gain of the noisy electrons, covariance of what is left [e-^2], share of unclipped values.

    A reading that is constant, because all its values are clipped, has gain 0.
    """
    demand_independent_channels(point.sensor)
    sources = replace(noise_sources(point.sensor, point.exposure), step_e=0.0)
    _, bounds = counted_readout(seen, sources, clipping_readout(point.sensor, point.exposure))
    variance = sources.variance_e2(seen)
    held = held_moments(
        seen.ravel(),
        read_noise_e=np.sqrt(np.where(variance > 0, variance, _NO_NOISE_E2)).ravel(),
        black_e=bounds.black_e - sources.black_error_e,
        full_well_e=bounds.full_well_e - sources.black_error_e,
    )
    reading, spread, black, full = held.reshape(4, *seen.shape)
    free = 1.0 - black - full
    # c = whole x - r: r is small in a channel that is rarely clipped, and in one that always is
    whole = np.where(share @ free > 0.5, 1.0, 0.0)
    each = whole[..., None, :]
    u, r = _deviations(seen, share), _deviations(each * seen - reading, share)
    own = share @ np.maximum(each * variance * (1.0 - 2.0 * free) + spread * (variance > 0), 0.0)
    x = _moment(u, u) + diagonal(share @ variance)
    scale = np.sqrt(np.diagonal(x, axis1=-2, axis2=-1))
    scale = np.where(scale > 0, scale, 1.0)
    size = scale[..., :, None] * scale[..., None, :]
    x = x / size
    together = (_moment(r, u) + diagonal(share @ (variance * (each - free)))) / size
    rest = together @ pinv("electrons of the prior", x, hermitian=True)
    left = (_moment(r, r) + diagonal(own)) / size - rest @ x @ np.swapaxes(rest, -1, -2)
    gain = diagonal(whole) - rest
    total = np.diagonal(gain @ x @ np.swapaxes(gain, -1, -2) + left, axis1=-2, axis2=-1)
    varies = np.where(total > _CONSTANT, 1.0, 0.0)
    gain = (varies * scale)[..., :, None] * gain / scale[..., None, :]
    left = varies[..., :, None] * (left * size) * varies[..., None, :]
    return gain, left, varies * (share @ free)


RAW, COLOR = "raw", "color"
RAW_WITHOUT, COLOR_WITHOUT = "raw_without_brightness", "color_without_brightness"
READINGS = (RAW, COLOR, RAW_WITHOUT, COLOR_WITHOUT)
"""What a machine reads: raw values or color coordinates, and whether brightness is evidence."""
NEAR_CHANCE = 0.6
"""Below this probability of the right answer a reader decides nearly by chance, which is 0.5."""


_OF_PAIRS = (
    ("distance", "", "Distance D_M of"),
    ("probability", "_probability", "Share of readings classified correctly for"),
)


def _pair_keys(
    start: str, pair: str, of: "Callable[[Separation, Array], float]"
) -> tuple[JsonKey, ...]:
    """Distance and probability of a pair for each reading; ``of`` takes it from those of all."""

    def value(one: "Separation", field: str, reading: str) -> float:
        return of(one, getattr(one, field)[reading])

    return tuple(
        JsonKey(
            f"{start}{reading}{end}",
            partial(value, field=field, reading=reading),
            text=f"{what} {pair}. [1]",
        )
        for reading in READINGS
        for field, end, what in _OF_PAIRS
    )


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
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

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("of", "title"),
        JsonKey("pairs", lambda one: len(one.pairs.indices), text="Number of pairs."),
        *_pair_keys("median_", "the median pair", lambda _, of_all: float(np.median(of_all))),
        JsonKey(
            "worst_pair",
            ".",
            keys=(
                JsonKey("names", lambda one: one.pairs.names[one.worst], text="Its two patches."),
                *_pair_keys("", "the pair", lambda one, of_all: of_all[one.worst]),
            ),
        ),
    )

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
    at = _patches_at(analysis, pairs)
    if at.saturated.any():
        return None
    distance = {name: _distance(at, pairs, name) for name in READINGS}
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
    title = chart_title(point.chart) if point.pairs is None else pairs.patches.source
    return Separation(pairs=pairs, title=title, distance=distance, probability=probability)


def _patches_at(analysis: Analysis, pairs: PatchPairs) -> Stages:
    """The patches of the pairs, as they are read."""
    return stages_at(
        analysis.point,
        analysis.matrix,
        reflectance=pairs.patches.values.T,
        readout=analysis.readout,
    )


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
    level_lux, lux_per_e
        As `stages_at`.
    """
    check.one_of("reading", reading, READINGS)
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


@dataclass(frozen=True, kw_only=True)
class PairOutcome:
    """How well one pair of patches is separated.

    Attributes
    ----------
    names
        Names of the two patches; ``None`` for the median of all pairs.
    distance
        D_M. [1]
    """

    names: tuple[str, str] | None
    distance: float
    _probability: Callable[[], float] = field(repr=False, compare=False)

    @property
    def probability(self) -> float:
        """Probability that an ideal reader names the right patch; computed where it is read."""
        return self._probability()

    @property
    def near_chance(self) -> bool:
        """Whether the probability is below `NEAR_CHANCE`."""
        return self.probability < NEAR_CHANCE


@dataclass(frozen=True, kw_only=True)
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

    Much faster than `separation_of`: only probabilities of these pairs are computed, on demand.

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
    at = _patches_at(analysis, pairs)
    if at.saturated.any():
        return None
    return {reading: _outcome(at, pairs, reading) for reading in (RAW, RAW_WITHOUT)}


def _outcome(at: Stages, pairs: PatchPairs, reading: str) -> RawOutcome:
    distance = _distance(at, pairs, reading)
    order = np.argsort(distance, kind="stable")
    middle = order[(len(order) - 1) // 2 : len(order) // 2 + 1]
    few = np.append(order[:1], middle)

    @cache
    def probability() -> Float[Array, " m"]:
        found = _raw_probabilities(at, replace(pairs, indices=pairs.indices[few]))
        if reading == RAW_WITHOUT:
            found = np.minimum(found, separation_probability(distance[few]))
        return found

    first, second = (pairs.patches.names[k] for k in pairs.indices[order[0]])
    return RawOutcome(
        median=PairOutcome(
            names=None,
            distance=float(distance[middle].mean()),  # `np.median` would import numpy.ma
            _probability=lambda: float(probability()[1:].mean()),
        ),
        worst=PairOutcome(
            names=(first, second),
            distance=float(distance[order[0]]),
            _probability=lambda: float(probability()[0]),
        ),
    )


def pairs_of(point: OperatingPoint) -> PatchPairs:
    """The pairs of an operating point; without them all pairs of its chart."""
    if point.pairs is not None:
        return point.pairs
    return all_pairs(chart_on(point.illuminant.grid, point.chart))


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
    noise = noise_sources(at.point.sensor, at.point.exposure)
    few = np.asarray(few_electrons(at.expected_e, noise).all(axis=-1))
    exact = np.asarray(few[pairs.indices].all(axis=1))
    if after_counting(at.point.sensor.crosstalk) is not None:
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


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class MachineReading:
    """What a machine can know from the raw values of one sensor.

    Attributes
    ----------
    separation, contrast
        ``None`` where a patch or a gray saturates a channel.
    information
        About the whole spectrum of the default prior, then about its visible part; empty where a
        channel is saturated on the white.
    """

    KEYS: ClassVar[JsonKeys] = (
        "separation",
        JsonKey("contrast_detection", "contrast"),
        "information",
    )

    label: str
    separation: Separation | None
    contrast: ContrastDetection | None
    information: tuple[InformationChain, ...]


def machine_reading(analysis: Analysis) -> MachineReading:
    """Separation, contrast detection and information at the operating point of an analysis.

    Parameters
    ----------
    analysis
        With sensor, exposure, light, matrix and pairs.

    Raises
    ------
    InputError
        As `separation_of`.
    """
    return MachineReading(
        label=analysis.sensor.label,
        separation=separation_of(analysis),
        contrast=contrast_detection_of(analysis),
        information=information_chains(analysis),
    )
