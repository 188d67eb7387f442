"""White-preserving color matrices of least error plus weighted noise, up to a gray picture.

Of the matrices that are exact on a perfect white, a weight w of the noise selects the one of least
E|C M - XYZ|^2 + w tr(C D C^T), D the covariance averaged over the training set. A weight of 0 is
least squares, 1 gives the least total error, and an infinite weight the least noise, in a gray
picture. In noise-whitened channels (C^T = W y with W^T D W = 1) the white
demands a^T y = XYZ with a = W^T m. The part of y along a is the gray matrix. The rest is a ridge
problem, and one singular value decomposition serves all weights.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Bool,
    Float,
    check,
    orthogonal_complement,
    qr,
    svd,
    whitening,
)
from chromanoise.color.matrices import ColorMatrix, kernel_matrix
from chromanoise.color.training import Training, training_response
from chromanoise.noise import Exposure, mean_noise_covariance
from chromanoise.sensor import Sensor
from chromanoise.spectra import Metric

_BEYOND = 1e3  # of the least and the largest singular value of a whitened training set, squared


def noise_aware(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    weight: float,
) -> ColorMatrix:
    """The white-preserving matrix of least squared color error plus ``weight`` times the noise.

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the set; D is the mean covariance of the readings there. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    weight
        Weight of tr(C D C^T): 0 is the white-preserving least squares, 1 has the least total error
        in X, Y and Z of all white-preserving matrices. [1]

    Raises
    ------
    InputError
        As `white_preserving`, and if the weight is negative.

    Notes
    -----
    Vora & Herley (ICIP 1998) with the constraint of Finlayson & Drew (CIC5, 1997).
    """
    check.not_negative("weight of the noise", "1", weight)
    family = NoiseAwareFamily(sensor, exposure, training, level_lux=level_lux)
    matrix = family.matrices(np.array([weight]))[0]
    framed = kernel_matrix(sensor, exposure, metric, training.observer)
    made_by = f"noise-aware {weight:g} at {level_lux:g} lx ({training.source})"
    return replace(framed, matrix=matrix, made_by=made_by)


def noise_aware_over_light(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    level_lux: Float[Array, " k"],
    *,
    weight: float = 1.0,
) -> Float[Array, "k 3 p"]:
    """The matrices of `noise_aware` for many light levels. [lx/e-]

    Parameters
    ----------
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminances on the set, > 0. [lx]
    weight
        As `noise_aware`. [1]

    Raises
    ------
    InputError
        As `noise_aware`, or if a level is not positive.
    """
    check.not_negative("weight of the noise", "1", weight)
    levels = check.non_negative("level_lux", "lx", level_lux)
    check.positive("smallest level_lux", "lx", float(levels.min()))
    family = NoiseAwareFamily(sensor, exposure, training, level_lux=float(levels[0]))
    weights = np.array([weight])
    return np.stack([one.matrices(weights)[0] for one in family.in_lights(levels / levels[0])])


class NoiseAwareFamily:
    """The matrices of `noise_aware` for all weights of the noise.

    Parameters
    ----------
    sensor, exposure, training, level_lux
        As `noise_aware`.

    Raises
    ------
    InputError
        As `noise_aware`.
    """

    _gray: Float[Array, "c p"]  # of the used channels, as the next ones
    _directions: Float[Array, "p s"]
    _s: Float[Array, " s"]
    _turn: Float[Array, "s s"]
    _target: Float[Array, "s c"]
    _kept: Bool[Array, " s"]

    def __init__(
        self, sensor: Sensor, exposure: Exposure, training: Training, *, level_lux: float
    ) -> None:
        seen = training_response(training, sensor, exposure, level_lux=level_lux)
        white = f"white of {sensor.name} in {training.illuminant.name}"
        check.positive(white, "e-", seen.white_e.max())
        self._what = f"noise-aware matrices of {sensor.name}"
        self._seen, self._sensor, self._exposure = seen, sensor, exposure
        electrons, xyz = seen.weighted
        turn, self._relative = qr(self._what, electrons / seen.scale)
        self._xyz = turn.T @ xyz
        self._noise_e2 = seen.noise_e2
        self._used = seen.white_e > 0
        self._solved([self])

    def in_lights(self, factors: Float[Array, " k"]) -> "list[NoiseAwareFamily]":
        """The family at other light levels; spectra and their colors are kept.

        Parameters
        ----------
        factors
            Each light over that of this family. [1]
        """
        seen, found = self._seen, [copy(self) for _ in factors]
        others = np.flatnonzero(factors != 1)
        if others.size:
            given = (seen.electrons, seen.share, self._sensor, self._exposure)
            light = factors[others]
            noise_e2 = mean_noise_covariance(*given, light=light) / light[:, None, None] ** 2
            for k, own_e2 in zip(others, noise_e2, strict=True):
                found[k]._noise_e2 = own_e2
            self._solved([found[k] for k in others])
        return found

    @staticmethod
    def with_channels(
        families: "Sequence[NoiseAwareFamily]", used: Bool[Array, " p"]
    ) -> "list[NoiseAwareFamily]":
        """The families of the matrices that use only these channels.

        Parameters
        ----------
        families
            From one family `in_lights`.
        used
            True for each channel that may have a weight, in the order of the sensor.
        """
        fewer = [copy(one) for one in families]
        for one in fewer:
            one._used = used & (one._seen.white_e > 0)
        return fewer[0]._solved(fewer) if fewer else fewer

    @property
    def used(self) -> Bool[Array, " p"]:
        """The channels that the matrices weigh: by default those that see the light."""
        return self._used

    def _solved(self, families: "list[NoiseAwareFamily]") -> "list[NoiseAwareFamily]":
        """Separate gray from the directions orthogonal to it, in noise-whitened channels.

        The families share their channels, and differ from this one in noise and channels alone.
        """
        used = families[0]._used
        scale, relative = self._seen.scale[used], self._relative[:, used]
        noise_e2 = np.stack([one._noise_e2[np.ix_(used, used)] for one in families])
        unit = whitening(self._what, noise_e2 / np.outer(scale, scale))
        toward = unit.sum(axis=-2)  # of the white, a row of ones
        weights = (unit @ toward[..., None])[..., 0] / (toward**2).sum(axis=-1, keepdims=True)
        gray = self._seen.white_xyz[:, None] * weights[:, None]
        directions = unit @ orthogonal_complement(toward)
        left, s, turn = svd(self._what, relative @ directions, full_matrices=False)
        target = np.swapaxes(left, -1, -2) @ (self._xyz - relative @ np.swapaxes(gray, -1, -2))
        kept = s > RANK_TOLERANCE * s.max(axis=-1, keepdims=True, initial=0.0)
        for i, one in enumerate(families):
            one._gray, one._directions, one._target = gray[i], directions[i], target[i]
            one._s, one._turn, one._kept = s[i], turn[i], kept[i]
        return families

    def weights(self, per_decade: int = 12) -> Float[Array, " q"]:
        """Weights from 0 to infinity, dense where the matrix changes. [1]

        That is around the squares of the singular values of the training set in channels of unit
        noise.

        Parameters
        ----------
        per_decade
            How many weights lie between one and ten times it.
        """
        squares = self._s[self._kept] ** 2
        if not squares.size:
            return np.array([0.0, np.inf])
        low, high = squares.min() / _BEYOND, squares.max() * _BEYOND
        count = 1 + int(np.ceil(per_decade * np.log10(high / low)))
        return np.concatenate([[0.0], low * (high / low) ** np.linspace(0.0, 1.0, count), [np.inf]])

    def matrices(self, weights: Float[Array, " q"]) -> Float[Array, "q 3 p"]:
        """One matrix per weight. [lx/e-]

        Parameters
        ----------
        weights
            Weights of tr(C D C^T); an infinite one gives the matrix of least noise. [1]
        """
        s = np.where(self._kept, self._s, 1.0)
        gain = np.where(self._kept, s / (s**2 + weights[:, None]), 0.0)
        moved = (self._target.T * gain[:, None, :]) @ self._turn @ self._directions.T
        found = np.zeros((weights.size, len(self._gray), self._used.size))
        found[..., self._used] = (self._gray + moved) / self._seen.scale[self._used]
        return found
