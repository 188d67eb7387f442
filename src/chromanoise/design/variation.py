"""A sensor of a study with its parameters changed by some nm or percent."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from chromanoise.errors import InputError
from chromanoise.exposure import OperatingPoint
from chromanoise.sensor import PIXEL, Sensor, ir_cut_model, moved_curve
from chromanoise.study import Given, Study, operating_points_of, sensor_of

NM, PERCENT, POINTS = "nm", "%", "% points"
"""Units of a change: nm, percent of the value, percentage points of a share."""

_OF_PIXEL = {  # those that a share of the value may change
    name: one.label for name, one in PIXEL.items() if one.least >= 0 and one.unit != "K"
}
_OF_EXPOSURE = {"time_s": "exposure time", "f_number": "f-number"}
_SMALL_END = 0.01  # of the peak of a curve


@dataclass(frozen=True, slots=True, kw_only=True)
class Varied:
    """A parameter that may change.

    Attributes
    ----------
    name
        ``R.shift``, ``read_noise_e`` ...
    what
        In words.
    unit
        Of a change: ``nm``, ``%`` of the value, or ``% points``.
    one_sided
        Whether it can only rise.
    of_use
        Whether it belongs to exposure and light, and not to the sensor: no tolerance applies.
    """

    name: str
    what: str
    unit: str
    one_sided: bool = False
    of_use: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Variation:
    """The one sensor of a study, with all parameters that may change.

    The exposure time is that of the unchanged sensor, also where the study solves it.

    Attributes
    ----------
    study
        With one sensor.
    given
        Objects for names in the study.

    Raises
    ------
    InputError
        If the sensor cannot be made (on first use).
    """

    study: Study
    given: Given

    @cached_property
    def point(self) -> OperatingPoint:
        """The operating point without a change."""
        (point,) = operating_points_of(self.study, self.given)
        return point

    @cached_property
    def bare(self) -> Sensor:
        """The sensor of the name, without the changes of the study."""
        part = self.study.sensors[0]
        fields = type(part).model_fields
        kept = ("name", "answers", "beyond", "negatives")
        plain = {name: one.get_default(call_default_factory=True) for name, one in fields.items()}
        update = {name: value for name, value in plain.items() if name not in kept}
        return sensor_of(part.model_copy(update=update), given=self.given)

    @cached_property
    def parameters(self) -> tuple[Varied, ...]:
        """What may change: curves of each channel, IR-cut, crosstalk, pixel, exposure, light."""
        part, point = self.study.sensors[0], self.point
        varied = [
            Varied(name=f"{channel}.{name}", what=f"{what} of {channel}", unit=unit)
            for channel in self.bare.names
            for name, what, unit in (
                ("shift", "shift of the curve", NM),
                ("width", "width of the curve", PERCENT),
                ("gain", "QE", PERCENT),
            )
        ]
        model = None if part.filter is None else ir_cut_model(part.filter)
        if model is not None:
            varied.append(Varied(name="filter.edge", what=f"edge of {part.filter}", unit=NM))
        if part.ircut_nm is not None:
            varied.append(Varied(name="ircut_nm", what="edge of the added IR-cut", unit=NM))
        share = part.crosstalk
        if not isinstance(share, str) and (
            share is not None or (point.sensor.mosaic is not None and not point.sensor.crosstalk)
        ):
            varied.append(
                Varied(name="crosstalk", what="crosstalk", unit=POINTS, one_sided=not share)
            )
        varied += [
            Varied(name=name, what=what, unit=PERCENT)
            for name, what in _OF_PIXEL.items()
            if getattr(point.sensor.pixel, name)
        ]
        varied += [
            Varied(name=name, what=what, unit=PERCENT, of_use=True)
            for name, what in (*_OF_EXPOSURE.items(), ("level_lux", "illuminance"))
        ]
        return tuple(varied)

    @property
    def notes(self) -> tuple[str, ...]:
        """Channels whose curve does not end near zero, so that a shift needs unknown values."""
        qe, grid = self.bare.qe, self.bare.grid
        high = (qe[[0, -1]] > _SMALL_END * qe.max(axis=0)).any(axis=0)
        open_ended = [name for name, one in zip(self.bare.names, high, strict=True) if one]
        if not open_ended:
            return ()
        return (
            f"the curves of {', '.join(open_ended)} do not end near zero at {grid.start_nm:g} or "
            f"{grid.stop_nm:g} nm; where a shift needs values beyond, the end value is repeated",
        )

    def at(self, changes: Mapping[str, float]) -> OperatingPoint:
        """The operating point with parameters changed.

        Parameters
        ----------
        changes
            By the names of ``parameters``, each in its unit; those left out do not change.

        Raises
        ------
        InputError
            If a value leaves its range.
        """
        part, point = self.study.sensors[0], self.point
        update: dict[str, Any] = {}
        if "ircut_nm" in changes:
            update["ircut_nm"] = (part.ircut_nm or 0.0) + changes["ircut_nm"]
        if "filter.edge" in changes:
            edge, width = ir_cut_model(part.filter)  # type: ignore[arg-type,misc]
            update["filter"] = f"ircut-{edge + changes['filter.edge']!r}/{width!r}"
        if "crosstalk" in changes:
            share = part.crosstalk if isinstance(part.crosstalk, float) else 0.0
            update["crosstalk"] = share + changes["crosstalk"] / 100
        changed = replace(self.given, sensors={part.name: self._with_curves(changes)})
        sensor = sensor_of(part.model_copy(update=update), given=changed)
        pixel = _scaled(sensor.pixel, changes, _OF_PIXEL)
        return replace(
            point,
            sensor=replace(sensor, pixel=pixel, name=point.sensor.name),
            exposure=_scaled(point.exposure, changes, _OF_EXPOSURE),
            level_lux=point.level_lux * (1 + changes.get("level_lux", 0.0) / 100),
        )

    def _with_curves(self, changes: Mapping[str, float]) -> Sensor:
        bare = self.bare
        at = bare.grid.wavelength_nm
        curves = []
        for name, curve in zip(bare.names, bare.qe.T, strict=True):
            shift, width, gain = (
                changes.get(f"{name}.{what}", 0.0) for what in ("shift", "width", "gain")
            )
            moved = moved_curve(at, curve, shift_nm=shift, width_share=width / 100)
            curves.append(moved * (1 + gain / 100))
        return replace(bare, qe=np.stack(curves, axis=1))


def _scaled(one: Any, changes: Mapping[str, float], names: Mapping[str, str]) -> Any:
    own = {
        name: getattr(one, name) * (1 + changes[name] / 100) for name in names if name in changes
    }
    return replace(one, **own) if own else one


def refuse_several(study: Study) -> None:
    """Refuse a study of several sensors or matrices.

    Raises
    ------
    InputError
        If it has.
    """
    for name, parts in (("sensors", study.sensors), ("matrices", study.matrices)):
        if len(parts) != 1:
            raise InputError(name, "must be a single one for a sensitivity", value=len(parts))
