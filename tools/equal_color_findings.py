"""Print the table of docs/findings.md: the paper's pair at equal color error over the light."""

from dataclasses import replace

import chromanoise as cn
from chromanoise.study import equal_color

LEVELS_LUX = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1000.0)
FULL_LUX = 10.0
"""At which the sensor without IR-cut is full after the time of the paper; with more light the time
is shorter in proportion. [lx]"""


def main() -> None:
    """Print a row per level."""
    pair = cn.analyze("onyx-rgbw", "onyx-rgb-ircut", lux=FULL_LUX)
    for level_lux in LEVELS_LUX:
        points = [
            replace(
                one,
                level_lux=level_lux,
                exposure=replace(
                    one.exposure,
                    time_s=one.exposure.time_s * min(1.0, FULL_LUX / level_lux),
                ),
            )
            for one in pair.points
        ]
        found = equal_color(points)
        assert found is not None
        noise = {one.sensor: one.noise for one in found.standings}
        totals = zip(found.standings, found.least_total_errors, strict=True)
        least = {one.sensor: total for one, total in totals}
        lost = ", ".join(found.lost) or "none"
        cells = [
            f"{level_lux:g}",
            f"{found.at_color_error:.1f}",
            *(f"{noise[name]:.3g}" for name in ("onyx-rgbw", "onyx-rgb-ircut")),
            "tie" if found.is_tie else f"{found.winner}, {found.margin_db:.1f} dB",
            *(f"{least[name]:.1f}" for name in ("onyx-rgbw", "onyx-rgb-ircut")),
            lost,
        ]
        print(f"| {' | '.join(cells)} |")
        for one in found.turns:
            print(f"  {one}")


if __name__ == "__main__":
    main()
