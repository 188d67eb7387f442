"""Tables 2-5: as printed, in closed form, and by Monte Carlo with its error bar."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from chromanoise.analysis.analysis import Analysis, color_snr_db, contravariant_snr_db, raw_snr_db
from chromanoise.metrics import snr_db
from chromanoise.noise import Estimate, monte_carlo, with_noise
from chromanoise.paper.study import (
    DRAWS,
    PRINTED_ANGLE_DEG,
    PRINTED_CONTRAVARIANT_SNR_DB,
    PRINTED_FULL_WELL_SNR_DB,
    PRINTED_GREEN_SNR_Y_DB,
    PRINTED_RAW_SNR_DB,
    PRINTED_SNR_Y_DB,
    PaperStudy,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One number of the paper beside ours.

    Attributes
    ----------
    table, row, column
        Where it stands in the paper.
    quantity, unit
        What it is.
    paper
        As printed; ``None`` where the paper prints nothing.
    closed_form, monte_carlo, monte_carlo_se
        Ours; ``None`` where a quantity has no noise to sample.
    clipped_share
        Share of the acquisitions in which this raw channel, or for other coordinates any channel,
        was held at black or full well; 0 where nothing is clipped.
    """

    table: int
    row: str
    column: str
    quantity: str
    unit: str
    paper: float | None
    closed_form: float | None
    monte_carlo: float | None = None
    monte_carlo_se: float | None = None
    clipped_share: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Reproduction:
    """The paper's tables, ours beside them.

    Attributes
    ----------
    study
        The closed form behind the cells.
    cells
        In the paper's order.
    seed, draws, clipped
        How the Monte Carlo was drawn.
    """

    study: PaperStudy
    cells: tuple[Cell, ...]
    seed: int
    draws: int
    clipped: bool


def reproduced(
    study: PaperStudy,
    *,
    draws: int = DRAWS,
    seed: int = 0,
    clip: bool = False,
    progress: Callable[[int], None] = lambda _: None,
) -> Reproduction:
    """Tables 2-5 of the paper.

    Parameters
    ----------
    study
        `paper_study`.
    draws
        Acquisitions per column; the paper takes 5000.
    seed
        Of the Monte Carlo.
    clip
        Hold each draw between black and full well; the paper does not.
    progress
        Called with the number of newly finished draws, out of ``draws`` for each of
        `witnessed_columns`.

    Raises
    ------
    InputError
        If the seed is negative, or there are fewer than 2 draws or more than 1e10.
    """
    analyses = witnessed_columns(study)
    drawn = partial(_witness, draws=draws, seed=seed, clip=clip, progress=progress)
    witnesses = {
        column: drawn(analysis, number=number)
        for number, (column, analysis) in enumerate(analyses.items())
    }
    cells = [
        _snr_cell(line, column, printed, analyses[column], witnesses[column])
        for line in _LINES
        for column, printed in line.printed.items()
    ]
    cells += list(_noiseless_cells(study))
    cells.sort(key=lambda cell: cell.table)
    return Reproduction(study=study, cells=tuple(cells), seed=seed, draws=draws, clipped=clip)


def witnessed_columns(study: PaperStudy) -> dict[str, Analysis]:
    """The columns of the tables that are checked by Monte Carlo.

    Parameters
    ----------
    study
        The study.
    """
    return {**study.columns, **study.greens}


_SNR_OF: dict[str, Callable[[Analysis], dict[str, float | None]]] = {
    "raw SNR": raw_snr_db,
    "contravariant SNR": contravariant_snr_db,
    "Y SNR": color_snr_db,
}


@dataclass(frozen=True, slots=True)
class _Line:
    """One row of a table of SNRs: which coordinate of which stage, and what the paper prints."""

    table: int
    row: str
    quantity: str
    coordinate: str
    printed: dict[str, float]


_LINES = (
    *(_Line(2, c, "raw SNR", c, row) for c, row in PRINTED_RAW_SNR_DB.items()),
    _Line(3, "SNR_Y", "Y SNR", "Y", PRINTED_SNR_Y_DB),
    *(
        _Line(4, f"M^{c}", "contravariant SNR", c, row)
        for c, row in PRINTED_CONTRAVARIANT_SNR_DB.items()
    ),
    _Line(5, "SNR_raw", "raw SNR", "G", PRINTED_FULL_WELL_SNR_DB),
    _Line(5, "SNR_y", "Y SNR", "Y", PRINTED_GREEN_SNR_Y_DB),
)


@dataclass(frozen=True, slots=True)
class _Witness:
    """Monte Carlo of every (quantity, coordinate) of one column, from the same acquisitions."""

    estimate: Estimate
    coordinates: tuple[tuple[str, str], ...]


def _witness(
    analysis: Analysis,
    *,
    draws: int,
    seed: int,
    number: int,
    clip: bool,
    progress: Callable[[int], None],
) -> _Witness:
    channels = analysis.sensor.names
    rows = np.vstack(
        [np.eye(len(channels)), analysis.matrix.frame.inverse_gram, analysis.matrix.matrix]
    )
    estimate = monte_carlo(
        analysis.raw.mean,
        analysis.sensor.pixel,
        rows,
        draws=draws,
        seed=seed,
        name=(number,),
        clip=clip,
        progress=progress,
    )
    coordinates = (
        *(("raw SNR", name) for name in channels),
        *(("contravariant SNR", name) for name in channels),
        *(("Y SNR", name) for name in analysis.color.names),
    )
    return _Witness(estimate, coordinates)


def _snr_cell(
    line: _Line, column: str, printed: float, analysis: Analysis, witness: _Witness
) -> Cell:
    i = witness.coordinates.index((line.quantity, line.coordinate))
    estimate = witness.estimate
    clipped = estimate.any_clipped_share
    if line.quantity == "raw SNR":
        clipped = float(estimate.clipped_share[analysis.sensor.names.index(line.coordinate)])
    return Cell(
        table=line.table,
        row=line.row,
        column=column,
        quantity=line.quantity,
        unit="dB",
        paper=printed,
        closed_form=_SNR_OF[line.quantity](analysis)[line.coordinate],
        monte_carlo=float(estimate.snr_db[i]),
        monte_carlo_se=float(estimate.snr_se_db[i]),
        clipped_share=clipped,
    )


def _noiseless_cells(study: PaperStudy) -> Iterator[Cell]:
    """Table 5's angle, and the full-well SNR that its line SNR_raw really is."""
    for column, analysis in study.greens.items():
        sensor = analysis.sensor
        full_well = with_noise(np.full(len(sensor.names), sensor.pixel.full_well_e), sensor)
        yield Cell(
            table=5,
            row="theta(y,g)",
            column=column,
            quantity="angle",
            unit="deg",
            paper=PRINTED_ANGLE_DEG[column],
            closed_form=float(analysis.to_axes_deg[0, 1]),
        )
        yield Cell(
            table=5,
            row="SNR at full well",
            column=column,
            quantity="raw SNR of a full well",
            unit="dB",
            paper=PRINTED_FULL_WELL_SNR_DB[column],
            closed_form=float(snr_db(full_well)["G"]),
        )
