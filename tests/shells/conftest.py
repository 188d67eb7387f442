"""What the tests of several commands share."""

import json
import re
import sys
import tomllib
from pathlib import Path

import pytest

from chromanoise.base.errors import InputError, errors_in
from chromanoise.cli import entry, main
from chromanoise.web.uploads import Uploads
from outcomes import Outcome
from shells.browser import address, browser, chromium, page, page_address, watch, window

__all__ = ["address", "browser", "chromium", "page", "page_address", "watch", "window"]  # fixtures


@pytest.fixture
def run(capsys, monkeypatch):
    """Run the command line; give back its `Outcome`."""
    ended, sentence = [], entry._sentence

    def recorded(error, command):
        ended.extend(errors_in(error) if isinstance(error, InputError) else ())
        return sentence(error, command)

    monkeypatch.setattr(entry, "_sentence", recorded)

    def call(*arguments):
        ended.clear()
        with pytest.raises(SystemExit) as stop:
            main([str(argument) for argument in arguments])
        text = capsys.readouterr()
        return Outcome(stop.value.code, text.out, text.err, errors=tuple(ended))

    return call


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def done(run):
    """Run a command that succeeds; give back (standard output, standard error)."""

    def call(*arguments):
        code, out, err = run(*arguments)
        assert code == 0, err
        return out, err

    return call


@pytest.fixture
def result_of(done):
    """Run a command that succeeds with ``--json -``; give back its result."""

    def call(*arguments):
        return json.loads(done(*arguments, "--json", "-")[0])

    return call


@pytest.fixture
def uploads():
    """A folder of files that are dropped on the page."""
    kept = Uploads()
    yield kept
    kept.close()


@pytest.fixture
def no_sliders(monkeypatch):
    """Reports of this process have no sliders, whose answers take most of the time."""
    monkeypatch.setattr("chromanoise.web.report_of_study.slides_of", lambda of: ())


@pytest.fixture
def plain_report(no_sliders, monkeypatch):
    """Reports of this process have no card either."""
    monkeypatch.setattr("chromanoise.web.report_of_study._card", lambda of, work: "")


_MODULES = {
    "bm3d": "bm3d",
    "cma": "cma",
    "dask": "dask",
    "distributed": "distributed",
    "astropy": "astropy",
    "h5netcdf": "h5netcdf",
    "h5py": "h5py",
    "imagecodecs": "imagecodecs",
    "opencv-python-headless": "cv2",
    "openexr": "OpenEXR",
    "openpyxl": "openpyxl",
    "pandas": "pandas",
    "pymoo": "pymoo",
    "pywavelets": "pywt",
    "rawpy": "rawpy",
    "scikit-image": "skimage",
    "torch": "torch",
    "xarray": "xarray",
    "zarr": "zarr",
}
_EXTRAS = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text("utf-8"))[
    "project"
]["optional-dependencies"]
_INSTALLED = ("compiled", "bench", "dev", "docs")  # the README installs the first
_OF_USERS = [packages for name, packages in _EXTRAS.items() if name not in _INSTALLED]


@pytest.fixture
def without_extras(monkeypatch):
    """As the README installs: this process can import no package of the other extras."""
    names = {re.split(r"[><=[]", one)[0] for packages in _OF_USERS for one in packages}
    assert names - {"chromanoise"} == set(_MODULES)
    for name in [one for one in sys.modules if one.split(".")[0] in _MODULES.values()]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [_Without(finder) for finder in sys.meta_path])


class _Without:
    """A finder of modules that finds none of an extra."""

    def __init__(self, finder):
        self.finder = finder

    def find_spec(self, name, path=None, target=None):
        found = name.split(".")[0] not in _MODULES.values()
        return self.finder.find_spec(name, path, target) if found else None

    def __getattr__(self, name):
        return getattr(self.finder, name)
