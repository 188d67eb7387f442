"""Help of the commands: the common options under headings, and all of them with --help-all."""

from pathlib import Path

import click
import pytest

import chromanoise
from chromanoise.cli.entry import COMMANDS, commands
from chromanoise.cli.options import MOST_COMMON


def listed(command, *, whole):
    context = click.Context(command, info_name=command.name)
    context.meta["chromanoise.whole_help"] = whole
    return [name for one in command.listed_options(context) for name in one.opts]


@pytest.mark.parametrize("name", COMMANDS)
def test_the_short_help_has_at_most_15_options_and_the_long_help_has_all(name, run):
    command = commands.get_command(click.Context(commands), name)
    short, whole = (listed(command, whole=one) for one in (False, True))
    context = click.Context(command)
    rows = [one for one in command.get_params(context) if isinstance(one, click.Option)]
    named = {one.opts[0]: one for one in rows if not one.hidden}
    assert len(set(short) & {*named}) <= MOST_COMMON == 15
    assert {*short} <= {*whole}
    if len(named) <= MOST_COMMON + 1:
        del named["--help-all"]
    assert {*named} <= {*whole}
    text = run(name, "--help-all")[1]
    assert all(any(option in text for option in one.opts) for one in named.values())


def test_the_short_help_says_how_many_options_it_omits(run):
    text = run("analyze", "--help")[1]
    assert len(text.splitlines()) < 70
    assert "\nLight:\n" in text
    *_, last = text.strip().splitlines()
    command = commands.get_command(click.Context(commands), "analyze")
    more = len(listed(command, whole=True)) - len(listed(command, whole=False))
    assert last == f"{more} more options: chromanoise analyze --help-all"
    assert "more options" not in run("analyze", "--help-all")[1]


def test_a_command_of_few_options_lists_them_all(run):
    assert "--help-all" not in run("run", "--help")[1]
    assert run("run", "--help-all") == run("run", "--help")


@pytest.mark.parametrize("other", ["fullest channel", "brightest channel"])
def test_the_channel_that_sets_the_time_has_one_name(other):
    package = Path(chromanoise.__file__).parent
    files = [one for one in package.rglob("*") if one.suffix in (".py", ".js", ".j2", ".toml")]
    assert len(files) > 300
    texts = {one.name: " ".join(one.read_text(encoding="utf-8").lower().split()) for one in files}
    assert not [name for name, text in texts.items() if other in text]
