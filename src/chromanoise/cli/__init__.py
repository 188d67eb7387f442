"""The command line: read, one library call, write."""


def main(arguments: list[str] | None = None) -> None:
    """The command ``chromanoise``; quiet even when it is stopped while it still imports."""
    try:
        from chromanoise.cli.entry import run
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    run(arguments)


__all__ = ["main"]
