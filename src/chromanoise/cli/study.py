"""``chromanoise study``."""

import json

import click

from chromanoise.study import STARTER, study_schema


@click.command()
@click.option("--schema", is_flag=True, help="The JSON Schema, for editors and other programs.")
def study(schema: bool) -> None:
    """What a study file may say: a commented example, or the schema."""
    click.echo(json.dumps(study_schema(), indent=2) if schema else STARTER.rstrip())
