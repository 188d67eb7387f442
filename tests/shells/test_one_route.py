"""Command line, study file, copied script, page and Python give the same numbers and refusals."""

import io
import json
import os
import tempfile
import warnings
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import chromanoise as cn
from chart_values import stages_of
from chromanoise.base.errors import InputError, errors_in
from chromanoise.cli.entry import commands
from chromanoise.study import FUNCTIONS, flags_of, option_of
from chromanoise.web.answers import ChartReplies
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.page_studies import Studies
from chromanoise.web.uploads import Uploads

SENSORS = ["onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "model-mono", "model-rgbir", "cam.csv"]


def columns(head, last, *values):
    rows = [
        f"{w}," + ",".join(f"{value(w):g}" for value in values) for w in range(400, last + 1, 10)
    ]
    return "\n".join([head, *rows]) + "\n"


FILES = {
    # in percent, and short of 1050 nm: both must be declared
    "cam.csv": columns(
        "wavelength_nm,R,G,B",
        1000,
        lambda w: 5 + 40 * (w > 590),
        lambda w: 4 + 45 * (500 < w < 590),
        lambda w: 3 + 35 * (w < 500),
    ),
    "lamp.csv": columns("wavelength_nm,power", 1050, lambda w: w / 500),
    "filter.csv": columns("wavelength_nm,transmittance", 1050, lambda w: 0.9 if w < 680 else 0.01),
    "pixel.txt": "K = 0.5 DN/e-\nsigma_d [e-] = 2.4\nmu_e.sat: 9000 e-\npixel pitch = 3 um\n"
    "dark current = 40 e-/s\nDSNU = 3 e-\nPRNU = 1 %\nbits = 12\n",
    "mix.csv": "to,R,G,B\nR,0.9,0.05,0\nG,0.05,0.9,0.05\nB,0,0.05,0.9\n",
    "cards.csv": columns(
        "wavelength_nm,red,green",
        1050,
        lambda w: 10 + 60 * (w > 600),
        lambda w: 10 + 50 * (500 < w < 600),
    ),
    "kernel.csv": "0,0.02,0\n0.02,0.9,0.03\n0,0.03,0\n",
}


@dataclass(frozen=True)
class Asked:
    """A call: sensors, color matrices (comma-separated) and settings of Python by name."""

    sensors: tuple[str, ...]
    matrix: str
    settings: dict[str, Any]
    function: str = "analyze"


@dataclass(frozen=True)
class Refusal:
    """Key of the study (or subject, outside of one) and value of each error, and its sentence."""

    errors: tuple[InputError, ...]

    @property
    def fields(self):
        return [(_last(e.setting) or e.subject, e.setting, e.value) for e in self.errors]


def _last(key):
    return key.rpartition(".")[2]


# ---- what is drawn ----


def maybe(*values):
    return st.sampled_from([None, None, *values])


VALID = {
    "lux": maybe(0.05, 3.0, 400.0),
    "f_number": maybe(1.4, 8.0),
    "magnification": maybe(0.0, 0.1),
    "metric": maybe("quanta", "energy"),
    "observer": maybe("cie-1964-10", "cie-2015-2"),
    "pitch_um": maybe(2.4),
    "full_well_e": maybe(4000.0),
    "read_noise_e": maybe(0.0, 2.5),
    "dsnu_e": maybe(0.0, 4.0),
    "prnu": maybe(0.0, 0.02),
    "row_noise_e": maybe(2.0),
    "black_error_e": maybe(-3.0, 8.0),
    "bits": maybe(10, 14),
    "gain_dn_per_e": maybe(0.25),
    "pixel": maybe("pixel.txt"),
    "filter": maybe("ircut-650", "ircut-650/20", "filter.csv"),
    "ircut_nm": maybe(680.0),
    "shift_nm": maybe(-5.0, 10.0),
    "chart": maybe(True),
    "space": maybe("lab", "luv", "linear-srgb"),
}
TIMES = [
    *({}, {}, {"time_ms": 4.0}, {"time_ms": 12.0}, {"equal": "exposure"}),
    *({"equal": "saturation"}, {"equal": "light", "saturate": 0.5}, {"saturate": 0.7}),
]
LIGHTS = [
    *({}, {"illuminant": "A"}, {"illuminant": "D65", "illuminant_beyond": "zero"}),
    {"illuminant": "D65", "illuminant_beyond": "hold"},
    *({"illuminant": "A+0.5xLED850"}, {"illuminant": "3200K"}),
    {"illuminant": "lamp.csv", "illuminant_per": "photon"},
    {"illuminant": "lamp.csv", "illuminant_per": "energy"},
]
DARK = [
    *({}, {}, {"dark_current_e_per_s": 30.0}),
    {"dark_current_e_per_s": 30.0, "temperature_c": 50.0},
    {"dark_current_e_per_s": 9.0, "dark_reference_c": 60.0, "dark_doubling_k": 6.0},
]
MIXED = [
    *({}, {}, {}, {"crosstalk": 0.1}, {"crosstalk": 0.05, "crosstalk_stage": "charge"}),
    {"crosstalk": "kernel.csv"},
]
MIXED_RGB = [{}, {"crosstalk": 0.1, "mosaic": "bayer"}, {"crosstalk": "mix.csv"}]
RGB = {"onyx-rgb-ircut", "onyx-rgb", "cam.csv"}
MATRICES = [
    *({"matrix": "kernel"}, {"matrix": "kernel"}, {"matrix": "least-squares"}),
    *({"matrix": "lmmse"}, {"matrix": "lmmse", "prior": "chart"}, {"matrix": "ridge=0.01"}),
]
MOMENTS = [{}, {}, {"budget": True}, {"clip": True}, {"budget": False}]
TROUBLE = [  # idle, contradictory, impossible or unknown
    *({"lux": -1.0}, {"lux": 1e30}, {"time_ms": 0.0}, {"f_number": 1e-5}, {"saturate": 1.5}),
    {"time_ms": 3.0, "saturate": 0.5},
    {"time_ms": 3.0, "saturate": None, "equal": "light"},
    *({"equal": "light", "time_ms": None, "saturate": 1e-12}, {"time_ms": 1e-20}),
    *({"illuminant": "D65", "illuminant_beyond": None}, {"illuminant": "D66"}),
    {"illuminant": "E", "illuminant_per": "photon"},
    *({"filter": "ircut-x"}, {"filter": "ircut-650", "filter_wavelength_unit": "nm"}),
    *({"filter": None, "filter_wavelength_unit": "nm"}, {"pixel": "missing.txt"}),
    *({"filter": None, "shift_ircut_nm": 5.0}, {"filter": "ircut-650", "shift_ircut_nm": 201.0}),
    *({"pitch_um": 0.0}, {"read_noise_e": -1.0}, {"peak_qe": 2.0}),
    *({"ircut_nm": 449.0}, {"shift_nm": 201.0}, {"observer": "cie-1964"}),
    {"peak_qe": 0.5, "level": "absolute"},
    *({"per": "photon"}, {"qe_scale": None}, {"beyond": None}),
    *({"clip": True, "budget": True}, {"matrix": "kernel", "prior": "chart"}),
    *({"matrix": "ridge"}, {"matrix": "lmse"}, {"lux": -1.0, "f_number": 0.0}),
    *({"sensors": ("onyx-rgbw", "onyx-rgbw")}, {"sensors": ("onyx-rgbx",)}),
    *({"sensors": ("missing.csv", "onyx-rgbw")}, {"full_well_e": 1e-30}),
    *({"prnu": 2.0}, {"dsnu_e": -1.0}, {"bits": 7}, {"gain_dn_per_e": 0.0}, {"row_noise_e": -1.0}),
    *({"dark_current_e_per_s": None, "temperature_c": 40.0}, {"black_error_e": 1e30}),
    {"dark_current_e_per_s": 5.0, "temperature_c": -300.0},
    {"dark_current_e_per_s": 5.0, "dark_doubling_k": 0.5},
    *({"crosstalk": 1.5}, {"crosstalk": "missing.csv"}, {"crosstalk": None, "mosaic": "bayer"}),
    {"crosstalk": None, "crosstalk_stage": "charge"},
    *({"crosstalk": 0.1, "mosaic": "bayer"}, {"crosstalk": 0.1, "mosaic": "bayr"}),
    {"crosstalk": "mix.csv"},
]


@st.composite
def calls(draw, troubles=TROUBLE):
    sensors = draw(st.lists(st.sampled_from(SENSORS), min_size=1, max_size=3, unique=True))
    names = draw(st.sets(st.sampled_from(list(VALID)), max_size=4))
    values = {name: draw(VALID[name]) for name in sorted(names)}
    mixed = MIXED_RGB if set(sensors) <= RGB else MIXED
    for group in (TIMES, LIGHTS, MATRICES, MOMENTS, DARK, mixed):
        values |= draw(st.sampled_from(group))
    if "cam.csv" in sensors:
        values |= {"qe_scale": "percent", "beyond": draw(st.sampled_from(["zero", "hold"]))}
    if troubles and draw(st.booleans()):
        values |= draw(st.sampled_from(troubles))
    return capture_settings_of({"sensors": tuple(sensors)} | values)


def capture_settings_of(result):
    settings = {name: value for name, value in result.items() if value is not None}
    return Asked(settings.pop("sensors"), settings.pop("matrix"), settings)


# ---- the routes ----


@contextmanager
def folder_of_files():
    """A working folder with the files of `FILES`."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            for name, text in FILES.items():
                Path(name).write_text(text)
            yield
        finally:
            os.chdir(before)


def printed(*words):
    """What a command prints; its errors are raised."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        commands.main(args=[str(word) for word in words], standalone_mode=False)
    return out.getvalue()


def words_of(asked):
    words = [asked.function.removesuffix("_map"), *asked.sensors]
    if asked.matrix != "kernel":
        words += ["--matrix", asked.matrix]
    rest = dict(asked.settings)
    if "vary" in rest:
        words += ["--sweep", f"{rest.pop('vary')}={rest.pop('first')}:{rest.pop('last')}"]
    if "second_vary" in rest:
        name, *ends = (rest.pop(f"second_{key}") for key in ("vary", "first", "last", "points"))
        words += ["--and", f"{name}={':'.join(map(str, ends))}"]
    if "pareto_first" in rest:
        ends = rest.pop("pareto_first"), rest.pop("pareto_last"), rest.pop("pareto_points")
        words += ["--pareto", ":".join(map(str, ends))]
    for name, value in rest.items():
        option = option_of(name, value)
        if value is True or option in flags_of(name).values():
            words.append(option)
        elif isinstance(value, dict):
            words += [part for key, own in value.items() for part in (option, f"{key}={own}")]
        elif name == "labels":
            words += [part for own in value for part in (option, own)]
        elif value is not False:
            words += [option, ",".join(map(str, value)) if isinstance(value, tuple) else value]
    return words


def outcome(act, *given):
    try:
        return act(*given)
    except InputError as error:
        return Refusal(errors_in(error))


def in_python(asked):
    function = getattr(cn, asked.function)
    if asked.function.startswith("compare"):
        matrices = asked.matrix.split(",")
        return function(*asked.sensors, matrices=matrices, **asked.settings).to_dict()
    return as_a_step(
        asked, function(*asked.sensors, matrix=asked.matrix, **asked.settings).to_dict()
    )


def as_a_step(asked, data):
    """What a run writes: a list of one matrix where `cn.matrix` and its command give it alone."""
    return {"sensors": [data]} if asked.function == "matrix" else data


def on_the_command_line(asked):
    return as_a_step(asked, json.loads(printed(*words_of(asked), "--json", "-")))


def as_copied_study(asked):
    Path("copied.toml").write_text(printed(*words_of(asked), "--copy-as", "toml"))
    printed("run", "copied.toml", "--out", "copied")
    found = [json.loads(path.read_bytes()) for path in Path("copied").glob("*.json")]
    (result,) = [values["result"] for values in found if "result" in values]
    if asked.function == "matrix":
        result = {"sensors": result["sensors"]}  # without the sentences of several sensors
    return result


def as_copied_script(asked):
    script = printed(*words_of(asked), "--copy-as", "python")
    out = io.StringIO()
    with redirect_stdout(out):
        exec(compile(script, "copied.py", "exec"), {})
    (data,) = json.loads(out.getvalue())
    return as_a_step(asked, data)


def data_of(asked):
    """The study that a page would send."""
    data: dict[str, Any] = {
        "matrices": [asked.matrix],
        "outputs": {"budget": False},
        "sensors": [{"name": name} for name in asked.sensors],
    }
    keys = {name: FUNCTIONS["analyze"][name][0] for name in asked.settings}
    for name, key in keys.items():
        place, _, rest = key.partition("sensors.*.")
        for i, start in enumerate(data["sensors"] if rest else [data]):
            *path, last = (rest or place).split(".")
            at = start
            for step in path:
                at = at.setdefault(step, {})
            value = asked.settings[name]
            at[last] = value[i] if name == "labels" else value
    return data


def on_the_page(data, *want):
    """Parts of the answer of a page that may read the files here, or its faults."""
    uploads = Uploads()
    try:
        studies = Studies(uploads, files=frozenset(FILES) | {"missing.txt", "missing.csv"})
        try:
            record = ChartReplies(studies).answer({"study": data, "want": list(want)})
        except QuestionError as error:
            return error
        return json.loads(record)["parts"]
    finally:
        uploads.close()


# ---- what must be equal ----


def agree(one, other):
    """Equal structure and words; numbers to a relative 1e-12."""
    if isinstance(one, dict):
        assert isinstance(other, dict)
        assert one.keys() == other.keys()
        for key in one:
            agree(one[key], other[key])
    elif isinstance(one, list | tuple):
        assert len(one) == len(other)
        for mine, theirs in zip(one, other, strict=True):
            agree(mine, theirs)
    elif isinstance(one, float):
        assert other == pytest.approx(one, rel=1e-12, abs=1e-300)
    else:
        assert one == other


def page_agrees(result, parts):
    """The SNR of each kind, the operating point and the notes of each sensor."""
    stages, heads = stages_of(parts["stages"]), parts["head"]["sensors"]
    for own, drawn, head in zip(result["sensors"], stages, heads, strict=True):
        assert own["label"] == head["name"]
        channels = own["channels"]
        agree({c["name"]: c["snr_db"] for c in channels}, drawn["raw SNR"])
        unmixed = {c["name"]: c["contravariant_snr_db"] for c in channels}
        agree(unmixed, drawn["contravariant SNR"])
        agree(own["color"]["snr_db"], drawn["color SNR"])
        agree({"Y": own["price_db"]}, drawn["color SNR loss"])
        assert own["notes"] == head["notes"]


def page_refuses(error, asked, parts):
    """The same key and demand, or no page has this fault."""
    if kept_by_a_page(error, asked):
        return
    assert isinstance(parts, QuestionError), (error.setting, asked)
    demand = error.requirement or error.subject
    assert any(
        demand in sentence and error.setting in ("", where) for where, sentence in parts.faults
    ), (vars(error), parts.faults)


def kept_by_a_page(error, asked):
    """A page keeps what another control puts out of effect, and a copy about to be changed."""
    if error.setting == "exposure.time_ms":
        return "saturate" in asked.settings
    return error.setting == "prior" or asked.sensors.count(error.value) > 1


def routes_agree(asked):
    """What all routes give; the page's own is compared where a page can show it."""
    with folder_of_files():
        result = outcome(in_python, asked)
        others = {
            act.__name__: outcome(act, asked)
            for act in (on_the_command_line, as_copied_study, as_copied_script)
        }
        paged = asked.function == "analyze"
        parts = on_the_page(data_of(asked), "head", "stages") if paged else None
        if isinstance(result, Refusal):
            for name, other in others.items():
                assert isinstance(other, Refusal), (name, result.fields)
                assert result.fields[0] in other.fields, (name, result.fields, other.fields)
            if paged:
                page_refuses(result.errors[0], asked, parts)
            return result
        for name, other in others.items():
            assert not isinstance(other, Refusal), (name, other.fields)
            agree(result, other)
        assert not isinstance(parts, QuestionError), parts.faults
        if paged and not asked.settings.get("clip"):  # a page draws the moments of eq. 7
            page_agrees(result, parts)
        return result


# ---- the laws ----


@settings(max_examples=5)
@given(calls(troubles=[]))
def test_every_route_gives_the_same_analysis(asked):
    routes_agree(asked)


@pytest.mark.parametrize("trouble", TROUBLE, ids=str)
def test_every_route_gives_the_same_refusal(trouble):
    of_file = {"qe_scale", "beyond", "peak_qe"} & trouble.keys()
    values = {"sensors": ("cam.csv",), "qe_scale": "percent", "beyond": "zero"} if of_file else {}
    asked = capture_settings_of({"sensors": ("onyx-rgbw",), "matrix": "kernel"} | values | trouble)
    assert isinstance(routes_agree(asked), Refusal)


PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
EXACT = {"chart": True, "space": "lab"}  # seconds for each sensor and route


@pytest.mark.parametrize(
    "more",
    [
        {"sensors": PAIR, "matrix": "lmmse"},
        *(
            pytest.param({"sensors": one, "matrix": matrix, **EXACT}, marks=pytest.mark.evidence)
            for one, matrix in ((PAIR[1:], "kernel"), (PAIR, "kernel"), (PAIR, "lmmse"))
        ),
    ],
    ids=str,
)
def test_an_observer_is_the_same_by_every_route(more):
    asked = {"observer": "cie-1964-10", "budget": True} | more
    assert routes_agree(capture_settings_of(asked))["observer"] == "cie-1964-10"


@pytest.mark.evidence
@settings(max_examples=400)
@given(calls())
def test_every_route_gives_the_same_analysis_or_refusal_for_many_calls(asked):
    routes_agree(asked)


LIGHT = {"lux": 3.0, "illuminant": "A", "f_number": 2.8}
NOISY = {
    **{"prnu": 0.01, "dsnu_e": 3.0, "dark_current_e_per_s": 40.0, "temperature_c": 45.0},
    **{"row_noise_e": 2.0, "black_error_e": 4.0, "bits": 10, "gain_dn_per_e": 0.2},
    **{"crosstalk": 0.1, "crosstalk_stage": "charge"},
}
COMPARED = [
    {},
    {"vary": "time-ms", "first": 1.0, "last": 20.0, "equal": "saturation"},
    {"vary": "read-noise-e", "first": 0.0, "last": 9.0, "time_ms": 5.0, "quantity": "bound"},
    {"vary": "kelvin", "first": 2000.0, "last": 9000.0, "matrix": "kernel,lmmse", **LIGHT},
    {"vary": "lux", "first": 1.0, "last": 50.0, "matrix": "kernel,lmmse", **NOISY},
    {"matrix": "kernel,lmmse", "observer": "cie-1964-10"},
    pytest.param({"matrix": "lmmse", "prior": "all"}, marks=pytest.mark.evidence),
    {"vary": "time-ms", "first": 1.0, "last": 20.0, "time_ms": 5.0},
    {"vary": "read-noise-e", "first": 0.0, "last": 9.0, "read_noise_e": 5.0},
    *({"vary": "lx", "first": 1.0, "last": 2.0}, {"vary": "lux", "first": 5.0, "last": 2.0}),
    *({"prior": "chart"}, {"matrix": "kernel,lmse"}, {"points": 1}),
]
MATRIXED = [
    *({}, {"matrix": "lmmse", "prior": "chart", **LIGHT}, {"matrix": "bounded-psi=6.5"}),
    *({"matrix": "lmmse", **NOISY}, {"pixel": "pixel.txt"}),
    {"pareto_first": 0.1, "pareto_last": 10.0, "pareto_points": 3, "metric": "energy"},
    {"pareto_first": 0.1, "pareto_last": 10.0, "pareto_points": 3, "observer": "cie-2015-10"},
    {"pareto_first": 10.0, "pareto_last": 0.1, "pareto_points": 3},
    *({"matrix": "ridge=-1"}, {"prior": "chart"}, {"time_ms": 1.0, "saturate": 0.5}),
]


@pytest.mark.parametrize("result", COMPARED, ids=str)
def test_a_comparison_is_the_same_by_every_route(result):
    start = {"sensors": ("onyx-rgbw", "onyx-rgb-ircut"), "matrix": "kernel", "points": 3}
    routes_agree(replace(capture_settings_of(start | result), function="compare"))


def test_a_comparison_over_two_parameters_is_the_same_by_every_route():
    second = {"second_vary": "prnu", "second_first": 0.0, "second_last": 0.1, "second_points": 3}
    given = {"vary": "lux", "first": 0.1, "last": 10.0, "points": 4, **second}
    start = {"sensors": PAIR, "matrix": "kernel"}
    routes_agree(replace(capture_settings_of(start | given), function="compare_map"))


@pytest.mark.parametrize("result", MATRIXED, ids=str)
def test_a_color_matrix_is_the_same_by_every_route(result):
    start = {"sensors": ("onyx-rgbw",), "matrix": "kernel"}
    routes_agree(replace(capture_settings_of(start | result), function="matrix"))


FURTHER = [
    {
        **{"sensors": ("cam.csv",), "qe_scale": "percent", "beyond": "hold", "negatives": "zero"},
        **{"filter": "filter.csv", "shift_ircut_nm": 5.0, "channel_filters": {"R": "ircut-650"}},
        **{"labels": ("mine",), "merit": True, "reader": "machine", "pairs": "cards.csv"},
        **{"chart_file": "cards.csv", "patch": 0.5, "reflectance_scale": "percent"},
        **{"illuminant": "lamp.csv", "illuminant_per": "energy", "illuminant_column": "power"},
    },
    {
        **{"pipeline": True, "white_balance": (2.0, 1.0, 1.2), "exposure_gain": 0.7},
        **{"saturation": 1.2, "tone": "rec709", "luma": "bt601", "base_iso": 50.0},
        **{"iso": (100.0, 800.0), "iso_read_noise_e": (2.0, 3.0), "column_noise_e": 1.0},
        **{"rtn_share": 0.1, "rtn_amplitude_e": 20.0, "binning": 4, "binning_mode": "digital"},
    },
]


@pytest.mark.evidence
@pytest.mark.parametrize("settings", FURTHER, ids=["curves", "pipeline"])
def test_further_settings_of_an_analysis_are_the_same_by_every_route(settings):
    start = {"sensors": ("onyx-rgb-ircut",), "matrix": "kernel"}
    assert not isinstance(routes_agree(capture_settings_of(start | settings)), Refusal)


def times_ms(result):
    return [one["time_ms"] for one in result["sensors"]]


def brightest_e(sensor):
    return max(channel["mean_e"] for channel in sensor["channels"])


def test_ten_lux_and_twelve_milliseconds_give_the_json_of_the_command_exactly():
    data = json.loads(printed("analyze", *PAIR, "--lux", "10", "--time-ms", "12", "--json", "-"))
    assert cn.analyze(*PAIR, lux=10, time_ms=12).to_dict() == data
    assert times_ms(data) == [12.0, 12.0]


@pytest.mark.parametrize("equal", [{}, {"equal": "exposure"}])
def test_without_a_time_all_sensors_share_one_at_which_none_saturates(equal):
    words = [word for name, value in equal.items() for word in (f"--{name}", value)]
    data = json.loads(printed("analyze", *PAIR, *words, "--json", "-"))
    assert cn.analyze(*PAIR, **equal).to_dict() == data
    assert times_ms(data) == pytest.approx([11.94, 11.94], abs=0.005)
    assert max(brightest_e(one) for one in data["sensors"]) == pytest.approx(9900)


def test_equal_saturation_gives_each_sensor_its_own_time():
    data = json.loads(printed("analyze", *PAIR, "--equal", "saturation", "--json", "-"))
    assert cn.analyze(*PAIR, equal="saturation").to_dict() == data
    first, second = times_ms(data)
    assert first == pytest.approx(11.94, abs=0.005)
    assert second > 2 * first
    for one in data["sensors"]:
        assert brightest_e(one) == pytest.approx(9900)  # 99 % of the paper's 10,000 e-
