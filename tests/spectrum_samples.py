"""The same two curves in every format, as the tools of each write them."""

import io
import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

import numpy as np
from scipy.io import savemat

AT_NM = np.array([400.0, 500.0, 600.0, 700.0])
RED = np.array([0.0125, 0.05, 0.45, 0.3])
GREEN = np.array([0.02, 0.4375, 0.125, 0.0625])


def _rows() -> list[tuple[float, float, float]]:
    return [(float(w), float(r), float(g)) for w, r, g in zip(AT_NM, RED, GREEN, strict=True)]


def csv_text() -> str:
    rows = [f"{w:g},{r!r},{g!r}" for w, r, g in _rows()]
    return "\n".join(["# a bench", "Wavelength [nm],R,G", *rows]) + "\n"


def german_text() -> str:
    rows = [f"{w / 1000:g};{100 * r:g};{100 * g:g}".replace(".", ",") for w, r, g in _rows()]
    return "\ufeff" + "\r\n".join(["Wellenlänge [µm];R (%);G (%)", *rows]) + "\r\n"


def digitized_text() -> str:
    # each list in an order of its own, and the first point of R twice
    rows = ["R,,G,", "X,Y,X,Y", "400,0.0125,700,0.0625", "700,0.3,600,0.125", "500,0.05,400,0.02"]
    return "\n".join([*rows, "600,0.45,500,0.4375", "400,0.0125,,"]) + "\n"


def isetcam_bytes(compressed: bool = True) -> bytes:
    names = np.empty((1, 2), dtype=object)
    names[0, 0], names[0, 1] = "R", "G"
    file = io.BytesIO()
    arrays = {
        "wavelength": AT_NM.astype(np.uint16)[None],
        "data": np.stack([RED, GREEN], axis=1),
        "filterNames": names,
        "comment": "a bench",
        "units": "photons",
    }
    savemat(file, arrays, do_compression=compressed)
    return file.getvalue()


def rawtoaces_text() -> str:
    main = {f"{w:g}": [r, g] for w, r, g in _rows()}
    spectral = {"units": "relative", "index": {"main": ["R", "G"]}, "data": {"main": main}}
    header = {"schema_version": "1.0.0", "manufacturer": "nobody", "model": None}
    return json.dumps({"header": header, "spectral_data": spectral}, indent=1)


def cgats_text() -> str:
    head = [
        "SPECT",
        'DESCRIPTOR "two filters"',
        'KEYWORD "MEAS_TYPE"',
        'MEAS_TYPE "TRANSMISSIVE"',
        'SPECTRAL_BANDS "4"',
        'SPECTRAL_START_NM "400.0"',
        'SPECTRAL_END_NM "700.0"',
        'SPECTRAL_NORM "50.0"',
        "NUMBER_OF_FIELDS 5",
        "BEGIN_DATA_FORMAT",
        "SAMPLE_ID SPEC_400 SPEC_500 SPEC_600 SPEC_700",
        "END_DATA_FORMAT",
        "NUMBER_OF_SETS 2",
        "BEGIN_DATA",
    ]
    sets = [" ".join([n, *(f"{50 * v:.4f}" for v in c)]) for n, c in (("R", RED), ("G", GREEN))]
    return "\n".join([*head, *sets, "END_DATA"]) + "\n"


def tm27_text(quantity: str = "transmittance") -> str:
    points = "".join(
        f'<SpectralData wavelength="{w:.1f}">{r!r}</SpectralData>\n' for w, r, _ in _rows()
    )
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n<IESTM2714 xmlns="iestm2714" version="1.0">\n'
        "<Header><Description>R</Description></Header>\n<SpectralDistribution>"
        f"<SpectralQuantity>{quantity}</SpectralQuantity>\n{points}"
        "</SpectralDistribution></IESTM2714>"
    )


def workbook_bytes() -> bytes:
    from openpyxl import Workbook

    book = Workbook()
    sheet = book.active
    sheet.append(["QE of a bench"])
    sheet.append(["Wavelength (nm)", "R", "G"])
    for row in _rows():
        sheet.append(list(row))
    file = io.BytesIO()
    book.save(file)
    return file.getvalue()


CAMERA_CSV = "wavelength_nm,R,G,B\n" + "\n".join(
    f"{nm},{0.1 + 0.3 * (nm > 590)},{0.1 + 0.3 * (500 < nm < 590)},{0.1 + 0.3 * (nm < 500)}"
    for nm in range(400, 1051, 10)
)
SAMPLES: dict[str, bytes] = {
    "bench.csv": csv_text().encode(),
    "german.csv": german_text().encode(),
    "digitized.csv": digitized_text().encode(),
    "plain.mat": isetcam_bytes(compressed=False),
    "packed.mat": isetcam_bytes(),
    "camera.json": rawtoaces_text().encode(),
    "argyll.sp": cgats_text().encode(),
    "lamp.spdx": tm27_text().encode(),
    "book.xlsx": workbook_bytes(),
}


# Files as the programs of instruments write them: their layout is real, their values are not.


@dataclass(frozen=True, kw_only=True)
class Written:
    """A file of an instrument, and the curve that reading it must give.

    Attributes
    ----------
    maker, name, content
        The instrument or its program; the file.
    wavelength_nm, values
        The true curve, in increasing order.
    answers
        What the file does not declare, and which of its curves is meant.
    beside
        Other files of its folder.
    """

    maker: str
    name: str
    content: bytes
    wavelength_nm: tuple[float, ...]
    values: tuple[float, ...]
    answers: dict[str, Any] = field(default_factory=dict)
    beside: dict[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class Style:
    """How a text is stored: the settings of a computer, not of an instrument."""

    number: int
    coding: str
    ends: str
    comma: bool
    falling: bool
    more_lines: int

    @property
    def sign(self) -> str:
        """What separates cells where a comma does, unless it is the decimal sign."""
        return ";" if self.comma else ","

    def text(self, value: Decimal | int) -> str:
        text = format(value, "f")
        return text.replace(".", ",") if self.comma else text

    def points(self) -> list[tuple[Decimal, Decimal]]:
        """Wavelengths in nm and values of 0.05 to 0.95, other ones for each style."""
        steps = range(350 + self.number, 1101 + self.number, 25)
        made = [
            (Decimal(at), Decimal(500 + (at * (at + 37 * self.number)) % 9000) / 10000)
            for at in steps
        ]
        return made[::-1] if self.falling else made

    def rows(self, cells, sign="\t") -> list[str]:
        """One line per point; ``cells`` gives numbers or words for wavelength, value and place."""
        lines = []
        for k, (at, value) in enumerate(self.points()):
            given = (c if isinstance(c, str) else self.text(c) for c in cells(at, value, k))
            lines.append(sign.join(given))
        return lines

    def facts(self, sign: str) -> list[str]:
        return [f"Parameter {k}{sign}25 °C" for k in range(self.more_lines)]


STYLES = [
    Style(
        number=k,
        coding=("utf-8", "cp1252", "utf-8-sig", "utf-16")[k % 4],
        ends=("\n", "\r\n", "\r")[k % 3],
        comma=k % 2 == 1,
        falling=k % 5 == 4,
        more_lines=(1, 4, 40)[k % 3],
    )
    for k in range(12)
]
_PERCENT = {"scale": "percent"}


def _spectrasuite(s):
    lines = ["SpectraSuite Data File", "+" * 36, "Date: Thu Jan 01 10:00:00 CET 2015", "User: lab",
             "Dark Spectrum Present: Yes", "Integration Time (usec): 100000 (USB4C1)",
             *s.facts(": "), "Number of Pixels in Processed Spectrum: 31",
             ">>>>>Begin Processed Spectral Data<<<<<", *s.rows(lambda w, v, k: (w, 100 * v)),
             ">>>>>End Processed Spectral Data<<<<<"]  # fmt: skip
    return "a.txt", lines, _PERCENT


def _oceanview(s):
    lines = ["Data from FLMS1__0__10-00-00-000.txt Node", "", "Date: Mon", "User: lab",
             "Trigger mode: 0", *s.facts(": "), "XAxis mode: Wavelengths",
             ">>>>>Begin Spectral Data<<<<<", *s.rows(lambda w, v, k: (w, 100 * v))]  # fmt: skip
    return "a.txt", lines, _PERCENT


def _jaz(s):
    lines = ["Jaz Data File", "+" * 36, *s.facts(": "), ">>>>>Begin Processed Spectral Data<<<<<",
             "W\tD\tR\tS\tP",
             *s.rows(lambda w, v, k: (w, Decimal(90), Decimal(9000), 90 + 8910 * v, 100 * v)),
             ">>>>>End Processed Spectral Data<<<<<"]  # fmt: skip
    return "a.txt", lines, {"columns": ("P",), **_PERCENT}


def _avasoft_7(s):
    lines = [
        "a comment",
        "Integration time: 175 ms",
        "Average: 20 scans",
        *s.facts(": "),
        "Wave   ;Dark     ;Ref      ;Sample   ;Transmittance",
        "[nm]   ;[counts] ;[counts] ;[counts] ;[% transmittance] ",
        *s.rows(lambda w, v, k: (w, Decimal("-8.9"), Decimal(7000), v, 100 * v), ";"),
    ]
    return "a.ttt", lines, {"columns": ("Transmittance",)}  # fmt: skip


def _avasoft_sample(s):
    lines = [
        "",
        "Integration time [ms]:  84.900",
        "Averaging Nr. [scans]: 10",
        *s.facts(": "),
        "Wave   ;Sample   ;Dark     ;Reference;Reflectance",
        "[nm]   ;[counts] ;[counts] ;[counts] ;[%]",
        "",
        *s.rows(lambda w, v, k: (w, v, Decimal("0.1"), Decimal("0.9"), 100 * v), ";"),
    ]
    return "a.TXT", lines, {"columns": ("Sample",)}  # fmt: skip


def _sekonic(s):
    at = dict(s.points())
    coarse = [f"Spectral Data {w}[nm]{s.sign}{s.text(at[w] / 2)}" for w in list(at)[::5]]
    lines = [f"Date Saved{s.sign}15/03/2021 3:44", f"Title{s.sign}a", *s.facts(s.sign),
             f"Tcp [K]{s.sign}3262", f"CRI Ra{s.sign}87{s.text(Decimal('.5'))}", *coarse,
             *s.rows(lambda w, v, k: (f"Spectral Data {w}[nm]", v), s.sign),
             f"PFD [umolm-2s-1]{s.sign}12"]  # fmt: skip
    return "a.csv", lines, {}


def _licor(s):
    lines = ["Model Name\tLI-180", "Serial Number\tLI180-1", "Time\t2020/01/01_10:00:00",
             *s.facts("\t"), "PPFD\t100", "I-Time\t10",
             *s.rows(lambda w, v, k: (f"{w}nm", v))]  # fmt: skip
    return "a.txt", lines, {}


def _uprtek(s):
    lines = ["Model Name\tCV600", "Memo\t\t", "LUX\t695", "LambdaP\t456", *s.facts("\t"),
             "R1\t91", *s.rows(lambda w, v, k: (f"{w}nm", v))]  # fmt: skip
    return "a.xls", lines, {}


def _wasatch(s):
    head = ("Pixel", "Wavelength", "Wavenumber", "Processed", "Raw", "Dark", "Reference")
    lines = [
        f"ENLIGHTEN Version{s.sign}4.0.14",
        *s.facts(s.sign),
        f"Laser Enable{s.sign}False",
        "",
        s.sign.join(head),
        *s.rows(lambda w, v, k: (k, w, 9 * w, v, 900 * v, Decimal(9), Decimal(900)), s.sign),
    ]
    return "a.csv", lines, {"columns": ("Processed",)}  # fmt: skip


def _bwtek(s):
    head = "Pixel;Wavelength;Wavenumber;Raman Shift;Dark;Raw data #1;%TR #1;Absorbance #1;"
    lines = [
        "File Version;BWSpec4.02_15",
        "Date;2015-01-01",
        *s.facts(";"),
        head,
        *s.rows(lambda w, v, k: (k, w, 9 * w, "", Decimal(9), 900 * v, 100 * v, v, ""), ";"),
    ]
    return "a.txt", lines, {"columns": ("%TR #1",)}  # fmt: skip


def _semrock(s):
    lines = ["Typical Measured Data for FF01-600/50-25", *s.facts(": "), "----------",
             "Wavelength (nm)\tTransmission", *s.rows(lambda w, v, k: (w, v))]  # fmt: skip
    return "a.txt", lines, {}


def _alluxa(s):
    lines = ["Part Number 7777", "Angle of Incidence: 0 deg", *s.facts(": "),
             "Wavelength (µm)\tTransmission (%)\tOptical Density",
             *s.rows(lambda w, v, k: (w / 1000, 100 * v, Decimal("0.3")))]  # fmt: skip
    return "a.txt", lines, {"columns": ("Transmission",)}


def _thorlabs_osa(s):
    lines = ["#Thorlabs FTS", "[SpectrumHeader]", "Date;20161027", *s.facts(";"),
             "XAxisUnit;nm_air", "YAxisUnit;intensity", "[Data]",
             *s.rows(lambda w, v, k: (w, v), ";"), "[EndOfFile]"]  # fmt: skip
    return "a.csv", lines, {}


def _cary(s):
    lines = [s.sign.join(["Baseline 100%T", "", "sample1", "", ""]),
             s.sign.join(["Wavelength (nm)", "%T"] * 2 + [""]),
             *s.rows(lambda w, v, k: (w, Decimal("99.5"), w, 100 * v, ""), s.sign), "",
             "Baseline 100%T", "Collection Time: 1/1/2015 10:00:00", *s.facts("  "),
             "Start (nm)              1100.0"]  # fmt: skip
    return "a.csv", lines, {"columns": ("sample1",)}


def _shimadzu(s):
    lines = ['"file: a - RawData"', s.sign.join(['"Wavelength nm."', '"T%"']),
             *s.rows(lambda w, v, k: (w, 100 * v), s.sign)]  # fmt: skip
    return "a.txt", lines, {}


def _perkin_elmer(s):
    lines = ["PE UV       SUBTECH     SPECTRUM    ASCII       PEDS        4.00 ", "-1", "a.sp",
             "15/01/01", "10:00:00.00", "#HDR", *s.facts(" "), "#GR", "nm", "%T", "1.0", "0.0",
             "31", "#DATA", *s.rows(lambda w, v, k: (w, 100 * v))]  # fmt: skip
    return "a.asc", lines, _PERCENT


def _svc(s):
    lines = [
        "/*** Spectra Vista SIG Data ***/",
        "name= a.sig",
        "integration= 100, 30, 10",
        *s.facts("= "),
        "units= Radiance, Radiance",
        "temp= 1,2,3,4",
        "data= ",
        *s.rows(lambda w, v, k: (w, Decimal(1000 + k), 1000 * v, 100 * v), "  "),
    ]
    return "a.sig", lines, {"columns": ("column 4",), **_PERCENT}  # fmt: skip


def _spectral_evolution(s):
    lines = ["Comment:", "Version: 2.3 [1.2.6250C]", "Instrument: PSR-3500_SN1", *s.facts(": "),
             "Units: W/m^2/sr/nm", "Columns [4]:", "Data:",
             "Wvl\tRad. (Ref.)\tRad. (Target)\tReflect. %",
             *s.rows(lambda w, v, k: (w, Decimal("0.1"), v / 10, 100 * v))]  # fmt: skip
    return "a.sed", lines, {"columns": ("Reflect.",)}


def _asd_text(s):
    lines = ["Text conversion of header file a.000", "The instrument number was 1",
             *s.facts(" was "), "wavelength\ta.000", *s.rows(lambda w, v, k: (w, v))]  # fmt: skip
    return "a.000.txt", lines, {}


def _stellarnet(s):
    lines = ['"File: a.trm","SpectraWiz"', *s.facts(" : "),
             *s.rows(lambda w, v, k: (w, 100 * v), "   ")]  # fmt: skip
    return "a.trm", lines, _PERCENT


def _horiba(s):
    lines = ["#Acq. time (s)=\t10", "#AxisUnit[1]=\tnm", *(f"#{line}" for line in s.facts("=\t")),
             *s.rows(lambda w, v, k: (w, v))]  # fmt: skip
    return "a.txt", lines, {}


def _lightfield(s):
    lines = [s.sign.join(("Frame", "Row", "Column", "Wavelength", "Intensity")),
             *s.rows(lambda w, v, k: (1, 1, k, w, v), s.sign)]  # fmt: skip
    return "a.csv", lines, {}


def _chroma(s):
    return "a.txt", s.rows(lambda w, v, k: (w, v)), {}


def _gl_optic(s):
    lines = ["GL Spectis 1.0", *s.facts(": "), "lambda [nm]; S [W/m²nm]",
             *s.rows(lambda w, v, k: (w, v), ";")]  # fmt: skip
    return "a.csv", lines, {}


def _clicked(s):
    rows = s.rows(lambda w, v, k: (w, v), "; " if s.comma else ", ")
    return "a.csv", [rows[i * 7 % len(rows)] for i in range(len(rows))], {}


_TEXTS = (
    _spectrasuite, _oceanview, _jaz, _avasoft_7, _avasoft_sample, _sekonic, _licor, _uprtek,
    _wasatch, _bwtek, _semrock, _alluxa, _thorlabs_osa, _cary, _shimadzu, _perkin_elmer, _svc,
    _spectral_evolution, _asd_text, _stellarnet, _horiba, _lightfield, _chroma, _gl_optic, _clicked,
)  # fmt: skip


def _true(style) -> dict[str, tuple[float, ...]]:
    points = sorted(style.points())
    return {
        "wavelength_nm": tuple(float(at) for at, _ in points),
        "values": tuple(float(value) for _, value in points),
    }


def _text_files() -> Iterator[Written]:
    for maker in _TEXTS:
        for style in STYLES:
            name, lines, answers = maker(style)
            content = (style.ends.join(lines) + style.ends).encode(style.coding)
            yield Written(
                maker=maker.__name__.strip("_"), name=name, content=content, answers=answers,
                **_true(style),
            )  # fmt: skip


_POINTS = Style(0, "utf-8", "\n", False, False, 0).points()


def _binary(maker, name, content, **changes) -> Written:
    true = _true(STYLES[0])
    return Written(maker=maker, name=name, content=content, **{**true, **changes})


def _thorlabs_workbooks() -> Iterator[Written]:
    """Words in columns A and B beside the table, which begins in column C."""
    from openpyxl import Workbook

    for k in range(12):
        unit, factor = (("nm", 1), ("µm", 1000))[k % 2]
        book = Workbook()
        sheet = book.active
        if k % 3 == 2:
            sheet["A1"] = "This file has the data of one sample."
            sheet = book.create_sheet("Transmission")
        start = 1 + k % 4
        sheet.cell(start, 1, "Item #")
        sheet.cell(start + 2, 2, "The data are typical and vary from lot to lot.")
        sheet.cell(start + 9, 1, "www.example.com")
        heading = ["% Transmission", "Transmission (%)", "Optical Density"]
        sheet.cell(start, 3, f"Wavelength ({unit})")
        sheet.cell(start, 4, heading[k % 2])
        if k % 4 == 1:
            sheet.cell(start, 6, "Click to download")
            sheet.cell(start + 3, 6, "Notes: at 20 °C")
        for row, (at, value) in enumerate(_POINTS, start + 1):
            sheet.cell(row, 3, float(at / factor))
            sheet.cell(row, 4, float(100 * value))
        file = io.BytesIO()
        book.save(file)
        yield _binary("thorlabs workbook", "a.xlsx", file.getvalue())


def _psychtoolbox() -> Iterator[Written]:
    at, values = (np.array([float(one) for one in each]) for each in zip(*_POINTS, strict=True))
    sampling = np.array([[at[0], at[1] - at[0], at.size]])
    for version in ("4", "5"):
        for name, curve in (
            ("T_eye", values[None]), ("spd_lamp", values[:, None]), ("sur_wall", values[:, None]),
            ("srf_wall", values[:, None]),
        ):  # fmt: skip
            file = io.BytesIO()
            savemat(file, {f"S_{name.partition('_')[2]}": sampling, name: curve}, format=version)
            yield _binary("psychtoolbox", "a.mat", file.getvalue())


def asd_bytes(mark, kind, form, spectrum, reference=None, *, start_nm=350.0, step_nm=25.0) -> bytes:
    """An ASD file by the offsets of its description: 186, 191, 195, 199, 204 and 484."""
    head = bytearray(484)
    head[:3] = mark
    head[186], head[199] = kind, form
    head[191:199] = struct.pack("<2f", start_nm, step_nm)
    head[204:206] = struct.pack("<H", len(spectrum))
    body = np.asarray(spectrum).astype(("<f4", "<i4", "<f8")[form]).tobytes()
    if reference is None:
        return bytes(head) + body
    words = b"white panel"
    flag = struct.pack("<H", 1) + bytes(16) + struct.pack("<H", len(words)) + words
    return bytes(head) + body + flag + np.asarray(reference, dtype="<f8").tobytes()


def _asd() -> Iterator[Written]:
    values = np.array([float(value) for _, value in _POINTS])
    for mark in (b"as6", b"as7", b"as8"):
        for kind in (1, 6):
            for form, panel in ((1, 10_000.0), (2, 20_000.0)):
                content = asd_bytes(mark, kind, form, np.round(values * panel), values * 0 + panel)
                yield _binary("asd", "a.asd", content)
        yield _binary("asd", "a.000", asd_bytes(mark, 1, 2, values), answers={"scale": "fraction"})


def _isofit() -> Iterator[Written]:
    at, values = zip(*((float(a), float(v)) for a, v in _POINTS), strict=True)
    for interleave, sides in (("bip", (1, 3)), ("bil", (1, 3)), ("bsq", (3, 1)), ("bip", (3, 1))):
        for code, dtype in ((5, "<f8"), (4, "<f4")):
            samples, lines = sides
            table = np.array([values, values, values], dtype=dtype)  # spectra by wavelengths
            stored = {"bip": table, "bil": table, "bsq": table.T}[interleave]
            header = (
                f"ENVI\nsamples = {samples}\nlines = {lines}\nbands = {len(at)}\n"
                "header offset = 0\nfile type = ENVI Standard\n"
                f"data type = {code}\ninterleave = {interleave}\nbyte order = 0\n"
                f"wavelength units = Nanometers\nwavelength = {{ {' , '.join(map(str, at))} }}\n"
            )
            yield _binary(
                "isofit", "filtered_ocean", stored.tobytes(), answers={"columns": ("2",)},
                values=tuple(table[1].astype(float).tolist()),
                beside={"filtered_ocean.hdr": header.encode()},
            )  # fmt: skip


def jcamp_block(
    title, lines, count, *, form="(X++(Y..Y))", units="NANOMETERS", **more
) -> list[str]:
    label = "XYPOINTS" if form == "(XY..XY)" else "XYDATA"
    facts = {"XUNITS": units, "YUNITS": "TRANSMITTANCE", "XFACTOR": "1", **more}
    return [
        f"##TITLE= {title}", "##JCAMP-DX= 4.24 $$ a program", "##DATA TYPE= UV/VIS SPECTRUM",
        *(f"##{key}= {value}" for key, value in facts.items()), f"##NPOINTS= {count}",
        f"##{label}= {form}", *lines, "##END=",
    ]  # fmt: skip


def asdf_lines(numbers, start, step, form, per_line=8) -> list[str]:
    """Whole numbers in a form of JCAMP-DX: each digit by the table of McDonald & Wilks (1988)."""

    def letter(value, positive, negative, zero):
        digits = str(abs(value))
        first = zero if value == 0 else (positive if value > 0 else negative)[int(digits[0]) - 1]
        return first + digits[1:]

    def squeezed(value):
        return letter(value, "ABCDEFGHI", "abcdefghi", "@")

    def difference(value):
        return letter(value, "JKLMNOPQR", "jklmnopqr", "%")

    def changes(part):
        left, text = np.diff(part).tolist(), ""
        while left:
            same = next((k for k, c in enumerate(left) if c != left[0]), len(left))
            same = min(same, 9) if form == "DIFDUP" else 1
            text += difference(left[0]) + ("STUVWXYZs"[same - 1] if same > 1 else "")
            left = left[same:]
        return text

    written = {
        "AFFN": lambda part: " " + " ".join(map(str, part)),
        "PAC": lambda part: "".join(f"{value:+d}" for value in part),
        "SQZ": lambda part: "".join(map(squeezed, part)),
    }.get(form, lambda part: squeezed(part[0]) + changes(part))
    check = form in ("DIF", "DIFDUP")  # each line begins with the last value of the line before
    parts = ((i, numbers[i : i + per_line + check]) for i in range(0, len(numbers), per_line))
    return [f"{start + i * step:g}{written(part)}" for i, part in parts]


def _jcamp() -> Iterator[Written]:
    whole = [int(10000 * value) for _, value in _POINTS]
    first, last = _POINTS[0][0], _POINTS[-1][0]
    flat = [5000, 5000, 5000, 5000, 5000, 5010, 5020, 5030, 5040, *whole[9:]]
    steps = {"YFACTOR": "0.0001", "FIRSTX": first, "LASTX": last}
    for numbers in (whole, flat):
        values = tuple(number / 10000 for number in numbers)
        for form in ("AFFN", "PAC", "SQZ", "DIF", "DIFDUP"):
            lines = asdf_lines(numbers, first, 25, form)
            block = jcamp_block("sample", lines, len(whole), **steps)
            yield _binary("jcamp", "a.jdx", "\n".join(block).encode(), values=values)
        points = [f"{at}, {number}" for (at, _), number in zip(_POINTS, numbers, strict=True)]
        for rows in (points, [f"{row};" for row in points], ["; ".join(points)]):
            block = jcamp_block("sample", rows, len(whole), form="(XY..XY)", YFACTOR="0.0001")
            yield _binary("jcamp", "a.dx", "\r\n".join(block).encode(), values=values)
        for comma in (False, True):  # as SpectraSuite exports sample, dark and reference
            blocks = []
            for factor, title in ((1, "SAMPLE"), (3, "DARK"), (9, "REFERENCE")):
                rows = [f"{at}.00, {number / 10000:.6f}" for (at, _), number in
                        zip(_POINTS, (factor * n for n in numbers), strict=True)]  # fmt: skip
                rows = [r.replace(".", ",") if comma else r for r in rows]
                blocks += jcamp_block(
                    f"EXPORT: {title} SPECTRUM", rows, len(whole), form="(XY..XY)"
                )
            link = ["##TITLE= EXPORT", "##DATA TYPE= LINK", "##BLOCKS= 3", *blocks, "##END= $$all"]
            yield _binary(
                "spectrasuite jcamp", "a.jdx", "\n".join(link).encode(), values=values,
                answers={"columns": ("EXPORT: SAMPLE SPECTRUM",)},
            )  # fmt: skip


def written_files() -> list[Written]:
    """Files of 31 instruments and programs, in the forms in which computers store them."""
    makers = (_text_files, _thorlabs_workbooks, _psychtoolbox, _asd, _isofit, _jcamp)
    return [file for maker in makers for file in maker()]
