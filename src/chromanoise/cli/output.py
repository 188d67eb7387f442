"""Write JSON and tables to a file or to standard output."""

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from chromanoise._files import write_all_whole
from chromanoise.errors import InputError
from chromanoise.io.table import (
    Table,
)
from chromanoise.io.table_formats import table_writer

_ANOTHER = "name another file"

json_option = click.option(
    "--json", "json_target", metavar="FILE|-", help="Write JSON; - for standard output."
)


def json_text(data: dict[str, Any]) -> str:
    """JSON as the commands write it."""
    return json.dumps(data, indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def table_text(table: Table, target: str) -> str:
    """A table in the format given by the suffix of its file."""
    return table_writer(Path(target))(table)


def write_outputs(*outputs: tuple[str | None, Callable[[], str]]) -> None:
    """Write the files of a command, all or none; ``-`` is standard output.

    Parameters
    ----------
    outputs
        The file, ``None`` where it is not wanted, and the function that makes its text.
    """
    texts = {target: make() for target, make in outputs if target is not None}
    files = {Path(name): text.encode("utf-8") for name, text in texts.items() if name != "-"}
    write_all_whole(files)
    if "-" in texts:
        click.echo(texts["-"], nl=False)


def write_json(data: dict[str, Any], target: str) -> None:
    """Write JSON to a file atomically, or to standard output if ``target`` is ``-``."""
    write_outputs((target, lambda: json_text(data)))


def refuse_inputs(target: str | Path | None, option: str, *inputs: str) -> None:
    """Raise an error before any computation if an output file is also an input file."""
    if target is None or str(target) == "-":
        return
    goal = os.path.realpath(target)
    for name in inputs:
        if Path(name).exists() and os.path.realpath(name) == goal:
            raise InputError(
                option, "must not be a file that is read", value=str(target), remedy=_ANOTHER
            )


def refuse_same(targets: Mapping[str, str | Path | None]) -> None:
    """Raise an error before any computation if two outputs go to the same file."""
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
    """Check before any computation that no output replaces an input, and that its format exists."""
    inputs = [
        *sensors,
        *(options.get("channel_filters") or {}).values(),
        *(
            str(options[name])
            for name in ("illuminant", "pixel", "filter", "chart_file", "prior", "patch")
            if options.get(name) is not None
        ),
    ]
    refuse_same(targets)
    for option, target in targets.items():
        refuse_inputs(target, option, *inputs)
        if option == "--table" and target is not None:
            table_writer(Path(target))


def terminal() -> Console:
    """Standard output for tables; 140 columns wide if it is no terminal."""
    console = Console(highlight=False, markup=False)
    return console if console.is_terminal else Console(highlight=False, markup=False, width=140)


def print_lines(lines: Iterable[str]) -> None:
    """Print sentences, each on a line of its own."""
    for line in lines:
        terminal().print(line, soft_wrap=True)
