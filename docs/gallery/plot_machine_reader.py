"""
An eye and a machine prefer different sensors
=============================================

For an eye, the noise of luminance matters. For a machine that reads raw values, only the distance
of two patches in units of their noise matters. The sensor with IR-cut is better for the eye (left
panel), the sensor without it is better for the machine (right panel).
"""

import matplotlib.pyplot as plt

import chromanoise as cn

names = ["onyx-rgbw", "onyx-rgb-ircut"]
light = {"time_ms": 12, "first": 0.05, "last": 9, "points": 31}
quantities = {"snr-y": "for an eye", "separation": "for a machine"}
swept = {quantity: cn.compare(*names, quantity=quantity, **light) for quantity in quantities}

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 4), layout="constrained")
    for ax, (quantity, title) in zip(axes, quantities.items(), strict=True):
        swept[quantity].plot(ax).set_title(title)

eye, machine = ([curve.value for curve in one.curves] for one in swept.values())
assert (eye[0] < eye[1]).all()
assert (machine[0] > machine[1]).all()
