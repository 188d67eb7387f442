"""Pixels from data sheets, noise profiles and photon transfer: what goes in comes out."""

import json

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.base.errors import InputError
from chromanoise.io.pixels import read_noise_profile
from chromanoise.io.pixels.emva import pixel_from_emva, read_emva_sheet
from chromanoise.io.pixels.noise_profiles import (
    RelativeNoise,
    is_noise_profile_text,
    pixel_from_darktable,
    read_darktable_noise,
)
from chromanoise.io.pixels.photon_transfer_csv import (
    is_photon_transfer_text,
    read_photon_transfer_csv,
)
from chromanoise.sensor import Adc, Pixel
from chromanoise.sensor.camera_noise import noise_profile, pixel_from_noise_profile
from chromanoise.sensor.changes import PixelSource, open_questions, pixel_from
from chromanoise.sensor.photon_transfer import photon_transfer_fit, pixel_from_photon_transfer
from chromanoise.sensor.photon_transfer_regression import PhotonTransfer
from outcomes import refused_input

RNG_SEED = 1288

# a sheet: 10,000 e- full, K = 0.25 DN/e-; SNR_max = 100 = 40 dB; sigma_y.dark^2 = 4 DN^2 + 1/12
# rounds to 2.0207 DN = 8.0829 e-; threshold 8.5829 e-; DR = 1165.1 = 61.33 dB
SHEET = {
    "QE": (60.0, "%"),
    "K": (0.25, "DN/e-"),
    "sigma_d": (8.0, "e-"),
    "sigma_y.dark": (2.0207, "DN"),
    "u_e.sat": (10_000.0, "e-"),
    "u_p.sat": (16_667.0, "p"),
    "u_e.min": (8.5829, "e-"),
    "u_p.min": (14.305, "p"),
    "SNR_max": (40.0, "dB"),
    "DR": (61.33, "dB"),
    "DSNU": (1.5, "e-"),
    "PRNU": (0.5, "%"),
    "dark current": (4.0, "DN/s"),
    "pixel pitch": (3.45, "um"),
    "bits": (12.0, "bit"),
    "black level": (64.0, "DN"),
}


def disagreements(source):
    return [note for note in source.notes if "one is wrong" in note or "the top code " in note]


def typed(tmp_path, values, form="{name} = {number} {unit}", name="sheet.txt"):
    path = tmp_path / name
    lines = [form.format(name=n, number=v, unit=u) for n, (v, u) in values.items()]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


# sources and questions


def test_what_no_source_says_is_asked_and_one_answer_each_makes_the_pixel():
    silent = PixelSource(source="nothing")
    assert [q.split(":")[0] for q in open_questions(silent)] == [
        "pitch_um",
        "full_well_e",
        "read_noise_e",
    ]
    with refused_input(subject="nothing", setting="full_well_e"):
        pixel_from(silent, pitch_um=2.0, read_noise_e=1.0)
    pixel = pixel_from(silent, pitch_um=2.0, read_noise_e=1.0, full_well_e=5000.0)
    assert (pixel.pitch_um, pixel.full_well_e, pixel.read_noise_e) == (2.0, 5000.0, 1.0)


def test_the_pixel_of_a_source_has_all_of_its_values():
    sheet = PixelSource(source="a sheet", pitch_um=3.0, full_well_e=9000.0, dsnu_e=1.5, prnu=0.01)
    pixel = pixel_from(sheet, read_noise_e=2.0, row_noise_e=0.5)
    assert pixel == Pixel(
        pitch_um=3.0, full_well_e=9000.0, read_noise_e=2.0, dsnu_e=1.5, prnu=0.01, row_noise_e=0.5
    )


def test_an_answer_never_overrides_a_source():
    with refused_input(subject="pitch_um", value=2.0):
        pixel_from(PixelSource(source="a sheet", pitch_um=3.0), pitch_um=2.0)


# EMVA 1288


def test_a_sheet_that_agrees_with_itself_has_no_contradiction_and_its_own_numbers():
    result = pixel_from_emva(SHEET, source="a sheet")
    assert disagreements(result) == []
    assert (result.qe, result.pitch_um, result.full_well_e, result.read_noise_e) == (
        0.6,
        3.45,
        1e4,
        8.0,
    )
    assert result.adc == Adc(bits=12, gain_e_per_dn=4.0, black_level_dn=64)
    assert (result.dark_current_e_per_s, result.dsnu_e, result.prnu) == (16.0, 1.5, 0.005)
    assert open_questions(result) == ()


@pytest.mark.parametrize(
    ("name", "value", "law"),
    [
        ("SNR_max", (43.0, "dB"), "SNR_max"),
        ("DR", (66.0, "dB"), "DR = "),
        ("u_e.min", (12.0, "e-"), "u_e.min"),
        ("sigma_y.dark", (3.0, "DN"), "sigma_y.dark"),
        ("u_p.sat", (12_000.0, "p"), "QE u_p.sat"),
        ("u_p.min", (20.0, "p"), "QE u_p.min"),
        ("bits", (10.0, "bit"), "above the top code 1023"),
    ],
)
def test_a_value_that_speaks_against_the_others_is_told(name, value, law):
    found = disagreements(pixel_from_emva(SHEET | {name: value}))
    assert found
    assert all(law in note for note in found)


def test_the_same_sheet_in_codes_or_electrons_dB_or_bits_percent_or_fraction_is_the_same_pixel():
    # 8 e- x 0.25 = 2 DN; 1/K = 4 e-/DN; SNR 100 = 6.6439 bit
    again = {k: v for k, v in SHEET.items() if k not in ("K", "DSNU")} | {
        "1/K": (4.0, "e-/DN"),
        "sigma_d": (2.0, "DN"),
        "DSNU": (0.375, "DN"),
        "PRNU": (0.005, "1"),
        "QE": (0.6, "1"),
        "SNR_max": (6.6439, "bit"),
        "dark current": (16.0, "e-/s"),
    }
    assert pixel_from_emva(again) == pixel_from_emva(SHEET)
    assert pixel_from_emva(SHEET | {"K": (4.0, "e-/DN")}) == pixel_from_emva(SHEET)


@pytest.mark.parametrize(
    "form",
    [
        "{name} = {number} {unit}",
        "{name}: {number} [{unit}]",
        "{name} [{unit}] = {number}",
        "{name},{number},{unit}",
        "{name};{number};{unit}",
        "{name}\t{number}\t{unit}  # said the maker",
    ],
)
def test_every_way_to_type_a_sheet_is_read_alike(tmp_path, form):
    path = typed(tmp_path, SHEET, form)
    assert read_emva_sheet(path) == pixel_from_emva(SHEET, source="sheet.txt")


def test_a_sheet_as_json_is_read_alike(tmp_path):
    path = tmp_path / "sheet.json"
    held = {name: {"value": v, "unit": u} for name, (v, u) in SHEET.items()}
    path.write_text(json.dumps(held | {"camera": "any"}), encoding="utf-8")
    assert read_emva_sheet(path) == pixel_from_emva(SHEET, source="sheet.json")


@pytest.mark.parametrize("name", ["σ_d", "sigma_d", "sigma.d", "Temporal dark noise", "Sigma d"])
def test_greek_dots_and_words_name_the_same_value(name):
    assert pixel_from_emva({name: (2.4, "e-")}).read_noise_e == 2.4


@pytest.mark.parametrize(
    ("lines", "where", "value"),
    [
        ("PRNU = 0.5", "line 1, PRNU", ""),
        ("# x\nsigma_d = 2.4 V", "line 2, sigma_d", "V"),
        ("sigma_d = 2,4 e-", "line 1, sigma_d", "4 e-"),
        ("K = about 2", "line 1", "K = about 2"),
        ("sigma_d = 2 DN", "line 1, sigma_d", None),
        ("K = 0 DN/e-", "line 1, K", 0.0),
        ("QE = 130 %", "qe", 1.3),
        ("sigma_d = -2 e-", "line 1, sigma_d", -2.0),
        ("sigma_d = 2 e-\nsigma_d = 3 e-", "line 2", "sigma_d"),
        ("sigma_d = 2 e-\nread noise = 3 e-", "line 2, read noise", 3.0),
        ("camera: Foo\nlinearity = 0.2 %", "", ["linearity"]),
        ("bits = 12.5\nK = 1 DN/e-", "line 1, bits", 12.5),
        ("bits = 20\nK = 1 DN/e-", "bits", 20),
        ("", "", []),
        ('{"K": 0.5}', "K", 0.5),
        ('{"K": {"value": 1', "line 1, column 18", None),
        ("[" * 100_000, "", []),
        ('{"K":' + "[" * 100_000, "", None),
    ],
)
def test_a_sheet_that_cannot_be_used_is_refused_in_one_sentence(file, lines, where, value):
    path = file(lines, "sheet.txt")
    with refused_input(subject=str(path), where=where, value=value):
        read_emva_sheet(path)


def test_what_a_sheet_leaves_out_is_said():
    notes = " ".join(pixel_from_emva({"K": (1.0, "DN/e-"), "bits": (10.0, "")}).notes)
    assert "dark current, DSNU, PRNU not given, taken as 0" in notes
    assert "black level not given" in notes


# noise profiles


def of_profile(slope, offset, black_dn, white_dn):
    rows = np.array([[slope, offset]])
    return pixel_from_noise_profile(rows, black_level_dn=black_dn, white_level_dn=white_dn)


def test_the_noise_profile_of_docs_numbers_gives_back_its_gain_and_read_noise():
    # docs/numbers.md: 8 bits, black 55, 2 e-/DN, 10 e-: S = 1/400, O = (25 + 1/12)/200^2
    result = of_profile(0.0025, 6.270833333333e-4, 55, 255)
    assert result.gain_e_per_dn == pytest.approx(2.0, rel=1e-12)
    assert result.read_noise_e == pytest.approx(10.0, rel=1e-11)
    assert result.adc == Adc(bits=8, gain_e_per_dn=result.gain_e_per_dn, black_level_dn=55)
    assert result.full_well_e is None
    assert "400 e- lie between black and white" in result.notes[0]


@given(
    bits=st.integers(8, 16),
    gain=st.floats(0.02, 50.0),
    black=st.integers(0, 200),
    read=st.floats(0.5, 100.0),
)
def test_a_profile_and_its_pixel_are_inverse(bits, gain, black, read):
    adc = Adc(bits=bits, gain_e_per_dn=gain, black_level_dn=black)
    rows = np.tile(noise_profile(adc, read_noise_e=read), (3, 1))
    result = pixel_from_noise_profile(rows, black_level_dn=black, white_level_dn=adc.top_code)
    assert result.gain_e_per_dn == pytest.approx(gain, rel=1e-9)
    # rounding is taken away again: what is left of it is that of double precision
    lost = 1e-12 * (gain / read) ** 2
    assert result.read_noise_e == pytest.approx(read, rel=1e-9 + lost)


def test_codes_drawn_with_a_profile_have_its_variance():
    # another road: Poisson electrons, Gaussian readout, rounding, then S x + O of the codes
    rng = np.random.default_rng(RNG_SEED)
    draws, gain, read, black = 200_000, 2.5, 6.0, 64
    adc = Adc(bits=12, gain_e_per_dn=gain, black_level_dn=black)
    result = of_profile(*noise_profile(adc, read_noise_e=read), black, 4095)
    for electrons in (0.0, 40.0, 4000.0):
        codes = np.rint(
            black + (rng.poisson(electrons, draws) + read * rng.standard_normal(draws)) / gain
        )
        own = (electrons + result.read_noise_e**2) / result.gain_e_per_dn**2 + 1 / 12
        assert abs(codes.var() / own - 1) / np.sqrt(2 / draws) < 5


def test_a_dark_variance_below_that_of_rounding_tells_no_read_noise():
    result = of_profile(1e-3, 1e-9, 0, 1023)
    assert result.read_noise_e is None
    assert any("less than rounding alone makes" in note for note in result.notes)


def test_a_white_level_below_the_top_code_is_told():
    result = of_profile(1e-4, 1e-6, 0, 1000)
    assert result.adc is not None
    assert result.adc.bits == 10
    assert any("top code 1023" in note for note in result.notes)


@pytest.mark.parametrize(
    ("change", "where", "value"),
    [
        ({"S": 0.0}, "S of channel 0", 0.0),
        ({"S": [1e-4, 2e-4], "O": [1e-6, 1e-6]}, "", {"0": 1e-4, "1": 2e-4}),
        ({"S": [1e-4, 1e-4]}, "the number of channels", {"S": 2, "O": 1}),
        ({"white_level_dn": 1e300}, "white level", 1e300),
        ({"white_level_dn": 64}, "white minus black level", 0.0),
        ({"O": "much"}, "O", "much"),
        ({"S": True}, "S", True),
        ({"black_level_dn": [1, 2]}, "black_level_dn", [1.0, 2.0]),
        ({"channels": "RGB"}, "channels", "RGB"),
    ],
)
def test_a_noise_profile_that_cannot_be_used_is_refused(tmp_path, change, where, value):
    path = tmp_path / "p.json"
    held = {"S": 1e-4, "O": 1e-6, "black_level_dn": 64, "white_level_dn": 1023}
    path.write_text(json.dumps(held), encoding="utf-8")
    assert read_noise_profile(path).gain_e_per_dn == pytest.approx(1e4 / 959)
    path.write_text(json.dumps(held | change), encoding="utf-8")
    with refused_input(subject=str(path), where=where, value=value):
        read_noise_profile(path)


# photon transfer

GAIN, READ_E, BLACK = 0.8, 6.0, 100.0
LIGHTS_E = np.array([0.0, 30.0, 100.0, 300.0, 600.0, 1000.0, 1500.0, 2000.0])


def drawn(rng, *, samples=2000, prnu=0.0, lights=LIGHTS_E, full_e=np.inf):
    """Codes of ``samples`` pixels at each light."""
    sensitivity = 1 + prnu * rng.standard_normal(samples)
    rows = []
    for light in lights:
        electrons = rng.poisson(light * sensitivity) + READ_E * rng.standard_normal(samples)
        codes = np.rint(BLACK + GAIN * np.minimum(electrons, full_e))
        rows.append((codes.mean(), codes.var(ddof=1)))
    mean, variance = np.array(rows).T
    return PhotonTransfer(
        mean_dn=mean,
        variance_dn2=variance,
        dark=lights == 0,
        samples=np.full(lights.size, float(samples)),
        spatial=True,
    )


def test_drawn_codes_give_back_gain_and_read_noise_within_honest_standard_errors():
    rng = np.random.default_rng(RNG_SEED)
    repeats = 120
    fits = [photon_transfer_fit(drawn(rng)) for _ in range(repeats)]
    gain = np.array([(f.gain_dn_per_e - GAIN) / f.gain_se for f in fits])
    read = np.array([(f.read_noise_e - READ_E) / f.read_noise_se for f in fits])
    chi2 = np.array([f.chi2_per_row for f in fits])
    for z in (gain, read):
        assert abs(z.mean()) < 5 / np.sqrt(repeats)
        assert abs(z.var() - 1) < 5 * np.sqrt(2 / repeats)
    # free: 8 rows less 2 terms; the mean of chi^2 per degree has the variance 2/free/repeats
    assert abs(chi2.mean() - 1) < 5 * np.sqrt(2 / 6 / repeats)


def test_a_pattern_of_sensitivities_bends_the_variance_up_by_its_square():
    rng = np.random.default_rng(RNG_SEED + 1)
    lights = np.array([0.0, 200.0, 1000.0, 3000.0, 8000.0, 20_000.0])
    fits = [photon_transfer_fit(drawn(rng, prnu=0.02, lights=lights)) for _ in range(100)]
    assert all(f.prnu is not None for f in fits)
    # one pattern for all lights makes their errors common, so the scatter is its own judge
    prnu = np.array([f.prnu for f in fits])
    assert abs(prnu.mean() - 0.02) < 5 * prnu.std(ddof=1) / 10
    gain = np.array([f.gain_dn_per_e for f in fits])
    assert abs(gain.mean() - GAIN) < 5 * gain.std(ddof=1) / 10


def test_no_pattern_is_seldom_taken_for_one():
    rng = np.random.default_rng(RNG_SEED + 2)
    found = sum(photon_transfer_fit(drawn(rng)).prnu is not None for _ in range(100))
    assert found <= 4  # 0.135 % of a Gaussian lie beyond three standard errors above


def exact(lights, *, known=True, **more):
    mean = BLACK + GAIN * lights
    return PhotonTransfer(
        mean_dn=mean,
        variance_dn2=GAIN**2 * (lights + READ_E**2) + 1 / 12,
        dark=lights == 0,
        samples=np.full(lights.size, 1e4) if known else None,
        **more,
    )


@pytest.mark.parametrize("known", [True, False])
def test_an_exact_line_is_found_exactly(known):
    fit = photon_transfer_fit(exact(LIGHTS_E, known=known))
    assert fit.gain_dn_per_e == pytest.approx(GAIN, rel=1e-12)
    assert fit.read_noise_e == pytest.approx(READ_E, rel=1e-10)
    assert (fit.prnu, fit.full_well_e, fit.black_dn) == (None, None, BLACK)
    assert any("full well is unknown" in note for note in fit.notes)


def test_without_black_level_the_gain_is_known_and_the_read_noise_is_not():
    fit = photon_transfer_fit(exact(LIGHTS_E[1:]))
    assert fit.gain_dn_per_e == pytest.approx(GAIN, rel=1e-12)
    assert fit.read_noise_e is None
    again = photon_transfer_fit(exact(LIGHTS_E[1:]), black_dn=BLACK)
    assert again.read_noise_e == pytest.approx(READ_E, rel=1e-9)


def test_codes_held_at_full_well_are_left_out_and_tell_the_full_well():
    rng = np.random.default_rng(RNG_SEED + 3)
    lights = np.concatenate([[0.0], np.linspace(500.0, 12_000.0, 24)])
    fit = photon_transfer_fit(drawn(rng, lights=lights, full_e=10_000.0))
    assert abs(fit.gain_dn_per_e - GAIN) < 5 * fit.gain_se
    assert 9_000 < fit.full_well_e < 10_000  # the last light before: steps of 500 e-
    assert not fit.fitted[lights > 7_000].any()
    assert np.abs(fit.residual_z[lights > 10_500]).min() > 5
    source = pixel_from_photon_transfer(fit)
    assert source.full_well_e == fit.full_well_e
    assert source.gain_e_per_dn == 1 / fit.gain_dn_per_e


def test_a_row_far_off_the_line_is_named():
    table = exact(LIGHTS_E)
    variance = table.variance_dn2.copy()
    variance[4] *= 1.3
    odd = PhotonTransfer(
        mean_dn=table.mean_dn, variance_dn2=variance, dark=table.dark, samples=table.samples
    )
    notes = photon_transfer_fit(odd).notes
    assert any(f"row of mean {table.mean_dn[4]:g} DN is +" in note for note in notes)
    assert any("scatter" in note for note in notes)
    assert not any("scatter" in note for note in photon_transfer_fit(table).notes)


def test_a_variance_that_bends_down_is_no_pattern_and_is_told():
    table = exact(LIGHTS_E)
    bent = table.variance_dn2 - 1e-4 * (table.mean_dn - BLACK) ** 2
    fit = photon_transfer_fit(
        PhotonTransfer(mean_dn=table.mean_dn, variance_dn2=bent, dark=table.dark,
                       samples=table.samples)
    )  # fmt: skip
    assert fit.prnu is None
    assert fit.low_light_gain_dn_per_e == pytest.approx(GAIN, rel=1e-9)
    assert fit.high_light_gain_dn_per_e == pytest.approx(GAIN - 2e-4 * 1600, rel=1e-9)
    assert any("bends down" in note for note in fit.notes)


def test_the_reference_code_of_the_standard_finds_the_same_gain_read_noise_and_full_well(
    monkeypatch,
):
    results = pytest.importorskip("emva1288.process.results", reason="needs the package emva1288")
    # emva1288 1.0.2 still calls np.asfarray, which numpy 2 has dropped
    monkeypatch.setattr(np, "asfarray", lambda a: np.asarray(a, dtype=float), raising=False)
    lights = np.linspace(210.0, 10_500.0, 50)
    table = exact(np.concatenate([[0.0], lights]))
    held = table.mean_dn > BLACK + GAIN * 9_900.0
    variance = np.where(held, 0.01, table.variance_dn2)
    ours = photon_transfer_fit(
        PhotonTransfer(mean_dn=table.mean_dn, variance_dn2=variance, dark=table.dark)
    )
    same = np.ones(lights.size)
    temporal = {
        "texp": 1e6 * same,
        "u_p": lights / 0.5,
        "u_y": table.mean_dn[1:],
        "s2_y": variance[1:],
        "u_ydark": BLACK * same,
        "s2_ydark": variance[0] * same,
    }
    theirs = results.Results1288({"temporal": temporal, "spatial": {}}, pixel_area=100.0)
    assert ours.gain_dn_per_e == pytest.approx(theirs.K, rel=1e-9)
    assert ours.read_noise_e == pytest.approx(theirs.sigma_d, rel=1e-9)
    assert ours.full_well_e == pytest.approx(theirs.u_e_sat, rel=1e-9)
    sheet = {
        "K": (theirs.K, "DN/e-"),
        "QE": (theirs.QE, "%"),
        "sigma_d": (theirs.sigma_d, "e-"),
        "u_e.sat": (theirs.u_e_sat, "e-"),
        "u_e.min": (theirs.u_e_min, "e-"),
        "u_p.min": (theirs.u_p_min, "p"),
        "u_p.sat": (theirs.u_p_sat, "p"),
        "DR": (theirs.DR_dB(), "dB"),
        "SNR_max": (theirs.SNR_max_bit(), "bit"),
        "sigma_y.dark": (theirs.sigma_y_dark, "DN"),
    }
    assert disagreements(pixel_from_emva({k: (float(v), u) for k, (v, u) in sheet.items()})) == []


@settings(max_examples=25)
@given(scale=st.floats(1.0, 100.0), order=st.permutations(range(LIGHTS_E.size)))
def test_neither_the_order_of_rows_nor_the_unit_of_codes_changes_the_electrons(scale, order):
    rng = np.random.default_rng(RNG_SEED + 4)
    table = drawn(rng)
    first = photon_transfer_fit(table)
    rows = list(order)
    again = photon_transfer_fit(
        PhotonTransfer(
            mean_dn=scale * table.mean_dn[rows],
            variance_dn2=scale**2 * (table.variance_dn2[rows] - 1 / 12) + 1 / 12,
            dark=table.dark[rows],
            samples=table.samples[rows],
        )
    )
    # rounding stays one code, so weights differ a little
    assert again.read_noise_e == pytest.approx(first.read_noise_e, abs=first.read_noise_se)
    assert again.gain_dn_per_e == pytest.approx(scale * first.gain_dn_per_e, rel=1e-2)


def test_a_photon_transfer_is_read_from_csv_to_the_digit(tmp_path):
    path = tmp_path / "transfer.csv"
    table = drawn(np.random.default_rng(RNG_SEED + 5))
    rows = zip(table.mean_dn, table.variance_dn2, table.samples, table.dark, strict=True)
    lines = [f"{m!r},{v!r},{int(n)},{'dark' if d else 'light'}" for m, v, n, d in
             ((float(m), float(v), n, d) for m, v, n, d in rows)]  # fmt: skip
    text = "# one gain\nmean_dn,variance_dn2,samples,light\n" + "\n".join(lines)
    path.write_text(text, encoding="utf-8")
    read = read_photon_transfer_csv(path)
    assert np.array_equal(read.mean_dn, table.mean_dn)
    assert np.array_equal(read.variance_dn2, table.variance_dn2)
    assert np.array_equal(read.dark, table.dark)
    assert np.array_equal(read.samples, table.samples)


def test_a_variance_that_does_not_grow_is_no_photon_transfer():
    x = np.array([0.0, 1.0, 2.0, 3.0])
    for variance in (4 - x, 0 * x, 0 * x + 1):
        table = PhotonTransfer(mean_dn=x, variance_dn2=variance, dark=x == 0)
        with refused_input(subject="photon transfer", requirement="grows|below 70 %"):
            photon_transfer_fit(table)


def test_two_black_levels_or_one_above_the_codes_are_refused():
    with refused_input(subject="black_dn", value=99.0):
        photon_transfer_fit(exact(LIGHTS_E), black_dn=99.0)
    with refused_input(subject="black_dn", value=1000.0):
        photon_transfer_fit(exact(LIGHTS_E[1:]), black_dn=1000.0)


# darktable


def profiles(tmp_path, entries):
    path = tmp_path / "noiseprofiles.json"
    held = {
        "version": 0,
        "noiseprofiles": [
            {"maker": "Canon", "models": [{"model": "EOS-1Ds", "profiles": entries}]}
        ],
    }
    path.write_text(json.dumps(held), encoding="utf-8")
    return path


# darktable, data/noiseprofiles.json, EOS-1Ds at ISO 50
REAL = {
    "name": "EOS-1Ds iso 50",
    "iso": 50,
    "a": [4.51315201045946e-06, 2.15965916027681e-06, 3.18527773445627e-06],
    "b": [2.58737644842453e-08, 2.09817875966987e-08, 2.68411852737342e-08],
}


def test_a_real_profile_with_a_full_well_gives_the_read_noise_of_such_a_camera(tmp_path):
    noise = read_darktable_noise(profiles(tmp_path, [REAL]), maker="Canon", model="EOS-1Ds", iso=50)
    # cameras of 2002 read out with some tens of electrons; 1/a of green would be 463,000 e-
    assert 10 < pixel_from_darktable(noise, full_well_e=80_000.0).read_noise_e < 50
    assert any("neither gain nor full well" in note for note in noise.notes)


def test_a_relative_profile_alone_makes_no_pixel(tmp_path):
    noise = read_darktable_noise(profiles(tmp_path, [REAL]), maker="Canon", model="EOS-1Ds", iso=50)
    adc = Adc(bits=12, gain_e_per_dn=20.0, black_level_dn=95)
    profile = "the noise profile of Canon EOS-1Ds at ISO 50"
    with refused_input(subject=profile, setting="full_well_e"):
        pixel_from_darktable(noise)
    with refused_input(subject=profile, value=(1e4, adc)):
        pixel_from_darktable(noise, full_well_e=1e4, adc=adc)
    by_gain = pixel_from_darktable(noise, adc=adc)
    assert by_gain == pixel_from_darktable(noise, full_well_e=80_000.0).__class__(
        source=by_gain.source,
        full_well_e=80_000.0,
        read_noise_e=by_gain.read_noise_e,
        gain_e_per_dn=20.0,
        adc=adc,
        notes=by_gain.notes,
    )


@given(factor=st.floats(1e-3, 1e3), read=st.floats(0.1, 100.0), well=st.floats(1e3, 1e6))
def test_the_unknown_factor_of_a_profile_does_not_reach_the_read_noise(factor, read, well):
    # variance of electrons E x + read^2, over E^2, times whatever darktable's filters made of it
    noise = RelativeNoise(
        camera="any",
        iso=100,
        a=np.full(3, factor / well),
        b=np.full(3, factor * read * read / well / well),
    )
    result = pixel_from_darktable(noise, full_well_e=well)
    assert result.read_noise_e == pytest.approx(read, rel=1e-12)


def test_a_negative_b_tells_no_read_noise_and_doubles_are_told(tmp_path):
    entry = REAL | {"b": [1e-8, -1e-9, 1e-8]}
    path = profiles(tmp_path, [entry, REAL])
    noise = read_darktable_noise(path, maker="Canon", model="EOS-1Ds", iso=50)
    assert any("2 profiles of ISO 50" in note for note in noise.notes)
    result = pixel_from_darktable(noise, full_well_e=1e4)
    assert result.read_noise_e is None
    assert any("b of green is negative" in note for note in result.notes)


@pytest.mark.parametrize(
    ("name", "value", "nearest"),
    [("maker", "Cannon", "Canon"), ("model", "EOS-1D", "EOS-1Ds"), ("iso", 75, "50")],
)
def test_a_camera_that_is_not_there_brings_the_nearest(tmp_path, name, value, nearest):
    asked = {"maker": "Canon", "model": "EOS-1Ds", "iso": 50, name: value}
    with refused_input(subject=name, value=value) as refusal:
        read_darktable_noise(profiles(tmp_path, [REAL]), **asked)
    assert nearest in refusal.value.remedy[0]


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("[]", ""),
        ('{"noiseprofiles": [{"maker": "Canon"}]}', "Canon"),
        ('{"noiseprofiles": 3}', ""),
        ("{", "line 1, column 2"),
    ],
)
def test_another_json_is_not_taken_for_noise_profiles(file, text, where):
    path = file(text, "n.json")
    with refused_input(subject=str(path), where=where):
        read_darktable_noise(path, maker="Canon", model="EOS-1Ds", iso=50)


def test_entries_of_a_profile_that_are_no_three_numbers_are_refused(tmp_path):
    for bad in ([1e-6, 1e-6], [1e-6, 1e-6, None], "a", [1e-6, 1e-6, float("inf")]):
        path = profiles(tmp_path, [REAL | {"a": bad}])
        with refused_input(subject=str(path), where="a of Canon EOS-1Ds at ISO 50", value=bad):
            read_darktable_noise(path, maker="Canon", model="EOS-1Ds", iso=50)


# the forms in which people have them


ROWS = "64,1.5\n164,51.5\n264,101.5\n364,151.5\n"


def test_a_noise_profile_alone_tells_the_read_noise_in_electrons(file):
    # 1 / S = 5000 e- from black to white; sqrt(O) = 0.001 of them
    result = read_noise_profile(file("NoiseProfile: 0.0002 0.000001\n"))
    assert result.read_noise_e == pytest.approx(5.0, rel=1e-12)
    assert result.gain_e_per_dn is None
    assert any("5000 e- lie between" in note for note in result.notes)
    assert any("no BlackLevel" in note for note in result.notes)


def test_with_its_levels_a_noise_profile_tells_the_gain_too(file):
    # docs of DNG: S = 1 / (2 e-/DN * 200 DN); O = (20^2 + 1/12) / 200^2
    pairs = "0.0025 0.0100020833 0.0025 0.0100020833"
    text = f"Noise Profile : {pairs}\nBlack Level: 55 55\nWhiteLevel=255\n"
    message = read_noise_profile(file(text))
    assert message.gain_e_per_dn == pytest.approx(2.0)
    assert message.read_noise_e == pytest.approx(40.0, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "where", "value"),
    [
        ("NoiseProfile: 0.0002\n", "NoiseProfile", 1),
        ("a\nNoiseProfile: 0.0002 low\n", "line 2", "0.0002 low"),
        ("NoiseProfile: 0.0002 1e-6\nBlackLevel: 64\n", "WhiteLevel", None),
        ("NoiseProfile: 2e-4 1e-6\nBlackLevel: 6 7\nWhiteLevel: 9", "BlackLevel", [6.0, 7.0]),
        ("NoiseProfile: 2e-4 -1e-6\n", "O", -1e-6),
    ],
)
def test_a_noise_profile_that_is_cut_short_is_refused(file, text, where, value):
    assert is_noise_profile_text(text)
    path = file(text)
    with refused_input(subject=str(path), where=where, value=value):
        read_noise_profile(path)


@pytest.mark.parametrize(
    "head", ["mean_dn,variance_dn2", "Mean [DN],Variance [DN^2]", "signal (ADU),var (DN2)"]
)
def test_a_photon_transfer_says_its_units_in_any_of_the_usual_ways(file, head):
    assert is_photon_transfer_text(head)
    table = read_photon_transfer_csv(file(f"{head}\n{ROWS}"))
    assert table.mean_dn.tolist() == [64, 164, 264, 364]
    assert table.variance_dn2.tolist() == [1.5, 51.5, 101.5, 151.5]


def test_a_photon_transfer_without_units_is_asked_for_them(file):
    assert is_photon_transfer_text("mean,variance")
    path = file(f"mean,variance\n{ROWS}")
    with refused_input(subject=str(path), where="line 1", value=["mean", "variance"]):
        read_photon_transfer_csv(path)


def test_a_file_of_no_known_form_is_told_all_forms_with_an_example_each():
    with pytest.raises(InputError) as refused:
        pixel_from_emva({"price": (3.0, "EUR")})
    for example in ("sigma_d = 2.4 e-", "mean_dn,variance_dn2", "NoiseProfile: 0.0002", '"S"'):
        assert example in str(refused.value)


def test_only_a_saturation_capacity_is_said_to_be_taken_for_the_full_well():
    said = pixel_from_emva({"saturation capacity": (9000.0, "e-")}).notes
    assert any("saturation capacity, is taken for the full well" in note for note in said)
    assert not any(
        "taken for the full" in n for n in pixel_from_emva({"full well": (9e3, "e-")}).notes
    )


def test_a_gain_without_bits_has_a_note_that_bits_are_needed():
    alone = pixel_from_emva({"K": (0.5, "DN/e-")}).notes
    assert any("bits not given: the gain of 2 e-/DN" in n for n in alone)
    both = pixel_from_emva({"K": (0.5, "DN/e-"), "bits": (12.0, "")}).notes
    assert not any("bits not given" in n for n in both)


def test_a_known_name_before_a_number_and_a_unit_needs_a_sign_between(file):
    path = file("K = 0.5 DN/e-\nread noise 2.5 e-\n")
    with refused_input(subject=str(path), where="line 2", value="read noise 2.5 e-"):
        read_emva_sheet(path)
    assert read_emva_sheet(file("Camera K 12 of 2020\nsigma_d = 2 e-\n")).bits is None


EMVA_XML = """<?xml version="1.0" ?>
<results>
  <sensitivity>
    <K><short>System gain</short><symbol>K</symbol><unit>$DN/e^-$</unit><value>0.25</value></K>
    <inverse_K><unit>$e^-/DN$</unit><value>4.0</value></inverse_K>
    <QE><symbol>$\\eta$</symbol><unit>\\%</unit><value>61.5</value></QE>
    <sigma_y_dark><unit>DN</unit><value>1.0408</value></sigma_y_dark>
    <sigma_d><unit>$e^-$</unit><value>4.0</value></sigma_d>
    <u_p_sat><unit>$p$</unit><value>20000</value></u_p_sat>
    <u_e_sat><unit>$e^-$</unit><value>12300</value></u_e_sat>
    <SNR_max><unit>None</unit><value>110.9</value></SNR_max>
    <DR><value>2650</value></DR>
  </sensitivity>
  <dark_current>
    <u_I_var><unit>$e^-/s$</unit><value>4.5</value></u_I_var>
    <u_I_mean><unit>$e^-/s$</unit><value>MEAN</value></u_I_mean>
    <u_I_mean_DN><unit>$DN/s$</unit><value>0.9</value></u_I_mean_DN>
  </dark_current>
  <spatial>
    <DSNU1288><unit>$e^-$</unit><value>1.5</value></DSNU1288>
    <PRNU1288><unit>\\%</unit><value>0.5</value></PRNU1288>
  </spatial>
</results>
"""


@pytest.mark.parametrize(("mean", "current"), [("3.6", 3.6), ("nan", 4.5), ("None", 4.5)])
def test_results_of_the_reference_code_are_read_with_their_latex_units(file, mean, current):
    result = read_emva_sheet(file(EMVA_XML.replace("MEAN", mean)))
    assert (result.gain_e_per_dn, result.read_noise_e, result.full_well_e) == (4.0, 4.0, 12300)
    assert (result.qe, result.dsnu_e, result.prnu) == (0.615, 1.5, 0.005)
    assert result.dark_current_e_per_s == current
    assert any("u_I_var" in note for note in result.notes) == (mean == "3.6")


@pytest.mark.parametrize("unit", ["$e^-/s$", "e^-/s", r"$e^{-}/s$", "e-/s", "e⁻/s"])
def test_a_unit_means_the_same_in_latex(unit):
    assert pixel_from_emva({"mu_I": (3.0, unit)}).dark_current_e_per_s == 3.0
