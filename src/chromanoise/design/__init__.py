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
    from chromanoise.design.document import DesignStudy as DesignStudy
    from chromanoise.design.document import with_effort as with_effort
    from chromanoise.design.evaluation import Objectives as Objectives
    from chromanoise.design.front import Front as Front
    from chromanoise.design.front import Member as Member
    from chromanoise.design.front import front_of as front_of
    from chromanoise.design.front_file import FRONT_SCHEMA as FRONT_SCHEMA
    from chromanoise.design.front_file import FrontFile as FrontFile
    from chromanoise.design.front_file import FrontMember as FrontMember
    from chromanoise.design.front_file import FrontObjective as FrontObjective
    from chromanoise.design.front_file import FrontReference as FrontReference
    from chromanoise.design.front_file import FrontScene as FrontScene
    from chromanoise.design.front_file import member_csv as member_csv
    from chromanoise.design.front_file import read_front as read_front
    from chromanoise.design.objectives import OBJECTIVES as OBJECTIVES
    from chromanoise.design.objectives import Candidate as Candidate
    from chromanoise.design.objectives import Objective as Objective
    from chromanoise.design.objectives import value_of as value_of
    from chromanoise.design.optimizing import Reference as Reference
    from chromanoise.design.optimizing import Task as Task
    from chromanoise.design.optimizing import searched as searched
    from chromanoise.design.optimizing import task_of as task_of
    from chromanoise.design.outputs import optimized as optimized
    from chromanoise.design.outputs import read_design as read_design
    from chromanoise.design.parameters import Free as Free
    from chromanoise.design.parameters import Parameter as Parameter
    from chromanoise.design.problem import Evaluated as Evaluated
    from chromanoise.design.problem import Linearized as Linearized
    from chromanoise.design.problem import Problem as Problem
    from chromanoise.design.result import Design as Design
    from chromanoise.design.scenes import DesignScene as DesignScene
    from chromanoise.design.scheduler import scheduler_at as scheduler_at
    from chromanoise.design.search import FrontResult as FrontResult
    from chromanoise.design.search import Progress as Progress
    from chromanoise.design.search import SearchOptions as SearchOptions
    from chromanoise.design.search import searched_front as searched_front
    from chromanoise.design.sensitivity import DEFAULT_OBJECTIVES as DEFAULT_OBJECTIVES
    from chromanoise.design.sensitivity import Effect as Effect
    from chromanoise.design.sensitivity import HalfWidths as HalfWidths
    from chromanoise.design.sensitivity import Sensitivity as Sensitivity
    from chromanoise.design.sensitivity import half_widths as half_widths
    from chromanoise.design.sensitivity import sensitivity_of as sensitivity_of
    from chromanoise.design.space import Channel as Channel
    from chromanoise.design.space import DesignSpace as DesignSpace
    from chromanoise.design.space import Filter as Filter
    from chromanoise.design.starter import DESIGN_STARTER as DESIGN_STARTER

__getattr__, __dir__ = lazy_names(
    __name__,
    DesignDocument="DesignStudy",
    Evaluator="Objectives",
    SearchResult="FrontResult",
    SearchSettings="SearchOptions",
)
