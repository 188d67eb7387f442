"""Stored command lines give the outputs, files and exit codes that they gave when they were stored.

`tools/pin_commands.py` writes a change on purpose into the record; CHANGELOG.md names it.
"""

import pytest

import pin_commands
from chromanoise.cli.entry import COMMANDS

RECORD = pin_commands.stored_record()
SLOW = ("simulate", "optimize", "report", "denoise-bench", "demo", "rerun", "reproduce")
"""Words of rows that compile kernels, draw figures or take longer than others."""
QUICK = [row for row in RECORD["outputs"] if not any(word in row for word in SLOW)]


def check(rows):
    found = {row: pin_commands.differences(row, RECORD["outputs"][row]) for row in rows}
    assert not {row: lines for row, lines in found.items() if lines}


def test_a_stored_command_line_gives_the_stored_output():
    check(QUICK[2::3])


@pytest.mark.evidence
def test_every_stored_command_line_gives_the_stored_output():
    check(RECORD["outputs"])


def test_every_command_is_in_a_stored_line():
    lines = [line for row in RECORD["outputs"] for line in row.split(" && ")]
    assert {*COMMANDS} == {line.split()[0] for line in lines} - {"analyse"}
    assert {*RECORD["outputs"]} == {*pin_commands.rows()}


@pytest.mark.parametrize(
    ("old", "new", "are_equal"),
    [
        ("SNR 26.1 dB", "SNR 26.1 dB", True),
        ("SNR 26.1 dB", "SNR 26.2 dB", False),
        ("x = 1.00000000001e-3", "x = 0.00100000000002", True),
        ("x = 1.0000001", "x = 1.0000002", False),
        ("x = 1 e-", "x = 1 DN", False),
    ],
)
def test_texts_are_equal_if_only_the_last_digits_of_numbers_differ(old, new, are_equal):
    assert pin_commands.are_equal(old, new) is are_equal
