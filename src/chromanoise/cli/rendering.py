"""Render errors for the command line, with options in place of settings."""

from collections.abc import Mapping

from chromanoise.errors import InputError, Setting, StudyError, errors_in, setting_of_study

_NONE: Mapping[str, str] = {}
_PARTS = {
    "first": "FIRST",
    "last": "LAST",
    "second_first": "FIRST",
    "second_last": "LAST",
    "second_points": "POINTS",
    "pareto_first": "FIRST",
    "pareto_last": "LAST",
    "pareto_points": "POINTS",
}  # names in the help of options that take several settings
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
    subject = error.subject
    if command in _OF_A_FILE and "." in error.setting:
        own = error.setting if subject == error.setting_name else subject
        return error.sentence(subject=own, render=setting_of_study)
    if error.setting:
        name = _flat(error.setting, command)
        if name is not None and subject in (name, error.setting_name, "matrix"):
            part = f"{_PARTS[name]} of " if name in _PARTS else ""
            subject = part + _option(name, command, error.value)
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
    from chromanoise.study import FLAGS

    name = _flat(setting.name, command) or setting.name
    flags = FLAGS.get(name)
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
    from chromanoise.study import (
        ANALYSIS,
        COMPARISON,
        FUNCTIONS,
        MAPS,
        MATRIX,
        RENDERING,
        argument_of,
    )

    if key.startswith("matrices"):
        return "matrix"
    if key.startswith("sensors.") and key.endswith(".name"):
        return "sensors"
    if key == "pictures.0.cube":
        return "cube"
    own = {"simulate": RENDERING, "denoise": FUNCTIONS["denoise"]}
    names = own.get(command) or {**ANALYSIS, **COMPARISON, **MAPS, **MATRIX}
    alone = "qe_scale" if key == "scale" else key  # for commands that read one file
    return argument_of(key, names) or (None if "." in key else alone)
