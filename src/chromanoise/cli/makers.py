"""Names of color matrices to functions: the one place where a word chooses a method."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from chromanoise import _check
from chromanoise.color import (
    ColorMatrix,
    Training,
    chart_training,
    kernel,
    least_squares,
    lmmse,
    nir_diverse,
    white_preserving,
)
from chromanoise.exposure import Exposure
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant, Metric
from chromanoise.study import MatrixMaker

_METHODS: Mapping[str, Callable[..., ColorMatrix]] = {
    "kernel": kernel,
    "least-squares": least_squares,
    "white-preserving": white_preserving,
    "lmmse": lmmse,
}
MATRIX_NAMES = tuple(_METHODS)


def matrix_makers(
    names: Sequence[str], illuminant: Illuminant, metric: Metric
) -> Mapping[str, MatrixMaker]:
    """The matrix methods that a person names, made for this light.

    What is trained is trained on the ColorChecker with near-infrared metamers.
    """
    wanted = [name.strip() for name in names]
    for name in wanted:
        _check.one_of("matrix", name, MATRIX_NAMES)
    training = nir_diverse(chart_training(illuminant))
    return {
        name: partial(_made, method=_METHODS[name], training=training, metric=metric)
        for name in wanted
    }


def _made(
    sensor: Sensor,
    exposure: Exposure,
    level_lux: float,
    *,
    method: Callable[..., ColorMatrix],
    training: Training,
    metric: Metric,
) -> ColorMatrix:
    return method(sensor, exposure, training, level_lux=level_lux, metric=metric)
