"""Frames of a folder, of files or of a list, as levels of light with their darks."""

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from chromanoise._inputs import regular_file, true_path
from chromanoise.errors import InputError
from chromanoise.io.frames.by_name import frame_name, levels_by_name, natural
from chromanoise.io.frames.capture import CAPTURE, read_capture
from chromanoise.io.frames.consistency import EXAMPLE, mosaic_of_all, refuse_mixed
from chromanoise.io.frames.descriptor import is_descriptor, read_descriptor
from chromanoise.io.frames.formats import frames_in, is_frame_name
from chromanoise.io.frames.frame import FrameSet, RawFrame

_MOST_FILES = 20_000
_TEXT = (".txt", ".emva")


def read_frame_set(words: Sequence[Path | str]) -> FrameSet:
    """The frames of a photon transfer measurement, grouped into levels of light with their darks.

    Parameters
    ----------
    words
        One of: a folder with ``capture.toml``, or that file (see `read_capture`); an EMVA 1288
        descriptor, or the folder with it (see `read_descriptor`); otherwise folders and files of
        frames, which are grouped by name and exposure time (see `levels_by_name`). Files of
        other formats in a folder are left out, and a note states how many.

    Raises
    ------
    InputError
        If a file cannot be read, the frames are of different cameras, sizes, gains or mosaics, a
        level has one flat, or it is unclear which frames form a level.
    """
    paths = [Path(word) for word in words]
    if not paths:
        raise InputError("frames", "must be a folder or files", found="none are given")
    for path in paths:
        regular_file(path, folder=True)
    if len(paths) == 1:
        listed = _list_of(paths[0])
        if listed is not None:
            return read_capture(listed) if listed.suffix == ".toml" else read_descriptor(listed)
    for path in paths:
        if path.suffix.lower() in (".toml", *_TEXT) and path.is_file():
            raise InputError(
                str(path),
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
        raise InputError(
            str(path),
            "must have one EMVA 1288 descriptor",
            value=len(found),
            found=f"has {found[0].name} and {found[1].name}",
            remedy="name one of them",
        )
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
                raise InputError(
                    str(file),
                    "must be given alone, because it lists the frames",
                    remedy=f"evaluate {file.parent} by itself",
                )
            if true_path(file) in seen:
                raise InputError(str(file), "must be given once", found="is given twice")
            seen.add(true_path(file))
            if inside and (file.name.startswith(".") or not is_frame_name(file)):
                others.append(file)
                continue
            base = path if inside else file.parent
            own = frames_in(file)
            frames += own
            names += [_name(frame, base, several=len(paths) > 1) for frame in own]
    if not frames:
        raise InputError(
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
            raise InputError(str(folder), f"must hold at most {_MOST_FILES} files")
    return sorted(found, key=lambda path: (natural(str(path.relative_to(folder))), str(path)))


def _refuse_folder(error: OSError) -> None:
    raise InputError(str(error.filename), f"cannot be read ({error.strerror})") from None


def _listed(files: Sequence[Path]) -> str:
    """`` (3 .txt, 1 .csv)``."""
    counts = Counter(file.suffix.lower() or file.name for file in files)
    listed = ", ".join(f"{count} {ending[:20]}" for ending, count in sorted(counts.items())[:8])
    return f" ({listed})" if listed else ""
