"""Resolve the names in a study to objects: lights, sensors, exposures, cubes."""

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import field, replace
from typing import Any

from chromanoise.base import (
    Array,
    Float,
    InputError,
    Setting,
    check,
    dataclass,
    no_place_for,
    refusal,
    regular_file,
)
from chromanoise.io import read_crosstalk
from chromanoise.io.spectra import Answers, Found
from chromanoise.noise import EQUAL_TERMS, Exposure, OperatingPoint
from chromanoise.sensor import (
    PIXEL,
    Sensor,
    behind_ir_cut,
    crosstalk_of_share,
    mosaic_named,
    refuse_blind_channels,
    refuse_other_channels,
    with_binning,
    with_channel_names,
    with_crosstalk,
    with_shifted_curves,
)
from chromanoise.spectra import (
    Cube,
    Illuminant,
    OwnObserver,
    PatchPairs,
    Scene,
    Spectra,
    builtin_cube,
    flat_field,
    infrared_parts,
)
from chromanoise.study.color_matrices import (
    DEFAULT_PRIOR,
    PRIORS,
    MatrixMaker,
    matrix_makers,
    trained_names,
)
from chromanoise.study.pixel_files import idle_answers, sensor_with_pixel
from chromanoise.study.resolve_names import (
    Curves,
    WordKind,
    behind_resolved_filter,
    catalog_word,
    file_of,
    is_file_word,
    is_object_word,
    is_reflectance_file,
    resolve_illuminant,
    resolve_observer,
    resolve_pairs,
    resolve_patch,
    resolve_reflectances,
    resolve_sensor,
    shown_word,
)
from chromanoise.study.schema import (
    PicturePart,
    PixelPart,
    ReflectancesPart,
    SecondSweepPart,
    SensorPart,
    Study,
    SweepPart,
)
from chromanoise.study.sweeps import SWEEPS, swept_values

_OF_ANSWERS = ("scale", "level", "per", "wavelength_unit", "peak_qe")


@dataclass(frozen=True, kw_only=True)
class Given:
    """Objects of Python that a study names, in place of the catalog and files.

    Attributes
    ----------
    objects
        Sensors, illuminants, curves (``Found``), reflectances on the grid, pairs of patches,
        observers, cubes, matrices and functions that give one, by the word in the study: that of
        the object (``object_word``), or a name in whose place it is.
    """

    objects: Mapping[str, Any] = field(default_factory=dict)

    def of(self, word: Any) -> Any:
        """What a word refers to: an object, or the word itself.

        Parameters
        ----------
        word
            Word of a study.

        Raises
        ------
        InputError
            If the word refers to an object that is not given.
        """
        if word not in self.objects and is_object_word(word):
            raise InputError(
                shown_word(word), "must be given as an object of Python", value=word, found=None
            )
        return self.objects.get(word, word)

    def reads_reflectances(self, word: object) -> bool:
        """Whether a word for reflectances refers to a file or to curves.

        Parameters
        ----------
        word
            Word of a study.
        """
        one = self.of(word)
        return isinstance(one, Found) or (isinstance(one, str) and is_reflectance_file(one))

    def reads(self, word: str, kind: WordKind) -> bool:
        """Whether a word refers to a file or to curves, rather than to a name or an object.

        Parameters
        ----------
        word
            Word of a study.
        kind
            What it refers to.
        """
        one = self.of(word)
        return isinstance(one, Curves) and is_file_word(one, kind)


NOTHING_GIVEN: Given = Given()
"""No objects in place of names."""


def operating_points_of(study: Study, given: Given = NOTHING_GIVEN) -> list[OperatingPoint]:
    """Each sensor of the study in its light, with its exposure.

    Parameters
    ----------
    given
        Objects of Python that the study names.

    Raises
    ------
    InputError
        If a name names nothing, a file cannot be read, a setting has no effect, or no light reaches
        a sensor.
    """
    refuse_idle(study, given)
    illuminant = illuminant_of(study, given)
    sensors = [
        sensor_of(part, key=f"sensors.{i}", given=given, varied=_varied(study))
        for i, part in enumerate(study.sensors)
    ]
    return _with_files_told_apart(study, operating_points_in(study, illuminant, sensors, given))


def _with_files_told_apart(study: Study, points: list[OperatingPoint]) -> list[OperatingPoint]:
    """Sensors of one name get a number; a note on each names its file."""
    count = Counter(one.sensor.name for one in points)

    def with_its_file(point: OperatingPoint, word: str) -> OperatingPoint:
        sensor = point.sensor
        if count[sensor.name] == 1 or not is_file_word(word, "sensor"):
            return point
        notes = (*sensor.notes, f"the file of this sensor is {shown_word(word)}")
        return replace(point, sensor=replace(sensor, notes=notes))

    words = [part.name for part in study.sensors]
    return with_distinct_names(list(map(with_its_file, points, words)))


def refuse_idle(study: Study, given: Given = NOTHING_GIVEN) -> None:
    """Refuse repeated sensors, repeated labels and settings that change nothing, all at once.

    Parameters
    ----------
    given
        Objects of Python that the study names.

    Raises
    ------
    InputError
        If there is one.
    """
    errors = [*duplicates(study), *repeated_labels(study), *idle_settings(study, given)]
    if errors:
        raise refusal(errors)


def with_distinct_names(points: Sequence[OperatingPoint]) -> list[OperatingPoint]:
    """Sensors of one name get a number: a sensor is often compared with a changed copy.

    ``cam``, ``cam`` become ``cam`` and ``cam (2)``; a number that is a name already is skipped.
    """
    names = distinct_names([one.sensor.name for one in points])
    return [
        one if name == one.sensor.name else replace(one, sensor=replace(one.sensor, name=name))
        for one, name in zip(points, names, strict=True)
    ]


def distinct_names(names: Sequence[str]) -> list[str]:
    """The names, with a number where one is repeated, as `with_distinct_names`."""
    counts, later = dict[str, int](), Counter(names)
    taken: dict[str, None] = {}  # in order
    for own in names:
        name = own
        later[own] -= 1
        count = counts.get(own, 1)
        while name in taken or (name != own and later[name]):
            count += 1
            name = f"{own} ({count})"
        counts[own] = count
        taken[name] = None
    return list(taken)


def _one_word(word: str) -> str:
    """The same text for all words of one sensor: ``./a.csv`` is a.csv, ``onyx_rgbw`` onyx-rgbw."""
    return str(file_of(word)) if is_file_word(word, "sensor") else catalog_word(word, "sensor")


def duplicates(study: Study) -> list[InputError]:
    """An error for each sensor that is repeated with nothing changed.

    A page shows them, for one of them is about to be changed; a run would compute all of it twice.
    """
    words = [_one_word(part.name) for part in study.sensors]
    times = Counter(words)
    texts = [
        part.model_copy(update={"name": word}).model_dump_json(exclude={"label"})
        if times[word] > 1  # else no other sensor can be the same
        else word
        for part, word in zip(study.sensors, words, strict=True)
    ]
    count, seen, found = Counter(texts), Counter[str](), list[InputError]()
    for i, (text, word) in enumerate(zip(texts, words, strict=True)):
        seen[text] += 1
        if seen[text] != 2:
            continue
        shown, more = shown_word(word), count[text] - 1
        found.append(
            InputError(
                "name",
                "must not be repeated with the same settings",
                value=shown,
                found=f"{shown!r} is {'repeated' if more == 1 else f'given {more + 1} times'}",
                remedy=(
                    f"change one in a study file, e.g. sensors.{i}.filter",
                    "omit one" if more == 1 else f"omit {more}",
                ),
                setting=f"sensors.{i}.name",
            )
        )
    return found


def repeated_labels(study: Study) -> list[InputError]:
    """Labels that another sensor has as label or name, so that tables could not tell them apart."""
    names = [shown_word(one.name) for one in study.sensors]
    labels = [one.label for one in study.sensors]
    first = {label: i for i, label in reversed(list(enumerate(labels)))}
    counts = Counter(names)
    return [
        InputError(
            "label",
            "must differ from the labels and names of the other sensors",
            value=label,
            found=f"{label!r} is repeated",
            setting=f"sensors.{i}.label",
        )
        for i, (name, label) in enumerate(zip(names, labels, strict=True))
        if label is not None and (first[label] < i or counts[label] > (name == label))
    ]


def idle_settings(study: Study, given: Given = NOTHING_GIVEN) -> list[InputError]:
    """Settings that change nothing: answers about a file where something else is given.

    An answer that several sensors share has an effect if one of them needs it.
    """
    errors = []
    for name in _OF_ANSWERS:
        values = {getattr(part.answers, name) for part in study.sensors} - {None}
        for value in sorted(values, key=str):
            parts = [part for part in study.sensors if getattr(part.answers, name) == value]
            if all(
                isinstance(given.of(part.name), Sensor)
                or name in idle_answers([given.of(part.name)], _answers(part))
                for part in parts
            ):
                errors.append(_idle_of_sensors(study, parts, f"answers.{name}", value))
    errors += [*_idle_alone(study), *_idle_treatments(study, given)]
    light = study.light
    infrared = infrared_parts(light.illuminant)
    base = light.illuminant if infrared is None else infrared[0]
    if not given.reads(light.illuminant if is_object_word(base) else base, "light"):
        of_file = {name: getattr(light, name) for name in ("per", "column", "wavelength_unit")}
        errors += _all_idle("light", of_file, shown_word(light.illuminant))
    own = study.reflectances
    words = [
        word for word in (own.chart, own.patch, own.pairs, study.prior) if isinstance(word, str)
    ]
    if not any(map(given.reads_reflectances, words)):
        of_file = {name: getattr(own, name) for name in ("scale", "wavelength_unit", "beyond")}
        errors += _all_idle("reflectances", of_file, "a study without such a file")
    for i, part in enumerate(study.sensors):
        unit = part.filter_wavelength_unit
        filters = [*filter(None, [part.filter]), *(part.channel_filters or {}).values()]
        if unit and not any(given.reads(word, "filter") for word in filters):
            errors.append(
                _idle(f"sensors.{i}.filter_wavelength_unit", unit, part.filter or "no filter")
            )
            break
    return errors


def _idle_treatments(study: Study, given: Given) -> list[InputError]:
    """Extrapolation and treatment of negative values where no curve of the study needs them."""
    own, light = study.reflectances, study.light
    files = [word for word in (own.chart, own.patch, study.prior) if isinstance(word, str)]
    if study.pictures or any(map(given.reads_reflectances, files)):
        return []
    errors = []
    for name in ("beyond", "negatives"):
        parts = [one for one in study.sensors if getattr(one, name) != "refuse"]
        needed = any(_is_incomplete(one, given) for one in parts)
        if name == "negatives" and given.reads(light.illuminant, "light"):
            needed = True
        if parts and not needed:
            errors.append(_idle_of_sensors(study, parts, name, getattr(parts[0], name)))
    return errors


def _is_incomplete(part: SensorPart, given: Given) -> bool:
    """Whether curves of a sensor come from a file or a filter, or do not cover the grid."""
    if part.filter is not None or part.channel_filters:
        return True
    if isinstance(given.of(part.name), Sensor):
        return False
    if given.reads(part.name, "sensor"):
        return True
    try:
        resolve_sensor(part.name, answers=replace(_answers(part), beyond="refuse"))
    except InputError:
        return True
    return False


def _idle_alone(study: Study) -> list[InputError]:
    """Settings of sensors that lack the other setting without which they have no effect."""
    needs = {
        "crosstalk_stage": ("crosstalk", "crosstalk"),
        "shift_ircut_nm": ("filter", "a filter on all channels"),
    }
    return [
        InputError(
            name,
            f"must be given only with {what}",
            value=getattr(part, name),
            found="there is none",
            remedy=(Setting(f"sensors.{i}.{other}"), "omit it"),
            setting=f"sensors.{i}.{name}",
        )
        for i, part in enumerate(study.sensors)
        for name, (other, what) in needs.items()
        if getattr(part, other) is None
        and getattr(part, name) != SensorPart.model_fields[name].default
    ]


def _idle_of_sensors(
    study: Study, parts: Sequence[SensorPart], name: str, value: Any
) -> InputError:
    words = ", ".join(shown_word(part.name) for part in parts)
    return _idle(f"sensors.{study.sensors.index(parts[0])}.{name}", value, words)


def _all_idle(key: str, values: Mapping[str, Any], of: str) -> list[InputError]:
    given = {name: value for name, value in values.items() if value is not None}
    return [_idle(f"{key}.{name}", value, of) for name, value in given.items()]


def _idle(key: str, value: Any, of: str) -> InputError:
    demand = f"must not be given for {of}, where it changes nothing"
    return no_place_for(key.rpartition(".")[2], demand, value, setting=key)


def operating_points_in(
    study: Study,
    illuminant: Illuminant,
    sensors: Sequence[Sensor],
    given: Given = NOTHING_GIVEN,
) -> list[OperatingPoint]:
    """Sensors in a light, on the terms of the study.

    Parameters
    ----------
    study
        Of which the exposure, the light level and the observer are used.
    given
        Objects in place of names.

    Raises
    ------
    InputError
        If no light reaches a sensor.
    """
    light = study.light
    white = flat_field(illuminant, level_lux=light.level_lux)
    reflectances = {name: reflectances_of(study, given, name=name) for name in _REFLECTANCES}
    observer = observer_of(study, given)
    return [
        OperatingPoint(
            sensor=sensor,
            exposure=exposure,
            illuminant=illuminant,
            level_lux=light.level_lux,
            observer=observer,
            **reflectances,
        )
        for sensor, exposure in zip(sensors, _exposures(study, white, sensors), strict=True)
    ]


def illuminant_of(study: Study, given: Given = NOTHING_GIVEN) -> Illuminant:
    """The light of the study.

    Raises
    ------
    InputError
        If its name names nothing, or a file cannot be read.
    """
    with keyed("light.illuminant", lambda name: f"light.{'column' if name == 'columns' else name}"):
        own = given.of(study.light.illuminant)
        return _lamp(own, light_answers_of(study))


def _lamp(own: Illuminant | Curves, answers: Answers) -> Illuminant:
    return own if isinstance(own, Illuminant) else resolve_illuminant(own, answers=answers)


def observer_of(study: Study, given: Given = NOTHING_GIVEN) -> str:
    """The observer of the study: a name, or an `OwnObserver`.

    Raises
    ------
    InputError
        If its name names nothing, or a file cannot be read.
    """
    with keyed("observer", str):
        observer = given.of(study.observer)
        return observer if isinstance(observer, OwnObserver) else resolve_observer(observer)


def balance_light_of(study: Study, given: Given = NOTHING_GIVEN) -> Illuminant | None:
    """The illuminant that the white balance of the pipeline names; ``None`` if it names none.

    Raises
    ------
    InputError
        If its name names nothing, or a file cannot be read.
    """
    part = study.outputs.pipeline
    word = part.white_balance
    if not part.run or not isinstance(word, str) or word == "gray":
        return None
    if word == "illuminant" or word == study.light.illuminant:
        return illuminant_of(study, given)
    with keyed("outputs.pipeline.white_balance", lambda name: f"light.{name}"):
        light = study.light
        answers = Answers(quantity="power", beyond=light.beyond, negatives=light.negatives)
        return _lamp(given.of(word), answers)


def light_answers_of(study: Study) -> Answers:
    """What the study says of the file of its light, where the file does not declare it."""
    light = study.light
    return Answers(
        quantity="power",
        per=light.per,
        beyond=light.beyond,
        columns=() if light.column is None else (light.column,),
        wavelength_unit=light.wavelength_unit,
        negatives=light.negatives,
    )


_REFLECTANCES: dict[str, tuple[type, Callable[..., Any]]] = {
    "chart": (Spectra, resolve_reflectances),
    "patch": (Spectra, resolve_patch),
    "pairs": (PatchPairs, resolve_pairs),
}


def reflectances_of(study: Study, given: Given = NOTHING_GIVEN, *, name: str) -> Any:
    """The chart, the patch or the pairs of patches of a study; ``None`` if it names none.

    Raises
    ------
    InputError
        If the file cannot be read, its curves do not cover the grid and nothing extends them, there
        is no such patch, or a line of a list does not name two patches.
    """
    word = getattr(study.reflectances, name)
    if word is None:
        return None
    kind, resolve = _REFLECTANCES[name]
    with keyed(f"reflectances.{name}", _reflectance_key):
        own = given.of(word)
        return own if isinstance(own, kind) else resolve(own, answers=_reflectance_answers(study))


def prior_of(study: Study, given: Given = NOTHING_GIVEN) -> str | Spectra:
    """The training set of the study: the name of a prior, or the reflectances of a file.

    Raises
    ------
    InputError
        As `reflectances_of`.
    """
    if study.prior in PRIORS or not trained_names(study.matrices):
        return study.prior if study.prior in PRIORS else DEFAULT_PRIOR
    with keyed("prior", _reflectance_key):
        return resolve_reflectances(given.of(study.prior), answers=_reflectance_answers(study))


def _reflectance_answers(study: Study) -> Answers:
    own, first = study.reflectances, study.sensors[0]
    return Answers(
        beyond=own.beyond or first.beyond,
        negatives=first.negatives,
        scale=own.scale,
        wavelength_unit=own.wavelength_unit,
    )


def _reflectance_key(name: str) -> str:
    if name in ("beyond", "negatives"):
        return f"sensors.0.{name}"
    return f"reflectances.{name}" if name in ReflectancesPart.model_fields else name


def _varied(study: Study) -> set[str]:
    """The fields of a pixel that the sweeps of a study vary, or its pictures replace."""
    names = {one.vary for part in study.sweeps for one in (part, part.second) if one is not None}
    replaced = {name for part in study.pictures for name in part.model_fields_set}
    return ({name.replace("-", "_") for name in names} | replaced) & {*PIXEL}


def sensor_of(
    part: SensorPart,
    *,
    key: str = "sensors.0",
    given: Given = NOTHING_GIVEN,
    varied: Collection[str] = (),
) -> Sensor:
    """A sensor of the study: shifted first, then behind its filter and the added IR-cut.

    Parameters
    ----------
    key
        Its key, for errors.
    given
        Objects in place of names.
    varied
        As for `chromanoise.sensor.with_pixel`.

    Raises
    ------
    InputError
        If its name names nothing, a file cannot be read, or a channel measures nothing.
    """
    own = {name: f"{key}.{place}" for name, place in _ANSWER_KEYS.items()}
    own |= {} if part.pixel.file is None else {part.pixel.file: f"{key}.pixel.file"}
    pixel = _pixel_changes(part.pixel)
    with keyed(f"{key}.name", lambda name: own.get(name, f"{key}.{name}"), own, _NO_KEYS):
        sensor = sensor_with_pixel(
            given.of(part.name), answers=_answers(part), varied=varied, **pixel
        )
    if part.pixel.binning is not None:
        with keyed(f"{key}.pixel.binning"):
            sensor = with_binning(sensor, part.pixel.binning, part.pixel.binning_mode or "charge")
    sensor = with_shifted_curves(sensor, part.shift_nm)
    answers = Answers(
        beyond=part.beyond, negatives=part.negatives, wavelength_unit=part.filter_wavelength_unit
    )
    if part.filter is not None:
        with keyed(f"{key}.filter", lambda name: f"{key}.{_FILTER_KEYS.get(name, name)}"):
            sensor = behind_resolved_filter(
                sensor, given.of(part.filter), answers=answers, shift_nm=part.shift_ircut_nm
            )
    for channel, word in (part.channel_filters or {}).items():
        with keyed(f"{key}.channel_filters", lambda name: f"{key}.{_FILTER_KEYS.get(name, name)}"):
            try:
                check.among("channel", channel, sensor.names)
            except InputError as error:
                raise error.within("channel_filters") from None
            sensor = behind_resolved_filter(
                sensor, given.of(word), answers=answers, channel=channel
            )
    if part.ircut_nm is not None:
        sensor = behind_ir_cut(sensor, part.ircut_nm)
    with keyed(f"{key}.name"):
        refuse_blind_channels(sensor)
    sensor = _with_crosstalk(sensor, part, key)
    return replace(sensor, shown_as=part.label) if part.label else sensor


def _pixel_changes(part: PixelPart) -> dict[str, Any]:
    """The changes as `sensor_with_pixel` takes them; a gain K in DN/e- becomes e-/DN."""
    if not part.model_fields_set:  # most sensors
        return {}
    changes = part.model_dump(exclude={"gain_dn_per_e", "binning", "binning_mode"})
    if part.gain_dn_per_e is not None:
        changes["gain_e_per_dn"] = 1 / part.gain_dn_per_e
    return changes


def _with_crosstalk(sensor: Sensor, part: SensorPart, key: str) -> Sensor:
    if part.mosaic is not None:
        with keyed(f"{key}.mosaic", lambda name: f"{key}.{name}"):
            mosaic = with_channel_names(mosaic_named(part.mosaic), sensor.names)
            refuse_other_channels(mosaic, sensor.names)
            sensor = replace(sensor, mosaic=mosaic)
    if part.crosstalk is None:
        return sensor
    with keyed(f"{key}.crosstalk", lambda name: f"{key}.{name}", {"mosaic": f"{key}.mosaic"}):
        given = part.crosstalk
        if isinstance(given, str):
            mixing = read_crosstalk(file_of(given), sensor.names, sensor.mosaic)
        elif sensor.mosaic is None:
            raise InputError(
                "crosstalk",
                "must be given with the mosaic that determines the neighbors",
                value=given,
                found=f"{sensor.name} has no mosaic of its own",
                remedy=Setting("mosaic"),
            )
        else:
            mixing = crosstalk_of_share(given, sensor.mosaic, sensor.names)
        return with_crosstalk(sensor, replace(mixing, stage=part.crosstalk_stage))


_PIXEL_KEYS = {name: f"pixel.{name}" for name in PixelPart.model_fields if name != "file"}
_ANSWER_KEYS = (
    {name: f"answers.{name}" for name in _OF_ANSWERS}
    | _PIXEL_KEYS
    | {"gain_e_per_dn": "pixel.gain_dn_per_e"}
)
_STUDY_NAMES = {"gain_e_per_dn": "gain_dn_per_e"}
_FILTER_KEYS = {"wavelength_unit": "filter_wavelength_unit"}


def _answers(part: SensorPart) -> Answers:
    return Answers(beyond=part.beyond, negatives=part.negatives, **part.answers.model_dump())


@contextmanager
def keyed(
    key: str,
    names: Callable[[str], str] = str,
    own: Mapping[str, str] | None = None,
    instead: Mapping[str, str] | None = None,
) -> Iterator[None]:
    """An error inside names the key of the study, and its settings by their keys.

    Parameters
    ----------
    key
        Of the value that is used inside.
    names
        From a parameter of the library to its key.
    own
        Keys of other values that are used inside, by the subject of their errors.
    instead
        As `InputError.inside`.

    Raises
    ------
    InputError
        The error from inside, with the key.
    """
    try:
        yield
    except InputError as error:
        if error.setting:  # of something narrower
            raise
        place = (own or {}).get(error.subject, key)
        named = error.called(_STUDY_NAMES.get(error.subject, error.subject))
        raise named.inside(place, names, instead) from error.__cause__


_NO_KEYS = {"columns": "choose columns with `chromanoise convert --column`"}


def unresolved(study: Study) -> list[InputError]:
    """What a study names and cannot be made, each with its key."""
    found: list[InputError] = []

    def tried(make: Callable[..., Any], *given: Any, **more: Any) -> Any:
        try:
            return make(*given, **more)
        except InputError as error:
            found.append(error)
            return None

    for one in (illuminant_of, balance_light_of, observer_of):
        tried(one, study)
    for name in _REFLECTANCES:
        tried(reflectances_of, study, name=name)
    tried(prior_of, study)
    sensors = [
        tried(sensor_of, part, key=f"sensors.{i}", varied=_varied(study))
        for i, part in enumerate(study.sensors)
    ]
    found += [*duplicates(study), *repeated_labels(study), *idle_settings(study)]
    for i, sweep in enumerate(study.sweeps):
        tried(values_of_sweep, sweep, f"sweeps.{i}")
        if sweep.second is not None:
            tried(values_of_sweep, sweep.second, f"sweeps.{i}.second")
    for i, picture in enumerate(study.pictures):
        tried(_cube_is_there, i, picture.cube)
        if picture.mosaic not in (None, "sensor"):
            tried(_mosaic_fits, i, picture, sensors)
    return found


def values_of_sweep(part: SweepPart | SecondSweepPart, key: str) -> Float[Array, " k"]:
    """The values of one parameter of a sweep.

    Parameters
    ----------
    key
        Of the sweep, for errors.

    Raises
    ------
    InputError
        If they do not rise, or are out of range.
    """
    with keyed(f"{key}.vary"):
        try:
            return swept_values(SWEEPS[part.vary], part.first, part.last, part.points)
        except InputError as error:
            raise error.within("vary") from None


def _cube_is_there(number: int, word: str) -> None:
    if not word.startswith("builtin:") and not is_object_word(word):
        with keyed(f"pictures.{number}.cube", str):
            regular_file(file_of(word), folder=True)


def makers_of(study: Study, given: Given = NOTHING_GIVEN) -> Mapping[str, MatrixMaker]:
    """The color matrices of a study, by name.

    Parameters
    ----------
    given
        Objects in place of names.

    Raises
    ------
    InputError
        If one is repeated.
    """
    with keyed("matrices", str):
        own = {name: given.of(name) for name in study.matrices if is_object_word(name)}
        prior = prior_of(study, given)
        return matrix_makers(study.matrices, study.metric, prior=prior, own=own)  # type: ignore[arg-type]


def _mosaic_fits(number: int, part: PicturePart, sensors: Sequence[Sensor | None]) -> None:
    with keyed(f"pictures.{number}.mosaic", str):
        mosaic = mosaic_named(str(part.mosaic))
    for sensor in filter(None, sensors):
        own = set(with_channel_names(mosaic, sensor.names).names)
        idle = [name for name in sensor.names if name not in own]
        strange = sorted(own - set(sensor.names))
        if strange or (idle and not part.raw_only):
            what = f"{sensor.name} lacks its channel {', '.join(strange)}"
            if not strange:
                what = f"it has no pixel for channel {', '.join(idle)} of {sensor.name}"
            raise InputError(
                "mosaic",
                "must have the channels of each sensor",
                value=part.mosaic,
                found=f"{what}; it has {', '.join(sorted(own))}",
                setting=f"pictures.{number}.mosaic",
            )


_OF_FILE = ("key", "shape", "wavelengths", "scale")


def cube_of(part: PicturePart, *, key: str = "pictures.0", given: Given = NOTHING_GIVEN) -> Cube:
    """The cube of which a part of a study takes pictures.

    Parameters
    ----------
    key
        Its key, for errors.
    given
        Objects in place of names.

    Raises
    ------
    InputError
        If a built-in name names nothing or is given what only a file needs, or a file cannot be
        read.
    """
    how = {name: getattr(part, name) for name in _OF_FILE}
    if part.cube.startswith("builtin:") or is_object_word(part.cube):
        for error in _all_idle(key, how, shown_word(part.cube)):
            raise error
        if is_object_word(part.cube):
            own: Cube = given.of(part.cube)
            return own
        with keyed(f"{key}.cube", str):
            return builtin_cube(part.cube)
    from chromanoise.io.cubes import read_cube  # not needed without pictures

    if isinstance(part.wavelengths, str):
        how["wavelengths"] = file_of(part.wavelengths)
    with keyed(f"{key}.cube", lambda name: f"{key}.{name}"):
        return read_cube(file_of(part.cube), **how)


def _exposures(study: Study, white: Scene, sensors: Sequence[Sensor]) -> list[Exposure]:
    part = study.exposure
    lens: dict[str, Any] = {"f_number": part.f_number, "magnification": part.magnification}
    if part.time_ms is not None:
        return [Exposure(time_s=1e-3 * part.time_ms, **lens)] * len(sensors)
    return EQUAL_TERMS[part.equal](white, sensors, share=part.saturate, **lens)
