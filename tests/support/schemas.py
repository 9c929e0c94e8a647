"""Documents against the schemas in proto/json/schemas, by Debian's python3-jsonschema."""
import functools
import json
import os
import pathlib

import jsonschema

SCHEMAS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "proto" / "json" / "schemas"


@functools.lru_cache(maxsize=None)
def validator_of(format_name: str) -> jsonschema.Draft202012Validator:
    """Of "kinship.problem/1". Raises AssertionError if it has no schema."""
    file = SCHEMAS / (format_name.removeprefix("kinship.").replace("/", "-") + ".schema.json")
    if not format_name.startswith("kinship.") or not file.exists():
        raise AssertionError(f"'{format_name}' has no schema: there is no {file}")
    schema = json.loads(file.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def check_document(document, what: str = "") -> str:
    """Returns its format. Raises AssertionError that says what is wrong where."""
    if not isinstance(document, dict) or next(iter(document), None) != "format":
        raise AssertionError(f"{what}: the first member is not \"format\": {str(document)[:200]}")
    faults = [f"{error.json_path}: {error.message[:500]}" for error in validator_of(document["format"]).iter_errors(document)]
    if faults:
        raise AssertionError(f"{what}: is no {document['format']}: " + "; ".join(faults[:5]))
    return document["format"]


def check_text(text: str, what: str = "") -> "list[str]":
    """One document, or one a line. Returns the format of each. Raises AssertionError also if there is none."""
    try:
        documents = [json.loads(text)]
    except ValueError:
        documents = [json.loads(line) for line in text.splitlines()]
    if not documents:
        raise AssertionError(f"{what}: no document")
    return [check_document(document, what) for document in documents]
