"""Design files: forms of a number, what is refused with its key, references as limits."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from chromanoise.apps.design import (
    DESIGN_STARTER,
    OBJECTIVES,
    DesignStudy,
    optimized,
    read_design,
    with_effort,
)
from chromanoise.apps.design.algorithms import METHODS
from chromanoise.apps.design.optimizing import task_of
from chromanoise.apps.design.parameters import Free, noise_properties
from chromanoise.apps.design.search import MOST_POPULATION
from chromanoise.base.errors import errors_in
from chromanoise.sensor import dye_transmittances
from chromanoise.sensor.filter_models import FILTER_MODELS
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import sensor_named
from outcomes import refused_input

EXAMPLES = Path(__file__).parents[2] / "examples/designs"
HEAD = """
[[sensors]]
name = "onyx-rgbw"
[[sensors]]
name = "onyx-rgb-ircut"
label = "RGB"
[design]
objectives = ["snr_y_db", "delta_e"]
budget = 16
population = 8
polish = false
"""
CHANNEL = """
[[design.channels]]
name = "R"
filter = "gaussian"
center_nm = [560, 680]
width_nm = 40
"""


def read(tmp_path, text):
    file = tmp_path / "design.toml"
    file.write_text(text)
    return read_design(file)


def refused_keys(tmp_path, text):
    """The keys of the errors in a design."""
    with refused_input() as caught:
        read(tmp_path, text)
    return [one.setting for one in errors_in(caught.value)]


def test_the_starter_is_a_design_with_two_references_and_seven_free_numbers(tmp_path):
    document = read(tmp_path, DESIGN_STARTER)
    task = task_of(document)
    assert [one.name for one in task.references] == ["onyx-rgbw", "onyx-rgb-ircut"]
    assert [one.name for one in task.space.parameters] == [
        *("R.center_nm", "R.width_nm", "G.center_nm", "G.width_nm"),
        *("B.center_nm", "B.width_nm", "ir_cut.cutoff_nm"),
    ]


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("610", 610.0),
        ("[560, 680]", Free(low=560.0, high=680.0)),
        ("{low = 560, high = 680}", Free(low=560.0, high=680.0)),
        (
            "{low = 560, high = 680, start = 600, tolerance = 5}",
            Free(low=560.0, high=680.0, start=600.0, tolerance=5.0),
        ),
        ('"R.width_nm"', "R.width_nm"),
    ],
)
def test_a_number_is_fixed_free_or_tied(tmp_path, written, value):
    text = HEAD + CHANNEL.replace("[560, 680]", written).replace("40", "[120, 600]")
    document = read(tmp_path, text)
    assert document.design.channels[0].numbers["center_nm"] == value


@pytest.mark.parametrize(
    ("change", "setting"),
    [
        (("[560, 680]", "[680, 560]"), "design.channels.0.center_nm"),
        (("[560, 680]", "[560]"), "design.channels.0.center_nm"),
        (("[560, 680]", "true"), "design.channels.0.center_nm"),
        (("[560, 680]", "[-5, 680]"), "design.channels.0.center_nm"),
        (("[560, 680]", "[0.56, 0.68]"), "design.channels.0.center_nm"),
        (("width_nm", "widht_nm"), "design.channels.0.widht_nm"),
        (("width_nm = 40", ""), "design.channels.0.width_nm"),
        (("width_nm = 40", 'width_nm = "G.width_nm"'), "design.channels.0.width_nm"),
        (("width_nm = 40", "width_nm = 40\n[design.pixel]\npitch_um = 3"), "design.pixel.pitch_um"),
        (("width_nm = 40", "width_nm = 40\n[design.pixel]\nprnu = [0, 2]"), "design.pixel.prnu"),
        (('"gaussian"', '"bell"'), "design.channels.0.filter"),
        (('"snr_y_db"', '"snr"'), "design.objectives.0"),
        (("budget = 16", "budget = 4"), "design.budget"),
        (("budget = 16", 'base = "mono"'), "design.base"),
        (("[560, 680]", "600"), "design"),
        (("[560, 680]", "{low = 560, high = 680, tol = 5}"), "design.channels.0.center_nm"),
        (("[560, 680]", "nan"), "design.channels.0.center_nm"),
        (('"delta_e"]', '"snr_y_db"]'), "design.objectives"),
        (("budget = 16", 'budget = 16\nmethod = "de"'), "design.method"),
    ],
)
def test_what_a_design_cannot_use_is_refused_with_its_key(tmp_path, change, setting):
    text = (HEAD + CHANNEL).replace(*change)
    with refused_input(setting=None) as caught:
        read(tmp_path, text)
    assert setting in [one.setting for one in errors_in(caught.value)]
    assert all(place.startswith(str(tmp_path)) for place in caught.value.places)


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ('[[sweeps]]\nvary = "lux"\nfirst = 1\nlast = 9\nquantity = "snr-y"', "sweeps"),
        ('[exposure]\nequal = "saturation"', "exposure.equal"),
        ("[outputs]\nmerit = true", "outputs"),
    ],
)
def test_a_table_without_effect_on_a_design_is_refused(tmp_path, table, key):
    assert refused_keys(tmp_path, HEAD + CHANNEL + table) == [key]


def constraint(side, limit):
    return f'[[design.constraints]]\nobjective = "delta_e"\n{side} = {limit}\n'


@pytest.mark.parametrize("limit", ['"RGB"', '"onyx-rgb-ircut"', '"best reference"'])
def test_the_limit_of_a_reference_is_its_own_value(tmp_path, limit):
    task = task_of(read(tmp_path, HEAD + CHANNEL + constraint("at_most", limit)))
    (one,) = task.limits
    values = {each.name: each.objectives["delta_e"] for each in task.references}
    assert (one.origin, one.value) == ("RGB", values["RGB"])
    assert values["RGB"] < values["onyx-rgbw"]


@pytest.mark.parametrize(
    ("text", "where"),
    [
        (constraint("at_most", '"CMY"'), "design.constraints.0.at_most"),
        (constraint("at_most", "5") + "at_least = 1\n", "design.constraints.0.at_most"),
        ('[[design.constraints]]\nobjective = "delta_e"\n', "design.constraints.0.at_most"),
    ],
)
def test_a_constraint_has_one_limit_that_is_a_number_or_a_reference(tmp_path, text, where):
    assert refused_keys(tmp_path, HEAD + CHANNEL + text) == [where]


def test_the_identity_of_a_design_depends_on_all_but_the_effort_of_the_search(tmp_path):
    def identity(text):
        return task_of(read(tmp_path, text)).identity

    first = identity(HEAD + CHANNEL)
    assert identity(HEAD.replace("16", "64").replace("= 8", "= 4") + CHANNEL) == first
    assert identity(HEAD + CHANNEL.replace("560", "561")) != first
    assert identity(HEAD + "[light]\nlevel_lux = 9.0\n" + CHANNEL) != first


def test_every_description_of_the_schema_names_all_objectives():
    text = DesignStudy.model_fields["design"].annotation.model_fields["objectives"].description
    assert all(name in text for name in OBJECTIVES)


def test_the_page_on_the_search_lists_each_filter_with_its_numbers_and_each_objective():
    page = (Path(__file__).parents[2] / "docs" / "design_search.md").read_text(encoding="utf-8")
    for name, model in FILTER_MODELS.items():
        numbers = ", ".join(f"`{one}`" for one in model.numbers_for(()))
        assert f"| `{name}` | {model.what} | {numbers} |" in page
    for name, one in OBJECTIVES.items():
        assert f"| `{name}` | {one.what} | {one.unit} | {one.better} |" in page


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("method", '"nsga-2"'),
        ("population", "3"),
        ("population", f"{MOST_POPULATION + 1}"),
        ("over_scenes", '"median"'),
        ("structure", '"stack"'),
    ],
)
def test_a_design_refuses_what_its_search_and_space_refuse_with_the_key(tmp_path, key, value):
    effort = f"[design]\n{key} = {value}\n"
    head = HEAD.replace("population = 8\n", "").replace("budget = 16", "budget = 1_000_000")
    text = head.replace("[design]\n", effort) + CHANNEL
    assert refused_keys(tmp_path, text) == [f"design.{key}"]


def test_every_method_of_the_search_is_a_method_of_a_design(tmp_path):
    of_one = HEAD.replace(', "delta_e"', "")
    free_width = CHANNEL.replace("width_nm = 40", "width_nm = [30, 60]")
    for name in METHODS:
        text = of_one.replace("[design]", f'[design]\nmethod = "{name}"')
        assert read(tmp_path, text + free_width).design.method == name


def test_a_curve_is_the_dye_of_a_channel_of_the_catalog(tmp_path):
    dye = CHANNEL.replace("gaussian", "dye").replace("center_nm = [560, 680]\nwidth_nm = 40", "")
    words = '["model-rgbw:R", "model-rgbw:B"]'
    task = task_of(read(tmp_path, f"{HEAD}{dye}curves = {words}\nthickness = [0.5, 2]"))
    expected = dye_transmittances(sensor_named("model-rgbw", DEFAULT_GRID)).values
    np.testing.assert_array_equal(task.space.library["model-rgbw:R"], expected[:, 0])
    np.testing.assert_array_equal(task.space.library["model-rgbw:B"], expected[:, 2])
    assert [one.choices for one in task.space.parameters if one.choices] == [
        ("model-rgbw:R", "model-rgbw:B")
    ]


@pytest.mark.evidence
def test_the_folder_of_a_failed_search_takes_the_corrected_design(tmp_path):
    text = HEAD + CHANNEL + constraint("at_most", "0.001")
    with refused_input(subject="the constraints"):
        optimized(read(tmp_path, text), tmp_path / "out")
    optimized(read(tmp_path, text.replace("0.001", "1000")), tmp_path / "out")
    with refused_input(requirement="must not hold another design"):
        optimized(read(tmp_path, text.replace("0.001", "999")), tmp_path / "out")


def test_a_saturated_reference_is_named_and_not_counted_as_beaten(tmp_path):
    scene = "[[design.scenes]]\ntime_ms = 400.0\nlevel_lux = 1.0\n"
    design = optimized(read(tmp_path, HEAD + CHANNEL + scene), None)
    (lost,) = [one.name for one in design.references if one.objectives["snr_y_db"] < 0]
    assert any(one.startswith(f"{lost} is not compared") for one in design.sentences)
    assert not any(" better than " in one and lost in one for one in design.sentences)


def test_limits_that_contradict_each_other_are_refused_before_the_search(tmp_path):
    limits = constraint("at_most", "1") + constraint("at_least", "2")
    assert refused_keys(tmp_path, HEAD + CHANNEL + limits) == ["design.constraints"]


BARE = "\n".join(f'[[design.channels]]\nname = "{name}"' for name in "RGB")
BANDS = "[design.router]\ncrossing_1_nm = 490\ncrossing_2_nm = 590\nedge_nm = 15\n"
ROUTED = f"{BANDS}efficiency = [0.5, 0.9]\n" + "".join(
    f"{name}_selectivity = 0.8\n" for name in ("R", "G", "B")
)
GREEN = '[[design.channels]]\nname = "G"\nfilter = "gaussian"\ncenter_nm = 540\nwidth_nm = 40\n'
BELLS = CHANNEL + GREEN + GREEN.replace("540", "450").replace('"G"', '"B"')
PARTNER = {"rtn_share": "rtn_amplitude_e = 9\n", "rtn_amplitude_e": "rtn_share = 0.1\n"}
STRUCTURES = {
    "crosstalk": (BELLS + "[design.crosstalk]\nshare = [0, 0.2]\n", "crosstalk.share"),
    **{
        name: (
            f"{CHANNEL}[design.pixel]\n{PARTNER.get(name, '')}"
            f"{name} = [0.001, {min(one.most, 9)}]\n",
            f"pixel.{name}",
        )
        for name, one in noise_properties().items()
    },
    "time": (CHANNEL + "[design.exposure]\ntime_ms = [1, 9]\n", "exposure.time_ms"),
    "layers": (
        'structure = "layers"\n' + BARE
        + "\n[design.layers]\nR_um = [1, 4]\nG_um = 1\nB_um = 0.3\n",
        "layers.R_um",
    ),
    "router": ('structure = "router"\n' + BARE + "\n" + ROUTED, "router.efficiency"),
}  # fmt: skip


@pytest.mark.parametrize("case", sorted(STRUCTURES))
def test_what_a_document_varies_changes_an_objective(tmp_path, case):
    text, name = STRUCTURES[case]
    task = task_of(read(tmp_path, HEAD + text + "[exposure]\ntime_ms = 2.0\n"))
    problem = task.problem()
    middle = 0.5 * (problem.low + problem.high)
    ends = np.tile(middle, (2, 1))
    place = problem.names.index(name)
    ends[:, place] = problem.low[place], problem.high[place]
    found = problem.evaluate(ends).objectives
    assert np.isfinite(found).all()
    assert found[0, 0] != found[1, 0]


def test_the_mean_of_scenes_lies_between_the_worst_and_the_best(tmp_path):
    bright_scene = "[exposure]\ntime_ms = 10\n[[design.scenes]]\nlevel_lux = 5\n"
    scenes = f"{bright_scene}[[design.scenes]]\nlevel_lux = 1\n"

    def value(text):
        task = task_of(read(tmp_path, text + CHANNEL))
        return task.problem().evaluate(np.array([[620.0]])).objectives[0, 0]

    mean = value(HEAD + 'over_scenes = "mean"\n' + scenes)
    worst, bright = value(HEAD + scenes), value(HEAD + bright_scene)
    assert worst < mean < bright


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_the_example_designs_are_read(path):
    task = task_of(read_design(path))
    assert [one.name for one in task.references] == ["onyx-rgbw", "onyx-rgb-ircut"]
    assert task.problem().constraints[0].startswith("snr_y_db >= 32.3666")


def test_a_scene_without_a_time_has_the_longest_at_which_no_reference_saturates(tmp_path):
    scenes = "".join(f"[[design.scenes]]\nlevel_lux = {lux}\n" for lux in (1, 10, 100))
    task = task_of(read(tmp_path, HEAD + CHANNEL + scenes))
    times = np.array([one.point.exposure.time_s for one in task.scenes])
    np.testing.assert_allclose(times, 0.011941189 * np.array([10, 1, 0.1]), rtol=1e-6)
    assert all(np.isfinite(list(one.objectives.values())).all() for one in task.references)


def test_an_unknown_light_of_a_scene_names_the_scene(tmp_path):
    scene = '[[design.scenes]]\nilluminant = "QQ"\n'
    assert refused_keys(tmp_path, HEAD + CHANNEL + scene) == ["design.scenes.0.illuminant"]


def test_candidates_whose_channels_see_next_to_nothing_do_not_end_a_search(tmp_path):
    text = DESIGN_STARTER.replace("center_nm = [560, 680]", "center_nm = [560, 1000]", 1)
    text = text.replace("width_nm = [15, 80] ", "width_nm = [5, 80] ", 1)
    text = text.replace("seed = 1\n", "seed = 3\nseeds = 1\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)  # as on the command line
        found = optimized(with_effort(read(tmp_path, text), budget=200), None)
    assert len(found.members) == 100
    assert not found.result.convergence.failures


def test_the_conditions_of_a_front_name_all_scenes_and_which_value_counts(tmp_path):
    scenes = "".join(f"[[design.scenes]]\nlevel_lux = {lux}\ntime_ms = 5\n" for lux in (8, 2))
    found = optimized(read(tmp_path, HEAD + CHANNEL + scenes), None)
    assert found.conditions.startswith("the worst of 2 scenes: 8 lx (")
    assert "; 2 lx (" in found.conditions
    assert found.conditions in found.to_table().title


def test_a_choice_is_shown_by_its_name(tmp_path):
    text = (EXAMPLES / "better_than_both_dyes.toml").read_text()
    text = text.replace("[design]\n", "[design]\npolish = false\n")
    found = optimized(with_effort(read(tmp_path, text), budget=400), None)
    table = found.to_table()
    at = [column.name for column in table.columns].index("R.curve")
    chosen = {row[at] for row in table.rows[len(found.references) :]}
    assert chosen <= {"mt9v024-rgbw:R", "mt9v024-rgbw:G", "mt9v024-rgbw:B"}
    assert chosen
