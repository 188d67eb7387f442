"""Straight edges tilted by 5 degrees, also one that exists only in the infrared."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _linalg
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.scene.builtin.mixtures import logistic, mixed_cube
from chromanoise.scene.cube import Cube
from chromanoise.spectra import DEFAULT_GRID, cie_1931, colorchecker

SIDE_PX = 256
TILT_DEG = 5.0
FLAT_MARGIN_PX = 8
"""Distance of the flat regions from the edge and from the border of its cell."""
EDGE_KINDS = ("luminance", "low-contrast", "color", "infrared")
"""Gray 0.15 and 0.60; gray 0.27 and 0.33; equal luminance; equal XYZ, other infrared."""
DIRECTIONS = ("vertical", "horizontal")

Region = tuple[slice, slice]


@dataclass(frozen=True, slots=True, kw_only=True)
class SlantedEdge:
    """An edge through the center of a cell of the picture.

    Attributes
    ----------
    kind
        One of `EDGE_KINDS`: what differs between the two sides.
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

        They are at least `FLAT_MARGIN_PX` from the edge and from the border of the cell.
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
    shares = np.zeros((SIDE_PX, SIDE_PX, 2 * len(EDGE_KINDS)))
    for edge in SLANTED_EDGES:
        second = _covered(edge)
        k = 2 * EDGE_KINDS.index(edge.kind)
        shares[(*edge.cell, slice(k, k + 2))] = np.stack([1.0 - second, second], axis=-1)
    return mixed_cube(
        shares,
        np.concatenate([_pairs()[kind] for kind in EDGE_KINDS]),
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
    orthonormal = _linalg.qr("color matching functions", cie_1931(DEFAULT_GRID).values)[0]
    return difference - orthonormal @ (orthonormal.T @ difference)
