"""What the raw channels know about spectra, and where a camera loses it."""

from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import pinv, svd
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.operating_point import electrons_at
from chromanoise.analysis.priors import DEFAULT_PRIOR, training_named
from chromanoise.analysis.undefined import plain_fields
from chromanoise.color import ColorMatrix
from chromanoise.color.training import shares
from chromanoise.exposure import OperatingPoint
from chromanoise.metrics import information_bits
from chromanoise.noise import (
    clipping_readout,
    counted_readout,
    demand_independent_channels,
    mean_noise_covariance,
    noise_sources,
    saturated,
)
from chromanoise.noise.gaussian import held_moments
from chromanoise.sensor import Converter
from chromanoise.spectra import Spectra, is_infrared

About = Literal["spectrum", "visible"]
"""Whether infrared electrons are signal, or noise where visible ones do not predict them."""

_KEPT = 1e-10  # singular values of the visible electrons below this share of the largest are 0
_CONSTANT = 1e-20  # share of the variance before clipping below which a reading is constant
_NO_NOISE_E2 = 1e-12  # in place of 0, where it decides only which values are clipped


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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

    name: str
    bits: Float[Array, "*levels"]
    lost_bits: Float[Array, "*levels"]

    def __post_init__(self) -> None:
        _check.freeze(self, "bits", "lost_bits")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
    _check.one_of("information_about", information_about, get_args(About))
    sensor, exposure = point.sensor, point.exposure
    if matrix is not None:
        _check.same_names("color matrix", sensor=sensor.names, matrix=matrix.channels)
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
    noise = noise + _diagonal(step_e**2 / 12 * unclipped)
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
    crosstalk, white_e = analysis.sensor.crosstalk, electrons_at(analysis.point)
    if saturated(white_e, analysis.sensor, analysis.exposure).any():
        return ()
    return tuple(
        information_chain(
            analysis.point,
            analysis.matrix,
            information_about=about,
            clipped=crosstalk is None or crosstalk.stage != "charge",
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


def information_as_json(chain: InformationChain) -> dict[str, Any]:
    """The chain of one light level; an infinite number of bits is ``None``."""
    return {
        **plain_fields(chain, "about", "prior"),
        "steps": [
            {"step": step.name} | plain_fields(step, "bits", "lost_bits") for step in chain.steps
        ],
    }


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
    x = _moment(u, u) + _diagonal(share @ variance)
    scale = np.sqrt(np.diagonal(x, axis1=-2, axis2=-1))
    scale = np.where(scale > 0, scale, 1.0)
    size = scale[..., :, None] * scale[..., None, :]
    x = x / size
    together = (_moment(r, u) + _diagonal(share @ (variance * (each - free)))) / size
    rest = together @ pinv("electrons of the prior", x, hermitian=True)
    left = (_moment(r, r) + _diagonal(own)) / size - rest @ x @ np.swapaxes(rest, -1, -2)
    gain = _diagonal(whole) - rest
    total = np.diagonal(gain @ x @ np.swapaxes(gain, -1, -2) + left, axis1=-2, axis2=-1)
    varies = np.where(total > _CONSTANT, 1.0, 0.0)
    gain = (varies * scale)[..., :, None] * gain / scale[..., None, :]
    left = varies[..., :, None] * (left * size) * varies[..., None, :]
    return gain, left, varies * (share @ free)


def _diagonal(values: Float[Array, "*levels p"]) -> Float[Array, "*levels p p"]:
    return values[..., None] * np.eye(values.shape[-1])
