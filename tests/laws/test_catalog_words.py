"""Names and files that a person writes for a sensor, a light or a filter."""

import pytest

from chromanoise.sensor import filter_named
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import catalog_entries, catalog_entry, sensor_named
from chromanoise.study.catalog import unknown_name
from chromanoise.study.resolve_names import resolve_filter, resolve_illuminant, resolve_sensor
from outcomes import refused_input

UNKNOWN = {
    "sensor": (resolve_sensor, "sensor", "onyx-rgwb", "onyx-rgbw"),
    "sensor like none": (resolve_sensor, "sensor", "zzzzzzqq", "see the catalog"),
    "light": (resolve_illuminant, "illuminant", "halogn", "halogen"),
    "CIE illuminant": (resolve_illuminant, "illuminant", "D66", "D65"),
    "diode": (resolve_illuminant, "illuminant", "LED9x0", "LED<nm>/<width>"),
    "light with a diode": (
        lambda word: resolve_illuminant(f"{word}+1xLED850"),
        "illuminant",
        "X",
        "see the catalog",
    ),
    "filter": (resolve_filter, "filter", "ircut-schot", "ircut-schott"),
    "model of a filter": (resolve_filter, "filter", "ircut-6x50", "ircut-<nm>/<width>"),
    "filter like none": (resolve_filter, "filter", "q", "see the catalog"),
    "sensor by name": (
        lambda word: sensor_named(word, DEFAULT_GRID),
        "sensor",
        "mt9v24",
        "mt9v024",
    ),
    "filter by name": (
        lambda word: filter_named(word, DEFAULT_GRID),
        "filter",
        "ircut-schot",
        "ircut-schott",
    ),
    "entry": (catalog_entry, "entry", "skni", "skin"),
    "kind": (catalog_entries, "kind", "sensor", "sensors"),
}


@pytest.mark.parametrize(("ask", "subject", "word", "remedy"), UNKNOWN.values(), ids=UNKNOWN)
def test_a_word_that_names_nothing_is_refused_with_the_nearest_names(ask, subject, word, remedy):
    with refused_input(subject=subject, value=word) as refusal:
        ask(word)
    assert remedy in refusal.value.remedy[0]
    assert len(refusal.value.remedy[0]) < 100
    assert "\n" not in str(refusal.value)


def test_the_nearest_names_are_few():
    error = unknown_name("sensor", "camera", [f"camera-{i}" for i in range(80)])
    assert error.remedy[0].count("camera-") == 3


@pytest.mark.parametrize("ask", [resolve_sensor, resolve_filter])
def test_a_file_that_is_missing_is_refused_by_its_name(ask):
    with refused_input(subject="missing/curves.csv", value=None):
        ask("missing/curves.csv")


def test_a_kind_is_not_an_entry():
    with refused_input(subject="entry", value="sensors"):
        catalog_entry("sensors")


def test_a_number_of_a_model_filter_must_be_a_number():
    with refused_input(subject="filter", value="ircut-6.5.0"):
        filter_named("ircut-6.5.0", DEFAULT_GRID)


def test_a_filter_file_of_two_curves_is_refused(tmp_path):
    path = tmp_path / "two.csv"
    path.write_text("wavelength_nm,a,b\n400,0.5,0.5\n1050,0.5,0.5\n")
    with refused_input(value=("a", "b"), requirement="one curve"):
        resolve_filter(str(path))
