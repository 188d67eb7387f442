"""Charts of results: columns of numbers, panels with axes and marks, tables and sentences.

A chart is a `Chart`, or plain data where its drawing is special. The page draws it in SVG; figures
draw it with Matplotlib. An undefined value is ``None``; a panel without data states the reason in
its ``absence``.
"""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.charts.budget_chart import cause_label as cause_label
    from chromanoise.charts.card import (
        PAPERS_IN,
        Card as Card,
        Paper as Paper,
        card_ending,
        card_of as card_of,
    )
    from chromanoise.charts.charted_study import (
        MOST_ON_CARD,
        Look as Look,
        Shown as Shown,
        shown as shown,
        shown_at as shown_at,
    )
    from chromanoise.charts.description import Chart as Chart, as_data as as_data
    from chromanoise.charts.explanations import (
        EXPLANATIONS,
        coordinate_mathml,
        explanation_as_json,
        mathml,
    )
    from chromanoise.charts.figure_style import (
        FAINT,
        INK,
        QUIET,
        as_index,
        channel_color as channel_color,
        chromanoise_style as chromanoise_style,
        figure_bytes,
        framed_figure,
        paled,
        sensor_label,
        sensor_lines as sensor_lines,
        sensor_mark,
        shade_nir,
        write_beside,
        write_figures as write_figures,
        write_heading,
    )
    from chromanoise.charts.figures_of_study import (
        draw_color_errors as draw_color_errors,
        draw_comparison as draw_comparison,
        draw_maps as draw_maps,
        draw_sensitivities as draw_sensitivities,
        map_figures as map_figures,
        study_figures as study_figures,
    )
    from chromanoise.charts.levels import at_level, level_curves
    from chromanoise.charts.machine_verdicts import machine_tables as machine_tables
    from chromanoise.charts.numbers import NONE, brief, decimal, electrons, listed, table
    from chromanoise.charts.registry import (
        DRAWINGS as DRAWINGS,
        PARTS as PARTS,
        SECTIONS,
        Section,
        chart_csv as chart_csv,
        chart_rows as chart_rows,
        drawing as drawing,
    )
    from chromanoise.charts.result_figures import (
        draw_analyses as draw_analyses,
        draw_budget as draw_budget,
        draw_capture as draw_capture,
        draw_ellipses as draw_ellipses,
        draw_flow as draw_flow,
        draw_league as draw_league,
        draw_matrices as draw_matrices,
        draw_panels as draw_panels,
        draw_pareto as draw_pareto,
        draw_picture as draw_picture,
    )
    from chromanoise.charts.run_tables import (
        channels_table,
        color_table,
        outcome_tables,
        pareto_table,
    )
    from chromanoise.charts.sensor_table import sensor_values
    from chromanoise.charts.verdicts import (
        matrices_in_words,
        verdict_of as verdict_of,
        verdict_sentences as verdict_sentences,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
