"""Print the numbers of the findings in docs/league.md."""

import numpy as np
from scipy.stats import spearmanr

from chromanoise.spectra.tables import camera_facts
from chromanoise.study import RANKED, LeagueEntry, league

PERIODS = ((2004, 2009), (2010, 2016), (2017, 2025))


def main() -> None:
    """Correlations with the year and among numbers, medians of periods, and the range of noise."""
    result = league()
    facts = camera_facts()
    cameras = [one for one in result.cameras if not facts[one.name].defect]
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


def _noise(standing: LeagueEntry, i: int) -> float | None:
    return standing.iso[i].visual_noise


def _correlation(x: np.ndarray, y: np.ndarray) -> str:
    found = spearmanr(x, y)
    return f"rank correlation {found.statistic:.2f}, p = {found.pvalue:.2g}"


if __name__ == "__main__":
    main()
