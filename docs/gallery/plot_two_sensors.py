"""
The same scene by two sensors
=============================

A ColorChecker at 10 lx and 12 ms: RGB behind an IR-cut, and RGBW without it. The right sensor
collects several times the electrons, and its color picture has more noise.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

pictures = cn.render("builtin:checker", "onyx-rgb-ircut", "onyx-rgbw", lux=10, time_ms=12)
snr_db = cn.analyze("onyx-rgb-ircut", "onyx-rgbw", lux=10, time_ms=12).color_snr_db()

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    for capture, (name, color), ax in zip(pictures.captures, snr_db.items(), axes, strict=True):
        title = f"{name}: SNR of Y {color['Y']:.1f} dB"
        cn.charts.draw_picture(capture.picture.srgb, ax, title=title)

electrons = [sum(one["mean_e"].values()) for one in pictures.summaries]
assert electrons[1] > 3 * electrons[0]
assert snr_db["onyx-rgb-ircut"]["Y"] - snr_db["onyx-rgbw"]["Y"] > 6
