"""Write the pinned command lines: exit code, output and written files of each, and all help texts.

    python tools/pin_commands.py                       writes tests/pinned/commands.json.gz
    python tools/pin_commands.py --check               compares with it and prints what differs
    python tools/pin_commands.py --check --help-texts  compares the options and the help texts
    python tools/pin_commands.py --renew-help-texts    writes new help texts beside the old outputs

Text is compared exactly, except that numbers may differ by 1e-9 (relative), and that versions,
hashes, times, the processor and the scratch folder are masked. Lines of one row of the table run
one after the other in the same folder.
"""

import argparse
import base64
import contextlib
import difflib
import gzip
import hashlib
import io
import json
import os
import re
import shlex
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from unittest.mock import patch

import click

from chromanoise.base.version import __version__
from chromanoise.cli.entry import COMMANDS, commands, run
from pin_studies import FOLDER

RECORD = FOLDER / "commands.json.gz"
TOLERANCE = 1e-9
LONGEST = 60_000
"""Characters of a text above which only its digest and some of its numbers are stored."""
NUMBERS = 200
LINES = """
analyze onyx-rgbw
analyze onyx-rgbw onyx-rgb-ircut --json -
analyze onyx-rgbw --json a.json --table a.csv
analyze onyx-rgb-ircut --illuminant A --lux 3 --time-ms 20 --f-number 2.8 --table a.md
analyze onyx-rgb-ircut --illuminant files/lamp.csv --illuminant-column power_w_m2_nm --illuminant-energy --illuminant-wavelength-unit nm --illuminant-beyond zero
analyze onyx-rgbw --saturate 0.5 --magnification 0.1 --metric quanta --observer cie-2015-10
analyze onyx-rgbw onyx-rgb --equal saturation --label first --label second --table a.tex
analyze onyx-rgbw onyx-rgb --equal light --space lab --json -
analyze onyx-rgb --filter ircut-650 --shift-ircut-nm 10 --shift-nm -5 --budget --json -
analyze onyx-rgb --filter files/filter.csv --filter-wavelength-unit nm --beyond hold --space luv
analyze onyx-rgb --ircut-nm 680 --channel-filter R=ircut-650 --channel-filter G=files/filter.csv --beyond zero
analyze onyx-rgb-ircut --pixel files/pixel.toml --read-noise-e 3 --bits 12 --clip --json -
analyze onyx-rgb-ircut --pitch-um 2.4 --full-well-e 6000 --read-noise-e 1.5 --prnu 0.01 --dsnu-e 1 --row-noise-e 0.7 --column-noise-e 0.5 --budget --json -
analyze onyx-rgb-ircut --dark-current-e-per-s 40 --temperature-c 60 --dark-reference-c 25 --dark-doubling-k 6 --time-ms 15 --budget
analyze onyx-rgb-ircut --reset-capacitance-ff 0.5 --rtn-share 0.02 --rtn-amplitude-e 20 --black-error-e 2 --gain-dn-per-e 0.4 --bits 10 --json -
analyze onyx-rgbw --binning 4 --binning-mode digital --json -
analyze onyx-rgb-ircut --crosstalk 0.1 --mosaic bayer --crosstalk-stage charge --budget
analyze onyx-rgb-ircut --crosstalk files/crosstalk.csv --mosaic R/G/B --json -
analyze onyx-rgb-ircut --crosstalk files/crosstalk.csv
analyze onyx-rgb-ircut --crosstalk files/kernel.csv --mosaic RG/GB
analyze files/camera.csv --fraction --absolute --photons --wavelength-unit nm --json -
analyze files/percent.csv --percent --relative --peak-qe 0.5 --energy --negatives zero
analyze mt9v024-rgbw --chart --merit
analyze mt9v024-rgbw --beyond zero
analyze onyx-rgb-ircut --chart --merit --chart-file files/reflectances.csv --reflectance-scale fraction --reflectance-wavelength-unit nm --reflectance-beyond hold --json -
analyze onyx-rgb-ircut --patch 0.18 --matrix lmmse --prior smooth-50 --json -
analyze onyx-rgb-ircut --patch red --matrix ridge=0.01 --prior files/reflectances.csv --reflectance-beyond hold
analyze onyx-rgbw --reader machine --pairs files/pairs.csv --json -
analyze onyx-rgbw onyx-rgb-ircut --reader machine
analyze onyx-rgb-ircut --matrix noise-regularized=0.5 --space srgb --json -
analyze onyx-rgb-ircut --pipeline --white-balance gray --white-balance-pixels 400 --tone rec709 --luma bt601 --saturation 1.2 --exposure-gain 1.1 --json -
analyze onyx-rgb-ircut --pipeline --exposure-gain 2
analyze onyx-rgb-ircut --pipeline --iso 100,400 --base-iso 50 --iso-read-noise-e 3,2
analyze onyx-rgb-ircut --lux 5 --prnu 0.01 --crosstalk 0.05 --mosaic bayer --copy-as python
analyze onyx-rgb-ircut --lux 5 --prnu 0.01 --channel-filter R=ircut-650 --copy-as toml
compare onyx-rgbw onyx-rgb-ircut
compare onyx-rgbw onyx-rgb-ircut --sweep lux=0.1:100 --points 7 --json - --table c.csv
compare onyx-rgbw onyx-rgb-ircut --sweep read-noise-e=1:20 --points 5 --quantity delta-e --json -
compare onyx-rgbw --sweep read-noise-e=0:20
compare onyx-rgbw onyx-rgb-ircut --sweep temperature-c=0:60 --dark-current-e-per-s 30 --points 4 --quantity total-error --matrix kernel,lmmse
compare onyx-rgbw onyx-rgb-ircut --sweep lux=1:100 --and prnu=0:0.02:3 --points 4 --json -
compare onyx-rgbw onyx-rgb-ircut --sweep lux=1:100 --points 4 --quantity separation --pairs files/pairs.csv --json -
compare onyx-rgbw onyx-rgb-ircut --sweep kelvin=2500:7000 --points 3 --matrix lmmse --prior all --json -
compare onyx-rgbw --sweep ircut-nm=600:750 --points 3 --copy-as toml
compare onyx-rgbw --sweep infrared=0:1 --points 3 --copy-as python
matrix onyx-rgb-ircut
matrix onyx-rgb-ircut --matrix lmmse --prior chart --lux 3 --json - --table m.csv
matrix onyx-rgbw --matrix bounded-psi=6.5 --export m.csv --json -
matrix onyx-rgb-ircut --matrix white-preserving --export m.json
matrix onyx-rgb-ircut --matrix least-squares --export m.clf
matrix onyx-rgb-ircut --matrix ridge=0.1 --export m.dcp.json
matrix onyx-rgb-ircut --pareto 0.1:10:3 --json -
matrix onyx-rgb-ircut --export m.csv && analyze onyx-rgb-ircut --matrix m.csv --json -
matrix onyx-rgb-ircut --copy-as python
sensitivity onyx-rgb-ircut --objectives snr_y_db,delta_e,vora --json -
sensitivity onyx-rgb-ircut --objectives snr_y_db,delta_e --loss snr_y_db=0.1 --tolerance-nm 5 --tolerance-percent 1 --draws 50 --seed 3 --keep-matrix --table s.csv
inspect files/camera.csv --json -
inspect files/percent.csv
inspect files/lamps.csv --quantity power --column first --wavelength-unit um --energy
inspect files/bare.csv --quantity reflectance --fraction --wavelength-unit um --json i.json
inspect files/lamp.csv --beyond zero --quantity power --json -
inspect files/pixel.toml
inspect files/cube.npy
convert files/camera.csv c.csv --fraction --absolute --photons
convert onyx-rgb-ircut c.json && inspect c.json
convert onyx-rgb-ircut c.json --as rawtoaces --created 2026-01-31
convert files/lamp.csv c.spdx --quantity power --energy --created 2026-01-31
convert files/percent.csv c.csv --percent --relative --peak-qe 0.5 --energy --column C --column M
catalog
catalog sensors
catalog illuminants --json -
catalog onyx-rgbw
catalog E --json -
catalog sensors --markdown -
catalog --folder files
catalog --folder mine
cite
cite --bibtex
study
study --schema
schema matrix
schema analyse
analyze onyx-rgbw onyx-rgb --fail-if "snr_y_db < 27" --fail-if "channels.snr_db < 38"
matrix onyx-rgb --fail-if "snr_y_db < 31" --json -
compare onyx-rgb --points 3 --fail-if "snr_q < 1"
run files/study.toml -o out && run files/study.toml -o other --set light.level_lux=3 && diff out other
init new.toml && run new.toml -o out && rerun out/study.json -o again
init --design
init && report study.toml -o r.html --set light.level_lux=3 --set seed=5
run files/study.toml -o out && rerun out/study.json -o again
run files/study.toml -o out --set light.level_lux=3 --set sensors.0.name=onyx-rgb --threads 1
report files/study.toml -o r.html
optimize files/design.toml -o o --budget 16 --seed 2 --json -
simulate builtin:checker --sensor onyx-rgb-ircut -o o
simulate builtin:checker --sensor onyx-rgbw --mosaic rgbw-2x2 --demosaic gradient --format raw,xyz --bits 10 --black-level 64 --frames 2 --seed 7 -o o
simulate builtin:checker --sensor onyx-rgb-ircut --mosaic bayer --raw-only --format raw,dng --prnu 0.02 --threads 1 --tile 16 -o o
simulate builtin:checker --sensor onyx-rgb-ircut --clip --format xyz -o o
simulate builtin:checker --sensor onyx-rgb-ircut --mosaic bayer --clip -o o
simulate builtin:checker --sensor onyx-rgb-ircut --mosaic bayer --demosaic malvar --denoise guided --format png,srgb16 -o o
simulate files/cube.npy --sensor onyx-rgb-ircut --wavelengths 400:1050 --scale 0.0004 --beyond hold --bad-pixels zero --format xyz -o o
simulate builtin:checker --sensor onyx-rgb-ircut --mosaic bayer --raw-only --copy-as toml
simulate builtin:checker --sensor onyx-rgb-ircut --mosaic bayer --raw-only --format dng -o o && denoise o/onyx-rgb-ircut.dng --denoise guided -o d
demo-frames -o f --shape 24x32 --levels 9 --mosaic RG/GB --bits 12 --seed 3 --gain-dn-per-e 0.1 --black-level 40 --hot-pixels 3 --read-noise-e 3 --row-noise-e 1 && characterize f -o c --json -
demo-frames -o f --shape 24x32 --levels 4 --format pgm --dark-current-e-per-s 20 --dsnu-e 2 --prnu 0.02 --column-noise-e 1 --hot-pixel-e-per-s 300 --qe 0.6 --full-well-e 9000 --bend 0.05 --drift 0.001 --shading 0.1 --neighbor-correlation 0.1 && characterize f/capture.toml -o c --resume kept.json
denoise-bench builtin:checker --sensor onyx-rgb-ircut:bayer --levels 3 --denoise lmmse --demosaic bilinear --crop 24 --seed 1 -o bench --json -
reproduce --draws 200 --seed 1 --metric energy --json -
reproduce --draws 100 --clip
reproduce --draws 50 -o figures
demo -o demo
report files/study.toml -o r.html --figures figures
analyze
analyze onyx-rgbx
analyze onyx-rgbw --lux -1
analyze onyx-rgbw --lux nan --prnu 2 --bits 99
analyze onyx-rgbw --temperature-c 40
analyze onyx-rgbw --no-such 1
analyze onyx-rgbw --pixel missing.toml
analyze onyx-rgbw --read-noise-e many
analyze onyx-rgb --filter files/filter.csv
analyze onyx-rgbw --clip --budget
analyze onyx-rgbw --crosstalk 0.1 --mosaic nonsense
analyze onyx-rgb-ircut --rtn-share 0.1
analyze files/percent.csv
analyze onyx-rgbw --white-balance gray
analyze onyx-rgbw --iso 100
analyze onyx-rgbw --matrix ridge
analyze onyx-rgbw --saturate 0.5 --time-ms 3
analyze onyx-rgbw --table t.xls
card onyx-rgb -o card.gif
league onyx-rgbw --iso 800,6400 --sort color_error --json -
league --iso 400
league --iso 5:1
compare onyx-rgbw --sweep lux=10:1
compare onyx-rgbw --sweep luxury=1:2
compare onyx-rgbw --sweep lux=1:2 --lux 3
matrix onyx-rgbw --pareto 1
simulate builtin:none --sensor onyx-rgbw
simulate files/cube.npy --sensor onyx-rgbw
simulate builtin:checker --sensor onyx-rgbw --format gif
sensitivity onyx-rgbw --objectives none
optimize files/study.toml
run files/missing.toml
run files/study.toml --set light.level=3
run files/study.toml --set sensors.0.pixel.bits=99
rerun files/study.toml -o o
catalog nothing
convert files/lamp.csv c.xyz
characterize files
demo-frames -o f --shape 1
denoise files/cube.npy
serve --port 99999
serve missing.toml
analyse onyx-rgbw
"""  # noqa: E501
SMALL_FILES = {
    "files/study.toml": """\
title = "Two sensors"
matrices = ["kernel", "lmmse"]
[light]
level_lux = 5.0
[[sensors]]
name = "onyx-rgbw"
label = "four"
[[sensors]]
name = "onyx-rgb-ircut"
[sensors.pixel]
read_noise_e = 3.0
[[sweeps]]
vary = "lux"
first = 0.1
last = 100.0
points = 4
[outputs]
budget = true
merit = true
""",
    "mine/shed.csv": "wavelength_nm,R,G\n400,0.3,0.1\n500,0.3,0.2\n700,0.2,0.2\n1050,0,0\n",
    "mine/SOURCES.toml": """\
[shed]
kind = "sensor"
what = "a camera"
quantity = "QE"
unit = "e-/photon"
level = "absolute"
source = "a bench"
license = "CC0"
defects = "none known"
""",
    "files/design.toml": """\
[exposure]
time_ms = 5.0
[[sensors]]
name = "onyx-rgb-ircut"
[design]
objectives = ["snr_y_db", "delta_e"]
method = "nsga2"
budget = 32
population = 8
[[design.channels]]
name = "R"
filter = "gaussian"
center_nm = [580, 660]
width_nm = 40
[[design.channels]]
name = "G"
filter = "gaussian"
center_nm = 540
width_nm = [15, 80]
[[design.channels]]
name = "B"
filter = "gaussian"
center_nm = 450
width_nm = 30
[design.ir_cut]
cutoff_nm = [600, 900]
width_nm = 8
""",
}
_MASKS = [
    (re.compile(r"\b(?=[0-9a-f]*[a-f])(?=[0-9a-f]*[0-9])[0-9a-f]{12,64}\b"), "<hash>"),
    (re.compile(r"\b[0-9.]+ (ms|s|min)\b(?= (?:for|left|so far))"), "<time>"),
    (re.compile(r'(?<="seconds": )[0-9.e-]+'), "<time>"),
    (re.compile(r"\b20\d\d-\d\d-\d\dT[0-9:.+Z-]+"), "<date>"),
    (re.compile(r'(?<="cpu_features": )\[[^\]]*\]|(?<="blas_kernel": )"\w*"'), "<processor>"),
]
_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def masked(text: str, here: Path) -> str:
    """A text without what changes from run to run."""
    for folder in {str(here), str(here.resolve())}:
        text = text.replace(folder, "<here>")
    text = text.replace(__version__, "<version>")
    for pattern, name in _MASKS:
        text = pattern.sub(name, text)
    return text


def stored(text: str) -> Any:
    """A text, or the digest of its words and some of its numbers if it is long."""
    if len(text) <= LONGEST:
        return text
    numbers = _NUMBER.findall(text)
    words = _NUMBER.sub("#", text)
    return {
        "words": hashlib.sha256(words.encode()).hexdigest()[:16],
        "count": len(numbers),
        "numbers": numbers[:: max(1, len(numbers) // NUMBERS)],
    }


def html_text(text: str) -> str:
    """A page without its style and programs, and with its packed numbers in clear."""
    packed = re.findall(r'<script type="application/gzip"[^>]*>(.*?)</script>', text, re.DOTALL)
    plain = re.sub(r"<(script|style).*?</\1>", "", text, flags=re.DOTALL)
    return plain + "".join(gzip.decompress(base64.b64decode(one)).decode() for one in packed)


def content(path: Path, here: Path) -> Any:
    """What is stored of a written file; some are only named.

    These are figures, the statistics kept by ``--resume``, which depend on times of files, and the
    report of a benchmark, which has times.
    """
    data = path.read_bytes()
    if (
        path.suffix in (".pdf", ".svg", ".zip")
        or path.match("kept.json")
        or path.match("bench/*.html")
        or (path.suffix == ".png" and b"Matplotlib" in data[:400])
    ):
        return "<exists>"
    try:
        text = data.decode()
        return stored(masked(html_text(text) if path.suffix == ".html" else text, here))
    except UnicodeDecodeError:
        return hashlib.sha256(data).hexdigest()[:16]


def line_outcome(words: list[str], here: Path) -> dict[str, Any]:
    """Exit code, standard output and errors of one line."""
    out, err = io.StringIO(), io.StringIO()
    code: Any = None
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            run(words)
        except SystemExit as stop:
            code = stop.code
    return {
        "code": code,
        "out": stored(masked(out.getvalue(), here)),
        "err": masked(err.getvalue(), here),
    }


def outcome(row: str) -> dict[str, Any]:
    """The outcomes of the lines of a row, and the files that they wrote."""
    before = Path.cwd()
    with (
        tempfile.TemporaryDirectory() as scratch,
        patch.dict(os.environ, {"COLUMNS": "100", "CHROMANOISE_CATALOG": ""}),
    ):
        here = Path(scratch)
        shutil.copytree(FOLDER / "files", here / "files")
        (here / "mine").mkdir()
        for name, text in SMALL_FILES.items():
            (here / name).write_text(text)
        own = {*here.rglob("*")}
        os.chdir(here)
        try:
            lines = [line_outcome(shlex.split(line), here) for line in row.split(" && ")]
        finally:
            os.chdir(before)
        files = {
            str(one.relative_to(here)): content(one, here)
            for one in sorted(here.rglob("*"))
            if one.is_file() and one not in own and not one.name.startswith(".")
        }
    return {"lines": lines, "files": files}


def rows() -> list[str]:
    """The rows of the table."""
    return LINES.strip().split("\n")


def are_equal(old: str, new: str, tolerance: float = TOLERANCE) -> bool:
    """Whether two texts have the same words, and numbers that are equal within the tolerance."""
    if old == new:
        return True
    if _NUMBER.sub("#", old) != _NUMBER.sub("#", new):
        return False
    pairs = zip(_NUMBER.findall(old), _NUMBER.findall(new), strict=True)
    return all(_close(float(a), float(b), tolerance) for a, b in pairs)


def _close(a: float, b: float, tolerance: float) -> bool:
    return a == b or abs(a - b) <= tolerance * max(abs(a), abs(b)) + 1e-13


def text_differences(name: str, old: Any, new: Any) -> Iterator[str]:
    """What differs between two stored texts."""
    if isinstance(old, str) and isinstance(new, str):
        before, now = old.splitlines(), new.splitlines()
        if len(before) == len(now):  # close numbers are no difference
            now = [a if are_equal(a, b) else b for a, b in zip(before, now, strict=True)]
        found = list(difflib.unified_diff(before, now, lineterm="", n=0))[2:]
        yield from (f"  {name}: {line[:200]}" for line in found[:12] if not line.startswith("@@"))
        if len(found) > 12:
            yield f"  {name}: and {len(found) - 12} more lines"
    elif isinstance(old, dict) and isinstance(new, dict):
        if old["words"] != new["words"] or old["count"] != new["count"]:
            yield f"  {name}: other words ({old['count']} numbers before, {new['count']} now)"
        else:
            for a, b in zip(old["numbers"], new["numbers"], strict=True):
                if not _close(float(a), float(b), TOLERANCE):
                    yield f"  {name}: {a} became {b}"
    elif old != new:
        yield f"  {name}: {str(old)[:80]} became {str(new)[:80]}"


def differences(row: str, old: Mapping[str, Any]) -> list[str]:
    """What differs between the record of a row and its outcome now."""
    try:
        new = outcome(row)
    except Exception as error:  # whatever it is, it is a difference
        return [f"  {type(error).__name__}: {error}"]
    found: list[str] = []
    for i, (before, now) in enumerate(zip(old["lines"], new["lines"], strict=True)):
        if before["code"] != now["code"]:
            found.append(f"  exit code {i}: {before['code']} became {now['code']}")
        for stream in ("out", "err"):
            found += text_differences(f"{stream} {i}", before[stream], now[stream])
    for name in sorted({*old["files"], *new["files"]}):
        before, now = (one["files"].get(name, "<absent>") for one in (old, new))
        found += text_differences(name, before, now)
    return found


def help_of(command: str) -> dict[str, Any]:
    """The help text of a command, and the declarations of its options and arguments."""
    found = commands.get_command(click.Context(commands), command)
    assert found is not None
    with patch.dict(os.environ, {"COLUMNS": "100"}):
        text = line_outcome([command, "--help-all"], FOLDER)["out"]
    return {"text": text, "options": {str(one.name): declaration(one) for one in found.params}}


def declaration(option: click.Parameter) -> dict[str, Any]:
    """Type, default and words of an option."""
    kind = option.type
    return {
        "words": [*option.opts, *option.secondary_opts],
        "type": type(kind).__name__,
        "choices": list(map(str, kind.choices)) if isinstance(kind, click.Choice) else None,
        "default": None if callable(option.default) else repr(option.default),
        "required": option.required,
        "multiple": option.multiple,
        "nargs": option.nargs,
        "metavar": option.metavar,
        "is_flag": getattr(option, "is_flag", False),
        "help": getattr(option, "help", None),
    }


def help_differences(old: Mapping[str, Any]) -> Iterator[str]:
    """What differs between the stored and the present options and help texts."""
    for command in dict.fromkeys([*old, *COMMANDS]):
        if command not in old or command not in COMMANDS:
            yield f"{command}: {'new' if command in COMMANDS else 'missing'}"
            continue
        before, now = old[command], help_of(command)
        for name in dict.fromkeys([*before["options"], *now["options"]]):
            a, b = (one["options"].get(name) for one in (before, now))
            if a is None or b is None:
                yield f"{command} {name}: {'new' if a is None else 'missing'}"
            else:
                for key in [key for key in b if a.get(key) != b[key]]:
                    yield f"{command} {name} {key}: {a.get(key)!r} became {b[key]!r}"
        if list(before["options"]) != list(now["options"]):
            yield f"{command}: another order of the options"
        words = (" ".join(one["text"].split()) for one in (before, now))
        if before["text"] != now["text"]:
            yield f"{command}: the text differs"
            if len({*words}) == 1:
                yield "  only in its line breaks"
            else:
                lines = difflib.unified_diff(
                    before["text"].splitlines(), now["text"].splitlines(), lineterm="", n=0
                )
                yield from (f"  {line}" for line in lines if line[:2] not in ("--", "++", "@@"))


def stored_record() -> dict[str, Any]:
    """The record: ``outputs`` by row, ``help`` by command."""
    found: dict[str, Any] = json.loads(gzip.decompress(RECORD.read_bytes()))
    return found


def write_record(outputs: Mapping[str, Any], texts: Mapping[str, Any]) -> None:
    """Write the record."""
    text = json.dumps({"outputs": outputs, "help": texts}, separators=(",", ":"))
    RECORD.write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def main() -> None:
    """Write the record, or compare with it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--help-texts", action="store_true")
    parser.add_argument("--renew-help-texts", action="store_true")
    parser.add_argument("--only", default="", help="only rows that contain this text")
    parser.add_argument("--seconds", action="store_true", help="print the time of each row")
    given = parser.parse_args()
    chosen = [row for row in rows() if given.only in row]
    if given.renew_help_texts:
        write_record(stored_record()["outputs"], {name: help_of(name) for name in COMMANDS})
    elif given.check and given.help_texts:
        print(*help_differences(stored_record()["help"]), sep="\n")
    elif given.check:
        for row, old in stored_record()["outputs"].items():
            if given.only in row and (found := differences(row, old)):
                print(row, *found, sep="\n")
    else:
        outputs = stored_record()["outputs"] if given.only else {}
        for row in chosen:
            start = time.perf_counter()
            outputs[row] = outcome(row)
            if given.seconds:
                print(f"{time.perf_counter() - start:.1f} s", row, file=sys.stderr)
        write_record(
            {row: outputs[row] for row in rows() if row in outputs},
            {name: help_of(name) for name in COMMANDS},
        )


if __name__ == "__main__":
    main()
