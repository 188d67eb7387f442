"""The objectives of a design: one table, each with the library's function.

To add an objective, write a function below ``_objective``. The evaluator calls it for each
candidate, which takes some milliseconds. The module ``kernels`` computes those of `FAST` for a
whole batch; tests compare them with the function.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from chromanoise.base import Array, dataclass, defined
from chromanoise.color import ColorMatrix, first_order
from chromanoise.metrics import (
    chart_ciede2000,
    chart_color_error,
    illuminance_for_snr,
    illuminance_for_snr_adapted,
    pair_distances,
    sensor_metamerism,
    vora_value,
)
from chromanoise.noise import OperatingPoint, measurement_vectors, saturated, signal_limit_e
from chromanoise.spectra import INFRARED_FROM_NM, color_axes, is_infrared
from chromanoise.study import (
    GRAY,
    VISUAL_NOISE,
    MatrixMaker,
    electrons_at,
    pairs_of,
    raw_information,
    stages_at,
    total_errors,
    visual_noise,
)

SNR10 = 10.0
"""The amplitude ratio of SNR10, 20 dB."""


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """One candidate in one scene: an operating point and its color matrix.

    Attributes
    ----------
    point
        Sensor, exposure and light.
    maker
        The method of the matrix, for other light levels.
    """

    point: OperatingPoint
    matrix: ColorMatrix
    maker: MatrixMaker


@dataclass(frozen=True, kw_only=True)
class Objective:
    """One number of a candidate.

    Attributes
    ----------
    name
        What users type; also in JSON.
    short
        Its name in sentences.
    what
        Its name in tables and on axes, without the unit.
    of
        The function that computes it; ``None`` or not finite where it is undefined.
    rows
        The rows of a scene that its kernel needs beside the white (``kernels.GROUPS``), empty if
        none; ``None`` without a kernel.
    of_saturated
        Whether it is defined if a channel is saturated on a perfect white.
    of_noise
        Whether it depends on the noise.
    """

    name: str
    short: str
    what: str
    unit: str
    better: Literal["higher", "lower"]
    of: Callable[[Candidate], float | None]
    source: str = ""
    rows: str | None = None
    of_saturated: bool = False
    of_noise: bool = True

    @property
    def fast(self) -> bool:
        """Whether it is computed for a whole batch."""
        return self.rows is not None

    @property
    def undefined(self) -> float:
        """The value where it is undefined: -inf or inf, the worst one."""
        return -np.inf if self.better == "higher" else np.inf


def value_of(objective: Objective, candidate: Candidate) -> float:
    """An objective of one candidate by the library's function; `Objective.undefined` if none.

    Parameters
    ----------
    objective
        An entry of `OBJECTIVES`.
    candidate
        The operating point and its matrix.
    """
    point = candidate.point
    full = saturated(electrons_at(point), point.sensor, point.exposure).any()
    value = None if full and not objective.of_saturated else objective.of(candidate)
    if value is None or np.isnan(value):
        return objective.undefined
    return float(value)


def _mean_error(candidate: Candidate, errors: Callable[..., Array | None]) -> float | None:
    point = candidate.point
    found = errors(point.sensor, candidate.matrix, point.exposure, point.illuminant, point.chart)
    return None if found is None else float(found.mean())


def _distances(point: OperatingPoint, matrix: ColorMatrix) -> Array | None:
    """D_M of all pairs in raw values; ``None`` where a patch saturates a channel."""
    pairs = pairs_of(point)
    at = stages_at(point, matrix, reflectance=pairs.patches.values.T)
    return None if at.saturated.any() else pair_distances(at.raw, pairs.indices)


def _rms(values: Array) -> float:
    return float(np.sqrt((values**2).mean()))


_Function = Callable[[Candidate], float | None]
OBJECTIVES: dict[str, Objective] = {}
"""Objectives by name: ``_objective`` enters a function by its name."""


def _objective(
    short: str, what: str, unit: str, better: Literal["higher", "lower"], **more: Any
) -> Callable[[_Function], _Function]:
    """A decorator that enters the function `Objective.of` with what describes it."""

    def entered(of: _Function) -> _Function:
        name = of.__name__.removeprefix("_")
        OBJECTIVES[name] = Objective(
            name=name, short=short, what=what, unit=unit, better=better, of=of, **more
        )
        return of

    return entered


@_objective(
    "SNR of Y",
    "SNR of Y of a perfect white",
    "dB",
    "higher",
    source="Clouet, Vaillant & Alleysson 2019, eq. 5-7",
    rows="",
)
def _snr_y_db(candidate: Candidate) -> float:
    at = stages_at(candidate.point, candidate.matrix)
    return float(at.color_snr_db[candidate.matrix.coordinates.index("Y")])


@_objective(
    "noise in CIELAB",
    "RMS noise in CIELAB over the chart",
    "Delta E*ab",
    "lower",
    source="JCGM 102:2011, 6.2 (first order)",
    rows="chart",
)
def _noise_delta_e(candidate: Candidate) -> float | None:
    error = total_errors(candidate.point, candidate.matrix, method=first_order)
    return None if error is None else _rms(error.noise)


@_objective(
    "total error",
    "RMS of bias and noise in CIELAB over the chart",
    "Delta E*ab",
    "lower",
    source="JCGM 102:2011, 6.2 (first order)",
    rows="chart",
)
def _total_delta_e(candidate: Candidate) -> float | None:
    error = total_errors(candidate.point, candidate.matrix, method=first_order)
    return None if error is None else _rms(error.total)


@_objective(
    "color error",
    "mean color error over the chart, white balanced",
    "Delta E*ab",
    "lower",
    source="CIE 015:2018, eq. 8.21",
    rows="chart",
)
def _delta_e(candidate: Candidate) -> float | None:
    return _mean_error(candidate, chart_color_error)


@_objective(
    "CIEDE2000",
    "mean CIEDE2000 over the chart, white balanced",
    "1",
    "lower",
    source="CIE 142-2001 (ISO/CIE 11664-6)",
    rows="chart",
)
def _ciede2000(candidate: Candidate) -> float | None:
    return _mean_error(candidate, chart_ciede2000)


@_objective(
    "Vora value",
    "Vora value",
    "1",
    "higher",
    source="Vora & Trussell 1993",
    rows="orthonormal",
    of_saturated=True,
    of_noise=False,
)
def _vora(candidate: Candidate) -> float:
    point, metric = candidate.point, candidate.matrix.metric
    filters = measurement_vectors(point.sensor, point.exposure, metric)
    return vora_value(filters, color_axes(point.sensor.grid, metric, point.observer))


@_objective(
    "SMI",
    "sensitivity metamerism index",
    "1",
    "higher",
    source="ISO 17321-1:2012",
    of_saturated=True,
    of_noise=False,
)
def _smi(candidate: Candidate) -> float:
    return sensor_metamerism(candidate.point.sensor).index


@_objective(
    "visual noise",
    VISUAL_NOISE,
    "CIELUV",
    "lower",
    source="ISO 15739:2017",
)
def _visual_noise(candidate: Candidate) -> float | None:
    return defined(visual_noise(candidate.point, candidate.matrix))


@_objective(
    "SNR10",
    "illuminance at which Y of a gray has an SNR of 10",
    "lx",
    "lower",
    source="Alakarhu, IISW 2007",
    rows="",
    of_saturated=True,
)
def _snr10_lux(candidate: Candidate) -> float | None:
    point, maker = candidate.point, candidate.maker
    given = (point.sensor, point.illuminant, point.exposure)
    if maker.method.over_light is None:
        return illuminance_for_snr(*given, candidate.matrix, snr=SNR10, reflectance=GRAY)
    return illuminance_for_snr_adapted(
        *given,
        lambda lux: maker(replace(point, level_lux=lux)),
        snr=SNR10,
        reflectance=GRAY,
    )


@_objective(
    "information",
    "information of one pixel with all channels about the spectrum",
    "bit",
    "higher",
    source="Cover & Thomas 2006, 9.4",
)
def _information_bits(candidate: Candidate) -> float:
    return float(raw_information(candidate.point))


@_objective(
    "least separation",
    "least distance between two patches in raw values",
    "1",
    "higher",
    source="ICRU Report 54 (1996)",
    rows="paired",
)
def _least_separation(candidate: Candidate) -> float | None:
    distance = _distances(candidate.point, candidate.matrix)
    return None if distance is None else float(distance.min())


@_objective(
    "mean separation",
    "mean distance between two patches in raw values",
    "1",
    "higher",
    source="ICRU Report 54 (1996)",
    rows="paired",
)
def _mean_separation(candidate: Candidate) -> float | None:
    distance = _distances(candidate.point, candidate.matrix)
    return None if distance is None else float(distance.mean())


@_objective(
    "infrared share",
    f"share of the electrons of a white beyond {INFRARED_FROM_NM:g} nm, worst channel",
    "1",
    "lower",
    rows="infrared",
    of_saturated=True,
    of_noise=False,
)
def _infrared_share(candidate: Candidate) -> float | None:
    point = candidate.point
    infrared = is_infrared(point.sensor.grid).astype(np.float64)
    white_e, infrared_e = electrons_at(point), electrons_at(point, reflectance=infrared)
    if not (white_e > 0).all():
        return None
    return float((infrared_e / white_e).max())


@_objective(
    "share of full well",
    "electrons of a white as a share of full well or top code, most sensitive channel",
    "1",
    "lower",
    source="EMVA 1288, release 4.0",
    rows="",
    of_saturated=True,
    of_noise=False,
)
def _share_of_full_well(candidate: Candidate) -> float:
    point = candidate.point
    limit_e = signal_limit_e(point.sensor, point.exposure)
    return float(electrons_at(point).max() / limit_e) if limit_e > 0 else np.inf


FAST = tuple(name for name, one in OBJECTIVES.items() if one.fast)
"""Objectives that the kernels compute for a whole batch, in the order of their columns."""
