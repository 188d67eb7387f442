"""Files that a release needs agree with the package."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

import chromanoise

ROOT = Path(__file__).parents[1]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
HEADINGS = re.findall(
    r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.MULTILINE
)


def test_the_citation_has_the_version_the_license_and_the_keywords_of_the_package():
    assert CITATION["version"] == chromanoise.__version__
    assert CITATION["license"] == PROJECT["license"]
    assert CITATION["keywords"] == PROJECT["keywords"]
    assert CITATION["authors"] == PROJECT["authors"]


def test_the_citation_names_the_paper():
    (paper,) = CITATION["references"]
    assert [one["family-names"] for one in paper["authors"]] == ["Clouet", "Vaillant", "Alleysson"]
    assert f'"{" ".join(paper["title"].split())}"' in " ".join(
        (ROOT / "README.md").read_text(encoding="utf-8").split()
    ).replace(',"', '"')


def test_the_changelog_has_a_section_for_changes_to_come_and_one_for_this_version():
    """Form of https://keepachangelog.com/en/1.1.0/; a release replaces the words by its date."""
    assert HEADINGS[0] == "[Unreleased]"
    form = re.compile(r"\[(\d+\.\d+\.\d+)\] - (\d{4}-\d{2}-\d{2}|not yet released)")
    versions = [form.fullmatch(heading) for heading in HEADINGS[1:]]
    assert all(versions), HEADINGS
    numbers = [tuple(map(int, one[1].split("."))) for one in versions]
    assert numbers == sorted(set(numbers), reverse=True)
    assert versions[0][1] == chromanoise.__version__


def test_the_classifiers_name_every_python_that_the_workflow_tests():
    workflow = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"))
    tested = workflow["jobs"]["check"]["strategy"]["matrix"]["python"]
    named = [c.rpartition(" ")[2] for c in PROJECT["classifiers"] if "Python :: 3." in c]
    assert tested == named
    assert PROJECT["requires-python"] == f">={tested[0]}"


@pytest.mark.parametrize(
    "path", sorted((ROOT / ".github").rglob("*.yml")), ids=lambda path: path.name
)
def test_every_form_and_workflow_is_yaml_with_a_name(path):
    assert yaml.safe_load(path.read_text(encoding="utf-8"))["name"]


def test_no_committed_file_names_a_registry_of_packages():
    """`.npmrc` leaves the addresses away, so each machine uses the registry that it is set to."""
    lock = (ROOT / "package-lock.json").read_text(encoding="utf-8")
    assert '"integrity"' in lock
    assert '"resolved"' not in lock
