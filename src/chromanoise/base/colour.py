"""Lazy import of colour-science without its side effects."""

import warnings
from functools import cache
from typing import Any

import numpy as np


@cache
def colour_science() -> Any:
    """The package colour-science; its first import costs about a second.

    The import changes the print options of numpy for the whole process and warns about missing
    optional packages. This function restores the options and suppresses the warnings.
    """
    printing = np.get_printoptions()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import colour
    finally:
        np.set_printoptions(**printing)
    return colour
