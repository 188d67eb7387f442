"""A study: its document, errors, run and records.

``settings`` makes a study from the options of a command or the arguments of a function, and
``reading`` makes one from a file. ``assembly`` resolves its names, and ``running`` computes its
``results``.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.result import Result
    from chromanoise.study.analyses import (
        Outcome,
        analysis_of,
        outcome_of,
        outcomes_as_json,
    )
    from chromanoise.study.assembly import (
        NOTHING_GIVEN,
        Given,
        keyed,
        makers_of,
        operating_points_of,
        refuse_idle,
        sensor_of,
        unresolved,
    )
    from chromanoise.study.commands import (
        Call,
        call_of,
        option_of,
        study_as_command,
        study_as_python,
    )
    from chromanoise.study.denoised_files import (
        DenoisedPicture,
        denoised_picture,
        refuse_other_denoised,
        write_denoised,
    )
    from chromanoise.study.denoising_plan import (
        DenoisingPlan,
        Electrons,
        electrons_of_array,
        frame_of_array,
        frames_of_pictures,
        prepared_denoising,
    )
    from chromanoise.study.document import (
        MOST_SENSORS,
        OutputsPart,
        Part,
        Study,
        StudyKind,
        study_schema,
    )
    from chromanoise.study.file_names import file_word
    from chromanoise.study.hashes import (
        file_digests,
        provenance,
        study_as_json,
        study_hash,
    )
    from chromanoise.study.keys import KEYS, KeyOfStudy
    from chromanoise.study.keywords import (
        AnalysisSettings,
        ComparisonSettings,
        DenoiseSettings,
        MapSettings,
        MatrixSettings,
        RenderSettings,
        SensitivitySettings,
    )
    from chromanoise.study.pictures import (
        TakenPicture,
        prepared_cameras,
        taken_pictures,
    )
    from chromanoise.study.reading import (
        beside_file,
        document_from_text,
        document_text,
        is_relative_to_working_folder,
        read_study,
        study_from_data,
        study_from_text,
    )
    from chromanoise.study.records import (
        Agreement,
        RecordedRun,
        agreement_of,
        agreement_text,
        recorded_run,
        refuse_other_pictures,
        run_study,
        study_of_output,
    )
    from chromanoise.study.results import (
        Analyses,
        Comparison,
        ComparisonMap,
        Matrices,
        MatrixResult,
        Pictures,
        Results,
    )
    from chromanoise.study.running import (
        Progress,
        Step,
        run,
        run_plan,
    )
    from chromanoise.study.settings import (
        FUNCTIONS,
        DescribedSetting,
        argument_of,
        default_of,
        described_settings,
        flags_of,
        in_arguments,
        interface_of,
        study_of,
    )
    from chromanoise.study.starter import (
        STARTER,
    )
    from chromanoise.study.toml_text import (
        study_as_toml,
    )

__all__ = [
    "FUNCTIONS",
    "KEYS",
    "MOST_SENSORS",
    "NOTHING_GIVEN",
    "STARTER",
    "Agreement",
    "Analyses",
    "AnalysisSettings",
    "Call",
    "Comparison",
    "ComparisonMap",
    "ComparisonSettings",
    "DenoiseSettings",
    "DenoisedPicture",
    "DenoisingPlan",
    "DescribedSetting",
    "Electrons",
    "Given",
    "KeyOfStudy",
    "MapSettings",
    "Matrices",
    "MatrixResult",
    "MatrixSettings",
    "Outcome",
    "OutputsPart",
    "Part",
    "Pictures",
    "Progress",
    "RecordedRun",
    "RenderSettings",
    "Result",
    "Results",
    "SensitivitySettings",
    "Step",
    "Study",
    "StudyKind",
    "TakenPicture",
    "agreement_of",
    "agreement_text",
    "analysis_of",
    "argument_of",
    "beside_file",
    "call_of",
    "default_of",
    "denoised_picture",
    "described_settings",
    "document_from_text",
    "document_text",
    "electrons_of_array",
    "file_digests",
    "file_word",
    "flags_of",
    "frame_of_array",
    "frames_of_pictures",
    "in_arguments",
    "interface_of",
    "is_relative_to_working_folder",
    "keyed",
    "makers_of",
    "operating_points_of",
    "option_of",
    "outcome_of",
    "outcomes_as_json",
    "prepared_cameras",
    "prepared_denoising",
    "provenance",
    "read_study",
    "recorded_run",
    "refuse_idle",
    "refuse_other_denoised",
    "refuse_other_pictures",
    "run",
    "run_plan",
    "run_study",
    "sensor_of",
    "study_as_command",
    "study_as_json",
    "study_as_python",
    "study_as_toml",
    "study_from_data",
    "study_from_text",
    "study_hash",
    "study_of",
    "study_of_output",
    "study_schema",
    "taken_pictures",
    "unresolved",
    "write_denoised",
]
__getattr__, __dir__ = lazy_names(__name__)
