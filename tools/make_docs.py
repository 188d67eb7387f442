"""Draw the pictures of README and docs anew from the library's own numbers."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from chromanoise.apps.paper import PaperStudy, paper_study
from chromanoise.apps.paper.printed_numbers import RGB_12, RGBW_12, paper_pictures
from chromanoise.charts import chromanoise_style, draw_color_errors, draw_comparison
from chromanoise.charts.figure_style import channel_color, sensor_lines
from chromanoise.color import kernel_matrix
from chromanoise.geometry import dual_frame, ellipse_outline, variance_inflation
from chromanoise.imaging import write_png
from chromanoise.metrics import pair_distances
from chromanoise.noise import OperatingPoint, measurement_vectors, through
from chromanoise.spectra import DEFAULT_GRID, colorchecker, equal_energy
from chromanoise.study import compared, crossover_sentence, crossovers, matrix_makers
from chromanoise.study.analysis import stages_at
from chromanoise.study.sweeps import QUANTITIES

PICTURES = Path(__file__).parent.parent / "docs" / "pictures"
GAP_PX = 16
LEVELS_LUX = np.geomspace(0.01, 30, 71)
READER_LUX = np.geomspace(0.05, 10, 61)
READERS = {
    "snr-y": "eye: SNR of Y [dB]",
    "separation": "machine: median D_M",
    "separation-without-brightness": "without brightness: median D_M",
}


def main() -> None:
    """Write all pictures of README and docs that are no photographs of the page."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    study = paper_study()
    write_two_sensors(study)
    write_crossover(study)
    write_two_readers(study)
    write_unmixing(study)
    write_geometry()
    write_geometry_of_sensors(study)


def write_two_sensors(study: PaperStudy) -> None:
    """RGB behind an IR-cut beside RGBW without, at the same light and time."""
    rgb, rgbw = paper_pictures(study)
    gap = np.full((rgb.srgb.shape[0], GAP_PX, 3), 255, dtype=np.uint8)
    write_png(PICTURES / "two-sensors.png", np.hstack([rgb.srgb, gap, rgbw.srgb]))


def write_crossover(study: PaperStudy) -> None:
    """Both sensors over the light level, with the kernel and with LMMSE."""
    contestants = both_sensors(study)
    makers = matrix_makers(["kernel", "lmmse"], "quanta")
    curves = compared(contestants, makers, LEVELS_LUX)
    crossed = crossovers(contestants, makers, curves)
    with chromanoise_style():
        figure = Figure(figsize=(7.5, 6.5), layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        draw_comparison(curves, above, crossovers=crossed).set_xlabel("")
        draw_color_errors(curves, below)
        figure.savefig(PICTURES / "crossover.png", dpi=110)
    for crossover in crossed:
        print(crossover_sentence(crossover))


def both_sensors(study: PaperStudy) -> list[OperatingPoint]:
    """RGBW without IR-cut and RGB behind it, at one time, 10 lx of illuminant E."""
    return [
        OperatingPoint(
            sensor=study.columns[name].sensor,
            exposure=study.columns[name].exposure,
            illuminant=equal_energy(DEFAULT_GRID),
            level_lux=10.0,
        )
        for name in (RGBW_12, RGB_12)
    ]


def write_two_readers(study: PaperStudy) -> None:
    """SNR of Y for an eye, and the median distance of patches for a machine, over the light."""
    points, makers = both_sensors(study), matrix_makers(["kernel"], "quanta")
    with chromanoise_style():
        figure = Figure(figsize=(9.0, 3.6), layout="constrained")
        panels = figure.subplots(1, 3, sharex=True)
        for (quantity, title), panel in zip(READERS.items(), panels, strict=True):
            curves = compared(points, makers, READER_LUX, quantity=QUANTITIES[quantity])
            lines = sensor_lines(curve.label for curve in curves)
            for curve in curves:
                panel.plot(curve.at, curve.value, label=curve.label, **lines[curve.label])
            panel.set(xscale="log", xlabel="illuminance [lx]", title=title)
            if quantity != "snr-y":
                panel.set_yscale("log")
        panels[0].legend(frameon=False)
        figure.savefig(PICTURES / "two_readers.png", dpi=110)


def write_unmixing(study: PaperStudy) -> None:
    """Two patches in two raw channels, and unmixed: the ellipses change, their overlap does not."""
    point = both_sensors(study)[0]
    chart = colorchecker(DEFAULT_GRID)
    at = [chart.names.index(name) for name in ("orange", "orange yellow")]
    matrix = kernel_matrix(point.sensor, point.exposure, "quanta")
    raw = stages_at(point, matrix, reflectance=chart.values.T[at]).raw
    two = [raw.names.index(name) for name in ("G", "W")]
    keep = np.eye(len(raw.names))[two]
    unmix = np.array([[1.0, -0.35], [-0.8, 1.0]])
    with chromanoise_style():
        figure = Figure(figsize=(8.0, 3.8), layout="constrained")
        for matrix_2, title, axes, panel in (
            (keep, "raw", ("G", "W"), figure.add_subplot(121)),
            (unmix @ keep, "unmixed", ("G - 0.35 W", "W - 0.8 G"), figure.add_subplot(122)),
        ):
            seen = through(raw, matrix_2, names=("a", "b"), kind="raw", unit="e-")
            angle = np.linspace(0, 2 * np.pi, 200)
            circle = 2 * np.stack([np.cos(angle), np.sin(angle)])
            for mean, covariance, name in zip(seen.mean, seen.covariance, at, strict=True):
                ellipse = mean[:, None] + np.linalg.cholesky(covariance) @ circle
                panel.plot(*ellipse, label=chart.names[name])
            distance = float(pair_distances(seen, np.array([[0, 1]]))[0])
            heads = [f"{axis} [e-]" for axis in axes]
            panel.set(title=f"{title}: D_M = {distance:.2f}", xlabel=heads[0], ylabel=heads[1])
        panel.legend(frameon=False)
        figure.savefig(PICTURES / "unmixing.png", dpi=110)


def write_geometry() -> None:
    """Two channels at 90, 60 and 30 degrees, their dual basis, and the noise before and after."""
    with chromanoise_style():
        figure = Figure(figsize=(9.0, 3.4), layout="constrained")
        for panel, angle_deg in zip(figure.subplots(1, 3), (90.0, 60.0, 30.0), strict=True):
            t = np.radians(angle_deg)
            basis = np.array([[1.0, np.cos(t)], [0.0, np.sin(t)]])
            frame = dual_frame(basis, names=("1", "2"), metric="quanta")
            arrows = ((basis, "C0", "f{}", "bottom"), (frame.dual, "C3", "f{}*", "top"))
            for vectors, color, name, place in arrows:
                for i, (x, y) in enumerate(vectors.T):
                    panel.annotate(
                        "", (x, y), (0, 0), arrowprops={"arrowstyle": "->", "color": color, "lw": 2}
                    )
                    panel.text(1.15 * x, 1.15 * y, name.format(i + 1), color=color, va=place)
            # equal noise of both readings; as light it is this ellipse
            covariance = 0.15 * frame.dual @ frame.dual.T
            panel.plot(*ellipse_outline(np.zeros(2), covariance, sigmas=1.0).T, color="C7", lw=1)
            vif = variance_inflation(frame)[0]
            panel.set(title=f"{angle_deg:.0f} deg: VIF {vif:.2f}", xlim=(-1.3, 1.5))
            panel.set(ylim=(-2.0, 2.3), aspect="equal", xticks=[], yticks=[])
        figure.savefig(PICTURES / "geometry-angle.png", dpi=110)


def write_geometry_of_sensors(study: PaperStudy) -> None:
    """Curves, and VIF of each channel, without and with the IR-cut."""
    with chromanoise_style():
        figure = Figure(figsize=(9.0, 5.2), layout="constrained")
        for row, name in zip(figure.subplots(2, 2), (RGBW_12, RGB_12), strict=True):
            sensor, exposure = study.columns[name].sensor, study.columns[name].exposure
            basis = measurement_vectors(sensor, exposure, "quanta")
            frame = dual_frame(basis, names=sensor.names, metric="quanta")
            colors = [channel_color(one) for one in sensor.names]
            for curve, color, channel in zip(sensor.qe.T, colors, sensor.names, strict=True):
                row[0].plot(sensor.grid.wavelength_nm, curve, color=color, label=channel)
            row[0].set(title=sensor.name, xlabel="wavelength [nm]", ylabel="QE [e-/photon]")
            row[0].legend(frameon=False)
            bars = row[1].bar(sensor.names, variance_inflation(frame), color=colors)
            row[1].bar_label(bars, fmt="%.2f")
            row[1].set(
                title=f"variance inflation factor, metric {frame.metric}", ylim=(0, 9), ylabel="VIF"
            )
        figure.savefig(PICTURES / "geometry-sensors.png", dpi=110)


if __name__ == "__main__":
    main()
