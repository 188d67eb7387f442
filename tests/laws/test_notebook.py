"""Nouns show themselves in a notebook: what is shown is what they hold, and it is safe HTML."""

import re
from html.parser import HTMLParser

import pytest

from chromanoise.base.notebook import table
from chromanoise.noise import Exposure
from chromanoise.sensor import Pixel
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import analyzed, color_budgets, sensor_named
from strategies import raw_of, white_channel

PIXEL = Pixel(pitch_um=3.0, full_well_e=5000.0, read_noise_e=2.0)
SENSOR = sensor_named("onyx-rgbw", DEFAULT_GRID)
WHITE = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
ANALYSIS = analyzed(WHITE, SENSOR, Exposure(time_s=0.0119))


class Balanced(HTMLParser):
    """Refuses a tag that is closed by another."""

    def __init__(self):
        super().__init__()
        self.open, self.text = [], []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def read(noun):
    page = Balanced()
    page.feed(noun._repr_html_())
    assert page.open == []
    return " ".join(page.text)


@pytest.mark.parametrize(
    "noun",
    [SENSOR, ANALYSIS, ANALYSIS.raw, ANALYSIS.color, ANALYSIS.matrix, color_budgets(ANALYSIS)[1]],
    ids=["sensor", "analysis", "raw", "color", "matrix", "budget"],
)
def test_every_tag_is_closed_and_nothing_is_fetched(noun):
    read(noun)
    assert not re.search(r"(src|href|url)\s*[=(]|<script|<style", noun._repr_html_())


def test_a_name_cannot_become_markup():
    evil = '<img src=x onerror="alert(1)">'
    sensor = white_channel(name=evil, names=("<b>",), notes=("a & b",))
    assert "<img" not in sensor._repr_html_()
    result = read(sensor)
    assert evil in result
    assert "a & b" in result


def test_a_measurement_tells_mean_deviation_and_correlation():
    """The covariance [[4, -3], [-3, 9]] has deviations 2 and 3 and a correlation of -1/2."""
    result = read(raw_of([10.0, 20.0], [[4.0, -3.0], [-3.0, 9.0]], ("a", "b")))
    assert re.search(r"a\s+10\s+2\s+1.00\s+-0.50", result)
    assert re.search(r"b\s+20\s+3\s+-0.50\s+1.00", result)


def test_an_analysis_shows_the_papers_figures():
    """Clouet et al. (CIC27, 2019): 39.9 dB of W in Table 2, 26.1 dB of Y in Table 3."""
    shown = dict(re.findall(r"(channel W|\bY)\s+([\d.]+)", read(ANALYSIS)))
    assert float(shown["channel W"]) == pytest.approx(39.9, abs=0.3)
    assert float(shown["Y"]) == pytest.approx(26.1, abs=0.3)


def test_a_saturated_channel_shows_no_number():
    bright = analyzed(WHITE, SENSOR, Exposure(time_s=1.0))
    assert "none" in read(bright)
    assert "saturated" in read(bright)


def test_the_shown_costs_lead_from_all_photons_to_the_coordinate():
    result = read(color_budgets(ANALYSIS)[1])
    (start,) = re.findall(r"all photons on the pixels\s+(\d+\.\d\d)", result)
    costs = re.findall(r"\s([+-]\d+\.\d\d)\s", result)
    (end,) = re.findall(r"SNR of Y\s+(\d+\.\d\d)", result)
    assert len(costs) == 6
    assert float(start) + sum(map(float, costs)) == pytest.approx(float(end), abs=0.05)


def test_electrons_and_micrometers_have_their_signs_and_numbers_keep_theirs():
    result = table(["", "mean [e-]", "1e-05 um"], [["R", "12 e-/photon", "number"]])
    assert "mean [e⁻]" in result
    assert "12 e⁻/photon" in result
    assert "1e-05 µm" in result
    assert "number" in result
