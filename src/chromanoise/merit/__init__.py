"""What a measurement is worth: SNR at every stage, its bound and price, color error."""

from chromanoise.merit.accuracy import chart_color_error
from chromanoise.merit.snr import bound_db, price_db, snr_db

__all__ = ["bound_db", "chart_color_error", "price_db", "snr_db"]
