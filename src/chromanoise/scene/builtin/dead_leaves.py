"""Dead leaves: occluding discs of random size, the standard target for texture."""

from functools import partial

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Integer
from chromanoise.rng import stream
from chromanoise.scene.builtin.mixtures import logistic, mixed_cube, paint_behind, pixel_means
from chromanoise.scene.cube import Cube
from chromanoise.spectra import DEFAULT_GRID, colorchecker

SIDE_PX = 256
RADIUS_PX = (1.0, 64.0)
"""Smallest and largest radius of a disc."""
SEED = 2009
_SUBPIXELS = 4
_PARTS = 3  # patches of the ColorChecker in the mixture of a disc
_DARKEST = 0.15  # smallest factor on a mixture
_BATCH = 4096
_DISCS, _SPECTRA = 0, 1  # random streams


def occluding_discs(
    side: int, radius: tuple[float, float], *, seed: int
) -> tuple[Integer[Array, "h w"], Float[Array, " discs"]]:
    """The dead leaves model with discs: the visible disc at each sample, and the radii.

    Parameters
    ----------
    side
        Rows and columns of samples.
    radius
        Smallest and largest radius, in samples. The density of the radii falls as r^-3.
    seed
        Seed of the discs.

    Returns
    -------
    label, radii
        The index into ``radii`` of the frontmost disc at each sample.

    Notes
    -----
    Lee, Mumford & Huang, "Occlusion models for natural images", IJCV 41 (2001) 35: with r^-3 the
    picture is scale invariant, and its power spectrum falls about as f^-2. Cao, Guichard & Hornung,
    "Measuring texture sharpness of a digital camera", Proc. SPIE 7250 (2009); ISO/TS 19567-2.
    """
    rng = stream(seed, _DISCS)
    smallest, largest = radius
    label = np.full((side, side), -1, dtype=np.int32)
    radii = np.empty(0)
    while (label < 0).any():
        row, column, share = rng.random((3, _BATCH))
        new = 1.0 / np.sqrt(smallest**-2 - share * (smallest**-2 - largest**-2))
        center = np.stack([row, column], axis=1) * (side + 2 * largest) - largest
        paint_behind(label, center, new, partial(_inside_disc, new), first=radii.size)
        radii = np.concatenate([radii, new])
    return label, radii


def _inside_disc(
    radii: Float[Array, " discs"], k: int, down: Float[Array, "h 1"], right: Float[Array, "1 w"]
) -> Bool[Array, "h w"]:
    return down**2 + right**2 <= radii[k] ** 2


def dead_leaves_cube() -> Cube:
    """Occluding discs with random reflectances, 256 x 256 pixels, 400-1050 nm.

    The radii are 1 to 64 px. Pixels on the border of discs are means of 4 x 4 samples. The
    reflectance of a disc is a random mixture of three ColorChecker patches times a random factor,
    up to about 700 nm, and beyond it a second, independent one. Thus color and infrared vary
    independently of lightness.

    Notes
    -----
    The model: `occluding_discs`. The infrared of dyed and painted surfaces hardly depends on their
    visible color: Salamati, Fredembach & Susstrunk, "Material classification using color and
    NIR images", CIC17 (2009).
    """
    label, radii = occluding_discs(
        SIDE_PX * _SUBPIXELS, (RADIUS_PX[0] * _SUBPIXELS, RADIUS_PX[1] * _SUBPIXELS), seed=SEED
    )
    chart = colorchecker(DEFAULT_GRID).values.T
    infrared = logistic(700.0, 10.0)
    mixtures = np.concatenate(
        [_random_mixtures(radii.size, len(chart), of=k) for k in (0, 1)], axis=1
    )
    shares = pixel_means(mixtures.astype(np.float32), label, subpixels=_SUBPIXELS)
    return mixed_cube(
        shares,
        np.concatenate([chart * (1.0 - infrared), chart * infrared]),
        source="builtin:dead-leaves",
        notes=(
            "synthetic: occluding discs; each reflectance is a random mixture of ColorChecker "
            "patches, with an independent one beyond about 700 nm",
        ),
    )


def _random_mixtures(count: int, patches: int, *, of: int) -> Float[Array, "count patches"]:
    """Random factors times random convex weights of a few patches each."""
    rng = stream(SEED, _SPECTRA, of)
    which = np.floor(patches * rng.random((count, _PARTS))).astype(int)
    cuts = np.sort(rng.random((count, _PARTS - 1)), axis=1)
    weight = np.diff(cuts, axis=1, prepend=0.0, append=1.0)  # uniform on the simplex
    factor = _DARKEST + (1.0 - _DARKEST) * rng.random((count, 1))
    mixtures = np.zeros((count, patches))
    np.add.at(mixtures, (np.arange(count)[:, None], which), factor * weight)
    return mixtures
