"""A noise source costs two edits, in two files; tools write its stub and man pages."""

import pytest

from chromanoise.study import hashes, study_from_data, study_hash
from edited_copies import answers_of_copy

PROPERTY = """    flicker_noise_e: Annotated[
        float,
        Property(
            label="flicker noise", unit="e-", least=0.0, most=_MOST, slider=(0.0, 20.0, 0.2),
            help="Standard deviation of the flicker of a reading [e-].",
            growth=Growth(readings=0.5), later=True,
        ),
    ] = 0.0
"""
ENTRY = """    NoiseSource(
        cause="flicker noise", drawn="reading", term="floor_e2",
        value=lambda of: of.pixel.flicker_noise_e**2,
    ),
"""
EDITS = {
    "sensor/pixel.py": ("    black_error_e: Annotated[", PROPERTY),
    "sensor/noise_sources.py": ('    NoiseSource(\n        cause="DSNU"', ENTRY),
}
QUESTIONS = """
import contextlib, io, json
import numpy as np
import chromanoise as cn
from chromanoise.study import color_budgets
from chromanoise.cli.entry import run
from chromanoise.apps.design.parameters import noise_properties
from chromanoise.noise import noise_sources, sample_electrons
from chromanoise.web.controls import described_fields
from chromanoise.base.rng import stream
from chromanoise.sensor import with_binning
from chromanoise.study import hashes, study_from_data, study_hash

NAME = "onyx-rgb-ircut"
new = cn.analyze(NAME, lux=10, flicker_noise_e=30)
known = cn.analyze(NAME, lux=10, read_noise_e=(10**2 + 30**2) ** 0.5)
sensor = new.analyses[0].sensor
noise = noise_sources(sensor)
drawn = sample_electrons(np.full((200_000, 1), 50.0), sensor.pixel, stream(3), noise=noise)
table = io.StringIO()
with contextlib.redirect_stdout(table), contextlib.suppress(SystemExit):
    run(["analyze", NAME, "--lux", "10", "--flicker-noise-e", "30", "--json", "-"])
sweeps = [{"vary": "flicker-noise-e", "first": 1, "last": 30, "points": 3}]
one = {"name": NAME, "pixel": {"flicker_noise_e": 30}}
study = study_from_data({"sensors": [one], "sweeps": sweeps}, source="a test")
swept = cn.run(study)
hashes.__version__ = "a version"
try:
    cn.analyze(NAME, flicker_noise_e=-1)
    refused = ""
except cn.InputError as error:
    refused = error.subject
print(json.dumps({
    "of Python": [one.to_dict()["sensors"][0]["color"]["snr_db"] for one in (new, known)],
    "of the command": json.loads(table.getvalue())["sensors"][0]["color"]["snr_db"],
    "losses": [
        {cost.cause: cost.cost_db for cost in one.costs} for one in color_budgets(new.analyses[0])
    ],
    "variance drawn": float(drawn.var()),
    "of four readings": with_binning(sensor, 4, "digital").pixel.flicker_noise_e,
    "controls": sorted(one["key"] for one in described_fields() if "flicker" in one["key"]),
    "free in a design": "flicker_noise_e" in noise_properties(),
    "refused": refused,
    "hash": study_hash(study_from_data({"sensors": [{"name": NAME}]}, source="a test")),
    "swept": "flicker" in json.dumps(swept.to_dict()),
}))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What a copy of the package with the two edits answers."""
    return answers_of_copy(tmp_path_factory.mktemp("copy"), EDITS, QUESTIONS)


def test_python_and_the_command_give_the_snr_of_a_read_noise_of_the_same_variance(answers):
    new, known = answers["of Python"]
    assert new == pytest.approx(known, abs=1e-9)
    assert answers["of the command"] == new


def test_the_budget_has_its_row_and_ends_at_the_table(answers):
    for losses in answers["losses"]:
        assert losses["flicker noise"] > 0.3
        assert abs(losses["rest"]) < 0.01


def test_draws_have_its_variance_and_binning_multiplies_it_by_the_readings(answers):
    assert answers["variance drawn"] == pytest.approx(50 + 10**2 + 30**2, rel=0.02)
    assert answers["of four readings"] == pytest.approx(60.0)


def test_the_page_a_design_a_sweep_and_the_check_of_bounds_have_it(answers):
    assert "sensors.pixel.flicker_noise_e" in answers["controls"]
    assert answers["free in a design"]
    assert answers["swept"]
    assert answers["refused"] == "flicker_noise_e"


def test_a_study_without_it_keeps_its_hash(answers, monkeypatch):
    monkeypatch.setattr(hashes, "__version__", "a version")
    study = study_from_data({"sensors": [{"name": "onyx-rgb-ircut"}]}, source="a test")
    assert answers["hash"] == study_hash(study)
