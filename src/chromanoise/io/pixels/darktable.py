"""darktable's noise profiles: variance = a x + b per channel, relative only.

The profiles are measured on developed pictures (demosaiced, white-balanced, filtered by a wavelet),
which scales a and b by an unknown factor. The ratio b / a does not depend on that factor. Together
with a full well from another source it gives the read noise. The profile cannot give the full well.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._inputs import json_of
from chromanoise._shapes import (
    Float,
)
from chromanoise.errors import (
    InputError,
    Setting,
)
from chromanoise.io.pixels.source_text import (
    errors_in_file,
    finite_number,
    source_text,
)
from chromanoise.sensor.adc import Adc
from chromanoise.sensor.pixel_source import PixelSource

_GREEN = 1  # the channel that a white balance does not change


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RelativeNoise:
    """One profile of darktable: variance = a x + b, with x = 1 at the largest code.

    Attributes
    ----------
    camera
        Maker and model.
    iso
        The ISO setting.
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
        _check.positive(f"ISO of {self.camera}", "1", self.iso)
        for name in ("a", "b"):
            values = _check.finite(f"{name} {where}", "1", getattr(self, name))
            object.__setattr__(self, name, _check.frozen(values))
        for value in self.a.tolist():
            _check.positive(f"a {where}", "1", value)


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
        raise InputError(
            "iso",
            f"must be listed in {path} for {camera}",
            value=iso,
            remedy=f"choose from {', '.join(isos[:40])}",
        )
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
    noise
        A profile.
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
        raise InputError(
            f"the noise profile of {noise.camera} at ISO {noise.iso:g}",
            "is relative and needs either full_well_e (electrons where the codes end) or adc (the "
            "converter)",
            value=(full_well_e, adc),
            found="has neither" if adc is None else "has both",
            remedy=(Setting("full_well_e"), Setting("adc")) if adc is None else "omit one",
        )
    if full_well_e is None and adc is not None:
        full_well_e = adc.gain_e_per_dn * (adc.top_code - adc.black_level_dn)
    well = _check.positive("full_well_e", "e-", full_well_e or 0.0)
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
        return _check.one_of(name, value, sorted(choices))
    except InputError as error:
        raise InputError(
            name, f"must be listed in {where}", value=value, remedy=error.remedy
        ) from None


def _listed(held: Any, key: str, name: str, path: Path, where: str) -> Mapping[str, dict[str, Any]]:
    """The objects under ``key``, by their ``name``."""
    entries = held.get(key) if isinstance(held, dict) else None
    found: dict[str, dict[str, Any]] = {}
    for entry in entries if isinstance(entries, list) else []:
        if isinstance(entry, dict) and isinstance(entry.get(name), str):
            found.setdefault(entry[name], entry)
    if not found:
        raise InputError(
            str(path),
            f"has no {key} with a {name}",
            where=where,
            remedy="give the file noiseprofiles.json of darktable",
        )
    return found


def _three(values: Any, path: Path, where: str) -> Float[Array, " 3"]:
    entries: Sequence[Any] = values if isinstance(values, list) else []
    numbers = [number for entry in entries if (number := finite_number(entry)) is not None]
    if len(numbers) != 3 or len(entries) != 3:
        raise InputError(str(path), "must be three finite numbers", value=values, where=where)
    return np.array(numbers)
