"""Photon transfer by EMVA 1288: standard errors, bends, dark rows, photons, files."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.base.errors import InputError
from chromanoise.io.pixels.photon_transfer_csv import (
    is_photon_transfer_text,
    read_photon_transfer_csv,
)
from chromanoise.sensor.photon_transfer import photon_transfer_fit, pixel_from_photon_transfer
from chromanoise.sensor.photon_transfer_regression import PhotonTransfer
from outcomes import refused_input

PIXELS = 1500
QE = 0.55


def camera(rng, *, gain, read_e, offset_dn=100.0, bend=0.0, dark_e_per_ms=0.0, levels=24, **more):
    """Two frames of each level and of its dark, by plain Poisson and Gaussian draws.

    ``bend`` is the share by which the gain of the last electron falls at 10,000 e-.
    """
    photons = np.linspace(0.0, 10_500.0 / QE, levels + 1)
    time_ms = np.full(photons.size, 10.0)
    if dark_e_per_ms:
        time_ms = np.linspace(1.0, 50.0, photons.size)
    rows = []
    for p, t in zip(photons[1:], time_ms[1:], strict=True):
        dark_e = dark_e_per_ms * t
        both = (frames(rng, e, gain, read_e, offset_dn, bend) for e in (p * QE + dark_e, dark_e))
        rows.append(list(both))
    if not dark_e_per_ms:  # one dark for all
        rows = [[lit, rows[0][1]] for lit, _ in rows]
    (mean, variance), (dark_mean, dark_variance) = np.moveaxis(np.array(rows), 0, -1)
    return PhotonTransfer(
        mean_dn=mean,
        variance_dn2=variance,
        dark=np.zeros(levels, dtype=bool),
        samples=np.full(levels, float(PIXELS)),
        dark_mean_dn=dark_mean,
        dark_variance_dn2=dark_variance,
        photons=photons[1:],
        time_ms=time_ms[1:] if dark_e_per_ms else None,
        **more,
    )


def frames(rng, mean_e, gain, read_e, offset_dn, bend):
    """Mean of two frames, and half the variance of their difference."""
    electrons = rng.poisson(mean_e, (2, PIXELS)) + read_e * rng.standard_normal((2, PIXELS))
    electrons = np.minimum(electrons, 10_000.0)
    a, b = np.rint(offset_dn + gain * electrons * (1 - 0.5 * bend * electrons / 10_000.0))
    return (a.mean() + b.mean()) / 2, (a - b).var(ddof=1) / 2


def bent_line(fitted, *, gain, read_e, bend):
    """Slope through the origin over the levels of `camera` that were fitted, by quadrature."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(9)
    mean_e = np.linspace(0.0, 10_500.0, fitted.size + 1)[:, None]
    electrons = mean_e + np.sqrt(mean_e + read_e**2) * nodes
    codes = gain * electrons * (1 - 0.5 * bend * electrons / 10_000.0)
    weights = weights / weights.sum()
    mean = codes @ weights
    variance = (codes - mean[:, None]) ** 2 @ weights
    x, y = ((of[1:] - of[0])[fitted] for of in (mean, variance))
    return np.linalg.lstsq(x[:, None], y, rcond=None)[0][0]


def table_of(mean_dn, variance_dn2, *, dark=None, samples=None, **more):
    """A table; where ``dark`` is not given, the lowest mean is that of the dark."""
    mean_dn = np.asarray(mean_dn, dtype=float)
    return PhotonTransfer(
        mean_dn=mean_dn,
        variance_dn2=np.asarray(variance_dn2, dtype=float),
        dark=mean_dn == mean_dn.min() if dark is None else dark,
        samples=None if samples is None else np.full(mean_dn.size, float(samples)),
        **more,
    )


# errors


@pytest.mark.evidence
def test_standard_errors_of_200_linear_cameras_are_those_of_their_scatter():
    rng = np.random.default_rng(1)
    z = {"K": [], "sigma_d": [], "qe": [], "bend": []}
    for _ in range(200):
        gain, read = rng.uniform(0.3, 2.0), rng.uniform(3.0, 20.0)
        fit = photon_transfer_fit(camera(rng, gain=gain, read_e=read))
        z["K"].append((fit.gain_dn_per_e - gain) / fit.gain_se)
        z["sigma_d"].append((fit.read_noise_e - read) / fit.read_noise_se)
        z["qe"].append((fit.qe - QE) / fit.qe_se)
        z["bend"].append(fit.bend_z)
    for name, values in z.items():
        assert 0.9 < np.std(values, ddof=1) < 1.1, name  # the standard error of this ratio is 0.05
        assert abs(np.mean(values)) < 5 / np.sqrt(200), name


def test_dark_rows_at_each_exposure_time_give_dark_current_and_read_noise_at_time_0():
    rng = np.random.default_rng(2)
    fits = [
        photon_transfer_fit(camera(rng, gain=0.8, read_e=8.0, dark_e_per_ms=4.0)) for _ in range(60)
    ]
    for name, error, truth in (
        ("gain_dn_per_e", "gain_se", 0.8),
        ("read_noise_e", "read_noise_se", 8.0),
        ("dark_current_e_per_s", "dark_current_se", 4000.0),
        ("qe", "qe_se", QE),
    ):
        z = np.array([(getattr(f, name) - truth) / getattr(f, error) for f in fits])
        assert abs(z.mean()) < 5 / np.sqrt(60), name
        assert abs(z.std(ddof=1) - 1) < 5 / np.sqrt(120), name
    assert np.mean([f.black_dn for f in fits]) == pytest.approx(100.0, abs=0.05)


def test_a_camera_whose_gain_falls_is_reported_as_bent_with_its_slopes_at_both_ends():
    # code = K e (1 - b e / 2 / 10,000): its slope at e is K (1 - b e / 10,000), so that the
    # variance over the mean, K^2 (1 - b u)^2 e, begins with the slope K
    rng = np.random.default_rng(3)
    bent = [photon_transfer_fit(camera(rng, gain=0.8, read_e=8.0, bend=0.3)) for _ in range(60)]
    assert all(f.bend_z < -3 for f in bent)
    line = np.array([bent_line(f.fitted, gain=0.8, read_e=8.0, bend=0.3) for f in bent])
    off = np.array([f.gain_dn_per_e for f in bent]) - line
    assert abs(off.mean()) < 5 * off.std(ddof=1) / np.sqrt(60)
    assert off.std(ddof=1) < 0.02 * 0.8
    assert line.max() < 0.9 * 0.8  # the slope at low light is another number
    assert all(
        f.high_light_gain_dn_per_e < f.gain_dn_per_e < f.low_light_gain_dn_per_e for f in bent
    )
    low = np.array([(f.low_light_gain_dn_per_e - 0.8) / f.low_light_gain_se for f in bent])
    assert abs(low.std(ddof=1) - 1) < 5 / np.sqrt(120)
    assert all(f.prnu is None for f in bent)
    assert all(any("bends down" in note for note in f.notes) for f in bent)
    straight = photon_transfer_fit(camera(rng, gain=0.8, read_e=8.0))
    assert abs(straight.bend_z) < 3
    assert not any("bends" in note for note in straight.notes)


# saturation


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("shares", [[0.9], [0.7], [0.55], [0.45], [0.9, 0.898, 0.897, 0.899]])
def test_rows_beyond_the_maximum_of_the_variance_are_saturated_however_little_they_fall(
    shares, known
):
    # K = 0.5 DN/e-, 20 lit rows to 2000 DN above the dark of 64 DN, then saturated ones
    x = np.linspace(0.0, 2000.0, 21)
    variance = np.append(4 + 1 / 12 + 0.5 * x, np.multiply(shares, 4 + 1 / 12 + 1000.0))
    x = np.append(x, 2040.0 + np.arange(len(shares)))
    fit = photon_transfer_fit(table_of(64 + x, variance, samples=1e6 if known else None))
    assert fit.gain_dn_per_e == pytest.approx(0.5, rel=1e-12)
    assert (fit.saturation_dn, fit.full_well_e) == pytest.approx((2064.0, 4000.0))
    assert abs(fit.bend_z) < 3
    assert x[fit.fitted].max() == 1400.0


def test_scatter_of_the_brightest_rows_is_no_saturation():
    # 1000 samples: a variance scatters by 4.5 %, rows 5 % apart
    rng = np.random.default_rng(4)
    x = np.linspace(0.0, 2000.0, 21)
    for _ in range(50):
        scatter = 1 + np.sqrt(2 / 999) * rng.standard_normal(x.size)
        table = table_of(64 + x, (4 + 1 / 12 + 0.5 * x) * scatter, samples=1000)
        assert photon_transfer_fit(table).full_well_e is None


# the table


def exact(light, **more):
    """K = 0.5 DN/e-, QE = 0.5, sigma_d = 6 e-, black 64: 0.25 DN and 0.125 DN^2 per photon."""
    signal = 0.25 * light
    return table_of(64 + signal, 9 + 1 / 12 + 0.5 * signal, **more)


PHOTONS = np.array([0.0, 400.0, 1000.0, 2000.0, 4000.0, 8000.0])


def test_photons_give_the_quantum_efficiency_of_the_pixel():
    fit = photon_transfer_fit(exact(PHOTONS, photons=PHOTONS))
    assert (fit.qe, fit.gain_dn_per_e) == pytest.approx((0.5, 0.5), rel=1e-12)
    assert pixel_from_photon_transfer(fit).qe == fit.qe
    assert photon_transfer_fit(exact(PHOTONS)).qe is None


def test_photons_fewer_than_electrons_are_refused():
    with refused_input(where="column 'photons'", value=pytest.approx(2.0)):
        photon_transfer_fit(exact(PHOTONS, photons=PHOTONS / 4))


def test_only_a_column_named_spatial_variance_gives_prnu():
    # PRNU of 1 % adds (0.01 signal)^2: x^2 of the codes
    plain = exact(PHOTONS, samples=1e5)
    bent = replace(plain, variance_dn2=plain.variance_dn2 + (0.01 * (plain.mean_dn - 64)) ** 2)
    fit = photon_transfer_fit(replace(bent, spatial=True))
    assert (fit.prnu, fit.gain_dn_per_e) == pytest.approx((0.01, 0.5), rel=1e-6)
    temporal = photon_transfer_fit(bent)
    assert temporal.prnu is None
    assert temporal.low_light_gain_dn_per_e == pytest.approx(0.5, rel=1e-6)
    assert temporal.high_light_gain_dn_per_e == pytest.approx(0.5 + 2e-4 * 2000, rel=1e-6)
    # y = 0.5 x + 1e-4 x^2, so that the slope through the origin is 0.5 + 1e-4 sum x^3 / sum x^2
    x = 0.25 * PHOTONS
    assert temporal.gain_dn_per_e == pytest.approx(0.5 + 1e-4 * (x**3).sum() / (x**2).sum())


def test_lit_rows_use_the_dark_rows_of_the_same_exposure_time():
    # dark: 64 DN + 2 DN/ms = 4 e-/ms; its shot noise adds 4 e-/ms, 1 DN^2/ms
    time = np.array([1.0, 2.0, 4.0, 8.0])
    lit = 0.25 * np.array([500.0, 1000.0, 2000.0, 4000.0])
    dark_mean, dark_variance = 64 + 2 * time, 9 + 1 / 12 + time
    rows = table_of(
        [*dark_mean, *(dark_mean + lit)],
        [*dark_variance, *(dark_variance + 0.5 * lit)],
        dark=np.arange(8) < 4,
        time_ms=np.concatenate([time, time]),
    )
    columns = table_of(
        dark_mean + lit,
        dark_variance + 0.5 * lit,
        dark=np.zeros(4, dtype=bool),
        time_ms=time,
        dark_mean_dn=dark_mean,
        dark_variance_dn2=dark_variance,
    )
    for fit in (photon_transfer_fit(rows), photon_transfer_fit(columns)):
        found = (fit.gain_dn_per_e, fit.read_noise_e, fit.dark_current_e_per_s, fit.black_dn)
        assert found == pytest.approx((0.5, 6.0, 4000.0, 64.0), rel=1e-9)
    pixel = pixel_from_photon_transfer(photon_transfer_fit(rows))
    assert pixel.dark_current_e_per_s == pytest.approx(4000.0)
    with refused_input(where="column 'time_ms'", value=3.0):
        photon_transfer_fit(replace(rows, time_ms=np.concatenate([time, [1.0, 2.0, 4.0, 3.0]])))


def test_a_dark_variance_of_quantization_gives_an_upper_limit_of_the_read_noise():
    x = np.array([0.0, 100.0, 200.0, 400.0])
    fit = photon_transfer_fit(table_of(x, 0.1 + 0.5 * x))
    # EMVA 1288 writes 0.40 / K
    assert (fit.read_noise_e, fit.read_noise_se) == (pytest.approx(0.40 / 0.5, rel=0.02), None)
    assert any("upper limit" in note for note in fit.notes)


def timed(dark_mean, dark_variance, *, dark_ms=(1.0, 2.0, 3.0), lit_ms=(1.0, 2.0, 3.0)):
    """Dark rows at three times, and lit rows 200, 400 and 800 DN above them with K = 0.5 DN/e-."""
    lit = np.array([200.0, 400.0, 800.0])
    return table_of(
        [*dark_mean, *(dark_mean + lit)],
        [*dark_variance, *(dark_variance + 0.5 * lit)],
        dark=np.arange(6) < 3,
        samples=1e6,
        time_ms=np.array([*dark_ms, *lit_ms]),
    )


@pytest.mark.parametrize("seed", range(20))
def test_without_a_dark_the_upper_limit_of_the_read_noise_includes_the_error_of_the_line(seed):
    """Read noise of 3 e-, i.e. 0.9 DN, below the shot noise of all rows."""
    rng, n = np.random.default_rng(seed), 4000
    x = np.linspace(100.0, 2000.0, 12)
    true = 0.81 + 1 / 12 + 0.3 * x
    drawn = true * (1 + np.sqrt(2 / (n - 1)) * rng.standard_normal(x.size))
    table = table_of(x, np.maximum(drawn, 0.1), dark=x < 0, samples=n)
    fit = photon_transfer_fit(table, black_dn=0.0)
    if fit.read_noise_se is None:
        assert fit.read_noise_e > 3.0
    else:
        variance_se = 2 * fit.read_noise_e * fit.read_noise_se
        assert abs(fit.read_noise_e**2 - 9.0) < 4 * variance_se


def test_a_dark_variance_extrapolated_below_0_is_replaced_by_that_of_the_shortest_time():
    # a line over 1, 2, 9 DN^2 at 1, 2, 3 ms is -4 DN^2 at 0 ms
    fit = photon_transfer_fit(timed(64 + np.arange(3.0), np.array([1.0, 2.0, 9.0])))
    assert fit.gain_dn_per_e == pytest.approx(0.5, rel=1e-9)
    assert fit.read_noise_e == pytest.approx(np.sqrt(1 - 1 / 12) / 0.5, rel=1e-9)
    assert fit.read_noise_se is None  # an upper limit
    assert any("-4 DN^2" in note and "shortest" in note for note in fit.notes)
    assert not any("quantization" in note for note in fit.notes)


def test_a_dark_mean_that_falls_with_the_exposure_time_is_named():
    # -1 DN/ms over 0.5 DN/e- is -2000 e-/s
    fit = photon_transfer_fit(timed(64 - np.arange(3.0), np.full(3, 4.0)))
    assert fit.dark_current_e_per_s is None
    assert any("-2000" in note for note in fit.notes)


def test_a_dark_row_within_1_percent_of_an_exposure_time_is_its_dark():
    means, variances = 64 + np.arange(3.0), 4 + np.arange(3.0)
    for dark_ms in ((1.009, 2.01, 3.02), (0.991, 1.99, 2.98)):
        fit = photon_transfer_fit(timed(means, variances, dark_ms=dark_ms))
        assert fit.gain_dn_per_e == pytest.approx(0.5, rel=1e-9)
    with refused_input(where="column 'time_ms'", value=2.0):
        photon_transfer_fit(timed(means, variances, dark_ms=(1.0, 2.03, 3.0)))


def test_a_quantum_efficiency_above_1_within_its_error_leaves_the_gain():
    # 1.002 electrons per photon, and rows of 1000 samples: K is uncertain by about 2 %
    table = exact(PHOTONS, photons=PHOTONS / 2 / 1.002, samples=1e3)
    fit = photon_transfer_fit(table)
    assert (fit.gain_dn_per_e, fit.qe) == pytest.approx((0.5, 1.002))
    assert 0.002 < fit.qe_se < 0.05
    assert any("1.002" in note for note in fit.notes)
    pixel = pixel_from_photon_transfer(fit)
    assert pixel.qe is None
    assert pixel.gain_e_per_dn == pytest.approx(2.0)
    with refused_input(where="column 'photons'", value=pytest.approx(1.002)):
        photon_transfer_fit(replace(table, samples=np.full(PHOTONS.size, 1e9)))


@pytest.mark.parametrize(
    ("mean", "variance", "samples"),
    [
        ([64, 64 + 1e-8, 64 + 2e-8, 64 + 4e-8], [1, 2, 3, 4], 1e4),
        ([1e9, 1e9, 1e9 + 1e-6, 1e9], [1, 2, 3, 4], 1e4),
        ([64, 164, 264, 364], [0, 0, 0, 0], 1e4),
        ([64, 164, 264, 364], [0, 0, 0, 10], 1e12),
        ([64, 164, 264, 364], [1, 51, 101, 151], 1e12),
        ([64, 164, 164, 164], [1, 51, 0, 1e18], 2.0),
    ],
)
@pytest.mark.parametrize("known", [True, False])
def test_a_degenerate_table_gives_numbers_or_one_sentence(mean, variance, samples, known):
    for dark in (np.arange(4) < 1, np.zeros(4, dtype=bool)):
        try:
            table = table_of(mean, variance, dark=dark, samples=samples if known else None)
            fit = photon_transfer_fit(table)
        except InputError as error:
            assert "\n" not in str(error)  # noqa: PT017
        else:
            assert np.isfinite([fit.gain_dn_per_e, fit.gain_se, *fit.residual_z]).all()


# files


ROWS = [
    (64.0, 9.25, "dark"),
    (564.5, 259.5, "light"),
    (1064.0, 509.25, "light"),
    (4095.0, 2024.75, "light"),
]


@pytest.mark.parametrize("sign", [",", ";", "\t", " "])
@pytest.mark.parametrize("comma", [False, True])
def test_every_delimiter_and_decimal_sign_gives_the_same_table(file, sign, comma):
    if sign == "," and comma:
        return  # a comma parts cells or fractions, not both
    lines = [sign.join(["mean_dn", "variance_dn2", "light"])]
    lines += [sign.join(map(str, row)).replace(".", "," if comma else ".") for row in ROWS]
    path = file("# a bench\n" + "\n".join(lines), "t.csv")
    assert is_photon_transfer_text(path.read_text())
    table = read_photon_transfer_csv(path)
    assert table.mean_dn.tolist() == [row[0] for row in ROWS]
    assert table.variance_dn2.tolist() == [row[1] for row in ROWS]
    assert table.dark.tolist() == [True, False, False, False]


def test_all_columns_of_a_table_are_read(file):
    path = file(
        "Mean [DN];Spatial variance [DN^2];dark mean [DN];dark_variance_dn2;Exposure time [ms];"
        "photons per pixel;samples;operator\n"
        "100,5;20;64;1,5;1;500;1000;A\n200;70;65;2;2;1500;1000;B\n300;120;66;2,5;3;2500;1000;B\n",
        "t.csv",
    )
    table = read_photon_transfer_csv(path)
    assert table.spatial
    assert table.dark_mean_dn.tolist() == [64, 65, 66]
    assert table.dark_variance_dn2.tolist() == [1.5, 2, 2.5]
    assert table.time_ms.tolist() == [1, 2, 3]
    assert table.photons.tolist() == [500, 1500, 2500]
    assert table.samples.tolist() == [1000] * 3
    assert any("operator" in note for note in photon_transfer_fit(table).notes)


def test_a_row_with_0_photons_is_dark(file):
    path = file(
        "mean_dn,variance_dn2,photons\n64,9,0\n164,59,400\n264,109,800\n364,159,1200\n", "t.csv"
    )
    fit = photon_transfer_fit(read_photon_transfer_csv(path))
    assert (fit.black_dn, fit.gain_dn_per_e, fit.qe) == pytest.approx((64, 0.5, 0.5))


HEAD, CELL = "mean_dn,variance_dn2", "line 2, column 'variance_dn2'"


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        (f"{HEAD}\n1,5,2,0\n", {"where": "line 2", "value": 4}),
        (f"{HEAD}\n1,x\n", {"where": CELL, "value": "x"}),
        (f"{HEAD}\n1,nan\n", {"where": CELL, "value": "nan"}),
        (f"{HEAD}\n1,2\n2,3\n", {"where": "", "value": 2}),
        (f"{HEAD}\n", {"where": "", "value": 0}),
        ("", {"where": "", "value": 0}),
        (f"{HEAD},light\n1,2,dim\n", {"where": "line 2, column 'light'", "value": "dim"}),
        (f"{HEAD},samples\n1,2,1\n2,3,1\n3,4,1\n", {"where": "column 'samples'", "value": 1.0}),
        (f"{HEAD}\n1,2\n2,-3\n3,4\n", {"where": "variance_dn2", "value": -3.0}),
        (f"{HEAD}\n1,2\n2,3\n1e29,4\n", {"where": "largest |mean_dn|", "value": 1e29}),
        (f"{HEAD}\n1,2\n2,3\n4,1e30\n", {"where": "largest variance_dn2", "value": 1e30}),
        ("mean_dn;variance_dn2\n1,5;2\n2.5;3\n3;4\n", {"value": (2, 3)}),  # decimal comma and point
        (f"{HEAD},spatial_variance_dn2\n1,2,3\n", {"where": "line 1"}),
        (f"{HEAD},dark_mean_dn\n1,2,0\n2,3,0\n3,4,0", {"requirement": "dark_variance_dn2"}),
        (
            f"{HEAD},photons,light\n1,2,5,dark\n2,3,6,light\n3,4,7,light",
            {"where": "line 2, column 'light'", "value": "dark"},
        ),
        (f"{HEAD},light\n1,2,dark\n2,3,dark\n3,4,dark", {"requirement": "rows with light"}),
        (f"{HEAD}\n1,2 %\n2,3\n3,4", {"where": CELL, "value": "2 %"}),
        (
            f"{HEAD}\n1,2\n2,3\n3,1e300",
            {"where": "line 4, column 'variance_dn2'", "value": "1e300"},
        ),
    ],
)
def test_a_table_that_contradicts_itself_is_refused_in_one_sentence(file, text, fields):
    path = file(text, "t.csv")
    with refused_input(subject=str(path), **fields):
        photon_transfer_fit(read_photon_transfer_csv(path))
