"""The page without a server: what it needs, and that it answers as the server does."""

import json
import sys

import pytest

from chromanoise.web import previews
from chromanoise.web.offline import OfflinePage
from chromanoise.web.services import STUDY
from processes import printed
from shells.test_serve import client  # noqa: F401

BLOCKED = """
import sys

class Blocked:
    known = {"numpy", "scipy", "chromanoise"} | sys.stdlib_module_names

    def find_spec(self, name, path=None, target=None):
        top = name.split(".")[0]
        if top not in self.known and not top.startswith("_"):
            raise ImportError(f"{name} is blocked", name=name)

sys.meta_path.insert(0, Blocked())
import json
from chromanoise.web.offline import PREPARED, OfflinePage
from chromanoise.web.services import STUDY

page = OfflinePage()
body = json.dumps({"study": STUDY, "part": "budget"}).encode()
for path in ("answer", "csv", "texts", *PREPARED):
    reply = page.reply(f"/api/{path}", body)
    assert reply.status == 200, (path, reply)
    assert b"could not be computed" not in reply.content, path
table = b"wavelength_nm,QE W\\n" + b"\\n".join(b"%d,0.5" % nm for nm in range(400, 1051, 10))
assert b"A sensor: 1 curve" in page.reply("/api/upload", table, "flat.csv").content
(fault,) = json.loads(page.reply("/api/report", body).content)["faults"]
assert "without markupsafe" in fault["sentence"], fault
"""


def test_answers_need_numpy_and_scipy_alone_and_the_rest_names_what_it_needs():
    printed(BLOCKED)


@pytest.mark.parametrize("path", ["/api/answer", "/api/texts", "/api/csv"])
@pytest.mark.parametrize("study", [STUDY, {"sensors": [{"name": "nobody"}]}])
def test_a_question_gets_the_reply_of_the_server(client, path, study):  # noqa: F811
    question = {"study": study, "part": "stages", "want": ["head", "stages"]}
    served = client.post(path, json=question)
    ours = OfflinePage().reply(path, json.dumps(question).encode())
    assert ours.status == served.status_code
    assert ours.kind == served.headers["content-type"].partition(";")[0]
    told = [
        json.loads(one) if ours.kind != "text/csv" else one
        for one in (ours.content, served.content)
    ]
    for one in told:
        if isinstance(one, dict):
            one.pop("seconds", None)
    assert told[0] == told[1]


@pytest.mark.parametrize("name", ["scene.npy", "Scene.NPZ", "curves.mat", "table.xlsx", "a.tif"])
def test_a_file_whose_reader_is_not_inside_points_to_the_installed_program(name):
    (fault,) = json.loads(OfflinePage().reply("/api/upload", b"1", name).content)["faults"]
    assert fault["where"] == "file"
    assert "need the installed program" in fault["sentence"]


@pytest.mark.parametrize("method", ["patches", "aggregate"])
def test_a_method_without_numba_is_refused_before_anything_is_computed(monkeypatch, method):
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.setattr(previews, "captured_with", None)
    study = STUDY | {"pictures": [{"cube": "builtin:checker", "denoise": method}]}
    reply = OfflinePage().reply("/api/picture", json.dumps({"study": study}).encode())
    (fault,) = json.loads(reply.content)["faults"]
    assert "needs the package numba" in fault["sentence"]
    assert "pip install 'chromanoise[compiled]'" in fault["sentence"]


@pytest.mark.parametrize(
    ("path", "body", "status"), [("/api/answer", b"{", 400), ("/api/nothing", b"{}", 404)]
)
def test_what_is_no_question_gets_a_fault(path, body, status):
    reply = OfflinePage().reply(path, body)
    assert reply.status == status
    assert json.loads(reply.content)["faults"]
