"""``chromanoise catalog``: built-in data with source, range and known defects."""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from chromanoise.base import InputError
from chromanoise.cli.options import PATH, command
from chromanoise.cli.output import as_json, json_option, write_outputs
from chromanoise.study import (
    KINDS,
    Entry,
    catalog_entries,
    catalog_entry,
    catalog_folder,
    entries_as_json,
    pixel_summary,
)

_WIDTH = 100


@command()
@click.argument("word", required=False, metavar="[KIND|NAME]")
@click.option(
    "--folder",
    type=PATH,
    help="Folder of your own tables, instead of CHROMANOISE_CATALOG.",
)
@click.option(
    "--markdown", metavar="FILE|-", help="Write the tables as Markdown; - for standard output."
)
@json_option
def catalog(
    word: str | None, folder: Path | None, markdown: str | None, json_target: str | None
) -> None:
    """List sensors, cameras, illuminants, reflectances, filters and scenes, or show the entry NAME.

    The environment variable CHROMANOISE_CATALOG names a folder of your own tables.
    """
    if markdown == "-" and json_target == "-":
        raise InputError(
            "--markdown",
            "must be a file where --json writes to standard output",
            value=markdown,
            remedy="name a file",
        )
    folder = catalog_folder() if folder is None else folder
    one = word is not None and word not in KINDS
    entries = (
        (catalog_entry(word, folder=folder),)
        if one and word is not None
        else catalog_entries(word, folder=folder)
    )
    write_outputs(
        as_json(json_target, lambda: entries_as_json(entries)),
        (markdown, lambda: as_markdown(entries)),
    )
    if "-" in (json_target, markdown):
        return
    if one:
        click.echo("\n".join(entry_as_text(entries[0])))
    else:
        print_entries(entries)


def print_entries(entries: Sequence[Entry]) -> None:
    """One table per kind."""
    console = Console(highlight=False, markup=False)
    if not console.is_terminal:
        console = Console(highlight=False, markup=False, width=_WIDTH)
    for kind, word in KINDS.items():
        here = [entry for entry in entries if entry.provenance.kind == word]
        if not here:
            continue
        table = Table(title=kind.capitalize(), title_justify="left", expand=True)
        longest = max(len(entry.provenance.name) for entry in here)
        table.add_column("name", width=longest + 1)  # lines break after a comma
        table.add_column("what", ratio=5)
        table.add_column("nm", no_wrap=True)
        table.add_column("quantity", ratio=3)
        table.add_column("source; known defects", ratio=12, overflow="fold")
        for row in _rows(here):
            table.add_row(*row, end_section=True)
        console.print(table)
    console.print("All of one entry: chromanoise catalog NAME.")


def entry_as_text(entry: Entry) -> list[str]:
    """The facts of one entry, one per line."""
    about = entry.provenance
    facts = {
        "what": about.what,
        "kind": about.kind,
        "curves": ", ".join(entry.channels),
        "range": _range(entry),
        "quantity": f"{about.quantity} [{about.unit}], {about.level}"
        + {"photon": ", light counted in photons", "energy": ", light counted as energy"}.get(
            about.per or "", ""
        ),
        "source": about.source,
        "license": about.license,
        "done": about.done,
        "mosaic": about.mosaic,
        "pixel": pixel_summary(entry) if about.is_sensor else "",
        "file": "" if entry.file is None else str(entry.file),
        "asks": "; ".join(entry.asks),
    }
    lines = [about.name, *(f"  {key:<10} {text}" for key, text in facts.items() if text)]
    lines.append(f"  DEFECT     {about.defects}")
    return lines + [f"  FOUND      {sentence}" for sentence in entry.found]


def as_markdown(entries: Sequence[Entry]) -> str:
    """The tables as Markdown, one per kind."""
    lines = ["# The catalog", "", "Written by `chromanoise catalog --markdown docs/catalog.md`."]
    heads = ("name", "what", "nm", "quantity", "source; known defects")
    for kind, word in KINDS.items():
        here = [entry for entry in entries if entry.provenance.kind == word]
        if here:
            lines += ["", f"## {kind.capitalize()}", "", _line(heads), _line(["---"] * len(heads))]
            lines += [_line(row) for row in _rows(here)]
    return "\n".join(lines) + "\n"


def _rows(entries: Sequence[Entry]) -> list[tuple[str, ...]]:
    """One row per entry; the source of adjacent entries that share it is in the first row."""
    rows: list[tuple[str, ...]] = []
    for (nm, source, level, defects), same in groupby(entries, key=_shared):
        for i, about in enumerate(entry.provenance for entry in same):
            origin = "as above" if i else f"{source}; {defects}"
            rows.append((about.name, about.what, nm, level, origin))
    return rows


def _shared(entry: Entry) -> tuple[str, str, str, str]:
    about = entry.provenance
    return _range(entry), about.source, f"{about.level} {about.quantity}", about.defects


def _range(entry: Entry) -> str:
    if entry.start_nm is None or entry.stop_nm is None:
        return "any"
    return f"{entry.start_nm:g}-{entry.stop_nm:g}"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
