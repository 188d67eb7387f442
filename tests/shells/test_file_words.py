"""One rule decides whether a word for a sensor, a light or a filter names a file."""

import numpy as np
import pytest

from chromanoise.io.spectra import Answers
from chromanoise.study import read_study, study_hash
from chromanoise.study.resolve_names import (
    is_file_word,
    resolve_filter,
    resolve_illuminant,
    word_files,
)

CAMERA = "wavelength_nm,R,G,B\n400,0.1,0.1,0.5\n700,0.6,0.2,0.1\n1050,0.1,0.1,0.1\n"
LAMP = "wavelength [nm],power [W]\n380,1\n1060,2\n"
GLASS = "wavelength [nm],transmittance\n380,0.9\n1060,0.5\n"
ENDINGS = ["csv", "dat", "ecsv", "sed", "asc", "tab", "sli.txt", "DAT", ""]


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CHROMANOISE_CATALOG", raising=False)
    return tmp_path


def written(path, text):
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    return path


@pytest.fixture
def analysis(result_of):
    def call(*arguments):
        data = result_of("analyze", *arguments)
        return [[sensor[part] for part in ("channels", "color")] for sensor in data["sensors"]]

    return call


@pytest.mark.parametrize("ending", ENDINGS)
def test_every_ending_works_for_a_sensor_a_light_and_a_filter(here, analysis, ending):
    end = f".{ending}" if ending else ""
    for name, text in (("cam", CAMERA), ("lamp", LAMP), ("glass", GLASS)):
        written(here / f"{name}.csv", text)
        written(here / f"{name}{end}", text)
    words = lambda end: (  # noqa: E731
        f"cam{end}", "--illuminant", f"lamp{end}+0.5xLED850", "--filter", f"glass{end}"
    )  # fmt: skip
    assert analysis(*words(end)) == analysis(*words(".csv"))


@pytest.mark.parametrize(
    ("kind", "known", "files"),
    [
        ("sensor", ["onyx-rgbw", "ar0132at-rgbw"], ["cam.csv", "a/cam", "./onyx-rgbw", "~/x"]),
        ("light", ["D65", "FL3.1", "5500.5K", "LED850/20", "LED850.5/20"], ["D65.dat", "a/b"]),
        ("filter", ["ircut-650.5/8", "ircut-schott"], ["ircut.sed", "/dev/fd/3"]),
    ],
)
def test_a_word_is_a_file_if_it_looks_like_one_or_exists_and_is_not_in_the_catalog(
    here, kind, known, files
):
    assert not any(is_file_word(word, kind) for word in known)
    assert all(is_file_word(word, kind) for word in files)
    for word in ("plain", *known):
        if "/" not in word:
            written(here / word, "400,1\n")
    # a file never hides a name of the catalog
    assert not any(is_file_word(word, kind) for word in known)
    assert is_file_word("plain", kind)
    assert not is_file_word("plain", kind, folder=here / "elsewhere")
    (here / "folder").mkdir()
    assert not is_file_word("folder", kind)


@pytest.mark.parametrize("ending", [".dat", ""])
def test_files_of_a_study_are_found_in_its_folder_with_any_ending(here, ending):
    for name, text in (("cam", CAMERA), ("lamp", LAMP), ("glass", GLASS)):
        written(here / "project" / f"{name}{ending}", text)
    (here / "project/study.toml").write_text(
        f'[light]\nilluminant = "lamp{ending}+0.5xLED850"\n'
        f'[[sensors]]\nname = "cam{ending}"\nfilter = "glass{ending}"\n'
    )
    study = read_study("project/study.toml")
    assert study.light.illuminant == f"project/lamp{ending}+0.5xLED850"
    assert study.sensors[0].name == f"project/cam{ending}"
    assert study.sensors[0].filter == f"project/glass{ending}"
    before = study_hash(study)
    written(here / "project" / f"glass{ending}", GLASS.replace("0.5", "0.6"))
    assert study_hash(study) != before


def test_the_digest_of_an_envi_library_covers_header_and_data(here):
    written(here / "lamp.hdr", "ENVI\n")
    written(here / "lamp.sli", "")
    assert {path.name for path in word_files("lamp.sli", "light")} == {"lamp.hdr", "lamp.sli"}


def test_an_envi_library_works_as_light_and_filter(here):
    (here / "x.hdr").write_text(
        "ENVI\nsamples = 2\nlines = 1\nbands = 1\ndata type = 5\ninterleave = bsq\nbyte order = 0\n"
        "file type = ENVI Spectral Library\nwavelength units = Nanometers\nz plot titles = {, W}\n"
        "wavelength = {380, 1060}\nspectra names = {spectral power [W]}\n"
    )
    (here / "x.sli").write_bytes(np.array([0.25, 0.75]).tobytes())
    passes = resolve_filter("x.sli")
    assert passes.values[:, 0] == pytest.approx(0.25 + 0.5 * (passes.wavelength_nm - 380) / 680)
    light = resolve_illuminant("x.hdr", answers=Answers(quantity="power", per="energy"))
    slope = light.irradiance / (0.25 + 0.5 * (light.grid.wavelength_nm - 380) / 680)
    assert slope == pytest.approx(slope[0])
