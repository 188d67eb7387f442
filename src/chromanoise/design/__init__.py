"""Search over filters, IR-cut, pixel shares, exposure and matrix of a sensor.

A design file: ``read_design``, ``optimized`` and the `Design` that it returns. In Python: a
`DesignSpace` of channels and filters, `Objectives` in scenes, a `Problem` of any
functions, and ``searched_front``, which minimizes it. The effects of small changes of one sensor:
``sensitivity_of``.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.design.algorithms import METHODS as METHODS
    from chromanoise.design.candidates import Candidates as Candidates
    from chromanoise.design.document import DesignStudy as DesignStudy, with_effort as with_effort
    from chromanoise.design.evaluation import Objectives as Objectives
    from chromanoise.design.front import Front as Front, Member as Member, front_of as front_of
    from chromanoise.design.front_file import (
        FRONT_SCHEMA as FRONT_SCHEMA,
        FrontFile as FrontFile,
        FrontMember as FrontMember,
        FrontObjective as FrontObjective,
        FrontReference as FrontReference,
        FrontScene as FrontScene,
        member_csv as member_csv,
        read_front as read_front,
    )
    from chromanoise.design.objectives import (
        OBJECTIVES as OBJECTIVES,
        Candidate as Candidate,
        Objective as Objective,
        value_of as value_of,
    )
    from chromanoise.design.optimizing import (
        Reference as Reference,
        Task as Task,
        searched as searched,
        task_of as task_of,
    )
    from chromanoise.design.outputs import optimized as optimized, read_design as read_design
    from chromanoise.design.parameters import Free as Free, Parameter as Parameter
    from chromanoise.design.problem import (
        Evaluated as Evaluated,
        Linearized as Linearized,
        Problem as Problem,
    )
    from chromanoise.design.result import Design as Design
    from chromanoise.design.scenes import DesignScene as DesignScene
    from chromanoise.design.scheduler import scheduler_at as scheduler_at
    from chromanoise.design.search import (
        FrontResult as FrontResult,
        Progress as Progress,
        SearchOptions as SearchOptions,
        searched_front as searched_front,
    )
    from chromanoise.design.sensitivity import (
        DEFAULT_OBJECTIVES as DEFAULT_OBJECTIVES,
        Effect as Effect,
        HalfWidths as HalfWidths,
        Sensitivity as Sensitivity,
        half_widths as half_widths,
        sensitivity_of as sensitivity_of,
    )
    from chromanoise.design.space import (
        Channel as Channel,
        DesignSpace as DesignSpace,
        Filter as Filter,
    )
    from chromanoise.design.starter import DESIGN_STARTER as DESIGN_STARTER

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    DesignDocument="DesignStudy",
    Evaluator="Objectives",
    SearchResult="FrontResult",
    SearchSettings="SearchOptions",
)
