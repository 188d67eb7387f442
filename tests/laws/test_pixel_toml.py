"""A pixel as TOML: what is written is read, and what is wrong is named with its place."""

import math
from dataclasses import fields

import pytest
from hypothesis import given, strategies as st

from chromanoise.io.pixels import pixel_source_toml, read_pixel_toml
from chromanoise.sensor import PIXEL, Adc, Pixel, PixelSource
from chromanoise.study import read_pixel_source, sensor_with_pixel
from outcomes import refused_input

HEAD = 'schema = "chromanoise pixel"\nschema_version = 1\n'


def number(name):
    """A value of a pixel that a file may have."""
    bounds = (PIXEL[name].least, PIXEL[name].most) if name in PIXEL else (1e-3, 1e6)
    return st.none() | st.floats(max(bounds[0], 1e-3), min(bounds[1], 1e6))


words = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)


NUMBERS = (
    *("pitch_um", "full_well_e", "read_noise_e", "gain_e_per_dn", "dsnu_e", "prnu"),
    *("dark_current_e_per_s", "row_noise_e", "qe_at_nm"),
    *("black_error_e", "temperature_c", "dark_reference_c", "dark_doubling_k"),
)


@given(
    numbers=st.fixed_dictionaries({name: number(name) for name in NUMBERS}),
    qe=st.none() | st.floats(0, 1),
    bits=st.none() | st.integers(8, 16),
    black=st.none() | st.integers(0, 200),
    source=words,
    notes=st.lists(words, max_size=3),
)
def test_what_is_written_is_read_to_the_last_digit(
    tmp_path_factory, numbers, qe, bits, black, source, notes
):
    pixel = PixelSource(
        source=source, qe=qe, bits=bits, black_level_dn=black, notes=tuple(notes), **numbers
    )
    path = tmp_path_factory.mktemp("toml") / "pixel.toml"
    path.write_text(pixel_source_toml(pixel), encoding="utf-8")
    assert read_pixel_source(path) == pixel


def test_every_number_of_a_pixel_can_be_in_a_file():
    own = {one.name for one in fields(Pixel)} - {"summed_pixels", "summed_readings"}
    assert own <= {one.name for one in fields(PixelSource)}


def test_a_file_with_a_temperature_has_the_dark_current_of_that_temperature(file):
    """39 C is two doublings of 7 K above 25 C, and 11 C two below; 4 e-/s become 16 and 1."""
    for text, expected in (("39", 16.0), ("11", 1.0), ("39\ndark_reference_c = 46", 2.0)):
        path = file(f"{HEAD}dark_current_e_per_s = 4\ntemperature_c = {text}\n")
        sensor = sensor_with_pixel("onyx-rgbw", file=str(path))
        assert sensor.pixel.dark_electrons_e(time_s=1.0) == pytest.approx(expected, rel=1e-12)


def test_a_temperature_may_be_below_zero_but_not_below_the_absolute_zero(file):
    path = file(f"{HEAD}dark_current_e_per_s = 4\ntemperature_c = -20\n")
    assert sensor_with_pixel("onyx-rgbw", file=str(path)).pixel.temperature_c == -20
    path = file(f"{HEAD}dark_current_e_per_s = 4\ntemperature_c = -300\n")
    with refused_input(value=-300):
        sensor_with_pixel("onyx-rgbw", file=str(path))


def test_a_complete_converter_is_written_as_its_values(file):
    adc = Adc(bits=10, gain_e_per_dn=1.5, black_level_dn=42)
    read = read_pixel_toml(file(pixel_source_toml(PixelSource(source="a", adc=adc))))
    assert (read.bits, read.gain_e_per_dn, read.black_level_dn) == (10, 1.5, 42)


def test_a_gain_in_dn_per_electron_is_inverted(file):
    assert read_pixel_toml(file(f"{HEAD}gain_dn_per_e = 0.25\n")).gain_e_per_dn == 4.0


def test_a_black_level_between_codes_is_rounded_with_a_note(file):
    read = read_pixel_toml(file(f"{HEAD}black_level_dn = 64.75\n"))
    assert read.black_level_dn == 65
    assert any("64.75" in note for note in read.notes)


def test_the_schema_line_marks_a_pixel_under_any_name(file):
    path = file(f"{HEAD}read_noise_e = 2\n", "camera.txt")
    assert read_pixel_source(path).read_noise_e == 2.0


def test_row_noise_reaches_the_pixel_of_a_sensor_and_an_option_overrides_it(file):
    path = str(file(f"{HEAD}row_noise_e = 3.5\n", "pixel.toml"))
    assert sensor_with_pixel("onyx-rgbw", file=path).pixel.row_noise_e == 3.5
    assert sensor_with_pixel("onyx-rgbw", file=path, row_noise_e=0.0).pixel.row_noise_e == 0.0


@pytest.mark.parametrize(
    ("text", "where", "value"),
    [
        ("read_noise_e = 2\n", "schema", None),
        ('schema = "chromanoise sensor"\n', "schema", "chromanoise sensor"),
        ('schema = "chromanoise pixel"\nschema_version = 2\n', "schema_version", 2),
        ('schema = "chromanoise pixel"\nschema_version = true\n', "schema_version", True),
        (f"{HEAD}read_nois_e = 2\n", "read_nois_e", None),
        (f'{HEAD}read_noise_e = "2"\n', "read_noise_e", "2"),
        (f"{HEAD}read_noise_e = nan\n", "read_noise_e", math.nan),
        (f"{HEAD}read_noise_e = inf\n", "read_noise_e", math.inf),
        (f"{HEAD}read_noise_e = true\n", "read_noise_e", True),
        (f"{HEAD}read_noise_e = -1\n", "read_noise_e", -1.0),
        (f"{HEAD}dsnu_e = -1\n", "dsnu_e", -1.0),
        (f"{HEAD}qe = 61\n", "qe", 61.0),
        (f"{HEAD}bits = 12.5\n", "bits", 12.5),
        (f"{HEAD}bits = 20\n", "bits", 20),
        (f"{HEAD}black_level_dn = 70000\n", "black_level_dn", 70000.0),
        (f"{HEAD}gain_dn_per_e = 0\n", "gain_dn_per_e", 0.0),
        (f"{HEAD}gain_dn_per_e = 2\ngain_e_per_dn = 0.5\n", "gain", (0.5, 2)),
        (f"{HEAD}notes = 3\n", "notes", 3),
        (f"{HEAD}source = 3\n", "source", [3]),
    ],
)
def test_what_is_wrong_is_refused_with_its_key(file, text, where, value):
    path = file(text, "pixel.toml")
    with refused_input(subject=str(path), where=where) as caught:
        read_pixel_source(path)
    held = caught.value.value
    assert held == value or (value != value and held != held)


@pytest.mark.parametrize(
    "text", [f"{HEAD}a = [", "K = 2 DN/e-\n", f"{HEAD}a = {'[' * 5000}", f"{HEAD}a = {'1' * 9999}"]
)
def test_text_that_is_not_toml_is_refused(file, text):
    path = file(text, "pixel.toml")
    with refused_input(subject=str(path)):
        read_pixel_source(path)


def test_a_misspelled_key_is_named_with_the_right_one(file):
    with refused_input(where="read_nois_e", requirement="is not a key") as caught:
        read_pixel_toml(file(f"{HEAD}read_nois_e = 2\n"))
    assert caught.value.remedy[0].startswith("did you mean read_noise_e")


def test_a_huge_file_is_refused_before_it_is_parsed(file):
    path = file(HEAD + "#" * 2**20)
    with refused_input(subject=str(path), value=2**20 + len(HEAD)):
        read_pixel_toml(path)
