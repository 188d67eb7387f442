"""Render errors for the command line, with options in place of settings."""

from collections.abc import Mapping

from chromanoise.errors import InputError, Setting, StudyError, errors_in, setting_of_study

_NONE: Mapping[str, str] = {}
_OF_A_FILE = ("run", "rerun", "report", "serve", "optimize")  # a study or design has the settings


def sentences(error: InputError, command: str = "", options: Mapping[str, str] = _NONE) -> str:
    """One sentence per error, with options in place of settings.

    Parameters
    ----------
    error
        An error of the library.
    command
        Name of the command. Some settings have different options in different commands.
    options
        Options of the command by parameter name, also those that are no setting of a study, e.g.
        ``threads``.
    """
    if isinstance(error, StudyError) and error.places:  # a study file: its terms, not options
        lines = error.sentences()
    else:
        lines = [_sentence(one, command, options) for one in errors_in(error)]
    return "\n".join(dict.fromkeys(lines))


def _sentence(error: InputError, command: str, options: Mapping[str, str]) -> str:
    from chromanoise.study import interface_of  # only where there is an error

    subject = error.subject
    if command in _OF_A_FILE and "." in error.setting:
        own = error.setting if subject == error.setting_name else subject
        return error.sentence(subject=own, render=setting_of_study)
    if error.setting:
        name = _flat(error.setting, command)
        if name is not None and subject in (name, error.setting_name, "matrix"):
            part = interface_of(name).part
            option = _option(name, command, error.value)
            subject = f"{part} of {option}" if part in ("FIRST", "LAST", "POINTS") else option
    else:
        subject = options.get(subject, subject)
    return error.sentence(subject=subject, render=lambda setting: _remedy(setting, command))


def _remedy(setting: Setting, command: str) -> str:
    if list(map(str, setting.values)) == ["False"]:  # of an option that has no value
        return f"omit {options_text(Setting(setting.name), command)}"
    return f"{'omit' if setting.omit else 'give'} {options_text(setting, command)}"


def options_text(setting: Setting, command: str = "") -> str:
    """A setting as options of the command line: ``--energy or --photons``, ``--beyond zero``.

    Parameters
    ----------
    setting
        A setting named by a key of a study or by a parameter of a reader.
    command
        Name of the command.
    """
    from chromanoise.study import flags_of

    name = _flat(setting.name, command) or setting.name
    flags = flags_of(name)
    values = [str(value) for value in setting.values]
    if flags:
        return " or ".join(flags[value] for value in values or flags)
    if values == ["True"]:
        return _option(name, command)
    return f"{_option(name, command)} {' or '.join(values)}".strip()


def _option(name: str, command: str, value: object = None) -> str:
    """The option of a setting, or the argument."""
    from chromanoise.study import option_of

    if name == "cube" or (name == "sensors" and command not in ("simulate", "denoise")):
        return {"cube": "CUBE", "sensors": "SENSOR"}[name]
    return option_of(name, value)


def _flat(key: str, command: str) -> str | None:
    """The setting for a key of a study in this command; a key without dots is a setting."""
    from chromanoise.study import FUNCTIONS, argument_of

    if key.startswith("matrices"):
        return "matrix"
    if key.startswith("sensors.") and key.endswith(".name"):
        return "sensors"
    if key == "pictures.0.cube":
        return "cube"
    own = {"simulate": "render", "denoise": "denoise"}.get(command)
    names = FUNCTIONS[own] if own else _of_all(("analyze", "compare", "compare_map", "matrix"))
    alone = "qe_scale" if key == "scale" else key  # for commands that read one file
    return argument_of(key, names) or (None if "." in key else alone)


def _of_all(functions: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    from chromanoise.study import FUNCTIONS

    return {name: keys for one in functions for name, keys in FUNCTIONS[one].items()}
