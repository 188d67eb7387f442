"""Formulas in LaTeX as MathML, for the page, reports and the demo."""

from functools import lru_cache


@lru_cache(maxsize=512)
def mathml(latex: str, *, block: bool = False) -> str:
    r"""A formula as one MathML element, which browsers draw and screen readers speak.

    Parameters
    ----------
    latex
        The formula, without dollar signs.
    block
        Whether it stands in a line of its own.

    Examples
    --------
    >>> mathml("M^i").startswith("<math")
    True
    """
    from latex2mathml.converter import convert  # an analysis needs no formulas

    return convert(latex, display="block" if block else "inline")


def coordinate_latex(coordinate: str) -> str:
    r"""The symbol of a coordinate of a budget or of a row of a table.

    Examples
    --------
    >>> coordinate_latex("M^R"), coordinate_latex("L*"), coordinate_latex("Y")
    ('M^{\\mathrm{R}}', 'L^*', 'Y')
    """
    letter, power, channel = coordinate.partition("^")
    if power:
        return rf"{letter}^{{\mathrm{{{channel}}}}}"
    return f"{letter[:-1]}^*" if letter.endswith("*") else letter
