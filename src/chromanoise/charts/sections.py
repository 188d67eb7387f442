"""Charts of a study as sections of page and report: order, headings and captions."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """One chart as a section of the page and of the report.

    Attributes
    ----------
    part
        A name from `chromanoise.charts.DRAWINGS`, or ``picture``.
    heading
        Its heading.
    shows
        What it shows, in one sentence.
    explanations
        Keys of `chromanoise.charts.explanations.EXPLANATIONS`, for its ``?``.
    """

    part: str
    heading: str
    shows: str
    explanations: tuple[str, ...]


SECTIONS: tuple[Section, ...] = (
    Section(
        part="picture",
        heading="The picture",
        shows="The same scene, light and time through each sensor.",
        explanations=("picture", "color"),
    ),
    Section(
        part="head",
        heading="Sensors",
        shows="The rank follows the SNR of Y; the electrons are those of a perfect white.",
        explanations=("electrons", "color", "price"),
    ),
    Section(
        part="budget",
        heading="SNR budget",
        shows="From every photon that hits the pixels down to one color coordinate: what each "
        "cause costs.",
        explanations=("budget", "bound", "price"),
    ),
    Section(
        part="vectors",
        heading="Channels as vectors",
        shows="The smaller the angle between two channels, the noisier their unmixing, and the "
        "larger the ellipsoid of uncertainty around the light.",
        explanations=("vectors",),
    ),
    Section(
        part="stages",
        heading="SNR from raw to color",
        shows="The SNR of the same light at each stage: channels as read, unmixed, and as color.",
        explanations=("raw", "contravariant", "spectral", "color", "lab", "bound", "price"),
    ),
    Section(
        part="levels",
        heading="Over the light level",
        shows="With the same exposure time; circles mark where two sensors are equally good.",
        explanations=("levels", "color"),
    ),
    Section(
        part="map",
        heading="Two parameters",
        shows="One quantity for every combination of two parameters.",
        explanations=("map", "color"),
    ),
    Section(
        part="ellipses",
        heading="Noise ellipses of the chart",
        shows="For every patch of the chart: the cross is its true color, the ellipse shows how "
        "far noise moves it.",
        explanations=("ellipses",),
    ),
    Section(
        part="chart",
        heading="Color error and noise",
        shows="For every patch: how far its mean color is off, and how far noise moves it.",
        explanations=("chart",),
    ),
    Section(
        part="pareto",
        heading="Training error against SNR",
        shows="What other matrices achieve: each point is a matrix with another weight of the "
        "noise. The training error is the color error averaged over the prior, not over the "
        "chart.",
        explanations=("pareto",),
    ),
    Section(
        part="sensitivities",
        heading="Sensitivities",
        shows="The quantum efficiency of each channel, and the light; the near infrared is shaded.",
        explanations=("electrons",),
    ),
)
"""In the order of the page and of the report."""
