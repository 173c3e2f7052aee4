#!/usr/bin/env python3
"""Judges law files by docs/law.schema.json, with the part of JSON Schema that it uses; anything else in the schema is an error.

usage: law_schema.py SCHEMA LAW.json...      prints "valid" or "invalid: why" for each
"""
import json
import re
import sys

KINDS = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}
KNOWN = {"$schema", "title", "description", "type", "const", "enum", "properties", "required", "additionalProperties", "items", "minItems", "maxItems", "minimum", "maximum",
         "exclusiveMinimum", "exclusiveMaximum", "pattern", "oneOf", "anyOf", "allOf"}


def is_kind(value, kind):
    if kind in ("number", "integer"):
        return isinstance(value, (int, float)) and not isinstance(value, bool) and (kind == "number" or value == int(value))
    return isinstance(value, KINDS[kind])


def wrong(value, schema, where="the file"):
    """Why a value does not fit, or None."""
    if set(schema) - KNOWN:
        raise SystemExit(f"the schema uses {set(schema) - KNOWN}")
    kinds = schema.get("type")
    if kinds and not any(is_kind(value, k) for k in ([kinds] if isinstance(kinds, str) else kinds)):
        return f"{where} is no {kinds}"
    if "const" in schema and value != schema["const"] or "enum" in schema and value not in schema["enum"]:
        return f"{where} is {value!r}"
    if is_kind(value, "number"):
        if not (value >= schema.get("minimum", value) and value <= schema.get("maximum", value)):
            return f"{where} is out of range"
        if value <= schema.get("exclusiveMinimum", value - 1) or value >= schema.get("exclusiveMaximum", value + 1):
            return f"{where} is out of range"
    if isinstance(value, str) and "pattern" in schema and not re.search(schema["pattern"], value):
        return f"{where} is {value!r}"
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            return f"{where} has {len(value)} entries"
        for i, item in enumerate(value):
            found = wrong(item, schema.get("items", {}), f"{where}[{i}]")
            if found:
                return found
    if isinstance(value, dict):
        for key in schema.get("required", []):
            if key not in value:
                return f"{where} has no {key}"
        for key, item in value.items():
            rule = schema.get("properties", {}).get(key, schema.get("additionalProperties", True))
            if rule is False:
                return f"{where}: unknown {key}"
            found = wrong(item, rule, f"{where}.{key}") if isinstance(rule, dict) else None
            if found:
                return found
    for word, fits in (("oneOf", lambda n, all: n == 1), ("anyOf", lambda n, all: n > 0), ("allOf", lambda n, all: n == all)):
        if word in schema:
            found = [wrong(value, s, where) for s in schema[word]]
            if not fits(found.count(None), len(found)):
                return f"{where}: {word}: {[f for f in found if f]}"
    return None


with open(sys.argv[1]) as file:
    SCHEMA = json.load(file)
for path in sys.argv[2:]:
    with open(path) as file:
        reason = wrong(json.load(file), SCHEMA)
    print("valid" if reason is None else f"invalid: {reason}")
