"""The numbers of a chart by their headings."""

from chromanoise.charts import as_data
from chromanoise.charts.description import csv_rows


def rows_of(chart):
    """A record per row of the CSV of a chart or of its plain data."""
    head, *rows = csv_rows(as_data(chart))
    return [dict(zip(head, row, strict=True)) for row in rows]


def stages_of(chart):
    """Of each sensor of the chart ``stages`` its values by kind, then by channel or coordinate."""
    data = as_data(chart)
    found = [{} for _ in data["sensors"]]
    for (kind, _, line, *values), texts in zip(
        csv_rows(data)[1:], data["table"]["rows"], strict=True
    ):
        for one, value, text in zip(found, values, texts[2:], strict=True):
            if text != "–":  # it has no such channel
                one.setdefault(kind, {})[line] = value
    return found


def steps_of(chart):
    """Of each sensor of the chart ``budget`` its steps: label, change, before, after.

    The gain of removing the cause of a step is not among them: `gains_of`.
    """
    found = {name: [] for name in as_data(chart)["sensors"]}
    for name, *step in csv_rows(as_data(chart))[1:]:
        label, change, _, before, after = step
        found[name].append([label, change, before, after])
    return list(found.values())


def gains_of(chart):
    """Of each sensor of the chart ``budget`` what removing the cause of each step would gain."""
    found = {name: [] for name in as_data(chart)["sensors"]}
    for row in rows_of(chart):
        found[row["sensor"]].append(row["gain if removed [dB]"])
    return found
