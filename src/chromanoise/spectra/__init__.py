"""The wavelength grid, spectral curves, illuminants, observers, reflectances and the metric."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.spectra.builtin_scenes import (
        BUILTIN_CUBES as BUILTIN_CUBES,
        PATCH_PX,
        SLANTED_EDGES as SLANTED_EDGES,
        Region,
        SlantedEdge as SlantedEdge,
        builtin_cube as builtin_cube,
        checker_cube as checker_cube,
        dead_leaves_cube as dead_leaves_cube,
        foliage_cube as foliage_cube,
        patch_corners,
        slanted_edges_cube as slanted_edges_cube,
    )
    from chromanoise.spectra.curves import (
        DEFAULT_GRID as DEFAULT_GRID,
        METRICS as METRICS,
        SMALL_NEGATIVES as SMALL_NEGATIVES,
        Beyond as Beyond,
        Grid as Grid,
        Metric as Metric,
        Spectra as Spectra,
        are_small_negatives,
        interpolation_matrix as interpolation_matrix,
        is_extrapolation_note,
        means_on_grid as means_on_grid,
        on_grid as on_grid,
        photons_per_unit,
        refuse_outside as refuse_outside,
        shifted as shifted,
        used_on_grid as used_on_grid,
    )
    from chromanoise.spectra.illuminants import (
        Illuminant as Illuminant,
        astm_g173 as astm_g173,
        black_body as black_body,
        cie_a as cie_a,
        cie_illuminant as cie_illuminant,
        equal_energy as equal_energy,
        halogen as halogen,
        illuminant_from as illuminant_from,
        illuminant_named as illuminant_named,
        infrared_parts as infrared_parts,
        is_light_name as is_light_name,
        led as led,
        led_white as led_white,
        mixed as mixed,
        photon_irradiance as photon_irradiance,
        with_infrared as with_infrared,
    )
    from chromanoise.spectra.observers import (
        DEFAULT_OBSERVER as DEFAULT_OBSERVER,
        INFRARED_FROM_NM as INFRARED_FROM_NM,
        OBSERVERS as OBSERVERS,
        OwnObserver as OwnObserver,
        cie_1931 as cie_1931,
        color_axes as color_axes,
        color_matching_functions as color_matching_functions,
        is_infrared as is_infrared,
        known_observer as known_observer,
        observer_notes as observer_notes,
        observer_table as observer_table,
    )
    from chromanoise.spectra.provenance import (
        SOURCES,
        Provenance,
        UserTable,
        user_curves,
        user_tables,
    )
    from chromanoise.spectra.readers import read_spectra_csv as read_spectra_csv
    from chromanoise.spectra.reflectances import (
        PatchPairs as PatchPairs,
        all_pairs as all_pairs,
        chart_on as chart_on,
        chart_title as chart_title,
        colorchecker as colorchecker,
        reflectance_named as reflectance_named,
    )
    from chromanoise.spectra.scene import (
        BRIGHTEST,
        Cube as Cube,
        Scene as Scene,
        bands_within as bands_within,
        flat_cube as flat_cube,
        flat_field as flat_field,
        light as light,
        reflectance_rows,
    )
    from chromanoise.spectra.scene_rows import (
        ArrayRows,
        FileRows,
        PaletteRows,
        PlaneRows,
        ReorderedRows,
        RowSource as RowSource,
        block,
        refuse_other_rows,
        row_source as row_source,
        with_bands,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
