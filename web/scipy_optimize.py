"""In place of scipy/optimize/__init__.py, which imports all solvers: only what answers use."""

from importlib import import_module

_HOMES = {"nnls": "_nnls"}


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"scipy.optimize.{name} is not part of this page")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
