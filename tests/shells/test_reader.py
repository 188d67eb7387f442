"""``--reader machine`` and ``--pairs``: what a machine tells apart, from every interface."""

import json

import pytest

import chromanoise as cn
from chromanoise.spectra import DEFAULT_GRID, colorchecker
from chromanoise.web.answers import ChartReplies
from chromanoise.web.page_studies import Studies
from chromanoise.web.uploads import Uploads
from outcomes import refused

LIGHT = ("--lux", "10", "--time-ms", "12")
DISTANCES = ("raw", "color", "raw_without_brightness", "color_without_brightness")


def separation(done, *options):
    out, _ = done("analyze", "onyx-rgbw", *LIGHT, "--reader", "machine", "--json", "-", *options)
    return json.loads(out)["sensors"][0]["separation"]


def test_the_json_has_medians_with_probabilities_and_the_worst_pair(done):
    found = separation(done)
    assert found["pairs"] == 276
    for name in DISTANCES:
        assert found[f"median_{name}"] > found["worst_pair"][name] > 0
        assert 0.5 < found["worst_pair"][f"{name}_probability"] < 1
        assert found[f"median_{name}_probability"] > 0.99
    assert set(found["worst_pair"]["names"]) == {"orange", "orange yellow"}


def test_for_an_eye_nothing_of_a_machine_is_computed(done):
    out, _ = done("analyze", "onyx-rgbw", *LIGHT, "--json", "-")
    (sensor,) = json.loads(out)["sensors"]
    assert not {"separation", "contrast_detection"} & set(sensor)


@pytest.mark.parametrize("outputs", [{"reader": "machine"}, {"clip": True, "budget": False}])
def test_the_page_answers_for_these_outputs_whatever_was_asked_before(outputs):
    def parts(replies, outputs):
        study = {"sensors": [{"name": "onyx-rgbw"}], "outputs": outputs}
        question = {"number": 1, "study": study, "want": ["head", "levels", "stages"], "look": {}}
        return json.loads(replies.answer(question))["parts"]

    asked_before = ChartReplies(Studies(Uploads()))
    others = parts(asked_before, {})
    found = parts(asked_before, outputs)
    assert found == parts(ChartReplies(Studies(Uploads())), outputs)
    assert found != others


def test_a_list_of_pairs_names_patches_of_the_chart_and_the_catalog(done, here):
    (here / "pairs.csv").write_text("# mine\nfirst,second\nred,green\nlawn,0.18\nred,lawn\n")
    found = separation(done, "--pairs", "pairs.csv")
    assert found["pairs"] == 3
    assert set(found["worst_pair"]["names"]) < {"red", "green", "lawn", "0.18"}


def test_a_file_of_reflectances_gives_all_its_pairs(done, here):
    chart = colorchecker(DEFAULT_GRID)
    rows = ["wavelength_nm,red,amber,green"]
    for nm, values in zip(chart.wavelength_nm, chart.values[:, [14, 15, 13]], strict=True):
        rows.append(",".join(map(repr, [float(nm), *map(float, values)])))
    (here / "signals.csv").write_text("\n".join(rows) + "\n")
    found = separation(done, "--pairs", "signals.csv")
    assert found["pairs"] == 3
    (here / "same.csv").write_text("first,second\nred,yellow\nred,green\nyellow,green\n")
    named = separation(done, "--pairs", "same.csv")
    for name in DISTANCES:
        assert found[f"median_{name}"] == pytest.approx(named[f"median_{name}"], rel=1e-9)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("first,second\nred,redd\n", "redd"),
        ("first,second\nred,green,blue\n", "red,green,blue"),
        ("first,second\nred,red\n", "red"),
        ("first,second\nred,leaf.csv\n", "leaf.csv"),
        ("first,second\nred,1.5\n", 1.5),
    ],
)
def test_a_wrong_line_of_a_list_is_named(run, here, text, value):
    (here / "pairs.csv").write_text(text)
    outcome = run("analyze", "onyx-rgbw", "--reader", "machine", "--pairs", "pairs.csv")
    refused(outcome, value=value)


def test_a_list_may_have_the_line_ends_of_any_system(done, here):
    (here / "pairs.csv").write_bytes(b"first,second\rred,green\rred,blue\r\n")
    assert separation(done, "--pairs", "pairs.csv")["pairs"] == 2


@pytest.mark.parametrize(
    "text", ["", "first,second\n", "hello\n", "\0" * 200_000, 'first,second\n"red,' + "a" * 140_000]
)
def test_a_file_without_pairs_is_refused(run, here, text):
    (here / "pairs.csv").write_text(text)
    refused(run("analyze", "onyx-rgbw", "--reader", "machine", "--pairs", "pairs.csv"), "pairs.csv")


@pytest.mark.evidence
def test_a_comparison_of_separations_crosses_where_the_medians_do(done):
    out, _ = done(
        "compare", "onyx-rgbw", "onyx-rgb-ircut", "--quantity", "separation-without-brightness",
        "--sweep", "lux=1:8", "--points", "7", "--time-ms", "12", "--json", "-",
    )  # fmt: skip
    (crossover,) = json.loads(out)["crossovers"]
    (lux,) = crossover["at"]
    both = cn.analyze(
        "onyx-rgbw", "onyx-rgb-ircut", lux=lux, time_ms=12, reader="machine"
    ).to_dict()["sensors"]
    medians = [one["separation"]["median_raw_without_brightness"] for one in both]
    assert medians[0] == pytest.approx(medians[1], rel=2e-3)


@pytest.mark.evidence
@pytest.mark.usefixtures("plain_report")
def test_the_report_for_a_machine_has_the_medians_of_the_command(done, here):
    (here / "s.toml").write_text(
        '[[sensors]]\nname = "onyx-rgbw"\n[exposure]\ntime_ms = 12\n[outputs]\nreader = "machine"\n'
    )
    done("report", "s.toml", "-o", "s.html")
    found = separation(done)
    text = (here / "s.html").read_text()
    for name in DISTANCES:
        cell = (
            f"<td>{found[f'median_{name}']:#.3g} ({found[f'median_{name}_probability']:.3f})</td>"
        )
        assert cell in text


def test_a_comparison_of_raw_values_says_nothing_of_matrix_and_color_error(done):
    lines = []
    for quantity in ("separation-without-brightness", "color-separation"):
        out, _ = done(
            "compare", "onyx-rgbw", "onyx-rgb-ircut", "--quantity", quantity,
            "--sweep", "lux=1:8", "--points", "3", "--time-ms", "12",
        )  # fmt: skip
        lines.append(out)
    raw, color = lines
    assert " | 12.4" not in raw
    assert " | 12.4" in color
