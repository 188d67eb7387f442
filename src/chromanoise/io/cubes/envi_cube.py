"""Read cubes in the ENVI format: a text header beside a file of raw numbers."""

from functools import partial
from pathlib import Path

from chromanoise.base import reason
from chromanoise.io.cubes.raw_cube import Found, refuse_other_shape
from chromanoise.io.envi_layout import (
    envi_pair,
    envi_pixels,
    envi_scale,
    envi_wavelengths,
    has_envi_wavelengths,
    read_envi_header,
)
from chromanoise.io.source_files import refused


def envi_cube(path: Path, shape: tuple[int, int] | None) -> Found | None:
    """A cube from its header or its data; ``None`` where no header is beside.

    Parameters
    ----------
    shape
        Height and width that it must have; ``None`` for any. [pixels]

    Raises
    ------
    InputError
        If the header or the numbers are damaged.
    """
    try:
        pair = envi_pair(path)
        if pair is None:
            return None
        header = read_envi_header(pair[0])
        pixels, notes = envi_pixels(header, pair[1])
    except OSError as error:
        raise refused(path, f"cannot be read ({reason(error)})") from None
    refuse_other_shape(path, pixels, shape)
    return Found(
        pixels=pixels,
        wavelengths=partial(envi_wavelengths, header) if has_envi_wavelengths(header) else None,
        scale=partial(envi_scale, header),
        description=header.fields.get("description", ""),
        units=" ".join(header.fields.get(name, "") for name in ("data units", "units")),
        notes=notes,
    )
