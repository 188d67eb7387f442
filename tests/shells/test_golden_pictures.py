"""The first screens of the page, and the card, look as their committed pictures.

Pictures are compared in cells of 20 x 20 pixels, because letters differ between versions of a
browser and its fonts. `tools/photograph_page.py NAME` takes a new picture: look at it.
"""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image, ImageOps

from photograph_page import FILES, PICTURES, SHOTS, photograph

CELL = 20
MEAN, FAR = 4.0, 24.0  # difference over all cells, and of a cell that is far off, of 255
FAR_SHARE = 0.02  # of the cells that may be far off
SCREENS = ("page-first", "page-first-dark", "page-printed", "page-phone")


def cells(picture):
    small = Image.open(BytesIO(picture)).convert("RGB")
    return np.asarray(small.reduce(CELL), float)


def looks_like(name, picture):
    golden, found = cells((PICTURES / f"{name}.png").read_bytes()), cells(picture)
    if golden.shape != found.shape:
        return False
    apart = np.abs(golden - found).mean(axis=-1)
    print(name, apart.mean(), (apart > FAR).mean())
    return apart.mean() < MEAN and (apart > FAR).mean() < FAR_SHARE


@pytest.mark.parametrize("name", SCREENS)
def test_a_first_screen_looks_as_its_committed_picture(name, chromium, page_address):
    assert looks_like(name, photograph(chromium, page_address, SHOTS[name]))


@pytest.mark.evidence
def test_the_card_looks_as_its_committed_picture(tmp_path):
    assert looks_like("card", FILES["card"](None, tmp_path))


def test_a_lost_panel_other_colors_and_a_shift_are_seen():
    golden = Image.open(PICTURES / "page-first.png").convert("RGB")
    lost, shifted = golden.copy(), Image.new("RGB", golden.size, "white")
    lost.paste((255, 255, 255), (640, 400, 1280, 800))
    shifted.paste(golden, (0, 40))
    for other in (lost, shifted, ImageOps.invert(golden)):
        other.save(written := BytesIO(), "png")
        assert not looks_like("page-first", written.getvalue())
