"""Two channels at an angle: what unmixing costs, beside (1 - cos t) / sqrt(1 + cos^2 t)."""

import numpy as np

from chromanoise.geometry import contravariant, dual_frame, variance_inflation
from chromanoise.metrics import snr_db
from chromanoise.noise import Measurement

for angle_deg, printed_db in ((60.0, -6.9897), (30.0, -19.8899), (10.0, -39.3119)):
    t = np.radians(angle_deg)
    basis = np.array([[1.0, np.cos(t)], [0.0, np.sin(t)]])
    frame = dual_frame(basis, names=("a", "b"), metric="quanta")
    raw = Measurement(
        mean=np.array([1000.0, 1000.0]),
        covariance=1000.0 * np.eye(2),
        names=("a", "b"),
        kind="raw",
        unit="e-",
    )
    loss_db = float(snr_db(contravariant(raw, frame))["a"] - snr_db(raw)["a"])
    print(f"{angle_deg:4.0f} deg: VIF {variance_inflation(frame)[0]:6.2f}, loss {loss_db:.4f} dB")
    assert abs(loss_db - printed_db) < 5e-5
