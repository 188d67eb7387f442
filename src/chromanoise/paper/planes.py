"""Which planes the paper's geometric figures show, and how far their noise is magnified."""

from dataclasses import dataclass

from chromanoise.paper.study import RGB_59, RGBW_12, PaperStudy
from chromanoise.paper.views import (
    ChannelPlane,
    MagnifiedNoise,
    channel_plane,
    fitting_magnification,
    magnified_noise,
    narrowest_pair,
    widest_pair,
)

_PAIR = ("R", "G")  # of the RGB sensor, in Figures 3, 4 and 6
_PAIR_FAR_FROM_Y = ("G", "R")  # of the RGBW sensor, in Figure 10
_PAIR_NEAR_Y = ("G", "R")  # of the RGB sensor, in Figure 10

NoisyPlane = tuple[ChannelPlane, MagnifiedNoise]


@dataclass(frozen=True, slots=True, kw_only=True)
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
    """The planes of the paper's geometric figures; ``seed`` names the sampled acquisitions.

    Parameters
    ----------
    study
        The study.
    seed
        Seed of the random numbers.
    """
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
