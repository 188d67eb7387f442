"""Names of ours: ``_`` and ``-`` are equal wherever a person writes one; the stored name is one."""

import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner

import chromanoise as cn
from chromanoise import charts
from chromanoise.apps.design import OBJECTIVES, SearchOptions
from chromanoise.apps.design.algorithms import METHODS as SEARCHES
from chromanoise.apps.design.design_document import DesignPart
from chromanoise.apps.design.space import MODELS, Filter
from chromanoise.base.errors import InputError, known_name
from chromanoise.base.lazy import MOVED_NAMES, MOVED_PACKAGES
from chromanoise.cli.entry import COMMANDS, commands
from chromanoise.color import SPACES
from chromanoise.imaging import DEMOSAICING
from chromanoise.imaging.denoising import DENOISING, denoising_named
from chromanoise.sensor import MOSAIC_NAMES, mosaic_named
from chromanoise.spectra import BUILTIN_CUBES, DEFAULT_GRID, OBSERVERS
from chromanoise.study import PRIORS, QUANTITIES, SWEEPS, study_from_data, study_of
from chromanoise.study.catalog import sensor_named
from chromanoise.study.color_matrices import METHODS, matrix_makers
from chromanoise.study.hashes import study_hash
from chromanoise.study.reading import study_from_text
from chromanoise.study.resolve_names import catalog_word
from outcomes import refused_input

SENSOR = "onyx-rgbw"


def analyzed(**settings):
    return study_of("analyze", [SENSOR], settings)


def swept(**settings):
    given = {"vary": "lux", "first": 1.0, "last": 2.0} | settings
    return study_of("compare", [SENSOR], given).sweeps[0]


def rendered(cube="builtin:checker", **settings):
    return study_of("render", [SENSOR], settings, cube=cube).pictures[0]


def designed(**given):
    channel = {"name": "R", "filter": "gaussian", "center_nm": 600.0, "width_nm": 40.0}
    data = {"objectives": ["vora"], "channels": [channel]}
    return DesignPart.model_validate(data | given)


def with_parameter(name):
    parameter = METHODS[name].parameter if name in METHODS else METHODS[flipped(name)].parameter
    return f"{name}={METHODS[known_name(name, METHODS)].bounds[1]!r}" if parameter else name


REGISTRIES = {
    "sweep": (SWEEPS, lambda name: swept(vary=name).vary),
    "quantity": (QUANTITIES, lambda name: swept(quantity=name).quantity),
    "matrix": (
        METHODS,
        lambda name: (
            study_of("analyze", [SENSOR], {}, matrices=[with_parameter(name)])
            .matrices[0]
            .partition("=")[0]
        ),
    ),
    "prior": (
        PRIORS,
        lambda name: study_of("analyze", [SENSOR], {"prior": name}, matrices=["lmmse"]).prior,
    ),
    "space": (SPACES, lambda name: analyzed(space=name).outputs.space),
    "observer": (OBSERVERS, lambda name: analyzed(observer=name).observer),
    "denoising": (DENOISING, lambda name: rendered(denoise=name).denoise),
    "demosaicing": (
        DEMOSAICING,
        lambda name: rendered(mosaic="rgbw-2x2", demosaic=name).demosaic,
    ),
    "mosaic": (MOSAIC_NAMES, lambda name: rendered(mosaic=name).mosaic),
    "mosaic of a sensor": (MOSAIC_NAMES, lambda name: analyzed(mosaic=name).sensors[0].mosaic),
    "cube": (BUILTIN_CUBES, lambda name: rendered(cube=name).cube),
    "objective": (OBJECTIVES, lambda name: designed(objectives=[name]).objectives[0]),
    "search": (SEARCHES, lambda name: designed(method=name).method),
    "statistic": (
        ("percentile-95",),
        lambda name: designed(robust={"statistic": name, "samples": 64}).robust.statistic,
    ),
    "filter of a design": (MODELS, lambda name: Filter(model=name).model),
    "search of Python": (SEARCHES, lambda name: SearchOptions(method=name).method),
    "sensor": ((SENSOR,), lambda name: sensor_named(name, DEFAULT_GRID).name),
    "filter": (("ircut-650", "ircut-schott"), lambda name: catalog_word(name, "filter")),
    "light": (("led-white",), lambda name: catalog_word(name, "light")),
}
NAMES = [(kind, name) for kind, (names, _) in REGISTRIES.items() for name in names]


def flipped(name):
    return name.translate(str.maketrans("_-", "-_"))


@pytest.mark.parametrize(("kind", "name"), NAMES, ids=" ".join)
def test_a_name_with_the_other_sign_is_the_name(kind, name):
    stored = REGISTRIES[kind][1]
    assert stored(flipped(name)) == stored(name) == name


@pytest.mark.parametrize("name", MOSAIC_NAMES)
def test_a_mosaic_with_the_other_sign_is_the_mosaic(name):
    assert mosaic_named(flipped(name)) == mosaic_named(name)


def test_a_lookup_that_returns_an_object_takes_both_signs():
    assert denoising_named("bm3d_joint") is DENOISING["bm3d-joint"]
    made = matrix_makers(["least_squares"], "quanta")["least_squares"]
    assert made.method is METHODS["least-squares"]
    assert set(charts.DRAWINGS) == {known_name(one, charts.DRAWINGS) for one in charts.DRAWINGS}


def test_two_names_that_differ_in_the_sign_alone_stay_two():
    names = ["a_b-c", "a-b_c"]
    assert [known_name(one, names) for one in names] == names
    assert known_name("a-b-c", names) == "a-b-c"  # none of them


KEYS = ("level_lux", "f_number", "read_noise_e", "white_balance")
TEXT = """
title = "t"
[light]
{} = 3.0
[exposure]
{} = 2.0
[[sensors]]
name = "onyx-rgbw"
[sensors.pixel]
{} = 2.0
[outputs]
[outputs.pipeline]
run = true
{} = "illuminant"
"""


def test_keys_of_a_study_file_take_both_signs_and_the_hash_is_the_same():
    own = study_from_text(TEXT.format(*KEYS), source="a.toml")
    other = study_from_text(TEXT.format(*map(flipped, KEYS)), source="a.toml")
    assert own == other
    assert study_hash(own) == study_hash(other)


def test_a_change_with_the_other_sign_replaces_the_value():
    changes = ["light.level-lux=7"]
    study = study_from_text(TEXT.format(*KEYS), source="a.toml", changes=changes)
    assert study.light.level_lux == 7.0


def test_a_key_that_is_given_with_both_signs_is_refused():
    data = {"sensors": [{"name": SENSOR}], "light": {"level_lux": 3.0, "level-lux": 3.0}}
    with pytest.raises(InputError) as caught:
        study_from_data(data)
    assert caught.value.setting == "light.level-lux"


def test_a_fault_under_the_other_sign_names_its_line():
    text = TEXT.format(*map(flipped, KEYS))
    with pytest.raises(InputError) as caught:
        study_from_text(text.replace("3.0", "-3.0"), source="a.toml")
    assert "a.toml:4" in str(caught.value)


@pytest.mark.parametrize("key", ["center-nm", "center_nm"])
def test_numbers_of_a_design_take_both_signs(key):
    channel = {"name": "R", "filter": "gaussian", key: [560.0, 680.0], "width-nm": 40.0}
    (found,) = designed(channels=[channel]).channels
    assert set(found.numbers) == {"center_nm", "width_nm"}


def test_names_of_channels_keep_their_signs():
    filters = {"R_1": "ircut-650", "R-1": "ircut-680"}
    study = study_from_data({"sensors": [{"name": SENSOR, "channel-filters": filters}]})
    assert study.sensors[0].channel_filters == filters


def ran(line):
    return CliRunner().invoke(commands, line.split(), catch_exceptions=False)


@pytest.mark.parametrize(
    "words",
    [
        "compare onyx-rgbw onyx-rgb-ircut --sweep read{0}noise{0}e=1:3 --points 2 "
        "--quantity snr{0}y --time{0}ms 12 --matrix white{0}preserving --json -",
        "analyze onyx-rgbw --space linear{0}srgb --json -",
    ],
)
def test_a_command_line_takes_both_signs_and_prints_the_same(words):
    first, second = (ran(words.format(sign)) for sign in "-_")
    assert first.exit_code == second.exit_code == 0
    assert first.stdout == second.stdout


def test_a_command_takes_both_signs():
    found = {known_name(flipped(name), COMMANDS) for name in COMMANDS}
    assert found == set(COMMANDS)


def test_the_old_option_of_a_matrix_gives_the_same_and_warns_once():
    new = ran("matrix onyx-rgb-ircut --matrix ridge=0.1 --json -")
    for words in ("--method ridge=0.1", "--method=ridge=0.1"):
        old = ran(f"matrix onyx-rgb-ircut {words} --json -")
        assert (old.exit_code, old.stdout, new.stderr) == (0, new.stdout, "")
        (line,) = old.stderr.splitlines()
        assert "--method" in line
        assert "--matrix" in line


def test_the_old_option_of_denoising_gives_the_same_and_warns_once(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.save("a.npy", np.full((16, 16), 300, np.uint16))
    known = "--mosaic RG/GB --bits 12 --black-level 100 --gain-dn-per-e 0.5 --read-noise-e 5"
    new = ran(f"denoise a.npy {known} --denoise wiener -o new")
    old = ran(f"denoise a.npy {known} --method wiener -o old")
    assert old.exit_code == new.exit_code == 0
    assert len(old.stderr.splitlines()) == len(new.stderr.splitlines()) + 1
    pictures = [sorted(one.name for one in Path(name).glob("*.tif*")) for name in ("new", "old")]
    assert pictures[0] == pictures[1] != []
    for name in pictures[0]:
        assert (Path("old") / name).read_bytes() == (Path("new") / name).read_bytes()


def test_an_option_and_its_old_name_are_refused_together():
    with pytest.raises(click.UsageError):
        commands.main(
            ["matrix", "onyx-rgb", "--matrix", "lmmse", "--method", "kernel"], standalone_mode=False
        )


def test_the_old_keyword_gives_the_same_and_warns():
    codes = np.full((16, 16), 300, np.uint16)
    known = {"mosaic": "RG/GB", "gain_dn_per_e": 0.5, "read_noise_e": 5.0, "black_level": 100}
    new = cn.denoise(codes, unit="DN", denoise="wiener", bits=12, **known)
    with pytest.warns(FutureWarning, match="denoise"):
        old = cn.denoise(codes, unit="DN", method="wiener", bits=12, **known)
    assert np.array_equal(old.values_e, new.values_e)
    with pytest.raises(TypeError):
        cn.denoise(codes, unit="DN", method="wiener", denoise="wiener", **known)


def test_the_noise_of_a_gray_has_its_old_key_and_attribute_too():
    result = cn.analyze(SENSOR, space="lab")
    (own,) = result.to_dict()["sensors"]
    assert own["gray_noise"]["space"] == "CIELAB"
    assert own["grey_noise"] == own["gray_noise"]
    (outcome,) = result.outcomes
    with pytest.warns(FutureWarning, match="gray_noise"):
        assert outcome.grey_noise is outcome.gray_noise


OLD_CLASSES = {
    ("geometry", "Frame"): "DualBasis",
    ("io.frames", "Frame"): "RawFrame",
    ("study", "Method"): "MatrixMethod",
    ("apps.design", "DesignDocument"): "DesignStudy",
    ("apps.design", "Evaluator"): "Objectives",
    ("apps.design", "SearchResult"): "FrontResult",
    ("apps.design", "SearchSettings"): "SearchOptions",
}


@pytest.mark.parametrize(("package", "old"), OLD_CLASSES, ids=".".join)
def test_an_old_name_of_a_class_is_the_class_and_warns_where_it_is_used(package, old):
    module = import_module(f"chromanoise.{package}")
    new = OLD_CLASSES[package, old]
    with pytest.warns(FutureWarning, match=rf"\.{new}\b") as caught:
        found = getattr(module, old)
    assert found is getattr(module, new)
    assert Path(caught[0].filename) == Path(__file__)
    assert old not in module.__all__
    assert new in module.__all__


def found_again(old):
    """What an old name imports, and the file of the line that the warning names."""
    sys.modules.pop(old, None)
    with pytest.warns(FutureWarning, match=re.escape(old)) as caught:
        module = import_module(old)
    return module, Path(caught[0].filename)


@pytest.mark.parametrize("old", MOVED_PACKAGES)
def test_an_old_package_is_the_new_one_and_warns_where_it_is_used(old):
    assert found_again(old) == (import_module(MOVED_PACKAGES[old]), Path(__file__))


def test_a_module_of_an_old_package_is_no_second_copy():
    # in a process of its own: the checks of shapes here import modules before the finder is asked
    lines = "import chromanoise.scene.curves as old, chromanoise.spectra.curves as new"
    done = subprocess.run(
        [sys.executable, "-c", f"{lines}\nassert old is new"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "chromanoise.scene.curves is now chromanoise.spectra.curves" in done.stderr


@pytest.mark.parametrize(
    ("package", "name"),
    [(package, name) for package, names in MOVED_NAMES.items() for name in names],
)
def test_a_name_that_moved_to_another_package_is_found_in_the_old_one(package, name):
    new = MOVED_NAMES[package][name]
    with pytest.warns(FutureWarning, match=re.escape(f"{new}.{name}")):
        found = getattr(import_module(package), name)
    assert found is getattr(import_module(new), name)


def test_a_sensor_is_repeated_in_either_spelling():
    with refused_input(subject="sensors", value="onyx-rgb"):
        cn.analyze("onyx_rgb", "onyx-rgb")


def test_one_matrix_needs_no_list():
    sensors, sweep = ("onyx-rgb", "onyx-rgbw"), {"points": 3}
    alone, listed = (cn.compare(*sensors, matrices=one, **sweep) for one in ("lmmse", ["lmmse"]))
    assert alone.to_dict() == listed.to_dict()


@pytest.mark.parametrize("data", [[], None, "x"])
def test_a_study_of_python_is_a_mapping(data):
    with refused_input(subject="study", value=type(data).__name__):
        study_from_data(data)
