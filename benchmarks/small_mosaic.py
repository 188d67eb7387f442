"""A cube of 512 x 512 x 66 to the codes of a 12-bit RGBW 2x2 mosaic, warm, one thread for each.

Fifteen lines of numpy do all of it. The peers know no mosaic, so each is given the electrons that
numpy makes of the cube, and does shot noise, read noise and converter; its time holds both.
"""

import importlib
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from memory import status_bytes
from subject import CHANNELS, SEED, cube_of, operating_point, textured

from chromanoise.imaging import Work, acquired
from chromanoise.imaging.plans import light_of
from chromanoise.noise import OperatingPoint
from chromanoise.sensor import rgbw_2x2
from chromanoise.spectra import Cube

SIDE, BANDS, BITS = 512, 66, 12
Doing = Callable[[], object]
Electrons = Callable[[], np.ndarray]


def small_cube() -> Cube:
    """Of 512 x 512 pixels and 66 bands."""
    return cube_of(textured(SIDE, SIDE, BANDS))


def small_paths(cube: Cube) -> tuple[dict[str, Doing], list[str]]:
    """What takes part, and a line for each that cannot."""
    at = operating_point()
    electrons = _electrons_by_numpy(cube, at)
    paths: dict[str, Doing] = {
        "here": lambda: acquired(cube, at, mosaic=rgbw_2x2(), seed=SEED, work=Work(threads=1)),
        "here, all cores": lambda: acquired(cube, at, mosaic=rgbw_2x2(), seed=SEED),
        "numpy": _fifteen_lines(electrons, at),
    }
    missing = []
    for name, peer in {"prysm": _prysm, "getframes": _getframes}.items():
        try:
            paths[name] = peer(electrons, at)
        except ImportError:
            missing.append(f"{name} is not installed (it is in the extra `bench`)")
    return paths, missing


def _electrons_by_numpy(cube: Cube, at: OperatingPoint) -> Electrons:
    """Expected electrons of the channel over each pixel: only these are computed."""
    light = light_of(cube, at, beyond="refuse")
    weights = light.weights[:CHANNELS, : cube.stored.shape[2]].T
    names = at.sensor.names
    pattern = [[names.index(name) for name in row] for row in rgbw_2x2().pattern]

    def electrons() -> np.ndarray:
        mean_e = np.empty(cube.stored.shape[:2], np.float32)
        for y, row in enumerate(pattern):
            for x, channel in enumerate(row):
                mean_e[y::2, x::2] = cube.stored[y::2, x::2] @ weights[:, channel]
        return mean_e

    return electrons


def _fifteen_lines(electrons: Electrons, at: OperatingPoint) -> Doing:
    pixel, top = at.sensor.pixel, 2**BITS - 1
    dn_per_e = top / pixel.full_well_e
    rng = np.random.default_rng(SEED)

    def codes() -> np.ndarray:
        mean_e = electrons()
        noisy = rng.poisson(mean_e).astype(np.float32)
        noisy += pixel.read_noise_e * rng.standard_normal(mean_e.shape, dtype=np.float32)
        noisy = np.minimum(noisy, pixel.full_well_e)
        return np.clip(np.round(noisy * dn_per_e), 0, top).astype(np.uint16)

    return codes


def _prysm(electrons: Electrons, at: OperatingPoint) -> Doing:
    pixel = at.sensor.pixel
    detector = importlib.import_module("prysm.detector").Detector(
        dark_current=0,
        read_noise=pixel.read_noise_e,
        bias=0,
        fwc=pixel.full_well_e,
        conversion_gain=pixel.full_well_e / (2**BITS - 1),
        bits=BITS,
        exposure_time=1,
    )
    return lambda: detector.expose(electrons())


def _getframes(electrons: Electrons, at: OperatingPoint) -> Doing:
    getframes, pixel = importlib.import_module("getframes"), at.sensor.pixel
    config = getframes.CameraConfig(
        name="paper",
        sensor_type="CMOS",
        resolution=(SIDE, SIDE),
        pixel_size_um=pixel.pitch_um,
        quantum_efficiency=1.0,
        full_well_e=pixel.full_well_e,
        bit_depth=BITS,
        gain_e_per_adu=pixel.full_well_e / (2**BITS - 1),
        bias_offset_adu=0.0,
        read_noise_e=pixel.read_noise_e,
        dark_current_e_per_s=0.0,
    )
    camera = getframes.Camera(config, seed=SEED, precision="float32")
    return lambda: camera.expose(electrons(), 1.0, include_truth=False)


def peak_of_cube() -> float:
    """Peak memory of a whole process over the cube's size, less what it held before the cube."""
    printed = subprocess.run(
        [sys.executable, str(Path(__file__)), "peak"], capture_output=True, text=True, check=True
    )
    return float(printed.stdout)


def _peak() -> float:
    """In a process of its own: warm up on a small cube, then take a large one."""
    importlib.import_module("numba")  # so that kernels, too, are there before the large one
    at, work = operating_point(), Work(threads=2)
    acquired(cube_of(textured(64, 64, BANDS)), at, mosaic=rgbw_2x2(), work=work)
    before = status_bytes("VmRSS")
    cube = cube_of(np.full((SIDE, SIDE, BANDS), 0.4, np.float32))
    Path("/proc/self/clear_refs").write_text("5")  # the peak is counted from here
    acquired(cube, at, mosaic=rgbw_2x2(), work=work)
    return (status_bytes("VmHWM") - before) / cube.stored.nbytes


if __name__ == "__main__":
    print(_peak())
