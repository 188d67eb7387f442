"""Settings of the documentation site; ``make docs`` builds it into ``out/site``."""

import os
import sys
import warnings
from pathlib import Path

import jaxtyping  # noqa: F401  # imported first, so that signatures show the shapes of arrays

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["MPLBACKEND"] = "agg"

import chromanoise  # noqa: E402

project = "chromanoise"
author = "the chromanoise developers"
project_copyright = author
version = release = chromanoise.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "myst_nb",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "mathml",
    "reference_pages",
]
exclude_patterns = ["_ext", "gallery", "auto_gallery/*.ipynb", "**/.ipynb_checkpoints"]
nitpicky = True
nitpick_ignore_regex = [(r"py:.*", r".*")]  # types of other libraries have no pages here
default_role = "py:obj"
suppress_warnings = ["config.cache"]

# Python
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
python_maximum_signature_line_length = 88
python_use_unqualified_type_names = True
add_module_names = False

# Markdown and notebooks
myst_enable_extensions = ["amsmath", "attrs_block", "deflist", "dollarmath"]
myst_heading_anchors = 4
myst_fence_as_directive = []
nb_execution_mode = "cache"
nb_execution_cache_path = str(HERE.parent / "out" / "notebooks")
nb_execution_in_temp = True
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_ipywidgets_js = {}
copybutton_exclude = ".linenos, .gp, .go"

# pictures made by the scripts under them
sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "image_scrapers": ("matplotlib",),
    "matplotlib_animations": False,
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1e9,
    "within_subsection_order": "FileNameSortKey",
    "write_computation_times": False,
}

# pages
html_theme = "furo"
html_title = f"chromanoise {release.partition('.dev')[0]}"  # short, for the sidebar
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_split_index = True
html_show_sphinx = False
html_last_updated_fmt = None
html_theme_options = {"navigation_with_keys": True}
linkcheck_ignore = [r"http://127\.0\.0\.1.*", r"http://localhost.*"]
linkcheck_timeout = 20
warnings.filterwarnings("ignore", category=DeprecationWarning, module="jupyter_.*")

TRY = """
```{raw} html
<p><a href="try/index.html"><strong>Try it now</strong></a>: the page in your browser, without
installation; your files stay on your computer. <a href="try/chromanoise.html" download>Download the
page</a> as one file that opens from a disk (<a href="try/chromanoise.html.sha256">sha256</a>).</p>
```
"""


def with_links_to_the_page(app, name, source):
    """The start page has links to the page as one file, where that was built first."""
    if name == "index" and (HERE.parent / "out" / "web" / "site").is_dir():
        source[0] = source[0].replace("<!-- try it now -->", TRY)


def setup(app):
    """Add what this site does beyond Sphinx."""
    app.connect("source-read", with_links_to_the_page)
