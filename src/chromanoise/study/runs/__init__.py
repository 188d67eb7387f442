"""A study in a file, and its run."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.study.runs.agreement import Agreement, agreement_of, agreement_text
    from chromanoise.study.runs.analyses import Outcome, outcome_of, outcomes_as_json
    from chromanoise.study.runs.document import MOST_SENSORS, OutputsPart, Study, study_schema
    from chromanoise.study.runs.hashes import (
        file_digests,
        provenance,
        study_as_json,
        study_hash,
    )
    from chromanoise.study.runs.pictures import file_word
    from chromanoise.study.runs.pixel_files import (
        idle_answers,
        own_sensor_of,
        read_pixel_source,
        sensor_with_pixel,
    )
    from chromanoise.study.runs.reading import read_study, study_from_data, study_from_text
    from chromanoise.study.runs.records import RecordedRun, recorded_run, run_study, study_of_output
    from chromanoise.study.runs.running import Step, study_steps
    from chromanoise.study.runs.scripts import study_as_python
    from chromanoise.study.runs.starter import STARTER
    from chromanoise.study.runs.texts import study_as_command, study_as_toml

__all__ = [
    "MOST_SENSORS",
    "STARTER",
    "Agreement",
    "Outcome",
    "OutputsPart",
    "RecordedRun",
    "Step",
    "Study",
    "agreement_of",
    "agreement_text",
    "file_digests",
    "file_word",
    "idle_answers",
    "outcome_of",
    "outcomes_as_json",
    "own_sensor_of",
    "provenance",
    "read_pixel_source",
    "read_study",
    "recorded_run",
    "run_study",
    "sensor_with_pixel",
    "study_as_command",
    "study_as_json",
    "study_as_python",
    "study_as_toml",
    "study_from_data",
    "study_from_text",
    "study_hash",
    "study_of_output",
    "study_schema",
    "study_steps",
]
__getattr__, __dir__ = lazy_names(__name__)
