"""The page's server: what it answers, whom it refuses, and that nothing brings it down."""

import json
import re
import shlex
import signal
import socket
import subprocess
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import httpx
import pytest

from chart_values import stages_of
from chromanoise.charts import PARTS, as_data, drawing, shown
from chromanoise.charts.explanations import EXPLANATIONS
from chromanoise.study import study_from_data, study_from_text
from chromanoise.web.requests import JSON_BYTES, UPLOAD_BYTES, asset
from chromanoise.web.server import listening_socket, page_server
from chromanoise.web.uploads import MOST_FILES, Uploads
from outcomes import refused
from processes import IGNORING, Patient, command, printed
from spectrum_samples import CAMERA_CSV

BOTH = {
    "light": {"illuminant": "E", "level_lux": 10.0},
    "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut"}],
}
FILE = {"Content-Type": "application/octet-stream"}


@pytest.fixture(scope="module")
def address():
    """A server of its own thread, stopped when the module's tests are done."""
    listening = listening_socket(0)
    server = page_server(listening)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    yield f"http://127.0.0.1:{listening.getsockname()[1]}"
    server.should_exit = True
    thread.join(20)
    listening.close()
    assert not thread.is_alive()


@pytest.fixture(scope="module")
def client(address):
    with httpx.Client(base_url=address, timeout=600, transport=Patient()) as asking:
        yield asking


def answered(client, question, **headers):
    return client.post("/api/answer", json=question, headers=headers)


def sentence_of(reply, status):
    assert reply.status_code == status, reply.text[:300]
    (fault, *_) = reply.json()["faults"]
    assert fault["sentence"]
    return fault["sentence"]


def uploaded(client, name, content):
    return client.post("/api/upload", content=content, headers=FILE | {"X-Filename": name})


def test_an_answer_has_the_digits_of_the_library(client):
    record = answered(client, {"number": 7, "study": BOTH}).json()
    of = shown(study_from_data(BOTH, source="a test"))
    assert record["number"] == 7
    assert re.fullmatch("[0-9a-f]{64}", record["hash"])
    assert list(record["parts"]) == list(PARTS)
    for part, data in record["parts"].items():
        assert data == json.loads(json.dumps(as_data(drawing(part, of))))


def test_only_what_is_wanted_is_answered_and_what_changes_nothing_is_remembered(client):
    question = {"number": 1, "study": BOTH, "want": ["sensitivities"]}
    first = answered(client, question).json()
    dim = BOTH | {"light": {"illuminant": "E", "level_lux": 3.0}}
    again = answered(client, question | {"study": dim, "number": 2}).json()
    assert list(first["parts"]) == ["sensitivities"]
    assert again["parts"] == first["parts"]
    assert again["number"] == 2
    assert again["hash"] != first["hash"]


def test_an_answer_clips_where_the_study_does_and_is_not_that_of_the_unclipped_one(client):
    dark = BOTH | {"light": {"illuminant": "E", "level_lux": 0.01}, "exposure": {"time_ms": 12.0}}
    luminance = {}
    for clip in (False, True):
        study = dark | {"outputs": {"clip": clip, "budget": False}}
        data = answered(client, {"study": study, "want": ["stages"]}).json()
        luminance[clip] = stages_of(data["parts"]["stages"])[0]["color SNR"]["Y"]
    assert luminance == pytest.approx({False: -15.81, True: -16.25}, abs=0.01)


def test_a_look_changes_the_drawing_that_reads_it(client):
    question = {"study": BOTH, "want": ["budget", "ellipses"]}
    result = answered(
        client, question | {"look": {"coordinate": "b*", "plane": "xy", "theme": "x"}}
    )
    assert result.json()["parts"]["budget"]["panels"][0]["x"]["label"] == "SNR of b* [dB]"
    assert result.json()["parts"]["ellipses"]["panels"][0]["x"]["label"] == "x"


def test_explanations_have_words_formulas_symbols_and_a_source(client):
    found = client.get("/api/explanations").json()
    assert found.keys() == EXPLANATIONS.keys()
    for one in found.values():
        assert one["title"]
        assert one["words"]
        assert one["source"]
        shown = [*one["formulas"], *(symbol["symbol"] for symbol in one["symbols"])]
        assert all(formula.startswith("<math") for formula in shown)


def test_choices_hold_sensors_lights_and_sliders(client):
    data = client.get("/api/choices").json()
    names = [sensor["name"] for sensor in data["sensors"]]
    assert {"onyx-rgbw", "onyx-rgb-ircut", "model-rgbir"} <= set(names)
    assert {"E", "A", "G173"} <= set(data["illuminants"])
    assert {"light.level_lux", "light.infrared"} <= {s["key"] for s in data["sliders"]}
    assert {"sensors.ircut_nm", "observer"} <= {one["key"] for one in data["fields"]}
    assert study_from_data(data["study"], source="the page's own").sensors


def test_a_body_that_says_it_is_too_long_is_refused_before_it_comes(address):
    host, _, port = address.removeprefix("http://").partition(":")
    for path, kind in (("upload", "octet-stream"), ("answer", "json")):
        with socket.create_connection((host, int(port)), timeout=10) as asking:
            head = f"POST /api/{path} HTTP/1.1\r\nHost: {host}:{port}\r\nX-Filename: a.csv\r\n"
            kinds = f"Content-Type: application/{kind}\r\nContent-Length: {10**12}\r\n\r\n"
            asking.sendall((head + kinds).encode())
            received = b""
            while b"exceeds the limit" not in received:
                piece = asking.recv(4096)
                assert piece, received
                received += piece
            assert received.startswith(b"HTTP/1.1 413")


def test_a_number_of_thousands_of_digits_is_one_sentence(client):
    body = b'{"number": ' + b"1" * 6000 + b"}"
    reply = client.post("/api/answer", content=body, headers={"Content-Type": "application/json"})
    assert "key 'number'" in sentence_of(reply, 400)
    data = uploaded(client, "a.toml", "seed = " + "1" * 6000).json()["faults"]
    (fault,) = data
    assert fault["sentence"].startswith("a.toml: ")


def test_no_header_waits_for_its_answer_on_the_socket():
    with closing(listening_socket(0)) as listening:
        # what asyncio asks for before it sends short answers at once
        assert listening.proto == socket.IPPROTO_TCP


def test_texts_are_the_study_again(client):
    data = client.post("/api/texts", json={"study": BOTH}).json()
    assert study_from_text(data["toml"], source="a test") == study_from_data(BOTH, source="a test")
    assert data["command"].startswith("chromanoise ")
    compile(data["python"], "a test", "exec")


def test_a_picture_is_a_png_of_its_cube_and_tells_how_it_was_taken(client):
    question = {"study": BOTH, "sensor": 1, "noisy": False, "cube": None}
    still = client.post("/api/picture", json=question)
    noisy = client.post("/api/picture", json=question | {"noisy": True})
    assert still.headers["content-type"] == "image/png"
    assert still.content.startswith(b"\x89PNG")
    assert still.content != noisy.content
    assert json.loads(noisy.headers["x-chromanoise-summary"])["mean_e"]
    assert "no sensor 2" in sentence_of(
        client.post("/api/picture", json=question | {"sensor": 2}), 200
    )


def test_all_faults_of_a_study_are_told_each_with_its_key(client):
    study = {"light": {"level_lux": -1.0}, "sensors": [{"nam": "x"}], "matrices": ["kernl"]}
    faults = answered(client, {"study": study}).json()["faults"]
    where = {fault["where"] for fault in faults}
    assert {"light.level_lux", "sensors.0.name", "sensors.0.nam"} <= where


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"sensors": [{"name": "onyx-rgbw"}, {"name": "onix"}]}, "sensors.1.name"),
        ({"light": {"illuminant": "moon"}}, "light.illuminant"),
        ({"sensors": [{"name": "onyx-rgbw"}] * 11}, "sensors"),
        ({"sensors": [{"name": "upload:0123456789abcdef"}]}, "sensors.0.name"),
        ({"sensors": [{"name": "onyx\u0000"}]}, "sensors.0.name"),
    ],
)
def test_a_word_that_names_nothing_is_told_beside_it(client, change, where):
    reply = answered(client, {"study": BOTH | change})
    assert sentence_of(reply, 200)
    assert reply.json()["faults"][0]["where"] == where


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "localhost"},
        {"Host": "127.0.0.1:1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://localhost:1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
    ids=lambda h: " ".join(h.values()),
)
def test_whoever_is_not_this_page_is_refused(client, headers):
    assert sentence_of(answered(client, {"study": BOTH}, **headers), 403)
    assert sentence_of(client.get("/", headers=headers), 403)
    assert sentence_of(client.get("/api/choices", headers=headers), 403)


def test_the_page_itself_and_a_link_that_somebody_follows_are_let_in(client, address):
    port = address.rpartition(":")[2]
    for name in ("localhost", "127.0.0.1", "[::1]"):
        own = {"Host": f"{name}:{port}", "Origin": f"http://{name}:{port}"}
        assert answered(client, {"study": BOTH, "want": []}, **own).status_code == 200
    link = {"Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "document"}
    followed = link | {"Sec-Fetch-Site": "cross-site"}
    assert client.get("/", headers=followed).status_code == 200
    assert client.get("/api/choices", headers=followed).status_code == 403
    framed = followed | {"Sec-Fetch-Dest": "iframe"}
    assert client.get("/", headers=framed).status_code == 403


def test_every_reply_carries_the_headers_that_keep_it_here(client):
    for reply in (client.get("/"), client.get("/api/choices"), client.get("/nowhere")):
        policy = reply.headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "http" not in policy
        assert "unsafe" not in policy
        assert reply.headers["x-content-type-options"] == "nosniff"
        assert reply.headers["referrer-policy"] == "no-referrer"
        assert reply.headers["cross-origin-opener-policy"] == "same-origin"
        assert "access-control-allow-origin" not in reply.headers
    assert client.get("/api/choices").headers["cache-control"] == "no-store"


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"{",
        b"[]",
        b"\xff\xfe",
        b'{"number": "seven"}',
        b'{"number": true}',
        b'{"want": ["waterfall"]}',
        b'{"want": [{}]}',
        b'{"look": {"magnification": "big"}}',
        b'{"study": 3}',
        b"[" * 100_000,
        b'{"study":' * 20_000 + b"1" + b"}" * 20_000,
    ],
    ids=lambda body: body[:24].decode("latin-1"),
)
def test_what_is_no_question_gets_one_clear_sentence(client, body):
    headers = {"Content-Type": "application/json"}
    assert sentence_of(client.post("/api/answer", content=body, headers=headers), 400)


@pytest.mark.parametrize("look", [{"plane": "uv"}, {"magnification": -1}])
def test_a_look_that_cannot_be_is_told_in_a_sentence(client, look):
    assert sentence_of(answered(client, {"look": look, "study": BOTH}), 200)


@pytest.mark.parametrize(
    "light",
    [
        {"level_lux": 1e-300},
        {"level_lux": 1e300},
        {"illuminant": "E+1e300xLED850"},
        {"illuminant": "x" * 100_000},
        {"illuminant": "E+" * 20_000},
        {"illuminant": "0K"},
    ],
    ids=lambda light: str(light)[:40],
)
def test_numbers_and_words_out_of_reason_are_refused_in_a_sentence(client, light):
    reply = answered(client, {"study": BOTH | {"light": light}})
    assert len(sentence_of(reply, 200)) < 2000


def test_a_question_that_is_not_json_or_too_long_is_refused(client):
    form = {"Content-Type": "text/plain"}
    assert sentence_of(client.post("/api/answer", content=b"{}", headers=form), 415)
    long = b'{"a": "' + b"x" * JSON_BYTES + b'"}'
    headers = {"Content-Type": "application/json"}
    assert "MB" in sentence_of(client.post("/api/answer", content=long, headers=headers), 413)


def test_a_body_in_pieces_without_length_is_stopped_where_it_is_too_long(address):
    sent = 0

    def endless():
        nonlocal sent
        while sent < 100 * JSON_BYTES:
            sent += 65_536
            yield b"x" * 65_536

    headers = {"Content-Type": "application/json"}
    try:
        reply = httpx.post(f"{address}/api/answer", content=endless(), headers=headers, timeout=30)
        assert reply.status_code == 413
    except (httpx.WriteError, httpx.ReadError):
        pass  # the server hung up while we still spoke
    assert sent < 60 * JSON_BYTES


def test_a_dropped_sensor_is_previewed_and_answers_under_its_own_name(client):
    data = uploaded(client, "my%20sensor.csv", CAMERA_CSV).json()
    assert data["kind"] == "sensor"
    assert "R, G, B" in data["preview"][0]
    answers = {"level": "absolute", "per": "photon"}
    study = BOTH | {"sensors": [{"name": data["id"], "answers": answers}, {"name": "onyx-rgbw"}]}
    head = answered(client, {"study": study, "want": ["head"]}).json()["parts"]["head"]
    assert head["sensors"][0]["name"] == "my sensor"
    assert "upload" not in json.dumps(head)
    assert "tmp" not in json.dumps(head)


@pytest.mark.evidence
def test_the_copied_command_names_a_dropped_file_and_runs_twice_where_the_file_lies(
    client, run, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my sensor.csv").write_text(CAMERA_CSV)
    used = {"name": uploaded(client, "my%20sensor.csv", CAMERA_CSV).json()["id"], "label": "mine"}
    used["answers"] = {"level": "absolute", "per": "photon"}
    for matrices in (["kernel"], ["kernel", "lmmse"]):
        study = BOTH | {"sensors": [used, {"name": "onyx-rgbw"}], "matrices": matrices}
        command = client.post("/api/texts", json={"study": study}).json()["command"]
        line, _, text = command.partition(" <<'STUDY'\n")
        (tmp_path / "stdin").write_text(text.removesuffix("STUDY"))
        words = ["stdin" if one == "/dev/stdin" else one for one in shlex.split(line)]
        for _ in range(2):
            code, _, err = run(*words[1:])
            assert code == 0, err


def test_a_dropped_light_answers_with_infrared_beside_it(client):
    rows = "\n".join(f"{nm},1.0" for nm in range(400, 1051, 10))
    data = uploaded(client, "lamp.csv", f"wavelength_nm,power_W\n{rows}").json()
    assert data["kind"] == "light"
    light = {"illuminant": f"{data['id']}+0.5xLED850", "per": "energy"}
    head = answered(client, {"study": BOTH | {"light": light}, "want": ["head"]}).json()
    assert head["parts"]["head"]["light"]["name"].startswith("lamp")


def test_a_lamp_that_is_1_at_its_peak_is_no_wrong_lamp_and_keeps_the_name_of_its_file(client):
    lamp = b"wavelength_nm,power\n" + b"".join(
        b"%d,%.2f\n" % (w, w / 1050) for w in range(400, 1051, 10)
    )
    data = uploaded(client, "night.csv", lamp).json()
    assert data["kind"] == "light"
    assert not any("Looks wrong" in line for line in data["preview"])
    light = {"illuminant": f"{data['id']}+0.3xLED850", "per": "energy"}
    reply = answered(client, {"number": 1, "study": BOTH | {"light": light}})
    assert "exactly 1" not in reply.text
    assert "night.csv" in reply.text
    assert data["id"].removeprefix("upload:") not in json.dumps(reply.json()["parts"])


def test_a_dropped_study_comes_back_as_data(client):
    data = uploaded(client, "a.toml", b'title = "T"\n[[sensors]]\nname = "onyx-rgb"\n').json()
    assert data["kind"] == "study"
    assert data["study"]["sensors"][0]["name"] == "onyx-rgb"
    bad = uploaded(client, "b.toml", b"[[sensors]]\nnam = 3\n")
    assert any("b.toml:2" in fault["sentence"] for fault in bad.json()["faults"])


@pytest.mark.parametrize(
    "name",
    [
        "..%2F..%2F..%2Ftmp%2Fevil.csv",
        "%2Fetc%2Fpasswd.csv",
        "C%3A%5Cwindows%5Cx.csv",
        "%00.csv",
        "a%0D%0AX-Evil%3A%201.csv",
        ".csv.csv",
        "x" * 3000 + ".csv",
    ],
)
def test_a_name_never_becomes_a_path(client, tmp_path, name):
    reply = uploaded(client, name, CAMERA_CSV)
    data = reply.json()
    assert reply.status_code == 200
    assert not re.search(r"/etc|/tmp|windows|\.\.", reply.text)
    assert "x-evil" not in reply.headers
    if "faults" not in data:
        assert re.fullmatch("upload:[0-9a-f]{16}[.]csv", data["id"])


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.exe", b"MZ"),
        ("noending", b"1,2"),
        ("a.csv", b""),
        ("a.csv", b"\x00\xff" * 500),
        ("a.json", b"{"),
        ("a.json", b"[" * 50_000),
        ("a.xlsx", b"PK\x03\x04 no archive"),
        ("a.npz", b"PK\x03\x04 no archive"),
        ("a.mat", b"MATLAB 5.0 MAT-file" + b"\x00" * 200),
        ("a.h5", b"\x89HDF\r\n\x1a\n" + b"\x00" * 100),
        ("a.toml", b"a." * 40_000 + b" = 1"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_file_that_cannot_be_read_is_told_in_a_sentence(client, name, content):
    message = sentence_of(uploaded(client, name, content), 200)
    assert "Traceback" not in message
    assert "/tmp" not in message


def test_a_spectrum_of_ten_megabytes_or_a_hundred_thousand_points_is_refused_at_once(client):
    row = b"500.123456,0.123456789\n"
    large = b"wavelength_nm,G\n" + row * (10_000_000 // len(row))
    assert "10.0 MB" in sentence_of(uploaded(client, "large.csv", large), 200)
    points = "\n".join(f"{400 + 650 * i / 99_999:.6f},0.5" for i in range(100_000))
    fine = uploaded(client, "fine.csv", f"wavelength_nm,G\n{points}")
    assert "fine.csv" in sentence_of(fine, 200)
    points = "\n".join(f"{400 + 650 * i / 9_999:.6f},0.5" for i in range(10_000))
    assert uploaded(client, "fair.csv", f"wavelength_nm,G\n{points}").json()["id"]


def test_an_upload_beyond_the_limit_is_refused_before_it_is_read(client):
    assert "MB" in sentence_of(uploaded(client, "a.csv", b"x" * (UPLOAD_BYTES + 1)), 413)


def test_of_many_uploads_the_oldest_go():
    uploads = Uploads()
    kept = [uploads.keep(f"{i}.csv", f"{i}".encode()) for i in range(MOST_FILES + 3)]
    assert [one.path.exists() for one in kept] == [False] * 3 + [True] * MOST_FILES
    folder = kept[-1].path.parent
    uploads.close()
    assert not folder.exists()


@pytest.mark.evidence
def test_two_hundred_questions_at_once_all_get_an_answer_and_the_server_lives(address):
    every = httpx.Limits(max_connections=200)
    with httpx.Client(base_url=address, timeout=600, limits=every) as many:

        def ask(i):
            study = {"light": {"level_lux": 5.0 + i % 25}, "sensors": [{"name": "onyx-rgbw"}]}
            question = {"number": i, "study": study, "want": ["vectors"]}
            reply = many.post("/api/answer", json=question)
            data = reply.json()
            assert reply.status_code in (200, 503)
            return data["number"] == i if reply.status_code == 200 else bool(data["faults"])

        with ThreadPoolExecutor(200) as pool:
            assert all(pool.map(ask, range(200)))
        assert answered(many, {"study": BOTH, "want": ["head"]}).status_code == 200


def test_whoever_hangs_up_in_the_middle_harms_nobody(address, client, capfd):
    port = int(address.rpartition(":")[2])
    head = f"POST /api/answer HTTP/1.1\r\nHost: localhost:{port}\r\n"
    head += "Content-Type: application/json\r\n"
    whole = json.dumps({"study": BOTH}).encode()
    for length, sent in ((1000, b'{"study"'), (len(whole), whole), (1000, b"")):
        with socket.create_connection(("127.0.0.1", port)) as lost:
            lost.sendall(f"{head}Content-Length: {length}\r\n\r\n".encode() + sent)
    assert answered(client, {"study": BOTH, "want": ["head"]}).status_code == 200
    result = capfd.readouterr()
    assert "Traceback" not in result.err


def test_files_of_the_page_come_with_a_tag_and_nothing_else_comes(client):
    for path in ("/assets/../server.py", "/assets/%2e%2e/server.py", "/assets/.hidden", "/assets/"):
        assert client.get(path).status_code == 404
    for path in ("/assets/app/../../server.py", "/assets//etc/passwd", "/assets/a%00.js", "/x"):
        assert client.get(path).status_code == 404
    assert asset("index.html") is not None
    first = client.get("/")
    again = client.get("/", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


def test_what_is_asked_in_another_way_is_told_so(client):
    assert sentence_of(client.get("/api/answer"), 405)
    assert sentence_of(client.post("/api/nothing", json={}), 404)


def test_serve_tells_its_address_answers_soon_and_ends_with_ctrl_c(tmp_path):
    study = tmp_path / "study.toml"
    study.write_text('title = "T"\n[[sensors]]\nname = "model-rgbir"\n', encoding="utf-8")
    with command("serve", study, "--port", 0, PYTHONUNBUFFERED="1") as process:
        address = process.stdout.readline().split()[0]
        assert re.fullmatch(r"http://localhost:\d+/", address)
        assert httpx.get(address, timeout=300).status_code == 200
        choices = httpx.get(f"{address}api/choices", timeout=300).json()
        assert choices["study"]["sensors"][0]["name"] == "model-rgbir"
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=300)
    assert (process.returncode, errors) == (0, "")


@pytest.mark.evidence
def test_a_server_started_with_sigint_ignored_ends_only_by_sigterm():
    with command("serve", "--port", 0, script=IGNORING, PYTHONUNBUFFERED="1") as process:
        address = process.stdout.readline().split()[0]
        assert httpx.get(address, timeout=300).status_code == 200
        process.send_signal(signal.SIGINT)
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(timeout=1)
        assert httpx.get(address, timeout=300).status_code == 200
        process.terminate()
        _, errors = process.communicate(timeout=300)
    assert (process.returncode, errors) == (0, "")


def test_a_port_that_is_taken_is_told_in_one_sentence(run):
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        refused(run("serve", "--port", port), "--port", str(port))


def test_a_study_that_cannot_be_read_is_told_before_anything_is_served(run, tmp_path):
    bad = tmp_path / "bad.toml"
    bad.write_text("[[sensors]]\nnam = 3\n", encoding="utf-8")
    refused(run("serve", bad, "--port", 0), "bad.toml:2", setting="sensors.0.nam")


@pytest.mark.parametrize(
    ("module", "more"),
    [("chromanoise.web", {"starlette", "uvicorn"}), ("chromanoise.web.server", set())],
)
def test_the_server_is_ready_before_what_computes_is_imported(module, more):
    script = f"import sys, {module}\nprint('\\n'.join(sys.modules))"
    heavy = {"numpy", "scipy", "colour", "chromanoise.study", *more}
    assert not heavy & set(printed(script).split())


@pytest.mark.parametrize("word", ["NaN", "Infinity", "-Infinity"])
def test_a_number_that_json_does_not_have_is_named(client, word):
    body = f'{{"look": {{"anything": {word}}}}}'
    reply = client.post("/api/answer", content=body, headers={"Content-Type": "application/json"})
    assert f"contains {word}," in sentence_of(reply, 400)


def test_a_file_of_this_machine_is_not_opened_by_its_name(client, tmp_path):
    own = tmp_path / "own.csv"
    own.write_text(CAMERA_CSV, encoding="utf-8")
    for change in ({"sensors": [{"name": str(own)}]}, {"light": {"illuminant": str(own)}}):
        sentence = sentence_of(answered(client, {"study": BOTH | change}), 200)
        assert sentence.startswith(f"'{str(own)[:40]}")
