"""Facts typed in from published sources; ``SOURCES.toml`` says which, and what was done to them."""

import tomllib
from functools import cache
from importlib import resources
from typing import Any

from chromanoise.spectra.curves import Spectra
from chromanoise.spectra.readers import spectra_from_text


@cache
def sources() -> dict[str, dict[str, Any]]:
    """For each packaged table: quantity, unit, source, and what to know about it."""
    text = resources.files(__name__).joinpath("SOURCES.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


@cache
def packaged_table(name: str) -> Spectra:
    """The packaged table ``name``.csv with its source."""
    entry = sources()[name]
    text = resources.files(__name__).joinpath(f"{name}.csv").read_text(encoding="utf-8")
    return spectra_from_text(
        text, source=entry["source"], quantity=entry["quantity"], unit=entry["unit"]
    )
