"""A study in a file, and its run."""

from chromanoise.study.runs.document import Study, study_schema
from chromanoise.study.runs.reading import read_study, study_from_text
from chromanoise.study.runs.records import run_study, study_of_output
from chromanoise.study.runs.running import (
    Step,
    provenance,
    study_as_json,
    study_hash,
    study_steps,
)
from chromanoise.study.runs.starter import STARTER

__all__ = [
    "STARTER",
    "Step",
    "Study",
    "provenance",
    "read_study",
    "run_study",
    "study_as_json",
    "study_from_text",
    "study_hash",
    "study_of_output",
    "study_schema",
    "study_steps",
]
