"""Figures of merit of filters: against the observer, and for the ColorChecker as a prior."""

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.figures_of_merit.entries import Merit, merit_or_reason, refuse_full
from chromanoise.color import LAB, scene_xyz
from chromanoise.exposure import expected_electrons, measurement_vectors, white_scene
from chromanoise.metrics import (
    figure_of_merit,
    filter_quality,
    information_bits,
    metamerism,
    perceptual_weight,
    principal_angles_deg,
    second_moment,
    sensor_metamerism,
    vora_value,
)
from chromanoise.noise import with_noise
from chromanoise.scene import Scene, light
from chromanoise.spectra import cie_1931, color_axes, colorchecker
from chromanoise.spectra.metric import photons_per_unit

_COLORED_PATCHES = 18  # of 24; the gray row has no metamerism


# filters against the observer


def filter_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """Neugebauer's q, Vora value and principal angles over the whole grid, for any illuminant."""
    sensor, metric = analysis.sensor, analysis.matrix.metric
    filters = measurement_vectors(sensor, analysis.exposure, metric)
    eye = color_axes(sensor.grid, metric, analysis.matrix.observer)
    q = filter_quality(filters, eye)
    angles = principal_angles_deg(filters, eye)
    qualities = (
        Merit(
            name=f"neugebauer_q_{channel}",
            what=f"Neugebauer's q of {channel}",
            unit="1",
            value=float(value),
            source="Neugebauer 1956",
        )
        for channel, value in zip(sensor.names, q, strict=True)
    )
    between = (
        Merit(
            name=f"principal_angle_{i}",
            what=f"principal angle {i} between sensor and eye",
            unit="deg",
            value=float(angle),
            source="Bjorck & Golub 1973",
        )
        for i, angle in enumerate(angles, start=1)
    )
    vora = Merit(
        name="vora_value",
        what="Vora value",
        unit="1",
        value=vora_value(filters, eye),
        source="Vora & Trussell 1993",
    )
    return (*qualities, vora, *between)


def metamerism_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """SMI in the standard's light, and in that of the analysis."""
    lamp = analysis.scene.illuminant.name
    return (
        merit_or_reason(
            "smi",
            "sensitivity metamerism index, D55, 380-780 nm",
            "1",
            "ISO 17321-1:2012, annex D",
            of=lambda: sensor_metamerism(analysis.sensor).index,
        ),
        merit_or_reason(
            "smi_lamp",
            f"the same in {lamp}, whole grid, measured ColorChecker",
            "1",
            "formula of ISO 17321-1:2012",
            of=lambda: _lamp_metamerism(analysis),
        ),
    )


def _lamp_metamerism(analysis: Analysis) -> float:
    """SMI in the lamp of the analysis: the near infrared, which the standard leaves out, counts."""
    sensor, lamp = analysis.sensor, analysis.scene.illuminant
    return metamerism(
        sensor.qe * photons_per_unit(sensor.grid, "energy")[:, None],
        cie_1931(sensor.grid).values,
        lamp.irradiance,
        colorchecker(sensor.grid).values.T[:_COLORED_PATCHES],
    ).index


# merits under a prior: the ColorChecker in this light and exposure


def chart_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """General figure of merit and information; each patch of a ColorChecker is equally likely."""
    return (
        merit_or_reason(
            "figure_of_merit",
            "share of the ColorChecker's color (CIELAB) that the best matrix keeps",
            "1",
            "Sharma & Trussell 1997, eq. 7 noise",
            of=lambda: _chart_figure(analysis),
        ),
        merit_or_reason(
            "information",
            "information of a pixel with all channels on the ColorChecker's light",
            "bit",
            "Shannon 1948",
            of=lambda: _chart_information(analysis),
            never="without noise it is not finite",
        ),
    )


def _chart_figure(analysis: Analysis) -> float:
    refuse_full(analysis)
    chart, metric = _chart(analysis), analysis.matrix.metric
    observer = analysis.matrix.observer
    white_xyz = scene_xyz(white_scene(analysis.point), metric, observer)
    return figure_of_merit(
        measurement_vectors(analysis.sensor, analysis.exposure, metric),
        color_axes(analysis.sensor.grid, metric, observer),
        light_moment=second_moment(light(chart, metric)),
        noise_covariance=_mean_noise(chart, analysis),
        weight=perceptual_weight(LAB.jacobian(scene_xyz(chart, metric, observer), white_xyz)),
    )


def _chart_information(analysis: Analysis) -> float:
    refuse_full(analysis)
    chart = _chart(analysis)
    electrons = expected_electrons(chart, analysis.sensor, analysis.exposure)
    signal = second_moment(electrons - electrons.mean(axis=0))
    return float(information_bits(signal, _mean_noise(chart, analysis)))


def _chart(analysis: Analysis) -> Scene:
    return Scene(
        illuminant=analysis.scene.illuminant,
        level_lux=analysis.scene.level_lux,
        reflectance=colorchecker(analysis.sensor.grid).values.T,
    )


def _mean_noise(scene: Scene, analysis: Analysis) -> Float[Array, "p p"]:
    """Covariance of the raw channels, mean of the patches. [e-^2]"""
    electrons = expected_electrons(scene, analysis.sensor, analysis.exposure)
    return with_noise(electrons, analysis.sensor, analysis.exposure).covariance.mean(axis=0)
