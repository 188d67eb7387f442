"""The command line: read, one library call, write."""

from chromanoise.cli.main import main

__all__ = ["main"]
