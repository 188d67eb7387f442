"""Written by tools/make_stubs.py from the classes of a study: change them there."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, TypedDict

NAMES: Mapping[str, str]

class _Shared(TypedDict, total=False):
    negatives: Literal["refuse", "zero"]
    labels: Sequence[str]
    beyond: Literal["hold", "refuse", "zero"]
    qe_scale: Literal["fraction", "percent"]
    level: Literal["absolute", "relative"]
    per: Literal["energy", "photon"]
    wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    peak_qe: float
    pixel: str | Path
    pitch_um: float
    full_well_e: float
    read_noise_e: float
    dark_current_e_per_s: float
    temperature_c: float
    dark_reference_c: float
    dark_doubling_k: float
    dsnu_e: float
    prnu: float
    row_noise_e: float
    column_noise_e: float
    reset_capacitance_ff: float
    rtn_share: float
    rtn_amplitude_e: float
    black_error_e: float
    bits: int
    gain_dn_per_e: float
    binning: int
    binning_mode: Literal["charge", "digital"]
    filter: str | Path | object
    channel_filters: Mapping[str, str | Path | object]
    filter_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    shift_ircut_nm: float
    crosstalk: float | str | Path
    crosstalk_stage: Literal["charge", "light"]
    mosaic: str
    ircut_nm: float
    shift_nm: float

class AnalysisSettings(_Shared, total=False):
    illuminant: str | Path | object
    lux: float
    illuminant_beyond: Literal["hold", "refuse", "zero"]
    illuminant_per: Literal["energy", "photon"]
    illuminant_column: str
    illuminant_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    equal: Literal["exposure", "light", "saturation"]
    time_ms: float
    saturate: float
    f_number: float
    magnification: float
    metric: str
    observer: str | Path | object
    prior: str | Path | object
    chart_file: str | Path | object
    patch: float | str | Path | object
    pairs: str | Path | object
    reflectance_scale: Literal["fraction", "percent"]
    reflectance_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    reflectance_beyond: Literal["hold", "refuse", "zero"]
    clip: bool
    budget: bool
    merit: bool
    chart: bool
    space: str
    reader: Literal["eye", "machine"]
    pipeline: bool
    white_balance: Sequence[float] | str | Path | object
    white_balance_pixels: int
    exposure_gain: float
    saturation: float
    tone: float | str
    luma: Literal["bt601", "bt709"]
    iso: Sequence[float]
    base_iso: float
    iso_read_noise_e: Sequence[float]

class CardSettings(_Shared, total=False):
    illuminant: str | Path | object
    lux: float
    illuminant_beyond: Literal["hold", "refuse", "zero"]
    illuminant_per: Literal["energy", "photon"]
    illuminant_column: str
    illuminant_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    equal: Literal["exposure", "light", "saturation"]
    time_ms: float
    saturate: float
    f_number: float
    magnification: float
    metric: str
    observer: str | Path | object
    prior: str | Path | object
    chart_file: str | Path | object
    patch: float | str | Path | object
    pairs: str | Path | object
    reflectance_scale: Literal["fraction", "percent"]
    reflectance_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    reflectance_beyond: Literal["hold", "refuse", "zero"]
    reader: Literal["eye", "machine"]
    seed: int

class ComparisonSettings(_Shared, total=False):
    illuminant: str | Path | object
    lux: float
    illuminant_beyond: Literal["hold", "refuse", "zero"]
    illuminant_per: Literal["energy", "photon"]
    illuminant_column: str
    illuminant_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    equal: Literal["exposure", "light", "saturation"]
    time_ms: float
    saturate: float
    f_number: float
    magnification: float
    metric: str
    observer: str | Path | object
    prior: str | Path | object
    chart_file: str | Path | object
    patch: float | str | Path | object
    pairs: str | Path | object
    reflectance_scale: Literal["fraction", "percent"]
    reflectance_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    reflectance_beyond: Literal["hold", "refuse", "zero"]
    vary: str
    first: float
    last: float
    points: int
    quantity: str
    all_priors: bool

class MapSettings(_Shared, total=False):
    illuminant: str | Path | object
    lux: float
    illuminant_beyond: Literal["hold", "refuse", "zero"]
    illuminant_per: Literal["energy", "photon"]
    illuminant_column: str
    illuminant_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    equal: Literal["exposure", "light", "saturation"]
    time_ms: float
    saturate: float
    f_number: float
    magnification: float
    metric: str
    observer: str | Path | object
    prior: str | Path | object
    chart_file: str | Path | object
    patch: float | str | Path | object
    pairs: str | Path | object
    reflectance_scale: Literal["fraction", "percent"]
    reflectance_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    reflectance_beyond: Literal["hold", "refuse", "zero"]
    vary: str
    first: float
    last: float
    points: int
    quantity: str
    second_vary: str
    second_first: float
    second_last: float
    second_points: int

class DenoiseSettings(_Shared, total=False):
    illuminant: str | Path | object
    lux: float
    illuminant_beyond: Literal["hold", "refuse", "zero"]
    illuminant_per: Literal["energy", "photon"]
    illuminant_column: str
    illuminant_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    equal: Literal["exposure", "light", "saturation"]
    time_ms: float
    saturate: float
    f_number: float
    magnification: float
    metric: str
    observer: str | Path | object
    prior: str | Path | object
    demosaic: str
    black_level: int

class LeagueSettings(_Shared, total=False):
    pass

class MatrixSettings(_Shared, total=False):
    illuminant: str | Path | object
    lux: float
    illuminant_beyond: Literal["hold", "refuse", "zero"]
    illuminant_per: Literal["energy", "photon"]
    illuminant_column: str
    illuminant_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    equal: Literal["exposure", "light", "saturation"]
    time_ms: float
    saturate: float
    f_number: float
    magnification: float
    metric: str
    observer: str | Path | object
    prior: str | Path | object
    chart_file: str | Path | object
    patch: float | str | Path | object
    pairs: str | Path | object
    reflectance_scale: Literal["fraction", "percent"]
    reflectance_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    reflectance_beyond: Literal["hold", "refuse", "zero"]
    pareto_first: float
    pareto_last: float
    pareto_points: int

class RenderSettings(_Shared, total=False):
    illuminant: str | Path | object
    lux: float
    illuminant_beyond: Literal["hold", "refuse", "zero"]
    illuminant_per: Literal["energy", "photon"]
    illuminant_column: str
    illuminant_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    equal: Literal["exposure", "light", "saturation"]
    time_ms: float
    saturate: float
    f_number: float
    magnification: float
    metric: str
    observer: str | Path | object
    prior: str | Path | object
    seed: int
    key: str
    shape: tuple[int, int]
    wavelengths: tuple[float, float] | str
    scale: float
    bad_pixels: Literal["refuse", "zero"]
    demosaic: str
    raw_only: bool
    black_level: int
    frames: int
    denoise: str
    formats: Sequence[str]
    clip: bool

class SensitivitySettings(_Shared, total=False):
    illuminant: str | Path | object
    lux: float
    illuminant_beyond: Literal["hold", "refuse", "zero"]
    illuminant_per: Literal["energy", "photon"]
    illuminant_column: str
    illuminant_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    equal: Literal["exposure", "light", "saturation"]
    time_ms: float
    saturate: float
    f_number: float
    magnification: float
    metric: str
    observer: str | Path | object
    prior: str | Path | object
    chart_file: str | Path | object
    patch: float | str | Path | object
    pairs: str | Path | object
    reflectance_scale: Literal["fraction", "percent"]
    reflectance_wavelength_unit: Literal["1/cm", "angstrom", "nm", "um"]
    reflectance_beyond: Literal["hold", "refuse", "zero"]
