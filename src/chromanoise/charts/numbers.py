"""Numbers as text, for tables, labels and sentences of charts.

The numbers behind each chart as the rows of a CSV file, to full precision.
"""

from collections.abc import Callable, Mapping, Sequence
from decimal import ROUND_HALF_UP, Decimal
from typing import Any

from chromanoise.base import check, csv_text
from chromanoise.charts.description import as_data, csv_rows

NONE = "–"
"""Text of a cell without a value."""
UNDEFINED = "undefined"
"""Text of a cell where a ratio is undefined."""
_MINUS = "\N{MINUS SIGN}"


def decimal(value: float | None, digits: int = 1, none: str = NONE) -> str:
    """A number with fixed decimals, ties rounded away from 0, and a true minus sign.

    Parameters
    ----------
    value
        A finite number, or ``None``.
    digits
        Number of decimals.
    none
        The text for ``None``.

    Examples
    --------
    >>> decimal(12.25, 1), decimal(-0.01, 1), decimal(None, 1)
    ('12.3', '0.0', '–')
    """
    if value is None:
        return none
    text = f"{value:.{digits}f}"
    if (abs(value) * 10.0**digits) % 1 == 0.5:  # a tie, which Python rounds to even
        text = str(Decimal(value).quantize(Decimal(1).scaleb(-digits), ROUND_HALF_UP))
    return text.replace("-", "" if float(text) == 0 else _MINUS)


def signed(value: float, digits: int = 1) -> str:
    """A change in dB with its sign.

    Examples
    --------
    >>> signed(3.14), signed(-3.14), signed(0.01)
    ('+3.1', '−3.1', '0.0')
    """
    text = decimal(value, digits)
    return text if text.startswith(_MINUS) or float(text) == 0 else f"+{text}"


def brief(value: float | None, digits: int = 3) -> str:
    """A number in its shortest form with the given number of significant digits.

    Examples
    --------
    >>> brief(0.05), brief(1234.0), brief(2e-4), brief(205.31, 4)
    ('0.05', '1230', '2.0e−4', '205.3')
    """
    if value is None:
        return NONE
    if value and not 1e-3 <= abs(value) < 1e6:
        mantissa, _, power = f"{value:.1e}".partition("e")
        return f"{mantissa}e{int(power):+d}".replace("-", _MINUS)
    exact = Decimal(value)
    place = Decimal(1).scaleb(exact.adjusted() - digits + 1) if value else Decimal(1)
    text = f"{exact.quantize(place, ROUND_HALF_UP):f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", _MINUS)


def electrons(value: float) -> str:
    """A number of electrons with four significant digits, or more up to whole electrons.

    Examples
    --------
    >>> electrons(12345.6), electrons(205.31), electrons(0.012346)
    ('12346', '205.3', '0.01235')
    """
    return decimal(value, 0) if abs(value) >= 1000 else brief(value, 4)


def percent(share: float) -> str:
    """A share in whole percent.

    Examples
    --------
    >>> percent(0.304)
    '30 %'
    """
    return f"{decimal(100 * share, 0)} %"


def listed(names: Sequence[str]) -> str:
    """Names in one sentence.

    Examples
    --------
    >>> listed(["a"]), listed(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> dict[str, Any]:
    """A table as plain data: one text per column of the head, and of each row."""
    return {"head": list(head), "rows": [list(row) for row in rows]}


Row = list[Any]


def chart_rows(part: str, record: Mapping[str, Any]) -> list[Row]:
    """The numbers behind a chart: first a row of headings with units, then the rows.

    Parameters
    ----------
    part
        A name from `chromanoise.charts.DRAWINGS`.
    record
        Of that chart, from `chromanoise.charts.drawing`.

    Returns
    -------
    list
        Rows of text and numbers, ``None`` where a value is undefined; empty if the chart is.

    Raises
    ------
    InputError
        If there is no such chart.
    """
    data = as_data(record)
    if "columns" in data:
        return csv_rows(data)
    return _ROWS[check.one_of("part", part, tuple(_ROWS))](record)


def chart_csv(part: str, record: Mapping[str, Any]) -> str:
    """`chart_rows` as CSV (RFC 4180, lines end in LF); an undefined value is an empty cell.

    Text that a spreadsheet would interpret as a formula is prefixed with an apostrophe.

    Parameters
    ----------
    part
        A name from `chromanoise.charts.DRAWINGS`.
    record
        Of that chart, from `chromanoise.charts.drawing`.

    Raises
    ------
    InputError
        If there is no such chart.
    """
    return csv_text(chart_rows(part, record))


def text_table(
    part: str, record: Mapping[str, Any], *texts: Callable[[Any], str]
) -> dict[str, Any]:
    """The numbers behind a chart as text.

    Parameters
    ----------
    part, record
        As `chart_rows`.
    texts
        The text of a value in each column; the last also in all columns after it.
    """
    head, *rows = chart_rows(part, record)
    each = [*texts, *[texts[-1]] * (len(head) - len(texts))]
    shown = [[text(value) for text, value in zip(each, row, strict=True)] for row in rows]
    return table([name.replace("Delta E", "ΔE") for name in head], shown)


def _columns(*columns: tuple[str, Sequence[Any]]) -> list[Row]:
    """Heads with the values under them."""
    return [
        [head for head, _ in columns],
        *map(list, zip(*(one for _, one in columns), strict=True)),
    ]


def _head(record: Mapping[str, Any]) -> list[Row]:
    rows = [
        [one["name"], name, mean_e, one["full_well_e"], one["time_ms"], one["f_number"]]
        for one in record["sensors"]
        for name, mean_e in one["mean_e"].items()
    ]
    head = ["sensor", "channel", "electrons of a white [e-]", "full well [e-]"]
    return [[*head, "exposure time [ms]", "f-number"], *rows]


def _stages(record: Mapping[str, Any]) -> list[Row]:
    names = [one["name"] for one in record["sensors"]]
    rows = [
        [kind["title"], kind["unit"], line["name"], *line["values"]]
        for kind in record["kinds"]
        for line in kind["lines"]
    ]
    return [["kind", "unit", "channel or coordinate", *names], *rows]


def _budget(record: Mapping[str, Any]) -> list[Row]:
    rows = [
        [one["name"], step["label"], step["change_db"], step["from_db"], step["to_db"]]
        for one in record["sensors"]
        for step in one["steps"]
    ]
    snr = f"SNR of {record['coordinate']}"
    return [["sensor", "step", "change [dB]", f"{snr} before [dB]", f"{snr} [dB]"], *rows]


def _map(record: Mapping[str, Any]) -> list[Row]:
    if record["why_not"] is not None:
        return []
    x, y, sensors, unit = record["x"], record["y"], record["sensors"], record["unit"]
    rows = [
        [across, up, *(one["values"][j][k] for one in sensors)]
        for j, up in enumerate(y["values"])
        for k, across in enumerate(x["values"])
    ]
    return [[x["what"], y["what"], *(f"{one['name']} [{unit}]" for one in sensors)], *rows]


def vector_rows(record: Mapping[str, Any], *, drawn: bool = False) -> list[Row]:
    """The rows of the chart ``vectors``: half axes as long as they are, or as they are drawn.

    Parameters
    ----------
    record
        Of the chart.
    drawn
        Whether half axes are magnified.
    """
    rows = [["color axes", axis["name"], *axis["at"], None] for axis in record["axes"]]
    rows.append(["scene", "true light", *record["scene"]["at"], record["scene"]["norm_share"]])
    for one in record["sensors"]:
        light = [{"name": "light", **one["light"]}] if one["light"] else []
        rows += [
            [one["name"], arrow["name"], *arrow["at"], arrow["norm_share"]]
            for arrow in (*one["channels"], *light)
        ]
        times = one["magnification"]
        for k, axis in enumerate((one["ellipsoid"] or {}).get("half_axes", ()), 1):
            how = f", ×{brief(times)}" if drawn else f" of {record['sigmas']:g} sigma"
            lengths = axis if drawn else [value / times for value in axis]
            rows.append([one["name"], f"half axis {k}{how}", *lengths, None])
    return [["sensor", "vector", "first", "second", "third", "share of squared norm"], *rows]


def _chart(record: Mapping[str, Any]) -> list[Row]:
    names = [patch["name"] for patch in record["patches"]]
    blank = [dict.fromkeys(("delta_e", "noise"))] * len(names)
    errors = [
        (f"{one['name']} {what} [Delta E*ab]", [patch[key] for patch in one["patches"] or blank])
        for one in record["sensors"]
        for what, key in (("color error", "delta_e"), ("color noise", "noise"))
    ]
    return _columns(("patch", names), *errors)


_ROWS: Mapping[str, Callable[[Mapping[str, Any]], list[Row]]] = {
    "head": _head,
    "stages": _stages,
    "budget": _budget,
    "map": _map,
    "vectors": vector_rows,
    "chart": _chart,
}
