"""The build of the page as one file: its pins, and how it changes modules of WebAssembly."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
WEB = ROOT / "web"
sys.path.append(str(WEB))
wasm = pytest.importorskip("wasm", reason="the source distribution has no web/")

# (module (memory 1) (global $pointer (mut i32) (i32.const 7)) (func $kept) (func $dropped ...)
#   (export "memory" (memory 0)) (data (i32.const 3) "ab") (custom section "name"))
KEPT, DROPPED = b"\x02\x00\x0b", b"\x06\x00\x41\x01\x1a\x01\x0b"
SECTIONS = [
    (1, b"\x01\x60\x00\x00"),
    (wasm.IMPORTS, b"\x01\x01m\x01f\x00\x00"),
    (3, b"\x02\x00\x00"),
    (wasm.MEMORIES, b"\x01\x00\x01"),
    (wasm.GLOBALS, b"\x02\x7f\x01\x41\x07\x0b\x7f\x00\x41\x09\x0b"),
    (wasm.EXPORTS, b"\x02\x06memory\x02\x00\x05begin\x00\x01"),
    (wasm.CODE, b"\x02" + KEPT + DROPPED),
    (wasm.DATA, b"\x01\x00\x41\x03\x0b\x02ab"),
    (wasm.CUSTOM, b"\x04name\x01\x10\x03\x00\x01f\x01\x04kept\x02\x04gone"),
]


def test_a_module_is_read_and_written_without_its_names():
    module = wasm.MAGIC + b"".join(bytes([n]) + wasm.unsigned(len(d)) + d for n, d in SECTIONS)
    assert wasm.sections_of(module) == SECTIONS
    assert wasm.module_of(wasm.sections_of(module)) == wasm.module_of(SECTIONS[:-1])
    with pytest.raises(ValueError, match="module of WebAssembly"):
        wasm.sections_of(b"PK")


@pytest.mark.parametrize("value", [0, 1, 127, 128, 300, 1 << 31, (1 << 63) - 1])
def test_numbers_are_read_as_they_are_written(value):
    assert wasm.Bytes(wasm.unsigned(value)).unsigned() == value


@pytest.mark.parametrize(
    ("value", "coded"),  # WebAssembly Core Specification 3.0, 5.2.2, and its note
    [(0, b"\x00"), (-1, b"\x7f"), (63, b"\x3f"), (64, b"\xc0\x00"), (-123456, b"\xc0\xbb\x78")],
)
def test_signed_numbers_have_the_code_of_the_standard(value, coded):
    assert wasm.signed(value) == coded


def test_a_dropped_function_is_a_trap_and_the_others_stay():
    assert wasm.function_names(SECTIONS) == {0: "f", 1: "kept", 2: "gone"}
    hollow = wasm.hollowed(SECTIONS, {2})
    assert dict(hollow)[wasm.CODE] == b"\x02" + KEPT + b"\x03\x00\x00\x0b"


def test_a_frozen_module_begins_with_the_memory_and_the_variables_of_another():
    open_ = wasm.with_globals_exported(SECTIONS)
    assert b"saved-global-0" in dict(open_)[wasm.EXPORTS]
    memory = bytearray(2 << 16)
    memory[5:8], memory[70_000] = b"xyz", 9
    frozen = dict(
        wasm.frozen(open_, bytes(memory), {"saved-global-0": 2**31 + 1}, dropped=("begin",))
    )
    assert frozen[wasm.MEMORIES] == b"\x01\x00\x02"
    assert frozen[wasm.EXPORTS] == b"\x01\x06memory\x02\x00"
    assert frozen[wasm.GLOBALS].startswith(b"\x02\x7f\x01\x41" + wasm.signed(1 - 2**31))
    assert frozen[wasm.GLOBALS].endswith(b"\x7f\x00\x41\x09\x0b")
    assert wasm.DATA not in frozen
    pages = np.array([0, 70_000 // 4096], "<u4").tobytes()  # as interpreter.js puts them back
    assert frozen[wasm.CUSTOM] == b"\x05pages" + pages
    assert wasm.image(bytes(memory)) == bytes(memory[:4096] + memory[17 * 4096 : 18 * 4096])
    assert frozen[wasm.CUSTOM] in wasm.module_of([*frozen.items()])


def test_every_download_is_pinned_by_its_hash_and_names_no_host():
    lines = (WEB / "requirements.txt").read_text().splitlines()
    pins = [line for line in lines if not line.startswith("#")]
    assert all(re.fullmatch(r"\S+==\S+ --hash=sha256:[0-9a-f]{64}", line) for line in pins)
    locked = json.loads((WEB / "package-lock.json").read_text())["packages"]
    wanted = json.loads((WEB / "package.json").read_text())["devDependencies"]
    assert {name: locked[f"node_modules/{name}"]["version"] for name in wanted} == wanted
    for name, one in locked.items():
        assert not name or one["integrity"].startswith("sha512-")
        assert "resolved" not in one
