"""Memory that is used again: as large as asked for, and in large pages where there are such."""

import mmap

import numpy as np
import pytest

from chromanoise.imaging.blocks import Scratch, in_large_pages, new_rows


def refused(*_):
    raise OSError("no large pages")


@pytest.fixture(params=["large pages", "none in the system", "none in Python"])
def system(request, monkeypatch):
    if request.param == "none in Python":
        monkeypatch.delattr(mmap, "MADV_HUGEPAGE", raising=False)
    elif request.param == "none in the system":
        deaf = type("Deaf", (mmap.mmap,), {"madvise": refused})
        monkeypatch.setattr(mmap, "mmap", deaf)
    return request.param


@pytest.mark.usefixtures("system")
@pytest.mark.parametrize("size", [1, 4097, 3 << 20])
def test_memory_is_as_large_as_asked_for_and_may_be_written(size):
    one, other = in_large_pages(size), in_large_pages(size)
    one[:], other[:] = 1, 2
    assert one.shape == other.shape == (size,)
    assert one.dtype == np.uint8
    assert (one == 1).all()
    assert (other == 2).all()


@pytest.mark.skipif(not hasattr(mmap, "MADV_HUGEPAGE"), reason="no large pages here")
def test_large_pages_begin_where_a_page_does():
    assert in_large_pages(5).ctypes.data % (2 << 20) == 0


@pytest.mark.usefixtures("system")
@pytest.mark.parametrize("shape", [(3, 2, 5), (0, 7), (1200, 1000, 3)])
def test_new_rows_have_the_shape_and_type_that_is_asked_for(shape):
    rows = new_rows(shape, np.float32)
    rows[...] = 1.5
    assert rows.shape == shape
    assert rows.dtype == np.float32
    assert rows.flags.c_contiguous
    assert float(rows.sum()) == 1.5 * rows.size


def test_scratch_is_kept_as_long_as_it_is_large_enough():
    scratch = Scratch()
    first = scratch.of(1000)
    assert scratch.of(0) is None
    assert scratch.of(500).ctypes.data == first.ctypes.data
    assert scratch.of(1 << 23).size == 1 << 23
