"""The formulas of page and reports as MathML: ``python tools/make_formulas.py``."""

import json
from pathlib import Path

FORMULAS = Path(__file__).parents[1] / "src" / "chromanoise" / "charts" / "formulas.json"


def formulas() -> dict[str, dict[str, str]]:
    """MathML by LaTeX, of all explanations and of the tables of the paper."""
    from latex2mathml.converter import convert

    from chromanoise.charts.explanations import EXPLANATIONS
    from chromanoise.web.report_bundle import PAPER_FORMULAS

    each = EXPLANATIONS.values()
    found = {
        "block": {latex for one in each for latex in one.latex},
        "inline": {*PAPER_FORMULAS.values(), *(s.latex for one in each for s in one.symbols)},
    }
    return {
        display: {latex: convert(latex, display=display) for latex in sorted(some)}
        for display, some in found.items()
    }


def main() -> None:
    """Write the file anew."""
    text = json.dumps(formulas(), indent=1, ensure_ascii=False)
    FORMULAS.write_text(f"{text}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
