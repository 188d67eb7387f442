"""A characterization from frames, or from a table of means and variances."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from chromanoise.characterization.kept_statistics import resumed
from chromanoise.characterization.measure import characterized
from chromanoise.characterization.planes import plane_of_fit
from chromanoise.characterization.results import Characterization, LevelNoise, ModelVerdict
from chromanoise.characterization.statistics import light_sample
from chromanoise.characterization.verdict import bend_sentences
from chromanoise.errors import InputError
from chromanoise.io.frames import FrameSet, read_frame_set
from chromanoise.io.pixels import read_photon_transfer_csv
from chromanoise.io.pixels.photon_transfer_csv import is_photon_transfer_text
from chromanoise.sensor import PhotonTransfer, photon_transfer_fit

_HEAD_BYTES = 4096
_TABLES = (".csv", ".tsv", ".txt", ".dat")


def characterize(
    *frames: str | Path | FrameSet,
    resume: str | Path | None = None,
    progress: Callable[[int, int], None] = lambda _done, _all: None,
) -> Characterization:
    """Noise of a camera from its own raw frames: flats of several levels of light, and darks.

    Parameters
    ----------
    frames
        A folder, files, a `FrameSet`, or one table of means and variances. A folder with
        ``capture.toml`` needs no guessing.
    resume
        File for the statistics of the frames read so far, from which a later call goes on.
    progress
        Called with the number of frames read and their total.

    Returns
    -------
    Characterization
        Gain, dark noise, full well, QE, DSNU, PRNU ... of each plane of the mosaic, each with its
        error, and a verdict on the linear model.

    Raises
    ------
    InputError
        If a frame cannot be read, frames do not belong together, or they give no photon transfer.

    Notes
    -----
    EMVA Standard 1288, release 4.0 Linear (2021).

    Examples
    --------
    >>> import chromanoise as cn
    >>> camera = cn.characterize("frames")                          # doctest: +SKIP
    >>> camera.planes[0].gain_dn_per_e, camera.verdict.sentences    # doctest: +SKIP
    """
    kept = None if resume is None else Path(resume)
    if len(frames) == 1 and isinstance(frames[0], FrameSet):
        return characterization_of(frames[0], resume=kept, progress=progress)
    words = [one for one in frames if isinstance(one, str | Path)]
    if len(words) < len(frames) or not words:
        raise InputError(
            "frames",
            "must be a folder, files, or one FrameSet",
            value=[type(one).__name__ for one in frames],
        )
    return characterization_of(read_source(words), resume=kept, progress=progress)


def read_source(words: Sequence[Path | str]) -> FrameSet | PhotonTransfer:
    """Frames, or one table of means and variances.

    Parameters
    ----------
    words
        As `chromanoise.io.frames.read_frame_set`, or one table in a form of
        `chromanoise.io.pixels.read_photon_transfer_csv`.

    Raises
    ------
    InputError
        As these readers.
    """
    if len(words) == 1 and is_table(Path(words[0]).expanduser()):
        return read_photon_transfer_csv(Path(words[0]).expanduser())
    return read_frame_set(words)


def characterization_of(
    source: FrameSet | PhotonTransfer,
    *,
    resume: Path | None = None,
    progress: Callable[[int, int], None] = lambda _done, _all: None,
) -> Characterization:
    """The noise of a camera from what `read_source` read.

    Parameters
    ----------
    source
        Frames, or a table.
    resume
        File for the statistics of frames (`resumed`); ``None`` for none.
    progress
        As `characterized`.

    Raises
    ------
    InputError
        As `characterized`, `characterized_table` or `resumed`.
    """
    if isinstance(source, PhotonTransfer):
        return characterized_table(source)
    sampled = light_sample if resume is None else resumed(resume)
    return characterized(source, sampled=sampled, progress=progress)


def is_table(path: Path) -> bool:
    """Whether a file is a table of means and variances, by its ending and its heading."""
    if path.suffix.lower() not in _TABLES or not path.is_file():
        return False
    with path.open("rb") as file:
        return is_photon_transfer_text(file.read(_HEAD_BYTES).decode("utf-8", errors="replace"))


def characterized_table(table: PhotonTransfer) -> Characterization:
    """One plane from a table: without fixed patterns, row noise and correlations.

    Parameters
    ----------
    table
        Means and variances.

    Raises
    ------
    InputError
        As `chromanoise.sensor.photon_transfer_fit`.
    """
    fit = photon_transfer_fit(table)
    lit = np.flatnonzero(~table.dark)
    lit = lit[np.argsort(table.mean_dn[lit], kind="stable")]
    levels = [_level(table, int(row), fit.gain_dn_per_e, fit.fitted) for row in lit]
    plane = plane_of_fit(fit, name="mono", levels=tuple(levels))
    used = np.abs(fit.residual_z) * fit.fitted
    worst = int(used.argmax())
    sentences = tuple(bend_sentences([plane]))
    return Characterization(
        source=table.source,
        camera="",
        iso=None,
        bits=None,
        mosaic=None,
        planes=(plane,),
        correlation=np.eye(1),
        covariance_dn2=table.variance_dn2[lit][:, None, None],
        verdict=ModelVerdict(
            holds=not sentences,
            chi2_per_level=fit.chi2_per_row,
            worst_level=f"row {worst + 1}",
            worst_z=float(fit.residual_z[worst]),
            sentences=sentences,
        ),
        notes=(f"a table of {lit.size} means and variances: no fixed patterns and no row noise",),
    )


def _level(table: PhotonTransfer, row: int, gain: float, fitted: np.ndarray) -> LevelNoise:
    dark_mean, dark_variance = _dark(table, row)
    darkest = int(table.mean_dn.argmin())
    base = float(table.mean_dn[darkest]) if dark_mean is None else dark_mean
    floor = float(table.variance_dn2[darkest]) if dark_variance is None else dark_variance
    variance = float(table.variance_dn2[row])
    samples = math.nan if table.samples is None else float(table.samples[row])
    return LevelNoise(
        name=f"row {row + 1}",
        frames=2,
        time_ms=None if table.time_ms is None else float(table.time_ms[row]),
        photons_per_pixel=None if table.photons is None else float(table.photons[row]),
        mean_dn=float(table.mean_dn[row]),
        variance_dn2=variance,
        variance_se_dn2=0.0 if math.isnan(samples) else variance * math.sqrt(2 / (samples - 1)),
        predicted_variance_dn2=gain * (float(table.mean_dn[row]) - base) + floor,
        dark_mean_dn=dark_mean,
        dark_variance_dn2=dark_variance,
        fitted=bool(fitted[row]),
        clipped_share=0.0,
        correlation_right=0.0,
        correlation_down=0.0,
        drift_z=0.0,
    )


def _dark(table: PhotonTransfer, row: int) -> tuple[float | None, float | None]:
    """Dark mean and variance of a row: its own columns, the dark of its time, or all darks."""
    if table.dark_mean_dn is not None and table.dark_variance_dn2 is not None:
        return float(table.dark_mean_dn[row]), float(table.dark_variance_dn2[row])
    if not table.dark.any():
        return None, None
    chosen = table.dark
    if table.time_ms is not None:
        away = np.where(table.dark, np.abs(table.time_ms - table.time_ms[row]), np.inf)
        chosen = away == away.min()
    return float(table.mean_dn[chosen].mean()), float(table.variance_dn2[chosen].mean())
