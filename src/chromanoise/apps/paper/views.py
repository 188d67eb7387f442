"""The planes of two channels that the paper's Figures 3, 4, 6, 9 and 10 show.

The paper draws these planes by hand. Here they are computed: lengths and angles are those of the
n-dimensional vectors, and only the noise, too small to be seen, is magnified. `paper_planes`
chooses the channels and the magnification of each figure.
"""

from itertools import combinations

import numpy as np

from chromanoise.apps.paper.printed_numbers import RGB_59, RGBW_12, PaperStudy
from chromanoise.base import Array, Float, InputError, dataclass, eigvalsh, one_of, stream
from chromanoise.geometry import PlaneView, ellipse_outline, plane_view
from chromanoise.noise import Measurement, sample_electrons, through
from chromanoise.sensor import with_channels
from chromanoise.spectra import color_axes, light
from chromanoise.study import Analysis, analyzed, color_snr_db

DRAWS = 400
"""Acquisitions that are sampled for a cloud."""
SIGMAS = 2.0
"""Size of the ellipse of uncertainty, in standard deviations (Mahalanobis)."""

_STREAM = 3469  # a name that no other stream of a study begins with
_PARALLEL_DEG = 1e-6
_ARROW_SHARE = 0.3  # of |L^|: short enough that everything else on the axes lies beyond it
_AXIS_NAMES = ("x", "y", "z")
_ENDS = np.array([[-1.0], [1.0]])
_CORNERS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


@dataclass(frozen=True, kw_only=True, eq=False)
class ColorAxis:
    """One color axis, projected into the plane of two channels.

    Attributes
    ----------
    name
        x, y or z.
    direction
        Of its projection, length 1.
    length
        Of its projection. [lx per unit of light]
    tilt_deg
        Angle between the axis and the plane. [deg]
    share
        cos^2 of the tilt: the share of the axis's squared length that lies in the plane.
    foot
        Orthogonal projection of L^ on the axis; its distance times ``length`` is the color.
    color, color_snr_db
        The two-channel sensor's own color coordinate, and its SNR in closed form; ``None`` where
        a channel is saturated. [lx], [dB]
    """

    name: str
    direction: Float[Array, " 2"]
    length: float
    tilt_deg: float
    share: float
    foot: Float[Array, " 2"]
    color: float
    color_snr_db: float | None


@dataclass(frozen=True, kw_only=True, eq=False)
class ChannelPlane:
    """Two channels, the light and a color axis, in the true plane of the two channels.

    All points are in the unit of the light, in the coordinates of ``view``; where two vectors
    are held, they are rows.

    Attributes
    ----------
    sensor_name
        The sensor that the channels are taken from.
    two
        The analysis of the sensor that has these two channels only.
    view
        The plane; its ``vectors`` are f_1 and f_2 themselves.
    angle_deg
        Between the two channels. [deg]
    arrows
        f_1 and f_2 times one common factor, for they are in another unit than the light: the
        longer comes out at three tenths of L^.
    measured
        L^ and its covariance in closed form.
    light_length, light_tilt_deg
        |L|, and the angle between L and the plane. [unit of light], [deg]
    feet
        Orthogonal projections of L on the axes of f_1 and f_2: the covariant measurement.
    parts
        M^1 f_1 and M^2 f_2, which add up to L^ (eq. 4).
    duals
        f^1 and f^2, the dual basis.
    cloud
        L^ of sampled acquisitions.
    """

    sensor_name: str
    two: Analysis
    view: PlaneView
    angle_deg: float
    arrows: Float[Array, "2 2"]
    measured: Measurement
    light_length: float
    light_tilt_deg: float
    feet: Float[Array, "2 2"]
    parts: Float[Array, "2 2"]
    duals: Float[Array, "2 2"]
    axis: ColorAxis
    cloud: Float[Array, "draws 2"]

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the two channels."""
        return self.two.sensor.names


@dataclass(frozen=True, kw_only=True, eq=False)
class MagnifiedNoise:
    """The noise of a plane, drawn ``magnification`` times larger around its mean.

    Attributes
    ----------
    magnification
        Deviation drawn over true deviation.
    sigmas
        Standard deviations that the outlines and bars stand for.
    cloud
        Sampled acquisitions.
    outline
        The ellipse of uncertainty, in closed form.
    locus
        Corners of the zone that the uncertainty of the two measurement axes leaves open: the
        gray area of the paper's Figure 9. The ellipse touches its four sides.
    feet_bars
        Ends of the interval on each channel's axis, around its foot.
    axis_bar
        Ends of the interval on the color axis, around its foot.
    axis_touch
        Points of the outline whose projections are these ends.
    """

    magnification: float
    sigmas: float
    cloud: Float[Array, "draws 2"]
    outline: Float[Array, "points 2"]
    locus: Float[Array, "4 2"]
    feet_bars: Float[Array, "2 2 2"]
    axis_bar: Float[Array, "2 2"]
    axis_touch: Float[Array, "2 2"]


def channel_plane(
    analysis: Analysis,
    channels: tuple[str, str],
    *,
    axis: str = "y",
    draws: int = DRAWS,
    seed: int = 0,
) -> ChannelPlane:
    """The plane of two channels, taken as a sensor of their own.

    Parameters
    ----------
    analysis
        Whose sensor, scene, exposure, metric and observer are taken.
    channels
        Two of its channels; the first is drawn to the right.
    axis
        The color axis x, y or z.
    draws, seed
        Of the sampled acquisitions.

    Raises
    ------
    InputError
        If the sensor has no such channels, or they are parallel or see none of the light.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), Figures 3, 4, 6, 9 and 10.
    """
    column = _AXIS_NAMES.index(one_of("axis", axis, _AXIS_NAMES))
    name = f"{', '.join(channels)} of {analysis.sensor.name}"
    sensor = with_channels(analysis.sensor, channels, name=name)
    own = analysis.matrix
    two = analyzed(analysis.scene, sensor, analysis.exposure, own.metric, observer=own.observer)
    _refuse_no_plane(two)
    frame = two.matrix.frame
    view = plane_view(frame.basis[:, 0], frame.basis[:, 1])
    to_plane = view.axes.T @ frame.dual
    measured = through(
        two.raw,
        to_plane,
        names=("along f_1", "across f_1"),
        kind="spectral",
        unit="units of light",
        metric=two.matrix.metric,
    )
    whole_light = light(two.scene, frame.metric)
    lengths = np.linalg.norm(view.vectors, axis=0)
    electrons = sample_electrons(
        np.broadcast_to(two.raw.mean, (draws, 2)), sensor.pixel, stream(seed, _STREAM)
    )
    return ChannelPlane(
        sensor_name=analysis.sensor.name,
        two=two,
        view=view,
        angle_deg=float(two.between_deg[0, 1]),
        arrows=_ARROW_SHARE * np.linalg.norm(measured.mean) / lengths.max() * view.vectors.T,
        measured=measured,
        light_length=float(np.linalg.norm(whole_light)),
        light_tilt_deg=_tilt_deg(whole_light, view),
        feet=(two.raw.mean / lengths**2 * view.vectors).T,
        parts=(two.contravariant.mean * view.vectors).T,
        duals=to_plane.T,
        axis=_color_axis(two, view, measured, column),
        cloud=electrons @ to_plane.T,
    )


def fitting_magnification(*planes: ChannelPlane, span: float = 0.25) -> float:
    """The round number (1, 2, 5, 10, ...) that makes the noise visible, one for all planes.

    Parameters
    ----------
    planes
        The geometric mean of their ellipses, each compared with its L^, decides.
    span
        What the long diameter should be, as a share of |L^|.
    """
    diameters = [
        2
        * SIGMAS
        * np.sqrt(eigvalsh("covariance in a plane", plane.measured.covariance)[-1])
        / np.linalg.norm(plane.measured.mean)
        for plane in planes
    ]
    return _rounded(span / float(np.exp(np.mean(np.log(diameters)))))


def magnified_noise(plane: ChannelPlane, magnification: float) -> MagnifiedNoise:
    """The noise of ``plane``, drawn larger: its cloud, ellipse, locus and intervals."""
    center, covariance = plane.measured.mean, plane.measured.covariance
    reach = magnification * SIGMAS
    raw_sd = np.sqrt(plane.two.raw.variance)
    vectors = plane.view.vectors.T
    sides = reach * raw_sd[:, None] * plane.duals
    half_feet = reach * (raw_sd / (vectors**2).sum(axis=1))[:, None] * vectors
    toward = plane.axis.direction
    axis_sd = float(np.sqrt(toward @ covariance @ toward))
    return MagnifiedNoise(
        magnification=magnification,
        sigmas=SIGMAS,
        cloud=center + magnification * (plane.cloud - center),
        outline=ellipse_outline(center, magnification**2 * covariance, sigmas=SIGMAS),
        locus=center + _CORNERS @ sides,
        feet_bars=plane.feet[:, None, :] + _ENDS * half_feet[:, None, :],
        axis_bar=plane.axis.foot + _ENDS * (reach * axis_sd * toward),
        axis_touch=center + _ENDS * (reach / axis_sd * covariance @ toward),
    )


def widest_pair(analysis: Analysis) -> tuple[str, str]:
    """The two channels with the largest angle between them."""
    return max(_pairs(analysis))[1]


def narrowest_pair(analysis: Analysis) -> tuple[str, str]:
    """The two channels with the smallest angle between them."""
    return min(_pairs(analysis))[1]


def _pairs(analysis: Analysis) -> list[tuple[float, tuple[str, str]]]:
    """Every pair of channels with its angle."""
    return [
        (float(analysis.between_deg[i, j]), (first, second))
        for (i, first), (j, second) in combinations(enumerate(analysis.sensor.names), 2)
    ]


def _refuse_no_plane(two: Analysis) -> None:
    first, second = two.sensor.names
    if two.matrix.frame.rank < 2 or two.between_deg[0, 1] < _PARALLEL_DEG:
        raise InputError(
            f"channels {first} and {second}",
            "must differ in direction to span a plane",
            found="have the same direction",
            remedy="choose two that differ",
        )
    for name, mean in zip(two.sensor.names, two.raw.mean, strict=True):
        if not mean > 0:
            raise InputError(
                f"channel {name}", "must see some of this light", value=0.0, found="sees none"
            )


def _color_axis(two: Analysis, view: PlaneView, measured: Measurement, column: int) -> ColorAxis:
    axis = color_axes(two.sensor.grid, two.matrix.metric, two.matrix.observer)[:, column]
    seen = view.seen(axis)
    length = float(np.linalg.norm(seen))
    if not length > 0:
        raise InputError(
            f"channels of {two.sensor.name}",
            f"must see part of the color axis {_AXIS_NAMES[column]}",
            found="their plane is perpendicular to it",
        )
    direction = seen / length
    color = two.color.mean[column]
    return ColorAxis(
        name=_AXIS_NAMES[column],
        direction=direction,
        length=length,
        tilt_deg=_tilt_deg(axis, view),
        share=float((length / np.linalg.norm(axis)) ** 2),
        foot=(measured.mean @ direction) * direction,
        color=float(color),
        color_snr_db=color_snr_db(two)[two.color.names[column]],
    )


def _tilt_deg(vector: Float[Array, " n"], view: PlaneView) -> float:
    """Angle between a vector and the plane, from both its parts: accurate at both ends."""
    inside = view.seen(vector)
    outside = vector - view.axes @ inside
    return float(np.degrees(np.arctan2(np.linalg.norm(outside), np.linalg.norm(inside))))


def _rounded(value: float) -> float:
    """The nearest of 1, 2, 5, 10, 20, 50 ..., by ratio; never below 1."""
    decade = 10.0 ** np.floor(np.log10(value))
    nearest = min((1.0, 2.0, 5.0, 10.0), key=lambda digit: abs(np.log(value / (digit * decade))))
    return float(max(1.0, nearest * decade))


_PAIR = ("R", "G")  # of the RGB sensor, in Figures 3, 4 and 6
_PAIR_FAR_FROM_Y = ("G", "R")  # of the RGBW sensor, in Figure 10
_PAIR_NEAR_Y = ("G", "R")  # of the RGB sensor, in Figure 10

NoisyPlane = tuple[ChannelPlane, MagnifiedNoise]


@dataclass(frozen=True, kw_only=True)
class PaperPlanes:
    """The planes of Figures 3, 4, 6, 9 and 10, each sensor at its own saturation.

    Attributes
    ----------
    measurement
        Red and green behind the IR-cut: Figures 3, 4 and 6.
    correlation
        The widest pair of RGB and the narrowest of RGBW, with one magnification: Figure 9.
    color_axis
        A pair far from y and a pair near it, with one magnification: Figure 10.
    """

    measurement: ChannelPlane
    correlation: tuple[NoisyPlane, NoisyPlane]
    color_axis: tuple[NoisyPlane, NoisyPlane]


def paper_planes(study: PaperStudy, *, seed: int = 0) -> PaperPlanes:
    """The planes of the paper's geometric figures; ``seed`` names the sampled acquisitions."""
    rgb, rgbw = study.columns[RGB_59], study.columns[RGBW_12]
    return PaperPlanes(
        measurement=channel_plane(rgb, _PAIR, seed=seed),
        correlation=_alike_magnified(
            channel_plane(rgb, widest_pair(rgb), seed=seed),
            channel_plane(rgbw, narrowest_pair(rgbw), seed=seed),
        ),
        color_axis=_alike_magnified(
            channel_plane(rgbw, _PAIR_FAR_FROM_Y, seed=seed),
            channel_plane(rgb, _PAIR_NEAR_Y, seed=seed),
        ),
    )


def _alike_magnified(first: ChannelPlane, second: ChannelPlane) -> tuple[NoisyPlane, NoisyPlane]:
    times = fitting_magnification(first, second)
    return (first, magnified_noise(first, times)), (second, magnified_noise(second, times))
