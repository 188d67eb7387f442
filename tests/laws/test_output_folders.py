"""Outputs appear whole or not at all, whatever stops a run; other files are never changed."""

import hashlib
import json
import os
import shutil
import subprocess
import sys
from contextlib import nullcontext, suppress
from functools import partial
from pathlib import Path

import pytest

from chromanoise.base import files as _files
from chromanoise.base.errors import InputError
from chromanoise.base.files import (
    OWN_FILES,
    claimed_folder,
    refuse_unwritable,
    refuse_unwritable_file,
    whole_folder,
    write_kept,
    write_whole,
)
from outcomes import refused_input
from processes import printed

NEW = {"a.png": "new a", "b.png": "new b", "summary.json": "new"}
REPLACED = {"b.png": "old b", "summary.json": "old"}
OLD = REPLACED | {"mine.txt": "mine", "deep/mine.txt": "mine too"}


def put(folder, files):
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def tree(folder):
    return {
        str(path.relative_to(folder)): path.read_text()
        for path in folder.rglob("*")
        if path.is_file() and path.name != OWN_FILES
    }


def earlier(folder, files=OLD):
    """A folder with files of an earlier run, those of REPLACED, and of others."""
    written(folder, {name: text for name, text in files.items() if name in REPLACED})
    put(folder, {name: text for name, text in files.items() if name not in REPLACED})


def written(folder, files=NEW):
    with whole_folder(folder, "test") as scratch:
        put(scratch, files)


def stopped(during, *and_then):
    """A run in the context ``during`` that is stopped after its files are written."""
    with during as scratch:
        put(scratch, NEW)
        for step in and_then:
            step()
        raise KeyboardInterrupt


def fails_in(folder, *and_then):
    with pytest.raises(KeyboardInterrupt):
        stopped(whole_folder(folder, "test"), *and_then)


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out" / "o"
    earlier(folder)
    return folder


def test_a_failed_run_keeps_other_files(tmp_path):
    fails_in(
        tmp_path / "out" / "a",
        lambda: written(tmp_path / "out" / "b"),
        lambda: (tmp_path / "out" / "notes.txt").write_text("notes"),
    )
    expected = {f"out/b/{name}": text for name, text in NEW.items()} | {"out/notes.txt": "notes"}
    assert tree(tmp_path) == expected


def test_a_failed_run_removes_the_folders_that_it_made(tmp_path):
    (tmp_path / "there").mkdir()
    fails_in(tmp_path / "there" / "deep" / "o")
    assert list(tmp_path.rglob("*")) == [tmp_path / "there"]


def test_a_new_folder_has_default_permissions_and_an_old_one_keeps_its_own(tmp_path):
    (tmp_path / "plain").mkdir()
    written(tmp_path / "new")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "plain").stat().st_mode
    (tmp_path / "new").chmod(0o750)
    written(tmp_path / "new")
    assert (tmp_path / "new").stat().st_mode & 0o777 == 0o750


def test_files_of_the_same_name_are_replaced_and_others_stay_the_same_files(out):
    before = (out / "mine.txt").stat().st_ino, (out / "deep" / "mine.txt").stat().st_ino
    written(out)
    assert tree(out.parent) == {f"o/{name}": text for name, text in (OLD | NEW).items()}
    assert ((out / "mine.txt").stat().st_ino, (out / "deep/mine.txt").stat().st_ino) == before


def test_a_folder_in_the_place_of_a_file_is_refused_and_nothing_changes(out):
    (out / "a.png").mkdir()
    with refused_input(subject=str(out / "a.png"), found="is a folder"):
        written(out)
    assert tree(out.parent) == {f"o/{name}": text for name, text in OLD.items()}


def test_a_link_to_a_folder_stays_a_link(tmp_path, out):
    (tmp_path / "link").symlink_to(out)
    written(tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert tree(out) == OLD | NEW


def test_a_folder_with_other_files_stays_the_working_folder_of_other_processes(out):
    other = subprocess.Popen(
        [sys.executable, "-c", "input(); open('result.txt', 'w').write('theirs')"],
        cwd=out, stdin=subprocess.PIPE, text=True,
    )  # fmt: skip
    written(out)
    other.communicate("\n", timeout=30)
    assert other.returncode == 0
    assert tree(out) == OLD | NEW | {"result.txt": "theirs"}


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="needs root")
@pytest.mark.parametrize("old", [{}, REPLACED, OLD], ids=["empty", "of a run", "of others too"])
def test_owner_and_group_of_a_folder_and_of_those_in_it_stay(tmp_path, old):
    folder = tmp_path / "o"
    earlier(folder, old)
    folder.mkdir(exist_ok=True)
    folders = [folder, *(path for path in folder.rglob("*") if path.is_dir())]
    for path in folders:
        os.chown(path, 1001, 2000)
    written(folder)
    found = [(path.stat().st_uid, path.stat().st_gid) for path in folders]
    assert found == [(1001, 2000)] * len(folders)
    assert tree(folder) == old | NEW


def test_what_comes_into_the_folder_while_it_is_replaced_is_kept(out, monkeypatch):
    exchange = _files._exchanged
    (out / "mine.txt").unlink()
    shutil.rmtree(out / "deep")

    def exchanged(one, other):
        put(out, {"late.txt": "late", "late/deep.txt": "late too"})
        return exchange(one, other)

    monkeypatch.setattr(_files, "_exchanged", exchanged)
    written(out)
    late = {"late.txt": "late", "late/deep.txt": "late too"}
    assert tree(out.parent) == {f"o/{name}": text for name, text in (NEW | late).items()}


def test_a_file_that_fails_to_move_leaves_no_summary_beside_half_of_the_files(out, monkeypatch):
    move = Path.replace

    def moved(path, target):
        if Path(target) == out / "b.png":
            raise OSError(5, "a disk error")
        return move(path, target)

    monkeypatch.setattr(Path, "replace", moved)
    with refused_input(subject=str(out), requirement="a disk error"):
        written(out)
    left = {name: text for name, text in OLD.items() if name != "summary.json"}
    assert tree(out.parent) == {f"o/{k}": v for k, v in (left | {"a.png": "new a"}).items()}


def fails(*_, **__):
    raise OSError("not on this file system")


@pytest.mark.parametrize("lacks", ["exchange", "locks"])
@pytest.mark.parametrize("old", [REPLACED, OLD], ids=["of a run", "of others too"])
def test_a_file_system_that_lacks_something_gets_the_same_files(tmp_path, monkeypatch, old, lacks):
    earlier(tmp_path / "o", old)
    if lacks == "exchange":
        monkeypatch.setattr(_files, "_exchanged", lambda *_: False)
    else:
        monkeypatch.setattr("fcntl.flock", fails)
    written(tmp_path / "o")
    assert tree(tmp_path) == {f"o/{name}": text for name, text in (old | NEW).items()}
    fails_in(tmp_path / "o")
    assert tree(tmp_path) == {f"o/{name}": text for name, text in (old | NEW).items()}


@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="needs the list of open files")
def test_without_locks_no_file_is_removed_while_it_is_open(out, monkeypatch):
    unlink = Path.unlink

    def closed(path, missing_ok=False):
        open_now = [one.readlink() for one in Path("/proc/self/fd").iterdir() if one.is_symlink()]
        if path in open_now:
            raise PermissionError(13, "in use")  # as Windows says
        unlink(path, missing_ok)

    monkeypatch.setattr("fcntl.flock", fails)
    monkeypatch.setattr(Path, "unlink", closed)
    written(out)
    assert [path.name for path in out.parent.iterdir()] == ["o"]


@pytest.mark.parametrize("what", ["the working folder", "a mount point"])
def test_a_folder_that_cannot_be_renamed_gets_its_files(out, monkeypatch, what):
    inode = out.stat().st_ino
    if what == "a mount point":
        monkeypatch.setattr(_files, "_is_mount", lambda folder: Path(folder) == out)
        written(out)
    else:
        monkeypatch.chdir(out)
        written(Path())
    assert tree(out.parent) == {f"o/{name}": text for name, text in (OLD | NEW).items()}
    assert out.stat().st_ino == inode


def test_a_folder_that_another_run_writes_is_refused_with_its_process(tmp_path, out, monkeypatch):
    with whole_folder(out, "test") as scratch:
        put(scratch, NEW)
        for second in (refuse_unwritable, written):
            with refused_input(value=os.getpid()):
                second(out)
        monkeypatch.chdir(out)
        with refused_input(value=os.getpid()):
            written(Path())
        monkeypatch.chdir(tmp_path)
    assert tree(out.parent) == {f"o/{name}": text for name, text in (OLD | NEW).items()}
    monkeypatch.chdir(out)
    with whole_folder(Path(), "test"), monkeypatch.context() as elsewhere:
        elsewhere.chdir(tmp_path)
        with refused_input(value=os.getpid()):
            written(out)


def test_a_claim_covers_several_results_each_whole(out):
    with claimed_folder(out, "test") as claimed:
        with claimed.scratch() as scratch:
            put(scratch, {"one.json": "1"})
        with pytest.raises(KeyboardInterrupt):
            stopped(claimed.scratch())
        with claimed.scratch() as scratch:
            put(scratch, {"three.json": "3", "three.png": "3"})
        (out / "mine.txt").unlink()
    expected = OLD | {"one.json": "1", "three.json": "3", "three.png": "3"}
    del expected["mine.txt"]
    assert tree(out.parent) == {f"o/{name}": text for name, text in expected.items()}


LIST = {"command": "test", "sha256": [hashlib.sha256(b"theirs").hexdigest()]}
NO_LISTS = {
    "no JSON": "theirs",
    "other JSON": "[1]",
    "deep": "[" * 100_000,
    "no hashes": '{"files": {"a.png": {}}}',
    "outside": json.dumps({"files": {"sensors/../../notes.json": LIST}}),
    "absolute": json.dumps({"files": {"/notes.json": LIST}}),
    "huge number": '{"files": {"a.png": {"command": "test", "sha256": 1e400}}}',
}


@pytest.mark.parametrize("text", NO_LISTS.values(), ids=NO_LISTS)
def test_a_list_that_no_run_wrote_is_refused_and_nothing_changes(out, text):
    (out.parent / "notes.json").write_text("theirs")
    (out / "sensors").mkdir()
    (out / OWN_FILES).write_text(text)
    before = tree(out.parent)
    with (
        refused_input(subject=str(out / OWN_FILES)),
        claimed_folder(out, "test") as claimed,
        claimed.scratch(outdated="sensors/*.json") as scratch,
    ):
        put(scratch, NEW)
    assert tree(out.parent) == before
    assert (out / OWN_FILES).read_text() == text


def test_what_replaces_a_private_file_is_private_while_it_is_written(tmp_path, monkeypatch):
    (tmp_path / "o").mkdir(mode=0o700)
    with whole_folder(tmp_path / "o", "test") as scratch:
        assert scratch.stat().st_mode & 0o777 == 0o700
    seen, keep = [], _files._keep_mode

    def kept(old, new):
        seen.append(new.stat().st_mode & 0o777)
        keep(old, new)

    monkeypatch.setattr(_files, "_keep_mode", kept)
    (tmp_path / "a.json").touch(mode=0o600)
    _files.write_whole(tmp_path / "a.json", b"new")
    assert seen == [0o600]
    assert (tmp_path / "a.json").read_bytes() == b"new"


def ended_by(error, folder, files, *and_then):
    with claimed_folder(folder, "test") as claimed:
        with claimed.scratch() as scratch:
            put(scratch, files)
        for step in and_then:
            step()
        raise error


def test_an_error_removes_what_the_run_added_but_not_what_the_user_then_changed(out):
    before = tree(out)
    new = {"one.json": "1", "sub/two.json": "2", "sub/three.json": "3"}
    changed = partial((out / "sub/two.json").write_text, "mine")
    with pytest.raises(RuntimeError):
        ended_by(RuntimeError(), out, new, changed)
    assert tree(out) == before | {"sub/two.json": "mine"}
    (out / "sub/two.json").unlink()
    (out / "sub").rmdir()
    listed = (out / OWN_FILES).read_bytes()
    with pytest.raises(RuntimeError):
        ended_by(RuntimeError(), out, new)
    assert tree(out) == before
    assert not (out / "sub").exists()
    assert (out / OWN_FILES).read_bytes() == listed


@pytest.mark.parametrize(
    ("error", "stays"),
    [(OSError(28, "full"), True), (MemoryError(), True), (KeyboardInterrupt(), True),
     (InputError("x", "must be y"), False), (RuntimeError(), False)],
)  # fmt: skip
def test_complete_sets_stay_if_the_user_or_the_machine_ends_the_run(tmp_path, error, stays):
    with pytest.raises(type(error)):
        ended_by(error, tmp_path / "a" / "o", {"one.json": "1"})
    assert tree(tmp_path) == ({"a/o/one.json": "1"} if stays else {})
    assert (tmp_path / "a").exists() == stays


def test_a_kept_file_is_known_at_every_moment_of_its_replacement(tmp_path, monkeypatch):
    folder = tmp_path / "o"
    with claimed_folder(folder, "test") as claimed:
        with claimed.scratch() as scratch:
            put(scratch, {"a.json": "1"})
        claimed.keep("kept")
    replace = Path.replace
    for stop_at in range(4):
        done = 0

        def stopped(path, target, stop_at=stop_at):
            nonlocal done
            done += 1
            if done > stop_at:
                raise KeyboardInterrupt
            return replace(path, target)

        with monkeypatch.context() as stopping:
            stopping.setattr(Path, "replace", stopped)
            with suppress(KeyboardInterrupt):
                write_kept(folder / "kept", b"%d" % stop_at)
        with claimed_folder(folder, "test") as claimed:
            claimed.keep("kept")
    (folder / "kept").write_text("theirs")
    with (
        refused_input(subject=str(folder / "kept"), found="was changed after it was written"),
        claimed_folder(folder, "test") as claimed,
    ):
        claimed.keep("kept")
    assert (folder / "kept").read_text() == "theirs"


# every operation on files ends the run once: the n-th in the folder n
STOPPED = """
import os, sys
from pathlib import Path
from chromanoise.base.files import whole_folder

SEEN = {"open", "os.link", "os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.scandir",
        "os.truncate", "os.utime", "os.chmod", "ctypes.dlsym", "shutil.rmtree"}
left, armed = 0, False

def put(folder, files):
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)

def stop(event, _):
    global left
    if armed and event in SEEN:
        left -= 1
        if left < 0:
            END

sys.addaudithook(stop)
number = 0
while True:
    folder = Path(sys.argv[1]) / f"{number:03d}" / "out" / "o"
    with whole_folder(folder, "test") as scratch:
        put(scratch, OWN)
    put(folder, OLD)
    folder.parent.parent.mkdir(parents=True, exist_ok=True)
    (folder.parent.parent / "notes.txt").write_text("notes")
    child = os.fork()
    if child == 0:
        left, armed = number, True
        try:
            with whole_folder(folder, "test") as scratch:
                put(scratch, NEW)
        finally:
            armed = False
            os._exit(0 if left >= 0 else 1)
    _, status = os.waitpid(child, 0)
    if status == 0:
        break
    number += 1
print(number)
"""


@pytest.mark.evidence
@pytest.mark.parametrize("end", ["os._exit(9)", "raise KeyboardInterrupt"])
@pytest.mark.parametrize("old", [{}, REPLACED, OLD], ids=["new", "of a run", "of others too"])
def test_a_stop_at_any_operation_leaves_old_or_new_files_and_no_summary_of_half_of_them(
    tmp_path, old, end
):
    own = {name: text for name, text in old.items() if name in REPLACED}
    script = f"OLD = {old!r}\nOWN = {own!r}\nNEW = {NEW!r}\n{STOPPED.replace('END', end)}"
    number = int(printed(script, tmp_path))
    assert number > 10
    states = [tree(tmp_path / f"{n:03d}" / "out" / "o") for n in range(number)]
    assert old in states
    assert old | NEW in states
    for state in states:
        if state not in (old, old | NEW):
            assert old == OLD, "one step would do"
            assert "summary.json" not in state
            assert {name: state[name] for name in OLD.keys() - NEW} == {
                name: OLD[name] for name in OLD.keys() - NEW
            }
    for n in range(number):
        written(tmp_path / f"{n:03d}" / "out" / "o", NEW | {"again.json": "again"})
        expected = {f"out/o/{k}": v for k, v in (old | NEW | {"again.json": "again"}).items()}
        assert tree(tmp_path / f"{n:03d}") == expected | {"notes.txt": "notes"}
        assert [path.name for path in (tmp_path / f"{n:03d}" / "out").iterdir()] == ["o"]


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs /proc")
def test_a_file_system_without_new_files_is_refused_at_once():
    with pytest.raises((InputError, OSError)), whole_folder(Path("/proc/no-such-folder"), "test"):
        raise AssertionError("a folder was made")


def places(folder):
    """Paths to write to, and whether that is possible."""
    (folder / "file").write_text("mine")
    (folder / "link").symlink_to(folder / "file")
    (folder / "later").symlink_to(folder / "new" / "file")
    (folder / "loop").symlink_to(folder / "loop")
    possible = {"file": True, "link": True, "later": True, "a/b": True, "/dev/null": True}
    return possible | {"loop": False, ".": False, "file/x": False}


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither such links nor devices")
def test_before_and_when_it_is_written_the_same_files_are_refused(tmp_path):
    for place, possible in places(tmp_path).items():
        with claimed_folder(tmp_path, "another run"):
            for act in (refuse_unwritable_file, lambda path: write_whole(path, b"new")):
                with nullcontext() if possible else refused_input():
                    act(tmp_path / place)
    assert (tmp_path / "new" / "file").read_bytes() == b"new"
