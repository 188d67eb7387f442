"""A study: its document, errors, run and records.

``function_settings`` makes a study from the options of a command or the arguments of a function,
and ``reading`` makes one from a file. ``assembly`` resolves its names, and ``running`` computes
its ``results``.
"""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.base import defined
    from chromanoise.io import Result as Result
    from chromanoise.study.analysis import (
        Analysis as Analysis,
        Stages as Stages,
        analyzed as analyzed,
        color_snr_db as color_snr_db,
        contravariant_snr_db as contravariant_snr_db,
        diagnosis as diagnosis,
        electrons_at as electrons_at,
        input_notes,
        mean_color_error as mean_color_error,
        metric_of as metric_of,
        mix_sentence,
        noisy_color_at as noisy_color_at,
        of_white,
        raw_snr_db as raw_snr_db,
        stages_at as stages_at,
    )
    from chromanoise.study.assembly import (
        NOTHING_GIVEN as NOTHING_GIVEN,
        Given as Given,
        cube_of,
        idle_settings,
        illuminant_of,
        keyed as keyed,
        light_answers_of,
        makers_of as makers_of,
        operating_points_in,
        operating_points_of as operating_points_of,
        prior_of,
        refuse_idle as refuse_idle,
        sensor_of as sensor_of,
        unresolved as unresolved,
        with_distinct_names,
    )
    from chromanoise.study.camera_league import (
        DEFAULT_ISO,
        League as League,
        iso_speeds as iso_speeds,
        league_of,
        league_of_study,
    )
    from chromanoise.study.camera_pipeline import (
        BASE_ISO as BASE_ISO,
        GainStep as GainStep,
        PipelineNoise as PipelineNoise,
        PipelineSettings as PipelineSettings,
        PipelineStep as PipelineStep,
        WhiteBalanceNoise as WhiteBalanceNoise,
        pipeline_noise as pipeline_noise,
    )
    from chromanoise.study.cameras import (
        camera_pixel as camera_pixel,
        saturation_electrons as saturation_electrons,
    )
    from chromanoise.study.catalog import (
        KINDS,
        KNOWN_SENSORS as KNOWN_SENSORS,
        RECONSTRUCTION,
        SENSOR_NAMES as SENSOR_NAMES,
        Entry as Entry,
        assumptions as assumptions,
        catalog_entries as catalog_entries,
        catalog_entry as catalog_entry,
        catalog_file_of as catalog_file_of,
        catalog_folder,
        entries_as_json,
        is_assumed as is_assumed,
        pixel_summary,
        sensor_from_table as sensor_from_table,
        sensor_named as sensor_named,
    )
    from chromanoise.study.color_matrices import (
        DEFAULT_METHOD as DEFAULT_METHOD,
        DEFAULT_PRIOR as DEFAULT_PRIOR,
        METHODS as METHODS,
        PRIORS as PRIORS,
        MatrixFunction as MatrixFunction,
        MatrixMaker as MatrixMaker,
        MatrixMethod as MatrixMethod,
        Prior as Prior,
        known_matrices as known_matrices,
        matrix_makers as matrix_makers,
        trained_names as trained_names,
        training_named,
    )
    from chromanoise.study.color_noise import (
        GRAY,
        LOST_DELTA_E,
        VISUAL_NOISE,
        ChartNoise as ChartNoise,
        GrayNoise as GrayNoise,
        TotalError as TotalError,
        Viewing as Viewing,
        chart_noise as chart_noise,
        color_budgets as color_budgets,
        contravariant_budgets as contravariant_budgets,
        coordinate_budget as coordinate_budget,
        gray_noise as gray_noise,
        lab_budgets as lab_budgets,
        mean_total_error as mean_total_error,
        missing_lab_budgets as missing_lab_budgets,
        noise_as_viewed as noise_as_viewed,
        noise_weights as noise_weights,
        pareto_of as pareto_of,
        total_error_of as total_error_of,
        total_errors as total_errors,
        visual_noise as visual_noise,
        visual_noise_of as visual_noise_of,
        white_snr_db as white_snr_db,
    )
    from chromanoise.study.denoised_files import (
        DenoisedPicture as DenoisedPicture,
        DenoisingPlan as DenoisingPlan,
        Electrons as Electrons,
        denoised_picture as denoised_picture,
        electrons_of_array as electrons_of_array,
        frame_of_array as frame_of_array,
        frames_of_pictures as frames_of_pictures,
        prepared_denoising as prepared_denoising,
        refuse_other_denoised as refuse_other_denoised,
        write_denoised as write_denoised,
    )
    from chromanoise.study.equal_color_sweeps import (
        EqualColorRange,
        equal_color_ranges,
        range_sentences,
    )
    from chromanoise.study.fail_conditions import (
        Condition as Condition,
        JudgedResult as JudgedResult,
        conditions_of as conditions_of,
        failures_of as failures_of,
        names_of_entries as names_of_entries,
    )
    from chromanoise.study.function_settings import (
        FUNCTIONS as FUNCTIONS,
        Call as Call,
        DescribedSetting as DescribedSetting,
        argument_of as argument_of,
        call_of as call_of,
        default_of as default_of,
        described_settings as described_settings,
        flags_of as flags_of,
        in_arguments as in_arguments,
        interface_of as interface_of,
        option_of as option_of,
        study_as_command as study_as_command,
        study_as_python as study_as_python,
        study_of as study_of,
    )
    from chromanoise.study.hashes import (
        FileWord,
        digests_of,
        file_digests as file_digests,
        file_words,
        files_of_word,
        provenance as provenance,
        study_as_json as study_as_json,
        study_hash as study_hash,
        with_file_words,
    )
    from chromanoise.study.keywords import (
        AnalysisSettings as AnalysisSettings,
        CardSettings as CardSettings,
        ComparisonSettings as ComparisonSettings,
        DenoiseSettings as DenoiseSettings,
        LeagueSettings as LeagueSettings,
        MapSettings as MapSettings,
        MatrixSettings as MatrixSettings,
        RenderSettings as RenderSettings,
        SensitivitySettings as SensitivitySettings,
    )
    from chromanoise.study.league_entries import (
        OF_FILTERS,
        RANKED,
        AtIso as AtIso,
        LeagueEntry as LeagueEntry,
        Ranked as Ranked,
        point_at_iso as point_at_iso,
    )
    from chromanoise.study.maps import (
        BestCell as BestCell,
        CrossoverLine,
        QuantityMap,
        best_cell_sentences,
        best_cells,
        best_of,
    )
    from chromanoise.study.merits import (
        Merit as Merit,
        Merits as Merits,
        merits_of as merits_of,
        visual_merits,
    )
    from chromanoise.study.pixel_files import (
        converter_of as converter_of,
        idle_answers as idle_answers,
        own_sensor_of as own_sensor_of,
        read_pixel_source as read_pixel_source,
        sensor_with_pixel as sensor_with_pixel,
    )
    from chromanoise.study.ranking import (
        MOST_CROSSED_SENSORS,
        MOST_PAIRS_SENSORS,
        Crossover as Crossover,
        CrossoverBand as CrossoverBand,
        Incomparable as Incomparable,
        Optimum as Optimum,
        Rank,
        band_sentence as band_sentence,
        crossover_bands as crossover_bands,
        crossover_sentence as crossover_sentence,
        crossovers as crossovers,
        crossovers_or_reasons as crossovers_or_reasons,
        lead_changes,
        lead_sentences,
        leading_crossovers,
        leads,
        optima,
        optima_sentences,
    )
    from chromanoise.study.reading import (
        beside_file as beside_file,
        document_from_text as document_from_text,
        document_text as document_text,
        file_word as file_word,
        is_relative_to_working_folder as is_relative_to_working_folder,
        read_study as read_study,
        study_as_toml as study_as_toml,
        study_from_data as study_from_data,
        study_from_text as study_from_text,
    )
    from chromanoise.study.reading_quality import (
        BRIGHT,
        DARK,
        RAW,
        RAW_WITHOUT,
        READINGS,
        TARGET,
        TOLERANCE,
        About as About,
        InformationChain as InformationChain,
        InformationStep as InformationStep,
        MachineReading,
        PairOutcome,
        RawOutcome,
        information_chain as information_chain,
        machine_reading,
        pairs_of,
        raw_information,
        raw_outcomes,
    )
    from chromanoise.study.resolve_names import (
        CURVES,
        PAIRS_HEADER,
        curves_of_object,
        file_of,
        file_there,
        is_file_word,
        is_of_colour_science,
        object_word,
        resolve_filter,
        resolve_illuminant,
        resolve_pairs,
        resolve_sensor,
        word_beside,
    )
    from chromanoise.study.results import (
        RESULT_KINDS as RESULT_KINDS,
        Analyses as Analyses,
        Comparison as Comparison,
        ComparisonMap as ComparisonMap,
        Matrices as Matrices,
        MatrixResult as MatrixResult,
        Outcome as Outcome,
        Pictures as Pictures,
        Results as Results,
        analysis_of as analysis_of,
        outcome_of as outcome_of,
    )
    from chromanoise.study.run_differences import (
        ChangedValue as ChangedValue,
        Differences as Differences,
        differences_of as differences_of,
    )
    from chromanoise.study.run_files import (
        Agreement as Agreement,
        RecordedRun as RecordedRun,
        agreement_of as agreement_of,
        agreement_text as agreement_text,
        answers_of,
        read_record as read_record,
        recorded_run as recorded_run,
        refuse_other_pictures as refuse_other_pictures,
        run_study as run_study,
        study_of_output as study_of_output,
    )
    from chromanoise.study.running import (
        Progress as Progress,
        Step as Step,
        TakenPicture as TakenPicture,
        capture_settings_of,
        prepared_cameras as prepared_cameras,
        result_steps,
        run as run,
        run_plan as run_plan,
        sweep_map,
        taken_pictures as taken_pictures,
    )
    from chromanoise.study.schema import (
        KEYS as KEYS,
        MOST_SENSORS as MOST_SENSORS,
        STARTER as STARTER,
        ExposurePart,
        KeyOfStudy as KeyOfStudy,
        LightPart,
        OutputsPart as OutputsPart,
        Part as Part,
        PicturePart,
        PixelPart,
        Study as Study,
        StudyKind as StudyKind,
        study_schema as study_schema,
        without_idle_settings,
    )
    from chromanoise.study.sweeps import (
        QUANTITIES as QUANTITIES,
        SNR_Y,
        SWEEPS as SWEEPS,
        Curve as Curve,
        Quantity as Quantity,
        Sweep as Sweep,
        by_matrix,
        compared as compared,
        fullest_level_lux,
        swept_values as swept_values,
    )
    from chromanoise.study.trade_offs import (
        HARDLY_SEEN_DELTA_E,
        LEAST_TIE_DB,
        MOST_CHECKED,
        EqualColor as EqualColor,
        LeftOut as LeftOut,
        LostColors as LostColors,
        Reader,
        Standing as Standing,
        Told,
        TradeOff as TradeOff,
        Turn as Turn,
        Verdict as Verdict,
        equal_color as equal_color,
        lost_colors as lost_colors,
        total_error_as_viewed as total_error_as_viewed,
        trade_off as trade_off,
    )

__getattr__, __dir__, __all__ = lazy_names(
    __name__, Method="MatrixMethod", on_pixel="sensor_with_pixel"
)
