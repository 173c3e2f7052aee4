#!/usr/bin/env python3
"""Judges reports by docs/report.schema.json, with the library jsonschema.

usage: report_schema.py SCHEMA REPORT.json...      prints "valid" or "invalid: where: why" for each; the exit code is the number of invalid ones
"""
import json
import sys

import jsonschema

with open(sys.argv[1], encoding="utf-8") as file:
    schema = json.load(file)
jsonschema.Draft202012Validator.check_schema(schema)
kinds = {name: jsonschema.Draft202012Validator({**schema["$defs"][name], "$defs": schema["$defs"]}) for name in ("report", "several")}
invalid = 0
for path in sys.argv[2:]:
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    error = next(kinds["several" if "comparison" in report else "report"].iter_errors(report), None)
    invalid += error is not None
    print("valid" if error is None else f"invalid: {path}: {'/'.join(map(str, error.absolute_path))}: {error.message[:300]}")
sys.exit(invalid)
