"""The command ``chromanoise``: its subcommands, ``--version``, and error messages.

``--version`` also prints the versions of the packages that chromanoise uses. Errors of the library
become messages and exit codes.
"""

import codecs
import gc
import json
import os
import re
import signal
import sys
import threading
import warnings
from _thread import interrupt_main
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import Any

import click

from chromanoise.base import (
    InputError,
    __version__,
    check,
    did_you_mean,
    keep_freed_memory,
    known_name,
)
from chromanoise.cli import paused_collection

_NEEDS = re.compile(r"([A-Za-z0-9._-]+)[^;]*(?:;.*extra\s*==\s*['\"]([^'\"]+)['\"])?")
_FOR_DEVELOPERS = ("bench", "dev", "docs")


def installation() -> str:
    """Version, Python, system, and each package that chromanoise uses, by extra.

    ``missing`` packages belong to extras: ``pip install "chromanoise[NAME]"`` installs them.
    """
    import platform  # of --version alone

    lines = [
        f"chromanoise {__version__}",
        f"Python {platform.python_version()} on {platform.system()} {platform.machine()}",
    ]
    groups: dict[str, list[str]] = {}
    for package, extra in _needs():
        groups.setdefault(extra, []).append(f"{package} {_version(package)}")
    width = max(map(len, groups), default=0)
    lines += [f"{name:<{width}}  {', '.join(found)}" for name, found in groups.items()]
    return "\n".join(lines)


def _needs() -> Iterator[tuple[str, str]]:
    """Each package with its extra; none if only the source is here, not an installation."""
    from importlib import metadata  # imports the package email, which is slow

    try:
        needs = metadata.requires("chromanoise") or []
    except metadata.PackageNotFoundError:
        return
    for need in needs:
        match = _NEEDS.match(need)
        if match and match[2] not in _FOR_DEVELOPERS and match[1] != "chromanoise":
            yield match[1], match[2] or "required"


def _version(package: str) -> str:
    from importlib import metadata

    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "missing"


COMMANDS = {
    "analyze": (
        "analyses",
        "Noise of sensors in raw, spectral and color coordinates, side by side.",
    ),
    "card": (
        "card_command",
        "One sheet that compares sensors, for slides and paper: PDF, SVG, PNG or HTML.",
    ),
    "simulate": (
        "simulate",
        "Render a hyperspectral cube through sensors to noisy color pictures.",
    ),
    "denoise": (
        "denoise",
        "Denoise raw pictures of any camera with their known noise; color with a sensor.",
    ),
    "compare": (
        "analyses",
        "Sensors over one or two parameters, as light or read noise: curves, crossovers.",
    ),
    "matrix": (
        "analyses",
        "A sensor's color matrix: color error, noise, condition; to CSV, JSON, CLF, profile.",
    ),
    "sensitivity": (
        "design_commands",
        "What 1 nm or 1 % of each parameter of a sensor changes; tolerance budget.",
    ),
    "optimize": (
        "design_commands",
        "Search filters, IR-cut, exposure and matrix of a sensor for the best trade-offs.",
    ),
    "init": ("study_files", "A commented study or design file to start from."),
    "run": ("study_files", "Run a study file: analyses, sweeps, pictures, with provenance."),
    "rerun": ("study_files", "Run the study of an output once more and compare the results."),
    "diff": ("study_files", "Which inputs, settings and numbers of two outputs differ."),
    "schema": ("study_files", "The keys in the JSON of a command, as JSON Schema."),
    "study": ("study_files", "A commented study file; --schema lists all keys, for editors."),
    "league": (
        "league_command",
        "Cameras of the catalog ranked by color and noise, yours among them.",
    ),
    "catalog": (
        "catalog_command",
        "Built-in sensors, lights and filters, with source, range and known defects.",
    ),
    "inspect": (
        "inspect_convert",
        "How a file of spectra is parsed, what looks wrong, and what it does not declare.",
    ),
    "convert": (
        "inspect_convert",
        "Curves of a file or a sensor as CSV, JSON, rawtoaces' JSON or IES TM-27.",
    ),
    "serve": ("serve", "A local web page with sliders."),
    "reproduce": ("demo", "The paper's Tables 2-5 next to ours, and its ten figures."),
    "report": (
        "study_files",
        "A study as one self-contained HTML file: charts, tables, equations, sliders.",
    ),
    "demo": ("demo", "All results of the paper on one page: out/demo/index.html."),
    "characterize": (
        "characterize",
        "Noise of a camera from its own raw frames, as a pixel file and a report.",
    ),
    "denoise-bench": (
        "denoise",
        "Denoising methods compared over scenes, sensors and light levels; a report.",
    ),
    "cite": ("demo", "How to cite chromanoise and the paper; --bibtex for BibTeX."),
    "demo-frames": (
        "characterize",
        "Raw frames of a virtual camera with known noise, to try a characterization.",
    ),
}
"""Each command with its module and its line of help."""


class _Commands(click.Group):
    """Subcommands that are imported only when they are called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        name = cmd_name.replace("-", "_")
        path = f"chromanoise.cli.{COMMANDS[cmd_name][0]}"
        with paused_collection():
            known = path in sys.modules
            module = import_module(path)
            if not known:
                gc.freeze()  # collections pass over what imports created: a seventh of the time
                keep_freed_memory()
        command = getattr(module, name)
        assert isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            known = f"known: {', '.join(COMMANDS)}"
            hint = did_you_mean(args[0], list(COMMANDS), known, most=2, cutoff=0.5)
            raise click.UsageError(f"unknown command {args[0]!r}; {hint}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


def _print_version(ctx: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked and not ctx.resilient_parsing:
        click.echo(installation())
        ctx.exit()


def _with_hyphens(name: str) -> str:
    return name.replace("_", "-")


@click.command(
    cls=_Commands,
    # of the subcommands too: names of options and choices
    context_settings={
        "help_option_names": ["-h", "--help"],
        "token_normalize_func": _with_hyphens,
    },
)
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_version,
    help="Show the version, and which packages are installed.",
)
def commands() -> None:
    """From photons to color, with the noise."""


def run(arguments: list[str] | None = None) -> None:
    """Run the command line; bad input ends with one sentence and exit code 2."""
    stopped: list[bool] = []  # not empty after a stop
    _prepare_output()
    _prepare_libraries()
    given = list(sys.argv[1:] if arguments is None else arguments)
    given[:1] = [known_name(word, COMMANDS) for word in given[:1]]
    try:
        with _stop_on_signals(stopped):
            _refuse_unreadable(given)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # warnings of libraries are not for users
                warnings.filterwarnings("error", "overflow|divide by zero|invalid value")  # numpy's
                result = commands.main(
                    args=given or ["--help"], prog_name="chromanoise", standalone_mode=False
                )
    except BaseException as error:
        # a stop during an import may be raised as another exception
        if stopped or isinstance(error, click.Abort | KeyboardInterrupt):
            click.echo("chromanoise: stopped", err=True)
            sys.exit(130)
        if isinstance(error, BrokenPipeError):
            sys.stderr.close()  # the reader has ended
            sys.exit(1)
        sentence = _sentence(error, given[0] if given else "")
        if sentence is None:
            raise
        _leave(sentence)
    sys.exit(result if isinstance(result, int) else 0)


def _sentence(error: BaseException, command: str) -> str | None:
    """The message for an error; ``None`` if the error is a bug of the program."""
    match error:
        case click.ClickException():
            return error.format_message()
        case InputError():
            from chromanoise.cli.output import sentences

            return sentences(error, command, _options_of(command))
        case ArithmeticError() | RuntimeWarning():
            return (
                f"a number exceeds double precision ({error}); choose less extreme values of the "
                "light, the exposure, the pixel or the matrix"
            )
        case OSError():
            return f"{error.filename or 'standard output'}: {error.strerror or error}"
        case MemoryError():
            return "this machine does not have enough memory; use a smaller cube or fewer bands"
    return None


def _options_of(command: str) -> dict[str, str]:
    """The options of a command by the names of their parameters."""
    found = commands.get_command(click.Context(commands), command)
    options = [one for one in found.params if isinstance(one, click.Option)] if found else []
    return {str(one.name): max(one.opts, key=len) for one in options}


@contextmanager
def _stop_on_signals(stopped: list[bool]) -> Iterator[None]:
    """Make SIGTERM act like Ctrl-C, so that scratch files are removed.

    A stop may be lost: Python ignores exceptions while it deletes an object, and some libraries
    catch all of them. It is sent again until the main thread handles its exception.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    ended, before = threading.Event(), sys.unraisablehook
    is_repeated = False  # no lock, because a handler may interrupt itself

    def stop(*_: object) -> None:
        nonlocal is_repeated
        was_repeated, is_repeated = is_repeated, False
        if was_repeated and _is_stopping():
            return
        if not stopped:
            stopped.append(True)
            threading.Thread(target=repeat, daemon=True).start()
        raise KeyboardInterrupt

    def repeat() -> None:
        nonlocal is_repeated
        while not ended.wait(_REPEATED_S):
            is_repeated = True
            _interrupt_main_thread()

    def ignored(error: Any) -> None:
        if not (stopped and error.exc_type is KeyboardInterrupt):
            before(error)

    sys.unraisablehook = ignored
    signal.signal(signal.SIGTERM, stop)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # it may be ignored
        signal.signal(signal.SIGINT, stop)
    try:
        yield
    finally:
        ended.set()
        sys.unraisablehook = before


def _is_stopping() -> bool:
    """Whether the main thread handles a stop, or an error that a stop became."""
    errors, seen = [sys.exc_info()[1]], set[int]()  # the links between errors may form a circle
    while errors:
        error = errors.pop()
        if isinstance(error, KeyboardInterrupt):
            return True
        if error is not None and id(error) not in seen:
            seen.add(id(error))
            errors += [error.__cause__, error.__context__]
    return False


def _interrupt_main_thread() -> None:
    if hasattr(signal, "pthread_kill"):  # it also ends what the thread waits for
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)
    else:
        interrupt_main(signal.SIGTERM)


def _prepare_output() -> None:
    """Escape characters that the output encoding lacks, as JSON and TOML do."""
    codecs.register_error("json-escape", _escaped)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="json-escape")


def _escaped(error: UnicodeError) -> tuple[str, int]:
    assert isinstance(error, UnicodeEncodeError)
    return json.dumps(error.object[error.start : error.end])[1:-1], error.end


def _prepare_libraries() -> None:
    """Override settings of libraries that do not apply to a command."""
    os.environ["MPLBACKEND"] = "agg"  # figures go to files, never to a window
    os.environ.pop("NUMBA_NUM_THREADS", None)  # numba's own threads are not used


def _refuse_unreadable(arguments: Sequence[str]) -> None:
    """Refuse arguments that are empty, or are not text and so cannot be printed or recorded."""
    for before, word in zip(["chromanoise", *arguments], arguments, strict=False):
        option, equals, value = word.partition("=")
        if not word or (equals and not value and option.startswith("--")):
            name = option or f"the argument after {before}"
            raise InputError(name, "must not be empty", remedy=("give a value", "omit it"))
        strange = check.strange_character(word)
        if strange is not None:
            raise InputError(
                f"the argument {word!a}",
                f"must be printable {sys.getfilesystemencoding()} text",
                value=word,
                found=f"holds {strange!a}",
                remedy=("rename the file", "retype the argument"),
            )


_REPEATED_S = 1.0


def _leave(sentence: str) -> None:
    for line in sentence.split("\n"):
        click.echo(f"chromanoise: {' '.join(line.split())}", err=True)
    sys.exit(2)
