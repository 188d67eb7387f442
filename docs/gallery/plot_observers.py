"""
Two observers: 2 degrees and 10 degrees
=======================================

The color-matching functions of CIE 1931 (2 degrees) and CIE 1964 (10 degrees). The noise of a color
depends on the observer, because each color is a projection of the measured light on its functions.
The titles give the SNR of X, Y and Z of the same readings.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 3.6), sharey=True, layout="constrained")
    for observer, ax in zip(("cie-1931-2", "cie-1964-10"), axes, strict=True):
        curves = cn.spectra.color_matching_functions(cn.spectra.DEFAULT_GRID, observer)
        cn.apps.paper.draw_observer(curves, ax)
        seen = cn.analyze("onyx-rgb-ircut", lux=10, time_ms=12, observer=observer)
        snr = seen.color_snr_db()["onyx-rgb-ircut"]
        ax.set_title(f"{observer}: " + ", ".join(f"{k} {v:.1f} dB" for k, v in snr.items()))
