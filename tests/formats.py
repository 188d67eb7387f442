"""All formats of files: a whole file of each, and what is read of it, for the tests of damage."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from chromanoise.base.inputs import content_hash
from chromanoise.io.cubes import read_cube
from chromanoise.io.frames import frames_in, read_frame_set
from chromanoise.io.pixels import read_darktable_noise
from chromanoise.io.result_tables import Column, Table, table_from_json, table_json
from chromanoise.io.sensor_files import sensor_json, spectra_json
from chromanoise.io.spectra import Answers, read_curves
from chromanoise.io.spectra.writing import sensor_spectra
from chromanoise.sensor import PixelSource
from chromanoise.spectra import Grid, row_source
from chromanoise.study import (
    STARTER,
    own_sensor_of,
    provenance,
    read_pixel_source,
    read_study,
    sensor_named,
    study_from_text,
    study_of_output,
)
from damaged_cubes import FORMATS as CUBES
from frame_files import WRITERS as FRAMES, drawn
from spectrum_samples import SAMPLES as CURVES, written_files


@dataclass(frozen=True)
class Format:
    """A format of files.

    Attributes
    ----------
    write
        Writes a whole file into an empty folder, and returns the path that is read.
    read
        The numbers of the file or folder; it asserts that they are whole, and raises what the
        library raises.
    sealed
        Whether a checksum covers the numbers, so that no damage may change them.
    sentences
        Whether an error has a line for each fault.
    """

    write: Callable[[Path], Path]
    read: Callable[[Path], list[np.ndarray]]
    sealed: bool = False
    sentences: bool = False


SHEET = """# a camera
K = 0.5 DN/e-
sigma_d [e-] = 2.4
mu_e.sat: 9000 e-
PRNU,0.8,%
DSNU = 1.5 e-
mu_I = 3 e-/s
pixel pitch = 3.45 um
bits = 12
DR = 71.5 dB
"""
SHEET_JSON = '{"sigma_d": {"value": 2.4, "unit": "e-"}, "K": {"value": 0.5, "unit": "DN/e-"}}'
PROFILE = '{"S": [1e-4, 1.01e-4], "O": [1e-6, 1e-6], "black_level_dn": 64, "white_level_dn": 1023}'
TRANSFER = "mean_dn,variance_dn2,samples,light\n100,4.1,1000,dark\n" + "".join(
    f"{100 + m},{0.5 * m + 4.1},1000,light\n" for m in range(50, 1000, 100)
)
PIXEL_TOML = """schema = "chromanoise pixel"
schema_version = 1
pitch_um = 3.45
full_well_e = 9000 # e-
read_noise_e = 2.4
gain_dn_per_e = 0.5
bits = 12
black_level_dn = 64.5
dark_current_e_per_s = 3
dsnu_e = 1.5
prnu = 0.008
row_noise_e = 0.3
qe = 0.6
source = "a camera"
notes = ["one", "two"]
"""
DARKTABLE = json.dumps(
    {
        "version": 0,
        "noiseprofiles": [
            {
                "maker": "A",
                "models": [
                    {
                        "model": "B",
                        "profiles": [{"name": "x", "iso": 100, "a": [2e-6] * 3, "b": [2e-8] * 3}],
                    }
                ],
            }
        ],
    }
)
STUDY = STARTER.replace("# [[pictures]]\n# cube", "[[pictures]]\ncube") + "clip = false\n"
SENSOR = sensor_named("model-rgb", Grid.uniform(400, 1050, 50))
TABLE = Table(
    title="t", columns=(Column(name="a", unit="dB", digits=".2f"),), rows=((1.5,), (None,))
)


def _put(name, content, folder):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def _rows(options, path):
    given = {k: str(path.parent / v) if isinstance(v, str) else v for k, v in options.items()}
    cube = read_cube(path, **given)
    at, source = cube.wavelength_nm, row_source(cube.stored)
    assert at.size == source.shape[2]
    assert (np.diff(at) > 0).all()
    rows = source.rows(0, min(source.shape[0], 8))
    assert rows.shape[1:] == source.shape[1:]
    return [rows]


def _codes(path):
    read = [(frame, frame.codes()) for frame in frames_in(path)]
    assert all(codes.dtype.kind in "ui" and codes.shape == one.shape for one, codes in read)
    return [codes for _, codes in read]


def _curves(answers, path):
    curves = read_curves(path, answers=Answers(**answers)).curves
    assert np.isfinite(curves.values).all()
    assert (np.diff(curves.wavelength_nm) > 0).all()
    assert curves.names
    return [curves.wavelength_nm, curves.values]


def _written_curve(file, folder):
    for name, content in file.beside.items():
        _put(name, content, folder)
    return _put(file.name, file.content, folder)


def _listed_frames(name, folder):
    for i in range(8):
        np.save(folder / f"f{i}.npy", drawn(4, 6))
    np.save(folder / "s.npy", np.stack([drawn(4, 6)] * 2))
    return _put(name, LISTS[name], folder)


def _levels(path):
    levels = read_frame_set([path]).levels
    assert levels
    return [frame.codes() for level in levels for frame in level.frames]


def _pixel(path):
    """A pixel has no sense below 0."""
    source = read_pixel_source(path)
    assert isinstance(source, PixelSource)
    names = ("pitch_um", "full_well_e", "read_noise_e", "dsnu_e", "prnu", "dark_current_e_per_s")
    values = np.array([value for name in names if (value := getattr(source, name)) is not None])
    assert np.isfinite(values).all()
    assert (values >= 0).all()
    return [values]


def _own_sensor(path):
    sensor = own_sensor_of(path)
    if sensor is None:  # its head was hit: it is another's JSON then
        head = path.read_bytes()[:200]
        assert b'"chromanoise sensor"' not in head or not head.lstrip().startswith(b"{")
        return []
    assert ((sensor.qe >= 0) & (sensor.qe <= 1)).all()
    assert sensor.qe.shape == (sensor.grid.n, len(sensor.names))
    return [sensor.qe]


def _darktable(path):
    noise = read_darktable_noise(path, maker="A", model="B", iso=100)
    return [noise.a, noise.b]


def _nothing(read, path):
    assert read(path) is not None
    return []


def _table(path):
    return table_from_json(path.read_bytes().decode("utf-8", "replace"), source=str(path))


LISTS = {
    "capture.toml": b"""mosaic = "RG/GB"
bits = 12
darks = ["f[67].npy"]
[[levels]]
flats = ["f0.npy", "f1.npy"]
time_ms = 5
photons_per_pixel = 310.5
[[levels]]
name = "own"
flats = ["s.npy[0]", "s.npy[1]", "f2*"]
darks = ["f3.npy", "f4.npy"]
""",
    "descriptor.txt": b"""v 4.0
n 12 6 4
b 1000000 350.5
i f0.npy
i f1.npy
d 1000000
i f2.npy
i f3.npy
""",
}
RECORD = provenance(study_from_text(STARTER, source="starter"))
OUTPUT = json.dumps(RECORD | {"content": content_hash(RECORD)}, indent=1)
PIXELS = {"sheet": SHEET, "sheet json": SHEET_JSON, "profile": PROFILE, "transfer": TRANSFER,
          "pixel toml": PIXEL_TOML}  # fmt: skip


def _frame(file, write, folder):
    write(folder / file, drawn())
    return folder / file


FORMATS: dict[str, Format] = {
    **{
        f"cube {name}": Format(write, partial(_rows, options), sealed)
        for name, (write, options, sealed) in CUBES.items()
    },
    **{
        f"frame {name}": Format(partial(_frame, file, write), _codes)
        for name, (file, write) in FRAMES.items()
    },
    **{f"frames {name}": Format(partial(_listed_frames, name), _levels) for name in LISTS},
    **{
        f"curves {name}": Format(partial(_put, name, content), partial(_curves, {}))
        for name, content in CURVES.items()
    },
    **{
        f"curves of {file.maker}": Format(
            partial(_written_curve, file), partial(_curves, file.answers)
        )
        for file in written_files()
    },
    **{name: Format(partial(_put, f"{name}.json", text), _pixel) for name, text in PIXELS.items()},
    "darktable": Format(partial(_put, "a.json", DARKTABLE), _darktable),
    "sensor": Format(partial(_put, "a.json", sensor_json(SENSOR)), _own_sensor),
    "spectra": Format(
        partial(_put, "a.json", spectra_json(sensor_spectra(SENSOR))), partial(_curves, {})
    ),
    "table": Format(partial(_put, "a.json", table_json(TABLE)), partial(_nothing, _table)),
    "output": Format(partial(_put, "a.json", OUTPUT), partial(_nothing, study_of_output)),
    "study": Format(partial(_put, "a.toml", STUDY), partial(_nothing, read_study), sentences=True),
}
"""Formats by name; of the files of an instrument, one."""
