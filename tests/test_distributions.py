"""The wheel and the source distribution: complete, repeatable, and installed without git."""

import os
import re
import runpy
import shutil
import subprocess
import sys
import tomllib
from email.parser import HeaderParser
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).parents[1]
BUILD = runpy.run_path(str(ROOT / "hatch_build.py"))
portable_readme, project_links = BUILD["portable_readme"], BUILD["project_links"]
VERSION = "9.8.7"
VERSION_VARIABLES = ("SETUPTOOLS_SCM_PRETEND_VERSION", "VCS_VERSIONING_PRETEND_VERSION")
README = (ROOT / "README.md").read_text(encoding="utf-8")


def tracked_files():
    found = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if found.returncode != 0:
        pytest.skip("git lists the files of the source, and is missing here, or this is no clone")
    return [name for name in found.stdout.split("\0") if name and (ROOT / name).is_file()]


def built(folder):
    """Wheel and source distribution of a copy of the source, without git."""
    source = folder / "source"
    for name in tracked_files():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, source / name)
    out = folder / "dist"
    words = [sys.executable, "-m", "build", "--no-isolation", "--outdir", out, source]
    given = dict.fromkeys(VERSION_VARIABLES, VERSION)
    env = {k: v for k, v in os.environ.items() if k != "CHROMANOISE_REPOSITORY"} | given
    subprocess.run(words, env=env, check=True, capture_output=True)
    (wheel,), (sdist,) = out.glob("*.whl"), out.glob("*.tar.gz")
    return wheel, sdist


@pytest.fixture(scope="module")
def distributions(tmp_path_factory):
    return built(tmp_path_factory.mktemp("built"))


@pytest.fixture(scope="module")
def description(distributions):
    """The README of the wheel."""
    with ZipFile(distributions[0]) as archive:
        text = archive.read(f"chromanoise-{VERSION}.dist-info/METADATA").decode("utf-8")
    parsed = HeaderParser().parsestr(text)
    assert parsed["Version"] == VERSION
    assert parsed["Description-Content-Type"] == "text/markdown"
    return parsed.get_payload()


def test_the_checks_of_a_package_index_pass(distributions):
    words = [sys.executable, "-m", "twine", "check", "--strict", *distributions]
    subprocess.run(words, check=True, capture_output=True)


@pytest.mark.evidence
def test_two_builds_give_the_same_bytes(distributions, tmp_path):
    again = built(tmp_path)
    for first, second in zip(distributions, again, strict=True):
        assert first.name == second.name
        assert first.read_bytes() == second.read_bytes()


def test_the_readme_of_the_wheel_is_short_text_without_relative_links(description):
    assert len(description.encode()) < 20_000
    assert "data:image" not in description
    links = re.findall(r"\[[^\]]*\]\(([^)]*)\)", description)
    assert all(one.startswith(("http", "#")) for one in links)


def test_with_the_address_of_the_repository_links_lead_to_the_tag():
    text = "![a](docs/a.png) and [b](docs/b.md), [c](https://c.org/d)"
    assert portable_readme(text, repository="https://host.org/me/it/", version="0.2.0") == (
        "![a](https://host.org/me/it/raw/v0.2.0/docs/a.png) and "
        "[b](https://host.org/me/it/blob/v0.2.0/docs/b.md), [c](https://c.org/d)"
    )
    own = {"repository": "https://host.org/me/it", "version": "0.3.0.dev4+gabc"}
    assert "/blob/HEAD/docs/b.md" in portable_readme(text, **own)
    assert project_links(**own)["Repository"] == "https://host.org/me/it"
    pages = [url.partition("/blob/HEAD/")[2] for url in project_links(**own).values()]
    assert all((ROOT / page).is_file() for page in pages if page)


def license_of(text):
    """The words of a license, without indents and line breaks."""
    return " ".join(text.split())


LICENSES = {  # of the tables that name them as their source
    "ISETCam": "Permission is hereby granted, free of charge",
    "isofit": "Apache License Version 2.0, January 2004",
    "pvlib": "Redistribution and use in source and binary forms",
    "rawtoaces": "Apache License Version 2.0, January 2004",
}


@pytest.mark.parametrize("project", LICENSES)
def test_the_wheel_has_the_license_of_each_source_of_its_tables(distributions, project):
    with ZipFile(distributions[0]) as archive:
        folder = f"chromanoise-{VERSION}.dist-info/licenses"
        text = archive.read(f"{folder}/licenses/{project}.txt").decode("utf-8")
        sources = archive.read("chromanoise/spectra/tables/SOURCES.toml").decode("utf-8")
        assert f"{folder}/LICENSE" in archive.namelist()
    assert LICENSES[project] in license_of(text)
    assert "Copyright" in text
    taken = {
        name
        for name, one in tomllib.loads(sources).items()
        if project in one["source"] + one["license"]
    }
    assert set(re.findall(r"tables/([\w-]+)\.csv", text)) == taken != set()


@pytest.mark.evidence
def test_an_installation_without_git_knows_its_version(distributions, tmp_path):
    target, nothing = tmp_path / "installed", tmp_path / "nothing"
    nothing.mkdir()
    words = ["-m", "pip", "install", "--no-deps", "--no-index", "--quiet", "--target", target]
    env = os.environ | {"PATH": str(nothing), "PYTHONPATH": str(target)}
    subprocess.run([sys.executable, *words, distributions[0]], env=env, check=True)
    script = "from chromanoise.cli import main; main()"
    for command, said in (
        (["--version"], f"chromanoise {VERSION}"),
        (["cite", "--bibtex"], VERSION),
    ):
        printed = subprocess.run(
            [sys.executable, "-c", script, *command],
            env=env,
            cwd=tmp_path,
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        assert said in printed
    assert (target / "share/man/man1/chromanoise.1").is_file()


def test_the_source_distribution_contains_what_the_tests_need(distributions):
    with subprocess.Popen(["tar", "tzf", distributions[1]], stdout=subprocess.PIPE, text=True) as p:
        names = {line.partition("/")[2].strip() for line in p.stdout}
    kept = (".git/", ".gitignore", ".github/")
    missing = [name for name in tracked_files() if name not in names and not name.startswith(kept)]
    assert missing == []
