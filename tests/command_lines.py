"""Command lines for every command and option, valid and damaged, each run in a separate process.

``python tests/command_lines.py SEED COUNT`` prints the lines that broke a rule as JSON. Everything
is imported once; each line is then run by a fork of that process, in a folder of its own, within
limits of time and memory. A line depends on the seed and its number only.
"""

import contextlib
import io
import json
import os
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
from dataclasses import asdict, dataclass, field
from importlib import import_module
from pathlib import Path

import click
import numpy as np

if __name__ == "__main__":  # run as a script, it finds its neighbors and the sources beside it
    sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "src")]

from chromanoise.apps.design import DESIGN_STARTER
from chromanoise.base.files import OWN_FILES
from chromanoise.cli.entry import COMMANDS, commands, run
from chromanoise.study import STARTER
from damage import mutated, random_edits

SECONDS = 60  # of the processor
WALL_SECONDS = 300  # a busy machine is slower
ADDRESS_SPACE_BYTES = 4 << 30
RESIDENT_KIB = 1 << 20
SERVED = "serve"  # listens until it is stopped, so only lines that it refuses are run

SENSORS = ["onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "model-mono", "model-rgbir", "cam.csv"]
LIGHTS = ["E", "A", "G173", "3200K", "LED660", "A+0.5xLED850", "lamp.csv", "halogen"]
MATRICES = [
    *("kernel", "least-squares", "white-preserving", "lmmse", "ridge=0.01"),
    *("noise-regularized=0.5", "bounded-psi=6.5"),
]
FILES = [
    *(
        "cam.csv",
        "lamp.csv",
        "filter.csv",
        "pixel.txt",
        "cube.npy",
        "study.toml",
        "design.toml",
        "mine",
    ),
    *("result.json", "missing.csv", "folder", "é.csv", "loop.csv"),
]
VALUES = {  # by the name of an option or argument; a command's own as "command.name"
    "sensors": SENSORS,
    "sensor": SENSORS,
    "illuminant": LIGHTS,
    "lux": ["10", "0.01", "1000"],
    "time_ms": ["12", "0.1"],
    "saturate": ["0.5", "1"],
    "f_number": ["1.8", "16"],
    "illuminant_column": ["power"],
    "magnification": ["0", "1"],
    "filter": ["ircut-650", "ircut-650/20", "filter.csv"],
    "ircut_nm": ["650"],
    "shift_nm": ["-5", "10"],
    "shift_ircut_nm": ["-5", "10"],
    "pixel": ["pixel.txt"],
    "pitch_um": ["2.4"],
    "full_well_e": ["8000"],
    "read_noise_e": ["2", "0"],
    "peak_qe": ["0.6"],
    "white_balance": ["gray", "illuminant", "A", "lamp.csv", "2,1,1.5", "1,1,1,1"],
    "white_balance_pixels": ["1", "100"],
    "exposure_gain": ["0.5", "2"],
    "saturation": ["0", "1.3"],
    "tone": ["srgb", "rec709", "linear", "2.2"],
    "iso": ["100", "100,400", "50"],
    "base_iso": ["50", "100"],
    "iso_read_noise_e": ["2", "2,3"],
    "method": MATRICES,
    "matrix": MATRICES,
    "matrices": [*MATRICES, "kernel,lmmse"],
    "table": ["t.csv", "t.json", "t.md", "t.tex", "folder/t.csv"],
    "json_target": ["-", "j.json"],
    "cube": ["builtin:checker", "cube.npy"],
    "mosaic": ["sensor", "bayer", "RG/GB"],
    "bits": ["8", "12", "16"],
    "black_level": ["0", "64"],
    "frames": ["1", "2"],
    "darks": ["1", "2"],
    "levels": ["2", "3"],
    "pictures": ["shots/f0a.npy"],
    "white_level": ["4095", "100"],
    "denoise": ["guided", "lmmse"],
    "denoise.mosaic": ["RG/GB", "none"],
    "denoise.denoise": ["guided", "lmmse"],
    "denoise.method": ["guided", "lmmse"],
    "denoise-bench.cubes": ["builtin:dead-leaves", "cube.npy"],
    "denoise-bench.cameras": ["onyx-rgbw", "onyx-rgb-ircut:bayer"],
    "denoise-bench.methods": ["guided", "lmmse"],
    "denoise-bench.demosaic": ["bilinear"],
    "league.iso": ["100:25600", "800", "100,400"],
    "crop": ["24", "32"],
    "processes": ["1"],
    "characterize.frames": ["shots", "shots/capture.toml"],
    "characterize.resume": ["kept.json"],
    "characterize.matrix": ["ccm.csv"],
    "demo-frames.frames": ["2", "3"],
    "demo-frames.shape": ["12x16"],
    "demo-frames.mosaic": ["RG/GB", "bayer", "rgb-ir"],
    "demo-frames.bits": ["8", "10"],
    "black_level_dn": ["64"],
    "qe": ["0.5"],
    "column_noise_e": ["1"],
    "hot_pixels": ["3"],
    "hot_pixel_e_per_s": ["100"],
    "shading": ["0.1"],
    "bend": ["0.1"],
    "drift": ["-0.001"],
    "neighbor_correlation": ["0.2"],
    "seed": ["0", "7"],
    "dark_current_e_per_s": ["0", "5"],
    "temperature_c": ["40"],
    "dark_reference_c": ["20"],
    "dark_doubling_k": ["6"],
    "dsnu_e": ["1"],
    "prnu": ["0.01"],
    "row_noise_e": ["1"],
    "reset_capacitance_ff": ["1"],
    "rtn_share": ["0.01"],
    "rtn_amplitude_e": ["20"],
    "black_error_e": ["-2", "5"],
    "gain_dn_per_e": ["0.5"],
    "crosstalk": ["0.1", "0", "mix.csv"],
    "binning": ["1", "4"],
    "labels": ["small"],
    "prior": ["chart", "chart-nir", "filter.csv"],
    "observer": ["cie-1964-10", "cie-2015-2"],
    "channel_filters": ["R=ircut-650", "G=filter.csv", "W=ircut-650", "R"],
    "chart_file": ["filter.csv", "missing.csv"],
    "pairs": ["filter.csv", "missing.csv"],
    "patch": ["0.18", "red", "lawn", "filter.csv", "2"],
    "formats": ["png", "png,xyz", "raw,dng", "exr"],
    "key": ["data"],
    "shape": ["4x5"],
    "wavelengths": ["400:1050"],
    "scale": ["1", "0.5"],
    "threads": ["1", "2"],
    "tile": ["1", "64"],
    "scheduler": ["tcp://127.0.0.1:1"],
    "out": ["o", "folder", "a/b"],
    "report.out": ["r.html"],
    "sweep": ["lux=0.1:100", "time-ms=1:20", "read-noise-e=0:10"],
    "points": ["2", "9"],
    "export": ["m.csv", "m.json", "m.clf", "m.dcp.json"],
    "weights": ["0.01:100", "0.01:100:5"],
    "study": ["study.toml"],
    "optimize.design": ["design.toml"],
    "budget": ["8", "16"],
    "init.study": ["new.toml"],
    "serve.study": ["missing.toml"],
    "front": ["missing.json", "cam.csv"],
    "changes": ["light.level_lux=3", "sensors.0.name=onyx-rgb", "seed=1"],
    "output": ["result.json"],
    "fail_if": ["snr_y_db < 30", "condition>9", "value == 1", "color.snr_db.Q<1", "x", "name<1"],
    "diff.first": ["result.json", "folder", "cam.csv"],
    "second": ["f-number=1.4:8", "prnu=0:0.02:3"],
    "diff.second": ["result.json", "missing.json"],
    "word": ["sensors", "illuminants", "onyx-rgbw", "E"],
    "folder": ["mine"],
    "markdown": ["-", "c.md"],
    "file": ["cam.csv", "lamp.csv", "filter.csv"],
    "columns": ["R"],
    "source": ["cam.csv", "onyx-rgbw", "lamp.csv"],
    "target": ["n.csv", "n.json", "n.spdx"],
    "created": ["2026-01-31"],
    "port": ["70000", "-1"],
    "draws": ["100", "1e3"],
    "figures": ["f"],
    "objectives": ["snr_y_db", "vora,delta_e", "infrared_share,snr10_lux"],
    "losses": ["snr_y_db=0.1", "delta_e=1", "vora"],
    "tolerance_nm": ["5", "0"],
    "tolerance_percent": ["1"],
}
EXTREME = [
    *("0", "-1", "-0", "1e308", "-1e308", "1e-308", "5e-324", "nan", "inf", "-inf", "1e400"),
    *("99999999999999999999", "1e15", "1e-15", "2.5", "3", "0x10", "1_0", "１０", "1,5", "½"),
    *("1:1", "1:0", "0:inf", "lux=0:0", "lux=1e-300:1e300", "kernel=1", "ridge", "ridge=nan"),
    *(
        "ridge=1e6",
        "noise-regularized=1e15",
        "noise-regularized=0",
        "bounded-psi=1e-15",
        "9" * 5000,
    ),
]
KEYS = [
    *("light.level_lux", "light.illuminant", "light.column", "exposure.time_ms", "matrices.0"),
    *("exposure.f_number", "exposure.saturate", "exposure.magnification", "exposure.equal"),
    *("sensors.0.name", "sensors.0.shift_nm", "sensors.0.ircut_nm", "sensors.0.filter", "seed"),
    *("sensors.0.pixel.pitch_um", "sensors.0.pixel.file", "outputs.space", "outputs.merit"),
    *("outputs.chart", "outputs.clip", "outputs.matrix", "metric", "prior", "title", "a.b.c", ""),
]
STRANGE = [
    *("", " ", "-", "--", "=", "é", "中文.csv", "🎨", "\u202e", "\0", "\udcff", "\n", "a" * 5000),
    *("[bold]x[/bold]", "[/]", "{}", "%s%n", "$HOME", "~", "~nobody", ".", "a/b/c", "cam.csv/x"),
    *("folder", "loop.csv", "/dev/null", "/dev/full", "/dev/null/x", "no-such", "<b>&", "'", '"'),
    *("--json", "--no-such", "-o", "-h", "--help", "None", "True", "E+E", "A+1xLED850+1xLED850"),
]
_SHORT_DESIGN = DESIGN_STARTER.replace("population = 200", "population = 4").replace(
    "budget = 30000", "budget = 8"
)
WEIGHTS = {
    **{"analyze": 24, "compare": 12, "matrix": 15, "simulate": 14, "convert": 10, "inspect": 8},
    **{
        "card": 1,
        "catalog": 5,
        "run": 4,
        "rerun": 2,
        "report": 1,
        "init": 2,
        "study": 1,
        "diff": 2,
        "schema": 0.5,
        "serve": 2,
        "optimize": 2,
        "sensitivity": 6,
        "denoise": 6,
        "denoise-bench": 1,
        "league": 2,
    },
    **{"reproduce": 1, "demo": 0.2, "demo-frames": 4, "characterize": 5},
}


def curve_csv(names, value, step=50):
    rows = [
        f"{w}," + ",".join(value(w, i) for i in range(len(names))) for w in range(400, 1051, step)
    ]
    return ("\n".join([",".join(["wavelength_nm", *names]), *rows]) + "\n").encode()


def npy(array):
    kept = io.BytesIO()
    np.save(kept, array)
    return kept.getvalue()


def frame_files():
    """Frames of a small color camera, six levels and one set of darks, with capture.toml."""
    rng = np.random.default_rng(6)

    def codes(electrons):
        noisy = rng.poisson(electrons, (24, 32)) + 3 * rng.standard_normal((24, 32))
        return npy(np.clip(100 + 0.5 * noisy, 0, 4095).round().astype(np.uint16))

    files, toml = {}, 'mosaic = "RG/GB"\nbits = 12\ndarks = ["d0.npy", "d1.npy"]\n'
    for k in range(2):
        files[f"shots/d{k}.npy"] = codes(0)
    for i in range(6):
        toml += (
            f'[[levels]]\nflats = ["f{i}a.npy", "f{i}b.npy"]\nphotons_per_pixel = {900 * (i + 1)}\n'
        )
        for k in "ab":
            files[f"shots/f{i}{k}.npy"] = codes(450 * (i + 1))
    return files | {"shots/capture.toml": toml.encode()}


def input_files():
    """Small files of every kind that a command line may name, by name."""
    return {
        "cam.csv": curve_csv("RGB", lambda w, i: f"{0.1 + 0.4 * (abs(w - 650 + 100 * i) < 80)}"),
        "lamp.csv": curve_csv(["power"], lambda w, i: f"{w / 500}"),
        "filter.csv": curve_csv(["filter"], lambda w, i: f"{0.9 if w < 660 else 0.02}"),
        "pixel.txt": b"K = 0.5 DN/e-\nsigma_d [e-] = 2.4\nmu_e.sat: 9000 e-\npixel pitch = 3 um\n",
        "mix.csv": b"to,R,G,B\nR,0.9,0.05,0\nG,0.05,0.9,0.05\nB,0,0.05,0.9\n",
        "ccm.csv": b"1.6,-0.4,-0.2\n-0.2,1.4,-0.2\n0,-0.5,1.5\n",
        **frame_files(),
        "cube.npy": npy(np.full((4, 5, 14), 0.4, np.float32)),
        "study.toml": STARTER.encode(),
        "design.toml": _SHORT_DESIGN.encode(),
        "é.csv": curve_csv("RGB", lambda w, i: f"{0.3 / (1 + i)}"),
        "mine/shed.csv": curve_csv("RG", lambda w, i: f"{0.3 / (1 + i)}"),
        "mine/SOURCES.toml": b'[shed]\nkind = "sensor"\nwhat = "a camera"\nquantity = "QE"\n'
        b'unit = "e-/photon"\nlevel = "absolute"\nsource = "a bench"\nlicense = "CC0"\n'
        b'defects = "none known"\n',
    }


@dataclass
class Line:
    """Words of a command line, and the files in its folder that differ from `input_files`."""

    words: list[str]
    damaged: dict[str, bytes] = field(default_factory=dict)


@dataclass
class Outcome:
    """The result of a command line."""

    code: int | str
    out: str
    err: str
    seconds: float
    resident_kib: int
    left: list[str]


def options_of(name):
    command = commands.get_command(click.Context(commands), name)
    return [p for p in command.params if p.name != "help"]


def valid_values(command, param):
    if isinstance(param.type, click.Choice):
        return list(param.type.choices)
    return VALUES.get(f"{command}.{param.name}", VALUES.get(param.name))


def random_line(seed, number, files):
    """The command line with this number: valid, and usually damaged one to three times."""
    rng = np.random.default_rng([seed, number])

    def one(values):
        return values[int(rng.integers(len(values)))]

    names, weights = list(WEIGHTS), np.array(list(WEIGHTS.values()), float)
    command = names[int(rng.choice(len(names), p=weights / weights.sum()))]
    params = options_of(command)
    arguments = [p for p in params if isinstance(p, click.Argument)]
    options = [p for p in params if not isinstance(p, click.Argument)]
    parts = []  # one list of words each, so that options keep their values
    for argument in arguments:
        count = int(rng.integers(1, 3)) if argument.nargs == -1 else 1
        parts += [[one(valid_values(command, argument))] for _ in range(count)]
    chosen = [o for o in options if o.required]
    chosen += [one(options) for _ in range(int(rng.integers(0, 5)))] if options else []
    parts += [option_words(command, option, one) for option in chosen]
    line = Line([command])
    for _ in range(int(rng.choice(5, p=[0.2, 0.4, 0.2, 0.1, 0.1]))):
        damage(parts, command, options, line, files, rng, one)
    if command == SERVED and not any(p[0] == "--port" for p in parts):
        parts.append(["--port", "-1"])
    if command == "denoise-bench":  # else all methods of large scenes
        for short in (["--denoise", "lmmse"], ["--crop", "24"]):
            if not any(part[0] == short[0] for part in parts):
                parts.append(short)
    line.words += [word for part in parts for word in part]
    return line


def option_words(command, option, one):
    if isinstance(option, click.Argument):
        return [one(valid_values(command, option))]
    word = one([*option.opts, *option.secondary_opts])
    return [word] if option.is_flag else [word, one(valid_values(command, option))]


def damage(parts, command, options, line, files, rng, one):
    """Damage the line once, in place."""
    often = ["value"] * 5 + ["number"] * 6 + ["file"] * 3 + ["cells"] * 3 + ["set"] * 2
    kind = one([*often, "drop", "double", "foreign", "swap", "join", "extra"])
    place = int(rng.integers(len(parts))) if parts else None
    if kind == "file":
        name = one(list(files))
        line.damaged[name] = mutated(line.damaged.get(name, files[name]), random_edits(rng))
    elif kind == "extra" or place is None:
        parts.append([one(EXTREME + STRANGE)])
    elif kind == "number":
        value = f"{10 ** rng.uniform(-16, 16):.6g}"
        numbers = [o for o in options if o.type.name in ("float", "integer")]
        if numbers:
            parts.append([one(numbers).opts[-1], value])
    elif kind == "cells":
        cells = rng.random((3, 14)) ** rng.choice([1, 40, 300])
        line.damaged["cam.csv"] = curve_csv("RGB", lambda w, i: f"{cells[i, (w - 400) // 50]:.6g}")
    elif kind == "set" and command in ("run", "report"):
        parts.append(["--set", f"{one(KEYS)}={one(one([EXTREME, STRANGE, FILES]))}"])
    elif kind == "value":
        number = len(parts[place]) > 1 and parts[place][-1][:1].isdigit()
        values = EXTREME if number and rng.random() < 0.7 else one([EXTREME, STRANGE, FILES])
        parts[place] = [*parts[place][:-1], one(values)]
    elif kind == "drop":
        parts[place] = parts[place][:-1]
    elif kind == "double":
        parts.append(list(parts[place]))
    elif kind == "foreign":
        other = one(list(COMMANDS))
        parts.append(option_words(other, one(options_of(other) or options), one))
    elif kind == "swap":
        parts[0], parts[place] = parts[place], parts[0]
    elif kind == "join":
        parts[place] = ["=".join(parts[place])]
    parts[:] = [part for part in parts if part]
    if command == SERVED:  # no word may make it listen
        parts[:] = [["--port", "-1"] if part[0].startswith("--port") else part for part in parts]


def outcome_of(line, files):
    """Run a line in a fork of this process, in a new folder."""
    with tempfile.TemporaryDirectory() as base:
        folder, scratch = Path(base, "here"), Path(base, "tmp")
        scratch.mkdir()
        (folder / "folder").mkdir(parents=True)
        for name, content in (files | line.damaged).items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_bytes(content)
        (folder / "loop.csv").symlink_to("loop.csv")
        start = time.perf_counter()
        process = os.fork()
        if process == 0:
            _run_and_leave(line.words, base)
        code, usage = _waited(process, start + WALL_SECONDS)
        return Outcome(
            code=code,
            out=Path(base, "out").read_bytes().decode(errors="replace"),
            err=Path(base, "err").read_bytes().decode(errors="replace"),
            seconds=time.perf_counter() - start,
            resident_kib=usage.ru_maxrss,
            left=[
                str(path.relative_to(base))
                for path in [*folder.rglob(".*"), *scratch.rglob("*")]
                if path.name != OWN_FILES
            ],
        )


def _run_and_leave(words, base):
    code = 1
    try:
        os.setsid()
        os.chdir(Path(base, "here"))
        os.environ.update(TMPDIR=str(Path(base, "tmp")), HOME=base)
        tempfile.tempdir = None
        for number, name in ((1, "out"), (2, "err")):
            os.dup2(os.open(Path(base, name), os.O_WRONLY | os.O_CREAT | os.O_APPEND), number)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        sys.stdout, sys.stderr = (
            io.TextIOWrapper(io.FileIO(number, "w", closefd=False), encoding="utf-8")
            for number in (1, 2)
        )
        resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE_BYTES, ADDRESS_SPACE_BYTES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        try:
            run(words)
        except SystemExit as stop:
            code = stop.code
        except BaseException:
            traceback.print_exc()
        with contextlib.suppress(ValueError):  # already closed if the reader is gone
            sys.stdout.flush()
            sys.stderr.flush()
    finally:
        os._exit(code)


def _waited(process, end):
    """The exit status in words or as a number, and what the process used."""
    while True:
        done, status, usage = os.wait4(process, os.WNOHANG)
        late = time.perf_counter() > end
        if not done and late:
            os.killpg(process, signal.SIGKILL)
            _, status, usage = os.wait4(process, 0)
        if done or late:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process, signal.SIGKILL)  # processes that it started and did not end
            code = os.waitstatus_to_exitcode(status)
            if late and not done:
                return f"not done within {WALL_SECONDS} s", usage
            return (code if code >= 0 else signal.Signals(-code).name), usage
        time.sleep(0.002)


_INTERNALS = re.compile(
    r"Traceback|Warning\b|\*\* On entry| object at 0x|<class '|<ast|\bErrno\b|np\.float64\(|"
    r"Exception ignored|NoneType|\bnan\b e-"
)


def faults_of(line, outcome):
    """The rules that an outcome breaks."""
    lines = outcome.err.splitlines()
    found = []
    differs = line.words[0] == "rerun" and outcome.code == 1 and "differ" in outcome.err
    if outcome.code not in (0, 2) and not differs:
        found.append(f"exit {outcome.code}")
    if outcome.code == 2:
        if outcome.out:
            found.append("refused, but printed something first")
        if not lines or not all(re.match(r"chromanoise: \S", one) for one in lines):
            found.append("no sentence of chromanoise's own")
        if len(set(lines)) < len(lines):  # one sentence for each error
            found.append("a sentence is repeated")
    found += [f"says {word!r}" for word in sorted(set(_INTERNALS.findall(outcome.err)))]
    if outcome.code == 0 and "Traceback" in outcome.out:
        found.append("a traceback on standard output")
    if outcome.code == 0 and "--json" in line.words and not outcome.err and _is_json_line(line):
        found += _json_faults(outcome.out)
    if outcome.resident_kib > RESIDENT_KIB:
        found.append(f"{outcome.resident_kib >> 10} MiB resident")
    if outcome.left:
        found.append(f"left {outcome.left[:3]}")
    return found


def _is_json_line(line):
    at = len(line.words) - 1 - line.words[::-1].index("--json")  # the last one counts
    return line.words[at + 1 : at + 2] == ["-"] and not {"-h", "--help"} & {*line.words}


def _json_faults(text):
    try:
        json.loads(text, parse_constant=lambda word: 1 / 0)
    except (ValueError, ZeroDivisionError) as error:
        return [f"no JSON on standard output: {error!r}"[:200]]
    return []


def prepared_files():
    """The input files and a result of ``run``; everything is imported and compiled after it."""
    for module, _ in COMMANDS.values():
        import_module(f"chromanoise.cli.{module}")
    files = input_files()
    with tempfile.TemporaryDirectory() as base:
        study = Path(base, "study.toml")
        study.write_text(
            '[[sensors]]\nname = "onyx-rgb"\n[[pictures]]\n[[pictures]]\nmosaic = "bayer"\n'
        )
        with contextlib.ExitStack() as silent, contextlib.suppress(SystemExit):
            silent.enter_context(contextlib.redirect_stdout(io.StringIO()))
            silent.enter_context(contextlib.redirect_stderr(io.StringIO()))
            run(["run", str(study), "-o", base])
        return files | {"result.json": Path(base, "analysis-kernel.json").read_bytes()}


def broken_lines(seed, numbers, report=lambda number, line, outcome, faults: None):
    """The lines that break a rule, and statistics of all lines."""
    files, broken, codes, slowest, largest = prepared_files(), [], {}, 0.0, 0
    for number in numbers:
        line = random_line(seed, number, files)
        outcome = outcome_of(line, files)
        faults = faults_of(line, outcome)
        report(number, line, outcome, faults)
        codes[str(outcome.code)] = codes.get(str(outcome.code), 0) + 1
        slowest, largest = max(slowest, outcome.seconds), max(largest, outcome.resident_kib)
        if faults:
            damaged = {name: content.decode("latin-1") for name, content in line.damaged.items()}
            broken.append(
                {"number": number, "faults": faults, "words": line.words, "damaged": damaged}
                | {key: str(value)[-1500:] for key, value in asdict(outcome).items()}
            )
    figures = {"lines": len(numbers), "codes": codes, "slowest_s": round(slowest, 1)}
    return {"broken": broken, "largest_mib": largest >> 10, **figures}


if __name__ == "__main__":
    first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    print(json.dumps(broken_lines(int(sys.argv[1]), range(first, first + int(sys.argv[2])))))
