"""The noise of a camera as calibrated by ELD: the dictionary of a file ``camera_params/*.npy``."""

import math
from collections.abc import Mapping
from typing import Any, Literal, cast, get_args

import numpy as np

from chromanoise import _check
from chromanoise.errors import InputError, Setting
from chromanoise.sensor.read_noise import LogLinearNoise

ReadNoiseShape = Literal["tukey-lambda", "gaussian"]
"""Distribution of ELD's read noise."""


def eld_noise(
    params: Mapping[str, Any], *, read: ReadNoiseShape, profile: str
) -> tuple[tuple[float, float], dict[str, Any]]:
    """The range of the gain [DN/e-], and fields of `CameraNoise`, of the parameters of ELD.

    Parameters
    ----------
    params, read, profile
        As `CameraNoise.from_eld`.

    Raises
    ------
    InputError
        If a key is missing or a value is not as described.

    Notes
    -----
    Wei, Fu, Yang & Huang, CVPR (2020), eqs. 8-11.
    """
    read = cast(ReadNoiseShape, _check.one_of("read", read, get_args(ReadNoiseShape)))
    one = _mapping(params, profile)
    low, high = _number(params, "Kmin"), _number(params, "Kmax")
    if not 0 < low <= high:
        raise InputError(
            "ELD parameters",
            "must have 0 < Kmin <= Kmax [DN/e-]",
            value=(low, high),
            found=f"have Kmin = {low:g} and Kmax = {high:g}",
            remedy="give K, not its logarithm",
        )
    heavy = read == "tukey-lambda"
    if heavy and ("G_shape" not in params or "G_scale" not in one):
        missing = "G_scale" if "G_shape" in params else "G_shape"
        raise InputError(
            "ELD parameters",
            f"must have {missing} for Tukey lambda read noise",
            found="do not",
            remedy=Setting("read", ("gaussian",)),
        )
    shapes = _row_of_numbers(params, "G_shape") if heavy else ()
    offsets = None
    if params.get("color_bias") is not None:
        given = _check.finite("color_bias", "DN", params["color_bias"])
        if given.ndim != 2 or given.shape[1] != 4:
            raise InputError(
                "color_bias",
                "must have rows of 4 values: R, G1, B, G2 [DN]",
                value=given.shape,
                found=f"has shape {given.shape}",
            )
        offsets = given[:, [0, 1, 3, 2]]
    return (low, high), {
        "tail_lambda": shapes,
        "read_noise_law": _log_linear(one, "G_scale" if heavy else "g_scale", tukey_scale=heavy),
        "row_noise_law": _log_linear(one, "R_scale") if "R_scale" in one else None,
        "black_offsets_dn": offsets,
    }


def _mapping(params: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    found = params.get(key) if isinstance(params, Mapping) else None
    if not isinstance(found, Mapping):
        raise InputError(
            "ELD parameters",
            f"must be a dictionary with the dictionary {key}",
            value=type(params).__name__,
            found=f"have no {key}" if isinstance(params, Mapping) else None,
            remedy="take np.load(file, allow_pickle=True).item() of a file that you trust",
        )
    return found


def _number(params: Mapping[str, Any], key: str, where: str = "") -> float:
    place = f"{where}.{key}" if where else key
    if key not in params:
        raise InputError("ELD parameters", f"must have {place}", found="do not")
    try:
        number = float(params[key])
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InputError(
            "ELD parameters", "must be a finite number", value=params[key], where=place
        )
    return number


def _row_of_numbers(params: Mapping[str, Any], key: str) -> tuple[float, ...]:
    try:
        array = np.atleast_1d(np.asarray(params[key], dtype=np.float64))
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 1 or not array.size:
        raise InputError(
            "ELD parameters", "must be one or more numbers", value=params[key], where=key
        )
    return tuple(float(one) for one in array)


def _log_linear(
    profile: Mapping[str, Any], key: str, *, tukey_scale: bool = False
) -> LogLinearNoise:
    found = profile.get(key)
    if not isinstance(found, Mapping):
        raise InputError(
            "ELD parameters",
            f"must have {key} with slope, bias and sigma",
            value=found,
            found=f"have no {key}" if found is None else "",
        )
    return LogLinearNoise(
        slope=_number(found, "slope", key),
        bias=_number(found, "bias", key),
        sigma=_number(found, "sigma", key),
        tukey_scale=tukey_scale,
    )
