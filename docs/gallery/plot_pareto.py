"""
Training error against SNR
==========================

A color matrix can give exact colors or low noise. Along each curve the weight of the noise in the
matrix grows: from least squares (the smallest error) over LMMSE (weight 1, large mark) to a nearly
gray picture. Where the color is usable, the sensor behind the IR-cut is better in both.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

study = cn.study_from_data(
    {
        "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut"}],
        "light": {"level_lux": 1.0},
        "exposure": {"time_ms": 12.0},
        "matrices": ["lmmse"],
    },
    source="gallery",
)
with cn.charts.chromanoise_style():
    figure, ax = plt.subplots(figsize=(7, 4.4), layout="constrained")
    cn.charts.draw_pareto(cn.charts.drawing("pareto", cn.charts.shown(study)), ax)
