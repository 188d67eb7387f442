"""Crossovers over spectral priors: what a trained matrix expects decides who wins."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.color_matrices import matrix_makers, trained_names
from chromanoise.analysis.comparison.crossing import Crossover, crossover_as_json, crossovers
from chromanoise.analysis.comparison.curves import compared
from chromanoise.analysis.comparison.quantities import SNR_Y, Quantity
from chromanoise.analysis.comparison.sweeps import SWEEPS, Sweep
from chromanoise.analysis.priors import PRIORS
from chromanoise.analysis.undefined import plain_fields
from chromanoise.exposure import OperatingPoint
from chromanoise.spectra import Metric


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossoverBand:
    """Where two sensors are equally good, over all priors of one trained matrix.

    Attributes
    ----------
    first, second, matrix
        Names.
    by_prior
        The crossover under each prior.
    """

    first: str
    second: str
    matrix: str
    by_prior: Mapping[str, Crossover]

    @property
    def span(self) -> tuple[float, float] | None:
        """From the lowest to the highest crossing under any prior; ``None`` where there is none."""
        at = [value for crossover in self.by_prior.values() for value in crossover.at]
        return (min(at), max(at)) if at else None


def crossover_bands(
    contestants: Sequence[OperatingPoint],
    names: Sequence[str],
    at: Float[Array, " k"],
    *,
    metric: Metric = "quanta",
    sweep: Sweep = SWEEPS["lux"],
    quantity: Quantity = SNR_Y,
    priors: Sequence[str] = tuple(PRIORS),
) -> tuple[CrossoverBand, ...]:
    """For each pair of sensors and each trained matrix, the crossovers under every prior.

    Parameters
    ----------
    contestants, at, sweep, quantity
        As `chromanoise.analysis.compared`.
    names, metric
        As `chromanoise.analysis.matrix_makers`; untrained ones have no prior and are passed over.
    priors
        Of `PRIORS`.

    Raises
    ------
    InputError
        As `crossovers` and `matrix_makers`.
    """
    trained = trained_names(names)
    found: dict[tuple[str, str, str], dict[str, Crossover]] = {}
    for prior in priors if trained else ():
        makers = matrix_makers(trained, metric, prior=prior)
        curves = compared(contestants, makers, at, sweep=sweep, quantity=quantity)
        for crossover in crossovers(contestants, makers, curves):
            pair = (crossover.first, crossover.second, crossover.matrix)
            found.setdefault(pair, {})[prior] = crossover
    return tuple(
        CrossoverBand(first=first, second=second, matrix=matrix, by_prior=by_prior)
        for (first, second, matrix), by_prior in found.items()
    )


def band_sentence(band: CrossoverBand) -> str:
    """The band in words.

    Parameters
    ----------
    band
        Crossovers over all training sets.
    """
    one = next(iter(band.by_prior.values()))
    start = (
        f"Over {len(band.by_prior)} priors ({', '.join(band.by_prior)}) of the {band.matrix} "
        f"matrix, {' and '.join(one.labels)}"
    )
    if band.span is None:
        called = dict(zip((band.first, band.second), one.labels, strict=True))
        better = {c.better_first for c in band.by_prior.values()}
        leaders = sorted(called[name] for name in better if name is not None)
        who = f"{leaders[0]} is always better" if leaders else "they are equal"
        if len(leaders) > 1:
            who = f"{' or '.join(leaders)} is better, depending on the prior"
        return f"{start} have no crossover in {one.quantity.what}: {who}."
    low, high = band.span
    never = [prior for prior, crossover in band.by_prior.items() if not crossover.at]
    exceptions = f", and none with {', '.join(never)}" if never else ""
    return (
        f"{start} have a crossover in {one.quantity.what} between {low:.3g} and "
        f"{one.sweep.with_unit(f'{high:.3g}')} of {one.sweep.what}{exceptions}."
    )


def bands_as_json(bands: Sequence[CrossoverBand]) -> list[dict[str, Any]]:
    """Bands as plain data.

    Parameters
    ----------
    bands
        Crossovers over all training sets, one band per pair of sensors.
    """
    return [
        plain_fields(band, "first", "second", "matrix", "span")
        | {
            "by_prior": {
                prior: crossover_as_json(crossover) for prior, crossover in band.by_prior.items()
            },
            "sentence": band_sentence(band),
        }
        for band in bands
    ]
