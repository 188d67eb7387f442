"""The reproduction of the paper as plain data."""

from dataclasses import asdict
from typing import Any

from chromanoise import __version__
from chromanoise.catalog.sensors import RECONSTRUCTION
from chromanoise.paper.findings import set_aside_reasons, table_5_finding, verdict
from chromanoise.paper.reproduction import Reproduction
from chromanoise.paper.study import PRINTED_TIMES_MS


def reproduction_as_json(result: Reproduction) -> dict[str, Any]:
    """The paper's tables with ours beside them, and what they say.

    Parameters
    ----------
    result
        The reproduction.
    """
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
