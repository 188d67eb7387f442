"""Refusals of the command line: fields, the options that they name, and no file that changes."""

import os
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import command_lines
from outcomes import refused

CURVES = "wavelength_nm,R,G\n" + "".join(
    f"{w},{0.5 if w > 580 else 0.05},{0.4 if 490 < w < 590 else 0.1}\n"
    for w in range(400, 1051, 10)
)
FILES = {
    "over.csv": CURVES.replace("500,0.05,0.4", "500,0.05,40"),
    "percent.csv": re.sub(r",0\.", ",1.", CURVES).replace("500,1.05,1.4", "500,1.05,400"),
    "negative.csv": CURVES.replace("450,0.05,0.1", "450,-0.05,0.1"),
    "nan.csv": CURVES.replace("420,0.05,0.1", "420,nan,0.1"),
    "short.csv": CURVES[: CURVES.index("710,")],
    "um.csv": "wavelength_nm,R\n0.4,0.1\n0.7,0.5\n1.05,0.1\n",
    "two.csv": "wavelength_nm,A,B\n400,0.1,0.2\n500,0.2,0.2\n",
    "faint.csv": "wavelength_nm,R,G\n400,1e-300,1e-12\n1050,1e-300,1e-12\n",
    "one.csv": command_lines.input_files()["filter.csv"].decode(),
    "old.json": '{"schema": "chromanoise sensor", "schema_version": 9}',
    "list.json": "[1, 2]",
    "taken": "mine",
    "study.toml": '[[sensors]]\nname = "onyx-rgb"\n',
    "no-profile.txt": '{"noiseprofiles": []}',
    "no-pixel.txt": "quantum efficiency = 60 %",
    "nonsense.txt": "nonsense",
    "no-number.txt": "mean_dn,variance_dn2\n1,x",
}


@pytest.fixture(autouse=True)
def inputs(here):
    """The files above, a cube with a pixel that is not a number, and links in a loop."""
    for name, text in FILES.items():
        Path(name).write_text(text)
    Path("binary.csv").write_bytes(bytes(range(256)))
    reflectance = np.full((4, 4, 14), 0.5)
    reflectance[2, 1, 3] = np.nan
    np.savez("cube.npz", wavelength_nm=np.linspace(400, 1050, 14), reflectance=reflectance)
    np.save("cube.npy", np.full((3, 4, 5), 0.5))
    Path("made/summary.json").mkdir(parents=True)
    Path("folder.svg").mkdir()
    Path("two.svg").write_text(FILES["two.csv"])
    for name in ("loop", "loop.csv"):
        Path(name).symlink_to(name)
    os.mkfifo("queue")


def state():
    """All files of the working folder, with the content of the regular ones."""
    return {path: path.is_file() and path.read_bytes() for path in Path().rglob("*")}


class Case(NamedTuple):
    """Words of a command line, parts of its sentence, fields of its error."""

    words: list[str]
    parts: tuple[str, ...]
    fields: dict


def case(words, *parts, **fields):
    one = words.split() if isinstance(words, str) else words
    return pytest.param(Case(one, parts, fields), id=ascii(" ".join(one))[1:60])


SENSOR = {"setting": "sensors.0.name"}
LIGHT = {"setting": "light.illuminant"}
FILTER = {"setting": "sensors.0.filter"}
SIMULATE = "simulate builtin:checker --sensor onyx-rgb"
CASES = [
    # names
    case("analyze onyx-rbgw", "onyx-rbgw", "onyx-rgbw", **SENSOR),
    case("analyze onyx", "'onyx'", "onyx-rgb", "file", **SENSOR),
    case("analyze nothing.dat", "nothing.dat", "catalog", **SENSOR),
    case("analyze onyx-rgbw --illuminant D66", "D66", "D65", **LIGHT),
    case("analyze onyx-rgbw --illuminant lamp.dat", "lamp.dat", "catalog", **LIGHT),
    case("analyze onyx-rgbw --illuminant a/lamp", "a/lamp", "catalog", **LIGHT),
    case("analyze onyx-rgbw --illuminant lmp", "'lmp'", "file", **LIGHT),
    case("analyze onyx-rgbw --illuminant 3200", "--illuminant", "3200K", value="3200"),
    case("analyze onyx-rgbw --illuminant LED99", subject="peak of illuminant LED99", value=99.0),
    case("analyze model-mono --illuminant LED550/2", subject="width_nm", **LIGHT),
    case(
        "analyze model-mono --illuminant LED850",
        subject="illuminant 850 nm LED, 20 nm wide",
        **LIGHT,
    ),
    case("analyze model-mono --illuminant D65", "780 nm", "--illuminant-beyond", **LIGHT),
    case("analyze onyx-rgbw --filter glass.sed", "glass.sed", "catalog", **FILTER),
    case("analyze onyx-rgbw --filter glss", "'glss'", "file", **FILTER),
    *(
        case(f"analyze onyx-rgbw --illuminant {word}", word, value=0.0, **LIGHT)
        for word in ("0K", "LED0", "LED500/0")
    ),
    case("analyze mt9m131", "1000 nm", "--beyond", **SENSOR),
    case("analyze ar0132at-rgbw", "--peak-qe", **SENSOR),
    case("analyze nikon-d5100-npl", "--energy", "--photons", **SENSOR),
    case("analyze onyx-rgbw --pairs none.csv", "none.csv"),
    case("catalog mt9v024", "mt9v024-rgbw", value="mt9v024"),
    case("catalog sensors --folder nowhere", "nowhere"),
    case("analyse onyx-rgbw", "analyze"),
    case("inspect onyx-rgbw", "catalog onyx-rgbw", subject="onyx-rgbw"),
    case("inspect onyx-none", subject="onyx-none"),
    case(
        "simulate builtin:chequer --sensor onyx-rgbw",
        "builtin:checker",
        setting="pictures.0.cube",
        value="builtin:chequer",
    ),
    # files of curves
    case("analyze over.csv", "over.csv", "G", "500 nm", "40", "correct it", **SENSOR),
    case("analyze percent.csv", "percent.csv", "R", "--percent", **SENSOR),
    case("analyze negative.csv", "negative.csv", "R", "450 nm", "-0.05", **SENSOR),
    case("analyze nan.csv", "nan.csv", "line 4", "R", "nan", **SENSOR),
    case("analyze short.csv", "short.csv", "700 nm", "--beyond", "zero", "hold", **SENSOR),
    case("analyze um.csv --beyond zero", "um.csv", "--wavelength-unit um", **SENSOR),
    case("analyze nowhere.csv", "nowhere.csv", **SENSOR),
    case("analyze binary.csv", "binary.csv", "UTF-8"),
    case(
        "analyze faint.csv --matrix lmmse --lux 0.01 --time-ms 81125.6 --f-number 54734.5 "
        "--pitch-um 0.0132912",
        *("faint", "R"),
    ),
    *(
        case(words, "queue", "pipe", **key)
        for words, key in (
            ("analyze queue", SENSOR),
            ("analyze onyx-rgb --filter queue", FILTER),
            ("analyze onyx-rgb --illuminant queue", LIGHT),
        )
    ),
    *(
        case(f"{words} loop{end}", "loop")
        for words, end in (
            *(("denoise", ""), ("characterize", ""), ("analyze", ""), ("inspect", "")),
            *(("run", ""), ("optimize", ""), ("init", ""), ("convert onyx-rgb", ".csv")),
            *(("analyze onyx-rgbw --json", ""), ("analyze onyx-rgb --json", ".csv")),
            *(("analyze onyx-rgb --table", ".csv"), ("matrix onyx-rgb --export", ".csv")),
            *(("run study.toml -o", ".csv"), ("analyze", ".csv"), ("denoise -o o", "")),
            *(("demo-frames --shape 12x16 -o", ""), ("rerun -o o", "")),
        )
    ),
    case("convert loop a.csv", "loop"),
    case("simulate loop --sensor onyx-rgbw", "loop"),
    # files of pixels
    case("analyze onyx-rgbw --pixel no-profile.txt", "no-profile.txt", "darktable"),
    case(
        "analyze onyx-rgbw --pixel no-pixel.txt",
        *("no-pixel.txt", "pitch", "full well", "read noise"),
    ),
    case("analyze onyx-rgbw --pixel nonsense.txt", "nonsense.txt", "EMVA 1288"),
    case("analyze onyx-rgbw --pixel no-number.txt", "no-number.txt", "line 2", "'x'"),
    # cubes
    case(
        "simulate cube.npz --sensor onyx-rgbw -o new",
        *("cube.npz", "nan", "row 2", "column 1", "550 nm", "--bad-pixels"),
    ),
    case(
        "simulate builtin:checker --sensor model-mono --scale 3",
        *("--scale", "builtin:checker"),
        setting="pictures.0.scale",
        value=3.0,
    ),
    *(
        case(
            f"simulate cube.npy --sensor model-rgb --wavelengths {word}",
            subject="--wavelengths",
            value=word,
        )
        for word in ("400", "none.txt", "400:x", "nan")
    ),
    # numbers; test_bounds.py has the bounds of each
    case("analyze onyx-rgbw --lux abc", subject="--lux", value="abc", remedy=()),
    case("analyze onyx-rgbw --bits 1.5", subject="--bits", value="1.5", remedy=()),
    case("analyze onyx-rgbw --iso a,b", subject="--iso", value="a,b", remedy=()),
    *(
        case(f"{SIMULATE} --threads {threads}", "threads", str(int(float(threads))))
        for threads in ("1e20", "0", "-1", "1025")
    ),
    *(case(f"reproduce --draws {draws}", "draws") for draws in ("1e11", "1", "1.5", "inf", "x")),
    # words
    case(
        "analyze onyx-rgbw --equal exposur",
        subject="--equal",
        value="exposur",
        remedy=("did you mean exposure?",),
    ),
    case(
        "analyze onyx-rgbw --luxx 3",
        subject="--luxx",
        value=None,
        remedy=("did you mean --lux or --luma?",),
    ),
    *(
        case(words, words[-2] if words[-1] == "" else words[-1].rstrip("="), "empty")
        for words in (
            *(["analyze", "onyx-rgb", "--json", ""], ["analyze", "onyx-rgb", "--json="]),
            *(["analyze", "onyx-rgb", "--filter", ""], ["analyze", "onyx-rgb", "--illuminant", ""]),
            *([*SIMULATE.split(), "--scheduler", ""], [*SIMULATE.split(), "-o", ""]),
            *(["analyze", ""], ["run", ""]),
        )
    ),
    *(
        case(["analyze", word], ascii(word), value=word)
        for word in ("\udcff.csv", "a\0.csv", "a\n.csv", "a\u2028.csv", "\x1b[2J")
    ),
    case("analyze onyx-rgbw model-rgb --label A", "--label", "2", subject="labels", value=1),
    # what changes nothing, or excludes each other
    case("analyze onyx-rgbw --beyond zero", subject="beyond", value="zero"),
    case("analyze onyx-rgbw --negatives zero", subject="negatives", value="zero"),
    case("analyze onyx-rgbw --white-balance gray", subject="white_balance", value="gray"),
    case("analyze onyx-rgbw --tone srgb", subject="tone", value="srgb"),
    case("analyze onyx-rgbw --clip --budget", "--clip", setting="outputs.clip", value=True),
    case(
        "analyze onyx-rgbw --time-ms 3 --saturate 0.5",
        *("omit --time-ms", "omit --saturate"),
        subject="time_ms",
        setting="exposure.time_ms",
        value=3.0,
        remedy_setting="exposure.saturate",
    ),
    case(
        "compare model-rgb-ircut --equal light --time-ms 5",
        "--equal",
        setting="exposure.equal",
        value="light",
    ),
    case(
        "analyze onyx-rgbw --binning-mode digital",
        *("--binning,", "omit --binning-mode"),
        subject="binning_mode",
        remedy_setting="sensors.0.pixel.binning_mode",
    ),
    case(
        "analyze onyx-rgbw --channel-filter Q=ircut-650",
        "--channel-filter",
        subject="channel_filters",
        where="channel",
        value="Q",
    ),
    case(
        "simulate builtin:checker --sensor onyx-rgbw --mosaic bayer",
        "--mosaic rgbw-2x2",
        subject="channel 'W'",
        remedy_setting="pictures.0.mosaic",
    ),
    # matrices
    case(
        "analyze onyx-rgbw --matrix ridge=-1",
        "--matrix",
        subject="matrix",
        where="strength of a ridge matrix",
        value=-1.0,
    ),
    case("analyze onyx-rgbw --matrix a/folder", "--matrix", ".clf", value="a/folder"),
    # sweeps
    case("compare model-mono --sweep lux=1", "--sweep", subject="--sweep", value="lux=1"),
    case("compare model-mono --sweep lux=10:1", "lux", "10", "1", setting="sweeps.0.vary"),
    case("compare model-mono --sweep lux=0:1", "lux", setting="sweeps.0.vary", value=0.0),
    case("compare model-mono --sweep kelvin=10:99", "kelvin", setting="sweeps.0.vary", value=10.0),
    case(
        "compare model-mono --sweep time=1:2",
        *("--sweep", "time-ms"),
        setting="sweeps.0.vary",
        value="time",
    ),
    case(
        "compare model-mono --matrix kernl",
        *("--matrix", "kernel"),
        setting="matrices.0",
        value="kernl",
    ),
    case(
        "compare onyx-rgbw --sweep lux=1:2 --and lux=1:2",
        *("--sweep", "omit --and"),
        value="lux",
        remedy_setting="sweeps.0.second.vary",
    ),
    case("compare onyx-rgbw --and prnu", "--and"),
    case("compare onyx-rgbw --and prnu=0:0.1:x", "--and"),
    case("compare onyx-rgbw --and prnu=0.1:0", "prnu"),
    case("compare onyx-rgbw --and nosuch=1:2", "--and"),
    case(
        "compare onyx-rgbw --sweep lux=2:1",
        "--sweep",
        subject="vary",
        where="sweep of lux",
        value=(2.0, 1.0),
    ),
    # outputs
    case(
        "analyze onyx-rgbw --json z.json --table ./z.json",
        "--json",
        subject="--table",
        value="./z.json",
    ),
    case("catalog --json - --markdown -", subject="--markdown", value="-"),
    case(f"{SIMULATE} -o taken", "taken"),
    case(f"{SIMULATE} -o made", "summary.json"),
    case("reproduce --json tables.json --out taken/deep", "taken/deep"),
    *(
        case(f"{command} onyx-rgbw --table a.csv --json taken/x.json", subject="taken")
        for command in ("analyze", "compare", "matrix")
    ),
    *(
        case(f"{command} nothing --table t.pdf", "t.pdf", ".csv, .json, .md, .tex")
        for command in ("analyze", "compare", "matrix")
    ),
    *(
        case(f"{command} two.csv --table two.csv", subject="--table", value="two.csv")
        for command in ("analyze", "compare", "matrix")
    ),
    case("card onyx-rgb -o c.gif", ".pdf, .svg, .png or .html", subject="--out", value="c.gif"),
    case("card onyx-rgb -o taken/c.pdf", "taken", subject="taken"),
    case("card onyx-rgb -o folder.svg", "folder.svg", subject="--out", value="folder.svg"),
    case("card two.svg -o two.svg", subject="--out", value="two.svg"),
    case("card -o c.pdf", "SENSOR"),
    case("card onyx-rgb", "--out"),
    case("card onyx-rgb --paper a3 -o c.pdf", subject="--paper", value="a3"),
    case("card onyx-rgb --lux -1 -o c.pdf", "--lux", setting="light.level_lux"),
    case(
        "card onyx-rgb onyx-rgbw onyx-rgb-ircut onyx-rgbw-ircut model-rgb model-mono -o c.pdf",
        "SENSOR must be at most 5",
        value=6,
    ),
    case("matrix onyx-rgbw --export m.xyz", ".clf", subject="--export", value="m.xyz"),
    # conditions and comparisons of outputs
    case(
        ["analyze", "onyx-rgb", "--fail-if", "snr_y_dbb < 30"],
        "did you mean snr_y_db",
        subject="--fail-if",
        value="snr_y_dbb",
    ),
    case(["analyze", "nothing", "--fail-if", "snr_q < 1"], subject="--fail-if", value="snr_q"),
    case(["matrix", "onyx-rgb", "--fail-if", "color.snr_db.Q < 1"], subject="--fail-if"),
    case(
        ["analyze", "onyx-rgb", "--fail-if", "color.snr_db.Q < 1", "--json", "a"], "color.snr_db.Q"
    ),
    case(["analyze", "onyx-rgb", "--fail-if", "rank > 1"], "sensors.rank or ranking.rank"),
    case(["analyze", "onyx-rgb", "--fail-if", "metric == 1"], "is text", value="metric"),
    case(["run", "study.toml", "-o", "new", "--fail-if", "snr_q < 1"], value="snr_q"),
    case(["compare", "onyx-rgb", "--fail-if", "sensor"], subject="--fail-if", value="sensor"),
    case(["analyze", "onyx-rgb", "--fail-if", "condition < nan"], value="condition < nan"),
    case("diff old.json nowhere", "nowhere"),
    case("diff old.json made", "made", "study.json"),
    case("diff old.json nonsense.txt", "nonsense.txt", "JSON"),
    case("diff list.json old.json", "list.json", "no results"),
    case("schema anlyze", "analyze", value="anlyze"),
    # convert
    case("convert two.csv two.csv", "OUT", "'two.csv'"),
    case("convert two.csv ./two.csv", "OUT", "'two.csv'"),
    case("convert two.csv x.xlsx", ".csv, .json, .spdx"),
    case("convert two.csv x.csv --as rawtoaces", "--as rawtoaces", ".json"),
    case("convert two.csv x.json --as rawtoaces", "two.csv", "--energy", "--photons"),
    case("convert two.csv x.spdx", "two.csv", "A, B", "--column"),
    case("convert two.csv x.spdx --column C", "'C'"),
    case("convert two.csv x.spdx --column A --created soon", "--created", "2026-01-31"),
    case("convert nowhere.csv x.json", "nowhere.csv"),
    case("convert nowhere.json x.csv", "nowhere.json"),
    case("convert onyx x.json", "onyx-rgb"),
    case("convert onyx-rgbw x.json --column R", "--column"),
    case("convert old.json x.csv", "old.json", "schema_version", "9"),
    case("convert ar0132at-rgbw x.csv", "ar0132at-rgbw", "--peak-qe"),
    case("convert onyx-rgbw x.csv --peak-qe 0.3", "--peak-qe", "onyx-rgbw"),
    case("convert onyx-rgbw x.csv --quantity QE", "--quantity", "onyx-rgbw"),
]


@pytest.mark.parametrize("one", CASES)
def test_a_command_is_refused_in_fields_and_leaves_all_files_as_they_are(run, one):
    before = state()
    refused(run(*one.words), *one.parts, **one.fields)
    assert state() == before
