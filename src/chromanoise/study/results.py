"""The results of the steps of a study: analyses, matrices, comparisons and pictures.

Each result can be converted to plain data (`to_dict`, as the JSON of the commands), a table, a
pandas data frame, LaTeX and a figure. Its keys in JSON are its ``KEYS``. The further outputs of an
analysis are registered in ``OUTPUTS``.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np

from chromanoise.base import (
    LIST,
    VERSION,
    Array,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    Setting,
    check,
    dataclass,
    warn_of_old_name,
    with_short_repr,
    write_whole,
)
from chromanoise.color import SPACES, UNBOUNDED, ColorMatrix, ParetoCurve
from chromanoise.io import (
    Entry,
    MadeMatrix,
    Result,
    Table,
    axes_of,
    figures,
    matrix_writer,
    number_text,
    panels_of,
    table_of,
)
from chromanoise.metrics import MatrixReport
from chromanoise.noise import (
    DEFAULT_RULE,
    OperatingPoint,
    clipping_readout,
    conditions,
    patch_scene,
)
from chromanoise.spectra import Illuminant, Spectra, observer_notes
from chromanoise.study.analysis import (
    Analysis,
    analyzed,
    color_snr_db,
    contravariant_snr_db,
    diagnosis,
    mean_color_error,
    of_white,
    raw_snr_db,
    reflectance_notes,
    temporal_color_snr_db,
    temporal_raw_snr_db,
)
from chromanoise.study.assembly import keyed
from chromanoise.study.camera_league import League
from chromanoise.study.camera_pipeline import GainStep, PipelineNoise, pipeline_noise
from chromanoise.study.color_matrices import DEFAULT_PRIOR, MatrixMaker
from chromanoise.study.color_noise import (
    CHART_KEYS,
    ChartNoise,
    GrayNoise,
    chart_noise,
    color_budgets,
    contravariant_budgets,
    find_budgets,
    gray_noise,
    lab_budgets,
    mean_total_error,
    total_errors_of,
    visual_noise_of,
    white_snr_db,
)
from chromanoise.study.equal_color_sweeps import EqualColorRange, range_sentences
from chromanoise.study.maps import (
    BestCell,
    CrossoverLine,
    QuantityMap,
    best_cell_sentences,
    best_cells,
    best_of,
)
from chromanoise.study.merits import Merits, merits_of
from chromanoise.study.ranking import (
    MOST_PAIRS_SENSORS,
    Crossover,
    CrossoverBand,
    Lead,
    Optimum,
    Rank,
    crossover_sentence,
    lead_changes,
    lead_sentences,
    leading_crossovers,
    matrix_sentences,
    optima_sentences,
    ranked,
)
from chromanoise.study.reading_quality import MachineReading, machine_reading
from chromanoise.study.schema import OutputsPart, Study, pipeline_settings
from chromanoise.study.sweeps import Curve, SweptQuantity, by_matrix
from chromanoise.study.trade_offs import MOST_CHECKED, Verdict

if TYPE_CHECKING:
    from chromanoise.imaging import Capture


def ranking_of_analyses(analyses: Sequence[Analysis]) -> tuple[Rank, ...]:
    """The sensors from highest to lowest SNR of Y."""
    found = [(one.sensor.name, one.sensor.label, color_snr_db(one)["Y"]) for one in analyses]
    return ranked(
        [(name, label, math.nan if snr is None else snr) for name, label, snr in found],
        matrix=analyses[0].matrix.made_by,
        more_is_better=True,
    )


def _entry(place: int) -> Callable[[Any], Entry]:
    """The cell of a row that is a tuple."""
    return lambda row: row[place]


def _key(name: str) -> Callable[[Any], Entry]:
    """The cell of a row that ends in a mapping; none where that has no such key."""
    return lambda row: row[-1].get(name)


def analyses_as_table(analyses: Sequence[Analysis]) -> Table:
    """One row per sensor: exposure, SNR of color, best linear SNR, loss, condition, color error.

    Raises
    ------
    InputError
        If their color coordinates differ.
    """
    axes = analyses[0].color.names
    for analysis in analyses:
        check.same_names("a table of analyses", first=axes, other=analysis.color.names)

    def snr_db(axis: str, analysis: Analysis) -> float | None:
        return color_snr_db(analysis)[axis]

    return table_of(
        "SNR of color",
        analyses,
        ("sensor", "", "", lambda one: one.sensor.label),
        ("time", "ms", ".4g", lambda one: 1e3 * one.exposure.time_s),
        *((f"SNR {axis}", "dB", ".1f", partial(snr_db, axis)) for axis in axes),
        ("bound", "dB", ".1f", lambda one: one.optimal_linear_snr_db),
        ("color SNR loss", "dB", ".1f", lambda one: one.color_snr_loss_db),
        ("condition of channels", "", ".4g", lambda one: one.matrix.frame.condition),
        ("color error", "Delta E*ab", ".2f", mean_color_error),
        ("visual noise", "CIELUV", ".3g", visual_noise_of),
        notes=(note for one in analyses for note in one.sensor.notes),
    )


def _sds(one: GainStep, with_raw: bool) -> list[list[float]]:
    """The numbers of each patch, in the order of the columns."""
    steps = [(one.steps[0], 1.0)] if with_raw else []
    steps += [(step, 255.0) for step in one.steps[-3:-1]] + [(one.steps[-1], 1.0)]
    blocks = [factor * np.sqrt(step.measurement.variance) for step, factor in steps]
    rows: list[list[float]] = np.hstack(blocks).tolist()
    return rows


def matrices_as_table(results: "Sequence[MatrixResult]") -> Table:
    """Color matrices, one row per coordinate; error, condition and SNR are in the notes.

    Parameters
    ----------
    results
        Of several sensors there is a column with the names; a channel that only other sensors have
        is an empty cell.
    """
    several = len(results) > 1
    names = ", ".join(one.point.sensor.label for one in results)
    channels = dict.fromkeys(channel for one in results for channel in one.matrix.channels)
    rows = [
        (one.point.sensor.label, coordinate, dict(zip(one.matrix.channels, weights, strict=True)))
        for one in results
        for coordinate, weights in zip(
            one.matrix.coordinates, one.matrix.matrix.tolist(), strict=True
        )
    ]
    sensor = [("sensor", "", "", _entry(0))] if several else []
    return table_of(
        f"Color matrix of {names}: {results[0].report.made_by}",
        rows,
        *sensor,
        ("coordinate", "", "", _entry(1)),
        *((channel, "lx/e-", ".6g", _key(channel)) for channel in channels),
        notes=(
            f"{one.point.sensor.label}: {note}" if several else note
            for one in results
            for note in _notes_of(one.report)
        ),
    )


def _notes_of(report: MatrixReport) -> list[str]:
    none = "not defined"
    error = number_text(report.color_error_mean, ".4g", none)
    return [
        f"mean color error without noise {error} Delta E*ab over {report.chart}",
        f"condition of the matrix {number_text(report.condition, '.4g', none)}",
        *(
            f"SNR {name} of {report.patch} {number_text(snr, '.2f', none)} dB"
            for name, snr in (report.snr_db or {}).items()
        ),
    ]


def curves_as_table(curves: Sequence[Curve]) -> Table:
    """A comparison: one row per value of the sweep, two columns per sensor and matrix."""
    first = curves[0]
    columns = [(first.sweep.what, first.sweep.unit, ".4g", first.at)]
    for one in curves:
        who = f"{one.label}, {one.matrix}"
        quantity = one.quantity
        columns += [
            (f"{who}: {quantity.what}", quantity.unit, ".4g", one.value),
            (f"{who}: color error", "Delta E*ab", ".2f", one.color_error),
        ]
    return table_of(
        f"{first.quantity.what} over {first.over}",
        range(first.at.size),
        *((name, unit, digits, values.item) for name, unit, digits, values in columns),
    )


SENSOR_KEYS: JsonKeys = (
    JsonKey("name", "sensor.name"),
    JsonKey("label", "sensor.label"),
    JsonKey("time_ms", "exposure.time_s", factor=1e3),
    JsonKey("f_number", "exposure.f_number"),
    JsonKey(
        "channels",
        ".",
        rows=True,
        keys=(
            JsonKey("name", "sensor.names"),
            JsonKey("mean_e", "raw.mean"),
            JsonKey("snr_db", raw_snr_db),
            JsonKey("temporal_snr_db", temporal_raw_snr_db),
            JsonKey("contravariant_snr_db", contravariant_snr_db),
            *("vif", "saturated", "full_share"),
            JsonKey("angle_deg", "between_deg", by=("sensor.names",)),
            JsonKey("angle_to_axis_deg", "to_axes_deg", by=(("x", "y", "z"),)),
        ),
    ),
    "spectral_snr_db",
    JsonKey(
        "color",
        ".",
        keys=(
            JsonKey("snr_db", color_snr_db),
            JsonKey("temporal_snr_db", temporal_color_snr_db),
            JsonKey("visual_noise", visual_noise_of),
            JsonKey("total_error_delta_e", mean_total_error),
            JsonKey("mean_lux", "color.mean", by=("color.names",)),
            JsonKey("covariance_lux2", "color.covariance"),
        ),
    ),
    JsonKey("bound_db", "optimal_linear_snr_db"),
    JsonKey("price_db", "color_snr_loss_db"),
    JsonKey("condition", "matrix.frame.condition"),
    JsonKey("rank", "matrix.frame.rank"),
    JsonKey("nearest_mix", "mix"),
    JsonKey("matrix", "matrix.matrix"),
    JsonKey("matrix_made_by", "matrix.made_by"),
    JsonKey("matrix_unit", lambda _: "lx/e-", text="Unit of the matrix."),
    JsonKey("color_error_mean", mean_color_error),
    JsonKey("notes", diagnosis),
)
"""Of one sensor in the JSON of an analysis."""


BUDGET_KEYS: JsonKeys = (
    JsonKey("budget", color_budgets),
    JsonKey("contravariant_budget", contravariant_budgets),
    JsonKey("lab_budget", lab_budgets),
)
"""The budgets of an analysis; ``None`` where a coordinate has none."""


@dataclass(frozen=True, kw_only=True)
class Output:
    """A further output of a study for each sensor.

    Attributes
    ----------
    asked
        Whether the outputs of a study ask for it.
    keys
        Of a sensor in JSON, from its `Outcome`.
    of
        The value of the field of `Outcome` with its name: of an analysis, its matrix maker, the
        outputs of the study and the light of the white balance. ``None`` if it has no field.
    """

    asked: Callable[[OutputsPart], bool]
    keys: JsonKeys
    of: "Callable[[Analysis, MatrixMaker, OutputsPart, Illuminant | None], Any] | None" = None


def _gray_noise(analysis: Analysis, _: Any, outputs: OutputsPart, __: Any) -> GrayNoise | None:
    return gray_noise(analysis, SPACES[str(outputs.space)], readout=analysis.readout)


def _chart(analysis: Analysis, *_: Any) -> ChartNoise | None:
    return chart_noise(analysis, readout=analysis.readout or UNBOUNDED)


def _merits(analysis: Analysis, maker: MatrixMaker, *_: Any) -> Merits:
    return merits_of(of_white(analysis), maker=maker)


def _pipeline(
    analysis: Analysis, _: Any, outputs: OutputsPart, light: Illuminant | None
) -> PipelineNoise | None:
    key = "outputs.pipeline"
    own = {name: f"{key}.{name}" for name in type(outputs.pipeline).model_fields}
    with keyed(f"{key}.white_balance", lambda name: f"{key}.{name}", own):
        settings = pipeline_settings(outputs.pipeline, light)
        return pipeline_noise(analysis, settings, readout=analysis.readout)


OUTPUTS: Mapping[str, Output] = {
    "budget": Output(
        asked=lambda outputs: outputs.budget,
        keys=(JsonKey("", "analysis", keys=BUDGET_KEYS),),
    ),
    "gray_noise": Output(
        asked=lambda outputs: outputs.space is not None,
        keys=(
            "gray_noise",
            JsonKey("grey_noise", "gray_noise", is_old=True),
        ),  # the old key, in this release only
        of=_gray_noise,
    ),
    "chart": Output(
        asked=lambda outputs: outputs.chart,
        keys=(JsonKey("chart", rows=True, keys=CHART_KEYS),),
        of=_chart,
    ),
    "merits": Output(asked=lambda outputs: outputs.merit, keys=("merits",), of=_merits),
    "pipeline": Output(
        asked=lambda outputs: outputs.pipeline.run, keys=("pipeline",), of=_pipeline
    ),
    "machine": Output(
        asked=lambda outputs: outputs.reader == "machine",
        keys=(JsonKey("", "machine"),),
        of=lambda analysis, *_: machine_reading(analysis),
    ),
}
"""By the name of the field of `Outcome`, in the order of computation and of the JSON."""


def _asked_keys(name: str, output: Output) -> JsonKey:
    return JsonKey("", ".", keys=output.keys, when=lambda outcome: name in outcome.asked)


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Outcome:
    """Every stage of one sensor, and the further outputs of the study.

    Attributes
    ----------
    analysis
        Raw, spectral and color coordinates of a perfect white.
    asked
        Names of the further outputs that the study asks for, of ``OUTPUTS``.
    gray_noise, chart
        ``None`` where not asked for, or where a channel is saturated or white is no color.
    merits
        ``None`` where not asked for.
    pipeline
        As ``gray_noise``.
    machine
        ``None`` for an eye.
    """

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("", "analysis", keys=SENSOR_KEYS),
        *(_asked_keys(name, output) for name, output in OUTPUTS.items()),
    )

    analysis: Analysis
    asked: tuple[str, ...]
    gray_noise: GrayNoise | None = None
    chart: ChartNoise | None = None
    merits: Merits | None = None
    pipeline: PipelineNoise | None = None
    machine: MachineReading | None = None

    @property
    def grey_noise(self) -> GrayNoise | None:
        """The old name of ``gray_noise``."""
        warn_of_old_name("grey_noise", "gray_noise")
        return self.gray_noise


def analysis_of(
    operating_point: OperatingPoint, maker: MatrixMaker, outputs: OutputsPart
) -> Analysis:
    """Every stage of a sensor for the patch, by default a perfect white.

    Clipped where the outputs ask for it.

    Results and charts of a study use this function, so that they show the same numbers.

    Parameters
    ----------
    operating_point, maker, outputs
        As `outcome_of`.

    Raises
    ------
    InputError
        If the matrix cannot be made.
    """
    sensor = operating_point.sensor
    clipping = clipping_readout(sensor, operating_point.exposure) if outputs.clip else None
    analysis = analyzed(
        patch_scene(operating_point),
        sensor,
        operating_point.exposure,
        readout=clipping,
        matrix=maker(operating_point),
    )
    point = operating_point
    return replace(analysis, chart=point.chart, patch=point.patch, pairs=point.pairs)


def outcome_of(
    operating_point: OperatingPoint,
    maker: MatrixMaker,
    outputs: OutputsPart,
    *,
    balance_light: Illuminant | None = None,
) -> Outcome:
    """Compute all requested results of a sensor at one operating point.

    Parameters
    ----------
    operating_point
        Sensor, exposure and light.
    maker
        Of its color matrix.
    balance_light
        The illuminant that the white balance of the pipeline names (``balance_light_of``).

    Raises
    ------
    InputError
        If the matrix cannot be made, or an output cannot be computed.
    """
    analysis = analysis_of(operating_point, maker, outputs)
    asked = tuple(name for name, output in OUTPUTS.items() if output.asked(outputs))
    found = {
        name: of(analysis, maker, outputs, balance_light)
        for name in asked
        if (of := OUTPUTS[name].of) is not None
    }
    return Outcome(analysis=analysis, asked=asked, **found)


Kind = TypeVar("Kind", bound="Result")


@dataclass(frozen=True, kw_only=True, eq=False)
class Analyses(Result):
    """The analysis of each sensor with one color matrix.

    Attributes
    ----------
    matrix
        Name of the matrix method.
    points
        Operating point of each sensor.
    outcomes
        Per sensor: stages, chart, figures of merit, noise in a color space.
    outputs
        What the study asks for.
    prior
        The training set of the comparison at equal color error.
    equal
        The exposure rule, from `chromanoise.noise.EQUAL_TERMS`.
    """

    KEYS: ClassVar[JsonKeys] = (
        VERSION,
        JsonKey("metric", "analyses.0.matrix.metric"),
        JsonKey("illuminant", "analyses.0.scene.illuminant.name"),
        JsonKey("level_lux", "analyses.0.scene.level_lux"),
        JsonKey("observer", "analyses.0.matrix.observer"),
        JsonKey("sensors", "outcomes"),
        JsonKey("verdict", when="is_comparison"),
        "ranking",
        JsonKey("reader", "outputs.reader", when="outcomes.0.machine", text="``machine``."),
    )

    matrix: str
    points: tuple[OperatingPoint, ...]
    outcomes: tuple[Outcome, ...]
    outputs: OutputsPart
    prior: str | Spectra = DEFAULT_PRIOR
    equal: str = DEFAULT_RULE

    def to_dict(self) -> dict[str, Any]:
        """As that of each result."""
        total_errors_of(self.analyses)  # of all sensors at once, in a fraction of the time
        if OUTPUTS["budget"].asked(self.outputs):
            find_budgets(self.analyses)
        return super().to_dict()

    @property
    def analyses(self) -> tuple[Analysis, ...]:
        """The stages of each sensor."""
        return tuple(outcome.analysis for outcome in self.outcomes)

    @property
    def ranking(self) -> tuple[Rank, ...]:
        """The sensors from highest to lowest SNR of Y."""
        return ranking_of_analyses(self.analyses)

    @property
    def is_comparison(self) -> bool:
        """Whether there are sensors to compare."""
        return len(self.points) > 1

    @property
    def verdict(self) -> Verdict:
        """The best sensor for the reader, by how much, and why."""
        found: Verdict = figures().verdict_of(
            self.analyses, equal=self.equal, reader=self.outputs.reader, prior=self.prior
        )
        return found

    def raw_snr_db(self) -> dict[str, dict[str, float | None]]:
        """Raw SNR by sensor and channel (eq. 7); ``None`` where it is not defined. [dB]"""
        return {one.sensor.name: raw_snr_db(one) for one in self.analyses}

    def contravariant_snr_db(self) -> dict[str, dict[str, float | None]]:
        """Contravariant SNR by sensor and channel (eq. 3); ``None`` where undefined. [dB]"""
        return {one.sensor.name: contravariant_snr_db(one) for one in self.analyses}

    def color_snr_db(self) -> dict[str, dict[str, float | None]]:
        """SNR of X, Y and Z by sensor (eq. 5); ``None`` where it is not defined. [dB]"""
        return {one.sensor.name: color_snr_db(one) for one in self.analyses}

    def to_table(self) -> Table:
        """One row per sensor."""
        return analyses_as_table(self.analyses)

    def pipeline_table(self) -> Table:
        """One row per sensor, ISO and patch: standard deviations after the camera's pipeline.

        Raw channels (e-) are columns where all sensors have the same; encoded sRGB and Y'CbCr are
        in 1/255, CIELAB is that of the picture, relative to D65.

        Raises
        ------
        InputError
            If the pipeline was not requested, or no sensor has a color.
        """
        found = {one.analysis.sensor.label: one.pipeline for one in self.outcomes}
        able = {name: one for name, one in found.items() if one is not None}
        if not able:
            raise InputError(
                "analyses", "must hold at least one with a pipeline for its table", value=(*found,)
            )
        raw, *_, encoded, luma, lab = next(iter(able.values())).steps
        with_raw = len({one.channels for one in able.values()}) == 1
        columns = [
            *((f"raw {name}", "e-", ".2f") for name in raw.measurement.names if with_raw),
            *((name, "1/255", ".2f") for one in (encoded, luma) for name in one.measurement.names),
            *((name, "", ".2f") for name in lab.measurement.names),
        ]
        rows = [
            (name, one.iso, patch, *values)
            for name, noise in able.items()
            for one in noise.iso
            for patch, values in zip(noise.patches, _sds(one, with_raw), strict=True)
        ]
        heads = [("sensor", "", ""), ("ISO", "", ".4g"), ("patch", "", ""), *columns]
        cells = [(*head, _entry(place)) for place, head in enumerate(heads)]
        return table_of("Pipeline, standard deviations", rows, *cells)

    def plot(self, ax: Any = None, kind: str = "losses") -> Any:
        """Draw the SNR losses from all photons to Y of each sensor [dB], or another chart.

        Parameters
        ----------
        ax
            Axes of matplotlib, for all but ``losses`` one per sensor; ``None`` for those of a new
            figure.
        kind
            ``losses`` of all sensors on one axes; with a panel per sensor ``budget`` (waterfall of
            the SNR of Y), ``ellipses`` (noise of the patches in a* and b*) or ``flow`` (SNR from
            stage to stage).

        Returns
        -------
        Axes, or a list of one per sensor

        Raises
        ------
        InputError
            If there is no such chart, or the number of axes is another.
        """
        check.one_of("kind", kind, ("losses", "budget", "ellipses", "flow"))
        if kind == "losses":
            return figures().draw_analyses(self.analyses, axes_of(ax))
        columns = 3 if kind == "ellipses" else 1
        axes = panels_of(ax, len(self.analyses), columns=columns)
        return figures().draw_panels(self.analyses, kind, axes)

    def __repr__(self) -> str:
        """Sensors, SNR of Y and the operating point."""
        snr = {one.sensor.label: color_snr_db(one)["Y"] for one in self.analyses}
        text = ", ".join(
            f"{label} {'undefined' if y is None else f'{y:.1f} dB'}" for label, y in snr.items()
        )
        return f"<Analyses: SNR Y {text} at {conditions(self.points)}>"

    def _repr_html_(self) -> str:
        return self._html(f"At {conditions(self.points)}")


@dataclass(frozen=True, kw_only=True, eq=False)
class MatrixResult(Result):
    """One color matrix of one sensor.

    Attributes
    ----------
    point
        Operating point of the sensor.
    matrix
        Electrons to XYZ. [lx/e-]
    report
        Color error, noise, condition.
    white_e
        Expected electrons of a perfect white. [e-]
    pareto
        The curve of color error against noise; ``None`` if not requested.
    """

    KEYS: ClassVar[JsonKeys] = (
        VERSION,
        JsonKey("sensor", "point.sensor.name"),
        JsonKey("label", "point.sensor.label"),
        JsonKey("illuminant", "point.illuminant.name"),
        JsonKey("level_lux", "point.level_lux"),
        JsonKey("observer", "matrix.observer"),
        JsonKey("time_ms", "point.exposure.time_s", factor=1e3),
        JsonKey(
            "matrix",
            keys=(
                *("made_by", "metric", "channels", "coordinates"),
                JsonKey("lux_per_e", "matrix"),
            ),
        ),
        "report",
        JsonKey(
            "pareto",
            rows=True,
            keys=(
                "weight",
                JsonKey("color_error_rms_lux", "color_error_rms"),
                "delta_e",
                JsonKey("noise_rms_lux", "noise_rms"),
                JsonKey("snr_y_db", "pareto_snr_y_db"),
                JsonKey("lux_per_e", "matrix"),
            ),
        ),
        "notes",
    )

    point: OperatingPoint
    matrix: ColorMatrix
    report: MatrixReport
    white_e: Float[Array, " p"]
    pareto: ParetoCurve | None

    @property
    def white_lux(self) -> float:
        """Y of a perfect white by this matrix. [lx]"""
        return float(self.matrix.matrix[1] @ self.white_e)

    @property
    def pareto_snr_y_db(self) -> tuple[float | None, ...]:
        """SNR of Y along the Pareto curve; ``None`` where a channel is saturated. [dB]"""
        return () if self.pareto is None else white_snr_db(self.pareto, self.report)

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks on sensor, light, observer and reflectances."""
        return (
            *self.point.sensor.notes,
            *self.point.illuminant.notes,
            *observer_notes(self.matrix.observer),
            *reflectance_notes(self.point),
        )

    @property
    def made(self) -> MadeMatrix:
        """The matrix with the conditions for which it was made, as files store it."""
        point = self.point
        sensor, lamp = point.sensor, point.illuminant
        return MadeMatrix(
            sensor=sensor.name,
            illuminant=lamp.name,
            level_lux=point.level_lux,
            time_s=point.exposure.time_s,
            f_number=point.exposure.f_number,
            pitch_um=sensor.pixel.pitch_um,
            matrix=self.matrix,
            white_e=self.white_e,
            white_lux=self.white_lux,
            notes=(*sensor.notes, *lamp.notes),
        )

    def export(self, path: str | Path) -> Path:
        """Write the matrix for other programs, as ``chromanoise matrix --export``.

        Parameters
        ----------
        path
            File that ends in ``.csv``, ``.json``, ``.clf`` (Common LUT Format 3 of the Academy,
            S-2014-006) or ``.dcp.json`` (names of camera profiles).

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            If the file has another ending or cannot be written, or the sensor does not have the
            three channels that the format demands.
        """
        path = Path(path)
        write_whole(path, matrix_writer(path.name)(self.made).encode())
        return path

    def to_table(self) -> Table:
        """One row per coordinate."""
        return matrices_as_table([self])

    def plot(self, ax: Any = None) -> Any:
        """Draw color error against noise if that curve was requested, else the matrix as bars."""
        return figures().draw_matrices([self], axes_of(ax))

    def __repr__(self) -> str:
        """Method, sensor and color error."""
        text = f"{self.report.made_by}, {_color_error_text(self)}"
        return f"<MatrixResult: {text} at {conditions([self.point])}>"

    def _repr_html_(self) -> str:
        return self._html(f"{self.report.made_by} at {conditions([self.point])}")


def _matrix_sentence(one: MatrixResult) -> str:
    report = one.report
    snr = None if report.snr_db is None else report.snr_db.get("Y")
    noise = "no SNR of Y" if snr is None else f"an SNR of Y of {snr:.2f} dB"
    error = number_text(report.color_error_mean, none="undefined")
    return (
        f"With the matrix {report.made_by}, {one.point.sensor.label} has a mean color error of "
        f"{error} Delta E*ab over {report.chart} and {noise} on {report.patch}."
    )


def _color_error_text(one: MatrixResult) -> str:
    error = number_text(one.report.color_error_mean, none="undefined")
    return f"{one.point.sensor.label} {error} Delta E*ab"


@dataclass(frozen=True, kw_only=True, eq=False)
class Matrices(Result):
    """The color matrix of each sensor, by one method.

    Attributes
    ----------
    method
        Name of the method.
    """

    KEYS: ClassVar[JsonKeys] = (JsonKey("sensors", "results"), "sentences")

    method: str
    results: tuple[MatrixResult, ...]

    @property
    def sentences(self) -> list[str]:
        """Of each sensor the mean color error with the matrix, and the SNR of Y."""
        return [_matrix_sentence(one) for one in self.results]

    def to_table(self) -> Table:
        """One row per coordinate; of several sensors, per sensor and coordinate."""
        return matrices_as_table(self.results)

    def plot(self, ax: Any = None) -> Any:
        """Draw color error against noise if that curve was requested, else the matrix as bars."""
        return figures().draw_matrices(self.results, axes_of(ax))

    def __repr__(self) -> str:
        """Method, sensors and color error."""
        text = ", ".join(map(_color_error_text, self.results))
        points = [one.point for one in self.results]
        return f"<Matrices: {self.method}, {text} at {conditions(points)}>"

    def _repr_html_(self) -> str:
        return self._html(f"{self.method} at {conditions([one.point for one in self.results])}")


def _subject(swept: Sequence[SweptQuantity]) -> str:
    names = ", ".join(dict.fromkeys(one.label for one in swept))
    return f"{swept[0].quantity.what} of {names} over {swept[0].over}"


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison(Result):
    """A quantity of all sensors as a function of one parameter.

    Attributes
    ----------
    points
        Operating point of each sensor before the sweep.
    curves, crossovers, bands
        Per sensor and matrix; per pair of sensors, of more than 60 only those that follow each
        other as the best; over all priors, if requested.
    ranking
        The sensors from best to worst at their operating points, per matrix.
    leads
        Where which sensor is the best of all, per matrix.
    optima
        At which value of the sweep each sensor is best, per matrix, and between which values.
    equal_color
        Ranges of the sweep, each with the sensor of least visual noise at equal color error.
    equal, prior
        The exposure rule, and the training set of trained matrices.
    """

    KEYS: ClassVar[JsonKeys] = (
        VERSION,
        JsonKey("sweep", "curves.0", keys=(JsonKey("", "sweep"), JsonKey("values", "at"))),
        JsonKey("quantity", "curves.0.quantity"),
        *("curves", "crossovers"),
        JsonKey("observer", "points.0.observer"),
        *("equal", "prior", "bands", "ranking", "leads", "optima", "equal_color"),
        JsonKey("sentences", "shown_sentences"),
    )
    OF_QUANTITY: ClassVar[tuple[str, ...]] = ("curves", LIST, "value")  # the key of the quantity

    points: tuple[OperatingPoint, ...]
    curves: tuple[Curve, ...]
    crossovers: tuple[Crossover, ...]
    bands: tuple[CrossoverBand, ...]
    ranking: tuple[Rank, ...]
    leads: tuple[Lead, ...]
    optima: tuple[Optimum, ...]
    equal_color: tuple[EqualColorRange, ...]
    equal: str
    prior: str

    @property
    def _many(self) -> bool:
        return len(self.points) > MOST_PAIRS_SENSORS

    def to_table(self) -> Table:
        """One row per value of the sweep, two columns per sensor and matrix."""
        return curves_as_table(self.curves)

    @property
    def shown_crossovers(self) -> tuple[Crossover, ...]:
        """Of up to three sensors, all crossovers; of more, those at which the leader changes."""
        return leading_crossovers(self.leads, self.crossovers) if self._many else self.crossovers

    @property
    def shown_bands(self) -> tuple[CrossoverBand, ...]:
        """The bands of the pairs of `shown_crossovers`; of up to three sensors, all."""
        if not self._many:
            return self.bands
        pairs = {(one.first, one.second, one.matrix) for one in self.shown_crossovers}
        return tuple(one for one in self.bands if (one.first, one.second, one.matrix) in pairs)

    @property
    def shown_sentences(self) -> list[str]:
        """Which sensor leads at equal color error, the optimum of each sensor, `shown_crossovers`.

        Of up to three sensors, the matrices of each if several; of more, the leaders.
        """
        if self._many:
            first = lead_sentences(self.leads)
        else:
            first = matrix_sentences(self.ranking, self.curves[0].quantity)
        best = optima_sentences(self.optima)
        crossed = [crossover_sentence(one) for one in self.shown_crossovers]
        left_out = []
        if len(self.points) > MOST_CHECKED and not self.curves[0].quantity.of_raw:
            what = f"At most {MOST_CHECKED} sensors are compared at equal color error over"
            left_out = [f"{what} {self.curves[0].sweep.what}."]
        return [*range_sentences(self.equal_color), *best, *first, *crossed, *left_out]

    def plot(self, ax: Any = None) -> Any:
        """Draw the quantity over the parameter, one curve per sensor and matrix."""
        title = f"{self.curves[0].quantity.what}, from {conditions(self.points)}"
        crossed = lead_changes(self.leads, self.crossovers) if self._many else self.crossovers
        return figures().draw_comparison(self.curves, axes_of(ax), crossovers=crossed, title=title)

    def __repr__(self) -> str:
        """The quantity, the parameter and the operating point."""
        return f"<Comparison: {_subject(self.curves)}, from {conditions(self.points)}>"

    def _repr_html_(self) -> str:
        return self._html(f"From {conditions(self.points)}", self.shown_sentences)


@dataclass(frozen=True, kw_only=True, eq=False)
class ComparisonMap(Result):
    """A quantity of all sensors as a function of two parameters.

    Attributes
    ----------
    points
        Operating point of each sensor before the sweeps.
    maps, lines
        The values per sensor and matrix; of up to three sensors, where each pair changes places.
    ranking
        The sensors from best to worst at their operating points, per matrix.
    equal, prior
        The exposure rule, and the training set of trained matrices.
    """

    KEYS: ClassVar[JsonKeys] = (
        VERSION,
        JsonKey("sweep", "maps.0", keys=(JsonKey("", "sweep"), JsonKey("values", "at"))),
        JsonKey("second", "maps.0", keys=(JsonKey("", "second"), JsonKey("values", "second_at"))),
        JsonKey("quantity", "maps.0.quantity"),
        *("maps", "best"),
        JsonKey("crossovers", "lines"),
        *("equal", "prior", "ranking", "optima"),
        JsonKey("sentences", "shown_sentences"),
    )
    OF_QUANTITY: ClassVar[tuple[str, ...]] = ("maps", LIST, "value")

    points: tuple[OperatingPoint, ...]
    maps: tuple[QuantityMap, ...]
    lines: tuple[CrossoverLine, ...]
    ranking: tuple[Rank, ...]
    equal: str
    prior: str

    @property
    def best(self) -> dict[str, list[list[str | None]]]:
        """The best sensor at each pair of values, per matrix; ``None`` where none has a value."""
        return {
            name: [
                [None if i < 0 else mine[i].sensor for i in row] for row in best_of(mine).tolist()
            ]
            for name, mine in by_matrix(self.maps).items()
        }

    @property
    def optima(self) -> tuple[BestCell, ...]:
        """The pair of values at which each sensor is best, per matrix."""
        return best_cells(self.maps)

    @property
    def shown_sentences(self) -> list[str]:
        """The best pair of values of each sensor."""
        return best_cell_sentences(self.optima)

    def to_table(self) -> Table:
        """One row per pair of values; a column per sensor and matrix, and the best per matrix."""
        first = self.maps[0]

        def leader(mine: Sequence[QuantityMap]) -> Callable[[tuple[int, int]], Entry]:
            best = best_of(mine)
            return lambda at: None if best[at] < 0 else mine[best[at]].label

        return table_of(
            f"{first.quantity.what} over {first.over}",
            product(range(first.second_at.size), range(first.at.size)),
            (first.second.what, first.second.unit, ".4g", lambda at: first.second_at[at[0]]),
            (first.sweep.what, first.sweep.unit, ".4g", lambda at: first.at[at[1]]),
            *(
                (
                    f"{one.label}, {one.matrix}: {one.quantity.what}",
                    one.quantity.unit,
                    ".4g",
                    one.value.__getitem__,
                )
                for one in self.maps
            ),
            *(
                (f"best, {name}", "", "", leader(mine))
                for name, mine in by_matrix(self.maps).items()
            ),
        )

    def plot(self, ax: Any = None) -> Any:
        """Draw a heat map with the first matrix.

        Of one sensor the quantity; of two their difference, with the line where they are equal;
        of more the best sensor.
        """
        title = f"{self.maps[0].quantity.what}, from {conditions(self.points)}"
        return figures().draw_maps(self.maps, axes_of(ax), lines=self.lines, title=title)

    def __repr__(self) -> str:
        """The quantity, the parameters and the operating point."""
        return f"<ComparisonMap: {_subject(self.maps)}, from {conditions(self.points)}>"

    def _repr_html_(self) -> str:
        return self._html(f"From {conditions(self.points)}", self.shown_sentences)


@dataclass(frozen=True, kw_only=True, eq=False)
class Pictures(Result):
    """The pictures of one cube.

    Attributes
    ----------
    cube
        Its name in the study.
    points
        Operating point of each sensor.
    summaries
        Settings and statistics of each picture as plain data; its files, if a folder was given.
    captures
        The pictures, if no folder was given.
    """

    KEYS: ClassVar[JsonKeys] = (VERSION, "cube", JsonKey("pictures", "summaries"))

    cube: str
    points: tuple[OperatingPoint, ...]
    summaries: tuple[dict[str, Any], ...]
    captures: "tuple[Capture, ...]" = ()

    def to_table(self) -> Table:
        """One row per picture and channel: mean electrons, and the share of pixels above full well.

        The share is of all pixels of the channel.
        """
        return table_of(
            f"Pictures of {self.cube}",
            [(one, channel) for one in self.summaries for channel in one["mean_e"]],
            ("sensor", "", "", lambda row: row[0]["label"]),
            ("matrix", "", "", lambda row: row[0]["matrix"]),
            ("frame", "", "", lambda row: row[0]["frame"]),
            ("channel", "", "", lambda row: row[1]),
            ("time", "ms", ".4g", lambda row: row[0]["time_ms"]),
            ("mean", "e-", ".4g", lambda row: row[0]["mean_e"][row[1]]),
            ("above full well", "", ".2%", lambda row: row[0]["above_full_well_share"][row[1]]),
        )

    def plot(self, ax: Any = None) -> Any:
        """Draw all pictures, side by side.

        Parameters
        ----------
        ax
            Axes of matplotlib, one per picture; ``None`` for those of a new figure.

        Returns
        -------
        Axes, or a list of one per picture if there are several

        Raises
        ------
        InputError
            If the pictures are in a folder, or the number of axes is another.
        """
        if not self.captures:
            raise InputError(
                "folder",
                "must not be given for a plot, which draws pictures in memory",
                found=None,
                remedy="omit it, or open the files",
            )
        if len(self.captures) == 1 and not isinstance(ax, (list, tuple)):
            return figures().draw_capture(self.captures[0], axes_of(ax))
        axes = panels_of(ax, len(self.captures), columns=3)
        return [figures().draw_capture(*one) for one in zip(self.captures, axes, strict=True)]

    def __repr__(self) -> str:
        """Number of pictures, cube and operating point."""
        text = f"{len(self.summaries)} of {self.cube} at {conditions(self.points)}"
        return f"<Pictures: {text}>"

    def _repr_html_(self) -> str:
        return self._html(f"{self.cube} at {conditions(self.points)}")


RESULT_KINDS: Mapping[str, type[Result]] = {
    "analyze": Analyses,
    "compare": Comparison,
    "compare-map": ComparisonMap,
    "league": League,
    "matrix": MatrixResult,
}
"""The classes of results with described keys, by the commands that write them as JSON."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Results:
    """All results of a study.

    Attributes
    ----------
    points
        Operating point of each sensor.
    steps
        The result of each step in order, by the name of the step, which is that of the file of
        ``chromanoise run``: ``analysis-kernel``, ``sweep-1-lux-snr-y`` ...
    """

    study: Study
    points: tuple[OperatingPoint, ...]
    steps: Mapping[str, Result]

    @property
    def analyses(self) -> dict[str, Analyses]:
        """The analyses by the name of their color matrix."""
        return {one.matrix: one for one in self._of(Analyses)}

    @property
    def matrices(self) -> dict[str, Matrices]:
        """The color matrices by the name of their method."""
        return {one.method: one for one in self._of(Matrices)}

    @property
    def sweeps(self) -> tuple[Comparison, ...]:
        """The sweeps of one parameter, in the order of the study."""
        return self._of(Comparison)

    @property
    def maps(self) -> tuple[ComparisonMap, ...]:
        """The sweeps of two parameters, in the order of the study."""
        return self._of(ComparisonMap)

    @property
    def pictures(self) -> tuple[Pictures, ...]:
        """The pictures, in the order of the study."""
        return self._of(Pictures)

    def step(self, name: str | None = None) -> Result:
        """The result of a step.

        Parameters
        ----------
        name
            A key of `steps`; ``None`` for the only step.

        Returns
        -------
        Result

        Raises
        ------
        InputError
            If there is no such step, or several and none is named.
        """
        if name is not None:
            return self.steps[check.one_of("step", name, tuple(self.steps))]
        if len(self.steps) > 1:
            raise InputError(
                "step",
                "must name one of the steps of the study",
                found="none is named",
                remedy=Setting("step", tuple(self.steps)),
            )
        return next(iter(self.steps.values()))

    def to_dict(self) -> dict[str, Any]:
        """The result of each step by its name, as ``chromanoise run`` writes them."""
        return {name: step.to_dict() for name, step in self.steps.items()}

    def to_list(self) -> list[dict[str, Any]]:
        """The result of each step, as `to_dict` without the names."""
        return list(self.to_dict().values())

    def to_table(self, step: str | None = None) -> Table:
        """The main table of a step.

        Parameters
        ----------
        step
            As of `Results.step`.

        Returns
        -------
        Table
        """
        return self.step(step).to_table()

    def to_dataframe(self, step: str | None = None) -> Any:
        """The main table of a step as a pandas data frame; pandas must be installed.

        Parameters
        ----------
        step
            As of `Results.step`.

        Returns
        -------
        DataFrame
        """
        return self.step(step).to_dataframe()

    def to_latex(self, label: str = "", step: str | None = None) -> str:
        r"""The main table of a step in LaTeX.

        Parameters
        ----------
        label
            Label for ``\ref``; empty for no label.
        step
            As of `Results.step`.

        Returns
        -------
        str
        """
        return self.step(step).to_latex(label)

    def plot(self, ax: Any = None, step: str | None = None) -> Any:
        """Draw the main chart of a step.

        Parameters
        ----------
        ax
            Axes of matplotlib; ``None`` for those of a new figure.
        step
            As of `Results.step`.

        Returns
        -------
        Axes
        """
        return self.step(step).plot(ax)

    def __repr__(self) -> str:
        """Number of results of each kind, and the operating point."""
        kinds = ("analyses", "matrices", "sweeps", "maps", "pictures")
        counts = {kind: len(getattr(self, kind)) for kind in kinds}
        text = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
        return f"<Results: {text} at {conditions(self.points)}>"

    def _repr_html_(self) -> str:
        return "".join(one._repr_html_() for one in self.steps.values())

    def _of(self, kind: type[Kind]) -> tuple[Kind, ...]:
        return tuple(one for one in self.steps.values() if isinstance(one, kind))
