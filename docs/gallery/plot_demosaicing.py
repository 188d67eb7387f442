"""
Mosaic and noise after demosaicing
==================================

Behind a Bayer mosaic each pixel has one channel (left: its codes as gray), and demosaicing
estimates the other two. A linear method correlates the noise of neighboring pixels. The number in
the other titles is the noise of Y on the gray patch, relative to white.
"""

import matplotlib.pyplot as plt
import numpy as np

import chromanoise as cn

part = np.s_[165:295, 90:220]  # of the chart [px]
gray = np.s_[248:296, 172:220]  # the flat part of a gray patch [px]
noise = {}
with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(1, 4, figsize=(10, 3.1), layout="constrained")
    for method, ax in zip(("bilinear", "malvar", "lmmse"), axes[1:], strict=True):
        settings = {"lux": 2, "time_ms": 12, "mosaic": "bayer", "demosaic": method}
        capture = cn.render("builtin:checker", "onyx-rgb-ircut", **settings).captures[0]
        noise[method] = 100 * float(np.std(capture.picture.xyz[gray][..., 1], dtype=float))
        title = f"{method}: {noise[method]:.1f} %"
        cn.charts.draw_picture(capture.picture.srgb[part], ax, title=title)
    axes[0].imshow(capture.raw.codes[part], cmap="gray", interpolation="none")
    axes[0].set_title("raw codes")
    axes[0].set_axis_off()

assert noise["lmmse"] < noise["malvar"]
