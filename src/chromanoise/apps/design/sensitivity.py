"""Effects of 1 nm or 1 % of each parameter of a sensor on objectives, and tolerance budgets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from chromanoise.apps.design.objectives import OBJECTIVES, Candidate, Objective, value_of
from chromanoise.base import (
    Array,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    check,
    dataclass,
    from_above,
    lstsq,
    plain,
    stream,
)
from chromanoise.color import ColorMatrix
from chromanoise.io import Column, Result, Table, axes_of
from chromanoise.noise import OperatingPoint, conditions
from chromanoise.sensor import PIXEL, Sensor, ir_cut_model, moved_curve
from chromanoise.study import (
    NOTHING_GIVEN,
    Given,
    MatrixMaker,
    Study,
    makers_of,
    operating_points_of,
    sensor_of,
)

NM, PERCENT, POINTS = "nm", "%", "% points"
"""Units of a change: nm, percent of the value, percentage points of a share."""

_OF_PIXEL = {  # those that a share of the value may change
    name: one.label for name, one in PIXEL.items() if one.least >= 0 and one.unit != "K"
}
_OF_EXPOSURE = {"time_s": "exposure time", "f_number": "f-number"}
_SMALL_END = 0.01  # of the peak of a curve


@dataclass(frozen=True, kw_only=True)
class Varied:
    """A parameter that may change.

    Attributes
    ----------
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
        plain = {name: None if one.required else one.default for name, one in fields.items()}
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
        objects = {**self.given.objects, part.name: self._with_curves(changes)}
        changed = replace(self.given, objects=objects)
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


DEFAULT_OBJECTIVES: tuple[str, ...] = (
    "snr_y_db",
    "total_delta_e",
    "delta_e",
    "mean_separation",
    "vora",
)
"""What a sensitivity computes if no objectives are named."""
STEP = 0.1
"""Half step of the central differences. [nm or %]"""
FEWEST_DRAWS, MOST_DRAWS = 10, 1_000_000
"""Numbers of sensors that can be drawn."""
_ROUNDING = 1e-13
Values = Callable[[Mapping[str, float]], Array]
"""The objectives of a sensor whose parameters are changed, by name."""


@dataclass(frozen=True, kw_only=True)
class HalfWidths:
    """Tolerances of the parameters of a sensor: half widths of uniform distributions.

    Exposure and light have none.

    Attributes
    ----------
    nm
        Of all wavelengths. [nm]
    percent
        Of all values in percent, and of shares in percentage points. [%]

    Raises
    ------
    InputError
        If a value is negative, or both are 0.
    """

    nm: float = 0.0
    percent: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("nm", "nm"), ("percent", "%")):
            check.within(f"tolerance_{name}", unit, getattr(self, name), 0.0, 50.0)
        if not self.nm and not self.percent:
            raise InputError("tolerance_nm", "must be above 0, or tolerance_percent", value=0.0)

    def of(self, parameter: Varied) -> float:
        """The half width for a parameter, in its unit."""
        if parameter.of_use:
            return 0.0
        return self.nm if parameter.unit == NM else self.percent


def half_widths(nm: float | None, percent: float | None) -> HalfWidths | None:
    """Half widths of tolerances; ``None`` if neither is given.

    Parameters
    ----------
    nm, percent
        As `HalfWidths`; ``None`` for 0.

    Raises
    ------
    InputError
        As `HalfWidths`.
    """
    if nm is None and percent is None:
        return None
    return HalfWidths(nm=nm or 0.0, percent=percent or 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Effect:
    """The effect of one parameter.

    Attributes
    ----------
    slope
        Change of each objective per nm, percent or percentage point; ``None`` where it is not
        defined.
    """

    parameter: Varied
    slope: Mapping[str, float | None]


@dataclass(frozen=True, kw_only=True, eq=False)
class Spread:
    """The objectives of sensors whose parameters differ by their tolerances.

    Attributes
    ----------
    contribution
        Standard deviation of each objective from each parameter alone, first order: slope times
        half width over the root of 3. By objective, in the order of the effects.
    total
        Root of the sum of their squares.
    worst
        Sum of slope times half width: all parameters at the worse end of their tolerance.
    drawn
        Standard deviation of drawn sensors, without those for which the objective is not defined;
        ``None`` without draws.
    drawn_share
        Share of the drawn variance that each parameter explains (first-order Sobol index), from
        the regression on all parameters.
    explained
        Share of the drawn variance that the regression explains; 1 where first order is exact.
    undefined
        Number of drawn sensors for which an objective is not defined: a channel saturates.
    """

    contribution: Mapping[str, Float[Array, " d"]]
    total: Mapping[str, float]
    worst: Mapping[str, float]
    drawn: Mapping[str, float | None]
    drawn_share: Mapping[str, Float[Array, " d"] | None]
    explained: Mapping[str, float | None]
    undefined: Mapping[str, int]

    @property
    def by_objective(self) -> dict[str, dict[str, Any]]:
        """The numbers of each objective over all parameters."""
        names = ("total", "worst", "drawn", "explained", "undefined")
        return {name: {key: getattr(self, key)[name] for key in names} for name in self.total}


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensitivity(Result):
    """Effects of all parameters of a sensor on its objectives.

    Attributes
    ----------
    point, matrix
        The operating point; the name of the matrix.
    keeps_matrix
        Whether a changed sensor keeps the matrix of the unchanged one.
    value
        Value of each objective; ``None`` where it is not defined.
    effects
        Per parameter, from the largest to the smallest effect on the first objective.
    losses
        Losses for which allowances are wanted, by objective.
    tolerances, spread
        Tolerances and what they cause; ``None`` without them.
    draws
        Number of drawn sensors.
    """

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("sensor", "point.sensor.label"),
        JsonKey("conditions", lambda one: conditions([one.point])),
        *("matrix", "keeps_matrix"),
        JsonKey("objectives", lambda one: one.values_by_objective()),
        JsonKey("parameters", lambda one: [one.entry(i) for i in range(len(one.effects))]),
        "notes",
        JsonKey("losses", when="losses"),
        JsonKey("spread", "spread.by_objective", when="spread"),
        JsonKey("draws", when="spread"),
    )

    point: OperatingPoint
    matrix: str
    keeps_matrix: bool
    objectives: tuple[Objective, ...]
    value: Mapping[str, float | None]
    effects: tuple[Effect, ...]
    losses: Mapping[str, float]
    tolerances: HalfWidths | None
    spread: Spread | None
    draws: int
    notes: tuple[str, ...]

    def allowance(self, effect: Effect, objective: str, *, together: bool = False) -> float | None:
        """The change of a parameter that costs the loss; ``None`` where it costs nothing.

        Parameters
        ----------
        together
            Whether all parameters vary, each with an equal contribution: their root sum of squares
            is then the loss.

        Returns
        -------
        float or None
            In the unit of the parameter.
        """
        slope = effect.slope[objective]
        if not slope:
            return None
        costly = sum(1 for one in self.effects if one.slope[objective])
        return self.losses[objective] / abs(slope) / (np.sqrt(costly) if together else 1.0)

    def values_by_objective(self) -> dict[str, dict[str, Any]]:
        """Value, unit and meaning of each objective."""
        return {
            one.name: {"value": self.value[one.name]} | plain(one, "unit", "what", "better")
            for one in self.objectives
        }

    def entry(self, i: int) -> dict[str, Any]:
        """The i-th parameter: effects, and allowances and contributions where requested."""
        effect = self.effects[i]
        entry: dict[str, Any] = plain(effect.parameter, "name", "what", "unit")
        entry["effects"] = dict(effect.slope)
        if self.losses:
            entry["allowances"] = {
                name: {
                    "alone": self.allowance(effect, name),
                    "together": self.allowance(effect, name, together=True),
                }
                for name in self.losses
            }
        if self.spread is not None and self.tolerances is not None:
            shares = self.spread.drawn_share
            entry["tolerance"] = self.tolerances.of(effect.parameter)
            entry["contributions"] = {k: v[i] for k, v in self.spread.contribution.items()}
            entry["drawn_shares"] = {k: None if v is None else v[i] for k, v in shares.items()}
        return entry

    @property
    def sentences(self) -> tuple[str, ...]:
        """For each objective, the parameter with the largest effect, in words."""
        texts = []
        for objective in self.objectives:
            known = [
                (slope, one.parameter)
                for one in self.effects
                if (slope := one.slope[objective.name]) is not None
            ]
            if not known:
                continue
            slope, most = max(known, key=lambda pair: abs(pair[0]))
            unit = "" if objective.unit == "1" else f" {objective.unit}"
            texts.append(f"{objective.short} by {slope:+.2g}{unit} per {most.unit} of {most.name}")
        label = self.point.sensor.label
        return (f"The largest effects on {label} change {', '.join(texts)}.",) if texts else ()

    def to_table(self) -> Table:
        """One row per parameter: its effect per unit, and the budget where one was requested."""
        columns = [Column(name="parameter"), Column(name="change")]
        columns += [Column(name=one.name, unit=one.unit, digits=".3g") for one in self.objectives]
        for name, loss in self.losses.items():
            columns.append(Column(name=f"alone for {loss:g} of {name}", digits=".3g"))
            columns.append(Column(name=f"together for {loss:g} of {name}", digits=".3g"))
        spread = self.spread
        rows = [self._row(i, effect) for i, effect in enumerate(self.effects)]
        if spread is not None:
            blank = [None] * (len(columns) - 1)  # up to the tolerance
            columns.append(Column(name="tolerance", digits="g"))
            columns += [Column(name=f"spread of {name}", digits=".3g") for name in spread.total]
            rows.append(("root sum of squares", "", *blank, *spread.total.values()))
            if self.draws:
                drawn = f"drawn, {self.draws} sensors"
                rows.append((drawn, "", *blank, *spread.drawn.values()))
        return Table(
            title=f"Sensitivity of {self.point.sensor.label} at {conditions([self.point])}",
            columns=tuple(columns),
            rows=tuple(rows),
            notes=self.notes,
        )

    def _row(self, i: int, effect: Effect) -> tuple[Any, ...]:
        """The i-th parameter in `to_table`."""
        row: list[Any] = [effect.parameter.name, f"+1 {effect.parameter.unit}"]
        row += [effect.slope[one.name] for one in self.objectives]
        for name in self.losses:
            row += [self.allowance(effect, name), self.allowance(effect, name, together=True)]
        if self.spread is not None and self.tolerances is not None:
            row.append(self.tolerances.of(effect.parameter))
            row += [float(one[i]) for one in self.spread.contribution.values()]
        return tuple(row)

    def plot(self, ax: Any = None) -> Any:
        """Draw the effect of each parameter on the first objective as bars."""
        return from_above("design").draw_sensitivity(self, axes_of(ax))

    def __repr__(self) -> str:
        """The sensor and the parameter with the largest effect."""
        first, name = self.effects[0], self.objectives[0]
        slope = first.slope[name.name]
        text = "undefined" if slope is None else f"{slope:+.2g} {name.unit}"
        what = f"{first.parameter.name} {text} per {first.parameter.unit}"
        return f"<Sensitivity: {name.name} {what} at {conditions([self.point])}>"

    def _repr_html_(self) -> str:
        return self._html(f"At {conditions([self.point])}", self.notes)


def sensitivity_of(
    study: Study,
    *,
    given: Given = NOTHING_GIVEN,
    objectives: Sequence[str] = DEFAULT_OBJECTIVES,
    losses: Mapping[str, float] | None = None,
    tolerances: HalfWidths | None = None,
    draws: int = 0,
    seed: int = 0,
    keep_matrix: bool = False,
) -> Sensitivity:
    """Effects of all parameters of the sensor of a study on objectives, and tolerance budgets.

    Parameters
    ----------
    study
        With one sensor and one matrix. The exposure time stays that of the unchanged sensor.
    given
        Objects for names in the study.
    losses
        By objective, how much it may lose: the allowed change of each parameter is computed.
    tolerances
        Half widths: the spread of the objectives is computed.
    draws
        Sensors to draw within the tolerances, as a check of the first order; 0 for none.
    keep_matrix
        Whether a changed sensor keeps the color matrix of the unchanged one, as a camera that is
        not calibrated again; otherwise each has its own.

    Raises
    ------
    InputError
        If the study has several sensors or matrices, a name is unknown, a loss or a tolerance is
        out of range, there are draws without tolerances, or no objective is defined.

    Notes
    -----
    Central differences with a step of 0.1 nm or 0.1 %; one-sided where only one side is possible.
    Root sum of squares: JCGM 100:2008, 5.1.2 (independent parameters, first order). A uniform
    distribution of half width a has the standard deviation a / sqrt(3) (ibid., 4.3.7).
    """
    objectives = [check.one_of("objectives", name, tuple(OBJECTIVES)) for name in objectives]
    losses = {check.one_of("losses", name, objectives): one for name, one in (losses or {}).items()}
    refuse_several(study)
    _refuse_requests(objectives, losses, tolerances, draws)
    variation = Variation(study=study, given=given)
    ((matrix_name, maker),) = makers_of(study, given).items()
    point = variation.point
    kept = maker(point) if keep_matrix else None
    entries = tuple(OBJECTIVES[name] for name in objectives)

    def values(changes: Mapping[str, float]) -> Float[Array, " q"]:
        return _values(entries, variation.at(changes), maker, kept)

    def size(effect: Effect) -> float:
        width = tolerances.of(effect.parameter) if tolerances else 1.0
        return abs(effect.slope[entries[0].name] or 0.0) * width

    base = values({})
    value = {one.name: _finite(number) for one, number in zip(entries, base, strict=True)}
    notes = [*variation.notes, *_undefined(value)]
    effects = [_effect(entries, values, one, base) for one in variation.parameters]
    ordered = tuple(sorted(effects, key=size, reverse=True))
    spread = None
    if tolerances is not None:
        widths = np.array([tolerances.of(one.parameter) for one in ordered])
        spread = _spread(entries, ordered, widths, values, draws, seed)
        notes += [
            f"{count} of {draws} drawn sensors have no {name}: a channel saturates"
            for name, count in spread.undefined.items()
            if count
        ]
    return Sensitivity(
        point=point,
        matrix=matrix_name,
        keeps_matrix=keep_matrix,
        objectives=entries,
        value=value,
        effects=ordered,
        losses=losses,
        tolerances=tolerances,
        spread=spread,
        draws=draws,
        notes=tuple(notes),
    )


def _refuse_requests(
    objectives: Sequence[str],
    losses: Mapping[str, float],
    tolerances: HalfWidths | None,
    draws: int,
) -> None:
    check.distinct("objectives", objectives)
    if not objectives:
        raise InputError("objectives", "must name at least one", found="is empty")
    for name, loss in losses.items():
        check.positive(f"loss of {name}", OBJECTIVES[name].unit, loss)
    if draws and tolerances is None:
        raise InputError(
            "draws",
            "must be given only with tolerances",
            value=draws,
            remedy="give tolerance_nm or tolerance_percent",
        )
    if draws and not FEWEST_DRAWS <= draws <= MOST_DRAWS:
        raise InputError("draws", f"must be 0 or {FEWEST_DRAWS} to {MOST_DRAWS}", value=draws)


def _undefined(value: Mapping[str, float | None]) -> list[str]:
    """A note for each objective that is not defined; an error if none is defined."""
    names = [name for name, one in value.items() if one is None]
    if len(names) == len(value):
        raise InputError(
            "objectives",
            "must be defined at the operating point",
            value=tuple(value),
            found="none is: a channel saturates, or has no signal",
        )
    return [f"{name} is undefined here: a channel saturates, or has no signal" for name in names]


def _effect(
    entries: Sequence[Objective], values: Values, parameter: Varied, base: Float[Array, " q"]
) -> Effect:
    slopes = _slopes(values, parameter, base)
    slope = {one.name: _finite(number) for one, number in zip(entries, slopes, strict=True)}
    return Effect(parameter=parameter, slope=slope)


def _values(
    entries: Sequence[Objective],
    point: OperatingPoint,
    maker: MatrixMaker,
    kept: ColorMatrix | None,
) -> Float[Array, " q"]:
    candidate = Candidate(point=point, matrix=kept or maker(point), maker=maker)
    return np.array([value_of(one, candidate) for one in entries])


def _slopes(values: Values, parameter: Varied, base: Float[Array, " q"]) -> Float[Array, " q"]:
    """Central differences; one-sided where one side is not defined or not possible.

    NaN where neither is. A difference within the rounding of the values is 0.
    """

    def at(step: float) -> Float[Array, " q"]:
        try:
            return values({parameter.name: step})
        except InputError:  # the value is at the end of its range
            return np.full_like(base, np.nan)

    with np.errstate(invalid="ignore"):  # inf - inf
        sides = [at(STEP) - base]
        if not parameter.one_sided:
            sides.append(base - at(-STEP))
        both = np.stack(sides)
        both = np.where(np.abs(both) <= _ROUNDING * np.abs(base), 0.0, both)
    defined = np.isfinite(both)
    count = defined.sum(axis=0)
    total = np.where(defined, both, 0.0).sum(axis=0) / STEP
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _spread(
    entries: Sequence[Objective],
    effects: Sequence[Effect],
    widths: Float[Array, " d"],
    values: Values,
    draws: int,
    seed: int,
) -> Spread:
    parameters = [effect.parameter for effect in effects]
    columns: list[Array | None] = [None] * len(entries)
    amounts = np.empty((0, len(effects)))
    if draws:
        low = np.array([0.0 if one.one_sided else -1.0 for one in parameters])
        uniform = stream(seed).random((draws, len(effects)))
        amounts = (low + (1.0 - low) * uniform) * widths
        found = [
            values({one.name: float(x) for one, x in zip(parameters, row, strict=True) if x})
            for row in amounts
        ]
        columns = list(np.array(found).T)
    spreads = {}
    for one, column in zip(entries, columns, strict=True):
        slopes = np.abs([effect.slope[one.name] or 0.0 for effect in effects])
        contribution = slopes * widths / np.sqrt(3.0)
        spreads[one.name] = {
            "contribution": contribution,
            "total": float(np.sqrt((contribution**2).sum())),
            "worst": float(slopes @ widths),
        } | _drawn(amounts, column)
    names = [one.name for one in fields(Spread)]
    return Spread(**{name: {key: one[name] for key, one in spreads.items()} for name in names})


def _drawn(amounts: Float[Array, "draws d"], column: Array | None) -> dict[str, Any]:
    """Spread of an objective of drawn sensors, and its linear regression on their parameters."""
    found: dict[str, Any] = {"drawn": None, "drawn_share": None, "explained": None, "undefined": 0}
    if column is None:
        return found
    defined = np.isfinite(column)
    found["undefined"] = int((~defined).sum())
    column, amounts = column[defined], amounts[defined]
    if column.size < FEWEST_DRAWS:
        return found
    found["drawn"] = float(column.std(ddof=1))
    if found["drawn"] and column.size > amounts.shape[1] + 1:
        centered, variance = amounts - amounts.mean(axis=0), column.var()
        fit = lstsq("tolerances", centered, column - column.mean(), rcond=None)[0]
        found["drawn_share"] = fit**2 * centered.var(axis=0) / variance
        found["explained"] = float((centered @ fit).var() / variance)
    return found


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
