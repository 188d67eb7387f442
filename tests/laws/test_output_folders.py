"""Outputs appear whole or not at all, whatever stops a run; nothing of others is touched."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import chromanoise
from chromanoise import _files
from chromanoise._check import InputError
from chromanoise._files import claimed_folder, refuse_unwritable, whole_folder

NEW = {"a.png": "new a", "b.png": "new b", "summary.json": "new"}
OLD = {"b.png": "old b", "summary.json": "old", "mine.txt": "mine", "deep/mine.txt": "mine too"}


def put(folder, files):
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def tree(folder):
    return {
        str(path.relative_to(folder)): path.read_text()
        for path in folder.rglob("*")
        if path.is_file()
    }


def written(folder, files=NEW):
    with whole_folder(folder) as scratch:
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
        stopped(whole_folder(folder), *and_then)


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out" / "o"
    put(folder, OLD)
    return folder


def test_a_run_that_fails_leaves_what_others_put_beside_it(tmp_path):
    fails_in(
        tmp_path / "out" / "a",
        lambda: written(tmp_path / "out" / "b"),
        lambda: (tmp_path / "out" / "notes.txt").write_text("notes"),
    )
    expected = {f"out/b/{name}": text for name, text in NEW.items()} | {"out/notes.txt": "notes"}
    assert tree(tmp_path) == expected


def test_a_run_that_fails_removes_the_folders_that_it_made(tmp_path):
    (tmp_path / "there").mkdir()
    fails_in(tmp_path / "there" / "deep" / "o")
    assert list(tmp_path.rglob("*")) == [tmp_path / "there"]


def test_a_new_folder_has_the_rights_of_any_new_folder_and_an_old_one_keeps_its_own(tmp_path):
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
    with pytest.raises(InputError, match=r"a\.png: is a folder"):
        written(out)
    assert tree(out.parent) == {f"o/{name}": text for name, text in OLD.items()}


def test_a_link_to_a_folder_stays_a_link(tmp_path, out):
    (tmp_path / "link").symlink_to(out)
    written(tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert tree(out) == OLD | NEW


def test_what_comes_into_the_folder_while_it_is_replaced_is_kept(out, monkeypatch):
    exchange = _files._exchanged

    def exchanged(one, other):
        put(out, {"late.txt": "late", "late/deep.txt": "late too", "deep/late.txt": "late three"})
        (out / "editor").write_text("mine, changed")
        (out / "editor").replace(out / "mine.txt")  # as an editor saves
        return exchange(one, other)

    monkeypatch.setattr(_files, "_exchanged", exchanged)
    written(out)
    late = {"late.txt": "late", "late/deep.txt": "late too", "deep/late.txt": "late three"}
    changed = {"mine.txt": "mine, changed"}
    assert tree(out.parent) == {f"o/{k}": v for k, v in (OLD | NEW | late | changed).items()}


def no_links(*_, **__):
    raise OSError("no links here")


@pytest.mark.parametrize("lacks", ["links", "exchange", "locks"])
def test_a_file_system_that_lacks_something_gets_the_same_files(out, monkeypatch, lacks):
    if lacks == "links":
        monkeypatch.setattr(os, "link", no_links)
    elif lacks == "exchange":
        monkeypatch.setattr(_files, "_exchanged", lambda *_: False)
    else:
        monkeypatch.setattr("fcntl.flock", no_links)
    written(out)
    assert tree(out.parent) == {f"o/{name}": text for name, text in (OLD | NEW).items()}
    fails_in(out)
    assert tree(out.parent) == {f"o/{name}": text for name, text in (OLD | NEW).items()}


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
    with whole_folder(out) as scratch:
        put(scratch, NEW)
        for second in (refuse_unwritable, written):
            with pytest.raises(InputError, match=f"process {os.getpid()} is writing into it"):
                second(out)
        monkeypatch.chdir(out)
        with pytest.raises(InputError, match=f"process {os.getpid()} is writing into it"):
            written(Path())
        monkeypatch.chdir(tmp_path)
    assert tree(out.parent) == {f"o/{name}": text for name, text in (OLD | NEW).items()}
    monkeypatch.chdir(out)
    with whole_folder(Path()), monkeypatch.context() as elsewhere:
        elsewhere.chdir(tmp_path)
        with pytest.raises(InputError, match=f"process {os.getpid()} is writing into it"):
            written(out)


def test_a_claim_covers_several_results_each_whole(out):
    with claimed_folder(out) as scratch_folder:
        with scratch_folder() as scratch:
            put(scratch, {"one.json": "1"})
        with pytest.raises(KeyboardInterrupt):
            stopped(scratch_folder())
        with scratch_folder() as scratch:
            put(scratch, {"three.json": "3", "three.png": "3"})
        (out / "mine.txt").unlink()
    expected = OLD | {"one.json": "1", "three.json": "3", "three.png": "3"}
    del expected["mine.txt"]
    assert tree(out.parent) == {f"o/{name}": text for name, text in expected.items()}


# every operation on files ends the run once: the n-th in the folder n
STOPPED = """
import os, sys
from pathlib import Path
from chromanoise._files import whole_folder

SEEN = {"open", "os.link", "os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.scandir",
        "os.truncate", "os.utime", "os.chmod", "ctypes.dlsym", "shutil.rmtree"}
left, armed = 0, False

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
    for name, text in OLD.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    folder.parent.parent.mkdir(parents=True, exist_ok=True)
    (folder.parent.parent / "notes.txt").write_text("notes")
    child = os.fork()
    if child == 0:
        left, armed = number, True
        try:
            with whole_folder(folder) as scratch:
                for name, text in NEW.items():
                    (scratch / name).write_text(text)
        finally:
            armed = False
            os._exit(0 if left >= 0 else 1)
    _, status = os.waitpid(child, 0)
    if status == 0:
        break
    number += 1
print(number)
"""


@pytest.mark.parametrize("end", ["os._exit(9)", "raise KeyboardInterrupt"])
@pytest.mark.parametrize("old", [{}, OLD], ids=["a new folder", "a folder with files"])
def test_a_stop_at_any_operation_leaves_the_old_state_or_the_new_one(tmp_path, old, end):
    script = f"OLD = {old!r}\nNEW = {NEW!r}\n{STOPPED.replace('END', end)}"
    done = subprocess.run(
        [sys.executable, "-c", script, tmp_path],
        env={**os.environ, "PYTHONPATH": str(Path(chromanoise.__file__).parents[1])},
        capture_output=True, text=True, check=True, timeout=60,
    )  # fmt: skip
    number = int(done.stdout)
    assert number > 10
    states = [tree(tmp_path / f"{n:03d}" / "out" / "o") for n in range(number)]
    assert {len(state) for state in states} == {len(old), len(old | NEW)}
    assert all(state in (old, old | NEW) for state in states)
    for n in range(number):
        written(tmp_path / f"{n:03d}" / "out" / "o", NEW | {"again.json": "again"})
        expected = {f"out/o/{k}": v for k, v in (old | NEW | {"again.json": "again"}).items()}
        assert tree(tmp_path / f"{n:03d}") == expected | {"notes.txt": "notes"}
        assert [path.name for path in (tmp_path / f"{n:03d}" / "out").iterdir()] == ["o"]
