"""
Quantum efficiency of four sensors
==================================

The curves of each channel over wavelength. All silicon is sensitive to the near infrared (shaded)
unless a filter blocks it. The title names curves that are a model or a reconstruction.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

names = ["onyx-rgbw", "onyx-rgb-ircut", "mt9v024-rgbw", "model-cmy"]
sensors = [cn.sensor_named(name) for name in names]

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(2, 2, figsize=(9.6, 6), layout="constrained")
    top = 1.15 * max(float(sensor.qe.max()) for sensor in sensors)
    for sensor, ax in zip(sensors, axes.flat, strict=True):
        cn.charts.draw_sensitivities(sensor, ax, top=top, dashes="solid")
