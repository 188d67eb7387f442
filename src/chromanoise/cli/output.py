"""Output of the commands: JSON and tables, errors with options in place of settings, progress.

JSON and tables go to a file or to standard output, where `--copy-as` prints a study. Progress is an
estimate of the duration, and a bar on a terminal.
"""

import os
import re
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from chromanoise.base import (
    InputError,
    Setting,
    StudyError,
    errors_in,
    json_text,
    refuse_unwritable_file,
    setting_of_study,
    write_all_whole,
)
from chromanoise.cli.options import own_option
from chromanoise.io import Table, table_writer
from chromanoise.study import Study, refuse_idle, study_as_python, study_as_toml

_ANOTHER = "name another file"

json_option = own_option(
    "--json",
    "json_target",
    metavar="FILE|-",
    heading="Output",
    help="Write JSON; - for standard output.",
)

_FAILED = 3  # exit code

fail_if_option = own_option(
    "--fail-if",
    "fail_if",
    multiple=True,
    heading="Output",
    metavar='"KEY < NUMBER"',
    help="Exit with code 3 and one sentence if a key of the JSON has such a value, or none, for "
    'any sensor: "snr_y_db < 30"; also <=, >, >=, ==, !=. Repeatable. Keys: `chromanoise schema`.',
)


def leave_if_failed(sentences: Sequence[str]) -> None:
    """Print each sentence of a condition of ``--fail-if`` that is met, and leave with code 3."""
    for sentence in sentences:
        click.echo(f"chromanoise: {sentence}", err=True)
    if sentences:
        click.get_current_context().exit(_FAILED)


_TEXTS = {"python": study_as_python, "toml": study_as_toml}
_NOT_COPIED = {
    "json_target": "--json",
    "fail_if": "--fail-if",
    "table": "--table",
    "export": "--export",
    "threads": "--threads",
    "tile": "--tile",
    "scheduler": "--scheduler",
    "out": "--out",
    "whole_notes": "--notes",
}


def leave_if_copied(kind: str | None, study: Study) -> None:
    """With ``--copy-as``, print the study as TOML or as a script, and leave.

    Raises
    ------
    InputError
        If an option was given that is not part of a study, or a setting changes nothing.
    """
    if kind is None:
        return
    context = click.get_current_context()
    for name, option in _NOT_COPIED.items():
        if context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE:
            why = "with --copy-as, as a study does not contain it"
            raise superfluous(option, why, str(context.params[name]))
    refuse_idle(study)
    click.echo(_TEXTS[kind](study), nl=False)
    context.exit()


Output = tuple[str | None, Callable[[], str]]
"""A file, ``None`` where it is not wanted, and the function that makes its text."""


def as_table(target: str | None, make: Callable[[], Table]) -> Output:
    """The output of a table, in the format given by the suffix of its file."""
    return target, lambda: table_writer(Path(str(target)))(make())


def as_json(target: str | None, make: Callable[[], Mapping[str, Any]]) -> Output:
    """The output of a record as JSON."""
    return target, lambda: json_text(make())


def write_outputs(*outputs: Output) -> None:
    """Write the files of a command, all or none; ``-`` is standard output."""
    texts = {target: make() for target, make in outputs if target is not None}
    files = {Path(name): text.encode("utf-8") for name, text in texts.items() if name != "-"}
    write_all_whole(files)
    if "-" in texts:
        click.echo(texts["-"], nl=False)


def write_json(data: Mapping[str, Any], target: str) -> None:
    """Write JSON to a file atomically, or to standard output if ``target`` is ``-``."""
    write_outputs(as_json(target, lambda: data))


def refuse_output(target: str | Path | None, option: str, *inputs: str) -> None:
    """Raise an error before any computation if an output is an input, or cannot be written."""
    if target is None or str(target) == "-":
        return
    goal, out = os.path.realpath(target), Path(target)
    for name in inputs:
        if Path(name).exists() and os.path.realpath(name) == goal:
            raise InputError(
                option, "must not be a file that is read", value=str(target), remedy=_ANOTHER
            )
    if out.is_dir():
        found = f"{out} is a folder"
        raise InputError(option, "must be a file", value=str(out), found=found, remedy=_ANOTHER)
    refuse_unwritable_file(out)


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
    """Check before any computation that each output can be written, and replaces no input."""
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
        refuse_output(target, option, *inputs)
        if option == "--table" and target is not None:
            table_writer(Path(target))


def superfluous(option: str, why: str, value: Any, *, setting: str = "") -> InputError:
    """The error of an option that must not be given here; ``why`` follows "must not be given"."""
    requirement = f"must not be given {why}"
    return InputError(
        option, requirement, value=value, found=None, remedy="omit it", setting=setting
    )


def terminal() -> Console:
    """Standard output for tables; 140 columns wide if it is no terminal."""
    console = Console(highlight=False, markup=False)
    return console if console.is_terminal else Console(highlight=False, markup=False, width=140)


def print_lines(lines: Iterable[str]) -> None:
    """Print sentences, each on a line of its own."""
    for line in lines:
        terminal().print(line, soft_wrap=True)


_LONGEST_NOTE = 120  # characters of a note on one line
_ENDS_OF_CLAUSES = re.compile(r"; |: |, | \(")


def short_note(text: str) -> str:
    """A note up to the last clause that ends within 120 characters, with " ..." where it is cut.

    Examples
    --------
    >>> short_note("a channel is saturated")
    'a channel is saturated'
    >>> short_note("curves are extrapolated by hold, " + "as they end before 1050 nm " * 5)
    'curves are extrapolated by hold ...'
    """
    if len(text) <= _LONGEST_NOTE:
        return text
    ends = [found.start() for found in _ENDS_OF_CLAUSES.finditer(text, 0, _LONGEST_NOTE)]
    whole = [end for end in ends if text.count("(", 0, end) == text.count(")", 0, end)]
    end = max(whole, default=text.rfind(" ", 0, _LONGEST_NOTE))
    return f"{text[:end]} ..."


_NONE: Mapping[str, str] = {}
_OF_A_FILE = ("run", "rerun", "report", "serve", "optimize")  # a study or design has the settings


def sentences(error: InputError, command: str = "", options: Mapping[str, str] = _NONE) -> str:
    """One sentence per error, with options in place of settings.

    Parameters
    ----------
    error
        An error of the library.
    command
        Name of the command. Some settings have different options in different commands.
    options
        Options of the command by parameter name, also those that are no setting of a study, e.g.
        ``threads``.
    """
    if isinstance(error, StudyError) and error.places:  # a study file: its terms, not options
        lines = error.sentences()
    else:
        lines = [_sentence(one, command, options) for one in errors_in(error)]
    return "\n".join(dict.fromkeys(lines))


def _sentence(error: InputError, command: str, options: Mapping[str, str]) -> str:
    from chromanoise.study import interface_of  # only where there is an error

    subject = error.subject
    if command in _OF_A_FILE and "." in error.setting:
        own = error.setting if subject == error.setting_name else subject
        return error.sentence(subject=own, render=setting_of_study)
    if error.setting:
        name = _flat(error.setting, command)
        if name is not None and subject in (name, error.setting_name, "matrix"):
            part = interface_of(name).part
            option = _option(name, command, error.value)
            subject = f"{part} of {option}" if part in ("FIRST", "LAST", "POINTS") else option
    else:
        subject = options.get(subject, subject)
    return error.sentence(subject=subject, render=lambda setting: _remedy(setting, command))


def _remedy(setting: Setting, command: str) -> str:
    if list(map(str, setting.values)) == ["False"]:  # of an option that has no value
        return f"omit {options_text(Setting(setting.name), command)}"
    return f"{'omit' if setting.omit else 'give'} {options_text(setting, command)}"


def options_text(setting: Setting, command: str = "") -> str:
    """A setting as options of the command line: ``--energy or --photons``, ``--beyond zero``.

    Parameters
    ----------
    setting
        A setting named by a key of a study or by a parameter of a reader.
    command
        Name of the command.
    """
    from chromanoise.study import flags_of

    name = _flat(setting.name, command) or setting.name
    flags = flags_of(name)
    values = [str(value) for value in setting.values]
    if flags:
        return " or ".join(flags[value] for value in values or flags)
    if values == ["True"]:
        return _option(name, command)
    return f"{_option(name, command)} {' or '.join(values)}".strip()


def _option(name: str, command: str, value: object = None) -> str:
    """The option of a setting, or the argument."""
    from chromanoise.study import option_of

    if name == "cube" or (name == "sensors" and command not in ("simulate", "denoise")):
        return {"cube": "CUBE", "sensors": "SENSOR"}[name]
    return option_of(name, value)


def _flat(key: str, command: str) -> str | None:
    """The setting for a key of a study in this command; a key without dots is a setting."""
    from chromanoise.study import FUNCTIONS, argument_of

    if key.startswith("matrices"):
        return "matrix"
    if key.startswith("sensors.") and key.endswith(".name"):
        return "sensors"
    if key == "pictures.0.cube":
        return "cube"
    own = {"simulate": "render", "denoise": "denoise"}.get(command)
    names = FUNCTIONS[own] if own else _of_all(("analyze", "compare", "compare_map", "matrix"))
    alone = "qe_scale" if key == "scale" else key  # for commands that read one file
    return argument_of(key, names) or (None if "." in key else alone)


def _of_all(functions: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    from chromanoise.study import FUNCTIONS

    return {name: keys for one in functions for name, keys in FUNCTIONS[one].items()}


_MEASURED_S = 1.0  # time measured before the total is estimated
_LONG_S = 30.0  # below this, no estimate is printed


@contextmanager
def progress_of(what: str, parts: int, unit: str) -> Iterator[Callable[[int], None]]:
    """Yield a function to be called with each number of newly finished parts, out of ``parts``.

    After the first second of work, a line on standard error gives the estimated total time if that
    is more than half a minute. Whenever the time of the work has doubled, a line corrects it if it
    has changed by a fifth. A terminal also shows a bar.
    """
    console = Console(stderr=True, highlight=False, markup=False, emoji=False, soft_wrap=True)
    start, finished, told_s, due_s = time.monotonic(), 0, 0.0, _MEASURED_S
    first: tuple[float, int] | None = None  # the first parts include what is prepared once

    def advance(count: int) -> None:
        nonlocal finished, told_s, due_s, first
        finished += count
        now = time.monotonic()
        if first is None:
            first = (now, finished) if finished else None
            return
        work_s = now - first[0]
        if first[1] < finished < parts and work_s >= due_s:
            due_s = 2 * work_s
            left_s = work_s / (finished - first[1]) * (parts - finished)
            whole_s = now - start + left_s
            if (told_s or whole_s > _LONG_S) and abs(whole_s - told_s) > told_s / 5:
                left = f", {duration(left_s)} of it left" if told_s else ""
                console.print(f"{what}: takes about {duration(whole_s)}{left}")
                told_s = whole_s

    if not console.is_terminal:
        yield advance
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    rate = TextColumn("{task.completed}/{task.total} " + unit + ", {task.fields[speed]:.0f}/s")
    with Progress(
        BarColumn(), rate, TimeRemainingColumn(), console=console, transient=True
    ) as progress:
        task = progress.add_task(unit, total=parts, speed=0.0)

        def advance_bar(count: int) -> None:
            advance(count)
            progress.advance(task, count)
            speed = progress.tasks[0].speed or 0.0
            progress.update(task, speed=speed)

        yield advance_bar


def duration(seconds: float) -> str:
    """A duration in a readable unit.

    Examples
    --------
    >>> duration(42.3), duration(150.0), duration(90000.0), duration(2e6)
    ('42 s', '2.5 min', '25 h', '23 days')
    """
    for unit, length, most in (("s", 1, 90), ("min", 60, 90 * 60), ("h", 3600, 48 * 3600)):
        if seconds < most:
            return f"{seconds / length:.2g} {unit}"
    return f"{seconds / 86400:.2g} days"
