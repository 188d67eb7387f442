"""
A front of better sensors
=========================

The search varies three Gaussian filters and the edge of an IR-cut. Each dot is a sensor that no
other candidate equals or exceeds in both SNR and color error. The references are the two sensors
of the paper; their silicon is that of the white channel of RGBW.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import chromanoise as cn

with TemporaryDirectory() as folder:
    path = Path(folder, "design.toml")
    path.write_text(cn.apps.design.DESIGN_STARTER, encoding="utf-8")
    found = cn.optimize(path, budget=8000)

with cn.charts.chromanoise_style():
    figure, ax = plt.subplots(figsize=(7.2, 4.6), layout="constrained")
    found.plot(ax)

knee, reference = found.front.knee.objectives, found.references[1].objectives
assert knee["snr_y_db"] > reference["snr_y_db"] + 2
assert knee["delta_e"] < reference["delta_e"] / 5
