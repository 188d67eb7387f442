"""All results of one sensor at one operating point, and their conversion to plain data."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from chromanoise._lazy import warn_of_old_name
from chromanoise.analysis.analysis import Analysis, analyzed, of_white
from chromanoise.analysis.camera_pipeline import pipeline_noise
from chromanoise.analysis.chart_patches import ChartNoise, chart_as_json, chart_noise
from chromanoise.analysis.color_matrices import MatrixMaker
from chromanoise.analysis.color_space_noise import GrayNoise, gray_noise, gray_noise_as_json
from chromanoise.analysis.export import analyses_as_json, budgets_as_json
from chromanoise.analysis.figures_of_merit.merits import Merits, merits_as_json, merits_of
from chromanoise.analysis.machine_reading import (
    MachineReading,
    machine_reading,
    machine_reading_as_json,
)
from chromanoise.analysis.pipeline_results import PipelineNoise, pipeline_as_json
from chromanoise.color import SPACES, UNBOUNDED
from chromanoise.exposure import OperatingPoint, patch_scene
from chromanoise.noise import Readout, clipping_readout
from chromanoise.spectra import Illuminant
from chromanoise.study.assembly import keyed
from chromanoise.study.document import OutputsPart, PipelinePart, pipeline_settings


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outcome:
    """Every stage of one sensor, and the further outputs of the study.

    Attributes
    ----------
    analysis
        Raw, spectral and color coordinates of a perfect white.
    gray_noise, chart
        ``None`` where not asked for, or where a channel is saturated or white is no color.
    merits
        ``None`` where not asked for.
    pipeline
        As ``gray_noise``.
    machine
        ``None`` for an eye.
    """

    analysis: Analysis
    gray_noise: GrayNoise | None
    chart: ChartNoise | None
    merits: Merits | None
    pipeline: PipelineNoise | None
    machine: MachineReading | None

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
    outputs
        The requested outputs; `outcomes_as_json` adds ``budget``.
    balance_light
        The illuminant that the white balance of the pipeline names (`balance_light_of`).

    Raises
    ------
    InputError
        If the matrix cannot be made, or an output cannot be computed.
    """
    analysis = analysis_of(operating_point, maker, outputs)
    readout = analysis.readout
    space = SPACES[outputs.space] if outputs.space is not None else None
    return Outcome(
        analysis=analysis,
        gray_noise=gray_noise(analysis, space, readout=readout) if space else None,
        chart=chart_noise(analysis, readout=readout or UNBOUNDED) if outputs.chart else None,
        merits=merits_of(of_white(analysis), maker=maker) if outputs.merit else None,
        pipeline=_pipeline(analysis, outputs.pipeline, balance_light, readout)
        if outputs.pipeline.run
        else None,
        machine=machine_reading(analysis) if outputs.reader == "machine" else None,
    )


def _pipeline(
    analysis: Analysis, part: PipelinePart, light: Illuminant | None, readout: Readout | None
) -> PipelineNoise | None:
    key = "outputs.pipeline"
    own = {name: f"{key}.{name}" for name in type(part).model_fields}
    with keyed(f"{key}.white_balance", lambda name: f"{key}.{name}", own):
        return pipeline_noise(analysis, pipeline_settings(part, light), readout=readout)


def outcomes_as_json(outcomes: Sequence[Outcome], outputs: OutputsPart) -> dict[str, Any]:
    """The outcomes as plain data, side by side.

    Parameters
    ----------
    outcomes
        Results of each sensor.
    outputs
        Which results the study asks for.
    """
    data = analyses_as_json([outcome.analysis for outcome in outcomes])
    for own, outcome in zip(data["sensors"], outcomes, strict=True):
        if outputs.budget:
            own |= budgets_as_json(outcome.analysis)
        if outputs.space is not None:
            own["gray_noise"] = gray_noise_as_json(outcome.gray_noise)
            own["grey_noise"] = own["gray_noise"]  # the old key, in this release only
        if outputs.chart:
            own["chart"] = chart_as_json(outcome.chart)
        if outcome.merits is not None:
            own["merits"] = merits_as_json(outcome.merits)
        if outputs.pipeline.run:
            own["pipeline"] = pipeline_as_json(outcome.pipeline)
        if outcome.machine is not None:
            data["reader"] = outputs.reader
            own |= machine_reading_as_json(outcome.machine)
    return data
