"""
Noise in the plane of two channels
==================================

Two channels are two vectors in the space of spectra. Each measures the light along its direction,
up to its noise (gray stripe); the light is where the stripes cross. The smaller the angle of the
vectors, the longer the ellipse: between red and blue behind the IR-cut (above) and between the
closest pair of RGBW (below).
"""

import matplotlib.pyplot as plt

import chromanoise as cn

planes = cn.apps.paper.paper_planes(cn.apps.paper.paper_study())

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(2, 1, figsize=(6.8, 8.4), layout="constrained")
    titles = ("Weakly correlated: ", "Highly correlated: ")
    for (plane, noise), title, ax in zip(planes.correlation, titles, axes, strict=True):
        cn.apps.paper.draw_uncertainty(plane, noise, ax, title=title)
