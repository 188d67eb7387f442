"""Frames of a folder form the levels that names, times or capture.toml tell, or are refused."""

import numpy as np
import pytest

from chromanoise.io.frames import read_frame_set
from chromanoise.sensor import Mosaic, bayer
from frame_files import drawn, write_fits, write_raw
from outcomes import refused_input

pytest.importorskip("astropy", reason="FITS needs chromanoise[fits]")

CODES = drawn(4, 6)
UNCLEAR = "which frames form a level"


def put(folder, *names, **keys):
    """Frames of these names, made by their ending; ``keys`` are of a FITS header."""
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".npy":
            np.save(path, CODES)
        elif path.suffix == ".fits":
            write_fits(path, CODES, **keys)
        else:
            path.write_text("remarks")


def pairs(*levels, kinds=("flat", "dark")):
    return [f"{k}_{i}_{r}.npy" for k in kinds for i in levels for r in "12"]


def grouped(frames):
    """Names of flats and darks, and the time, by the name of the level."""
    return {
        level.name: (
            [frame.path.stem for frame in level.flats],
            [frame.path.stem for frame in level.darks],
            level.time_ms,
        )
        for level in frames.levels
    }


# names


def test_a_level_has_names_that_differ_in_the_last_number_and_darks_of_its_number(tmp_path):
    put(tmp_path, *pairs("09", "10", "11"))
    frames = read_frame_set([tmp_path])
    assert grouped(frames) == {
        f"flat_{i}": ([f"flat_{i}_1", f"flat_{i}_2"], [f"dark_{i}_1", f"dark_{i}_2"], None)
        for i in ("09", "10", "11")
    }
    assert list(grouped(frames)) == ["flat_09", "flat_10", "flat_11"]
    assert frames.notes[:2] == (
        "3 levels of 2 flats by name",
        "6 darks matched by name to 3 levels",
    )


def test_letters_count_repeats_and_darks_of_one_name_are_used_at_all_levels(tmp_path):
    put(tmp_path, *(f"L{i:02d}_{r}.npy" for i in range(3) for r in "abc"), "Bias1.npy", "Bias2.npy")
    assert grouped(read_frame_set([tmp_path])) == {
        f"L0{i}": ([f"L0{i}_a", f"L0{i}_b", f"L0{i}_c"], ["Bias1", "Bias2"], None) for i in range(3)
    }


def test_a_time_in_the_name_is_the_exposure_time(tmp_path):
    times = {"500us": 0.5, "2ms": 2.0, "0.1s": 100.0}
    put(tmp_path, *(f"{t}_{k}_{r}.npy" for t in times for k in ("flat", "dark") for r in "12"))
    assert grouped(read_frame_set([tmp_path])) == {
        f"{ms:g} ms": ([f"{t}_flat_1", f"{t}_flat_2"], [f"{t}_dark_1", f"{t}_dark_2"], ms)
        for t, ms in times.items()
    }


def test_a_folder_per_level_has_its_flats_and_darks(tmp_path):
    put(
        tmp_path,
        *(f"{f}/{k}{r}.npy" for f in ("10lx", "2lx") for k in ("flat", "dark") for r in "12"),
    )
    frames = read_frame_set([tmp_path])
    assert [level.name for level in frames.levels] == ["2lx/flat", "10lx/flat"]
    for level in frames.levels:
        folders = {frame.path.parent.name for frame in (*level.flats, *level.darks)}
        assert folders == {level.name.split("/")[0]}


def test_a_folder_of_darks_holds_darks(tmp_path):
    put(tmp_path, *(f"Darks/IMG_{i}.npy" for i in range(4)))
    put(tmp_path, *(f"level{i}/IMG_{i}{r}.npy" for i in range(3) for r in range(2)))
    frames = read_frame_set([tmp_path])
    assert [len(level.flats) for level in frames.levels] == [2, 2, 2]
    assert all(len(level.darks) == 4 for level in frames.levels)


def test_words_that_only_begin_like_a_word_for_dark_are_of_flats(tmp_path):
    put(tmp_path, *(f"capture_black-box-{i}_{r}.npy" for i in (3, 4, 5) for r in "12"))
    # "black" is a word of this name; capture is not "cap"
    assert all(level.darks and not level.flats for level in read_frame_set([tmp_path]).levels)
    other = tmp_path / "other"
    put(other, *(f"capture_blackmagic_{i}_{r}.npy" for i in (3, 4, 5) for r in "12"))
    assert all(level.flats and not level.darks for level in read_frame_set([other]).levels)


def test_each_stack_is_a_level(tmp_path):
    for i in range(3):
        np.save(tmp_path / f"flat_{i}.npy", np.stack([CODES] * 4))
    np.save(tmp_path / "dark.npy", np.stack([CODES] * 5))
    frames = read_frame_set([tmp_path])
    assert [(level.name, len(level.flats), len(level.darks)) for level in frames.levels] == [
        (f"flat_{i}", 4, 5) for i in range(3)
    ]


def test_arrays_of_an_npz_are_named_like_files(tmp_path):
    names = [f"{k}_{i}_{r}" for k in ("flat", "dark") for i in (3, 4, 5) for r in "ab"]
    np.savez(tmp_path / "all.npz", **dict.fromkeys(names, CODES))
    frames = read_frame_set([tmp_path / "all.npz"])
    assert [[frame.part for frame in level.darks] for level in frames.levels] == [
        [f"dark_{i}_a", f"dark_{i}_b"] for i in (3, 4, 5)
    ]


# times in headers


def test_exposure_times_in_headers_group_a_running_number_and_match_the_darks(tmp_path):
    for i, time_s in enumerate((0.01, 0.01, 0.02, 0.02, 0.02, 0.04, 0.04)):
        put(tmp_path, f"IMG_{i:04d}.fits", EXPTIME=time_s)
    for i, time_s in enumerate((0.02, 0.02, 0.5, 0.5, 0.5)):
        put(tmp_path, f"dark_{i:04d}.fits", EXPTIME=time_s)
    frames = read_frame_set([tmp_path])
    assert grouped(frames) == {
        "10 ms": (["IMG_0000", "IMG_0001"], [], 10.0),
        "20 ms": (["IMG_0002", "IMG_0003", "IMG_0004"], ["dark_0000", "dark_0001"], 20.0),
        "40 ms": (["IMG_0005", "IMG_0006"], [], 40.0),
        "darks 500 ms": ([], ["dark_0002", "dark_0003", "dark_0004"], 500.0),
    }
    assert frames.notes[:4] == (
        "3 levels of 2 to 3 flats by exposure time",
        "2 darks matched by exposure time to 1 level",
        "2 of 3 levels have no darks of their exposure time",
        "1 level of 3 darks of other exposure times than the flats",
    )


def test_equal_times_with_names_of_levels_are_levels_of_different_light(tmp_path):
    for k in ("flat", "dark"):
        put(tmp_path, *(f"{k}_{i}_{r}.fits" for i in range(3) for r in "ab"), EXPTIME=0.01)
    frames = read_frame_set([tmp_path])
    assert grouped(frames) == {
        f"flat_{i}": ([f"flat_{i}_a", f"flat_{i}_b"], [f"dark_{i}_a", f"dark_{i}_b"], 10.0)
        for i in range(3)
    }


def test_darks_alone_are_levels_without_flats(tmp_path):
    for time_s in (0.1, 0.2, 0.4):
        put(tmp_path, *(f"dark_{time_s}s_{i}.fits" for i in range(2)), EXPTIME=time_s)
    frames = read_frame_set([tmp_path])
    assert [(level.flats, len(level.darks), level.time_ms) for level in frames.levels] == [
        ((), 2, ms) for ms in (100.0, 200.0, 400.0)
    ]


def test_other_files_are_left_out_with_a_note(tmp_path):
    put(tmp_path, "flat_1.npy", "flat_2.npy", "notes.txt", "x/light.csv", ".hidden.npy")
    frames = read_frame_set([tmp_path])
    assert grouped(frames) == {"flat": (["flat_1", "flat_2"], [], None)}
    assert any("3 other files left out" in note for note in frames.notes)
    assert any("no darks" in note for note in frames.notes)


def test_files_in_any_order_give_the_same_levels(tmp_path):
    put(tmp_path, *pairs("3", "4"))
    files = sorted(tmp_path.glob("*.npy"))
    whole = grouped(read_frame_set([tmp_path]))
    listed = read_frame_set(files)
    assert [(a, b) for a, b, _ in grouped(listed).values()] == [
        (a, b) for a, b, _ in whole.values()
    ]


# questions


UNCLEAR_NAMES = {
    "a running number without times": [f"flat_{i}.npy" for i in range(8)],
    "two numbers, of repeat and level": [f"f_{r}_{i}.npy" for r in (1, 2) for i in range(9)],
    "a folder for each run": [f"run{r}/f{i}.npy" for r in (1, 2) for i in range(9)],
    "a flat that is dark": ["dark_flat_1.npy", "dark_flat_2.npy"],
    "a flat in a folder of darks": ["darks/flat_1.npy", "darks/flat_2.npy"],
    "a time that may be a fraction": ["f_1-100s_1.npy", "f_1-100s_2.npy"],
    "two times": ["f_1ms_2ms_1.npy", "f_1ms_2ms_2.npy"],
    "darks that match no level": [
        *(f"f_{i}_{r}.npy" for i in (3, 5) for r in "ab"),
        *(f"dark_{i}_{r}.npy" for i in (3, 4, 6) for r in "ab"),
    ],
    "darks without times": [
        *(f"f_{t}ms_{r}.npy" for t in (1, 2) for r in "ab"), "dark_1.npy", "dark_2.npy",
    ],
    "darks with times and flats without": [
        *(f"f_{i}_{r}.npy" for i in (3, 5) for r in "ab"), "dark_1ms_1.npy", "dark_1ms_2.npy",
    ],
    "some flats without time": ["f_1ms_1.npy", "f_1ms_2.npy", "f_2.npy", "f_3.npy"],
    "one flat for each time and repeat": [f"run{r}/{t}ms.npy" for r in (1, 2) for t in (1, 2)],
}  # fmt: skip


@pytest.mark.parametrize("name", UNCLEAR_NAMES)
def test_names_with_two_readings_are_a_question_that_names_capture_toml(tmp_path, name):
    put(tmp_path, *UNCLEAR_NAMES[name])
    with refused_input(requirement=UNCLEAR) as caught:
        read_frame_set([tmp_path])
    assert "capture.toml" in str(caught.value)
    assert "[[levels]]" in str(caught.value)


def test_a_level_with_one_flat_is_refused_by_name(tmp_path):
    put(tmp_path, *(f"flat_{i}_{r}.npy" for i in (3, 4) for r in "ab"), "flat_5_a.npy")
    with refused_input(where="level 'flat_5'", value=1):
        read_frame_set([tmp_path])


MIXED = {
    "ISO": ({"ISOSPEED": 100}, {"ISOSPEED": 200}),
    "gain": ({"GAIN": 1}, {"GAIN": 2}),
    "camera": ({"INSTRUME": "A"}, {"INSTRUME": "B"}),
    "mosaic": ({"BAYERPAT": "RGGB"}, {}),
}


@pytest.mark.parametrize("name", MIXED)
@pytest.mark.parametrize("listed", [False, True])
def test_mixed_frames_are_refused_with_two_of_their_names(tmp_path, name, listed):
    first, other = MIXED[name]
    put(tmp_path, "flat_1.fits", "flat_2.fits", **first)
    put(tmp_path, "flat_3.fits", **other)
    if listed:
        (tmp_path / "capture.toml").write_text('[[levels]]\nflats = ["flat*.fits"]\n')
    with refused_input(requirement=f"must have one {name}") as caught:
        read_frame_set([tmp_path])
    assert "flat_1.fits" in caught.value.found
    assert "flat_3.fits" in caught.value.found


def test_mixed_sizes_and_iso_in_names_are_refused(tmp_path):
    put(tmp_path, "a_iso100_1.npy", "a_iso100_2.npy", "a_iso200_1.npy", "a_iso200_2.npy")
    with refused_input(requirement="must have one ISO", value=(100.0, 200.0)):
        read_frame_set([tmp_path])
    other = tmp_path / "other"
    put(other, "flat_1.npy")
    np.save(other / "flat_2.npy", CODES[:2])
    with refused_input(requirement="must have one size", value=((4, 6), (2, 6))):
        read_frame_set([other])


# capture.toml


def test_capture_toml_is_followed_to_the_letter(tmp_path):
    put(tmp_path, *(f"shot{i}.npy" for i in range(9)), "off/a.npy", "off/b.npy")
    np.save(tmp_path / "stack.npy", np.stack([CODES, CODES + 1, CODES + 2]))
    (tmp_path / "capture.toml").write_text(
        'mosaic = "RG/GB"\nbits = 12\ndarks = ["off/*.npy"]\n'
        '[[levels]]\nflats = ["shot[0-2].npy"]\ntime_ms = 5\nphotons_per_pixel = 310.5\n'
        '[[levels]]\nname = "own"\nflats = ["shot3.npy", "stack.npy[2]"]\ndarks = ["shot4.npy"]\n'
        '[[levels]]\ndarks = ["shot5.npy", "shot6.npy"]\ntime_ms = 100.5\n'
    )
    for word in (tmp_path, tmp_path / "capture.toml"):
        frames = read_frame_set([word])
        assert grouped(frames) == {
            "level 1": (["shot0", "shot1", "shot2"], ["a", "b"], 5.0),
            "own": (["shot3", "stack"], ["shot4"], None),
            "level 3": ([], ["shot5", "shot6"], 100.5),
        }
        assert frames.mosaic == bayer()
        assert [level.photons_per_pixel for level in frames.levels] == [310.5, None, None]
        assert {frame.bits for level in frames.levels for frame in level.flats} == {12}
        assert (frames.levels[1].flats[1].codes() == CODES + 2).all()


def test_capture_toml_takes_times_and_mosaic_from_the_files_if_it_tells_none(tmp_path):
    put(tmp_path, "a.fits", "b.fits", EXPTIME=0.25, BAYERPAT="GRBG")
    (tmp_path / "capture.toml").write_text('[[levels]]\nflats = ["?.fits"]\n')
    frames = read_frame_set([tmp_path])
    assert frames.levels[0].time_ms == 250.0
    assert frames.mosaic == Mosaic((("G", "R"), ("B", "G")))


def test_the_mosaic_of_capture_toml_is_used_with_a_note_where_a_file_tells_another(tmp_path):
    put(tmp_path, "a.fits", "b.fits", BAYERPAT="GRBG")
    (tmp_path / "capture.toml").write_text('mosaic = "RG/GB"\n[[levels]]\nflats = ["?.fits"]\n')
    frames = read_frame_set([tmp_path])
    assert frames.mosaic == bayer()
    assert any("GR/BG" in note for note in frames.notes)


def test_camera_and_iso_of_capture_toml_are_those_of_every_frame(tmp_path):
    put(tmp_path, *(f"{name}.npy" for name in "abcdef"))
    (tmp_path / "capture.toml").write_text(
        'camera = "Acme One"\niso = 100\ndarks = ["e.npy", "f.npy"]\n'
        '[[levels]]\nflats = ["a.npy", "b.npy"]\n'
        '[[levels]]\nflats = ["c.npy", "d.npy"]\niso = 100.0\n'
    )
    frames = read_frame_set([tmp_path])
    every = [frame for one in frames.levels for frame in (*one.flats, *one.darks)]
    assert {(frame.camera, frame.iso) for frame in every} == {("Acme One", 100.0)}


@pytest.mark.parametrize(
    ("stated", "refused"),
    [
        ('camera = "One"', None),  # a shorter name of the same camera
        ('camera = "ACME one mark II"', None),
        ('camera = "Acme Two"', {"where": "camera", "value": "Acme Two"}),
        ("iso = 200", None),
        ("iso = 100", {"where": "iso", "value": 100.0}),
    ],
)
def test_camera_and_iso_that_contradict_the_files_are_refused(tmp_path, stated, refused):
    put(tmp_path, "a.fits", "b.fits", INSTRUME="Acme One", ISOSPEED=200)
    (tmp_path / "capture.toml").write_text(f'{stated}\n[[levels]]\nflats = ["?.fits"]\n')
    if refused is None:
        assert read_frame_set([tmp_path]).levels[0].flats[0].iso == 200
    else:
        with refused_input(subject=str(tmp_path / "capture.toml"), **refused):
            read_frame_set([tmp_path])


LEVEL = '[[levels]]\nflats = ["a.npy", "b.npy"]\n'
WRONG = {
    "an unknown key": ('mosiac = "RG/GB"\n' + LEVEL, {"value": "mosiac"}),
    "an unknown key of a level": (LEVEL + "time = 5\n", {"value": "time", "where": "level 1"}),
    "no level": ("bits = 12\n", {"requirement": "at least one"}),
    "one flat": ('[[levels]]\nflats = ["a.npy"]\n', {"value": 1, "where": "level 'level 1'"}),
    "neither flats nor darks": ("[[levels]]\ntime_ms = 1\n", {"where": "level 1"}),
    "no such file": ('[[levels]]\nflats = ["x*.npy"]\n', {"value": "x*.npy"}),
    "a text for a list": ('[[levels]]\nflats = "a.npy"\n', {"where": "level 1, flats"}),
    "numbers for names": ("[[levels]]\nflats = [1, 2]\n", {"where": "level 1, flats"}),
    "a frame twice": ('[[levels]]\nflats = ["a.npy", "?.npy"]\n', {"value": "a.npy"}),
    "a flat of two levels": (LEVEL + LEVEL, {"value": "a.npy", "where": "level 'level 2'"}),
    "flat and dark": (LEVEL + 'darks = ["a.npy"]\n', {"value": "a.npy"}),
    "a time below 0": (LEVEL + "time_ms = -1\n", {"value": -1}),
    "a time of NaN": (LEVEL + "time_ms = nan\n", {"where": "level 1, time_ms"}),
    "a time as text": (LEVEL + 'time_ms = "5"\n', {"value": "5"}),
    "a truth for a time": (LEVEL + "time_ms = true\n", {"value": True}),
    "photons of darks": ('[[levels]]\ndarks = ["a.npy"]\nphotons_per_pixel = 3\n', {"value": 3.0}),
    "bits of 0": ("bits = 0\n" + LEVEL, {"value": 0, "where": "bits"}),
    "an ISO of 0": ("iso = 0\n" + LEVEL, {"where": "iso", "value": 0}),
    "an ISO as text": (LEVEL + 'iso = "100"\n', {"where": "level 1, iso", "value": "100"}),
    "two ISO settings": (
        LEVEL + 'iso = 100\n[[levels]]\nflats = ["s.npy"]\niso = 200\n',
        {"value": (100.0, 200.0)},
    ),
    "a camera as number": ("camera = 5\n" + LEVEL, {"where": "camera", "value": 5}),
    "an empty camera": ('camera = " "\n' + LEVEL, {"where": "camera", "value": " "}),
    "a mosaic of unequal rows": ('mosaic = "RG/G"\n' + LEVEL, {"where": "mosaic"}),
    "a mosaic as list": ("mosaic = [1]\n" + LEVEL, {"where": "mosaic"}),
    "levels as a list of numbers": ("levels = [1]\n", {"where": "levels"}),
    "an absolute name": ('[[levels]]\nflats = ["/a.npy"]\n', {"value": "/a.npy"}),
    "a name that is too long": (f'darks = ["{"a" * 300}"]\n' + LEVEL, {"value": "a" * 300}),
    "a wrong pattern": ('[[levels]]\nflats = ["**a"]\n', {"value": "**a"}),
    "a frame beyond the stack": ('[[levels]]\nflats = ["s.npy[7]"]\n', {"value": "s.npy[7]"}),
    "a name of two levels": (
        LEVEL + 'name = "a"\n[[levels]]\nname = "a"\ndarks = ["s.npy"]\n',
        {"where": "names of levels", "value": "a"},
    ),
    "no TOML": ("[[levels\n", {"requirement": "is not TOML"}),
    "a number of 5000 digits": (LEVEL + f"time_ms = {'9' * 5000}\n", {"requirement": "."}),
    "no text": (b"\xff\xfe", {"requirement": "UTF-8"}),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_capture_toml_is_refused_with_its_place(tmp_path, name):
    text, fields = WRONG[name]
    put(tmp_path, "a.npy", "b.npy")
    np.save(tmp_path / "s.npy", np.stack([CODES] * 2))
    path = tmp_path / "capture.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with refused_input(subject=str(path), **fields):
        read_frame_set([tmp_path])


def test_an_unknown_key_suggests_the_known_one(tmp_path):
    put(tmp_path, "a.npy", "b.npy")
    (tmp_path / "capture.toml").write_text(LEVEL + "photons_per_pixle = 5\n")
    with refused_input(remedy=("did you mean photons_per_pixel?",)):
        read_frame_set([tmp_path])


# words


def test_frames_of_a_dng_have_their_mosaic(tmp_path):
    pytest.importorskip("rawpy", reason="DNG needs chromanoise[raw]")
    mosaic = Mosaic((("G", "R"), ("B", "G")))
    for name in ("flat_1.dng", "flat_2.dng"):
        write_raw(tmp_path / name, drawn(), mosaic)
    assert read_frame_set([tmp_path]).mosaic == mosaic


def test_what_is_no_folder_of_frames_is_refused(tmp_path):
    with refused_input(subject="frames"):
        read_frame_set([])
    with refused_input(requirement="must hold raw frames"):
        read_frame_set([tmp_path])
    with refused_input(subject=str(tmp_path / "none")):
        read_frame_set([tmp_path / "none"])
    put(tmp_path, "a.npy", "b.npy", "capture.toml", "notes.txt")
    with refused_input(subject=str(tmp_path / "capture.toml"), requirement="alone"):
        read_frame_set([tmp_path / "capture.toml", tmp_path / "a.npy"])
    put(tmp_path / "deep", "c.npy")
    (tmp_path / "capture.toml").rename(tmp_path / "deep" / "capture.toml")
    for words in ([tmp_path], [tmp_path / "a.npy", tmp_path / "deep"]):
        with refused_input(subject=str(tmp_path / "deep" / "capture.toml"), requirement="alone"):
            read_frame_set(words)
    with refused_input(subject=str(tmp_path / "notes.txt")):
        read_frame_set([tmp_path / "notes.txt"])
    with refused_input(requirement="given once"):
        read_frame_set([tmp_path / "a.npy", tmp_path / "a.npy"])
