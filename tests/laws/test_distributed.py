"""On a cluster: the bits are those of one machine, and what goes wrong is one sentence."""

import os
import pickle
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import tifffile

from chromanoise.base.errors import InputError
from chromanoise.base.files import OWN_FILES
from chromanoise.cli import main
from chromanoise.imaging import (
    Work,
    acquired,
    distributed as on_clusters,
    electrons_of_cube,
    rendered,
    shared_rows,
)
from chromanoise.imaging.distributed import cluster
from chromanoise.imaging.plans import ElectronPlan, light_of, plan_for_rows
from chromanoise.imaging.shared_rows import row_blocks
from chromanoise.io.cubes import read_cube
from chromanoise.sensor import bayer
from chromanoise.spectra import Cube
from chromanoise.spectra.scene_rows import FileRows
from dear import dear
from outcomes import refused, refused_input, same_bits
from processes import command, wait_for
from strategies import bell_qe, point_of, sensor_of, with_pixel_of

ROWS, COLUMNS = 41, 25
WAVELENGTH = np.linspace(400, 700, 31)
SENSOR = sensor_of(
    bell_qe([600.0, 540.0, 450.0], [35.0, 35.0, 25.0], [0.6, 0.7, 0.6]), names=("R", "G", "B")
)
SITUATION = point_of(SENSOR, 30.0)


def reflectances():
    return np.random.default_rng(4).random((ROWS, COLUMNS, WAVELENGTH.size), dtype=np.float32)


IN_MEMORY = {
    "bip": lambda rho: rho,
    "bil": lambda rho: np.ascontiguousarray(rho.transpose(0, 2, 1)).transpose(0, 2, 1),
    "bsq": lambda rho: np.ascontiguousarray(rho.transpose(2, 0, 1)).transpose(1, 2, 0),
}


def in_memory(interleave="bip", rho=None):
    stored = IN_MEMORY[interleave](reflectances() if rho is None else rho)
    return Cube(wavelength_nm=WAVELENGTH, stored=stored, source="a cube in memory")


def envi_file(folder, interleave="bip", rho=None):
    """Written by hand: big-endian, so that no reader can pass the bytes on as they are."""
    rho = reflectances() if rho is None else rho
    order = {"bip": (0, 1, 2), "bil": (0, 2, 1), "bsq": (2, 0, 1)}[interleave]
    np.ascontiguousarray(rho.transpose(order)).astype(">f4").tofile(folder / "cube.img")
    lines, samples, bands = rho.shape
    (folder / "cube.hdr").write_text(
        f"ENVI\nsamples = {samples}\nlines = {lines}\nbands = {bands}\nheader offset = 0\n"
        f"data type = 4\ninterleave = {interleave}\nbyte order = 1\n"
        "wavelength units = Nanometers\n"
        f"wavelength = {{{', '.join(f'{w:g}' for w in WAVELENGTH)}}}\n"
    )
    return folder / "cube.hdr"


@pytest.fixture(scope="module")
def executor(cluster_address):
    with cluster(cluster_address) as found:
        yield found


def test_the_cluster_works_in_other_processes(executor):
    assert executor.submit(os.getpid).result() != os.getpid()


@pytest.mark.parametrize("interleave", ["bip", "bil", "bsq"])
@pytest.mark.parametrize("kept", ["in memory", "in a file"])
def test_a_cluster_makes_the_bits_of_threads(executor, tmp_path, interleave, kept):
    if kept == "in memory":
        cube = in_memory(interleave)
    else:
        cube = read_cube(envi_file(tmp_path, interleave))
    point = with_pixel_of(SITUATION, dsnu_e=3.0, row_noise_e=5.0, prnu=0.01)
    asked = {"seed": 6, "frame": 2}
    there = Work(executor=executor, tile_rows=9)
    for make in (
        partial(acquired, cube, point, mosaic=bayer(), **asked),
        partial(rendered, cube, point, **asked),
        partial(electrons_of_cube, cube, SITUATION),
    ):
        assert same_bits(*(make(work=w) for w in one_and(there)))


@pytest.mark.parametrize("room", [True, False], ids=["in place", "no memory to share"])
def test_workers_of_this_machine_fill_the_picture_in_place(executor, tmp_path, monkeypatch, room):
    if not room:
        monkeypatch.delattr(os, "memfd_create")
    cube = read_cube(envi_file(tmp_path))
    point = with_pixel_of(SITUATION, dsnu_e=3.0, prnu=0.01)
    asked = {"seed": 6}
    there = Work(executor=executor, tile_rows=9, same_machine=True)
    sent = []
    monkeypatch.setattr(executor, "submit", recorded(executor.submit, sent))
    here, beside = (rendered(cube, point, **asked, work=w) for w in one_and(there))
    assert same_bits(here, beside)
    assert type(beside.xyz) is np.ndarray
    assert {task.__name__ for task in sent} == {"_filled_and_put" if room else "_filled_and_sent"}


def recorded(submit, tasks):
    def submitted(task, *arguments):
        tasks.append(task)
        return submit(task, *arguments)

    return submitted


@pytest.mark.parametrize("workers", [1, 2, 8])
def test_every_worker_has_its_share_of_a_file_however_large_the_blocks_may_be(tmp_path, workers):
    gigabyte = tmp_path / "cube.raw"
    gigabyte.touch()
    os.truncate(gigabyte, 10**9)  # nothing is stored, nothing is read
    source = FileRows(
        path=gigabyte,
        offset=0,
        stored=np.dtype("f4"),
        shape=(1000, 1000, 250),
        strides=(1_000_000, 1000, 4),
    )
    blocks = row_blocks(source, Work(executor=ThreadPoolExecutor(1), threads=workers))
    assert len(blocks) >= 4 * workers
    assert max(stop - start for start, stop in blocks) <= 256


def rows_at(path, memory=(0, 0)):
    return shared_rows.SharedRows(
        path=str(path), memory=memory, shape=(2, 3), dtype=np.dtype(np.uint8)
    )


def test_a_worker_of_another_machine_cannot_fill_in_place_and_says_so(tmp_path):
    with refused_input(subject=str(tmp_path / "none"), setting="same_machine"):
        rows_at(tmp_path / "none").put(0, np.zeros((2, 3), np.uint8))


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_picture_that_finds_no_room_in_memory_says_so():
    status = Path("/dev/full").stat()
    full = rows_at("/dev/full", (status.st_dev, status.st_ino))
    with refused_input(remedy=("make a part of it at a time",)):
        full.put(0, np.zeros((2, 3), np.uint8))


def test_more_than_the_machine_has_is_not_shared():
    with shared_rows.shared_rows(((1 << 50, 4), np.float32)) as shared:
        assert shared is None


def test_rows_of_a_picture_that_was_given_up_are_not_put_into_the_next():
    with shared_rows.shared_rows(((2, 3), np.uint8)) as (first,):
        pass
    with shared_rows.shared_rows(((2, 3), np.uint8)) as (second,):
        assert second.path == first.path  # or this test says nothing
        with refused_input(subject="the picture"):
            first.put(0, np.ones((2, 3), np.uint8))
        second.put(1, np.full((1, 3), 7, np.uint8))
        assert second.mapped().tolist() == [[0, 0, 0], [7, 7, 7]]


def test_rows_that_are_written_in_parts_are_whole(monkeypatch):
    write = os.pwrite
    monkeypatch.setattr(os, "pwrite", lambda file, some, at: write(file, some[:2], at))
    rows = np.arange(6, dtype=np.uint8).reshape(2, 3)
    with shared_rows.shared_rows(((4, 3), np.uint8)) as (shared,):
        shared.put(1, rows)
        assert (shared.mapped()[1:3] == rows).all()


def one_and(there):
    return Work(threads=1), there


def test_progress_is_told_of_every_row_that_comes_back(executor):
    rows = []
    work = Work(executor=executor, tile_rows=7, progress=rows.append)
    electrons_of_cube(in_memory(), SITUATION, work=work)
    assert sorted(rows) == [6, 7, 7, 7, 7, 7]


def files_of(folder):
    other = {"summary.json", OWN_FILES}
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.name not in other}


def simulated(source, folder, *more):
    with pytest.raises(SystemExit) as stop:
        main(
            ["simulate", str(source), "--sensor", "model-rgb-ircut", "--mosaic", "bayer",
             "--frames", "2", "--beyond", "zero", "-o", str(folder), *map(str, more)]
        )  # fmt: skip
    return stop.value.code


@pytest.fixture
def wide_file(tmp_path):
    """A cube over the whole grid of the catalog's sensors, as ENVI."""
    path = envi_file(tmp_path)
    ends = ", ".join(f"{w:g}" for w in np.linspace(400, 1050, WAVELENGTH.size))
    head, _, _ = path.read_text().rpartition("wavelength =")
    path.write_text(f"{head}wavelength = {{{ends}}}\n")
    return path


@pytest.mark.evidence
def test_the_command_writes_the_same_files_on_threads_and_on_any_cluster(
    cluster_address, wide_file, tmp_path, capsys
):
    assert simulated(wide_file, tmp_path / "threads") == 0
    asked = ("--tile", 10, "--scheduler")
    assert simulated(wide_file, tmp_path / "there", *asked, cluster_address) == 0
    assert simulated(wide_file, tmp_path / "local", "--threads", 1, *asked, "local") == 0
    capsys.readouterr()
    files = files_of(tmp_path / "threads")
    assert len(files) == 8
    assert files_of(tmp_path / "there") == files
    assert files_of(tmp_path / "local") == files
    assert tifffile.imread(tmp_path / "there" / "model-rgb-ircut-0001.raw.tiff").std() > 0


@pytest.mark.parametrize("after_s", [0.0, *dear(3.0)], ids="{:g} s".format)
def test_a_stop_from_the_keyboard_ends_a_local_cluster_in_one_line(wide_file, tmp_path, after_s):
    with command(
        "simulate", wide_file, "--sensor", "model-rgb-ircut", "--mosaic", "bayer", "--raw-only",
        "--beyond", "zero", "--frames", "100000", "--scheduler", "local", "--threads", "2",
        "-o", tmp_path / "o",
    ) as process:  # fmt: skip
        wait_for(lambda: list(tmp_path.glob(".o-*")), process)  # the cluster comes next
        time.sleep(after_s)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, "")
    *estimate, last = filter(None, err.splitlines())
    assert last == "chromanoise: stopped"
    assert all(line.startswith("the pictures: takes about") for line in estimate)
    assert not list(tmp_path.glob("*o*/"))


def spoiled(kind, tmp_path):
    rho = reflectances()
    rho[33, 5, 7] = np.nan
    if kind == "file":
        return read_cube(envi_file(tmp_path, rho=rho))
    return in_memory(rho=rho)


@pytest.mark.parametrize("kind", ["file", "memory"])
def test_a_bad_reflectance_is_the_same_sentence_from_a_worker(executor, tmp_path, kind):
    cube, values = spoiled(kind, tmp_path), []
    for work in (Work(tile_rows=9), Work(tile_rows=9, executor=executor)):
        with refused_input(subject=cube.source) as refused:
            acquired(cube, SITUATION, mosaic=bayer(), work=work)
        assert refused.value.where.startswith("row 33, column 5 ")
        values.append(str(refused.value))
    assert values[0] == values[1]


def test_after_a_refused_cube_the_cluster_works_on(executor):
    bad = reflectances()
    bad[:] = -1.0
    with pytest.raises(InputError):
        electrons_of_cube(in_memory(rho=bad), SITUATION, work=Work(executor=executor, tile_rows=4))
    here, away = (
        electrons_of_cube(in_memory(), SITUATION, work=w) for w in one_and(Work(executor=executor))
    )
    assert (here == away).all()


@pytest.mark.parametrize("kept", ["in memory", "in a file"])
def test_what_is_sent_of_a_cube_is_a_block_in_memory_and_nothing_in_a_file(tmp_path, kept):
    rho = np.full((400, 50, WAVELENGTH.size), 0.5, np.float32)
    cube = in_memory(rho=rho) if kept == "in memory" else read_cube(envi_file(tmp_path, rho=rho))
    plan = ElectronPlan(light=light_of(cube, SITUATION, beyond="refuse"))
    sent = len(pickle.dumps(plan_for_rows(plan, 10, 12)[0], protocol=5))
    block = rho[10:12].nbytes if kept == "in memory" else 0
    assert block <= sent < block + 20_000


def test_a_worker_that_is_killed_in_the_work_changes_no_bit(executor, kill_one):
    cube = in_memory("bil")
    there = Work(executor=executor, tile_rows=1, progress=kill_one)
    here, away = (acquired(cube, SITUATION, mosaic=bayer(), work=w) for w in one_and(there))
    assert same_bits(here, away)


def test_a_cluster_that_loses_its_workers_says_so():
    dask = pytest.importorskip("dask", reason="dask is an extra")
    pytest.importorskip("distributed", reason="dask is an extra")
    once = {"distributed.scheduler.allowed-failures": 0}
    with (
        dask.config.set(once),
        refused_input(setting="tile_rows", requirement="KilledWorker"),
        cluster("local", workers=1) as executor,
    ):
        executor.submit(os._exit, 1).result()


@pytest.mark.parametrize(
    "scheduler", ["tcp://127.0.0.1:1", "nowhere://127.0.0.1:80", "tcp://127.0.0.1:99999999"]
)
def test_a_scheduler_that_does_not_answer_is_one_sentence(
    wide_file, tmp_path, capsys, monkeypatch, scheduler
):
    dask = pytest.importorskip("dask", reason="dask is an extra")
    monkeypatch.setattr(on_clusters, "_ANSWERS_WITHIN_S", 0.5)
    code = simulated(wide_file, tmp_path / "o", "--scheduler", scheduler)
    refused((code, *capsys.readouterr()), f"'{scheduler}'")
    assert dask.config.get("scheduler", None) is None  # others' work with dask goes on
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cube.hdr", "cube.img"]


@pytest.mark.parametrize("missing", ["dask", "dask.distributed"])
def test_without_dask_the_way_to_install_it_is_told(
    wide_file, tmp_path, capsys, monkeypatch, missing
):
    monkeypatch.setitem(sys.modules, missing, None)
    code = simulated(wide_file, tmp_path / "o", "--scheduler", "local")
    refused((code, *capsys.readouterr()), "pip install 'chromanoise[distributed]'")
    assert not (tmp_path / "o").exists()


def test_an_executor_may_finish_its_blocks_in_any_order():
    class Backwards(ThreadPoolExecutor):
        """Holds what it is given until the first is waited for, and starts with the last."""

        def __init__(self):
            super().__init__(1)
            self.held = []

        def submit(self, call, /, *arguments, **more):
            future = super().submit(lambda: None).__class__()
            self.held.append((future, call, arguments, more))
            if len(self.held) == 5:
                for late, run, given, named in reversed(self.held):
                    late.set_result(run(*given, **named))
            return future

    with Backwards() as executor:
        work = Work(executor=executor, tile_rows=9)
        here, away = (
            acquired(in_memory(), SITUATION, mosaic=bayer(), work=w) for w in one_and(work)
        )
    assert same_bits(here, away)
