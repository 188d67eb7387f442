"""Damaged files of pixels, studies, outputs and our own JSON: a right result or sentences."""

import json
import os
import resource
import time

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from chromanoise.base.errors import InputError
from chromanoise.base.inputs import content_hash
from chromanoise.io.pixels import RelativeNoise, read_darktable_noise
from chromanoise.io.result_tables import Column, Table, table_from_json, table_json
from chromanoise.io.sensor_files import sensor_json, spectra_json
from chromanoise.io.spectra import ParsedSpectra, read_curves
from chromanoise.io.spectra.writing import sensor_spectra
from chromanoise.sensor import PixelSource, Sensor
from chromanoise.spectra import Grid
from chromanoise.study import (
    STARTER,
    Study,
    own_sensor_of,
    provenance,
    read_pixel_source,
    read_study,
    sensor_named,
    study_from_text,
    study_of_output,
)
from damage import TOKENS, mutated, random_edits

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


def read_darktable(path):
    return read_darktable_noise(path, maker="A", model="B", iso=100)


def read_table(path):
    return table_from_json(path.read_bytes().decode("utf-8", "replace"), source=str(path))


RECORD = provenance(study_from_text(STARTER, source="starter"))
COUNT = int(os.environ.get("CHROMANOISE_DAMAGED_FILES", "100000"))
SAMPLES = {
    "sheet": (read_pixel_source, SHEET),
    "sheet-json": (read_pixel_source, SHEET_JSON),
    "profile": (read_pixel_source, PROFILE),
    "transfer": (read_pixel_source, TRANSFER),
    "pixel-toml": (read_pixel_source, PIXEL_TOML),
    "darktable": (read_darktable, DARKTABLE),
    "study": (read_study, STUDY),
    "output": (
        study_of_output,
        json.dumps(RECORD | {"content": content_hash(RECORD)}, indent=1),
    ),
    "sensor-json": (own_sensor_of, sensor_json(SENSOR)),
    "spectra-json": (read_curves, spectra_json(sensor_spectra(SENSOR))),
    "table": (read_table, table_json(TABLE)),
}
SENTENCES = ("study",)  # all its faults at once, one line each


def right_or_refused(read, path, name):
    """What was read, or why not: sentences that name the file and are not endless."""
    try:
        result = read(path)
    except InputError as error:
        lines = str(error).splitlines()
        assert len(lines) == 1 or name in SENTENCES
        for line in lines:
            assert path.name in line, line
            assert len(line) < 2000
        return False
    if result is None:  # of our own JSON whose head was hit: it is another's then
        head = path.read_bytes()[:200]
        assert b'"chromanoise sensor"' not in head or not head.lstrip().startswith(b"{")
        return True
    assert isinstance(result, KINDS[name])
    assert all(np.isfinite(value) and value >= 0 for value in numbers_of(result))
    if isinstance(result, Sensor):
        assert ((result.qe >= 0) & (result.qe <= 1)).all()
        assert result.qe.shape == (result.grid.n, len(result.names))
    return True


KINDS = dict.fromkeys(("sheet", "sheet-json", "profile", "transfer", "pixel-toml"), PixelSource) | {
    "darktable": RelativeNoise,
    "study": Study,
    "output": Study,
    "sensor-json": Sensor,
    "spectra-json": ParsedSpectra,
    "table": Table,
}


def numbers_of(result):
    """What a pixel is made of, which has no sense below 0; and the curves of a file."""
    if isinstance(result, PixelSource):
        given = (
            result.pitch_um,
            result.full_well_e,
            result.read_noise_e,
            result.dsnu_e,
            result.prnu,
        )
        return [value for value in (*given, result.dark_current_e_per_s) if value is not None]
    if isinstance(result, Sensor):
        pixel = result.pixel
        return [pixel.pitch_um, pixel.full_well_e, pixel.read_noise_e]
    if isinstance(result, ParsedSpectra):
        return np.abs(result.curves.values).ravel()
    return []


edits = st.lists(
    st.tuples(
        st.floats(0, 1, exclude_max=True),
        st.integers(0, 40),
        st.one_of(st.sampled_from(TOKENS), st.binary(max_size=6)),
    ),
    min_size=1,
    max_size=6,
)


@pytest.mark.parametrize("name", SAMPLES)
def test_a_whole_file_is_read(tmp_path, name):
    read, text = SAMPLES[name]
    path = tmp_path / f"{name}.json"
    path.write_text(text)
    assert right_or_refused(read, path, name)


@pytest.mark.parametrize("name", SAMPLES)
@settings(max_examples=80, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(edits)
def test_a_damaged_file_is_read_right_or_refused_in_sentences(tmp_path, name, changes):
    read, text = SAMPLES[name]
    path = tmp_path / f"{name}.json"
    path.write_bytes(mutated(text.encode(), changes))
    right_or_refused(read, path, name)


@pytest.mark.evidence
def test_very_many_damaged_files_are_read_right_or_refused(tmp_path):
    rng = np.random.default_rng(5)
    names = list(SAMPLES)
    right = dict.fromkeys(names, 0)
    slowest = 0.0
    for i in range(COUNT):
        name = names[i % len(names)]
        read, text = SAMPLES[name]
        changes = random_edits(rng)
        path = tmp_path / f"{name}.json"
        path.write_bytes(mutated(text.encode(), changes))
        start = time.perf_counter()
        right[name] += right_or_refused(read, path, name)
        slowest = max(slowest, time.perf_counter() - start)
    print(f"read right: {right}; slowest {slowest:.2f} s")
    assert slowest < 10.0
    assert COUNT < 100_000 or min(right.values()) > 0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 2**20  # KiB: 1 GiB
