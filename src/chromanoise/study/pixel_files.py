"""Replace the pixel of a sensor by one from a file: TOML, data sheet, noise profile, table."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

from chromanoise.base import InputError, Setting, first_bytes, from_above, json_of
from chromanoise.io import read_curves, sensor_from_json
from chromanoise.io.pixels import (
    errors_in_file,
    is_noise_profile_text,
    is_photon_transfer_text,
    is_pixel_toml_text,
    read_emva_sheet,
    read_noise_profile,
    read_photon_transfer_csv,
    read_pixel_toml,
    source_text,
)
from chromanoise.io.spectra import ASK, Answers
from chromanoise.sensor import PIXEL, PIXEL_REQUIRED, Converter, PixelSource, Sensor, with_pixel
from chromanoise.study.resolve_names import (
    Curves,
    asked_of_name,
    file_of,
    file_there,
    is_file_word,
    resolve_sensor,
)

_HEAD_BYTES = 200  # of the JSON, which name its schema
_BEFORE_JSON = b"\xef\xbb\xbf \t\r\n"


def read_pixel_source(path: Path | str) -> PixelSource:
    """The pixel data in a file: our TOML, EMVA 1288 sheet, DNG noise profile, photon transfer.

    Parameters
    ----------
    path
        The file. JSON with ``S`` and ``O`` or a line ``NoiseProfile: S O`` is a noise profile, JSON
        of ``chromanoise characterize`` gives `chromanoise.apps.camera.pixel_of`, a
        table headed ``mean_dn,variance_dn2`` is a photon transfer, a text with a line ``schema =``
        or a file ``.toml`` is a pixel in TOML, anything else a data sheet.

    Raises
    ------
    InputError
        As for the reader of each kind, or if the file is from darktable, whose noise profiles
        are relative.
    """
    path = Path(path)
    with errors_in_file(path):
        return _source(path, source_text(path))


def _source(path: Path, text: str) -> PixelSource:
    if path.suffix.lower() == ".toml" or is_pixel_toml_text(text):
        return read_pixel_toml(path)
    if text.lstrip().startswith("{"):
        held = json_of(text, str(path))
        if "noiseprofiles" in held:
            raise InputError(
                str(path),
                "must give electrons to be a pixel",
                found="holds the noise profiles of darktable, which are relative",
                remedy=("give a data sheet or a photon transfer", Setting("read_noise_e")),
            )
        camera = from_above("camera")
        if camera.is_characterization(held):
            return camera.pixel_of(camera.characterization_from_json(held, str(path)))
        return read_noise_profile(path) if {"S", "O"} <= set(held) else read_emva_sheet(path)
    if is_noise_profile_text(text):
        return read_noise_profile(path)
    if is_photon_transfer_text(text):
        from chromanoise.sensor import photon_transfer_fit, pixel_from_photon_transfer

        return pixel_from_photon_transfer(photon_transfer_fit(read_photon_transfer_csv(path)))
    return read_emva_sheet(path)


def own_sensor_of(path: Path) -> Sensor | None:
    """The sensor in a JSON file of the schema ``chromanoise sensor``; ``None`` for other files.

    Raises
    ------
    InputError
        If the file has that schema but another version, or is invalid.
    """
    head = first_bytes(path, _HEAD_BYTES).lstrip(_BEFORE_JSON)
    if not head.startswith(b"{") or b'"chromanoise sensor"' not in head:
        return None
    return sensor_from_json(source_text(path), source=str(path))


def idle_answers(words: Sequence[Curves], answers: Answers) -> tuple[str, ...]:
    """The given answers that none of the sensors needs, as names of fields of `Answers`.

    A file that cannot be read counts as needing all; reading it later raises the error.

    Parameters
    ----------
    words
        Names or files of sensors.
    answers
        Metadata that files may lack.

    Raises
    ------
    InputError
        If the user's folder is invalid.

    Examples
    --------
    >>> idle_answers(["onyx-rgbw"], Answers(peak_qe=0.3, per="energy"))
    ('per', 'peak_qe')
    """
    given = [name for name in _OF_SENSORS if getattr(answers, name) is not None]
    used = {name for word in words for name in (_answers_used_by(word, answers) if given else ())}
    return tuple(name for name in given if name not in used)


_OF_SENSORS = ("scale", "level", "per", "wavelength_unit", "peak_qe")


def _answers_used_by(word: Curves, answers: Answers) -> tuple[str, ...]:
    if isinstance(word, str) and not is_file_word(word, "sensor"):
        return asked_of_name(word)
    try:
        if _own_sensor(word) is not None:
            return ()
        level = read_curves(file_there(word, "sensor"), answers=answers).level
    except InputError:
        return _OF_SENSORS
    return _OF_SENSORS[:-1] if level == "absolute" else _OF_SENSORS


def _own_sensor(word: Curves) -> Sensor | None:
    if not isinstance(word, str) or not is_file_word(word, "sensor"):
        return None
    return own_sensor_of(file_there(word, "sensor"))


def sensor_with_pixel(
    word: Curves | Sensor,
    *,
    answers: Answers = ASK,
    file: str | None = None,
    varied: Collection[str] = (),
    **given: float | None,
) -> Sensor:
    """A sensor from ``resolve_sensor``, from our own JSON or in memory, with the pixel of a file.

    Parameters
    ----------
    word, answers
        As for ``resolve_sensor``, or a sensor, which needs no answers.
    file
        A file for `read_pixel_source`; ``None`` keeps the sensor's pixel.
    varied
        As for `chromanoise.sensor.with_pixel`.
    given
        Fields of `Pixel` and of `Converter`. They override the file, which overrides the sensor's
        pixel; ``None`` does not.

    Raises
    ------
    InputError
        As for ``resolve_sensor`` and `read_pixel_source`, or if the file gives no value.
    """

    def made(changes: Mapping[str, Any]) -> Sensor:
        if isinstance(word, Sensor):
            return with_pixel(word, changes, varied=varied)
        if (own := _own_sensor(word)) is not None:
            return with_pixel(own, changes, varied=varied)
        return resolve_sensor(word, answers=answers, varied=varied, **changes)

    values = {name: value for name, value in given.items() if value is not None}
    if file is None:
        return made(values)
    source = read_pixel_source(file_of(file))
    own = {name: getattr(source, name) for name in PIXEL}
    held = {name: value for name, value in own.items() if value is not None}
    of_file = {**held, **converter_of(source).known}
    if not of_file:
        raise InputError(
            file,
            "must give pitch, full well, read noise or another value of a pixel or its converter",
            value=source.notes,
            found=f"gives none ({'; '.join(source.notes)})",
        )
    try:
        sensor = made({**of_file, **values})
    except InputError as error:
        if error.subject in of_file and error.subject not in values:
            raise error.within(source.source) from None
        raise
    return replace(sensor, notes=(*sensor.notes, *_notes(source, of_file, values)))


def converter_of(source: PixelSource) -> Converter:
    """The known values of the converter, from the file or from its complete converter.

    Raises
    ------
    InputError
        If a value is out of the range of `Converter`.
    """
    adc = source.adc if source.bits is None else None
    try:
        if adc is not None:
            return Converter(**asdict(adc))
        return Converter(**{one.name: getattr(source, one.name) for one in fields(Converter)})
    except InputError as error:
        raise error.within(source.source) from None


def _notes(source: PixelSource, held: Mapping[str, Any], values: Mapping[str, Any]) -> list[str]:
    """Notes that state which values are from the file, given, or unchanged."""
    taken = [name for name in held if name not in values]
    replaced = [name for name in held if name in values]
    silent = [name for name in PIXEL_REQUIRED if name not in held and name not in values]
    notes = [f"{', '.join(taken)} of {source.source}"] if taken else []
    if replaced:
        notes.append(f"{', '.join(replaced)} as given, not of {source.source}")
    if silent:
        notes.append(
            f"{source.source} does not give {', '.join(silent)}: the sensor's own values are used"
        )
    return [*notes, *source.notes]
