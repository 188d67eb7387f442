"""Search over filters, IR-cut, pixel shares, exposure and matrix of a sensor.

A design file: ``read_design``, ``optimized`` and the `Design` that it returns. In Python: a
`DesignSpace` of channels and filters, `Objectives` in scenes, a `Problem` of any
functions, and ``searched_front``, which minimizes it. The effects of small changes of one sensor:
``sensitivity_of``.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.design.algorithms import METHODS
    from chromanoise.design.candidates import Candidates
    from chromanoise.design.document import DesignStudy, with_effort
    from chromanoise.design.evaluation import Objectives
    from chromanoise.design.front import Front, Member, front_of
    from chromanoise.design.front_file import (
        FRONT_SCHEMA,
        FrontFile,
        FrontMember,
        FrontObjective,
        FrontReference,
        FrontScene,
        member_csv,
        read_front,
    )
    from chromanoise.design.objectives import OBJECTIVES, Candidate, Objective, value_of
    from chromanoise.design.optimizing import Reference, Task, searched, task_of
    from chromanoise.design.outputs import optimized, read_design
    from chromanoise.design.parameters import Free, Parameter
    from chromanoise.design.problem import Evaluated, Linearized, Problem
    from chromanoise.design.result import Design
    from chromanoise.design.scenes import DesignScene
    from chromanoise.design.scheduler import scheduler_at
    from chromanoise.design.search import FrontResult, Progress, SearchOptions, searched_front
    from chromanoise.design.sensitivity import (
        DEFAULT_OBJECTIVES,
        Effect,
        HalfWidths,
        Sensitivity,
        half_widths,
        sensitivity_of,
    )
    from chromanoise.design.space import Channel, DesignSpace, Filter
    from chromanoise.design.starter import DESIGN_STARTER

__all__ = [
    "DEFAULT_OBJECTIVES",
    "DESIGN_STARTER",
    "FRONT_SCHEMA",
    "METHODS",
    "OBJECTIVES",
    "Candidate",
    "Candidates",
    "Channel",
    "Design",
    "DesignScene",
    "DesignSpace",
    "DesignStudy",
    "Effect",
    "Evaluated",
    "Filter",
    "Free",
    "Front",
    "FrontFile",
    "FrontMember",
    "FrontObjective",
    "FrontReference",
    "FrontResult",
    "FrontScene",
    "HalfWidths",
    "Linearized",
    "Member",
    "Objective",
    "Objectives",
    "Parameter",
    "Problem",
    "Progress",
    "Reference",
    "SearchOptions",
    "Sensitivity",
    "Task",
    "front_of",
    "half_widths",
    "member_csv",
    "optimized",
    "read_design",
    "read_front",
    "scheduler_at",
    "searched",
    "searched_front",
    "sensitivity_of",
    "task_of",
    "value_of",
    "with_effort",
]
__getattr__, __dir__ = lazy_names(
    __name__,
    DesignDocument="DesignStudy",
    Evaluator="Objectives",
    SearchResult="FrontResult",
    SearchSettings="SearchOptions",
)
