"""What all tests share: shapes in signatures are checked, and hypothesis draws reproducibly."""

import sys
from pathlib import Path

import pytest
from beartype import BeartypeConf, beartype
from hypothesis import settings
from jaxtyping import install_import_hook

from chromanoise._colour_science import colour_science

colour_science()  # first of all: imported bare it sets numpy's print options to those of 1.13
TESTS = Path(__file__).parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "tools")]  # for `from strategies import ...`

# An int may stand for a float (PEP 484).
checked = beartype(conf=BeartypeConf(is_pep484_tower=True))
sys.modules["shape_checker"] = sys.modules[__name__]
install_import_hook("chromanoise", "shape_checker.checked")


def pytest_configure(config: pytest.Config) -> None:
    """Beartype looks at a random entry of a tuple; what hypothesis draws does not depend on it."""
    config.addinivalue_line(
        "filterwarnings", "ignore:Do not use the `random` module inside strategies"
    )


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """With ``-n``: each process gets a run of neighbors, so that few modules are prepared twice."""
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log) if config.getvalue("dist") == "load" else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Modules that are dear to prepare come first: work is stolen from the end of what is left."""
    dear = ("test_page_", "test_report")
    items.sort(key=lambda item: not item.path.name.startswith(dear))


settings.register_profile(
    "laws", max_examples=25, deadline=None, derandomize=True, database=None, print_blob=False
)
settings.load_profile("laws")
