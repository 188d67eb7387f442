"""The figures of merit of one sensor in use, each with its source, in one list."""

from dataclasses import dataclass
from typing import Any

from chromanoise import _check
from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.color_matrices import MatrixFunction
from chromanoise.analysis.figures_of_merit.entries import Merit, Viewing
from chromanoise.analysis.figures_of_merit.filters import (
    chart_merits,
    filter_merits,
    metamerism_merits,
)
from chromanoise.analysis.figures_of_merit.light import (
    level_merits,
    matrix_merits,
    speed_merits,
    viewed_pixels_per_degree,
    visual_merits,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Merits:
    """All figures of merit of a sensor in a light and with an exposure.

    Attributes
    ----------
    sensor, illuminant, matrix
        Names.
    level_lux, time_s
        The exposure. [lx], [s]
    metric
        Metric of the space of spectra.
    observer
        Of the filters and of color; the SMI is that of CIE 1931 by its standard.
    viewing
        Of the visual noise.
    entries
        The figures, in the order of tables and JSON.
    """

    sensor: str
    illuminant: str
    matrix: str
    level_lux: float
    time_s: float
    metric: str
    observer: str
    viewing: Viewing
    entries: tuple[Merit, ...]

    def __post_init__(self) -> None:
        _check.distinct(f"merits of {self.sensor}", [entry.name for entry in self.entries])


def merits_of(
    analysis: Analysis, *, maker: MatrixFunction | None = None, viewing: Viewing | None = None
) -> Merits:
    """Every figure of merit of an analysis: its sensor, exposure, lamp and matrix.

    A figure that is not defined (a channel is saturated on the white, a color of the lamp is zero,
    the mosaic is not known) has the reason in place of a value. Noise is unclipped.

    Parameters
    ----------
    analysis
        Its scene gives lamp and illuminance; its reflectance does not matter.
    maker
        Makes the matrix of ``analysis``; where that changes with the light, SNR10 is given for
        the adapting matrix as well. ``None`` for a matrix that stays.
    viewing
        Of the visual noise; ``None`` for pixels of 0.25 mm from 600 mm.

    Notes
    -----
    The source of each figure stands beside it. Those of the filters depend on the metric.

    Examples
    --------
    One channel whose white just fills 10,000 electrons, 10 e- of readout: 181 levels (DxOMark).

    >>> from chromanoise.exposure import saturating_exposure
    >>> from chromanoise.scene import flat_field
    >>> from chromanoise.catalog import sensor_named
    >>> from chromanoise.spectra import DEFAULT_GRID, equal_energy
    >>> from chromanoise.analysis import analyzed
    >>> white = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
    >>> mono = sensor_named("model-mono", DEFAULT_GRID)
    >>> filled = saturating_exposure(white, mono, share=1.0)
    >>> entries = merits_of(analyzed(white, mono, filled)).entries
    >>> bits = {entry.name: entry.value for entry in entries}["tonal_range_W"]
    >>> round(2**bits, 3)
    180.998
    """
    viewed = viewing or Viewing()
    return Merits(
        sensor=analysis.sensor.label,
        illuminant=analysis.scene.illuminant.name,
        matrix=analysis.matrix.made_by,
        level_lux=analysis.scene.level_lux,
        time_s=analysis.exposure.time_s,
        metric=analysis.matrix.metric,
        observer=analysis.matrix.observer,
        viewing=viewed,
        entries=(
            *filter_merits(analysis),
            *metamerism_merits(analysis),
            *chart_merits(analysis),
            *speed_merits(analysis, maker),
            *level_merits(analysis),
            *visual_merits(analysis, viewed),
            *matrix_merits(analysis),
        ),
    )


def merits_as_json(merits: Merits) -> dict[str, Any]:
    """Conditions, and per name the value with unit, meaning and source; ``None`` with a reason.

    Parameters
    ----------
    merits
        Figures of merit of a sensor in use.
    """
    return {
        "matrix": merits.matrix,
        "metric": merits.metric,
        "observer": merits.observer,
        "viewing": {
            "pixel_pitch_mm": merits.viewing.pixel_pitch_mm,
            "distance_mm": merits.viewing.distance_mm,
            "pixels_per_degree": viewed_pixels_per_degree(merits.viewing),
        },
        "values": {
            entry.name: {
                "value": entry.value,
                "unit": entry.unit,
                "what": entry.what,
                "source": entry.source,
                "missing": entry.missing or None,
            }
            for entry in merits.entries
        },
    }
