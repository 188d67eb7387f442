"""What may come to the page's server: questions and files, valid, mutated and malicious."""

import bz2
import importlib
import io
import json
import random
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

JSON = {"Content-Type": "application/json"}
NM = range(400, 1051, 25)
PARTS = (
    "head", "sensitivities", "stages", "budget", "vectors", "ellipses", "levels", "chart",
    "pareto", "map",
)  # fmt: skip
NUMBERS = (
    0, -0.0, -1, 1, 2, 0.5, 1e-320, 1e-300, 1e-15, 1e-6, 1e6, 1e15, 1e16, 1e154, 1e155, 1e300,
    1.7976931348623157e308, -1e308, 2**31, 2**32, 2**63, 2**64, 10**30, 10**299, 10**400, 99_999,
)  # fmt: skip
WORDS = (
    "", " ", "\0", "\n", "\r\n", "\ud800", "\udfff\ud800", "\u202e", "\ufeff", "e\u0301",
    "\U0001f4a5", "%s%n{}", "__proto__", "/etc/passwd", "../x.csv", "~", "/dev/zero", "C:\\x.csv",
    "builtin:", "upload:0123456789abcdef", "builtin:checker", "E", "onyx-rgbw", "kernel", "E+E",
    "x" * 600, "9" * 5000, "<script>", "' OR 1=1", "nan", "inf", "1e999", "True", "null",
)  # fmt: skip
LIGHTS = ("E", "A", "G173", "5000K", "3200K", "LED660", "A+0.5xLED850")
ODD_LIGHTS = (
    "0K", "1e9K", "0.001K", "-5K", "LED0", "LED1e9", "E+1e300xLED850", "E+0xLED850",
    "E+1e-300xLED940/50", "E+1xLED940/1e-9", "E+1xLED940/0",
)  # fmt: skip
SENSORS = ("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "model-rgbir")
FILTERS = ("ircut-650", "ircut-700", "ircut-1e9", "ircut-0", "ircut--5", "ircut-")
METHODS = (
    "kernel", "least-squares", "white-preserving", "lmmse", "ridge", "noise-regularized",
    "bounded-psi",
)  # fmt: skip
METHODS_WITH_NUMBER = METHODS[-3:]
TOKENS = (
    b"NaN", b"Infinity", b"-Infinity", b"1e999", b"null", b'"\\ud800"', b"[", b"{", b"}", b"\0",
    b"\xff", b"\xef\xbb\xbf", b"1" * 400, b"[" * 5000, b'{"a":' * 2000,
)  # fmt: skip
METHODS_OF_HTTP = ("GET", "HEAD", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "BREW")
PATHS = (
    "/", "/api/choices", "/api/answer", "/api/nothing", "/api/answer/", "/api//answer",
    "/api/%61nswer", "/assets/app/main.js", "/assets/../server.py", "/assets/%2e%2e/server.py",
    "/assets/", "//", "/%00", "/assets/" + "a" * 300 + ".js", "/assets/" + "a/" * 500 + "b.js",
    "/assets/" + "a/" * 3000 + "b.js",
    "/" + "x" * 8000, "/?" + "q" * 9000,
)  # fmt: skip


Ids = dict[str, list[str]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """One request.

    Attributes
    ----------
    kind
        Of which it is, for the report.
    method, path, headers, body
        As HTTP has them.
    """

    kind: str
    method: str = "POST"
    path: str = "/api/answer"
    headers: Mapping[str, str] = field(default_factory=lambda: dict(JSON))
    body: bytes = b""


def questions(seed: int, ids: Ids, *, bombs: float = 0.003) -> Iterator[Question]:
    """Without end, the same for the same seed and the same ids.

    Parameters
    ----------
    seed
        Of what is drawn.
    ids
        Of files that were uploaded, by kind; whoever asks puts new ones there.
    bombs
        Share of files that are made to take much memory or time.
    """
    rng = random.Random(seed)
    while True:
        share = rng.random()
        if share < bombs:
            name = rng.choice(list(BOMBS))
            yield upload("bomb", f"{name}.{name.partition('.')[0]}", _bomb(name))
        elif share < 0.25:
            yield _file(rng)
        elif share < 0.30:
            yield _odd_request(rng)
        else:
            yield _question(rng, ids)


# questions


def _study(rng: random.Random, ids: Ids) -> dict[str, Any]:
    def sensor() -> dict[str, Any]:
        own = ids.get("sensor", []) if rng.random() < 0.2 else []
        name = rng.choice(own or SENSORS)
        part: dict[str, Any] = {"name": name}
        if rng.random() < 0.1:
            part["filter"] = rng.choice(FILTERS)
        if rng.random() < 0.5:
            part["pixel"] = {"read_noise_e": rng.choice((0, 1.0, 5.5)), "full_well_e": 9e3}
            part["shift_nm"], part["ircut_nm"] = rng.uniform(-50, 50), rng.choice((None, 650.0))
        if name.startswith("upload:"):
            part["answers"] = {"level": "absolute", "per": "photon"}
        return part

    def matrix() -> str:
        name = rng.choice(METHODS)
        number = rng.choice(NUMBERS if rng.random() < 0.2 else (0.01, 0.5, 0.99))
        return f"{name}={number}" if name in METHODS_WITH_NUMBER else name

    sweep = {"vary": "lux", "first": 0.01, "last": 1e3, "points": 61, "quantity": "snr-y"}
    light = rng.choice(ODD_LIGHTS if rng.random() < 0.1 else LIGHTS)
    cube = rng.choice(["builtin:checker", *ids.get("cube", [])])
    return {
        "light": {"illuminant": light, "level_lux": rng.choice((0.1, 10.0, 1e4))},
        "exposure": {"equal": "exposure", "f_number": 1.8, "saturate": rng.uniform(0.1, 1)},
        "sensors": [sensor() for _ in range(rng.choice((1, 1, 1, 2, 2, 8)))],
        "matrices": list({matrix() for _ in range(rng.choice((1, 1, 2, 4)))}),
        "sweeps": [sweep] * rng.choice((0, 1)),
        "pictures": [{"cube": cube, "prnu": 0.01}] * rng.choice((0, 1)),
        "metric": rng.choice(("quanta", "energy")),
    }


def _question(rng: random.Random, ids: Ids) -> Question:
    path = rng.choice(("/api/answer",) * 8 + ("/api/texts",) * 2 + ("/api/picture",))
    question: dict[str, Any] = {"number": rng.randrange(1000), "study": _study(rng, ids)}
    if path == "/api/answer":
        question["want"] = rng.sample(PARTS, rng.choice((1, 1, 2)))
        question["look"] = {
            "coordinate": rng.choice(("Y", "b*", "?")),
            "plane": rng.choice(("ab", "xy")),
        }
    elif path == "/api/picture":
        question |= {"sensor": rng.choice((0, 0, 1)), "noisy": rng.random() < 0.5}
        question["cube"] = rng.choice((None, "builtin:checker", *ids.get("cube", [])))
    for _ in range(rng.choice((0, 0, 1, 1, 1, 3))):
        _mutate(rng, question)
    body = json.dumps(question).encode()
    if rng.random() < 0.1:
        body = damaged(rng, body)
    return Question(kind=f"question {path}", path=path, body=body)


def _mutate(rng: random.Random, question: Any) -> None:
    """Change one value somewhere in it."""
    places: list[tuple[Any, Any]] = []

    def look(at: Any) -> None:
        for key in at if isinstance(at, dict) else range(len(at)):
            places.append((at, key))
            if isinstance(at[key], dict | list):
                look(at[key])

    look(question)
    if not places:
        return
    at, key = rng.choice(places)
    was, how = at[key], rng.random()
    if how < 0.35:
        at[key] = rng.choice(NUMBERS)
    elif how < 0.6:
        at[key] = rng.choice(WORDS)
    elif how < 0.75:
        at[key] = rng.choice(
            (None, True, False, [], {}, [[]], {"a": {}}, [None], [was], {"x": was})
        )
    elif how < 0.85 and isinstance(at, dict):
        at[rng.choice((*WORDS[:12], "sensor", "pixle", "extra"))] = was
    elif how < 0.92:
        copies = rng.choice((2, 9, 65, 1000, 100_000))
        at[key] = (was if isinstance(was, list) else [was]) * (copies if len(repr(was)) < 9 else 40)
    elif isinstance(at, dict):
        del at[key]


def damaged(rng: random.Random, content: bytes) -> bytes:
    """Some bytes changed, cut off, put in, or repeated."""
    held = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 6))):
        at, how = rng.randrange(len(held) + 1), rng.random()
        if how < 0.2:
            del held[at:]
        elif how < 0.4:
            held[at:at] = rng.choice(TOKENS)
        elif how < 0.5:
            held[at : at + rng.randrange(60)] = b""
        elif how < 0.6:
            held[at:at] = held[at : at + rng.randrange(400)] * rng.choice((1, 50))
        elif how < 0.8 and len(held) - at >= 4:
            held[at : at + 4] = struct.pack("<I", rng.choice((0, 1, 2**16, 2**31, 2**32 - 1)))
        elif at < len(held):
            held[at] = rng.randrange(256)
    return bytes(held[:11_000_000])


def _odd_request(rng: random.Random) -> Question:
    body = json.dumps({"study": {"sensors": [{"name": "onyx-rgbw"}]}, "want": ["head"]}).encode()
    headers = dict(JSON)
    how = rng.randrange(4)
    if how == 0:
        return Question(kind="path", method="GET", path=rng.choice(PATHS), headers={})
    if how == 1:
        method = rng.choice(METHODS_OF_HTTP)
        return Question(kind="method", method=method, path=rng.choice(PATHS), headers=headers)
    if how == 2:
        name = rng.choice(("Host", "Origin", "Sec-Fetch-Site", "Content-Type", "Accept", "Cookie"))
        headers[name] = rng.choice(
            ("evil.example", "", "null", "cross-site", "a" * 5000, "\xff", ";")
        )
        return Question(kind="header", headers=headers, body=body)
    name = rng.choice(
        ("", "%", "%ff", "%00.csv", "a" * 4000 + ".csv", "..%2f..%2fx.npz", "x.exe", ".")
    )
    return upload("name", name, body)


# files


def upload(kind: str, name: str, content: bytes) -> Question:
    """A file that is dropped."""
    headers = {"Content-Type": "application/octet-stream", "X-Filename": name}
    return Question(kind=kind, path="/api/upload", headers=headers, body=content)


def _file(rng: random.Random) -> Question:
    name = rng.choice(list(FILES))
    if name in _SLOW and rng.random() < 0.75:
        name = "csv"
    content = _sample(name)
    if rng.random() < 0.9:
        content = damaged(rng, content)
    ending = name if rng.random() < 0.95 else rng.choice(list(FILES))
    return upload(f"file {name}", f"{name}.{ending}", content)


def _table(head: str, row: str = "{0},0.1,0.2,0.3") -> bytes:
    return "\n".join([head, *(row.format(w) for w in NM)]).encode()


def _cube(shape: tuple[int, ...] = (4, 5, len(NM)), kind: str = "<f4") -> np.ndarray:
    return np.full(shape, 0.5, kind)


def _saved(write: Callable[[io.BytesIO], object]) -> bytes:
    held = io.BytesIO()
    write(held)
    return held.getvalue()


def _npz(cube: np.ndarray, *, packed: bool = True) -> bytes:
    save = np.savez_compressed if packed else np.savez
    at = np.linspace(400, 1050, cube.shape[-1])
    return _saved(lambda held: save(held, reflectance=cube, wavelength_nm=at))


def _mat(packed: bool = True, **arrays: Any) -> bytes:
    from scipy.io import savemat

    return _saved(lambda held: savemat(held, arrays, do_compression=packed))


def _tif(cube: np.ndarray, compression: str | None = "zlib") -> bytes:
    import tifffile

    description = json.dumps({"wavelengths": [float(w) for w in np.linspace(400, 1050, len(cube))]})
    return _saved(
        lambda held: tifffile.imwrite(
            held, cube, compression=compression, photometric="minisblack", description=description
        )
    )


def _h5(cube: np.ndarray, **made: Any) -> bytes:
    h5py = importlib.import_module("h5py")

    def write(held: io.BytesIO) -> None:
        with h5py.File(held, "w") as file:
            file.create_dataset("reflectance", data=cube, **made)
            file["wavelength_nm"] = np.linspace(400, 1050, cube.shape[-1])

    return _saved(write)


def _h5_of_nothing(shape: tuple[int, ...], chunks: tuple[int, ...]) -> bytes:
    h5py = importlib.import_module("h5py")

    def write(held: io.BytesIO) -> None:
        with h5py.File(held, "w") as file:
            made = {"chunks": chunks, "compression": "gzip"}
            dataset = file.create_dataset("reflectance", shape, "f4", **made)
            plain = zlib.compress(bytes(4 * int(np.prod(chunks))))
            dataset.id.write_direct_chunk((0, 0, 0), plain)
            file["wavelength_nm"] = np.linspace(400, 1050, shape[-1])

    return _saved(write)


def _xlsx(rows: int = len(NM)) -> bytes:
    import openpyxl

    book = openpyxl.Workbook()
    book.active.append(["wavelength_nm", "R", "G"])
    for i in range(rows):
        book.active.append([400 + 650 * i / (rows - 1), 0.25, 0.5])
    return _saved(book.save)


def _xlsx_of_zeros(member: str, size: int) -> bytes:
    def write(held: io.BytesIO) -> None:
        with (
            zipfile.ZipFile(io.BytesIO(_xlsx())) as old,
            zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as new,
        ):
            for name in old.namelist():
                content = old.read(name)
                if name == member:
                    head, _, tail = content.partition(b"</sheetData>")
                    row = b'<row r="1"><c r="A1" t="inlineStr"><is><t>x</t></is></c></row>'
                    content = head + row * (size // len(row)) + b"</sheetData>" + tail
                new.writestr(name, content)

    return _saved(write)


def _npy(shape: tuple[int, ...]) -> bytes:
    head = str({"descr": "<f4", "fortran_order": False, "shape": shape}).encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + bytes(1000)


_JSON_CURVES = {"units": "relative", "index": {"main": ["R", "G"]},
                "data": {"main": {str(w): [0.1, 0.2] for w in NM}}}  # fmt: skip
_SP = b'CTI3\n\nDEVICE_CLASS "EMISS"\nMEAS_TYPE "EMISSION"\n'
_SP += b'SPECTRAL_BANDS "3"\nSPECTRAL_START_NM "400"\nSPECTRAL_END_NM "1050"\n'
_SP += b"NUMBER_OF_FIELDS 3\nBEGIN_DATA_FORMAT\nSPEC_400 SPEC_725 SPEC_1050\nEND_DATA_FORMAT\n"
_SP += b"NUMBER_OF_SETS 1\nBEGIN_DATA\n1 2 3\nEND_DATA\n"
_SPDX = b'<IESTM2714 xmlns="iestm2714" version="1.0"><SpectralDistribution>'
_SPDX += b"<SpectralQuantity>relative</SpectralQuantity>"
_SPDX += b"".join(b'<SpectralData wavelength="%d">0.5</SpectralData>' % w for w in NM)
_SPDX += b"</SpectralDistribution></IESTM2714>"
_TOML = b'title = "T"\n[light]\nilluminant = "E"\n[[sensors]]\nname = "onyx-rgb"\n'

_FRONT = {
    "schema": "chromanoise front",
    "schema_version": 1,
    "objectives": [{"name": "snr_y_db", "what": "SNR of Y", "unit": "dB", "better": "higher"}],
    "scenes": [{"name": "day", "light": {"level_lux": 100.0}}],
    "members": [
        {
            "name": "front-001",
            "sensor": "sensors/front-001.csv",
            "objectives": {"snr_y_db": 30.0},
            "curves": {
                "wavelength_nm": [float(w) for w in NM],
                "names": ["G"],
                "qe": [[0.5]] * len(NM),
            },
            "pixel": {"read_noise_e": 2.0},
        }
    ],
}
_MATRIX = {
    "matrix_lux_per_e": [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    "time_ms": 10.0, "f_number": 2.0, "pitch_um": 3.0, "level_lux": 10.0, "illuminant": "E",
}  # fmt: skip
_MATRIX_CSV = b"# time_ms: 10\n# f_number: 2\n# pitch_um: 3\n# level_lux: 10\n"
_MATRIX_CSV += b"lx/e-,R,G,B\nX,2,0,0\nY,0,1,0\nZ,0,0,1\n"


def _sensor_json() -> bytes:
    from chromanoise.io.sensor_files import sensor_json
    from chromanoise.study import sensor_named

    return sensor_json(sensor_named("onyx-rgb")).encode()


FILES: Mapping[str, Callable[[], bytes]] = {
    "csv": lambda: _table("wavelength_nm,R,G,B"),
    "tsv": lambda: _table("nm\tpower", "{0}\t0.5"),
    "txt": lambda: _table("# a lamp", "{0} 0.5"),
    "json": lambda: json.dumps({"spectral_data": _JSON_CURVES}).encode(),
    "front.json": lambda: json.dumps(_FRONT).encode(),
    "matrix.json": lambda: json.dumps(_MATRIX).encode(),
    "matrix.csv": lambda: _MATRIX_CSV,
    "sensor.json": lambda: _sensor_json(),
    "sp": lambda: _SP,
    "spdx": lambda: _SPDX,
    "xml": lambda: _SPDX,
    "xlsx": lambda: _xlsx(),
    "toml": lambda: _TOML,
    "npz": lambda: _npz(_cube()),
    "npy": lambda: _saved(lambda held: np.save(held, _cube())),
    "tif": lambda: _tif(_cube((6, 4, 5))),
    "tiff": lambda: _tif(_cube((6, 4, 5)), None),
    "mat": lambda: _mat(wavelength=np.array(NM)[:, None], data=np.full((len(NM), 3), 0.5)),
    "h5": lambda: _h5(_cube(), chunks=(2, 5, 9), compression="gzip"),
    "hdf5": lambda: _h5(_cube()),
    "nc": lambda: _h5(_cube(), chunks=(4, 5, 9), compression="gzip", shuffle=True),
}
"""A small valid file of each ending."""

_SLOW = ("h5", "hdf5", "nc")  # a process is started for each

BOMBS: Mapping[str, Callable[[], bytes]] = {
    "mat": lambda: _mat(reflectance=_cube((1000, 1000, 250), "<f8")),
    "mat.curves": lambda: _mat(
        wavelength=np.linspace(400, 1050, 2000)[:, None], data=np.full((2000, 2000), 0.5)
    ),
    "mat.words": lambda: _mat(
        wavelength=np.array(NM)[:, None],
        data=np.full((len(NM), 3), 0.5),
        filterNames=np.full((1, 300_000), "x", dtype=object),
    ),
    "tif": lambda: _tif(np.zeros((31, 6000, 6000), "u2")),
    "tif.pages": lambda: _tif(np.zeros((15_000, 8, 8), "u1"), None),
    "npz": lambda: _npz(_cube((3000, 3000, 40))),
    "npz.one": lambda: _npz(_cube((1000, 2000, 31))),
    "npy": lambda: _npy((10**6, 10**6, 31)),
    "npy.negative": lambda: _npy((-5, 4, 31)),
    "h5": lambda: _h5(np.zeros((1500, 1500, 31), "f4"), chunks=(500, 500, 31), compression="gzip"),
    "h5.chunk": lambda: _h5_of_nothing((4000, 4000, 31), (2000, 2000, 31)),
    "nc": lambda: _h5_of_nothing((10**6, 10**6, 31), (1000, 1000, 31)),
    "xlsx": lambda: _xlsx_of_zeros("xl/worksheets/sheet1.xml", 60_000_000),
    "xlsx.long": lambda: _xlsx_of_zeros("xl/worksheets/sheet1.xml", 600_000_000),
    "csv": lambda: b"wavelength_nm,R\n" + b"500,0.1\n" * 120_000,
    "csv.wide": lambda: b"wavelength_nm" + b",R" * 450_000 + b"\n400,1\n",
    "csv.quote": lambda: b'wavelength_nm,"' + b"x" * 990_000,
    "json": lambda: b'{"spectral_data":' + b"[" * 400_000,
    "json.wide": lambda: b'{"spectral_data": {"data": {"main": {' + b'"400": [1],' * 80_000,
    "spdx": lambda: _SPDX[:100] + b"<a>" * 300_000,
    "toml": lambda: _TOML + b"[[pictures]]\n" * 70_000,
    "toml.list": lambda: _TOML + b"[[pictures]]\nformats = [" + b"'x'," * 240_000 + b"]\n",
    "toml.keys": lambda: _TOML + b"".join(b"[a%d]\n" % i for i in range(90_000)),
    "sp": lambda: _SP + b"1 " * 400_000,
}
"""Files that are small and would take much memory or time, the first word of each its ending."""


@cache
def _sample(name: str) -> bytes:
    return FILES[name]()


@cache
def _packed_bomb(name: str) -> bytes:
    return bz2.compress(BOMBS[name](), 1)


def _bomb(name: str) -> bytes:
    return bz2.decompress(_packed_bomb(name))
