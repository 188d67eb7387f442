"""A study: its document, faults, run and records."""

from chromanoise.study.agreement import (
    Agreement,
    agreement_of,
    agreement_text,
)
from chromanoise.study.analyses import (
    Outcome,
    outcome_of,
    outcomes_as_json,
)
from chromanoise.study.document import (
    MOST_SENSORS,
    OutputsPart,
    Study,
    study_schema,
)
from chromanoise.study.hashes import (
    file_digests,
    provenance,
    study_as_json,
    study_hash,
)
from chromanoise.study.pictures import (
    file_word,
)
from chromanoise.study.reading import (
    read_study,
    study_from_data,
    study_from_text,
)
from chromanoise.study.records import (
    RecordedRun,
    recorded_run,
    run_study,
    study_of_output,
)
from chromanoise.study.running import (
    Step,
    study_steps,
)
from chromanoise.study.scripts import (
    study_as_python,
)
from chromanoise.study.starter import (
    STARTER,
)
from chromanoise.study.texts import (
    study_as_command,
    study_as_toml,
)

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
    "outcome_of",
    "outcomes_as_json",
    "provenance",
    "read_study",
    "recorded_run",
    "run_study",
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
