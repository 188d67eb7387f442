"""Ask the page's server what it should survive, and report what it answered.

    python tools/attack_page.py --count 100000 --seed 1

A server is started as a process of its own. Two clients ask mutated questions and upload damaged
and malicious files (`attack_questions`). Counted are the statuses; measured are the slowest answers
and the largest memory of the server with all its processes. What was answered with 500, or not at
all, is written out.
"""

import argparse
import http.client
import json
import sys
import threading
import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from attack_questions import Question, questions
from served_page import served

_CLIENTS = 2
_PATIENCE_S = 180.0
_MOST_KEPT = 20
_IDS = 8
_EVERY_S = 0.1
_TOLD_EVERY_S = 60.0


@dataclass(slots=True, kw_only=True)
class Report:
    """What became of all questions.

    Attributes
    ----------
    counts
        By status; 0 where there was no answer.
    slowest
        Seconds and kind of question, of each kind of route (``upload``, ``question``).
    largest_bytes
        Memory of the server with all its processes, pages that they share counted once.
    largest_while
        Kinds of the questions that were being answered then.
    asking
        Kinds of the questions that are being answered now, by client.
    bad
        Questions that were answered with 500 or above, but 503, or not at all.
    refused
        How many of status 200 got sentences in place of an answer.
    """

    counts: Counter[int] = field(default_factory=Counter)
    slowest: dict[str, tuple[float, str]] = field(default_factory=dict)
    largest_bytes: int = 0
    largest_while: tuple[str, ...] = ()
    asking: dict[int, str] = field(default_factory=dict)
    bad: list[tuple[int, Question]] = field(default_factory=list)
    refused: int = 0

    def add(self, question: Question, status: int, seconds: float, reply: bytes) -> None:
        """Count one answer."""
        self.counts[status] += 1
        self.refused += status == 200 and reply.startswith(b'{"faults"')
        route = "upload" if question.path == "/api/upload" else "question"
        self.slowest[route] = max(
            self.slowest.get(route, (0.0, "")), (round(seconds, 2), question.kind)
        )
        if (status == 0 or status >= 500) and status != 503 and len(self.bad) < _MOST_KEPT:
            self.bad.append((status, question))

    def __str__(self) -> str:
        """All of it on a few lines."""
        kinds = {
            f"{k}xx": sum(n for s, n in self.counts.items() if s // 100 == k) for k in (2, 4, 5)
        }
        return (
            f"{sum(self.counts.values())} questions: {kinds}, of 2xx {self.refused} refused in a "
            f"sentence; by status {dict(sorted(self.counts.items()))}\n"
            f"slowest: {self.slowest}\nlargest memory: {self.largest_bytes / 1e6:.0f} MB "
            f"while answering {self.largest_while}"
        )


def attacked(count: int, seed: int, *, bombs: float = 0.003) -> Report:
    """Ask a server of its own so many questions.

    Parameters
    ----------
    count, seed
        How many, and of what is drawn.
    bombs
        Share of files that are made to take much memory or time.
    """
    report = Report()
    with served() as (address, process):
        host = address.removeprefix("http://").rstrip("/").replace("localhost", "127.0.0.1")
        done = threading.Event()
        watching = threading.Thread(target=_watch, args=(process.pid, report, done))
        lock = threading.Lock()
        streams = [(seed * _CLIENTS + i, bombs) for i in range(_CLIENTS)]
        clients = [
            threading.Thread(target=_ask, args=(host, count // _CLIENTS, asked, report, lock))
            for asked in streams
        ]
        for thread in (watching, *clients):
            thread.start()
        for thread in clients:
            while thread.is_alive():
                thread.join(_TOLD_EVERY_S)
                print(report, file=sys.stderr, flush=True)
        done.set()
        watching.join()
        assert process.poll() is None, "the server ended"
    return report


def _ask(
    host: str, count: int, stream: tuple[int, float], report: Report, lock: threading.Lock
) -> None:
    ids: dict[str, list[str]] = {}
    asked = questions(stream[0], ids, bombs=stream[1])
    for _ in range(count):
        question = next(asked)
        report.asking[threading.get_ident()] = (
            f"{question.kind} {question.headers.get('X-Filename')}"
        )
        start = time.monotonic()
        status, reply = answer_of(host, question)
        with lock:
            report.add(question, status, time.monotonic() - start, reply)
        if question.path == "/api/upload" and b'"id"' in reply:
            upload = json.loads(reply)
            ids[upload["kind"]] = [*ids.get(upload["kind"], []), upload["id"]][-_IDS:]


def answer_of(host: str, question: Question) -> tuple[int, bytes]:
    """Status and body of an answer; 0 where there is none.

    Parameters
    ----------
    host
        With its port.
    question
        What is asked.
    """
    connection = http.client.HTTPConnection(host, timeout=_PATIENCE_S)
    try:
        connection.putrequest(
            question.method,
            question.path,
            skip_host="Host" in question.headers,
            skip_accept_encoding=True,
        )
        for name, value in question.headers.items():
            connection.putheader(name, value.encode("latin-1"))
        connection.putheader("Content-Length", str(len(question.body)))
        with suppress(BrokenPipeError, ConnectionResetError):  # it may have answered already
            connection.endheaders(question.body)
        reply = connection.getresponse()
        return reply.status, reply.read()
    except (OSError, http.client.HTTPException):
        return 0, b""
    finally:
        connection.close()


def _watch(pid: int, report: Report, done: threading.Event) -> None:
    while not done.wait(_EVERY_S):
        held = memory_bytes(pid)
        if held > report.largest_bytes:
            report.largest_bytes, report.largest_while = held, tuple(report.asking.values())


def memory_bytes(pid: int) -> int:
    """What a process and all that it started hold; pages that several share are counted once."""
    total = 0
    for one in _tree(pid):
        with suppress(OSError):
            for line in Path(f"/proc/{one}/smaps_rollup").read_text().splitlines():
                if line.startswith("Pss:"):
                    total += 1024 * int(line.split()[1])
    return total


def _tree(pid: int) -> list[int]:
    found = [pid]
    with suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            for child in (task / "children").read_text().split():
                found += _tree(int(child))
    return found


def main() -> None:
    """Send the questions, and print progress and the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--bombs", type=float, default=0.003, help="Share of malicious files.")
    options: Any = parser.parse_args()
    report = attacked(options.count, options.seed, bombs=options.bombs)
    print(report)
    for status, question in report.bad:
        print(status, question.kind, question.method, question.path[:80], dict(question.headers))
        print("   ", question.body[:2000])


if __name__ == "__main__":
    main()
