"""The forms in which a pixel comes: what people have is read, or told how to write."""

import pytest

from chromanoise.base.errors import InputError
from chromanoise.io.pixels import read_emva_sheet, read_noise_profile
from chromanoise.io.pixels.emva import pixel_from_emva
from chromanoise.io.pixels.noise_profiles import is_noise_profile_text
from chromanoise.io.pixels.photon_transfer_csv import (
    is_photon_transfer_text,
    read_photon_transfer_csv,
)
from outcomes import refused_input

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
