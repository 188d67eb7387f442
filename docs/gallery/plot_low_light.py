"""
RGBW against RGB in the dark
============================

At 0.26 lx an LMMSE matrix gives up color to keep noise down. The sensors then have the same SNR of
luminance, and both pictures have lost most of their color.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

names = ["onyx-rgbw", "onyx-rgb-ircut"]
with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(2, 2, figsize=(8.4, 6.2), layout="constrained")
    for matrix, row in zip(("kernel", "lmmse"), axes, strict=True):
        settings = {"lux": 0.26, "time_ms": 12, "matrix": matrix}
        pictures = cn.render("builtin:checker", *names, **settings)
        snr_db = cn.analyze(*names, **settings).color_snr_db()
        for name, capture, ax in zip(names, pictures.captures, row, strict=True):
            title = f"{name}, {matrix}: SNR of Y {snr_db[name]['Y']:.1f} dB"
            cn.charts.draw_picture(capture.picture.srgb, ax, title=title)

assert abs(snr_db["onyx-rgbw"]["Y"] - snr_db["onyx-rgb-ircut"]["Y"]) < 0.2
