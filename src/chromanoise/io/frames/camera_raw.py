"""Raw frames in the files of cameras: DNG and all that LibRaw reads.

LibRaw runs in a child process with limits on time and memory, because a damaged file may crash it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from chromanoise import _sandbox
from chromanoise._check import Array
from chromanoise._shapes import UInt16
from chromanoise.errors import InputError
from chromanoise.io.cubes.errors import reading, reading_rows, refuse_absent_library
from chromanoise.io.cubes.tiff import is_plain, refuse_incomplete
from chromanoise.io.cubes.tiff_pages import decoded_pages
from chromanoise.io.frames.exif import CFA, CFA_COLORS, exposure_of, mosaic_of, smallest_mosaic
from chromanoise.io.frames.frame import RawFrame
from chromanoise.io.frames.stored import StoredPlane, refuse_shape, refused_picture
from chromanoise.io.frames.tiff import opened_tiff
from chromanoise.sensor import Mosaic

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
    from_tags, plane = _of_tags(path)
    if plane is not None:
        return (RawFrame(path=path, shape=plane.shape, read=plane, **from_tags),)
    refuse_absent_library("rawpy", str(path), extra="raw")
    size = path.stat().st_size
    with reading(path, "camera raw"):
        raw_shape, shape = _sandbox.sandboxed(
            _sizes, str(path), path=path, limit_s=_LIMIT_S, memory_bytes=_HEADER_BYTES
        )
    refuse_shape(path, "", raw_shape)
    refuse_shape(path, "", shape)
    pixels = raw_shape[0] * raw_shape[1]
    if pixels > _MOST_PIXELS_PER_BYTE * size:
        raise InputError(
            str(path),
            f"must fit into the {size} bytes of the file",
            value=raw_shape,
            found=f"is declared as {raw_shape[0]} x {raw_shape[1]} pixels",
            remedy="copy it again, because the file is damaged",
        )
    read = _Raw(path=path, shape=shape, pixels=pixels)
    metadata = from_tags if "mosaic" in from_tags else read.header() | from_tags
    return (RawFrame(path=path, shape=shape, read=read, **metadata),)


@dataclass(frozen=True, slots=True, kw_only=True)
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
            return _sandbox.sandboxed(
                function,
                str(self.path),
                self.shape,
                path=self.path,
                limit_s=_LIMIT_S + self.pixels / _SLOWEST_PIXELS_PER_S,
                memory_bytes=_HEADER_BYTES + _BYTES_PER_PIXEL * self.pixels,
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Tiles:
    """Joins the uncompressed tiles of a DNG into one picture.

    LibRaw 0.22 reads wrong codes where a tile is larger than the picture.

    Attributes
    ----------
    path
        The file.
    stored
        Rows and columns of all pixels.
    area
        The visible pixels: first row, first column, row after the last, column after the last.
    """

    path: Path
    stored: tuple[int, int]
    area: tuple[int, int, int, int]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the visible pixels."""
        top, left, bottom, right = self.area
        return bottom - top, right - left

    def __call__(self) -> UInt16[Array, "h w"]:
        with opened_tiff(self.path) as tiff:
            (page,) = _mosaic_pages(tiff)
            if tuple(page.shape) != self.stored or not _is_uncompressed(page):
                raise InputError(str(self.path), "must not change while it is read")
            refuse_incomplete(self.path, 0, page)
            codes = decoded_pages(self.path, [page])[0]
        top, left, bottom, right = self.area
        return codes[top:bottom, left:right].astype(np.uint16, copy=False)


def _mosaic_pages(tiff: Any) -> list[Any]:
    """The pages of raw codes in the first directory and below it."""
    first = tiff.pages[0].aspage()
    pages = [first, *(page.aspage() for page in first.pages or ())]
    return [page for page in pages if page.photometric == CFA]


def _of_tags(path: Path) -> tuple[dict[str, Any], StoredPlane | _Tiles | None]:
    """What the TIFF tags state, and how to read the codes if the file is an uncompressed DNG.

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
        return metadata | levels | {"mosaic": mosaic}, _uncompressed(path, whole[0])


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


def _is_within(
    area: tuple[int, ...], shape: tuple[int, int]
) -> TypeGuard[tuple[int, int, int, int]]:
    """Whether an area of rows and columns lies in a picture and is not empty."""
    if len(area) != 4 or not all(isinstance(side, int) for side in area):
        return False
    top, left, bottom, right = area
    return 0 <= top < bottom <= shape[0] and 0 <= left < right <= shape[1]


def _uncompressed(path: Path, page: Any) -> StoredPlane | _Tiles | None:
    """Reads the codes of a page of a DNG if they are stored as they are; else ``None``."""
    if not _is_uncompressed(page) or _LINEARIZATION in page.tags:
        return None
    shape = int(page.shape[0]), int(page.shape[1])
    active = page.tags.get(_ACTIVE_AREA)
    area = (0, 0, *shape) if active is None else tuple(active.value)
    if page.is_tiled and _is_within(area, shape):
        refuse_shape(path, "", shape)
        return _Tiles(path=path, stored=shape, area=area)
    if not is_plain(page) or area != (0, 0, *shape):
        return None
    refuse_shape(path, "", shape)
    return StoredPlane(
        path=path,
        size=path.stat().st_size,
        offset=int(page.dataoffsets[0]),
        stored=np.dtype(page.dtype).newbyteorder(page.parent.byteorder),
        shape=shape,
    )


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
            raise InputError(path, "must have the size stated in its header", value=codes.shape)
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
