"""Statistics of frames kept in a file, so that a stopped run continues where it ended."""

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from chromanoise import __version__, _inputs
from chromanoise._files import write_whole
from chromanoise.characterization.lights import Sampler
from chromanoise.characterization.statistics import LightSample, PlaneSample, light_sample
from chromanoise.errors import InputError
from chromanoise.io.frames.frame import RawFrame

_SCHEMA = "chromanoise frame statistics"
_MOST_BYTES = 100_000_000
_FIELDS = {field.name for field in fields(PlaneSample)}


def resumed(path: Path) -> Sampler:
    """A function for `characterized` that keeps its results in a file.

    The file is rewritten after each light. Results are reused only for the same frames: same
    paths, sizes and modification times. Several threads may call the function.

    Parameters
    ----------
    path
        The file; made if it does not exist.

    Raises
    ------
    InputError
        If the file exists and is of another kind or version, or was changed.
    """
    kept, writing = _read(path) if os.path.lexists(path) else {}, Lock()

    def sampled(frames: Sequence[RawFrame], tile: tuple[int, int]) -> LightSample:
        key = _key(frames, tile)
        if key not in kept:
            found = light_sample(frames, tile)
            one = {
                "planes": [asdict(plane) for plane in found.planes],
                "covariance_dn2": found.covariance_dn2.tolist(),
            }
            with writing:
                kept[key] = one
                data = {"schema": _SCHEMA, "version": __version__, "lights": kept}
                data["content"] = _inputs.content_hash(data)
                write_whole(path, json.dumps(data).encode())
            return found
        one = kept[key]
        planes = [
            PlaneSample(**plane | {"frame_means_dn": tuple(plane["frame_means_dn"])})
            for plane in one["planes"]
        ]
        return LightSample(planes=tuple(planes), covariance_dn2=np.array(one["covariance_dn2"]))

    return sampled


def _key(frames: Sequence[RawFrame], tile: tuple[int, int]) -> str:
    digest = hashlib.sha256(repr(tile).encode())
    for frame in frames:
        facts = frame.path.stat()
        place = f"{_inputs.true_path(frame.path)}|{frame.part}|{frame.index}"
        digest.update(f"{place}|{facts.st_size}|{facts.st_mtime_ns}\n".encode())
    return digest.hexdigest()


def _read(path: Path) -> dict[str, Any]:
    data = _inputs.json_file(path, most_bytes=_MOST_BYTES)
    remedy = "give the file of an earlier run, or one that does not exist"
    try:
        lights = data["lights"]
        same = data["schema"] == _SCHEMA and data["version"] == __version__
        valid = all(
            set(plane) == _FIELDS for one in lights.values() for plane in one["planes"]
        ) and all("covariance_dn2" in one for one in lights.values())
    except (KeyError, TypeError, AttributeError):
        same = valid = False
    if not (same and valid):
        raise InputError(
            str(path), f"must hold statistics of frames of version {__version__}", remedy=remedy
        )
    if data.get("content") != _inputs.content_hash(data):
        raise InputError(
            str(path),
            "must be as the earlier run wrote it",
            found="was changed since, as its content hash shows",
            remedy=("restore it", "name a file that does not exist"),
        )
    return dict(lights)
