"""Statistics of raw frames: temporal noise of frames of one light, and fixed-pattern noise.

Temporal variance, row and column noise and correlation come from differences of consecutive frames,
in which fixed patterns cancel. The mean of each difference is subtracted (EMVA 1288, release 4.0,
section 6.5, with two frames). Row and column noise follow from the analysis of variance of the
difference: rows, columns, rest.

If the light changes between two frames, shading and PRNU do not cancel: a relative change d adds
d^2 / 2 times the spatial variance of the flats. `scaled_sample` therefore scales both frames to one
light.

DSNU, PRNU and hot pixels of a plane come from sums of frames (EMVA 1288).
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields, replace

import numpy as np

from chromanoise.base import Array, Float, InputError, Integer, check, dataclass
from chromanoise.imaging import (
    SMOOTHED,
    PairSums,
    PatternSums,
    ScaledPairSums,
    add_plane,
    difference_rests,
    neighbor_products,
)
from chromanoise.io.frames import RawFrame

_BLOCK_PIXELS = 1 << 20
SURE_Z = 5.0
"""Standard errors beyond which a difference is no chance."""
LEAST_CLIPPED = 1e-3
"""Share of clipped pixels that changes a variance by as much."""
_FEW_PIXELS = 1 << 10  # of which most codes have a greatest common divisor of 1
_MOST_OPEN = 32  # files from which rows are read in turn
BAND_PIXELS = 1 << 17
"""Pixels of a plane from which correlations are computed: their error is 0.003."""


@dataclass(frozen=True, kw_only=True)
class PlaneSample:
    """Statistics of one plane over the frames of one light.

    Attributes
    ----------
    frame_means_dn
        Mean code of each frame. [DN]
    variance_dn2
        Temporal variance of a pixel: rows, columns and the rest together. [DN^2]
    rest_dn2
        The part that neighbors do not share. [DN^2]
    row_dn2, row_se_dn2, column_dn2, column_se_dn2
        Variance that all pixels of a row, or of a column, share, and its standard error; may be
        negative by chance. [DN^2]
    samples
        Number of independent values with the same error of the variance. [1]
    mean_variance_dn2
        Variance of the mean over all frames, from temporal noise. [DN^2]
    pixels
        Pixels of the plane. [1]
    top_dn, bottom_dn
        The largest and the smallest code in the middle rows of the first frame. [DN]
    top_share, bottom_share
        Share of the pixels in these rows that have them. [1]
    step_dn
        Greatest common divisor of the differences of the codes in these rows; 0 if all are equal.
        [DN]
    correlation_right, correlation_down
        Of the rest, between neighbors in a row, and in a column. [1]
    """

    frame_means_dn: tuple[float, ...]
    variance_dn2: float
    rest_dn2: float
    row_dn2: float
    row_se_dn2: float
    column_dn2: float
    column_se_dn2: float
    samples: float
    mean_variance_dn2: float
    pixels: int
    top_share: float
    top_dn: int
    bottom_dn: int
    bottom_share: float
    step_dn: int
    correlation_right: float
    correlation_down: float

    @property
    def mean_dn(self) -> float:
        """Mean over all frames. [DN]"""
        return float(np.add.reduce(self.frame_means_dn)) / len(self.frame_means_dn)

    @property
    def drift_z(self) -> float:
        """Largest change of the mean between two frames, over its standard error."""
        spread = max(self.frame_means_dn) - min(self.frame_means_dn)
        error = math.sqrt(2 * len(self.frame_means_dn) * self.mean_variance_dn2)
        return spread / error if error else (math.inf if spread else 0.0)

    def in_steps(self, step_dn: int, offset_dn: int) -> "PlaneSample":
        """The statistics of the codes (code - offset) / step.

        Parameters
        ----------
        step_dn, offset_dn
            Of the codes. [DN]
        """
        values = {
            field.name: getattr(self, field.name) / step_dn**2
            for field in fields(self)
            if field.name.endswith("_dn2")
        }
        return replace(
            self,
            **values,
            frame_means_dn=tuple((mean - offset_dn) / step_dn for mean in self.frame_means_dn),
            top_dn=(self.top_dn - offset_dn) // step_dn,
            bottom_dn=(self.bottom_dn - offset_dn) // step_dn,
            step_dn=self.step_dn // step_dn,
        )


def mean_shared(samples: Sequence[PlaneSample], which: str) -> tuple[float, float]:
    """Mean variance that rows, or columns, share, over several lights, and its error. [DN^2]

    Parameters
    ----------
    samples
        Of one plane, at least one.

    Notes
    -----
    Equal weights: errors from few rows are those of chance, and would favor small variances.
    """
    errors = np.array([getattr(one, f"{which}_se_dn2") for one in samples])
    mean = float(np.mean([getattr(one, f"{which}_dn2") for one in samples]))
    return mean, math.sqrt(float(errors @ errors)) / errors.size


@dataclass(frozen=True, kw_only=True, eq=False)
class LightSample:
    """Statistics of all planes over the frames of one light.

    Attributes
    ----------
    planes
        In the order of the pixels of a period of the mosaic.
    covariance_dn2
        Temporal covariance of the planes of one cell, rows and columns not included. [DN^2]
    """

    planes: tuple[PlaneSample, ...]
    covariance_dn2: Float[Array, "p p"]

    def __post_init__(self) -> None:
        check.freeze(self, "covariance_dn2")

    def in_steps(self, step_dn: int, offset_dn: int) -> "LightSample":
        """As `PlaneSample.in_steps`.

        Parameters
        ----------
        step_dn, offset_dn
            Of the codes. [DN]
        """
        return LightSample(
            planes=tuple(plane.in_steps(step_dn, offset_dn) for plane in self.planes),
            covariance_dn2=self.covariance_dn2 / step_dn**2,
        )


def light_sample(frames: Sequence[RawFrame], tile: tuple[int, int]) -> LightSample:
    """Statistics of two or more frames with the same light.

    Parameters
    ----------
    frames
        All of one size. They are read in turn: two are in memory while a third is being read.
    tile
        Rows and columns of the period of the mosaic; (1, 1) without a mosaic.

    Raises
    ------
    InputError
        If there is only one frame, a frame cannot be read, or the frames are smaller than 4 x 4
        pixels of each plane.

    Notes
    -----
    For k frames, the variances of k - 1 differences of consecutive frames are averaged. Their mean
    has the error of a mean over ``independent_pairs`` (k) differences.
    """
    if len(frames) < 2:
        raise InputError(
            frames[0].name if frames else "frames",
            "must be one of two or more frames of the same light for a temporal variance",
            value=len(frames),
            found="is the only one",
        )
    shape = _whole_cells(frames[0], tile)
    sums = [PairSums(shape, tile) for _ in frames[1:]]
    first, second = _added(frames, tile, sums)
    means = [one.totals.ravel() / _cells(shape, tile) for one in sums]
    means.append(means[-1] - _differences(sums[-1])[0] / _cells(shape, tile))
    return _sample(sums, np.array(means), difference_rests(first, second), first)


def scaled_sample(
    frames: Sequence[RawFrame],
    tile: tuple[int, int],
    sample: LightSample,
    darks: Sequence[tuple[float, float]],
) -> LightSample:
    """The statistics of frames whose light changes from one to the next, scaled to one light.

    Parameters
    ----------
    frames, tile
        As `light_sample`. The frames are read again.
    sample
        Result of `light_sample` for these frames.
    darks
        Mean and variance of each plane without light; the variance is 0 where it is not known.
        [DN], [DN^2]

    Notes
    -----
    The signals p and q of two frames above dark are multiplied by g = c / p and h = c / q, so that
    shading and PRNU cancel in the difference. Half of the variance of the difference contains the
    shot noise K (g^2 p + h^2 q) / 2 = K c^2 (1 / p + 1 / q) / 2. For c^2 = 2 m p q / (p + q) it is
    K m, the shot noise of the mean m of all frames. The temporal variance in the dark is multiplied
    by (g^2 + h^2) / 2; the excess, for two frames (p - q)^2 / (2 p q) times the dark variance, is
    subtracted. An error of (g - h)^2 / 2 times DSNU^2 remains, with the same small factor.

    The signal of pixels near saturation is not proportional to the light. If the mean difference
    depends significantly on the signal, its variance over the signal is subtracted too.
    """
    shape = _whole_cells(frames[0], tile)
    means = np.array([plane.frame_means_dn for plane in sample.planes])
    signal = means - np.array([mean for mean, _ in darks])[:, None]  # of each plane and frame
    one, other, both = signal[:, :-1], signal[:, 1:], signal.mean(axis=1, keepdims=True)
    level = np.sqrt(2 * both * one * other / (one + other))
    factors = np.stack([level / one, level / other])  # of plane and pair
    by_pair = np.moveaxis(factors, 2, 0).reshape(len(frames) - 1, 2, *tile)
    top = max(plane.top_dn for plane in sample.planes)
    sums = [ScaledPairSums(shape, tile, own, top) for own in by_pair]
    first, second = _added(frames, tile, sums)
    (g, h), index = factors[:, :, 0], (slice(None), None, None)
    rests = _centered(g[index] * first - h[index] * second)
    found = _sample(sums, means.T, rests, first)
    excess = (0.5 * (factors**2).sum(axis=0) - 1).mean(axis=1)
    planes = []
    for i, (plane, (_, dark_dn2)) in enumerate(zip(found.planes, darks, strict=True)):
        unlike = _unlike_light(sums, divmod(i, tile[1]), plane.variance_dn2)
        less = float(excess[i]) * dark_dn2 + unlike
        left = {
            name: max(getattr(plane, name) - less, 0.0) for name in ("variance_dn2", "rest_dn2")
        }
        planes.append(replace(plane, **left))
    return replace(found, planes=tuple(planes))


def _unlike_light(
    sums: Sequence[ScaledPairSums], place: tuple[int, int], variance_dn2: float
) -> float:
    """Variance of a plane by which differences depend on the signal; 0 if by chance. [DN^2]"""
    within, groups, free = 0.0, 0, 0
    for one in sums:
        counts, total = one.counts[place], one.sums[place]
        filled = counts > 0
        within += one.squares[place] - float((total[filled] ** 2 / counts[filled]).sum())
        groups += int(filled.sum())
        free += int(counts.sum()) - int(filled.sum())
    of_bins = within / (2 * max(free, 1))
    chance = of_bins * math.sqrt(2 * groups) / max(free, 1)
    return variance_dn2 - of_bins if variance_dn2 - of_bins > SURE_Z * chance else 0.0


def _added(
    frames: Sequence[RawFrame], tile: tuple[int, int], sums: Sequence[PairSums]
) -> tuple[Integer[Array, "p m n"], Integer[Array, "p m n"]]:
    """Add each two consecutive frames to their sums; rows in the middle of the first two frames."""
    shape = _whole_cells(frames[0], tile)
    middle = _band_rows(shape, tile)
    bands: tuple[list[Array], list[Array]] = ([], [])
    for start, blocks in _blocks(frames, shape, tile):
        inside = slice(max(middle.start - start, 0), max(middle.stop - start, 0))
        before = None
        for number, block in enumerate(blocks):
            if before is not None:
                sums[number - 1].add(before, block, start)
            if number < 2 and block[inside].size:
                bands[number].append(np.stack(planes_of(block[inside], tile)))
            before = block
    first, second = (np.concatenate(band, axis=1) for band in bands)
    return first, second


def independent_pairs(frames: int) -> float:
    """Independent differences with the error of all differences of consecutive frames. [1]

    Of k frames: 2 (k - 1)^2 / (3 k - 4), because neighboring differences share a frame.

    Examples
    --------
    >>> independent_pairs(2), independent_pairs(4)
    (1.0, 2.25)
    """
    return 2 * (frames - 1) ** 2 / (3 * frames - 4)


def planes_of(image: Array, tile: tuple[int, int]) -> list[Array]:
    """Views of an image, one for each pixel of the period of the mosaic."""
    return [image[y :: tile[0], x :: tile[1]] for y in range(tile[0]) for x in range(tile[1])]


def _blocks(
    frames: Sequence[RawFrame], shape: tuple[int, int], tile: tuple[int, int]
) -> Iterator[tuple[int, Iterator[Integer[Array, "n w"]]]]:
    """Rows of all frames, with the number of the first one.

    Rows of a few frames that their files store one after another are read in blocks that stay in
    the cache of the processor; other frames are read whole, one after another.
    """
    height, width = shape
    if len(frames) > _MOST_OPEN or not all(frame.has_rows for frame in frames):
        yield 0, (frame.codes()[:height, :width] for frame in frames)
        return
    rows = max(1, _BLOCK_PIXELS // width // tile[0]) * tile[0]
    every = [frame.blocks(rows) for frame in frames]
    for start in range(0, height, rows):
        yield start, (next(blocks)[: height - start, :width] for blocks in every)


def _whole_cells(frame: RawFrame, tile: tuple[int, int]) -> tuple[int, int]:
    """Rows and columns of the whole periods of the mosaic in a frame."""
    height, width = (size - size % step for size, step in zip(frame.shape, tile, strict=True))
    if height < 4 * tile[0] or width < 4 * tile[1]:
        raise InputError(
            frame.name,
            "must have at least 4 x 4 pixels of each plane",
            value=frame.shape,
            found=f"has {frame.shape[0]} x {frame.shape[1]} pixels",
        )
    return height, width


def _cells(shape: tuple[int, int], tile: tuple[int, int]) -> int:
    """Pixels of each plane."""
    return shape[0] // tile[0] * (shape[1] // tile[1])


def _differences(sums: PairSums) -> tuple[Array, Array, Array]:
    """Sums of the difference of two frames in each plane: of all pixels, by row, by column."""
    (high, wide), (rows, columns) = sums.totals.shape, (len(sums.rows), sums.columns.shape[1])
    by_row = sums.rows.reshape(rows // high, high * wide).T
    by_place = sums.columns.reshape(high, columns // wide, wide).swapaxes(1, 2)
    by_column = by_place.reshape(high * wide, columns // wide)
    return by_column.sum(axis=1), by_row, by_column


def _mean_squares(sums: PairSums) -> Float[Array, "3 p"]:
    """The analysis of variance of a difference: mean squares of the rest, rows and columns."""
    whole, by_row, by_column = _differences(sums)
    rows, columns = by_row.shape[1], by_column.shape[1]
    n, mean = rows * columns, whole[:, None] / (rows * columns)
    of_rows = columns * ((by_row / columns - mean) ** 2).sum(axis=1)
    of_columns = rows * ((by_column / rows - mean) ** 2).sum(axis=1)
    totals = zip(sums.squares.ravel().tolist(), whole.tolist(), strict=True)  # may exceed 64 bits
    squares = np.array([(square * n - one**2) / n for square, one in totals])
    rest = np.maximum(squares - of_rows - of_columns, 0.0)
    free = (rows - 1) * (columns - 1), rows - 1, columns - 1
    return np.stack([rest, of_rows, of_columns]) / np.array(free)[:, None]


def _step(codes: Integer[Array, "m n"], bottom: int) -> int:
    """Greatest common divisor of the codes minus the smallest."""
    few = int(np.gcd.reduce(codes.ravel()[:_FEW_PIXELS].astype(np.int64) - bottom))
    return few if few == 1 else int(np.gcd.reduce(codes.ravel().astype(np.int64) - bottom))


def _band_rows(shape: tuple[int, int], tile: tuple[int, int]) -> slice:
    """Rows in the middle of a frame with enough pixels for correlations."""
    height, width = shape
    rows = min(height // tile[0], max(4, BAND_PIXELS // (width // tile[1])))
    start = (height // tile[0] - rows) // 2 * tile[0]
    return slice(start, start + rows * tile[0])


def _centered(values: Float[Array, "p m n"]) -> Float[Array, "p m n"]:
    """The values without the means of their rows and columns, in float32."""
    values = values - values.mean(axis=1, keepdims=True)
    return np.asarray(values - values.mean(axis=2, keepdims=True), np.float32)


def _correlations(
    rests: Float[Array, "p m n"],
) -> tuple[Float[Array, " p"], Float[Array, " p"], Float[Array, "p p"]]:
    """Correlations of neighbors in rows and columns, and the covariance of the planes.

    Parameters
    ----------
    rests
        Rows in the middle of a difference, row and column means subtracted.
    """
    _, rows, columns = rests.shape
    products, right, down = neighbor_products(rests)
    squares = np.diag(products) / (rows * columns)
    squares = np.where(squares > 0, squares, 1.0)
    return (  # the subtracted means correlate neighbors by -1 / (n - 1)
        right / (rows * (columns - 1)) / squares + 1 / (columns - 1),
        down / ((rows - 1) * columns) / squares + 1 / (rows - 1),
        products / (2 * (rows - 1) * (columns - 1)),
    )


def _sample(
    sums: Sequence[PairSums],
    means: Float[Array, "k p"],
    rests: Float[Array, "p m n"],
    first: Integer[Array, "p m n"],
) -> LightSample:
    count, (high, wide) = len(means), sums[0].totals.shape
    rows, columns = len(sums[0].rows) // high, sums[0].columns.shape[1] // wide
    # variance of one frame: half that of a difference
    rest, of_rows, of_columns = 0.5 * np.mean([_mean_squares(one) for one in sums], axis=0)
    independent = independent_pairs(count)
    row, column = (of_rows - rest) / columns, (of_columns - rest) / rows
    kept = independent * (rows - 1) * (columns - 1)
    row_error2, column_error2 = (
        2 * own**2 / (independent * (lines - 1)) + 2 * rest**2 / kept
        for own, lines in ((of_rows, rows), (of_columns, columns))
    )
    variance = rest + row + column
    shared = np.maximum(row, 0) ** 2 / rows + np.maximum(column, 0) ** 2 / columns
    error2 = (rest**2 / (rows * columns) + shared) / independent  # half the squared error
    samples = np.where(error2 > 0, variance**2 / np.where(error2 > 0, error2, 1.0), kept) + 1
    of_mean = rest / (rows * columns) + np.maximum(row, 0) / rows
    right, down, covariance = _correlations(rests)
    by_plane = {
        "variance_dn2": np.maximum(variance, 0.0),
        "rest_dn2": rest,
        "row_dn2": row,
        "row_se_dn2": np.sqrt(row_error2) / columns,
        "column_dn2": column,
        "column_se_dn2": np.sqrt(column_error2) / rows,
        "samples": np.maximum(samples, 2.0),
        "mean_variance_dn2": (of_mean + np.maximum(column, 0) / columns) / count,
        "correlation_right": right,
        "correlation_down": down,
    }
    planes = (
        PlaneSample(
            frame_means_dn=tuple(means[:, i].tolist()),
            pixels=rows * columns,
            top_share=np.count_nonzero(codes == top) / codes.size,
            top_dn=top,
            bottom_dn=bottom,
            bottom_share=np.count_nonzero(codes == bottom) / codes.size,
            step_dn=_step(codes, bottom),
            **{name: float(values[i]) for name, values in by_plane.items()},
        )
        for i, codes in enumerate(first)
        for top, bottom in ((int(codes.max()), int(codes.min())),)
    )
    return LightSample(planes=tuple(planes), covariance_dn2=covariance)


_HOT_SIGMA = 6.0  # of the spread of the dark mean: of 10^8 normal pixels, 0.1 lie above
_TO_SIGMA = 1.482602218505602  # from the median absolute deviation of a normal distribution
LEAST_SIDE = 64
"""Least side of a plane that is high-pass filtered. [px]"""
_BINOMIAL = np.array([1.0, 2.0, 1.0]) / 4
_SMOOTH = np.convolve(np.convolve(np.full(7, 1 / 7), np.full(11, 1 / 11)), _BINOMIAL)
"""Smoothing of EMVA 1288 in one direction: 7 and 11 pixels wide, then a binomial of 3."""


@dataclass(frozen=True, kw_only=True)
class SpatialVariance:
    """Variance of the pixels of an averaged frame without its temporal part.

    Attributes
    ----------
    variance_dn2, se_dn2
        The variance and its standard error; may be negative by chance. [DN^2]
    mean_dn
        Mean of the pixels used. [DN]
    removed_dn2
        Variance that the high-pass filter removed: uneven light and shading. [DN^2]
    filtered
        Whether the frame was high-pass filtered; its borders are then not used.
    """

    variance_dn2: float
    se_dn2: float
    mean_dn: float
    removed_dn2: float
    filtered: bool

    def signal_dn(self, dark: "SpatialVariance") -> float:
        """Root mean square of the signal above dark, by which the spread of pixels grows. [DN]"""
        return math.sqrt((self.mean_dn - dark.mean_dn) ** 2 + self.removed_dn2)


@dataclass(frozen=True, kw_only=True, eq=False)
class FixedPattern:
    """The sum of frames of one light, one plane, without the places of its pixels.

    Attributes
    ----------
    frames
        Number of frames in the sum. [1]
    shape
        Rows and columns. [px]
    values, counts
        The different sums in increasing order, and how many pixels have each. [DN], [1]
    high_passed
        Variance of the sum minus its smoothed copy, and the rows and columns of what is left
        without the borders; ``None`` below 64 pixels. [DN^2], [px]
    inner_counts
        As ``counts``, without these borders. [1]
    """

    frames: int
    shape: tuple[int, int]
    values: Integer[Array, "n"]
    counts: Integer[Array, "n"]
    high_passed: tuple[float, tuple[int, int]] | None
    inner_counts: Integer[Array, "n"]

    @property
    def whole(self) -> tuple[float, float]:
        """Mean and variance of the pixels. [DN], [DN^2]"""
        return _moments(self.values, self.counts)

    @property
    def inner(self) -> tuple[float, float]:
        """Mean and variance of the pixels without the borders. [DN], [DN^2]"""
        return _moments(self.values, self.inner_counts)


def _moments(values: Integer[Array, "n"], counts: Integer[Array, "n"]) -> tuple[float, float]:
    pixels = int(counts.sum())
    mean = float(values @ counts) / pixels
    return mean, float(counts @ (values - mean) ** 2) / (pixels - 1)


def fixed_patterns(
    frames: Sequence[RawFrame], tile: tuple[int, int], planes: Iterable[int]
) -> dict[int, FixedPattern]:
    """Fixed-pattern statistics of the sum of at most 2^15 frames, by the number of the plane.

    Parameters
    ----------
    frames, tile
        As `light_sample`.
    planes
        Numbers of the planes that are wanted.

    Raises
    ------
    InputError
        If a frame cannot be read.
    """
    shape = _whole_cells(frames[0], tile)
    cells = (shape[0] // tile[0], shape[1] // tile[1])
    border = SMOOTHED // 2 if min(cells) >= LEAST_SIDE else 0
    sums: dict[int, PatternSums] = {}
    for _, blocks in _blocks(frames, shape, tile):
        totals: dict[int, Array] = {}
        for block in blocks:
            if not sums:
                kind = np.dtype(np.int32 if block.dtype.itemsize <= 2 else np.int64)
                sums = {i: PatternSums(cells, kind, border) for i in planes}
            totals = totals or {i: one.zeros(len(block) // tile[0]) for i, one in sums.items()}
            for i, total in totals.items():
                add_plane(block, i, tile, total)
        for one in sums.values():
            one.add()
    found = {}
    for i, one in sums.items():
        values, counts, inner_counts = one.counts
        found[i] = FixedPattern(
            frames=len(frames),
            shape=cells,
            values=values,
            counts=counts,
            high_passed=one.high_passed if border else None,
            inner_counts=inner_counts,
        )
    return found


def spatial_variance(
    pattern: FixedPattern,
    sample: PlaneSample,
    *,
    high_pass: bool,
    dark: PlaneSample | None = None,
) -> SpatialVariance:
    """The variance between pixels that is the same in every frame.

    Parameters
    ----------
    pattern
        Of the sum of frames of one light.
    sample
        Temporal statistics of the frames of this light.
    high_pass
        Whether the frame minus its smoothed copy is used, so that uneven light and shading are not
        counted. The variance of white noise is kept by a factor. Not done below 64 pixels.
    dark
        Statistics of the darks of flats that are filtered. Filtering excludes the borders, which
        shading makes darker, so the signal and the shot noise of the remaining pixels are larger.

    Notes
    -----
    EMVA 1288, release 4.0: s^2 = s^2 measured - sigma^2 / L for L frames; the filter is that of its
    section on PRNU.
    """
    frames, (mean, measured), (rows, columns) = pattern.frames, pattern.whole, pattern.shape
    filtered, removed = high_pass and pattern.high_passed is not None, 0.0
    white, shared = _kept() if filtered else (1.0, 1.0)
    rest = max(sample.rest_dn2, 0.0)
    if high_pass and pattern.high_passed is not None:
        measured, (rows, columns) = pattern.high_passed
        mean, inner = pattern.inner
        removed = max(inner - measured / white, 0.0) / frames**2
        if dark is not None and sample.mean_dn > dark.mean_dn:
            of_light = (mean / frames - dark.mean_dn) / (sample.mean_dn - dark.mean_dn)
            rest = max(dark.rest_dn2 + of_light * (sample.rest_dn2 - dark.rest_dn2), 0.0)
    measured /= frames**2
    of_rows, of_columns = (max(part, 0.0) for part in (sample.row_dn2, sample.column_dn2))
    temporal = (rest * white + (of_rows + of_columns) * shared) / frames
    by_rows, by_columns = of_rows * shared / frames, of_columns * shared / frames
    own = max(measured - by_rows - by_columns, 0.0)
    error2 = 2 * (own**2 / (rows * columns) + by_rows**2 / rows + by_columns**2 / columns)
    rest_se = rest * math.sqrt(2 / (sample.pixels * independent_pairs(len(sample.frame_means_dn))))
    shared_se = math.hypot(sample.row_se_dn2, sample.column_se_dn2)
    error2 += ((rest_se * white) ** 2 + (shared_se * shared) ** 2) / frames**2
    return SpatialVariance(
        variance_dn2=(measured - temporal) / white,
        se_dn2=math.sqrt(error2) / white,
        mean_dn=mean / frames,
        removed_dn2=removed,
        filtered=filtered,
    )


def hot_pixels(pattern: FixedPattern, sample: PlaneSample) -> int:
    """Number of pixels far above the others in a sum of dark frames.

    Parameters
    ----------
    pattern, sample
        As `spatial_variance`. The spread of the others is that of the median absolute deviation,
        and at least that of the temporal noise: averages of few codes may all be equal.
    """
    values, counts = pattern.values, pattern.counts
    away = values - _median(values, counts)
    order = np.argsort(np.abs(away))
    spread = _TO_SIGMA * _median(np.abs(away)[order], counts[order])
    least = math.sqrt(max(sample.variance_dn2, 1 / 12) * pattern.frames)
    return int(counts[away > _HOT_SIGMA * max(spread, least)].sum())


def _median(values: Array, counts: Array) -> float:
    """Median of sorted values, each of which occurs as often as ``counts`` says."""
    until = np.cumsum(counts)
    middle = np.searchsorted(until, [(until[-1] - 1) // 2, until[-1] // 2], side="right")
    return float(values[middle].mean())


def _kept() -> tuple[float, float]:
    """Factors of the variance of white noise, and of noise that a whole row or column shares."""
    middle, square = float(_SMOOTH[_SMOOTH.size // 2]), float(_SMOOTH @ _SMOOTH)
    return 1 - 2 * middle**2 + square**2, 1 - 2 * middle + square
