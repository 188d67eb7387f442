"""Tables 2-5: as printed, in closed form, and by Monte Carlo with its error bar."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from chromanoise._check import InputError
from chromanoise.noise import Estimate, monte_carlo
from chromanoise.study import paper
from chromanoise.study.analysis import (
    Analysis,
    color_snr_db,
    contravariant_snr_db,
    raw_snr_db,
)
from chromanoise.study.paper import PaperStudy
from chromanoise.units import decibel


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
        Share of the acquisitions in which a channel of this sensor clipped; 0 unclipped.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperTable:
    """One of the paper's tables, laid out: for each row a cell per column, or ``None``."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[Cell | None, ...]], ...]


def as_printed(value: float | None) -> str:
    """A number of the paper with the digits that the paper gives it.

    Examples
    --------
    >>> as_printed(25.0), as_printed(39.95), as_printed(None)
    ('25.0', '39.95', '-')
    """
    return "-" if value is None else f"{value:.2f}".removesuffix("0")


_TITLES = {
    2: "Table 2: raw SNR",
    3: "Table 3: SNR of luminance Y",
    4: "Table 4: SNR of contravariant coordinates",
    5: "Table 5: one green channel",
}


def paper_tables(result: Reproduction) -> tuple[PaperTable, ...]:
    """The cells of a reproduction in the layout of the paper."""
    return tuple(_laid_out(number, title, result.cells) for number, title in _TITLES.items())


def _laid_out(number: int, title: str, cells: tuple[Cell, ...]) -> PaperTable:
    by_place = {(cell.row, cell.column): cell for cell in cells if cell.table == number}
    columns = tuple(dict.fromkeys(column for _, column in by_place))
    rows = dict.fromkeys(row for row, _ in by_place)
    return PaperTable(
        title=title,
        columns=columns,
        rows=tuple((row, tuple(by_place.get((row, c)) for c in columns)) for row in rows),
    )


def reproduced(
    study: PaperStudy, *, draws: int = paper.DRAWS, seed: int = 0, clip: bool = False
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

    Raises
    ------
    InputError
        If the seed is negative or there are fewer than 2 draws.
    """
    if seed < 0:
        raise InputError(f"seed must be an integer >= 0, but is {seed}")
    analyses = {**study.columns, **study.greens}
    witnesses = {
        column: _witness(analysis, draws=draws, seed=seed, number=number, clip=clip)
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
    *(_Line(2, c, "raw SNR", c, row) for c, row in paper.PRINTED_RAW_SNR_DB.items()),
    _Line(3, "SNR_Y", "Y SNR", "Y", paper.PRINTED_SNR_Y_DB),
    *(
        _Line(4, f"M^{c}", "contravariant SNR", c, row)
        for c, row in paper.PRINTED_CONTRAVARIANT_SNR_DB.items()
    ),
    _Line(5, "SNR_raw", "raw SNR", "G", paper.PRINTED_FULL_WELL_SNR_DB),
    _Line(5, "SNR_y", "Y SNR", "Y", paper.PRINTED_GREEN_SNR_Y_DB),
)


@dataclass(frozen=True, slots=True)
class _Witness:
    """Monte Carlo of every (quantity, coordinate) of one column, from the same acquisitions."""

    estimate: Estimate
    coordinates: tuple[tuple[str, str], ...]


def _witness(analysis: Analysis, *, draws: int, seed: int, number: int, clip: bool) -> _Witness:
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
    clipped = witness.estimate.clipped_share
    own = analysis.sensor.names.index(line.coordinate) if line.quantity == "raw SNR" else None
    return Cell(
        table=line.table,
        row=line.row,
        column=column,
        quantity=line.quantity,
        unit="dB",
        paper=printed,
        closed_form=_SNR_OF[line.quantity](analysis)[line.coordinate],
        monte_carlo=float(witness.estimate.snr_db[i]),
        monte_carlo_se=float(witness.estimate.snr_se_db[i]),
        clipped_share=float(clipped.max() if own is None else clipped[own]),
    )


def _noiseless_cells(study: PaperStudy) -> Iterator[Cell]:
    """Table 5's angle, and the full-well SNR that its line SNR_raw really is."""
    for column, analysis in study.greens.items():
        pixel = analysis.sensor.pixel
        full = pixel.full_well_e / np.sqrt(pixel.full_well_e + pixel.read_noise_e**2)
        yield Cell(
            table=5,
            row="theta(y,g)",
            column=column,
            quantity="angle",
            unit="deg",
            paper=paper.PRINTED_ANGLE_DEG[column],
            closed_form=float(analysis.to_axes_deg[0, 1]),
        )
        yield Cell(
            table=5,
            row="SNR at full well",
            column=column,
            quantity="raw SNR of a full well",
            unit="dB",
            paper=paper.PRINTED_FULL_WELL_SNR_DB[column],
            closed_form=float(decibel(full)),
        )
