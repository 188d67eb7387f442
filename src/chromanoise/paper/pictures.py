"""The paper's Figure 8: one scene through both sensors at the same exposure."""

from chromanoise.exposure import OperatingPoint
from chromanoise.imaging import Picture, rendered
from chromanoise.paper.study import RGB_12, RGBW_12, PaperStudy
from chromanoise.scene import checker_cube


def paper_pictures(study: PaperStudy, *, seed: int = 0) -> tuple[Picture, Picture]:
    """The ColorChecker through RGB with IR-cut and RGBW_n, both at RGBW_n's time.

    The paper renders a scene of its own database, which is not published; the chart stands in.
    """
    cube = checker_cube()
    first, second = (
        rendered(
            cube,
            OperatingPoint(
                sensor=analysis.sensor,
                exposure=analysis.exposure,
                illuminant=study.scene.illuminant,
                level_lux=study.scene.level_lux,
            ),
            matrix=analysis.matrix,
            seed=seed,
        )
        for analysis in (study.columns[RGB_12], study.columns[RGBW_12])
    )
    return first, second
