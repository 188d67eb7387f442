"""CGATS tables of spectra, such as the ``.sp`` files of Argyll."""

import re

import numpy as np

from chromanoise.errors import InputError
from chromanoise.io.spectra.parsed import Column, Found, Level, Per, Quantity, has
from chromanoise.io.spectra.tables import finite_number, number_in

_TOKEN = re.compile(r'"[^"\n]*"|\S+')
_FIELD = re.compile(r"(?:SPEC(?:TRAL)?_?(?:NM)?_?|NM_?|R_)(\d+(?:\.\d+)?)", re.IGNORECASE)
_KINDS: dict[str, tuple[Quantity, Per | None, Level | None]] = {
    "EMISSION": ("power", "energy", "absolute"),
    "AMBIENT": ("power", "energy", "absolute"),
    "EMISSION_FLASH": ("power", "energy", "absolute"),
    "AMBIENT_FLASH": ("power", "energy", "absolute"),
    "REFLECTIVE": ("reflectance", None, None),
    "TRANSMISSIVE": ("transmittance", None, None),
    "SENSITIVITY": ("response", None, None),
}
_Token = tuple[int, str]


def is_cgats(text: str) -> bool:
    """Whether the text has the table of a CGATS file."""
    return "BEGIN_DATA_FORMAT" in text and "BEGIN_DATA" in text


def read_cgats(text: str, source: str) -> Found:
    """The spectra of the first table, one curve per set.

    Raises
    ------
    InputError
        If the table has no spectral fields, or a value is not a number; the message names the line.
    """
    tokens = _tokens(text)
    words = [token for _, token in tokens]
    fields = words[_between(words, "BEGIN_DATA_FORMAT", "END_DATA_FORMAT", source)]
    table = _between(words, "BEGIN_DATA", "END_DATA", source)
    facts = _facts(tokens[: words.index("BEGIN_DATA_FORMAT")])
    spectral = [i for i, field in enumerate(fields) if _FIELD.fullmatch(field)]
    wavelength = _wavelengths(facts, [fields[i] for i in spectral], source)
    sets = _sets(tokens[table], fields, source)
    norm = _norm(facts, source)
    values = (
        np.array(
            [
                [finite_number(row[i][1], source, f"line {row[i][0]}") for i in spectral]
                for row in sets
            ]
        )
        / norm
    )
    quantity, per, level = _KINDS.get(facts.get("MEAS_TYPE", "").upper(), (None, None, None))
    notes = (f"values divided by SPECTRAL_NORM {norm:g}",) if norm != 1 else ()
    return Found(
        source=source,
        format="CGATS",
        columns=tuple(
            Column(name=_name(row, fields, k), wavelength=wavelength, values=values[k])
            for k, row in enumerate(sets)
        ),
        words=" ".join(facts.values()),
        wavelength_unit="nm",
        quantity=quantity,
        per=per,
        level=level,
        notes=notes,
    )


def _tokens(text: str) -> list[_Token]:
    return [
        (number, token.strip('"'))
        for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1)
        if not line.lstrip().startswith("#")
        for token in _TOKEN.findall(line)
    ]


def _between(words: list[str], first: str, last: str, source: str) -> slice:
    try:
        start = words.index(first) + 1
        return slice(start, words.index(last, start))
    except ValueError:
        raise InputError(
            source, f"must have {first} and {last} around a part of a CGATS file"
        ) from None


def _facts(tokens: list[_Token]) -> dict[str, str]:
    """The first two words of each line."""
    lines: dict[int, list[str]] = {}
    for number, token in tokens:
        lines.setdefault(number, []).append(token)
    return {line[0]: line[1] for line in lines.values() if len(line) > 1}


def _wavelengths(facts: dict[str, str], fields: list[str], source: str) -> np.ndarray:
    if len(fields) < 2:
        need = "must have at least 2 spectral fields (SPEC_400 ...) in its CGATS table"
        raise has(source, need, len(fields), remedy="check that it is a table of spectra")
    named = np.array([float(match[1]) for f in fields if (match := _FIELD.fullmatch(f))])
    ends = [facts.get(key, "") for key in ("SPECTRAL_START_NM", "SPECTRAL_END_NM")]
    if not all(np.isfinite(number_in(end)) for end in ends):
        return named
    expected = np.linspace(number_in(ends[0]), number_in(ends[1]), named.size)
    if np.abs(expected - named).max() > 1.0:  # the names of the fields are rounded
        raise InputError(
            source,
            "SPECTRAL_START_NM and SPECTRAL_END_NM must agree with the fields",
            value=(ends[0], ends[1]),
            found=f"are {ends[0]} and {ends[1]}, and the fields are {fields[0]} to {fields[-1]}",
        )
    return expected


def _norm(facts: dict[str, str], source: str) -> float:
    text = facts.get("SPECTRAL_NORM", "1")
    norm = number_in(text)
    if not 1e-30 < norm < 1e30:
        raise InputError(source, "must be a number > 0", value=text, where="SPECTRAL_NORM")
    return norm


def _sets(tokens: list[_Token], fields: list[str], source: str) -> list[list[_Token]]:
    if not tokens or len(tokens) % len(fields):
        line = tokens[-1][0] if tokens else 0
        raise InputError(
            source,
            f"must have sets of {len(fields)} values, as many as fields",
            value=len(tokens),
            found=f"has {len(tokens)} values in all",
            where=f"line {line}",
        )
    return [tokens[i : i + len(fields)] for i in range(0, len(tokens), len(fields))]


def _name(row: list[_Token], fields: list[str], k: int) -> str:
    for key in ("SAMPLE_NAME", "SAMPLE_ID", "SAMPLE_LOC"):
        if key in fields and row[fields.index(key)][1]:
            return row[fields.index(key)][1]
    return f"sample {k + 1}"
