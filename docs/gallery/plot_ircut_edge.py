"""
Where should the IR-cut have its edge?
======================================

SNR of luminance and color error over the edge of an IR-cut in front of two sensors, with an LMMSE
matrix for each edge. The best SNR (dot) is at 617 nm. Infrared light enters every channel: with an
edge beyond 700 nm both sensors get worse.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

swept = cn.compare(
    "onyx-rgbw",
    "onyx-rgb",
    matrices=["lmmse"],
    vary="ircut-nm",
    first=580,
    last=1000,
    points=106,
    time_ms=11.94,
)

with cn.charts.chromanoise_style():
    figure, (above, below) = plt.subplots(
        2, 1, figsize=(7.2, 5.6), sharex=True, height_ratios=(3, 2), layout="constrained"
    )
    swept.plot(above).set_xlabel("")
    cn.charts.draw_color_errors(swept.curves, below)

rgbw = swept.curves[0]
best = rgbw.value.argmax()
assert abs(rgbw.at[best] - 617) <= 4
assert abs(rgbw.value[best] - 34.2) < 0.1
above.plot(rgbw.at[best], rgbw.value[best], "o", color="black")
