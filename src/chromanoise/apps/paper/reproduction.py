"""The reproduction of Tables 2-5 of the paper: its cells, tables, and sentences on the numbers.

Each cell has the printed value, the value in closed form, and that of a Monte Carlo simulation with
its standard error.
"""

from collections.abc import Callable, Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from chromanoise.apps.paper.printed_numbers import (
    DRAWS,
    G_N,
    PRINTED_ANGLE_DEG,
    PRINTED_CONTRAVARIANT_SNR_DB,
    PRINTED_FULL_WELL_SNR_DB,
    PRINTED_GREEN_SNR_Y_DB,
    PRINTED_RAW_SNR_DB,
    PRINTED_SNR_Y_DB,
    PRINTED_TIMES_MS,
    RGB_12,
    RGB_59,
    RGBW_12,
    G,
    PaperStudy,
)
from chromanoise.base import __version__, dataclass
from chromanoise.metrics import (
    CORRELATION,
    INFRARED,
    Budget,
    color_budget,
    snr_db,
    without_infrared,
)
from chromanoise.noise import expected_electrons, monte_carlo, with_noise
from chromanoise.spectra import INFRARED_FROM_NM
from chromanoise.study import (
    RECONSTRUCTION,
    Analysis,
    color_snr_db,
    contravariant_snr_db,
    equal_color,
    mean_color_error,
    mix_sentence,
    raw_snr_db,
)


def verdict(study: PaperStudy) -> str:
    """The paper's result with its numbers and reasons, and what it becomes at equal color error."""
    bare, cut = study.columns[RGBW_12], study.columns[RGB_12]
    shared = cut.sensor.names
    raw_gain = np.mean([_db(raw_snr_db(bare)[c]) - _db(raw_snr_db(cut)[c]) for c in shared])
    loss = _db(color_snr_db(cut)["Y"]) - _db(color_snr_db(bare)["Y"])
    before, after = luminance_budget(cut), luminance_budget(bare)
    return (
        f"At {bare.scene.level_lux:g} lx and {1e3 * bare.exposure.time_s:.1f} ms the RGBW sensor "
        f"without IR-cut is {raw_gain:.1f} dB better in raw (mean of {', '.join(shared)}) and "
        f"{loss:.1f} dB worse in luminance, because unmixing its correlated channels costs "
        f"{_cost(after, CORRELATION):.1f} dB ({_cost(before, CORRELATION):.1f} dB behind the "
        f"IR-cut) and the {100 * nir_share(bare):.0f} % of its electrons that come from beyond "
        f"{INFRARED_FROM_NM:g} nm and carry no color cost {_cost(after, INFRARED):.1f} dB "
        f"({_cost(before, INFRARED):.1f} dB): its luminance SNR is "
        f"{_db(bare.color_snr_loss_db):.1f} dB below the best linear readout, that of the RGB "
        f"sensor {_db(cut.color_snr_loss_db):.1f} dB. {_at_equal_color(bare, cut)}"
    )


def _at_equal_color(bare: Analysis, cut: Analysis) -> str:
    """The comparison of both sensors that does not depend on one color matrix."""
    found = equal_color([bare.point, cut.point], turns=False)
    best, other = found.standings
    winner = "RGB sensor behind the IR-cut" if best.sensor == cut.sensor.label else "RGBW sensor"
    return (
        f"At equal color error ({found.at_color_error:.1f} Delta E*ab), each with its own best "
        f"matrix, the {winner} has {other.behind_db:.1f} dB less visual noise "
        f"({best.visual_noise:.3g} against {other.visual_noise:.3g})."
    )


def luminance_budget(analysis: Analysis) -> Budget:
    """From all photons down to SNR_Y, cause by cause."""
    budget = color_budget(analysis.scene, analysis.sensor, analysis.exposure, analysis.matrix)
    assert budget is not None  # the paper's white is seen by all of its sensors
    return budget


def _cost(budget: Budget, cause: str) -> float:
    return next(cost.cost_db for cost in budget.costs if cost.cause == cause)


def metric_remark(study: PaperStudy) -> str:
    """Whether printed and computed values can be compared in this metric."""
    if study.metric == "quanta":
        return "Metric quanta, in which the reconstruction was fitted."
    return (
        f"Metric {study.metric}: the reconstruction was fitted in quanta, so only here, and not "
        "with the printed figures, do Tables 4 and 5 show what the other metric does."
    )


def nir_share(analysis: Analysis) -> float:
    """Share of all expected electrons that light beyond 700 nm makes."""
    visible = without_infrared(analysis.scene)
    seen = expected_electrons(visible, analysis.sensor, analysis.exposure)
    return float(1 - seen.sum() / analysis.raw.mean.sum())


def table_5_finding(study: PaperStudy) -> str:
    """Why Table 5's loss is not an effect of the angle, and what the angle does govern."""
    bare, cut = study.greens[G_N], study.greens[G]
    columns = (G_N, G)
    snr_y = [PRINTED_GREEN_SNR_Y_DB[c] for c in columns]
    full = [PRINTED_FULL_WELL_SNR_DB[c] for c in columns]
    raw_g = [PRINTED_RAW_SNR_DB["G"][c] for c in (RGBW_12, RGB_59)]
    error_db = 20 / np.log(10) / np.sqrt(2 * DRAWS)
    reach = [100 * np.cos(np.radians(g.to_axes_deg[0, 1])) ** 2 for g in (bare, cut)]
    return (
        "With one channel Y^ is a constant times the raw signal, so SNR_y equals SNR_raw at any "
        f"angle: {_db(raw_snr_db(bare)['G']):.1f} dB for G_n at "
        f"{1e3 * bare.exposure.time_s:.0f} ms and {_db(raw_snr_db(cut)['G']):.1f} dB for G at "
        f"{1e3 * cut.exposure.time_s:.0f} ms. The printed {snr_y[0]:g} and {snr_y[1]:g} dB are "
        f"Table 2's raw G at 12 and 59 ms ({raw_g[0]:g} and {raw_g[1]:g}) within the Monte Carlo "
        f"error of {error_db:.2f} dB; the printed {full[0]:g} dB is the SNR of a full well, which "
        "neither channel reaches. What the angle "
        f"governs is bias: cos^2 theta is the share of |y|^2 that the channel can reach, "
        f"{reach[0]:.1f} % and {reach[1]:.1f} %."
    )


def set_aside_reasons(study: PaperStudy) -> tuple[str, ...]:
    """Why the paper leaves out its two other sensors, one sentence each.

    Each stands beside the sensor with the same channels that the paper keeps.
    """
    rgb, rgbw = study.set_aside["onyx-rgb"], study.set_aside["onyx-rgbw-ircut"]
    kept_rgb, kept_rgbw = study.columns[RGB_59], study.columns[RGBW_12]
    return (
        f"{_standing(rgb)} Without white and without IR-cut the NIR turns into false color: "
        f"mean error {_error(rgb)} Delta E*ab, against {_error(kept_rgb)} with the IR-cut and "
        f"{_error(kept_rgbw)} with white.",
        f"{_standing(rgbw)} Behind the IR-cut white says little that R, G and B do not, so the "
        "correlation matrix of the kernel is close to singular (the reconstruction was asked for "
        f"this): {kept_rgbw.sensor.name} has VIF up to {kept_rgbw.vif.max():.1f}, condition "
        f"{kept_rgbw.matrix.frame.condition:.1f}. Its color error, {_error(rgbw)} against "
        f"{_error(kept_rgbw)}, is no reason against it; its noise is.",
    )


def _standing(analysis: Analysis) -> str:
    mix = analysis.mix
    near = f"{mix_sentence(mix)} ({100 * mix.explained:.1f} % of it), " if mix else ""
    return (
        f"{analysis.sensor.name}: {near}VIF up to {analysis.vif.max():.1f}, condition "
        f"{analysis.matrix.frame.condition:.1f}."
    )


def _error(analysis: Analysis) -> str:
    error = mean_color_error(analysis)
    return "undefined" if error is None else f"{error:.1f}"


def _db(value: float | None) -> float:
    """The paper's conditions saturate no channel, so every SNR of its study exists."""
    assert value is not None
    return value


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One number of the paper beside ours.

    Attributes
    ----------
    table, row, column
        Where it stands in the paper.
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


@dataclass(frozen=True, kw_only=True)
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
    sampled = {
        column: _sampled(
            analysis, draws=draws, seed=seed, name=(number,), clip=clip, progress=progress
        )
        for number, (column, analysis) in enumerate(analyses.items())
    }
    cells = [
        Cell(
            table=line.table,
            row=line.row,
            column=column,
            quantity=line.quantity,
            unit="dB",
            paper=printed,
            closed_form=_SNR_OF[line.quantity](analyses[column])[line.coordinate],
            **sampled[column][line.quantity, line.coordinate],
        )
        for line in _LINES
        for column, printed in line.printed.items()
    ]
    cells += list(_noiseless_cells(study))
    cells.sort(key=lambda cell: cell.table)
    return Reproduction(study=study, cells=tuple(cells), seed=seed, draws=draws, clipped=clip)


def witnessed_columns(study: PaperStudy) -> dict[str, Analysis]:
    """The columns of the tables that are checked by Monte Carlo."""
    return {**study.columns, **study.greens}


_SNR_OF: dict[str, Callable[[Analysis], dict[str, float | None]]] = {
    "raw SNR": raw_snr_db,
    "contravariant SNR": contravariant_snr_db,
    "Y SNR": color_snr_db,
}


@dataclass(frozen=True)
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


def _sampled(analysis: Analysis, **how: Any) -> dict[tuple[str, str], dict[str, float]]:
    """Monte Carlo of every quantity and coordinate of one column, from the same acquisitions."""
    channels = analysis.sensor.names
    names = {
        "raw SNR": channels,
        "contravariant SNR": channels,
        "Y SNR": analysis.color.names,
    }
    rows = [np.eye(len(channels)), analysis.matrix.frame.inverse_gram, analysis.matrix.matrix]
    found = monte_carlo(analysis.raw.mean, analysis.sensor.pixel, np.vstack(rows), **how)
    keys = [(quantity, name) for quantity, own in names.items() for name in own]
    clipped = np.full(len(keys), found.any_clipped_share)
    clipped[: len(channels)] = found.clipped_share
    numbers = zip(found.snr_db, found.snr_se_db, clipped, strict=True)
    fields = ("monte_carlo", "monte_carlo_se", "clipped_share")
    return {
        key: dict(zip(fields, map(float, own), strict=True))
        for key, own in zip(keys, numbers, strict=True)
    }


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


@dataclass(frozen=True, kw_only=True)
class PaperTable:
    """One of the paper's tables, laid out.

    Attributes
    ----------
    title
        Number and content of the table.
    columns
        Heads of the columns.
    rows
        Head of each row, and a cell per column; ``None`` where the paper has none.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[Cell | None, ...]], ...]


def as_printed(value: float | None) -> str:
    """A number of the paper with the digits that the paper gives it.

    Parameters
    ----------
    value
        The number; ``None`` where the paper gives none.

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


def reproduction_as_json(result: Reproduction) -> dict[str, Any]:
    """The paper's tables with ours beside them, and what they say."""
    times_s = result.study.times_s
    return {
        "version": __version__,
        "seed": result.seed,
        "draws": result.draws,
        "clipped": result.clipped,
        "metric": result.study.metric,
        "tables": [asdict(cell) for cell in result.cells],
        "times_ms": {name: 1e3 * times_s[name] for name in PRINTED_TIMES_MS},
        "verdict": verdict(result.study),
        "table_5": table_5_finding(result.study),
        "set_aside": list(set_aside_reasons(result.study)),
        "note": RECONSTRUCTION,
    }
