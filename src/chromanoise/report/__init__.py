"""Self-contained HTML pages of the paper and of a study; reports compute nothing themselves."""

from chromanoise.report.characterization_report import (
    characterization_report,
    write_characterization,
)
from chromanoise.report.demo import demo_page
from chromanoise.report.denoising_report import write_denoising_report
from chromanoise.report.study_report import Sight, report_data, sights_of, study_report

__all__ = [
    "Sight",
    "characterization_report",
    "demo_page",
    "report_data",
    "sights_of",
    "study_report",
    "write_characterization",
    "write_denoising_report",
]
