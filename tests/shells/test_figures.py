"""The ten figures: what they hold, what they say, and that their files are whole and repeatable."""

import re
from dataclasses import replace
from io import BytesIO
from itertools import combinations

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from chromanoise.api import analyze, compare, matrix, render
from chromanoise.apps.paper import paper_planes, paper_study
from chromanoise.apps.paper.figures_of_paper import (
    CAPTIONS,
    draw_color_projection,
    draw_contravariant,
    draw_measurement,
    draw_mosaic,
    draw_uncertainty,
    paper_figures,
)
from chromanoise.apps.paper.printed_numbers import RGB_12, RGB_59, RGBW_12
from chromanoise.apps.paper.views import channel_plane, magnified_noise
from chromanoise.base.errors import InputError
from chromanoise.charts import (
    chromanoise_style,
    draw_analyses,
    draw_capture,
    draw_matrices,
    draw_sensitivities,
    write_figures,
)
from chromanoise.charts.figure_style import channel_color, figure_bytes, sensor_dashes, sensor_label
from chromanoise.sensor import bayer
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import analyzed, color_snr_db, sensor_named

STILL = ("figure-03-measurement", "figure-04-contravariant", "figure-06-projection")
NOISY = ("figure-09-correlation", "figure-10-color-axis")
PICTURE = np.linspace(0, 255, 40 * 60 * 3).astype(np.uint8).reshape(40, 60, 3)


@pytest.fixture(scope="module")
def study():
    return paper_study()


@pytest.fixture(scope="module")
def figures(study):
    return paper_figures(study, paper_planes(study), (PICTURE, PICTURE))


@pytest.fixture(scope="module")
def svgs(figures):
    return {name: figure_bytes(figure, "svg") for name, figure in figures.items()}


def texts_of(parent):
    """Everything that is written and not empty."""
    return [t for t in parent.findobj(Text) if t.get_visible() and t.get_text().strip()]


def written_in(parent):
    return "\n".join(text.get_text() for text in texts_of(parent))


def test_there_are_ten_figures_each_with_a_caption_of_one_sentence(figures):
    numbers = [int(name.split("-")[1]) for name in figures]
    assert numbers == list(range(1, 11))
    assert list(CAPTIONS) == list(figures)
    for caption in CAPTIONS.values():
        assert caption.endswith(".")
        assert ". " not in caption


def test_without_pictures_there_is_no_figure_8(study):
    assert set(CAPTIONS) - set(paper_figures(study, paper_planes(study))) == {"figure-08-pictures"}


@pytest.mark.parametrize("name", [*STILL, *NOISY])
def test_geometry_is_drawn_to_scale_and_says_what_it_is(figures, name):
    for ax in figures[name].axes:
        assert ax.get_aspect() == 1
        said = written_in(ax)
        assert re.search(r"\d+\.\d°", said)
        assert ("without noise" if name in STILL else "noise magnified ×") in said
    assert "reconstruction" in written_in(figures[name])


@pytest.mark.parametrize("name", NOISY)
def test_both_panels_share_one_magnification_and_one_scale(figures, name):
    top, bottom = figures[name].axes
    assert len(set(re.findall(r"magnified ×(\d+)", written_in(figures[name])))) == 1
    # inches of paper per unit of light, along both coordinates
    inches = [
        ax.get_position().size
        * figures[name].get_size_inches()
        / np.ptp([ax.get_xlim(), ax.get_ylim()], axis=1)
        for ax in (top, bottom)
    ]
    np.testing.assert_allclose(np.ravel(inches), inches[0][0], rtol=1e-9)


def labels_of(ax):
    """What was written on purpose: all but the numbers at the ticks."""
    framed = [ax.xaxis.label, ax.yaxis.label] if ax.axison else []
    return [t for t in (ax._left_title, *ax.texts, *framed) if t.get_text()]


def drawn(figure):
    with chromanoise_style():
        renderer = FigureCanvasAgg(figure).get_renderer()
        figure.draw(renderer)
    return renderer


@pytest.mark.parametrize("name", CAPTIONS)
def test_no_two_labels_overlap_and_none_leaves_the_figure(figures, name):
    figure = figures[name]
    renderer = drawn(figure)
    labels = [label for ax in figure.axes for label in labels_of(ax)]
    boxes = [(t.get_text(), t.get_window_extent(renderer)) for t in labels]
    for text, box in boxes:
        assert box.x0 >= 0, text
        assert box.y0 >= 0, text
        assert box.x1 <= figure.bbox.x1, text
        assert box.y1 <= figure.bbox.y1, text
    for (one, a), (two, b) in combinations(boxes, 2):
        assert not a.overlaps(b), (one, two)


@pytest.mark.parametrize("name", ["figure-05-observer", "figure-07-sensitivities"])
def test_no_curve_runs_through_a_letter(figures, name):
    renderer = drawn(figures[name])
    for ax in figures[name].axes:
        curves = [ax.transData.transform_path(line.get_path()) for line in ax.lines]
        for text in ax.texts:
            box = text.get_window_extent(renderer)
            assert not any(c.intersects_bbox(box, filled=False) for c in curves), text.get_text()


@pytest.mark.parametrize(("panel", "column"), [(0, RGBW_12), (1, RGB_12)])
def test_every_curve_has_its_letter_its_color_and_its_sensors_dashes(figures, study, panel, column):
    ax = figures["figure-07-sensitivities"].axes[panel]
    sensor = study.columns[column].sensor
    assert f"{sensor.name} (reconstruction)" == ax.get_title(loc="left")
    assert {t.get_text() for t in ax.texts} == {*sensor.names, "near infrared"}
    assert [line.get_color() for line in ax.lines] == [channel_color(n) for n in sensor.names]
    for line, qe in zip(ax.lines, sensor.qe.T, strict=True):
        np.testing.assert_array_equal(line.get_ydata(), qe)


def test_the_two_sensors_differ_in_dashes():
    figure = Figure()
    lines = [
        draw_sensitivities(sensor_named(name, DEFAULT_GRID), figure.add_subplot()).lines[-1]
        for name in ("onyx-rgbw", "onyx-rgb-ircut")
    ]
    assert not lines[0].is_dashed()
    assert lines[1].is_dashed()


def test_as_many_sensors_as_a_page_shows_have_each_a_dash_of_its_own():
    names = ["onyx-rgbw", "mine", "yours", "onyx-rgb", "theirs", "a", "b", "c"]
    patterns = sensor_dashes([*names, "mine"])
    assert list(patterns) == names
    assert len({str(pattern) for pattern in patterns.values()}) == len(names)
    assert patterns["onyx-rgbw"] == "solid"


def test_the_flow_shows_the_luminance_snr_of_both_sensors(figures, study):
    for ax, column in zip(figures["figure-02-flow"].axes, (RGBW_12, RGB_12), strict=True):
        assert f"{color_snr_db(study.columns[column])['Y']:.1f} dB" in written_in(ax)


def test_a_mosaic_repeats_its_block():
    ax = draw_mosaic(bayer(), Figure().add_subplot(), cells=4)
    assert [t.get_text() for t in ax.texts] == list("RGRGGBGBRGRGGBGB")


def test_a_measured_sensor_is_not_called_a_reconstruction():
    assert sensor_label("my-model", "given") == "my-model"


def test_saturated_channels_have_no_snr_to_show(study):
    bright = study.columns[RGB_59]
    exposure = type(bright.exposure)(time_s=1.0)
    plane = channel_plane(analyzed(bright.scene, bright.sensor, exposure), ("R", "G"))
    ax = draw_uncertainty(plane, magnified_noise(plane, 5), Figure().add_subplot())
    assert "spectral SNR undefined (saturated)" in written_in(ax)


def test_channel_names_with_signs_of_a_formula_are_written_as_they_are(study):
    bright = study.columns[RGB_59]
    sensor = replace(bright.sensor, names=("a_1", "50%", "c{^}$"), mosaic=None)
    analysis = analyzed(bright.scene, sensor, bright.exposure)
    for names in (("a_1", "50%"), ("50%", "c{^}$")):
        plane = channel_plane(analysis, names)
        for draw in (draw_measurement, draw_contravariant, draw_color_projection):
            figure = Figure()
            draw(plane, figure.add_subplot())
            figure_bytes(figure, "svg")


@pytest.mark.parametrize("name", CAPTIONS)
def test_svg_keeps_text_as_text_and_has_no_date(svgs, name):
    svg = svgs[name].decode()
    assert svg.count("<text") >= 2
    assert "reconstruction" in svg or name in ("figure-01-mosaics", "figure-05-observer")
    assert "dc:date" not in svg


@pytest.mark.evidence
def test_two_runs_give_the_same_bytes(study, svgs):
    again = paper_figures(study, paper_planes(study), (PICTURE, PICTURE))
    for name, figure in again.items():
        assert figure_bytes(figure, "svg") == svgs[name], name
    name = "figure-04-contravariant"
    for ending in ("png", "pdf"):
        first, second = (figure_bytes(again[name], ending) for _ in range(2))
        assert first == second


def test_drawing_leaves_the_users_settings_alone_and_ignores_them(study, svgs):
    with matplotlib.rc_context({"font.size": 20, "figure.facecolor": "red"}):
        before = dict(matplotlib.rcParams)
        figure = paper_figures(study, paper_planes(study))["figure-04-contravariant"]
        assert figure_bytes(figure, "svg") == svgs["figure-04-contravariant"]
        assert dict(matplotlib.rcParams) == before


def test_png_opens_at_150_dots_per_inch(figures):
    for figure in figures.values():
        image = Image.open(BytesIO(figure_bytes(figure, "png")))
        np.testing.assert_allclose(image.size, 150 * figure.get_size_inches(), atol=1)


def test_each_figure_is_written_as_png_svg_and_pdf_and_nothing_else(figures, tmp_path):
    name = "figure-04-contravariant"
    paths = write_figures({name: figures[name]}, tmp_path / "new" / "folder")
    assert [path.name for path in paths] == [f"{name}.{ending}" for ending in ("png", "svg", "pdf")]
    assert sorted(paths) == sorted((tmp_path / "new" / "folder").iterdir())
    assert [path.read_bytes()[:5] for path in paths] == [b"\x89PNG\r", b"<?xml", b"%PDF-"]


def test_a_write_that_fails_leaves_nothing_half_done(figures, tmp_path):
    name = "figure-04-contravariant"
    (tmp_path / f"{name}.png").mkdir()  # a folder stands where the file should go
    with pytest.raises(InputError, match=name):
        write_figures({name: figures[name]}, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [f"{name}.png"]


def test_who_reads_a_figure_while_it_is_replaced_reads_the_old_one_whole(figures, tmp_path):
    name = "figure-04-contravariant"
    old = tmp_path / f"{name}.png"
    old.write_bytes(b"the old figure")
    with old.open("rb") as reader:
        write_figures({name: figures[name]}, tmp_path)
        assert reader.read() == b"the old figure"
    assert old.read_bytes().startswith(b"\x89PNG")


PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
POINT = "10 lx (illuminant E, 11.94 ms, f/1.8)"


@pytest.fixture
def ax():
    return Figure(layout="constrained").add_subplot()


def bars_of(ax):
    """Lengths of the bars of each set, by its entry in the legend."""
    return {
        bars.get_label(): [bar.get_width() for bar in bars]
        for bars in ax.containers
        if hasattr(bars, "patches")
    }


def test_the_bars_of_each_sensor_lead_from_the_photons_to_its_snr(ax):
    """By the SNR of the analysis and the photons of the legend."""
    result = analyze(*PAIR)
    assert draw_analyses(result.analyses, ax) is ax
    drawn = bars_of(ax)
    for analysis in result.analyses:
        (label,) = (one for one in drawn if one.startswith(f"{analysis.sensor.name}: "))
        left, photons = (float(one) for one in re.findall(r"([\d.]+) dB", label))
        start, *changes, end = drawn[label]
        assert start == pytest.approx(photons, abs=0.051)
        assert end == pytest.approx(color_snr_db(analysis)["Y"])
        assert left == pytest.approx(end, abs=0.051)
        assert start + sum(changes) == pytest.approx(end)
    assert ax.get_xlabel() == "SNR of Y [dB]"
    assert POINT in ax.get_title(loc="left")
    names = [text.get_text() for text in ax.get_yticklabels()]
    assert (names[0], names[-2], names[-1]) == (
        "all photons",
        "infrared leaking into Y",
        "SNR of Y",
    )


def test_a_cause_of_one_sensor_alone_stands_among_those_of_the_other(ax):
    mixed = analyze("onyx-rgb", crosstalk=0.3, mosaic="bayer").analyses
    draw_analyses([*analyze("onyx-rgb").analyses, *mixed], ax)
    names = [text.get_text() for text in ax.get_yticklabels()]
    assert 0 < names.index("crosstalk") < len(names) - 1
    assert len(set(names)) == len(names)


def test_a_saturated_sensor_has_no_bar_and_is_named(ax):
    for sensors, drawn in ((PAIR, ["onyx-rgb-ircut"]), (PAIR[:1], [])):
        ax.clear()
        draw_analyses(analyze(*sensors, time_ms=30.0).analyses, ax)
        assert [label.partition(":")[0] for label in bars_of(ax)] == drawn
        named = " ".join(text.get_text() for text in ax.get_legend().get_texts())
        assert "onyx-rgbw: channels" in named
        assert "saturated" in named


def test_each_entry_of_a_matrix_is_a_bar_in_the_color_of_its_channel(ax):
    one = matrix("onyx-rgbw")
    draw_matrices([one], ax)
    bars = [bar for group in ax.containers for bar in group]
    np.testing.assert_allclose([b.get_height() for b in bars], one.matrix.matrix.ravel())
    colors = [matplotlib.colors.to_hex(bar.get_facecolor()).upper() for bar in bars[:4]]
    assert colors == [channel_color(name).upper() for name in "RGBW"]
    assert [text.get_text() for text in ax.texts] == list("RGBW" * 3)
    assert "[lx/e⁻]" in ax.get_ylabel()
    assert POINT in ax.get_title(loc="left")


def test_a_pareto_curve_goes_through_the_errors_and_ratios_of_its_matrices(ax):
    one = matrix("onyx-rgbw", pareto_first=0.01, pareto_last=100.0)
    draw_matrices([one], ax)
    at = ax.lines[0].get_xydata()
    np.testing.assert_array_equal(at[:, 0], one.pareto.snr_y_db)
    np.testing.assert_array_equal(at[:, 1], one.pareto.delta_e)
    assert [text.get_text() for text in ax.texts] == ["0.01", "100"]
    assert (ax.get_xlabel()[-4:], ax.get_ylabel()[-7:]) == ("[dB]", "[ΔE*ab]")


def test_a_comparison_is_drawn_on_one_axes_with_its_crossovers(ax):
    result = compare(*PAIR, matrices=("kernel", "lmmse"))
    assert result.plot(ax) is ax
    curves = [line.get_xydata() for line in ax.lines[:4]]
    circles = [line for line in ax.lines[4:] if line.get_marker() == "o"]  # not the line of 0 dB
    for line, curve in zip(curves, result.curves, strict=True):
        np.testing.assert_array_equal(line, np.stack([curve.at, curve.value], axis=1))
    crossed = [value for one in result.crossovers for value in one.at]
    assert crossed
    assert [circle.get_xdata()[0] for circle in circles] == crossed
    assert ax.get_ylabel() == "SNR of Y of a white [dB]"
    assert ax.get_xlabel() == "illuminance [lx]"
    assert POINT in ax.get_title(loc="left")


def test_a_capture_is_drawn_pixel_for_pixel(ax):
    (shot,) = render("builtin:checker", "onyx-rgbw").captures
    draw_capture(shot, ax)
    (image,) = ax.images
    np.testing.assert_array_equal(image.get_array(), shot.picture.srgb)
    assert image.get_interpolation() == "none"
    assert POINT in ax.get_title(loc="left")


def test_codes_without_color_are_gray_up_to_the_top_code(ax):
    (shot,) = render("builtin:checker", "onyx-rgb-ircut", mosaic="RG/GB", raw_only=True).captures
    draw_capture(shot, ax)
    (image,) = ax.images
    np.testing.assert_array_equal(image.get_array(), shot.raw.codes)
    assert image.get_clim() == (0, shot.raw.adc.top_code)


def test_the_other_charts_of_an_analysis_have_a_panel_per_sensor():
    pair = analyze("onyx-rgbw", "onyx-rgb-ircut")
    panels = Figure().subplots(1, 2)
    assert pair.plot(panels, kind="ellipses") == list(panels)
    assert [len(ax.patches) for ax in panels] == [24, 24]
    panels = Figure().subplots(2, 1)
    pair.plot(panels, kind="budget")
    for analysis, ax in zip(pair.analyses, panels, strict=True):
        last = ax.patches[-1]
        assert last.get_width() == pytest.approx(color_snr_db(analysis)["Y"])


def test_an_unknown_chart_or_too_few_axes_are_refused():
    pair = analyze("onyx-rgbw", "onyx-rgb-ircut")
    with pytest.raises(InputError, match="did you mean ellipses"):
        pair.plot(kind="ellipse")
    with pytest.raises(InputError, match="must be 2 axes"):
        pair.plot(Figure().subplots(), kind="flow")


def test_all_pictures_are_drawn_side_by_side():
    taken = render("builtin:checker", "onyx-rgbw", "onyx-rgb-ircut")
    for capture, ax in zip(taken.captures, taken.plot(Figure().subplots(1, 2)), strict=True):
        np.testing.assert_array_equal(ax.images[0].get_array(), capture.picture.srgb)
