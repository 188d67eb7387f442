"""A study is what it says: its text, its hash, its run and its script tell the same."""

import json
import re
import shutil
import time
from dataclasses import replace
from pathlib import Path
from types import UnionType
from typing import Annotated, Literal, Union, get_args, get_origin

import pytest
from hypothesis import find, given, reject, settings, strategies as st

import chromanoise
from chromanoise.base import DeclaredField, InputError, Property, Record, RecordError, errors_in
from chromanoise.base.files import OWN_FILES
from chromanoise.study import (
    STARTER,
    Study,
    provenance,
    read_study,
    run_plan,
    run_study,
    sensor_with_pixel,
    study_as_python,
    study_as_toml,
    study_from_data,
    study_from_text,
    study_hash,
    study_of_output,
    study_schema,
)
from chromanoise.study.assembly import (
    duplicates,
    operating_points_of,
    repeated_labels,
    with_distinct_names,
)
from chromanoise.study.schema import (
    Known,
    LightPart,
    ParetoPart,
    PicturePart,
    PixelPart,
    SecondSweepPart,
    SensorPart,
    SweepPart,
)
from dear import dear
from outcomes import refused_input

SMALL = """
schema = 1
seed = 7
[light]
level_lux = 3.0
[[sensors]]
name = "onyx-rgbw"
[[sensors]]
name = "onyx-rgb-ircut"
pixel.read_noise_e = 2.0
[[sweeps]]
vary = "lux"
first = 0.1
last = 100
points = 5
[[pictures]]
frames = 2
[[pictures]]
mosaic = "bayer"
raw_only = true
row_noise_e = 2.5
"""


def small(changes=()):
    return study_from_text(SMALL, source="small", changes=changes)


def files_of(folder):
    return {p.name: p.read_bytes() for p in sorted(folder.iterdir()) if p.name != OWN_FILES}


# ---- texts ----

WORDS = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
OWN = {  # what their classes alone do not say
    "matrices": st.just(("kernel", "ridge=0.01", "lmmse")),
    "pareto": st.none(),
    "label": st.none() | st.text("abc 1", min_size=1, max_size=9),
    "patch": st.none() | WORDS | st.floats(0, 1),
    "crosstalk": st.none() | WORDS | st.floats(0, 1),
    "tone": st.sampled_from(["srgb", "linear"]) | st.floats(0.1, 10.0),
    "white_balance": st.sampled_from(["gray", "illuminant", "A", (2.0, 1.0, 1.5)]),
    "wavelengths": st.none() | st.tuples(st.floats(1, 9), st.floats(1, 9)),
}


def value_of(kind, about=()):
    """Values of a type of a study, within the bounds that its field declares."""
    origin, inside = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return value_of(inside[0], (*about, *inside[1:]))
    for one in about:
        if isinstance(one, Known):
            return st.sampled_from(one.names)
        if isinstance(one, Property):
            return st.floats(one.least, one.most)
    if origin in (Union, UnionType):
        return st.one_of(*(value_of(one, about) for one in inside))
    if origin is Literal:
        return st.sampled_from(inside)
    if origin is tuple:
        each = value_of(inside[0])
        few = st.lists(each, min_size=1, max_size=3).map(tuple)
        return few if inside[-1] is ... else st.tuples(*map(value_of, inside))
    if origin is dict:
        return st.dictionaries(WORDS, WORDS, min_size=1, max_size=2)
    if isinstance(kind, type) and issubclass(kind, Record):
        return part_of(kind)
    plain = {bool: st.booleans(), str: WORDS, type(None): st.none()}
    if kind in plain:
        return plain[kind]
    bounds = [one for one in about if isinstance(one, DeclaredField)]
    low = max((one.ge if one.ge is not None else one.gt or 0 for one in bounds), default=0)
    high = min((one.le or one.lt for one in bounds if one.le or one.lt), default=1000)
    return st.integers(low, high - 1) if kind is int else st.floats(max(low, 1e-3), high)


@st.composite
def part_of(draw, kind, most=3):
    """A part of a study with a few of its settings, which go together."""
    known = {name: one for name, one in kind.model_fields.items() if name != "schema_number"}
    chosen = draw(st.lists(st.sampled_from([*known]), max_size=most, unique=True))
    names = [name for name, one in known.items() if one.required or name in chosen]
    values = {
        name: draw(
            OWN[name] if name in OWN else value_of(known[name].annotation, known[name].metadata)
        )
        for name in names
    }
    try:
        return kind(**values)
    except RecordError:
        reject()


@settings(max_examples=150)
@given(part_of(Study, most=8))
def test_a_study_read_from_its_own_toml_is_the_same_study(study):
    assert study_from_text(study_as_toml(study), source="its text") == study


def test_the_toml_of_a_study_says_what_differs_from_the_defaults_and_no_more():
    text = 'schema = 1\n\n[light]\nlevel_lux = 3.0\n\n[[sensors]]\nname = "onyx-rgbw"\n'
    assert study_as_toml(study_from_text(text, source="text")) == text
    longer = text.replace("level_lux", 'illuminant = "E"\nlevel_lux') + 'beyond = "refuse"\n'
    assert study_as_toml(study_from_text(longer, source="text")) == text


def printed(study, capsys):
    exec(compile(study_as_python(study), "script", "exec"), {})
    return json.loads(capsys.readouterr().out)


def but_files(result):
    """A script writes into the folder in which it runs, under names of its own."""
    for one in result.get("pictures", []):
        one.pop("files")
        one.pop("not_written", None)
    return result


EXTRAS = [
    SMALL,
    """
matrices = ["lmmse", "kernel"]
metric = "energy"
[light]
illuminant = "3200K"
[exposure]
equal = "light"
magnification = 0.1
[[sensors]]
name = "model-rgb"
pixel = { pitch_um = 2.5, full_well_e = 5000 }
[[sweeps]]
vary = "read-noise-e"
first = 1
last = 50
points = 3
quantity = "bound"
all_priors = true
[outputs]
budget = false
clip = true
space = "lab"
matrix = true
pareto = { first = 0.1, last = 10, points = 3 }
""",
    """
[exposure]
time_ms = 4
[[sensors]]
name = "model-rgb"
[outputs]
merit = true
chart = true
""",
]


@pytest.mark.evidence
@pytest.mark.parametrize("text", EXTRAS)
def test_the_script_of_a_study_prints_the_numbers_of_its_run(text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    study = study_from_text(text, source="text")
    files = run_study(study, tmp_path / "run")
    ours = [but_files(json.loads(file.read_bytes())["result"]) for file in files]
    assert [but_files(one) for one in printed(study, capsys)] == ours
    for picture in tmp_path.glob("picture-*.raw.tiff"):
        run = next((tmp_path / "run").glob("picture-2-onyx-rgbw-*.raw.tiff"))
        if "rgbw" in picture.name:
            assert picture.read_bytes() == run.read_bytes()


def test_a_script_holds_words_of_a_study_as_words_only():
    text = SMALL.replace('"onyx-rgbw"', json.dumps("x') or print(1) #\\\n"))
    study = study_from_text('title = "\\t\\n\\"\\"\\" boo"\n' + text, source="text")
    compile(study_as_python(study), "script", "exec")
    with refused_input(setting_name="name"):
        exec(compile(study_as_python(study), "script", "exec"), {})


# ---- hash ----

OTHER = {  # words that name something, and values that go together
    "observer": "cie-1964-10",
    "matrices": ("lmmse",),
    "prior": "chart",
    "illuminant": "A",
    "level_lux": 4.0,
    "column": "c",
    "name": "model-rgb",
    "filter": "ircut-650",
    "file": "p.txt",
    "shape": (2, 3),
    "wavelengths": (400.0, 700.0),
    "patch": 0.5,
    "channel_filters": {"R": "ircut-650"},
    "label": "small",
    "second": SecondSweepPart(vary="f-number", first=1.4, last=8.0),
    "crosstalk": 0.1,
    "pareto": ParetoPart(first=1.0, last=2.0),
    "white_balance": "D65",
    "tone": "linear",
}


def another(model, name):
    """A value of a field that is not its own."""
    one, own = type(model).model_fields[name], getattr(model, name)
    if name in OTHER:
        return OTHER[name]
    return find(value_of(one.annotation, one.metadata), lambda value: value not in (own, None))


FULL = Study(
    sensors=(SensorPart(name="onyx-rgbw"),),
    sweeps=(SweepPart(vary="lux", first=1.0, last=10.0),),
    pictures=(PicturePart(cube="builtin:other"),),
)


def leaves(model, path=()):
    """(path, field's name, another value) of every value that a study holds."""
    for name in type(model).model_fields:
        value = getattr(model, name)
        if isinstance(value, Record):
            yield from leaves(value, (*path, name))
        elif isinstance(value, tuple) and value and isinstance(value[0], Record):
            yield from leaves(value[0], (*path, name, 0))
        else:
            yield path, name, None if name == "schema_number" else another(model, name)


def changed(model, path, name, value):
    """A copy that differs in one field, unchecked: only the hash is asked."""
    if not path:
        return model.model_copy(update={name: value})
    step, *rest = path
    inner = getattr(model, step)
    if rest and rest[0] == 0:
        return model.model_copy(update={step: (changed(inner[0], rest[1:], name, value),)})
    return model.model_copy(update={step: changed(inner, rest, name, value)})


@pytest.mark.evidence
def test_the_hash_depends_on_every_field_of_a_study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.txt").write_text("x")
    (tmp_path / "builtin").mkdir()
    seen = {study_hash(FULL)}
    count = 1
    for path, name, other in leaves(FULL):
        if name == "schema_number":  # there is one schema
            continue
        if path == ("reflectances",) and name in ("chart", "pairs"):
            other = "p.txt"
        seen.add(study_hash(changed(FULL, path, name, other)))
        count += 1
    assert len(seen) == count > 50


def test_the_hash_depends_on_the_bytes_of_every_file_and_on_the_version(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = ["s.csv", "light.csv", "pixel.txt", "cube.hdr", "cube.dat"]
    for name in names:
        (tmp_path / name).write_text("ENVI\n" if name == "cube.hdr" else "one")
    (tmp_path / "pages").mkdir()
    (tmp_path / "pages" / "1.png").write_text("one")
    (tmp_path / "bare").write_text("one")  # a file of curves needs no ending
    study = Study(
        light=LightPart(illuminant="light.csv"),
        sensors=(
            SensorPart(name="s.csv", pixel=PixelPart(file="pixel.txt")),
            SensorPart(name="bare"),
        ),
        pictures=(PicturePart(cube="cube.dat"), PicturePart(cube="pages")),
    )
    result = provenance(study)
    assert set(result["files"]) == {*names, "pages/1.png", "bare"}
    seen = {result["hash"]}
    for name in result["files"]:
        kept = (tmp_path / name).read_text()
        (tmp_path / name).write_text(kept + "two")
        seen.add(study_hash(study))
        (tmp_path / name).write_text(kept)
    monkeypatch.setattr("chromanoise.study.hashes.__version__", "another")
    seen.add(study_hash(study))
    assert len(seen) == 2 + len(result["files"])
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pages" / "2.png").write_text("new")
    assert study_hash(study) not in seen


# ---- runs ----


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "whole"
    run_study(small(), folder)
    return folder


@pytest.mark.evidence
@pytest.mark.parametrize("after", [0, 1, 2, 3])
def test_a_run_that_was_stopped_goes_on_to_the_same_bytes(after, whole, tmp_path):
    steps = []

    def reported(what, done):
        if len(steps) == after:
            raise KeyboardInterrupt
        steps.append(done)

    with pytest.raises(KeyboardInterrupt):
        run_study(small(), tmp_path / "o", report=reported)
    stood = []
    run_study(small(), tmp_path / "o", report=lambda _, done: stood.append(done))
    assert stood == [True] * after + [False] * (4 - after)
    assert files_of(tmp_path / "o") == files_of(whole)


def test_a_picture_that_is_missing_or_empty_is_taken_again(whole, tmp_path):
    for spoil in (Path.unlink, lambda path: path.write_bytes(b"")):
        shutil.copytree(whole, tmp_path / "o", dirs_exist_ok=True)
        spoil(next((tmp_path / "o").glob("picture-1-*.png")))
        stood = []
        run_study(small(), tmp_path / "o", report=lambda _, done, stood=stood: stood.append(done))
        assert stood == [True, True, False, True]
        assert files_of(tmp_path / "o") == files_of(whole)


def test_a_changed_picture_is_refused_and_stays(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "o")
    picture = next((tmp_path / "o").glob("picture-1-*.png"))
    picture.write_bytes(picture.read_bytes() + b"changed")
    before = files_of(tmp_path / "o")
    with refused_input(subject=str(picture), found="was changed after it was written"):
        run_study(small(), tmp_path / "o")
    assert files_of(tmp_path / "o") == before


@pytest.mark.parametrize("result", [None, 3, *dear("x", [])])
def test_a_step_without_a_result_stays_and_is_done_again_once_it_is_moved(result, whole, tmp_path):
    shutil.copytree(whole, tmp_path / "o")
    step = tmp_path / "o" / "sweep-1-lux-snr-y.json"
    data = json.loads(step.read_bytes())
    if result is None:
        del data["result"]
    else:
        data["result"] = result
    step.write_text(json.dumps(data))
    with refused_input(subject=str(step), found="was changed after it was written"):
        run_study(small(), tmp_path / "o")
    assert json.loads(step.read_bytes()) == data
    step.rename(tmp_path / "mine.json")
    run_study(small(), tmp_path / "o")
    assert files_of(tmp_path / "o") == files_of(whole)


def test_files_of_a_study_are_told_from_its_own_folder(tmp_path, monkeypatch):
    project = tmp_path / "project"
    project.mkdir()
    rows = [f"{w},{0.3},{0.1 + w / 9000},{0.2}" for w in range(400, 1051, 10)]
    for name in ("cam.csv", "bare"):
        (project / name).write_text("\n".join(["wavelength_nm,A,B,C", *rows]))
    (project / "lamp.csv").write_text("wavelength_nm,lamp [W]\n380,1\n1060,2\n")
    (project / "pixel.txt").write_text("sigma_d = 3.0 e-\n")
    (project / "glass.csv").write_text("wavelength_nm,T\n380,0.5\n1060,0.5\n")
    (project / "onyx-rgbw").write_text("no sensor hides a name of ours")
    text = (
        '[light]\nilluminant = "lamp.csv+1xLED850"\n[[sensors]]\nname = "cam.csv"\n'
        'pixel.file = "pixel.txt"\nfilter = "glass.csv"\n[[sensors]]\nname = "bare"\n'
        '[[sensors]]\nname = "onyx-rgbw"\nfilter = "ircut-650"\n[[pictures]]\n'
    )
    (project / "s.toml").write_text(text)
    monkeypatch.chdir(tmp_path)
    study = read_study("project/s.toml")
    names = ("lamp.csv", "cam.csv", "glass.csv", "pixel.txt", "bare")
    assert set(provenance(study)["files"]) == {f"project/{name}" for name in names}
    assert study.sensors[2].name == "onyx-rgbw"
    assert study.pictures[0].cube == "builtin:checker"
    assert len(run_plan(study).steps) == 2
    monkeypatch.chdir(project)
    assert read_study("s.toml") == study_from_text(text, source="text")


def test_a_sensor_by_a_name_that_no_file_can_have_is_one_sentence(tmp_path):
    for name in ("x" * 5000, "a\0.json", "a\0"):
        text = f"[[sensors]]\nname = {json.dumps(name)}"
        with pytest.raises(InputError) as error:
            run_study(study_from_text(text, source="text"), tmp_path / "o")
        assert len(str(error.value).splitlines()) == 1
        with pytest.raises(InputError):
            sensor_with_pixel(name)
    assert not (tmp_path / "o").exists()


def test_a_comment_may_be_a_line_of_dots(tmp_path):
    text = f"# {'.' * 70}\n{SMALL}\n# {'.' * 700}"
    assert study_from_text(text, source="text") == small()
    with pytest.raises(InputError, match="64"):
        study_from_text(f"a = ['''\n# ''', {{{'a.' * 90}b = 1}}]", source="text")


def test_the_study_of_any_output_runs_to_the_same_bytes(whole, tmp_path):
    study = small()
    for output in [whole, *whole.glob("*.json")]:
        assert study_of_output(output) == study
    run_study(study_of_output(whole), tmp_path / "o")
    assert files_of(tmp_path / "o") == files_of(whole)


def test_frames_and_parts_of_a_study_do_not_share_their_noise(whole):
    codes = {p.read_bytes() for p in whole.glob("picture-1-onyx-rgbw-*.xyz.tiff")}
    assert len(codes) == 2
    data = json.loads((whole / "pictures-2.json").read_bytes())["result"]["pictures"]
    assert [one["frame"] for one in data] == [2, 2]


def test_an_output_that_was_changed_or_is_of_another_version_or_file_is_refused(
    whole, tmp_path, monkeypatch
):
    text = (whole / "study.json").read_text()
    for name, content in [
        ("seed", text.replace('"seed": 7', '"seed": 8', 1)),
        ("kind", text.replace('"level_lux": 3.0', '"level_lux": "3"')),
        ("half", text[: len(text) // 2]),
        ("other", "{}"),
        ("list", "[1]"),
        ("deep", "[" * 100_000),
    ]:
        assert content != text
        path = tmp_path / f"{name}.json"
        path.write_text(content)
        with pytest.raises(InputError, match=path.name) as error:
            study_of_output(path)
        assert len(str(error.value).splitlines()) == 1
    monkeypatch.setattr("chromanoise.study.hashes.__version__", "0.0.0")
    with pytest.raises(InputError, match=re.escape(repr(chromanoise.__version__))):
        study_of_output(whole)
    with pytest.raises(InputError, match=whole.name):
        run_study(small(), whole)


def test_results_of_a_file_that_changed_since_are_not_gone_on_with(tmp_path):
    curves = tmp_path / "cam.csv"
    rows = [f"{w},{0.3},{0.4}" for w in range(400, 1051, 10)]
    curves.write_text("\n".join(["wavelength_nm,A,B", *rows]))
    study = study_from_text(f"[[sensors]]\nname = {json.dumps(str(curves))}", source="text")
    run_study(study, tmp_path / "o")
    curves.write_text("\n".join(["wavelength_nm,A,B", *rows]).replace("0.4", "0.5"))
    for again in (run_study, lambda _, folder: study_of_output(folder)):
        with pytest.raises(InputError, match=r"cam\.csv"):
            again(study, tmp_path / "o")


def test_outputs_stay_in_their_folder_whatever_a_sensor_is_called(tmp_path):
    name = "..\\ .. $(x) é"
    curves = tmp_path / f"{name}.csv"
    rows = [f"{w},{0.3},{0.1 + 0.4 * (w % 70) / 70},{0.2 + w / 9000}" for w in range(400, 1051, 10)]
    curves.write_text("\n".join(["wavelength_nm,A,B,C", *rows]))
    text = f"[[sensors]]\nname = {json.dumps(str(curves))}\n[[pictures]]\nformats=['png']"
    files = run_study(study_from_text(text, source="text"), tmp_path / "o")
    assert {p.parent for p in files} == {tmp_path / "o"}
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(["o", curves.name])
    (picture,) = (tmp_path / "o").glob("*.png")
    assert picture.name.isprintable()
    assert not set(picture.name) & set("\\/$( ")


def test_what_cannot_be_is_refused_before_anything_is_computed(tmp_path):
    for change, key in [
        ("sweeps.0.first=1e30", "sweeps.0.vary"),
        ("sweeps.0.first=200", "sweeps.0.vary"),
        ("pictures.1.mosaic=RG/B", "pictures.1.mosaic"),
        ("pictures.0.formats=['dng']", "pictures.0"),
        ("pictures.0.cube=nowhere.hdr", ""),  # found when the files are hashed
        ("pictures.0.scale=2", "pictures.0.scale"),
        ("sensors.0.name=onyx", "sensors.0.name"),
        ('sensors.1={name = "onyx-rgbw"}', "sensors.1.name"),
        ("sensors.0.pixel.file=nowhere.txt", ""),
        ("matrices=['ridge']", "matrices.0"),
    ]:
        named = None if key else change.partition("=")[2]
        with pytest.raises(InputError, match=named) as error:
            run_study(small([change]), tmp_path / "o")
        (one,) = errors_in(error.value)
        assert one.setting.startswith(key)
        assert len(str(error.value).splitlines()) == 1
        assert not (tmp_path / "o").exists()


def test_a_study_that_asks_for_nothing_is_told_so():
    text = '[[sensors]]\nname = "onyx-rgbw"\n[outputs]\nanalyses = false'
    with refused_input(subject="the study"):
        run_plan(study_from_text(text, source="text"))


# ---- reading ----


def test_every_fault_is_told_at_once_with_file_line_and_what_may_be_meant(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(
        'metric = "quants"\n'
        "[light]\n"
        "level_lux = -1\n"
        "iluminant = 3\n"
        "[[sensors]]\n"
        'name = "onyx-rgbw"\n'
        "[sensors.pixel]\n"
        'pitch_um = "wide"\n'
        "[[sensors]]\n"
        "[[pictures]]\n"
        "bits = 99\n"
        "[[sweeps]]\n"
        'vary = "luxx"\n'
        "first = nan\n"
    )
    with pytest.raises(InputError) as error:
        read_study(path)
    lines = str(error.value).splitlines()
    values = {line.removeprefix(f"{path}:").split(":")[0] for line in lines}
    assert values == {"1", "3", "4", "8", "9", "11", "12", "13", "14"}
    assert any("did you mean illuminant" in line for line in lines)
    path.write_text(
        'metric = "quants"\n[[sensors]]\nname = "onyx-rgb"\n'
        '[[sweeps]]\nvary = "luxx"\nfirst=1\nlast=2\n'
        '[[pictures]]\nmosaic="bayer"\ndemosaic = "bilinar"\nformats = ["png", "jpg"]\n'
    )
    with pytest.raises(InputError) as error:
        read_study(path)
    found = [
        (1, "metric", "quants", "quanta"),
        (5, "sweeps.0.vary", "luxx", "lux"),
        (10, "pictures.0.demosaic", "bilinar", "bilinear"),
        (11, "pictures.0.formats.1", "jpg", "png"),
    ]
    lines = str(error.value).splitlines()
    for one, line, (number, key, value, meant) in zip(
        error.value.errors, lines, found, strict=True
    ):
        assert line.startswith(f"{path}:{number}: {key}: ")
        assert (one.setting, one.value) == (key, value)
        assert f"did you mean {meant}?" in one.remedy


def test_a_change_wins_over_the_file_and_is_named_where_it_is_wrong():
    study = small(["light.level_lux=5", "sensors.0.name=model-rgb", "sensors.1.pixel.pitch_um=2.0"])
    assert study.light.level_lux == 5
    assert [sensor.name for sensor in study.sensors] == ["model-rgb", "onyx-rgb-ircut"]
    assert study.sensors[1].pixel == PixelPart(read_noise_e=2.0, pitch_um=2.0)
    for change, fields in [
        ("light.level_lux=-1", {"subject": "level_lux", "value": -1}),
        (f"light.level_lux=1{0:0400}", {"subject": "level_lux", "value": float("inf")}),
        ("light.lux=1", {"subject": "lux", "remedy": ("did you mean level_lux?",)}),
        ("title=a\x1b[31m", {"subject": "title", "value": "a\x1b[31m"}),
        ("light", {"value": "light"}),
        ("sensors.7.name=x", {"value": "7"}),
        ("seed.0=1", {"value": "seed.0"}),
        (".=1", {"value": ".=1"}),
        ("sensors.\u00b2.name=x", {"value": "\u00b2"}),
        (f"sensors.{'9' * 5000}.name=x", {"value": "9" * 5000}),
        (f"seed={'9' * 5000}", {"value": "9" * 5000}),
        (f"seed={'[' * 5000}", {"value": "[" * 5000}),
        (f"seed={{{'a.' * 5000}b=1}}", {"value": 5000}),
    ]:
        with refused_input(**fields) as error:
            small([change])
        assert str(error.value).startswith(f"change {change[:80]}")
        assert len(str(error.value)) < 500


def test_a_study_with_a_byte_order_mark_is_that_without(tmp_path):
    for name, start in (("plain.toml", b""), ("marked.toml", b"\xef\xbb\xbf")):
        (tmp_path / name).write_bytes(start + SMALL.encode("utf-8"))
    plain, marked = (read_study(tmp_path / name) for name in ("plain.toml", "marked.toml"))
    assert plain.model_dump() == marked.model_dump()


def test_the_caller_names_the_changes_in_errors():
    with pytest.raises(InputError) as error:
        study_from_text(SMALL, source="small", changes=["seed=-1"], change_label="--set")
    assert str(error.value).startswith("--set seed=-1: ")


def nested(depth):
    return "a = " + "[" * depth + "]" * depth


HOSTILE = [
    "",
    "\x00",
    "a" * 2_000_000,
    nested(100),
    nested(100_000),
    "a." * 50_000 + "b = 1",
    "[" + "a." * 50_000 + "b]",
    "[light]\nlevel_lux = 1\n[light]\nlevel_lux = 2",
    "light.level_lux = 1\n[light]\nlevel_lux = 2",
    'light = 3\nsensors = "x"\nsweeps = 1.5\npictures = {}\noutputs = []\nexposure = true',
    "sensors = []",
    "sensors = [[]]",
    "sensors = [1, 'a', {}, []]",
    "schema = 2\n[[sensors]]\nname = 'a'",
    "schema = true\n[[sensors]]\nname = 'a'",
    "[[sensors]]\nname = 1979-05-27",
    "[[sensors]]\nname = 'a'\n[light]\nlevel_lux = inf",
    "seed = 99999999999999999999999999\n[[sensors]]\nname='a'",
    "matrices = ['']\n[[sensors]]\nname='a'",
    "[[sensors]]\nname='a'\n[[pictures]]\nshape=[1]\nwavelengths=[1,2,3]\nformats=[]\nframes=0",
    "x = " + "9" * 10_000,
]


@pytest.mark.parametrize("text", HOSTILE, ids=lambda text: text[:12].encode().hex() or "empty")
def test_a_hostile_text_is_refused_in_sentences(text, tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(text)
    start = time.perf_counter()
    with pytest.raises(InputError) as error:
        read_study(path)
    assert time.perf_counter() - start < 4.0
    for line in str(error.value).splitlines():
        assert line.startswith(f"{path}")
        assert len(line) < 2000


def test_other_things_than_a_text_are_refused_in_one_sentence(tmp_path):
    (tmp_path / "latin").write_bytes(b"title = '\xe9'")
    for path in (tmp_path, tmp_path / "latin", tmp_path / "none", "a\0b"):
        with pytest.raises(InputError) as error:
            read_study(path)
        assert len(str(error.value).splitlines()) == 1


def test_the_starter_is_a_study_of_two_sensors_and_the_schema_knows_all_its_keys():
    study = study_from_text(STARTER, source="starter")
    assert [sensor.name for sensor in study.sensors] == ["onyx-rgbw", "onyx-rgb-ircut"]
    schema = study_schema()
    for key in ("light", "sensors", "sweeps", "pictures", "outputs", "schema"):
        assert key in schema["properties"]


def test_every_key_of_a_study_file_is_described():
    schema = study_schema()
    for part in [schema, *schema["$defs"].values()]:
        for name, field in part["properties"].items():
            assert "description" in field or "$ref" in str(field), name  # a part tells itself


def test_a_thousand_sensors_are_compared_in_linear_time():
    parts = [{"name": "onyx-rgbw", "shift_nm": i / 50, "label": f"s{i}"} for i in range(999)]
    study = study_from_data({"sensors": [*parts, {"name": "onyx-rgbw", "shift_nm": 0.0}]})
    start = time.process_time()
    (repeated,) = duplicates(study)
    assert repeated.setting == "sensors.999.name"
    assert repeated_labels(study) == []
    assert time.process_time() - start < 0.5  # by pairs of models: 3 s


def test_a_sensor_given_several_times_is_one_error():
    (repeated,) = duplicates(study_from_data({"sensors": [{"name": "onyx-rgbw"}] * 4}))
    assert (repeated.setting, repeated.value) == ("sensors.1.name", "onyx-rgbw")
    assert "4 times" in repeated.found


def test_two_words_of_one_sensor_are_one_repetition():
    words = ["a.csv", "./a.csv", "onyx-rgbw", "onyx_rgbw"]
    found = duplicates(study_from_data({"sensors": [{"name": word} for word in words]}))
    assert [one.setting for one in found] == ["sensors.1.name", "sensors.3.name"]


def test_of_files_with_one_name_each_is_named(tmp_path):
    files = [tmp_path / folder / "s.csv" for folder in "ab"]
    for file, qe in zip(files, (0.4, 0.5), strict=True):
        file.parent.mkdir()
        file.write_text(f"wavelength_nm,R,G\n400,{qe},0.1\n700,0.1,{qe}\n1050,0,0\n")
    study = study_from_data({"sensors": [{"name": str(file)} for file in files]})
    for point, file in zip(operating_points_of(study), files, strict=True):
        assert any(note.endswith(str(file)) for note in point.sensor.notes)


def test_equal_names_get_numbers_that_are_not_names_already():
    names = ["cam", "cam", "cam (2)", "cam", "b", "cam (3)", "b"]
    (point,) = operating_points_of(study_from_data({"sensors": [{"name": "onyx-rgbw"}]}))
    points = [replace(point, sensor=replace(point.sensor, name=name)) for name in names]
    distinct = [one.sensor.name for one in with_distinct_names(points)]
    assert distinct == ["cam", "cam (4)", "cam (2)", "cam (5)", "b", "cam (3)", "b (2)"]
