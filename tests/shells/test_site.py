"""Blocks of the documents run, links lead somewhere, public names are documented."""

import importlib
import importlib.util
import inspect
import pkgutil
import re
import shlex
import sys
import textwrap
import tomllib
from pathlib import Path
from typing import NamedTuple, is_typeddict
from urllib.parse import urlsplit

import pytest

import chromanoise as cn
from dear import dear_if
from documentation import (
    faults_of_class,
    faults_of_function,
    leads_somewhere,
    public_methods,
    references,
    short_entries,
)

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    path
    for path in (ROOT / "docs").rglob("*.md")
    if not path.is_relative_to(ROOT / "docs/auto_gallery")
)
WITH_ROOT = [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]


def page_id(path):
    return path.relative_to(ROOT).as_posix()


# ---- blocks ----


class Block(NamedTuple):
    kind: str
    mark: str
    text: str


def blocks(text):
    found = re.findall(r"^( *)```(\w*)([^\n]*)\n(.*?)^\1```$", text, flags=re.DOTALL | re.MULTILINE)
    return [
        Block(kind, mark.strip(), textwrap.dedent(body))
        for _, kind, mark, body in found
        if not mark.startswith("{")  # a directive of the site
    ]


def commands(block):
    """The commands of a block of the shell, without comments."""
    lines = block.text.replace("\\\n", "").splitlines()
    parts = [part for line in lines for part in line.split("&&")]
    words = [shlex.split(part, comments=True) for part in parts]
    return [one for one in words if one]


def run_python(block, space, capsys):
    """Run a script; what it prints must be its comments that start a line, if there are any."""
    promised = re.findall(r"^# (.*)$", block.text, flags=re.MULTILINE)
    capsys.readouterr()
    exec(compile(block.text, "<page>", "exec"), space)
    printed = capsys.readouterr().out.splitlines()
    assert not promised or printed == promised


def run_shell(block, done):
    for words in commands(block):
        assert words[0] == "chromanoise", words
        done(*words[1:])


def check_toml(block):
    data = tomllib.loads(block.text)
    if "sensors" in data and "design" not in data:  # a script of the page reads a design
        cn.study_from_data(data)


def run_page(path, done, capsys):
    space = {}
    for block in blocks(path.read_text(encoding="utf-8")):
        if block.mark.startswith("file="):
            Path(block.mark.removeprefix("file=")).write_text(block.text, encoding="utf-8")
        if block.mark.startswith("no-run: "):
            continue
        if block.kind == "python":
            run_python(block, space, capsys)
        elif block.kind == "sh":
            run_shell(block, done)
        elif block.kind == "toml":
            check_toml(block)


RUNNING = [
    path
    for path in PAGES
    if any(
        block.kind in ("python", "sh", "toml") for block in blocks(path.read_text(encoding="utf-8"))
    )
]


LONG = ("denoising.md", "characterize.md", "own_matrix.md", "pixel_shares.md")


@pytest.mark.evidence
@pytest.mark.parametrize("path", dear_if(lambda path: path.name in LONG, RUNNING), ids=page_id)
def test_every_block_of_a_page_runs_without_extras_and_prints_what_the_page_says(
    path, here, done, capsys, without_extras
):
    run_page(path, done, capsys)


@pytest.mark.parametrize(
    "text",
    [
        "```python\nprint(1)\n# 2\n```\n",
        "```python\nraise ValueError\n```\n",
        "```sh\nchromanoise analyze none.csv\n```\n",
        "```sh\nls\n```\n",
        "```toml\na = = 1\n```\n",
    ],
)
def test_a_block_that_does_not_do_what_it_says_is_found(text, here, done, capsys):
    Path("page.md").write_text(text)
    with pytest.raises((AssertionError, ValueError)):
        run_page(Path("page.md"), done, capsys)


@pytest.mark.parametrize("path", PAGES, ids=page_id)
def test_a_block_that_is_not_run_says_why(path):
    for block in blocks(path.read_text(encoding="utf-8")):
        assert not block.mark or re.fullmatch(r"no-run: \w.*|file=\S+", block.mark), block


# ---- links ----


def slug(heading):
    """The anchor of a heading, as GitHub and Sphinx name it."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)|[`*]", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def without_code(text):
    return re.sub(r"^( *)```.*?^\1```$|`[^`\n]*`", "", text, flags=re.DOTALL | re.MULTILINE)


def links(path):
    return re.findall(r"\]\(([^)\s]+)\)", without_code(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("path", WITH_ROOT, ids=page_id)
def test_every_link_leads_to_a_file_and_a_heading(path):
    for link in links(path):
        if "://" in link:
            parts = urlsplit(link)
            assert parts.scheme in ("http", "https"), link
            assert re.fullmatch(r"[\w.-]+\.\w+|127\.0\.0\.1:\d+", parts.netloc), link
            continue
        target, _, anchor = link.partition("#")
        file = (path.parent / target).resolve() if target else path
        assert file.exists(), link
        if anchor:
            headings = re.findall(r"^#+ (.*)$", file.read_text(encoding="utf-8"), re.MULTILINE)
            assert anchor in map(slug, headings), link


def test_every_page_is_in_the_contents_of_the_site():
    listed = {ROOT / "docs/index.md"}
    for path in PAGES:
        for body in re.findall(
            r"```\{toctree\}\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL
        ):
            for line in body.splitlines():
                if line and not line.startswith(":"):
                    listed |= {(path.parent / f"{line}.md").resolve()}
                    if "*" in line:
                        listed |= set(path.parent.glob(f"{line}.md"))
    assert set(PAGES) - listed == set()


# ---- names ----


def loaded(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module  # the next one imports it
    spec.loader.exec_module(module)
    return module


site = loaded(ROOT / "docs/_ext/public_names.py")
reference = loaded(ROOT / "docs/_ext/package_pages.py")
powers = loaded(ROOT / "docs/_ext/powers.py")


def test_every_package_with_public_names_is_in_the_reference():
    shells = {"chromanoise.cli"}
    found = {
        module.name
        for module in pkgutil.walk_packages(cn.__path__, "chromanoise.")
        if module.ispkg and getattr(importlib.import_module(module.name), "__all__", ())
    }
    assert {name for name in found if "._" not in name} - shells <= set(site.all_packages())


def names_of(path):
    module = importlib.import_module(path)
    return [(name, getattr(module, name)) for name in site.public_names(module)]


@pytest.mark.parametrize("path", list(site.all_packages()))
def test_every_public_name_has_a_summary(path):
    bare = []
    for name, value in names_of(path):
        text = (
            site.documentation_of_data(path, name)
            if site.kind_of(value) == "data" and not inspect.ismodule(value)
            else value.__doc__
        )
        if not text or not text.strip():
            bare.append(name)
    assert bare == []


@pytest.mark.parametrize("path", list(site.all_packages())[1:])
def test_every_parameter_unit_and_error_of_a_public_name_is_documented(path):
    """What comes back is what the summary says, so that a section of its own is not needed."""
    faults = []
    for name, value in names_of(path):
        if inspect.isclass(value) and site.kind_of(value) == "classes" and not is_typeddict(value):
            found = faults_of_class(name, value)
            faults += [one for one in found if one != f"{name}: no Raises"]
        elif site.kind_of(value) == "functions":
            faults += faults_of_function(name, inspect.unwrap(value), computes=False)
    assert [one for one in faults if not one.endswith((": no Returns", ": no source"))] == []


def docstrings_of(path):
    """Name, owner and text of each docstring of the public names of a package."""
    module = importlib.import_module(path)
    yield path, module, module.__doc__
    for name, value in names_of(path):
        if site.kind_of(value) == "data":
            yield (
                name,
                module,
                "" if inspect.ismodule(value) else site.documentation_of_data(path, name),
            )
            continue
        yield name, value, value.__doc__
        for own, function in public_methods(value) if inspect.isclass(value) else ():
            yield f"{name}.{own}", value, function.__doc__


@pytest.fixture(scope="module")
def public():
    found = {}
    for path in site.all_packages():
        module = importlib.import_module(path)
        found.setdefault(path.rpartition(".")[2], []).append(module)
        for name, value in names_of(path):
            found.setdefault(name, []).append(value)
    return found


@pytest.mark.parametrize("path", list(site.all_packages()))
def test_no_entry_of_a_docstring_only_repeats_the_name(path):
    found = [
        one
        for name, value in names_of(path)
        if site.kind_of(value) != "data"
        for one in short_entries(name, inspect.unwrap(value))
    ]
    assert found == []


@pytest.mark.parametrize("path", list(site.all_packages()))
def test_cross_references_name_public_things_only(path, public):
    module = importlib.import_module(path)
    lost = [
        f"{where}: {name}"
        for where, owner, text in docstrings_of(path)
        for name in references(text)
        if not leads_somewhere(name, owner, module, public)
    ]
    assert lost == []


# ---- pages of the Python reference ----

MOST_NAMES_OF_A_PAGE = 20  # about 12,000 pixels


@pytest.fixture(scope="module")
def reference_pages():
    return {
        name: text
        for path in site.all_packages()
        for name, text in reference.pages_of_package(importlib.import_module(path)).items()
    }


def test_each_public_name_has_one_entry_in_the_reference(reference_pages):
    text = "\n".join(reference_pages.values())
    entries = re.findall(r"^\.\. (?:autoclass|autofunction|py:data):: (?:.*\.)?(\w+)", text, re.M)
    own = [
        name
        for path in site.all_packages()
        for name, value in names_of(path)
        if not inspect.ismodule(value) and site.home_of(value, name, path) is None
    ]
    assert sorted(entries) == sorted(own)


def test_headings_of_the_reference_are_lines_of_their_own(reference_pages):
    for name, text in reference_pages.items():
        lines = ["", *text.splitlines(), ""]
        rules = [i for i, line in enumerate(lines) if re.fullmatch(r"={3,}|-{3,}", line)]
        assert rules, name
        for i in rules:
            assert len(lines[i]) == len(lines[i - 1]), lines[i - 1]
            assert lines[i - 2] == lines[i + 1] == "", lines[i - 1]


def test_no_page_of_the_reference_is_long(reference_pages):
    for name, text in reference_pages.items():
        entries = re.findall(r"^\.\. (?:autoclass|autofunction|py:data)::", text, re.M)
        assert len(entries) <= MOST_NAMES_OF_A_PAGE, name


@pytest.mark.parametrize("path", list(site.all_packages()))
def test_a_summary_in_the_reference_is_a_whole_sentence(path):
    module = importlib.import_module(path)
    for name, value in names_of(path):
        text = "" if inspect.ismodule(value) else reference.documentation(module, name)
        first = reference.summary(text)
        assert not re.search(r"\b(eq|eqs|Rec|Fig|vs|e\.g|i\.e)\.$", first), name
        assert first.count("(") == first.count(")"), name


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Color C M (eq. 5). More.", "Color C M (eq. 5)."),
        ("The kernel of eq. 6.\n\nMore.", "The kernel of eq. 6."),
        ("Linear sRGB (Rec. 709) of X. Then.", "Linear sRGB (Rec. 709) of X."),
    ],
)
def test_a_summary_ends_at_the_first_sentence(text, shown):
    assert reference.summary(text) == shown


def test_stars_of_a_docstring_are_no_markup_outside_code():
    assert reference.marked_up("a* of `x*` and ``y*``") == r"a\* of `x*` and ``y*``"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("C D C^T", "C D C{sup T}"),
        ("(F^T F)^-1 M", "(F{sup T} F){sup −1} M"),
        ("x^(1/gamma), |f|^2", "x{sup 1/gamma}, |f|{sup 2}"),
        ("L^ = F", "L̂ = F"),
        ("VIF_i = (G⁻¹)_ii, σ_read²", "VIF{sub i} = (G⁻¹){sub ii}, σ{sub read}²"),
        ("read_noise_e, snr_y_db, d_m.x and onyx_rgbw", None),
    ],
)
def test_powers_and_indices_of_running_text_are_raised_and_lowered(text, shown):
    found = "".join(f"{{{kind} {part}}}" if kind else part for kind, part in powers.pieces(text))
    assert found == (shown or text)
