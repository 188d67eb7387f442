"""Look-alikes of public files of spectra: each is read right, asks, or is refused in one sentence.

`public_spectral_files.toml` holds facts of each file: its layout, its unit, its range and its
highest value. The curves between are made up here; no data of others is copied.
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from chromanoise.io.spectra import Answers, read_curves
from outcomes import refused_input

FILES: list[dict[str, Any]] = tomllib.loads(
    Path(__file__).with_name("public_spectral_files.toml").read_text(encoding="utf-8")
)["file"]
OF_NM = {
    "nm": lambda nm: nm,
    "um": lambda nm: nm / 1000,
    "angstrom": lambda nm: 10 * nm,
    "eV": lambda nm: 1239.841984 / nm,
}
GRID_NM = (400, 1050)


@dataclass(frozen=True)
class LookAlike:
    """The text of a file as an entry describes it, with a smooth curve through ends and peak."""

    entry: dict[str, Any]

    @property
    def count(self) -> int:
        return self.entry.get("curves", len(self.entry.get("names", ["one"])))

    def cells_of(self, at_nm, values) -> str:
        at = self.entry.get("at", "%.10g") % OF_NM[self.entry["unit"]](at_nm)
        return self.entry.get("sign", " ").join([at, *map(self.number, values)])

    def number(self, value: float) -> str:
        text = "" if value != value else self.entry.get("as", "%.6g") % value
        return text.replace(".", self.entry.get("decimal", "."))

    def at_nm(self, step_nm: float) -> np.ndarray:
        first, last, _ = self.entry["nm"]
        inner = np.arange(first + step_nm, last - 0.5 * step_nm, step_nm)
        peak_nm = self.entry["peak"][1]
        apart = inner[np.abs(inner - peak_nm) > 0.25 * step_nm]
        return np.unique([first, *apart, peak_nm, last])

    def values(self, at_nm: np.ndarray, k: int) -> np.ndarray:
        """Curve ``k``; the first reaches the peak, the others stay below it."""
        first, last, _ = self.entry["nm"]
        peak, peak_nm = self.entry["peak"]
        bell = np.exp(-(((at_nm - peak_nm) / (0.2 * (last - first))) ** 2))
        shape = np.ones_like(bell) if self.entry.get("flat") else 0.02 + 0.98 * bell
        values = peak * (1 - 0.5 * k / self.count) * shape
        if "low" in self.entry:
            values[0] = self.entry["low"]
        if k and k == self.count - 1:
            values[at_nm > self.entry.get("short", last)] = np.nan
        return values

    def rows(self, step_nm: float) -> list[str]:
        at = self.at_nm(step_nm)
        table = np.stack([self.values(at, k) for k in range(self.count)], axis=1)
        spread = np.full((at.size, self.entry.get("deviations", 0)), 0.01)
        table = np.concatenate([table, spread], axis=1)
        rows = [self.cells_of(w, v) for w, v in zip(at, table, strict=True)]
        if self.entry.get("disorder"):
            for i in range(5, len(rows) - 1, 10):
                rows[i : i + 2] = rows[i + 1], rows[i]
        return rows

    def digitized(self) -> list[str]:
        """Each curve with wavelengths of its own, those of the first inside those of all others."""
        step = self.entry["nm"][2]
        columns = []
        for k in range(self.count):
            at = self.at_nm(step)
            values = self.values(at, k)
            at[[0, -1]] += [-0.1 * k * step, 0.1 * k * step]
            columns.append([self.cells_of(w, [v]) for w, v in zip(at, values, strict=True)])
        sign = self.entry["sign"]
        return [sign.join(cells) for cells in zip(*columns, strict=True)]

    def in_rows(self) -> list[str]:
        at, sign = self.at_nm(self.entry["nm"][2]), self.entry["sign"]
        heading = [self.entry["corner"], *(self.entry["at"] % w for w in at)]
        names = enumerate(self.entry["names"])
        rows = [[name, *map(self.number, self.values(at, k))] for k, name in names]
        return [sign.join(cells) for cells in [heading, *rows]]

    def long(self) -> list[str]:
        at = self.at_nm(self.entry["nm"][2])
        return [
            f"{angle},{self.cells_of(w, [v * (1 - angle / 100)])}"
            for angle in (8, 36, 60)
            for w, v in zip(at, self.values(at, 0), strict=True)
        ]

    def matrix(self) -> list[str]:
        rows = self.rows(self.entry["nm"][2])
        return [rows[i * 7 % len(rows)] for i in range(len(rows)) if len(rows) % 7]

    def rawtoaces(self) -> list[str]:
        at = self.at_nm(self.entry["nm"][2])
        rows = ", ".join(
            f'"{w:g}": [ {v:.13f} ]' for w, v in zip(at, self.values(at, 0), strict=True)
        )
        names = ", ".join(f'"{name}"' for name in self.entry["names"])
        return [
            '{ "header": { "schema_version": "1.0.0", "laboratory": null }, "spectral_data": {',
            f'"units": "relative", "index": {{ "main": [ {names} ] }},',
            f'"data": {{ "main": {{ {rows} }} }} }} }}',
        ]

    def tm27(self) -> list[str]:
        at = self.at_nm(self.entry["nm"][2])
        rows = [
            f'<SpectralData wavelength="{w:.1f}">{self.number(v)}</SpectralData>'
            for w, v in zip(at, self.values(at, 0), strict=True)
        ]
        maker, number, words = self.entry["names"][0].split(" - ")
        return [
            '<?xml version="1.0"?>',
            '<IESTM2714 xmlns="iestm2714" version="1.0"><Header>',
            f"<Manufacturer>{maker}</Manufacturer><CatalogNumber>{number}</CatalogNumber>",
            f"<Description>{words}</Description></Header><SpectralDistribution>",
            f"<SpectralQuantity>{self.entry['level']}</SpectralQuantity>",
            *rows,
            "</SpectralDistribution></IESTM2714>",
        ]

    def cgats(self) -> list[str]:
        at, names = self.at_nm(self.entry["nm"][2]), self.entry["names"]
        fields = ["SampleID", "SAMPLE_NAME", "RGB_R", *(f"nm{w:.0f}" for w in at)]
        sets = [
            [str(k + 1), name, "109.97", *map(self.number, self.values(at, k))]
            for k, name in enumerate(names)
        ]
        return [
            'LGOROWLENGTH\t10\nINSTRUMENTATION\t"an instrument"',
            f"NUMBER_OF_FIELDS\t{len(fields)}",
            "BEGIN_DATA_FORMAT",
            "\t".join(fields),
            f"END_DATA_FORMAT\nNUMBER_OF_SETS\t{len(names)}\nBEGIN_DATA",
            *("\t".join(cells) for cells in sets),
            "END_DATA",
        ]

    def text(self) -> str:
        form = self.entry.get("form", "rows of numbers")
        step = self.entry["nm"][2]
        body = {
            "rows of numbers": lambda: self.rows(step),
            "units in cells": lambda: [
                *(self.rows(self.entry["again"]) if "again" in self.entry else []),
                *self.rows(step),
            ],
            "digitized": self.digitized,
            "rows": self.in_rows,
            "long": self.long,
            "matrix": self.matrix,
            "line": lambda: [",".join(map(self.number, self.values(self.at_nm(step), 0)))],
            "rawtoaces": self.rawtoaces,
            "tm27": self.tm27,
            "cgats": self.cgats,
            "verbatim": list,
        }[form]()
        return self.entry.get("head", "") + "\n".join(body) + "\n" + self.entry.get("tail", "")


def _id(entry):
    return f"{entry['repository'].rpartition('/')[2]}:{entry['path'].rpartition('/')[2]}"


def _written(entry, folder) -> Path:
    path = folder / Path(entry["path"]).name
    path.write_text(LookAlike(entry).text(), encoding="utf-8", newline=entry.get("ends", "\n"))
    return path


def _assert_ends_and_peak(result, entry):
    first, last, _ = entry["nm"]
    last = entry.get("short", last)
    peak, peak_nm = entry["peak"]
    at = result.curves.wavelength_nm
    assert [at[0], at[-1]] == pytest.approx([first, last], rel=1e-5)
    highest = result.curves.values[:, 0]
    assert highest.max() == pytest.approx(peak * result.factor, rel=1e-4)
    assert highest[np.abs(at - peak_nm).argmin()] == highest.max()


def _assert_refused(path, **fields) -> None:
    with refused_input(subject=str(path), **fields):
        read_curves(path)


READ = [f for f in FILES if "refused" not in f and f.get("asks") != ["wavelength_unit"]]
ASKED = [f for f in FILES if f.get("asks") == ["wavelength_unit"]]
REFUSED = [f for f in FILES if "refused" in f]


def _cases(entries):
    return [
        pytest.param(
            entry,
            id=_id(entry),
            marks=pytest.mark.skipif("later" in entry, reason=str(entry.get("later"))),
        )
        for entry in entries
    ]


@pytest.mark.parametrize("entry", _cases(READ))
def test_a_public_file_is_read_as_declared_and_the_rest_is_asked(tmp_path, entry):
    result = read_curves(_written(entry, tmp_path))
    assert result.wavelength_unit == entry["unit"]
    _assert_ends_and_peak(result, entry)
    assert len(result.curves.names) == LookAlike(entry).count
    if "names" in entry:
        assert list(result.curves.names) == entry["names"]
    declares = [entry.get(key) for key in ("quantity", "level", "per")]
    assert [result.quantity, result.level, result.per] == declares
    assert result.factor == (0.01 if entry.get("scale") == "percent" else 1.0)
    assert result.scale == entry.get("scale", result.scale)
    assert (result.deviations is not None) == ("deviations" in entry)
    guessed = any(f"are taken as {entry['unit']}" in note for note in result.notes)
    assert guessed == (not entry.get("declared", True))
    first, last = result.curves.wavelength_nm[[0, -1]]
    short = ["beyond"] if first > GRID_NM[0] or last < GRID_NM[1] else []
    assert sorted(q.about for q in result.questions) == sorted([*entry.get("asks", []), *short])


@pytest.mark.parametrize("entry", _cases(ASKED))
def test_a_public_file_without_a_unit_asks_for_it_and_is_read_right_with_it(tmp_path, entry):
    path = _written(entry, tmp_path)
    _assert_refused(path, setting="wavelength_unit")
    if entry["unit"] != "eV" and entry.get("form") != "matrix":
        result = read_curves(path, answers=Answers(wavelength_unit=entry["unit"]))
        _assert_ends_and_peak(result, entry)


@pytest.mark.parametrize("entry", _cases(REFUSED))
def test_a_public_file_that_is_not_a_table_of_curves_is_refused_in_one_sentence(tmp_path, entry):
    _assert_refused(_written(entry, tmp_path), **entry["refused"])


def test_the_list_holds_a_hundred_files_of_twenty_five_repositories_once_each():
    names = [(f["repository"], f["path"]) for f in FILES]
    assert len(set(names)) == len(names) >= 100
    assert len({repository for repository, _ in names}) >= 25


SHARED = next(
    (
        parent / "shared/data"
        for parent in Path(__file__).parents[2:4]
        if (parent / "shared/data").is_dir()
    ),
    None,
)
# Facts of the README beside these files: first and last wavelength [nm], and the number of curves.
REAL = {
    "sensors/MT9V024_RGBW.mat": (380, 1080, 4), "sensors/MT9V024_RGB.mat": (380, 1080, 3),
    "sensors/MT9V024_Mono.mat": (380, 1080, 1), "sensors/ar0132atRGB.mat": (380, 1000, 3),
    "sensors/ar0132atRGBW.mat": (380, 1000, 4), "sensors/AptinaMT9M131.mat": (400, 1000, 3),
    "sensors/IMX249_BFLY-U3-23S6C.csv": (370, 750, 3),
    "irfilters/ircf_public.mat": (350, 1200, 1),
    "irfilters/irFilter_schott.mat": (380, 1068, 1),
    "reflectances/macbethChart.mat": (380, 1068, 24),
    "reflectances/esserChart.mat": (380, 1068, 113), "illuminants/ASTMG173.csv": (280, 4000, 3),
    "reflectances/AstroGreenBaseball.txt": (350, 2500, 1),
    "reflectances/AstroRedBaseball.txt": (350, 2500, 1),
    "reflectances/BeckmanLawn.txt": (350, 2500, 1),
    "reflectances/DarkTarget_Trial1.txt": (350, 2500, 1),
    "reflectances/Horse_Trial2.txt": (350, 2500, 2),  # no heading says that one is a deviation
    "illuminants/ill_A.mat": (380, 1068, 1), "illuminants/ill_CWF.mat": (380, 1068, 1),
    "illuminants/ill_DAY.mat": (380, 1068, 1), "illuminants/ill_U30.mat": (380, 1068, 1),
}  # fmt: skip


@pytest.mark.skipif(SHARED is None, reason="needs the real files of shared/data")
@pytest.mark.parametrize("name", REAL)
def test_a_real_file_has_the_range_and_the_curves_that_its_readme_states(name):
    assert SHARED is not None
    first, last, curves = REAL[name]
    result = read_curves(SHARED / name)
    assert result.curves.wavelength_nm[[0, -1]].tolist() == [first, last]
    assert (result.wavelength_unit, len(result.curves.names)) == ("nm", curves)
