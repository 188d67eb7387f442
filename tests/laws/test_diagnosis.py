"""A sensor that cannot answer says so, and says why."""

import re

import numpy as np
import pytest
from scipy.stats import norm, poisson

import chromanoise as cn
from chromanoise.noise import Exposure, Readout, saturating_exposure
from chromanoise.spectra import Grid, equal_energy, flat_field
from chromanoise.study import analyzed, color_snr_db, contravariant_snr_db, diagnosis, raw_snr_db
from strategies import bell_qe, sensor_of, white_channel

GRID = Grid.uniform(400, 700, 10)
SCENE = flat_field(equal_energy(GRID), level_lux=10.0)
RGB = bell_qe([450, 540, 620], [25, 35, 30], [0.6, 0.7, 0.8])
COPY = np.hstack([RGB, RGB[:, :1] * 0.5])  # d is half of a


def analysis_of(qe, time_s=0.005):
    return analyzed(SCENE, sensor_of(qe), Exposure(time_s=time_s))


def test_a_healthy_sensor_has_every_number_and_no_complaint():
    analysis = analysis_of(RGB)
    assert diagnosis(analysis) == ()
    for result in (raw_snr_db(analysis), contravariant_snr_db(analysis), color_snr_db(analysis)):
        assert all(isinstance(db, float) and np.isfinite(db) for db in result.values())


def test_a_copied_channel_hides_its_own_contravariant_snr_and_no_other():
    analysis = analysis_of(COPY)
    result = contravariant_snr_db(analysis)
    healthy = contravariant_snr_db(analysis_of(RGB))
    assert (result["a"], result["d"]) == (None, None)
    for name in ("b", "c"):
        assert result[name] == pytest.approx(healthy[name], abs=1.0)
    assert None not in raw_snr_db(analysis).values()
    assert None not in color_snr_db(analysis).values()


def test_a_copied_channel_is_diagnosed_with_its_mix():
    result = " ".join(diagnosis(analysis_of(COPY)))
    assert "singular" in result
    assert "3 of 4" in result
    assert "0.50 a" in result or "2.00 d" in result


def test_a_nearly_copied_channel_is_diagnosed_and_keeps_its_numbers():
    nearly = COPY + bell_qe([500], [10], [0.002]) * np.array([0, 0, 0, 1.0])
    analysis = analysis_of(nearly)
    assert "nearly singular" in " ".join(diagnosis(analysis))
    assert None not in contravariant_snr_db(analysis).values()


def test_a_saturated_channel_hides_every_number_that_it_enters():
    saturating = saturating_exposure(SCENE, sensor_of(RGB), share=1.0).time_s
    fullest = int(np.argmax(analysis_of(RGB).raw.mean))
    name = "abc"[fullest]
    analysis = analysis_of(RGB, time_s=1.0001 * saturating)
    raw = raw_snr_db(analysis)
    assert raw[name] is None
    assert [other for other, db in raw.items() if db is None] == [name]
    assert set(contravariant_snr_db(analysis).values()) == {None}
    assert set(color_snr_db(analysis).values()) == {None}
    result = diagnosis(analysis)
    assert len(result) == 1
    assert f"channel {name} is saturated" in result[0]
    assert "10000 e-" in result[0]


def test_full_well_itself_still_has_an_snr():
    saturating = saturating_exposure(SCENE, sensor_of(RGB), share=1.0)
    analysis = analyzed(SCENE, sensor_of(RGB), saturating)
    assert None not in raw_snr_db(analysis).values()
    # 10,000 e- with 10 e- of read noise
    assert max(raw_snr_db(analysis).values()) == pytest.approx(39.9568, abs=5e-5)


def held(mean_e):
    """What is said of one channel of ``mean_e``, read with 10 e- and held at 10,000 e-."""
    per_second = analyzed(SCENE, white_channel(), Exposure(time_s=1e-3)).raw.mean[0] * 1e3
    exposure = Exposure(time_s=mean_e / per_second)
    return diagnosis(analyzed(SCENE, white_channel(), exposure, readout=Readout(full_well_e=1e4)))


def test_a_channel_at_99_percent_of_full_well_is_told_to_be_held_there_in_one_of_six_readouts():
    # docs/numbers.md: 15.866 % of 9,900 e- with 10 e- of read noise
    (result,) = held(9_900.0)
    assert result.startswith("15.9 % of W is clipped at full well")
    assert "SNR are too high" in result


def test_one_held_readout_of_a_thousand_is_worth_telling_and_one_of_ten_thousand_is_not():
    # Gaussian tails at (10,000 - M) / sqrt(M + 100): 3.03 standard deviations 0.12 %, 3.54 0.02 %
    (result,) = held(9_700.0)
    assert result.startswith("0.1 % of W is clipped at full well")
    assert held(9_650.0) == ()


def test_a_channel_that_sees_none_of_the_light_is_told():
    # a channel beyond 620 nm under a lamp that ends before
    lamp_end = (GRID.wavelength_nm < 600).astype(float)
    scene = type(SCENE)(illuminant=SCENE.illuminant, level_lux=10.0, reflectance=lamp_end)
    far_red = np.where(GRID.wavelength_nm[:, None] > 620, 0.5, 0.0)
    sensor = sensor_of(np.hstack([RGB[:, :2], far_red]))
    analysis = analyzed(scene, sensor, Exposure(time_s=0.005))
    assert "channel c sees none of this light" in diagnosis(analysis)
    assert raw_snr_db(analysis)["c"] is None
    assert raw_snr_db(analysis)["a"] is not None


def test_one_channel_needs_no_neighbors():
    analysis = analyzed(SCENE, white_channel(), Exposure(time_s=0.002))
    assert analysis.mix is None
    assert analysis.color_snr_loss_db == pytest.approx(0.0, abs=1e-9)
    assert contravariant_snr_db(analysis)["W"] == pytest.approx(raw_snr_db(analysis)["W"], abs=1e-9)
    assert analysis.spectral_snr_db == pytest.approx(raw_snr_db(analysis)["W"], abs=1e-9)


def test_notes_of_sensor_and_lamp_open_the_diagnosis():
    lamp = equal_energy(GRID)
    lamp = type(lamp)(name="E", grid=GRID, irradiance=lamp.irradiance, notes=("from a lamp",))
    sensor = sensor_of(RGB, notes=("from a sensor",))
    analysis = analyzed(flat_field(lamp, level_lux=10.0), sensor, Exposure(time_s=0.005))
    assert diagnosis(analysis) == ("from a sensor", "from a lamp")


def test_the_rise_by_clipping_at_black_is_told_from_the_bias_of_coarse_rounding():
    settings = {"lux": 0.05, "time_ms": 12}
    rounded = cn.analyze("onyx-rgb-ircut", bits=8, clip=True, **settings).to_dict()["sensors"][0]
    light_e = cn.analyze("onyx-rgb-ircut", **settings).to_dict()["sensors"][0]["channels"][0]
    step_e, codes, counts = 10_000 / 255, np.arange(-9, 30), np.arange(80)
    edges = norm.cdf((codes[:, None] + [-0.5, 0.5])[..., None] * step_e, loc=counts, scale=10.0)
    chance = np.diff(edges, axis=1)[:, 0] @ poisson.pmf(counts, light_e["mean_e"])
    means = chance @ codes * step_e, chance @ np.maximum(codes, 0) * step_e
    said = next(note for note in rounded["notes"] if "of R is clipped at black" in note)
    numbers = re.search(r"from (\S+) to (\S+) e-", said).groups()
    assert [float(one) for one in numbers] == pytest.approx(means, rel=5e-3)
