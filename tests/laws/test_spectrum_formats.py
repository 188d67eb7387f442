"""Formats of spectra other than text: camera databases, ENVI libraries, FITS; and other files."""

import io
import json
import struct
import zipfile
from functools import partial

import numpy as np
import pytest
from scipy.io import savemat

from chromanoise.io.spectra import Answers, qe_of, read_curves
from outcomes import refusal_of, refused_input
from spectrum_samples import AT_NM, GREEN, RED

CURVES = np.stack([RED, GREEN], axis=1)


refusal = partial(refusal_of, read_curves)


# ISETCam


def cells(*entries):
    names = np.empty((1, len(entries)), dtype=object)
    names[0, :] = entries
    return names


def matlab(**arrays):
    written = io.BytesIO()
    savemat(written, arrays)
    return written.getvalue()


def cmy(**changes):
    return matlab(**{"wavelength": AT_NM[None], "data": CURVES, **changes})


@pytest.mark.parametrize(
    ("changes", "names"),
    [
        ({}, ("1", "2")),
        ({"filterNames": np.array(["cyan   ", "magenta"])}, ("cyan", "magenta")),
        ({"filterNames": cells("c", "m")}, ("c", "m")),
        ({"filterNames": cells("c", "m").T}, ("c", "m")),
        ({"filterNames": cells("c", "")}, ("1", "2")),
        ({"filterNames": cells("c", "m"), "comment": ""}, ("c", "m")),
        ({"filterNames": cells("c", "m"), "comment": np.array(["one", "two"])}, ("c", "m")),
        ({"filterNames": cells("c", "m"), "info": {"maker": "nobody", "year": 2003}}, ("c", "m")),
        ({"filterNames": cells("c", "m"), "data": CURVES.T.copy()[:, :]}, ("c", "m")),
        ({"filterNames": cells("c", "m"), "wavelength": AT_NM.astype("u2")[:, None]}, ("c", "m")),
    ],
)
def test_isetcam_may_name_its_filters_in_any_of_its_ways(file, changes, names):
    read = read_curves(file(cmy(**changes), "CMY.mat"))
    assert read.curves.names == names
    assert np.array_equal(read.curves.values, CURVES)


def with_bare_cell(content: bytes) -> bytes:
    """A second name of which MATLAB wrote only the tag: kind 14, 0 bytes."""
    last = content.rindex(struct.pack("<I", 14))  # the cell that holds "m", at the file's end
    shorter = content[:last] + struct.pack("<II", 14, 0)
    lost = len(content) - len(shorter)
    start = shorter.index(b"filterNames") - 48  # flags, dimensions and name are before it
    assert struct.unpack_from("<I", shorter, start)[0] == 14
    count = struct.unpack_from("<I", shorter, start + 4)[0]
    return shorter[: start + 4] + struct.pack("<I", count - lost) + shorter[start + 8 :]


def test_an_empty_cell_without_a_body_and_zeros_at_the_end_are_valid(file):
    content = cmy(filterNames=cells("c", "m"))
    read = read_curves(file(with_bare_cell(content), "cym.mat"))
    assert read.curves.names == ("1", "2")  # one of the names is empty
    assert np.array_equal(read.curves.values, CURVES)
    padded = read_curves(file(content + bytes(512), "padded.mat"))
    assert padded.curves.names == ("c", "m")


# cameras


def test_a_camera_of_jiang_has_the_wavelengths_of_its_paper_and_a_note(file):
    curves = {name: np.linspace(0.1 * k, 1.0, 33) for k, name in enumerate("rgb")}
    read = read_curves(file(matlab(**curves), "cmf_Some.mat"))
    assert read.curves.wavelength_nm.tolist() == list(range(400, 721, 10))
    assert read.curves.names == ("R", "G", "B")
    assert np.array_equal(read.curves.values, np.stack([*curves.values()], axis=1))
    assert (read.quantity, read.per, read.level) == ("response", "energy", "relative")
    assert any("no wavelengths" in note and "Jiang" in note for note in read.notes)


def test_r_g_b_of_another_length_are_refused_for_lack_of_wavelengths(file):
    error = refusal(file(matlab(**dict.fromkeys("rgb", np.ones(31))), "rgb.mat"))
    assert error.value == (31, 31, 31)


DCAMPROF = {"camera_name": "A", "red_ssf": [0.1, 0.2, 0.9], "green_ssf": [0.1, 1, 0.2],
            "blue_ssf": [0.8, 0.2, 0]}  # fmt: skip


@pytest.mark.parametrize("bands", [[400, 500, 600], [400, 600, 100]])
def test_a_camera_of_ssf_data_is_a_relative_response_per_energy(file, bands):
    path = file(json.dumps({"ssf_bands": bands, **DCAMPROF}), "A.json")
    read = read_curves(path)
    assert read.curves.wavelength_nm.tolist() == [400, 500, 600]
    assert read.curves.values.T.tolist() == [DCAMPROF[f"{c}_ssf"] for c in ("red", "green", "blue")]
    assert read.curves.names == ("R", "G", "B")
    assert (read.quantity, read.per, read.level) == ("response", "energy", "relative")
    qe = qe_of(read, Answers(peak_qe=0.5))
    # per photon the blue end gains: 0.8 / 400 of 0.9 / 600 and 1 / 500, the highest of which is .5
    assert pytest.approx(
        np.array([DCAMPROF["red_ssf"], DCAMPROF["green_ssf"], DCAMPROF["blue_ssf"]])
        / [4, 5, 6] / (1 / 5) * 0.5, rel=1e-12
    ) == qe.values.T  # fmt: skip


def test_a_spectrum_of_dcamprof_is_divided_by_its_scale(file):
    path = file(json.dumps({"bands": [400, 500], "scale": 4, "spectrum": [1, 2]}), "lamp.json")
    assert read_curves(path).curves.values.ravel().tolist() == [0.25, 0.5]


@pytest.mark.parametrize(
    "form",
    [
        {"camera": "A", "wavelengths": [400, 500], "red": [0.1, 0.2], "green": [0.3, 0.4]},
        {"wavelength_nm": [400, 500], "sensitivities": {"red": [0.1, 0.2], "green": [0.3, 0.4]}},
        {"wavelength": [0.4, 0.5], "wavelength_unit": "um", "red": [0.1, 0.2],
         "green": [0.3, 0.4], "iso": [100]},
    ],
)  # fmt: skip
def test_plain_lists_of_json_are_curves_over_their_list_of_wavelengths(file, form):
    path = file(json.dumps(form), "A.json")
    if "iso" in form:
        error = refusal(path)
        assert (error.where, error.value) == ("key 'iso'", 1)
        return
    read = read_curves(path)
    assert read.curves.wavelength_nm.tolist() == [400, 500]
    assert read.curves.names == ("red", "green")
    assert read.curves.values.tolist() == [[0.1, 0.3], [0.2, 0.4]]


@pytest.mark.parametrize(
    "form",
    [
        {"ssf_bands": [400, 500], **DCAMPROF},
        {"ssf_bands": [400, 500, 600]},
        {"ssf_bands": "all", **DCAMPROF},
        {"ssf_bands": [600, 400, 100], **DCAMPROF},
        {"bands": [400, 500], "scale": 0, "spectrum": [1, 2]},
        {"wavelengths": [400, 500], "red": [0.1, None]},
        {"wavelengths": [400, 500], "red": [0.1, 1e31]},
        {"schema": "chromanoise sensor"},
        {"schema": "chromanoise table", "schema_version": 1},
        {"schema": "chromanoise spectra", "schema_version": 2},
        {"schema": "chromanoise spectra", "schema_version": 1},
    ],
)
def test_invalid_json_of_a_known_format_is_refused_in_one_sentence(file, form):
    refusal(file(json.dumps(form), "A.json"))


# ENVI


def header(**changes):
    fields = {
        "samples": 4, "lines": 2, "bands": 1, "header offset": 0, "data type": 4,
        "interleave": "bsq", "file type": "ENVI Spectral Library", "byte order": 0,
        "wavelength units": "Micrometers", "reflectance scale factor": 10000,
        "spectra names": "{oak,\n elm}", "wavelength": "{0.4, 0.5,\n 0.6, 0.7}",
    } | changes  # fmt: skip
    pairs = (f"{key} = {value}" for key, value in fields.items() if value is not None)
    return "\n".join(["ENVI", *pairs]) + "\n"


@pytest.mark.parametrize("named", ["lib.sli", "lib.hdr", "both.sli", "both.sli.hdr"])
@pytest.mark.parametrize(("code", "dtype"), [(4, "<f4"), (5, ">f8"), (2, ">i2"), (12, "<u2")])
def test_an_envi_library_is_read_by_either_of_its_files(file, named, code, dtype):
    counts = np.round(CURVES.T * 10_000)
    order = {"<": 0, ">": 1}[dtype[0]]
    text = header(**{"data type": code, "byte order": order})
    for data, head in (("lib.sli", "lib.hdr"), ("both.sli", "both.sli.hdr")):
        first = file(counts.astype(dtype).tobytes(), data)
        file(text, head)
    read = read_curves(first.with_name(named))
    assert read.curves.names == ("oak", "elm")
    assert read.curves.wavelength_nm.tolist() == AT_NM.tolist()
    assert np.array_equal(read.curves.values, counts.T / 10_000)
    assert (read.quantity, read.wavelength_unit) == ("reflectance", "um")


def test_an_envi_library_is_read_without_its_deleted_points_and_with_a_note(file):
    values = CURVES.T.astype("<f4").copy()
    values[0, 1] = -1.23e34
    file(header(**{"reflectance scale factor": None}), "lib.hdr")
    read = read_curves(file(values.tobytes(), "lib.sli"))
    # between 0.0125 and 0.45 over 200 nm
    assert read.curves.values[1, 0] == pytest.approx((0.0125 + 0.45) / 2, rel=1e-6)
    assert any("oak: 1 values" in defect for defect in read.defects)
    assert read.quantity is None


@pytest.mark.parametrize(
    ("changes", "where", "value"),
    [
        ({"wavelength units": "GHz"}, "", "GHz"),
        ({"file type": "ENVI Standard"}, "key 'file type'", "ENVI Standard"),
        ({"samples": 3}, "", 32),
        ({"wavelength": "{0.4, 0.5}"}, "key 'wavelength'", 2),
        ({"wavelength": "{0.4, 0.5, 0.6, high}"}, "entry 3 of 'wavelength'", "high"),
        ({"wavelength": None}, "key 'wavelength'", None),
        ({"reflectance scale factor": 0}, "key 'reflectance scale factor'", "0"),
        ({"data type": 6}, "key 'data type'", 6),
        ({"data gain values": "{1, 2}"}, "key 'data gain values'", None),
    ],
)
def test_an_envi_library_that_contradicts_itself_is_refused(file, changes, where, value):
    head = file(header(**changes), "lib.hdr")
    path = file(CURVES.T.astype("<f4").tobytes(), "lib.sli")
    subject = path if "samples" in changes else head
    with refused_input(subject=str(subject), where=where, value=value):
        read_curves(path)


def test_half_of_an_envi_library_is_refused(file):
    assert refusal(file(bytes(32), "lib.sli")).value == "lib.hdr"
    path = file(header(), "other.hdr")
    assert refusal(path).subject == str(path)


# FITS


def fits_bytes(unit: str | None = "Angstrom", flux=RED, cards=()) -> bytes:
    """A binary table of wavelength and flux, made by the rules of the standard alone."""

    def block(cards):
        text = "".join(card.ljust(80) for card in [*cards, "END"])
        return text.ljust(-(-len(text) // 2880) * 2880).encode()

    def card(key, value):
        return f"{key:<8}= {value:>20}"

    first = [card("SIMPLE", "T"), card("BITPIX", 8), card("NAXIS", 0), card("EXTEND", "T")]
    form, dtype = ("I", ">i2") if flux.dtype.kind == "i" else ("D", ">f8")
    rows = np.empty(4, dtype=[("wavelength", ">f8"), ("flux", dtype)])
    rows["wavelength"], rows["flux"] = AT_NM * 10, flux
    table = [
        f"{'XTENSION':<8}= 'BINTABLE'",
        *(card("BITPIX", 8), card("NAXIS", 2), card("NAXIS1", rows.itemsize), card("NAXIS2", 4)),
        *(card("PCOUNT", 0), card("GCOUNT", 1), card("TFIELDS", 2)),
        *(f"TTYPE1  = '{'wavelength':<8}'", f"TFORM1  = '{'D':<8}'"),
        *((f"TUNIT1  = '{unit:<8}'",) if unit else ()),
        *(f"TTYPE2  = '{'flux':<8}'", f"TFORM2  = '{form:<8}'", "TUNIT2  = 'W/m2/nm'"),
        *(card(key, value) for key, value in cards),
    ]
    return block(first) + block(table) + rows.tobytes().ljust(2880, b"\0")


def test_a_fits_table_is_read_in_the_unit_of_its_column(file):
    pytest.importorskip("astropy")
    read = read_curves(file(fits_bytes(), "lamp.fits"))
    assert read.curves.wavelength_nm == pytest.approx(AT_NM)
    assert np.array_equal(read.curves.values[:, 0], RED)
    assert read.curves.names == ("flux",)
    assert read.quantity == "power"


def test_a_fits_table_without_wavelengths_or_in_another_unit_is_refused(file):
    pytest.importorskip("astropy")
    assert refusal(file(fits_bytes("GHz"), "lamp.fits")).value == "GHz"
    nameless = fits_bytes().replace(b"'wavelength'", b"'somewhere '")
    refusal(file(nameless, "none.fits"))


@pytest.mark.parametrize(("scale", "zero"), [(1.0, 0.0), (1e-3, 0.0), (1, 32768)])
def test_a_fits_cell_of_the_declared_null_number_is_no_value(file, scale, zero):
    pytest.importorskip("astropy")
    stored = np.array([500, -999, 400, 300])
    cards = [("TNULL2", -999), ("TSCAL2", scale), ("TZERO2", zero)]
    read = read_curves(file(fits_bytes(flux=stored, cards=cards), "lamp.fits"))
    known = [zero + scale * number for number in (500, 400, 300)]
    assert read.curves.values[:, 0] == pytest.approx(known)
    assert read.curves.wavelength_nm.tolist() == [400.0, 600.0, 700.0]
    assert any("flux: 1 value" in result for result in read.defects)


# headings


@pytest.mark.parametrize(
    ("heading", "quantity", "scale", "values"),
    [
        ("R [A / W]", "response", "as written", (10, 20)),
        ("R ( A/W )", "response", "as written", (10, 20)),
        ("QE [ % ]", "QE", "percent", (0.1, 0.2)),
        ("QE % ", "QE", "percent", (0.1, 0.2)),
        ("E [W m-2  nm-1 ]", "power", "as written", (10, 20)),
    ],
)
def test_spaces_in_a_unit_do_not_hide_it(file, heading, quantity, scale, values):
    read = read_curves(file(f"wavelength (nm ),{heading}\n400,10\n500,20\n", "a.csv"))
    assert (read.quantity, read.scale, read.wavelength_unit) == (quantity, scale, "nm")
    assert read.curves.names == (heading[: heading.index(" ")],)
    assert read.curves.values.ravel() == pytest.approx(values)
    assert read.per == {"QE": "photon"}.get(quantity, "energy")


# what is none


def npz():
    written = io.BytesIO()
    np.savez(written, r=np.ones(3))
    return written.getvalue()


def archive(name):
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w") as parts:
        parts.writestr(name, "a")
    return written.getvalue()


def matlab_4():
    written = io.BytesIO()
    savemat(written, {"wavelength": AT_NM, "data": CURVES}, format="4")
    return written.getvalue()


KINDS = {
    "PNG": b"\x89PNG\r\n\x1a\n" + bytes(40),
    "JPEG": b"\xff\xd8\xff\xe0" + bytes(40),
    "TIFF": b"II*\0" + bytes(40),
    "PDF": b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n",
    "RTF": b"{\\rtf1\\ansi curves}",
    "HTML": b"\n<!DOCTYPE html>\n<html><body>400</body></html>",
    "ZIP": archive("curves.csv"),
    ".ods": archive("content.xml"),
    "gzip": b"\x1f\x8b\x08\0" + bytes(40),
    ".xls": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600),
    "SQLite": b"SQLite format 3\0" + bytes(40),
    "HDF5": b"\x89HDF\r\n\x1a\n" + bytes(40),
    ".npy": b"\x93NUMPY\x01\0" + bytes(40),
    ".npz": npz(),
    "ELF": b"\x7fELF\x02\x01" + bytes(40),
    "AvaSoft 8": b"AVS84" + bytes(400),
    "AvaSoft 7": struct.pack("<f", 70.0) + bytes(400),
    "AvaSoft 6": struct.pack("<f", 60.0) + bytes(400),
    "OPUS": b"\n\n\xfe\xfe" + bytes(400),
    "WiRE": b"WDF1" + bytes(400),
    "OMNIC": b"Spectral Data File\r\n" + bytes(400),
    ".spc": b"\0K\0\x80" + bytes(400),
    ".ProcSpec": archive("ps_1.xml"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_of_another_kind_is_refused_with_the_kind_of_its_first_bytes(file, kind):
    assert kind in refusal(file(KINDS[kind], "curves.csv")).value


TABLE = "Wellenlänge [µm];Grün (%)\r\n0,4;12,5\r\n0,5;50,0\r\n"


@pytest.mark.parametrize(
    "coding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"]
)
def test_a_table_is_read_in_every_supported_character_encoding(file, coding):
    read = read_curves(file(TABLE.encode(coding), "a.csv"))
    assert read.curves.wavelength_nm.tolist() == [400.0, 500.0]
    assert read.curves.names == ("Grün",)
    assert read.curves.values.ravel().tolist() == [0.125, 0.5]
    assert any("read as" in note for note in read.notes) == (
        coding in ("utf-16-le", "utf-16-be", "cp1252")
    )


def test_no_message_of_a_third_party_parser_is_shown(file, monkeypatch):
    from chromanoise.io import curve_files as door

    def broken(*_):
        raise TypeError("expected <class 'int'>")

    monkeypatch.setattr(door, "meaning_of", broken)
    message = str(refusal(file("nm,A\n400,0.1\n500,0.2\n", "a.csv")))
    assert "class" not in message
    assert "expected" not in message
