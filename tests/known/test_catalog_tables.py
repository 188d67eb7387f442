"""The shipped numbers against the files of their sources, read by scipy and numpy alone."""

from pathlib import Path

import numpy as np
import pytest

from chromanoise.spectra import DEFAULT_GRID, Grid, illuminant_named
from chromanoise.spectra.tables import packaged_table

DATA = Path(__file__).parents[3] / "shared" / "data"
needs_sources = pytest.mark.skipif(
    not DATA.exists(), reason="the files of the sources are not beside this checkout"
)


def isetcam(name):
    from scipy.io import loadmat

    result = loadmat(DATA / name)
    wavelength = result["wavelength"].ravel().astype(float)
    return wavelength, result["data"].reshape(wavelength.size, -1)


def text(name, **options):
    table = np.loadtxt(DATA / name, **options)
    return table[:, 0], table[:, 1:2]


def at_points(wavelength, values, at):
    return np.stack([np.interp(at, wavelength, curve) for curve in values.T], axis=1)


def cell_means(wavelength, values, at):
    """Means over 10 nm cells, cut at the table's ends, from a 0.01 nm ladder: another road."""
    means = []
    for center in at:
        half = min(5.0, center - wavelength[0], wavelength[-1] - center)
        ladder = np.linspace(center - half, center + half, 1001)
        means.append([np.trapezoid(np.interp(ladder, wavelength, c)) / 1000 for c in values.T])
    return np.array(means)


SENSORS = {
    "mt9v024-rgbw": lambda: isetcam("sensors/MT9V024_RGBW.mat"),
    "mt9v024-rgb": lambda: isetcam("sensors/MT9V024_RGB.mat"),
    "mt9v024-mono": lambda: isetcam("sensors/MT9V024_Mono.mat"),
    "mt9m131": lambda: isetcam("sensors/AptinaMT9M131.mat"),
    "ar0132at-rgbw": lambda: isetcam("sensors/ar0132atRGBW.mat"),
    "gsense4040bsi": lambda: text("sensors/GSENSE4040BSI.csv", delimiter=",", skiprows=2),
    "ircut-schott": lambda: isetcam("irfilters/irFilter_schott.mat"),
    "lawn": lambda: text("reflectances/BeckmanLawn.txt"),
    "turf-green": lambda: text("reflectances/AstroGreenBaseball.txt"),
    "turf-red": lambda: text("reflectances/AstroRedBaseball.txt"),
    "bare-ground": lambda: text("reflectances/Horse_Trial2.txt"),
    "dark-target": lambda: text("reflectances/DarkTarget_Trial1.txt"),
}
MEANS = {
    "ircut-largan": lambda: isetcam("irfilters/ircf_public.mat"),
    "booth-cwf": lambda: isetcam("illuminants/ill_CWF.mat"),
    "booth-u30": lambda: isetcam("illuminants/ill_U30.mat"),
    "booth-day": lambda: isetcam("illuminants/ill_DAY.mat"),
}


def agrees_to_3_digits(shipped, source):
    digit = 10.0 ** (np.floor(np.log10(np.maximum(source, 1e-12))) - 2)
    assert (np.abs(shipped - source) <= 0.5001 * digit + 1e-12).all()


@needs_sources
@pytest.mark.parametrize("name", SENSORS)
def test_shipped_values_are_those_of_the_source_to_3_digits(name):
    table = packaged_table(name)
    agrees_to_3_digits(table.values, at_points(*SENSORS[name](), table.wavelength_nm))


@needs_sources
@pytest.mark.parametrize("name", MEANS)
def test_shipped_means_are_those_of_the_source(name):
    table = packaged_table(name)
    means = cell_means(*MEANS[name](), table.wavelength_nm)
    if name.startswith("booth"):
        means = means / means.max()
    # the ladder is not exact at the kinks of the source, so two units of the third digit
    np.testing.assert_allclose(table.values, means, rtol=0.006, atol=2e-6)


@needs_sources
def test_shipped_skin_is_the_mean_of_all_and_of_the_tenths_by_brightness():
    wavelength, all_of = isetcam("reflectances/HyspexSkinReflectance.mat")
    assert all_of.shape[1] == 71
    bright = all_of[(wavelength >= 500) & (wavelength <= 650)].mean(axis=0)
    order = np.argsort(bright)
    table = packaged_table("skin")
    for name, chosen in (("mean", order), ("dark", order[:7]), ("light", order[-7:])):
        source = at_points(wavelength, all_of[:, chosen], table.wavelength_nm).mean(axis=1)
        agrees_to_3_digits(table.values[:, table.names.index(name)], source)


@needs_sources
def test_the_white_of_the_mono_mt9v024_differs_from_that_of_the_rgbw_by_0_045():
    _, mono = isetcam("sensors/MT9V024_Mono.mat")
    _, rgbw = isetcam("sensors/MT9V024_RGBW.mat")
    assert np.abs(mono[:, 0] - rgbw[:, 3]).max() == pytest.approx(0.045, abs=5e-4)


@needs_sources
def test_green_of_the_color_mt9v024_exceeds_the_bare_silicon_of_the_mono():
    (at, color), (_, mono) = (isetcam(f"sensors/MT9V024_{v}.mat") for v in ("RGB", "Mono"))
    assert color[at == 540, 1] == pytest.approx(0.617, abs=5e-4)
    assert color[at == 540, 1] > mono[at == 540, 0]


@needs_sources
def test_the_gsense_curve_jumps_between_neighbors_where_its_defects_say():
    wavelength, qe = text("sensors/GSENSE4040BSI.csv", delimiter=",", skiprows=2)
    jumps = np.abs(np.diff(qe[:, 0]))
    wild = wavelength[1:][(jumps > 0.045) & (wavelength[1:] > 600)]
    assert jumps[wavelength[1:] > 600].max() == pytest.approx(0.085, abs=0.006)
    assert wild.min() >= 830
    assert wild.max() <= 980


@needs_sources
def test_the_dark_target_has_a_hump_of_30_percent_at_930_to_970_nm():
    table = packaged_table("dark-target")
    level = np.median(table.values[table.wavelength_nm > 850, 0])
    over = table.wavelength_nm[table.values[:, 0] > 1.05 * level]
    assert (over.min(), over.max()) == (930, 970)
    assert table.values.max() / level - 1 == pytest.approx(0.29, abs=0.02)


def test_leaves_are_dark_in_red_and_bright_in_the_infrared():
    # chlorophyll takes red, and the red edge rises near 700 nm
    lawn = packaged_table("lawn")
    value = dict(zip(lawn.wavelength_nm, lawn.values[:, 0], strict=True))
    assert value[800] > 10 * value[670]
    assert value[550] > value[670]
    steps = np.diff(lawn.values[:, 0])
    assert 690 <= lawn.wavelength_nm[steps.argmax()] <= 730


def test_skin_shows_the_bands_of_blood():
    # oxyhemoglobin absorbs at 542 and 577 nm, with a window between (560 nm)
    skin = packaged_table("skin")
    value = dict(zip(skin.wavelength_nm, skin.values[:, skin.names.index("light")], strict=True))
    assert value[560] > value[540]
    assert value[560] > value[570] or value[560] > value[580]
    assert value[650] > 2 * value[540]


def test_the_white_led_has_the_color_temperature_that_is_told():
    import colour

    light = illuminant_named("led-white", Grid.uniform(360, 780, 1))
    at = light.grid.wavelength_nm
    spectrum = colour.SpectralDistribution(light.irradiance, at)
    uv = colour.UCS_to_uv(colour.XYZ_to_UCS(colour.sd_to_XYZ(spectrum)))
    cct_k, duv = colour.temperature.uv_to_CCT(uv)
    assert cct_k == pytest.approx(4167, abs=2)
    assert duv == pytest.approx(0.0004, abs=1e-4)
    power = light.irradiance / light.irradiance.max()
    assert at[power >= 0.01].max() == 760


def test_halogen_is_a_black_body_of_3200_k():
    import colour

    light = illuminant_named("halogen", DEFAULT_GRID)
    planck = colour.colorimetry.planck_law(DEFAULT_GRID.wavelength_nm * 1e-9, 3200)
    ratio = light.irradiance / planck
    # colour-science's second radiation constant is that of the ITS-90, rounded to 5 digits
    assert np.ptp(ratio) / ratio.mean() < 3e-4
