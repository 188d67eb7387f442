"""Relations that the values of an EMVA 1288 data sheet must satisfy."""

from collections.abc import Callable, Mapping
from math import sqrt

from chromanoise.sensor.noise_profile import ROUNDING_DN2

_TOLERANCE = 0.05  # values of a sheet are rounded, and are measured separately


def contradictions(values: Mapping[str, float], source: str) -> tuple[str, ...]:
    """The relations between values of a sheet that do not hold, one sentence each.

    Parameters
    ----------
    values
        The values, by the keys of `chromanoise.io.pixels.emva`; electrons, photons, DN/e-, ratios.
    source
        The name of the sheet.

    Notes
    -----
    EMVA Standard 1288, Release 4.0 Linear (2021), chapter 2: SNR_max^2 = u_e.sat, DR = u_e.sat /
    u_e.min, u_e.min = sqrt(sigma_d^2 + 1/(12 K^2)) + 1/2, electrons = QE photons.

    Examples
    --------
    >>> contradictions({"saturation": 10_000.0, "snr_max": 50.0}, "a sheet")
    ('a sheet: SNR_max^2 = 2500, but u_e.sat [e-] gives 1e+04; one is wrong',)
    """
    n = dict(values)
    if "snr_max" in n:
        n["snr_max"] **= 2
    notes = []
    for (stated, *needs), what, other, expected in _LAWS:
        if n.keys() >= {stated, *needs} and not alike(n[stated], expected(n)):
            found = f"{what} = {n[stated]:.4g}, but {other} gives {expected(n):.4g}"
            notes.append(f"{source}: {found}; one is wrong")
    codes = 2 ** n["bits"] - 1 if 8 <= n.get("bits", 0) <= 16 else 0.0
    top = n.get("gain", 0.0) * n.get("saturation", 0.0) + n.get("black", 0.0)
    if codes and top > (1 + _TOLERANCE) * codes:
        notes.append(
            f"{source}: the full well gives code {top:.4g}, above the top code {codes:.0f}; gain, "
            "full well and bits are probably from different camera modes"
        )
    return tuple(notes)


def _threshold_e(n: Mapping[str, float]) -> float:
    return sqrt(n["read_noise"] ** 2 + ROUNDING_DN2 / n["gain"] ** 2) + 0.5


_Law = tuple[tuple[str, ...], str, str, Callable[[Mapping[str, float]], float]]
_LAWS: tuple[_Law, ...] = (  # needed values, of which the first is stated; what gives it
    (("snr_max", "saturation"), "SNR_max^2", "u_e.sat [e-]", lambda n: n["saturation"]),
    (
        ("dynamic_range", "saturation", "threshold"),
        "DR",
        "u_e.sat / u_e.min",
        lambda n: n["saturation"] / max(n["threshold"], 1e-300),
    ),
    (
        ("dynamic_range", "saturation", "read_noise", "gain"),
        "DR",
        "u_e.sat over the threshold of sigma_d",
        lambda n: n["saturation"] / _threshold_e(n),
    ),
    (
        ("threshold", "read_noise", "gain"),
        "u_e.min [e-]",
        "sqrt(sigma_d^2 + 1/(12 K^2)) + 1/2",
        _threshold_e,
    ),
    (
        ("dark_noise", "read_noise", "gain"),
        "sigma_y.dark [e-]",
        "sqrt(sigma_d^2 + 1/(12 K^2))",
        lambda n: sqrt(n["read_noise"] ** 2 + ROUNDING_DN2 / n["gain"] ** 2),
    ),
    (
        ("saturation", "photons_full", "qe"),
        "u_e.sat [e-]",
        "QE u_p.sat",
        lambda n: n["qe"] * n["photons_full"],
    ),
    (
        ("threshold", "photons_threshold", "qe"),
        "u_e.min [e-]",
        "QE u_p.min",
        lambda n: n["qe"] * n["photons_threshold"],
    ),
)


def alike(a: float, b: float) -> bool:
    """Whether two values of a sheet agree, within 5 % of the larger."""
    return abs(a - b) <= _TOLERANCE * max(abs(a), abs(b))
