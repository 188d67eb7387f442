"""What all packages use: errors, declared properties, checks of input, files, linear algebra."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.base.check import Array, among, distinct, frozen, one_of, printable, reason
    from chromanoise.base.errors import (
        InputError as InputError,
        Remedy,
        Render,
        Setting as Setting,
        StudyError as StudyError,
        did_you_mean as did_you_mean,
        errors_in as errors_in,
        in_study as in_study,
        known_name,
        no_place_for,
        refusal,
        setting_of_study,
    )
    from chromanoise.base.files import (
        OWN_FILES,
        claimed_folder,
        csv_comment,
        csv_text,
        digest_of,
        refuse_unwritable,
        refuse_unwritable_file,
        renamed,
        text_of_cell,
        text_of_comment,
        whole_folder,
        write_all_whole,
        write_kept,
        write_whole,
    )
    from chromanoise.base.immutable import dataclass, kept, kept_of_each
    from chromanoise.base.inputs import (
        content_hash,
        first_bytes,
        json_file,
        json_of,
        regular_file,
        system_errors_of,
        true_path,
    )
    from chromanoise.base.lazy import (
        MovedPackages,
        from_above,
        lazy_names,
        register_above,
        renamed_keywords,
        warn_of_old_name,
    )
    from chromanoise.base.linalg import (
        RANK_TOLERANCE,
        angles_deg,
        blas_kernel,
        cholesky,
        congruence,
        congruence_of_many,
        covariance_root,
        det,
        diagonal,
        eigh,
        eigvalsh,
        inv,
        lstsq,
        matrix_rank,
        orthogonal_complement,
        pinv,
        qr,
        solve,
        svd,
        unit_columns,
        variances_along,
        whitening,
    )
    from chromanoise.base.packages import is_absent, optional_package, refuse_absent_package
    from chromanoise.base.palette import (
        CHANNELS,
        DIFFERENCES,
        NEUTRALS,
        SENSORS,
        VALUES,
        channel_color,
        color_between,
        palette_css,
    )
    from chromanoise.base.properties import (
        Growth,
        Interface,
        Property,
        beside_their_needs,
        demand_properties,
        partial_class,
        properties_of,
        required_of,
    )
    from chromanoise.base.records import (
        After,
        Before,
        DeclaredField,
        Fault,
        Field,
        Key,
        Record,
        RecordError,
        Written,
        after,
        dotted,
        short,
        subclass,
    )
    from chromanoise.base.result_json import (
        ANY_NAME,
        LIST,
        VERSION,
        DescribedKey,
        JsonKey,
        JsonKeys,
        defined,
        described_keys,
        json_text,
        keys_of,
        plain,
        schema,
        with_short_repr,
    )
    from chromanoise.base.rng import stream as stream
    from chromanoise.base.sandbox import (
        exit_after,
        exit_code,
        held_bytes,
        is_out_of_memory,
        keep_freed_memory,
        set_limit,
        started_python,
        stopped_after,
    )
    from chromanoise.base.shapes import (
        Bool,
        Complex,
        Float,
        Float32,
        Float64,
        Inexact,
        Int,
        Int64,
        Integer,
        Num,
        Shaped,
        UInt8,
        UInt16,
    )
    from chromanoise.base.units import (
        BOLTZMANN_J_PER_K as BOLTZMANN_J_PER_K,
        LIGHT_M_PER_S as LIGHT_M_PER_S,
        LUMEN_PER_WATT as LUMEN_PER_WATT,
        PLANCK_J_S as PLANCK_J_S,
        UM2_PER_M2 as UM2_PER_M2,
        decibel as decibel,
        from_decibel as from_decibel,
        photons_per_joule as photons_per_joule,
    )
    from chromanoise.base.version import __version__

__getattr__, __dir__, __all__ = lazy_names(__name__)
