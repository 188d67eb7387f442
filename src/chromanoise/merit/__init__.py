"""What a measurement is worth: SNR at every stage, its bound and price, color error."""

from chromanoise.merit.accuracy import chart_color_error
from chromanoise.merit.budget import Budget, Cost, color_budget, shapley_values
from chromanoise.merit.snr import bound_db, price_db, snr_db

__all__ = [
    "Budget",
    "Cost",
    "bound_db",
    "chart_color_error",
    "color_budget",
    "price_db",
    "shapley_values",
    "snr_db",
]
