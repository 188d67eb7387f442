"""The version of the package."""

try:
    from chromanoise.base._version import version as _version
except ImportError:  # a source tree that was never installed
    _version = "0+unknown"
__version__: str = _version
