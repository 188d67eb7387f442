"""TIFF files of one page per band, or of pages with many samples, also compressed."""

import logging
import lzma
import math
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import Array, InputError, Setting, Shaped, json_of, optional_package, sandbox
from chromanoise.io.cubes.found_cube import (
    MOST_INFLATED,
    Found,
    Wavelengths,
    packed_rows,
    reading,
    refuse_impossible,
    refuse_other_shape,
    refuse_other_size,
)
from chromanoise.io.source_files import by, has, refuse_not_numbers, refused, xml_root
from chromanoise.io.spectra.declared import SPECTRAL_NAMES, named_wavelengths, nanometers
from chromanoise.spectra import FileRows, PlaneRows, RowSource

_LIMIT_S = 60.0
_SLOWEST_BYTES_PER_S = 1e7
_HARMLESS_BYTES = 64 * 2**20
_DEFLATE, _LZMA = (8, 32946), 34925
_MOST_BY_LZMA = 8192  # largest compression ratio of LZMA
_BLACK_IS_0, _UPRIGHT, _ORIENTATION = 1, 1, 274


def decoded_pages(path: Path, pages: list[Any]) -> Shaped[Array, "pages ..."]:
    """The numbers of pages with the same shape and type.

    Raises
    ------
    InputError
        If they need more memory than is available or than the file can hold, a page is damaged, or
        its compression needs the package imagecodecs, which is not installed.
    """
    first = pages[0]
    dtype = np.dtype(first.dtype)
    declared = (len(pages), *(int(n) for n in first.shape))
    packed = sum(sum(page.databytecounts) for page in pages)
    size = min(packed, path.stat().st_size)  # pages may share their bytes
    refuse_impossible(path, "all pages", declared, dtype, size=size)
    for page in pages:
        _refuse_overfull(path, page)
    numbers = np.empty(declared, dtype=dtype)
    for k, page in enumerate(pages):
        decoded = _by_tifffile(page)
        if decoded is None:
            numbers[k:] = _by_pillow(path, pages[k:])
            break
        refuse_other_size(path, f"page {k} (from 0)", decoded.shape, declared[1:])
        numbers[k] = decoded
    return numbers


def _refuse_overfull(path: Path, page: Any) -> None:
    """Raise an error for strips that inflate to more than declared; tifffile has no limit."""
    most: int
    unpacker: Any
    if page.compression in _DEFLATE:
        most, unpacker = MOST_INFLATED, zlib.decompressobj
    elif page.compression == _LZMA:
        most, unpacker = _MOST_BY_LZMA, lzma.LZMADecompressor
    else:
        return
    whole = math.prod(page.chunks) * np.dtype(page.dtype).itemsize
    with path.open("rb") as file:
        for at, count in zip(page.dataoffsets, page.databytecounts, strict=True):
            if count * most <= whole + _HARMLESS_BYTES:
                continue
            file.seek(at)
            if len(unpacker().decompress(file.read(count), whole + 1)) > whole:
                need = f"must unpack to at most {whole} bytes"
                found = "unpacks to more"
                remedy = "save it again, because the file is damaged"
                raise refused(path, need, found=found, where=f"strip at byte {at}", remedy=remedy)


def _by_tifffile(page: Any) -> Shaped[Array, "..."] | None:
    """The numbers of a page; None if its compression needs the package imagecodecs."""
    try:
        return np.asarray(page.asarray())
    except (ImportError, KeyError, ValueError) as error:
        if not isinstance(error, ImportError) and "imagecodecs" not in str(error):
            raise
        return None


def _by_pillow(path: Path, pages: list[Any]) -> Shaped[Array, "pages h w"]:
    """The numbers of grayscale pages; an error if Pillow would change or cannot decode them."""
    first, dtype = pages[0], np.dtype(pages[0].dtype).newbyteorder("=")
    size = len(pages) * math.prod(first.shape) * dtype.itemsize
    numbers = None
    if all(_is_as_pillow_has_it(page) for page in pages):
        numbers = sandbox.sandboxed(
            _read_by_pillow,
            path,
            [page.index for page in pages],
            first.shape,
            dtype,
            path=path,
            limit_s=_LIMIT_S + size / _SLOWEST_BYTES_PER_S,
            memory_bytes=sandbox.MEMORY_BYTES + 3 * size,
        )
    if numbers is None:
        compression = getattr(first.compression, "name", first.compression)
        where = f"pages ({compression}, {first.dtype})"
        optional_package("imagecodecs", str(path), extra="tiff", where=where)
        raise refused(
            path, "cannot be decoded", where=where, remedy="save it uncompressed or with deflate"
        )
    return numbers


def _is_as_pillow_has_it(page: Any) -> bool:
    turned = page.tags.get(_ORIENTATION)
    upright = turned is None or turned.value == _UPRIGHT
    return bool(len(page.shape) == 2 and page.photometric == _BLACK_IS_0 and upright)


def _read_by_pillow(
    path: Path, indices: list[int], shape: tuple[int, int], dtype: np.dtype
) -> Shaped[Array, "pages h w"] | None:
    """Run in the child process, because libtiff parses the file and writes to stderr."""
    from PIL.TiffImagePlugin import TiffImageFile

    numbers = np.empty((len(indices), *shape), dtype=dtype)
    try:
        image = TiffImageFile(path)
    except (SyntaxError, KeyError, ValueError):  # a kind that Pillow does not support
        return None
    with image:
        for plane, index in zip(numbers, indices, strict=True):
            try:
                image.seek(index)
            except (SyntaxError, KeyError, ValueError):
                return None
            decoded = np.asarray(image)
            if decoded.shape != plane.shape:
                raise ValueError("a page does not have its declared size")
            if decoded.dtype != plane.dtype:
                return None
            plane[...] = decoded
    return numbers


ENDINGS = (".tif", ".tiff")
_LISTED = re.compile(
    r"\bwavelengths?(?:_nm)?\s{0,4}[=:]\s{0,4}[\[{(]([^\]})]{1,100000})[\]})]", re.I
)
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?")
_MOST_PAGES = 20_000
_UNCOMPRESSED = 1
_GDAL_METADATA = 42112
_LARGEST_METADATA = 4 * 2**20

logging.getLogger("tifffile").addHandler(logging.NullHandler())  # errors are raised here


def tiff_cube(path: Path, shape: tuple[int, int] | None) -> Found:
    """The bands of a TIFF: its pages, or the samples of its only page.

    Uncompressed data are read in place.

    Raises
    ------
    InputError
        If the pages differ in size or type, or parts of the file are missing.
    """
    with opened_tiff(path) as file:
        pages = whole_pages(path, file)
        _refuse_unlike(path, pages)
        texts = [str(getattr(page, "description", "")) for page in pages]
        pixels, notes = _pixels(path, pages)
        tag = pages[0].tags.get(_GDAL_METADATA)
        facts = _of_gdal(path, str(tag.value)) if tag is not None else {}
    refuse_other_shape(path, pixels, shape)
    bands = pixels.shape[2]
    return Found(
        pixels=pixels,
        wavelengths=_wavelengths(path, texts, bands) or _gdal_wavelengths(path, facts, bands),
        scale=lambda: _gdal_scale(path, facts),
        description=" ".join(texts)[:100_000],
        notes=notes,
    )


@contextmanager
def opened_tiff(path: Path) -> Iterator[Any]:
    """A file of tifffile, whose errors become an `InputError`."""
    import tifffile

    with reading(path, "TIFF"), tifffile.TiffFile(path) as file:
        yield file


def whole_pages(path: Path, file: Any, most: int = _MOST_PAGES) -> list[Any]:
    """The pages without thumbnails and masks; ``page.index`` is their place in the file."""
    if len(file.pages) > most:
        raise has(path, f"must hold at most {most} pages", len(file.pages), "holds")
    pages = [page.aspage() for page in file.pages]
    whole = [page for page in pages if not page.is_reduced]
    if not whole:
        raise refused(path, "must hold pages", found="holds none")
    return whole


def _refuse_unlike(path: Path, pages: list[Any]) -> None:
    first = pages[0]
    for i, page in enumerate(pages):
        if page.dtype is None:
            raise refused(
                path, "must hold plain numbers", found="holds none", where=f"page {i} (from 0)"
            )
        refuse_not_numbers(path, f"page {i}", np.dtype(page.dtype))
        if (page.shape, page.dtype) != (first.shape, first.dtype):
            need = f"must be {by(first.shape)} {first.dtype} as page 0"
            found = f"is {by(page.shape)} {page.dtype}"
            where = f"page {i} (from 0)"
            remedy = "save all pages alike"
            raise refused(
                path, need, (*page.shape, str(page.dtype)), found, where=where, remedy=remedy
            )
        refuse_incomplete(path, i, page)


def refuse_incomplete(path: Path, i: int, page: Any) -> None:
    """Raise an error if strips are missing, for which the library returns zeros."""
    size = path.stat().st_size
    places = (*page.dataoffsets, *page.databytecounts)
    if not all(isinstance(place, int) for place in places):
        need = "must declare where its numbers are"
        raise refused(path, need, where=f"page {i} (from 0)", remedy="save it again")
    ends = [at + n for at, n in zip(page.dataoffsets, page.databytecounts, strict=True)]
    if not ends or min(page.dataoffsets) <= 0 or min(page.databytecounts) <= 0 or max(ends) > size:
        need = "must be complete"
        found = "the file is truncated or was never finished"
        raise refused(path, need, found=found, where=f"page {i} (from 0)", remedy="save it again")


def _pixels(
    path: Path, pages: list[Any]
) -> tuple[Shaped[Array, "h w m"] | RowSource, tuple[str, ...]]:
    first = pages[0]
    many = len(pages) > 1
    if many and len(first.shape) == 2:
        notes = ("pages taken as bands",)
        if all(is_plain(page) for page in pages):
            return PlaneRows(planes=tuple(_in_place(path, page) for page in pages)), notes
        return decoded_pages(path, pages).transpose(1, 2, 0), notes
    if many or len(first.shape) != 3 or first.axes not in ("YXS", "SYX"):
        need = "must have one page per band, or one page of many samples"
        found = f"has {len(pages)} pages of {by(first.shape)}"
        remedy = ("save it in that form", "save it as ENVI")
        raise refused(path, need, (len(pages), *first.shape), found, remedy=remedy)
    order = tuple(first.axes.index(axis) for axis in "YXS")
    notes = ("samples of the page taken as bands",)
    if is_plain(first):
        return _in_place(path, first, order), notes
    return decoded_pages(path, pages)[0].transpose(order), notes


def is_plain(page: Any) -> bool:
    """Whether the numbers are uncompressed and contiguous."""
    expected = math.prod(page.shape) * np.dtype(page.dtype).itemsize
    offsets, counts = page.dataoffsets, page.databytecounts
    joined = all(a + n == b for a, n, b in zip(offsets[:-1], counts[:-1], offsets[1:], strict=True))
    whole_bytes = page.bitspersample == np.dtype(page.dtype).itemsize * 8
    return bool(
        page.compression == _UNCOMPRESSED
        and page.predictor == 1
        and page.fillorder == 1
        and not page.is_tiled
        and not page.is_subsampled
        and whole_bytes
        and joined
        and sum(counts) == expected
    )


def _in_place(path: Path, page: Any, axes: tuple[int, ...] = (0, 1, 2)) -> FileRows:
    stored = np.dtype(page.dtype).newbyteorder(page.parent.byteorder)
    sizes = [int(n) for n in (*page.shape, 1)]  # a page without samples is one band
    return packed_rows(path, page.dataoffsets[0], stored, sizes[:3], axes)


def _wavelengths(path: Path, texts: list[str], bands: int) -> Wavelengths | None:
    """The wavelengths from the description of the first page, or one from that of each page."""
    listed = _listed(path, texts[0])
    if listed is not None:
        name, values = listed
        return lambda: nanometers(path, name, values, "")
    return _described(texts, "pages") if len(texts) == bands else None


def _described(texts: list[str], what: str) -> Wavelengths | None:
    """One wavelength from each text; None if a text has none."""
    found = named_wavelengths([text[:10_000] for text in texts])
    if found is None:
        return None
    return lambda: (found, (f"wavelengths taken from the descriptions of the {what}",))


def _of_gdal(path: Path, text: str) -> dict[tuple[str, int | None], str]:
    """The items of GDAL's tag by name or role, and by band; ``None`` means all bands.

    Notes
    -----
    GDAL, "GTiff -- GeoTIFF File Format", metadata: XML with ``<Item name sample role>``, where
    ``sample`` counts bands from 0, and the roles are description, scale, offset and unittype.
    """
    if len(text) > _LARGEST_METADATA:
        return {}
    found: dict[tuple[str, int | None], str] = {}
    for item in xml_root(text.strip().rstrip("\0"), str(path)).iter("Item"):
        sample = item.get("sample", "")
        band = int(sample) if re.fullmatch(r"\d{1,6}", sample) else None
        name = (item.get("role") or item.get("name") or "").lower().replace(" ", "_")
        found.setdefault((name, band), (item.text or "").strip())
    return found


def _gdal_wavelengths(
    path: Path, facts: dict[tuple[str, int | None], str], bands: int
) -> Wavelengths | None:
    """The wavelengths of GDAL's tag: one per band, one list, or those in the descriptions."""
    for name in dict.fromkeys(name for name, _ in facts if name in SPECTRAL_NAMES):
        cells = [facts.get((name, band), "") for band in range(bands)]
        if not all(cells):
            cells = re.findall(r"[^\s,;{}\[\]]+", facts.get((name, None), ""))
        listed = _numbers(name, cells)
        if listed is None:
            continue
        keys = [
            (key, band) for key in ("wavelength_units", "wavelength_unit") for band in (0, None)
        ]
        unit = next((facts[key] for key in keys if key in facts), "")
        return lambda: nanometers(
            path, name, listed[1], unit, unit_key="wavelength_units in GDAL_METADATA"
        )
    return _described([facts.get(("description", band), "") for band in range(bands)], "bands")


def _gdal_scale(path: Path, facts: dict[tuple[str, int | None], str]) -> float | None:
    """Reflectance per stored unit of GDAL's tag; None if it is 1 or not declared."""
    offsets = [text for (name, _), text in facts.items() if name == "offset"]
    scales = [text for (name, _), text in facts.items() if name == "scale"]
    numbers, shifts = (
        [float(text) if _NUMBER.fullmatch(text) else math.nan for text in texts]
        for texts in (scales, offsets)
    )
    if any(shift != 0 for shift in shifts) or len(set(numbers)) > 1:
        need = "must have one scale for all bands, and no offsets"
        where = "tag GDAL_METADATA"
        remedy = ("apply them and save the cube again", Setting("scale"))
        raise refused(
            path, need, (sorted(set(scales)), sorted(set(offsets))), where=where, remedy=remedy
        )
    if not numbers or numbers[0] == 1:
        return None
    if not (numbers[0] > 0 and math.isfinite(1 / numbers[0])):
        need = "must be > 0"
        where = "scale in tag GDAL_METADATA"
        raise refused(path, need, scales[0], where=where, remedy=("correct it", Setting("scale")))
    return numbers[0]


def _listed(path: Path, text: str) -> tuple[str, Array] | None:
    """A list called wavelength, as JSON or as ``wavelength = {400, 410}``."""
    try:
        data = json_of(text, str(path), any_number=True)
    except InputError:
        data = None
    if isinstance(data, dict):
        for key in data:
            if key.lower() in SPECTRAL_NAMES:
                return _numbers(key, data[key])
    match = _LISTED.search(text)
    return None if match is None else _numbers("wavelength", match[1].replace(",", " ").split())


def _numbers(name: str, values: Any) -> tuple[str, Array] | None:
    try:
        numbers = np.array([float(v) for v in values])
    except (TypeError, ValueError):
        return None
    return (name, numbers) if numbers.size else None
