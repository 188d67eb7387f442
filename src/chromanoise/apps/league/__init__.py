"""A league of the cameras of the catalog, with sensors of one's own among them."""

from typing import TYPE_CHECKING

from chromanoise.base import lazy_names

if TYPE_CHECKING:
    from chromanoise.apps.league.cloud import draw_cloud as draw_cloud
    from chromanoise.apps.league.ranking import (
        RANKED,
        AtIso as AtIso,
        League as League,
        Ranked as Ranked,
        Standing as Standing,
        league as league,
    )
    from chromanoise.apps.league.speeds import DEFAULT_ISO, iso_speeds as iso_speeds

__getattr__, __dir__, __all__ = lazy_names(__name__)
