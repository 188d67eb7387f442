"""All denoising methods by name, and those of other packages for comparison.

Add a method to `DENOISING`. The methods of other packages get the same known noise. All but `NONE`
work on stabilized planes (`chromanoise.imaging.denoising.electron_planes`), whose noise is white
with a variance of 1. All but ``bm3d`` first rotate the planes to the components of
`NoisyPlanes.components`, which leaves the noise unchanged and separates luminance from color, which
has the lower SNR. Parameters are those that the packages recommend for a known noise; where they
leave a choice, it was made for the lowest mean CIEDE2000 on ``builtin:dead-leaves`` and
``builtin:foliage`` at 10 and 0.1 lx through ``onyx-rgbw``.

The packages come with the extra ``denoise``. BM3D is licensed for noncommercial use only.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, Float32, InputError, check, refuse_absent_package
from chromanoise.imaging.denoising.electron_planes import (
    DenoisingMethod,
    NoisyPlanes,
    stabilized,
    unstabilized,
)
from chromanoise.imaging.denoising.guided import GUIDED
from chromanoise.imaging.denoising.linear import LMMSE, WIENER
from chromanoise.imaging.denoising.patches import AGGREGATE, PATCHES

_PATCH_PX, _REACH_PX = 7, 11  # defaults of denoise_nl_means
_NLM_H = 0.6  # its documentation: 0.6 sigma for the fast mode with a known sigma
_SHIFTS, _SHIFT_PX = 4, 3  # cycle spinning over 4 x 4 shifts
_OPENCV_H = 1.0  # of the noise; 0.7 is 6 % better at 10 lx and 33 % worse at 0.1 lx
_OPENCV_PATCH_PX, _OPENCV_WINDOW_PX = 7, 21  # recommended by its documentation
_CODES_PER_SD, _TOP_CODE = 64.0, 65535
_BM3D_LEAST_PX = 12  # the package ends the process at 8 x 8 pixels

Stable = Float[Array, "h w p"]


def _of_planes(clean: Callable[[Stable], Stable], planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    return unstabilized(clean(stabilized(planes)), planes)


def _of_components(
    clean: Callable[[Stable], Stable], planes: NoisyPlanes
) -> Float32[Array, "h w p"]:
    directions, _ = planes.components()
    return _of_planes(lambda stable: clean(stable @ directions) @ directions.T, planes)


def _each(clean: Callable[[Float[Array, "h w"]], Array]) -> Callable[[Stable], Stable]:
    """The method for one plane, for each plane."""

    def of_all(stable: Stable) -> Stable:
        planes = [clean(np.ascontiguousarray(one)) for one in np.moveaxis(stable, -1, 0)]
        return np.stack(planes, axis=-1).astype(np.float64)

    return of_all


def _nlm(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    restoration = _package("skimage.restoration", NLM, planes)

    def clean(plane: Float[Array, "h w"]) -> Array:
        return restoration.denoise_nl_means(
            plane, patch_size=_PATCH_PX, patch_distance=_REACH_PX, h=_NLM_H, sigma=1.0
        )

    return _of_components(_each(clean), planes)


def _wavelets(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    restoration = _package("skimage.restoration", WAVELETS, planes)
    levels = min(planes.values_e.shape[:2]).bit_length() - 1

    def clean(stable: Stable) -> Stable:
        total = np.zeros_like(stable)
        for shift in np.ndindex(_SHIFTS, _SHIFTS):
            by = _SHIFT_PX * np.array(shift)
            smooth = restoration.denoise_wavelet(
                np.roll(stable, by, axis=(0, 1)),
                sigma=1.0,
                wavelet="db1",
                mode="soft",
                method="BayesShrink",
                wavelet_levels=levels,
                rescale_sigma=False,
                channel_axis=-1,
            )
            total += np.roll(smooth, -by, axis=(0, 1))
        return total / _SHIFTS**2

    return _of_components(clean, planes)


def _opencv(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    cv2 = _package("cv2", OPENCV, planes)

    def clean(plane: Float[Array, "h w"]) -> Array:
        low = plane.min()
        scale = min(_CODES_PER_SD, _TOP_CODE / max(float(np.ptp(plane)), 1.0))
        codes = np.round((plane - low) * scale).astype(np.uint16)
        smooth = cv2.fastNlMeansDenoising(
            codes,
            h=[_OPENCV_H * scale],
            templateWindowSize=_OPENCV_PATCH_PX,
            searchWindowSize=_OPENCV_WINDOW_PX,
            normType=cv2.NORM_L1,
        )
        return smooth / scale + low

    return _of_components(_each(clean), planes)


def _bm3d(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    package = _package("bm3d", BM3D, planes, least_px=_BM3D_LEAST_PX)
    return _of_planes(_each(lambda plane: package.bm3d(plane, 1.0, _profile(package))), planes)


def _bm3d_joint(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    package = _package("bm3d", BM3D_JOINT, planes, least_px=_BM3D_LEAST_PX)

    def clean(stable: Stable) -> Stable:
        smooth = package.bm3d(stable, 1.0, _profile(package))
        return np.asarray(smooth, np.float64).reshape(stable.shape)

    return _of_components(clean, planes)


def _profile(package: Any) -> Any:
    """The default profile on one thread, so that sums have one order."""
    profile = package.BM3DProfile()
    profile.num_threads = 1
    return profile


def _package(
    module: str, method: DenoisingMethod, planes: NoisyPlanes, *, least_px: int = 2
) -> Any:
    """The module of a package, for planes that it can process.

    Raises
    ------
    InputError
        If it is not installed, or the planes have a side below ``least_px``.
    """
    _refuse_absent(method)
    shape = planes.values_e.shape[:2]
    if min(shape) < least_px:
        raise InputError(
            "picture",
            f"must have at least {least_px} x {least_px} pixels per plane for the method "
            f"{method.name}",
            value=shape,
            found=f"has {shape[0]} x {shape[1]}",
            remedy="take a larger picture or another method",
        )
    return import_module(module)


def _refuse_absent(method: DenoisingMethod) -> None:
    for package, extra in method.absent_packages:
        refuse_absent_package(
            package,
            "denoise",
            extra=extra,
            value=method.name,
            otherwise=("take another method",),
        )


def _baseline(name: str, what: str, denoise: Any, *packages: str) -> DenoisingMethod:
    return DenoisingMethod(
        name=name, what=what, denoise=denoise, reach_px=None, baseline=True, packages=packages
    )


NONE = DenoisingMethod(
    name="none",
    what="No denoising: the noisy planes, unchanged.",
    denoise=lambda planes: planes.values_e,
    reach_px=0,
    linear=True,
    baseline=True,
)
NLM = _baseline(
    "nlm", "Non-local means of scikit-image, on components of stabilized planes.", _nlm, "skimage"
)
WAVELETS = _baseline(
    "wavelets",
    "BayesShrink wavelets of scikit-image with cycle spinning, on components of stabilized planes.",
    _wavelets,
    "skimage",
    "pywt",
)
OPENCV = _baseline(
    "opencv", "Non-local means of OpenCV, on components of stabilized planes.", _opencv, "cv2"
)
BM3D = _baseline("bm3d", "BM3D on each stabilized plane.", _bm3d, "bm3d")
BM3D_JOINT = _baseline(
    "bm3d-joint",
    "BM3D on all components of stabilized planes; blocks are matched on the first component.",
    _bm3d_joint,
    "bm3d",
)
BASELINES = (NONE, NLM, WAVELETS, OPENCV, BM3D, BM3D_JOINT)


DENOISING: Mapping[str, DenoisingMethod] = {
    method.name: method for method in (GUIDED, PATCHES, AGGREGATE, LMMSE, WIENER, *BASELINES)
}
"""Denoising methods by their name on the command line and in studies."""


def denoising_named(name: str) -> DenoisingMethod:
    """The denoising method with a name.

    Parameters
    ----------
    name
        Name of a method, such as ``guided``.

    Raises
    ------
    InputError
        If no method has this name, or a package that it needs is not installed.
    """
    method = DENOISING[check.one_of("denoise", name, tuple(DENOISING))]
    _refuse_absent(method)
    return method
