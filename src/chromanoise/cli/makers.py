"""Names of color matrices to functions: the one place where a word chooses a method."""

from collections.abc import Mapping, Sequence

from chromanoise import _check
from chromanoise.color import ColorMatrix, kernel_matrix
from chromanoise.exposure import Exposure
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant, Metric
from chromanoise.study.comparison import MatrixMaker

MATRIX_NAMES = ("kernel",)


def matrix_makers(
    names: Sequence[str], illuminant: Illuminant, metric: Metric
) -> Mapping[str, MatrixMaker]:
    """The matrix methods that a person names, made for this light."""
    wanted = [name.strip() for name in names]
    for name in wanted:
        _check.one_of("matrix", name, MATRIX_NAMES)

    def kernel(sensor: Sensor, exposure: Exposure, level_lux: float) -> ColorMatrix:
        return kernel_matrix(sensor, exposure, metric)

    makers: dict[str, MatrixMaker] = {"kernel": kernel}
    return {name: makers[name] for name in wanted}
