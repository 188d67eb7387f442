"""Frames of one scene, merged by their variance; pixels where something moved are rejected."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Float32, Shaped
from chromanoise.denoising.planes import NoisyPlanes
from chromanoise.errors import InputError
from chromanoise.sensor import VarianceLaw

_ROWS = 64  # tested together, to save memory
_LEAST_E2 = 1e-12  # of planes without read noise, at pixels without light


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BurstFrame:
    """Another frame of a burst.

    Attributes
    ----------
    values_e
        Its values, in its own electrons. [e-]
    exposure
        Its exposure over that of the first frame: of times, or of times and gains of the light.
        [1]
    """

    values_e: Float32[Array, "h w p"]
    exposure: float = 1.0

    def __post_init__(self) -> None:
        _check.positive("exposure of a frame", "1", self.exposure)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Burst:
    """Merged frames.

    Attributes
    ----------
    planes
        The merged values, in electrons of the first frame, and their noise where all frames were
        used. Input of any denoising method.
    used
        Share of the weights that was used at each pixel: 1 where all frames agree. 0 where every
        frame is saturated; the values there are those of the first frame.
    frames
        Number of frames.
    """

    planes: NoisyPlanes
    used: Float32[Array, "h w p"]
    frames: int


def merged_frames(
    first: NoisyPlanes,
    others: Iterable[BurstFrame],
    *,
    fixed: VarianceLaw | None = None,
    saturation_e: float | None = None,
    false_alarm: float = 1e-3,
    window_px: int = 3,
) -> Burst:
    """The mean of the frames of a burst, weighted by the inverse of their temporal variance.

    The frames are read in one pass, one in memory at a time: ``others`` may be a generator.

    Parameters
    ----------
    first
        The reference frame and its noise. The result shows the scene as it was in this frame.
    others
        The other frames, with the same pixels; a mosaic as `packed`.
    fixed
        Part of ``first.law`` that is the same in every frame: DSNU^2 and PRNU^2, as
        ``NoiseSources.law("spatial")``; by default only the square.
    saturation_e
        Values of a frame at or above it are not used, in its own electrons. By default there is no
        saturation. [e-]
    false_alarm
        Probability that a frame is rejected at a pixel although nothing moved. [1]
    window_px
        Side of the window, odd, over which the test sums the differences: a larger one detects
        weaker differences, but rejects more of the surroundings. [pixels]

    Raises
    ------
    InputError
        If a frame has another shape or a value that is not finite, the fixed part is larger than
        the law, there is no temporal noise, or a number is out of range.

    Notes
    -----
    Values are divided by the relative exposure t, so their temporal variance at a mean m of the
    first frame is (floor - fixed) / t^2 + slope m / t. The weights are its inverse at
    ``first.prior_mean_e``: weights from the noisy value of a pixel would bias the mean. So the law
    of the result has a closed form. PRNU and DSNU are the same in all frames, so merging does not
    reduce them.

    A frame is tested against the first: the sum over window and planes of the squared difference
    over its variance has a chi-square distribution where nothing moved. It is rejected at a pixel
    above the value of which ``false_alarm`` is the probability. The mean in the variance is that of
    both frames at the pixel; PRNU has no part in a difference. The distribution is that of
    Gaussian noise: at 1 electron and a read noise of 1 electron, 2.8e-3 of the pixels are rejected
    instead of 1e-3 (4 planes, 3 x 3 pixels); at 10 electrons, 1e-3. Where the first frame is
    saturated, no test is possible.

    Weights: Hasinoff, Durand & Freeman, "Noise-optimal capture for high dynamic range photography",
    CVPR (2010).

    Examples
    --------
    >>> one = NoisyPlanes(
    ...     values_e=np.full((3, 3, 1), 98, np.float32), prior_e2=np.eye(1),
    ...     law=VarianceLaw(floor_e2=100.0, slope_e=1.0, square=0.25),
    ...     prior_mean_e=np.array([100.0]), names=("W",))
    >>> both = merged_frames(one, [BurstFrame(values_e=np.full((3, 3, 1), 102, np.float32))])
    >>> both.planes.values_e[0, 0], both.planes.law.coefficients.ravel()
    (array([100.], dtype=float32), array([50.  ,  0.5 ,  0.25]))
    """
    fixed = VarianceLaw(square=first.law.square) if fixed is None else fixed
    fixed = fixed.of_planes(len(first.names))
    temporal = first.law - fixed
    if not (temporal.variance_e2(first.prior_mean_e) > 0).all():
        raise InputError(
            "temporal noise of the planes",
            "must be above 0 at the mean of typical scenes",
            value=0.0,
            remedy="give a read noise above 0",
        )
    _check.within("false_alarm", "1", false_alarm, 1e-12, 0.5)
    if window_px < 1 or window_px % 2 == 0:
        raise InputError("window_px", "must be odd and at least 1 [pixels]", value=window_px)
    test = _Test(
        first=first,
        fixed=fixed,
        temporal=temporal,
        saturation_e=np.inf if saturation_e is None else saturation_e,
        limits=_limits(false_alarm, window_px**2 * len(first.names)),
        window_px=window_px,
    )
    sums = _Sums(test)
    for number, frame in enumerate(chain([BurstFrame(values_e=first.values_e)], others), start=1):
        if frame.values_e.shape != first.values_e.shape:
            raise InputError(
                f"frame {number} of the burst",
                f"must have the {first.values_e.shape} rows, columns and planes of the first",
                value=frame.values_e.shape,
                found=f"has {frame.values_e.shape}",
            )
        _check.finite(f"frame {number} of the burst", "e-", frame.values_e)
        sums.add(frame)
    return sums.burst()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Test:
    """Which values of a frame are used: those not saturated, where the frame agrees."""

    first: NoisyPlanes
    fixed: VarianceLaw
    temporal: VarianceLaw
    saturation_e: float
    limits: Float[Array, " n"]
    window_px: int

    def used(self, frame: BurstFrame, start: int, stop: int) -> Bool[Array, "rows w p"]:
        """Whether each value of the rows ``start`` to ``stop`` is used."""
        before = max(start - self.window_px // 2, 0)
        rows = slice(before, stop + self.window_px // 2)
        own, values = self.first.values_e[rows], frame.values_e[rows]
        usable = values < self.saturation_e
        both = usable & (own < self.saturation_e)
        squares = np.where(both, self._squares(own, values, frame.exposure), 0.0)
        found, count = (_window_sums(one, self.window_px) for one in (squares, both))
        agrees = found <= self.limits[count.round().astype(int)]
        return (usable & agrees[..., None])[start - before : stop - before]

    def _squares(
        self, own: Float32[Array, "h w p"], values: Float32[Array, "h w p"], t: float
    ) -> Float[Array, "h w p"]:
        """Squared difference of a frame from the first one, over its variance. [1]"""
        light = np.maximum((own + values) / (1.0 + t), 0.0)
        offsets = VarianceLaw(floor_e2=self.fixed.floor_e2 * (1.0 / t - 1.0) ** 2)
        law = self.temporal.in_units_of(t) + self.temporal + offsets
        return np.asarray((values / t - own) ** 2 / np.maximum(law.variance_e2(light), _LEAST_E2))


class _Sums:
    """Running sums over the frames of a burst."""

    def __init__(self, test: _Test) -> None:
        self._test, self._frames, self._temporal = test, 0, VarianceLaw()
        self._values, self._used = (np.zeros(test.first.values_e.shape) for _ in range(2))
        # of the weights w at relative exposures t: w, w / t
        self._weights = np.zeros((2, len(test.first.names)))

    def add(self, frame: BurstFrame) -> None:
        """Add a frame where it is used."""
        law = self._test.temporal.in_units_of(frame.exposure)
        w = 1.0 / law.variance_e2(self._test.first.prior_mean_e)
        share = w / frame.exposure
        for start in range(0, len(self._values), _ROWS):
            rows = slice(start, start + _ROWS)
            values = frame.values_e[rows]
            used = self._test.used(frame, start, start + len(values))
            self._values[rows] += np.where(used, values * share, 0.0)
            self._used[rows] += np.where(used, w, 0.0)
        self._weights += (w, share)
        self._temporal += law.scaled(w**2)
        self._frames += 1

    def burst(self) -> Burst:
        """The merged frames."""
        first, (w, share) = self._test.first, self._weights
        values = np.array(first.values_e)
        np.divide(self._values, self._used, out=values, where=self._used > 0, casting="same_kind")
        self._used /= w
        law = self._temporal.scaled(1.0 / w**2) + self._test.fixed.in_units_of(w / share)
        planes = replace(first, values_e=values, law=law)
        return Burst(planes=planes, used=self._used.astype(np.float32), frames=self._frames)


def _window_sums(values: Shaped[Array, "h w p"], window_px: int) -> Float[Array, "h w"]:
    """Sum over the planes and the pixels of a window; beyond the borders are no pixels."""
    from scipy.ndimage import correlate1d

    ones = np.ones(window_px)
    rows = correlate1d(values.sum(axis=-1, dtype=float), ones, axis=0, mode="constant")
    return np.asarray(correlate1d(rows, ones, axis=1, mode="constant"))


def _limits(false_alarm: float, most: int) -> Float[Array, " n"]:
    """The chi-square of which ``false_alarm`` is the probability, for 0 to ``most`` squares."""
    from scipy.special import chdtri

    return np.concatenate([[np.inf], chdtri(np.arange(1, most + 1), false_alarm)])
