"""``chromanoise serve``."""

import signal
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

import click

from chromanoise.base import InputError
from chromanoise.cli.options import PATH, command

if TYPE_CHECKING:
    from uvicorn import Server


@command()
@click.argument("study", required=False, type=PATH)
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8421,
    show_default=True,
    help="Port on this machine; 0 selects a free port.",
)
@click.option(
    "--front",
    type=PATH,
    help="Show the front of a design: the front.json of `chromanoise optimize`.",
)
@click.option("--open", "opened", is_flag=True, help="Open the page in the browser.")
def serve(study: Path | None, port: int, front: Path | None, opened: bool) -> None:
    """Serve a local web page with sliders, for STUDY or for the paper's two sensors.

    The server listens on this machine only and uses no network. Ctrl-C ends it.
    """
    from chromanoise.web import listening_socket, page_server

    data = _study(study)
    if front is not None:
        from chromanoise.apps.design import read_front

        read_front(front)  # an invalid one ends the command
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
        server = page_server(listening, study=data, front=front)
        _keep_ignored(server)
        server.run(sockets=[listening])
    except KeyboardInterrupt:
        pass  # Ctrl-C is the normal end
    finally:
        listening.close()


def _keep_ignored(server: "Server") -> None:
    """Keep SIGINT ignored if it was: a shell ignores it for commands in the background."""
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
        return
    ends = server.handle_exit

    def without_sigint(number: int, frame: FrameType | None) -> None:
        if number != signal.SIGINT:
            ends(number, frame)

    server.handle_exit = without_sigint  # type: ignore[assignment]


def _study(path: Path | None) -> dict[str, object] | None:
    """The initial study as plain data; an invalid study raises an error."""
    if path is None:
        return None
    from chromanoise.study import read_study
    from chromanoise.web import served_data

    study = read_study(path)
    try:
        return served_data(study)
    except InputError as error:
        raise error.called(f"{path}: {error.subject}") from None
