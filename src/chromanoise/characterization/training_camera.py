"""A characterized camera as the noise model of a sampler of training data."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from chromanoise.characterization.merged_pixel import read_noise_e, root_mean_square
from chromanoise.characterization.results import (
    SHARED,
    SPREADS,
    Characterization,
    PlaneNoise,
    by_iso,
)
from chromanoise.errors import InputError, Setting
from chromanoise.sensor import CameraNoise, ReadNoiseTable

_BEYOND = 1.25  # factor of the gain by which the table goes beyond the settings measured
_LEAST_SHARE = 1e-3  # of the read noise: what a noise of 0 counts as in a table of logarithms


def camera_noise(results: Characterization | Sequence[Characterization]) -> CameraNoise:
    """The noise model of a camera from its frames at one ISO setting, or at several.

    Parameters
    ----------
    results
        One characterization, or one per ISO setting. The first one gives gain, black levels, dark
        current and PRNU; with several, read, row and column noise and DSNU at other settings are
        interpolated between the means over the planes, and the largest full well is used, because
        at a high ISO the largest code is reached before the full well.

    Returns
    -------
    CameraNoise
        Its channels are the planes. The read noise is the dark noise without that of rows
        and columns.
        The dark current is the mean over the planes; DSNU, PRNU, row and column noise are root mean
        squares, as in `pixel_of`; 0 where not measured.

    Raises
    ------
    InputError
        As `by_iso` for several results, if there is none, if a plane has no dark noise or black
        level, or if the bits are not known.

    Notes
    -----
    EMVA 1288, release 4.0: the temporal dark noise includes the row noise.
    """
    every = [results] if isinstance(results, Characterization) else list(results)
    if len(every) == 1:
        return _camera(every[0])
    by_iso(every)
    cameras = [_camera(one) for one in every]
    cameras_by_gain = sorted(cameras, key=lambda one: float(one.gain_dn_per_e.mean()))
    gains = [float(one.gain_dn_per_e.mean()) for one in cameras_by_gain]
    noise_dn = [float((one.read_noise_e * one.gain_dn_per_e).mean()) for one in cameras_by_gain]

    def table(values_dn: Sequence[float]) -> ReadNoiseTable | None:
        if not any(values_dn):
            return None
        least = [_LEAST_SHARE * one for one in noise_dn]
        values = np.maximum(values_dn, least)
        return ReadNoiseTable(  # single planes at the ends have gains a little beyond the means
            gain_dn_per_e=np.array([gains[0] / _BEYOND, *gains, gains[-1] * _BEYOND]),
            read_noise_dn=np.array([values[0], *values, values[-1]]),
        )

    pairs = list(zip(cameras_by_gain, gains, strict=True))
    wells = [one.full_well_e for one in cameras if one.full_well_e is not None]
    laws: dict[str, Any] = {
        f"{name.removesuffix('_e')}_law": table([getattr(one, name) * gain for one, gain in pairs])
        for name in SPREADS
        if SPREADS[name].unit == "e-"
    }
    return replace(
        cameras[0],
        full_well_e=max(wells, default=None),
        read_noise_law=table(noise_dn),
        **laws,
    )


def _camera(result: Characterization) -> CameraNoise:
    if result.bits is None:
        raise InputError(
            f"characterization of {result.source}",
            "must state the bits of the codes",
            found="does not",
            remedy=Setting("bits"),
        )
    planes = result.planes
    spreads: dict[str, Any] = {
        name: root_mean_square([getattr(plane, name) for plane in planes]) or 0.0
        for name in SPREADS
    }
    shared_e = [spreads[name] for name in SHARED]
    currents = [one.dark_current_e_per_s for one in planes if one.dark_current_e_per_s is not None]
    wells = [plane.full_well_e for plane in planes if plane.full_well_e is not None]
    return CameraNoise(
        names=tuple(plane.name for plane in planes),
        mosaic=result.mosaic,
        iso=result.iso,
        gain_dn_per_e=np.array([plane.gain_dn_per_e for plane in planes]),
        read_noise_e=np.array(
            [_known(plane, "dark_noise_e", read_noise_e(plane, *shared_e)) for plane in planes]
        ),
        black_level_dn=np.array(
            [_known(plane, "black_level_dn", plane.black_level_dn) for plane in planes]
        ),
        top_code_dn=float(2**result.bits - 1),
        full_well_e=min(wells) if wells else None,
        dark_current_e_per_s=max(0.0, float(np.mean(currents))) if currents else 0.0,
        **spreads,
    )


def _known(plane: PlaneNoise, name: str, value: float | None) -> float:
    if value is None:
        raise InputError(
            name,
            "must be known for a noise model",
            where=f"plane {plane.name}",
            found="is not",
            remedy="characterize the camera with dark frames",
        )
    return value
