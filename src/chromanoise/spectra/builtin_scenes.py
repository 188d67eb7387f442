"""The built-in cubes by name: ColorChecker, dead leaves, foliage and slanted edges.

All but the ColorChecker are mixtures of a few reflectances. Dead leaves are occluding discs of
random size, the standard target for texture. Foliage has leaves on soil, dyed cotton and skin,
whose infrared differs from their visible color. The edges are straight and tilted by 5 degrees; one
kind exists only in the infrared.
"""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from chromanoise.base import Array, Bool, Float, Float32, Integer, check, dataclass, qr, stream
from chromanoise.spectra.curves import DEFAULT_GRID
from chromanoise.spectra.observers import cie_1931
from chromanoise.spectra.reflectances import colorchecker
from chromanoise.spectra.scene import Cube
from chromanoise.spectra.scene_rows import PaletteRows

PATCH_PX, GAP_PX = 64, 12
_GAP_REFLECTANCE = 0.04


def patch_corners() -> tuple[tuple[int, int], ...]:
    """Row and column of the upper left pixel of each patch, in the order of the chart."""
    pitch = PATCH_PX + GAP_PX
    return tuple((GAP_PX + (k // 6) * pitch, GAP_PX + (k % 6) * pitch) for k in range(24))


def checker_cube() -> Cube:
    """A ColorChecker with reflectances up to 1050 nm: 4 x 6 patches on a dark background."""
    chart = colorchecker(DEFAULT_GRID)
    pitch = PATCH_PX + GAP_PX
    index = np.zeros((4 * pitch + GAP_PX, 6 * pitch + GAP_PX), dtype=np.uint8)
    for k, (top, left) in enumerate(patch_corners(), 1):
        index[top : top + PATCH_PX, left : left + PATCH_PX] = k
    palette = np.vstack([np.full(DEFAULT_GRID.n, _GAP_REFLECTANCE), chart.values.T])
    return Cube(
        wavelength_nm=DEFAULT_GRID.wavelength_nm,
        stored=PaletteRows(palette=palette.astype(np.float32), index=index),
        source="builtin:checker",
        notes=chart.notes,
    )


_DECIMALS = 6  # rounding hides the last bits, which depend on the BLAS kernel


def logistic(center_nm: float, width_nm: float) -> Float[Array, " n"]:
    """A step from 0 to 1 on the default grid: 1 / (1 + exp(-(wavelength - center) / width))."""
    return 1.0 / (1.0 + np.exp(-(DEFAULT_GRID.wavelength_nm - center_nm) / width_nm))


def gaussian(center_nm: float, sd_nm: float) -> Float[Array, " n"]:
    """A bump of height 1 on the default grid, with the standard deviation ``sd_nm``."""
    return np.exp(-0.5 * ((DEFAULT_GRID.wavelength_nm - center_nm) / sd_nm) ** 2)


def pixel_means(
    values: Float[Array, "labels k"], label: Integer[Array, "sh sw"]
) -> Float[Array, "h w k"]:
    """Mean of ``values[label]`` over the 4 x 4 samples of each pixel."""
    firsts = np.ndindex(_SUBPIXELS, _SUBPIXELS)
    samples = (values[label[i::_SUBPIXELS, j::_SUBPIXELS]] for i, j in firsts)
    return sum(samples) / np.float32(_SUBPIXELS**2)


def mixed_reflectances(
    shares: Float[Array, "h w k"], reflectances: Float[Array, "k n"]
) -> Float32[Array, "h w n"]:
    """Mixtures ``shares @ reflectances``, rounded to 6 decimals: the same on all machines.

    Parameters
    ----------
    shares
        Share of each reflectance in each pixel, times the gain of the pixel.
    reflectances
        Reflectances on any grid.
    """
    out = np.empty((*shares.shape[:2], reflectances.shape[1]), np.float32)
    for row, some in zip(out, shares, strict=True):
        row[...] = np.round(some.astype(np.float64) @ reflectances, _DECIMALS)
    return out


Inside = Callable[[int, Float[Array, "h 1"], Float[Array, "1 w"]], Bool[Array, "h w"]]
"""Whether the points at (down, right) from the center of a shape are inside it."""


def paint_behind(
    label: Integer[Array, "h w"],
    center: Float[Array, "k 2"],
    reach: Float[Array, " k"],
    inside: Inside,
    *,
    first: int = 0,
) -> None:
    """Paint shapes in place, each behind all earlier ones.

    Parameters
    ----------
    label
        Number of the shape seen by each sample; negative where none is seen yet.
    center
        Row and column of the centers; sample (i, j) is at (i, j).
    reach
        Largest distance of a point of each shape from its center, in samples.
    inside
        Returns whether points are inside shape ``k``.
    first
        The number of the first of these shapes.

    Notes
    -----
    Painting from front to back until nothing is left uncovered samples the stationary dead leaves
    model exactly: Kendall & Thonnes, "Perfect simulation in stochastic geometry", Pattern
    Recognition 32 (1999) 1569.
    """
    low = np.maximum(np.ceil(center - reach[:, None]), 0).astype(int)
    high = np.minimum(np.floor(center + reach[:, None]) + 1, label.shape).astype(int)
    for k in np.flatnonzero((low < high).all(axis=1)):
        (top, left), (bottom, right) = low[k], high[k]
        window = label[top:bottom, left:right]
        free = window < 0
        if not free.any():
            continue
        down = np.arange(top, bottom)[:, None] - center[k, 0]
        across = np.arange(left, right)[None, :] - center[k, 1]
        window[free & inside(int(k), down, across)] = first + k


SIDE_PX = 256
RADIUS_PX = (1.0, 64.0)
"""Smallest and largest radius of a disc."""
DEAD_LEAVES_SEED = 2009
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
    The model: ``occluding_discs``. The infrared of dyed and painted surfaces hardly depends on
    their visible color: Salamati, Fredembach & Susstrunk, "Material classification using color and
    NIR images", CIC17 (2009).
    """
    label, radii = occluding_discs(
        SIDE_PX * _SUBPIXELS,
        (RADIUS_PX[0] * _SUBPIXELS, RADIUS_PX[1] * _SUBPIXELS),
        seed=DEAD_LEAVES_SEED,
    )
    chart = colorchecker(DEFAULT_GRID).values.T
    infrared = logistic(700.0, 10.0)
    mixtures = np.concatenate(
        [_random_mixtures(radii.size, len(chart), of=k) for k in (0, 1)], axis=1
    )
    shares = pixel_means(mixtures.astype(np.float32), label)
    parts = np.concatenate([chart * (1.0 - infrared), chart * infrared])
    return Cube(
        wavelength_nm=DEFAULT_GRID.wavelength_nm,
        stored=mixed_reflectances(shares, parts),
        source="builtin:dead-leaves",
        notes=(
            "synthetic: occluding discs; each reflectance is a random mixture of ColorChecker "
            "patches, with an independent one beyond about 700 nm",
        ),
    )


def _random_mixtures(count: int, patches: int, *, of: int) -> Float[Array, "count patches"]:
    """Random factors times random convex weights of a few patches each."""
    rng = stream(DEAD_LEAVES_SEED, _SPECTRA, of)
    which = np.floor(patches * rng.random((count, _PARTS))).astype(int)
    cuts = np.sort(rng.random((count, _PARTS - 1)), axis=1)
    weight = np.diff(cuts, axis=1, prepend=0.0, append=1.0)  # uniform on the simplex
    factor = _DARKEST + (1.0 - _DARKEST) * rng.random((count, 1))
    mixtures = np.zeros((count, patches))
    np.add.at(mixtures, (np.arange(count)[:, None], which), factor * weight)
    return mixtures


FOLIAGE_SEED = 700
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

    The reflectances are those of ``foliage_reflectances``, times a smooth illumination that falls
    from one corner to the other, a texture whose amplitude falls as 1/f, and the weave of the
    cloth. Pixels on the border of leaves are means of 4 x 4 samples.
    """
    reflectances = foliage_reflectances()
    materials = list(reflectances)
    label = _leaves()
    background = label < 0
    label[background] = 2 * _LEAVES + _ground(label.shape[0])[background]
    kind = np.floor(len(_LEAF_KINDS) * stream(FOLIAGE_SEED, _KINDS).random(_LEAVES)).astype(int)
    shares = np.zeros((2 * _LEAVES + len(_GROUND), len(materials)), dtype=np.float32)
    for half, light in enumerate((1.0, _FOLD)):
        shares[2 * np.arange(_LEAVES) + half, kind] = light
    for k, name in enumerate(_GROUND):
        shares[2 * _LEAVES + k, materials.index(name)] = 1.0
    seen = pixel_means(shares, label)
    cloth = sum(seen[..., materials.index(name)] for name in ("black cotton", "blue cotton"))
    gain = _illumination() * (1.0 + _TEXTURE * _pink_noise()) * (1.0 + cloth * _weave())
    return Cube(
        wavelength_nm=DEFAULT_GRID.wavelength_nm,
        stored=mixed_reflectances(seen * gain[..., None], np.stack(list(reflectances.values()))),
        source="builtin:foliage",
        notes=(
            "synthetic: leaves, soil, dyed cotton and skin with reflectances from formulas, under "
            "uneven illumination",
        ),
    )


def _leaves() -> Integer[Array, "sh sw"]:
    """The half of a leaf seen by each sample, two numbers per leaf; -1 for the ground."""
    side = SIDE_PX * _SUBPIXELS
    row, column, size, turn = stream(FOLIAGE_SEED, _SHAPES).random((4, _LEAVES))
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
    white = np.fft.rfft2(stream(FOLIAGE_SEED, _NOISE).random((SIDE_PX, SIDE_PX)) - 0.5)
    frequency = np.hypot(np.fft.fftfreq(SIDE_PX)[:, None], np.fft.rfftfreq(SIDE_PX)[None, :])
    frequency[0, 0] = np.inf  # no mean
    noise = np.fft.irfft2(white / frequency, s=white.shape[:1] * 2)
    return noise / noise.std()


TILT_DEG = 5.0
FLAT_MARGIN_PX = 8
"""Distance of the flat regions from the edge and from the border of its cell."""
EDGE_KINDS = ("luminance", "low-contrast", "color", "infrared")
"""Gray 0.15 and 0.60; gray 0.27 and 0.33; equal luminance; equal XYZ, other infrared."""
DIRECTIONS = ("vertical", "horizontal")

Region = tuple[slice, slice]


@dataclass(frozen=True, kw_only=True)
class SlantedEdge:
    """An edge through the center of a cell of the picture.

    Attributes
    ----------
    kind
        One of ``EDGE_KINDS``: what differs between the two sides.
    direction
        ``vertical`` or ``horizontal``, before the tilt.
    rows, columns
        The cell: first row or column, and the one after the last. [px]
    tilt_deg
        Angle between the edge and its direction. [degrees]
    """

    kind: str
    direction: str
    rows: tuple[int, int]
    columns: tuple[int, int]
    tilt_deg: float = TILT_DEG

    @property
    def cell(self) -> Region:
        """Slices of the rows and columns of the cell."""
        return slice(*self.rows), slice(*self.columns)

    @property
    def center_px(self) -> tuple[float, float]:
        """Row and column of a point on the edge; (0, 0) is the center of the first pixel. [px]"""
        return (sum(self.rows) - 1) / 2, (sum(self.columns) - 1) / 2

    @property
    def distance_px(self) -> Float[Array, "h w"]:
        """Distance of the pixels of the cell from the edge. [px]

        Negative on the first side, which is left or above.

        Examples
        --------
        >>> edge = SLANTED_EDGES[0]
        >>> edge.direction, edge.distance_px[31, [0, -1]].round(1)
        ('vertical', array([-63.3,  63.2]))
        """
        down = np.arange(*self.rows)[:, None] - self.center_px[0]
        right = np.arange(*self.columns)[None, :] - self.center_px[1]
        across, along = (right, down) if self.direction == "vertical" else (down, right)
        tilt = np.radians(self.tilt_deg)
        return across * np.cos(tilt) + along * np.sin(tilt)

    @property
    def flat_regions(self) -> tuple[Region, Region]:
        """Rows and columns of the largest flat rectangle on the first and the second side.

        They are at least ``FLAT_MARGIN_PX`` from the edge and from the border of the cell.
        """
        far = np.abs(self.distance_px) >= FLAT_MARGIN_PX + 1
        vertical = self.direction == "vertical"
        (low, high), (start, stop) = (
            (self.columns, self.rows) if vertical else (self.rows, self.columns)
        )
        near = low + np.flatnonzero(~far.all(axis=0 if vertical else 1))
        along = slice(start + FLAT_MARGIN_PX, stop - FLAT_MARGIN_PX)
        sides = (
            slice(low + FLAT_MARGIN_PX, int(near[0])),
            slice(int(near[-1]) + 1, high - FLAT_MARGIN_PX),
        )
        first, second = ((along, one) if vertical else (one, along) for one in sides)
        return first, second


def _edges() -> tuple[SlantedEdge, ...]:
    height, width = SIDE_PX // len(EDGE_KINDS), SIDE_PX // len(DIRECTIONS)
    return tuple(
        SlantedEdge(
            kind=kind,
            direction=direction,
            rows=(i * height, (i + 1) * height),
            columns=(j * width, (j + 1) * width),
        )
        for i, kind in enumerate(EDGE_KINDS)
        for j, direction in enumerate(DIRECTIONS)
    )


SLANTED_EDGES = _edges()
"""The edges of ``builtin:slanted-edges``: a row of cells per kind, a column per direction."""


def slanted_edges_cube() -> Cube:
    """Edges of four kinds in two directions, 256 x 256 pixels, 400-1050 nm.

    `SLANTED_EDGES` has their positions. A pixel on an edge is the exact mean over its area. The
    pairs of reflectances:

    luminance
        Gray 0.15 and 0.60, the contrast 4:1 of ISO 12233.
    low-contrast
        Gray 0.27 and 0.33.
    color
        The ColorChecker patches red and green, of equal luminance under illuminant E. Beyond about
        700 nm both are 0.5.
    infrared
        Gray 0.3, and the same plus 0.45 beyond about 720 nm. XYZ are equal under illuminant E,
        because the difference is a metameric black.

    Notes
    -----
    ISO 12233:2017, e-SFR: edges tilted by 5 degrees. Metameric black: Cohen & Kappauf, "Metameric
    color stimuli, fundamental metamers, and Wyszecki's metameric blacks", Am. J. Psychol. 95 (1982)
    537.
    """
    second, kind = np.zeros((SIDE_PX, SIDE_PX)), np.zeros((SIDE_PX, SIDE_PX), np.int64)
    for edge in SLANTED_EDGES:
        second[edge.cell], kind[edge.cell] = _covered(edge), EDGE_KINDS.index(edge.kind)
    values, which = np.unique(second, return_inverse=True)
    shares = np.zeros((len(EDGE_KINDS), values.size, 2 * len(EDGE_KINDS)))
    for k in range(len(EDGE_KINDS)):
        shares[k, :, 2 * k : 2 * k + 2] = np.stack([1.0 - values, values], axis=-1)
    sides = np.concatenate([_pairs()[kind] for kind in EDGE_KINDS])
    index = kind * values.size + which.reshape(kind.shape)
    return Cube(
        wavelength_nm=DEFAULT_GRID.wavelength_nm,
        stored=PaletteRows(
            palette=mixed_reflectances(shares, sides).reshape(-1, DEFAULT_GRID.n),
            index=index.astype(np.uint16),
        ),
        source="builtin:slanted-edges",
        notes=(
            "synthetic: grays, two ColorChecker patches of equal luminance, and two grays of equal "
            "XYZ that differ beyond about 700 nm; equal under illuminant E",
        ),
    )


def _covered(edge: SlantedEdge) -> Float[Array, "h w"]:
    """Share of the area of each pixel on the second side of the edge.

    A unit square seen along the edge is a box of width cos(tilt) convolved with one of sin(tilt).
    """
    wide, narrow = np.cos(np.radians(edge.tilt_deg)), np.sin(np.radians(edge.tilt_deg))
    outer, inner = (wide + narrow) / 2, (wide - narrow) / 2
    d = edge.distance_px
    corners = ((outer, 1), (inner, -1), (-inner, -1), (-outer, 1))
    twice_area = sum(sign * np.maximum(d + shift, 0.0) ** 2 for shift, sign in corners)
    return np.clip(twice_area / (2 * wide * narrow), 0.0, 1.0)  # 1 with rounding


def _pairs() -> dict[str, Float[Array, "2 n"]]:
    """The reflectances of the first and the second side by the kind of edge."""
    flat = np.ones(DEFAULT_GRID.n)
    return {
        "luminance": np.stack([0.15 * flat, 0.60 * flat]),
        "low-contrast": np.stack([0.27 * flat, 0.33 * flat]),
        "color": _of_equal_luminance("red", "green"),
        "infrared": np.stack([0.3 * flat, 0.3 * flat + _metameric_black(0.45 * logistic(720, 6))]),
    }


def _of_equal_luminance(first: str, second: str) -> Float[Array, "2 n"]:
    """Two patches with the same infrared, the second scaled to the luminance of the first."""
    infrared = logistic(700.0, 10.0)
    chart = colorchecker(DEFAULT_GRID)
    a, b = ((1.0 - infrared) * chart.values[:, chart.names.index(one)] for one in (first, second))
    luminance = cie_1931(DEFAULT_GRID).values[:, 1]
    return np.stack([a, b * (luminance @ a) / (luminance @ b)]) + 0.5 * infrared


def _metameric_black(difference: Float[Array, " n"]) -> Float[Array, " n"]:
    """The nearest difference of reflectances that leaves XYZ under illuminant E unchanged."""
    orthonormal = qr("color matching functions", cie_1931(DEFAULT_GRID).values)[0]
    return difference - orthonormal @ (orthonormal.T @ difference)


_MAKERS: Mapping[str, Callable[[], Cube]] = {
    "builtin:checker": checker_cube,
    "builtin:dead-leaves": dead_leaves_cube,
    "builtin:slanted-edges": slanted_edges_cube,
    "builtin:foliage": foliage_cube,
}
BUILTIN_CUBES = tuple(_MAKERS)
"""The names of all built-in cubes, such as ``builtin:checker``."""


def builtin_cube(name: str) -> Cube:
    """The cube with the name ``builtin:...``.

    Parameters
    ----------
    name
        Name of the cube, such as ``builtin:checker``.

    Raises
    ------
    InputError
        If no built-in cube has this name.
    """
    return _MAKERS[check.one_of("scene", name, BUILTIN_CUBES)]()
