"""Names of sensors and matrices as parts of file names."""

from collections.abc import Sequence

from chromanoise._check import distinct
from chromanoise.exposure import OperatingPoint


def refuse_shared_file_names(operating_points: Sequence[OperatingPoint]) -> None:
    """Refuse sensors whose names differ, but not as parts of names of files."""
    distinct("file names of sensors", [file_word(each.sensor.name) for each in operating_points])


def file_word(name: str) -> str:
    """A name as a file's name or a part of one: it leads into no other folder and hides nothing.

    Parameters
    ----------
    name
        The name.

    Examples
    --------
    >>> file_word("../../a b")
    '-.-..-a-b'
    """
    word = "".join(c if c.isalnum() or c in "+-_." else "-" for c in name)
    return f"-{word[1:]}" if word.startswith(".") else word
