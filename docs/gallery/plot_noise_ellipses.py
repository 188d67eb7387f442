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
data = cn.charts.drawing("ellipses", cn.charts.shown(study))

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(1, 2, figsize=(6.2, 6.2), sharey=True, layout="constrained")
    for i, ax in enumerate(axes):
        cn.charts.draw_ellipses(data, i, ax)
    axes[1].set_ylabel("")
    figure.suptitle("Noise ellipses of 24 patches at 10 lx, 12 ms, f/1.8", fontsize=10)

height = [np.ptp([p["outline"] for p in one["patches"]], axis=1)[:, 1] for one in data["sensors"]]
assert np.median(height[0]) > 1.5 * np.median(height[1])
