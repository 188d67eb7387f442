"""Damaged cubes of every format, each read in a separate process: python damaged_cubes.py COUNT.

A process is forked for each file, with limits of memory and time, so that a crash, an endless loop
or gigabytes of memory are detected and end only that process. Libraries run in a further
process, as in production, but forked instead of started. The summary is JSON on stdout.
"""

import gc
import json
import os
import pickle
import resource
import select
import shutil
import signal
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import h5py
import numpy as np
import scipy.io
import tifffile
import zarr
from PIL import Image

from chromanoise.base import sandbox as _sandbox
from chromanoise.base.errors import InputError
from chromanoise.io.cubes import read_cube
from chromanoise.spectra import row_source
from chromanoise.spectra.scene import reflectance_rows
from damage import INTERNALS, damaged

NM = (400.0, 450.0, 500.0, 600.0, 700.0)
CUBE = np.random.default_rng(5).integers(1, 128, size=(3, 4, 5)) / 128
WHOLE = (CUBE * 128).astype(np.uint8)
EVEN = {"wavelengths": (400, 800)}
MEMORY_BYTES = 2**30  # in addition to the memory that the process has before
SECONDS = 30.0
SEED = 7


# whole cubes


def write_envi(folder, interleave="bil"):
    order = {"bsq": (2, 0, 1), "bil": (0, 2, 1), "bip": (0, 1, 2)}[interleave]
    (folder / "a.img").write_bytes(CUBE.transpose(order).astype("<f4").tobytes())
    listed = ", ".join(map(str, NM))
    (folder / "a.hdr").write_text(
        f"ENVI\nsamples = 4\nlines = 3\nbands = 5\ndata type = 4\ninterleave = {interleave}\n"
        f"byte order = 0\nheader offset = 0\nwavelength units = nm\nwavelength = {{{listed}}}\n"
    )
    return folder / "a.hdr"


def write_mat(folder, packed):
    arrays = {"reflectance": CUBE, "wl": np.array(NM), "note": "text", "cell": {"a": 1.0}}
    scipy.io.savemat(folder / "a.mat", arrays, do_compression=packed)
    return folder / "a.mat"


def write_npz(folder, packed):
    save = np.savez_compressed if packed else np.savez
    save(folder / "a.npz", reflectance=CUBE, bands_nm=np.array(NM))
    return folder / "a.npz"


def write_npy(folder):
    np.save(folder / "a.npy", CUBE)
    return folder / "a.npy"


def write_hdf5(folder, name="a.h5", matlab=False, **options):
    cube = CUBE.T if matlab else CUBE
    with h5py.File(folder / name, "w", userblock_size=512 if matlab else 0) as file:
        file.create_dataset("reflectance", data=cube, **options)
        file["wl"] = np.array(NM)
        file["wl"].attrs["units"] = "nm"
        if matlab:
            for array in file.values():
                array.attrs["MATLAB_class"] = np.bytes_("double")
    if matlab:
        with (folder / name).open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return folder / name


def write_zarr(folder, version, **options):
    group = zarr.create_group(folder / "a.zarr", zarr_format=version)
    group.create_array("reflectance", data=CUBE, chunks=(2, 4, 5), **options)
    group.create_array("wavelengths", data=np.array(NM), chunks=(5,))
    return folder / "a.zarr"


def write_tiff(folder, **options):
    with tifffile.TiffWriter(folder / "a.tif") as file:
        for plane in CUBE.transpose(2, 0, 1).astype("f4"):
            file.write(plane, photometric="minisblack", metadata=None, **options)
    return folder / "a.tif"


def write_tiff_by_pillow(folder, compression):
    kind = WHOLE if compression == "jpeg" else CUBE.astype("f4")
    first, *more = (Image.fromarray(kind[:, :, k]) for k in range(5))
    first.save(folder / "a.tif", save_all=True, append_images=more, compression=compression)
    return folder / "a.tif"


def write_pngs(folder):
    (folder / "a").mkdir()
    for k, nm in enumerate(range(400, 801, 100)):
        Image.fromarray(WHOLE[:, :, k]).save(folder / "a" / f"b{nm}.png")
    return folder / "a"


def write_listed(folder):
    (folder / "wl.csv").write_text("center (um);width\n" + "".join(f"{n / 1000};1\n" for n in NM))
    return write_npy(folder)


# name: writer, options of read_cube, whether a checksum covers the numbers
FORMATS = {
    "envi bil": (write_envi, {}, False),
    "envi bsq": (partial(write_envi, interleave="bsq"), {}, False),
    "mat": (partial(write_mat, packed=False), {}, False),
    "mat packed": (partial(write_mat, packed=True), {}, True),
    "mat 7.3": (partial(write_hdf5, name="a.mat", matlab=True), {}, False),
    "mat 7.3 packed": (
        partial(write_hdf5, name="a.mat", matlab=True, chunks=(5, 2, 3), compression="gzip"),
        {}, False,
    ),
    "npz": (partial(write_npz, packed=False), {}, True),
    "npz packed": (partial(write_npz, packed=True), {}, True),
    "npy": (write_npy, EVEN, False),
    "hdf5": (write_hdf5, {}, False),
    "hdf5 gzip": (
        partial(write_hdf5, chunks=(2, 2, 5), compression="gzip", shuffle=True), {}, False,
    ),
    "hdf5 checked": (
        partial(write_hdf5, chunks=(2, 2, 5), compression="gzip", fletcher32=True), {}, False,
    ),
    "hdf5 lzf": (partial(write_hdf5, chunks=(2, 2, 5), compression="lzf"), {}, False),
    "zarr 2": (partial(write_zarr, version=2), {}, False),
    "zarr 3": (partial(write_zarr, version=3), {}, False),
    "zarr blosc": (partial(write_zarr, version=3, compressors=zarr.codecs.BloscCodec()), {}, False),
    "zarr shards": (
        partial(write_zarr, version=3, shards=(2, 4, 5), compressors=zarr.codecs.BloscCodec()),
        {}, False,
    ),
    "tiff": (write_tiff, EVEN, False),
    "tiff deflate": (partial(write_tiff, compression="zlib"), EVEN, False),
    "tiff lzma": (partial(write_tiff, compression="lzma"), EVEN, False),
    "tiff tiled": (partial(write_tiff, tile=(16, 16), compression="zlib"), EVEN, False),
    "tiff lzw": (partial(write_tiff_by_pillow, compression="tiff_lzw"), EVEN, False),
    "tiff packbits": (partial(write_tiff_by_pillow, compression="packbits"), EVEN, False),
    "tiff jpeg": (partial(write_tiff_by_pillow, compression="jpeg"), EVEN | {"scale": 0.01}, False),
    "png": (write_pngs, {"scale": 1 / 255}, False),
    "listed": (write_listed, {"wavelengths": "wl.csv"}, False),
}  # fmt: skip


# reading


def returned_in_a_fork(child, function, given, path, limit_s, memory_bytes):
    """Like the child process of `_sandbox`, but forked."""
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.close(reader)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        signal.alarm(10)  # a library may loop
        _sandbox._bound(limit_s, memory_bytes)
        _write_all(writer, pickle.dumps(_sandbox._answer(function, given, "")))
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as stream:
        result = stream.read()
    _, status = os.waitpid(pid, 0)
    if code := os.waitstatus_to_exitcode(status):
        raise _sandbox._fault(code, limit_s)
    how, what = pickle.loads(result)
    return _sandbox._result(how, what)


def _write_all(handle, raw):
    while raw:
        raw = raw[os.write(handle, raw) :]


def outcome(path, options, checked, original):
    """Outcome for one file: right, other numbers, an error sentence, or what went wrong."""
    try:
        cube = read_cube(path, **options)
        source = row_source(cube.stored)
        blocks = [
            (source.rows(a, min(a + 2, source.shape[0])), reflectance_rows(cube, a, a + 1))
            for a in range(0, min(source.shape[0], 8), 2)
        ]
    except InputError as error:
        message = str(error)
        if "\n" in message or len(message) > 2000 or INTERNALS.search(message):
            return f"not one plain sentence: {message[:300]}"
        return "sentence" if path.name.rpartition(".")[0][:1] in message else f"unnamed: {message}"
    except BaseException as error:
        return f"{type(error).__name__}: {str(error)[:200]}"
    nm = cube.wavelength_nm
    if nm.size != source.shape[2] or not (np.diff(nm) > 0).all() or nm[0] < 100:
        return f"wrong wavelengths {nm}"
    rows = np.concatenate([block for block, _ in blocks])
    if rows.shape[1:] != source.shape[1:]:
        return f"wrong shape {rows.shape}"
    if rows.shape == original.shape and np.array_equal(rows, original):
        return "right"
    return "wrong numbers under a checksum" if checked else "other numbers"


def in_a_fork(path, options, checked, original):
    """The outcome, what was printed, and the memory that it took [KiB]."""
    reader, writer = os.pipe()
    with tempfile.TemporaryFile() as printed:
        pid = os.fork()
        if pid == 0:
            os.dup2(printed.fileno(), 1)
            os.dup2(printed.fileno(), 2)
            limit = _mapped_bytes() + MEMORY_BYTES
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            _write_all(writer, outcome(path, options, checked, original).encode())
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(0)
        os.close(writer)
        result = _read_in_time(reader)
        os.close(reader)
        if result is None:
            os.kill(pid, signal.SIGKILL)
        _, status, usage = os.wait4(pid, 0)
        code = os.waitstatus_to_exitcode(status)
        printed.seek(0)
        chatter = printed.read(300).decode("utf-8", "replace")
    if result is None:
        result = f"not done in {SECONDS:g} s"
    elif code:
        result = f"ended with code {code}"
    elif chatter:
        result = f"printed {chatter!r}, then {result}"
    return result, usage.ru_maxrss


def _read_in_time(reader):
    until, received = time.monotonic() + SECONDS, b""
    while (left := until - time.monotonic()) > 0:
        if select.select([reader], [], [], left)[0]:
            part = os.read(reader, 65536)
            if not part:
                return received.decode("utf-8", "replace")
            received += part
    return None


def _mapped_bytes():
    return int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")


def prepared(root, name):
    """A whole cube in a folder of its own, its files, and its numbers as they are read."""
    write, options, checked = FORMATS[name]
    folder = root / name.replace(" ", "-")
    folder.mkdir()
    path = write(folder)
    options = {k: str(folder / v) if isinstance(v, str) else v for k, v in options.items()}
    files = sorted(p for p in folder.rglob("*") if p.is_file())
    contents = {file: file.read_bytes() for file in files}
    if name == "listed":
        files = [folder / "wl.csv"]
    original = CUBE.astype("f4") if name.startswith(("envi", "tiff")) else CUBE
    original = WHOLE if name in ("png", "tiff jpeg") else original
    return path, options, checked, original, files, contents


def main(count, seed=SEED, first=0):
    """Damage this many files and print the outcomes."""
    _sandbox._Child.returned = returned_in_a_fork
    root = Path(tempfile.mkdtemp(dir="/dev/shm" if Path("/dev/shm").is_dir() else None))
    outcomes, faults, largest = {}, [], 0
    begun = time.monotonic()
    try:
        samples = {name: prepared(root, name) for name in FORMATS}
        for name, (path, options, checked, original, *_) in samples.items():
            result, _ = in_a_fork(path, options, checked, original)
            if result != "right" and name != "tiff jpeg":  # JPEG loses digits
                faults.append({"format": name, "number": -1, "result": result})
        gc.disable()  # a collection in a fork would copy all memory that it shares
        gc.freeze()
        for number in range(first, first + count):
            rng = np.random.default_rng([seed, number])
            name = list(FORMATS)[number % len(FORMATS)]
            path, options, checked, original, files, contents = samples[name]
            file = files[rng.integers(len(files))]
            file.write_bytes(damaged(contents[file], rng))
            result, kib = in_a_fork(path, options, checked, original)
            file.write_bytes(contents[file])
            largest = max(largest, kib)
            kind = result if result in ("right", "other numbers", "sentence") else "fault"
            own = outcomes.setdefault(name, {})
            own[kind] = own.get(kind, 0) + 1
            if kind == "fault":
                faults.append({"format": name, "number": number, "result": result})
    finally:
        shutil.rmtree(root, ignore_errors=True)
    summary = {"count": count, "outcomes": outcomes, "faults": faults, "largest_kib": largest}
    print(json.dumps(summary | {"seconds": round(time.monotonic() - begun, 1)}))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
