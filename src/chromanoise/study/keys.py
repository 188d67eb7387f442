"""The keys of a study with their types, defaults, descriptions and interfaces.

The commented study that `chromanoise init` writes.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from types import MappingProxyType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from chromanoise.base import DeclaredField, Interface, Record
from chromanoise.study.document import Known, LightPart, Study


@dataclass(frozen=True, slots=True, kw_only=True)
class KeyOfStudy:
    """A key of a study that holds a value.

    Attributes
    ----------
    key
        With ``*`` for a sensor and ``0`` for an entry of another list: ``sensors.*.pixel.dsnu_e``.
    field
        Its type, default and description.
    interface
        How interfaces offer it; ``None`` for a key of study files alone.
    """

    key: str
    field: DeclaredField
    interface: Interface | None

    @property
    def keyword(self) -> str | None:
        """Its flat name as a setting; ``None`` if it is none."""
        if self.interface is None or self.interface.keyword is None:
            return None
        return self.interface.keyword or self.key.rpartition(".")[2]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of which its word is one; other words may be possible too."""
        found = [one for one in _inside(self) if isinstance(one, Known)]
        return found[0].names if found else ()

    @property
    def others(self) -> bool:
        """Whether it takes other words than `names`."""
        return any(one.others for one in _inside(self) if isinstance(one, Known))

    @property
    def type(self) -> Any:
        """Type of its value in Python, without ``None``."""
        if self.interface is not None and self.interface.each:
            return Sequence[str]
        return _of_python(self.field.annotation, self.interface or Interface())


def _inside(one: KeyOfStudy) -> list[Any]:
    """The metadata and the types of a field, also those inside a union."""
    return [*one.field.metadata, *_parts_of(one.field.annotation)]


def _parts_of(annotation: Any) -> list[Any]:
    """A type with all types and metadata inside it."""
    return [annotation, *(part for one in get_args(annotation) for part in _parts_of(one))]


_MAPPING: Any = Mapping  # types of values, which type checkers do not follow
_SEQUENCE: Any = Sequence
_TUPLE: Any = tuple


def _of_python(annotation: Any, interface: Interface) -> Any:
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _of_python(inside[0], interface)
    if origin in (Union, UnionType):
        kinds = [_of_python(one, interface) for one in inside if one is not type(None)]
        return reduce(lambda a, b: a | b, kinds)
    if origin is dict:
        return _MAPPING[str, _of_python(inside[1], interface)]
    if origin is tuple:
        ends = [_of_python(one, Interface()) for one in inside if one is not ...]
        return _SEQUENCE[ends[0]] if ... in inside else _TUPLE[*ends]
    if annotation is str and interface.curves:
        return str | Path | object
    return str | Path if annotation is str and interface.paths else annotation


def _walked(model: type[Record], prefix: str) -> Iterator[KeyOfStudy]:
    for name, field in model.model_fields.items():
        key = f"{prefix}{field.alias or name}"
        inside = _parts_of(field.annotation)
        part = next((p for p in inside if isinstance(p, type) and issubclass(p, Record)), None)
        if part is not None:
            many = any(get_origin(p) is tuple for p in inside)
            index = ("*." if name == "sensors" else "0.") if many else ""
            yield from _walked(part, f"{key}.{index}")
            continue
        interface = next((one for one in field.metadata if isinstance(one, Interface)), None)
        yield KeyOfStudy(key=key, field=field, interface=interface)


KEYS: Mapping[str, KeyOfStudy] = MappingProxyType({one.key: one for one in _walked(Study, "")})
"""The keys of a study that hold values, in the order of its classes."""


STARTER = f"""\
# A chromanoise study: `chromanoise run study.toml` computes all of it, and
# `chromanoise rerun out/study -o out/again` computes it again and compares the results. File
# names are relative to the folder of this file.
schema = 1
title = "Can the IR-cut be dropped?"
metric = "quanta"                    # spectra in photons (quanta) or in energy
seed = 0                             # of all noise that is drawn
matrices = ["kernel", "lmmse"]       # least-squares, white-preserving, ridge=0.01,
                                     # noise-regularized=1, bounded-psi=6.5
# prior = "chart-nir"                # of trained matrices: chart, smooth-50, smooth-100 ...

[light]
illuminant = "E"                     # A, D65, G173, 3200K, LED660, or a file
level_lux = {LightPart().level_lux}
# beyond = "hold"                    # what the curve is beyond its end: refuse, zero, hold

[exposure]
equal = "exposure"                   # one time for all; or saturation, or light
# saturate = 0.99                    # of full well, for the most sensitive of them
# time_ms = 12                       # instead of saturate
f_number = 1.8

[[sensors]]
name = "onyx-rgbw"                   # of `chromanoise catalog sensors`, or a file of QE curves

[[sensors]]
name = "onyx-rgb-ircut"
# label = "old"                      # shown in place of the name
# filter = "ircut-650"               # in front of it: of `chromanoise catalog filters`, or a file
# [sensors.pixel]
# file = "sheet.txt"                 # EMVA 1288 sheet, DNG noise profile, photon transfer
# read_noise_e = 2.0                 # pitch_um, full_well_e; they win over the file

[[sweeps]]
vary = "lux"                         # time-ms, f-number, read-noise-e, ircut-nm ...
first = 0.01
last = 1000
points = 61
quantity = "snr-y"                   # snr-x, snr-z, bound, price, delta-e, color-error
# second = {{vary = "f-number", first = 1.4, last = 8.0}}  # a second parameter: a heat map

# [[pictures]]
# cube = "builtin:checker"           # of `chromanoise catalog scenes`, or a file of reflectances
# mosaic = "sensor"                  # raw codes and demosaicing; bayer, RG/GB ...
# denoise = "guided"                 # the electrons, with their known noise, before color
# frames = 1                         # of a burst; formats, bits, noise of the pixel ...

[outputs]
budget = true                        # dB per cause
chart = false                        # every patch of the ColorChecker
# merit = true                       # Vora, SMI, ISO speed, visual noise ...
# matrix = true                      # each color matrix with its color error and noise
# space = "lab"                      # noise of an 18 % gray in lab, luv, srgb, linear-srgb

# [outputs.pipeline]                 # the camera's own, to sRGB, Y'CbCr and Lab, at every ISO
# run = true
# white_balance = "gray"             # illuminant, D65 ..., or [2.0, 1.0, 1.6]
# iso = [100, 400, 1600]
"""
"""The commented study file that ``chromanoise init`` writes."""
