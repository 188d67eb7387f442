"""The wavelength grid, spectral curves, illuminants, observers, reflectances and the metric."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.spectra.curves import (
        SMALL_NEGATIVES,
        Beyond,
        Spectra,
        interpolation_matrix,
        means_on_grid,
        on_grid,
        refuse_outside,
        shifted,
        used_on_grid,
    )
    from chromanoise.spectra.grid import DEFAULT_GRID, Grid
    from chromanoise.spectra.illuminants import (
        Illuminant,
        astm_g173,
        black_body,
        cie_a,
        cie_illuminant,
        equal_energy,
        halogen,
        illuminant_from,
        illuminant_named,
        infrared_parts,
        is_light_name,
        led,
        led_white,
        mixed,
        photon_irradiance,
        with_infrared,
    )
    from chromanoise.spectra.metric import METRICS, Metric
    from chromanoise.spectra.observers import (
        DEFAULT_OBSERVER,
        INFRARED_FROM_NM,
        OBSERVERS,
        OwnObserver,
        cie_1931,
        color_axes,
        color_matching_functions,
        is_infrared,
        known_observer,
        observer_notes,
        observer_table,
    )
    from chromanoise.spectra.readers import read_spectra_csv
    from chromanoise.spectra.reflectances import (
        PatchPairs,
        all_pairs,
        chart_on,
        chart_title,
        colorchecker,
        reflectance_named,
    )

__all__ = [
    "DEFAULT_GRID",
    "DEFAULT_OBSERVER",
    "INFRARED_FROM_NM",
    "METRICS",
    "OBSERVERS",
    "SMALL_NEGATIVES",
    "Beyond",
    "Grid",
    "Illuminant",
    "Metric",
    "OwnObserver",
    "PatchPairs",
    "Spectra",
    "all_pairs",
    "astm_g173",
    "black_body",
    "chart_on",
    "chart_title",
    "cie_1931",
    "cie_a",
    "cie_illuminant",
    "color_axes",
    "color_matching_functions",
    "colorchecker",
    "equal_energy",
    "halogen",
    "illuminant_from",
    "illuminant_named",
    "infrared_parts",
    "interpolation_matrix",
    "is_infrared",
    "is_light_name",
    "known_observer",
    "led",
    "led_white",
    "means_on_grid",
    "mixed",
    "observer_notes",
    "observer_table",
    "on_grid",
    "photon_irradiance",
    "read_spectra_csv",
    "reflectance_named",
    "refuse_outside",
    "shifted",
    "used_on_grid",
    "with_infrared",
]
__getattr__, __dir__ = lazy_names(__name__)
