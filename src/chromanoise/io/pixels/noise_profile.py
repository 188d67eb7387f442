"""The noise profile of DNG and Android, from JSON or from a text list of the tags of a DNG."""

import re
from pathlib import Path

import numpy as np

from chromanoise import _check
from chromanoise._inputs import json_of
from chromanoise.errors import InputError
from chromanoise.io.pixels.source_text import (
    errors_in_file,
    finite_number,
    source_text,
)
from chromanoise.sensor import PixelSource, pixel_from_noise_profile
from chromanoise.sensor.noise_profile import pixel_without_levels

_TAG, _BLACK, _WHITE = (
    re.compile(rf"(?im)^[ \t]*{name}[ \t]*[:=][ \t]*(.*)$")
    for name in (r"noise[ \t]*profile", r"black[ \t]*level", r"white[ \t]*level")
)
_KEYS = ("S", "O", "black_level_dn", "white_level_dn")


def read_noise_profile(path: Path | str) -> PixelSource:
    """The pixel of a JSON file with ``S``, ``O``, ``black_level_dn`` and ``white_level_dn``.

    Parameters
    ----------
    path
        A JSON file in which ``S`` and ``O`` are numbers, or lists with one number per channel;
        ``channels`` may name them. Or a text list of the tags of a DNG: ``NoiseProfile: S O ..``
        with a pair per channel, and optionally ``BlackLevel: ..`` and ``WhiteLevel: ..``.

    Raises
    ------
    InputError
        If the file cannot be read, or a key is missing or not a number; also as for
        `pixel_from_noise_profile`.
    """
    path = Path(path)
    text = source_text(path)
    if is_noise_profile_text(text):
        return _pixel_of_text(text, path)
    held = json_of(text, str(path))
    if not isinstance(held, dict) or any(key not in held for key in _KEYS):
        missing = [key for key in _KEYS if not isinstance(held, dict) or key not in held]
        raise InputError(
            str(path),
            f"must be a JSON object with {', '.join(_KEYS)} to be a noise profile",
            found=f"has no {' and no '.join(missing)}",
        )
    rows = {key: _numbers(held[key], key, path) for key in _KEYS}
    for key in _KEYS[2:]:
        if len(rows[key]) != 1:
            raise InputError(
                str(path), "must be one number for all channels", value=rows[key], where=key
            )
    names = held.get("channels", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(str(path), "must be a list of names", value=names, where="channels")
    with errors_in_file(path):
        _check.same_length("channels", S=len(rows["S"]), O=len(rows["O"]))
        return pixel_from_noise_profile(
            np.array([rows["S"], rows["O"]]).T,
            black_level_dn=rows["black_level_dn"][0],
            white_level_dn=rows["white_level_dn"][0],
            channels=names,
            source=path.name,
        )


def is_noise_profile_text(text: str) -> bool:
    r"""Whether a line of the text begins with ``NoiseProfile:``.

    Examples
    --------
    >>> is_noise_profile_text("ISO: 100\nNoise Profile : 2e-4 1e-6"), is_noise_profile_text("S, O")
    (True, False)
    """
    return _TAG.search(text) is not None


def _pixel_of_text(text: str, path: Path) -> PixelSource:
    numbers = _tagged(_TAG, text, path) or []
    if len(numbers) < 2 or len(numbers) % 2:
        raise InputError(
            str(path),
            "must hold S and O of each channel",
            value=len(numbers),
            found=f"holds {len(numbers)} numbers",
            where="NoiseProfile",
            remedy="write NoiseProfile: 0.0002 0.000001",
        )
    profile = np.array(numbers).reshape(-1, 2)
    levels = [_tagged(tag, text, path) for tag in (_BLACK, _WHITE)]
    if all(level is None for level in levels):
        with errors_in_file(path):
            return pixel_without_levels(profile, source=path.name)
    black, white = (set(level or ()) for level in levels)
    for name, level in (("BlackLevel", black), ("WhiteLevel", white)):
        if len(level) != 1:
            raise InputError(
                str(path),
                "must be one number for all channels",
                value=sorted(level) or None,
                found="is missing" if not level else "",
                where=name,
                remedy="write both BlackLevel and WhiteLevel or neither",
            )
    with errors_in_file(path):
        return pixel_from_noise_profile(
            profile, black_level_dn=black.pop(), white_level_dn=white.pop(), source=path.name
        )


def _tagged(tag: re.Pattern[str], text: str, path: Path) -> list[float] | None:
    """The numbers after a tag; None if the tag is missing."""
    match = tag.search(text)
    if match is None:
        return None
    words = re.split(r"[\s,;]+", match[1].strip())
    numbers = [_real(word) for word in words]
    found = [number for number in numbers if number is not None]
    if len(found) < len(words):
        line = text[: match.start(1)].count("\n") + 1
        raise InputError(
            str(path), "must be finite numbers", value=match[1].strip()[:60], where=f"line {line}"
        )
    return found


def _real(word: str) -> float | None:
    try:
        return finite_number(float(word))
    except ValueError:
        return None


def _numbers(value: object, key: str, path: Path) -> list[float]:
    entries = value if isinstance(value, list) else [value]
    numbers = [finite_number(entry) for entry in entries]
    found = [number for number in numbers if number is not None]
    if not numbers or len(found) < len(numbers):
        raise InputError(
            str(path), "must be a finite number or a list of them", value=value, where=key
        )
    return found
