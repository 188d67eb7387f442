"""The report and the folder of a characterized camera."""

import json
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from characterizations import color, monochrome, plane_of
from chromanoise.apps.camera import ModelVerdict, characterization_as_json, pixel_of, pixel_toml
from chromanoise.base.files import OWN_FILES
from chromanoise.io.pixels import read_emva_sheet, read_photon_transfer_csv
from chromanoise.study import read_pixel_source
from chromanoise.web import characterization_report, write_characterization
from chromanoise.web.further_reports import file_names, omitted_files
from outcomes import refused_input

ALWAYS = {"pixel.toml", "characterization.json", "report.html"}
OPTIONAL = {"noise_profile.json", "noise_profile.txt", "darktable.json", "libcamera.json"}


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.addresses, self.ids, self.tags, self.text = [], [], [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        held = dict(attrs)
        self.tags.append(tag)
        self.addresses += [held[key] for key in ("src", "href", "xlink:href") if key in held]
        self.ids += [held["id"]] if "id" in held else []

    def handle_data(self, data):
        self.text += data


@pytest.fixture
def quick(monkeypatch):
    """A report without drawings, for tests of the folder; it lists the notes."""
    monkeypatch.setattr(
        sys.modules[file_names.__module__],
        "characterization_report",
        lambda one: "\n".join(one.notes),
    )


def listed(folder):
    return {path.name for path in folder.iterdir()} - {OWN_FILES}


@pytest.fixture(scope="module")
def report():
    return characterization_report(color(camera="<b>&"))


def test_the_report_needs_no_other_file(report):
    page = Page(report)
    assert page.addresses
    assert all(address.startswith("#") for address in page.addresses)
    assert not {"script", "link", "img", "iframe"} & set(page.tags)
    assert "default-src 'none'" in report
    assert not re.findall(r"@import|url\((?!#)", report)


def test_each_id_of_the_report_is_unique_and_each_reference_has_one(report):
    page = Page(report)
    assert len(set(page.ids)) == len(page.ids)
    used = {*page.addresses, *(f"#{name}" for name in re.findall(r"url\(#([^)]+)\)", report))}
    assert {one.removeprefix("#") for one in used} <= set(page.ids)


def test_the_report_has_six_charts_and_the_colors_of_the_page(report):
    assert Page(report).tags.count("svg") == 6
    for drawing in re.findall(r"<svg.*?</svg>", report, re.DOTALL):
        assert "var(--quiet)" in drawing
        assert not re.search("#1b1f23|#575e66|#ffffff|#d55e00", drawing, re.IGNORECASE)


def test_the_report_shows_every_plane_with_its_gain_and_error(report):
    page = Page(report)
    assert "<b>&" in page.text
    for plane in color().planes:
        assert f"{plane.gain_dn_per_e:.4f} ± {plane.gain_dn_per_e_se:.4f}" in page.text


@pytest.mark.evidence
def test_the_verdict_stands_at_the_top_with_its_sentences():
    sentence = "neighbors in a row correlate by 0.21 at level 3"
    verdict = ModelVerdict(
        holds=False,
        chi2_per_level=19.0,
        worst_level="level 6",
        worst_z=-14.2,
        sentences=(sentence,),
    )
    text = Page(characterization_report(monochrome(verdict=verdict))).text
    assert text.index("does not hold") < text.index(sentence) < text.index("Parameters")
    assert "−14.2 standard errors, at level 6" in " ".join(text.split())
    assert "does not hold" not in Page(characterization_report(monochrome())).text


def test_names_of_planes_are_drawn_as_they_are():
    names = ("$x", "_y", "<z>")
    result = color(planes=tuple(plane_of(name) for name in names))
    legends = [drawing.text for drawing in drawings(characterization_report(result))]
    assert all(name in legends[0] for name in names)


def drawings(text):
    return [Page(one) for one in re.findall(r"<svg.*?</svg>", text, re.DOTALL)]


def test_levels_without_light_have_no_chart_of_linearity():
    plane = plane_of()
    levels = tuple(replace(one, photons_per_pixel=None, time_ms=5.0) for one in plane.levels)
    result = characterization_report(monochrome(planes=(replace(plane, levels=levels),)))
    assert Page(result).tags.count("svg") == 4


def test_values_that_are_not_known_are_dashes():
    unknown = {
        name: None
        for name in characterization_as_json(monochrome())["planes"][0]
        if name not in ("name", "gain_dn_per_e", "gain_dn_per_e_se", "levels", "fit")
    }
    plane = replace(plane_of(), **unknown)
    rows = Page(characterization_report(monochrome(planes=(plane,), iso=None, bits=None))).text
    assert rows.count("–") >= 12


def test_the_folder_holds_every_form_and_each_is_read(tmp_path):
    result = color()
    written = write_characterization(result, tmp_path / "out")
    names = {path.name for path in written}
    sheets = {
        f"{kind}_{plane}.{ending}"
        for plane in ("R", "G1", "G2", "B")
        for kind, ending in (
            *(("data_sheet", "txt"), ("data_sheet", "xml")),
            ("photon_transfer", "csv"),
        )
    }
    assert names == ALWAYS | OPTIONAL | sheets == listed(tmp_path / "out")
    folder = tmp_path / "out"
    assert read_pixel_source(folder / "pixel.toml") == pixel_of(result)
    assert json.loads((folder / "characterization.json").read_text()) == characterization_as_json(
        result
    )
    assert read_emva_sheet(folder / "data_sheet_B.txt").full_well_e == result.planes[3].full_well_e
    assert read_photon_transfer_csv(folder / "photon_transfer_G1.csv").mean_dn.size == 9


def test_what_cannot_be_written_is_named_with_its_reason(quick, tmp_path):
    write_characterization(monochrome(iso=None, bits=None), tmp_path)
    assert not OPTIONAL & listed(tmp_path)
    notes = json.loads((tmp_path / "characterization.json").read_text())["notes"]
    assert [note.split()[0] for note in notes[1:]] == [
        *("noise_profile.json", "noise_profile.txt", "darktable.json", "libcamera.json")
    ]
    assert "darktable.json is not written" in (tmp_path / "report.html").read_text()
    assert omitted_files(monochrome(iso=None, bits=None)) == notes[1:]
    assert omitted_files(color()) == []


def test_a_folder_with_files_of_another_camera_is_refused(quick, tmp_path):
    write_characterization(color(), tmp_path)
    before = (tmp_path / "report.html").read_bytes()
    with refused_input(subject=str(tmp_path), value="darktable.json"):
        write_characterization(monochrome(), tmp_path)
    assert (tmp_path / "report.html").read_bytes() == before


def test_names_of_planes_are_safe_and_distinct_names_of_files():
    planes = [plane_of(name) for name in ("R", "r", "a/..\\b", "")]
    assert file_names(planes) == ("R", "r_1", "a____b", "plane")


def test_analyze_takes_the_pixel_file_as_the_values_in_it(done, tmp_path):
    result = color()
    path, pixel = tmp_path / "pixel.toml", pixel_of(result)
    path.write_text(pixel_toml(result))
    options = {
        "full-well-e": pixel.full_well_e,
        "read-noise-e": pixel.read_noise_e,
        "dark-current-e-per-s": pixel.dark_current_e_per_s,
        "dsnu-e": pixel.dsnu_e,
        "prnu": pixel.prnu,
        "row-noise-e": 3.0,
        "column-noise-e": pixel.column_noise_e,
        "bits": 12,
        "gain-dn-per-e": 1 / pixel.gain_e_per_dn,
    }
    words = [word for name, value in options.items() for word in (f"--{name}", value)]
    without = [word for word in words if word not in ("--row-noise-e", 3.0)]
    ways = [("--pixel", path), words, without]
    read = [done("analyze", "onyx-rgbw", "--lux", 1, *one, "--json", "-")[0] for one in ways]
    of_file, given, without = (json.loads(text)["sensors"][0]["color"] for text in read)
    assert numbers(of_file) == pytest.approx(numbers(given), rel=1e-9)
    assert numbers(of_file) != pytest.approx(numbers(without), rel=1e-9)


def numbers(held):
    """The numbers in nested data, in order."""
    if isinstance(held, dict | list):
        parts = held.values() if isinstance(held, dict) else held
        return [number for part in parts for number in numbers(part)]
    return [held] if isinstance(held, float) else []
