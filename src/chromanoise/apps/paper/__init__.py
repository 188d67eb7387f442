"""The paper's own study: Tables 2-5 and the figures (Clouet et al., CIC27, 2019)."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.apps.paper.figures_of_paper import (
        CAPTIONS as CAPTIONS,
        draw_color_projection as draw_color_projection,
        draw_color_uncertainty as draw_color_uncertainty,
        draw_contravariant as draw_contravariant,
        draw_light_above_plane as draw_light_above_plane,
        draw_measurement as draw_measurement,
        draw_mosaic as draw_mosaic,
        draw_observer as draw_observer,
        draw_uncertainty as draw_uncertainty,
        paper_figures as paper_figures,
    )
    from chromanoise.apps.paper.printed_numbers import (
        PRINTED_TIMES_MS,
        RGB_12,
        RGBW_12,
        WELL_SHARE,
        PaperStudy as PaperStudy,
        paper_pictures,
        paper_study as paper_study,
    )
    from chromanoise.apps.paper.reproduction import (
        Cell as Cell,
        PaperTable as PaperTable,
        Reproduction as Reproduction,
        as_printed as as_printed,
        luminance_budget as luminance_budget,
        metric_remark as metric_remark,
        paper_tables as paper_tables,
        reproduced as reproduced,
        reproduction_as_json as reproduction_as_json,
        set_aside_reasons as set_aside_reasons,
        table_5_finding as table_5_finding,
        verdict as verdict,
        witnessed_columns as witnessed_columns,
    )
    from chromanoise.apps.paper.views import (
        PaperPlanes as PaperPlanes,
        paper_planes as paper_planes,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
