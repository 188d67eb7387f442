"""Every written file is read back to the last digit, by every reader that accepts it."""

import json

import numpy as np
import pytest

from chromanoise.io.spectra import Answers, read_curves
from chromanoise.study.resolve_names import resolve_filter, resolve_illuminant, resolve_sensor
from dear import dear

AT_NM = np.array([400.0, 437.5, 500.0, 612.3, 700.0, 1050.0])
SMALL = 10.0 ** np.array([-1, -3, -12, 0, -6, -2])


pytestmark = pytest.mark.usefixtures("here")


def values(curves: int, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.random((AT_NM.size, curves)) * SMALL[:, None]


def write_csv(path, table, names):
    rows = [",".join(map(repr, [at, *row])) for at, row in zip(AT_NM.tolist(), table, strict=True)]
    path.write_text("\n".join([f"wavelength_nm,{','.join(names)}", *rows]))


SAID = {
    "QE": ("--quantity", "QE", "--absolute"),
    "QE of unknown level": ("--quantity", "QE"),
    "QE that is relative": ("--quantity", "QE", "--relative"),
    "response": ("--quantity", "response", "--energy", "--relative"),
    "response per photon": ("--quantity", "response", "--photons", "--absolute"),
    "reflectance": ("--quantity", "reflectance"),
    "transmittance": ("--quantity", "transmittance", "--fraction"),
    "power": ("--quantity", "power", "--energy"),
    "photons": ("--quantity", "power", "--photons"),
    "nothing": (),
}
KEPT = ("quantity", "level", "per", "scale")


@pytest.mark.parametrize("said", SAID)
@pytest.mark.parametrize("ending", [".csv", ".json", ".spdx"])
@pytest.mark.parametrize("high", [1.0, *dear(3.7), 81.25])
def test_convert_reads_what_it_writes_with_all_declarations(done, here, ending, said, high):
    table = values(1) * high
    write_csv(here / "a.csv", table.tolist(), ["R"])
    beside = () if {"power", "response", "--fraction"} & set(SAID[said]) else ("--fraction",)
    done("convert", "a.csv", f"b{ending}", *SAID[said], *beside)
    done("convert", f"b{ending}", "c.json")
    for name in (f"b{ending}", "c.json"):
        read = read_curves(here / name)
        assert np.array_equal(read.curves.wavelength_nm, AT_NM)
        assert np.array_equal(read.curves.values, table)
        assert read.curves.names == ("R",)
        for key in KEPT:
            first = read_curves(here / "a.csv", answers=answers_of((*SAID[said], *beside)))
            assert getattr(read, key) == getattr(first, key), key


def answers_of(words):
    either = {
        "--absolute": {"level": "absolute"},
        "--relative": {"level": "relative"},
        "--energy": {"per": "energy"},
        "--photons": {"per": "photon"},
        "--fraction": {"scale": "fraction"},
    }
    found = {key: value for word in words for key, value in either.get(word, {}).items()}
    quantity = {"quantity": words[1]} if "--quantity" in words else {}
    return Answers(**found, **quantity)


@pytest.mark.parametrize("ending", [".csv", ".json"])
def test_names_that_look_like_units_and_values_that_look_like_wavelengths_survive(
    done, here, ending
):
    # 300 and 90 beside each other are two digitized curves where the heading does not say more
    names = ["clear [%]", "white (far)", "R %"]
    table = np.stack([values(1)[:, 0] * 50, 300 + AT_NM, values(1, 2)[:, 0]], axis=1)
    held = {
        "schema": "chromanoise spectra", "schema_version": 1, "version": "0", "quantity": "power",
        "unit": "1", "source": "a bench", "notes": ["one; two", "relative or %"], "names": names,
        "wavelength_nm": AT_NM.tolist(), "values": table.tolist(),
    }  # fmt: skip
    (here / "a.json").write_text(json.dumps(held))
    done("convert", "a.json", f"b{ending}")
    read = read_curves(here / f"b{ending}")
    assert read.curves.names == tuple(names)
    assert np.array_equal(read.curves.values, table)
    assert read.said_source == "a bench"
    assert read.level is None


@pytest.mark.parametrize("ending", [".csv", ".json"])
def test_the_qe_that_convert_writes_is_the_sensor_that_it_read(done, result_of, here, ending):
    write_csv(here / "cam.csv", (values(3) + 0.01).clip(max=1).tolist(), "RGB")
    answers = ("--quantity", "QE", "--absolute")
    done("convert", "cam.csv", f"again{ending}", *answers)
    first = resolve_sensor("cam.csv", answers=Answers(quantity="QE", level="absolute"))
    again = resolve_sensor(f"again{ending}")
    assert np.array_equal(first.qe, again.qe)
    assert first.names == again.names
    ours, theirs = (
        result_of("analyze", *words)["sensors"][0]["channels"]
        for words in ([f"again{ending}"], ["cam.csv", "--absolute"])
    )
    assert ours == theirs


@pytest.mark.parametrize("ending", [".csv", ".json"])
def test_a_sensor_of_the_catalog_comes_back_from_either_file(done, result_of, here, ending):
    done("convert", "onyx-rgbw", f"mine{ending}")
    data = [result_of("analyze", name)["sensors"][0] for name in ("onyx-rgbw", f"mine{ending}")]
    assert data[0]["channels"] == data[1]["channels"]
    assert data[0]["color"] == data[1]["color"]


@pytest.mark.parametrize("ending", [".csv", ".json", ".spdx"])
def test_a_light_that_convert_writes_is_the_light_that_it_read(done, here, ending):
    write_csv(here / "lamp.csv", (values(1) + 0.1).tolist(), ["lamp"])
    done("convert", "lamp.csv", f"again{ending}", "--quantity", "power", "--photons")
    first = resolve_illuminant("lamp.csv", answers=Answers(quantity="power", per="photon"))
    again = resolve_illuminant(f"again{ending}")
    mixed = resolve_illuminant(f"again{ending}+0.5xLED850")
    assert np.array_equal(first.irradiance, again.irradiance)
    # the diode adds almost no illuminance
    assert mixed.irradiance.sum() == pytest.approx(1.5 * again.irradiance.sum(), rel=1e-3)
    done("analyze", "onyx-rgbw", "--illuminant", f"again{ending}")


@pytest.mark.parametrize("ending", [".csv", ".json", ".spdx"])
def test_a_filter_that_convert_writes_is_the_filter_that_it_read(done, here, ending):
    write_csv(here / "glass.csv", values(1).tolist(), ["glass"])
    done("convert", "glass.csv", f"again{ending}", "--quantity", "transmittance")
    first, again = resolve_filter("glass.csv"), resolve_filter(f"again{ending}")
    assert np.array_equal(first.values, again.values)
    done("analyze", "onyx-rgbw", "--filter", f"again{ending}")


def test_curves_that_convert_writes_work_in_the_users_folder(done, here, monkeypatch):
    write_csv(here / "cam.csv", values(2).tolist(), "RG")
    folder = here / "mine"
    folder.mkdir()
    done("convert", "cam.csv", folder / "my-cam.csv", "--quantity", "QE", "--absolute")
    (folder / "SOURCES.toml").write_text(
        '[my-cam]\nkind = "sensor"\nwhat = "a camera"\nsource = "a bench"\nlicense = "mine"\n'
        'defects = "none"\nquantity = "QE"\nunit = "e-/photon"\nlevel = "absolute"\n'
    )
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(folder))
    first = resolve_sensor("cam.csv", answers=Answers(quantity="QE", level="absolute"))
    assert np.array_equal(resolve_sensor("my-cam").qe, first.qe)


def test_a_rawtoaces_camera_that_convert_writes_it_writes_again_the_same(done, here):
    done("convert", "onyx-rgb", "a.json", "--as", "rawtoaces", "--created", "2026-01-31")
    data = json.loads((here / "a.json").read_text())["spectral_data"]["data"]["main"]
    read = read_curves(here / "a.json").curves
    assert read.wavelength_nm.tolist() == [float(at) for at in data]
    assert read.values.tolist() == list(data.values())
    for name in ("b.csv", "b.json"):
        done("convert", "a.json", name)
        done("convert", name, "again.json", "--as", "rawtoaces")
        again = json.loads((here / "again.json").read_text())["spectral_data"]["data"]["main"]
        assert again == data
