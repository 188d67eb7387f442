"""The page's server under attack: small malicious files, endless lists, clients that stall."""

import asyncio
import json
import math
import os
import pickle
import random
import signal
import socket
import struct
import threading
import time
import tracemalloc
import zlib
from contextlib import ExitStack
from dataclasses import replace
from io import BytesIO

import httpx
import numpy as np
import pytest
import tifffile
from starlette.requests import ClientDisconnect, Request

from attack_page import _tree, attacked, memory_bytes
from attack_questions import FILES, damaged
from chromanoise.base import sandbox as _sandbox
from chromanoise.base.errors import InputError
from chromanoise.imaging import kernel_cache
from chromanoise.io.matlab import mat_array
from chromanoise.io.sensor_files import sensor_json
from chromanoise.study import sensor_named
from chromanoise.web import processes, requests, worker
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.processes import Workers
from chromanoise.web.requests import Bodies
from chromanoise.web.server import _Server
from chromanoise.web.services import Services
from chromanoise.web.uploads import Kept, Uploads
from dear import dear
from processes import Patient, is_running
from served_page import served

LANE = processes.LANES["questions"]

FILE = {"Content-Type": "application/octet-stream"}
STUDY = {"sensors": [{"name": "onyx-rgb"}]}
HEAD = json.dumps({"study": STUDY, "want": ["head"]}).encode()
PICTURE = json.dumps({"study": STUDY | {"pictures": [{"cube": "builtin:checker"}]}}).encode()
HEAVY = json.dumps(
    {
        "study": {
            "sensors": [{"name": "onyx-rgbw", "shift_nm": 1.5 * i} for i in range(8)],
            "matrices": ["lmmse", "kernel", "ridge=0.1"],
        }
    }
).encode()  # takes a second
ROWS = b"wavelength_nm,R\n" + b"5,1\n" * 240_000  # takes two seconds to parse


@pytest.fixture(scope="module")
def server():
    with (
        served() as (address, process),
        httpx.Client(base_url=address.rstrip("/"), timeout=600, transport=Patient()) as client,
    ):
        client.post("/api/answer", content=HEAD, headers={"Content-Type": "application/json"})
        yield client, process.pid


def only_sentence(reply, status=200):
    assert reply.status_code == status, reply.text[:300]
    (fault,) = reply.json()["faults"]
    assert fault["sentence"]
    assert len(fault["sentence"].splitlines()) == 1
    return fault


def mat_of_zeros(megabytes, *, rows=None):
    """A MATLAB array of doubles that deflates to a thousandth; with ``rows`` its shape is wrong."""
    size = megabytes * 1_000_000 // 40_000 * 40_000
    rows = rows or size // 40_000
    parts = struct.pack("<IIII", 6, 8, 6, 0) + struct.pack("<IIiiii", 5, 12, rows, 100, 50, 0)
    parts += struct.pack("<II", 1, 11) + b"reflectance".ljust(16, b"\0")
    packing = zlib.compressobj(1)
    packed = packing.compress(struct.pack("<II", 14, len(parts) + 8 + size) + parts)
    packed += packing.compress(struct.pack("<II", 9, size))
    for _ in range(size // 1_000_000):
        packed += packing.compress(bytes(1_000_000))
    packed += packing.compress(bytes(size % 1_000_000)) + packing.flush()
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    return head + struct.pack("<II", 15, len(packed)) + packed


def tiff_of_zeros(megabytes):
    held = BytesIO()
    page = np.zeros((5000, 5000), "u1")
    with tifffile.TiffWriter(held) as writer:
        for _ in range(megabytes // 25):
            writer.write(page, compression="zlib", compressionargs={"level": 1}, contiguous=False)
    return held.getvalue()


@pytest.mark.evidence
@pytest.mark.parametrize(
    ("name", "made"), [("bomb.mat", mat_of_zeros), ("bomb.tif", tiff_of_zeros)]
)
def test_a_file_that_unpacks_to_much_is_refused_and_leaves_no_memory_behind(server, name, made):
    client, pid = server
    content, before, largest = made(600), memory_bytes(pid), []
    assert len(content) < 6_000_000
    done = threading.Event()

    def watch():
        while not done.wait(0.05):
            largest.append(memory_bytes(pid))

    watching = threading.Thread(target=watch)
    watching.start()
    try:
        reply = client.post("/api/upload", content=content, headers=FILE | {"X-Filename": name})
    finally:
        done.set()
        watching.join()
    assert only_sentence(reply)["where"] == "file"
    assert max(largest, default=0) < 1e9
    assert memory_bytes(pid) < before + 300e6


def test_a_matlab_array_of_more_bytes_than_its_shape_needs_is_refused_before_it_is_inflated(
    tmp_path,
):
    path = tmp_path / "a.mat"
    path.write_bytes(mat_of_zeros(100, rows=1))
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match=r"a\.mat"):
            mat_array(path, "reflectance")
        assert tracemalloc.get_traced_memory()[1] < 10e6
    finally:
        tracemalloc.stop()
    path.write_bytes(mat_of_zeros(2))
    np.testing.assert_array_equal(mat_array(path, "reflectance"), np.zeros((50, 100, 50)))


@pytest.mark.parametrize("name", FILES)
def test_a_damaged_file_of_any_format_is_answered_and_never_an_error_of_the_server(server, name):
    client, _ = server
    whole = FILES[name]()
    rng = random.Random(name)
    for content in (whole[: len(whole) // 2], whole[:-1], damaged(rng, whole)):
        headers = FILE | {"X-Filename": f"a.{name}"}
        reply = client.post("/api/upload", content=content, headers=headers)
        assert reply.status_code == 200
        data = reply.json()
        assert data.get("id") or data["faults"][0]["sentence"]
    assert client.post("/api/upload", content=whole, headers=headers).json().get("id") or name in (
        "npy",  # does not declare its wavelengths
    )


@pytest.mark.evidence
@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"pictures": [{}] * 100_000}, "pictures"),
        ({"sweeps": [{}] * 65}, "sweeps"),
        ({"sensors": [{"name": "onyx-rgb"}] * 11}, "sensors"),
        ({"matrices": ["kernel"] * 5}, "matrices"),
    ],
)
def test_a_list_that_is_longer_than_the_page_shows_is_refused_with_its_key(server, change, where):
    for path in ("answer", "texts", "picture", "report"):
        reply = server[0].post(f"/api/{path}", json={"study": STUDY | change})
        assert only_sentence(reply)["where"] == where


@pytest.mark.parametrize("matrix", ["ridge=1e308", "ridge=-1", "ridge=nan", "bounded-psi=0"])
def test_a_parameter_of_a_matrix_that_is_out_of_bounds_is_refused_beside_it(server, matrix):
    for path in ("answer", "texts", "picture", "report"):
        study = STUDY | {"matrices": ["kernel", matrix]}
        reply = server[0].post(f"/api/{path}", json={"study": study})
        assert only_sentence(reply)["where"] == "matrices.1"


def test_a_list_that_no_question_of_the_page_has_is_refused(server):
    formats = {"pictures": [{"formats": ["x"] * 100_000}]}
    fault = only_sentence(server[0].post("/api/answer", json={"study": STUDY | formats}), 400)
    assert fault["where"] == "pictures.0.formats"
    keys = {f"k{i}": 1 for i in range(1000)}
    assert only_sentence(server[0].post("/api/answer", json={"study": STUDY | keys}), 400)
    deep: list = []
    for _ in range(900):
        deep = [deep]
    assert only_sentence(server[0].post("/api/answer", json={"study": {"title": deep}}), 400)


@pytest.mark.parametrize(
    "body",
    [
        b'{"study": {"\\ud800": 1, "sensors": [{"name": "onyx-rgb"}]}}',
        b'{"study": {"title": "\\udfff", "sensors": [{"name": "onyx-rgb"}]}}',
        b'{"study": {"sensors": [{"name": "\\ud83d"}]}}',
        b'{"look": {"a": "\\uDC00"}}',
    ],
)
def test_an_unpaired_surrogate_is_refused_in_one_sentence(server, body):
    for path in ("answer", "texts", "picture", "report"):
        headers = {"Content-Type": "application/json"}
        only_sentence(server[0].post(f"/api/{path}", content=body, headers=headers), 400)


def with_surrogate(name):
    """A file of our own JSON or of rawtoaces with an unpaired surrogate in a name or note."""
    if name == "curves":
        data = json.loads(FILES["json"]())
        data["spectral_data"]["index"]["main"] = ["\ud800", "G"]
    elif name == "front":
        data = json.loads(FILES["front.json"]())
        data["members"][0]["name"] = "\udfff"
    elif name == "matrix":
        data = {"balanced": np.eye(3).tolist(), "illuminant": "\ud83d"}
    else:
        data = json.loads(sensor_json(sensor_named("onyx-rgb")))
        data |= {"notes": ["\ud800"]} if name == "note" else {"name": "\ud800"}
    return json.dumps(data).encode()


@pytest.mark.parametrize("name", ["curves", "front", "matrix", "note", "name"])
def test_an_unpaired_surrogate_in_a_file_is_refused_in_one_sentence(server, name):
    headers = FILE | {"X-Filename": "front.json" if name == "front" else "a.json"}
    reply = server[0].post("/api/upload", content=with_surrogate(name), headers=headers)
    assert "surrogate" in only_sentence(reply)["sentence"]


CSV_MATRIX = "lx/e-,R,G,B\nX,2,0,0\nY,0,1,0\nZ,0,0,1\n"
MATRIX = {"matrix_lux_per_e": np.eye(3).tolist(), "time_ms": 10, "f_number": 2, "pitch_um": 2}


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("m.json", json.dumps(MATRIX | {"matrix_lux_per_e": [[10**400] * 3] * 3})),
        ("m.json", json.dumps(MATRIX | {"balanced": [[10**400] * 3] * 3, "matrix_lux_per_e": 1})),
        ("m.json", json.dumps(MATRIX | {"pitch_um": 1e200})),
        ("m.json", json.dumps(MATRIX | {"time_ms": 10**400})),
        ("m.json", json.dumps(MATRIX | {"level_lux": 10**400})),
        ("m.json", json.dumps(MATRIX | {"f_number": 0})),
        ("m.json", json.dumps(MATRIX | {"f_number": True})),
        *(
            ("m.csv", f"# time_ms: 10\n# f_number: 2\n# pitch_um: 2\n# {line}\n{CSV_MATRIX}")
            for line in ("pitch_um: 1e300", "time_ms: nan", "f_number: 1e-300", "level_lux: -1")
        ),
        ("m.csv", CSV_MATRIX.replace("X,2", "X,1e400")),
    ],
)
def test_a_matrix_with_an_impossible_number_is_refused_in_one_sentence(server, name, content):
    headers = FILE | {"X-Filename": name}
    reply = server[0].post("/api/upload", content=content.encode(), headers=headers)
    assert name in only_sentence(reply)["sentence"]


@pytest.mark.parametrize(
    "path", ["a" * 300 + ".js", "app/" + "a" * 5000 + ".js", "a/" * 3000 + "b.js"]
)
def test_a_long_name_of_an_asset_is_not_found(server, path):
    assert server[0].get(f"/assets/{path}").status_code == 404


def test_clients_that_send_no_body_do_not_delay_others(server):
    client, _ = server
    port = client.base_url.port
    head = (
        f"POST /api/answer HTTP/1.1\r\nHost: localhost:{port}\r\n"
        "Content-Type: application/json\r\nContent-Length: 900000\r\n\r\n{"
    )
    with ExitStack() as held:
        for _ in range(60):
            one = held.enter_context(socket.create_connection(("127.0.0.1", port)))
            one.sendall(head.encode())
        # once, four such clients blocked all long bodies for half a minute
        long = json.dumps({"study": STUDY, "want": ["head"], "look": {"x": "y" * 200_000}})
        headers = {"Content-Type": "application/json"}
        assert client.post("/api/answer", content=long, headers=headers).status_code == 200


class Coming:
    """A request whose pieces come when they are given."""

    def __init__(self):
        self.headers, self.pieces = {}, asyncio.Queue()

    async def stream(self):
        while (piece := await self.pieces.get()) is not None:
            yield piece


def test_when_bodies_exceed_their_memory_the_one_that_waited_longest_is_dropped(monkeypatch):
    monkeypatch.setattr(requests, "_MOST_COMING_BYTES", 2500)

    async def bodies():
        kept, requests = Bodies(), [Coming() for _ in range(3)]
        tasks = [asyncio.ensure_future(kept.body_of(one, most_bytes=5000)) for one in requests]
        for one in requests:
            await one.pieces.put(b"x" * 1000)
            await asyncio.sleep(0.01)
        for one in requests[1:]:
            await one.pieces.put(None)
        return await asyncio.gather(*tasks, return_exceptions=True)

    first, *others = asyncio.run(bodies())
    assert isinstance(first, QuestionError)
    assert first.status == 408
    assert others == [b"x" * 1000] * 2


def test_a_body_that_stops_coming_is_not_waited_for(monkeypatch):
    monkeypatch.setattr(requests, "_REST_S", 0.01)
    with pytest.raises(QuestionError) as error:
        asyncio.run(Bodies().body_of(Coming(), most_bytes=5000))
    assert error.value.status == 408


# ---- the processes that compute ----


@pytest.fixture(scope="module")
def workers():
    one = Workers(None)
    yield one
    one.close()
    assert all(process.poll() is not None for process in one._nursery._started)


def results(workers, *jobs):
    """What becomes of jobs, one after the other."""

    async def each():
        return [
            (await asyncio.gather(workers.done(*job), return_exceptions=True))[0] for job in jobs
        ]

    return asyncio.run(each())


@pytest.mark.evidence
def test_a_computation_that_takes_too_long_is_stopped_and_the_next_is_answered(
    workers, monkeypatch
):
    limit(monkeypatch, "answer", cpu_s=0, limit_s=0.2)
    stopped, answered = results(workers, ("answer", HEAVY), ("texts", HEAD))
    assert isinstance(stopped, QuestionError)
    assert stopped.status == 200
    assert "longer than" in str(stopped)
    assert "onyx-rgb" in json.loads(answered)["toml"]


def test_a_file_that_takes_too_much_of_the_processor_is_refused(workers, monkeypatch):
    limit(monkeypatch, "previewed", cpu_s=0, limit_s=60.0)
    uploads = Uploads()
    try:  # with cpu_s=0, the limit is the next full second of the process
        (refused,) = results(workers, ("previewed", uploads.keep("a.csv", ROWS)))
    finally:
        uploads.close()
    assert isinstance(refused, QuestionError)
    assert refused.faults[0][0] == "file"
    assert "longer than 0 s" in str(refused)


def test_a_computation_that_needs_too_much_memory_is_refused_in_one_sentence(workers, monkeypatch):
    queue = workers._lanes["pictures"]
    monkeypatch.setattr(queue, "_lane", replace(queue._lane, memory_bytes=3_000_000))
    larger = STUDY | {"pictures": [{"cube": "builtin:dead-leaves"}]}  # than what is prepared
    (refused,) = results(workers, ("picture", json.dumps({"study": larger}).encode()))
    assert isinstance(refused, QuestionError)
    assert "3 MB" in str(refused)


@pytest.mark.parametrize("question", [("texts", HEAD), ("picture", PICTURE)])
def test_an_answer_that_is_too_long_is_refused_in_one_sentence(workers, monkeypatch, question):
    monkeypatch.setattr(processes, "MOST_ANSWER_BYTES", 100)
    (refused,) = results(workers, question)
    assert isinstance(refused, QuestionError)


def test_a_question_that_would_wait_too_long_gets_status_503(workers, monkeypatch):
    monkeypatch.setattr(processes, "LONGEST_WAIT_S", -1.0)
    (refused,) = results(workers, ("texts", HEAD))
    assert isinstance(refused, QuestionError)
    assert refused.status == 503


def test_jobs_of_clients_that_left_are_not_computed(workers, monkeypatch):
    asked, ask = [], processes.Worker.asked
    monkeypatch.setattr(
        processes.Worker, "asked", lambda one, *given: asked.append(given) or ask(one, *given)
    )
    monkeypatch.setattr(processes, "ABANDONED_S", 0.0)

    async def abandoned():
        jobs = [asyncio.ensure_future(workers.done("answer", HEAVY)) for _ in range(30)]
        await asyncio.sleep(0.2)
        for one in jobs:
            one.cancel()
        await asyncio.gather(*jobs, return_exceptions=True)
        return await workers.done("texts", HEAD)

    assert "onyx-rgb" in json.loads(asyncio.run(abandoned()))["toml"]
    assert len(asked) <= LANE.workers + 1
    assert workers._lanes["questions"]._waiting == 0


@pytest.fixture
def prepared(tmp_path):
    """A worker that has prepared its job, and how often it was interrupted."""
    interrupted, told, asked = [], tmp_path / "told", tmp_path / "asked"
    told.write_bytes(pickle.dumps("begins"))
    with told.open("rb") as reads, asked.open("wb") as writes:
        ends = {"interrupt": lambda: interrupted.append(1), "ended": lambda: None}
        yield processes.Worker(reads, writes, **ends), interrupted


def test_a_job_that_its_client_left_ends_when_it_is_prepared_and_not_before(prepared):
    turn, (one, interrupted) = processes._Turn(), prepared
    turn.begin(one)
    turn.stop()
    assert not interrupted
    assert not turn.is_wanted()
    one.has_begun = True
    turn.stop()
    assert interrupted


def test_an_unwanted_job_is_ended_when_it_begins(prepared):
    one, interrupted = prepared
    with pytest.raises(processes.ProcessEndedError) as error:
        one.asked(("texts", (), (HEAD,), 15, 30.0), lambda: False)
    assert error.value.has_begun
    assert interrupted


def test_a_client_that_has_gone_ends_its_job():
    ended = []

    async def computes(*given, **named):
        try:
            await asyncio.Event().wait()
        finally:
            ended.append(True)

    async def leaves():
        return {"type": "http.disconnect"}

    server = _Server(None, None)
    try:
        server.workers.done = computes
        request = Request({"type": "http"}, leaves)
        with pytest.raises(ClientDisconnect):
            asyncio.run(server.done(request, "answer", HEAVY))
    finally:
        server.close()
    assert ended == [True]


@pytest.mark.evidence
def test_without_fork_each_process_is_started_separately(monkeypatch):
    monkeypatch.setattr(processes, "FORKS", False)
    workers = Workers(None)
    try:
        answered, refused = results(workers, ("texts", HEAD), ("texts", b"{"))
    finally:
        workers.close()
    assert "onyx-rgb" in json.loads(answered)["toml"]
    assert isinstance(refused, QuestionError)
    assert refused.status == 400
    assert all(process.poll() is not None for process in workers._nursery._started)


def test_no_file_of_the_working_folder_is_imported_by_a_worker_process(tmp_path, monkeypatch):
    for name in ("colour", "pickle", "numpy"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('imported')\n")
    monkeypatch.chdir(tmp_path)
    workers = Workers(None)
    try:
        (answered,) = results(workers, ("texts", HEAD))
    finally:
        workers.close()
    assert json.loads(answered)["toml"]


def test_a_limit_of_the_processor_that_several_threads_reach_is_said_to_be_one_of_time(
    workers, monkeypatch
):
    limit(monkeypatch, "previewed", cpu_s=1, limit_s=60.0)
    # what the server sees where threads use a second of the processor in less than a second
    for code in (-signal.SIGXCPU, _sandbox.TOO_LONG):
        ended = processes.ProcessEndedError(0.6, has_begun=True, exit_code=code)
        assert "longer than 1 s" in str(
            processes._stopped(processes.JOBS["previewed"], ended, LANE)
        )


@pytest.mark.parametrize(
    ("stop", "code"), [(signal.SIGKILL, -9), (signal.SIGXCPU, -24), (signal.SIGSEGV, -11)]
)
def test_the_signal_that_ended_a_process_is_reported(workers, stop, code):
    one, child = forked(workers)
    threading.Timer(0.5, os.kill, (child, stop)).start()
    with pytest.raises(processes.ProcessEndedError) as error:
        one.asked(("answer", (), (HEAVY,), 60, 60.0))
    assert error.value.exit_code == code
    assert one.is_spent


def test_a_process_that_does_not_begin_is_ended(workers, monkeypatch):
    monkeypatch.setattr(processes, "BEGINS_S", 0.5)
    one, child = forked(workers)
    os.kill(child, signal.SIGSTOP)
    with pytest.raises(processes.ProcessEndedError) as error:
        one.asked(("texts", (), (HEAD,), 15, 30.0))
    assert not error.value.has_begun
    assert one.is_spent
    assert child not in children_of(workers)


@pytest.mark.parametrize("error", [MemoryError, AttributeError, TypeError, KeyboardInterrupt])
def test_a_process_whose_answer_cannot_be_read_is_used_no_more(error, monkeypatch, tmp_path):
    def fails(_):
        raise error

    monkeypatch.setattr(processes.pickle, "load", fails)
    ended, path = [], tmp_path / "channel"
    path.touch()
    with path.open("rb") as reads, path.open("wb") as writes:
        one = processes.Worker(reads, writes, interrupt=lambda: None, ended=lambda: ended.append(1))
        with pytest.raises(error):
            one.asked(("texts", (), (HEAD,), 15, 30.0))
    assert one.is_spent
    assert ended == [1]


@pytest.mark.parametrize("error", [MemoryError, OSError(28, "No space left on device")])
def test_a_preparation_that_fails_is_an_answer_and_ends_the_process(monkeypatch, error, tmp_path):
    services, calls = Services(Kept()), []

    def fails(_):
        calls.append(1)
        raise error

    monkeypatch.setattr(services._pictures, "picture", fails)
    asked_twice, answers = tmp_path / "asked", tmp_path / "answers"
    asked_twice.write_bytes(pickle.dumps(("picture", (), (b"{}",), 15, 30.0)) * 2)
    with asked_twice.open("rb") as reads, answers.open("wb") as writes:
        worker._Answering(services, reads, writes, None).serve()
    written = BytesIO(answers.read_bytes())
    assert pickle.load(written) == "begins"
    (kind, *result), is_spent = pickle.load(written)
    assert (kind, is_spent) == (("no memory" if error is MemoryError else "failed"), True)
    assert error is MemoryError or "No space left" in result[0]
    assert not written.read()  # the second question is left to another process
    assert not services._prepared
    assert not kernel_cache._callbacks  # nor is it told of kernels of later callers


def test_cpu_time_in_which_kernels_are_compiled_does_not_count(monkeypatch, tmp_path):
    limits, now_s, services = [], iter([10.5, 11.0, 31.0]), Services(Kept())
    monkeypatch.setattr(worker, "set_limit", lambda *given: limits.append(given))
    monkeypatch.setattr(worker.time, "process_time", lambda: next(now_s))
    (tmp_path / "none").touch()
    with (tmp_path / "none").open("rb") as reads, (tmp_path / "answers").open("wb") as writes:
        one = worker._Answering(services, reads, writes, 10**9)
        one._compiling(True)  # before a job: nothing limits it
        one._compiling(False)
        one._bound(25)
        for is_begin in (True, True, False, False):  # one kernel calls another one
            one._compiling(is_begin)
    limits_s = [value for name, value in limits if name == "RLIMIT_CPU"]
    assert limits_s == [35.5, math.inf, 55.5]


def test_an_error_outside_of_an_answer_is_written_out_with_an_exit_code(capfd):
    def fails():
        raise KeyError("lost")

    def lacks():
        raise MemoryError

    codes = []
    for served_one in (fails, lacks, lambda: None):
        child = os.fork()
        if child == 0:
            _sandbox.exit_after(served_one)
        codes.append(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    assert codes == [_sandbox.FAILED, _sandbox.NO_MEMORY, 0]
    assert "KeyError: 'lost'" in capfd.readouterr().err


def test_the_study_that_the_server_starts_with_is_not_computed_without_a_bound(monkeypatch):
    services, computed = Services(Kept(), study=STUDY), []
    monkeypatch.setattr(services._answers, "answer", computed.append)
    services.warm()
    assert computed
    assert all(one["study"]["sensors"] != STUDY["sensors"] for one in computed)


@pytest.mark.evidence
@pytest.mark.parametrize("stop", [signal.SIGKILL, *dear(signal.SIGINT, signal.SIGTERM)])
def test_no_process_is_left_when_the_server_ends(stop):
    with served() as (address, process):
        with httpx.Client(base_url=address.rstrip("/"), timeout=600) as client:
            headers = {"Content-Type": "application/json"}
            assert client.post("/api/answer", content=HEAD, headers=headers).status_code == 200
        others = _tree(process.pid)[1:]
        assert len(others) >= 2  # who forks, and who answers
        process.send_signal(stop)
        process.wait(30)
        wait_until(lambda: not any(is_running(pid) for pid in others))


def limit(monkeypatch, job, **limits):
    """Other limits of one kind of job."""
    own = replace(processes.JOBS[job], **limits)
    monkeypatch.setattr(processes, "JOBS", processes.JOBS | {job: own})


def forked(workers):
    """A worker and its process."""
    workers._nursery.worker(LANE.memory_bytes).close()  # now there is one that forks
    before = set(children_of(workers))
    one = workers._nursery.worker(LANE.memory_bytes)
    wait_until(lambda: set(children_of(workers)) - before)
    (child,) = set(children_of(workers)) - before
    return one, child


def children_of(workers):
    wait_until(lambda: workers._nursery._started)
    return _tree(workers._nursery._started[-1].pid)[1:]


def wait_until(happens, seconds=300.0):
    end = time.monotonic() + seconds
    while not happens():
        assert time.monotonic() < end
        time.sleep(0.02)


# ---- all of it ----


@pytest.mark.evidence
def test_thousands_of_mutated_questions_and_malicious_files_are_answered_or_refused():
    report = attacked(int(os.environ.get("CHROMANOISE_ATTACKS", "3000")), seed=1)
    print(report)
    assert not report.bad
    assert report.largest_bytes < 1e9
    # an upload computes for 4 s at most, and each of the two clients may wait for the other's
    assert report.slowest["upload"][0] < 30
    assert report.slowest["question"][0] < 60
