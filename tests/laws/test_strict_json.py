"""JSON is read in one place, which accepts only what every later step can use."""

import json
import os
import sys
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.apps.camera.measure import resumed
from chromanoise.apps.design import read_front
from chromanoise.base.errors import InputError
from chromanoise.base.inputs import MOST_DEPTH, json_file, json_of
from chromanoise.base.result_json import JsonKey, json_text, plain
from chromanoise.io.matrix_files import read_matrix
from chromanoise.io.result_tables import table_from_json
from chromanoise.io.sensor_files import sensor_from_json, sensor_json
from chromanoise.io.spectra import read_curves
from chromanoise.study import read_pixel_source, recorded_run
from chromanoise.study.resolve_names import resolve_sensor
from outcomes import refused_input
from strategies import white_channel

REFUSED = {
    "NaN": '{"a": NaN}',
    "infinity": '{"a": [-Infinity]}',
    "1e400": '{"a": 1e400}',
    "a whole number of 401 digits": f'{{"a": {"9" * 401}}}',
    "a whole number of 5001 digits": f'{{"a": {"9" * 5001}}}',
    "an unpaired surrogate": '{"a": "\\ud800"}',
    "an unpaired surrogate in a key": '{"\\udfff": 1}',
    "a key twice": '{"a": 1, "a": 2}',
    "deep lists": f'{{"a": {"[" * MOST_DEPTH}{"]" * MOST_DEPTH}}}',
    "lists too deep for the parser": f'{{"a": {"[" * 100_000}{"]" * 100_000}}}',
    "deep objects": '{"a": ' * (MOST_DEPTH + 1) + "1" + "}" * (MOST_DEPTH + 1),
    "half a text": '{"a": [1, 2',
    "a byte that is not UTF-8": b'{"a": "\xff"}',
    "UTF-16": '{"a": 1}'.encode("utf-16"),
}
READERS = {
    "a sensor": lambda path: sensor_from_json(path.read_text("utf-8"), source=str(path)),
    "a table": lambda path: table_from_json(path.read_text("utf-8"), source=str(path)),
    "a matrix": read_matrix,
    "a pixel": read_pixel_source,
    "curves": read_curves,
    "a front": read_front,
    "kept statistics": resumed,
    "a result": recorded_run,
}


@pytest.mark.parametrize("content", REFUSED.values(), ids=REFUSED)
def test_json_that_a_later_step_could_not_use_is_refused(content):
    with refused_input(subject="a.json"):
        json_of(content, "a.json")


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(
    "name", [name for name in REFUSED if not name.startswith(("a byte", "UTF"))]
)
def test_every_reader_refuses_it_with_the_name_of_the_file(reader, name, tmp_path):
    path = tmp_path / "a.json"
    path.write_text(REFUSED[name])
    with pytest.raises(InputError) as caught:
        READERS[reader](path)
    assert "a.json" in caught.value.subject
    assert len(str(caught.value).splitlines()) == 1
    str(caught.value).encode()  # no unpaired surrogate in the sentence either


JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**300), 10**300)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inside: st.lists(inside) | st.dictionaries(st.text(), inside),
)


@given(JSON)
def test_all_other_json_is_read_as_it_was_written(data):
    for text in (json.dumps(data), json.dumps(data, ensure_ascii=False).encode()):
        assert json_of(text, "a") == data


def test_the_largest_number_and_depth_are_read():
    largest = sys.float_info.max
    assert json_of(f"[{largest!r}, {int(largest)}]", "a") == [largest, int(largest)]
    with refused_input(subject="a"):
        json_of(f"[{int(largest) + 1}]", "a")
    held = json_of("[" * MOST_DEPTH + "]" * MOST_DEPTH, "a")
    for _ in range(MOST_DEPTH - 1):
        (held,) = held
    assert held == []


def test_headers_of_other_programs_may_hold_what_is_not_a_number():
    assert json_of('{"_FillValue": NaN, "a": 1e400}', "a", any_number=True)["a"] == float("inf")


def test_a_key_with_a_fault_is_named():
    with refused_input(subject="a", where="key 'b.c.1'"):
        json_of('{"b": {"c": [1, 1e400]}}', "a")


def loop(path):
    path.symlink_to(path.name)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pipes in folders")
@pytest.mark.parametrize(
    "made", [os.mkfifo, os.mkdir, loop, lambda path: path.symlink_to("/dev/zero")]
)
@pytest.mark.parametrize(
    "read",
    [partial(json_file, most_bytes=99), resumed, recorded_run, read_front, read_matrix],
)
def test_only_regular_files_are_read(made, read, tmp_path):
    path = tmp_path / "a.json"
    made(path)
    with pytest.raises(InputError):
        read(path)


def test_a_file_is_read_to_its_bound_only(tmp_path):
    path = tmp_path / "a.json"
    path.write_bytes(b"[" + b" " * 97 + b"]")
    assert json_file(path, most_bytes=99) == []
    with refused_input(subject=str(path), value=99):
        json_file(path, most_bytes=98)


@pytest.mark.parametrize("key", ["name", "notes"])
def test_a_sensor_with_an_unpaired_surrogate_is_refused(key, tmp_path):
    data = json.loads(sensor_json(white_channel()))
    data[key] = "\ud800" if key == "name" else ["\udc00"]
    path = tmp_path / "cam.json"
    path.write_text(json.dumps(data))
    with refused_input(subject=str(path)):
        resolve_sensor(str(path))


@given(
    st.recursive(
        st.none()
        | st.booleans()
        | st.integers()
        | st.floats(allow_nan=False, allow_infinity=False)
        | st.text(max_size=5),
        lambda one: (
            st.lists(one, max_size=4) | st.dictionaries(st.text(max_size=4), one, max_size=3)
        ),
        max_leaves=20,
    ),
    st.sampled_from([1, 2]),
    st.booleans(),
)
def test_indented_text_is_that_of_the_standard_library(data, indent, ensure_ascii):
    expected = json.dumps(data, indent=indent, ensure_ascii=ensure_ascii) + "\n"
    assert json_text(data, indent=indent, ensure_ascii=ensure_ascii) == expected


def test_no_text_is_made_of_what_is_not_a_number():
    for data in (float("nan"), [1.0, float("inf")], {"a": [[float("nan")]]}):
        with pytest.raises(ValueError, match="JSON"):
            json_text(data)


def test_a_file_that_changed_is_read_again(tmp_path):
    file = tmp_path / "qe.csv"
    for peak in (0.5, 0.25):
        file.write_text(f"wavelength_nm,W\n400,0.1\n500,{peak}\n")
        assert read_curves(file).curves.values.max() == peak


@dataclass(frozen=True)
class Inner:
    """A record whose keys are its fields."""

    number: float
    word: str
    numbers: np.ndarray


@dataclass(frozen=True)
class Outer:
    """A record with keys of every kind."""

    KEYS: ClassVar[tuple[JsonKey | str, ...]] = (
        "inner",
        JsonKey("same", "inner.number"),
        JsonKey("", "inner"),
        JsonKey("none", "missing", keys=("number",)),
        JsonKey("rows", "missing", rows=True, keys=("number",)),
        JsonKey("thousand", "inner.number", factor=1e3),
        JsonKey("named", "inner.numbers", by=(("a", "b"),)),
        JsonKey("never", "inner", when="missing"),
        "many",
    )

    inner: Inner
    missing: Inner | None
    many: tuple[Inner, ...]


@pytest.mark.parametrize("number", [1.5, float("nan")])
def test_a_record_is_written_by_its_keys(number):
    inner = Inner(number, "w", np.array([2.0, np.inf]))
    known = None if number != number else number
    plain_inner = {"number": known, "word": "w", "numbers": [2.0, None]}
    assert plain(Outer(inner, None, (inner,))) == {
        "inner": plain_inner,
        "same": known,
        **plain_inner,
        "none": None,
        "rows": None,
        "thousand": None if known is None else 1500.0,
        "named": {"a": 2.0, "b": None},
        "many": [plain_inner],
    }
    assert plain("abc", JsonKey("length", len)) == {"length": 3}
    assert plain(None, "number") is None
