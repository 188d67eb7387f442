"""Detect defects of curves from their numbers."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from chromanoise.io.spectra.merging import Sorted, gaps_nm
from chromanoise.io.spectra.parsed import SENSITIVE_NM, Level, Quantity
from chromanoise.spectra.curves import Spectra

_CHART_PATCHES = 24
_PUBLISHED_WHITE = 0.881
_VISIBLE_NM = (500.0, 650.0)
_RATIOS = ("QE", "reflectance", "transmittance")


_RELATIVE = "the curves look relative"


def defects_of(
    curves: Spectra,
    quantity: Quantity | None,
    scale: Literal["fraction", "percent", "as written"],
    points: Sequence[Sorted],
    *,
    level: Level | None,
) -> tuple[str, ...]:
    """One sentence per kind of defect: sign, height, order of channels, gaps.

    Only wavelengths of 400-1050 nm are checked, because no others are used, unless the file has
    fewer than two of these.

    Notes
    -----
    The white of a ColorChecker reflects 0.881: L* 95.19 for D50 (X-Rite, charts made since
    November 2014), and Y = ((L* + 16) / 116)^3.
    """
    curves = judged(curves)
    return (
        *_conflicts(points),
        *_out_of_range(curves, quantity, scale),
        *_outliers(curves, quantity),
        *(_normalized(curves) if level is None else ()),
        *_white_below_green(curves),
        *_dark_white_patch(curves, quantity),
        *_guard_values(curves),
        *_rounded_wavelengths(curves),
        *_gaps(points),
    )


def judged(curves: Spectra) -> Spectra:
    """The curves at 400-1050 nm, where sensors use them; all if fewer than two points are there.

    Examples
    --------
    >>> curves = Spectra(wavelength_nm=np.array([350.0, 400.0, 500.0]), unit="1", source="s",
    ...                  values=np.array([[-9.0], [0.1], [0.2]]), names=("a",), quantity="QE")
    >>> judged(curves).values.ravel()
    array([0.1, 0.2])
    """
    at = curves.wavelength_nm
    here = (at >= SENSITIVE_NM[0]) & (at <= SENSITIVE_NM[1])
    if np.count_nonzero(here) < 2:
        return curves
    return replace(curves, wavelength_nm=at[here], values=curves.values[here])


def defects_of_a_light(defects: tuple[str, ...]) -> tuple[str, ...]:
    """The defects that matter for a light, whose values are always relative.

    Examples
    --------
    >>> defects_of_a_light(("the highest value is exactly 1: the curves look relative", "2 gaps"))
    ('2 gaps',)
    """
    return tuple(defect for defect in defects if not defect.endswith(_RELATIVE))


def looks_normalized(curves: Spectra) -> bool:
    """Whether the highest value is exactly one, as in curves normalized to their maximum.

    Examples
    --------
    >>> looks_normalized(Spectra(wavelength_nm=np.array([400.0, 500.0]), unit="1", source="s",
    ...                          values=np.array([[0.2], [1.0]]), names=("a",), quantity="QE"))
    True
    """
    return float(curves.values.max()) in (1.0, 100.0)


def _conflicts(points: Sequence[Sorted]) -> Iterator[str]:
    wrong = [point for point in points if point.conflicts_nm]
    if wrong:
        others = f" and of {len(wrong) - 1} more curves" if len(wrong) > 1 else ""
        yield (
            f"different values at the same wavelength, first of {wrong[0].name} at "
            f"{wrong[0].conflicts_nm[0]:g} nm ({len(wrong[0].conflicts_nm)} in all){others}"
        )


def _out_of_range(
    curves: Spectra, quantity: Quantity | None, scale: Literal["fraction", "percent", "as written"]
) -> Iterator[str]:
    negative = curves.values < 0
    if negative.any():
        yield f"{_count(negative)} below 0, {_first(curves, negative)}"
    above = curves.values > 1
    if above.any() and (quantity in _RATIOS or scale == "fraction"):
        yield f"{_count(above)} above 1, {_first(curves, above)}"


def _outliers(curves: Spectra, quantity: Quantity | None) -> Iterator[str]:
    """Values of hundreds among fractions, as in bands that water absorbs."""
    usual = float(np.quantile(curves.values, 0.95))
    wild = curves.values > 100
    if quantity != "power" and usual <= 1.5 and wild.any():
        at = curves.wavelength_nm[wild.any(axis=1)]
        yield (
            f"{_count(wild)} above 100 at {at[0]:g}-{at[-1]:g} nm, but 95 % below {usual:.2g}: "
            "outliers"
        )


def _count(bad: np.ndarray) -> str:
    return f"{int(bad.sum())} of {bad.size} values are"


def _first(curves: Spectra, bad: np.ndarray) -> str:
    row, column = (int(i) for i in np.argwhere(bad)[0])
    value = curves.values[row, column]
    return f"first {value:.6g} of {curves.names[column]} at {curves.wavelength_nm[row]:g} nm"


def _normalized(curves: Spectra) -> Iterator[str]:
    if looks_normalized(curves):
        row, column = np.unravel_index(int(curves.values.argmax()), curves.values.shape)
        yield (
            f"the highest value is exactly {curves.values.max():g} ({curves.names[column]} at "
            f"{curves.wavelength_nm[row]:g} nm): {_RELATIVE}"
        )


def _channel(curves: Spectra, words: str) -> np.ndarray | None:
    """The only curve whose name begins with one of these words, e.g. ``g``, ``G1`` or ``gAR01``."""
    pattern = rf"(?:{words})(?![a-z])"
    here = [i for i, name in enumerate(curves.names) if re.match(pattern, _small_first(name))]
    return curves.values[:, here[0]] if len(here) == 1 else None


def _small_first(name: str) -> str:
    return name.lower() if name.isupper() or name.istitle() else name[:1].lower() + name[1:]


def _white_below_green(curves: Spectra) -> Iterator[str]:
    white, green = _channel(curves, "w|white|clear|pan"), _channel(curves, "g|green")
    if white is None or green is None:
        return
    over = (green > 1.01 * white) & (green > 0.3 * green.max())
    if over.any():
        at = curves.wavelength_nm[over]
        share = float(np.max(green[over] / np.maximum(white[over], 1e-9 * green.max()))) - 1
        yield (
            f"green exceeds white by up to {100 * share:.0f} % at {at[0]:g}-{at[-1]:g} nm "
            f"({at.size} wavelengths): no filter adds light, so they come from different sources"
        )


def _dark_white_patch(curves: Spectra, quantity: Quantity | None) -> Iterator[str]:
    visible = (curves.wavelength_nm >= _VISIBLE_NM[0]) & (curves.wavelength_nm <= _VISIBLE_NM[1])
    if quantity != "reflectance" or len(curves.names) != _CHART_PATCHES or not visible.any():
        return
    levels = curves.values[visible].mean(axis=0)
    brightest = int(levels.argmax())
    off = float(levels[brightest]) / _PUBLISHED_WHITE - 1
    if abs(off) > 0.03:
        side = "below" if off < 0 else "above"
        yield (
            f"24 patches, but the brightest ({curves.names[brightest]}) reflects "
            f"{levels[brightest]:.2f} at 500-650 nm, {abs(100 * off):.0f} % "
            f"{side} the white of a ColorChecker; rescale before comparing"
        )


def _guard_values(curves: Spectra) -> Iterator[str]:
    at = curves.wavelength_nm
    usual = float(np.median(np.diff(at)))
    for end, beside in ((0, 1), (-1, -2)):
        step = abs(float(at[beside] - at[end]))
        if step > 1.5 * usual and not curves.values[end].any() and curves.values[beside].any():
            yield f"a lone 0 at {at[end]:g} nm, {step:g} nm from its neighbor, looks like a guard"


def _rounded_wavelengths(curves: Spectra) -> Iterator[str]:
    at = curves.wavelength_nm
    steps = np.unique(np.diff(at))
    whole = bool((at == np.round(at)).all())
    if whole and at.size > 10 and steps.size == 2 and steps[1] - steps[0] == 1 and steps[0] > 1:
        mean = float((at[-1] - at[0]) / (at.size - 1))
        steps_text = f"{steps[0]:g} and {steps[1]:g} for {mean:.2f}"
        yield f"wavelengths look rounded to whole nm: steps of {steps_text}"


def _gaps(points: Sequence[Sorted]) -> Iterator[str]:
    """One sentence for all gaps within the wavelengths that sensors use."""
    gaps = sorted(
        {
            (start, stop)
            for point in points
            for start, stop in gaps_nm(point.wavelength_nm)
            if stop > SENSITIVE_NM[0] and start < SENSITIVE_NM[1]
        },
        key=lambda gap: (gap[0] - gap[1], gap[0]),
    )
    if not gaps:
        return
    start, stop = gaps[0]
    what = f"a gap from {start:g} to {stop:g} nm"
    if len(gaps) > 1:
        what = f"{len(gaps)} gaps, the widest from {start:g} to {stop:g} nm"
    yield f"{what}: linear interpolation is uncertain there"
