"""Leaves on soil, dyed cotton and skin, whose infrared differs from their visible color."""

from collections.abc import Mapping

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Integer
from chromanoise.rng import stream
from chromanoise.scene.builtin.mixtures import (
    gaussian,
    logistic,
    mixed_cube,
    paint_behind,
    pixel_means,
)
from chromanoise.scene.cube import Cube
from chromanoise.spectra import DEFAULT_GRID

SIDE_PX = 256
SEED = 700
_SUBPIXELS = 4
_LEAVES = 150
_HALF_LENGTH_PX = (10.0, 42.0)
_SLENDERNESS = 0.36  # half width / half length
_FOLD = 0.8  # light on the second half of a leaf / light on the first
_TEXTURE = 0.08  # standard deviation of the 1/f texture
_WEAVE, _WEAVE_PX = 0.15, 5.0
_SHADE = (0.95, 0.35)  # illumination at two opposite corners
_SHAPES, _KINDS, _NOISE = range(3)  # random streams
_GROUND = ("soil", "black cotton", "blue cotton", "skin")
_LEAF_KINDS = ("leaf", "young leaf", "dry leaf")


def foliage_reflectances() -> Mapping[str, Float[Array, " n"]]:
    """Reflectances of the materials on the default grid, 400-1050 nm.

    With S(c, w) = 1 / (1 + exp(-(wavelength - c) / w)), G(c, s) a Gaussian of height 1, and all
    wavelengths in nm:

    leaf
        0.04 + 0.07 G(550, 28) + 0.44 S(715, 11) - 0.03 G(970, 25). Chlorophyll absorbs blue and
        red; scattering in the leaf makes the plateau; water absorbs at 970 nm.
    young leaf
        0.06 + 0.14 G(555, 32) + 0.42 S(700, 12) - 0.03 G(970, 25). Less chlorophyll: brighter
        green, and the red edge at a shorter wavelength.
    dry leaf
        0.06 + 0.40 S(600, 55). No chlorophyll and no water.
    soil
        0.04 + 0.16 (wavelength - 400) / 650.
    black cotton
        0.03 + 0.57 S(735, 14). The dyes absorb the visible light only; cotton reflects the rest.
    blue cotton
        0.04 + 0.22 G(450, 35) + 0.56 S(715, 12).
    skin
        0.28 + 0.34 S(595, 18) - 0.05 G(543, 12) - 0.06 G(577, 9) - 0.06 G(975, 30). Oxygenated
        hemoglobin absorbs at 543 and 577 nm, water at 975 nm.

    Notes
    -----
    The formulas are made for this scene; only the shapes are from the literature. Leaves: Gates,
    Keegan, Schleter & Weidner, "Spectral properties of plants", Appl. Opt. 4 (1965) 11; the red
    edge and chlorophyll: Horler, Dockray & Barber, Int. J. Remote Sens. 4 (1983) 273. Soil:
    Bowers & Hanks, "Reflection of radiant energy from soils", Soil Sci. 100 (1965) 130. Dyed
    cotton: Burkinshaw, Hallas & Towns, "Infrared camouflage", Rev. Prog. Color. 26 (1996) 47. Skin:
    Anderson & Parrish, "The optics of human skin", J. Invest. Dermatol. 77 (1981) 13.

    Examples
    --------
    >>> cotton = foliage_reflectances()["black cotton"]
    >>> cotton[[30, 90]].round(2)               # at 550 and 850 nm
    array([0.03, 0.6 ])
    """
    water = 0.03 * gaussian(970, 25)
    blood = 0.05 * gaussian(543, 12) + 0.06 * gaussian(577, 9)
    return {
        "leaf": 0.04 + 0.07 * gaussian(550, 28) + 0.44 * logistic(715, 11) - water,
        "young leaf": 0.06 + 0.14 * gaussian(555, 32) + 0.42 * logistic(700, 12) - water,
        "dry leaf": 0.06 + 0.40 * logistic(600, 55),
        "soil": 0.04 + 0.16 * (DEFAULT_GRID.wavelength_nm - 400.0) / 650.0,
        "black cotton": 0.03 + 0.57 * logistic(735, 14),
        "blue cotton": 0.04 + 0.22 * gaussian(450, 35) + 0.56 * logistic(715, 12),
        "skin": 0.28 + 0.34 * logistic(595, 18) - blood - 0.06 * gaussian(975, 30),
    }


def foliage_cube() -> Cube:
    """Leaves on soil, black and blue cotton and skin, 256 x 256 pixels, 400-1050 nm.

    The reflectances are those of `foliage_reflectances`, times a smooth illumination that falls
    from one corner to the other, a texture whose amplitude falls as 1/f, and the weave of the
    cloth. Pixels on the border of leaves are means of 4 x 4 samples.
    """
    reflectances = foliage_reflectances()
    materials = list(reflectances)
    label = _leaves()
    background = label < 0
    label[background] = 2 * _LEAVES + _ground(label.shape[0])[background]
    kind = np.floor(len(_LEAF_KINDS) * stream(SEED, _KINDS).random(_LEAVES)).astype(int)
    shares = np.zeros((2 * _LEAVES + len(_GROUND), len(materials)), dtype=np.float32)
    for half, light in enumerate((1.0, _FOLD)):
        shares[2 * np.arange(_LEAVES) + half, kind] = light
    for k, name in enumerate(_GROUND):
        shares[2 * _LEAVES + k, materials.index(name)] = 1.0
    seen = pixel_means(shares, label, subpixels=_SUBPIXELS)
    cloth = sum(seen[..., materials.index(name)] for name in ("black cotton", "blue cotton"))
    gain = _illumination() * (1.0 + _TEXTURE * _pink_noise()) * (1.0 + cloth * _weave())
    return mixed_cube(
        seen * gain[..., None],
        np.stack(list(reflectances.values())),
        source="builtin:foliage",
        notes=(
            "synthetic: leaves, soil, dyed cotton and skin with reflectances from formulas, under "
            "uneven illumination",
        ),
    )


def _leaves() -> Integer[Array, "sh sw"]:
    """The half of a leaf seen by each sample, two numbers per leaf; -1 for the ground."""
    side = SIDE_PX * _SUBPIXELS
    row, column, size, turn = stream(SEED, _SHAPES).random((4, _LEAVES))
    short, long = np.array(_HALF_LENGTH_PX) * _SUBPIXELS
    half_length = short + (long - short) * size**2
    angle = 2 * np.pi * turn
    center = np.stack([row, column], axis=1) * side

    def inside_half(
        k: int, down: Float[Array, "h 1"], right: Float[Array, "1 w"]
    ) -> Bool[Array, "h w"]:
        """Two arcs that meet in pointed ends; the halves are the two sides of the midrib."""
        leaf, half = divmod(k, 2)
        cos, sin = np.cos(angle[leaf]), np.sin(angle[leaf])
        along = (right * cos + down * sin) / half_length[leaf]
        across = (down * cos - right * sin) / half_length[leaf]
        width = np.where(half == 0, across, -across)
        return (width >= 0) & (width <= _SLENDERNESS * (1.0 - along**2))

    label = np.full((side, side), -1, dtype=np.int32)
    paint_behind(label, np.repeat(center, 2, axis=0), np.repeat(half_length, 2), inside_half)
    return label


def _ground(side: int) -> Integer[Array, "side side"]:
    """Indices into the materials of the ground: four fields with wavy borders."""
    place = np.arange(side) / side
    wave = 0.03 * np.sin(4 * np.pi * place)
    below = place[:, None] + wave[None, :] > 0.5
    right = place[None, :] + wave[:, None] > 0.5
    return 2 * below + right


def _illumination() -> Float[Array, "h w"]:
    place = (np.arange(SIDE_PX) + 0.5) / SIDE_PX
    fall = 0.5 - 0.5 * np.cos(np.pi * (place[:, None] + place[None, :]) / 2)
    return _SHADE[0] + (_SHADE[1] - _SHADE[0]) * fall


def _weave() -> Float[Array, "h w"]:
    thread = np.sin(2 * np.pi * np.arange(SIDE_PX) / _WEAVE_PX)
    return _WEAVE * thread[:, None] * thread[None, :]


def _pink_noise() -> Float[Array, "h w"]:
    """Noise with mean 0 and standard deviation 1 whose amplitude falls as 1/f."""
    white = np.fft.rfft2(stream(SEED, _NOISE).random((SIDE_PX, SIDE_PX)) - 0.5)
    frequency = np.hypot(np.fft.fftfreq(SIDE_PX)[:, None], np.fft.rfftfreq(SIDE_PX)[None, :])
    frequency[0, 0] = np.inf  # no mean
    noise = np.fft.irfft2(white / frequency, s=white.shape[:1] * 2)
    return noise / noise.std()
