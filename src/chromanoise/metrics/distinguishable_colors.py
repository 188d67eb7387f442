"""Number of colors of real light that a noisy reading distinguishes.

The means are those of light with a given spectrum, reflected by something that is constant on d
blocks of wavelengths. `color_sensitivity_bits` counts every raw value of a cube instead, and so
does not see the filters.
"""

from functools import cache
from itertools import product

import numpy as np

from chromanoise.base import RANK_TOLERANCE, Array, Float, InputError, check, det, matrix_rank

_NODES = 12  # per block: 12 and 20 agree to 1e-4 bit
_MOST_BLOCKS = 5  # 12^5 nodes


def distinguishable_colors_bits(
    blocks_e: Float[Array, "p d"],
    *,
    read_noise_e: float,
    matrix: Float[Array, "c p"] | None = None,
) -> float:
    """log2 of the number of distinguishable colors of a gamut. [bit]

    -inf where the blocks are linearly dependent for the reader: it distinguishes no colors.

    Parameters
    ----------
    blocks_e
        Expected electrons of each channel for each block that reflects all light. [e-]
    read_noise_e
        Standard deviation of the reading without light. [e-]
    matrix
        The color matrix of the reader, with d rows; ``None`` for the best unbiased reader.

    Raises
    ------
    InputError
        If electrons are negative, a channel has neither light nor read noise, there are not 1 to 5
        blocks, there are fewer channels than blocks, or the matrix does not have one row per block
        and one column per channel.

    Notes
    -----
    N = int sqrt(det(B^T D^-1 B)) dx over x in [0, 1]^d with D = diag(B x + s^2) is the volume of
    Jeffreys' prior (Clarke & Barron, J. Stat. Plan. Inference 41 (1994), 37). After a matrix C,
    N = int abs(det(C B)) / sqrt(det(C D C^T)) dx, which is not larger. Colors that noise tells
    apart are not just-noticeable differences.

    Examples
    --------
    One channel and one block: log2 of the levels, 2 (sqrt(N + s^2) - s).

    >>> round(distinguishable_colors_bits(np.array([[1e4]]), read_noise_e=10.0), 4)
    7.4998
    """
    blocks = check.non_negative("blocks_e", "e-", blocks_e)
    floor_e2 = check.not_negative("read_noise_e", "e-", read_noise_e) ** 2
    is_table = blocks.ndim == 2 and 1 <= blocks.shape[1] <= _MOST_BLOCKS
    need = f"must have the shape (channels, blocks) with 1 to {_MOST_BLOCKS} blocks"
    check.shape("blocks_e", blocks, is_table, need)
    channels, count = blocks.shape
    if channels < count:
        raise InputError(
            "blocks_e",
            "must have at least as many channels as blocks",
            value=blocks.shape,
            found=f"has {channels} channels and {count} blocks",
            remedy="merge blocks",
        )
    if floor_e2 == 0 and not blocks.any(axis=1).all():
        raise InputError(
            "blocks_e", "must reach every channel where there is no read noise", value=0.0
        )
    seen = blocks
    if matrix is not None:
        reader = check.finite("matrix", "1/e-", matrix)
        need = f"must have {count} rows and {channels} columns"
        check.shape("matrix", reader, reader.shape == (count, channels), need)
        seen = reader @ blocks
    lengths = np.linalg.norm(seen, axis=0)
    columns = seen / np.where(lengths > 0, lengths, 1.0)
    if matrix_rank("blocks seen by the reader", columns, tol=RANK_TOLERANCE) < count:
        return -np.inf
    at, weights = _rule(count)
    variance_e2 = at @ blocks.T + floor_e2
    if channels == count:  # whatever the matrix: det(B^T D^-1 B) = det(B)^2 / det(D)
        volume = abs(det("blocks", blocks)) / np.sqrt(variance_e2.prod(axis=-1))
    elif matrix is None:
        information = np.einsum("pd,kp,pe->kde", blocks, 1 / variance_e2, blocks)
        volume = np.sqrt(det("Fisher information", information))
    else:
        noise = np.einsum("cp,kp,ep->kce", reader, variance_e2, reader)
        volume = abs(det("blocks", seen)) / np.sqrt(det("noise of the reader", noise))
    return float(np.log2(weights @ volume))


@cache
def _rule(count: int) -> tuple[Float[Array, "k d"], Float[Array, " k"]]:
    """Nodes and weights over [0, 1]^d, of x = u^2: the density rises as 1 / u towards black."""
    one, weight = np.polynomial.legendre.leggauss(_NODES)
    u = (one + 1) / 2
    at = np.array([*product(u**2, repeat=count)])
    return at, np.array([*product(u * weight, repeat=count)]).prod(axis=1)
