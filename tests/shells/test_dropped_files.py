"""Files dropped on the page: what each is taken for, and the study that uses it."""

import json

import pytest

from chromanoise.study import study_from_text
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.services import Services
from fronts import front_of_ir_cuts

XYZ = ("X,1.5,0.1,0.2", "Y,0.6,0.9,0.1", "Z,0.1,0.2,1.1")
CLF = """<ProcessList id="a" compCLFversion="3.0" xmlns="urn:AMPAS:CLF:v3.0">
<Matrix inBitDepth="32f" outBitDepth="32f"><Array dim="3 3">1 0 0 0 1 0 0 0 1</Array></Matrix>
</ProcessList>"""
FILES = {
    "crosstalk": "R,G,B\n0.9,0.05,0\n0.05,0.9,0.05\n0,0.05,0.9\n",
    "labeled crosstalk": ",R,G,W\nR,0.9,0.05,0\nG,0.05,0.9,0.05\nW,0,0.05,0.9\n",
    "kernel": "0,0.05,0\n0.05,0.8,0.05\n0,0.05,0\n",
    "wide kernel": "0,0.1,0,0,0\n" + "0,0,0.5,0,0\n" * 2 + "0,0,0,0,0\n" * 2,
    "matrix": "\n".join(("lx/e-,R,G,B", *XYZ)),
    "balanced": "\n".join(("x,R,G,B", *XYZ)),
    "rgb matrix": ",R,G,B\nR,1.5,-0.3,-0.2\nG,-0.2,1.4,-0.2\nB,0,-0.3,1.3\n",
    "numbers": "1.5,-0.3,-0.2\n-0.2,1.4,-0.2\n0,-0.3,1.3\n",
    "photon transfer": "mean_dn,variance_dn2\n10,1\n20,2\n30,3\n",
    "sheet": "sigma_d = 2.4 e-\nmu_e.sat = 9000 e-\n",
    "pixel": 'schema = "chromanoise pixel"\nschema_version = 1\nread_noise_e = 2.4\n',
    "study": 'schema = 1\n[[sensors]]\nname = "onyx-rgb"\n',
    "sensor": "wavelength_nm,R,G,B\n400,0.1,0.2,0.1\n550,0.1,0.5,0.1\n700,0.3,0.1,0.1\n",
    "three rows": "wavelength_nm,R,G\n400,0.1,0.2\n550,0.1,0.5\n700,0.3,0.1\n",
}


@pytest.fixture
def services(uploads):
    return Services(uploads)


@pytest.fixture
def seen(services, uploads):
    """What a dropped file is taken for: the reply of the server."""

    def told(name, content):
        content = content.encode() if isinstance(content, str) else content
        return json.loads(services.previewed(uploads.keep(name, content)))

    return told


def answered(services, study):
    return json.loads(services.answer(json.dumps({"study": study}).encode()))


def faults_of(act, *given):
    with pytest.raises(QuestionError) as caught:
        act(*given)
    return caught.value.faults


@pytest.mark.parametrize(
    ("name", "content", "kinds"),
    [
        ("a.csv", "crosstalk", ["crosstalk"]),
        ("a.csv", "labeled crosstalk", ["crosstalk"]),
        ("a.csv", "kernel", ["crosstalk", "matrix"]),
        ("a.txt", "kernel", ["crosstalk", "matrix"]),
        ("a.csv", "wide kernel", ["crosstalk"]),
        ("a.csv", "matrix", ["matrix"]),
        ("a.csv", "balanced", ["matrix"]),
        ("a.csv", "rgb matrix", ["matrix"]),
        ("a.csv", "numbers", ["matrix"]),
        ("a.csv", "photon transfer", ["pixel"]),
        ("a.txt", "sheet", ["pixel"]),
        ("a.toml", "pixel", ["pixel"]),
        ("a.toml", "study", ["study"]),
        ("a.csv", "sensor", ["sensor"]),
        ("a.csv", "three rows", ["sensor"]),
    ],
)
def test_a_file_is_what_its_content_says(seen, name, content, kinds):
    told = seen(name, FILES[content])
    assert [told["kind"], *(one["kind"] for one in told["others"])] == kinds
    assert {one["id"] for one in told["others"]} <= {told["id"]}


def test_a_front_is_recognized_and_its_members_are_sensors(seen, services):
    told = seen("front.json", front_of_ir_cuts().as_json())
    assert (told["kind"], told["study"], told["others"]) == ("front", None, [])
    for name, member in told["front"]["members"].items():
        assert member["file"] == f"{name}.csv"
        sensor = seen(member["file"], member["text"])
        assert (sensor["kind"], sensor["asks"]) == ("sensor", [])


def test_a_clf_is_a_matrix_under_any_ending(seen):
    for name in ("a.clf", "a.xml"):
        assert seen(name, CLF)["kind"] == "matrix"


@pytest.mark.parametrize("ending", ["csv", "json", "clf"])
def test_a_matrix_that_the_command_line_wrote_is_a_matrix(seen, tmp_path, done, ending):
    path = tmp_path / f"made.{ending}"
    done("matrix", "onyx-rgb", "--time-ms", 10, "--export", path)
    told = seen(path.name, path.read_bytes())
    assert (told["kind"], told["others"]) == ("matrix", [])


@pytest.mark.parametrize(
    ("name", "content", "named"),
    [
        ("a.csv", "", "a.csv"),
        ("a.toml", "", "a.toml"),
        ("a.toml", "a = 1\n[b]\nc = 2\n", "schema"),
        ("a.txt", "hello\nworld\n", "a.txt"),
        ("a.json", '{"a": 1}', "a.json"),
        ("a.csv", "R,G,B\n1.2,0.05,0\n0.05,0.9,0.05\n0,0.05,0.9\n", "1.2"),
        ("a.csv", "R,G,B\n0.9,-0.05,0\n0.05,0.9,0.05\n0,0.05,0.9\n", "-0.05"),
        ("a.json", '{"balanced": [[1, 2], [3, 4]]}', "(2, 2)"),
        ("a.json", '{"matrix_lux_per_e": 5, "channels": 5}', "a.json"),
        ("a.csv", "x,R,G,B\nX," + "1" * 200_000 + "\n\n\n", "a.csv"),
        ("a.clf", "<a/>", "a.clf"),
        ("a.dcp", b"IIRC\x08\x00\x00\x00\x01\x00", "a.dcp"),
        ("a.dng", "text", "a.dng"),
    ],
)
def test_a_file_that_is_none_of_these_is_one_sentence(seen, name, content, named):
    ((where, sentence),) = faults_of(seen, name, content)
    assert where == "file"
    assert named in sentence
    assert "/tmp" not in sentence


def test_the_copied_study_names_the_dropped_files(services, seen):
    mixing, matrix = seen("my mix.csv", FILES["crosstalk"]), seen("cam.csv", FILES["balanced"])
    pixel = seen("pixel.toml", FILES["pixel"])
    sensor = {"name": "onyx-rgb", "crosstalk": mixing["id"], "pixel": {"file": pixel["id"]}}
    study = {"sensors": [sensor, {"name": "onyx-rgb"}], "matrices": [matrix["id"], "kernel"]}
    reply = answered(services, study)
    assert {one.get("fault") for one in reply["parts"].values()} == {None}
    head = reply["parts"]["head"]["sensors"]
    assert [one["read_noise_e"] for one in head] == [2.4, 10.0]
    text = json.dumps(reply["parts"])
    assert "/tmp" not in text
    assert "cam.csv" in text
    assert mixing["id"].removeprefix("upload:") not in text
    told = services.texts(json.dumps({"study": study}).encode())
    copied = study_from_text(json.loads(told)["toml"], source="a test")
    assert copied.matrices == ("cam.csv", "kernel")
    assert copied.sensors[0].crosstalk == "my mix.csv"
    assert copied.sensors[0].pixel.file == "pixel.toml"


def test_a_file_that_does_not_fit_the_sensor_is_refused_beside_its_control(services, seen):
    light = "R,G,B\n0.9,0.3,0\n0.05,0.9,0.05\n0,0.05,0.9\n"  # fits no mosaic of green and others
    other = seen("four.csv", FILES["labeled crosstalk"])["id"]
    for mixing, named in ((seen("light.csv", light)["id"], "light.csv"), (other, "four.csv")):
        study = {"sensors": [{"name": "onyx-rgb", "crosstalk": mixing}]}
        ((where, sentence),) = faults_of(answered, services, study)
        assert where == "sensors.0.crosstalk"
        assert sentence.startswith(named)
    study = {"sensors": [{"name": "onyx-rgbw"}], "matrices": [seen("m.csv", FILES["matrix"])["id"]]}
    ((where, sentence),) = faults_of(answered, services, study)
    assert where.startswith("matrices")
    assert "m.csv" in sentence
