"""
Where a picture is wrong: CIEDE2000 and S-CIELAB
================================================

Both maps compare a noisy picture with the picture of the same camera without noise. CIEDE2000
compares each pixel alone. S-CIELAB first blurs as an eye does at 60 pixels per degree, so that
fine noise has less effect.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

settings = {"lux": 3, "time_ms": 12}
picture = cn.render("builtin:slanted-edges", "onyx-rgb-ircut", **settings).captures[0].picture
made = cn.matrix("onyx-rgb-ircut", **settings)
mean_e = cn.imaging.electrons_of_cube(cn.spectra.builtin_cube("builtin:slanted-edges"), made.point)
clean = mean_e @ made.matrix.matrix.T / made.white_lux
pixel = cn.metrics.picture_color_difference(picture.xyz, clean, picture.white)
eye = cn.metrics.scielab_difference(picture.xyz, clean, picture.white, pixels_per_degree=60)

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(1, 3, figsize=(10.4, 3.3), layout="constrained")
    cn.charts.draw_picture(picture.srgb, axes[0], title="picture at 3 lx")
    for ax, values, name in zip(axes[1:], (pixel, eye), ("CIEDE2000", "S-CIELAB"), strict=True):
        shown = ax.imshow(values, cmap="viridis", vmin=0, vmax=20, interpolation="none")
        ax.set_title(f"{name}: mean {values.mean():.1f}")
        ax.set_axis_off()
    figure.colorbar(shown, ax=axes[1:], label="color difference [1]", shrink=0.85, extend="max")

assert eye.mean() < pixel.mean() / 2
