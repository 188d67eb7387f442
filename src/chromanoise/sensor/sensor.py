"""The sensor: p spectral channels that share one pixel design."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from chromanoise import _check, _notebook
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.sensor.adc import UNKNOWN_CONVERTER, Converter
from chromanoise.sensor.crosstalk import Crosstalk
from chromanoise.sensor.mosaic import Mosaic
from chromanoise.sensor.pixel import Pixel
from chromanoise.spectra import Grid

Origin = Literal["given", "measured", "model", "reconstruction"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensor:
    """``p`` spectral channels sharing one pixel design.

    Attributes
    ----------
    name
        Name of the sensor; random numbers and files are named by it.
    grid
        Wavelength grid of ``qe``.
    qe
        Electrons per photon, filter and IR-cut included: the paper's QE = QE_ph T_f.
        [e-/photon]
    names
        Channel names.
    pixel
        Pitch, full well, and all noise of the pixel.
    mosaic
        The channel of each pixel, if known.
    stacked
        Whether the channels are stacked in depth and share the light of one pixel.
    converter
        Known values of the converter; its step adds quantization noise.
    crosstalk
        Crosstalk that was added to the curves: ``qe`` contains it.
    origin
        Origin of the curves, shown with the sensor: ``given`` by the user, ``measured``,
        ``model`` or ``reconstruction``.
    notes
        Remarks for readers of a result.
    shown_as
        Text in place of the name where results are shown; empty for the name.

    Raises
    ------
    InputError
        If a QE is outside 0 .. 1, or the shapes are inconsistent.
    """

    name: str
    grid: Grid
    qe: Float[Array, "n p"]
    names: tuple[str, ...]
    pixel: Pixel
    mosaic: Mosaic | None = None
    stacked: bool = False
    converter: Converter = UNKNOWN_CONVERTER
    crosstalk: Crosstalk | None = None
    origin: Origin = "given"
    notes: tuple[str, ...] = ()
    shown_as: str = ""

    def __post_init__(self) -> None:
        qe = _check.fraction(f"QE of sensor {self.name}", "e-/photon", self.qe)
        if qe.ndim != 2 or qe.shape[1] == 0:
            raise InputError(
                f"QE of sensor {self.name}",
                "must be (wavelengths, channels)",
                value=qe.shape,
                found=f"has shape {qe.shape}",
            )
        _check.one_of("origin", self.origin, get_args(Origin))
        _check.same_length("wavelengths", grid=self.grid.n, qe=qe.shape[0])
        _check.same_length("channels", names=len(self.names), qe=qe.shape[1])
        names = _check.distinct(f"channel names of {self.name}", self.names)
        for name in self.mosaic.names if self.mosaic else ():
            _check.among(f"mosaic channel of {self.name}", name, names)
        if self.stacked and float(qe.sum(axis=1).max()) > 1 + 1e-9:
            raise InputError(
                f"QE of sensor {self.name}",
                "must sum to at most 1 over the stacked channels at each wavelength [e-/photon]",
                value=float(qe.sum(axis=1).max()),
            )
        object.__setattr__(self, "qe", _check.frozen(qe))
        object.__setattr__(self, "names", names)

    @property
    def label(self) -> str:
        """What tables and charts call the sensor: ``shown_as``, or else its name."""
        return self.shown_as or self.name

    def _repr_html_(self) -> str:
        pixel, nm = self.pixel, self.grid.wavelength_nm
        rows = [
            [name, f"{qe.max():.3f}", f"{nm[qe.argmax()]:g}"]
            for name, qe in zip(self.names, self.qe.T, strict=True)
        ]
        return _notebook.shown(
            f"Sensor {self.label} ({self.origin}): {pixel.pitch_um:g} um, full well "
            f"{pixel.full_well_e:g} e-, read noise {pixel.read_noise_e:g} e-",
            _notebook.curves(nm, self.qe, self.names, what=f"QE of {self.name} [e-/photon]"),
            _notebook.table(["channel", "highest QE [e-/photon]", "at [nm]"], rows),
            notes=self.notes,
        )


def pixels_of(sensor: Sensor) -> int:
    """Number of pixels for one set of channels: p, or 1 if the channels are stacked.

    Parameters
    ----------
    sensor
        The sensor.
    """
    return 1 if sensor.stacked else len(sensor.names)


def behind_filter(
    sensor: Sensor,
    transmittance: Float[Array, " n"],
    *,
    name: str,
    note: str = "",
    channel: str | None = None,
) -> Sensor:
    """The sensor behind one more filter, such as an IR-cut, on all channels or on one.

    Parameters
    ----------
    sensor
        Any sensor.
    transmittance
        Transmittance, 0 .. 1, on the sensor's grid.
    name
        Name of the new sensor.
    note
        Note added to the notes of the new sensor.
    channel
        The channel that has the filter; ``None`` for all.

    Raises
    ------
    InputError
        If the sensor has no such channel, or a transmittance is outside 0 .. 1.
    """
    if channel is not None:
        _check.among(f"channel of {sensor.name}", channel, sensor.names)
    checked = _check.fraction(f"transmittance before {sensor.name}", "1", transmittance)
    _check.same_length("wavelengths", sensor=sensor.grid.n, transmittance=checked.size)
    notes = (*sensor.notes, note) if note else sensor.notes
    behind = np.array([channel in (None, own) for own in sensor.names])
    qe = np.where(behind, sensor.qe * checked[:, None], sensor.qe)
    return replace(sensor, name=name, qe=qe, notes=notes)


def with_channels(
    sensor: Sensor, names: Sequence[str], *, name: str, mosaic: Mosaic | None = None
) -> Sensor:
    """The sensor with only the channels ``names``, in this order.

    Parameters
    ----------
    sensor
        The sensor.
    names
        Names of the channels.
    name
        Name of the new sensor.
    mosaic
        Which channel each pixel has.

    Raises
    ------
    InputError
        If the sensor has no such channel.
    """
    for wanted in names:
        _check.among(f"channel of {sensor.name}", wanted, sensor.names)
    columns = [sensor.names.index(wanted) for wanted in names]
    return replace(
        sensor,
        name=name,
        names=tuple(names),
        qe=sensor.qe[:, columns],
        mosaic=mosaic,
        crosstalk=None,
    )
