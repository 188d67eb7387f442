"""
Noise of each patch
===================

Color noise of the 24 patches of the ColorChecker at 10 lx: the mean difference ΔE*ab of a pixel
from the mean color of its patch. The sensor behind the IR-cut has the lower noise on every patch.
"""

import matplotlib.pyplot as plt
import numpy as np

import chromanoise as cn

names = ["onyx-rgbw", "onyx-rgb-ircut"]
pair = cn.analyze(*names, lux=10, time_ms=12, chart=True)
noise = {}
with cn.charts.chromanoise_style():
    figure, ax = plt.subplots(figsize=(7.2, 6), layout="constrained")
    for name, data, mark in zip(names, pair.to_dict()["sensors"], "os", strict=True):
        patches = [one["patch"] for one in data["chart"]]
        noise[name] = np.array([one["noise_delta_e"] for one in data["chart"]])
        ax.plot(
            noise[name], patches, mark, color="black", fillstyle="full" if mark == "s" else "none"
        )
        ax.annotate(name, (noise[name][0], 0), (6, 5), textcoords="offset points")
    ax.hlines(patches, *noise.values(), color="gray", linewidth=0.8, zorder=0)
    ax.set(
        xscale="log",
        xlabel="color noise of a patch [ΔE*ab]",
        title="ColorChecker at 10 lx, 12 ms, f/1.8",
    )
    ax.set_xticks([4, 6, 10, 20, 40], ["4", "6", "10", "20", "40"])
    ax.minorticks_off()
    ax.invert_yaxis()
    ax.grid(visible=True, axis="x", alpha=0.25)

assert (noise["onyx-rgb-ircut"] < noise["onyx-rgbw"]).all()
