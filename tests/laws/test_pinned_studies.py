"""Stored studies give the hashes, copied forms and numbers that they gave when they were stored.

`tools/pin_studies.py --renew` writes a change on purpose into the record; CHANGELOG.md names it.
"""

import json

import pytest

import pin_studies
from chromanoise.study import study_schema

RECORDS = pin_studies.stored_records()
OTHER_PROCESSORS = 1e-9
"""BLAS kernels and iterated fits differ by up to 3e-10 (docs/design.md)."""


def check(records, monkeypatch):
    monkeypatch.chdir(pin_studies.FOLDER)
    found = {
        json.dumps(one["study"]): lines
        for one in records
        if (lines := pin_studies.differences(one, OTHER_PROCESSORS))
    }
    assert not found


def test_a_stored_study_gives_the_stored_hash_forms_and_numbers(monkeypatch):
    fast = [one for one in RECORDS[10::40] if "pictures" not in one["study"]]
    check(fast, monkeypatch)


@pytest.mark.evidence
def test_every_stored_study_gives_the_stored_hash_forms_and_numbers(monkeypatch):
    check(RECORDS, monkeypatch)


def keys_of(schema, definitions, path=""):
    """All keys of the schema of a study, with dots."""
    for key, one in schema["properties"].items():
        inner = json.dumps(one)
        name = f"{path}.{key}".removeprefix(".")
        part = next((d for d in definitions if f'#/$defs/{d}"' in inner), None)
        if part is None:
            yield name
        else:
            yield from keys_of(definitions[part], definitions, name)


def test_every_key_of_a_study_occurs_in_a_stored_study():
    used = {
        ".".join(step for step in path.split("/") if step and not step.isdigit())
        for one in RECORDS
        for path, _ in pin_studies.flat(one["study"])
    }
    schema = study_schema()
    missing = {
        key
        for key in keys_of(schema, schema["$defs"])
        if not any(one == key or one.startswith(f"{key}.") for one in used)
    }
    # `key` and `shape` are of cubes in containers, which the stored studies do not have
    assert missing <= {"schema", "pictures.key", "pictures.shape"}
