"""Frames of a folder, of files or of a list, as levels of light with their darks.

Levels and darks are recognized by the names of the frames and the exposure times stated in their
files. A level has the frames whose names differ only in the last number or letter, and that have
the same exposure time. Where this leaves two interpretations, the frames are refused, and the
message states what is unclear.
"""

import os
import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from chromanoise.base import InputError, dataclass, regular_file, true_path
from chromanoise.io.frames.capture_conditions import CAPTURE, read_capture
from chromanoise.io.frames.descriptor import is_descriptor, read_descriptor
from chromanoise.io.frames.frame import (
    EXAMPLE,
    FrameLevel,
    FrameSet,
    RawFrame,
    mosaic_of_all,
    refuse_few,
    refuse_mixed,
)
from chromanoise.io.frames.frame_formats import frames_in, is_frame_name
from chromanoise.io.source_files import refused

DARK_WORDS = (
    *("dark", "darks", "darkframe", "darkframes", "bias", "biases", "biasframe", "biasframes"),
    *("black", "blacks", "blackframe", "blackframes", "cap", "capped", "lenscap"),
)
"""Words of a name that mark a frame without light."""
LIGHT_WORDS = ("flat", "flats", "flatfield", "flatfields", "bright", "brights", "light", "lights")
"""Words of a name that mark a frame with light."""
SAME_TIME = 0.001
"""Relative difference up to which two exposure times are equal."""

_MS_PER = {"us": 1e-3, "µs": 1e-3, "ms": 1.0, "s": 1e3}
_TIME = re.compile(r"(?<![\d.])(\d{1,7}(?:\.\d{1,9})?)(us|µs|ms|s)(?![A-Za-z0-9])", re.I)
_FRACTION = re.compile(r"(?<!\d)1[-_]\d{1,6}s(?![A-Za-z0-9])", re.I)
_ISO = re.compile(r"(?<![A-Za-z])iso[-_ ]?(\d{1,8})(?!\d)", re.I)
_REPEAT = re.compile(r"(?:[-_ .]?\d+|(?:(?<=\d)|[-_ .])[A-Za-z])$")
_LEVEL_WORD = re.compile(r"(?<![A-Za-z])(?:level|lvl|lv|l|step|stop|ev)[-_ ]?\d+", re.I)
_WORD = re.compile(r"[A-Za-zµ]+")


@dataclass(frozen=True, kw_only=True)
class _Named:
    """A frame and what its name states.

    Attributes
    ----------
    frame
        The frame; time and ISO are filled in from the name if the file does not state them.
    dark
        Whether it was taken without light.
    label
        Its name without the number of the repeat, the time and the ISO.
    number
        The number of the repeat, as text; empty in a stack.
    """

    frame: RawFrame
    dark: bool
    label: str
    number: str


_Group = tuple[str, float | None]
"""Label and exposure time [ms] of a level."""
_Key = TypeVar("_Key")
_Groups = dict[_Group, list[_Named]]


def levels_by_name(
    source: str, frames: Sequence[RawFrame], names: Sequence[str]
) -> tuple[tuple[FrameLevel, ...], tuple[str, ...]]:
    """Levels and notes.

    Parameters
    ----------
    source
        Folder of the frames, for messages.
    frames, names
        The frames, and the name of each: its path in the folder without the ending of the file.

    Raises
    ------
    InputError
        If the names and times allow more than one grouping, or none.

    Notes
    -----
    1. A frame is dark if the file name, else the nearest folder, has one of `DARK_WORDS`.
    2. The exposure time comes from the file, or else from the name (``10ms``, ``0.5s``).
    3. The label of a frame is its name without time, ISO and the last number or letter; frames of a
       stack have the label of their file. Equal labels and times form a level.
    4. Darks belong to the levels with the same exposure time; without times, to the flats with the
       same label, or, if there is only one label, to all levels.
    """
    named = [_named(source, frame, name) for frame, name in zip(frames, names, strict=True)]
    refuse_mixed(source, [one.frame for one in named])
    named = _with_equal_times(named)
    flats = [one for one in named if not one.dark]
    darks = [one for one in named if one.dark]
    groups = _groups(flats)
    how = _refuse_unclear_flats(source, flats, groups)
    dark_of, alone, note = _matched(source, groups, darks)
    titles = _titles(groups)
    levels = [
        FrameLevel(
            name=titles[key],
            flats=tuple(one.frame for one in group),
            darks=tuple(one.frame for one in dark_of.get(key, ())),
            time_ms=key[1],
        )
        for key, group in groups.items()
    ]
    levels += [
        FrameLevel(
            name=f"darks {time_ms:g} ms" if time_ms is not None else label or "darks",
            flats=(),
            darks=tuple(one.frame for one in group),
            time_ms=time_ms,
        )
        for (label, time_ms), group in alone.items()
    ]
    notes = [f"{_counts(groups, 'flats')} {how}"] if groups else []
    return tuple(levels), tuple(notes + note)


# what one name tells


def _named(source: str, frame: RawFrame, name: str) -> _Named:
    if frame.time_ms is None and _FRACTION.search(name):
        raise _question(source, f"the time in the name {name} may be a fraction of a second")
    time, iso = _TIME.findall(name), _ISO.findall(name)
    times = {float(number) * _MS_PER[unit.lower()] for number, unit in time}
    if frame.time_ms is None and len(times) > 1:
        raise _question(source, f"the name {name} has several exposure times")
    frame = replace(
        frame,
        time_ms=times.pop() if frame.time_ms is None and times else frame.time_ms,
        iso=float(iso[-1]) if frame.iso is None and iso else frame.iso,
    )
    folder, _, stem = name.rpartition("/")
    bare = _tidy(_ISO.sub("", _TIME.sub("", stem)))
    match = None if frame.index is not None else _REPEAT.search(bare)
    label = bare if match is None else bare[: match.start()]
    return _Named(
        frame=frame,
        dark=_is_dark(source, name),
        label=_tidy(f"{folder}/{label}" if folder else label),
        number="" if match is None else match[0],
    )


def _tidy(text: str) -> str:
    return re.sub(r"[-_ .]{2,}", "_", text).strip("-_ ./")


def _is_dark(source: str, name: str) -> bool:
    *folders, stem = name.split("/")
    dark, light = _dark_and_light(stem)
    if dark and light:
        raise _question(source, f"the name {name} has words of both flats and darks")
    for folder in reversed(folders):
        in_dark, in_light = _dark_and_light(folder)
        if light and in_dark and not in_light:
            raise _question(source, f"{name} is called a flat in a folder of darks")
        if not (dark or light) and in_dark != in_light:
            dark, light = in_dark, in_light
    return dark


def _dark_and_light(text: str) -> tuple[bool, bool]:
    words = {word.lower() for word in _WORD.findall(text)}
    return bool(words & set(DARK_WORDS)), bool(words & set(LIGHT_WORDS))


def _with_equal_times(named: list[_Named]) -> list[_Named]:
    """Times that differ by less than `SAME_TIME` replaced by the smallest of them."""
    times = sorted({one.frame.time_ms for one in named if one.frame.time_ms is not None})
    first: dict[float, float] = {}
    for time in times:
        last = next(reversed(first.values()), None)
        first[time] = last if last is not None and time - last <= SAME_TIME * last else time
    return [
        one
        if one.frame.time_ms is None
        else replace(one, frame=replace(one.frame, time_ms=first[one.frame.time_ms]))
        for one in named
    ]


# flats


def _groups(named: Iterable[_Named]) -> _Groups:
    """Frames by label and time, shortest time first, then by the numbers in the label."""
    groups = _grouped(named, lambda one: (one.label, one.frame.time_ms))
    return dict(sorted(groups.items(), key=lambda item: (_or_0(item[0][1]), natural(item[0][0]))))


def _grouped(named: Iterable[_Named], key: Callable[[_Named], _Key]) -> dict[_Key, list[_Named]]:
    groups: dict[_Key, list[_Named]] = {}
    for one in named:
        groups.setdefault(key(one), []).append(one)
    return groups


def _or_0(time_ms: float | None) -> float:
    return 0.0 if time_ms is None else time_ms


def natural(text: str) -> tuple[tuple[int, str], ...]:
    """A key that sorts numbers in a name by their value.

    Examples
    --------
    >>> sorted(["L10", "L9"], key=natural)
    ['L9', 'L10']
    """
    parts = re.findall(r"\d+|\D+", text.lower())
    return tuple((int(part), "") if part.isdecimal() else (-1, part) for part in parts)


def _refuse_unclear_flats(source: str, flats: list[_Named], groups: _Groups) -> str:
    """How the flats were grouped; an error if there is a second reading, or a single flat."""
    labels = {label for label, _ in groups}
    times = {time for _, time in groups}
    if None in times and len(times) > 1:
        without = next(one for one in flats if one.frame.time_ms is None)
        what = f"some flats have an exposure time, but {without.frame.name} has none"
        raise _question(source, what)
    single = [key for key, group in groups.items() if len(group) == 1]
    if single and len(single) == len(groups) > 1:
        raise _question(
            source,
            f"each of {len(groups)} names and exposure times has 1 flat, e.g. "
            f"{groups[single[0]][0].frame.name}, so that it is unclear which flats form a level",
        )
    for key in single:
        flat = groups[key][0].frame
        refuse_few(source, [FrameLevel(name=_title(key), flats=(flat,), darks=())])
    most = max((len(group) for group in groups.values()), default=0)
    if len(groups) == 1 and most > 2:
        raise _question(
            source,
            f"{most} flats from {flats[0].frame.name} to {flats[-1].frame.name} have one number "
            "each and the same exposure time or none, so that they may be repeats or levels",
        )
    if len(times) > 1:
        return "by exposure time" if len(labels) == 1 else "by exposure time and name"
    numbers = [frozenset(one.number for one in group) for group in groups.values()]
    crossed = len(set(numbers)) == 1 and "" not in numbers[0] and len(labels) <= most
    if crossed and len(labels) > 1 and _may_count_repeats(sorted(labels, key=natural)):
        raise _question(
            source,
            f"{len(labels)} names with {most} flats each, e.g. {flats[0].frame.name}, may be "
            "levels or repeats",
        )
    return "by name"


def _may_count_repeats(labels: list[str]) -> bool:
    """Whether labels differ by a number from 0 or 1, or a letter, which may count repeats.

    They do not if a word such as ``level`` stands before the number, or if they differ otherwise.
    """
    if all(_LEVEL_WORD.search(label) for label in labels):
        return False
    split = [re.findall(r"\d+|[^\W\d_]+", label.lower()) for label in labels]
    if len({len(words) for words in split}) > 1:
        return False
    differ = [words for words in zip(*split, strict=True) if len(set(words)) > 1]
    if len(differ) != 1:
        return True
    if all(word.isdecimal() for word in differ[0]):
        numbers = sorted(int(word) for word in differ[0])
        return numbers[0] in (0, 1) and numbers == list(range(numbers[0], numbers[-1] + 1))
    return all(len(word) == 1 for word in differ[0])


# darks


def _matched(
    source: str, groups: _Groups, darks: list[_Named]
) -> tuple[_Groups, _Groups, list[str]]:
    """Darks of each level, darks that belong to none, and notes."""
    if not darks:
        return {}, {}, ["no darks: no name has one of the words dark, bias, black, cap"]
    timed = [one.frame.time_ms is not None for one in darks]
    if not all(timed) and any(timed):
        without = next(one for one in darks if one.frame.time_ms is None)
        what = f"some darks have an exposure time, but {without.frame.name} has none"
        raise _question(source, what)
    times = {time for _, time in groups}
    if all(timed) and (None not in times):
        return _by_time(groups, darks)
    if all(timed):
        raise _question(source, "the darks have exposure times and the flats have none")
    return _without_times(source, groups, darks)


def _by_time(groups: _Groups, darks: list[_Named]) -> tuple[_Groups, _Groups, list[str]]:
    at = _grouped(darks, lambda one: one.frame.time_ms)
    matched = {key: at[key[1]] for key in groups if key[1] in at}
    matched |= _by_label(matched)
    lit = {key[1] for key in groups}
    alone = {("", time): at[time] for time in sorted(at, key=_or_0) if time not in lit}
    notes = []
    if matched:
        used = sum(len(at[time]) for time in {key[1] for key in matched})
        notes.append(f"{used} darks matched by exposure time to {_levels(len(matched))}")
    if groups and len(matched) < len(groups):
        missing = len(groups) - len(matched)
        notes.append(f"{missing} of {len(groups)} levels have no darks of their exposure time")
    if alone:
        notes.append(f"{_counts(alone, 'darks')} of other exposure times than the flats")
    return matched, alone, notes


def _by_label(matched: _Groups) -> _Groups:
    """Darks of the same time divided among its levels by label, where each label has its own."""
    divided: _Groups = {}
    for time in {key[1] for key in matched}:
        keys = [key for key in matched if key[1] == time]
        darks = matched[keys[0]]
        own = {key: [one for one in darks if _bare(one.label) == _bare(key[0])] for key in keys}
        if all(own.values()) and sum(len(group) for group in own.values()) == len(darks):
            divided |= own
    return divided


def _without_times(
    source: str, groups: _Groups, darks: list[_Named]
) -> tuple[_Groups, _Groups, list[str]]:
    by_label = _grouped(darks, lambda one: _bare(one.label))
    if not groups:
        alone: _Groups = {(label, None): own for label, own in sorted(by_label.items())}
        return {}, alone, [f"{_counts(alone, 'darks')} by name, without exposure times"]
    if len({time for _, time in groups}) > 1:
        raise _question(
            source,
            f"the flats have exposure times and the {len(darks)} darks, e.g. "
            f"{darks[0].frame.name}, have none",
        )
    bare = {key: _bare(key[0]) for key in groups}
    if len(set(bare.values())) == len(groups) and set(by_label) == set(bare.values()):
        matched = {key: by_label[label] for key, label in bare.items()}
        return matched, {}, [f"{len(darks)} darks matched by name to {_levels(len(groups))}"]
    if len(by_label) == 1:
        return (
            dict.fromkeys(groups, darks),
            {},
            [f"{len(darks)} darks used at all levels: neither their times nor names differ"],
        )
    raise _question(
        source,
        f"the names of {len(by_label)} groups of darks, e.g. {darks[0].frame.name}, do not match "
        f"those of {len(groups)} levels",
    )


def _bare(label: str) -> str:
    """A label without the words of flats and darks, in lower case, numbers without leading 0."""
    words = re.findall(r"[^\W\d_]+|\d+", label.lower())
    kept = [word for word in words if word not in (*DARK_WORDS, *LIGHT_WORDS)]
    return " ".join(str(int(word)) if word.isdecimal() else word for word in kept)


# words


def _titles(groups: _Groups) -> dict[_Group, str]:
    """The label if it is enough, else the time, else both."""
    if len({label for label, _ in groups}) == len(groups):
        return {key: key[0] or _title(key) for key in groups}
    if len({time for _, time in groups}) == len(groups):
        return {key: f"{key[1]:g} ms" for key in groups if key[1] is not None}
    return {key: _title(key) for key in groups}


def _title(key: _Group) -> str:
    label, time_ms = key
    return " ".join(part for part in (label, "" if time_ms is None else f"{time_ms:g} ms") if part)


def _counts(groups: _Groups, what: str) -> str:
    """``12 levels of 2 flats``."""
    counts = sorted({len(group) for group in groups.values()})
    several = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    return f"{_levels(len(groups))} of {several} {what}"


def _levels(count: int) -> str:
    return f"{count} level{'' if count == 1 else 's'}"


def _question(source: str, unclear: str) -> InputError:
    return refused(
        source, "must make clear which frames form a level", found=unclear, remedy=EXAMPLE
    )


def frame_name(path: Path, folder: Path, part: str) -> str:
    """Path in the folder, without the ending, and the name of the array: ``level3/a``."""
    inside = path.relative_to(folder).with_suffix("")
    return "/".join([*inside.parts, part] if part else inside.parts)


_MOST_FILES = 20_000
_TEXT = (".txt", ".emva")


def read_frame_set(words: Sequence[Path | str]) -> FrameSet:
    """The frames of a photon transfer measurement, grouped into levels of light with their darks.

    Parameters
    ----------
    words
        One of: a folder with ``capture.toml``, or that file (see ``read_capture``); an EMVA 1288
        descriptor, or the folder with it (see ``read_descriptor``); otherwise folders and files of
        frames, which are grouped by name and exposure time (see ``levels_by_name``). Files of
        other formats in a folder are left out, and a note states how many.

    Raises
    ------
    InputError
        If a file cannot be read, the frames are of different cameras, sizes, gains or mosaics, a
        level has one flat, or it is unclear which frames form a level.
    """
    paths = [Path(word) for word in words]
    if not paths:
        raise refused("frames", "must be a folder or files", found="none are given")
    for path in paths:
        regular_file(path, folder=True)
    if len(paths) == 1:
        listed = _list_of(paths[0])
        if listed is not None:
            return read_capture(listed) if listed.suffix == ".toml" else read_descriptor(listed)
    for path in paths:
        if path.suffix.lower() in (".toml", *_TEXT) and path.is_file():
            raise refused(
                path,
                "must be given alone, because it lists the frames"
                if path.suffix == ".toml"
                else "must be a frame or an EMVA 1288 descriptor",
            )
    return _by_name(paths)


def _list_of(path: Path) -> Path | None:
    """The file that lists the frames: ``capture.toml`` or a descriptor; ``None`` without one."""
    if path.is_file():
        if path.suffix.lower() == ".toml":
            return path
        return path if path.suffix.lower() in _TEXT and is_descriptor(path) else None
    if (path / CAPTURE).exists():
        return path / CAPTURE
    texts = sorted(file for file in _files(path, deep=False) if file.suffix.lower() in _TEXT)
    found = [file for file in texts if is_descriptor(file)]
    if len(found) > 1:
        need = "must have one EMVA 1288 descriptor"
        held = f"has {found[0].name} and {found[1].name}"
        raise refused(path, need, len(found), held, remedy="name one of them")
    return found[0] if found else None


def _by_name(paths: Sequence[Path]) -> FrameSet:
    source = str(paths[0]) if len(paths) == 1 else f"{len(paths)} files and folders"
    frames: list[RawFrame] = []
    names: list[str] = []
    others: list[Path] = []
    seen: set[Path] = set()
    for path in paths:
        inside = path.is_dir()
        for file in _files(path, deep=True) if inside else [path]:
            if file.name == CAPTURE:
                need = "must be given alone, because it lists the frames"
                raise refused(file, need, remedy=f"evaluate {file.parent} by itself")
            if true_path(file) in seen:
                raise refused(file, "must be given once", found="is given twice")
            seen.add(true_path(file))
            if inside and (file.name.startswith(".") or not is_frame_name(file)):
                others.append(file)
                continue
            base = path if inside else file.parent
            own = frames_in(file)
            frames += own
            names += [_name(frame, base, several=len(paths) > 1) for frame in own]
    if not frames:
        raise refused(
            source, "must hold raw frames", found=f"holds none{_listed(others)}", remedy=EXAMPLE
        )
    refuse_mixed(source, frames)
    mosaic = mosaic_of_all(source, frames)
    levels, notes = levels_by_name(source, frames, names)
    if mosaic is None:
        notes += ("taken as monochrome: no file states a mosaic; capture.toml can give one",)
    if others:
        notes += (f"{len(others)} other files left out{_listed(others)}",)
    return FrameSet(source=source, levels=levels, mosaic=mosaic, notes=notes)


def _name(frame: RawFrame, base: Path, *, several: bool) -> str:
    """The path of a frame in its folder; the folder itself counts if several are given."""
    name = frame_name(frame.path, base, frame.part)
    return f"{true_path(base).name}/{name}" if several and true_path(base).name else name


def _files(folder: Path, *, deep: bool) -> list[Path]:
    """Regular files, sorted by the numbers in their names; links to folders are not followed."""
    found: list[Path] = []
    for root, folders, files in os.walk(folder, onerror=_refuse_folder):
        folders[:] = sorted(folders) if deep else []
        found += [path for name in files if (path := Path(root, name)).is_file()]
        if len(found) > _MOST_FILES:
            raise refused(folder, f"must hold at most {_MOST_FILES} files")
    return sorted(found, key=lambda path: (natural(str(path.relative_to(folder))), str(path)))


def _refuse_folder(error: OSError) -> None:
    raise refused(error.filename, f"cannot be read ({error.strerror})") from None


def _listed(files: Sequence[Path]) -> str:
    """`` (3 .txt, 1 .csv)``."""
    counts = Counter(file.suffix.lower() or file.name for file in files)
    listed = ", ".join(f"{count} {ending[:20]}" for ending, count in sorted(counts.items())[:8])
    return f" ({listed})" if listed else ""
