"""Binary files of ASD field spectrometers (``.asd``, or numbers such as ``.000``)."""

import re
import struct
from pathlib import Path

import numpy as np

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.io.spectra.parsed import Found, Quantity, known_columns

_MARK = re.compile(rb"ASD|as[2-8]")
_HEADER_BYTES = 484
_EXPORT = "export it as text with ViewSpec Pro"
_STORED = ("<f4", "<i4", "<f8")
_KINDS: tuple[tuple[str, Quantity | None], ...] = (
    ("raw counts", None), ("reflectance", "reflectance"), ("radiance", None), ("no unit", None),
    ("irradiance", None), ("quality index", None), ("transmittance", "transmittance"),
    ("unknown", None), ("absorbance", None),
)  # fmt: skip
_MOST_CHANNELS = 100_000


def is_asd(content: bytes) -> bool:
    """Whether these are the first bytes of an ASD file, versions 1 to 8."""
    return _MARK.match(content) is not None and b"\0" in content[:_HEADER_BYTES]


def read_asd(path: Path, content: bytes) -> Found:
    """The spectrum and the white reference of a file, or their ratio if the file declares it.

    Raises
    ------
    InputError
        If the file is cut short, or holds radiance, irradiance or absorbance, whose calibration is
        not applied.

    Notes
    -----
    ASD Inc., "ASD File Format, version 8", document 600979: a header of 484 bytes; the channels of
    the spectrum; from version 2 on a flag, two times, a text and the channels of the reference.
    A reflectance or transmittance is the spectrum divided by that reference.
    """
    if len(content) < _HEADER_BYTES:
        raise _damage(path, len(content), _HEADER_BYTES)
    kind, form = content[186], content[199]
    start_nm, step_nm = struct.unpack_from("<2f", content, 191)
    channels = struct.unpack_from("<H", content, 204)[0]
    if kind >= len(_KINDS) or form >= len(_STORED) or not (start_nm > 0 and step_nm > 0):
        need = "must declare its data type, its numbers and its wavelengths in its header"
        values = (kind, form, start_nm, step_nm)
        raise InputError(str(path), need, value=values, remedy=_EXPORT)
    name, quantity = _KINDS[kind]
    if kind and quantity is None:
        need = "must hold reflectance, transmittance or raw counts"
        found = f"holds {name}, whose calibration is not applied"
        raise InputError(str(path), need, value=name, found=found, remedy=_EXPORT)
    stored = np.dtype(_STORED[form])
    spectrum = _numbers(path, content, _HEADER_BYTES, channels, stored)
    reference = _reference(path, content, _HEADER_BYTES + channels * stored.itemsize, channels)
    at = start_nm + step_nm * np.arange(channels)
    curves = {name: spectrum}
    notes: tuple[str, ...] = ()
    if reference is not None and quantity is None:
        curves = {"spectrum": spectrum, "white reference": reference}
    elif reference is not None:
        lost = reference == 0
        curves = {name: np.divide(spectrum, reference, where=~lost, out=np.full(channels, np.nan))}
        notes = (f"{name} is the spectrum divided by its white reference, as the file declares",)
    return Found(
        source=str(path),
        format=f"ASD binary, version {content[:3].decode('ascii')}",
        columns=known_columns(at, curves.items()),
        wavelength_unit="nm",
        quantity=quantity,
        scale="fraction" if quantity and reference is not None else None,
        notes=notes,
    )


def _reference(path: Path, content: bytes, at: int, channels: int) -> Array | None:
    if content[:3] == b"ASD" or len(content) < at + 20:
        return None
    if not struct.unpack_from("<H", content, at)[0]:
        return None
    length = struct.unpack_from("<H", content, at + 18)[0]
    return _numbers(path, content, at + 20 + length, channels, np.dtype("<f8"))


def _numbers(path: Path, content: bytes, at: int, count: int, stored: np.dtype) -> Array:
    end = at + count * stored.itemsize
    if not 1 < count <= _MOST_CHANNELS or end > len(content):
        raise _damage(path, len(content), end)
    return np.frombuffer(content[at:end], dtype=stored).astype(np.float64)


def _damage(path: Path, size: int, needed: int) -> InputError:
    return InputError(
        str(path),
        f"must have at least {needed} bytes, as its header declares",
        value=size,
        found=f"has {size}: it is damaged or cut short",
    )
