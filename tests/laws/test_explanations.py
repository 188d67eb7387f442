"""What is behind each `?`: every symbol is explained, and is that of the nomenclature."""

import json
import re
import unicodedata
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

import make_formulas
from chromanoise.charts.explanations import EXPLANATIONS, explanation_as_json, mathml
from chromanoise.charts.registry import SECTIONS

NOMENCLATURE = Path(__file__).parents[2] / "docs" / "nomenclature.md"
_MATHML = "{http://www.w3.org/1998/Math/MathML}"
OPERATORS = {"log", "tr", "min"}
EACH = pytest.mark.parametrize("key", EXPLANATIONS)


def letters(latex, *, block=False):
    """The identifiers of a formula, and the transposition sign."""
    elements = ET.fromstring(mathml(latex, block=block)).iter()
    texts = {one.text for one in elements if one.tag in (f"{_MATHML}mi", f"{_MATHML}mo")}
    return {text for text in texts if text and (text.isalpha() or text == "⊤")} - OPERATORS


def rows():
    """Symbol and unit of each row of the nomenclature, by the names in its first cell."""
    found = {}
    for line in NOMENCLATURE.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 4:
            first = cells[0].partition("(")[0]
            found |= {name.strip(" `"): cells[1:3] for name in first.split(",")}
    return found


def plain(text):
    """A text without the difference between letters and their raised, lowered or slanted forms."""
    return unicodedata.normalize("NFKD", text)


def test_the_stored_formulas_are_those_of_all_explanations():
    """Otherwise ``python tools/make_formulas.py`` writes them anew."""
    stored = json.loads(make_formulas.FORMULAS.read_text(encoding="utf-8"))
    assert stored == make_formulas.formulas()


@EACH
def test_every_letter_of_a_formula_is_in_the_list_of_symbols(key):
    one = EXPLANATIONS[key]
    listed = set().union(*(letters(symbol.latex) for symbol in one.symbols))
    for latex in one.latex:
        assert letters(latex, block=True) <= listed
    used = set().union(*(letters(latex, block=True) for latex in one.latex))
    for symbol in one.symbols:
        assert letters(symbol.latex) <= used
        assert symbol.meaning


@EACH
def test_symbols_and_units_are_those_of_the_nomenclature(key):
    known = rows()
    for symbol in EXPLANATIONS[key].symbols:
        if not symbol.name:
            continue
        sign, unit = known[symbol.name]
        for letter in letters(symbol.latex) - {"i"}:
            assert plain(letter) in plain(sign).replace("^T", "⊤")
        assert unit.startswith(symbol.unit)


@EACH
def test_an_explanation_has_a_few_sentences_for_a_student(key):
    sentences = re.findall(r"[.?!](?: |$)", EXPLANATIONS[key].words)
    assert 2 <= len(sentences) <= 6
    assert not re.search(r"[_^\\=√]|sqrt|\bdiag\b", EXPLANATIONS[key].words)
    assert EXPLANATIONS[key].source


def test_every_chart_has_explanations_that_exist():
    for section in SECTIONS:
        assert section.explanations
        assert set(section.explanations) <= EXPLANATIONS.keys()


def test_one_symbol_has_one_meaning_and_one_unit():
    units = {}
    for one in EXPLANATIONS.values():
        for symbol in one.symbols:
            if symbol.name:
                assert units.setdefault(symbol.latex, symbol.unit) == symbol.unit


def test_formulas_are_elements_without_style_or_script():
    for key in EXPLANATIONS:
        data = explanation_as_json(key)
        for text in (*data["formulas"], *(one["symbol"] for one in data["symbols"])):
            for element in ET.fromstring(text).iter():
                assert element.tag.startswith(_MATHML)
                assert not {"style", "href", "onclick"} & set(element.keys())
