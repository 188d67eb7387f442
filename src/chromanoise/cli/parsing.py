"""Commands that refuse an option that is given twice."""

from collections import Counter
from functools import partial

import click


class Command(click.Command):
    """A command whose options are given once, except those that may be repeated."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments.

        Raises
        ------
        click.UsageError
            If an option is repeated that has one value: click keeps the last one.
        """
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        for parameter, count in Counter(order).items():
            once = isinstance(parameter, click.Option) and not parameter.multiple
            if once and not parameter.is_eager and count > 1:
                name = " or ".join((*parameter.opts, *parameter.secondary_opts))
                raise click.UsageError(f"{name} must be given once, but is given {count} times")
        return super().parse_args(ctx, args)


command = partial(click.command, cls=Command)
