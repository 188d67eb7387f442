"""Print the numbers of the findings in docs/league.md; ``--front`` those of the search, too."""

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.stats import spearmanr

import chromanoise as cn
from chromanoise.color import white_preserving
from chromanoise.metrics import mean_chart_errors
from chromanoise.spectra.tables import camera_facts
from chromanoise.study import (
    RANKED,
    LeagueEntry,
    TradeOff,
    Viewing,
    camera_pixel,
    electrons_at,
    noise_as_viewed,
    point_at_iso,
    sensor_named,
    trade_off,
)
from chromanoise.study.color_matrices import training_named

FRONT = """\
schema = 1
matrices = ["white-preserving"]
light = {{illuminant = "D50", beyond = "zero", level_lux = 100.0}}
exposure = {{time_ms = 10, f_number = 1.8}}
sensors = [
    {{name = "flat.csv", answers = {{per = "photon", level = "absolute"}}, pixel = {pixel}}},
{cameras}
]

[design]
objectives = ["visual_noise", "delta_e"]
mosaic = "bayer"
budget = {budget}
population = 300
seed = {seed}
ir_cut = {{cutoff_nm = [600, 780], width_nm = 8}}
channels = [
    {{name = "R", base = "W", filter = "gaussian", center_nm = [540, 700], width_nm = [10, 120]}},
    {{name = "G", base = "W", filter = "gaussian", center_nm = [480, 600], width_nm = [10, 120]}},
    {{name = "B", base = "W", filter = "gaussian", center_nm = [400, 500], width_nm = [10, 120]}},
]
"""
"""Gaussian filters on a flat QE of 0.5, the peak QE assumed of each camera; shot noise alone."""
PIXEL = "{pitch_um = 4.0, full_well_e = 100000, read_noise_e = 0.0}"
PERIODS = ((2004, 2009), (2010, 2016), (2017, 2025))


def main() -> None:
    """Correlations with the year and among numbers, medians of periods, and the range of noise."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--front", action="store_true", help="search a front; about 10 minutes")
    parser.add_argument("--budget", type=int, default=60000, help="sensors per search")
    given = parser.parse_args()
    result = cn.league()
    facts = camera_facts()
    cameras = [one for one in result.cameras if not one.has_own_peaks]
    years = np.array([facts[one.name].year for one in cameras])
    laboratories = np.array([facts[one.name].laboratory for one in cameras])
    values = {one.name: np.array([getattr(c, one.name) for c in cameras]) for one in RANKED}
    for name, value in values.items():
        medians = [
            f"{first}-{last} {np.median(value[(first <= years) & (years <= last)]):.2f}"
            for first, last in PERIODS
        ]
        print(f"{name}: {', '.join(medians)}; with the year {_correlation(years, value)}")
        for laboratory in sorted(set(laboratories)):
            here = laboratories == laboratory
            if here.sum() > 5:
                told = _correlation(years[here], value[here])
                print(f"  {laboratory} alone, {here.sum()} cameras: {told}")
    print(f"SMI and loss: {_correlation(values['smi'], values['color_snr_loss_db'])}")
    for i, iso in enumerate(result.speeds):
        noise = [x for one in cameras if (x := _noise(one, i)) is not None]
        print(f"ISO {iso:g}: visual noise of {len(noise)} {min(noise):.2f} to {max(noise):.2f}")
    for iso in (800.0, 6400.0):
        best_matrices(iso)
    if given.front:
        distances_to_front([one.name for one in cameras], given.budget)


def distances_to_front(names: Sequence[str], budget: int, seeds: tuple[int, ...] = (1, 2)) -> None:
    """Visual noise of cameras above the front of Gaussian filters, at equal color error. [dB]"""
    found = []
    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            flat = ["wavelength_nm,W", *(f"{nm},0.5" for nm in range(400, 1055, 5))]
            (Path(folder) / "flat.csv").write_text("\n".join(flat), encoding="utf-8")
            cameras = ",\n".join(f'    {{name = "{one}", pixel = {PIXEL}}}' for one in names)
            text = FRONT.format(pixel=PIXEL, cameras=cameras, budget=budget, seed=seed)
            path = Path(folder) / "design.toml"
            path.write_text(text, encoding="utf-8")
            design = cn.optimize(path)
        pairs = sorted(
            (m.objectives["delta_e"], m.objectives["visual_noise"]) for m in design.members
        )
        errors, noise = np.array(pairs).T
        own = [one.objectives for one in design.references if one.name in names]
        found.append(
            [
                20 * np.log10(one["visual_noise"] / np.interp(one["delta_e"], errors, noise))
                for one in own
            ]
        )
    distances = np.array(found)
    print(f"seeds differ by {np.ptp(distances, axis=0).max():.3f} dB at most")
    order = np.argsort(distances.mean(axis=0))
    for i in (*order[:5], *order[-2:]):
        print(f"{names[i]}: {distances[:, i].mean():.2f} dB more noise than the front")


def best_matrices(iso: float) -> None:
    """What a matrix made for one ISO speed gains over the white-preserving one. [dB]"""
    same: list[float] = []
    further: list[float] = []
    for name in camera_facts():
        if iso < camera_facts()[name].base_iso:
            continue
        sensor = sensor_named(name)
        pixel = camera_pixel(sensor, iso)
        if pixel.read_noise_e is None or camera_facts()[name].has_own_peaks:
            continue
        point = point_at_iso(replace(sensor, pixel=replace(sensor.pixel, **pixel.known)), iso)
        trade = trade_off(point, prior="chart")
        if not isinstance(trade, TradeOff):
            continue
        usual = white_preserving(
            point.sensor,
            point.exposure,
            training_named("chart", point.illuminant),
            level_lux=point.level_lux,
        ).matrix
        seen = electrons_at(point), point.sensor, point.exposure
        noise = float(noise_as_viewed(*seen, usual, Viewing()))
        error = float(
            mean_chart_errors(point.sensor, usual[None], point.exposure, point.illuminant)[0]
        )
        for gains, allowed in ((same, 0.0), (further, 1.0)):
            reached = trade.visual_noise[trade.color_error <= error + allowed]
            gains.append(20 * np.log10(noise / reached.min()) if reached.size else np.nan)
    for gains, what in ((same, "at its color error"), (further, "at 1 Delta E*ab more")):
        low, middle, high = np.nanpercentile(gains, [0, 50, 100])
        print(f"ISO {iso:g}, {len(gains)} cameras: best matrix {what}: {middle:.2f} dB less noise")
        print(f"  ({low:.2f} to {high:.2f} dB)")


def _noise(standing: LeagueEntry, i: int) -> float | None:
    return standing.iso[i].visual_noise


def _correlation(x: np.ndarray, y: np.ndarray) -> str:
    found = spearmanr(x, y)
    return f"rank correlation {found.statistic:.2f}, p = {found.pvalue:.2g}"


if __name__ == "__main__":
    main()
