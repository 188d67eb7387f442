"""A study: its document, errors, run and records.

``settings`` makes a study from the options of a command or the arguments of a function, and
``reading`` makes one from a file. ``assembly`` resolves its names, and ``running`` computes its
``results``.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.result import Result as Result
    from chromanoise.study.analyses import (
        Outcome as Outcome,
        analysis_of as analysis_of,
        outcome_of as outcome_of,
        outcomes_as_json as outcomes_as_json,
    )
    from chromanoise.study.assembly import (
        NOTHING_GIVEN as NOTHING_GIVEN,
        Given as Given,
        keyed as keyed,
        makers_of as makers_of,
        operating_points_of as operating_points_of,
        refuse_idle as refuse_idle,
        sensor_of as sensor_of,
        unresolved as unresolved,
    )
    from chromanoise.study.commands import (
        Call as Call,
        call_of as call_of,
        option_of as option_of,
        study_as_command as study_as_command,
        study_as_python as study_as_python,
    )
    from chromanoise.study.denoised_files import (
        DenoisedPicture as DenoisedPicture,
        denoised_picture as denoised_picture,
        refuse_other_denoised as refuse_other_denoised,
        write_denoised as write_denoised,
    )
    from chromanoise.study.denoising_plan import (
        DenoisingPlan as DenoisingPlan,
        Electrons as Electrons,
        electrons_of_array as electrons_of_array,
        frame_of_array as frame_of_array,
        frames_of_pictures as frames_of_pictures,
        prepared_denoising as prepared_denoising,
    )
    from chromanoise.study.document import (
        MOST_SENSORS as MOST_SENSORS,
        OutputsPart as OutputsPart,
        Part as Part,
        Study as Study,
        StudyKind as StudyKind,
        study_schema as study_schema,
    )
    from chromanoise.study.file_names import file_word as file_word
    from chromanoise.study.hashes import (
        file_digests as file_digests,
        provenance as provenance,
        study_as_json as study_as_json,
        study_hash as study_hash,
    )
    from chromanoise.study.keys import (
        KEYS as KEYS,
        KeyOfStudy as KeyOfStudy,
    )
    from chromanoise.study.keywords import (
        AnalysisSettings as AnalysisSettings,
        ComparisonSettings as ComparisonSettings,
        DenoiseSettings as DenoiseSettings,
        MapSettings as MapSettings,
        MatrixSettings as MatrixSettings,
        RenderSettings as RenderSettings,
        SensitivitySettings as SensitivitySettings,
    )
    from chromanoise.study.pictures import (
        TakenPicture as TakenPicture,
        prepared_cameras as prepared_cameras,
        taken_pictures as taken_pictures,
    )
    from chromanoise.study.reading import (
        beside_file as beside_file,
        document_from_text as document_from_text,
        document_text as document_text,
        is_relative_to_working_folder as is_relative_to_working_folder,
        read_study as read_study,
        study_from_data as study_from_data,
        study_from_text as study_from_text,
    )
    from chromanoise.study.records import (
        Agreement as Agreement,
        RecordedRun as RecordedRun,
        agreement_of as agreement_of,
        agreement_text as agreement_text,
        recorded_run as recorded_run,
        refuse_other_pictures as refuse_other_pictures,
        run_study as run_study,
        study_of_output as study_of_output,
    )
    from chromanoise.study.results import (
        Analyses as Analyses,
        Comparison as Comparison,
        ComparisonMap as ComparisonMap,
        Matrices as Matrices,
        MatrixResult as MatrixResult,
        Pictures as Pictures,
        Results as Results,
    )
    from chromanoise.study.running import (
        Progress as Progress,
        Step as Step,
        run as run,
        run_plan as run_plan,
    )
    from chromanoise.study.settings import (
        FUNCTIONS as FUNCTIONS,
        DescribedSetting as DescribedSetting,
        argument_of as argument_of,
        default_of as default_of,
        described_settings as described_settings,
        flags_of as flags_of,
        in_arguments as in_arguments,
        interface_of as interface_of,
        study_of as study_of,
    )
    from chromanoise.study.starter import STARTER as STARTER
    from chromanoise.study.toml_text import study_as_toml as study_as_toml

__getattr__, __dir__, __all__ = lazy_names(__name__)
