"""
Where the SNR of luminance is lost
==================================

The budget starts with the SNR of all photons that hit the pixels. Each cause takes its decibels,
and what remains is the SNR of Y. Without IR-cut (above) the filters cost less, but correlation
and infrared cost more.
"""

import matplotlib.pyplot as plt

import chromanoise as cn

pair = cn.analyze("onyx-rgbw", "onyx-rgb-ircut", lux=10, time_ms=12)
budgets = [cn.study.coordinate_budget(one, "Y") for one in pair.analyses]

with cn.charts.chromanoise_style():
    figure, axes = plt.subplots(2, 1, figsize=(7.2, 5.6), sharex=True, layout="constrained")
    for analysis, budget, ax in zip(pair.analyses, budgets, axes, strict=True):
        limits_db = (0, max(one.photons_db for one in budgets))
        cn.charts.draw_budget(budget, analysis.sensor, ax, limits_db=limits_db)
    axes[0].set_xlabel("")

for budget in budgets:
    lost_db = sum(cost.cost_db for cost in budget.costs)
    assert abs(budget.photons_db - lost_db - budget.snr_db) < 1e-9
bare, cut = ({cost.cause: cost.cost_db for cost in budget.costs} for budget in budgets)
assert bare["filters"] < cut["filters"] - 4
assert bare["correlation"] > cut["correlation"] + 4
assert bare["infrared"] > cut["infrared"] + 4
