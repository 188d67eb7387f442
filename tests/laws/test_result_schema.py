"""The JSON schema of a result describes what the result writes."""

import json

import pytest

import chromanoise as cn

PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
MAKERS = {
    "analyze": lambda: cn.analyze(*PAIR, merit=True, chart=True, space="lab"),
    "machine": lambda: cn.analyze(*PAIR, reader="machine"),
    "compare": lambda: cn.compare(*PAIR, points=3),
    "map": lambda: cn.compare_map(*PAIR, points=3, second_points=2),
    "matrix": lambda: cn.matrix("onyx-rgbw"),
    "league": lambda: cn.league("onyx-rgbw", iso=800),
}
KINDS = {
    "object": dict, "array": list, "string": str, "boolean": bool, "null": type(None),
    "integer": int, "number": (int, float),
}  # fmt: skip


def faults(value, schema, whole, place="$"):
    """Where a value differs from a schema, by the rules of JSON schema that ours use."""
    if "$ref" in schema:
        return faults(value, whole["$defs"][schema["$ref"].rpartition("/")[2]], whole, place)
    found = []
    if not schema and isinstance(value, float):
        found.append(f"{place}: the number {value} has no type")
    if "anyOf" in schema and all(faults(value, one, whole) for one in schema["anyOf"]):
        found.append(f"{place}: none of {schema['anyOf']}")
    if "enum" in schema and value not in schema["enum"]:
        found.append(f"{place}: {value!r}")
    kinds = schema.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    if kinds and not any(isinstance(value, KINDS[kind]) for kind in kinds):
        found.append(f"{place}: {value!r} is no {kinds}")
    if isinstance(value, dict):
        found += [f"{place}: no {key}" for key in schema.get("required", ()) if key not in value]
        known, others = schema.get("properties", {}), schema.get("additionalProperties")
        for key, one in value.items():
            if key in known or others is not None:
                found += faults(one, known.get(key, others), whole, f"{place}.{key}")
            elif known:
                found.append(f"{place}: {key} is not described")
    if isinstance(value, list) and "items" in schema:
        for i, one in enumerate(value):
            found += faults(one, schema["items"], whole, f"{place}[{i}]")
    return found


@pytest.mark.parametrize("maker", MAKERS)
def test_a_result_has_the_keys_and_types_of_its_schema(maker):
    result = MAKERS[maker]()
    schema = type(result).json_schema()
    assert len(schema["properties"]) > 2
    data = json.loads(json.dumps(result.to_dict()))
    assert faults(data, schema, schema) == []
    (first, *_) = schema["required"]
    del data[first]
    assert faults(data, schema, schema) == [f"$: no {first}"]
