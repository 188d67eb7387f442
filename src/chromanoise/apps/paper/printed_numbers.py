"""The paper's own study: its sensors, two exposure times, printed values, and its Figure 8.

Clouet, Vaillant & Alleysson, "Physical noise propagation in color image construction: a geometrical
interpretation", CIC27 (2019), Tables 1-5. Figure 8 shows one scene through both sensors at the same
exposure.
"""

from chromanoise.base import dataclass
from chromanoise.imaging import Picture, rendered
from chromanoise.noise import Exposure, time_to_saturation
from chromanoise.sensor import Sensor, with_channels
from chromanoise.spectra import (
    DEFAULT_GRID,
    Grid,
    Metric,
    Scene,
    checker_cube,
    equal_energy,
    flat_field,
)
from chromanoise.study import Analysis, analyzed, sensor_named

LEVEL_LUX = 10.0
F_NUMBER = 1.8
WELL_SHARE = 0.99
DRAWS = 5000

RGBW_12, RGB_12, RGB_59 = "RGBW_n 12 ms", "RGB 12 ms", "RGB 59 ms"
G_N, G = "G_n", "G"

PRINTED_TIMES_MS = {"onyx-rgbw": 12.0, "onyx-rgb-ircut": 59.0}

PRINTED_RAW_SNR_DB = {  # Table 2
    "R": {RGBW_12: 38.1, RGB_12: 32.6, RGB_59: 39.8},
    "G": {RGBW_12: 36.8, RGB_12: 32.8, RGB_59: 39.8},
    "B": {RGBW_12: 36.4, RGB_12: 32.6, RGB_59: 39.9},
    "W": {RGBW_12: 39.9},
}
PRINTED_SNR_Y_DB = {RGBW_12: 26.1, RGB_12: 32.4, RGB_59: 39.4}  # Table 3
PRINTED_CONTRAVARIANT_SNR_DB = {  # Table 4
    "R": {RGBW_12: 9.8, RGB_12: 26.6, RGB_59: 34.1},
    "G": {RGBW_12: 8.8, RGB_12: 19.8, RGB_59: 27.4},
    "B": {RGBW_12: 16.4, RGB_12: 25.0, RGB_59: 32.4},
    "W": {RGBW_12: 12.8},
}
PRINTED_ANGLE_DEG = {G_N: 50.7, G: 18.1}  # Table 5
PRINTED_FULL_WELL_SNR_DB = {G_N: 39.95, G: 39.95}
PRINTED_GREEN_SNR_Y_DB = {G_N: 36.9, G: 39.7}


@dataclass(frozen=True, kw_only=True, eq=False)
class PaperStudy:
    """The paper's scene, sensors and exposures, each taken through every stage.

    Attributes
    ----------
    scene
        A perfect white under 10 lx of equal energy to 1050 nm.
    times_s
        The exposure time of each sensor, solved from the saturation rule. [s]
    columns
        The three columns of Tables 2-4.
    greens
        The two one-channel sensors of Table 5.
    set_aside
        The two sensors that the paper leaves out, at their own saturation.
    metric
        In which light is a vector.
    """

    scene: Scene
    times_s: dict[str, float]
    columns: dict[str, Analysis]
    greens: dict[str, Analysis]
    set_aside: dict[str, Analysis]
    metric: Metric


def paper_study(metric: Metric = "quanta", grid: Grid = DEFAULT_GRID) -> PaperStudy:
    """Tables 2-5 in closed form, on the reconstruction of the paper's sensors.

    Parameters
    ----------
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    grid
        Wavelengths of the result.
    """
    scene = flat_field(equal_energy(grid), level_lux=LEVEL_LUX)
    sensors = {
        name: sensor_named(name, grid)
        for name in ("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut")
    }
    times_s = {
        name: time_to_saturation(scene, sensor, f_number=F_NUMBER, share=WELL_SHARE)
        for name, sensor in sensors.items()
    }

    def seen(sensor: Sensor, time_of: str) -> Analysis:
        exposure = Exposure(time_s=times_s[time_of], f_number=F_NUMBER)
        return analyzed(scene, sensor, exposure, metric)

    rgbw, rgb = sensors["onyx-rgbw"], sensors["onyx-rgb-ircut"]
    return PaperStudy(
        scene=scene,
        times_s=times_s,
        columns={
            RGBW_12: seen(rgbw, "onyx-rgbw"),
            RGB_12: seen(rgb, "onyx-rgbw"),
            RGB_59: seen(rgb, "onyx-rgb-ircut"),
        },
        greens={
            G_N: seen(with_channels(rgbw, ("G",), name="G_n"), "onyx-rgbw"),
            G: seen(with_channels(rgb, ("G",), name="G"), "onyx-rgb-ircut"),
        },
        set_aside={name: seen(sensors[name], name) for name in ("onyx-rgb", "onyx-rgbw-ircut")},
        metric=metric,
    )


def paper_pictures(study: PaperStudy, *, seed: int = 0) -> tuple[Picture, Picture]:
    """The ColorChecker through RGB with IR-cut and RGBW_n, both at RGBW_n's time.

    The paper renders a scene of its own database, which is not published; the chart stands in.
    """
    cube = checker_cube()
    first, second = (
        rendered(cube, analysis.point, matrix=analysis.matrix, seed=seed)
        for analysis in (study.columns[RGB_12], study.columns[RGBW_12])
    )
    return first, second
