"""The local page: it asks, `chromanoise.charts` answers; no number is born here."""
