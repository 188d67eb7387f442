"""Commands that refuse an option that is given twice, and name what they refuse."""

import re
from collections import Counter
from functools import partial
from typing import Any

import click

from chromanoise.errors import InputError, did_you_mean


class RenamedOption(click.Option):
    """An option that also works by its old name, for one release, with a warning.

    Parameters
    ----------
    declarations, attributes
        As `click.Option`.
    old
        The old name, e.g. ``--method``.
    """

    def __init__(self, *declarations: Any, old: str, **attributes: Any) -> None:
        super().__init__(*declarations, **attributes)
        self.old = old


class Command(click.Command):
    """A command whose options are given once, except those that may be repeated."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments.

        Raises
        ------
        click.UsageError
            If an option is repeated that has one value: click keeps the last one.
        InputError
            If there is no such option, or a value is not a number or not one of the choices.
        """
        try:
            return self._parsed(ctx, self._by_new_names(args))
        except click.NoSuchOption as error:
            known = [name for one in self.params if _is_shown(one) for name in one.opts]
            help_ = f"see `{ctx.command_path} --help`"
            raise InputError(
                error.option_name,
                f"must be an option of `{ctx.command_path}`",
                remedy=did_you_mean(error.option_name, known, help_, most=2, cutoff=0.6),
            ) from None
        except click.BadParameter as error:
            raise _bad_value(error) or error from None

    def _by_new_names(self, args: list[str]) -> list[str]:
        """The arguments with the new names of options; one warning for each old name."""
        new = {one.old: one.opts[0] for one in self.params if isinstance(one, RenamedOption)}
        end = args.index("--") if "--" in args else len(args)
        words = [word.partition("=") for word in args[:end]]
        for old in dict.fromkeys(name for name, _, _ in words if name in new):
            click.echo(
                f"chromanoise: {old} is now {new[old]}; the old name works in this release only",
                err=True,
            )
        named = [new.get(name, name) + equals + value for name, equals, value in words]
        return [*named, *args[end:]]

    def _parsed(self, ctx: click.Context, args: list[str]) -> list[str]:
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        for parameter, count in Counter(order).items():
            once = isinstance(parameter, click.Option) and not parameter.multiple
            if once and not parameter.is_eager and count > 1:
                name = " or ".join((*parameter.opts, *parameter.secondary_opts))
                raise click.UsageError(f"{name} must be given once, but is given {count} times")
        return super().parse_args(ctx, args)


def _is_shown(parameter: click.Parameter) -> bool:
    return isinstance(parameter, click.Option) and not parameter.hidden


def _bad_value(error: click.BadParameter) -> InputError | None:
    """The error of a value that is no number or no choice; ``None`` for other errors."""
    kind: Any = error.param.type if error.param is not None else None
    quoted = re.match(r"(?s)'(.*)' is not ", error.message)
    if error.param is None or quoted is None:
        return None
    name = max(error.param.opts, key=len) if isinstance(error.param, click.Option) else ""
    name = name or error.param.human_readable_name
    if isinstance(kind, click.Choice):
        choices = [str(one) for one in kind.choices]
        remedy = did_you_mean(quoted[1], choices, "", most=1)
        return InputError(
            name, f"must be {' or '.join(choices)}", value=quoted[1], remedy=remedy or ()
        )
    demand = {click.FLOAT: "a number", click.INT: "a whole number"}.get(kind)
    return None if demand is None else InputError(name, f"must be {demand}", value=quoted[1])


def pair(option: str, text: str | None, separator: str, kind: Any) -> Any:
    """Two numbers with a separator between them; ``None`` for ``None``.

    Raises
    ------
    InputError
        If the text is anything else.
    """
    if text is None:
        return None
    parts = text.split(separator)
    try:
        first, second = (kind(part) for part in parts)
    except ValueError:
        raise InputError(
            option, f"must be two numbers with {separator!r} between them", value=text
        ) from None
    return first, second


command = partial(click.command, cls=Command)
