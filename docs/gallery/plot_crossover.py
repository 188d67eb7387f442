"""
Which sensor is better at which light
=====================================

SNR of luminance and color error over the light level, with the kernel matrix and with an LMMSE
matrix computed for each level. With the kernel matrix the curves do not cross. With LMMSE the
sensor without IR-cut is better below 0.26 lx, where the pictures of both have little color.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

swept = cn.compare(
    "onyx-rgbw",
    "onyx-rgb-ircut",
    matrices=["kernel", "lmmse"],
    time_ms=12,
    first=0.01,
    last=9,
    points=41,
)

with cn.charts.chromanoise_style():
    figure, (above, below) = plt.subplots(
        2, 1, figsize=(7.2, 6), sharex=True, height_ratios=(3, 2), layout="constrained"
    )
    swept.plot(above).set_xlabel("")
    cn.charts.draw_color_errors(swept.curves, below)

crossed = {one.matrix: one.at for one in swept.crossovers}
assert crossed["kernel"] == ()
assert abs(crossed["lmmse"][0] - 0.26) < 0.02
