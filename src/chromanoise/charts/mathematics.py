"""Formulas in LaTeX as MathML, for the page, reports and the demo."""

from functools import lru_cache
from html import escape


@lru_cache(maxsize=512)
def mathml(latex: str, *, block: bool = False) -> str:
    r"""A formula as one MathML element, which browsers draw and screen readers speak.

    Parameters
    ----------
    latex
        The formula, without dollar signs; no text of a user, which could hold markup.
    block
        Whether it stands in a line of its own.

    Examples
    --------
    >>> mathml("M^i").startswith("<math")
    True
    """
    from latex2mathml.converter import convert  # an analysis needs no formulas

    return convert(latex, display="block" if block else "inline")


def coordinate_mathml(coordinate: str) -> str:
    """A contravariant coordinate as one MathML element; the name of its channel is plain text.

    Parameters
    ----------
    coordinate
        ``M^`` and the name of a channel, which a file may give.

    Examples
    --------
    >>> coordinate_mathml("M^<b>").partition("<msup>")[2].partition("</msup>")[0]
    '<mi>M</mi><mtext>&lt;b&gt;</mtext>'
    """
    letter, _, channel = coordinate.partition("^")
    raised = f"<msup><mi>{escape(letter)}</mi><mtext>{escape(channel)}</mtext></msup>"
    return f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="inline">{raised}</math>'
