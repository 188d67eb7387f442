"""JSON to a file or to standard output."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from chromanoise._files import write_whole
from chromanoise.errors import InputError
from chromanoise.io.table import (
    Table,
)
from chromanoise.io.table_formats import table_writer

_ANOTHER = "name another file"


def write_json(data: dict[str, Any], target: str) -> None:
    """JSON to a file, whole or not at all, or to standard output where ``target`` is ``-``."""
    text = json.dumps(data, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    if target == "-":
        click.echo(text, nl=False)
    else:
        write_whole(Path(target), text.encode("utf-8"))


def refuse_inputs(target: str | Path | None, option: str, *inputs: str) -> None:
    """Say before anything is computed that a result would take the place of what it is made of."""
    if target is None or str(target) == "-":
        return
    goal = os.path.realpath(target)
    for name in inputs:
        if Path(name).exists() and os.path.realpath(name) == goal:
            raise InputError(
                option, "must not be a file that is read", value=str(target), remedy=_ANOTHER
            )


def refuse_same(targets: Mapping[str, str | Path | None]) -> None:
    """Say before anything is computed that one result would take the place of another."""
    seen: dict[str, str] = {}
    for option, target in targets.items():
        if target is None or str(target) == "-":
            continue
        first = seen.setdefault(os.path.realpath(target), option)
        if first != option:
            raise InputError(
                option, f"must not be the file of {first}", value=str(target), remedy=_ANOTHER
            )


def refuse_taken_inputs(
    targets: Mapping[str, str | Path | None], sensors: Sequence[str], options: Mapping[str, Any]
) -> None:
    """Before anything is computed: no result takes the place of an input, or has no format."""
    inputs = [
        *sensors,
        *filter(None, [options["illuminant"], options["pixel"], options["filter"]]),
    ]
    refuse_same(targets)
    for option, target in targets.items():
        refuse_inputs(target, option, *inputs)
        if option == "--table" and target is not None:
            table_writer(Path(target))


def write_table(table: Table, target: str) -> None:
    """A table in the format that its file's name ends in, whole or not at all."""
    write_whole(Path(target), table_writer(Path(target))(table).encode("utf-8"))
