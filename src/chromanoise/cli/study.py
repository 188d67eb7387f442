"""``chromanoise study``."""

import json

import click

from chromanoise.cli.parsing import command
from chromanoise.study import STARTER, study_schema


@command()
@click.option(
    "--schema", is_flag=True, help="Print the JSON Schema, for editors and other programs."
)
def study(schema: bool) -> None:
    """Print a commented study file with common keys, or the JSON Schema of all keys."""
    click.echo(json.dumps(study_schema(), indent=2) if schema else STARTER.rstrip())
