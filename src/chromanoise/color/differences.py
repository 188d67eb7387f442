"""Color differences between balanced colors, for which white is X = Y = Z = 1."""

import numpy as np

from chromanoise._check import Array
from chromanoise._colour_science import colour_science
from chromanoise._shapes import Float


def balanced_cielab(xyz: Float[Array, "*px 3"]) -> Float[Array, "*px 3"]:
    """CIE 1976 L*, a*, b* of colors divided by their white.

    Parameters
    ----------
    xyz
        X/Xn, Y/Yn, Z/Zn; also below 0, where the linear segment continues. [1]

    Notes
    -----
    CIE 015:2018, eq. 8.3-8.8, as `chromanoise.color.cielab`. The cube root is a power here, as in
    colour-science; it differs from ``np.cbrt`` in the last digit, and so would published results.

    Examples
    --------
    >>> balanced_cielab(np.array([0.125, 0.125, 0.125])).round(12)       # 116 / 2 - 16
    array([42.,  0.,  0.])
    """
    power = np.sign(xyz) * np.abs(xyz) ** (1 / 3)
    return lab_of_cube_roots(np.where(xyz > (24 / 116) ** 3, power, 841 / 108 * xyz + 16 / 116))


def lab_of_cube_roots(roots: Float[Array, "*px 3"]) -> Float[Array, "*px 3"]:
    """L*, a*, b* from the f of X/Xn, Y/Yn and Z/Zn (CIE 015:2018, eq. 8.3-8.5).

    Examples
    --------
    >>> lab_of_cube_roots(np.array([0.5, 0.5, 0.5]))
    array([42.,  0.,  0.])
    """
    x, y, z = np.moveaxis(roots, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def cie1976_difference(
    first: Float[Array, "*#px 3"], second: Float[Array, "*#px 3"]
) -> Float[Array, "..."]:
    """CIE 1976 color difference of two colors given as L*, a*, b*. [Delta E*ab]

    Parameters
    ----------
    first, second
        L*, a*, b*; their leading axes are broadcast.

    Notes
    -----
    CIE 015:2018, eq. 8.21.

    Examples
    --------
    >>> cie1976_difference(np.array([50.0, 3.0, 4.0]), np.array([50.0, 0.0, 0.0]))
    array(5.)
    """
    return np.asarray(np.linalg.norm(first - second, axis=-1))


def ciede2000_difference(
    first: Float[Array, "*#px 3"], second: Float[Array, "*#px 3"]
) -> Float[Array, "..."]:
    """CIEDE2000 color difference of two colors given as L*, a*, b*. [1]

    Parameters
    ----------
    first, second
        L*, a*, b*; their leading axes are broadcast.

    Notes
    -----
    CIE 142-2001 (ISO/CIE 11664-6), by colour-science.

    Examples
    --------
    Pair 7 of Sharma, Wu & Dalal, Color Res. Appl. 30, 21 (2005), table 1.

    >>> first, second = np.array([50.0, 0.0, 0.0]), np.array([50.0, -1.0, 2.0])
    >>> round(float(ciede2000_difference(first, second)), 4)
    2.3669
    """
    return np.asarray(colour_science().difference.delta_E_CIE2000(first, second))
