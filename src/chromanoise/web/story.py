"""The tour of the page: five studies, each with a few sentences, a question and its answer."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field
from typing import Any

import numpy as np

from chromanoise.base import dataclass
from chromanoise.charts import (
    Shown,
    brief,
    cause_label,
    decimal,
    electrons,
    level_curves,
    listed,
    shown,
)
from chromanoise.metrics import CORRELATION, INFRARED, Cost
from chromanoise.spectra import INFRARED_FROM_NM
from chromanoise.study import (
    Analysis,
    Crossover,
    color_snr_db,
    contravariant_snr_db,
    coordinate_budget,
    mean_color_error,
    metric_of,
    raw_snr_db,
    study_from_data,
    visual_noise_of,
)

# what the tasks ask for
_CUT_NM = 700.0
_DEEP_CUT_NM = 650.0
_DIM_LUX = 1.0
_DARK_LUX = 0.1
_CHANGED_DB = 0.3  # least change of a bar that the answer names


@dataclass(frozen=True, kw_only=True)
class Step:
    """One step of the tour.

    Attributes
    ----------
    heading
        Of a few words.
    parts
        The charts that show it, from `chromanoise.charts.registry.SECTIONS`; the page scrolls to
        the first.
    sentences
        What they show, with the numbers of the study of the step.
    task
        A question, or something to try.
    answer
        To the task, with the numbers of the study after the change that the task asks for.
    control
        Key of the control that the task names; the page opens and marks it. Empty for none.
    study
        Changes to the default study of the page, as plain data.
    look
        Options of the charts, as the page has them.
    """

    heading: str
    parts: tuple[str, ...]
    sentences: Callable[[Shown], Sequence[str]]
    task: str
    answer: Callable[[Shown], str]
    control: str = ""
    study: Mapping[str, Any] = field(default_factory=dict)
    look: Mapping[str, Any] = field(default_factory=dict)


def story(study: Mapping[str, Any]) -> dict[str, Any]:
    """The steps as plain data: the fields of `Step`, with the text and the whole study of each.

    Parameters
    ----------
    study
        The default study of the page as plain data: a sensor without IR-cut, then one with it.
    """
    steps = []
    for step in STEPS:
        data = dict(study) | dict(step.study)
        of = shown(study_from_data(data, source=""))
        own = {"heading": step.heading, "parts": list(step.parts), "task": step.task}
        own |= {"sentences": list(step.sentences(of)), "answer": step.answer(of)}
        own |= {"control": step.control}
        steps.append(own | {"study": data, "look": dict(step.look)})
    return {"steps": steps}


def _raw(of: Shown) -> list[str]:
    bare, cut = of.analyses
    name = _shared(bare, cut)[0]
    more, less = (electrons(_mean_e(a)[name]) for a in (bare, cut))
    better, worse = (decimal(raw_snr_db(a)[name]) for a in (bare, cut))
    return [
        "Two sensors see the same white surface, in the same light, for the same time. "
        f"{cut.sensor.label} has a filter in front that blocks infrared light, an IR-cut. "
        f"{bare.sensor.label} has no IR-cut, and it has a fourth channel W without a color filter.",
        f"Without the IR-cut more light reaches the pixels: channel {name} of {bare.sensor.label} "
        f"collects {more} electrons, against {less} in {cut.sensor.label}.",
        "More electrons mean less noise relative to the signal. The signal-to-noise ratio (SNR) "
        f"of {name}, as it is read from the sensor (raw), is {better} dB, against {worse} dB: the "
        "sensor without IR-cut looks better.",
    ]


def _raw_answer(of: Shown) -> str:
    bare, cut = _at_level(of, of.study.matrices[0], _DIM_LUX)
    pairs = [
        f"{_raw_db(bare, name)} dB against {_raw_db(cut, name)} dB in {name}"
        for name in _shared(bare, cut)
    ]
    return (
        f"Yes. At {brief(_DIM_LUX)} lx it has {listed(pairs)}. Both sensors lose SNR, because "
        "fewer photons arrive."
    )


def _alike(of: Shown) -> list[str]:
    bare, cut = of.analyses
    mix = bare.mix
    assert mix is not None  # four channels that depend on each other in part
    parts = " + ".join(f"{decimal(weight, 2)} {name}" for name, weight in mix.weights.items())
    vif = dict(zip(bare.sensor.names, bare.vif.tolist(), strict=True))
    return [
        f"In the infrared, beyond {brief(ALIKE_FROM_NM)} nm, the curves of {bare.sensor.label} "
        "are nearly equal: there all its channels see the same light.",
        "Think of each channel as an arrow: the more alike two channels are, the smaller the angle "
        f"between their arrows. The smallest angle of {bare.sensor.label} is {_closest(bare)}, "
        f"that of {cut.sensor.label} is {_closest(cut)} ({metric_of((bare, cut))}).",
        f"{mix.channel} is nearly a mix of the others: the angle between {mix.channel} and {parts} "
        f"is only {decimal(mix.angle_deg, 0)}° (metric {mix.metric}). The variance inflation "
        "factor (VIF) measures this: "
        "it is 1 for a channel that shares nothing with the others, and it grows as they become "
        f"more alike. For {mix.channel} it is {decimal(vif[mix.channel])}; behind the IR-cut no "
        f"channel has more than {decimal(float(cut.vif.max()))}.",
    ]


def _alike_answer(of: Shown) -> str:
    bare, mended = of.analyses[0], _with_cut(of, _DEEP_CUT_NM)
    before, after = bare.mix, mended.mix
    assert before is not None  # as in `_alike`
    assert after is not None
    return (
        f"The smallest angle between R, G and B grows from {_closest(bare, but=before.channel)} to "
        f"{_closest(mended, but=after.channel)}. But {after.channel} comes closer to a mix of "
        f"the others: the angle falls from {decimal(before.angle_deg, 0)}° to "
        f"{decimal(after.angle_deg, 0)}°, so {after.channel} adds almost no "
        "information about the color."
    )


def _unmixed(of: Shown) -> list[str]:
    bare, cut = of.analyses
    names = _shared(bare, cut)
    name = min(names, key=lambda one: _unmixed_db(bare, one) - _unmixed_db(cut, one))
    (raw, after), (raw_cut, after_cut) = (
        (decimal(raw_snr_db(a)[name]), decimal(contravariant_snr_db(a)[name])) for a in (bare, cut)
    )
    return [
        "Each channel sees a mixture of colors. To find the color of the light, the camera must "
        "subtract what the channels have in common. This is called unmixing.",
        "A subtraction removes signal, but the noise of both readings remains in the difference. "
        f"In {bare.sensor.label} the SNR of {name} falls from {raw} dB (raw) to "
        f"{after} dB (unmixed, contravariant, {metric_of((bare, cut))}); "
        f"in {cut.sensor.label} it falls from {raw_cut} dB to "
        f"{after_cut} dB.",
        f"The sensor with the better raw SNR now has the worse SNR in {listed(names)}.",
    ]


def _scales_answer(of: Shown) -> str:
    return (
        "The difference is 1 g, with an error of 1.4 g (the square root of 1² + 1²). The error is "
        "larger than the difference, although each scale is accurate to 0.1 %. The same happens "
        "to two channels that are nearly equal."
    )


def _infrared(of: Shown) -> list[str]:
    bare, cut = of.analyses
    cost, cost_cut = (_cost(a, INFRARED) for a in (bare, cut))
    mended = _with_cut(of)
    mix = mended.mix
    assert mix is not None  # as in `_alike`
    return [
        f"Our eyes see almost nothing beyond {brief(INFRARED_FROM_NM)} nm, but silicon does. In "
        f"{bare.sensor.label} {cost.reading}, in {cut.sensor.label} "
        f"{cost_cut.reading.partition(' of ')[0]}.",
        "These electrons carry no color, but they add noise. The chart starts with the SNR of all "
        "photons (top) and ends with that of the luminance Y, the brightness that an eye sees "
        f"(bottom). Each bar is a cause. In {bare.sensor.label} the infrared costs "
        f"{decimal(cost.cost_db)} dB.",
        "So the same electrons that raise the raw SNR lower the SNR of the color.",
        f"Infrared is not the only cause. With an IR-cut at {brief(_CUT_NM)} nm in front of "
        f"{bare.sensor.label}, its SNR of Y would be {decimal(_luminance_db(mended))} dB, still "
        f"less than the {decimal(_luminance_db(cut))} dB of {cut.sensor.label}: its channel "
        f"{mix.channel} is then nearly the sum of the others (only {decimal(mix.angle_deg, 0)}° "
        f"away, metric {mix.metric}), and correlation costs "
        f"{decimal(_cost(mended, CORRELATION).cost_db)} dB.",
    ]


def _infrared_answer(of: Shown) -> str:
    bare, mended = of.analyses[0], _with_cut(of)
    before, after = ({one.cause: one.cost_db for one in _costs(a)} for a in (bare, mended))
    changes = {cause: abs(after[cause]) - abs(before[cause]) for cause in before}

    def named(causes: Iterable[str]) -> str:
        texts = (
            f"{cause_label(cause, 'Y')} ({_change_db(before[cause], after[cause])})"
            for cause in causes
        )
        return listed(list(texts))

    return (
        f"Shorter: {named(one for one, by in changes.items() if by < -_CHANGED_DB)}. Longer: "
        f"{named(one for one, by in changes.items() if by > _CHANGED_DB)}. The SNR of Y rises from "
        f"{decimal(_luminance_db(bare))} dB to {decimal(_luminance_db(mended))} dB."
    )


def _picture(of: Shown) -> list[str]:
    bare, cut = of.analyses
    luminance, luminance_cut = (decimal(color_snr_db(a)["Y"]) for a in (bare, cut))
    curves, pairs = level_curves(of)
    lowest = curves[0].at[0]
    crossings = {one.matrix: one.at for one in pairs if isinstance(one, Crossover)}
    lux = crossings["lmmse"][-1]
    errors = [decimal(mean_color_error(a), 0) for a in _at_level(of, "lmmse", lux)]
    assert not crossings["kernel"]  # a test asserts it
    return [
        f"The color picture of {bare.sensor.label} is noisier: the SNR of Y is {luminance} dB, "
        f"against {luminance_cut} dB for {cut.sensor.label}. The sensor that collects more light "
        "gives the worse picture.",
        "Is this different in low light? Not with this color matrix (kernel), which is computed "
        f"without regard to the noise: {cut.sensor.label} is better from {brief(float(lowest))} lx "
        "up to the light level at which the first sensor is full.",
        "Another matrix (lmmse) is computed for each light level and gives up color where the "
        f"noise is strong. With it, {bare.sensor.label} is better below {brief(lux, 2)} lx. But "
        f"there the mean color errors are {errors[0]} and {errors[1]} ΔE (an eye just sees 2): the "
        "pictures are nearly gray.",
    ]


def _picture_answer(of: Shown) -> str:
    strong, faded = (_at_level(of, one, _DARK_LUX) for one in ("kernel", "lmmse"))
    bare, cut = (
        f"for {before.sensor.label} from {decimal(mean_color_error(before), 0)} to "
        f"{decimal(mean_color_error(after), 0)} ΔE (visual noise {_noise(before)} to "
        f"{_noise(after)})"
        for before, after in zip(strong, faded, strict=True)
    )
    return (
        f"With kernel both pictures are lost in noise: the SNR of Y is "
        f"{decimal(_luminance_db(strong[0]))} dB for {strong[0].sensor.label} and "
        f"{decimal(_luminance_db(strong[1]))} dB for {strong[1].sensor.label}. With lmmse the "
        f"noise falls, and the colors fade with it. Their mean error rises {bare}, and {cut}."
    )


STEPS: tuple[Step, ...] = (
    Step(
        heading="Raw looks better",
        parts=("stages",),
        sentences=_raw,
        task=f"Try it: drag the light level down to {_DIM_LUX:g} lx. Does the sensor without "
        "IR-cut keep its lead in raw SNR?",
        answer=_raw_answer,
        control="light.level_lux",
    ),
    Step(
        heading="Two channels that look alike",
        parts=("sensitivities", "vectors"),
        sentences=_alike,
        task=f"Try it: set the IR-cut edge of onyx-rgbw to {_DEEP_CUT_NM:.0f} nm. R, G and B then "
        "differ more. But what about W?",
        answer=_alike_answer,
        control="sensors.0.ircut_nm",
    ),
    Step(
        heading="Unmixing makes noise",
        parts=("stages",),
        sentences=_unmixed,
        task="Think of two scales that are accurate to 1 g each. One shows 1000 g, the other 999 "
        "g. How well do you know the difference?",
        answer=_scales_answer,
    ),
    Step(
        heading="Infrared carries no color",
        parts=("budget",),
        sentences=_infrared,
        task=f"Try it: set the IR-cut edge of onyx-rgbw to {_CUT_NM:.0f} nm. Which bars of the "
        "budget become shorter, and which longer?",
        answer=_infrared_answer,
        control="sensors.0.ircut_nm",
        look={"coordinate": "Y"},
    ),
    Step(
        heading="The color picture",
        parts=("picture", "levels"),
        sentences=_picture,
        task=f"Try it: drag the light level down to {_DARK_LUX:g} lx. What becomes of both "
        "pictures? Then remove the matrix kernel, so that lmmse makes the pictures. How do their "
        "colors change?",
        answer=_picture_answer,
        control="light.level_lux",
        study={"matrices": ["kernel", "lmmse"]},
        look={"coordinate": "Y"},
    ),
)
"""The steps, in their order."""

ALIKE_FROM_NM = 800.0
"""From here on the quantum efficiencies of a sensor without IR-cut differ by less than a fifth."""


def _cost(analysis: Analysis, cause: str) -> Cost:
    """What a cause costs of the SNR of Y, as the chart of the budget has it."""
    return next(cost for cost in _costs(analysis) if cost.cause == cause)


def _costs(analysis: Analysis) -> Sequence[Cost]:
    budget = coordinate_budget(analysis, "Y")
    assert budget is not None  # no sensor of the tour is saturated
    return budget.costs


def _luminance_db(analysis: Analysis) -> float:
    found = color_snr_db(analysis)["Y"]
    assert found is not None  # as `_cost`
    return found


def _with_cut(of: Shown, edge_nm: float = _CUT_NM) -> Analysis:
    """The first sensor behind an added IR-cut, with the time kept."""
    study = of.study
    cut = study.sensors[0].model_copy(update={"ircut_nm": edge_nm})
    time_ms = 1e3 * of.analyses[0].exposure.time_s
    exposure = study.exposure.model_copy(update={"time_ms": time_ms})
    return shown(study.model_copy(update={"sensors": (cut,), "exposure": exposure})).analyses[0]


def _shared(bare: Analysis, cut: Analysis) -> list[str]:
    return [name for name in bare.sensor.names if name in cut.sensor.names]


def _mean_e(analysis: Analysis) -> dict[str, float]:
    return dict(zip(analysis.sensor.names, analysis.raw.mean.tolist(), strict=True))


def _unmixed_db(analysis: Analysis, name: str) -> float:
    found = contravariant_snr_db(analysis)[name]
    assert found is not None  # as `_cost`
    return found


def _closest(analysis: Analysis, *, but: str = "") -> str:
    """The smallest angle between two channels, one left out, and their names."""
    left_out = np.array([name == but for name in analysis.sensor.names])
    apart = np.eye(len(left_out), dtype=bool) | left_out | left_out[:, None]
    angles = np.where(apart, 360.0, analysis.between_deg)
    i, j = divmod(int(angles.argmin()), len(angles))
    first, second = (analysis.sensor.names[k] for k in (i, j))
    return f"{decimal(float(angles[i, j]), 0)}° ({first} and {second})"


def _at_level(of: Shown, matrix: str, level_lux: float) -> tuple[Analysis, ...]:
    """The analyses with another matrix at another level, with the time kept."""
    time_ms = 1e3 * of.analyses[0].exposure.time_s
    study = of.study.model_copy(
        update={
            "matrices": (matrix,),
            "light": of.study.light.model_copy(update={"level_lux": level_lux}),
            "exposure": of.study.exposure.model_copy(update={"time_ms": time_ms}),
        }
    )
    return shown(study).analyses


def _raw_db(analysis: Analysis, name: str) -> str:
    return decimal(raw_snr_db(analysis)[name])


def _change_db(before: float, after: float) -> str:
    return f"{decimal(before)} to {decimal(after)} dB"


def _noise(analysis: Analysis) -> str:
    found = visual_noise_of(analysis)
    assert found is not None  # as `_cost`
    return decimal(found, 0)
