"""Properties are declared once: whatever takes values of a pixel takes them from `Pixel`."""

import inspect
import os
import re
import subprocess
import sys
from dataclasses import MISSING, dataclass, fields
from typing import Annotated

import pytest
from click import Context

import chromanoise as cn
import make_stubs
from chromanoise.base.properties import Property, beside_their_needs, partial_class, properties_of
from chromanoise.cli.entry import commands
from chromanoise.io.pixels import read_pixel_toml
from chromanoise.sensor import PIXEL, PIXEL_REQUIRED, Pixel, PixelOverrides, PixelSource
from chromanoise.study import FUNCTIONS, SWEEPS, study_from_data
from chromanoise.web.controls import described_fields

NAMES = [one.name for one in fields(Pixel) if not one.name.startswith("summed_")]
COMMANDS = (("analyze", "analyze"), ("compare", "compare"), ("simulate", "render"))
VALUES = {name: PIXEL[name].slider[1] for name in NAMES}  # allowed, and no default


@pytest.mark.parametrize("name", make_stubs.STUBS)
def test_a_stub_has_the_fields_that_are_declared(name):
    """`python tools/make_stubs.py` writes it anew."""
    stored = (make_stubs.PACKAGE / name).read_text(encoding="utf-8")
    assert stored == make_stubs.STUBS[name]()


@pytest.mark.parametrize("name", NAMES)
def test_a_field_of_the_pixel_is_taken_wherever_a_pixel_is_described(name, tmp_path):
    value = VALUES[name]
    sensor = {"name": "onyx-rgbw", "pixel": {name: value}}
    assert getattr(study_from_data({"sensors": [sensor]}).sensors[0].pixel, name) == value
    text = f'schema = "chromanoise pixel"\nschema_version = 1\n{name} = {value}\n'
    (tmp_path / "pixel.toml").write_text(text)
    assert getattr(read_pixel_toml(tmp_path / "pixel.toml"), name) == value
    assert getattr(PixelOverrides(**{name: value}), name) == value
    option = f"--{name.replace('_', '-')}"
    for command, function in COMMANDS:
        assert name in FUNCTIONS[function]
        assert name in inspect.signature(getattr(cn, function)).parameters
        options = commands.get_command(Context(commands), command).params
        (own,) = (one for one in options if option in one.opts)
        assert PIXEL[name].help in own.help
    sweep = SWEEPS[option.removeprefix("--")]
    assert (sweep.what, sweep.unit) == (PIXEL[name].label, PIXEL[name].unit)
    (control,) = (one for one in described_fields() if one["key"] == f"sensors.pixel.{name}")
    assert (control["low"], control["high"], control["step"]) == PIXEL[name].slider


def test_a_pixel_needs_the_properties_without_a_default():
    required = {one.name for one in fields(Pixel) if one.default is MISSING}
    assert set(PIXEL_REQUIRED) == required
    silent = PixelSource(source="a sheet")
    assert all(getattr(silent, name) is None for name in NAMES)


@dataclass
class Lamp:
    warmth_k: Annotated[
        float,
        Property(
            label="warmth", unit="K", least=1, most=9, needs=("power_w",),
            help="Warmth [K]; default: {default:g}.",
        ),
    ] = 7.0  # fmt: skip
    size_mm: Annotated[
        float, Property(label="size", unit="mm", least=0, most=1, help="Size [mm].")
    ] = 0.5
    power_w: Annotated[
        float, Property(label="power", unit="W", least=0, most=1, help="Power [W].")
    ] = 0.0


def test_the_help_of_a_property_names_the_default_of_its_field():
    assert properties_of(Lamp)["warmth_k"].help == "Warmth [K]; default: 7."


def test_a_property_can_be_listed_beside_the_one_that_it_needs():
    assert list(beside_their_needs(properties_of(Lamp))) == ["size_mm", "power_w", "warmth_k"]


def test_any_subset_of_properties_can_be_given():
    partial = partial_class("PartialLamp", properties_of(Lamp))
    lamp = partial(size_mm=0.2)
    assert (lamp.warmth_k, lamp.size_mm, lamp.power_w) == (None, 0.2, None)
    with pytest.raises(TypeError, match="bulb"):
        partial(bulb=1)


CALLS = {
    "cn.analyze('onyx-rgbw', prnu=0.01, temperature_c=30.0, lux=4.0)": True,
    "cn.analyze('onyx-rgbw', prnu='much')": False,
    "cn.analyze('onyx-rgbw', prnv=0.01)": False,
    "cn.analyze('onyx-rgbw', equal='saturation', iso=[100.0], labels=['a'])": True,
    "cn.analyze('onyx-rgbw', equal='time')": False,
    "cn.analyze('onyx-rgbw', points=3)": False,
    "given: cn.study.ComparisonSettings = {'points': 3}; cn.compare('onyx-rgbw', **given)": True,
    "other: cn.study.ComparisonSettings = {'point': 3}": False,
}


@pytest.mark.evidence
def test_a_type_checker_knows_the_settings_of_functions(tmp_path):
    lines = ["import chromanoise as cn", *CALLS]
    (tmp_path / "calls.py").write_text("\n".join(lines))
    run = [sys.executable, "-m", "mypy", "calls.py"]
    env = os.environ | {"MYPYPATH": str(make_stubs.PACKAGE.parent)}
    done = subprocess.run(run, cwd=tmp_path, env=env, check=False, capture_output=True, text=True)
    refused = {int(found) for found in re.findall(r"^calls\.py:(\d+): error", done.stdout, re.M)}
    assert refused == {lines.index(call) + 1 for call, accepted in CALLS.items() if not accepted}
