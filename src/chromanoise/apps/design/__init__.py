"""Search over filters, IR-cut, pixel shares, exposure and matrix of a sensor.

A design file: ``read_design``, ``optimized`` and the `Design` that it returns. In Python: a
`DesignSpace` of channels and filters, `Objectives` in scenes, a `Problem` of any
functions, and ``searched_front``, which minimizes it. The effects of small changes of one sensor:
``sensitivity_of``.
"""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.apps.design.algorithms import METHODS as METHODS
    from chromanoise.apps.design.design_document import (
        DESIGN_STARTER as DESIGN_STARTER,
        DesignStudy as DesignStudy,
        with_effort as with_effort,
    )
    from chromanoise.apps.design.design_result import (
        CHECKPOINT,
        Design as Design,
        optimized as optimized,
        read_design as read_design,
        searched as searched,
    )
    from chromanoise.apps.design.evaluation import (
        DesignScene as DesignScene,
        Objectives as Objectives,
    )
    from chromanoise.apps.design.front_charts import drawn_front
    from chromanoise.apps.design.front_figures import (
        draw_front as draw_front,
        draw_sensitivity as draw_sensitivity,
        front_figure as front_figure,
    )
    from chromanoise.apps.design.objectives import (
        OBJECTIVES as OBJECTIVES,
        Candidate as Candidate,
        Objective as Objective,
        value_of as value_of,
    )
    from chromanoise.apps.design.optimizing import (
        Reference as Reference,
        Task as Task,
        task_of as task_of,
    )
    from chromanoise.apps.design.parameters import (
        Candidates as Candidates,
        Free as Free,
        Parameter as Parameter,
    )
    from chromanoise.apps.design.pareto_front import (
        FRONT_SCHEMA as FRONT_SCHEMA,
        Evaluated as Evaluated,
        Front as Front,
        FrontFile as FrontFile,
        FrontMember as FrontMember,
        FrontObjective as FrontObjective,
        FrontReference as FrontReference,
        FrontScene as FrontScene,
        Linearized as Linearized,
        Member as Member,
        Problem as Problem,
        front_of as front_of,
        member_csv as member_csv,
        read_front as read_front,
    )
    from chromanoise.apps.design.search import (
        FrontResult as FrontResult,
        Progress as Progress,
        SearchOptions as SearchOptions,
        scheduler_at as scheduler_at,
        searched_front as searched_front,
    )
    from chromanoise.apps.design.sensitivity import (
        DEFAULT_OBJECTIVES as DEFAULT_OBJECTIVES,
        Effect as Effect,
        HalfWidths as HalfWidths,
        Sensitivity as Sensitivity,
        half_widths as half_widths,
        sensitivity_of as sensitivity_of,
    )
    from chromanoise.apps.design.space import (
        Channel as Channel,
        DesignSpace as DesignSpace,
        Filter as Filter,
    )

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    DesignDocument="DesignStudy",
    Evaluator="Objectives",
    SearchResult="FrontResult",
    SearchSettings="SearchOptions",
)
