"""SNR over the light level, and where sensors change places."""

import math
from typing import Any

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.study.comparing.crossing import (
    Crossover,
    Incomparable,
    crossover_sentence,
    crossovers_or_reasons,
)
from chromanoise.study.comparing.curves import compared
from chromanoise.study.comparing.quantities import QUANTITIES, Quantity, fullest_level_lux
from chromanoise.study.comparing.sweeps import SWEEPS, swept_values
from chromanoise.study.defined import defined
from chromanoise.study.drawings.shown import Look, Shown

LOWEST_LUX, HIGHEST_LUX = 0.01, 10_000.0
"""Of the curves, and of the page's slider: moonlight to a cloudy day."""
_PER_DECADE = 12  # the points of ``chromanoise compare`` are among them
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def drawn_levels(shown: Shown, look: Look) -> dict[str, Any]:
    """Curves of SNR over lux, each sensor with each matrix, and their crossovers.

    The times are those of the study's own level, as in ``chromanoise compare``.
    """
    sweep = SWEEPS["lux"]
    quantity = _quantity(look)
    values = drawn_lux(shown)
    makers = shown.makers
    curves = compared(shown.situations, makers, values, sweep=sweep, quantity=quantity)
    pairs = crossovers_or_reasons(shown.situations, makers, curves)
    fullest = [fullest_level_lux(one) for one in shown.situations for _ in makers]
    return {
        "lux": values.tolist(),
        "now_lux": shown.study.light.level_lux,
        "quantity": quantity.what,
        "unit": quantity.unit,
        "curves": [
            {
                "sensor": curve.sensor,
                "matrix": curve.matrix,
                "values": [defined(value) for value in curve.value.tolist()],
                "saturated_from_lux": full if full is not None and full < values[-1] else None,
            }
            for curve, full in zip(curves, fullest, strict=True)
        ],
        "crossovers": [entry for pair in pairs for entry in _crossed(pair)],
    }


def drawn_lux(shown: Shown) -> Float[Array, " k"]:
    """The light levels of the curves, to whole decades beyond a level that stands outside. [lx]"""
    sweep, level = SWEEPS["lux"], shown.study.light.level_lux
    first = min(LOWEST_LUX, 10.0 ** math.floor(math.log10(level)))
    last = max(HIGHEST_LUX, 10.0 ** math.ceil(math.log10(level)))
    points = 1 + _PER_DECADE * round(math.log10(last / first))
    return swept_values(sweep, max(first, sweep.lowest), min(last, sweep.highest), points)


def level_in_words(level_lux: float, digits: int = 3) -> str:
    """A light level as people write it, with a power of ten where zeros would have to be counted.

    Parameters
    ----------
    level_lux
        > 0. [lx]
    digits
        That count.

    Examples
    --------
    >>> level_in_words(12.34), level_in_words(0.0000133), level_in_words(20000.0)
    ('12.3 lx', '1.33·10⁻⁵ lx', '20000 lx')
    """
    mantissa, _, power = f"{level_lux:.{digits - 1}e}".partition("e")
    told = float(f"{mantissa}e{power}")
    if 1e-3 <= told < 1e6:
        return f"{told:.15g} lx"
    factor = f"{float(mantissa):g}"
    ten = f"10{str(int(power)).translate(_SUPERSCRIPT)} lx"
    return ten if factor == "1" else f"{factor}·{ten}"


def _quantity(look: Look) -> Quantity:
    """Of X, Y or Z where one of them is looked at, else of Y."""
    return QUANTITIES.get(f"snr-{look.coordinate.lower()}", QUANTITIES["snr-y"])


def _crossed(pair: Crossover | Incomparable) -> list[dict[str, Any]]:
    """One entry for each level at which two change places, else one that says why there is none."""
    between = {"first": pair.first, "second": pair.second, "matrix": pair.matrix}
    if isinstance(pair, Incomparable):
        return [{"lux": None, "sentence": pair.why, **between}]
    sentence = crossover_sentence(pair)
    return [{"lux": at, "sentence": sentence, **between} for at in pair.at or (None,)]
