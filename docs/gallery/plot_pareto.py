"""
Color error against visual noise
================================

A color matrix can give exact colors or little noise. Each curve is the trade-off of one sensor:
from the least color error to a nearly gray picture, with matrices that know the noise. The large
marks are the paper's matrix. Where colors are usable, the sensor behind the IR-cut has less noise
at every color error.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

study = cn.study_from_data(
    {
        "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut"}],
        "light": {"level_lux": 1.0},
        "exposure": {"time_ms": 12.0},
        "matrices": ["kernel"],
    },
    source="gallery",
)
with cn.charts.chromanoise_style():
    figure, ax = plt.subplots(figsize=(7, 4.4), layout="constrained")
    cn.charts.draw_pareto(cn.charts.drawing("pareto", cn.charts.shown(study)), ax)
