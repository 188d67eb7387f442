"""Noise through the camera's own pipeline as tables on a terminal."""

from collections.abc import Sequence

import numpy as np
from rich.table import Table

from chromanoise._check import Array
from chromanoise.analysis.pipeline_results import GainStep, PipelineNoise, PipelineStep
from chromanoise.cli.output import terminal

_CODES = 255
_MOST_CHANNELS = 4  # more are shown as a range


def print_pipeline(name: str, found: PipelineNoise | None) -> None:
    """Print the noise of each patch after each step, then one row per ISO.

    Parameters
    ----------
    name
        Of the sensor.
    found
        ``None`` where it has no color.
    """
    console = terminal()
    if found is None:
        console.print(
            f"{name}: no pipeline, because a channel is saturated, or XYZ of the white is not "
            "valid.",
            soft_wrap=True,
        )
        return
    console.print(_patches(name, found))
    console.print(_isos(name, found))
    for line in (*_balance(found), *found.notes):
        console.print(f"{name}: {line}", soft_wrap=True)


def _patches(name: str, found: PipelineNoise) -> Table:
    encoded = found.steps[-3]
    table = Table(
        title=f"Pipeline of {name}, standard deviations: raw in e-, {encoded.name} and Y'CbCr in "
        f"1/{_CODES}, Lab",
        title_justify="left",
    )
    few = len(found.channels) <= _MOST_CHANNELS
    raw_heads = found.channels if few else ("raw",)
    heads = (*raw_heads, *(name for step in found.steps[-3:] for name in step.measurement.names))
    for head in ("patch", *heads):
        table.add_column(head, justify="left" if head == "patch" else "right")
    raw = _sd(found.steps[0])
    others = np.hstack([_CODES * _sd(found.steps[-3]), _CODES * _sd(found.steps[-2])])
    lab = _sd(found.steps[-1])
    for i, patch in enumerate(found.patches):
        raws = [f"{sd:.1f}" for sd in raw[i]]
        shown = raws if few else [f"{raw[i].min():.1f} to {raw[i].max():.1f}"]
        numbers = (f"{value:.2f}" for value in (*others[i], *lab[i]))
        table.add_row(patch, *shown, *numbers, end_section=i == len(found.patches) - 1)
    means = (f"{value:.2f}" for value in (*others.mean(axis=0), *lab.mean(axis=0)))
    table.add_row("mean", *("" for _ in raw_heads), *means)
    return table


def _isos(name: str, found: PipelineNoise) -> Table:
    encoded, lab = (found.steps[i].measurement.names for i in (-2, -1))
    table = Table(
        title=f"{name} at each ISO (exposure of ISO {found.settings.base_iso:g} divided by the "
        "gain); Y'CbCr and Lab: mean standard deviation",
        title_justify="left",
    )
    heads = ("gain", "K DN/e-", "read e-", "white e-", "dynamic range dB", "stops", "S", "O")
    for head in ("ISO", *heads, *encoded, *lab):
        table.add_column(head, justify="right")
    for one in found.iso:
        table.add_row(*_iso_row(one))
    return table


def _iso_row(one: GainStep) -> list[str]:
    return [
        f"{one.iso:g}",
        f"{one.gain:g}",
        "-" if one.gain_dn_per_e is None else f"{one.gain_dn_per_e:.4g}",
        f"{one.read_noise_e:.3g}",
        f"{one.white_level_e:.4g}",
        _each(one.dynamic_range_db, ".1f"),
        _each(one.dynamic_range_stops, ".2f"),
        _each(one.noise_profile[:, 0], ".3g"),
        _each(one.noise_profile[:, 1], ".3g"),
        *(f"{_CODES * value:.2f}" for value in _sd(one.steps[-2]).mean(axis=0)),
        *(f"{value:.2f}" for value in _sd(one.steps[-1]).mean(axis=0)),
    ]


def _balance(found: PipelineNoise) -> Sequence[str]:
    gains = ", ".join(
        f"{name} {gain:.4g}" for name, gain in zip(found.channels, found.gains, strict=True)
    )
    lines = [f"white balance gains {gains}"]
    noise = found.white_balance_noise
    if noise is not None:
        sd = np.sqrt(np.diagonal(noise.gains_covariance))
        errors = ", ".join(
            f"{name} {100 * error:.2g} %"
            for name, error in zip(found.channels, sd / found.gains, strict=True)
        )
        lines.append(
            f"from {noise.pixels} gray pixels per channel the gains have standard deviations of "
            f"{errors}: a shift common to the whole picture of {noise.delta_e.mean():.2g} Delta "
            "E*ab (rms, mean of the patches)"
        )
    return lines


def _each(values: Array, digits: str) -> str:
    """One number where the channels agree to the printed digits, else the range."""
    shown = list(
        dict.fromkeys(format(float(value), digits) for value in (min(values), max(values)))
    )
    return " to ".join(shown)


def _sd(step: PipelineStep) -> Array:
    return np.asarray(np.sqrt(step.measurement.variance))
