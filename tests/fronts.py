"""A front of sensors for tests: one sensor of the catalog behind model IR-cuts."""

from chromanoise.apps.design.pareto_front import (
    FrontCurves,
    FrontFile,
    FrontMember,
    FrontObjective,
    FrontReference,
    FrontScene,
)
from chromanoise.study import makers_of, operating_points_of, study_from_data
from chromanoise.study.schema import ExposurePart, LightPart, PixelPart
from chromanoise.study.sweeps import QUANTITIES

LIGHT = {"illuminant": "A", "level_lux": 5.0}
EXPOSURE = {"time_ms": 8.0}
MATRIX = "noise-regularized=1"
EDGES_NM = (620, 650, 680, 720, 760, 800)
REFERENCES = ("onyx-rgbw", "onyx-rgb-ircut")
_OBJECTIVES = {"snr_y_db": "snr-y", "color_error": "color-error", "bound_db": "bound"}


def front_of_ir_cuts(edges_nm=EDGES_NM):
    """SNR of Y, color error and the bound of the SNR over the edge of the IR-cut."""
    cuts = [{"name": "onyx-rgbw", "ircut_nm": edge} for edge in edges_nm]
    study = study_from_data(
        {
            "light": LIGHT,
            "exposure": EXPOSURE,
            "matrices": [MATRIX],
            "sensors": [*({"name": name} for name in REFERENCES), *cuts],
        }
    )
    points, maker = operating_points_of(study), makers_of(study)[MATRIX]
    quantities = {name: QUANTITIES[one] for name, one in _OBJECTIVES.items()}
    values = [
        {name: one.of(point, maker(point)) for name, one in quantities.items()} for point in points
    ]
    first = len(REFERENCES)
    most = max(one["snr_y_db"] for one in values[first:])
    return FrontFile(
        objectives=[
            FrontObjective(
                name=name,
                what=one.what,
                unit=one.unit,
                better="higher" if one.more_is_better else "lower",
            )
            for name, one in quantities.items()
        ],
        scenes=[
            FrontScene(
                name="lamp",
                light=LightPart(**LIGHT),
                exposure=ExposurePart(**EXPOSURE),
                matrix=MATRIX,
            )
        ],
        references=[
            FrontReference(name=name, objectives=one)
            for name, one in zip(REFERENCES, values, strict=False)
        ],
        members=[
            FrontMember(
                name=f"front-{i:03d}",
                sensor=f"sensors/front-{i:03d}.csv",
                objectives=one,
                extreme_of=["snr_y_db"] if one["snr_y_db"] == most else [],
                knee=i == 2,
                held_by=["the edge at most 800 nm"] if i == len(edges_nm) else [],
                values={"ircut_nm": float(edge)},
                curves=FrontCurves(
                    wavelength_nm=point.sensor.grid.wavelength_nm.tolist(),
                    names=list(point.sensor.names),
                    qe=point.sensor.qe.tolist(),
                ),
                pixel=PixelPart(
                    pitch_um=point.sensor.pixel.pitch_um,
                    full_well_e=point.sensor.pixel.full_well_e,
                    read_noise_e=point.sensor.pixel.read_noise_e,
                    dark_reference_c=25.0,  # the default, which a study refuses if it is idle
                ),
            )
            for i, (edge, point, one) in enumerate(
                zip(edges_nm, points[first:], values[first:], strict=True), 1
            )
        ],
        sentences=["front-002 has 1 dB less than the best."],
    )
