"""JavaScript has no bound, default or range of a setting: the server sends them."""

import re
from pathlib import Path

import pytest

import chromanoise
from chromanoise.study import study_schema
from chromanoise.study.color_matrices import DEFAULT_METHOD
from chromanoise.web.controls import study_defaults

ROOT = Path(chromanoise.__file__).parent
SCRIPTS = sorted(
    (*ROOT.glob("web/assets/**/*.js"), *ROOT.glob("charts/draw/*.js"), *ROOT.glob("report/*.js"))
)
NUMBER = r"-?\b\d+(?:\.\d+)?(?:e[-+]?\d+)?\b"
RANGE = re.compile(rf"\b(?:low|high|start|first|last|least|most|fewest)\s*:\s*{NUMBER}")
TERMS = {"exposure", "light", "refuse", "gray", "eye"}
"""Words of choices with an own control, which compares them by name."""


def parts_of(schema):
    return [schema, *schema["$defs"].values()]


KEYS = {key for part in parts_of(study_schema()) for key in part.get("properties", {})}
SETTINGS = {key for key in KEYS if "_" in key} | {"seed", "bits", "prnu", "frames", "magnification"}


def code_of(text):
    """The lines of a script with their numbers, without comments and text that is shown."""
    text = re.sub(
        r"/\*.*?\*/", lambda found: re.sub(r"[^\n]", " ", found[0]), text, flags=re.DOTALL
    )
    return [(i, re.sub(r"//.*", "", line)) for i, line in enumerate(text.split("\n"), 1)]


def bounds_of(text):
    """The lines of a script that compare, limit or default a setting with a number."""
    keys = "|".join(sorted(SETTINGS))
    beside = re.compile(
        rf"\b({keys})\b[\"'\])]*\s*(?:\?\?|\|\||[<>]=?|[=!]==|=|:|%)\s*{NUMBER}"
        rf"|{NUMBER}\s*(?:[<>]=?|[=!]==)\s*[\w.?\[\]\"']*\b({keys})\b"
        rf"|Math\.(?:min|max)\([^()]*\b({keys})\b[^()]*{NUMBER}"
    )
    return [
        f"{i}: {line.strip()}"
        for i, line in code_of(text)
        if beside.search(line) or RANGE.search(line)
    ]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda one: one.name)
def test_no_script_has_a_bound_a_range_or_a_number_for_a_setting(script):
    assert bounds_of(script.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda one: one.name)
def test_no_script_has_a_default_of_a_study(script):
    words = {one for one in study_defaults().values() if isinstance(one, str) and one} - TERMS
    words = {one for one in words | {DEFAULT_METHOD} if len(one) > 2}
    found = [
        f"{i}: {line.strip()}"
        for i, line in code_of(script.read_text(encoding="utf-8"))
        for word in re.findall(r"[\"']([^\"']+)[\"']", line)
        if word in words
    ]
    assert found == []


@pytest.mark.parametrize(
    ("line", "is_found"),
    [
        ("const seed = study.seed ?? 0;", True),
        ("const { sensors, seed = 0 } = study;", True),
        ("weight: { label: 'Weight', low: 0.001, high: 1000 }", True),
        ("if (study.exposure.time_ms > 1000) return;", True),
        ("if (0 < study.exposure.f_number) return;", True),
        ("study.light.level_lux = Math.max(value, 3);", False),
        ("level = Math.min(study.light.level_lux, 1e4);", True),
        ("const range = rangeOf(choices, 'light.level_lux');", False),
        ("// level_lux = 10", False),
        ("brief(study.light.level_lux)", False),
    ],
)
def test_the_check_finds_numbers_beside_settings(line, is_found):
    assert bool(bounds_of(line)) is is_found
