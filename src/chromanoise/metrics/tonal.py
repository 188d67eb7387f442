"""Distinguishable levels and colors of a pixel."""

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError


def tonal_levels(
    top_e: Float[Array, "*px"], *, read_noise_e: float, step_e: float = 0.0
) -> Float[Array, "*px"]:
    """Number of distinguishable levels from black to ``top_e``: int dM / sigma(M). [1]

    Parameters
    ----------
    top_e
        The largest signal: full well or the signal of white. [e-]
    read_noise_e
        Standard deviation of the readout. [e-]
    step_e
        Size of one digital number, the least distance of two levels; 0 for none. [e-]

    Raises
    ------
    InputError
        If a number is negative or not finite.

    Notes
    -----
    DxOMark's tonal range: int dM / max(step, sigma(M)), sigma^2 = M + s^2 (eq. 7), which without
    a step is 2 (sqrt(N + s^2) - s). Per pixel; DxOMark's "print" values refer to a picture scaled
    to 8 megapixels.

    Examples
    --------
    >>> round(float(tonal_levels(np.array(10_000.0), read_noise_e=10.0)), 4)
    180.9975
    """
    top = _check.non_negative("top_e", "e-", top_e)
    floor = _check.not_negative("read_noise_e", "e-", read_noise_e) ** 2
    step = _check.not_negative("step_e", "e-", step_e)
    bend = np.clip(step**2 - floor, 0.0, top)  # below it the step is wider than the noise
    sigmas = np.sqrt(top + floor) + np.sqrt(bend + floor)
    above = 2.0 * (top - bend) / np.where(sigmas > 0, sigmas, 1.0)
    return np.asarray(above + (bend / step if step > 0 else 0.0))


def tonal_range_bits(
    top_e: Float[Array, "*px"], *, read_noise_e: float, step_e: float = 0.0
) -> Float[Array, "*px"]:
    """The tonal range, log2 of `tonal_levels`. [bit]

    Parameters
    ----------
    top_e
        Brightest signal. [e-]
    read_noise_e
        Standard deviation of the readout. [e-]
    step_e
        Quantization step; 0 without one. [e-]

    Raises
    ------
    InputError
        As `tonal_levels`, and if ``top_e`` is 0.

    Examples
    --------
    >>> round(float(tonal_range_bits(np.array(10_000.0), read_noise_e=10.0)), 4)
    7.4998
    """
    levels = tonal_levels(top_e, read_noise_e=read_noise_e, step_e=step_e)
    if not (levels > 0).all():
        first = tuple(int(i) for i in np.argwhere(~(levels > 0))[0])
        raise InputError(
            "top_e",
            "must be > 0 [e-] for a tonal range",
            value=0.0,
            found=f"is 0 at index {first} (from 0)",
            remedy="omit that channel",
        )
    return np.asarray(np.log2(levels))


def color_sensitivity_bits(
    top_e: Float[Array, "*px p"], *, read_noise_e: float, step_e: float = 0.0
) -> Float[Array, "*px"]:
    """Number of distinguishable colors, log2 int dM / sqrt(det covariance). [bit]

    The integral covers the box of raw values, 0 .. ``top_e`` per channel. The raw channels are
    independent, so the result is the sum of their tonal ranges. An invertible color matrix scales
    box and covariance equally and does not change the result: this number does not measure how
    accurately a sensor reproduces colors.

    Parameters
    ----------
    top_e
        The largest signal of each channel. [e-]
    read_noise_e, step_e
        As `tonal_levels`.

    Raises
    ------
    InputError
        As `tonal_range_bits`.

    Notes
    -----
    DxOMark's color sensitivity (color depth), per pixel and with every channel in each pixel.

    Examples
    --------
    >>> float(color_sensitivity_bits(np.array([64.0, 64.0, 64.0]), read_noise_e=0.0))
    12.0
    """
    bits = tonal_range_bits(top_e, read_noise_e=read_noise_e, step_e=step_e)
    return np.asarray(bits.sum(axis=-1))
