"""
SNR from the scene to color
===========================

Each column is a stage of one camera: the light, the electrons, their SNR (eq. 7), the SNR after
the channels are unmixed (eq. 3) and the SNR of X, Y, Z (eq. 6). Without IR-cut (above) every
channel has the higher raw SNR, and every color the lower one.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

pair = cn.analyze("onyx-rgbw", "onyx-rgb-ircut", lux=10, time_ms=12)

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(2, 1, figsize=(8.8, 5.1), layout="constrained")
    for analysis, ax in zip(pair.analyses, axes, strict=True):
        cn.charts.draw_flow(analysis, ax)

raw, color = pair.raw_snr_db(), pair.color_snr_db()
assert raw["onyx-rgbw"]["G"] > raw["onyx-rgb-ircut"]["G"]
assert color["onyx-rgbw"]["Y"] < color["onyx-rgb-ircut"]["Y"] - 6
