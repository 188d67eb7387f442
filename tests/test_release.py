"""Files that a release needs agree with the package."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
HEADINGS = re.findall(
    r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.MULTILINE
)


RELEASED = re.compile(r"\[(\d+\.\d+\.\d+)\] - (\d{4}-\d{2}-\d{2}|not yet released)")


def test_the_citation_has_version_and_date_of_the_newest_release_and_what_the_package_says():
    newest = RELEASED.fullmatch(HEADINGS[1])
    assert (CITATION["version"], str(CITATION["date-released"])) == newest.groups()
    assert CITATION["license"] == PROJECT["license"].partition(" AND ")[0]
    assert CITATION["keywords"] == PROJECT["keywords"]
    assert CITATION["authors"] == PROJECT["authors"]


def test_the_citation_names_the_paper():
    (paper,) = CITATION["references"]
    assert [one["family-names"] for one in paper["authors"]] == ["Clouet", "Vaillant", "Alleysson"]
    assert f'"{" ".join(paper["title"].split())}"' in " ".join(
        (ROOT / "README.md").read_text(encoding="utf-8").split()
    ).replace(',"', '"')


def test_the_changelog_has_a_section_for_changes_to_come_and_one_for_each_version():
    """Form of https://keepachangelog.com/en/1.1.0/; a release replaces the words by its date."""
    assert HEADINGS[0] == "[Unreleased]"
    versions = [RELEASED.fullmatch(heading) for heading in HEADINGS[1:]]
    assert all(versions), HEADINGS
    numbers = [tuple(map(int, one[1].split("."))) for one in versions]
    assert numbers == sorted(set(numbers), reverse=True)


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


def test_the_conda_recipe_needs_what_the_package_needs():
    text = (ROOT / "packaging/conda/recipe.yaml").read_text(encoding="utf-8")
    needs = yaml.safe_load(text)["requirements"]["run"]
    named = {need.replace(" ", "").replace("matplotlib-base", "matplotlib") for need in needs}
    own = (*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["compiled"])
    assert named == {*own, f"python{PROJECT['requires-python']}"}


def test_a_release_publishes_only_files_that_were_built_tested_and_signed():
    text = (ROOT / ".github/workflows/release.yml").read_text(encoding="utf-8")
    jobs = yaml.safe_load(text)["jobs"]
    assert (jobs["try"]["needs"], jobs["publish"]["needs"]) == ("build", "try")
    used = [step.get("uses", "").partition("@")[0] for step in jobs["publish"]["steps"]]
    signed, published = "actions/attest-build-provenance", "pypa/gh-action-pypi-publish"
    assert used.index(signed) < used.index(published)
    assert jobs["publish"]["permissions"]["id-token"] == "write"
