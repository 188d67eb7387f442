"""Demosaicing: what it must leave alone, how near it comes to the truth, and its noise."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.base.rng import stream
from chromanoise.imaging.demosaic import (
    FilterBank,
    bilinear_filters,
    border_pixels,
    channel_tile,
    demosaicked,
    malvar_filters,
)
from chromanoise.imaging.demosaic_methods import (
    PicturePrior,
    demosaicked_covariance,
    gradient_corrected_filters,
    lmmse_filters,
    noise_power_spectrum,
    picture_prior,
)
from chromanoise.metrics.visual_noise import visual_noise_from_spectrum, visual_noise_of_picture
from chromanoise.noise import Exposure, expected_electrons
from chromanoise.sensor import Mosaic, bayer, rgbw_2x2, rgbw_sparse_4x4
from chromanoise.spectra import DEFAULT_GRID, Scene, colorchecker, equal_energy
from chromanoise.study import sensor_named
from outcomes import refused_input

FABRY_PEROT = Mosaic(tuple(tuple(row) for row in ("abc", "def", "ghi")))
RGB_IR = Mosaic((("R", "G", "B", "G"), ("G", "I", "G", "I"), ("B", "G", "R", "G"), ("G", "I") * 2))
STRIPES = Mosaic((("R", "G", "B"),))
ARRAYS = {
    "Bayer": bayer(),
    "RGBW 2x2": rgbw_2x2(),
    "sparse RGBW": rgbw_sparse_4x4(),
    "Fabry-Perot 3x3": FABRY_PEROT,
    "RGB-IR": RGB_IR,
    "stripes": STRIPES,
}


def prior_of(names, *, likeness=0.9, noise=0.0):
    """Channels of different strength, alike to ``likeness``."""
    p = len(names)
    strength = 1.0 + np.arange(p)
    alike = likeness + (1.0 - likeness) * np.eye(p)
    return PicturePrior(
        names=tuple(names),
        covariance_e2=alike * np.outer(strength, strength),
        noise_e2=np.full(p, noise),
    )


METHODS = {
    "bilinear": lambda mosaic: bilinear_filters(mosaic),
    "gradient-corrected": lambda mosaic: gradient_corrected_filters(
        mosaic, prior=prior_of(mosaic.names, noise=0.1)
    ),
    "LMMSE": lambda mosaic: lmmse_filters(mosaic, prior_of(mosaic.names, noise=0.1)),
}


BANKS = [(name, make(mosaic)) for name, mosaic in ARRAYS.items() for make in METHODS.values()]
BANKS.append(("Bayer", malvar_filters(bayer())))
every_bank = pytest.mark.parametrize(
    "bank", [bank for _, bank in BANKS], ids=[f"{name}, {bank.made_by}" for name, bank in BANKS]
)


def raw_of(picture, mosaic, names):
    """What the mosaic lets through of a picture of all channels."""
    tile = channel_tile(mosaic, names)
    rows, columns = (np.arange(n) % t for n, t in zip(picture.shape, tile.shape, strict=False))
    channel = tile[rows[:, None], columns]
    return np.take_along_axis(picture, channel[..., None], axis=-1)[..., 0]


@st.composite
def mosaics(draw):
    """Any tile up to 4 x 4 of up to four channels."""
    rows, columns = draw(st.integers(1, 4)), draw(st.integers(1, 4))
    letters = st.sampled_from("RGBW")
    return Mosaic(tuple(tuple(draw(letters) for _ in range(columns)) for _ in range(rows)))


# what it leaves alone


@given(mosaics(), st.integers(0, 5), st.integers(0, 5), st.sampled_from(list(METHODS)))
def test_a_uniform_color_comes_out_as_it_is_up_to_the_border(mosaic, more, wider, method):
    bank = METHODS[method](mosaic)
    color = 100.0 * (1.0 + np.arange(len(bank.names)))
    shape = (len(mosaic.pattern) + more, len(mosaic.pattern[0]) + wider)
    flat = np.broadcast_to(color, (*shape, color.size))
    out = demosaicked(raw_of(flat, mosaic, bank.names), bank)
    assert out.shape == flat.shape
    np.testing.assert_allclose(out, flat, rtol=1e-9)


@given(
    mosaics(),
    st.floats(-3, 3),
    st.floats(-3, 3),
    st.sampled_from(["bilinear", "gradient-corrected"]),
)
def test_ramps_come_out_as_they_are_away_from_the_border(mosaic, down, across, method):
    bank = METHODS[method](mosaic)
    y, x = np.mgrid[:27.0, :29.0]
    slope = 1.0 + np.arange(len(bank.names))
    ramp = 50.0 + (down * y + across * x)[..., None] * slope
    out = demosaicked(raw_of(ramp, mosaic, bank.names), bank)
    inner = slice(bank.radius, -bank.radius or None)
    np.testing.assert_allclose(out[inner, inner], ramp[inner, inner], atol=1e-9)


@every_bank
def test_where_a_channel_is_measured_interpolation_keeps_it(bank):
    raw = stream(1).random((13, 14))
    out = demosaicked(raw, bank)
    kept = raw_of(out, bank.mosaic, bank.names)
    if bank.made_by == "LMMSE":  # told of noise, it smooths: less than half way
        assert 0 < np.abs(kept - raw).mean() < 0.5 * raw.std()
    else:
        np.testing.assert_array_equal(kept, raw)


def test_beyond_the_border_lies_the_mirror_image_where_the_period_is_two():
    raw = stream(2).random((7, 8))
    bank = malvar_filters(bayer())
    np.testing.assert_array_equal(raw[border_pixels(raw.shape, bank)], np.pad(raw, 2, "reflect"))


@every_bank
def test_beyond_the_border_each_place_keeps_its_channel(bank):
    ty, tx = bank.kernels.shape[:2]
    rows, columns = border_pixels((ty + 1, 2 * tx + 1), bank)
    for at, period in ((rows.ravel(), ty), (columns.ravel(), tx)):
        wanted = np.arange(at.size) - bank.radius
        np.testing.assert_array_equal(at % period, wanted % period)


# known filters


def test_filters_derived_for_a_bayer_array_come_near_those_that_malvar_fitted_to_photographs():
    """Malvar, He & Cutler, ICASSP (2004), figure 2; the prior knows nothing of photographs."""
    equal = PicturePrior(
        names=("R", "G", "B"),
        covariance_e2=0.95 + 0.05 * np.eye(3),
        noise_e2=np.zeros(3),
    )
    derived = gradient_corrected_filters(bayer(), prior=equal)
    published = gradient_corrected_filters(bayer())
    assert derived.kernels.shape == published.kernels.shape == (2, 2, 3, 5, 5)
    assert 0 < np.abs(derived.kernels - published.kernels).max() < 0.07


def test_white_at_a_red_pixel_of_the_sparse_array_comes_from_its_eight_neighbours():
    """White repeats with 2 x 2: half weight beside, a quarter across the corner, sum 3."""
    bank = bilinear_filters(rgbw_sparse_4x4(), ("R", "G", "B", "W"))
    ring = np.array([[1.0, 2.0, 1.0], [2.0, 0.0, 2.0], [1.0, 2.0, 1.0]]) / 12.0
    np.testing.assert_allclose(bank.kernels[0, 0, 3], np.pad(ring, 2), atol=1e-15)


@pytest.mark.parametrize("mosaic", ARRAYS.values(), ids=ARRAYS)
def test_unbiased_weights_are_those_of_means_of_which_nothing_is_known(mosaic):
    """Another road: plain least squares with the means as variables of a very large variance."""
    prior = prior_of(mosaic.names, noise=0.2)
    bank = lmmse_filters(mosaic, prior)
    side = bank.kernels.shape[-1]
    offsets = [(i, j) for i in range(side) for j in range(side)]
    tile, (ty, tx), p = channel_tile(mosaic, mosaic.names), bank.kernels.shape[:2], len(prior.names)
    place = (ty - 1, tx // 2)
    seen = [
        tile[(place[0] + i - side // 2) % ty, (place[1] + j - side // 2) % tx] for i, j in offsets
    ]
    apart = np.array([[np.hypot(i - k, j - m) for k, m in offsets] for i, j in offsets])
    middle = apart[offsets.index((side // 2, side // 2))]
    covariance, unknown = prior.covariance_e2, 1e5 * np.eye(p)
    pixels = covariance[np.ix_(seen, seen)] * 0.95**apart + unknown[np.ix_(seen, seen)]
    pixels += 0.2 * np.eye(side**2)
    wanted = covariance[:, seen] * 0.95**middle + unknown[:, seen]
    weights = np.linalg.solve(pixels, wanted.T).T
    np.testing.assert_allclose(
        bank.kernels[place].reshape(p, -1), weights, atol=2e-3 * np.abs(weights).max()
    )


# how near it comes


SIDE = 120


def chart_seen(name, level_lux):
    """Electrons of the 24 patches, and the noise at their mean (eq. 7)."""
    sensor = sensor_named(name, DEFAULT_GRID)
    rho = colorchecker(DEFAULT_GRID).values.T
    scene = Scene(illuminant=equal_energy(DEFAULT_GRID), level_lux=level_lux, reflectance=rho)
    electrons = expected_electrons(scene, sensor, Exposure(time_s=0.0119))
    return sensor, electrons, electrons.mean(axis=0) + sensor.pixel.read_noise_e**2


def cloudy(electrons):
    """Colors of the chart in clouds whose amplitude falls as 1/f, as it does in nature."""
    frequency = np.hypot(np.fft.fftfreq(SIDE)[:, None], np.fft.rfftfreq(SIDE))
    amplitude = 1.0 / np.maximum(frequency, 1.0 / SIDE)
    noise = stream(5).standard_normal((len(electrons), SIDE, SIDE))
    clouds = np.fft.irfft2(amplitude * np.fft.rfft2(noise), s=(SIDE, SIDE))
    clouds = clouds / clouds.std() / np.sqrt(len(electrons) - 1)
    return electrons.mean(axis=0) + np.moveaxis(clouds, 0, -1) @ (
        electrons - electrons.mean(axis=0)
    )


def zone_plate(electrons):
    """White and black in ever finer rings, up to 0.45 cycles per pixel."""
    y, x = np.mgrid[:SIDE, :SIDE]
    white = 0.5 + 0.5 * np.cos(0.45 * np.pi / SIDE * (x**2 + y**2))
    return electrons[23] + white[..., None] * (electrons[18] - electrons[23])


def slanted_squares(electrons):
    """Patches of the chart side by side, turned by 0.2 rad."""
    y, x = np.mgrid[:SIDE, :SIDE]
    down, across = (
        (np.cos(0.2) * a + s * np.sin(0.2) * b) // 13 for a, b, s in ((y, x, -1), (x, y, 1))
    )
    return electrons[((7 * across + 5 * down) % 24).astype(int)]


def psnr_db(picture, truth, white_e):
    away = ((picture - truth) / white_e)[8:-8, 8:-8]
    return -10 * np.log10((away**2).mean())


@pytest.mark.parametrize("scene", [cloudy, zone_plate, slanted_squares])
@pytest.mark.parametrize(
    ("sensor_name", "mosaic"),
    [
        ("onyx-rgb-ircut", bayer()),
        ("onyx-rgbw-ircut", rgbw_2x2()),
        ("onyx-rgbw-ircut", rgbw_sparse_4x4()),
    ],
    ids=["Bayer", "RGBW 2x2", "sparse RGBW"],
)
def test_gradients_bring_a_picture_nearer_than_bilinear_and_the_window_nearer_still(
    sensor_name, mosaic, scene
):
    sensor, electrons, noise = chart_seen(sensor_name, level_lux=10.0)
    truth = scene(electrons)
    mean = raw_of(truth, mosaic, sensor.names)
    spread = np.sqrt(np.maximum(mean, 0.0) + sensor.pixel.read_noise_e**2)
    raw = mean + spread * stream(3).standard_normal(mean.shape)
    prior = picture_prior(electrons, sensor.names, noise_e2=noise)
    bilinear, gradient, window = (
        psnr_db(demosaicked(raw, bank), truth, electrons[18])
        for bank in (
            bilinear_filters(mosaic, sensor.names),
            gradient_corrected_filters(mosaic, sensor.names, prior),
            lmmse_filters(mosaic, prior),
        )
    )
    assert gradient > bilinear + 0.5
    assert window > bilinear + 1.0
    assert window > gradient - 0.1


def test_in_the_dark_a_window_that_knows_of_the_noise_comes_nearer_than_one_that_does_not():
    sensor, electrons, noise = chart_seen("onyx-rgbw-ircut", level_lux=0.2)
    truth = cloudy(electrons)
    mean = raw_of(truth, rgbw_2x2(), sensor.names)
    spread = np.sqrt(np.maximum(mean, 0.0) + sensor.pixel.read_noise_e**2)
    raw = mean + spread * stream(4).standard_normal(mean.shape)
    values, untold = (
        demosaicked(
            raw, lmmse_filters(rgbw_2x2(), picture_prior(electrons, sensor.names, noise_e2=n))
        )
        for n in (noise, 0.0 * noise)
    )
    assert psnr_db(values, truth, electrons[18]) > psnr_db(untold, truth, electrons[18]) + 3.0


# its noise


def test_noise_of_a_bilinear_bayer_picture_is_nine_sixteenths_of_red_and_five_eighths_of_green():
    """Red: measured once, a mean of two twice, of four once; green: measured or a mean of four."""
    bank = bilinear_filters(bayer(), ("R", "G", "B"))
    mean = demosaicked_covariance(bank, np.array([16.0, 8.0, 32.0])).mean(axis=(0, 1))
    np.testing.assert_allclose(mean, np.diag([9.0, 5.0, 18.0]), atol=1e-12)


def test_spectrum_of_bilinear_red_is_that_of_a_triangle():
    """Every fourth pixel, through (1 + cos u)(1 + cos v): power v/4 of its square."""
    bank = bilinear_filters(bayer(), ("R", "G", "B"))
    spectrum = noise_power_spectrum(bank, np.array([4.0, 0.0, 0.0]), (8, 10))
    along = [(1 + np.cos(2 * np.pi * np.fft.fftfreq(n))) ** 2 for n in (8, 10)]
    np.testing.assert_allclose(spectrum[..., 0, 0], np.outer(*along), atol=1e-12)
    assert spectrum[0, 0, 0, 0] == pytest.approx(16.0)


@every_bank
def test_the_mean_of_the_spectrum_is_the_covariance(bank):
    variance = 1.0 + np.arange(len(bank.names))
    side = bank.kernels.shape[-1]
    mean = noise_power_spectrum(bank, variance, (side, side + 3)).mean(axis=(0, 1))
    np.testing.assert_allclose(
        mean, demosaicked_covariance(bank, variance).mean(axis=(0, 1)), atol=1e-10
    )


@every_bank
def test_starting_the_mosaic_elsewhere_moves_the_noise_along(bank):
    rolled = Mosaic(
        tuple(row[1:] + row[:1] for row in bank.mosaic.pattern[1:] + bank.mosaic.pattern[:1])
    )
    prior = prior_of(bank.mosaic.names, noise=0.1)
    there = {
        "bilinear": lambda: bilinear_filters(rolled, bank.names),
        "gradient-corrected": lambda: gradient_corrected_filters(rolled, bank.names, prior),
        "LMMSE": lambda: lmmse_filters(rolled, prior),
        "Malvar-He-Cutler": lambda: malvar_filters(rolled, bank.names),
    }[bank.made_by]()
    variance = 1.0 + np.arange(len(bank.names))
    here = demosaicked_covariance(bank, variance)
    np.testing.assert_allclose(
        demosaicked_covariance(there, variance), np.roll(here, (-1, -1), (0, 1)), atol=1e-9
    )


@every_bank
def test_a_color_matrix_may_be_applied_before_or_after_the_filters(bank):
    p = len(bank.names)
    matrix = stream(6).standard_normal((p, p))
    mixed = FilterBank(
        mosaic=bank.mosaic,
        names=bank.names,
        kernels=np.einsum("cd,abdij->abcij", matrix, bank.kernels),
        made_by="mixed",
    )
    raw, variance = stream(7).random((12, 12)), 1.0 + np.arange(p)
    np.testing.assert_allclose(
        demosaicked(raw, mixed), demosaicked(raw, bank) @ matrix.T, atol=1e-10
    )
    for noise in (demosaicked_covariance, lambda *of: noise_power_spectrum(*of, (11, 12))):
        np.testing.assert_allclose(
            noise(mixed, variance), matrix @ noise(bank, variance) @ matrix.T, atol=1e-8
        )


FRAMES, FIELD, MARGIN = 100, 24, 12


def noisy_fields(bank, variance):
    """Noise of flat fields that go on periodically, demosaicked: (frames, rows, columns, p)."""
    tile = channel_tile(bank.mosaic, bank.names)
    spread = np.sqrt(variance)[np.tile(tile, (FIELD // tile.shape[0], FIELD // tile.shape[1]))]
    raw = spread * stream(8).standard_normal((FRAMES, FIELD, FIELD))
    around = np.pad(raw, [(0, 0), (MARGIN, MARGIN), (MARGIN, MARGIN)], mode="wrap")
    side = FIELD + 2 * MARGIN
    out = demosaicked(around.reshape(-1, side), bank).reshape(FRAMES, side, side, -1)
    return out[:, MARGIN:-MARGIN, MARGIN:-MARGIN]


def worst_z(per_frame, expected):
    error = per_frame.std(axis=0, ddof=1) / np.sqrt(len(per_frame))
    certain = error < 1e-9
    np.testing.assert_allclose(per_frame.mean(axis=0)[certain], expected[certain], atol=1e-9)
    return np.abs((per_frame.mean(axis=0) - expected)[~certain] / error[~certain]).max()


MEASURED = [(name, bank) for name, bank in BANKS if name not in ("RGB-IR", "stripes")]


@pytest.mark.parametrize(
    "bank",
    [bank for _, bank in MEASURED],
    ids=[f"{name}, {bank.made_by}" for name, bank in MEASURED],
)
def test_flat_fields_scatter_as_covariance_and_spectrum_say(bank):
    ty, tx, p = bank.kernels.shape[:3]
    variance = 100.0 * (1.0 + np.arange(p))
    fields = noisy_fields(bank, variance)
    places = fields.reshape(FRAMES, FIELD // ty, ty, FIELD // tx, tx, p)
    measured = np.einsum("fyaxbc,fyaxbd->fabcd", places, places, optimize=True)
    measured /= FIELD**2 / (ty * tx)
    assert worst_z(measured, demosaicked_covariance(bank, variance)) < 5

    waves = np.fft.fft2(fields, axes=(1, 2)) / FIELD
    bands = waves.reshape(FRAMES, 6, FIELD // 6, 6, FIELD // 6, p)
    power = np.einsum("fynxmc,fynxmd->fyxcd", bands, bands.conj(), optimize=True).real
    spectrum = noise_power_spectrum(bank, variance, (FIELD, FIELD))
    expected = spectrum.reshape(6, FIELD // 6, 6, FIELD // 6, p, p).sum(axis=(1, 3))
    assert worst_z(power, expected) < 5


@pytest.mark.parametrize("bank", [bilinear_filters(bayer()), METHODS["LMMSE"](rgbw_sparse_4x4())])
def test_visual_noise_of_demosaicked_flat_fields_is_as_predicted(bank):
    """Through a color matrix and CIELUV's slope; measured by Fourier transform of each field."""
    p = len(bank.names)
    matrix = np.array([[0.5, 0.3, 0.2, 0.1], [0.2, 0.7, 0.1, 0.2], [0.0, 0.1, 0.9, 0.1]])[:, :p]
    slope = np.array([[0.0, 116.0, 0.0], [200.0, -180.0, 10.0], [20.0, 60.0, -90.0]])
    variance = 1e-4 * (1.0 + np.arange(p))
    spectrum = matrix @ noise_power_spectrum(bank, variance, (FIELD, FIELD)) @ matrix.T
    predicted = visual_noise_from_spectrum(spectrum, slope, pixels_per_degree=40.0)
    measured = np.array(
        [
            visual_noise_of_picture(
                1.0 + field @ matrix.T, lambda xyz: xyz @ slope.T, pixels_per_degree=40.0
            ).sigma_luv
            for field in noisy_fields(bank, variance)
        ]
    )
    assert worst_z(measured**2, predicted.sigma_luv**2) < 5


# the compiled way


@every_bank
def test_compiled_demosaicing_gives_the_same_bits_for_any_block_of_rows(bank):
    from chromanoise.imaging.demosaic import demosaicked_rows, surrounded_rows, taps_of

    raw, taps = 1000.0 * stream(9).random((23, 17)), taps_of(bank)
    whole = demosaicked_rows(surrounded_rows(raw, bank, 0, 23), taps, 0)
    for block in (1, 5, 22):
        parts = [
            demosaicked_rows(surrounded_rows(raw, bank, at, min(at + block, 23)), taps, at)
            for at in range(0, 23, block)
        ]
        assert np.concatenate(parts).tobytes() == whole.tobytes()
    np.testing.assert_allclose(whole, demosaicked(raw, bank), atol=2e-3)


# what is refused


@pytest.mark.parametrize(
    ("make", "fields"),
    [
        (lambda: demosaicked(np.ones((1, 1)), bilinear_filters(bayer())), {"value": (1, 1)}),
        (
            lambda: demosaicked(np.full((4, 4), np.nan), bilinear_filters(bayer())),
            {"subject": "raw_e"},
        ),
        (lambda: bilinear_filters(bayer(), ("R", "G", "B", "W")), {"subject": "channel 'W'"}),
        (
            lambda: bilinear_filters(bayer(), ("R", "G")),
            {"subject": "mosaic channel", "value": "B"},
        ),
        (lambda: malvar_filters(rgbw_2x2()), {"subject": "mosaic", "setting": "demosaic"}),
        (lambda: malvar_filters(Mosaic((("G", "G"), ("R", "B")))), {"found": "is G G/R B"}),
        (lambda: gradient_corrected_filters(rgbw_2x2()), {"subject": "prior"}),
        (
            lambda: gradient_corrected_filters(bayer(), prior=prior_of("RGBW")),
            {"subject": "the number of channels"},
        ),
        (
            lambda: lmmse_filters(rgbw_sparse_4x4(), prior_of("RWGB"), side=3),
            {"subject": "side", "value": 3},
        ),
        (lambda: lmmse_filters(bayer(), prior_of("RGB"), side=6), {"subject": "side", "value": 6}),
        (lambda: prior_of("RGB", likeness=1.5), {"subject": "covariance_e2"}),
        (lambda: picture_prior(np.ones((1, 3)), "RGB", noise_e2=np.zeros(3)), {"value": 1}),
        (lambda: picture_prior(np.ones((4, 3)), "RGB", noise_e2=np.zeros(3)), {"value": 0.0}),
        (
            lambda: noise_power_spectrum(bilinear_filters(bayer()), np.ones(3), (2, 8)),
            {"subject": "shape", "value": (2, 8)},
        ),
        (
            lambda: demosaicked_covariance(bilinear_filters(bayer()), np.ones(4)),
            {"subject": "the number of channels"},
        ),
        (
            lambda: FilterBank(
                mosaic=bayer(), names=("R", "G", "B"), kernels=np.ones((2, 2, 3, 4, 4)), made_by="x"
            ),
            {"subject": "kernels of x", "value": (2, 2, 3, 4, 4)},
        ),
    ],
)
def test_what_cannot_be_demosaicked_is_told_in_one_sentence(make, fields):
    with refused_input(**fields):
        make()
