"""``--copy-as``: the study of a command as text."""

import click

from chromanoise.errors import InputError
from chromanoise.study import Study, refuse_idle, study_as_python, study_as_toml

_TEXTS = {"python": study_as_python, "toml": study_as_toml}
_NOT_COPIED = {
    "json_target": "--json",
    "table": "--table",
    "export": "--export",
    "threads": "--threads",
    "tile": "--tile",
    "scheduler": "--scheduler",
    "out": "--out",
}


def print_copy(kind: str, study: Study) -> None:
    """Print the study as TOML or as a script.

    Raises
    ------
    InputError
        If an option was given that is not part of a study, or a setting changes nothing.
    """
    context = click.get_current_context()
    for name, option in _NOT_COPIED.items():
        if context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE:
            raise InputError(
                option,
                "must not be given with --copy-as, as a study does not contain it",
                value=str(context.params[name]),
                found=None,
                remedy="omit it",
            )
    refuse_idle(study)
    click.echo(_TEXTS[kind](study), nl=False)
