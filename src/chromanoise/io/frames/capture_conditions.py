"""``capture.toml``: which frames are flats and darks, without guessing."""

import os
import re
import tomllib
from collections.abc import Callable, Mapping
from itertools import islice
from pathlib import Path, PurePath
from typing import Any

from chromanoise.base import InputError, check, did_you_mean, printable
from chromanoise.io.frames.frame import (
    EXAMPLE,
    MOST_LEVELS,
    FrameLevel,
    FrameSet,
    RawFrame,
    mosaic_of_all,
    mosaic_text,
    refuse_few,
    refuse_mixed,
)
from chromanoise.io.frames.frame_formats import frames_in
from chromanoise.io.pixels.pixel_toml import errors_in_file
from chromanoise.io.source_files import errors_within, refused, small_text
from chromanoise.sensor import Mosaic, mosaic_named

CAPTURE = "capture.toml"
"""Name of the file in a folder of frames."""
_TOP = ("camera", "iso", "mosaic", "bits", "black_level_dn", "darks", "levels")
_LEVEL = ("name", "flats", "darks", "time_ms", "photons_per_pixel", "iso")
_LARGEST_BYTES = 2**20
_MOST_BITS = 32
_MOST_FILES, _MOST_WILD = 100_000, 4
_LONGEST_MS = 1e9
_MOST_PHOTONS = 1e15
_LONGEST_NAME = 1000
_LONGEST_CAMERA = 200
_LONGEST_NAME_OF_LEVEL = 200
_LEAST_ISO, _MOST_ISO = 1e-3, 1e9
_MOST_BLACK_DN = 1e9
_PART = re.compile(r"(.+?)((?:\[[^\[\]]{1,100}\]){1,2})")

_FramesOfFile = dict[Path, tuple[RawFrame, ...]]


def read_capture(path: Path) -> FrameSet:
    """The frames that a ``capture.toml`` lists.

    Parameters
    ----------
    path
        The file. Keys: ``mosaic`` (``RG/GB``; absent for the mosaic stated in the files), ``bits``,
        ``camera`` (maker and model), ``iso``, ``black_level_dn`` (code without light; 0 if the
        camera subtracts it), ``darks`` (used at every level without darks of its own) and
        ``[[levels]]`` with ``flats``, ``darks``, ``time_ms`` [ms], ``photons_per_pixel`` [1],
        ``iso`` and ``name``. Frames are names relative to the file; ``*``, ``?`` and ``[abc]`` are
        patterns, sorted by name. ``stack.tif[3]`` is one frame of a stack, ``a.npz[flat]`` one
        array.

    Raises
    ------
    InputError
        If a key is unknown, a value or a frame is missing or invalid, a frame is listed twice, a
        level has one flat, or a frame states another camera or ISO.
    """
    table = _table(path)
    opened: _FramesOfFile = {}
    pooled = _frames(path, table.get("darks", []), "darks", opened)
    iso = _iso(path, table, "")
    levels = [
        _level(path, i, entry, pooled, iso, opened)
        for i, entry in enumerate(_levels(path, table), 1)
    ]
    if not levels and pooled:
        darks = FrameLevel(name="darks", flats=(), darks=pooled, time_ms=_one_time(pooled))
        levels = [_with(path, darks, {"iso": iso})]
    if not levels:
        raise refused(path, "must have at least one [[levels]]", found="has none", remedy=EXAMPLE)
    _refuse_repeated(path, levels)
    with errors_in_file(path):
        check.distinct("names of levels", [level.name for level in levels])
    refuse_few(str(path), levels)
    camera = (_value(path, table, "camera") or "").strip()
    stated = {"bits": _value(path, table, "bits"), "camera": camera}
    levels = [_with(path, level, stated) for level in levels]
    levels, black_remarks = _with_black(path, table, levels)
    used = [frame for level in levels for frame in level.frames]
    refuse_mixed(str(path), used)
    mosaic, remarks = _mosaic(path, table, used)
    flats = sum(len(level.flats) for level in levels)
    lit = sum(bool(level.flats) for level in levels)
    count = len({frame.name for level in levels for frame in level.darks})
    note = f"{lit} levels with {flats} flats, and {count} darks, by {path.name}"
    return FrameSet(
        source=str(path),
        levels=tuple(levels),
        mosaic=mosaic,
        notes=(note, *remarks, *black_remarks),
    )


def _table(path: Path) -> dict[str, Any]:
    text = small_text(path, _LARGEST_BYTES, f"must be at most {_LARGEST_BYTES} bytes")
    try:
        table = tomllib.loads(text)
    except (RecursionError, ValueError, TypeError) as error:
        cause = check.reason(error)
        raise refused(path, f"is not TOML{f' ({cause})' if cause else ''}") from None
    _refuse_unknown(path, table, _TOP, "")
    return table


def _refuse_unknown(path: Path, table: Mapping[str, Any], known: tuple[str, ...], at: str) -> None:
    for key in table:
        if key not in known:
            found = f"{printable(key)!r} is not one"
            remedy = did_you_mean(key, known, f"known: {', '.join(known)}")
            raise refused(path, "has an unknown key", key, found, where=at, remedy=remedy)


def _levels(path: Path, table: Mapping[str, Any]) -> list[dict[str, Any]]:
    levels = table.get("levels", [])
    if not isinstance(levels, list) or not all(isinstance(one, dict) for one in levels):
        raise refused(path, "must have levels as tables", where="levels", remedy="write [[levels]]")
    if len(levels) > MOST_LEVELS:
        raise refused(path, f"must have at most {MOST_LEVELS} levels", len(levels))
    return levels


def _level(
    path: Path,
    number: int,
    entry: dict[str, Any],
    pooled: tuple[RawFrame, ...],
    iso: float | None,
    opened: _FramesOfFile,
) -> FrameLevel:
    at = f"level {number}"
    _refuse_unknown(path, entry, _LEVEL, at)
    name = _value(path, entry, "name", at) or at
    flats = _frames(path, entry.get("flats", []), f"{at}, flats", opened)
    own = _frames(path, entry.get("darks", []), f"{at}, darks", opened)
    if not flats and not own:
        raise refused(path, "must have flats or darks", where=at, remedy=EXAMPLE)
    time_ms = _value(path, entry, "time_ms", at)
    photons = _value(path, entry, "photons_per_pixel", at)
    if photons and not flats:
        raise refused(
            path, "must be 0 or absent without flats", photons, where=f"{at}, photons_per_pixel"
        )
    level = FrameLevel(
        name=name,
        flats=flats,
        darks=own or (pooled if flats else ()),
        time_ms=_one_time(flats or own) if time_ms is None else time_ms,
        photons_per_pixel=photons,
    )
    return _with(path, level, {"iso": _iso(path, entry, f"{at}, ") or iso})


def _within(most: float) -> Callable[[Any], bool]:
    return lambda value: type(value) in (int, float) and 0 <= value <= most


def _printable(most: int) -> Callable[[Any], bool]:
    return lambda value: (
        isinstance(value, str)
        and 0 < len(value) <= most
        and value.isprintable()
        and bool(value.strip())
    )


_VALUES: dict[str, tuple[Callable[[Any], bool], str]] = {
    "name": (_printable(_LONGEST_NAME_OF_LEVEL), "must be a name of 1 to 200 characters"),
    "camera": (
        _printable(_LONGEST_CAMERA),
        f"must be maker and model, a text of 1 to {_LONGEST_CAMERA} characters",
    ),
    "bits": (
        lambda bits: type(bits) is int and 1 <= bits <= _MOST_BITS,
        f"must be a whole number from 1 to {_MOST_BITS}",
    ),
    "time_ms": (_within(_LONGEST_MS), f"must be a number from 0 to {_LONGEST_MS:g} [ms]"),
    "photons_per_pixel": (
        _within(_MOST_PHOTONS),
        f"must be a number from 0 to {_MOST_PHOTONS:g} [1]",
    ),
    "black_level_dn": (
        _within(_MOST_BLACK_DN),
        f"must be a number from 0 to {_MOST_BLACK_DN:g} [DN]",
    ),
    "mosaic": (_printable(2000), "must be a text such as RG/GB"),
}
"""Whether the value of a key is valid, and the requirement."""


def _value(path: Path, entry: Mapping[str, Any], key: str, at: str = "") -> Any:
    """The value of a key, numbers as floats; None if it is absent."""
    value = entry.get(key)
    valid, need = _VALUES[key]
    if value is not None and not valid(value):
        raise refused(path, need, value, where=f"{at}, {key}" if at else key)
    return float(value) if type(value) is int and key != "bits" else value


def _frames(path: Path, words: Any, where: str, opened: _FramesOfFile) -> tuple[RawFrame, ...]:
    """The frames of a list of names and patterns, in its order."""
    if not isinstance(words, list) or not all(isinstance(word, str) and word for word in words):
        need = 'must be a list of file names, e.g. ["flat_01_a.tif", "flat_01_b.tif"]'
        raise refused(path, need, where=where)
    frames = [frame for word in words for frame in _of_word(path, word, where, opened)]
    seen = set()
    for frame in frames:
        if frame.place in seen:
            need = "must list each frame once"
            raise refused(path, need, frame.name, f"{frame.name} is repeated", where=where)
        seen.add(frame.place)
    return tuple(frames)


def _of_word(path: Path, word: str, where: str, opened: _FramesOfFile) -> tuple[RawFrame, ...]:
    folder = path.parent
    long = any(len(os.fsencode(name)) > 255 for name in word.split("/"))
    if Path(word).is_absolute() or "\0" in word or long or len(word) > _LONGEST_NAME:
        raise refused(path, "must name frames relative to the file", word, where=where)
    if (folder / word).is_file():
        return _opened(folder / word, opened)
    part = _PART.fullmatch(word)
    if part is not None and (folder / part[1]).is_file():
        return _parts_of(path, word, _opened(folder / part[1], opened), part[2], where)
    steps = PurePath(word).parts
    wild = [i for i, step in enumerate(steps) if any(sign in step for sign in "*?[")]
    if len(wild) > _MOST_WILD or steps.count("**") > 1 or (wild and ".." in steps[wild[0] :]):
        # the walk could visit a folder without bound
        need = (
            f"must have at most {_MOST_WILD} folders with wildcards, at most one '**', and no '..' "
            "after a wildcard"
        )
        raise refused(path, need, word, where=where, remedy="write the names of the folders")
    try:
        matches = (file for file in folder.glob(word) if not file.is_dir())
        files = sorted(islice(matches, _MOST_FILES + 1))
    except (ValueError, NotImplementedError, IndexError, OSError):
        files = []
    if not files or len(files) > _MOST_FILES:
        found = f"no file is called {printable(word)!r}" if not files else "too many match"
        raise refused(path, "must name files that exist", word, found, where=where)
    return tuple(frame for file in files for frame in _opened(file, opened))


def _opened(file: Path, opened: _FramesOfFile) -> tuple[RawFrame, ...]:
    if file not in opened:
        opened[file] = frames_in(file)
    return opened[file]


def _parts_of(
    path: Path, word: str, frames: tuple[RawFrame, ...], part: str, where: str
) -> tuple[RawFrame, ...]:
    """The frames called by name: ``[3]``, ``[flat]`` or ``[flat][3]``."""
    chosen = tuple(
        frame
        for frame in frames
        if frame.name == frame.path.name + part or (frame.part and part == f"[{frame.part}]")
    )
    if not chosen:
        raise refused(
            path, f"must name a frame from {frames[0].name} to {frames[-1].name}", word, where=where
        )
    return chosen


def _refuse_repeated(path: Path, levels: list[FrameLevel]) -> None:
    """Refuse a flat of two levels, or a frame that is both flat and dark."""
    seen: dict[tuple[Path, str, int | None], str] = {}
    for level in levels:
        for frame in level.flats:
            if frame.place in seen:
                raise _repeated(path, frame, level.name, f"also at {seen[frame.place]!r}")
            seen[frame.place] = level.name
    for level in levels:
        for frame in level.darks:
            if frame.place in seen:
                raise _repeated(path, frame, level.name, "both flat and dark")


def _repeated(path: Path, frame: RawFrame, level: str, found: str) -> InputError:
    need = "must use a flat once"
    return refused(path, need, frame.name, f"{frame.name} is {found}", where=f"level {level!r}")


def _one_time(frames: tuple[RawFrame, ...]) -> float | None:
    """The exposure time that all frames state. [ms]"""
    times = {frame.time_ms for frame in frames}
    return times.pop() if len(times) == 1 else None


def _iso(path: Path, table: Mapping[str, Any], at: str) -> float | None:
    iso = table.get("iso")
    if iso is None:
        return None
    with errors_in_file(path):
        if isinstance(iso, bool) or not isinstance(iso, int | float):
            raise refused(f"{at}iso", "must be a number", iso)
        return check.within(f"{at}iso", "1", iso, _LEAST_ISO, _MOST_ISO)


def _with(path: Path, level: FrameLevel, stated: Mapping[str, Any]) -> FrameLevel:
    """The level with what the list states of its frames, which must not state anything else."""
    known = {name: value for name, value in stated.items() if value}
    for frame in level.frames:
        for name, value in known.items():
            own = getattr(frame, name)
            if own and name != "bits" and not _same(own, value):
                need = f"must be {own} as {frame.name} states"
                remedy = (f"correct {name}", f"omit {name}")
                raise refused(path, need, value, where=name, remedy=remedy)
    return level.stating(**known)


def _with_black(
    path: Path, table: Mapping[str, Any], levels: list[FrameLevel]
) -> tuple[list[FrameLevel], tuple[str, ...]]:
    """The levels with the black level of the list, and a note if a file states another one."""
    black = _value(path, table, "black_level_dn")
    if black is None:
        return levels, ()
    frames = [frame for level in levels for frame in level.frames]
    other = next((one for one in frames if one.black_level_dn not in (None, black)), None)
    found = [level.stating(black_level_dn=black) for level in levels]
    if other is None:
        return found, ()
    note = f"the black level of {black:g} DN in {path.name} is used, although {other.name} states "
    return found, (f"{note}{other.black_level_dn:g} DN",)


def _same(one: Any, other: Any) -> bool:
    """Whether two values are equal, or all words of a name occur in the other one."""
    if not isinstance(one, str):
        return bool(one == other)
    words, others = (set(text.casefold().split()) for text in (one, other))
    return words <= others or others <= words


def _mosaic(
    path: Path, table: Mapping[str, Any], frames: list[RawFrame]
) -> tuple[Mosaic | None, tuple[str, ...]]:
    word = _value(path, table, "mosaic")
    if word is None:
        return mosaic_of_all(str(path), frames), ()
    if word == "none":
        return None, ()
    with errors_within(path, "mosaic"):
        mosaic = mosaic_named(word)
    other = next((one for one in frames if one.mosaic not in (None, mosaic)), None)
    if other is None:
        return mosaic, ()
    note = f"mosaic {mosaic_text(mosaic)} of {path.name}; {other.name} states "
    return mosaic, (note + mosaic_text(other.mosaic),)
