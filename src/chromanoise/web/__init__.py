"""The local page, which updates while a slider moves, and reports as HTML files."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.web.further_reports import (
        characterization_report as characterization_report,
        demo_page as demo_page,
        omitted_files,
        write_characterization as write_characterization,
        write_denoising_report as write_denoising_report,
    )
    from chromanoise.web.page_studies import served_data
    from chromanoise.web.report_of_study import (
        Sight as Sight,
        report_data as report_data,
        sights_of as sights_of,
        study_report as study_report,
    )
    from chromanoise.web.server import listening_socket, page_server

__getattr__, __dir__, __all__ = lazy_names(__name__)
