"""Methods for color matrices by name, and the spectral priors on which matrices are trained."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    InputError,
    Setting,
    check,
    dataclass,
    inv,
    kept,
    matrix_rank,
    pinv,
)
from chromanoise.color import (
    ColorMatrix,
    Training,
    bounded_psi,
    chart_training,
    kernel,
    kernel_matrix,
    least_squares,
    linear_srgb,
    lmmse,
    lmmse_over_light,
    nir_diverse,
    noise_aware,
    noise_aware_over_light,
    noise_regularized,
    ridge,
    scene_xyz,
    smooth_training,
    white_preserving,
)
from chromanoise.io import GivenMatrix, is_matrix_file, matrix_of_array, read_matrix
from chromanoise.noise import Exposure, OperatingPoint, expected_electrons, white_scene
from chromanoise.sensor import Sensor
from chromanoise.spectra import DEFAULT_OBSERVER, Illuminant, Metric, Spectra, chart_title
from chromanoise.study.resolve_names import file_of, is_object_word, shown_word

Prior = Callable[[Illuminant], Training]
"""A function from a lamp to a training set of reflectances."""


def chart_with_nir(illuminant: Illuminant) -> Training:
    """The ColorChecker, each patch also with nine other near-infrared reflectances."""
    return nir_diverse(chart_training(illuminant))


def smooth_with_nir(illuminant: Illuminant) -> Training:
    """Smooth spectra (50 nm), each also with nine other near-infrared reflectances."""
    return nir_diverse(smooth_training(illuminant, width_nm=50.0))


PRIORS: Mapping[str, Prior] = {
    "chart-nir": chart_with_nir,
    "chart": chart_training,
    "smooth-50-nir": smooth_with_nir,
    "smooth-50": partial(smooth_training, width_nm=50.0),
    "smooth-100": partial(smooth_training, width_nm=100.0),
}
"""Priors by name; the first is the default.

In "chart" and "smooth" the near-infrared reflectance correlates with the visible one, so infrared
electrons carry information about color; in the "nir" priors they carry none.
"""
DEFAULT_PRIOR = "chart-nir"
"""Name of the training set that trained matrices use unless another is given."""


@lru_cache(maxsize=16)
def training_named(
    prior: str | Spectra, illuminant: Illuminant, observer: str = DEFAULT_OBSERVER
) -> Training:
    """The training set of a prior under a lamp, cached per lamp for sweeps.

    Parameters
    ----------
    prior
        A name from `PRIORS`, or reflectances on the grid of the lamp, which are used as they are.
    observer
        A name from `chromanoise.spectra.OBSERVERS`.
    """
    if isinstance(prior, str):
        name = check.one_of("prior", prior, tuple(PRIORS))
        return replace(PRIORS[name](illuminant), observer=observer)
    return Training(
        illuminant=illuminant,
        reflectance=prior.values.T,
        names=prior.names,
        source=prior.source,
        notes=prior.notes,
        observer=observer,
    )


def refuse_unknown_prior(prior: str | Spectra) -> None:
    """Refuse a name that is none of `PRIORS`.

    Raises
    ------
    InputError
        If there is no such name.
    """
    if isinstance(prior, str):
        check.one_of("prior", prior, tuple(PRIORS))


MatrixFunction = Callable[[OperatingPoint], ColorMatrix]
"""A function from an operating point to its color matrix: a `MatrixMaker`, or one of your own."""
OwnMatrix = GivenMatrix | Callable[[OperatingPoint], Any]
"""A matrix of one's own, or a function that returns one: 3 x p numbers [lx/e-] or a ColorMatrix."""


@dataclass(frozen=True, kw_only=True)
class MatrixMethod:
    """One method of computing a color matrix.

    Attributes
    ----------
    make
        One of the functions of `chromanoise.color` with the common signature.
    parameter
        Name of its parameter, if it has one.
    trained
        Whether it is trained on the prior.
    over_light
        Function that returns the matrices of many light levels at once; ``None`` where the matrix
        does not depend on the level.
    bounds
        Lowest and highest value of the parameter; above the highest, the gains are too small for
        double precision.
    label
        Name of the parameter in controls.
    usual
        Lowest, highest and first value of a control of the parameter.
    """

    make: Callable[..., ColorMatrix]
    parameter: str | None = None
    trained: bool = True
    over_light: Callable[..., Array] | None = None
    bounds: tuple[float, float] = (0.0, 1e15)
    label: str = ""
    usual: tuple[float, float, float] = (1e-3, 1e3, 1.0)


DEFAULT_METHOD = "kernel"
"""Name of the color matrix that every result uses unless another is given."""
_OTHER_SCALE = 2.0  # of the luminance of a white, from which a matrix gets a note
_SAME_EXPOSURE = 1e-12  # relative; a matrix keeps its digits at the exposure for which it was made

METHODS: Mapping[str, MatrixMethod] = {
    "kernel": MatrixMethod(make=kernel, trained=False),
    "least-squares": MatrixMethod(make=least_squares),
    "white-preserving": MatrixMethod(make=white_preserving),
    "lmmse": MatrixMethod(make=lmmse, over_light=lmmse_over_light),
    "ridge": MatrixMethod(
        make=ridge,
        parameter="strength",
        bounds=(0.0, 1e6),
        label="Strength of the ridge",
        usual=(1e-6, 10.0, 0.01),
    ),
    "noise-regularized": MatrixMethod(
        make=noise_regularized,
        parameter="weight",
        over_light=lmmse_over_light,
        label="Weight of the noise",
    ),
    "noise-aware": MatrixMethod(
        make=noise_aware,
        parameter="weight",
        over_light=noise_aware_over_light,
        label="Weight of the noise",
    ),
    "bounded-psi": MatrixMethod(
        make=bounded_psi,
        parameter="limit",
        bounds=(1e-15, 1e15),
        label="Largest noise gain Ψ",
        usual=(1.0, 20.0, 6.5),
    ),
}
"""The methods of a color matrix by name."""


@dataclass(frozen=True, kw_only=True)
class MatrixMaker:
    """A method with its parameters, metric and prior: gives the matrix of an operating point.

    Attributes
    ----------
    metric
        Metric of the space of spectra.
    prior
        For a trained method: a name from `PRIORS`, or reflectances on the grid of the light.
    parameters
        Names and values of the parameters of the method.
    given
        The matrix of a file or array, used in place of the method.
    own
        A function of one's own with its name, used in place of the method. It receives the
        operating point and returns 3 x p numbers, raw electrons to X, Y, Z [lx/e-], or a
        `ColorMatrix`.
    """

    method: MatrixMethod
    metric: Metric
    prior: str | Spectra = DEFAULT_PRIOR
    parameters: tuple[tuple[str, float], ...] = ()
    given: GivenMatrix | None = None
    own: tuple[str, Callable[[OperatingPoint], Any]] | None = None

    def __call__(self, operating_point: OperatingPoint) -> ColorMatrix:
        """The color matrix of an operating point. [lx/e-]"""
        if self.own is not None:
            return _own_color_matrix(operating_point, *self.own, self.metric)
        if self.given is not None:
            return given_color_matrix(operating_point, self.given, self.metric)
        made = self._made(operating_point)
        notes = self._prior_notes()
        return replace(made, notes=notes) if notes else made

    def _made(self, operating_point: OperatingPoint) -> ColorMatrix:
        sensor, exposure = operating_point.sensor, operating_point.exposure
        training = self._training(operating_point)
        if self.method.over_light is None:
            make = self.method.make
            parameters = self._parameters(operating_point)
            return _of_any_light(sensor, make, exposure, training, self.metric, parameters)
        return self.method.make(
            sensor,
            exposure,
            training,
            level_lux=operating_point.level_lux,
            metric=self.metric,
            **dict(self.parameters),
        )

    def over_levels(
        self, operating_point: OperatingPoint, level_lux: Float[Array, " k"]
    ) -> Float[Array, "k c p"] | None:
        """The color matrices at many light levels, computed at once. [lx/e-]

        ``None`` if one matrix, that of the operating point, applies to all levels.

        Parameters
        ----------
        operating_point
            The operating point; its light level is ignored.
        level_lux
            Illuminances, > 0. [lx]

        Raises
        ------
        InputError
            If a level is not positive.
        """
        if self.own is not None:
            points = (replace(operating_point, level_lux=float(one)) for one in level_lux)
            return np.stack([self(point).matrix for point in points])
        if self.method.over_light is None:
            return None
        return self.method.over_light(
            operating_point.sensor,
            operating_point.exposure,
            self._training(operating_point),
            level_lux,
            **dict(self.parameters),
        )

    def _prior_notes(self) -> tuple[str, ...]:
        """What was read from the file of the training set."""
        if not self.method.trained or isinstance(self.prior, str):
            return ()
        title = f"prior: {len(self.prior.names)} reflectances of {chart_title(self.prior)}"
        return ("; ".join((title, *self.prior.notes)),)

    def _training(self, operating_point: OperatingPoint) -> Training | None:
        if not self.method.trained:
            return None
        return training_named(self.prior, operating_point.illuminant, operating_point.observer)

    def _parameters(self, operating_point: OperatingPoint) -> tuple[tuple[str, Any], ...]:
        """The parameters of the method, with the observer where no training set holds it."""
        if self.method.trained:
            return self.parameters
        return (*self.parameters, ("observer", operating_point.observer))


def matrix_makers(
    names: Sequence[str],
    metric: Metric,
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
    own: Mapping[str, OwnMatrix] | None = None,
) -> Mapping[str, MatrixMaker]:
    """The color matrix methods with the given names.

    Parameters
    ----------
    names
        Names from `METHODS`; a method with a parameter as ``name=value``, e.g. ``ridge=0.01``; or
        files for ``read_matrix``.
    metric
        Metric of the space of spectra.
    prior
        The training set of trained matrices: a name from `PRIORS`, or reflectances on the grid.
    own
        Matrices and functions of one's own, by their word in ``names``; the result has them by
        their name.

    Raises
    ------
    InputError
        If there is no method of that name, a file holds no matrix, or a parameter is missing, not a
        number, out of bounds or superfluous.
    """
    refuse_unknown_prior(prior)
    wanted = [name.strip() for name in names]
    check.distinct("names of matrices", list(map(shown_word, wanted)))
    return {
        shown_word(name): _maker(shown_word(name), metric, prior, (own or {}).get(name))
        for name in wanted
    }


def trained_names(names: Sequence[str]) -> list[str]:
    """The names among ``names`` whose matrix is trained on the prior.

    Parameters
    ----------
    names
        Names of methods of color matrices.

    Raises
    ------
    InputError
        If there is no method of that name.
    """
    words = [name.strip() for name in names]
    return [
        word
        for word in words
        if not is_matrix_file(word) and not is_object_word(word) and _method(word).trained
    ]


def known_matrices() -> str:
    """The names of the methods, with their parameters and bounds."""
    return ", ".join(
        f"{name}=<{m.parameter}> ({m.bounds[0]:g} to {m.bounds[1]:g})" if m.parameter else name
        for name, m in METHODS.items()
    )


def _maker(name: str, metric: Metric, prior: str | Spectra, own: OwnMatrix | None) -> MatrixMaker:
    if own is None and is_matrix_file(name):
        own = _read(name)
    if isinstance(own, GivenMatrix):
        return MatrixMaker(method=METHODS[DEFAULT_METHOD], metric=metric, given=own)
    if own is not None:
        return MatrixMaker(method=METHODS[DEFAULT_METHOD], metric=metric, own=(name, own))
    word, given, text = name.partition("=")
    method = _method(name)
    if bool(given) != (method.parameter is not None):
        wanted = f"{word}=<{method.parameter}>" if method.parameter else word
        raise InputError("matrix", f"must be given as {wanted}", value=name)
    parameters: tuple[tuple[str, float], ...] = ()
    if method.parameter:
        what = f"{method.parameter} of a {word} matrix"
        value = check.number(text, f"matrix {name!r}", "must end in a number")
        try:
            parameters = ((method.parameter, check.within(what, "1", value, *method.bounds)),)
        except InputError as error:
            raise error.within("matrix") from None
    return MatrixMaker(method=method, metric=metric, prior=prior, parameters=parameters)


def _own_color_matrix(
    operating_point: OperatingPoint,
    name: str,
    function: Callable[[OperatingPoint], Any],
    metric: Metric,
) -> ColorMatrix:
    """What a function of one's own returns, as a color matrix of the sensor and the observer."""
    try:
        made = function(operating_point)
    except InputError as error:
        raise error.within(f"matrix of {name}") from error
    except Exception as error:  # a function of the user's may raise anything
        raise InputError(
            f"function {name}",
            "must return a matrix",
            value=str(error),
            found=f"raised {type(error).__name__}: {error}",
        ) from error
    if isinstance(made, ColorMatrix):
        channels = operating_point.sensor.names
        if made.channels != channels or made.observer != operating_point.observer:
            raise InputError(
                f"matrix of {name}",
                f"must be for the channels {', '.join(channels)} and the observer "
                f"{operating_point.observer}",
                value=made.channels,
                found=f"is for {', '.join(made.channels)} and {made.observer}",
            )
        return made
    return given_color_matrix(operating_point, matrix_of_array(made, name), metric)


def _read(name: str) -> GivenMatrix:
    path = file_of(name)
    if not path.exists():
        raise InputError(
            "matrix",
            f"must be a file, or one of {', '.join(METHODS)}",
            value=name,
            found=f"there is no file {name}",
        )
    return read_matrix(path)


def given_color_matrix(
    operating_point: OperatingPoint, given: GivenMatrix, metric: Metric
) -> ColorMatrix:
    """The matrix of a file at an operating point.

    Parameters
    ----------
    operating_point
        Sensor, exposure, light and observer. A balanced matrix applies to raw over the raw of a
        perfect white in this light; X, Y and Z of the file count as those of the observer.
    given
        The matrix of a file.
    metric
        Metric of the frame that is reported with the matrix.

    Raises
    ------
    InputError
        If the channels differ, or a channel or the white gives no signal in this light.
    """
    sensor, exposure = operating_point.sensor, operating_point.exposure
    if given.observer not in ("", operating_point.observer):
        raise InputError(
            f"matrix of {given.source}",
            f"must be of the observer {operating_point.observer}",
            value=given.observer,
            found=f"is of {given.observer}",
            remedy=Setting("observer", (given.observer,)),
        )
    frame = kernel_matrix(sensor, exposure, metric, operating_point.observer)
    frame = replace(frame, made_by=f"given in {given.source}", notes=_notes(given, operating_point))
    values = _in_channel_order(given, sensor.names)
    if given.kind == "electrons":
        own = exposure.time_s * sensor.pixel.pitch_um**2 / exposure.f_number**2
        made_for = own if given.light_time is None else given.light_time
        scale = 1.0 if abs(made_for / own - 1) < _SAME_EXPOSURE else made_for / own
        return _with_scale_notes(replace(frame, matrix=values * scale), operating_point)
    white = white_scene(operating_point)
    white_e = expected_electrons(white, sensor, exposure)
    white_lux = scene_xyz(white, metric, operating_point.observer)
    for name, electrons in zip(sensor.names, white_e, strict=True):
        if not electrons > 0:
            raise InputError(
                f"channel {name} of {sensor.name}",
                "must see the light, for a matrix of white-balanced raw",
                value=float(electrons),
                found=f"collects nothing in {operating_point.illuminant.name}",
            )
    if given.kind == "from-xyz":  # camera values are raw electrons, up to one factor
        to_xyz = pinv(f"matrix of {given.source}", values)
        luminance = float(to_xyz[1] @ white_e)
        if not luminance > 0:
            raise InputError(
                f"matrix of {given.source}",
                "must give a perfect white in this light a luminance above 0",
                value=luminance,
            )
        return replace(frame, matrix=to_xyz * (white_lux[1] / luminance))
    if given.target == "sRGB":
        to_rgb = linear_srgb(np.eye(3), white_lux / white_lux[1]).T
        values = inv("sRGB of this white", to_rgb) @ values
    balanced = replace(frame, matrix=values * (white_lux[1] / white_e))
    return _with_scale_notes(balanced, operating_point)


def _notes(given: GivenMatrix, operating_point: OperatingPoint) -> tuple[str, ...]:
    """Which matrix it is, what the file was made for, where it differs, and a rank below 3."""
    light, notes = operating_point.illuminant.name, list(given.notes)
    differs = (
        given.sensor not in ("", operating_point.sensor.name)
        or given.illuminant not in ("", light)
        or (given.level_lux is not None and given.level_lux != operating_point.level_lux)
    )
    if differs:
        parts = [given.sensor, given.illuminant and f"illuminant {given.illuminant}"]
        parts += [] if given.level_lux is None else [f"{given.level_lux:g} lx"]
        notes.append(f"the matrix of {given.source} was made for {', '.join(filter(None, parts))}")
    rank = matrix_rank(f"matrix of {given.source}", given.values)
    if rank < len(operating_point.sensor.names) and rank < 3:
        notes.append(
            f"the matrix of {given.source} has rank {rank}: X, Y and Z are not independent"
        )
    return tuple(notes)


def _with_scale_notes(made: ColorMatrix, operating_point: OperatingPoint) -> ColorMatrix:
    """Noted where the white gets quite another luminance than it has: mostly a matter of units."""
    white = white_scene(operating_point)
    white_e = expected_electrons(white, operating_point.sensor, operating_point.exposure)
    luminance_lux, level_lux = float(made.matrix[1] @ white_e), operating_point.level_lux
    if not luminance_lux > 0 or 1 / _OTHER_SCALE < luminance_lux / level_lux < _OTHER_SCALE:
        return made
    note = (
        f"the matrix makes {luminance_lux:.3g} lx of a perfect white of {level_lux:g} lx: check "
        "its unit; SNR, color error and visual noise do not depend on this factor"
    )
    return replace(made, notes=(*made.notes, note))


def _in_channel_order(given: GivenMatrix, names: tuple[str, ...]) -> Float[Array, "a b"]:
    """The values with one column (row of a profile) per channel, in the order of the sensor."""
    values, axis = given.values, 0 if given.kind == "from-xyz" else 1
    if values.shape[axis] != len(names):
        raise InputError(
            f"matrix of {given.source}",
            f"must be for the {len(names)} channels {', '.join(names)}",
            value=values.shape,
            found=f"is for {values.shape[axis]}",
        )
    if not given.channels:
        return values
    if sorted(given.channels) != sorted(names):
        raise InputError(
            f"matrix of {given.source}",
            f"must be for the channels {', '.join(names)}",
            value=given.channels,
            found=f"is for {', '.join(given.channels)}",
        )
    return np.take(values, [given.channels.index(name) for name in names], axis=axis)


def _method(name: str) -> MatrixMethod:
    word = name.partition("=")[0].strip()
    return METHODS[check.one_of("matrix", word, tuple(METHODS))]


@kept
def _of_any_light(
    sensor: Sensor,
    make: Callable[..., ColorMatrix],
    exposure: Exposure,
    training: Training | None,
    metric: Metric,
    parameters: tuple[tuple[str, Any], ...],
) -> ColorMatrix:
    """The matrix of one exposure, which is the same at every light level."""
    return make(sensor, exposure, training, level_lux=1.0, metric=metric, **dict(parameters))
