"""The card: its files, its sentences and numbers, and that no text covers another or is cut off."""

import base64
import re
from dataclasses import replace
from functools import cache
from io import BytesIO
from itertools import combinations
from unittest.mock import patch
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from PIL import Image

import chromanoise as cn
from chromanoise.charts import Card, brief, decimal
from chromanoise.noise import conditions
from dear import dear, dear_if

PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
FIVE = (*PAIR, "onyx-rgb", "onyx-rgbw-ircut", "model-cmy-ircut")
CARDS = {
    "one": (PAIR[1:], {"lux": 3}),
    "two on A4": (PAIR, {"lux": 3, "paper": "a4"}),
    "two on A4 with large gains": (PAIR[::-1], {"lux": 10, "paper": "a4"}),
    "two, one saturated": (PAIR, {"lux": 3, "time_ms": 60}),
    "two with long names": (PAIR, {"labels": ["a $long$ name_of^a {sensor}, " * 2, "b" * 60]}),
    "three for a machine": (FIVE[:3], {"lux": 0.3, "reader": "machine"}),
    "five": (FIVE, {"lux": 3}),
    "five on A4": (FIVE, {"lux": 1000, "illuminant": "A", "paper": "a4"}),
}
SMALLEST_PT = 9.0
OVERLAP_PX = 1.0  # of the boxes, which are higher than the letters


@cache
def card_named(name):
    sensors, settings = CARDS[name]
    return cn.card(*sensors, **settings)


@pytest.fixture(scope="module")
def pair():
    return cn.card(*PAIR, lux=3)


@pytest.fixture(scope="module")
def svg(pair):
    return pair.content("svg")


def text_of(svg):
    """All text of an SVG, with one space between words."""
    root = ElementTree.fromstring(svg)
    return " ".join(" ".join(one.itertext()) for one in root.iter() if one.tag.endswith("}text"))


def drawn_texts(figure):
    """Each text that is drawn: its words, size in points, and box in pixels from below."""
    found = []

    def recorded(renderer, gc, x, y, s, prop, angle, ismath=False, mtext=None):
        width, height, descent = renderer.get_text_width_height_descent(s, prop, ismath)
        if angle == 90:
            box = (x - height, y - width, x, y)
        else:
            box = (x, y - height + descent, x + width, y + descent)
        found.append((s, prop.get_size_in_points(), np.array(box, dtype=float)))

    with patch.object(RendererAgg, "draw_text", recorded):
        FigureCanvasAgg(figure).draw()
    return [one for one in found if one[0].strip()]


def overlap(first, second):
    """Whether two boxes share more than a rim."""
    low, high = np.maximum(first[:2], second[:2]), np.minimum(first[2:], second[2:])
    return bool((high - low > OVERLAP_PX).all())


@pytest.mark.evidence
@pytest.mark.parametrize("name", dear_if(("one", "two on A4", "five").__contains__, CARDS))
def test_no_text_is_small_or_cut_off_or_covers_another(name):
    figure = card_named(name).figure()
    wide, high = figure.get_size_inches() * figure.dpi
    texts = drawn_texts(figure)
    assert len(texts) > 40
    assert min(size for _, size, _ in texts) >= SMALLEST_PT
    inside = np.array([0, 0, wide, high])
    for words, _, box in texts:
        assert (box[:2] >= inside[:2]).all(), words
        assert (box[2:] <= inside[2:]).all(), words
    letters = [one for one in texts if len(one[0]) > 1]  # a channel's letter may touch its curve
    for first, second in combinations(letters, 2):
        assert not overlap(first[2], second[2]), (first[0], second[0])


@pytest.mark.evidence
def test_the_svg_has_the_verdict_and_the_numbers_of_the_analysis(pair, svg):
    shown = text_of(svg)
    result = cn.analyze(*PAIR, lux=3)
    sentences = result.verdict.sentences
    assert sentences[0] in shown
    for one in result.verdict.told:
        if one.about in ("why", "total", "matrix"):
            assert one.text in shown
    assert pair.footer in shown
    assert conditions(result.points) in pair.footer
    for point, analysis in zip(result.points, result.analyses, strict=True):
        for number in (point.sensor.pixel.pitch_um, point.sensor.pixel.read_noise_e):
            assert brief(number) in pair.footer
        assert f"full well {point.sensor.pixel.full_well_e:.0f} e⁻" in pair.footer
        entry = next(
            one for one in result.to_dict()["sensors"] if one["label"] == analysis.sensor.label
        )
        mean, noise = entry["color_error_mean"], entry["color"]["visual_noise"]
        label = f"{analysis.sensor.label}: mean {decimal(mean)}, visual noise {brief(noise, 3)}"
        assert label in shown
        assert decimal(entry["color"]["snr_db"]["Y"]) in shown.split()


def test_pixels_of_different_sensors_are_told_apart():
    mine = cn.sensor_named("onyx-rgb")
    quiet = replace(mine, name="quiet", pixel=replace(mine.pixel, read_noise_e=1.25))
    card = cn.card(PAIR[0], quiet, mine, lux=1)
    assert card.footer.startswith(
        "onyx-rgbw and onyx-rgb: 10 µm, full well 10000 e⁻, read noise 10"
    )
    assert "; quiet: 10 µm, full well 10000 e⁻, read noise 1.25 e⁻" in card.footer


def test_the_footer_marks_what_is_assumed_of_a_pixel():
    pixel = "5.12 µm, full well 39550 e⁻, read noise 10 e⁻ (assumed)"
    assert pixel in cn.card("sony-ilce-7m4").footer
    assert "assumed" not in cn.card("sony-ilce-7m4", read_noise_e=3.0).footer


@pytest.mark.evidence
@pytest.mark.parametrize("paper", ["16:9", *dear("a4")])
def test_each_format_is_whole_and_of_the_size_of_its_paper(done, here, paper):
    for ending in ("png", "svg", "pdf", "html"):
        out, _ = done("card", "onyx-rgb", "--lux", 3, "--paper", paper, "-o", f"new/c.{ending}")
        assert out == f"new/c.{ending}\n"
    ratio = 16 / 9 if paper == "16:9" else 297 / 210
    with Image.open("new/c.png") as picture:
        assert picture.width >= 1920
        assert picture.width / picture.height == pytest.approx(ratio, rel=2e-3)
    svg = (here / "new/c.svg").read_bytes()
    root = ElementTree.fromstring(svg)
    _, _, wide, high = map(float, root.attrib["viewBox"].split())
    assert wide / high == pytest.approx(ratio, rel=1e-3)
    pdf = (here / "new/c.pdf").read_bytes()
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", pdf)
    assert [float(one) for one in box.groups()] == pytest.approx([wide, high], abs=0.01)
    assert pdf.rstrip().endswith(b"%%EOF")
    html = (here / "new/c.html").read_text(encoding="utf-8")
    assert "<title>onyx-rgb at 3 lx" in html
    assert html[html.index("<svg") : html.index("</svg>")] in svg.decode()
    assert not re.search(r'(src|href)="http', html)
    assert sorted(path.name for path in (here / "new").iterdir()) == [
        f"c.{ending}" for ending in ("html", "pdf", "png", "svg")
    ]


def test_two_runs_write_the_same_bytes(svg):
    assert cn.card(*PAIR, lux=3).content("svg") == svg


def test_the_pictures_are_the_same_crop_with_the_noise_of_the_study(pair, svg):
    assert pair.shown == (0, 1)
    assert {one.shape for one in pair.pictures} == {(164, 240, 3)}
    embedded = re.findall(rb"data:image/png;base64,([^\"]+)", svg)
    sizes = [Image.open(BytesIO(base64.b64decode(one))).size for one in embedded]
    assert sizes.count((240, 164)) == len(embedded) == 2
    cyan = np.s_[12:76, 12:76]  # no clipped code
    noisy, quiet = (one[cyan].std(axis=(0, 1)).sum() for one in pair.pictures)
    assert noisy > 1.5 * quiet
    other = cn.card(*PAIR, lux=3, seed=1)
    assert not np.array_equal(other.pictures[0], pair.pictures[0])


@pytest.mark.evidence
def test_a_saturated_sensor_says_so():
    card = card_named("two, one saturated")
    shown = text_of(card.content("svg"))
    assert "onyx-rgbw: channel W is saturated on the white" in card.sentences[0]
    assert card.sentences[1].startswith("onyx-rgb-ircut has 34.2 dB")
    assert card.pictures[0] is None
    assert "no picture: saturated" in shown
    assert "onyx-rgbw: saturated" in shown


@pytest.mark.evidence
def test_of_five_sensors_the_winner_and_the_second_have_a_picture():
    card = card_named("five")
    best = [one.sensor for one in card.verdict.at_equal_color.standings[:2]]
    assert sorted(FIVE[i] for i in card.shown) == sorted(best)
    shown = text_of(card.content("svg"))
    assert all(shown.count(name) >= 3 for name in FIVE)


def test_for_a_machine_its_winner_has_a_picture_whatever_it_is_called():
    card = cn.card(*FIVE[:4], lux=3, reader="machine", labels=("a", "b", "c", "d"))
    names = [one.sensor.name for one in card.of.operating_points]
    assert card.verdict.winner in [names[i] for i in card.shown]
    about = {one.text: one.about for one in card.verdict.told}
    assert [about[one] for one in card.sentences] == ["machine", "machine"]
    told = card.verdict.answer + card.verdict.details
    assert sorted(told) == sorted(card.verdict.told)


def test_objects_of_python_are_on_a_card():
    own = replace(cn.sensor_named("onyx-rgb"), name="mine")
    card = cn.card(own, illuminant=cn.illuminant_named("A", own.grid), lux=1)
    assert card.title.startswith("mine at 1 lx")


@pytest.mark.evidence
def test_an_existing_file_that_the_user_names_is_replaced_and_a_failure_leaves_it(run, here):
    file = here / "card.svg"
    file.write_text("old")
    with patch.object(Card, "content", side_effect=MemoryError):
        assert run("card", "onyx-rgb", "-o", file)[0] == 2
    assert [file] == list(here.iterdir())
    assert file.read_text() == "old"
    assert run("card", "onyx-rgb", "-o", file)[0] == 0
    assert text_of(file.read_bytes()).startswith("onyx-rgb at 10 lx")
