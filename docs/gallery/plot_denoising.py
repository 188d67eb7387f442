"""
Denoising with the known noise
==============================

Foliage at 3 lx with RGBW without IR-cut (above) and RGB behind an IR-cut (below), as captured and
denoised by ``guided``. The method needs no tuning, because the noise of each pixel is known from
the sensor and the exposure. The picture without IR-cut has more noise and gains more.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

names = ["onyx-rgbw", "onyx-rgb-ircut"]
with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(2, 2, figsize=(6.4, 6.6), layout="constrained")
    for method, column in zip(("none", "guided"), axes.T, strict=True):
        pictures = cn.render("builtin:foliage", *names, lux=3, time_ms=12, denoise=method)
        for name, capture, ax in zip(names, pictures.captures, column, strict=True):
            title = f"{name}, " + ("as captured" if method == "none" else f"{method}")
            cn.charts.draw_picture(capture.picture.srgb[:160, :160], ax, title=title)
