"""What a machine tells apart, as tables on a terminal."""

from collections.abc import Sequence

from rich.table import Table

from chromanoise.analysis.contrast_detection import (
    BRIGHT,
    DARK,
    TARGET,
    TOLERANCE,
    ContrastDetection,
)
from chromanoise.analysis.information import InformationChain
from chromanoise.analysis.separation import READINGS, Separation
from chromanoise.cli.output import terminal

_ABOUT = {"spectrum": "spectrum", "visible": "visible light"}
_HEADS = ("raw", "color", "raw, no brightness", "color, no brightness")


def print_separations(sensors: Sequence[tuple[str, Separation | None]]) -> None:
    """Print the median distances, then those of the worst pair of each sensor.

    Parameters
    ----------
    sensors
        Label and separation of each sensor.
    """
    console = terminal()
    table = Table(title="For a machine: distance D_M (probability)", title_justify="left")
    for head in ("sensor", "pairs"):
        table.add_column(head)
    for head in _HEADS:
        table.add_column(head, justify="right")
    for label, found in sensors:
        if found is None:
            table.add_row(label, "a patch is saturated", *("" for _ in READINGS))
            continue
        medians = [(found.median_distance(n), found.median_probability(n)) for n in READINGS]
        table.add_row(label, f"median of {len(found.pairs.indices)}", *map(_cell, medians))
        at, names = found.worst, found.pairs.names[found.worst]
        worst = [(found.distance[n][at], found.probability[n][at]) for n in READINGS]
        table.add_row("", f"worst: {names[0]} / {names[1]}", *map(_cell, worst))
    console.print(table)
    console.print(
        "D_M: distance of two patches in units of their noise, for an ideal reader of one pixel; "
        "in parentheses the probability that it names the right one of the two (0.5 is chance).",
        soft_wrap=True,
    )


def print_contrast_detection(sensors: Sequence[tuple[str, ContrastDetection | None]]) -> None:
    """Print the probability per channel and the level at which it is reliable.

    Parameters
    ----------
    sensors
        Label and contrast detection of each sensor.
    """
    console = terminal()
    table = Table(title="For a machine: contrast detection probability", title_justify="left")
    table.add_column("sensor")
    for head in ("raw channels", "Y", f"lux for {TARGET:g}"):
        table.add_column(head, justify="right")
    for label, found in sensors:
        if found is None:
            table.add_row(label, "saturated", "", "")
            continue
        channels = ", ".join(f"{name} {p:.3f}" for name, p in found.channels.items())
        luminance = "" if found.luminance != found.luminance else f"{found.luminance:.3f}"
        level = "none" if found.level_lux != found.level_lux else f"{found.level_lux:.3g}"
        table.add_row(label, channels, luminance, level)
    console.print(table)
    console.print(
        f"Grays of {100 * BRIGHT:g} and {100 * DARK:g} % on one pixel each: the share of readings "
        f"whose Weber contrast is within {100 * TOLERANCE:g} % of the true one (idea of IEEE "
        "P2020); the last column is for the best raw channel, with the time kept.",
        soft_wrap=True,
    )


def print_information(sensors: Sequence[tuple[str, Sequence[InformationChain]]]) -> None:
    """Print the bits after each step.

    Parameters
    ----------
    sensors
        Label and chains of each sensor.
    """
    console = terminal()
    table = Table(title="For a machine: information [bit per pixel]", title_justify="left")
    table.add_column("sensor")
    table.add_column("about")
    steps = list(
        dict.fromkeys(name for _, chains in sensors for one in chains for name in one.bits)
    )
    for name in steps:
        table.add_column(name, justify="right")
    for label, chains in sensors:
        if not chains:
            table.add_row(label, "saturated")
        for one in chains:
            bits = [f"{one.bits[name]:.2f}" if name in one.bits else "" for name in steps]
            table.add_row(label, _ABOUT[one.about], *bits)
    console.print(table)
    source = next((one.prior for _, chains in sensors for one in chains), "none")
    console.print(
        f"Information about reflectances ({source}) that is left after each step; for a linear "
        "reader of one pixel of each channel.",
        soft_wrap=True,
    )


def _cell(value: tuple[float, float]) -> str:
    distance, probability = value
    digits = "#.3g" if distance < 100 else ".0f"
    return f"{distance:{digits}} ({probability:.3f})"
