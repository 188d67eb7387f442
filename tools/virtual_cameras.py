"""How far characterized cameras are from the truth, in units of the stated errors.

    python tools/virtual_cameras.py [CAMERAS] [SEED] [small]

draws random virtual cameras (200 by default), writes the frames of each into a scratch folder,
characterizes them, and prints for each parameter how many values lie within 3 stated errors of the
truth, and the mean and standard deviation of z = (found - true) / stated error: 0 and 1 if the
errors are right. Cameras whose dark noise is below 0.49 DN are listed apart: below 0.24 DN^2, EMVA
1288 gives an upper limit of the dark noise only, because the rounding to codes hides it. With
``small``, the cameras have 64 x 64 to 128 x 128 pixels, and DSNU, PRNU, row and column noise that
are 0, small or usual, each listed apart: near 0 a value is the root of a clipped difference.
"""

import math
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import chromanoise as cn
from chromanoise.apps.camera import PlaneTruth, VirtualCamera, photon_transfer_frames
from chromanoise.base.rng import stream

PARAMETERS = (
    *("gain_dn_per_e", "dark_noise_e", "black_level_dn", "full_well_e", "qe"),
    *("dark_current_e_per_s", "dsnu_e", "prnu", "row_noise_e", "column_noise_e"),
)
OF_PIXELS = {"dsnu_of_pixels_e": "dsnu_e", "prnu_of_pixels": "prnu"}
"""True values of the pixels that were drawn, and what is compared with them; not in ``all``."""
COARSE_DN = 0.49
"""Root of 0.24 DN^2, the least dark variance that EMVA 1288 evaluates."""
_GAINS_DN_PER_E = (0.05, 20.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One parameter of one plane.

    Attributes
    ----------
    camera
        Number of the camera.
    parameter
        Name of a field of `PlaneTruth`.
    coarse
        Whether the dark noise is below `COARSE_DN`.
    true
        The true value.
    found, error
        The value found and its stated error; ``None`` if not stated.
    """

    camera: int
    parameter: str
    coarse: bool
    true: float
    found: float | None
    error: float | None

    @property
    def z(self) -> float | None:
        """Deviation over the stated error; ``None`` without one."""
        if self.found is None or self.error is None:
            return None
        deviation = self.found - self.true
        return deviation / self.error if self.error else math.copysign(math.inf, deviation)


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """All findings of one parameter.

    Attributes
    ----------
    values, missing
        Values with a stated error, and values without. [1]
    within_3
        Share of the values within 3 stated errors. [1]
    mean_z, sd_z
        Mean and standard deviation of z; 0 and 1 if the errors are right. [1]
    """

    values: int
    missing: int
    within_3: float
    mean_z: float
    sd_z: float


def random_camera(seed: int, number: int) -> VirtualCamera:
    """A camera whose values are drawn evenly on a logarithmic scale, within those of real cameras.

    Parameters
    ----------
    seed, number
        Of the random numbers. The same camera has the same frames.
    """
    rng = stream(seed, number)

    def log_uniform(low: float, high: float) -> float:
        return float(math.exp(rng.uniform(math.log(low), math.log(high))))

    while True:
        bits = int(rng.integers(8, 17))
        read_e, well_e = log_uniform(0.8, 20.0), log_uniform(500.0, 80_000.0)
        gain = log_uniform(0.3, 1.5) * (2**bits - 1) / well_e  # fills 0.3 to 1.5 of the codes
        black_dn = 6 * math.hypot(read_e * gain, 0.5) * float(rng.uniform(1.2, 2.0)) + 1
        low, high = _GAINS_DN_PER_E
        if low <= gain <= high and black_dn < 0.2 * 2**bits and well_e > 40 * read_e:
            break
    mosaic = "RG/GB" if rng.random() < 0.5 else None
    channels = 1 if mosaic is None else 3
    return VirtualCamera(
        shape=(180, 240) if mosaic is None else (240, 320),
        mosaic=mosaic,
        gain_dn_per_e=gain,
        sensitivity=tuple(float(one) for one in rng.uniform(0.6, 1.0, channels)),
        bits=bits,
        black_level_dn=round(black_dn),
        full_well_e=well_e,
        read_noise_e=read_e,
        qe=float(rng.uniform(0.15, 0.95)),
        dark_current_e_per_s=log_uniform(1.0, 500.0),
        dsnu_e=read_e * log_uniform(0.1, 1.0),
        prnu=float(rng.uniform(0.0, 0.02)),
        row_noise_e=read_e * log_uniform(0.05, 0.5),
        column_noise_e=read_e * log_uniform(0.05, 0.5),
        seed=int(rng.integers(1 << 62)),
    )


def small_camera(seed: int, number: int) -> VirtualCamera:
    """A camera of few pixels; numbers 0, 1, 2 of each three have no, small and usual patterns.

    Parameters
    ----------
    seed, number
        As `random_camera`.
    """
    rng = stream(seed, number)
    read_e = float(math.exp(rng.uniform(math.log(1.5), math.log(8))))

    def pattern() -> float:
        low, high = ((0.0, 0.0), (0.01, 0.15), (0.2, 1.0))[number % 3]
        return float(math.exp(rng.uniform(math.log(low), math.log(high)))) if high else 0.0

    side = int(rng.choice([64, 64, 96, 128]))
    return VirtualCamera(
        shape=(side, side),
        gain_dn_per_e=float(math.exp(rng.uniform(math.log(0.5), math.log(2)))),
        bits=14,
        black_level_dn=200,
        full_well_e=7000.0,
        read_noise_e=read_e,
        dark_current_e_per_s=10.0,
        dsnu_e=read_e * pattern(),
        prnu=0.02 * pattern(),
        row_noise_e=read_e * pattern(),
        column_noise_e=read_e * pattern(),
        seed=int(rng.integers(1 << 62)),
    )


def findings(
    seed: int, number: int, drawn: Callable[[int, int], VirtualCamera] = random_camera
) -> list[Finding]:
    """What is found of one random camera."""
    camera = drawn(seed, number)
    with tempfile.TemporaryDirectory() as folder:
        photon_transfer_frames(camera, folder=Path(folder, "frames"))
        characterize: Any = cn.characterize
        planes = {plane.name: plane for plane in characterize(Path(folder, "frames")).planes}
    truth = camera.planes()
    if sorted(planes) != sorted(plane.name for plane in truth):
        raise RuntimeError(f"camera {number}: the planes are {', '.join(planes)}")
    return [one for plane in truth for one in _of_plane(number, plane, planes[plane.name])]


def _of_plane(number: int, truth: PlaneTruth, plane: Any) -> list[Finding]:
    return [
        Finding(
            camera=number,
            parameter=name,
            coarse=truth.dark_noise_e * truth.gain_dn_per_e < COARSE_DN,
            true=getattr(truth, name),
            found=getattr(plane, OF_PIXELS.get(name, name)),
            error=getattr(plane, f"{OF_PIXELS.get(name, name)}_se"),
        )
        for name in (*PARAMETERS, *OF_PIXELS)
    ]


def scores(found: Iterable[Finding]) -> dict[str, Score]:
    """The score of each parameter, and of `PARAMETERS` together under ``all``."""
    kept = list(found)
    named = {name: _of(kept, name) for name in (*PARAMETERS, *OF_PIXELS, "all")}
    return {name: _score(some) for name, some in named.items()}


def _of(found: list[Finding], name: str) -> list[Finding]:
    """The findings of one parameter, or of ``all``."""
    names = PARAMETERS if name == "all" else (name,)
    return [one for one in found if one.parameter in names]


def _score(found: list[Finding]) -> Score:
    z = np.array([one.z for one in found if one.z is not None], dtype=float)
    known = z.size > 0
    finite = z[np.isfinite(z)]
    return Score(
        values=z.size,
        missing=len(found) - z.size,
        within_3=float((np.abs(z) <= 3).mean()) if known else math.nan,
        mean_z=float(finite.mean()) if finite.size else math.nan,
        sd_z=float(finite.std()) if finite.size else math.nan,
    )


def table(found: Iterable[Finding]) -> str:
    """The scores as a table in text, with the value that is farthest from the truth."""
    kept = list(found)
    lines = [
        f"{'parameter':22}{'values':>8}{'missing':>9}{'within 3':>10}{'mean z':>8}{'sd z':>7}"
        "   farthest"
    ]
    for name, score in scores(kept).items():
        own = [one for one in _of(kept, name) if one.z is not None]
        farthest = max(own, key=lambda one: abs(one.z or 0.0), default=None)
        note = "" if farthest is None else (
            f"z = {farthest.z:.1f}, camera {farthest.camera}: {farthest.found:.5g}, "
            f"true {farthest.true:.5g}"
        )  # fmt: skip
        lines.append(
            f"{name:22}{score.values:8}{score.missing:9}{score.within_3:10.2%}{score.mean_z:8.2f}"
            f"{score.sd_z:7.2f}   {note}"
        )
    return "\n".join(lines)


def main(cameras: int = 200, seed: int = 1, *, small: bool = False) -> None:
    """Print the tables of the fine and of the coarse cameras, or of each kind of small camera."""
    if not hasattr(cn, "characterize"):
        sys.exit("this version of chromanoise has no characterize")
    found: list[Finding] = []
    for number in range(cameras):
        found += findings(seed, number, small_camera if small else random_camera)
        print(f"\r{number + 1} of {cameras} cameras", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    if small:
        for kind, title in enumerate(("no", "small", "usual")):
            print(f"{title} patterns\n{table([f for f in found if f.camera % 3 == kind])}\n")
        return
    for coarse, title in ((False, "at least"), (True, "below")):
        group = [one for one in found if one.coarse is coarse]
        count = len({one.camera for one in group})
        print(f"{count} cameras with a dark noise of {title} {COARSE_DN} DN\n{table(group)}\n")


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "small"]
    main(*(int(word) for word in words), small="small" in sys.argv)
