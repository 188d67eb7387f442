"""Files in the studies of the page: which are opened, what of them is told, and when anew."""

import json
import os
import shlex
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from chart_values import stages_of
from chromanoise.base.errors import InputError
from chromanoise.study import read_study, run_study, study_from_data, study_from_text, study_hash
from chromanoise.study.hashes import file_words, with_file_words
from chromanoise.web import answers as answering
from chromanoise.web.answers import ChartReplies
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.page_studies import MOST_SENSORS, Studies, files_of, served_data
from chromanoise.web.previews import PictureReplies
from chromanoise.web.services import Services
from outcomes import refused, refused_input

NM = range(400, 1051, 10)
QE = {"level": "absolute", "per": "photon"}
EVERY_KEY = {
    "light": {"illuminant": "l"},
    "sensors": [
        {"name": "s", "filter": "f", "pixel": {"file": "p"}, "crosstalk": "x"},
        {"name": "t", "crosstalk": 0.1},
    ],
    "matrices": ["kernel", "m.csv"],
    "pictures": [{"cube": "c"}, {"cube": "d"}],
}
PIXEL = {
    **{"dark_current_e_per_s": 40.0, "temperature_c": 45.0, "dark_reference_c": 20.0},
    **{"dark_doubling_k": 6.0, "dsnu_e": 3.0, "prnu": 0.01, "row_noise_e": 2.0},
    **{"black_error_e": 4.0, "bits": 10, "gain_dn_per_e": 0.2},
}


def curves(*, red=0.4):
    rows = (f"{w},{0.1 + red * (w > 590)},{0.5 * (500 < w < 590)},{0.4 * (w < 500)}" for w in NM)
    return "\n".join(["wavelength_nm,R,G,B", *rows]).encode()


def cut(*, height=0.9):
    return "\n".join(["wavelength_nm,transmittance", *(f"{w},{height}" for w in NM)]).encode()


def lamp(*, slope=0.0):
    return "\n".join(
        ["wavelength_nm,power_W", *(f"{w},{1 + slope * (w - 400)}" for w in NM)]
    ).encode()


def cube_bytes(*, first=400, last=1050, level=0.5):
    at = np.arange(first, last + 1, 10.0)
    held = BytesIO()
    np.savez(held, reflectance=np.full((4, 5, at.size), level, np.float32), wavelength_nm=at)
    return held.getvalue()


@pytest.fixture
def answers(uploads):
    return ChartReplies(Studies(uploads))


def asked(answers, study, *want):
    return json.loads(answers.answer({"study": study, "want": list(want)}))


def faults_of(act, *given):
    with pytest.raises(QuestionError) as error:
        act(*given)
    assert error.value.status == 200
    return dict(error.value.faults)


def serving(uploads, path):
    """Answers and pictures of a server that was started with a study's file."""
    data = served_data(read_study(path))
    files = files_of(study_from_data(data, source="the test", keep_idle=True))
    studies = Studies(uploads, files=files)
    return data, ChartReplies(studies), PictureReplies(studies)


# ---- which files are opened ----


def test_every_key_that_may_name_a_file_is_listed_and_can_be_told_otherwise():
    study = study_from_data(EVERY_KEY, source="a test")
    values = {one.where: one.word for one in file_words(study)}
    assert values == {
        "light.illuminant": "l",
        "sensors.0.name": "s",
        "sensors.0.filter": "f",
        "sensors.0.pixel.file": "p",
        "sensors.0.crosstalk": "x",
        "sensors.1.name": "t",
        "matrices.1": "m.csv",
        "pictures.0.cube": "c",
        "pictures.1.cube": "d",
    }
    other = with_file_words(study, lambda one: one.word.upper())
    assert {one.word for one in file_words(other)} == {*"LSFPXTCD", "M.CSV"}


@pytest.mark.parametrize("name", ["/etc/passwd", "../own.csv", "~/own.csv", "/dev/zero", "/etc"])
def test_no_key_of_a_link_opens_a_file_of_its_own(answers, name):
    study = {
        "light": {"illuminant": name},
        "sensors": [
            {"name": name, "filter": name, "pixel": {"file": name}, "crosstalk": name},
        ],
        "matrices": [f"{name}.json"],
        "pictures": [{"cube": name}],
    }
    for act in (answers.answer, answers.texts):
        result = faults_of(act, {"study": study})
        assert len(result) == 7
        assert all("drop the file" in sentence for sentence in result.values())


def test_nothing_may_stand_behind_the_id_of_a_file_but_diodes(uploads, answers):
    one = uploads.keep("cam.csv", curves())
    result = faults_of(answers.answer, {"study": {"sensors": [{"name": f"{one.id}/../x.csv"}]}})
    assert "drop the file" in result["sensors.0.name"]


def test_a_pipe_in_a_served_study_is_refused_and_not_waited_for(uploads, tmp_path):
    os.mkfifo(tmp_path / "cube.npz")
    path = tmp_path / "s.toml"
    path.write_text('[[sensors]]\nname = "onyx-rgb"\n[[pictures]]\ncube = "cube.npz"\n')
    with refused_input(subject=str(tmp_path / "cube.npz"), value="a pipe"):
        serving(uploads, path)


def test_a_served_study_whose_cube_was_moved_away_is_told_so(uploads, tmp_path):
    cube, path = tmp_path / "cube.npz", tmp_path / "s.toml"
    cube.write_bytes(cube_bytes())
    path.write_text('[[sensors]]\nname = "onyx-rgb"\n[[pictures]]\ncube = "cube.npz"\n')
    result, answers, _ = serving(uploads, path)
    assert asked(answers, result, "head")["parts"]["head"]["sensors"]
    cube.unlink()
    assert "cube.npz" in faults_of(answers.answer, {"study": result})["pictures.0.cube"]


def test_a_dropped_cube_in_the_study_is_answered(uploads, answers):
    cube = uploads.keep("wall.npz", cube_bytes())
    study = {"sensors": [{"name": "onyx-rgb"}], "pictures": [{"cube": cube.id}]}
    assert asked(answers, study, "head")["parts"]["head"]["sensors"]


def test_a_served_lamp_stays_when_the_diode_beside_it_is_moved(uploads, tmp_path):
    (tmp_path / "lamp.csv").write_bytes(lamp())
    path = tmp_path / "s.toml"
    path.write_text(
        '[[sensors]]\nname = "onyx-rgb"\n'
        '[light]\nilluminant = "lamp.csv+0.5xLED850"\nper = "energy"\n'
    )
    result, answers, _ = serving(uploads, path)
    result["light"]["illuminant"] = result["light"]["illuminant"].replace("0.5x", "0.7x")
    assert asked(answers, result, "head")["parts"]["head"]["light"]["name"].endswith("+0.7xLED850")


# ---- what is copied, and its hash ----


def test_a_study_with_all_noise_of_a_pixel_is_answered_and_its_copies_keep_it(answers):
    noisy = {"crosstalk": 0.1, "crosstalk_stage": "charge", "mosaic": "bayer"}
    study = {"sensors": [{"name": "onyx-rgb", "pixel": PIXEL, **noisy}]}
    head, plain = (
        stages_of(asked(answers, one, "stages")["parts"]["stages"])[0]
        for one in (study, {"sensors": [{"name": "onyx-rgb"}]})
    )
    assert head["color SNR"]["Y"] < plain["color SNR"]["Y"] - 2
    message = answers.texts({"study": study})
    copied = study_from_text(message["toml"], source="a test").sensors[0]
    assert copied.pixel.model_dump(exclude_none=True) == PIXEL
    assert copied.model_dump(include=set(noisy)) == noisy
    for name, value in (PIXEL | noisy).items():
        assert f"{name}={json.dumps(value)}" in message["python"]
        assert f"--{name.replace('_', '-')} {value}" in message["command"]


def test_served_files_of_crosstalk_and_matrix_are_read_and_read_again(uploads, tmp_path, done):
    mix, path = tmp_path / "mix.csv", tmp_path / "s.toml"
    mix.write_text("R,G,B\n0.9,0.05,0\n0.05,0.9,0.05\n0,0.05,0.9\n")
    made = (tmp_path / "made.csv", "onyx-rgb", "--time-ms", 10, "--export")
    done("matrix", *made[1:], made[0])
    path.write_text(
        '[[sensors]]\nname = "onyx-rgb"\ncrosstalk = "mix.csv"\n[exposure]\ntime_ms = 10\n'
    )
    path.write_text('matrices = ["made.csv"]\n' + path.read_text())
    result, answers, _ = serving(uploads, path)

    def snr_db():
        (sensor,) = stages_of(asked(answers, result, "stages")["parts"]["stages"])
        return sensor["raw SNR"]["R"], sensor["color SNR"]["Y"]

    first = snr_db()
    done("matrix", *made[1:], made[0], "--matrix", "lmmse")
    second = snr_db()
    mix.write_text("R,G,B\n0.7,0,0\n0.1,1,0.1\n0,0,0.7\n")
    third = snr_db()
    assert first[0] == second[0] > third[0]
    assert first[1] != pytest.approx(second[1], abs=0.01)
    mix.unlink()
    assert "mix.csv" in faults_of(answers.answer, {"study": result})["sensors.0.crosstalk"]


def test_the_name_of_a_dropped_file_is_quoted_in_a_copied_command(uploads, answers):
    one = uploads.keep("my sensor; touch x #.csv", curves())
    study = {"sensors": [{"name": one.id, "answers": QE}]}
    message = answers.texts({"study": study})
    assert shlex.split(message["command"])[:3] == ["chromanoise", "analyze", one.label]
    assert study_from_text(message["toml"], source="a test").sensors[0].name == one.label
    odd = uploads.keep("a\"b\\c'd.csv", curves(red=0.3))
    message = answers.texts({"study": {"sensors": [{"name": odd.id, "answers": QE}]}})
    assert study_from_text(message["toml"], source="a test").sensors[0].name == odd.label
    compile(message["python"], "a test", "exec")


def test_the_hash_of_a_page_is_that_of_a_run_beside_the_same_files(
    uploads, answers, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    files = {"cam.csv": curves(), "cut.csv": cut(), "lamp.csv": lamp(), "wall.npz": cube_bytes()}
    kept = {name: uploads.keep(name, content).id for name, content in files.items()}
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)

    def study(named):
        return {
            "light": {"illuminant": f"{named['lamp.csv']}+0.5xLED850", "per": "energy"},
            "sensors": [{"name": named["cam.csv"], "filter": named["cut.csv"], "answers": QE}],
            "pictures": [{"cube": named["wall.npz"]}],
        }

    result = asked(answers, study(kept), "head")["hash"]
    beside = study_from_data(study({name: name for name in files}), source="a test")
    assert result == study_hash(beside)
    (tmp_path / "cut.csv").write_bytes(cut(height=0.8))
    assert result != study_hash(beside)


def test_two_files_of_one_name_stay_two_in_what_is_copied(uploads, answers):
    pair = [uploads.keep("cam.csv", curves(red=red)) for red in (0.3, 0.4)]
    study = {"sensors": [{"name": one.id, "answers": QE} for one in pair]}
    message = answers.texts({"study": study})["toml"]
    names = [part.name for part in study_from_text(message, source="a test").sensors]
    assert names == ["cam.csv", "cam (2).csv"]


# ---- numbers follow their files ----


@pytest.mark.parametrize("name", ["cam.csv", "cut.csv", "lamp.csv"])
def test_a_file_that_is_written_anew_gives_new_numbers(uploads, tmp_path, name):
    files = {"cam.csv": curves(), "cut.csv": cut(), "lamp.csv": lamp()}
    anew = {"cam.csv": curves(red=0.2), "cut.csv": cut(height=0.3), "lamp.csv": lamp(slope=0.01)}
    for one, content in files.items():
        (tmp_path / one).write_bytes(content)
    path = tmp_path / "s.toml"
    path.write_text(
        '[[sensors]]\nname = "cam.csv"\nfilter = "cut.csv"\nanswers.level = "absolute"\n'
        'answers.per = "photon"\n[exposure]\ntime_ms = 10\n'
        '[light]\nilluminant = "lamp.csv+0.5xLED850"\nper = "energy"\n'
    )
    result, answers, pictures = serving(uploads, path)
    before = asked(answers, result, "head")["parts"]["head"]["sensors"][0]["mean_e"]
    seen = pictures.picture({"study": result, "noisy": False})[1]
    (tmp_path / name).write_bytes(anew[name] + b"\n")
    after = asked(answers, result, "head")["parts"]["head"]["sensors"][0]["mean_e"]
    assert after["R"] != pytest.approx(before["R"], rel=0.01)
    assert (
        json.loads(pictures.picture({"study": result, "noisy": False})[1])["mean_e"]
        != (json.loads(seen)["mean_e"])
    )


def test_a_drawing_that_failed_for_want_of_something_is_tried_again(answers, monkeypatch, caplog):
    study = {"sensors": [{"name": "onyx-rgb"}]}

    def fails(*given):
        raise MemoryError

    with monkeypatch.context() as patched:
        patched.setattr(answering, "drawing", fails)
        assert "fault" in asked(answers, study, "stages")["parts"]["stages"]
    assert "the drawing stages failed" in caplog.text
    assert asked(answers, study, "stages")["parts"]["stages"]["panels"]


def test_what_is_wrong_with_one_study_is_not_said_of_the_next(answers, monkeypatch):
    def refuses(*given, **named):
        raise InputError("the matrix", "cannot be made")

    study = {"sensors": [{"name": "onyx-rgb"}], "exposure": {"time_ms": 10.0}}
    with monkeypatch.context() as patched:
        patched.setattr(answering, "shown", refuses)
        result = asked(answers, study | {"matrices": ["lmmse"]}, "sensitivities")
        assert result["parts"]["sensitivities"]["fault"] == "the matrix: cannot be made"
    result = asked(answers, study, "sensitivities")  # which depend on no matrix
    assert result["parts"]["sensitivities"]["panels"]


# ---- one sensor twice ----


def test_a_sensor_beside_its_changed_self_is_shown_copied_and_run_under_the_same_names(
    uploads, answers, tmp_path
):
    study = {"sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgbw", "shift_nm": 10.0}]}
    assert "shift_nm" in answers.texts({"study": study})["python"]
    shown = [one["name"] for one in asked(answers, study, "head")["parts"]["head"]["sensors"]]
    path = tmp_path / "s.toml"
    path.write_text(answers.texts({"study": study})["toml"] + '[[pictures]]\nformats = ["png"]\n')
    run_study(read_study(path), tmp_path / "o")
    data = json.loads((tmp_path / "o" / "analysis-kernel.json").read_bytes())["result"]
    assert shown == ["onyx-rgbw", "onyx-rgbw (2)"]
    assert [name for name in shown if json.dumps(name) in json.dumps(data)] == shown
    assert len(list((tmp_path / "o").glob("*.png"))) == 2


def test_a_sensor_beside_its_unchanged_self_is_refused_in_one_sentence(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(2 * '[[sensors]]\nname = "onyx-rgbw"\n')
    with refused_input(subject="name", value="onyx-rgbw") as caught:
        read_study(path)
    assert str(caught.value).startswith(f"{path}:4: sensors.1.name: ")


# ---- what is served ----


def test_more_sensors_than_the_page_shows_are_refused_before_anything_is_served(run, tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(
        "".join(
            f'[[sensors]]\nname = "onyx-rgb"\nshift_nm = {i}.0\n' for i in range(MOST_SENSORS + 1)
        )
    )
    refused(run("serve", path, "--port", 0), f"{path}: sensors", f" {MOST_SENSORS + 1}")


# ---- the picture ----


def pixels(png):
    return np.asarray(Image.open(BytesIO(png)))


def test_the_picture_of_a_served_study_is_that_of_its_run(uploads, tmp_path):
    (tmp_path / "wall.npz").write_bytes(cube_bytes(last=700, level=50.0))
    path = tmp_path / "s.toml"
    path.write_text(
        'seed = 3\n[[sensors]]\nname = "onyx-rgb-ircut"\n[[pictures]]\ncube = "wall.npz"\n'
        'scale = 0.01\nbeyond = "zero"\nclip = true\nrow_noise_e = 20.0\nformats = ["png"]\n'
    )
    result, _, pictures = serving(uploads, path)
    png, summary = pictures.picture({"study": result})
    run_study(read_study(path), tmp_path / "o")
    (file,) = (tmp_path / "o").glob("*.png")
    np.testing.assert_array_equal(pixels(png), pixels(file.read_bytes()))
    assert json.loads(summary)["clipped"]
    result["pictures"][0]["beyond"] = "refuse"
    (sentence,) = faults_of(pictures.picture, {"study": result}).values()
    assert "700" in sentence


def test_a_dropped_cube_that_ends_short_is_held_and_the_summary_says_so(uploads):
    short = uploads.keep("wall.npz", cube_bytes(last=700))
    study = {"sensors": [{"name": "onyx-rgb"}], "pictures": [{"cube": short.id}]}
    png, summary = PictureReplies(Studies(uploads)).picture({"study": study})
    assert pixels(png).shape == (4, 5, 3)
    assert any("hold beyond 400-700 nm" in note for note in json.loads(summary)["notes"])
    assert "tmp" not in summary


def test_a_lamp_that_is_exchanged_gives_another_picture(uploads):
    pictures = PictureReplies(Studies(uploads))
    study = {"sensors": [{"name": "onyx-rgb"}]}
    one, other = (
        pictures.picture({"study": study | {"light": {"illuminant": name}}, "noisy": False})[0]
        for name in ("E", "A")
    )
    assert one != other


def test_a_fault_of_a_picture_is_told_where_it_stands(uploads):
    pictures = PictureReplies(Studies(uploads))
    study = {"sensors": [{"name": "onyx-rgb"}], "pictures": [{"scale": 2.0}]}
    assert "scale" in faults_of(pictures.picture, {"study": study})["pictures.0.cube"]
    for word in ("/etc/passwd", "builtin:moon", "upload:0123456789abcdef"):
        assert faults_of(
            pictures.picture, {"study": {"sensors": [{"name": "onyx-rgb"}]}, "cube": word}
        )["cube"]


def test_the_digest_of_a_cube_is_taken_once_while_it_stays_the_same(uploads, tmp_path, monkeypatch):
    (tmp_path / "wall.npz").write_bytes(cube_bytes())
    path = tmp_path / "s.toml"
    path.write_text('[[sensors]]\nname = "onyx-rgb"\n[[pictures]]\ncube = "wall.npz"\n')
    result, answers, _ = serving(uploads, path)
    first = asked(answers, result, "head")["hash"]
    from chromanoise.web import page_studies as studies

    monkeypatch.setattr(studies, "digests_of", None)
    assert asked(answers, result, "head")["hash"] == first


def test_a_desk_warms_with_the_study_that_it_was_given(uploads):
    study = {"sensors": [{"name": "onyx-rgb"}]}
    services = Services(uploads, study=study)
    services.warm()
    assert json.loads(services.choices())["study"] == study
