"""The sensor: p spectral channels on one pixel design; white level, and model sensors.

The white level is the largest signal of a pixel: its full well, or the top code of its converter.
Model sensors are the industry's filter sets with the same silicon, resins and pixel, so that a
comparison shows only the filter set (`sensor.filters`). `dye_transmittances` computes the
transmittances of dyes that exist, from sensors with and without them.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, get_args

import numpy as np

from chromanoise.base import Array, Float, InputError, check, dataclass, notebook, with_short_repr
from chromanoise.sensor.crosstalk import (
    Crosstalk,
    Mosaic,
    bayer,
    mosaic_named,
    rgb_ir,
    rgbw_sparse_4x4,
)
from chromanoise.sensor.filters import ir_cut, layered_silicon_qe, resin_filter, silicon_qe
from chromanoise.sensor.pixel import PAPER_PIXEL, UNKNOWN_CONVERTER, Converter, Pixel, adc_of
from chromanoise.spectra import Grid, Spectra

Origin = Literal["given", "measured", "model", "reconstruction"]


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
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
        Name of each channel, in the order of ``qe``.
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
        what = f"QE of sensor {self.name}"
        qe = check.fraction(what, "e-/photon", self.qe)
        full = qe.ndim == 2 and qe.shape[1] > 0
        check.shape(what, qe, full, "must be (wavelengths, channels)")
        check.one_of("origin", self.origin, get_args(Origin))
        check.same_length("wavelengths", grid=self.grid.n, qe=qe.shape[0])
        check.same_length("channels", names=len(self.names), qe=qe.shape[1])
        for text in (self.name, self.label):
            check.shown_names("name of a sensor", (text,))
        names = check.shown_names(f"channel names of {self.name}", self.names)
        for name in self.mosaic.names if self.mosaic else ():
            check.among(f"mosaic channel of {self.name}", name, names)
        if self.stacked and (most := float(qe.sum(axis=1).max())) > 1 + 1e-9:
            need = "must sum to at most 1 over the stacked channels at each wavelength [e-/photon]"
            raise InputError(what, need, value=most)
        check.keep(self, qe=qe)
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
        return notebook.shown(
            f"Sensor {self.label} ({self.origin}): {pixel.pitch_um:g} um, full well "
            f"{pixel.full_well_e:g} e-, read noise {pixel.read_noise_e:g} e-",
            notebook.curves(nm, self.qe, self.names, what=f"QE of {self.name} [e-/photon]"),
            notebook.table(["channel", "highest QE [e-/photon]", "at [nm]"], rows),
            notes=self.notes,
        )


def pixels_of(sensor: Sensor) -> int:
    """Number of pixels for one set of channels: p, or 1 if the channels are stacked."""
    return 1 if sensor.stacked else len(sensor.names)


def refuse_blind_channels(sensor: Sensor) -> None:
    """Refuse a channel that measures nothing.

    Raises
    ------
    InputError
        If a channel is zero at every wavelength.
    """
    for name in blind_channels(sensor):
        raise InputError(
            f"channel {name} of sensor {sensor.name}",
            "must have a QE above 0 at some wavelength",
            value=0.0,
            found=f"has a QE of 0 on the whole grid {sensor.grid}, so it measures nothing",
            remedy="omit the channel",
        )


def blind_channels(sensor: Sensor) -> tuple[str, ...]:
    """The channels with a QE of 0 at every wavelength."""
    seen = zip(sensor.names, sensor.qe.max(axis=0), strict=True)
    return tuple(name for name, highest in seen if not highest)


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
        check.among(f"channel of {sensor.name}", channel, sensor.names)
    checked = check.fraction(f"transmittance before {sensor.name}", "1", transmittance)
    check.same_length("wavelengths", sensor=sensor.grid.n, transmittance=checked.size)
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
        check.among(f"channel of {sensor.name}", wanted, sensor.names)
    columns = [sensor.names.index(wanted) for wanted in names]
    return replace(
        sensor,
        name=name,
        names=tuple(names),
        qe=sensor.qe[:, columns],
        mosaic=mosaic,
        crosstalk=None,
    )


def code_range_e(sensor: Sensor) -> float:
    """Electrons from black level to top code; inf where bits or gain are not known. [e-]

    Where n readings are summed (`chromanoise.sensor.binned`), it is n times that of one reading.
    """
    converter = sensor.converter
    if converter.bits is None or converter.gain_e_per_dn is None:
        return math.inf
    adc = adc_of(converter, sensor.pixel)
    codes = adc.top_code - adc.black_level_dn
    return codes * adc.gain_e_per_dn * sensor.pixel.summed_readings


def white_level_e(sensor: Sensor, *, dark_e: float = 0.0) -> float:
    """Largest signal: full well minus dark electrons, or the top code if that is lower. [e-]

    Dark electrons take up part of the well; their mean is subtracted from the codes, which start at
    the black level. The result is 0 or less where dark electrons fill the whole well.

    Parameters
    ----------
    sensor
        Its pixel and converter.
    dark_e
        Mean number of dark electrons of the exposure. [e-]

    Notes
    -----
    EMVA 1288, release 4.0, calls it the saturation capacity and finds it at the largest variance.

    Examples
    --------
    >>> from chromanoise.study import sensor_named
    >>> from chromanoise.sensor import with_pixel
    >>> from chromanoise.spectra import DEFAULT_GRID
    >>> sensor = sensor_named("model-rgb", DEFAULT_GRID)
    >>> white_level_e(with_pixel(sensor, {"full_well_e": 9000.0}), dark_e=100.0)
    8900.0
    >>> white_level_e(with_pixel(sensor, {"bits": 10, "gain_e_per_dn": 2.0}))
    2046.0
    """
    return min(sensor.pixel.full_well_e - dark_e, code_range_e(sensor))


def white_level_name(sensor: Sensor, *, dark_e: float = 0.0) -> str:
    """What limits the signal: ``full well`` or ``top code`` (`white_level_e`).

    Parameters
    ----------
    dark_e
        Dark electrons. [e-]
    """
    well_e = sensor.pixel.full_well_e - dark_e
    return "top code" if code_range_e(sensor) < well_e else "full well"


_DEPTH_UM = 4.0
_NOTE = "curves are a model of silicon, resins and an IR-cut, not a device"

_RESINS: dict[str, dict[str, float]] = {
    "R": {"low_nm": 590, "high_nm": 1000, "leak_nm": 1000, "peak": 0.92},
    "G": {"low_nm": 490, "high_nm": 590, "leak_nm": 790},
    "B": {"low_nm": 380, "high_nm": 505, "leak_nm": 800},
    "C": {"low_nm": 380, "high_nm": 595, "leak_nm": 790},
    "Y": {"low_nm": 500, "high_nm": 1000, "leak_nm": 1000, "peak": 0.94},
    "IR": {"low_nm": 820, "high_nm": 1050, "leak_nm": 1050, "peak": 0.9},
}


def _transmittance(name: str, grid: Grid) -> Float[Array, " n"]:
    """Transmittance of the resin over channel ``name``; W has no filter, M transmits B and R."""
    if name == "W":
        return np.ones(grid.n)
    if name == "M":
        blue = resin_filter(grid, **_RESINS["B"])
        red = resin_filter(grid, **_RESINS["R"])
        return np.maximum(blue, red)
    return resin_filter(grid, **_RESINS[name])


def _resin_sensor(
    name: str, channels: Sequence[str], cut: bool, mosaic: Mosaic | None, grid: Grid
) -> Sensor:
    silicon = silicon_qe(grid, depth_um=_DEPTH_UM)
    passed = silicon * ir_cut(grid) if cut else silicon
    return Sensor(
        name=name,
        grid=grid,
        qe=np.stack([passed * _transmittance(c, grid) for c in channels], axis=1),
        names=tuple(channels),
        pixel=PAPER_PIXEL,
        mosaic=mosaic,
        origin="model",
        notes=(_NOTE,),
    )


def three_layer(grid: Grid) -> Sensor:
    """Three stacked photodiodes behind an IR-cut: color by the depth at which silicon absorbs.

    The layers end at 0.4, 1.2 and 4 um; each absorbs the light that the layers above transmit.
    """
    layers = layered_silicon_qe(grid, (0.4, 1.2, 4.0))
    return Sensor(
        name="model-three-layer",
        grid=grid,
        qe=layers * ir_cut(grid)[:, None],
        names=("B", "G", "R"),
        pixel=PAPER_PIXEL,
        stacked=True,
        origin="model",
        notes=("curves are a model of stacked silicon and an IR-cut, not a device",),
    )


_CMY, _RYB, _RCCB = mosaic_named("CY/YM"), mosaic_named("RY/YB"), mosaic_named("RW/WB")

_RGBWIR = mosaic_named("R W G W/W IR W IR/G W B W/W IR W IR")
_RESIN_SENSORS: dict[str, tuple[Sequence[str], bool, Mosaic | None]] = {  # IR-cut or not
    "model-mono": ("W", False, None),
    "model-rgb-ircut": ("RGB", True, bayer()),
    "model-rgb": ("RGB", False, bayer()),
    "model-rgbw-ircut": ("RGBW", True, rgbw_sparse_4x4()),
    "model-rgbw": ("RGBW", False, rgbw_sparse_4x4()),
    "model-rgbwir": (("R", "G", "B", "W", "IR"), False, _RGBWIR),
    "model-rgbir": (("R", "G", "B", "IR"), False, rgb_ir()),
    "model-cmy-ircut": ("CMY", True, _CMY),
    "model-cmy": ("CMY", False, _CMY),
    "model-ryb-ircut": ("RYB", True, _RYB),
    "model-ryb": ("RYB", False, _RYB),
    "model-rccb-ircut": ("RWB", True, _RCCB),
    "model-rccb": ("RWB", False, _RCCB),
}
MODELS: Mapping[str, Callable[[Grid], Sensor]] = {
    **{name: partial(_resin_sensor, name, *row) for name, row in _RESIN_SENSORS.items()},
    "model-three-layer": three_layer,
}
"""Filter sets by name. RGBC is RGBW behind the IR-cut, with white called clear."""


def dye_transmittances(sensor: Sensor, *, white: str = "W") -> Spectra:
    """Transmittances of the dyes of a sensor: the QE of each channel over that of its bare pixel.

    Where the two come from different plots of a data sheet, a ratio can exceed 1, which no filter
    can. All dyes are then divided by the highest ratio, and a note says so: their shapes and their
    ratios are kept, their level is a guess on the low side.

    Parameters
    ----------
    sensor
        A sensor of which one channel has no dye.
    white
        The name of this channel.

    Returns
    -------
    Spectra
        One curve per other channel, named ``sensor:channel``. [1]

    Raises
    ------
    InputError
        If the sensor has no such channel, no other one, or a QE of 0 in it.

    Examples
    --------
    >>> from chromanoise.study import sensor_named
    >>> from chromanoise.spectra import Grid
    >>> dyes = dye_transmittances(sensor_named("model-rgbw", Grid.uniform(450, 650, 100)))
    >>> dyes.names
    ('model-rgbw:R', 'model-rgbw:G', 'model-rgbw:B')
    >>> dyes.values[1].round(2)                                               # at 550 nm
    array([0.05, 0.86, 0.04])
    """
    check.among(f"channel of {sensor.name}", white, sensor.names)
    bare = sensor.qe[:, sensor.names.index(white)]
    others = [name for name in sensor.names if name != white]
    if not others or not bare.all():
        raise InputError(
            f"dyes of {sensor.name}",
            "must be the ratio of other channels to one whose QE is above 0 everywhere",
            value=white,
            found=f"{white} is 0 at {sensor.grid.wavelength_nm[bare.argmin()]:g} nm"
            if others
            else f"{white} is the only channel",
        )
    ratio = sensor.qe[:, [sensor.names.index(name) for name in others]] / bare[:, None]
    highest = float(ratio.max())
    note = (
        f"dyes of {sensor.name}: divided by {highest:.4g}, their highest ratio to {white}, because "
        "no filter transmits more than all light"
    )
    return Spectra(
        wavelength_nm=sensor.grid.wavelength_nm,
        values=ratio / max(highest, 1.0),
        names=tuple(f"{sensor.name}:{name}" for name in others),
        quantity="transmittance",
        unit="1",
        source=sensor.name,
        notes=(*sensor.notes, *((note,) if np.round(highest, 12) > 1 else ())),
    )
