"""One self-contained page: everything arranged, no number born here."""

from chromanoise.report.demo import demo_page

__all__ = ["demo_page"]
