"""Can I drop the IR-cut? The paper's question for its own sensors, at 10 lx and 12 ms."""

from chromanoise.color import colored, kernel_matrix
from chromanoise.metrics import color_snr_loss_db, optimal_linear_snr_db, snr_db
from chromanoise.noise import Exposure, expected_electrons, with_noise
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import sensor_named

scene = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
exposure = Exposure(time_s=0.012, f_number=1.8)

luminance_db = {}
for name in ("onyx-rgbw", "onyx-rgb-ircut"):  # both a reconstruction
    sensor = sensor_named(name, DEFAULT_GRID)
    raw = with_noise(expected_electrons(scene, sensor, exposure), sensor)  # eq. 1, 2, 7
    xyz = colored(raw, kernel_matrix(sensor, exposure))  # eq. 3-6
    luminance_db[name] = float(snr_db(xyz)["Y"])
    green = float(snr_db(raw)["G"])
    print(
        f"{name}: green {green:.1f} dB, bound {optimal_linear_snr_db(raw):.1f} dB, "
        f"luminance {luminance_db[name]:.1f} dB, price {color_snr_loss_db(raw, xyz):.1f} dB"
    )

loss_db = luminance_db["onyx-rgb-ircut"] - luminance_db["onyx-rgbw"]
print(f"Without the IR-cut the luminance is {loss_db:.1f} dB worse.")
assert abs(loss_db - (32.4 - 26.1)) < 0.6  # Table 3 of the paper, each figure within 0.3 dB
