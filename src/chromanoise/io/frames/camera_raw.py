"""Raw frames in TIFF files, and in DNG and all camera files that LibRaw reads.

A TIFF file has one frame per page; its tags state the exposure, the camera and its mosaic. LibRaw
runs in a child process with limits on time and memory, because a damaged file may crash it.
"""

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from chromanoise.base import (
    Array,
    Integer,
    UInt16,
    dataclass,
    json_of,
    refuse_absent_package,
    sandbox,
)
from chromanoise.io.cubes.found_cube import reading, reading_rows, refuse_impossible
from chromanoise.io.cubes.tiff import (
    decoded_pages,
    is_plain,
    opened_tiff,
    refuse_incomplete,
    whole_pages,
)
from chromanoise.io.frames.frame import (
    MOST_FRAMES,
    RawFrame,
    StoredPlane,
    refuse_shape,
    refused_picture,
    whole_codes,
)
from chromanoise.io.source_files import refused
from chromanoise.sensor import Mosaic

CFA = 32803
"""PhotometricInterpretation of a mosaic (TIFF/EP, ISO 12234-2)."""
CFA_COLORS = ("R", "G", "B", "C", "M", "Y", "W")
"""Channels by their codes in CFAPattern and CFAPlaneColor."""
_EXIF, _TIME, _ISO = 34665, 33434, 34855
_ISO_NAMES = ("PhotographicSensitivity", "ISOSpeedRatings", "ISOSpeed")
_MAKE, _MODEL, _REPEAT, _PATTERN = 271, 272, 33421, 33422
_MOST_PERIOD = 32
_LONGEST_S = 1e6
_LARGEST_ISO = 1e8


def exposure_of(page: Any) -> dict[str, Any]:
    """``time_ms``, ``iso`` and ``camera`` of a page of tifffile, as far as its tags state them.

    Parameters
    ----------
    page
        The first page, which has the Exif tags.
    """
    exif = _value(page, _EXIF)
    exif = exif if isinstance(exif, dict) else {}
    time_s = number_of_tag(_first(exif.get("ExposureTime"), _value(page, _TIME)))
    iso = number_of_tag(_first(*(exif.get(name) for name in _ISO_NAMES), _value(page, _ISO)))
    return {
        "time_ms": None if time_s is None or not 0 < time_s <= _LONGEST_S else 1000 * time_s,
        "iso": None if iso is None or not 0 < iso <= _LARGEST_ISO else iso,
        "camera": camera_name(*(str(_value(page, tag) or "") for tag in (_MAKE, _MODEL))),
    }


def camera_name(make: str, model: str) -> str:
    """Maker and model without repetition, printable.

    Examples
    --------
    >>> camera_name("NIKON CORPORATION", "NIKON D850"), camera_name("Canon", "Canon EOS R5")
    ('NIKON D850', 'Canon EOS R5')
    """
    make, model = (
        " ".join("".join(c if c.isprintable() else " " for c in text[:200]).split())
        for text in (make, model)
    )
    repeated = make and model.lower().startswith(make.split()[0].lower())
    return (model if repeated else f"{make} {model}").strip()


def mosaic_of(page: Any) -> Mosaic | None:
    """The mosaic from the tags CFARepeatPatternDim and CFAPattern; ``None`` without them.

    Parameters
    ----------
    page
        A page of tifffile.
    """
    sides, codes = _value(page, _REPEAT), _value(page, _PATTERN)
    try:
        rows, columns = (int(side) for side in sides)
        numbers = [int(code) for code in codes]
    except (TypeError, ValueError):
        return None
    if not (0 < rows <= _MOST_PERIOD and 0 < columns <= _MOST_PERIOD):
        return None
    if len(numbers) != rows * columns or not all(0 <= code < len(CFA_COLORS) for code in numbers):
        return None
    letters = [CFA_COLORS[code] for code in numbers]
    return smallest_mosaic([letters[r * columns : (r + 1) * columns] for r in range(rows)])


def smallest_mosaic(rows: list[list[str]]) -> Mosaic:
    """The smallest block that repeats to these rows.

    Examples
    --------
    >>> smallest_mosaic([["R", "G", "R", "G"], ["G", "B", "G", "B"]]).pattern
    (('R', 'G'), ('G', 'B'))
    """
    height, width = len(rows), len(rows[0])
    high = _period([tuple(row) for row in rows], height)
    wide = _period([tuple(row[c] for row in rows) for c in range(width)], width)
    return Mosaic(tuple(tuple(row[:wide]) for row in rows[:high]))


def _period(lines: list[tuple[str, ...]], length: int) -> int:
    for n in range(1, length):
        if length % n == 0 and all(lines[i] == lines[i % n] for i in range(length)):
            return n
    return length


def _value(page: Any, tag: int) -> Any:
    found = page.tags.get(tag)
    return None if found is None else found.value


def _first(*values: Any) -> Any:
    return next((value for value in values if value is not None), None)


def number_of_tag(value: Any) -> float | None:
    """A finite number, a fraction of two numbers, or the first of several; ``None`` otherwise.

    Examples
    --------
    >>> number_of_tag((1, 4)), number_of_tag("12.5"), number_of_tag(True)
    (0.25, 12.5, None)
    """
    if isinstance(value, bool):
        return None
    try:
        if isinstance(value, (tuple, list)) and len(value) == 2 and value[1]:
            value = value[0] / value[1]
        elif isinstance(value, (tuple, list)):
            value = value[0]
        number = float(value)
    except (TypeError, ValueError, IndexError, OverflowError):
        return None
    return number if math.isfinite(number) else None


_BLACK_IS_0, _WHITE_IS_0 = 1, 0


def tiff_frames(path: Path) -> tuple[RawFrame, ...]:
    """The pages of a TIFF; reduced pages (thumbnails) are not used.

    Uncompressed pages are read in place. Exposure time, ISO and camera come from the Exif tags of
    the first page, the mosaic from the tags of TIFF/EP (ISO 12234-2).

    Raises
    ------
    InputError
        If a page has more than one channel, is incomplete, or is larger than its file allows.
    """
    with opened_tiff(path) as file:
        pages = whole_pages(path, file, MOST_FRAMES)
        _refuse_truncated_stack(path, pages[0], len(pages))
        exposure = exposure_of(pages[0])
        many = len(pages) > 1
        return tuple(
            _frame(path, page, index=k if many else None, exposure=exposure)
            for k, page in enumerate(pages)
        )


def _frame(path: Path, page: Any, *, index: int | None, exposure: dict[str, Any]) -> RawFrame:
    where = "" if index is None else f"page {index} (from 0)"
    if page.dtype is None or len(page.shape) < 2:
        raise refused(path, "must hold plain numbers", found="holds none", where=where)
    if len(page.shape) != 2 or page.photometric not in (_BLACK_IS_0, _WHITE_IS_0, CFA):
        kind = getattr(page.photometric, "name", page.photometric)
        sides = " x ".join(str(side) for side in page.shape)
        raise refused_picture(path, f"is a picture of {sides} ({kind})", where)
    if page.photometric == _WHITE_IS_0:
        raise refused(path, "must store black as 0", found="stores white as 0", where=where)
    shape, dtype = (int(page.shape[0]), int(page.shape[1])), np.dtype(page.dtype)
    refuse_shape(path, where, shape)
    refuse_incomplete(path, index or 0, page)
    refuse_impossible(path, where or "page 0", shape, dtype)
    mosaic = mosaic_of(page)
    if page.photometric == CFA and mosaic is None:
        need = "must state its mosaic in the tag CFAPattern"
        remedy = "save it as a gray TIFF, and write the mosaic into capture.toml"
        raise refused(path, need, where=where, remedy=remedy)
    read: Any = partial(_unpacked_page, path, page.index, shape, str(dtype))
    if is_plain(page):
        read = _plane(path, page)
    bits = int(page.bitspersample)
    return RawFrame(
        path=path,
        shape=shape,
        read=read,
        index=index,
        mosaic=mosaic,
        bits=bits if dtype.kind == "u" and bits < 16 else None,
        **exposure,
    )


def _plane(path: Path, page: Any) -> StoredPlane:
    stored = np.dtype(page.dtype).newbyteorder(page.parent.byteorder)
    shape = int(page.shape[0]), int(page.shape[1])
    return StoredPlane(path, int(page.dataoffsets[0]), stored, shape)


def _unpacked_page(
    path: Path, number: int, shape: tuple[int, int], stored: str
) -> Integer[Array, "h w"]:
    with opened_tiff(path) as file:
        page = file.pages[number].aspage()
        if (tuple(page.shape), str(page.dtype)) != (shape, stored):
            raise refused(path, "must not change while it is read")
        refuse_incomplete(path, number, page)
        codes = decoded_pages(path, [page])[0]
    return whole_codes(str(path), codes)


def _refuse_truncated_stack(path: Path, first: Any, pages: int) -> None:
    """Refuse a file whose description states more frames than it has pages (ImageJ, tifffile)."""
    declared = 1
    text = str(getattr(first, "description", ""))[:10_000]
    if first.is_imagej:
        words = dict(line.split("=", 1) for line in text.splitlines() if "=" in line)
        images = words.get("images", "1").strip()
        declared = int(images) if images.isdigit() and len(images) < 9 else 1
    elif first.is_shaped:
        try:
            shape = json_of(text, str(path), any_number=True).get("shape", [])
            declared = int(np.prod([int(side) for side in shape[:-2]])) if len(shape) > 2 else 1
        except (ValueError, TypeError, AttributeError, OverflowError):
            declared = 1
    if declared > pages and pages == 1 and len(first.shape) == 2:
        need = "must have one page per frame"
        found = f"has {pages} page, and its description states {declared} frames"
        raise refused(path, need, pages, found, remedy="save each frame as a page")


_MOST_PIXELS_PER_BYTE = 64  # of the lossless compressions that cameras use; zeros take 1/16 byte
_LIMIT_S = 20.0
_SLOWEST_PIXELS_PER_S = 1e6
_HEADER_BYTES = 256 * 2**20
_BYTES_PER_PIXEL = 8  # codes, their copy for the parent process, and LibRaw's own buffers
_BLACK, _WHITE, _DNG_VERSION = 50714, 50717, 50706
_NO_COMPRESSION = 1
_LINEARIZATION, _ACTIVE_AREA = 50712, 50829
_NOISE_PROFILE, _PLANE_COLORS = 51041, 50710
_PROBE = 48  # a multiple of the periods 1, 2, 4, 6, 8 and 16 that LibRaw knows


def raw_frames(path: Path) -> tuple[RawFrame, ...]:
    """The frame in a file of a camera: the visible pixels, without any processing.

    An uncompressed DNG is read without LibRaw, strips in place; of another DNG, only the header is
    read at first. All other files are unpacked once, because LibRaw gives their mosaic and levels
    only then.

    Raises
    ------
    InputError
        If rawpy is not installed, LibRaw cannot read the file, or it holds demosaicked colors.
    """
    from_tags, frame = _of_tags(path)
    if frame is not None:
        return (frame,)
    refuse_absent_package("rawpy", str(path), extra="raw")
    size = path.stat().st_size
    with reading(path, "camera raw"):
        raw_shape, shape = sandbox.sandboxed(
            _sizes, str(path), path=path, limit_s=_LIMIT_S, memory_bytes=_HEADER_BYTES
        )
    refuse_shape(path, "", raw_shape)
    refuse_shape(path, "", shape)
    pixels = raw_shape[0] * raw_shape[1]
    if pixels > _MOST_PIXELS_PER_BYTE * size:
        need = f"must fit into the {size} bytes of the file"
        found = f"is declared as {raw_shape[0]} x {raw_shape[1]} pixels"
        remedy = "copy it again, because the file is damaged"
        raise refused(path, need, raw_shape, found, remedy=remedy)
    read = _Raw(path=path, shape=shape, pixels=pixels)
    metadata = from_tags if "mosaic" in from_tags else read.header() | from_tags
    return (RawFrame(path=path, shape=shape, read=read, **metadata),)


@dataclass(frozen=True, kw_only=True)
class _Raw:
    """Unpacks the visible pixels in the child process."""

    path: Path
    shape: tuple[int, int]
    pixels: int

    def __call__(self) -> UInt16[Array, "h w"]:
        codes: Any = self._called(_codes)
        return codes

    def header(self) -> dict[str, Any]:
        """Mosaic, levels, exposure time and ISO as LibRaw knows them."""
        metadata: dict[str, Any] = self._called(_header)
        rows = metadata.pop("mosaic")
        return metadata | {"mosaic": None if rows is None else smallest_mosaic(rows)}

    def _called(self, function: Any) -> Any:
        with reading_rows(self.path, "camera raw"):  # threads may read frames at once
            return sandbox.sandboxed(
                function,
                str(self.path),
                self.shape,
                path=self.path,
                limit_s=_LIMIT_S + self.pixels / _SLOWEST_PIXELS_PER_S,
                memory_bytes=_HEADER_BYTES + _BYTES_PER_PIXEL * self.pixels,
            )


_Area = tuple[int, int, int, int]
"""The visible pixels: first row, first column, row after the last, column after the last."""


def _tiled_codes(path: Path, stored: tuple[int, int], area: _Area) -> UInt16[Array, "h w"]:
    """The codes in uncompressed tiles; LibRaw 0.22 reads wrong ones of a tile beyond the picture.

    Parameters
    ----------
    stored
        Rows and columns of all pixels. [px]
    """
    with opened_tiff(path) as tiff:
        (page,) = _mosaic_pages(tiff)
        if tuple(page.shape) != stored or not _is_uncompressed(page):
            raise refused(path, "must not change while it is read")
        refuse_incomplete(path, 0, page)
        codes = decoded_pages(path, [page])[0]
    top, left, bottom, right = area
    return codes[top:bottom, left:right].astype(np.uint16, copy=False)


def _mosaic_pages(tiff: Any) -> list[Any]:
    """The pages of raw codes in the first directory and below it."""
    first = tiff.pages[0].aspage()
    pages = [first, *(page.aspage() for page in first.pages or ())]
    return [page for page in pages if page.photometric == CFA]


def _of_tags(path: Path) -> tuple[dict[str, Any], RawFrame | None]:
    """What the TIFF tags state, and the frame if the file is an uncompressed DNG.

    A file that is not a TIFF (CR3, RAF, ...) gives nothing here; LibRaw then gives what it knows.
    The tags of a DNG give all fields of a frame.
    """
    with path.open("rb") as file:
        start = file.read(4)
    if start not in (b"II*\0", b"MM\0*"):
        return {}, None
    with opened_tiff(path) as tiff:
        first = tiff.pages[0].aspage()
        metadata = {name: value for name, value in exposure_of(first).items() if value}
        if _DNG_VERSION not in first.tags:
            return metadata, None
        whole = _mosaic_pages(tiff)
        for page in whole:
            refuse_incomplete(path, 0, page)
        mosaic = mosaic_of(whole[0]) if len(whole) == 1 else None
        if mosaic is None:
            return metadata, None
        levels = {
            "black_level_dn": _mean(whole[0], _BLACK),
            "white_level_dn": _mean(whole[0], _WHITE),
            "noise_profile": _noise_profile([whole[0], first], mosaic),
        }
        metadata |= {**levels, "mosaic": mosaic}
        return metadata, _uncompressed(path, whole[0], metadata)


def _noise_profile(pages: list[Any], mosaic: Mosaic) -> Mapping[str, tuple[float, float]] | None:
    """S and O of each channel of the mosaic; ``None`` if the tag is absent or fits no channels.

    One pair is of all channels. Several pairs have the order of CFAPlaneColor.
    """
    tag = next((page.tags[_NOISE_PROFILE] for page in pages if _NOISE_PROFILE in page.tags), None)
    if tag is None:
        return None
    numbers = np.atleast_1d(np.asarray(tag.value, dtype=np.float64)).ravel()
    pairs = [(float(s), float(o)) for s, o in zip(numbers[::2], numbers[1::2], strict=False)]
    if not len(numbers) or len(numbers) % 2 or not np.isfinite(numbers).all():
        return None
    if len(pairs) == 1:
        return dict.fromkeys(mosaic.names, pairs[0])
    planes = pages[0].tags.get(_PLANE_COLORS)
    colors = (0, 1, 2) if planes is None else tuple(bytes(planes.value))
    if len(colors) != len(pairs) or not all(one < len(CFA_COLORS) for one in colors):
        return None
    named = {CFA_COLORS[one]: pair for one, pair in zip(colors, pairs, strict=True)}
    return named if set(mosaic.names) <= set(named) else None


def _is_uncompressed(page: Any) -> bool:
    """Whether a page holds codes of 16 bits without compression, in strips or tiles."""
    plain = page.compression == _NO_COMPRESSION and page.predictor == 1 and page.fillorder == 1
    return bool(plain and page.ndim == 2 and page.bitspersample == 16 and page.dtype == np.uint16)


def _is_within(area: tuple[int, ...], shape: tuple[int, int]) -> TypeGuard[_Area]:
    """Whether an area of rows and columns lies in a picture and is not empty."""
    if len(area) != 4 or not all(isinstance(side, int) for side in area):
        return False
    top, left, bottom, right = area
    return 0 <= top < bottom <= shape[0] and 0 <= left < right <= shape[1]


def _uncompressed(path: Path, page: Any, metadata: dict[str, Any]) -> RawFrame | None:
    """The frame of a DNG if its codes are stored as they are; else ``None``."""
    if not _is_uncompressed(page) or _LINEARIZATION in page.tags:
        return None
    shape = int(page.shape[0]), int(page.shape[1])
    active = page.tags.get(_ACTIVE_AREA)
    area = (0, 0, *shape) if active is None else tuple(active.value)
    read: Any
    if page.is_tiled and _is_within(area, shape):
        read = partial(_tiled_codes, path, shape, area)
    elif is_plain(page) and area == (0, 0, *shape):
        read = _plane(path, page)
    else:
        return None
    refuse_shape(path, "", shape)
    sides = area[2] - area[0], area[3] - area[1]
    return RawFrame(path=path, shape=sides, read=read, **metadata)


def _mean(page: Any, tag: int) -> float | None:
    """Mean of the numbers or fractions of a tag; ``None`` if it is absent or no number."""
    found = page.tags.get(tag)
    if found is None:
        return None
    try:
        values = np.atleast_1d(np.asarray(found.value, dtype=np.float64)).ravel()
        if found.dtype in (5, 10):
            values = values[::2] / np.where(values[1::2], values[1::2], np.nan)
        mean = float(values.mean())
    except (TypeError, ValueError):
        return None
    return mean if np.isfinite(mean) else None


# in the child process


def _sizes(path: str) -> tuple[tuple[int, int], tuple[int, int]]:
    """Rows and columns of all pixels, and of the visible ones."""
    import rawpy

    with rawpy.RawPy() as raw:
        raw.open_file(path)
        sizes = raw.sizes
        return (sizes.raw_height, sizes.raw_width), (sizes.height, sizes.width)


def _codes(path: str, shape: tuple[int, int]) -> UInt16[Array, "h w"]:
    with _unpacked(path) as raw:
        codes = raw.raw_image_visible
        if codes.shape != shape:
            raise refused(path, "must have the size stated in its header", codes.shape)
        return codes.copy()  # rawpy frees its memory


def _header(path: str, shape: tuple[int, int]) -> dict[str, Any]:
    with _unpacked(path) as raw:
        other = getattr(raw, "other", None)  # since rawpy 0.25
        blacks = raw.black_level_per_channel[: max(1, raw.num_colors)]
        time_s, iso = (getattr(other, name, 0) for name in ("shutter_speed", "iso_speed"))
        return {
            "time_ms": 1000 * float(time_s) if time_s > 0 else None,
            "iso": float(iso) if iso > 0 else None,
            "black_level_dn": float(np.mean(blacks)),
            "white_level_dn": float(raw.white_level),
            "mosaic": _probed(raw, shape),
        }


def _unpacked(path: str) -> Any:
    import rawpy

    raw = rawpy.imread(path)
    if raw.raw_type != rawpy.RawType.Flat or raw.raw_image_visible.ndim != 2:
        raise refused_picture(Path(path), "holds demosaicked or combined colors")
    return raw


def _probed(raw: Any, shape: tuple[int, int]) -> list[list[str]] | None:
    """Channel names of the first visible pixels; ``None`` for a monochrome sensor."""
    names = raw.color_desc.decode("ascii", "replace")
    sizes = raw.sizes
    rows, columns = (min(_PROBE, side) for side in shape)
    numbers = [
        [raw.raw_color(sizes.top_margin + r, sizes.left_margin + c) for c in range(columns)]
        for r in range(rows)
    ]
    if raw.num_colors == 1 or any(n >= len(names) for row in numbers for n in row):
        return None
    return [[names[n] for n in row] for row in numbers]
