"""Sliders of a report: charts of the study with one setting changed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise.analysis import SWEEPS
from chromanoise.charts import Shown, shown_at
from chromanoise.exposure import OperatingPoint, level_in_words
from chromanoise.spectra import is_infrared

_STEP = 10.0 ** (1 / 8)  # of the light level: eight steps per decade
_MOST_ABOVE = 12
_MOST_ANSWERS = 25
_ROOM = 50  # answers of one sensor: more sensors have fewer each, so that the file stays small
_EDGES_NM = (600.0, 620.0, 640.0, 660.0, 680.0, 700.0, 725.0, 750.0, 800.0, 850.0, 900.0, 950.0)
_RATIOS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)  # of infrared to light. [W/W]
_DIODE_NM = 850.0
_SEES_INFRARED = 0.02  # QE below which a channel is blind to it. [e-/photon]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Slide:
    """One slider.

    Attributes
    ----------
    key
        Of the sweep.
    label
        Label of the setting that it changes.
    values
        Values in the unit of the sweep; ``None`` is the unchanged study, where no value gives it.
    texts
        Text of each value.
    own
        Index of the unchanged study.
    """

    key: str
    label: str
    values: tuple[float | None, ...]
    texts: tuple[str, ...]
    own: int

    def __post_init__(self) -> None:
        _check.same_length("positions", values=len(self.values), texts=len(self.texts))


def slides_of(of: Shown) -> tuple[Slide, ...]:
    """The sliders that make sense for a study: the light level, an IR-cut where one matters, and
    infrared in the light where a sensor sees it.

    The light level goes up to where every sensor is saturated, for the time is the study's own.
    """
    count = max(5, min(_MOST_ANSWERS, _ROOM // len(of.operating_points)))
    step = (len(of.operating_points) + 1) // 2
    infrared = (_ir_cut(_EDGES_NM[::step]),) if _sees_infrared(of.operating_points) else ()
    more = (_infrared(_RATIOS[:: (step + 1) // 2]),) if _sees_diode(of.operating_points) else ()
    return (_level(of, count), *infrared, *more)


def at_value(of: Shown, slide: Slide, value: float | None) -> Shown:
    """The study with one setting changed and all others, including the time, kept.

    Parameters
    ----------
    of
        The unchanged study.
    slide
        What is changed; its key is one of `chromanoise.analysis.SWEEPS`.
    value
        To what; ``None`` changes nothing. [unit of the sweep]

    Raises
    ------
    InputError
        As `chromanoise.charts.shown_at`.
    """
    if value is None:
        return of
    change = SWEEPS[slide.key].at
    return shown_at(of, tuple(change(one, value) for one in of.operating_points))


def _level(of: Shown, count: int) -> Slide:
    own = of.study.light.level_lux
    above = 1
    slide = Slide(key="lux", label="Light level", values=(), texts=(), own=0)
    while above < min(_MOST_ABOVE, count // 2) and not _all_saturated(of, slide, own, above):
        above += 1
    steps = range(above - count + 1, above + 1)
    values = [float(f"{own * _STEP**i:.3g}") if i else own for i in steps]
    texts = [level_in_words(value) for value in values]
    return replace(slide, values=tuple(values), texts=tuple(texts), own=count - 1 - above)


def _all_saturated(of: Shown, slide: Slide, own: float, above: int) -> bool:
    there = at_value(of, slide, own * _STEP**above)
    return all(analysis.saturated.any() for analysis in there.analyses)


def _ir_cut(edges_nm: Sequence[float]) -> Slide:
    texts = [f"at {edge:g} nm" for edge in edges_nm]
    return Slide(
        key="ircut-nm",
        label="IR-cut added before every sensor",
        values=(*edges_nm, None),
        texts=(*texts, "none"),
        own=len(edges_nm),
    )


def _infrared(ratios: Sequence[float]) -> Slide:
    return Slide(
        key="infrared",
        label="Infrared added to the light, 850 nm",
        values=(None, *ratios),
        texts=("none", *(f"{ratio:g} W per W of light" for ratio in ratios)),
        own=0,
    )


def _sees_diode(operating_points: Sequence[OperatingPoint]) -> bool:
    seen = (
        np.interp(_DIODE_NM, one.sensor.grid.wavelength_nm, one.sensor.qe.max(axis=1))
        for one in operating_points
    )
    return bool(max(seen) > _SEES_INFRARED)


def _sees_infrared(operating_points: Sequence[OperatingPoint]) -> bool:
    for one in operating_points:
        beyond = is_infrared(one.sensor.grid)
        lit = one.illuminant.irradiance > 0
        if (beyond & lit).any() and np.max(one.sensor.qe[beyond & lit]) > _SEES_INFRARED:
            return True
    return False


def changed_keys(answer: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """Of every part only what differs from the study's own answer; a part of other keys whole.

    Examples
    --------
    >>> changed_keys({"a": {"x": 1, "y": 3}, "b": {"z": 1}}, {"a": {"x": 1, "y": 2}, "b": {"z": 1}})
    {'a': {'y': 3}}
    >>> changed_keys({"a": {"fault": "none"}}, {"a": {"x": 1}})
    {'a': {'whole': {'fault': 'none'}}}
    """
    texts: dict[str, Any] = {}
    for part, data in answer.items():
        if data.keys() != own[part].keys():
            texts[part] = {"whole": data}
        elif differing := {key: value for key, value in data.items() if value != own[part][key]}:
            texts[part] = differing
    return texts


def slide_as_json(
    slide: Slide, answers: Sequence[dict[str, Any]], own: dict[str, Any]
) -> dict[str, Any]:
    """A slider with its answers, each as `changed_keys` of the study's own."""
    return {
        "key": slide.key,
        "label": slide.label,
        "values": list(slide.values),
        "texts": list(slide.texts),
        "own": slide.own,
        "answers": [changed_keys(answer, own) for answer in answers],
    }
