"""A characterization as plain data for JSON."""

import math
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from chromanoise import __version__
from chromanoise.characterization.results import Characterization

SCHEMA = "chromanoise characterization"
SCHEMA_VERSION = 1


def characterization_as_json(result: Characterization) -> dict[str, Any]:
    """All numbers of a characterization with all digits, as plain data for ``json.dumps``.

    Parameters
    ----------
    result
        A characterization.

    Returns
    -------
    dict
        ``schema``, ``schema_version``, ``version`` and the fields of `Characterization`; the
        mosaic is a list of rows, ``planes`` a list of objects with the fields of `PlaneNoise`. A
        value that is not known or not finite is ``None``.
    """
    head = {"schema": SCHEMA, "schema_version": SCHEMA_VERSION, "version": __version__}
    mosaic = [list(row) for row in result.mosaic.pattern] if result.mosaic else None
    return {**head, **_plain(result), "mosaic": mosaic}


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
