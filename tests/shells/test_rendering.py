"""One error in the terms of each shell: option, key with its line, control, keyword."""

import pickle

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.base.errors import InputError, Setting, StudyError, in_study
from chromanoise.base.files import renamed
from chromanoise.cli.output import sentences
from chromanoise.study import in_arguments, study_from_text
from chromanoise.web.page_questions import page_sentence

ENDS = Setting("sensors.0.beyond", ("zero", "hold"))
LAMP_ENDS = Setting("light.beyond", ("zero", "hold"))
COUNTS = Setting("sensors.0.answers.per", ("energy", "photon"))
SHORT = InputError(
    "cam.csv",
    "must reach 1050 nm",
    value=780.0,
    found="ends at 780 nm",
    remedy=ENDS,
    setting="sensors.0.name",
)
DARK = InputError("level_lux", "must be > 0 [lx]", value=0.0, setting="light.level_lux")


def wrong(subject, key, *, value=1, remedy=()):
    return InputError(subject, "must be right", value=value, remedy=remedy, setting=key)


@pytest.mark.parametrize(
    ("error", "command", "sentence"),
    [
        (DARK, "analyze", "--lux must be > 0 [lx], but is 0"),
        (
            SHORT,
            "analyze",
            "cam.csv must reach 1050 nm, but ends at 780 nm; give --beyond zero or hold",
        ),
        (
            wrong("lamp.csv", "light.illuminant", remedy=LAMP_ENDS),
            "analyze",
            "lamp.csv must be right, but is 1; give --illuminant-beyond zero or hold",
        ),
        (
            wrong("cam.csv", "sensors.0.name", remedy=COUNTS),
            "simulate",
            "cam.csv must be right, but is 1; give --energy or --photons",
        ),
        (
            wrong("per", "light.per", value="energy"),
            "analyze",
            "--illuminant-energy must be right, but is 'energy'",
        ),
        (
            wrong("bits", "pictures.0.bits", remedy=Setting("pictures.0.mosaic")),
            "simulate",
            "--bits must be right, but is 1; give --mosaic",
        ),
        (wrong("formats", "pictures.0.formats.1"), "simulate", "--format must be right, but is 1"),
        (wrong("matrices", "matrices.0"), "compare", "--matrix must be right, but is 1"),
        (wrong("matrix", "matrices.0"), "matrix", "--matrix must be right, but is 1"),
        (wrong("vary", "sweeps.0.vary"), "compare", "--sweep must be right, but is 1"),
        (
            wrong("points", "outputs.pareto.points"),
            "matrix",
            "POINTS of --pareto must be right, but is 1",
        ),
        (wrong("first", "sweeps.0.first"), "compare", "FIRST of --sweep must be right, but is 1"),
        (wrong("sensors", "sensors.1.name"), "analyze", "SENSOR must be right, but is 1"),
        (wrong("name", "sensors.1.name"), "simulate", "--sensor must be right, but is 1"),
        (wrong("cube", "pictures.0.cube"), "simulate", "CUBE must be right, but is 1"),
        (
            wrong("scale", "scale", value="percent"),
            "inspect",
            "--percent must be right, but is 'percent'",
        ),
        (wrong("threads", ""), "simulate", "--threads must be right, but is 1"),
        (wrong("threads", ""), "analyze", "threads must be right, but is 1"),
    ],
)
def test_the_command_line_calls_a_setting_by_its_option(error, command, sentence):
    options = {"threads": "--threads"} if command == "simulate" else {}
    assert sentences(error, command, options) == sentence


def test_the_command_line_prints_each_error_once_in_a_line_of_its_own(run):
    both = StudyError([DARK, SHORT, DARK])
    assert sentences(both).splitlines() == [sentences(DARK), sentences(SHORT)]
    assert run("analyze", "onyx-rgbw", "--lux", 0, "--f-number", -1)[2].splitlines() == [
        "chromanoise: --lux must be greater than 0, but is 0",
        "chromanoise: --f-number must be greater than 0, but is -1",
    ]


def test_a_study_file_calls_a_setting_by_its_key_with_file_and_line(run, here):
    assert in_study(DARK, "s.toml:2") == "s.toml:2: light.level_lux: must be > 0 [lx], but is 0"
    assert in_study(SHORT, "s.toml:4") == (
        "s.toml:4: sensors.0.name: cam.csv must reach 1050 nm, but ends at 780 nm; "
        'set sensors.0.beyond = "zero" or "hold"'
    )
    text = "[light]\nlevel_lux = 0\n[[sensors]]\nname = 'onyx-rgbw'\n"
    (here / "s.toml").write_text(text)
    sentence = "light.level_lux: must be greater than 0, but is 0"
    assert run("run", "s.toml")[2] == f"chromanoise: s.toml:2: {sentence}\n"
    right = text.replace("= 0", "= 1")
    (here / "s.toml").write_text(right)
    changed = run("run", "s.toml", "--set", "light.level_lux=0")
    assert changed[2] == f"chromanoise: --set light.level_lux=0: {sentence}\n"
    with pytest.raises(StudyError, match=f"^a text:2: {sentence}$"):
        study_from_text(text, source="a text")


@pytest.mark.parametrize(
    ("cube", "lines", "key"),
    [
        (np.full((4, 4, 14), 0.5), "", "pictures.0.wavelengths"),
        (np.full((4, 4, 14), np.nan), "wavelengths = [400, 1050]", "pictures.0.bad_pixels"),
    ],
)
def test_a_fault_found_during_a_run_names_keys_of_the_study_and_no_option(
    run, here, cube, lines, key
):
    np.save(here / "cube.npy", cube)
    (here / "s.toml").write_text(
        f"[[sensors]]\nname = 'onyx-rgbw'\n[[pictures]]\ncube = 'cube.npy'\n{lines}\n"
    )
    outcome = run("run", "s.toml")
    assert outcome[0] == 2
    assert [remedy.name for remedy in outcome.errors[0].remedy if isinstance(remedy, Setting)] == [
        key
    ]
    assert f"set {key}" in outcome[2]
    assert "--" not in outcome[2]


def test_the_errors_of_a_study_are_data_with_their_places():
    text = "metric = 1\n[light]\nlevel_lux = 0\n[[sensors]]\nname = 'onyx-rgbw'\n"
    with pytest.raises(StudyError) as caught:
        study_from_text(text, source="s.toml", changes=["seed=-1"], change_label="--set")
    for error in (caught.value, pickle.loads(pickle.dumps(caught.value))):
        assert [one.setting for one in error.errors] == ["seed", "metric", "light.level_lux"]
        assert error.places == ("--set seed=-1", "s.toml:1", "s.toml:3")
        assert (error.requirement, error.value) == ("must have no errors", 3)
        assert not any(place in error.subject for place in error.places)
    with pytest.raises(StudyError) as caught:
        cn.study_from_data({"sensors": [{"name": "onyx-rgbw"}], "seed": -1, "metric": 1})
    assert caught.value.places == ()
    assert renamed(StudyError([DARK], ["s.toml:1"]), "a", "b").places == ("s.toml:1",)


def test_a_study_that_the_page_cannot_show_is_named_with_its_file(run, here):
    sensor = "[[sensors]]\nname = 'onyx-rgbw'\npixel.read_noise_e = "
    (here / "s.toml").write_text("".join(f"{sensor}{i}\n" for i in range(11)))
    outcome = run("serve", "s.toml")
    assert outcome[2] == (
        "chromanoise: s.toml: sensors must have at most 10 entries on the page, but has 11; "
        "remove some\n"
    )


def test_the_page_calls_a_setting_by_the_name_of_its_control():
    assert page_sentence(DARK) == "level lux must be > 0 [lx], but is 0"
    assert page_sentence(SHORT) == (
        "cam.csv must reach 1050 nm, but ends at 780 nm; set beyond to zero or hold"
    )


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: cn.analyze("onyx-rgbw", lux=0), "lux must be greater than 0, but is 0"),
        (
            lambda: cn.analyze("onyx-rgbw", lux=1e300),
            "lux must be 1e-15 to 1e+15 [lx], but is 1e+300",
        ),
        (
            lambda: cn.analyze("onyx-rgbw", pitch_um=1e200),
            "pitch_um must be 0.001 to 1e+06 [um], but is 1e+200",
        ),
        (
            lambda: cn.analyze("onyx-rgbw", illuminant_per="photon"),
            "illuminant_per must not be given for E, where it changes nothing; omit it",
        ),
        (
            lambda: cn.compare("onyx-rgbw", vary="time"),
            "vary must be a known name, but is 'time'; did you mean time-ms?",
        ),
        (
            lambda: cn.compare("onyx-rgbw", matrices=["kernl"]),
            "matrices must be a known name, but is 'kernl'; did you mean kernel?",
        ),
        (
            lambda: cn.matrix("onyx-rgbw", matrix="kernl"),
            "matrix must be a known name, but is 'kernl'; did you mean kernel?",
        ),
        (
            lambda: cn.render("builtin:checker", "onyx-rgbw", bits=8),
            "bits must not be given without a mosaic; set mosaic",
        ),
        (
            lambda: cn.render("builtin:checker", "onyx-rgbw", formats=["jpg"]),
            "formats must be a known name, but is 'jpg'; did you mean png?",
        ),
        (
            lambda: cn.analyze("onyx-rgbw", "onyx-rgbw"),
            "sensors must not be repeated with the same settings, but 'onyx-rgbw' is repeated; "
            "change one in a study file, e.g. sensors.1.filter, or omit one",
        ),
    ],
)
def test_python_calls_a_setting_by_its_keyword(call, sentence):
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value) == sentence


def test_python_names_the_keyword_that_resolves_an_error():
    assert str(in_arguments(SHORT, "analyze")) == (
        "cam.csv must reach 1050 nm, but ends at 780 nm; set beyond='zero' or 'hold'"
    )
