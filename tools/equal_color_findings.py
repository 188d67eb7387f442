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
        bare, cut = sorted(found.standings, key=lambda one: -len(one.sensor))[::-1]
        cells = [
            f"{level_lux:g}",
            f"{found.at_color_error:.1f}",
            *(f"{one.visual_noise:.3g}" for one in (bare, cut)),
            f"{found.standings[0].sensor}, {found.margin_db:.1f} dB (tie: {found.tie_db:.1f} dB)",
            *(f"{one.least_total_error:.1f}" for one in (bare, cut)),
            ", ".join(one.sensor for one in (bare, cut) if one.is_lost),
        ]
        print(f"| {' | '.join(cells)} |")
        for one in found.turns:
            print(f"  {one}")


if __name__ == "__main__":
    main()
