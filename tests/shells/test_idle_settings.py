"""Settings without effect: command, Python, study file and class refuse alike, the page keeps."""

import json

import pytest

import chromanoise as cn
from chromanoise.base import InputError, RecordError, dotted, errors_in
from chromanoise.study import (
    read_study,
    run_study,
    study_as_json,
    study_as_toml,
    study_from_text,
    study_hash,
    study_of_output,
)
from chromanoise.study.schema import KEEP_IDLE, without_idle_settings
from chromanoise.web.answers import ChartReplies
from chromanoise.web.page_studies import Studies
from chromanoise.web.services import Services
from chromanoise.web.uploads import Uploads
from outcomes import refused, refused_input

ONE = [{"name": "onyx-rgbw"}]
TIMES = {"vary": "time-ms", "first": 1.0, "last": 20.0}
NOISES = {"vary": "read-noise-e", "first": 1.0, "last": 9.0}
NO_ANALYSES = {"analyses": False}
TRAINED = "must be given only with a trained matrix, as lmmse"
REFUSED = [
    (
        ("analyze", {"time_ms": 3.0, "saturate": 0.5}, "--time-ms 3 --saturate 0.5"),
        {"exposure": {"time_ms": 3.0, "saturate": 0.5}},
        ("must not be given with a share of full well, from which the time is solved", 3.0),
        "exposure.time_ms",
    ),
    (  # the default, given
        ("analyze", {"time_ms": 3.0, "saturate": 0.99}, "--time-ms 3 --saturate 0.99"),
        {"exposure": {"time_ms": 3.0, "saturate": 0.99}},
        ("must not be given with a share of full well, from which the time is solved", 3.0),
        "exposure.time_ms",
    ),
    (
        ("analyze", {"prior": "chart"}, "--prior chart"),
        {"prior": "chart"},
        (TRAINED, "chart"),
        "prior",
    ),
    (
        ("compare", {"prior": "all"}, "--prior all"),
        {"sweeps": [{"vary": "lux", "first": 1.0, "last": 2.0, "all_priors": True}]},
        (TRAINED, True),
        "sweeps.0.all_priors",
    ),
    (
        ("compare", {**TIMES, "time_ms": 5.0}, "--sweep time-ms=1:20 --time-ms 5"),
        {"exposure": {"time_ms": 5.0}, "sweeps": [TIMES], "outputs": NO_ANALYSES},
        ("must not be given where it varies", 5.0),
        "exposure.time_ms",
    ),
    (
        ("compare", {**NOISES, "read_noise_e": 5.0}, "--sweep read-noise-e=1:9 --read-noise-e 5"),
        {
            "sensors": [{"name": "onyx-rgbw", "pixel": {"read_noise_e": 5.0}}],
            "sweeps": [NOISES],
            "outputs": NO_ANALYSES,
        },
        ("must not be given where it varies", 5.0),
        "sensors.0.pixel.read_noise_e",
    ),
]


def fields(errors):
    return [(one.requirement, one.value, one.setting) for one in errors]


@pytest.mark.parametrize(("call", "data", "refusal", "key"), REFUSED, ids=lambda one: str(one)[:40])
def test_a_setting_without_effect_is_refused_alike_by_every_entrance(
    call, data, refusal, key, run, here
):
    function, settings, words = call
    expected = [(*refusal, key)]
    with pytest.raises(cn.InputError) as caught:
        getattr(cn, function)("onyx-rgbw", **settings)
    assert fields(errors_in(caught.value)) == expected
    assert fields(run(function, "onyx-rgbw", *words.split()).errors) == expected
    data = {"sensors": ONE} | data
    with pytest.raises(cn.InputError) as caught:
        cn.study_from_data(data)
    assert fields(errors_in(caught.value)) == expected
    assert [one.subject for one in errors_in(caught.value)] == [key.rpartition(".")[2]]
    with pytest.raises(RecordError) as refused:
        cn.Study(**data)
    (fault,) = refused.value.faults
    assert fault.error.requirement == refusal[0]
    # the page keeps it for the next change of a control; what runs is without it
    kept = cn.Study.model_validate(data, context=KEEP_IDLE)
    share = "[exposure]\nsaturate = 0.99\n" if "0.99" in str(data) else ""  # a default
    text = study_as_toml(kept).replace("[exposure]\n", share) if share else study_as_toml(kept)
    (here / "s.toml").write_text(text)
    with pytest.raises(cn.InputError) as caught:
        read_study(here / "s.toml")
    assert fields(errors_in(caught.value)) == expected
    runs = without_idle_settings(kept)
    assert cn.study_from_data(json.loads(runs.model_dump_json(exclude_defaults=True))) == runs


@pytest.mark.parametrize(
    "data",
    [
        {"exposure": {"time_ms": 5.0}, "sweeps": [TIMES]},  # also of the analyses
        {
            "exposure": {"time_ms": 5.0},
            "sweeps": [TIMES, {"vary": "lux", "first": 1.0, "last": 2.0}],
            "outputs": NO_ANALYSES,
        },
        {"exposure": {"time_ms": 5.0}, "sweeps": [TIMES], "pictures": [{}], "outputs": NO_ANALYSES},
        {"prior": "chart", "matrices": ["kernel", "ridge=0.01"]},
        {"prior": "chart", "outputs": {"matrix": True, "pareto": {"first": 1.0, "last": 2.0}}},
    ],
    ids=str,
)
def test_a_setting_that_one_step_uses_is_accepted(data):
    study = cn.study_from_data({"sensors": ONE} | data)
    assert without_idle_settings(study) is study


def test_the_page_keeps_what_another_control_put_out_of_effect():
    data = {
        "sensors": ONE * 2,
        "prior": "chart",
        "exposure": {"time_ms": 3.0, "saturate": 0.5},
    }
    uploads = Uploads()
    try:
        answers = ChartReplies(Studies(uploads))
        record = json.loads(answers.answer({"study": data, "want": ["head"]}))
        assert [one["time_ms"] for one in record["parts"]["head"]["sensors"]] == [3.0, 3.0]
        copied = study_from_text(answers.texts({"study": data})["toml"], source="copied")
        assert (copied.prior, copied.exposure.saturate) == ("chart-nir", 0.99)
        assert record["hash"] == study_hash(copied)
        # the initial study has all defaults
        served = study_as_json(cn.study_from_data({"sensors": ONE, "exposure": {"time_ms": 3.0}}))
        assert Services(uploads, study=served)
        assert json.loads(answers.answer({"study": served, "want": []}))["parts"] == {}
    finally:
        uploads.close()


def test_the_record_of_a_run_has_all_defaults_and_is_run_again(here):
    study = cn.study_from_data({"sensors": ONE, "exposure": {"time_ms": 3.0}})
    run_study(study, here / "out")
    again = study_of_output(here / "out")
    assert again == study
    run_study(again, here / "again")
    assert (here / "again" / "study.json").exists()


@pytest.mark.parametrize(
    ("data", "setting", "value"),
    [
        ({"metric": "photons"}, "metric", "photons"),
        ({"observer": "cie-1964"}, "observer", "cie-1964"),
        ({"prior": "all"}, "prior", "all"),
        ({"matrices": ["kernel", "kernl"]}, "matrices.1", "kernl"),
        ({"matrices": ["ridge=-1"]}, "matrices.0", -1.0),
        ({"matrices": ["ridge"]}, "matrices.0", "ridge"),
        ({"sweeps": [TIMES | {"vary": "time"}]}, "sweeps.0.vary", "time"),
        ({"sweeps": [TIMES | {"quantity": "snr"}]}, "sweeps.0.quantity", "snr"),
        ({"outputs": {"space": "nonsense"}}, "outputs.space", "nonsense"),
        ({"pictures": [{"mosaic": "bayer", "demosaic": "x"}]}, "pictures.0.demosaic", "x"),
        ({"pictures": [{"formats": ["png", "jpg"]}]}, "pictures.0.formats.1", "jpg"),
    ],
    ids=str,
)
def test_a_study_built_in_python_is_checked_when_it_is_built(data, setting, value):
    with pytest.raises(RecordError) as refused:
        cn.Study(sensors=ONE, **data)
    fault = refused.value.faults[0]  # a list without its only entry is too short as well
    assert dotted(fault.key) == setting
    assert fault.error.value == value
    with refused_input(setting_name=setting.split(".")[-1 - setting[-1].isdigit()], value=value):
        cn.study_from_data({"sensors": ONE} | data)


def test_a_filter_or_a_catalog_sensor_that_ends_early_may_be_extrapolated(run):
    assert run("analyze", "ar0132at-rgbw", "--peak-qe", 0.3, "--beyond", "zero")[0] == 0
    assert run("analyze", "onyx-rgbw", "--filter", "ircut-650", "--beyond", "zero")[0] == 0


WARM = ("reset_capacitance_ff", "dark_current_e_per_s")


@pytest.mark.parametrize("needed", WARM)
def test_a_temperature_has_an_effect_where_what_it_needs_varies(needed):
    at = {"points": 3, "quantity": "snr-y"}
    sweep = {"vary": needed, "first": 0.5, "last": 2.0}
    found = cn.compare("onyx-rgbw", **at, **sweep, time_ms=10.0, temperature_c=60.0)
    single, cold = (
        cn.analyze("onyx-rgbw", time_ms=10.0, temperature_c=warmth, **{needed: 2.0}).color_snr_db()[
            "onyx-rgbw"
        ]["Y"]
        for warmth in (60.0, 0.0)
    )
    assert found.curves[0].value[-1] == pytest.approx(single, rel=1e-12)
    assert single < cold
    with refused_input(subject="temperature_c", value=60.0):
        cn.compare("onyx-rgbw", **at, vary="prnu", first=0.0, last=0.1, temperature_c=60.0)


@pytest.mark.parametrize("needed", WARM)
def test_a_zero_turns_off_a_value_of_a_file_beside_its_temperature(tmp_path, needed):
    plain = cn.analyze("onyx-rgbw").color_snr_db()
    file = tmp_path / "pixel.toml"
    file.write_text(
        f'schema = "chromanoise pixel"\nschema_version = 1\n{needed} = 5.0\ntemperature_c = 40\n'
    )
    assert cn.analyze("onyx-rgbw", pixel=file).color_snr_db() != plain
    off = cn.analyze("onyx-rgbw", pixel=file, **{needed: 0.0})
    assert off.color_snr_db() == plain


@pytest.mark.parametrize(
    ("unclipped", "remedies"),
    [
        ({"budget": True}, [("clip", True), ("budget", False)]),
        ({"merit": True}, [("clip", True), ("merit", False)]),
        ({"budget": True, "merit": True}, [("clip", True)]),
    ],
)
def test_clipped_moments_beside_outputs_of_eq_7_name_what_resolves_it(unclipped, remedies):
    with refused_input(subject="clip") as caught:
        cn.analyze("onyx-rgbw", clip=True, **unclipped)
    assert [(one.name, one.omit) for one in caught.value.remedy] == remedies


def test_a_study_file_that_clips_is_refused_with_the_line_that_turns_its_default_budget_off(
    run, tmp_path
):
    file = tmp_path / "study.toml"
    file.write_text('[[sensors]]\nname = "onyx-rgbw"\n[outputs]\nclip = true\n')
    refused(run("run", file), "set outputs.budget = false", setting="outputs.clip")
    refused(run("analyze", "onyx-rgbw", "--clip", "--budget"), "omit --clip", "omit --budget")


def test_an_rtn_amplitude_needs_a_share_of_pixels_that_have_it():
    with refused_input(subject="rtn_amplitude_e", value=20.0):
        cn.analyze("onyx-rgbw", rtn_amplitude_e=20.0)
    sweep = {"vary": "rtn-share", "first": 0.01, "last": 0.5, "points": 3}
    found = cn.compare("onyx-rgbw", **sweep, time_ms=10.0, rtn_amplitude_e=200.0)
    one = cn.analyze("onyx-rgbw", time_ms=10.0, rtn_share=0.5, rtn_amplitude_e=200.0)
    assert found.curves[0].value[-1] == pytest.approx(one.color_snr_db()["onyx-rgbw"]["Y"], 1e-12)


def test_a_share_of_rtn_pixels_without_an_amplitude_is_noted():
    def notes(**given):
        (point,) = cn.analyze("onyx-rgbw", rtn_share=0.1, **given).points
        return [one for one in point.sensor.notes if "RTN" in one]

    assert len(notes()) == 1
    assert notes(rtn_amplitude_e=20.0) == []


def test_a_refused_value_does_not_make_what_needs_it_a_second_fault(tmp_path):
    pixel = "[sensors.pixel]\nrtn_share = 2\nrtn_amplitude_e = 5\n"
    (tmp_path / "study.toml").write_text(f'[[sensors]]\nname = "onyx-rgbw"\n{pixel}')
    with pytest.raises(InputError) as caught:
        read_study(tmp_path / "study.toml")
    (error,) = errors_in(caught.value)
    assert (error.setting, error.value) == ("sensors.0.pixel.rtn_share", 2.0)
