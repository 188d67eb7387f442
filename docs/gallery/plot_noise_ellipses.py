"""
Noise of the ColorChecker in a* and b*
======================================

Each ellipse shows how the color of a patch varies from pixel to pixel (two standard deviations). A
line leads from the true color, marked by a cross, to the mean color of the camera. Both sensors
have the same light and time.
"""

import matplotlib.pyplot as plt
import numpy as np

import chromanoise as cn

names = ["onyx-rgbw", "onyx-rgb-ircut"]
study = cn.study.study_of("analyze", names, {"lux": 10.0, "time_ms": 12.0})
chart = cn.charts.drawing("ellipses", cn.charts.shown(study))

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(1, 2, figsize=(6.2, 6.2), sharey=True, layout="constrained")
    for i, ax in enumerate(axes):
        cn.charts.draw_ellipses(chart, i, ax)
    axes[1].set_ylabel("")
    figure.suptitle("Noise ellipses of 24 patches at 10 lx, 12 ms, f/1.8", fontsize=10)

(one, _) = (panel.marks[0] for panel in chart.panels)
height = np.hypot(*(np.array(chart.columns[i].values) for i in one.half_axes[1::2]))
first, second = np.split(height, 2)
assert np.median(first) > 1.5 * np.median(second)
