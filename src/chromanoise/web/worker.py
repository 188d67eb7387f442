"""The computations behind the routes of the page, and the process that answers with them.

The process has limits of time and memory.
"""

import contextlib
import json
import math
import os
import pickle
import signal
import socket
import struct
import sys
import time
import traceback
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

from chromanoise.base import InputError, exit_after, held_bytes, stopped_after
from chromanoise.charts import EXPLANATIONS, explanation_as_json
from chromanoise.imaging import watch_compiling
from chromanoise.imaging.denoising import DENOISING
from chromanoise.study import ExposurePart, LightPart, study_from_data
from chromanoise.web.answers import ChartReplies, card_reply, report_reply
from chromanoise.web.controls import choices
from chromanoise.web.page_studies import Studies, files_of
from chromanoise.web.previews import PictureReplies, preview_of
from chromanoise.web.requests import Kept, QuestionError, Upload, data_of
from chromanoise.web.story import story

STUDY: dict[str, Any] = {
    "light": LightPart().model_dump(include={"illuminant", "level_lux"}),
    "exposure": ExposurePart().model_dump(include={"equal", "f_number"}),
    "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut"}],
    "matrices": ["kernel"],
    "pictures": [{"cube": "builtin:checker", "clip": True}],
}
"""The default study: the paper's comparison, with a picture that full wells clip."""


class Services:
    """Answers, pictures and previews of one server.

    Parameters
    ----------
    study
        The initial study as plain data.
    """

    def __init__(self, uploads: Kept, *, study: dict[str, Any] | None = None) -> None:
        self.uploads, self._study = uploads, STUDY if study is None else study
        files = files_of(study_from_data(self._study, source="study", keep_idle=True))
        self._studies = Studies(uploads, files=files)
        self._answers = ChartReplies(self._studies)
        self._pictures = PictureReplies(self._studies)
        self._prepared: set[str | None] = set()
        self._story: str | None = None

    def choices(self, has_front: bool = False) -> str:
        """The JSON of ``/api/choices``; ``has_front`` tells whether ``/api/front`` has one."""
        served = {"study": self._study, "front": has_front}
        return json.dumps(choices() | served, allow_nan=False)

    def story(self) -> str:
        """The JSON of ``/api/story``."""
        if self._story is None:
            self._story = json.dumps(story(STUDY), allow_nan=False)
        return self._story

    def explanations(self) -> str:
        """The JSON of ``/api/explanations``."""
        return json.dumps({key: explanation_as_json(key) for key in EXPLANATIONS})

    def answer(self, body: bytes) -> str:
        """The JSON of ``/api/answer``.

        Raises
        ------
        QuestionError
            With all faults of the question; also for the other methods.
        """
        return self._answers.answer(data_of(body))

    def csv(self, body: bytes) -> str:
        """The CSV of ``/api/csv``."""
        return self._answers.csv(data_of(body))

    def report(self, body: bytes, folder: Path) -> tuple[str, str]:
        """The HTML of ``/api/report`` and the hash of its study; its files go into ``folder``."""
        return report_reply(self._studies, data_of(body), folder)

    def card(self, body: bytes, folder: Path) -> tuple[bytes, str]:
        """The PDF of ``/api/card``, as `report`."""
        return card_reply(self._studies, data_of(body), folder)

    def texts(self, body: bytes) -> str:
        """The JSON of ``/api/texts``."""
        return json.dumps(self._answers.texts(data_of(body)))

    def picture(self, body: bytes) -> tuple[bytes, str]:
        """The PNG of ``/api/picture``, and its summary as JSON."""
        return self._pictures.picture(data_of(body))

    def previewed(self, upload: Upload) -> str:
        """The JSON of ``/api/upload``."""
        preview = preview_of(upload)
        if preview["study"] is not None:
            wrong = self._studies.complaints(preview["study"])
            preview["preview"] += [f"Looks wrong: {sentence}" for sentence in wrong]
        return json.dumps(preview)

    def prepare(self, name: str, *given: Any) -> None:
        """Do the one-time preparation of a job, which must not count against its time limit.

        Parameters
        ----------
        name, given
            One of its methods, and the arguments. Some pictures compile kernels, which takes up to
            minutes on a busy machine.
        """
        if name == "picture":
            methods = (None, *_denoising_of(given[0])[:1])
        elif name == "report":
            methods = (None, *_denoising_of(given[0]))  # it begins with a card, which has pictures
        elif name == "card":
            methods = (None,)
        else:
            return
        for method in methods:
            if method in self._prepared:
                continue
            with suppress(QuestionError):  # of the page's own study: not a fault of the one asked
                self._pictures.picture({"study": STUDY | {"pictures": [{"denoise": method}]}})
                self._prepared.add(method)

    def warm(self) -> None:
        """Compute in advance what most requests need.

        Only the default study is used, because time and memory are not limited here.
        """
        self._answers.answer({"study": STUDY})
        self.choices()
        self.story()


def _denoising_of(body: bytes) -> tuple[str | None, ...]:
    """The known denoising method of each picture of the study in a question; `None` for none."""
    with suppress(QuestionError, LookupError, TypeError):  # reported by the question itself
        parts = data_of(body)["study"]["pictures"]
        methods = [part.get("denoise") for part in parts if isinstance(part, dict)]
        return tuple(one for one in methods if one is None or one in DENOISING)
    return ()


_SIZE = struct.calcsize("q")
_EXIT_S = 1.0  # a process that has closed its channel needs less


def main() -> None:
    """Fork workers or answer questions until the server ends."""
    if sys.argv[1] == "forks":
        _forking(socket.socket(fileno=0))
        os._exit(0)  # at once: nothing is left to clean up
    reads, writes = sys.stdin.buffer, sys.stdout.buffer
    (size,) = struct.unpack("q", reads.read(_SIZE))
    study = reads.read(size)
    exit_after(
        lambda: _Answering(Services(Kept(), study=pickle.loads(study)), reads, writes, None).serve()
    )


def _forking(control: socket.socket) -> None:
    (size,) = struct.unpack("q", control.recv(_SIZE, socket.MSG_WAITALL))
    services = Services(Kept(), study=pickle.loads(control.recv(size, socket.MSG_WAITALL)))
    with contextlib.suppress(QuestionError, InputError):  # reported to the request that needs it
        services.warm()
    children: dict[int, int] = {}
    while True:
        message, ends, *_ = socket.recv_fds(control, 2 * _SIZE, 1)
        if not message:
            for child in children.values():
                _exit_code(child, wait_s=0.0)
            return
        number, memory_bytes = struct.unpack("qq", message)
        if not ends:
            code = _exit_code(children.pop(number), wait_s=_EXIT_S)
            with contextlib.suppress(OSError):  # the server is gone, as the next message shows
                control.sendall(struct.pack("q", code))
            continue
        child = os.fork()
        if child == 0:
            control.close()
            exit_after(partial(_child, services, ends[0], memory_bytes))
        with contextlib.suppress(OSError):  # the child may have been quicker
            os.setpgid(child, child)
        os.close(ends[0])
        children[number] = child


def _exit_code(child: int, *, wait_s: float) -> int:
    """End a child, and whatever it started, such as the process that reads HDF5 files.

    Returns its exit code, or the negative number of the signal that ended it.
    """
    end = time.monotonic() + wait_s
    while not os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        if time.monotonic() >= end:
            break
        time.sleep(0.002)
    with contextlib.suppress(OSError):
        os.killpg(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _child(services: Services, end: int, memory_bytes: int) -> None:
    with contextlib.suppress(OSError):
        os.setpgid(0, 0)
    bound = _bounded(memory_bytes)
    with socket.socket(fileno=end) as channel:
        reads, writes = channel.makefile("rb"), channel.makefile("wb")
        _Answering(services, reads, writes, bound).serve()


def _bounded(memory_bytes: int) -> int:
    """Limit the memory of this process to what it holds now plus ``memory_bytes``.

    Returns the number of held bytes above which another process should replace it.
    """
    import resource

    held = held_bytes()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_DATA, (held + memory_bytes,) * 2)
    return held + memory_bytes // 2


class _Answering:
    """The services, the streams to the server, and the held bytes above which it is replaced."""

    def __init__(
        self, services: Services, reads: BinaryIO, writes: BinaryIO, bound: int | None
    ) -> None:
        self._services, self._reads, self._writes, self._bound = services, reads, writes, bound
        self._limit_s, self._kernels, self._began_s = math.inf, 0, 0.0

    def serve(self) -> None:
        """Answer until the server ends, or until another process should replace this one."""
        with watch_compiling(self._compiling):
            self._serve()

    def _serve(self) -> None:
        while (asked := self._asked()) is not None:
            name, kept, given, cpu_s, limit_s = asked
            self._bound_cpu(math.inf)  # preparing is not limited
            answer = answered(self._services, "prepare", kept, (name, *given))
            self._tell("begins")
            if answer[0] == "done":
                self._bound_cpu(cpu_s)
                with stopped_after(limit_s):
                    answer = answered(self._services, name, kept, given)
            is_spent = answer[0] in ("no memory", "failed") or self._is_spent(cpu_s)
            self._tell((answer, is_spent))
            if is_spent:
                return

    def _bound_cpu(self, cpu_s: float) -> None:
        """Limit the CPU time of this process and of those that it starts from now on."""
        if self._bound is not None:
            self._limit_s = time.process_time() + cpu_s
            _set_cpu_limit(self._limit_s)

    def _compiling(self, is_begin: bool) -> None:
        """CPU time in which a kernel is compiled does not count; elapsed time does."""
        if math.isinf(self._limit_s):
            return
        if is_begin and self._kernels == 0:
            self._began_s = time.process_time()
            _set_cpu_limit(math.inf)
        self._kernels += 1 if is_begin else -1
        if self._kernels == 0:
            self._limit_s += time.process_time() - self._began_s
            _set_cpu_limit(self._limit_s)

    def _is_spent(self, cpu_s: int) -> bool:
        """Whether a new process should replace it: its child processes inherit its CPU time."""
        if self._bound is None:
            return False
        return held_bytes() > self._bound or time.process_time() > cpu_s

    def _asked(self) -> tuple[str, tuple[Upload, ...], tuple[Any, ...], int, float] | None:
        try:
            return pickle.load(self._reads)
        except (EOFError, OSError, pickle.UnpicklingError):  # the server is gone
            return None

    def _tell(self, what: Any) -> None:
        with contextlib.suppress(OSError):  # the server has ended; the next read finds out
            pickle.dump(what, self._writes)
            self._writes.flush()


def _set_cpu_limit(seconds: float) -> None:
    import resource

    limit = resource.RLIM_INFINITY if math.isinf(seconds) else math.ceil(seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))


def answered(
    services: Services, name: str, kept: tuple[Upload, ...], given: tuple[Any, ...]
) -> tuple[Any, ...]:
    """How a job ended (done, refused, failed, no memory), and what it returned.

    Parameters
    ----------
    services
        The services that computes.
    name, given
        One of its methods, and the arguments.
    kept
        Files that the question may name.
    """
    services.uploads.hold(kept)
    try:
        return "done", getattr(services, name)(*given)
    except QuestionError as error:
        return "refused", error.faults, error.status
    except RecursionError:
        return "refused", (("", "request JSON is nested too deeply"),), 400
    except MemoryError:
        return ("no memory",)
    except Exception:
        return "failed", traceback.format_exc()
