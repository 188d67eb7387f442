"""
Crosstalk
=========

Light that reaches a neighboring pixel mixes the channels. The matrix unmixes them, which reduces
the SNR of Y: by 5 dB at 30 % crosstalk in a Bayer mosaic, and by 11 dB in the sparse mosaic of
onyx-rgbw, where the white pixels have different neighbors, so that crosstalk also makes a fixed
pattern. The color error does not change, because the matrix is computed with crosstalk.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

swept = cn.compare(
    "onyx-rgbw",
    "onyx-rgb-ircut",
    vary="crosstalk",
    first=0,
    last=0.3,
    points=31,
    time_ms=12,
    lux=8,
)

with cn.charts.chromanoise_style():
    figure, (above, below) = plt.subplots(
        2, 1, figsize=(7.2, 5.6), sharex=True, height_ratios=(3, 2), layout="constrained"
    )
    swept.plot(above).set_xlabel("")
    cn.charts.draw_color_errors(swept.curves, below)

for curve in swept.curves:
    assert curve.value[0] > curve.value[-1] + 4
