"""
A map of two parameters
=======================

The SNR of luminance over the light and the edge of an IR-cut in front of RGBW. More light raises
the SNR by tens of decibels. The best edge, near 740 nm with the kernel matrix, does not depend on
the light level.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

mapped = cn.compare_map(
    "onyx-rgbw",
    vary="lux",
    first=0.1,
    last=9,
    points=25,
    second_vary="ircut-nm",
    second_first=580,
    second_last=900,
    second_points=25,
    time_ms=12,
)

with cn.charts.chromanoise_style():
    figure, ax = plt.subplots(figsize=(7, 4.4), layout="constrained")
    mapped.plot(ax)

values, edges_nm = mapped.maps[0].value, mapped.maps[0].second_at
assert set(edges_nm[values.argmax(axis=0)]) == {edges_nm[12]}
