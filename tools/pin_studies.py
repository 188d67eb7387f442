"""Write the pinned studies: their hashes, copied forms, and a sample of the numbers of each result.

    python tools/pin_studies.py            writes tests/pinned/studies.json.gz
    python tools/pin_studies.py --check    compares with it and prints what differs
    python tools/pin_studies.py --renew    writes new outcomes of the same studies
    python tools/pin_studies.py --add      stores studies of keys that came later

The studies are drawn at random from the values below, until each key of a study occurs in at least
`LEAST` valid ones. The file holds the studies, so that it stays a record when the schema changes.
"""

import argparse
import gzip
import hashlib
import json
import os
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any
from unittest.mock import patch

import chromanoise as cn
from chromanoise.base.errors import InputError
from chromanoise.study import study_as_command, study_as_python, study_hash
from chromanoise.study.reading import study_as_toml

FOLDER = Path(__file__).resolve().parents[1] / "tests" / "pinned"
RECORD = FOLDER / "studies.json.gz"
VERSION = "0.2.0.dev997+g88cb82e2f"
"""Version in the stored hashes, which depend on it."""
STUDIES, LEAST, NUMBERS = 320, 3, 80

SENSORS: list[dict[str, Any]] = [
    {"name": "onyx-rgbw"},
    {"name": "onyx-rgb-ircut"},
    {"name": "onyx-rgb"},
    {"name": "onyx-rgbw-ircut"},
    {"name": "mt9v024-rgbw", "beyond": "zero"},
    {"name": "mt9m131", "beyond": "hold"},
    {"name": "gsense4040bsi"},
    {"name": "model-rgb-ircut"},
    {"name": "model-rgbw"},
    {"name": "ar0132at-rgbw", "beyond": "zero", "answers": {"peak_qe": 0.6}},
    {"name": "files/camera.csv", "answers": {"scale": "fraction", "level": "absolute"}},
    {
        "name": "files/percent.csv",
        "answers": {"scale": "percent", "level": "relative", "peak_qe": 0.5, "per": "energy"},
    },
    {
        "name": "files/camera.csv",
        "answers": {"scale": "fraction", "level": "absolute", "wavelength_unit": "nm"},
    },
]
# per key: values; "sensors.*" is set on one sensor of the study
VALUES: dict[str, list[Any]] = {
    "title": ["A study", 'Two sensors; "quoted"'],
    "metric": ["energy", "quanta"],
    "observer": ["cie-1964-10", "cie-2015-2", "cie-2015-10"],
    "seed": [7, 123456789],
    "prior": ["chart", "smooth-50-nir", "smooth-50", "smooth-100", "files/reflectances.csv"],
    "matrices": [
        ["least-squares"],
        ["kernel", "lmmse"],
        ["white-preserving"],
        ["ridge"],
        ["ridge=0.01"],
        ["noise-regularized"],
        ["bounded-psi"],
        ["kernel", "least-squares", "lmmse", "noise-regularized=2"],
    ],
    "light.illuminant": ["A", "D65", "G173", "3200K", "LED660", "A+0.5xLED850", "files/lamp.csv"],
    "light.level_lux": [0.1, 1.0, 100.0, 3.7],
    "light.beyond": ["zero", "hold"],
    "light.per": ["energy"],
    "light.column": ["power_w_m2_nm"],
    "light.wavelength_unit": ["nm"],
    "light.negatives": ["zero"],
    "exposure.equal": ["saturation", "light"],
    "exposure.time_ms": [12.0, 59.0, 0.5],
    "exposure.saturate": [0.5, 0.9],
    "exposure.f_number": [2.8, 1.4],
    "exposure.magnification": [0.1, 0.5],
    "reflectances.chart": ["files/reflectances.csv"],
    "reflectances.patch": [0.18, "red", "files/reflectances.csv:leaf"],
    "reflectances.pairs": ["files/pairs.csv", "files/reflectances.csv"],
    "reflectances.scale": ["fraction"],
    "reflectances.wavelength_unit": ["nm"],
    "reflectances.beyond": ["zero", "hold"],
    "sensors.*.label": ["mine"],
    "sensors.*.beyond": ["zero", "hold"],
    "sensors.*.negatives": ["zero"],
    "sensors.*.filter": ["ircut-650", "files/filter.csv"],
    "sensors.*.filter_wavelength_unit": ["nm"],
    "sensors.*.channel_filters": [{"R": "ircut-650"}, {"G": "files/filter.csv", "B": "ircut-650"}],
    "sensors.*.crosstalk": [0.05, 0.2, "files/crosstalk.csv", "files/kernel.csv"],
    "sensors.*.crosstalk_stage": ["charge"],
    "sensors.*.mosaic": ["bayer", "RG/GB", "rgbw-2x2"],
    "sensors.*.ircut_nm": [620.0, 700.0],
    "sensors.*.shift_nm": [5.0, -12.5],
    "sensors.*.pixel.file": ["files/pixel.toml"],
    "sensors.*.pixel.pitch_um": [2.0, 5.6],
    "sensors.*.pixel.full_well_e": [6000.0, 30000.0],
    "sensors.*.pixel.read_noise_e": [0.0, 1.7, 25.0],
    "sensors.*.pixel.dark_current_e_per_s": [20.0, 500.0],
    "sensors.*.pixel.temperature_c": [60.0],
    "sensors.*.pixel.dark_reference_c": [30.0],
    "sensors.*.pixel.dark_doubling_k": [6.5],
    "sensors.*.pixel.dsnu_e": [1.5],
    "sensors.*.pixel.prnu": [0.01, 0.03],
    "sensors.*.pixel.row_noise_e": [0.8],
    "sensors.*.pixel.black_error_e": [3.0, -2.0],
    "sensors.*.pixel.bits": [12, 14],
    "sensors.*.pixel.gain_dn_per_e": [0.9, 4.0],
    "sensors.*.pixel.binning": [4, 2],
    "sensors.*.pixel.binning_mode": ["charge", "digital"],
    "sweeps": [
        [{"vary": vary, "first": first, "last": last, "points": 4, **more}]
        for vary, first, last in (
            ("lux", 0.1, 100.0),
            ("time-ms", 1.0, 12.0),
            ("f-number", 1.4, 8.0),
            ("read-noise-e", 1.0, 20.0),
            ("dark-current-e-per-s", 0.0, 300.0),
            ("temperature-c", 0.0, 60.0),
            ("prnu", 0.0, 0.03),
            ("dsnu-e", 0.0, 5.0),
            ("bits", 8.0, 14.0),
            ("crosstalk", 0.0, 0.2),
            ("ircut-nm", 600.0, 750.0),
            ("kelvin", 2500.0, 7000.0),
            ("infrared", 0.0, 1.0),
        )
        for more in (
            {},
            {"quantity": "total-error"},
            {"quantity": "separation"},
            {
                "second": {
                    "vary": "lux" if vary != "lux" else "prnu",
                    "first": 0.01,
                    "last": 0.05,
                    "points": 2,
                }
            },
        )
    ]
    + [
        [{"vary": "lux", "first": 0.3, "last": 30.0, "points": 3, "quantity": quantity}]
        for quantity in (
            "snr-x",
            "snr-z",
            "bound",
            "price",
            "delta-e",
            "color-error",
            "cdp",
            "information",
            "color-separation",
            "separation-without-brightness",
        )
    ],
    "outputs.analyses": [False],
    "outputs.clip": [True],
    "outputs.budget": [True],
    "outputs.merit": [True],
    "outputs.chart": [True],
    "outputs.space": ["lab", "luv", "srgb", "linear-srgb"],
    "outputs.reader": ["machine", "both"],
    "outputs.matrix": [True],
    "outputs.pareto": [{"first": 0.1, "last": 10.0, "points": 3}],
    "outputs.pipeline.run": [True],
    "outputs.pipeline.white_balance": ["gray", "illuminant", [1.8, 1.0, 1.4]],
    "outputs.pipeline.white_balance_pixels": [400],
    "outputs.pipeline.exposure_gain": [2.0],
    "outputs.pipeline.saturation": [1.2],
    "outputs.pipeline.tone": ["rec709", "linear", 2.2],
    "outputs.pipeline.luma": ["bt601", "rec709"],
    "outputs.pipeline.iso": [[100.0, 400.0]],
    "outputs.pipeline.base_iso": [50.0],
    "outputs.pipeline.iso_read_noise_e": [[3.0, 2.0]],
}
PICTURE: dict[str, list[Any]] = {
    "cube": ["builtin:checker", "builtin:dead-leaves", "builtin:slanted-edges", "builtin:foliage"],
    "mosaic": ["bayer", "RG/GB"],
    "demosaic": ["bilinear", "malvar", "gradient", "lmmse"],
    "raw_only": [True],
    "bits": [10, 12],
    "black_level": [64],
    "frames": [2],
    "denoise": ["guided", "wiener"],
    "formats": [["raw"], ["png", "xyz"], ["srgb16"]],
    "clip": [True],
    "dark_current_e_per_s": [30.0],
    "dsnu_e": [2.0],
    "prnu": [0.02],
    "row_noise_e": [1.0],
    "scale": [0.0004],
    "beyond": ["hold"],
    "bad_pixels": ["zero"],
}

CAMERA = {"name": "onyx-rgb-ircut"}
WHITE = {"name": "onyx-rgbw"}
LAMPS = {"illuminant": "files/lamps.csv", "wavelength_unit": "um"}
WARM = {
    "dark_current_e_per_s": 50.0,
    "temperature_c": 60.0,
    "dark_reference_c": 30.0,
    "dark_doubling_k": 6.5,
}
FIRST: list[dict[str, Any]] = [
    {"sensors": [CAMERA], "light": {**LAMPS, "per": "energy", "column": "first"}},
    {"sensors": [WHITE], "light": {**LAMPS, "per": "photon", "column": "second"}},
    {
        "sensors": [CAMERA],
        "reflectances": {"chart": "files/bare.csv", "scale": "fraction", "wavelength_unit": "um"},
        "outputs": {"chart": True},
    },
    {"sensors": [{**CAMERA, "crosstalk": 0.1, "mosaic": "RG/GB"}]},
    {"sensors": [{**WHITE, "crosstalk": 0.1, "mosaic": "rgbw-2x2", "crosstalk_stage": "charge"}]},
    {"sensors": [{**CAMERA, "crosstalk": "files/kernel.csv", "mosaic": "bayer"}]},
    {"sensors": [{**CAMERA, "pixel": {"file": "files/pixel.toml"}}]},
    {
        "sensors": [CAMERA],
        "prior": "files/reflectances.csv",
        "matrices": ["lmmse"],
        "reflectances": {"beyond": "hold"},
    },
    {"sensors": [{**WHITE, "pixel": WARM}], "outputs": {"clip": True, "budget": False}},
    {"sensors": [{**CAMERA, "pixel": WARM}]},
    {
        "sensors": [WHITE, CAMERA],
        "matrices": ["lmmse"],
        "sweeps": [
            {"vary": "lux", "first": 0.1, "last": 10.0, "points": 5, "all_priors": True},
        ],
    },
    {
        "sensors": [{**CAMERA, "pixel": {"file": "files/pixel.toml", "prnu": 0.001}}, WHITE],
        "outputs": {"clip": True, "budget": False},
    },
    {
        "sensors": [
            {**WHITE, "filter": "files/filter.csv", "shift_ircut_nm": -12.5, "beyond": "hold"},
            {"name": "onyx-rgb", "filter": "ircut-650", "shift_ircut_nm": 20.0, "beyond": "hold"},
        ]
    },
    *(
        {
            "sensors": [CAMERA],
            "pictures": [
                {"cube": "builtin:checker", "mosaic": "bayer", "formats": ["raw"], **more}
            ],
        }
        for more in (
            {"raw_only": True, "bits": 10, "black_level": 64},
            {"raw_only": True, "bits": 12, "dark_current_e_per_s": 30.0, "prnu": 0.02},
            {"raw_only": True, "bits": 14, "row_noise_e": 1.0, "dsnu_e": 2.0},
            {"demosaic": "malvar", "formats": ["xyz", "png"]},
            {"demosaic": "gradient", "denoise": "guided", "formats": ["xyz"]},
            {"demosaic": "lmmse", "formats": ["srgb16"], "frames": 2},
        )
    ),
    *(
        {
            "sensors": [CAMERA],
            "pictures": [
                {
                    "cube": "files/cube.npy",
                    "wavelengths": [400.0, 1050.0],
                    "scale": scale,
                    "formats": ["xyz"],
                }
            ],
        }
        for scale in (0.0005, 0.0003)
    ),
]
"""Studies of keys that are valid only with others."""


NOISE = {
    "column_noise_e": 2.0, "reset_capacitance_ff": 0.5, "rtn_share": 0.02, "rtn_amplitude_e": 30.0
}  # fmt: skip
ADDED: list[dict[str, Any]] = [
    {"sensors": [{**CAMERA, "pixel": NOISE}], "outputs": {"budget": True}},
    {"sensors": [{**CAMERA, "pixel": NOISE}], "outputs": {"clip": True, "budget": False}},
    {
        "sensors": [{**WHITE, "pixel": {**NOISE, "temperature_c": 60.0}}],
        "sweeps": [{"vary": "column-noise-e", "first": 0.0, "last": 9.0, "points": 3}],
    },
    {
        "sensors": [CAMERA],
        "pictures": [{"cube": "builtin:checker", "mosaic": "bayer", "raw_only": True, **NOISE}],
    },
]
"""Studies of keys that came after the record; ``--add`` stores those that it does not have."""


def with_value(study: dict[str, Any], key: str, value: Any) -> None:
    """Set one key of a study; ``*`` is its first sensor."""
    at: Any = study
    *steps, last = key.replace("*", "0").split(".")
    for step in steps:
        at = at[int(step)] if step.isdigit() else at.setdefault(step, {})
    at[last] = value


def drawn_study(rng: random.Random, wanted: list[str]) -> dict[str, Any]:
    """A study with some keys; it may be invalid."""
    sensors = [json.loads(json.dumps(rng.choice(SENSORS))) for _ in range(rng.choice((1, 1, 2, 3)))]
    study: dict[str, Any] = {"sensors": sensors}
    keys = [*wanted, *rng.sample(list(VALUES), rng.choice((0, 1, 2, 4)))]
    for key in keys:
        if key.startswith("pictures."):
            picture = study.setdefault("pictures", [{"cube": "builtin:checker"}])[0]
            picture[key.partition(".")[2]] = rng.choice(PICTURE[key.partition(".")[2]])
        else:
            with_value(study, key, rng.choice(VALUES[key]))
    if "outputs.pipeline.run" not in keys and any(k.startswith("outputs.pipeline") for k in keys):
        study["outputs"]["pipeline"]["run"] = True
    return study


def flat(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """All leaves of a JSON value with their paths."""
    if isinstance(value, Mapping):
        for key, one in value.items():
            yield from flat(one, f"{path}/{key}")
    elif isinstance(value, list | tuple):
        for i, one in enumerate(value):
            yield from flat(one, f"{path}/{i}")
    else:
        yield path, value


def sampled(results: Any) -> dict[str, Any]:
    """At most `NUMBERS` numbers, evenly spaced over all, and a digest of all their paths."""
    leaves = [
        (path, one)
        for path, one in flat(results)
        # gray_noise is also stored under its old name, grey_noise
        if "version" not in path and "/gray_noise/" not in path
    ]
    numbers = [(p, v) for p, v in leaves if isinstance(v, int | float) and not isinstance(v, bool)]
    paths = "\n".join(sorted(path for path, _ in numbers))
    step = max(1, len(numbers) // NUMBERS)
    return {
        "paths": hashlib.sha256(paths.encode()).hexdigest()[:16],
        "numbers": dict(numbers[::step]),
    }


def outcome(data: dict[str, Any], scratch: Path) -> dict[str, Any]:
    """Hash, copied forms and numbers of a study; pictures as digests of their files."""
    study = cn.study_from_data(data)
    folder = scratch if data.get("pictures") else None
    results = cn.run(study, folder=folder) if folder else cn.run(study)
    with patch("chromanoise.study.hashes.__version__", VERSION):
        hash_ = study_hash(study)
    found = {
        "hash": hash_,
        "command": study_as_command(study),
        "toml": study_as_toml(study),
        "python": study_as_python(study),
        **sampled(results.to_list()),
    }
    if folder:
        found["files"] = {
            str(one.relative_to(folder)): hashlib.sha256(one.read_bytes()).hexdigest()[:16]
            for one in sorted(folder.rglob("*"))
            if one.is_file()
            and not one.name.startswith(".")
            and one.suffix not in (".json", ".html", ".md", ".dng")
        }
    return found


def records(seed: int) -> list[dict[str, Any]]:
    """Valid studies until each key occurs often enough, and their outcomes."""
    rng, first = random.Random(seed), list(FIRST)
    made: list[dict[str, Any]] = []
    seen: Counter[str] = Counter()
    keys: list[str] = [*VALUES, *(f"pictures.{key}" for key in PICTURE)]
    tries: Counter[str] = Counter()
    while len(made) < STUDIES or min(seen[key] for key in keys if tries[key] < 60) < LEAST:
        open_keys = [key for key in keys if seen[key] < LEAST and tries[key] < 60]
        wanted = [rng.choice(open_keys or keys)]
        tries[wanted[0]] += 1
        data = first.pop(0) if first else drawn_study(rng, wanted)
        try:
            found = outcome_apart(data)
        except (InputError, ValueError):
            if data in FIRST:
                raise
            continue
        used = {
            "/".join(p for p in path.split("/") if not p.isdigit())[1:].replace("/", ".")
            for path, _ in flat(data)
        }
        for key in keys:
            name = key.replace(".*", "")
            seen[key] += any(one == name or one.startswith(f"{name}.") for one in used)
        made.append({"study": data, **found})
        if len(made) % 40 == 0:
            print(len(made), file=sys.stderr)
    print("keys in no study:", [k for k in keys if not seen[k]], file=sys.stderr)
    return made


def outcome_apart(data: dict[str, Any]) -> dict[str, Any]:
    """`outcome`, with pictures in a folder that is removed."""
    with tempfile.TemporaryDirectory() as scratch:
        return outcome(data, Path(scratch))


def differences(old: Mapping[str, Any], tolerance: float) -> list[str]:
    """What differs between a record and the outcome of its study now."""
    try:
        new = outcome_apart(old["study"])
    except Exception as error:  # whatever it is, it is a difference
        return [f"{type(error).__name__}: {error}"]
    found = [
        key
        for key in ("hash", "command", "toml", "python", "paths", "files")
        if old.get(key) != new.get(key)
    ]
    for path, value in old["numbers"].items():
        now = new["numbers"].get(path)
        if now is None or abs(now - value) > tolerance * max(abs(value), abs(now)) + 1e-12:
            found.append(f"{path}: {value} {now}")
    return found


def stored_records() -> list[dict[str, Any]]:
    """The studies of the record with their outcomes."""
    stored: list[dict[str, Any]] = json.loads(gzip.decompress(RECORD.read_bytes()))
    return stored


def write_records(found: Iterable[Mapping[str, Any]]) -> None:
    """Write the record."""
    text = json.dumps(list(found), separators=(",", ":"))
    RECORD.write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def main() -> None:
    """Write the record, or compare with it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--renew", action="store_true")
    parser.add_argument("--add", action="store_true")
    parser.add_argument("--tolerance", type=float, default=1e-12)
    given = parser.parse_args()
    os.chdir(FOLDER)
    if given.renew:
        studies = [one["study"] for one in stored_records()]
        write_records({"study": study, **outcome_apart(study)} for study in studies)
    elif given.add:
        kept = stored_records()
        known = [one["study"] for one in kept]
        new = [study for study in ADDED if study not in known]
        write_records([*kept, *({"study": study, **outcome_apart(study)} for study in new)])
    elif not given.check:
        write_records(records(1))
    else:
        for i, one in enumerate(stored_records()):
            for line in differences(one, given.tolerance):
                print(i, line)


if __name__ == "__main__":
    main()
