"""The table of docs/findings.md on what PRNU, crosstalk, dark current and quantization cost.

    python tools/pixel_findings.py

prints it. Each source is added alone to shot and read noise.
"""

from typing import Any

import numpy as np

import chromanoise as cn

TIME_MS = 11.94
SENSORS: dict[str, dict[str, Any]] = {
    "onyx-rgbw": {},
    "onyx-rgb-ircut": {},
    "mt9v024-rgb": {"filter": "ircut-650"},
}
SOURCES: dict[str, dict[str, Any]] = {
    "PRNU 1 %": {"prnu": 0.01},
    "crosstalk 10 %": {"crosstalk": 0.1},
    "dark current 5,000 e⁻/s": {"dark_current_e_per_s": 5000.0},
    "quantization, 8 bits": {"bits": 8},
}
LEVELS_LUX = (10.0, 1.0)
COLOR = ("X", "Y", "Z")


def snr_db(name: str, lux: float, **source: Any) -> tuple[list[float], list[float]]:
    """SNR of a perfect white: of each channel, and of X, Y, Z by the kernel matrix."""
    settings = {"lux": lux, "time_ms": TIME_MS, **SENSORS[name], **source}
    result = cn.analyze(name, **settings).to_dict()["sensors"][0]
    raw = [channel["snr_db"] for channel in result["channels"]]
    return raw, [result["color"]["snr_db"][each] for each in COLOR]


def losses(name: str, lux: float, source: str) -> list[str]:
    """Losses of SNR in dB: mean of the channels with their range, then X, Y, Z."""
    raw, color = (
        np.subtract(before, after)
        for before, after in zip(
            snr_db(name, lux), snr_db(name, lux, **SOURCES[source]), strict=True
        )
    )
    mean = f"{raw.mean():.2f} ({raw.min():.2f} to {raw.max():.2f})"
    return [mean, *(f"{loss:.2f}" for loss in color)]


def main() -> None:
    """Print the table as Markdown."""
    columns = [f"{part}, {lux:g} lx" for lux in LEVELS_LUX for part in ("raw", *COLOR)]
    print("| sensor | source | " + " | ".join(columns) + " |")
    print("|---" * (2 + len(columns)) + "|")
    for name in SENSORS:
        for source in SOURCES:
            cells = [cell for lux in LEVELS_LUX for cell in losses(name, lux, source)]
            print("| " + " | ".join([name, source, *cells]) + " |")


if __name__ == "__main__":
    main()
