"""Public names: imported on first use (PEP 562), and old names that work for one release."""

import ast
import sys
import warnings
from collections.abc import Callable
from functools import wraps
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, ParamSpec, Protocol, TypeVar

_P = ParamSpec("_P")
_R = TypeVar("_R")


MOVED_PACKAGES = {
    "chromanoise.analysis": "chromanoise.study",
    "chromanoise.catalog": "chromanoise.study",
    "chromanoise.characterization": "chromanoise.apps.camera",
    "chromanoise.denoising": "chromanoise.imaging.denoising",
    "chromanoise.design": "chromanoise.apps.design",
    "chromanoise.errors": "chromanoise.base",
    "chromanoise.exposure": "chromanoise.noise",
    "chromanoise.figures": "chromanoise.charts",
    "chromanoise.paper": "chromanoise.apps.paper",
    "chromanoise.properties": "chromanoise.base",
    "chromanoise.report": "chromanoise.web",
    "chromanoise.rng": "chromanoise.base",
    "chromanoise.scene": "chromanoise.spectra",
    "chromanoise.scene.builtin": "chromanoise.spectra",
    "chromanoise.units": "chromanoise.base",
}
"""Where the packages of release 0.2 are; the old names warn and work for one release."""

_TRAINING = "chromanoise.apps.training"
MOVED_NAMES = {
    "chromanoise.noise": dict.fromkeys(("NoiseSampler", "NoisySample", "sampler"), _TRAINING),
    "chromanoise.imaging": dict.fromkeys(
        (
            "AddCameraNoise",
            "NoiseSampler",
            "NoisyDataset",
            "NoisySample",
            "Rendering",
            "draw_rendering",
            "linear_from_srgb",
            "mosaicked",
            "process",
            "sampler",
            "unprocess",
        ),
        _TRAINING,
    ),
}
MOVED_NAMES["chromanoise.imaging.denoising"] = dict.fromkeys(
    (
        "BenchmarkCamera",
        "BenchmarkCell",
        "EdgeSharpness",
        "FlatNoise",
        "Verdict",
        "benchmark_cells",
        "markdown_table",
        "verdict",
        "verdict_sentences",
        "BenchmarkScene",
        "benchmark_scene",
    ),
    "chromanoise.apps.denoising_benchmark",
)
MOVED_NAMES["chromanoise.charts"] = {
    **dict.fromkeys(
        (
            "characterization_figures",
            "draw_characterization",
            "draw_linearity",
            "draw_linearity_deviation",
            "draw_photon_transfer",
            "draw_predicted_variance",
            "draw_snr",
            "draw_variance_residuals",
        ),
        "chromanoise.apps.camera",
    ),
    **dict.fromkeys(("draw_front", "draw_sensitivity", "front_figure"), "chromanoise.apps.design"),
    **dict.fromkeys(
        (
            "CAPTIONS",
            "draw_mosaic",
            "draw_observer",
            "paper_figures",
            "draw_color_projection",
            "draw_color_uncertainty",
            "draw_contravariant",
            "draw_light_above_plane",
            "draw_measurement",
            "draw_uncertainty",
        ),
        "chromanoise.apps.paper",
    ),
}
"""Where single names of a package are that moved elsewhere."""


class MovedPackages:
    """Imports an old package as the one that has its names now, with a `FutureWarning`.

    A finder and loader without the base classes of `importlib.abc`, whose import would take a third
    of the time of ``import chromanoise``.
    """

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:
        """A spec for the old names of packages, and for the modules in them, alone."""
        return None if _new_place(fullname) is None else ModuleSpec(fullname, self)  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> None:
        """The module is made in the usual way."""

    def exec_module(self, module: ModuleType) -> None:
        """Put the new module in the place of the old one."""
        new = str(_new_place(module.__name__))
        frame = sys._getframe(1)  # of the line that imports: stacklevels differ by form of import
        while frame.f_back and (
            "importlib" in frame.f_code.co_filename or frame.f_code.co_filename == __file__
        ):
            frame = frame.f_back
        warnings.warn_explicit(
            old_name_sentence(module.__name__, new),
            FutureWarning,
            frame.f_code.co_filename,
            frame.f_lineno,
            module=frame.f_globals.get("__name__"),
            registry=frame.f_globals.setdefault("__warningregistry__", {}),
        )
        sys.modules[module.__name__] = import_module(new)


def _new_place(name: str) -> str | None:
    parent, _, last = name.rpartition(".")
    if parent in MOVED_PACKAGES and name not in MOVED_PACKAGES:
        return f"{MOVED_PACKAGES[parent]}.{last}"
    return MOVED_PACKAGES.get(name)


def _moved(package: str, name: str) -> object:
    old = f"{package}.{name}"
    if old in MOVED_PACKAGES:
        return import_module(old)
    new = MOVED_NAMES[package][name]
    warn_of_old_name(old, f"{new}.{name}", stacklevel=4)
    return getattr(import_module(new), name)


def lazy_names(
    package: str, **old: str
) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """``__getattr__``, ``__dir__`` and ``__all__`` of a package that imports on first use.

    The names are those that its ``__init__`` imports under ``if TYPE_CHECKING:``, so that type
    checkers and this function read the same lines. A name that is a submodule is imported as one.
    Public are the names that it imports as themselves (PEP 484), on first use or at once.

    Parameters
    ----------
    package
        The ``__name__`` of the package; each import is absolute, ``from module import name``.
    old
        As ``new`` of `old_names`.

    Raises
    ------
    ImportError
        If the source of the package is missing.

    Examples
    --------
    In an ``__init__.py``::

        from typing import TYPE_CHECKING

        from chromanoise.base.lazy import lazy_names

        if TYPE_CHECKING:
            from chromanoise.spectra.curves import Grid as Grid

        __getattr__, __dir__, __all__ = lazy_names(__name__)
    """
    module_of, public = _imports(package)
    otherwise = old_names(package, **old)
    moved = MOVED_NAMES.get(package, {})

    def imported(name: str) -> object:
        if name in moved or f"{package}.{name}" in MOVED_PACKAGES:
            return _moved(package, name)
        if name not in module_of:
            return otherwise(name, stacklevel=4)
        module, attribute = module_of[name]
        if module == package:
            return import_module(f"{package}.{attribute}")
        value = getattr(import_module(module), attribute)
        setattr(sys.modules[package], name, value)  # found without this function from now on
        return value

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *module_of})

    return imported, names, public


class _OldName(Protocol):
    def __call__(self, name: str, stacklevel: int = 3) -> object: ...


def old_names(package: str, **new: str) -> _OldName:
    """``__getattr__`` of a package that also has old names for a release, with a `FutureWarning`.

    Parameters
    ----------
    package
        The ``__name__`` of the package.
    new
        The new name by the old one.

    Examples
    --------
    In an ``__init__.py``::

        __getattr__ = old_names(__name__, Frame="DualBasis")
    """

    def found(name: str, stacklevel: int = 3) -> object:
        if name not in new:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        warn_of_old_name(f"{package}.{name}", f"{package}.{new[name]}", stacklevel=stacklevel)
        return getattr(sys.modules[package], new[name])

    return found


def renamed_keywords(**new: str) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """A decorator: the function also takes its old keywords, with a `FutureWarning`.

    Parameters
    ----------
    new
        The new keyword by the old one.

    Raises
    ------
    TypeError
        When the function is called with both.

    Examples
    --------
    >>> @renamed_keywords(method="denoise")
    ... def denoised(picture, *, denoise="guided"):
    ...     return denoise
    >>> denoised(1, denoise="lmmse")
    'lmmse'
    """

    def decorated(function: Callable[_P, _R]) -> Callable[_P, _R]:
        @wraps(function)
        def called(*args: _P.args, **keywords: _P.kwargs) -> _R:
            for old in new.keys() & keywords.keys():
                if new[old] in keywords:
                    raise TypeError(f"{old} is the old name of {new[old]}; give {new[old]} alone")
                warn_of_old_name(old, new[old])
                keywords[new[old]] = keywords.pop(old)
            return function(*args, **keywords)

        return called

    return decorated


def warn_of_old_name(old: str, new: str, *, stacklevel: int = 3) -> None:
    """Warn with a `FutureWarning`, by default where the caller of this function was called.

    Parameters
    ----------
    old, new
        The old name, which works for one release, and the new one.
    stacklevel
        As `warnings.warn`.
    """
    warnings.warn(old_name_sentence(old, new), FutureWarning, stacklevel=stacklevel)


def old_name_sentence(old: str, new: str) -> str:
    """The text of the warning of `warn_of_old_name`."""
    return f"{old} is now {new}; the old name works in this release only"


def _imports(package: str) -> tuple[dict[str, tuple[str, str]], list[str]]:
    """Module and attribute of the names for type checkers; the names imported as themselves."""
    spec = sys.modules[package].__spec__
    source = spec.loader.get_source(package) if spec and spec.loader else None  # type: ignore[attr-defined]
    if source is None:
        raise ImportError(f"{package}: its source is needed to import its names", name=package)
    body = ast.parse(source).body
    later = [
        node
        for block in body
        if isinstance(block, ast.If) and getattr(block.test, "id", "") == "TYPE_CHECKING"
        for node in block.body
    ]
    module_of, public = {}, []
    for node in (*body, *later):
        for alias in node.names if isinstance(node, ast.ImportFrom) else ():
            if node in later:
                module_of[alias.asname or alias.name] = (node.module or "", alias.name)
            if alias.asname == alias.name:
                public.append(alias.name)
    return module_of, sorted(public)


# ---- what a package uses of higher layers: a result draws itself without importing charts ----

_ABOVE: dict[str, str] = {}


def register_above(**modules: str) -> None:
    """Register modules of higher packages, imported on first use.

    Parameters
    ----------
    modules
        The dotted name of a module by the name under which lower packages ask for it.
    """
    _ABOVE.update(modules)


def from_above(name: str) -> Any:
    """The module that is registered under a name."""
    return import_module(_ABOVE[name])
