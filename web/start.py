"""Inside the interpreter, before its memory is kept: the page, with its first answer computed."""

import gc
import importlib
import json
import sys
from contextlib import suppress
from pathlib import Path

from chromanoise.web.offline import PREPARED, OfflinePage
from chromanoise.web.services import STUDY

IO = Path("/io")
HEAP_TYPE = 1 << 9  # of tp_flags
page = OfflinePage()


def answer():
    """The reply to the question in the files head and body of /io, into the same files."""
    head = json.loads((IO / "head").read_bytes())
    reply = page.reply(head["path"], (IO / "body").read_bytes(), head.get("file_name", ""))
    head = {"status": reply.status, "kind": reply.kind, "headers": reply.headers}
    (IO / "head").write_text(json.dumps(head), encoding="utf-8")
    (IO / "body").write_bytes(reply.content)


def resume():
    """Go on with another library and another folder for temporary files."""
    importlib.invalidate_caches()
    page.resume()


def without_docstrings():
    """Take the docstrings of compiled types away: nobody reads them here."""
    for one in gc.get_objects():
        if isinstance(one, type) and one.__flags__ & HEAP_TYPE and one.__doc__:
            with suppress(AttributeError, TypeError):
                one.__doc__ = None


for name in PREPARED:
    (IO / f"{name}.json").write_bytes(page.reply(f"/api/{name}").content)
first = page.reply("/api/answer", json.dumps({"study": STUDY}).encode())
faults = [part["fault"] for part in json.loads(first.content)["parts"].values() if "fault" in part]
assert not faults, faults

without_docstrings()
# freed memory is kept, too, but zeros take no room in a file
gc.collect()
for size in range(16, 513, 16):
    wiped = [bytes(size - 1) for _ in range((1 << 17) // size)]
wiped = [bytearray(1 << bits) for bits in range(18, 9, -1) for _ in range(1 << (19 - bits))]
del wiped
(IO / "loaded").write_text("\n".join(sorted(sys.modules)), encoding="utf-8")
