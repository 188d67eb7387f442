"""Text to an XML tree, without document types and entities."""

import re
from xml.etree import ElementTree

from chromanoise.base import InputError


def xml_root(text: str, source: str) -> ElementTree.Element:
    """The root element of an XML text.

    Parameters
    ----------
    text
        Decoded; an encoding in its declaration is not used.
    source
        Name of the file, for messages.

    Raises
    ------
    InputError
        If the text is not XML, or declares a document type or entity, which could expand to any
        size.
    """
    if re.search(r"<!\s*(DOCTYPE|ENTITY)", text, re.IGNORECASE):
        raise InputError(source, "must not declare a document type", remedy="remove it")
    plain = re.sub(r"\A\s*<\?xml[^>]*\?>", "", text)
    try:
        return ElementTree.fromstring(plain)
    except ElementTree.ParseError as error:
        line, column = error.position
        line += text[: text.find("?>") + 2].count("\n") if plain != text else 0
        raise InputError(
            source, f"is not XML ({error})", where=f"line {line}, column {column + 1}"
        ) from None
