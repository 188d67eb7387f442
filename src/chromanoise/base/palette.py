"""The colors of all drawings: figures, notebooks, the page and the reports.

Channels have the colors of Wong, "Points of view: Color blindness", Nature Methods 8 (2011) 441.
"""

from collections.abc import Mapping, Sequence

CHANNELS: Mapping[str, tuple[str, str]] = {
    "R": ("#D55E00", "#D55E00"),
    "G": ("#009E73", "#009E73"),
    "B": ("#0072B2", "#0072B2"),
    "W": ("#000000", "#FFFFFF"),
    "IR": ("#CC79A7", "#CC79A7"),
}
"""Colors of a channel by name: on a light background, on a dark background."""
NEUTRALS: Mapping[str, tuple[str, str]] = {
    "ink": ("#1B1F23", "#EDF0F2"),
    "quiet": ("#575E66", "#A5ADB5"),
    "faint": ("#E3E6E9", "#31373D"),
    "paper": ("#FFFFFF", "#15181B"),
}
"""Text; secondary text and grid lines; areas; background. Contrast: text 4.5:1, graphics 3:1."""
SENSORS: tuple[tuple[str, str], ...] = (
    ("#3F90DA", "#3F90DA"),
    ("#C07C00", "#FFA90E"),
    ("#BD1F01", "#D12201"),
    ("#832DB6", "#993DCF"),
    ("#329B9F", "#92DADD"),
    ("#E76300", "#E76300"),
    ("#717581", "#94A4A2"),
    ("#9B8D4C", "#B9AC70"),
    ("#A96B59", "#A96B59"),
    ("#1B1F23", "#EDF0F2"),
)
"""Colors of many sensors, in turn: Petroff, "Accessible color sequences for data visualization",
arXiv:2107.02270 (2021), darker or lighter where needed for a contrast of 3:1, and the text color.
"""
VALUES = (
    *("#440154", "#472D7B", "#3B528B", "#2C728E", "#21918C"),
    *("#28AE80", "#5EC962", "#ADDC30", "#FDE725"),
)
"""Colors of a value from low to high, equally far apart: viridis of matplotlib."""
DIFFERENCES = (
    *("#67001F", "#BB2A34", "#E58368", "#FBCEB7", "#F6F7F7"),
    *("#C0DCEB", "#68ABD0", "#2870B1", "#053061"),
)
"""Colors of a difference, negative, zero and positive: RdBu of ColorBrewer."""
INK, QUIET, FAINT = (NEUTRALS[name][0] for name in ("ink", "quiet", "faint"))


def channel_color(name: str) -> str | None:
    """The color of a channel on a light background; ``None`` if the palette does not contain it."""
    return CHANNELS[name][0] if name in CHANNELS else None


def color_between(colors: Sequence[str], share: float) -> str:
    """The color at a share of the way from the first to the last of a scale.

    Parameters
    ----------
    colors
        Of `VALUES` or `DIFFERENCES`.
    share
        From 0 (the first color) to 1 (the last).

    Examples
    --------
    >>> color_between(("#000000", "#FFFFFF"), 0.5)
    '#808080'
    """
    place = share * (len(colors) - 1)
    i = min(int(place), len(colors) - 2)
    before, after = (bytes.fromhex(color[1:]) for color in colors[i : i + 2])
    mixed = (round(a + (place - i) * (b - a)) for a, b in zip(before, after, strict=True))
    return f"#{bytes(mixed).hex().upper()}"


def palette_css() -> str:
    """The palette as CSS custom properties: ``--ink``, ``--channel-R``, ``--sensor-0`` and so on.

    Examples
    --------
    >>> print(palette_css()[:47])
    :root {
      --ink: light-dark(#1B1F23, #EDF0F2);
    """
    named = {
        **NEUTRALS,
        **{f"channel-{name}": pair for name, pair in CHANNELS.items()},
        **{f"sensor-{i}": pair for i, pair in enumerate(SENSORS)},
    }
    lines = [f"  --{name}: light-dark({light}, {dark});" for name, (light, dark) in named.items()]
    return "\n".join([":root {", *lines, "}", ""])
