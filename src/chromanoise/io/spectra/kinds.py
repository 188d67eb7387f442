"""Recognize files that are not spectra by their first bytes."""

_EXPORT = "export the curves as CSV"
_AVASOFT = "export it as ASCII in AvaSoft"
_KINDS: tuple[tuple[bytes, str, str], ...] = (
    (b"\x89PNG\r\n\x1a\n", "a PNG picture", "digitize its curves, and save them as CSV"),
    (b"\xff\xd8\xff", "a JPEG picture", "digitize its curves, and save them as CSV"),
    (b"GIF8", "a GIF picture", "digitize its curves, and save them as CSV"),
    (b"II*\0", "a TIFF picture", "digitize its curves, and save them as CSV"),
    (b"MM\0*", "a TIFF picture", "digitize its curves, and save them as CSV"),
    (b"%PDF-", "a PDF document", "copy or digitize its curves, and save them as CSV"),
    (b"{\\rtf", "an RTF document", "save it as plain text"),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an old Office file (.xls)", "save it as .xlsx or CSV"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"BZh", "a bzip2 archive", "unpack it first"),
    (b"\xfd7zXZ\0", "an xz archive", "unpack it first"),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", "unpack it first"),
    (b"SQLite format 3\0", "an SQLite database", _EXPORT),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 or MATLAB 7.3 file", "save it with -v7, or as CSV"),
    (b"CDF\x01", "a NetCDF file", _EXPORT),
    (b"CDF\x02", "a NetCDF file", _EXPORT),
    (b"\x93NUMPY", "a NumPy array (.npy)", "write wavelengths and values with numpy.savetxt"),
    (b"PAR1", "a Parquet file", _EXPORT),
    (b"\x80\x04\x95", "a Python pickle", _EXPORT),
    (b"AVS8", "a binary file of AvaSoft 8 (Avantes)", _AVASOFT),
    (b"\0\0\x8cB", "a binary file of AvaSoft 7 (Avantes)", _AVASOFT),
    (b"\0\0pB", "a binary file of AvaSoft 6 (Avantes)", _AVASOFT),
    (b"\n\n\xfe\xfe", "a Bruker OPUS file", "export it as a data point table"),
    (b"WDF1", "a Renishaw WiRE file", _EXPORT),
    (b"Spectral Data File", "a Thermo OMNIC file (.spa)", _EXPORT),
    (b"\x7fELF", "a program (ELF)", "name a file of curves"),
    (b"MZ", "a program (.exe)", "name a file of curves"),
)
_HTML = (b"<!doctype html", b"<html")
_START = 512


def kind_of(content: bytes) -> tuple[str, str] | None:
    r"""The kind of a file by its first bytes, and a remedy; None if it may be text.

    Examples
    --------
    >>> kind_of(b"\x89PNG\r\n\x1a\n..."), kind_of(b"nm,R\n400,0.1\n")
    (('a PNG picture', 'digitize its curves, and save them as CSV'), None)
    """
    for start, name, remedy in _KINDS:
        if content.startswith(start):
            return name, remedy
    if content[1:2] == b"K" and content[3:4] == b"\x80":
        return "a Thermo Galactic file (.spc)", _EXPORT
    if content[:_START].lstrip().lower().startswith(_HTML):
        return "an HTML page", "download the file that it links to, or save its table as CSV"
    return None


def kind_of_zip(names: list[str]) -> tuple[str, str] | None:
    """The kind of a ZIP archive by the names in it; None for a workbook.

    Examples
    --------
    >>> kind_of_zip(["r.npy"])[0], kind_of_zip(["xl/workbook.xml"])
    ('NumPy arrays (.npz)', None)
    """
    if any(name.startswith("xl/") for name in names):
        return None
    if names and all(name.endswith(".npy") for name in names):
        return "NumPy arrays (.npz)", "write wavelengths and values with numpy.savetxt"
    if any(name.startswith("ps_") and name.endswith(".xml") for name in names):
        return "an Ocean Optics file (.ProcSpec)", "save it as tab-delimited text in SpectraSuite"
    if "content.xml" in names:
        return "an OpenDocument file (.ods)", "save it as .xlsx or CSV"
    if any(name.startswith("word/") for name in names):
        return "a Word document", "save its table as CSV"
    return "a ZIP archive", "unpack it first"
