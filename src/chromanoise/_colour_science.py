"""The color library of the field, imported where it is used and without its side effects."""

import warnings
from functools import cache
from typing import Any

import numpy as np


@cache
def colour_science() -> Any:
    """The package colour-science; its first import costs about a second.

    It switches numpy to an old way of printing for the whole process, and warns of optional
    packages that it does not find: neither is for us to pass on to a user.
    """
    printing = np.get_printoptions()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import colour
    finally:
        np.set_printoptions(**printing)
    return colour
