"""Noise profiles as sources of a pixel: those of DNG and Android, and those of darktable.

The profile of DNG and Android is read from JSON or from a text list of the tags of a DNG.

A profile of darktable, variance = a x + b per channel, is relative only: it is measured on
developed pictures (demosaiced, white-balanced, filtered by a wavelet), which scales a and b by an
unknown factor. The ratio b / a does not depend on that factor. Together with a full well from
another source it gives the read noise. The profile cannot give the full well.
"""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, InputError, Setting, check, dataclass, json_of
from chromanoise.io.pixels.pixel_toml import errors_in_file, finite_number, source_text
from chromanoise.io.source_files import real_of, refused
from chromanoise.sensor import Adc, PixelSource, pixel_from_noise_profile, pixel_without_levels

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
        need = f"must be a JSON object with {', '.join(_KEYS)} to be a noise profile"
        raise refused(path, need, found=f"has no {' and no '.join(missing)}")
    rows = {key: _numbers(held[key], key, path) for key in _KEYS}
    for key in _KEYS[2:]:
        if len(rows[key]) != 1:
            raise refused(path, "must be one number for all channels", rows[key], where=key)
    names = held.get("channels", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise refused(path, "must be a list of names", names, where="channels")
    with errors_in_file(path):
        check.same_length("channels", S=len(rows["S"]), O=len(rows["O"]))
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
        need = "must hold S and O of each channel"
        found = f"holds {len(numbers)} numbers"
        remedy = "write NoiseProfile: 0.0002 0.000001"
        raise refused(path, need, len(numbers), found, where="NoiseProfile", remedy=remedy)
    profile = np.array(numbers).reshape(-1, 2)
    levels = [_tagged(tag, text, path) for tag in (_BLACK, _WHITE)]
    if all(level is None for level in levels):
        with errors_in_file(path):
            return pixel_without_levels(profile, source=path.name)
    black, white = (set(level or ()) for level in levels)
    for name, level in (("BlackLevel", black), ("WhiteLevel", white)):
        if len(level) != 1:
            need = "must be one number for all channels"
            found = "is missing" if not level else ""
            remedy = "write both BlackLevel and WhiteLevel or neither"
            raise refused(path, need, sorted(level) or None, found, where=name, remedy=remedy)
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
    numbers = [real_of(word) for word in words]
    if not all(map(math.isfinite, numbers)):
        line = text[: match.start(1)].count("\n") + 1
        raise refused(path, "must be finite numbers", match[1].strip()[:60], where=f"line {line}")
    return numbers


def _numbers(value: object, key: str, path: Path) -> list[float]:
    entries = value if isinstance(value, list) else [value]
    numbers = [finite_number(entry) for entry in entries]
    found = [number for number in numbers if number is not None]
    if not numbers or len(found) < len(numbers):
        raise refused(path, "must be a finite number or a list of them", value, where=key)
    return found


_GREEN = 1  # the channel that a white balance does not change


@dataclass(frozen=True, kw_only=True, eq=False)
class RelativeNoise:
    """One profile of darktable: variance = a x + b, with x = 1 at the largest code.

    Attributes
    ----------
    iso
        The ISO setting of the profile. [1]
    a, b
        Coefficients of red, green and blue, up to one unknown factor. [1]
    notes
        Remarks that apply to results.

    Raises
    ------
    InputError
        If an entry is not finite, or an entry of ``a`` is not > 0.
    """

    camera: str
    iso: float
    a: Float[Array, " 3"]
    b: Float[Array, " 3"]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"of {self.camera} at ISO {self.iso:g}"
        check.positive(f"ISO of {self.camera}", "1", self.iso)
        for name in ("a", "b"):
            values = check.finite(f"{name} {where}", "1", getattr(self, name))
            object.__setattr__(self, name, check.frozen(values))
        for value in self.a.tolist():
            check.positive(f"a {where}", "1", value)


def read_darktable_noise(path: Path | str, *, maker: str, model: str, iso: float) -> RelativeNoise:
    """The profile of one camera at one ISO from darktable's ``noiseprofiles.json``.

    Parameters
    ----------
    path
        The file that darktable installs.
    maker, model
        Names as in that file, e.g. ``Canon``, ``EOS-1Ds``.
    iso
        A measured ISO; there is no interpolation.

    Raises
    ------
    InputError
        If the file has another format, or lacks the camera or ISO; the message suggests similar
        ones.
    """
    path = Path(path)
    held = json_of(source_text(path), str(path), any_number=True)
    makers = _listed(held, "noiseprofiles", "maker", path, "")
    maker = _known("maker", maker, makers, f"{path}")
    models = _listed(makers[maker], "models", "model", path, maker)
    model = _known("model", model, models, f"{path} for {maker}")
    camera = f"{maker} {model}"
    profiles = models[model].get("profiles")
    entries = profiles if isinstance(profiles, list) else []
    mine = [e for e in entries if isinstance(e, dict) and finite_number(e.get("iso")) == iso]
    if not mine:
        isos = sorted(sorted({str(e.get("iso")) for e in entries if isinstance(e, dict)}), key=len)
        need = f"must be listed in {path} for {camera}"
        raise refused("iso", need, iso, remedy=f"choose from {', '.join(isos[:40])}")
    place = f"of {camera} at ISO {iso:g}"
    a, b = (_three(mine[0].get(key), path, f"{key} {place}") for key in "ab")
    notes = [
        f"{path.name}: {camera}, relative noise of developed pictures; it contains neither gain "
        "nor full well"
    ]
    if len(mine) > 1:
        notes.append(f"{path.name}: {len(mine)} profiles of ISO {iso:g}; the first is taken")
    with errors_in_file(path):
        return RelativeNoise(camera=camera, iso=float(iso), a=a, b=b, notes=tuple(notes))


def pixel_from_darktable(
    noise: RelativeNoise, *, full_well_e: float | None = None, adc: Adc | None = None
) -> PixelSource:
    """The read noise of green, from a profile and an absolute full well.

    Parameters
    ----------
    full_well_e
        Electrons at the largest code, at the ISO of the profile. [e-]
    adc
        Alternatively the converter at that ISO; its range times its gain gives these electrons.

    Raises
    ------
    InputError
        If neither or both are given.

    Notes
    -----
    With E electrons at x = 1 and an unknown factor c, a = c / E and b = c (sigma / E)^2, so that
    sigma^2 = E b / a. Green is used because white balance does not scale it.

    Examples
    --------
    >>> relative = RelativeNoise(camera="a camera", iso=100, a=np.full(3, 2e-6), b=np.full(3, 2e-8))
    >>> round(pixel_from_darktable(relative, full_well_e=10_000).read_noise_e, 6)
    10.0
    """
    if (full_well_e is None) == (adc is None):
        raise refused(
            f"the noise profile of {noise.camera} at ISO {noise.iso:g}",
            "is relative and needs either full_well_e (electrons where the codes end) or adc (the "
            "converter)",
            (full_well_e, adc),
            "has neither" if adc is None else "has both",
            remedy=(Setting("full_well_e"), Setting("adc")) if adc is None else "omit one",
        )
    if full_well_e is None and adc is not None:
        full_well_e = adc.gain_e_per_dn * (adc.top_code - adc.black_level_dn)
    well = check.positive("full_well_e", "e-", full_well_e or 0.0)
    read2 = well * float(noise.b[_GREEN]) / float(noise.a[_GREEN])
    note = f"{noise.camera}: read noise from b / a of green and {well:.4g} e- at the top"
    if read2 < 0:
        note = f"{noise.camera}: b of green is negative, so it gives no read noise"
    return PixelSource(
        source=f"darktable's profile of {noise.camera} at ISO {noise.iso:g}",
        full_well_e=well,
        read_noise_e=float(np.sqrt(read2)) if read2 >= 0 else None,
        gain_e_per_dn=adc.gain_e_per_dn if adc else None,
        adc=adc,
        notes=(*noise.notes, note),
    )


def _known(name: str, value: str, choices: Mapping[str, Any], where: str) -> str:
    try:
        return check.one_of(name, value, sorted(choices))
    except InputError as error:
        raise refused(name, f"must be listed in {where}", value, remedy=error.remedy) from None


def _listed(held: Any, key: str, name: str, path: Path, where: str) -> Mapping[str, dict[str, Any]]:
    """The objects under ``key``, by their ``name``."""
    entries = held.get(key) if isinstance(held, dict) else None
    found: dict[str, dict[str, Any]] = {}
    for entry in entries if isinstance(entries, list) else []:
        if isinstance(entry, dict) and isinstance(entry.get(name), str):
            found.setdefault(entry[name], entry)
    if not found:
        remedy = "give the file noiseprofiles.json of darktable"
        raise refused(path, f"has no {key} with a {name}", where=where, remedy=remedy)
    return found


def _three(values: Any, path: Path, where: str) -> Float[Array, " 3"]:
    entries: Sequence[Any] = values if isinstance(values, list) else []
    numbers = [number for entry in entries if (number := finite_number(entry)) is not None]
    if len(numbers) != 3 or len(entries) != 3:
        raise refused(path, "must be three finite numbers", values, where=where)
    return np.array(numbers)
