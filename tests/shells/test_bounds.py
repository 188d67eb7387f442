"""The bounds of every number of a study, each refused alike by every interface."""

import json
import math
import re
from copy import deepcopy
from functools import partial
from typing import get_args

import pytest

import chromanoise as cn
from chromanoise.base.errors import InputError, errors_in
from chromanoise.sensor import PIXEL, Pixel
from chromanoise.study import FUNCTIONS, read_study, study_from_data
from chromanoise.study.schema import KEYS
from chromanoise.web.answers import ChartReplies
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.page_studies import Studies
from chromanoise.web.uploads import Uploads
from outcomes import refused

ANY = "-inf < inf"
POSITIVE = "0 < inf"
NOT_NEGATIVE = "0 <= inf"
PIXELS = {  # allowed values of a pixel, least and most
    "pitch_um": "1e-3 <= 1e6",
    "full_well_e": "1e-3 <= 1e15",
    "read_noise_e": "0 <= 1e12",
    "dark_current_e_per_s": "0 <= 1e12",
    "temperature_c": "-273.15 <= 300",
    "dark_reference_c": "-273.15 <= 300",
    "dark_doubling_k": "3 <= 30",
    "dsnu_e": "0 <= 1e12",
    "prnu": "0 <= 0.2",
    "row_noise_e": "0 <= 1e12",
    "column_noise_e": "0 <= 1e12",
    "reset_capacitance_ff": "0 <= 1e6",
    "rtn_share": "0 <= 1",
    "rtn_amplitude_e": "0 <= 1e12",
    "black_error_e": "-1e15 <= 1e15",
}
OF_PICTURES = (
    *("dark_current_e_per_s", "dsnu_e", "prnu", "row_noise_e", "column_noise_e"),
    *("reset_capacitance_ff", "rtn_share", "rtn_amplitude_e"),
)
WHOLE = {
    "schema": (1, 1),
    "seed": (0, 4_294_967_295),
    "sensors.*.pixel.bits": (8, 16),
    "sensors.*.pixel.binning": (1, 10_000),
    "sweeps.0.points": (2, 100_000),
    "sweeps.0.second.points": (2, 100_000),
    "pictures.0.bits": (8, 16),
    "pictures.0.black_level": (0, 65_535),
    "pictures.0.frames": (1, 1_000_000),
    "outputs.pipeline.white_balance_pixels": (1, 1_000_000_000),
    "outputs.pareto.points": (2, 100_000),
}
BOUNDS = {
    "light.level_lux": "1e-15 <= 1e15",
    "exposure.time_ms": "1e-12 <= 1e15",
    "exposure.saturate": "1e-9 <= 1",
    "exposure.f_number": "0.5 <= 1e6",
    "exposure.magnification": ANY,
    "sensors.*.answers.peak_qe": "0 < 1",
    **{f"sensors.*.pixel.{name}": text for name, text in PIXELS.items()},
    "sensors.*.pixel.gain_dn_per_e": "1e-15 <= 1e12",
    "sensors.*.shift_ircut_nm": "-200 <= 200",
    "sensors.*.crosstalk": "0 <= 1",
    "sensors.*.ircut_nm": "450 <= 2000",
    "sensors.*.shift_nm": "-200 <= 200",
    "reflectances.patch": "0 <= 1",
    "sweeps.0.first": ANY,
    "sweeps.0.last": ANY,
    "sweeps.0.second.first": ANY,
    "sweeps.0.second.last": ANY,
    "pictures.0.scale": POSITIVE,
    **{f"pictures.0.{name}": PIXELS[name] for name in OF_PICTURES},
    "outputs.pipeline.exposure_gain": POSITIVE,
    "outputs.pipeline.saturation": NOT_NEGATIVE,
    "outputs.pipeline.tone": "0.1 <= 10",
    "outputs.pipeline.base_iso": POSITIVE,
    "outputs.pareto.first": POSITIVE,
    "outputs.pareto.last": POSITIVE,
}
OTHERS = {  # without one bound for one number: lists, which are tested with their meaning
    *("pictures.0.shape", "pictures.0.wavelengths", "outputs.pipeline.iso"),
    *("outputs.pipeline.white_balance", "outputs.pipeline.iso_read_noise_e"),
}
REMEDIES = {
    "f_number": ("no lens in air is faster than f/0.5 (sine condition)",),
    "prnu": ("write 1 percent as 0.01",),
    "rtn_share": ("write 1 percent as 0.01",),
}
BESIDE = {  # what a study needs beside the number, by the beginning of its key
    "sweeps": {"sweeps": [{"vary": "lux", "first": 1.0, "last": 2.0, "points": 2}]},
    "sweeps.0.second": {"sweeps.0.second": {"vary": "f-number", "first": 2.0, "last": 4.0}},
    "pictures": {"pictures": [{"mosaic": "bayer"}]},
    "outputs.pipeline": {"outputs.pipeline": {"run": True}},
    "outputs.pareto": {
        "outputs": {"matrix": True, "pareto": {"first": 1.0, "last": 2.0}},
    },
}
WORDS = {  # options that give several numbers
    "sweeps.0.first": "compare onyx-rgb --sweep lux={}:2",
    "sweeps.0.last": "compare onyx-rgb --sweep lux=1:{}",
    "sweeps.0.second.first": "compare onyx-rgb --sweep lux=1:2 --and f-number={}:4",
    "sweeps.0.second.last": "compare onyx-rgb --sweep lux=1:2 --and f-number=2:{}",
    "sweeps.0.second.points": "compare onyx-rgb --sweep lux=1:2 --and f-number=2:4:{}",
    "outputs.pareto.first": "matrix onyx-rgb --pareto {}:2",
    "outputs.pareto.last": "matrix onyx-rgb --pareto 1:{}",
    "outputs.pareto.points": "matrix onyx-rgb --pareto 1:2:{}",
}
CUBE = "builtin:checker"
COMMANDS = {  # a function and its command
    "analyze": (partial(cn.analyze, "onyx-rgb"), "analyze onyx-rgb"),
    "compare": (partial(cn.compare, "onyx-rgb"), "compare onyx-rgb"),
    "compare_map": (partial(cn.compare_map, "onyx-rgb"), "compare onyx-rgb"),
    "matrix": (partial(cn.matrix, "onyx-rgb"), "matrix onyx-rgb"),
    "render": (partial(cn.render, CUBE, "onyx-rgb"), f"simulate {CUBE} --sensor onyx-rgb"),
}
NEEDS = {  # settings of a function beside the number, by the beginning of its key
    "outputs.pareto": {"pareto_first": 1.0, "pareto_last": 2.0},
    "pictures": {"mosaic": "bayer"},
}


def put(data, key, value):
    """Set a value in nested data."""
    *path, last = key.split(".")
    for name in path:
        data = data[0] if name == "0" else data.setdefault(name, {})
    data[last] = value


def study_with(key, value):
    """The data of a study with a value and what it needs."""
    data = {"sensors": [{"name": "onyx-rgb"}]}
    for beginning, parts in BESIDE.items():
        if key.startswith(beginning):
            for name, part in deepcopy(parts).items():
                put(data, name, part)
    put(data, key.replace("*", "0"), value)
    return data


def as_toml(value):
    """A value in one line of TOML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {as_toml(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    return json.dumps(value) if isinstance(value, str | bool) else repr(value)


def numbers_in(kind):
    inside = get_args(kind)
    return kind in (int, float) or any(map(numbers_in, inside))


def ends(key):
    """The values at the ends that are allowed, and those next to them that are not."""
    if key in WHOLE:
        least, most = WHOLE[key]
        return [least, most], [least - 1, most + 1]
    least, sign, most = BOUNDS[key].split()
    least, most = float(least), float(most)
    below = least if sign == "<" else math.nextafter(least, -math.inf)
    above = most if math.isinf(most) else math.nextafter(most, math.inf)
    allowed = [math.nextafter(below, math.inf), math.nextafter(above, -math.inf)]
    return allowed, [below, above, math.nan]


EVERY = [*BOUNDS, *WHOLE]


@pytest.fixture
def replies():
    """What the page replies."""
    return ChartReplies(Studies(Uploads()))


def test_every_number_of_a_study_has_its_bounds_in_this_table():
    numbers = {key for key, one in KEYS.items() if numbers_in(one.field.annotation)}
    assert numbers == {*EVERY, *OTHERS}
    assert set(PIXEL) == set(PIXELS)


TOGETHER = {"outputs.pipeline.base_iso", "sweeps.0.second.points"}  # other numbers limit them, too


@pytest.mark.parametrize("key", [key for key in EVERY if key not in TOGETHER])
def test_the_ends_of_the_range_of_a_number_are_allowed(key):
    for value in ends(key)[0]:
        study_from_data(study_with(key, value))


def refused_as(caught, key, value, subject=None):
    """One error of a number: its name, its value, its key and its remedy."""
    name = key.rpartition(".")[2]
    assert {one.subject for one in caught} == {subject or name}
    (error,) = (one for one in caught if one.setting == key.replace("*", "0"))
    assert error.value == pytest.approx(value, rel=0, abs=0, nan_ok=True)
    remedies = (REMEDIES.get(name, ()), ()) if math.isnan(value) else (REMEDIES.get(name, ()),)
    assert error.remedy in remedies


@pytest.mark.parametrize("key", EVERY)
def test_a_number_out_of_its_range_is_refused_in_data_and_file_and_on_the_page(key, here, replies):
    for value in ends(key)[1]:
        data = study_with(key, value)
        with pytest.raises(InputError) as caught:
            study_from_data(data)
        refused_as(errors_in(caught.value), key, value)
        text = "\n".join(f"{name} = {as_toml(one)}" for name, one in data.items())
        (here / "s.toml").write_text(text, encoding="utf-8")
        with pytest.raises(InputError) as caught:
            read_study(here / "s.toml")
        refused_as(errors_in(caught.value), key, value)
        line = list(data).index(key.partition(".")[0]) + 1
        assert f"s.toml:{line}: " in str(caught.value)
        if math.isfinite(value):  # JSON has no others
            with pytest.raises(QuestionError) as refused:
                replies.answer({"study": data})
            assert [where for where, _ in refused.value.faults] == [key.replace("*", "0")]


@pytest.mark.parametrize("key", [key for key in EVERY if KEYS[key].keyword])
def test_a_number_out_of_its_range_is_refused_as_keyword_and_option(key, run, here):
    keyword = KEYS[key].keyword
    function = next(name for name in COMMANDS if key in FUNCTIONS[name].get(keyword, ()))
    call, words = COMMANDS[function]
    needs = NEEDS.get(key.rpartition(".0.")[0] or key.rpartition(".")[0], {})
    words = WORDS.get(key, f"{words} --{keyword.replace('_', '-')}={{}}")
    option = "--" + re.split("[ =]", words.rpartition(" --")[2])[0]
    for value in ends(key)[1]:
        with pytest.raises(InputError) as caught:
            call(**needs | {keyword: value})
        refused_as(errors_in(caught.value), key, value, keyword)
        outcome = run(*words.format(value).split())
        refused(outcome, option if key in WORDS else f"chromanoise: {option} ")
        refused_as(outcome.errors, key, value, keyword)


@pytest.mark.parametrize("name", PIXELS)
def test_a_number_out_of_its_range_is_refused_by_the_pixel(name):
    given = {"pitch_um": 5.0, "full_well_e": 1e15, "read_noise_e": 2.0}
    allowed, refused = ends(f"sensors.*.pixel.{name}")
    for value in allowed:
        assert getattr(Pixel(**given | {name: value}), name) == value
    for value in refused:
        with pytest.raises(InputError) as caught:
            Pixel(**given | {name: value})
        assert caught.value.subject == name
