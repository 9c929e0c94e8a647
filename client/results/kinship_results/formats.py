"""The first member of every document that Kinship writes: {"format": "kinship.NAME/VERSION", ...} (proto/FORMATS.md)."""
import re
from typing import Any

VERSION = 1  # of every format here


def in_format(name: str, document: dict[str, Any]) -> dict[str, Any]:
    """The document with its format in front."""
    return {"format": f"kinship.{name}/{VERSION}"} | document


def checked(document: Any, *names: str) -> Any:
    """The document, if it is of one of the formats or names none. Raises ValueError that names both if not, or if it is of a later version."""
    given = document.get("format") if isinstance(document, dict) else None
    if given is None:
        return document
    known = " or ".join(f"'kinship.{name}/{VERSION}'" for name in names)
    parts = re.fullmatch(r"kinship\.([a-z-]+)/([1-9][0-9]*)", given) if isinstance(given, str) else None
    if not parts or parts[1] not in names:
        raise ValueError(f"format: '{given}' is not {known}")
    if int(parts[2]) > VERSION:
        raise ValueError(f"format: '{given}' is newer than {known}, the newest that this program reads")
    return document
