"""Two parameters on the command line, in a study, in copies of it, in figures and in reports."""

import re

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.charts import draw_maps, shown, study_figures
from chromanoise.study import study_from_data
from chromanoise.web import study_report

PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
SWEEP = ("--sweep", "lux=0.1:10", "--points", 4)
STUDY = {
    "sensors": [{"name": name} for name in PAIR],
    "outputs": {"analyses": False},
    "sweeps": [
        {
            "vary": "lux",
            "first": 0.1,
            "last": 10.0,
            "points": 4,
            "second": {"vary": "prnu", "first": 0.0, "last": 0.1, "points": 3},
        }
    ],
}


def test_the_terminal_shows_values_and_the_best_sensor(done):
    out, _ = done("compare", *PAIR, *SWEEP, "--and", "prnu=0:0.1:3")
    assert "PRNU" in out
    assert "Best SNR of Y" in out


def test_the_heat_map_of_one_sensor_has_its_values_and_of_two_their_difference():
    found = cn.compare_map(*PAIR, points=4, second_points=3)
    one, other = found.maps
    for maps, expected in (([one], one.value), ([one, other], one.value - other.value)):
        ax = draw_maps(maps, cn.compare(PAIR[0], points=2).plot().figure.add_subplot())
        drawn = np.ma.filled(ax.collections[0].get_array(), np.nan)
        assert drawn.reshape(expected.shape) == pytest.approx(expected, nan_ok=True)


@pytest.mark.evidence
@pytest.mark.usefixtures("plain_report")
def test_the_report_and_the_figures_of_a_study_have_a_heat_map_per_sweep_of_two():
    of = shown(study_from_data(STUDY))
    assert [name for name in study_figures(of) if name.startswith("map")] == ["map-1"]
    page = study_report(of)
    assert len(re.findall(r'<img src="data:image/png;base64,[^"]+" alt="Heat map', page)) == 1
    plain = {"sensors": STUDY["sensors"][:1]}
    assert "Heat map" not in study_report(shown(study_from_data(plain)))
