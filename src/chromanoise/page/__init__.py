"""The local web page; `chromanoise.charts` computes all its numbers."""
