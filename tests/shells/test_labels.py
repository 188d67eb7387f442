"""Labels of sensors: shown in place of the name, and without effect on any number."""

import json

import pytest

import chromanoise as cn
from chromanoise.charts import as_data, drawing
from chromanoise.charts.charted_study import shown
from chromanoise.study import study_from_data
from outcomes import refused_input

PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
LABELS = ["New chip", "Old chip"]


def without_labels(result):
    """Plain data without labels and without the sentences that show them."""
    if isinstance(result, dict):
        told = ("label", "sentence", "sentences")
        return {k: without_labels(v) for k, v in result.items() if k not in told}
    return [without_labels(one) for one in result] if isinstance(result, list) else result


@pytest.mark.parametrize("function", [cn.analyze, cn.compare])
def test_a_label_changes_no_digit_and_no_name(function):
    plain, labeled = function(*PAIR).to_dict(), function(*PAIR, labels=LABELS).to_dict()
    assert without_labels(labeled) == without_labels(plain)


def test_a_label_changes_no_pixel_of_a_picture():
    plain, labeled = (
        cn.render("builtin:checker", PAIR[0], **given).captures[0].picture.srgb
        for given in ({}, {"labels": LABELS[:1]})
    )
    assert (plain == labeled).all()


def test_json_has_the_label_beside_the_name():
    found = cn.analyze(*PAIR, labels=["New chip", PAIR[1]]).to_dict()["sensors"]
    assert [(one["name"], one["label"]) for one in found] == [
        ("onyx-rgbw", "New chip"),
        ("onyx-rgb-ircut", "onyx-rgb-ircut"),
    ]


def test_tables_and_sentences_show_labels_in_place_of_names():
    compared = cn.compare(*PAIR, labels=LABELS, matrices=["lmmse"])
    heads = " ".join(column.name for column in compared.to_table().columns)
    sentence = compared.to_dict()["crossovers"][0]["sentence"]
    rows = cn.analyze(*PAIR, labels=LABELS).to_table().rows
    assert [row[0] for row in rows] == LABELS
    for text in (heads, sentence):
        assert all(label in text for label in LABELS)
        assert not any(name in text for name in PAIR)


def test_the_terminal_shows_labels_in_place_of_names(done):
    options = [word for label in LABELS for word in ("--label", label)]
    for command in ("analyze", "compare"):
        out, _ = done(command, *PAIR, *options)
        assert all(label in out for label in LABELS)
        assert not any(name in out for name in PAIR)


def test_charts_show_labels_in_place_of_names():
    sensors = [{"name": name, "label": label} for name, label in zip(PAIR, LABELS, strict=True)]
    of = shown(study_from_data({"sensors": sensors}))
    for part in ("levels", "budget", "stages", "pareto"):
        data = json.dumps(as_data(drawing(part, of)))
        assert all(label in data for label in LABELS)
        assert not any(f'"{name}"' in data for name in PAIR)


def test_a_command_with_labels_is_copied_with_them(done):
    options = ("--label", "New chip", "--label", PAIR[1])
    out, _ = done("analyze", *PAIR, *options, "--copy-as", "python")
    assert 'labels=["New chip", "onyx-rgb-ircut"]' in out


def test_three_labels_for_two_sensors_are_refused():
    with refused_input(subject="labels", value=3):
        cn.compare(*PAIR, labels=["A", "B", "C"])


@pytest.mark.parametrize("labels", [["A", "A"], [PAIR[1], "B"]])
def test_labels_that_do_not_tell_sensors_apart_are_refused(labels):
    with refused_input(subject="labels", value=labels[labels == ["A", "A"]]):
        cn.analyze(*PAIR, labels=labels)


@pytest.mark.parametrize("label", ["", "  ", "two\nlines", "a\x1b[31m"])
def test_a_label_that_cannot_be_shown_is_refused(label):
    with refused_input(subject="labels", value=label):
        cn.analyze("onyx-rgbw", labels=[label])


def test_a_sensor_cannot_be_repeated_under_another_label():
    sensors = [{"name": "onyx-rgbw", "label": label} for label in LABELS]
    with refused_input(subject="name", value="onyx-rgbw"):
        cn.run(study_from_data({"sensors": sensors}))


def test_two_variants_of_one_sensor_keep_their_labels():
    sensors = [
        {"name": "onyx-rgbw", "label": "as built"},
        {"name": "onyx-rgbw", "label": "quiet", "pixel": {"read_noise_e": 2.0}},
    ]
    (result,) = cn.run(study_from_data({"sensors": sensors})).analyses.values()
    found = [(one["name"], one["label"]) for one in result.to_dict()["sensors"]]
    assert found == [("onyx-rgbw", "as built"), ("onyx-rgbw (2)", "quiet")]


def test_no_letter_of_a_long_name_is_cut_on_the_terminal(run):
    long = "a-name-without-any-blank-of-46-letters-in-full"
    out = run("analyze", PAIR[0], "--label", long)[1]
    for head in ("Channels (eq. 1-3, 7", "Spectrum and color (eq. 4-6"):
        rows = [line.split("│") for line in out.partition(head)[2].splitlines() if "│" in line]
        cells = [row[1].strip() for row in rows]
        assert long in "".join(cells)
