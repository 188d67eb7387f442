"""
Does the camera follow the linear model?
========================================

Two virtual cameras. The gain of the second one falls by 10 % from dark to full well, and its frames
show it: the measured variance differs from the prediction by many standard errors, and the
response deviates from the straight line. Open marks were not used for the fit of the gain.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import chromanoise as cn
from chromanoise.apps.camera import VirtualCamera, photon_transfer_frames, plane_curves

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(2, 2, figsize=(9.4, 6.2), sharex="col", layout="constrained")
    for bend, row in zip((0.0, 0.1), axes, strict=True):
        with TemporaryDirectory() as folder:
            camera = VirtualCamera(bend=bend, shape=(160, 160))
            photon_transfer_frames(camera, folder=Path(folder), levels=12)
            measured = cn.characterize(folder)
        curves = [plane_curves(plane) for plane in measured.planes]
        cn.apps.camera.draw_variance_residuals(curves, row[0])
        cn.apps.camera.draw_linearity_deviation(curves, row[1])
        row[0].set_title(f"gain falls by {100 * bend:.0f} %: variance")
        row[1].set_title("mean")
        assert measured.verdict.holds == (bend == 0)
