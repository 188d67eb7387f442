"""The local page: it asks, `chromanoise.study.drawings` answers; no number is born here."""
