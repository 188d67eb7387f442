"""A measurement: mean and covariance in named coordinates, and its linear transforms."""

import numpy as np

from chromanoise.base import Array, Float, check, congruence, dataclass, notebook
from chromanoise.spectra import Metric


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    """Mean and covariance of ``p`` coordinates, for one point or a whole picture.

    Attributes
    ----------
    mean
        Expected value per coordinate, in ``unit``.
    covariance
        In ``unit`` squared.
    names
        One per coordinate, e.g. ("R", "G", "B") or ("X", "Y", "Z").
    kind
        Kind of the coordinates: "raw", "contravariant", "XYZ"; it names every SNR.
    unit
        Unit of the mean.
    metric
        Metric of the space of spectra, where the coordinates depend on it; ``None`` for raw
        electrons.
    reading_variance
        Variance of one reading in ``unit`` squared, if it differs from the diagonal of the
        covariance: for one pixel of a mosaic with crosstalk after counting
        (`chromanoise.noise.with_noise`).

    Raises
    ------
    InputError
        If a number is not finite, a variance is negative, or the shapes do not match.
    """

    mean: Float[Array, "*px p"]
    covariance: Float[Array, "*px p p"]
    names: tuple[str, ...]
    kind: str
    unit: str
    metric: Metric | None = None
    reading_variance: Float[Array, "*px p"] | None = None

    def __post_init__(self) -> None:
        mean = check.finite(f"{self.kind} mean", self.unit, self.mean)
        covariance = check.finite(f"{self.kind} covariance", f"{self.unit}^2", self.covariance)
        square = (*mean.shape, mean.shape[-1])
        need = f"must have shape {square} for a mean of {mean.shape}"
        check.shape(f"{self.kind} covariance", covariance, covariance.shape == square, need)
        check.same_length("coordinates", names=len(self.names), mean=mean.shape[-1])
        diagonal = np.diagonal(covariance, axis1=-2, axis2=-1)
        check.non_negative(f"{self.kind} variance", f"{self.unit}^2", diagonal)
        check.keep(self, mean=mean, covariance=covariance)
        if self.reading_variance is not None:
            what = f"{self.kind} reading variance"
            own = check.non_negative(what, f"{self.unit}^2", self.reading_variance)
            check.keep(self, reading_variance=own)

    @property
    def variance(self) -> Float[Array, "*px p"]:
        """The variance of one reading: the diagonal of the covariance, unless one is given.

        In the squared unit of the mean.
        """
        if self.reading_variance is not None:
            return self.reading_variance
        return np.diagonal(self.covariance, axis1=-2, axis2=-1)

    def _repr_html_(self) -> str:
        text = f"Measurement, {self.kind}" + (f" in {self.metric}" if self.metric else "")
        if self.mean.ndim > 1:
            return notebook.shown(f"{text}: {', '.join(self.names)} of {self.mean.shape[:-1]}")
        unit, sd = self.unit, np.sqrt(self.variance)
        own = np.sqrt(np.diagonal(self.covariance))
        own = np.where(own > 0, own, 1.0)
        shared = self.covariance / own / own[:, None]
        rows = [
            [name, f"{mean:.5g}", f"{deviation:.4g}", *(f"{one:.2f}" for one in row)]
            for name, mean, deviation, row in zip(self.names, self.mean, sd, shared, strict=True)
        ]
        head = ["", f"mean [{unit}]", f"standard deviation [{unit}]"]
        head += [f"correlation with {name}" for name in self.names]
        return notebook.shown(text, notebook.table(head, rows))


def through(
    measurement: Measurement,
    matrix: Float[Array, "q p"],
    *,
    names: tuple[str, ...],
    kind: str,
    unit: str,
    metric: Metric | None = None,
) -> Measurement:
    """The measurement in the coordinates ``matrix @ old``: mean C mu, covariance C S C^T.

    Parameters
    ----------
    measurement
        Mean mu and covariance S.
    matrix
        C; one row per new coordinate.
    names, kind, unit, metric
        Names, kind, unit and metric of the new coordinates.

    Raises
    ------
    InputError
        If the matrix does not have one column per old coordinate and one row per new one.

    Examples
    --------
    >>> raw = Measurement(mean=np.array([3.0, 1.0]), covariance=np.diag([4.0, 9.0]),
    ...                   names=("a", "b"), kind="raw", unit="e-")
    >>> sum_and_difference = np.array([[1.0, 1.0], [1.0, -1.0]])
    >>> through(raw, sum_and_difference, names=("s", "d"), kind="mixed", unit="e-").covariance
    array([[13., -5.],
           [-5., 13.]])
    """
    check.same_length("old coordinates", measurement=len(measurement.names), matrix=matrix.shape[1])
    return Measurement(
        mean=measurement.mean @ matrix.T,
        covariance=congruence(matrix, measurement.covariance),
        names=names,
        kind=kind,
        unit=unit,
        metric=metric,
    )
