"""
Photon transfer of a camera
===========================

The variance of the codes over their mean, from 32 frames of a virtual camera. The slope of each
line is the gain of a plane (a position of the mosaic): all four are within 4 standard errors of
the true 0.3 DN/e-.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import chromanoise as cn
from chromanoise.apps.camera import VirtualCamera, photon_transfer_frames

camera = VirtualCamera(
    mosaic="RG/GB", sensitivity=(0.7, 1.0, 0.6), gain_dn_per_e=0.3, shape=(160, 160)
)
with TemporaryDirectory() as folder:
    photon_transfer_frames(camera, folder=Path(folder), levels=8)
    measured = cn.characterize(folder)

with cn.charts.chromanoise_style():
    figure, ax = plt.subplots(figsize=(7, 4.4), layout="constrained")
    measured.plot(ax).set_title("Photon transfer of a virtual camera (EMVA 1288)")

for plane in measured.planes:
    assert abs(plane.gain_dn_per_e - 0.3) < 4 * plane.gain_dn_per_e_se
