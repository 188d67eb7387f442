"""Curves for a purpose: quantum efficiencies per photon, or power; no question left open."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from chromanoise import _check
from chromanoise.spectra.curves import Spectra
from chromanoise.spectra.files.defects import defects_of_a_light, looks_normalized
from chromanoise.spectra.files.understood import Answers, Understood
from chromanoise.units import photons_per_joule

_ELEMENTARY_CHARGE_C = 1.602176634e-19


def qe_of(told: Understood, answers: Answers) -> Spectra:
    """The curves as electrons per photon; what had to be taken for granted is in the notes.

    Parameters
    ----------
    told
        What was understood of the file.
    answers
        What its user said; ``peak_qe`` gives relative curves their height.

    Raises
    ------
    InputError
        If the file holds something else, or a question must be answered first.

    Notes
    -----
    A response S per energy is S h c / lambda per photon; one in A/W is divided by the elementary
    charge e: QE = S h c / (e lambda).

    Examples
    --------
    >>> curves = Spectra(wavelength_nm=np.array([400.0, 800.0]), values=np.array([[.5], [1.0]]),
    ...                  names=("mono",), quantity="response", unit="1", source="a sheet")
    >>> told = Understood(
    ...     curves=curves, format="text", delimiter="", decimal="", wavelength_unit="nm",
    ...     scale="as written", factor=1.0, step_nm=400.0, gaps_nm=(), merged=0,
    ...     quantity="response", level="relative", per="energy", deviations=None, notes=(),
    ...     defects=(), questions=())
    >>> qe_of(told, Answers(peak_qe=0.6)).values.ravel()    # the same per photon at both
    array([0.6, 0.6])
    """
    source = told.curves.source
    if told.quantity in ("reflectance", "transmittance", "power"):
        raise _check.InputError(
            f"{source}: holds {told.quantity}, but a sensor needs quantum efficiencies"
        )
    _refuse_unsaid(told, answers)
    curves, notes = told.curves, _said(told)
    if told.per == "energy":
        per_photon = 1.0 / photons_per_joule(curves.wavelength_nm)[:, None] / _ELEMENTARY_CHARGE_C
        curves = replace(curves, values=curves.values * per_photon)
        notes = (*notes, "counted per energy: divided by the photons in it")
    relative = told.level == "relative"
    if relative or (told.level is None and looks_normalized(told.curves)):
        curves, notes = _with_height(curves, answers, notes, relative)
    elif told.level is None:
        why = "a table headed wavelength_nm" if told.quantity is None else "QE by its own words"
        notes = (*notes, f"{_name(told)}: {why}, taken as absolute QE per photon")
    return replace(curves, quantity="QE", unit="e-/photon", notes=(*curves.notes, *notes))


def _refuse_unsaid(told: Understood, answers: Answers) -> None:
    """Ask, in one sentence, for all that no sensor's curves can be used without."""
    if told.quantity is None and told.own_form:
        return  # the documented table of absolute QE
    asked = []
    if told.per is None:
        asked.append(("its response may be per energy or per photon", "--energy or --photons"))
    if told.level is None and told.quantity != "QE" and answers.peak_qe is None:
        if looks_normalized(told.curves):
            asked.append(
                (
                    "its highest value is exactly 1 or 100; which QE is the highest?",
                    "--peak-qe, or --absolute if the curves are as high as they are",
                )
            )
        else:
            asked.append(
                (
                    "it does not say whether its heights are absolute or relative",
                    "--absolute or --relative",
                )
            )
    if asked:
        why, options = ("; ".join(parts) for parts in zip(*asked, strict=True))
        raise _asked(told.curves.source, why, options.replace("; ", ", and "))


def _with_height(
    curves: Spectra, answers: Answers, notes: tuple[str, ...], relative: bool
) -> tuple[Spectra, tuple[str, ...]]:
    highest = float(curves.values.max())
    if answers.peak_qe is None:
        why = "its curves are relative" if relative else "its highest value is exactly 1 or 100"
        option = "--peak-qe" if relative else "--peak-qe, or --absolute if they are QE as they are"
        raise _asked(curves.source, f"{why}; which QE is the highest?", option)
    if highest <= 0:
        raise _check.InputError(f"{curves.source}: its curves are nowhere above 0")
    told = f"relative curves, scaled to a highest QE of {answers.peak_qe:g}"
    return replace(curves, values=curves.values * (answers.peak_qe / highest)), (*notes, told)


def power_of(told: Understood) -> Spectra:
    """One curve of relative power over wavelength, as `illuminant_from` wants it.

    Raises
    ------
    InputError
        If it is not one curve, or not known whether light was counted as energy or in photons.
    """
    curves = told.curves
    if len(curves.names) != 1:
        raise _asked(
            curves.source,
            f"holds {len(curves.names)} curves: {', '.join(curves.names[:8])}; which is the light?",
            "--illuminant-column",
        )
    if told.per is None:
        raise _asked(
            curves.source,
            "does not say whether it counts light as energy or in photons",
            "--illuminant-energy or --illuminant-photons",
        )
    notes = _said(replace(told, defects=defects_of_a_light(told.defects)))
    if told.per == "photon":
        curves = power_of_photons(curves)
    return replace(curves, quantity="power", unit="relative", notes=(*curves.notes, *notes))


def power_of_photons(curves: Spectra) -> Spectra:
    """Curves that count photons as relative power, straight lines of photons kept as they are.

    Parameters
    ----------
    curves
        Relative photons per wavelength. They are taken at every nanometer before they are
        multiplied by the energy of a photon: what is straight in photons is bent in power.

    Notes
    -----
    A photon has the energy h c / lambda; that at the shortest wavelength is 1 here.

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


def _said(told: Understood) -> tuple[str, ...]:
    """Notes and defects, each with the name of the file."""
    return tuple(f"{_name(told)}: {text}" for text in (*told.notes, *told.defects))


def _name(told: Understood) -> str:
    return Path(told.curves.source).name


def _asked(source: str, why: str, option: str) -> _check.InputError:
    return _check.InputError(f"{source}: {why}; say {option}")
