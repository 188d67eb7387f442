"""The kernel in C beside this file, compiled for this machine when it is needed."""

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from subject import CHANNELS, Outputs, Plans

from chromanoise.imaging.plans import srgb_table

_SOURCE = Path(__file__).with_name("kernel.c")
_FLAGS = [
    "-O3",
    "-march=native",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-shared",
    "-fPIC",
    "-pthread",
]
_WHOLE, _REAL, _PLACE = ctypes.c_int64, ctypes.c_float, ctypes.c_void_p


class _Job(ctypes.Structure):
    """As in kernel.c."""

    _fields_ = (
        ("stored", _PLACE),
        *((name, _WHOLE) for name in ("height", "width", "bands")),
        *((name, _WHOLE) for name in ("row_step", "pixel_step", "band_step")),
        ("weights", _PLACE),
        ("tile", _PLACE),
        ("tile_rows", _WHOLE),
        ("tile_columns", _WHOLE),
        ("read_noise_e", _REAL),
        ("key", ctypes.c_uint64),
        ("frame", ctypes.c_uint64),
        *((name, _REAL) for name in ("full_well_e", "dn_per_e", "black_dn", "top_dn")),
        *((name, _PLACE) for name in ("matrices", "table", "electrons", "codes", "xyz", "srgb")),
        ("counts", _PLACE),
        ("extremes", _PLACE),
        ("threads", _WHOLE),
        ("next", _WHOLE),
    )


class NoKernelError(Exception):
    """Why there is none."""


def compiled() -> Callable[[_Job], None]:
    """The C function.

    Raises
    ------
    NoKernelError
        If there is no compiler, or it refuses.
    """
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        raise NoKernelError("no C compiler here")
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "kernel.so"
        command = [compiler, *_FLAGS, "-o", str(library), str(_SOURCE), "-lm"]
        finished = subprocess.run(command, capture_output=True, text=True, check=False)
        if finished.returncode:
            raise NoKernelError(f"the C compiler says {finished.stderr.strip().splitlines()[0]}")
        photograph = ctypes.CDLL(str(library)).photograph
    photograph.argtypes, photograph.restype = [ctypes.POINTER(_Job)], None
    return lambda job: photograph(ctypes.byref(job))


def c_paths(
    photograph: Callable[[_Job], None], plans: Plans, out: Outputs, threads: int
) -> dict[str, Callable[[], object]]:
    """Electrons, raw and color of a whole cube into ``out``."""
    places = {
        "electrons": {"electrons": out.electrons},
        "raw": {"codes": out.codes},
        "color": {"xyz": out.xyz, "srgb": out.srgb},
    }

    def path(wanted: dict[str, np.ndarray]) -> Callable[[], object]:
        counts = np.zeros((out.codes.shape[0], 2, CHANNELS))
        extremes = np.zeros((threads, 2), np.float32)
        arrays = {**wanted, "counts": counts, "extremes": extremes}

        def run() -> object:
            counts[:] = 0
            photograph(_job(plans, threads, arrays))
            return counts, extremes

        return run

    return {name: path(wanted) for name, wanted in places.items()}


def _job(plans: Plans, threads: int, arrays: dict[str, np.ndarray]) -> _Job:
    stored, draw = plans.light.cube.stored, plans.color.draw
    full_well_e, dn_per_e, black_dn, top_dn = (float(number) for number in plans.raw.adc)
    row_step, pixel_step, band_step = (stride // stored.itemsize for stride in stored.strides)
    height, width, bands = stored.shape
    read = {
        "stored": stored,
        "weights": plans.light.weights,
        "tile": plans.raw.tile,
        "matrices": plans.color.matrices,
        "table": srgb_table(),
    }
    return _Job(
        height=height,
        width=width,
        bands=bands,
        row_step=row_step,
        pixel_step=pixel_step,
        band_step=band_step,
        tile_rows=plans.raw.tile.shape[0],
        tile_columns=plans.raw.tile.shape[1],
        read_noise_e=float(draw.reading_e),
        key=int(draw.key),
        frame=int(draw.frame),
        full_well_e=full_well_e,
        dn_per_e=dn_per_e,
        black_dn=black_dn,
        top_dn=top_dn,
        threads=threads,
        **{name: array.ctypes.data for name, array in {**read, **arrays}.items()},
    )
