"""CSV that a spreadsheet does not read as formulas, and that is read back to the same text."""

import csv
import io
import re
from collections.abc import Iterable
from typing import Any

_FORMULA = r"'*\s*[=+\-@\t＝＋－＠]"
_GUARDED = re.compile(f"'(?={_FORMULA})")
_BEGIN = re.compile(f"(?={_FORMULA})")
_SEPARATED = re.compile(rf"([,;\t]\s*)(?={_FORMULA})")
_SEPARATED_GUARDED = re.compile(rf"([,;\t]\s*)'(?={_FORMULA})")


def csv_text(rows: Iterable[Iterable[Any]]) -> str:
    r"""Rows as CSV (RFC 4180, lines end in LF): numbers with all digits, ``None`` as an empty cell.

    Parameters
    ----------
    rows
        Rows of text and numbers. Text that a spreadsheet would interpret as a formula is prefixed
        with an apostrophe (OWASP, CSV injection).

    Examples
    --------
    >>> csv_text([["=1+1", "my sensor", -3.2, None]])
    "'=1+1,my sensor,-3.2,\n"
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([_cell(one) if isinstance(one, str) else one for one in row] for row in rows)
    return text.getvalue()


def csv_comment(key: str, value: str) -> str:
    """A comment line ``# key: value`` of a CSV, in which no cell looks like a formula.

    Parameters
    ----------
    key, value
        Spaces and line ends in the value become single spaces.
    """
    return f"# {key}: {_SEPARATED.sub(_guard_after, ' '.join(value.split()))}\n"


def text_of_cell(cell: str) -> str:
    """The original text of a cell that `csv_text` wrote.

    Examples
    --------
    >>> text_of_cell("'=1+1"), text_of_cell("'tis")
    ('=1+1', "'tis")
    """
    return _GUARDED.sub("", cell, count=1) if _GUARDED.match(cell) else cell


def text_of_comment(value: str) -> str:
    """The original value of a comment that `csv_comment` wrote.

    Examples
    --------
    >>> text_of_comment("a, '-b, c")
    'a, -b, c'
    """
    return _SEPARATED_GUARDED.sub(r"\1", value)


def _cell(text: str) -> str:
    plain = text.replace("\r\n", "\n").replace("\r", "\n")  # csv would leave a lone \r unquoted
    return f"'{plain}" if _BEGIN.match(plain) else plain


def _guard_after(match: re.Match[str]) -> str:
    return f"{match[1]}'"
