"""The catalog: nothing without provenance, and every entry can be used."""

import re

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.base.errors import InputError, Setting
from chromanoise.io.spectra import ASK, Answers
from chromanoise.noise import expected_electrons, saturating_exposure, with_noise
from chromanoise.sensor import PAPER_PIXEL, filter_named
from chromanoise.spectra import (
    BUILTIN_CUBES,
    DEFAULT_GRID,
    Grid,
    flat_field,
    illuminant_named,
    infrared_parts,
    reflectance_named,
    with_infrared,
)
from chromanoise.spectra.tables import formulas, packaged_table, sources
from chromanoise.study import KNOWN_SENSORS, sensor_named
from chromanoise.study.catalog import KINDS, catalog_entries, catalog_entry, entries_as_json
from outcomes import refused_input

ALL = Answers(beyond="zero", peak_qe=0.5, per="energy")
ENTRIES = catalog_entries()
NAMES = [entry.provenance.name for entry in ENTRIES]
BASES = ("E", "A", "halogen", "led-white", "G173", "booth-cwf", "3200K")
AT = DEFAULT_GRID.wavelength_nm


@pytest.mark.parametrize("entry", ENTRIES, ids=NAMES)
def test_every_entry_says_where_it_comes_from_and_what_is_wrong_with_it(entry):
    result = entry.provenance
    for text in (
        result.what,
        result.source,
        result.license,
        result.quantity,
        result.unit,
        result.defects,
    ):
        assert len(text) >= 1
        assert text == text.strip()
    assert len(result.source) > 10
    assert result.level in ("absolute", "relative")
    if result.table:
        assert len(result.done) > 10


def test_every_entry_of_a_table_has_the_range_of_its_file():
    from importlib import resources

    files = resources.files("chromanoise.spectra.tables")
    for entry in ENTRIES:
        if entry.provenance.table:
            rows = files.joinpath(f"{entry.provenance.table}.csv").read_text().splitlines()
            assert float(rows[1].split(",")[0]) == entry.start_nm
            assert float(rows[-1].split(",")[0]) == entry.stop_nm


def test_every_packaged_file_has_a_section_and_every_section_a_file():
    from importlib import resources

    folder = resources.files("chromanoise.spectra.tables")
    files = {item.name[:-4] for item in folder.iterdir() if item.name.endswith(".csv")}
    assert files == {result.table for result in sources().values()}


def test_no_two_entries_share_a_name():
    assert len(set(NAMES)) == len(NAMES)


def test_each_kind_has_its_entries_and_together_they_are_all():
    parts = [catalog_entries(kind) for kind in KINDS]
    assert all(parts)
    assert sum(map(len, parts)) == len(ENTRIES)
    with pytest.raises(InputError, match="did you mean sensors"):
        catalog_entries("sensor")


def test_the_catalog_lists_every_sensor_cube_and_cie_illuminant_that_can_be_named():
    import colour

    of = {kind: {e.provenance.name for e in catalog_entries(kind)} for kind in KINDS}
    assert of["sensors"] | of["cameras"] == set(KNOWN_SENSORS)
    assert of["scenes"] == set(BUILTIN_CUBES)
    assert set(colour.SDS_ILLUMINANTS) <= of["illuminants"]


def test_the_range_that_is_told_of_a_tabulated_light_is_that_of_its_table():
    import colour

    told = {name: one.range_nm for name, one in formulas().items() if one.range_nm}
    lights = {name: known for name, known in told.items() if name in colour.SDS_ILLUMINANTS}
    assert set(lights) == set(colour.SDS_ILLUMINANTS) - {"A", "E"}  # these two are formulas
    for name, known in lights.items():
        table = colour.SDS_ILLUMINANTS[name]
        assert known == (table.wavelengths[0], table.wavelengths[-1])


@pytest.mark.parametrize("name", KNOWN_SENSORS)
def test_every_sensor_gives_electrons_once_its_questions_are_answered(name):
    sensor = sensor_named(name, DEFAULT_GRID, answers=ALL)
    scene = flat_field(illuminant_named("A+0.5xLED850", DEFAULT_GRID), level_lux=10.0)
    exposure = saturating_exposure(scene, sensor, f_number=1.8, share=0.99)
    raw = with_noise(expected_electrons(scene, sensor, exposure), sensor)
    assert np.isfinite(raw.mean).all()
    assert raw.mean.max() == pytest.approx(0.99 * sensor.pixel.full_well_e, rel=1e-9)
    assert (np.diagonal(raw.covariance) > 0).all()
    assert sensor.name == name
    if sensor.mosaic is not None:
        assert set(sensor.mosaic.names) == set(sensor.names)


@pytest.mark.parametrize("entry", catalog_entries("sensors"), ids=lambda e: e.provenance.name)
def test_a_sensor_answers_at_once_if_and_only_if_it_asks_nothing(entry):
    name = entry.provenance.name
    assert entry.channels == sensor_named(name, DEFAULT_GRID, answers=ALL).names
    if not entry.asks:
        sensor_named(name, DEFAULT_GRID)
        return
    with pytest.raises(InputError) as refused:
        sensor_named(name, DEFAULT_GRID, answers=ASK)
    assert any(isinstance(one, Setting) for one in refused.value.remedy)


def test_what_is_asked_is_told_option_by_option():
    assert catalog_entry("mt9v024-rgb").asks == ()
    assert catalog_entry("mt9m131").asks == ("--beyond",)
    assert catalog_entry("ar0132at-rgbw").asks == ("--beyond", "--peak-qe")
    assert catalog_entry("nikon-d5100-npl").asks == (
        "--beyond",
        "--peak-qe",
        "--energy or --photons",
    )


def test_a_relative_sensor_has_the_peak_that_was_said_and_a_note_of_it():
    answers = Answers(beyond="zero", peak_qe=0.6)
    sensor = sensor_named("ar0132at-rgbw", DEFAULT_GRID, answers=answers)
    assert sensor.qe.max() == pytest.approx(0.6, rel=1e-12)
    assert any("--peak-qe" in note or "highest QE of 0.6" in note for note in sensor.notes)
    assert any(note == "QE of ar0132at-rgbw: zero beyond 380-1000 nm" for note in sensor.notes)
    assert not sensor.qe[AT > 1000].any()


def test_the_pixel_of_a_device_is_that_of_its_sheet_and_the_papers_stands_in_for_the_rest():
    sensor = sensor_named("mt9v024-mono", DEFAULT_GRID)
    assert sensor.pixel.pitch_um == 6.0
    assert sensor.pixel.full_well_e == PAPER_PIXEL.full_well_e
    assumed = "full well and read noise of mt9v024-mono not given: using 10000 e-, 10 e-"
    assert assumed in sensor.notes
    whole = sensor_named("gsense4040bsi", DEFAULT_GRID)
    assert not any("not given" in note for note in whole.notes)
    given = {"pitch_um": 3.0, "full_well_e": 2e4, "read_noise_e": 20.0}
    result = sensor_named("mt9v024-mono", DEFAULT_GRID, pixel=given)
    assert (result.pixel.pitch_um, result.pixel.full_well_e) == (3.0, 2e4)
    assert not any("not given" in note for note in result.notes)


def test_green_above_white_is_found_and_said_of_the_mt9v024():
    entry = catalog_entry("mt9v024-rgbw")
    assert any("green exceeds white by up to 15 % at 530-560 nm" in found for found in entry.found)
    assert "G exceeds W by 5-15 % at 530-560 nm" in entry.provenance.defects
    table = packaged_table("mt9v024-rgbw")
    over = table.wavelength_nm[table.values[:, 1] > table.values[:, 3]]
    assert over.tolist() == [530, 540, 550, 560]
    at = np.isin(table.wavelength_nm, over)
    share = table.values[at, 1] / table.values[at, 3] - 1
    assert (share.min(), share.max()) == pytest.approx((0.05, 0.15), abs=0.006)


def test_every_reflectance_and_filter_lies_between_0_and_1():
    for entry in (*catalog_entries("reflectances"), *catalog_entries("filters")):
        name = {"gray-<percent>": "gray-18", "ircut-<nm>/<width>": "ircut-650/8"}.get(
            entry.provenance.name, entry.provenance.name
        )
        if entry.provenance.kind == "filter":
            values = filter_named(name, DEFAULT_GRID).values[:, 0]
        else:
            values = reflectance_named(name, DEFAULT_GRID, beyond="hold").values
        assert np.isfinite(values).all()
        assert values.min() >= 0
        assert values.max() <= 1


def test_skin_ends_at_950_nm_and_asks_what_follows():
    with refused_input(subject="reflectance of skin", value=(420.0, 950.0), setting="beyond"):
        reflectance_named("skin", DEFAULT_GRID)
    held = reflectance_named("skin", DEFAULT_GRID, beyond="hold")
    assert held.notes == ("reflectance of skin: hold beyond 420-950 nm",)
    assert catalog_entry("skin").asks == ("--beyond",)


def test_an_ircut_by_name_passes_half_at_its_edge():
    grid = Grid.uniform(400, 1050, 1)
    for name, edge in (("ircut-650", 650), ("ircut-701/20", 701), ("ircut-650.0", 650)):
        passed = filter_named(name, grid).values[:, 0]
        assert passed[grid.wavelength_nm == edge] == pytest.approx(0.5)
    steep = filter_named("ircut-650/4", grid).values[:, 0]
    soft = filter_named("ircut-650/20", grid).values[:, 0]
    assert steep[grid.wavelength_nm == 660] < soft[grid.wavelength_nm == 660]


def test_a_gray_card_is_the_same_at_every_wavelength():
    assert reflectance_named("gray-18", DEFAULT_GRID).values == pytest.approx(0.18, abs=1e-15)
    with refused_input(subject="percent of gray-180", value=180.0):
        reflectance_named("gray-180", DEFAULT_GRID)


@pytest.mark.parametrize(
    ("ask", "fields"),
    [
        (lambda: reflectance_named("gray-1.2.3", DEFAULT_GRID), {"value": "1.2.3"}),
        (lambda: illuminant_named("E+1.2.3xLED850", DEFAULT_GRID), {"value": "1.2.3"}),
        (lambda: illuminant_named("E+1xLED850/5", DEFAULT_GRID), {"subject": "width_nm"}),
        (lambda: illuminant_named("E+1xLED1040", DEFAULT_GRID), {"subject": "peak_nm"}),
    ],
)
def test_a_family_of_names_refuses_wrong_numbers_by_their_fields(ask, fields):
    with refused_input(**fields) as refused:
        ask()
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("ask", "part"),
    [
        (lambda: reflectance_named("lwan", DEFAULT_GRID), "did you mean lawn"),
        (lambda: illuminant_named("halogn", DEFAULT_GRID), "did you mean halogen"),
        (lambda: illuminant_named("X+1xLED850", DEFAULT_GRID), "'X'"),
    ],
)
def test_what_is_not_there_is_refused_in_one_sentence(ask, part):
    with pytest.raises(InputError, match=re.escape(part)) as stop:
        ask()
    assert "\n" not in str(stop.value)


def test_a_name_of_a_family_finds_its_entry():
    for name, family in (
        ("2700K", "<T>K"),
        ("LED660/30", "LED<nm>/<width>"),
        ("A+0.5xLED850", "<light>+<r>xLED850"),
        ("ircut-700", "ircut-<nm>/<width>"),
        ("gray-18", "gray-<percent>"),
    ):
        assert catalog_entry(name).provenance.name == family


def test_daylight_beyond_the_cies_end_is_asked_and_never_invented():
    with refused_input(value=(300.0, 780.0), setting="beyond"):
        illuminant_named("D65", DEFAULT_GRID)
    assert "no daylight beyond 830 nm" in catalog_entry("D65").provenance.defects
    assert catalog_entry("D65").asks == ("--illuminant-beyond",)


# --- lights with an infrared diode beside them -----------------------------------------------


@pytest.mark.parametrize("ratio", [0.1, 0.5, 2.0])
def test_the_diode_has_its_share_of_the_lights_power(ratio):
    # E is flat: its level is read far from the diode, its power is level times length, and
    # what stands above that level is the diode
    lit = illuminant_named(f"E+{ratio}xLED850", DEFAULT_GRID)
    level = lit.irradiance[AT < 700].mean()
    flat = level * AT.size
    assert (lit.irradiance.sum() - flat) / flat == pytest.approx(ratio, rel=1e-9)
    assert AT[lit.irradiance.argmax()] == 850


def lux_of(light):
    """Trapezoid over the CIE's 1931 observer at 1 nm, from colour-science."""
    import colour

    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    y_bar = np.interp(light.grid.wavelength_nm, observer.wavelengths, observer.values[:, 1])
    return 683.002 * float(np.trapezoid(y_bar * light.irradiance, light.grid.wavelength_nm))


@pytest.mark.parametrize(
    "name", ["E+0.5xLED850", "A+1xLED940/50", "halogen+3xLED700", "E+1xLED850+1xLED940"]
)
def test_a_light_with_its_diode_gives_one_lux_as_a_whole(name):
    light = illuminant_named(name, Grid.uniform(360, 1050, 1))
    assert lux_of(light) == pytest.approx(1.0, rel=1e-3)
    assert light.name == name


def test_a_visible_tail_of_the_diode_is_counted_into_the_lux():
    # at 700 nm the eye still sees: the lamp must give way
    lamp, lit = (illuminant_named(n, DEFAULT_GRID) for n in ("E", "E+5xLED700"))
    assert lit.irradiance[0] < 0.95 * lamp.irradiance[0]


@given(st.sampled_from(BASES), st.floats(470, 980), st.floats(12, 30))
def test_no_diode_is_the_light_itself(base, peak_nm, width_nm):
    lamp = illuminant_named(base, DEFAULT_GRID)
    assert with_infrared(lamp, peak_nm=peak_nm, width_nm=width_nm, ratio=0.0) is lamp


@given(st.sampled_from(BASES), st.floats(0.001, 50.0), st.floats(0.001, 50.0))
def test_more_diode_is_more_infrared_and_the_visible_keeps_its_shape(base, a, b):
    lamp = illuminant_named(base, DEFAULT_GRID)
    less, more = (with_infrared(lamp, peak_nm=900.0, ratio=r) for r in (min(a, b), max(a, b)))
    at = AT == 900
    assert less.irradiance[at] <= more.irradiance[at] * (1 + 1e-12)
    seen = AT < 700
    shape = more.irradiance[seen] / more.irradiance[seen].sum()
    kept = lamp.irradiance[seen] / lamp.irradiance[seen].sum()
    np.testing.assert_allclose(shape, kept, rtol=1e-6, atol=1e-300)


def test_a_negative_ratio_is_refused():
    lamp = illuminant_named("E", DEFAULT_GRID)
    with refused_input(subject="ratio of infrared", value=-0.1):
        with_infrared(lamp, peak_nm=850, ratio=-0.1)


def test_the_last_diode_of_a_name_is_the_one_that_is_taken_off():
    base, last = infrared_parts("A+0.5xLED850+1e-3xLED940/50")
    assert base == "A+0.5xLED850"
    assert last == {"ratio": 1e-3, "peak_nm": 940.0, "width_nm": 50.0}
    assert infrared_parts("A") is None


def test_entries_as_json_say_everything_a_table_does():
    data = entries_as_json(catalog_entries("sensors"))["entries"]
    one = next(entry for entry in data if entry["name"] == "mt9v024-rgbw")
    assert one["curves"] == ["R", "G", "B", "W"]
    assert one["pixel"]["pitch_um"] == 6.0
    assert "MT9V024/D, Table 1" in one["pixel"]["told"]
    assert (one["start_nm"], one["stop_nm"], one["level"]) == (380.0, 1080.0, "absolute")
    assert {"source", "license", "quantity", "unit", "defects", "found", "asks"} <= set(one)
