"""The descriptor of EMVA 1288: a text file that lists the frames of a measurement."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path, PureWindowsPath

from chromanoise.base import InputError, dataclass, printable
from chromanoise.io.frames.frame import (
    MOST_LEVELS,
    FrameLevel,
    FrameSet,
    RawFrame,
    mosaic_of_all,
    refuse_mixed,
)
from chromanoise.io.frames.frame_formats import frames_in
from chromanoise.io.source_files import by, has, real_of, refused, small_text

_HEAD_BYTES = 65536
_LARGEST_BYTES = 16 * 2**20
_MS_PER_NS = 1e-6
_LARGEST = 1e18
_MOST_FILES = 100_000
_COMMANDS = {"v": 2, "n": 4, "b": 3, "d": 2, "i": 2}


@dataclass(frozen=True, kw_only=True)
class _Series:
    """Frames of one exposure; ``photons`` is ``None`` for darks."""

    line: int
    time_ms: float
    photons: float | None
    files: list[str]

    @property
    def spatial(self) -> bool:
        """Whether it has more than the two frames of a temporal measurement."""
        return len(self.files) > 2

    @property
    def lit(self) -> bool:
        """Whether it has light."""
        return self.photons is not None


def is_descriptor(path: Path) -> bool:
    """Whether the first lines of a text file are those of a descriptor."""
    try:
        with path.open("rb") as file:
            text = file.read(_HEAD_BYTES).decode("utf-8-sig", "replace")
    except OSError:
        return False
    words = [words for _, words in _lines(text)]
    shapes = {one[0]: len(one) for one in words[:2] if one}
    return shapes.get("n") == _COMMANDS["n"] and all(one[0] in _COMMANDS for one in words[:2])


def read_descriptor(path: Path) -> FrameSet:
    """The frames of an EMVA 1288 descriptor; times are in ns, names relative to its folder.

    A line ``b`` or ``d`` with two frames is a temporal measurement. A line with more frames is a
    spatial one, which is used for fixed patterns only (`FrameLevel`), unless all lines with light,
    or all lines of darks, are spatial. The darks of a level have the same exposure time, and are of
    the same kind (temporal or spatial) if possible.

    Raises
    ------
    InputError
        If a line is damaged, a frame is missing or has another size, or two series are equal.

    Notes
    -----
    The format of the package emva1288 1.0.2 (``v``, ``n bits width height``, ``b time photons``,
    ``d time``, ``i file``); names may have backslashes.
    """
    text = small_text(path, _LARGEST_BYTES, f"must be at most {_LARGEST_BYTES // 2**20} MiB")
    bits, shape, series = _parsed(path, text)
    frames_of = {one.line: _frames(path, one, bits, shape) for one in series}
    dark_at: dict[float, list[_Series]] = {}
    for one in series:
        if one.photons is None:
            dark_at.setdefault(one.time_ms, []).append(one)
    both = {
        kind: len({one.spatial for one in series if one.lit is kind}) > 1 for kind in (True, False)
    }
    levels, used = [], set()
    for one in series:
        if one.photons is None:
            continue
        same = dark_at.get(one.time_ms, [])
        darks = [dark for dark in same if dark.spatial == one.spatial] or same
        used |= {dark.line for dark in darks[:1]}
        dark = frames_of[darks[0].line] if darks else ()
        levels.append(_level(one, frames_of[one.line], dark, spatial=one.spatial and both[True]))
    alone = [one for one in series if one.photons is None and one.line not in used]
    levels += [
        _level(one, (), frames_of[one.line], spatial=one.spatial and both[False]) for one in alone
    ]
    frames = [frame for own in frames_of.values() for frame in own]
    refuse_mixed(str(path), frames)
    spatial = sum(level.spatial for level in levels)
    lit = sum(bool(level.flats) and not level.spatial for level in levels)
    without = sum(bool(level.flats) and not level.darks for level in levels)
    notes = [f"{lit} levels of light and {len(alone)} of darks only, by the descriptor {path.name}"]
    if spatial:
        notes.append(
            f"{spatial} series of more than 2 frames are used for fixed patterns, not for photon "
            "transfer"
        )
    if without:
        notes.append(f"{without} levels have no darks of their exposure time")
    return FrameSet(
        source=str(path),
        levels=tuple(levels),
        mosaic=mosaic_of_all(str(path), frames),
        notes=tuple(notes),
    )


def _lines(text: str) -> Iterator[tuple[int, list[str]]]:
    """Number and words of each line; the name of a file may contain blanks."""
    for number, line in enumerate(text.splitlines(), 1):
        line = line.strip()
        if line and not line.startswith("#"):
            yield number, line.split(maxsplit=1) if line[0] == "i" else line.split()


def _parsed(path: Path, text: str) -> tuple[int, tuple[int, int], list[_Series]]:
    """Bits, rows and columns, and all series."""
    form: list[int] = []
    series: list[_Series] = []
    total = 0
    for number, words in _lines(text):
        if len(words) != _COMMANDS.get(words[0]):
            raise _refused(path, number, " ".join(words))
        if words[0] == "n":
            if form or not all(word.isdecimal() and len(word) < 9 for word in words[1:]):
                raise _refused(path, number, " ".join(words))
            form = [int(word) for word in words[1:]]
        elif words[0] in "bd":
            numbers = [_number(path, number, word) for word in words[1:]]
            photons = numbers[1] if words[0] == "b" else None
            time_ms = numbers[0] * _MS_PER_NS
            series.append(_Series(line=number, time_ms=time_ms, photons=photons, files=[]))
        elif words[0] == "i":
            if not series:
                raise _refused(path, number, " ".join(words))
            total += 1
            if total > _MOST_FILES:
                raise refused(path, f"must list at most {_MOST_FILES} frames")
            series[-1].files.append(words[1])
    if len(form) != 3 or not 1 <= form[0] <= 32 or not series or len(series) > MOST_LEVELS:
        need = f"must have a line n bits width height, and 1 to {MOST_LEVELS} lines b or d"
        raise refused(path, need, len(series), f"has {len(series)}" if form else "has no line n")
    seen: dict[tuple[object, ...], int] = {}
    for one in series:
        if len(one.files) < 2:
            raise has(path, "must have at least 2 frames", len(one.files), where=f"line {one.line}")
        key = (one.time_ms, one.photons, one.spatial)
        if seen.setdefault(key, one.line) != one.line:
            need = f"must differ from line {seen[key]}"
            found = "has the same exposure time and photons"
            raise refused(path, need, found=found, where=f"line {one.line}")
    return form[0], (form[2], form[1]), series


def _refused(path: Path, number: int, line: str) -> InputError:
    need = "must be v version, n bits width height (once), b time_ns photons, d time_ns, or i file"
    return refused(path, need, printable(line), where=f"line {number}")


def _number(path: Path, line: int, word: str) -> float:
    value = real_of(word.replace(",", "."))
    if not 0 <= value <= _LARGEST:
        raise refused(
            path, f"must be a number from 0 to {_LARGEST:g}", printable(word), where=f"line {line}"
        )
    return value


def _level(
    one: _Series, flats: tuple[RawFrame, ...], darks: tuple[RawFrame, ...], *, spatial: bool
) -> FrameLevel:
    light = "dark" if one.photons is None else f"{one.photons:g} photons"
    return FrameLevel(
        name=f"{one.time_ms:g} ms, {light}, {len(one.files)} frames",
        flats=flats,
        darks=darks,
        time_ms=one.time_ms,
        photons_per_pixel=one.photons,
        spatial=spatial,
    )


def _frames(path: Path, series: _Series, bits: int, shape: tuple[int, int]) -> tuple[RawFrame, ...]:
    frames: list[RawFrame] = []
    for name in series.files:
        own = Path(name) if name.startswith("/") else Path(*PureWindowsPath(name).parts)
        frames += frames_in(path.parent / own)
        if frames[-1].shape != shape:
            need = f"must list frames of {by(shape)} pixels, as stated in its line n"
            found = f"{frames[-1].name} has {by(frames[-1].shape)}"
            raise refused(path, need, frames[-1].shape, found, where=f"line {series.line}")
    return tuple(replace(frame, bits=bits, time_ms=series.time_ms) for frame in frames)
