"""The same two curves in every format, as the tools of each write them."""

import io
import json

import numpy as np
from scipy.io import savemat

AT_NM = np.array([400.0, 500.0, 600.0, 700.0])
RED = np.array([0.0125, 0.05, 0.45, 0.3])
GREEN = np.array([0.02, 0.4375, 0.125, 0.0625])


def _rows() -> list[tuple[float, float, float]]:
    return [(float(w), float(r), float(g)) for w, r, g in zip(AT_NM, RED, GREEN, strict=True)]


def csv_text() -> str:
    rows = [f"{w:g},{r!r},{g!r}" for w, r, g in _rows()]
    return "\n".join(["# a bench", "Wavelength [nm],R,G", *rows]) + "\n"


def german_text() -> str:
    rows = [f"{w / 1000:g};{100 * r:g};{100 * g:g}".replace(".", ",") for w, r, g in _rows()]
    return "\ufeff" + "\r\n".join(["Wellenlänge [µm];R (%);G (%)", *rows]) + "\r\n"


def digitized_text() -> str:
    # each list in an order of its own, and the first point of R twice
    rows = ["R,,G,", "X,Y,X,Y", "400,0.0125,700,0.0625", "700,0.3,600,0.125", "500,0.05,400,0.02"]
    return "\n".join([*rows, "600,0.45,500,0.4375", "400,0.0125,,"]) + "\n"


def isetcam_bytes(compressed: bool = True) -> bytes:
    names = np.empty((1, 2), dtype=object)
    names[0, 0], names[0, 1] = "R", "G"
    file = io.BytesIO()
    arrays = {
        "wavelength": AT_NM.astype(np.uint16)[None],
        "data": np.stack([RED, GREEN], axis=1),
        "filterNames": names,
        "comment": "a bench",
        "units": "photons",
    }
    savemat(file, arrays, do_compression=compressed)
    return file.getvalue()


def rawtoaces_text() -> str:
    main = {f"{w:g}": [r, g] for w, r, g in _rows()}
    spectral = {"units": "relative", "index": {"main": ["R", "G"]}, "data": {"main": main}}
    header = {"schema_version": "1.0.0", "manufacturer": "nobody", "model": None}
    return json.dumps({"header": header, "spectral_data": spectral}, indent=1)


def cgats_text() -> str:
    head = [
        "SPECT",
        'DESCRIPTOR "two filters"',
        'KEYWORD "MEAS_TYPE"',
        'MEAS_TYPE "TRANSMISSIVE"',
        'SPECTRAL_BANDS "4"',
        'SPECTRAL_START_NM "400.0"',
        'SPECTRAL_END_NM "700.0"',
        'SPECTRAL_NORM "50.0"',
        "NUMBER_OF_FIELDS 5",
        "BEGIN_DATA_FORMAT",
        "SAMPLE_ID SPEC_400 SPEC_500 SPEC_600 SPEC_700",
        "END_DATA_FORMAT",
        "NUMBER_OF_SETS 2",
        "BEGIN_DATA",
    ]
    sets = [" ".join([n, *(f"{50 * v:.4f}" for v in c)]) for n, c in (("R", RED), ("G", GREEN))]
    return "\n".join([*head, *sets, "END_DATA"]) + "\n"


def tm27_text(quantity: str = "transmittance") -> str:
    points = "".join(
        f'<SpectralData wavelength="{w:.1f}">{r!r}</SpectralData>\n' for w, r, _ in _rows()
    )
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n<IESTM2714 xmlns="iestm2714" version="1.0">\n'
        "<Header><Description>R</Description></Header>\n<SpectralDistribution>"
        f"<SpectralQuantity>{quantity}</SpectralQuantity>\n{points}"
        "</SpectralDistribution></IESTM2714>"
    )


def workbook_bytes() -> bytes:
    from openpyxl import Workbook

    book = Workbook()
    sheet = book.active
    sheet.append(["QE of a bench"])
    sheet.append(["Wavelength (nm)", "R", "G"])
    for row in _rows():
        sheet.append(list(row))
    file = io.BytesIO()
    book.save(file)
    return file.getvalue()


SAMPLES: dict[str, bytes] = {
    "bench.csv": csv_text().encode(),
    "german.csv": german_text().encode(),
    "digitized.csv": digitized_text().encode(),
    "plain.mat": isetcam_bytes(compressed=False),
    "packed.mat": isetcam_bytes(),
    "camera.json": rawtoaces_text().encode(),
    "argyll.sp": cgats_text().encode(),
    "lamp.spdx": tm27_text().encode(),
    "book.xlsx": workbook_bytes(),
}
