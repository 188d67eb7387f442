"""A noise source in a subclass of `Pixel`: everything that walks the list has it."""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.apps.design.parameters import noise_of
from chromanoise.apps.training.training_noise import sampler
from chromanoise.base.properties import Growth, Property
from chromanoise.base.rng import stream
from chromanoise.imaging import Work
from chromanoise.imaging.render import rendered_electrons
from chromanoise.io.sensor_files import sensor_json
from chromanoise.noise import (
    NoiseSources,
    monte_carlo,
    noise_sources,
    reading_distribution,
    sample_electrons,
    with_noise,
)
from chromanoise.sensor import CameraNoise, Pixel, binned, shot_and_read_only, with_pixel
from chromanoise.sensor.noise_sources import NoiseSource
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import sensor_named, study_from_data, study_hash
from chromanoise.study.resolve_names import object_word
from laws.test_noise_sources import EXPOSURE, FRAMES, camera, flat, pictures, point
from outcomes import refused_input

GROWTH = {
    "reading": Growth(readings=0.5),
    "row": Growth(readings=0.5, columns=0.5),
    "column": Growth(readings=0.5, rows=0.5),
    "pattern": Growth(pixels=0.5),
    "gain": Growth(pixels=-0.5),
}


def kind_of_pixel(drawn):
    """A class of pixels with one more source, which is drawn in this way."""
    square = drawn == "gain"

    @dataclass(frozen=True, slots=True, kw_only=True)
    class OwnPixel(Pixel):
        flicker: Annotated[
            float,
            Property(
                label="flicker", unit="e-", least=0.0, most=100.0, help="Flicker [e-].",
                growth=GROWTH[drawn],
            ),
        ] = 0.0  # fmt: skip
        own_noise = (
            NoiseSource(
                cause="flicker noise",
                drawn=drawn,
                term="square" if square else "floor_e2",
                value=lambda of: of.pixel.flicker**2,
            ),
        )

    return OwnPixel


LIKE = {
    "reading": "read_noise_e",
    "row": "row_noise_e",
    "column": "column_noise_e",
    "pattern": "dsnu_e",
    "gain": "prnu",
}
"""The property of `Pixel` with the same noise."""
WAYS = pytest.mark.parametrize("drawn", LIKE)


def pixel_of(drawn, **more):
    flicker = 0.15 if drawn == "gain" else 6.0
    known = {"pitch_um": 5.0, "full_well_e": 1e5, "read_noise_e": 0.5, "flicker": flicker} | more
    return kind_of_pixel(drawn)(**known)


def known_pixel(drawn, **more):
    """A pixel of the library with noise of the same variance."""
    own = pixel_of(drawn)
    value = np.hypot(own.flicker, own.read_noise_e) if drawn == "reading" else own.flicker
    known = {"pitch_um": 5.0, "full_well_e": 1e5, "read_noise_e": 0.5, LIKE[drawn]: float(value)}
    return Pixel(**known | more)


@WAYS
@pytest.mark.parametrize("kind", ["total", "temporal"])
def test_the_closed_form_is_that_of_a_known_source_of_the_same_variance(drawn, kind):
    mean = np.array([0.0, 40.0, 1000.0])
    own, known = (
        NoiseSources(pixel=f(drawn)).variance_e2(mean, kind) for f in (pixel_of, known_pixel)
    )
    assert own == pytest.approx(known, rel=1e-12)
    assert shot_and_read_only(pixel_of(drawn)).flicker == 0


@WAYS
@pytest.mark.parametrize("mode", ["charge", "digital"])
def test_binning_follows_the_growth_of_its_property(drawn, mode):
    one, other = (NoiseSources(pixel=binned(f(drawn), 4, mode)) for f in (pixel_of, known_pixel))
    assert one.variance_e2(np.array([9.0])) == pytest.approx(other.variance_e2(np.array([9.0])))
    stepped = [
        replace(each, step_e=1.0, readings=4 if mode == "digital" else 1) for each in (one, other)
    ]
    own, known = (each.one_reading.variance_e2(np.array([9.0])) for each in stepped)
    assert own == pytest.approx(known)


@WAYS
def test_all_draws_have_its_variance(drawn):
    pixel, mean = pixel_of(drawn), np.array([40.0])
    expected = NoiseSources(pixel=known_pixel(drawn)).variance_e2(mean)[0]
    noise = noise_sources(camera(pixel), EXPOSURE)
    sampled = sample_electrons(np.full(400_000, 40.0), pixel, stream(7), noise=noise)
    assert sampled.var() == pytest.approx(expected, rel=0.02)
    estimate = monte_carlo(mean, pixel, np.eye(1), draws=40_000, seed=5, noise=noise)
    assert estimate.sd[0] ** 2 == pytest.approx(expected, rel=0.06)
    found = reading_distribution(mean, noise)
    assert found.probability[0] @ (found.values_e - 40.0) ** 2 == pytest.approx(expected, rel=2e-3)
    add_noise = sampler(CameraNoise.from_sensor(camera(pixel)), quantize=False, clamp=False)
    items = [
        add_noise(np.full((192, 192), 40.0), unit="electron", item=i, pattern=i) for i in range(12)
    ]
    shared = 0.17 if drawn in ("row", "column") else 0.02
    assert np.mean([(one.noisy - 40.0).var() for one in items]) == pytest.approx(
        expected, rel=shared
    )


@WAYS
def test_pictures_have_its_variance(drawn):
    pixel = pixel_of(drawn)
    values, mean_e = pictures(pixel, FRAMES)
    color = [
        rendered_electrons(flat(), point(pixel, f"sensor {i}"), work=Work(threads=1)).values_e
        for i in range(FRAMES)
    ]
    expected = with_noise(np.array([mean_e]), camera(known_pixel(drawn)), EXPOSURE).variance[0]
    shared = 0.17 if drawn in ("row", "column") else 0.02
    for found in (values, np.array(color)):
        assert ((found - mean_e) ** 2).mean() == pytest.approx(expected, rel=shared)


def own_sensor(drawn, **more):
    start = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    return replace(start, name="own", pixel=pixel_of(drawn, **more))


@WAYS
def test_an_analysis_has_its_snr_and_its_own_row_in_the_budget(drawn):
    same = replace(own_sensor(drawn), pixel=known_pixel(drawn))
    settings = {"lux": 10, "time_ms": 12, "budget": True}
    own, known = (
        cn.analyze(one, **settings).to_dict()["sensors"][0] for one in (own_sensor(drawn), same)
    )
    assert own["color"]["snr_db"] == pytest.approx(known["color"]["snr_db"], rel=1e-12)
    costs = {cost["cause"]: cost for cost in own["budget"][1]["costs"]}
    assert costs["flicker noise"]["cost_db"] > 0.01
    assert abs(costs["rest"]["cost_db"]) < 0.01  # the color error of the matrix


def test_a_change_of_the_pixel_keeps_the_source():
    sensor = with_pixel(own_sensor("reading"), {"read_noise_e": 2.0})
    assert noise_sources(sensor).floor_e2() == pytest.approx(2.0**2 + 6.0**2)


def test_the_hash_depends_on_the_source():
    word = object_word("own")
    study = study_from_data({"sensors": [{"name": word}]}, source="a test")
    sensors = [own_sensor("reading"), own_sensor("reading", flicker=7.0), own_sensor("row")]
    assert len({study_hash(study, objects={word: one}) for one in sensors}) == 3


@WAYS
def test_the_fast_objectives_of_a_design_have_the_law_of_its_base(drawn):
    *law, _ = noise_of(own_sensor(drawn), np.array([0.01]), {})
    floor, slope, square = (float(one[0]) for one in law)
    known = noise_sources(replace(own_sensor(drawn), pixel=known_pixel(drawn))).law()
    assert (floor, slope, square) == pytest.approx((known.floor_e2, known.slope_e, known.square))


def test_a_file_refuses_a_sensor_with_a_source_of_its_own():
    with refused_input(subject="sensor own", value=["flicker noise"]):
        sensor_json(own_sensor("reading"))


GOOD = NoiseSource(cause="own", drawn="reading", term="floor_e2", value=lambda of: 1.0)


@pytest.mark.parametrize(
    ("source", "subject", "value"),
    [
        (replace(GOOD, drawn="count"), "drawn of own", "count"),
        (replace(GOOD, drawn="levels"), "drawn of own", "levels"),
        (replace(GOOD, term="square"), "term of own", "square"),
        (replace(GOOD, cause="DSNU"), "causes of noise", "DSNU"),
        (replace(GOOD, value=lambda of: -1.0), "coefficient of own", -1.0),
        (replace(GOOD, value=lambda of: np.inf), "coefficient of own", np.inf),
    ],
)
def test_a_source_that_cannot_be_drawn_is_refused(source, subject, value):
    class OwnPixel(Pixel):
        own_noise = (source,)

    with refused_input(subject=subject, value=value):
        NoiseSources(pixel=OwnPixel(pitch_um=5.0, full_well_e=1e5, read_noise_e=0.5))


def test_a_source_whose_function_reads_what_has_changed_is_asked_again():
    strength = [2.0]
    source = replace(GOOD, value=lambda of: strength[0] ** 2)

    class OwnPixel(Pixel):
        own_noise = (source,)

    pixel = OwnPixel(pitch_um=5.0, full_well_e=1e5, read_noise_e=1.0)
    sensor = replace(sensor_named("onyx-rgb"), pixel=pixel)
    before = noise_sources(sensor).floor_e2()
    strength[0] = 3.0
    assert noise_sources(sensor).floor_e2() - before == 3.0**2 - 2.0**2
