"""Convert parsed curves to QE per photon or to power, once all questions are answered."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from chromanoise.errors import InputError
from chromanoise.io.spectra.defects import defects_of_a_light, looks_normalized
from chromanoise.io.spectra.parsed import Answers, ParsedSpectra, Question
from chromanoise.io.spectra.questions import (
    UndeclaredError,
    light_questions,
    scale_questions,
    sensor_questions,
)
from chromanoise.spectra.curves import Spectra
from chromanoise.units import photons_per_joule

_ELEMENTARY_CHARGE_C = 1.602176634e-19


def qe_of(parsed: ParsedSpectra, answers: Answers) -> Spectra:
    """Convert curves to electrons per photon; the notes list assumptions.

    Parameters
    ----------
    parsed
        The parsed file.
    answers
        The answers of the user; ``peak_qe`` scales relative curves.

    Raises
    ------
    InputError
        If the file contains another quantity.
    UndeclaredError
        If questions must be answered first; ``remedy`` holds the settings.

    Notes
    -----
    A response S per energy equals S h c / lambda per photon. A response in A/W is also divided by
    the elementary charge e: QE = S h c / (e lambda).

    Examples
    --------
    >>> curves = Spectra(wavelength_nm=np.array([400.0, 800.0]), values=np.array([[.5], [1.0]]),
    ...                  names=("mono",), quantity="response", unit="1", source="a sheet")
    >>> parsed = ParsedSpectra(
    ...     curves=curves, format="text", wavelength_unit="nm", scale="as written",
    ...     quantity="response", level="relative", per="energy")
    >>> qe_of(parsed, Answers(peak_qe=0.6)).values.ravel()  # equal per photon at both
    array([0.6, 0.6])
    """
    source = parsed.curves.source
    if parsed.quantity in ("reflectance", "transmittance", "power"):
        raise InputError(
            source,
            "must hold quantum efficiencies or responses, for a sensor",
            value=parsed.quantity,
            found=f"holds {parsed.quantity}",
        )
    asked = tuple(sensor_questions(parsed, answers))
    _refuse_open(parsed, (*scale_questions(parsed, answers), *asked) if asked else ())
    curves, notes = parsed.curves, _said(parsed)
    if parsed.per == "energy":
        per_photon = 1.0 / photons_per_joule(curves.wavelength_nm)[:, None] / _ELEMENTARY_CHARGE_C
        curves = replace(curves, values=curves.values * per_photon)
        notes = (*notes, "counted per energy: divided by the photons in it")
    if parsed.level == "relative" or (parsed.level is None and looks_normalized(parsed.curves)):
        highest = float(curves.values.max())
        assert answers.peak_qe is not None  # asked for by `sensor_questions`
        if highest <= 0:
            need = "must have a value above 0"
            raise InputError(curves.source, need, value=highest, found="all are 0 or less")
        curves = replace(curves, values=curves.values * (answers.peak_qe / highest))
        notes = (*notes, f"relative curves, scaled to a highest QE of {answers.peak_qe:g}")
    elif parsed.level is None:
        why = "a table headed wavelength_nm" if parsed.quantity is None else "the file declares QE"
        notes = (*notes, f"{_name(parsed)}: {why}, taken as absolute QE per photon")
    return replace(curves, quantity="QE", unit="e-/photon", notes=(*curves.notes, *notes))


def _refuse_open(parsed: ParsedSpectra, questions: Iterable[Question]) -> None:
    """Raise an error if there are open questions; its message lists all of them."""
    open_questions = tuple(questions)
    if open_questions:
        raise UndeclaredError(parsed.curves.source, open_questions)


def power_of(parsed: ParsedSpectra) -> Spectra:
    """Convert one curve to relative power over wavelength, for `illuminant_from`.

    Parameters
    ----------
    parsed
        The parsed file.

    Raises
    ------
    InputError
        If the light is given per wavenumber.
    UndeclaredError
        If the file has several curves, or does not declare whether light is counted as energy or in
        photons; ``remedy`` holds the settings.
    """
    curves = parsed.curves
    _refuse_open(parsed, light_questions(parsed))
    if parsed.wavelength_unit == "1/cm":
        raise InputError(
            curves.source,
            "must give light per wavelength",
            value=parsed.wavelength_unit,
            found="gives it per wavenumber in 1/cm, which is not a constant number of nm",
            remedy="convert it to light per nm",
        )
    notes = _said(replace(parsed, defects=defects_of_a_light(parsed.defects)))
    if parsed.per == "photon":
        curves = power_of_photons(curves)
    return replace(curves, quantity="power", unit="relative", notes=(*curves.notes, *notes))


def power_of_photons(curves: Spectra) -> Spectra:
    """Convert curves of photons to relative power, with linear interpolation in photons.

    Parameters
    ----------
    curves
        Relative photons per wavelength. They are interpolated to every nanometer before they are
        multiplied by the photon energy, because a line in photons is not a line in power.

    Notes
    -----
    A photon has the energy h c / lambda, here normalized to 1 at the shortest wavelength.

    Examples
    --------
    >>> flat = Spectra(wavelength_nm=np.array([400.0, 800.0]), values=np.ones((2, 1)),
    ...                names=("lamp",), quantity="power", unit="1", source="a lamp")
    >>> power = power_of_photons(flat)
    >>> float(power.values[power.wavelength_nm == 500, 0].round(12)[0])       # 400/500
    0.8
    """
    known = curves.wavelength_nm
    at = np.union1d(known, np.arange(np.ceil(known[0]), known[-1]))
    photons = np.stack([np.interp(at, known, curve) for curve in curves.values.T], axis=1)
    energy = 1.0 / photons_per_joule(at)[:, None]
    return replace(
        curves,
        wavelength_nm=at,
        values=photons * energy / energy.max(),
        quantity="power",
        unit="relative",
        notes=(*curves.notes, f"{curves.source}: counted in photons, multiplied by their energy"),
    )


def _said(parsed: ParsedSpectra) -> tuple[str, ...]:
    """Notes and defects, each prefixed with the name of the file."""
    return tuple(f"{_name(parsed)}: {text}" for text in (*parsed.notes, *parsed.defects))


def _name(parsed: ParsedSpectra) -> str:
    return Path(parsed.curves.source).name
