"""``chromanoise serve``."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from chromanoise.errors import (
    InputError,
    StudyError,
    errors_in,
)


@click.command()
@click.argument("study", required=False, type=click.Path(path_type=Path))
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8421,
    show_default=True,
    help="On this machine only; 0 takes any that is free.",
)
@click.option("--open", "opened", is_flag=True, help="Open it in the browser.")
def serve(study: Path | None, port: int, opened: bool) -> None:
    """Serve the page that answers while you drag, for STUDY or for the paper's two sensors.

    It listens on this machine only and asks nothing from outside. Ctrl-C ends it.
    """
    from chromanoise.page.server import listening_socket, page_server

    told = _study(study)
    try:
        listening = listening_socket(port)
    except OSError as error:
        raise InputError(
            "--port",
            "must be a free port",
            value=port,
            found=f"{port} cannot be listened on ({error.strerror})",
            remedy=("name another", "0 for any that is free"),
        ) from None
    address = f"http://localhost:{listening.getsockname()[1]}/"
    click.echo(f"{address}  (Ctrl-C ends it)")
    if opened:
        click.launch(address)
    try:
        with _ignored_stays_ignored():
            page_server(listening, study=told).run(sockets=[listening])
    except KeyboardInterrupt:
        pass  # how it is meant to end
    finally:
        listening.close()


@contextmanager
def _ignored_stays_ignored() -> Iterator[None]:
    """Keep SIGINT ignored if it was: a shell ignores it for commands in the background."""
    if not hasattr(signal, "pthread_sigmask") or signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _study(path: Path | None) -> dict[str, object] | None:
    """The study to start from, refused before anything is served."""
    if path is None:
        return None
    from chromanoise.page.studies import served_data
    from chromanoise.study import read_study

    study = read_study(path)
    try:
        return served_data(study)
    except InputError as error:
        errors = errors_in(error)
        raise StudyError(errors, [f"{path}: {one}" for one in errors]) from None
