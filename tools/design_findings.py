"""The tables of docs/findings.md on sensors that beat both sensors of the paper.

    python tools/design_findings.py [DESIGN.toml ...]

searches each design (those of `examples/designs`) at 10, 1 and 0.1 lx, without and with 10 %
crosstalk of designs and references. It checks each sensor of each front by `cn.analyze`, a million
draws and a rendered picture, and lets it deviate by 5 nm and 5 %. Each search has three seeds and a
polish; their agreement is printed.
"""

import sys
from pathlib import Path

import numpy as np

import chromanoise as cn
from chromanoise.apps.design import Design, DesignStudy, read_design
from chromanoise.apps.design.design_result import convergence_sentences
from chromanoise.apps.design.objectives import OBJECTIVES
from chromanoise.apps.design.optimizing import task_of
from chromanoise.noise import expected_electrons, monte_carlo, noise_sources
from chromanoise.spectra import flat_field
from chromanoise.spectra.builtin_scenes import GAP_PX, PATCH_PX
from chromanoise.study import Analyses

DESIGNS = tuple(sorted(Path("examples/designs").glob("*.toml")))
LEVELS_LUX = (10.0, 1.0, 0.1)
CROSSTALK = (0.0, 0.1)
BUDGETS = {("better_than_both", 1.0, 0.0): 1_000_000}  # design, level [lx], crosstalk
DRAWS = 1_000_000
DEVIATIONS = 256
TOLERANCE_NM, TOLERANCE_SHARE = 5.0, 0.05
WHITE_ROW = 3  # of the patches of the chart; the white is the first of this row


def design_at(path: Path, level_lux: float, crosstalk: float) -> DesignStudy:
    """The design at another level, with crosstalk in the designs, and in the references' limits."""
    document = read_design(path)
    light = document.light.model_copy(update={"level_lux": level_lux})
    sensors = tuple(
        one.model_copy(update={"crosstalk": crosstalk or None}) for one in document.sensors
    )
    references = task_of(
        document.model_copy(update={"light": light, "sensors": sensors})
    ).references
    limits = []
    for one in document.design.constraints:
        best = max if one.side == "at_least" else min
        limit = best(reference.objectives[one.objective] for reference in references)
        limits.append(one.model_copy(update={one.side: limit}))
    update: dict[str, object] = {"constraints": tuple(limits)}
    if crosstalk:
        update["crosstalk"] = document.design.crosstalk.model_copy(update={"share": crosstalk})
    design = document.design.model_copy(update=update)
    return document.model_copy(update={"light": light, "design": design})


def white_snr_db(analyses: Analyses) -> float:
    """SNR of Y of the one sensor of an analysis. [dB]"""
    ((snr_db,),) = ([row["Y"]] for row in analyses.color_snr_db().values())
    assert snr_db is not None  # a member of a front is not saturated
    return snr_db


def checked(found: Design, level_lux: float) -> str:
    """Each member by three other ways: `cn.analyze`, draws and a picture."""
    (scene,) = found.task.scenes
    time_ms = 1e3 * scene.point.exposure.time_s
    by_analysis, z, by_picture = [], [], []
    for i, member in enumerate(found.members):
        sensor, closed_db = member.sensor, member.objectives["snr_y_db"]
        analysis = cn.analyze(sensor, lux=level_lux, time_ms=time_ms)
        by_analysis.append(white_snr_db(analysis) - closed_db)
        (point,) = analysis.points
        white = flat_field(point.illuminant, level_lux=level_lux)
        estimate = monte_carlo(
            expected_electrons(white, sensor, point.exposure),
            sensor.pixel,
            scene.maker(point).matrix[1:2],
            draws=DRAWS,
            seed=1,
            name=(i,),
            noise=noise_sources(sensor, point.exposure),
        )
        z.append(float((estimate.snr_db[0] - closed_db) / estimate.snr_se_db[0]))
        patch = cn.analyze(sensor, lux=level_lux, time_ms=time_ms, patch="white")
        (taken,) = cn.render("builtin:checker", sensor, lux=level_lux, time_ms=time_ms).captures
        top = GAP_PX + WHITE_ROW * (PATCH_PX + GAP_PX)
        assert taken.picture is not None  # every pixel has every channel
        y = taken.picture.xyz[top : top + PATCH_PX, GAP_PX : GAP_PX + PATCH_PX, 1].astype(float)
        by_picture.append(
            20 * np.log10(y.mean() / y.std()) - patch.color_snr_db()[sensor.name]["Y"]
        )
    return (
        f"checks of {len(z)} sensors: cn.analyze within {np.abs(by_analysis).max():.1e} dB; "
        f"{DRAWS:,} draws: largest |z| {np.abs(z).max():.2f}, rms "
        f"{np.sqrt(np.mean(np.square(z))):.2f}; white patch of a picture: mean difference "
        f"{np.mean(by_picture):+.3f} dB, largest {np.abs(by_picture).max():.2f} dB"
    )


def deviating(found: Design) -> str:
    """What deviations of 5 nm and 5 % cost, in 95 % of the copies of each member."""
    parameters = found.task.space.parameters
    values = np.array([one.values for one in found.members])
    in_nm = np.array([one.name.endswith(("center_nm", "cutoff_nm")) for one in parameters])
    width = np.where(in_nm, TOLERANCE_NM, TOLERANCE_SHARE * values)
    width[:, [bool(one.choices) for one in parameters]] = 0.0
    least = np.array([one.least for one in parameters])
    most = np.array([one.most for one in parameters])
    rng = np.random.default_rng(1)
    moved = rng.uniform(-1, 1, (DEVIATIONS, *values.shape)) * width
    copies = np.clip(values + moved, least, most).reshape(-1, width.shape[1])
    evaluator = found.task.evaluator
    nominal = evaluator.values(found.task.space.candidates(values))
    after = evaluator.values(found.task.space.candidates(copies))
    after = after.reshape(DEVIATIONS, *nominal.shape) - nominal
    losses, lines = [], []
    for k, name in enumerate(evaluator.objectives):
        worst = 5 if OBJECTIVES[name].better == "higher" else 95
        loss = np.percentile(after[..., k], worst, axis=0)
        losses.append(f"{name} {np.median(loss):+.3g} ({loss.min():+.3g} to {loss.max():+.3g})")
        lines += [
            f"{one.name}, in 95 % of the copies: {name} {at:.4g}"
            for one, at in zip(found.members, nominal[:, k] + loss, strict=True)
            if one.extreme_of
        ]
    return "\n".join(["5 nm and 5 %, 95 % of copies are within: " + ", ".join(losses), *lines])


def rows(found: Design) -> list[str]:
    """References, extremes and knee as a table, and their parameters."""
    names = found.task.evaluator.objectives
    lines = [
        "| sensor | " + " | ".join(f"{name} [{OBJECTIVES[name].unit}]" for name in names) + " |",
        "|---" * (len(names) + 1) + "|",
    ]
    shown = [one for one in found.members if one.extreme_of or one.knee]
    values = np.array([one.values for one in shown])
    objectives = found.task.evaluator.values(found.task.space.candidates(values))
    limits = {one.objective: one.value for one in found.task.limits}
    numbers = " | ".join(f"{limits[name]:.4g}" if name in limits else "" for name in names)
    lines.append(f"| the better of the references | {numbers} |")
    for one, row in zip(shown, objectives, strict=True):
        lines.append(f"| {one.name} | " + " | ".join(f"{value:.4g}" for value in row) + " |")
    parameters = found.task.space.parameters
    for one in shown:
        chosen = (
            f"{p.name} {p.choices[round(v)] if p.choices else format(v, '.4g')}"
            for p, v in zip(parameters, one.values, strict=True)
        )
        lines.append(f"{one.name}: {', '.join(chosen)}")
    return lines


def main(designs: tuple[Path, ...]) -> None:
    """Print the tables."""
    for path in designs:
        for crosstalk in CROSSTALK:
            for level_lux in LEVELS_LUX:
                print(f"\n## {path.stem}, {level_lux:g} lx, crosstalk {crosstalk:.0%}")
                document = design_at(path, level_lux, crosstalk)
                try:
                    budget = BUDGETS.get((path.stem, level_lux, crosstalk))
                    found = cn.optimize(document, budget=budget)
                except cn.InputError as error:
                    print(error)
                    continue
                print(*rows(found), sep="\n")
                print(*convergence_sentences(found.result, found.front.objectives), sep="\n")
                print("best of each seed:", found.result.convergence.best.tolist())
                print(deviating(found))
                if not crosstalk:
                    print(checked(found, level_lux))


if __name__ == "__main__":
    main(tuple(map(Path, sys.argv[1:])) or DESIGNS)
