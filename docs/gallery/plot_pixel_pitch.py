"""
Smaller pixels
==============

A pixel of half the pitch gets a quarter of the light. Full well shrinks with the area; read noise
does not. At 10 lx shot noise prevails, and each halving of the pitch costs about 6 dB. In low
light read noise prevails, and it costs up to 12 dB.
"""

import matplotlib.pyplot as plt
import numpy as np

import chromanoise as cn

pitches_um = np.geomspace(0.8, 10, 21)
color = cn.charts.sensor_lines(["onyx-rgb-ircut"])["onyx-rgb-ircut"]["color"]
with cn.charts.chromanoise_style():
    figure, ax = plt.subplots(figsize=(7, 4.2), layout="constrained")
    for level_lux, dashes in ((10.0, "solid"), (1.0, (0, (6, 2))), (0.1, (0, (2, 1.2)))):
        snr_db = []
        for pitch_um in pitches_um:
            pixel = {"pitch_um": pitch_um, "full_well_e": 100 * pitch_um**2, "read_noise_e": 2}
            seen = cn.analyze("onyx-rgb-ircut", lux=level_lux, time_ms=12, **pixel)
            snr_db.append(seen.color_snr_db()["onyx-rgb-ircut"]["Y"])
        ax.plot(pitches_um, snr_db, color=color, linestyle=dashes)
        ax.annotate(
            f"{level_lux:g} lx", (pitches_um[-1], snr_db[-1]), (4, -3), textcoords="offset points"
        )
    ax.set(xscale="log", xlabel="pixel pitch [µm]", ylabel="SNR of Y [dB]", xlim=(0.75, 14))
    ax.set_xticks([1, 2, 5, 10], ["1", "2", "5", "10"])
    ax.set_title("onyx-rgb-ircut with other pixels at 12 ms, f/1.8, read noise 2 e-")
    ax.grid(visible=True, alpha=0.25)
