"""What the tests of several commands share."""

import pytest

from chromanoise.base.errors import InputError, errors_in
from chromanoise.cli import entry, main
from outcomes import Outcome
from shells.browser import address, browser, page, page_address, watch, window

__all__ = ["address", "browser", "page", "page_address", "watch", "window"]  # fixtures


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
