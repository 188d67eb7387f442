"""The sentences tell the numbers of the tables, and nothing else."""

import re

import pytest

from chromanoise.study import (
    paper_study,
    paper_tables,
    reproduced,
    set_aside_reasons,
    table_5_finding,
    verdict,
)


@pytest.fixture(scope="module")
def study():
    return paper_study()


@pytest.fixture(scope="module")
def cells(study):
    return {(c.table, c.row, c.column): c for c in reproduced(study, draws=100).cells}


def numbers(sentence):
    return [float(n) for n in re.findall(r"-?\d+\.\d+|\d+", sentence)]


def test_the_verdict_tells_the_differences_of_tables_2_and_3(study, cells):
    raw = sum(
        cells[2, c, "RGBW_n 12 ms"].closed_form - cells[2, c, "RGB 12 ms"].closed_form
        for c in "RGB"
    )
    loss = (
        cells[3, "SNR_Y", "RGB 12 ms"].closed_form - cells[3, "SNR_Y", "RGBW_n 12 ms"].closed_form
    )
    sentence = verdict(study)
    assert f"{raw / 3:.1f} dB better in raw" in sentence
    assert f"{loss:.1f} dB worse in luminance" in sentence
    assert f"loses {study.columns['RGBW_n 12 ms'].price_db:.1f} dB to color" in sentence


def test_the_verdict_agrees_with_the_printed_tables_within_half_a_decibel(study):
    better, worse = (float(n) for n in re.findall(r"([\d.]+) dB (?:better|worse)", verdict(study)))
    assert better == pytest.approx((38.1 - 32.6 + 36.8 - 32.8 + 36.4 - 32.6) / 3, abs=0.5)
    assert worse == pytest.approx(32.4 - 26.1, abs=0.5)


def test_the_finding_on_table_5_tells_the_share_within_reach(study):
    # cos^2 of the printed angles 50.7 and 18.1 degrees
    assert {40.1, 90.3} <= set(numbers(table_5_finding(study)))


def test_the_sensor_without_ir_cut_is_set_aside_for_color_and_the_other_for_noise(study):
    color, noise = set_aside_reasons(study)
    assert color.startswith("onyx-rgb:")
    assert "false color" in color
    assert noise.startswith("onyx-rgbw-ircut: W is")
    assert "singular" in noise


def test_the_layout_keeps_every_cell_and_leaves_what_the_paper_does_not_print_empty(study):
    result = reproduced(study, draws=100)
    tables = paper_tables(result)
    laid_out = [c for t in tables for _, row in t.rows for c in row if c is not None]
    assert len(laid_out) == len(result.cells)
    assert set(map(id, laid_out)) == set(map(id, result.cells))
    white = dict(tables[0].rows)["W"]
    assert [cell is None for cell in white] == [False, True, True]
