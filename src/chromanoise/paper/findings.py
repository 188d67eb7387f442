"""What the numbers of the paper's study say, in sentences."""

import numpy as np

from chromanoise.analysis.analysis import (
    Analysis,
    color_snr_db,
    mean_color_error,
    mix_sentence,
    raw_snr_db,
)
from chromanoise.exposure import expected_electrons
from chromanoise.metrics import Budget, color_budget
from chromanoise.metrics.budget import CORRELATION, INFRARED, without_infrared
from chromanoise.paper.study import (
    DRAWS,
    G_N,
    PRINTED_FULL_WELL_SNR_DB,
    PRINTED_GREEN_SNR_Y_DB,
    PRINTED_RAW_SNR_DB,
    RGB_12,
    RGB_59,
    RGBW_12,
    G,
    PaperStudy,
)
from chromanoise.spectra import INFRARED_FROM_NM


def verdict(study: PaperStudy) -> str:
    """The paper's result in one sentence with its numbers and reasons.

    Parameters
    ----------
    study
        The study.
    """
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
        f"sensor {_db(cut.color_snr_loss_db):.1f} dB."
    )


def luminance_budget(analysis: Analysis) -> Budget:
    """From all photons down to SNR_Y, cause by cause.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    budget = color_budget(analysis.scene, analysis.sensor, analysis.exposure, analysis.matrix)
    assert budget is not None  # the paper's white is seen by all of its sensors
    return budget


def _cost(budget: Budget, cause: str) -> float:
    return next(cost.loss_db for cost in budget.costs if cost.cause == cause)


def metric_remark(study: PaperStudy) -> str:
    """Whether printed and computed values can be compared in this metric.

    Parameters
    ----------
    study
        The study.
    """
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
    """Why Table 5's loss is not an effect of the angle, and what the angle does govern.

    Parameters
    ----------
    study
        The study.
    """
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

    Parameters
    ----------
    study
        The study.
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
