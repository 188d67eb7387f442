"""The descriptor of EMVA 1288: what the reference package writes and parses."""

import re

import numpy as np
import pytest
from PIL import Image

from chromanoise.io.frames import read_frame_set
from outcomes import refused_input

NEEDS = "needs the package emva1288"
generator = pytest.importorskip("emva1288.camera.dataset_generator", reason=NEEDS)
parser = pytest.importorskip("emva1288.process.parser", reason=NEEDS)

SIDE = 6


def put(folder, count):
    for i in range(count):
        codes = np.full((SIDE, SIDE + 2), 100 + i, np.uint16)
        Image.fromarray(codes).save(folder / f"image {i}.png")


def described(folder, *lines):
    text = "\n".join(("v 4.0", f"n 10 {SIDE + 2} {SIDE}", *lines))
    (folder / "EMVA1288descriptor.txt").write_text(text)
    return folder / "EMVA1288descriptor.txt"


def files(*numbers):
    return [f"i image {i}.png" for i in numbers]


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning")  # of theirs
def test_a_data_set_of_the_reference_package_is_read_as_its_own_parser_reads_it(tmp_path):
    made = generator.DatasetGenerator(
        steps=4, L=5, outdir=str(tmp_path), width=8, height=SIDE, bit_depth=10, image_format="tif"
    )
    theirs = parser.ParseEmvaDescriptorFile(made.descriptor_path).images
    expected = sorted(
        (time_ns / 1e6, photons, sorted(name.split("/")[-1] for name in names))
        for kind in theirs.values()
        for time_ns, of_time in kind.items()
        for photons, names in of_time.items()
        if photons
    )
    frames = read_frame_set([tmp_path])
    lit = [level for level in frames.levels if level.flats]
    ours = sorted(
        (one.time_ms, one.photons_per_pixel, sorted(frame.path.name for frame in one.flats))
        for one in lit
    )
    assert [one[2] for one in ours] == [one[2] for one in expected]
    assert np.array([one[:2] for one in ours]) == pytest.approx(
        np.array([one[:2] for one in expected])
    )
    for level in lit:
        darks = theirs["temporal" if len(level.flats) == 2 else "spatial"][level.time_ms * 1e6][0.0]
        assert [frame.path.name for frame in level.darks] == [re.split("/", n)[-1] for n in darks]
        assert {frame.bits for frame in (*level.flats, *level.darks)} == {10}
    top = lit[-1].flats[0]
    assert (top.codes() == np.asarray(Image.open(top.path))).all()


def test_darks_of_the_exposure_time_belong_to_a_level_and_others_stand_alone(tmp_path):
    put(tmp_path, 12)
    described(
        tmp_path,
        *("# by hand", "b 1000000,0 350.25", *files(0, 1)),
        *("b 2000000 700", *files(2, 3)),
        *("d 1000000", *files(4, 5), "d 8000000", *files(6, 7, 8)),
        *("b 1000000 350.25", *files(9, 10, 11)),  # spatial: more than two frames
    )
    values = [
        (level.time_ms, level.photons_per_pixel, len(level.flats), len(level.darks))
        for level in read_frame_set([tmp_path]).levels
    ]
    assert values == [(1, 350.25, 2, 2), (2, 700, 2, 0), (1, 350.25, 3, 2), (8, None, 0, 3)]


def test_names_have_backslashes_or_slashes(tmp_path):
    (tmp_path / "sub").mkdir()
    put(tmp_path / "sub", 2)
    path = described(tmp_path, "b 5 10", "i sub\\image 0.png", "i sub/image 1.png")
    assert [frame.codes()[0, 0] for frame in read_frame_set([path]).levels[0].flats] == [100, 101]


WRONG = {
    "one frame": (["b 5 10", *files(0)], {"where": "line 3", "value": 1}),
    "no photons": (["b 5", *files(0, 1)], {"where": "line 3", "value": "b 5"}),
    "no number": (["b x 10", *files(0, 1)], {"where": "line 3", "value": "x"}),
    "not finite": (["b inf 10", *files(0, 1)], {"where": "line 3", "value": "inf"}),
    "an unknown line": (["q 5 10", *files(0, 1)], {"where": "line 3"}),
    "frames before a series": ([*files(0, 1), "b 5 10", *files(0, 1)], {"where": "line 3"}),
    "a series twice": (["d 5", *files(0, 1), "d 5", *files(2, 3)], {"where": "line 6"}),
    "a second size": (["n 10 8 6", "d 5", *files(0, 1)], {"where": "line 3"}),
    "no series": ([], {"value": 0}),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_damaged_descriptor_is_refused_with_its_line(tmp_path, name):
    lines, fields = WRONG[name]
    put(tmp_path, 4)
    path = described(tmp_path, *lines)
    with refused_input(subject=str(path), **fields):
        read_frame_set([tmp_path])


def test_frames_of_another_size_or_that_are_missing_are_refused(tmp_path):
    put(tmp_path, 2)
    Image.fromarray(np.zeros((SIDE, SIDE), np.uint16)).save(tmp_path / "image 1.png")
    path = described(tmp_path, "d 5", *files(0, 1))
    with refused_input(subject=str(path), value=(SIDE, SIDE), where="line 3"):
        read_frame_set([path])
    with refused_input(subject=str(tmp_path / "image 7.png")):
        read_frame_set([described(tmp_path, "d 5", *files(0, 7))])


def test_two_descriptors_in_a_folder_are_a_question(tmp_path):
    put(tmp_path, 2)
    path = described(tmp_path, "d 5", *files(0, 1))
    (tmp_path / "again.txt").write_bytes(path.read_bytes())
    with refused_input(value=2, requirement="one EMVA 1288 descriptor"):
        read_frame_set([tmp_path])
