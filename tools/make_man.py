"""The man pages of the command line, docs/man: ``python tools/make_man.py``."""

import tempfile
import warnings
from pathlib import Path

import click

MAN = Path(__file__).parents[1] / "docs" / "man"


def man_pages() -> dict[str, str]:
    """Text of each page by file name; without date and version, so that only commands change it."""
    from click_man.core import write_man_pages

    from chromanoise.cli.entry import COMMANDS, commands

    context = click.Context(commands, info_name="chromanoise")
    found = {name: commands.get_command(context, name) for name in COMMANDS}
    for name, command in found.items():
        if command is not None:
            command.short_help = COMMANDS[name][1]  # whole, where click cuts it
    whole = click.Group(
        "chromanoise",
        help=commands.help,
        params=list(commands.params),
        commands={name: command for name, command in found.items() if command is not None},
    )
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # click-man calls what click 9 moves
        write_man_pages("chromanoise", whole, version="", target_dir=folder, date=" ")
        return {
            path.name: path.read_text(encoding="utf-8") for path in sorted(Path(folder).iterdir())
        }


def main() -> None:
    """Write all pages anew."""
    MAN.mkdir(exist_ok=True)
    pages = man_pages()
    for path in MAN.glob("*.1"):
        if path.name not in pages:
            path.unlink()
    for name, text in pages.items():
        (MAN / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
