"""What all tests share: shapes in signatures are checked, and hypothesis draws reproducibly."""

import sys
from pathlib import Path

import colour  # before any array is printed: its import sets numpy's print options ...
import numpy as np
import pytest
from beartype import BeartypeConf, beartype
from hypothesis import settings
from jaxtyping import install_import_hook

np.set_printoptions(legacy=False)  # ... to those of numpy 1.13, and doctests read array([ 1.])

assert colour.__version__  # imported for what it does to numpy; tests import it themselves
sys.path.insert(0, str(Path(__file__).parent))  # for `from strategies import ...`

# An int may stand for a float (PEP 484).
checked = beartype(conf=BeartypeConf(is_pep484_tower=True))
sys.modules["shape_checker"] = sys.modules[__name__]
stages = [
    "spectra",
    "scene",
    "sensor",
    "exposure",
    "noise",
    "geometry",
    "color",
    "merit",
    "imaging",
    "study",
    "figures",
]
# all but `units`: study.reproduction hands its decibel() a np.float64, the signature says array
install_import_hook(
    [f"chromanoise.{name}" for name in ("_check", "_linalg", "rng", *stages)],
    "shape_checker.checked",
)


def pytest_configure(config: pytest.Config) -> None:
    """Beartype looks at a random entry of a tuple; what hypothesis draws does not depend on it."""
    config.addinivalue_line(
        "filterwarnings", "ignore:Do not use the `random` module inside strategies"
    )


settings.register_profile(
    "laws", max_examples=25, deadline=None, derandomize=True, database=None, print_blob=False
)
settings.load_profile("laws")
