"""Color conversion matrices: the kernel CCM of eq. 6."""

from dataclasses import dataclass

from chromanoise import _check, _notebook
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.exposure import Exposure, measurement_vectors
from chromanoise.geometry import DualBasis, dual_frame
from chromanoise.noise import Measurement, through
from chromanoise.scene import Scene, light
from chromanoise.sensor import Sensor
from chromanoise.spectra import DEFAULT_OBSERVER, Metric, color_axes, known_observer

XYZ = ("X", "Y", "Z")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ColorMatrix:
    """A matrix from raw electrons to color, and how it was made.

    Attributes
    ----------
    matrix
        One row per color coordinate, one column per channel. [lx/e-]
    channels
        Names of the columns.
    coordinates
        Names of the rows.
    made_by
        Method and equation.
    metric
        Metric of the space of spectra.
    frame
        The sensor's frame; its rank and condition show how reliable the matrix is.
    observer
        The observer whose X, Y, Z the matrix gives, from `chromanoise.spectra.OBSERVERS`.
    notes
        Warnings: made for another sensor or light, or of low rank.

    Raises
    ------
    InputError
        If an entry is not finite, the shape is not that of coordinates and channels, or there is no
        observer of that name.
    """

    matrix: Float[Array, "c p"]
    channels: tuple[str, ...]
    coordinates: tuple[str, ...]
    made_by: str
    metric: Metric
    frame: DualBasis
    observer: str = DEFAULT_OBSERVER
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "observer", known_observer(self.observer))
        checked = _check.finite(f"{self.made_by} matrix", "lx/e-", self.matrix)
        if checked.shape != (len(self.coordinates), len(self.channels)):
            raise InputError(
                f"{self.made_by} matrix",
                f"must have shape {(len(self.coordinates), len(self.channels))}, one row per "
                "coordinate and one column per channel",
                value=checked.shape,
                found=f"has shape {checked.shape}",
            )
        object.__setattr__(self, "matrix", _check.frozen(checked))

    def _repr_html_(self) -> str:
        rows = [
            [name, *(f"{weight:.5g}" for weight in row)]
            for name, row in zip(self.coordinates, self.matrix, strict=True)
        ]
        frame = self.frame
        return _notebook.shown(
            f"Color matrix [lx/e-], {self.made_by}, in {self.metric}; condition "
            f"{frame.condition:.4g}, rank {frame.rank} of {len(self.channels)}",
            _notebook.table(["", *self.channels], rows),
        )


def kernel_matrix(
    sensor: Sensor,
    exposure: Exposure,
    metric: Metric = "quanta",
    observer: str = DEFAULT_OBSERVER,
) -> ColorMatrix:
    """The kernel color matrix, H^T F (F^T F)^-1: the color of the reconstructed spectrum.

    Parameters
    ----------
    sensor
        p channels; where they are linearly dependent, the pseudo-inverse is used.
    exposure
        Scales F, so that the matrix converts electrons to lux.
    metric
        In which light is a vector; the matrix depends on it.
    observer
        A name from `chromanoise.spectra.OBSERVERS`.

    Raises
    ------
    InputError
        If a channel is zero at every wavelength, or there is no observer of that name.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 6.
    """
    for name, seen in zip(sensor.names, sensor.qe.max(axis=0), strict=True):
        if not seen:
            raise InputError(
                f"channel {name} of sensor {sensor.name}",
                "must have a QE above 0 at some wavelength",
                value=0.0,
                found=f"has a QE of 0 on the whole grid {sensor.grid}, so it measures nothing",
                remedy="omit the channel",
            )
    basis = measurement_vectors(sensor, exposure, metric)  # F
    frame = dual_frame(basis, names=sensor.names, metric=metric)
    axes = color_axes(sensor.grid, metric, observer)  # H
    return ColorMatrix(
        matrix=axes.T @ frame.dual,
        channels=sensor.names,
        coordinates=XYZ,
        made_by="kernel (eq. 6)",
        metric=metric,
        frame=frame,
        observer=observer,
    )


def scene_xyz(
    scene: Scene, metric: Metric = "quanta", observer: str = DEFAULT_OBSERVER
) -> Float[Array, "*px 3"]:
    """X, Y, Z of the light for an observer: H^T L. [lx]

    Parameters
    ----------
    scene
        The light from the scene.
    metric
        Does not change the result beyond rounding.
    observer
        A name from `chromanoise.spectra.OBSERVERS`.

    Raises
    ------
    InputError
        If there is no observer of that name.
    """
    return light(scene, metric) @ color_axes(scene.illuminant.grid, metric, observer)


def colored(raw: Measurement, matrix: ColorMatrix) -> Measurement:
    """Color and its covariance C D C^T (eq. 5 with eq. 4). [lx]

    Parameters
    ----------
    raw
        Mean and covariance of the raw channels. [e-]
    matrix
        The color matrix. [lx/e-]

    Raises
    ------
    InputError
        If the channels of ``raw`` are not those of ``matrix``, in the same order.
    """
    _check.same_names("color", raw=raw.names, matrix=matrix.channels)
    return through(
        raw,
        matrix.matrix,
        names=matrix.coordinates,
        kind="".join(matrix.coordinates),
        unit="lx",
        metric=matrix.metric,
    )
