"""The contract of all formats: a damaged file is read whole, or refused in one sentence."""

import os
import pickle
import resource

import numpy as np
import pytest

from chromanoise.base.errors import InputError
from damage import INTERNALS, damaged, mutated, random_edits

for package in ("h5py", "zarr", "astropy", "rawpy"):
    pytest.importorskip(package, reason="comes with an extra of chromanoise")

from formats import FORMATS  # noqa: E402 - it needs these packages

COUNT = int(os.environ.get("CHROMANOISE_DAMAGED_FILES", "100000"))
OTHERS = (
    *(b"", b"\0", b"nonsense" * 100, b"PK\x03\x04", b"\x93NUMPY\x01\x00", b"CDF\x01" + bytes(99)),
    *(b"\x89PNG\r\n\x1a\n" + bytes(99), b"%PDF-1.7", b"{", b"<a>", pickle.dumps([1]), b"1,2\n"),
)
SLOW = ("lzw", "packbits", "jpeg", "pillow", "dng", "7.3", "hdf5", "zarr")
"""In names of formats that start a child process after each damage, or a slow library reads."""


def outcome(form, path, original):
    """The error of a file as text; empty if it is read."""
    try:
        read = form.read(path)
    except InputError as error:
        lines = str(error).splitlines()
        assert len(lines) == 1 or form.sentences
        for line in lines:
            assert any(name in line for name in (str(path.parent), path.name, path.stem)), line
            assert len(line) < 2000
            assert not INTERNALS.search(line), line
        return str(error)
    if form.sealed and read[0].shape == original[0].shape:
        assert np.array_equal(read[0], original[0])
    return ""


def faults(whole, rng, *, cuts, others, count):
    """Cut in many places, doubled, of another kind, and damaged at random."""
    yield from (whole[: len(whole) * i // cuts] for i in range(cuts))
    yield from (whole[:-1], whole + whole, *others)
    for i in range(count):
        yield damaged(whole, rng) if i % 2 else mutated(whole, random_edits(rng))


@pytest.mark.parametrize("name", FORMATS)
def test_a_damaged_file_is_read_whole_or_refused_in_one_sentence(tmp_path, name):
    form, rng = FORMATS[name], np.random.default_rng(7)
    path = form.write(tmp_path)
    files = sorted(one for one in tmp_path.rglob("*") if one.is_file())
    files = files if len(files) < 5 or path.is_dir() else [path]
    original = form.read(path)
    refused, few = 0, any(word in name for word in SLOW)
    kinds = (
        {"cuts": 2, "others": OTHERS[:1], "count": 2 // len(files)}
        if few
        else {"cuts": 10, "others": OTHERS, "count": 20 // len(files)}
    )
    for file in files:
        whole = file.read_bytes()
        for content in faults(whole, rng, **kinds):
            file.write_bytes(content)
            refused += bool(outcome(form, path, original))
            assert file.read_bytes() == content
        file.write_bytes(whole)
    assert refused >= (3 if few else 10)
    again = form.read(path)
    assert all(np.array_equal(a, b) for a, b in zip(original, again, strict=True))


@pytest.mark.evidence
def test_very_many_damaged_files_are_read_whole_or_refused(tmp_path):
    """Cubes and frames have a test of their own, with limits of memory and time for each."""
    names = [name for name in FORMATS if not name.startswith(("cube", "frame"))]
    rng = np.random.default_rng(12)
    written = {}
    for k, name in enumerate(names):
        (tmp_path / str(k)).mkdir()
        path = FORMATS[name].write(tmp_path / str(k))
        written[name] = path, path.read_bytes(), FORMATS[name].read(path)
    for i in range(COUNT):
        name = names[i % len(names)]
        path, whole, original = written[name]
        path.write_bytes(mutated(whole, random_edits(rng)))
        outcome(FORMATS[name], path, original)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 2**20  # KiB: 1 GiB
