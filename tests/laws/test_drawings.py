"""The drawings of the page arrange what the library computes: its digits and no others."""

import json
import re
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, strategies as st

import chromanoise
from chart_values import gains_of, rows_of, stages_of, steps_of
from chromanoise.base import notebook as _notebook, plain
from chromanoise.base.errors import InputError
from chromanoise.base.palette import CHANNELS, INK
from chromanoise.charts import PARTS, Look, Shown, as_data, drawing, shown
from chromanoise.charts.ellipses import SIGMAS, hex_colors, in_plane, patches_of
from chromanoise.charts.figure_style import channel_color
from chromanoise.charts.numbers import brief, decimal
from chromanoise.charts.vectors import color_frame, half_axes, round_magnification
from chromanoise.charts.verdicts import verdict_sentences
from chromanoise.color import LAB, XYY, ElectronSource, encoded_srgb, exact, noisy_color, propagate
from chromanoise.geometry import reconstructed_light, unit_circle
from chromanoise.noise import expected_electrons, level_in_words, white_scene
from chromanoise.sensor import behind_ir_cut, with_shifted_curves
from chromanoise.spectra import DEFAULT_GRID, color_axes, colorchecker
from chromanoise.study import (
    QUANTITIES,
    SWEEPS,
    OutputsPart,
    compared,
    crossover_sentence,
    crossovers,
    gray_noise,
    outcome_of,
    run,
    sensor_named,
    study_from_data,
    swept_values,
)
from chromanoise.study.assembly import operating_points_of, sensor_of
from chromanoise.study.color_matrices import METHODS, matrix_makers, training_named
from chromanoise.study.sweeps import fullest_level_lux, is_saturated
from chromanoise.web.controls import choices
from chromanoise.web.report_bundle import drawing_style
from chromanoise.web.report_of_study import at_value, slides_of
from chromanoise.web.requests import asset
from dear import dear
from noise_samples import noise_of
from outcomes import refused_input

BOTH = ("onyx-rgbw", "onyx-rgb-ircut")


def study_of(*names, level_lux=10.0, **more):
    light = {"illuminant": "E", "level_lux": level_lux} | more.pop("light", {})
    values = {"light": light, "sensors": [{"name": name} for name in names], **more}
    return study_from_data(values, source="a test")


def fast_study(*names, **more):
    """At a time that fills no well in any light of these tests."""
    return study_of(*names, exposure={"time_ms": 2.0}, **more)


@cache
def usual() -> Shown:
    return shown(study_of(*BOTH))


@cache
def bright() -> Shown:
    """A time at which the sensor without IR-cut, and it alone, is beyond full well."""
    return shown(study_of(*BOTH, exposure={"time_ms": 30.0}))


@cache
def analyzed_as_json():
    """What ``chromanoise analyze --budget --json`` writes."""
    outputs, of = OutputsPart(budget=True), usual()
    (maker,) = of.makers.values()
    outcomes = [outcome_of(each, maker, outputs) for each in of.operating_points]
    return plain(outcomes)


def rows_in(part, of, **look):
    """The numbers of each row of a chart, by heading."""
    return rows_of(drawing(part, of, Look(**look)))


def marks_of(part, of, kind):
    """The marks of one kind of a chart of one panel."""
    (panel,) = drawing(part, of).panels
    return [one for one in panel.marks if one.kind == kind]


def numbers_of(value):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list | tuple):
        return [number for item in value for number in numbers_of(item)]
    return [value] if isinstance(value, float) else []


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("of", [usual, bright], ids=["usual", "saturated"])
def test_every_drawing_is_plain_data_without_a_number_that_is_none(part, of):
    result = as_data(drawing(part, of(), Look()))
    assert json.loads(json.dumps(result, allow_nan=False)) == result
    assert np.isfinite(numbers_of(result)).all()


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("of", [usual, bright], ids=["usual", "saturated"])
def test_every_chart_has_a_table_of_text_with_a_cell_per_column(part, of):
    table = as_data(drawing(part, of()))["table"]
    assert table["rows"]
    for row in [table["head"], *table["rows"]]:
        assert len(row) == len(table["head"])
        assert all(isinstance(cell, str) and cell for cell in row)


@pytest.mark.parametrize("part", [part for part in PARTS if part not in ("head", "league")])
def test_the_title_of_a_chart_names_what_holds_for_all_of_it(part):
    title = as_data(drawing(part, usual()))["title"]
    assert "illuminant E" in title
    assert ("10 lx (" in title) == (part not in ("levels", "sensitivities"))
    assert ("11.94 ms, f/1.8" in title) == (part != "sensitivities")


def test_the_colors_of_channels_stand_in_one_file_of_the_source():
    hues = {color for pair in CHANNELS.values() for color in pair if len(set(color[1:])) > 1}
    assert hues == {"#D55E00", "#009E73", "#0072B2", "#CC79A7"}
    source = Path(chromanoise.__file__).parent
    named = re.compile("|".join(hues), re.IGNORECASE)
    files = (
        one for one in source.rglob("*") if one.suffix in (".py", ".js", ".css", ".svg", ".j2")
    )
    holding = {one.name for one in files if named.search(one.read_text("utf-8"))}
    assert holding == {"palette.py"}


def test_page_report_figures_and_notebooks_have_one_palette():
    for name, (light, dark) in CHANNELS.items():
        assert f"--channel-{name}: light-dark({light}, {dark});" in drawing_style()
        assert channel_color(name) == light
    assert asset("draw/draw.css").decode("utf-8") == drawing_style()
    assert channel_color("none such") == INK
    letters = _notebook.curves(np.arange(3.0), np.eye(3), ["R", "W", "C"], what="a test")
    assert re.findall(r'stroke="(\S+)"', letters) == ["#D55E00", "currentColor", "currentColor"]


@given(st.floats(-1e6, 1e6), st.integers(0, 4))
@example(0.5, 0)
@example(12.25, 1)
@example(-2.5, 0)
@example(-0.04, 1)
def test_a_number_is_told_to_the_nearest_decimal_and_a_tie_away_from_zero(value, digits):
    exact = Fraction(value) * 10**digits
    units = int(abs(exact) + Fraction(1, 2)) * (-1 if value < 0 else 1)
    text = decimal(value, digits)
    assert Fraction(text.replace("\N{MINUS SIGN}", "-")) == Fraction(units, 10**digits)
    assert ("\N{MINUS SIGN}" in text) == (units < 0)
    assert len(text.partition(".")[2]) == digits


@given(st.floats(1e-3, 9.9e5), st.integers(1, 4))
def test_a_short_number_keeps_its_significant_digits_and_no_zeros_after_them(value, digits):
    text = brief(value, digits)
    assert float(text) == pytest.approx(value, rel=0.5001 * 10.0 ** (1 - digits))
    assert not re.search(r"\.\d*0$|\.$", text)
    assert len(text.replace(".", "").strip("0")) <= digits


def test_head_and_stages_have_the_digits_of_analyze():
    head, stages = drawing("head", usual())["sensors"], stages_of(drawing("stages", usual()))
    for own, top, kinds in zip(analyzed_as_json(), head, stages, strict=True):
        assert top["time_ms"] == own["time_ms"]
        assert top["notes"] == own["notes"]
        assert top["mean_e"] == {c["name"]: c["mean_e"] for c in own["channels"]}
        assert_kinds_are_those_of(own, kinds)


def assert_kinds_are_those_of(own, kinds):
    """The values of the chart ``stages`` are those of a sensor in the JSON of an analysis."""
    channels = own["channels"]
    assert kinds["raw SNR"] == {c["name"]: c["snr_db"] for c in channels}
    unmixed = {c["name"]: c["contravariant_snr_db"] for c in channels}
    assert kinds["contravariant SNR"] == unmixed
    assert kinds["color SNR"] == own["color"]["snr_db"]
    assert kinds["bound"] == {"Y": own["bound_db"]}
    assert kinds["color SNR loss"] == {"Y": own["price_db"]}
    assert kinds["spectral SNR"] == {"spectrum": own["spectral_snr_db"]}


def night(*, clip):
    """Moonlight, where clipping at black changes every SNR, with the results of all charts."""
    outputs = {
        **{"clip": clip, "budget": not clip, "space": "lab", "matrix": True},
        "pareto": {"first": 1e-3, "last": 1e3, "points": 13},
    }
    sweep = {"vary": "lux", "quantity": "snr-y", "first": 0.01, "last": 1e4, "points": 73}
    return study_of(
        *("onyx-rgbw", "onyx-rgb-ircut"),
        **{"level_lux": 0.01, "exposure": {"time_ms": 12.0}},
        **{"outputs": outputs, "sweeps": [sweep]},
    )


@pytest.mark.parametrize("clip", [False, True])
def test_charts_have_the_numbers_of_a_run(clip):
    of, results = shown(night(clip=clip)), run(night(clip=clip))
    data = next(iter(results.analyses.values())).to_dict()["sensors"]
    head, stages = drawing("head", of)["sensors"], stages_of(drawing("stages", of))
    errors = rows_in("chart", of)
    for i, own in enumerate(data):
        channels = own["channels"]
        assert head[i]["mean_e"] == {c["name"]: c["mean_e"] for c in channels}
        assert head[i]["notes"] == own["notes"]
        assert_kinds_are_those_of(own, stages[i])
        # by the cubature of charts, which has fewer points
        spread = own["gray_noise"]["sd_normal_law"]
        assert stages[i]["noise in CIELAB"] == pytest.approx(spread, rel=0.03)
        found = [row[f"{own['name']} color error [Delta E*ab]"] for row in errors]
        assert np.mean(found) == pytest.approx(own["color_error_mean"], rel=1e-12)
    (matrices,) = results.matrices.values()
    now = [row for row in rows_in("pareto", of) if row["weight of the noise"] == "now"]
    for own, at in zip(data, now, strict=True):
        assert at["color error, mean Delta E*ab"] == own["color_error_mean"]
    for own, at in zip(matrices.to_dict()["sensors"], now, strict=True):
        assert at["SNR of Y [dB]"] == own["report"]["snr_db"]["Y"]
    (sweep,) = results.sweeps
    drawn = [list(one.values) for one in drawing("levels", of).columns[1:]]
    assert drawn == [c["value"] for c in sweep.to_dict()["curves"]]
    assert data[0]["color"]["snr_db"]["Y"] == pytest.approx(-16.25 if clip else -15.81, abs=0.01)


def test_the_noise_of_patches_is_clipped_where_the_study_clips():
    """Clipping at black removes noise from dark patches: less of it at equal color errors."""
    clipped, whole = (rows_in("chart", shown(night(clip=clip))) for clip in (True, False))
    whats = ("color error", "noise of one pixel")
    error, noise = (f"onyx-rgbw {what} [Delta E*ab]" for what in whats)
    assert [row[error] for row in clipped] == [row[error] for row in whole]
    assert sum(row[noise] for row in clipped) < 0.9 * sum(row[noise] for row in whole)


def test_a_clipped_study_has_no_budget_and_says_what_is_not_clipped():
    """A study refuses a budget together with clipping: it follows eq. 7."""
    of = shown(night(clip=True))
    for panel in drawing("budget", of).panels:
        assert not panel.marks
        assert "eq. 7" in panel.absence
    for part in PARTS:
        title = as_data(drawing(part, of)).get("title", "")
        assert title.endswith("without clipping") == (part in ("levels", "pareto"))
    result = drawing("head", of)["verdict"]
    assert not any(sentence.startswith("What") for sentence in result)


def test_a_slider_keeps_the_clipping_of_the_study():
    of = shown(night(clip=True))
    level, *_ = slides_of(of)
    moved = at_value(of, level, 0.02)
    study = of.study.model_copy(
        update={"light": of.study.light.model_copy(update={"level_lux": 0.02})}
    )
    for part in ("stages", "chart"):
        assert drawing(part, moved) == drawing(part, shown(study))


@pytest.mark.parametrize("coordinate", ["X", "Y", "Z", "M^G", "L*", "a*", "b*"])
def test_the_waterfall_has_the_digits_of_analyze_and_leads_from_the_photons_to_the_snr(coordinate):
    chart = drawing("budget", usual(), Look(coordinate=coordinate))
    result = steps_of(chart)
    for own, (start, *middle, end) in zip(analyzed_as_json(), result, strict=True):
        kept = [*own["budget"], *own["contravariant_budget"], *own["lab_budget"]]
        (budget,) = [one for one in kept if one and one["coordinate"] == coordinate]
        assert [change for _, change, _, _ in middle] == [-c["cost_db"] for c in budget["costs"]]
        gains = [c["gain_if_removed_db"] for c in budget["costs"]]
        assert gains_of(chart)[own["name"]] == [None, *gains, None]
        assert start[-1] == budget["photons_db"]
        assert end[-1] == budget["snr_db"]


@pytest.mark.parametrize("coordinate", ["Y", "b*"])
def test_the_steps_of_the_waterfall_meet_and_add_up(coordinate):
    chart = drawing("budget", usual(), Look(coordinate=coordinate))
    for steps, panel in zip(steps_of(chart), chart.panels, strict=True):
        (start, *middle, end), (bars,) = steps, panel.marks
        changes = [change for _, change, _, _ in middle]
        assert start[-1] + sum(changes) == pytest.approx(end[-1])
        for (*_, after), (_, _, before, _) in pairwise(steps):
            assert before == pytest.approx(after)
        roles = ["gain" if change > 0 else "cost" for change in changes]
        assert bars.roles == ("total", *roles, "total")


def test_a_coordinate_made_of_infrared_has_an_snr_but_no_budget_and_says_why():
    """Behind a perfect cut the same matrix makes Z negative: by the sweep of an added IR-cut."""
    of = shown(study_of("onyx-rgb", light={"illuminant": "A", "level_lux": 10.0}))
    (panel,) = drawing("budget", of, Look(coordinate="Z")).panels
    (stages,) = stages_of(drawing("stages", of))
    assert stages["color SNR"]["Z"] == pytest.approx(18.7, abs=0.1)
    assert not panel.marks
    assert "its Z comes from the infrared" in panel.absence
    assert "no SNR" not in panel.absence
    (cut,) = (SWEEPS["ircut-nm"].at(one, 700.0) for one in of.operating_points)
    assert np.isnan(QUANTITIES["snr-z"].of(cut, of.analyses[0].matrix))
    assert drawing("budget", of, Look(coordinate="X")).panels[0].marks


@pytest.mark.parametrize("matrices", [("kernel",), ("lmmse",)], ids=" ".join)
def test_curves_and_crossovers_over_the_light_are_those_of_compare(matrices):
    of = shown(study_of(*BOTH, matrices=matrices))
    result = drawing("levels", of)
    values = swept_values(SWEEPS["lux"], 0.01, 10_000.0, 73)
    curves = compared(of.operating_points, of.makers, values)
    lux, *drawn = result.columns
    assert list(lux.values) == values.tolist()
    for one, curve in zip(drawn, curves, strict=True):
        np.testing.assert_array_equal(np.array(one.values, dtype=float), curve.value)
    (crossed,) = crossovers(of.operating_points, of.makers, curves)
    rules = marks_of("levels", of, "rule")
    assert [one.at for one in rules if one.role == "crossing"] == list(crossed.at)
    assert (result.numbered or result.notes)[0] == crossover_sentence(crossed)


@pytest.mark.parametrize(
    ("level_lux", "low", "high"),
    [(10.0, 0.01, 1e4), (1e4, 0.01, 1e4), (2e4, 0.01, 1e5), (3e-5, 1e-5, 1e4), (1e-15, 1e-15, 1e4)],
)
def test_curves_reach_over_the_slider_and_to_the_level_in_equal_ratios(level_lux, low, high):
    """Twelve per decade, so that a ratio of neighbors is 10^(1/12)."""
    of = shown(fast_study(*BOTH, level_lux=level_lux))
    lux = np.array(drawing("levels", of).columns[0].values)
    assert lux[[0, -1]] == pytest.approx([low, high], rel=1e-12)
    np.testing.assert_allclose(lux[1:] / lux[:-1], 10 ** (1 / 12), rtol=1e-9)


def test_the_slider_of_the_page_ends_where_the_curves_end():
    (level,) = (one for one in choices()["sliders"] if one["key"] == "light.level_lux")
    lux = drawing("levels", usual()).columns[0].values
    assert (level["low"], level["high"]) == pytest.approx((lux[0], lux[-1]), rel=1e-12)


@pytest.mark.parametrize(
    ("level_lux", "result"),
    [
        (10.0, "10 lx"),
        (0.0133, "0.0133 lx"),
        (1.334e-5, "1.33·10⁻⁵ lx"),
        (2e-4, "2·10⁻⁴ lx"),
        (999.9, "1000 lx"),
        (13300.0, "13300 lx"),
        (2.5e7, "2.5·10⁷ lx"),
        (9.999e-4, "0.001 lx"),
        (1e15, "10¹⁵ lx"),
    ],
)
def test_a_level_is_told_as_people_write_it(level_lux, result):
    assert level_in_words(level_lux) == result


@pytest.mark.parametrize("level_lux", [2e-5, 5e4])
def test_no_sentence_or_slider_tells_a_level_with_an_e(level_lux):
    of = shown(study_of(*BOTH, level_lux=level_lux))
    slider, *_ = slides_of(of)
    message = [*drawing("head", of)["verdict"], *slider.texts]
    if level_lux > 1:  # else the span of the curves is told as the command tells it
        message += drawing("levels", of).numbered
    for sentence in message:
        assert not re.search(r"\de[+-]?\d", sentence)


def test_many_light_levels_at_once_give_what_they_give_one_by_one():
    of = usual()
    levels = np.array([0.01, 0.3, 9.0, 11.0, 1000.0])
    for operating_point, analysis in zip(of.operating_points, of.analyses, strict=True):
        for name in ("snr-x", "snr-y", "snr-z"):
            quantity = QUANTITIES[name]
            alone = [
                quantity.of(SWEEPS["lux"].at(operating_point, level), analysis.matrix)
                for level in levels.tolist()
            ]
            together = quantity.over_levels(operating_point, analysis.matrix, levels)
            np.testing.assert_allclose(together, alone, rtol=1e-12)


@pytest.mark.parametrize(
    "matrix",
    [
        "kernel",
        "least-squares",
        "white-preserving",
        "lmmse",
        "ridge=0.01",
        "noise-regularized=0.3",
        "noise-regularized=0",
        "bounded-psi=4",
    ],
)
@pytest.mark.parametrize("light", [*dear("E"), "A"])
def test_a_matrix_per_level_gives_what_it_gives_level_by_level(matrix, light):
    """The functions of one level, asked anew at each of them, and no cache between."""
    levels = np.geomspace(1e-3, 1e5, 9)
    word, _, number = matrix.partition("=")
    method = METHODS[word]
    own = {method.parameter: float(number)} if number else {}
    of = shown(study_of("onyx-rgb-ircut", "model-rgbir", light={"illuminant": light}))
    for curve, operating_point in zip(
        compared(of.operating_points, matrix_makers([matrix], "quanta"), levels),
        of.operating_points,
        strict=True,
    ):
        for i, level in enumerate(levels.tolist()):
            lit = SWEEPS["lux"].at(operating_point, level)
            training = training_named("chart-nir", operating_point.illuminant)
            made = method.make(
                operating_point.sensor, operating_point.exposure, training, level_lux=level, **own
            )
            snr = QUANTITIES["snr-y"].of(lit, made)
            error = QUANTITIES["color-error"].of(lit, made)
            np.testing.assert_allclose(curve.value[i], snr, rtol=1e-12, atol=1e-10)
            np.testing.assert_allclose(curve.color_error[i], error, rtol=1e-10)
            assert curve.saturated[i] == is_saturated(lit)


@pytest.mark.parametrize(
    "matrix", ["kernel", "noise-regularized=0.3", "bounded-psi=4", "white-preserving"]
)
def test_levels_are_drawn_without_making_a_matrix_per_level(matrix, monkeypatch):
    """What a page waits for, counted: two sensors, their curves and where they cross."""
    asked = []
    for word, method in METHODS.items():

        def counted(*args, make=method.make, **more):
            asked.append(more["level_lux"])
            return make(*args, **more)

        replaced = replace(method, make=counted)
        monkeypatch.setitem(METHODS, word, replaced)
    of = shown(study_of(*BOTH, matrices=[matrix]))
    drawing("levels", of)
    drawing("levels", of)
    assert len(asked) <= (2 if "noise" not in matrix else 100)


def test_the_fullest_level_is_where_the_fullest_channel_holds_its_well():
    for operating_point in usual().operating_points:
        fullest = fullest_level_lux(operating_point)
        full, above = (SWEEPS["lux"].at(operating_point, fullest * f) for f in (1.0, 1.0 + 1e-9))
        assert not is_saturated(full)
        assert is_saturated(above)
        electrons = expected_electrons(white_scene(full), full.sensor, full.exposure)
        assert electrons.max() == pytest.approx(full.sensor.pixel.full_well_e, rel=1e-12)


def test_a_curve_tells_from_which_light_on_it_is_saturated_and_not_the_next_point():
    """The time fills the fuller sensor's well to the share asked for at the study's own level."""
    of = shown(study_of(*BOTH, exposure={"saturate": 0.8}))
    (told,) = [one for one in drawing("levels", of).notes if one.startswith("Saturated from")]
    values = [float(one) for one in re.findall(r"([\d.]+) lx", told)]
    assert min(values) == pytest.approx(10.0 / 0.8, rel=1e-9)
    assert max(values) > 1.5 * min(values)


def test_two_sensors_are_equal_where_their_curves_cross():
    of = shown(study_of(*BOTH, matrices=["lmmse"]))
    found = [one for one in marks_of("levels", of, "rule") if one.role == "crossing"]
    assert found
    (maker,) = of.makers.values()
    for crossing in found:
        lit = [SWEEPS["lux"].at(one, crossing.at) for one in of.operating_points]
        ours, theirs = (QUANTITIES["snr-y"].of(each, maker(each)) for each in lit)
        assert ours == pytest.approx(theirs, abs=1e-6)


def test_a_saturated_sensor_has_no_snr_and_says_so_everywhere():
    of = bright()
    assert drawing("head", of)["sensors"][0]["saturated"]
    stages = stages_of(drawing("stages", of))[0]
    assert set(stages["color SNR"].values()) == {None}
    assert set(stages["noise in CIELAB"].values()) == {None}
    full, fine = drawing("vectors", of)["sensors"]
    assert "onyx-rgbw: channels" in full["why_not"]
    assert full["ellipsoid"] is None
    assert fine["why_not"] is None
    for part in ("budget", "ellipses"):
        full, fine = drawing(part, of).panels
        assert "onyx-rgbw: channel" in full.absence
        assert not full.marks
        assert fine.marks
        assert not fine.absence
    _, full, fine = marks_of("chart", of, "swatches")
    assert (full.colors, len(fine.colors)) == ((), 24)
    assert "onyx-rgbw: channel" in drawing("chart", of).description
    lux, first, _ = (one.values for one in drawing("levels", of).columns)
    assert all(v is None for v, at in zip(first, lux, strict=True) if at > 10.0)
    assert "Saturated from: onyx-rgbw " in " ".join(drawing("levels", of).notes)
    known = {row["sensor"] for row in rows_in("pareto", of) if row["SNR of Y [dB]"] is not None}
    assert known == {"onyx-rgb-ircut"}
    told = "onyx-rgbw: no curve, because a channel is saturated on the white."
    assert told in drawing("pareto", of).notes


def test_the_frame_is_orthonormal_and_spans_the_color_axes():
    axes = color_axes(DEFAULT_GRID, "quanta")
    frame = color_frame(axes)
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(frame @ (frame.T @ axes), axes, atol=1e-12 * np.abs(axes).max())
    result = drawing("vectors", usual())["axes"]
    assert all(axis["at"][i] > 0 for i, axis in enumerate(result))
    assert [np.linalg.norm(axis["at"]) for axis in result] == pytest.approx([1, 1, 1])


def test_angles_between_axes_in_the_frame_are_those_of_the_spectra():
    axes = color_axes(DEFAULT_GRID, "quanta")
    x, y = (np.array(axis["at"]) for axis in drawing("vectors", usual())["axes"][:2])
    cosine = axes[:, 0] @ axes[:, 1] / np.linalg.norm(axes[:, 0]) / np.linalg.norm(axes[:, 1])
    assert x @ y == pytest.approx(cosine, rel=1e-12)


def test_the_share_of_the_norm_is_what_least_squares_on_x_y_z_leaves():
    """By another road: fit the vector by the color axes; the residual is what lies outside."""
    axes = color_axes(DEFAULT_GRID, "quanta")
    analysis = usual().analyses[0]
    light = reconstructed_light(analysis.matrix.frame, analysis.raw.mean)
    result = drawing("vectors", usual())["sensors"][0]
    for vector, share in [
        (light, result["light"]["norm_share"]),
        *zip(
            analysis.matrix.frame.basis.T,
            [channel["norm_share"] for channel in result["channels"]],
            strict=True,
        ),
    ]:
        scaled = axes / np.linalg.norm(axes, axis=0)
        fit, *_ = np.linalg.lstsq(scaled, vector, rcond=None)
        rest = vector - scaled @ fit
        assert share == pytest.approx(1 - rest @ rest / (vector @ vector), rel=1e-9)


def test_the_ellipsoid_projected_on_an_axis_has_the_spread_of_that_color():
    """A color axis lies in the frame, so the ellipsoid casts its shadow as the SNR tells it."""
    of = usual()
    result = drawing("vectors", of, Look(magnification=1.0))
    for analysis, sensor in zip(of.analyses, result["sensors"], strict=True):
        direction = np.array(result["axes"][1]["at"])
        center = direction @ sensor["ellipsoid"]["center"]
        shadow = np.linalg.norm(np.array(sensor["ellipsoid"]["half_axes"]) @ direction)
        snr = 20 * np.log10(center / (shadow / result["sigmas"]))
        kernel = analysis.color.mean[1] / np.sqrt(analysis.color.variance[1])
        assert snr == pytest.approx(20 * np.log10(kernel), rel=1e-9)


def test_the_ellipsoids_share_is_that_of_the_noise_of_drawn_spectra_within_x_y_z():
    """Drawn electrons, their spectra, and what least squares on the color axes leaves of them."""
    of = usual()
    axes = color_axes(DEFAULT_GRID, "quanta")
    scaled = axes / np.linalg.norm(axes, axis=0)
    rng = np.random.default_rng(11)
    for analysis, result in zip(of.analyses, drawing("vectors", of)["sensors"], strict=True):
        sd = np.sqrt(np.diag(analysis.raw.covariance))
        noise = sd * rng.standard_normal((20_000, sd.size))
        spectra = reconstructed_light(analysis.matrix.frame, noise)
        fit, *_ = np.linalg.lstsq(scaled, spectra.T, rcond=None)
        rest = spectra - (scaled @ fit).T
        share = 1 - (rest**2).sum() / (spectra**2).sum()
        assert 0.01 < share < 0.99
        assert result["ellipsoid"]["norm_share"] == pytest.approx(share, abs=0.01)


def test_half_axes_rebuild_the_covariance():
    covariance = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 2.0]])
    axes = half_axes(covariance)
    np.testing.assert_allclose(axes.T @ axes, covariance, atol=1e-12)
    assert np.linalg.norm(axes[0]) >= np.linalg.norm(axes[1]) >= np.linalg.norm(axes[2])


@pytest.mark.parametrize(
    ("largest", "magnification"), [(0.3, 1.0), (0.31, 0.5), (0.05, 5.0), (3e-4, 1000.0), (0.0, 1.0)]
)
def test_the_magnification_is_a_round_number_that_fits(largest, magnification):
    assert round_magnification(largest, 0.3) == pytest.approx(magnification)


def test_a_magnification_that_is_asked_for_is_taken():
    one, two = (drawing("vectors", usual(), Look(magnification=m))["sensors"] for m in (1.0, 3.0))
    small, large = (np.array(result[0]["ellipsoid"]["half_axes"]) for result in (one, two))
    np.testing.assert_allclose(large, 3 * small)


def test_chart_errors_are_those_of_analyze():
    for name, own in zip(BOTH, analyzed_as_json(), strict=True):
        errors = [row[f"{name} color error [Delta E*ab]"] for row in rows_in("chart", usual())]
        assert np.mean(errors) == pytest.approx(own["color_error_mean"], rel=1e-12)


def test_chart_noise_is_that_of_the_exact_distribution():
    analysis = usual().analyses[1]
    rows = rows_in("chart", usual())
    result = [row["onyx-rgb-ircut noise of one pixel [Delta E*ab]"] for row in rows]
    chart, some = colorchecker(DEFAULT_GRID), [0, 12, 21]
    scene = replace(analysis.scene, reflectance=chart.values.T[some])
    source = ElectronSource(
        mean_e=expected_electrons(scene, analysis.sensor, analysis.exposure),
        matrix=analysis.matrix.matrix,
        noise=noise_of(read_noise_e=analysis.sensor.pixel.read_noise_e),
    )
    color = noisy_color(source, analysis.color.mean)
    noise = propagate(color, LAB, partial(exact, points=2**11))
    np.testing.assert_allclose([result[i] for i in some], noise.delta_e, rtol=0.02)


def half_axes_of(of, plane):
    """The two conjugate half axes of each ellipse, the sensors one after the other."""
    names = [f"conjugate half axis {k} {axis}" for k in (1, 2) for axis in AXES[plane]]
    rows = rows_in("ellipses", of, plane=plane)
    return np.array([[row[name] for name in names] for row in rows]).reshape(-1, 2, 2)


def covariances_of(of, plane):
    return np.concatenate([in_plane(patches_of(one), plane)[2] for one in of.analyses])


AXES = {"ab": ("a*", "b*"), "xy": ("x", "y")}


@pytest.mark.parametrize("plane", ["ab", "xy"])
def test_the_half_axes_of_an_ellipse_are_conjugate_for_its_covariance(plane):
    """For half axes u, v: u u^T + v v^T is the covariance, times the square of the sigmas."""
    axes = half_axes_of(usual(), plane)
    assert len(axes) == 2 * 24
    result = np.einsum("pki,pkj->pij", axes, axes) / SIGMAS**2
    np.testing.assert_allclose(result, covariances_of(usual(), plane), rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("plane", ["ab", "xy"])
def test_an_ellipse_reaches_as_far_as_the_spread_in_its_worst_direction(plane):
    """By another road: the spread along each of many directions, not the eigenvalues."""
    angle = np.linspace(0, np.pi, 2001)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    covariance = covariances_of(usual(), plane)
    spread = np.sqrt(np.einsum("ki,pij,kj->pk", around, covariance, around)).max(axis=1)
    rows = rows_in("ellipses", usual(), plane=plane)
    reach = np.array([row["reach of 2 sigma"] for row in rows])
    np.testing.assert_allclose(reach, SIGMAS * spread, rtol=1e-6)
    outline = np.einsum("ks,psi->pki", unit_circle(48), half_axes_of(usual(), plane))
    farthest = np.linalg.norm(outline, axis=2).max(axis=1)
    assert (np.cos(np.pi / 47) * reach * 0.998 < farthest).all()
    assert (farthest < reach * 1.002).all()


def test_ellipses_hold_the_share_of_draws_that_two_sigma_hold():
    """Drawn electrons through the matrix: 1 - exp(-2) of them lie within."""
    seen = patches_of(usual().analyses[1])
    rng = np.random.default_rng(7)
    xyz = rng.multivariate_normal(seen.xyz.mean[12], seen.xyz.covariance[12], size=20_000)
    for plane in ("ab", "xy"):
        _, center, covariance = in_plane(seen, plane)
        if plane == "ab":
            relative = np.cbrt(xyz / seen.white)
            points = np.stack(
                [500 * (relative[:, 0] - relative[:, 1]), 200 * (relative[:, 1] - relative[:, 2])],
                axis=1,
            )
        else:
            balanced = xyz / seen.white * seen.true_white
            points = balanced[:, :2] / balanced.sum(axis=1, keepdims=True)
        away = points - center[12]
        distance2 = np.einsum("ki,ij,kj->k", away, np.linalg.inv(covariance[12]), away)
        assert (distance2 < 4).mean() == pytest.approx(1 - np.exp(-2), abs=0.02)


def test_colors_on_the_screen_are_those_of_srgb():
    white, gray = np.array([0.9, 1.0, 0.8]), 0.18
    (result,) = hex_colors(gray * white[None], white)
    code = round(255 * float(encoded_srgb(np.full(3, gray), np.ones(3))[0]))
    assert result == f"#{code:02x}" + 2 * f"{code:02x}"


def test_chromaticity_of_equal_energy_is_a_third_and_its_slope_that_of_differences():
    xyz = np.array([[1.0, 1.0, 1.0], [0.3, 0.5, 0.1], [-0.3, 0.2, 0.05]])
    white = np.ones(3)
    np.testing.assert_allclose(XYY.from_xyz(xyz, white)[0], [1 / 3, 1 / 3, 1.0])
    step = 1e-6
    for k in range(3):
        moved = [XYY.from_xyz(xyz + s * step * np.eye(3)[k], white) for s in (1, -1)]
        slope = (moved[0] - moved[1]) / (2 * step)
        np.testing.assert_allclose(XYY.jacobian(xyz, white)[..., k], slope, rtol=1e-5, atol=1e-6)


def test_a_trade_off_never_gains_noise_with_error_and_passes_through_its_noise_aware_matrices():
    *points, _ = rows_in("pareto", shown(study_of("onyx-rgb-ircut")))
    names = ("color error, mean Delta E*ab", "visual noise [CIELUV]", "SNR of Y [dB]")
    errors, noises, _ = ([row[name] for row in points] for name in names)
    assert errors == sorted(errors)
    assert noises == sorted(noises, reverse=True)
    some = points[len(points) // 2]
    weighed = f"noise-aware={some['weight of the noise']!r}"
    *_, now = rows_in("pareto", shown(study_of("onyx-rgb-ircut", matrices=[weighed])))
    for name in names:
        assert now[name] == pytest.approx(some[name], rel=1e-9)


def test_the_verdict_of_the_papers_sensors_is_the_papers():
    result = " ".join(drawing("head", usual())["verdict"])
    assert "onyx-rgb-ircut has the least visual noise at equal color error" in result
    assert "onyx-rgbw has 6.4 dB less SNR of Y than onyx-rgb-ircut on a perfect white" in result
    assert "but 6.7 dB more raw SNR (best linear readout" in result
    assert "correlation (unmixing channels that look alike) costs" in result
    assert "ΔE*ab over the patches of the ColorChecker" in result


def bars(of):
    """What the bars of each sensor are called, and their numbers as they are shown."""
    chart = drawing("budget", of)
    texts = [panel.marks[0].texts for panel in chart.panels]
    return {
        name: dict(zip([label for label, *_ in steps], told, strict=True))
        for name, steps, told in zip(chart.sensors, steps_of(chart), texts, strict=True)
    }


@pytest.mark.parametrize(
    "second",
    [
        {"name": "onyx-rgb-ircut"},
        {"name": "onyx-rgb", "crosstalk": 0.3, "mosaic": "bayer"},
        {"name": "onyx-rgb-ircut", "pixel": {"prnu": 0.05, "dsnu_e": 60.0}},
        {"name": "onyx-rgb-ircut", "pixel": {"pitch_um": 1.0}},
    ],
)
def test_every_number_of_the_verdicts_reasons_is_that_of_the_bar_of_the_same_name(second):
    sensors = [{"name": "onyx-rgbw"}, second]
    of = shown(study_from_data({"sensors": sensors, "light": {"level_lux": 10.0}}, source=""))
    (why,) = (one for one in drawing("head", of)["verdict"] if one.startswith("Why "))
    names, _, reasons = why.removeprefix("Why ").rstrip(".").partition(": ")
    loser, _, winner = names.partition(" has less SNR of Y than ")
    found = 0
    for reason in reasons.split("; "):
        label, own, other = re.match(
            r"([^(:]+?)(?: \(.+?\))?(?: costs|:) (\S+) dB, against (\S+) dB", reason
        ).groups()
        sign = "" if re.search(r"^[^(]*:|\): ", reason) else "\N{MINUS SIGN}"
        for name, number in ((loser, own), (winner, other)):
            bar = bars(of)[name].get(label, "0.0")
            if label == "infrared":  # with its signal in Y, which has a bar of its own
                leak = bars(of)[name].get("infrared leaking into Y", "0.0")
                both = sum(float(one.replace("−", "-")) for one in (bar, leak))
                assert float((sign + number).replace("−", "-")) == pytest.approx(both, abs=0.11)
            else:
                assert bar == (number if float(number.replace("−", "-")) == 0 else sign + number)
            found += 1
    assert found >= 2


@pytest.mark.parametrize("crossed", [0, 1])
def test_crosstalk_of_one_sensor_only_is_a_reason_of_the_verdict(crossed):
    sensors = [{"name": "onyx-rgb"}, {"name": "onyx-rgb-ircut"}]
    sensors[crossed] |= {"crosstalk": 0.3, "mosaic": "bayer"}
    verdict = drawing("head", shown(study_from_data({"sensors": sensors}, source="")))["verdict"]
    assert any("crosstalk costs" in sentence for sentence in verdict)


def test_the_verdict_does_not_depend_on_the_order_of_sensors():
    one = verdict_sentences(usual().analyses)
    other = verdict_sentences(usual().analyses[::-1])
    assert one[:4] == other[:4]


def test_a_pixel_of_a_hundredth_of_the_area_loses_20_db_for_photons_and_the_verdict_says_so():
    small = {"name": "onyx-rgb-ircut", "pixel": {"pitch_um": 1.0}}
    values = {"light": {"level_lux": 10.0}, "sensors": [{"name": "onyx-rgb-ircut"}, small]}
    verdict = drawing("head", shown(study_from_data(values, source="a test")))["verdict"]
    photons = [
        steps["all photons"] for steps in bars(shown(study_from_data(values, source=""))).values()
    ]
    first, second = map(float, photons)
    assert first - second == pytest.approx(20.0, abs=0.1)
    (why,) = (one for one in verdict if one.startswith("Why "))
    assert f"all photons: {photons[1]} dB, against {photons[0]} dB" in why


@pytest.mark.parametrize(
    "names",
    [
        BOTH,
        ("model-mono", "onyx-rgb"),
        ("model-rgb", "model-rgbir"),
        ("onyx-rgbw", "onyx-rgb"),
        ("model-cmy-ircut", "onyx-rgbw"),
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("illuminant", ["E", "A"])
def test_the_reasons_that_are_told_reach_the_gap(names, illuminant):
    told = drawing(
        "head", shown(fast_study(*names, light={"illuminant": illuminant, "level_lux": 1.0}))
    )["verdict"]
    (why,) = (one for one in told if one.startswith("Why "))
    y_db = r"SNR of Y than \S+ on a perfect white \((-?[\d.]+) against (-?[\d.]+) dB"
    ours, theirs = re.search(y_db, " ".join(told)).groups()
    numbers = r"([−+]?[\d.]+) dB, against ([−+]?[\d.]+) dB for"
    found = re.findall(rf"(costs|:) {numbers}", why)
    levels = [[float(one.replace("−", "-")) for one in pair] for _, *pair in found]
    signs = [1.0 if word == "costs" else -1.0 for word, *_ in found]
    reached = sum(sign * (here - there) for sign, (here, there) in zip(signs, levels, strict=True))
    assert reached > abs(float(ours) - float(theirs)) - 0.3 - 0.4  # and rounding


@pytest.mark.parametrize("name", ["onyx-rgb-ircut", "model-rgb", "model-rgbir", "model-mono"])
@pytest.mark.parametrize("matrix", ["kernel", "lmmse"])
@pytest.mark.parametrize(("illuminant", "level_lux"), [("E", 0.1), ("A", 10.0)])
def test_what_a_sensor_alone_loses_below_its_raw_channels_is_not_what_they_lack_themselves(
    name, matrix, illuminant, level_lux
):
    light = {"illuminant": illuminant, "level_lux": level_lux}
    message, *_ = verdict_sentences(
        shown(fast_study(name, light=light, matrices=[matrix])).analyses
    )
    assert "read noise" not in message
    assert "-0.0" not in message
    price = float(re.search(r"SNR for an eye, ([\d.]+) dB below", message)[1])
    why = re.search(r"(mostly|above all) because of [^;]+: ([\d.]+) dB", message)
    assert (why is None) <= (price < 1.0)
    if why:
        share = float(why[2]) / price
        assert (why[1] == "mostly") == (0.5 < share <= 1.0)
        assert share > 0.3  # of three causes the largest


def test_terms_other_than_one_time_for_all_are_told():
    one, alike, photons = (
        drawing("head", shown(study_of(*BOTH, exposure={"equal": terms})))["verdict"][0]
        for terms in ("exposure", "saturation", "light")
    )
    assert one.startswith("At 10 lx (illuminant E, 11.94 ms, f/1.8), onyx")
    assert "ms (onyx-rgbw), " in alike  # the times differ
    assert "), with the same share of full well on each sensor, onyx" in alike
    assert "), with the same number of photons on each sensor, onyx" in photons
    with pytest.raises(InputError, match="terms of a comparison"):
        verdict_sentences(usual().analyses, equal="time")


def test_the_verdict_tells_of_saturated_sensors_and_of_one_alone():
    saturated, eye, *machine = drawing("head", bright())["verdict"]
    assert saturated.startswith("At 10 lx (illuminant E, 30 ms, f/1.8), onyx-rgbw: ")
    assert "saturated" in saturated
    assert eye.startswith("onyx-rgb-ircut has")
    assert machine
    assert not any("onyx-rgbw" in sentence for sentence in machine)


@pytest.mark.parametrize("reader", ["eye", "machine"])
def test_a_verdict_names_time_and_f_number_for_each_reader_and_with_saturated_sensors(reader):
    outputs = {"reader": reader}
    for sensors in (BOTH, BOTH[:1]):
        for time_ms in (5.0, 100.0):  # below full well, and all channels beyond it
            exposure = {"time_ms": time_ms, "f_number": 1.4}
            told = drawing("head", shown(study_of(*sensors, exposure=exposure, outputs=outputs)))
            where = f"At 10 lx (illuminant E, {time_ms:g} ms, f/1.4), "
            assert told["verdict"][0].startswith(where)


@pytest.mark.parametrize(
    "names",
    [
        ("onyx-rgbw",),
        ("model-cmy-ircut", "onyx-rgb-ircut", "model-rgbir"),
        ("model-mono", "gsense4040bsi"),
        ("model-mono", "onyx-rgb"),
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("level_lux", [0.001, 1000.0])
def test_every_set_of_sensors_has_a_verdict_of_whole_sentences(names, level_lux):
    result = drawing("head", shown(study_of(*names, level_lux=level_lux)))["verdict"]
    assert result
    for sentence in result:
        assert re.fullmatch(r"[^\n]*[A-Za-z][^\n]*[^.\s]\.", sentence)
        assert not re.search(r"\b(nan|inf|None)\b|  | [.,;]|\(\)|\.\.|-0\.0\b", sentence)
        assert sentence.count("(") == sentence.count(")")
    for name in names:
        assert any(name in sentence for sentence in result), name
    (colors,) = [s for s in result if "over the patches of" in s]
    assert all(name in colors for name in names if not any(s.startswith(name) for s in result))


def test_equal_sensors_are_told_apart_and_level():
    study = study_of("onyx-rgbw")
    of = shown(study, operating_points=operating_points_of(study) * 2)
    assert [s.sensor.name for s in of.operating_points] == ["onyx-rgbw", "onyx-rgbw (2)"]
    first, *others = drawing("head", of)["verdict"]
    assert "onyx-rgbw and onyx-rgbw (2) tie in visual noise at equal color error" in first
    (chosen,) = [one for one in others if "the same SNR of Y as onyx-rgbw (2)" in one]
    assert "and the same raw SNR" in chosen


def test_an_unknown_part_plane_or_coordinate_is_refused():
    with pytest.raises(InputError, match="part must be"):
        drawing("waterfall", usual())
    with pytest.raises(InputError, match="plane"):
        Look(plane="uv")
    with pytest.raises(InputError, match="coordinate"):
        drawing("budget", usual(), Look(coordinate="Q"))


def test_an_added_cut_in_a_study_is_that_of_the_sweep():
    values = {"sensors": [{"name": "onyx-rgbw", "ircut_nm": 650.0}]}
    (cut,) = operating_points_of(study_from_data(values, source="a test"))
    (bare,) = operating_points_of(study_of("onyx-rgbw"))
    swept = SWEEPS["ircut-nm"].at(bare, 650.0)
    np.testing.assert_array_equal(cut.sensor.qe, swept.sensor.qe)
    assert "IR-cut at 650 nm" in cut.sensor.notes[-1]


def test_shifted_curves_peak_where_they_did_and_the_shift_away():
    """A sensor whose curves are straight lines moves exactly; there and back keeps the middle."""
    sensor = sensor_named("model-rgb", DEFAULT_GRID)
    red = with_shifted_curves(sensor, 20.0)
    at = DEFAULT_GRID.wavelength_nm
    for i, peak_nm in ((1, 535.0), (2, 460.0)):  # of green and blue, read off the curves
        assert at[sensor.qe[:, i].argmax()] == peak_nm
        assert at[red.qe[:, i].argmax()] == peak_nm + 20.0
    np.testing.assert_allclose(red.qe[4:], sensor.qe[:-4], atol=1e-15)
    np.testing.assert_array_equal(red.qe[:4], np.tile(sensor.qe[0], (4, 1)))
    back = with_shifted_curves(red, -20.0)
    np.testing.assert_allclose(back.qe[:-4], sensor.qe[:-4], atol=1e-15)
    assert "400 to 420 nm" in red.notes[-1]
    assert "1030 to 1050 nm" in back.notes[-1]
    assert with_shifted_curves(sensor, 0.0) is sensor


def test_a_shift_of_half_a_step_takes_the_mean_of_neighbors():
    sensor = sensor_named("onyx-rgbw", DEFAULT_GRID)
    half = with_shifted_curves(sensor, 2.5)
    np.testing.assert_allclose(half.qe[1:], (sensor.qe[1:] + sensor.qe[:-1]) / 2, atol=1e-15)


@pytest.mark.parametrize("shift_nm", [201.0, -201.0, float("nan")])
def test_a_shift_out_of_reason_is_refused(shift_nm):
    with refused_input(subject="shift_nm"):
        with_shifted_curves(sensor_named("onyx-rgbw", DEFAULT_GRID), shift_nm)


def test_curves_are_shifted_before_the_added_cut_which_stays_where_it_is():
    values = {"sensors": [{"name": "onyx-rgb", "ircut_nm": 650.0, "shift_nm": 30.0}]}
    sensor = sensor_of(study_from_data(values, source="a test").sensors[0])
    moved = with_shifted_curves(sensor_named("onyx-rgb", DEFAULT_GRID), 30.0)
    np.testing.assert_array_equal(sensor.qe, behind_ir_cut(moved, 650.0).qe)
    edge = int(np.argmax(DEFAULT_GRID.wavelength_nm == 650.0))
    np.testing.assert_allclose(sensor.qe[edge], 0.5 * moved.qe[edge])


def test_the_grays_noise_is_that_of_the_full_cubature():
    for analysis, result in zip(
        usual().analyses, stages_of(drawing("stages", usual())), strict=True
    ):
        full = plain(gray_noise(analysis, LAB))["sd_normal_law"]
        assert result["noise in CIELAB"] == pytest.approx(full, rel=3e-3)


def test_the_league_has_the_filters_of_the_study_among_the_cameras_and_its_own_light():
    """Light, level and matrix of the study change nothing; a filter moves its sensor."""
    plain = drawing("league", shown(study_of("model-rgb-ircut")))
    other = study_of("model-rgb-ircut", level_lux=1.0, matrices=["lmmse"])
    assert as_data(drawing("league", shown(other))) == as_data(plain)
    rows = rows_in("league", shown(study_of("model-rgb-ircut")))
    assert len(rows) == 51  # without the two whose relative heights are lost
    assert rows[-1]["camera"] == "of this study"
    redder = study_from_data(
        {"sensors": [{"name": "model-rgb-ircut", "ircut_nm": 620.0}]}, source="a test"
    )
    moved = rows_in("league", shown(redder))
    assert moved[-1]["color error [Delta E*ab]"] != rows[-1]["color error [Delta E*ab]"]
    assert moved[:-1] == rows[:-1]


def test_a_sensor_of_one_channel_is_not_in_the_league_and_says_why():
    result = drawing("league", shown(study_of("model-mono")))
    assert [one.kind for one in result.panels[0].marks] == ["cloud"]
    assert any("at least 3 channels" in note for note in result.notes)
