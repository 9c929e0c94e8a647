"""Pinned documents are of their schemas, and each schema is one."""
import json
import os
import pathlib
import re
import unittest

from schemas import SCHEMAS, check_document, validator_of

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
PINS = SOURCE / "tests" / "golden" / "pins" / "json"


class PinnedDocuments(unittest.TestCase):
    def test_each_is_of_its_schema(self):
        for pin in sorted(PINS.glob("*.txt")):
            document = json.loads(pin.read_text(encoding="utf-8").split("\n", 1)[0])
            if pin.stem != "explanation":  # a row, which has no format by itself
                check_document(document, pin.name)

    def test_each_row_is_of_the_schema_of_its_listing_or_document(self):
        found = 0
        for pin in sorted((PINS / "rows").glob("*.txt")):
            row = json.loads(pin.read_text(encoding="utf-8").split("\n", 1)[0])
            name = pin.stem.replace("_", "-")
            for format_name, document in ((f"kinship.{name}-list/1", {"rows": [row]}), (f"kinship.{name}/1", row)):
                if (SCHEMAS / (format_name.removeprefix("kinship.").replace("/", "-") + ".schema.json")).exists() and (
                        "rows" in document or name not in ("attempt", "distribution")):  # these are documents of their own
                    check_document({"format": format_name} | document, pin.name)
                    found += 1
        self.assertGreaterEqual(found, 15)

    def test_a_member_that_is_missing_or_unknown_is_no_document(self):
        document = json.loads((PINS / "problem.txt").read_text(encoding="utf-8").split("\n", 1)[0])
        for wrong in (document | {"extra": 1}, {name: value for name, value in document.items() if name != "start"},
                      document | {"scene": {"boxs": []}}):
            with self.assertRaises(AssertionError):
                check_document(wrong)


class Schemas(unittest.TestCase):
    def test_each_is_a_schema_named_by_its_format_and_described_in_FORMATS(self):
        told = (SOURCE / "proto" / "FORMATS.md").read_text(encoding="utf-8")
        for file in sorted(SCHEMAS.iterdir()):
            name, version = re.fullmatch(r"([a-z-]+)-([0-9]+)\.schema\.json", file.name).groups()
            schema = json.loads(file.read_text(encoding="utf-8"))
            self.assertEqual(schema["properties"]["format"], {"const": f"kinship.{name}/{version}"}, file.name)
            self.assertFalse(schema["additionalProperties"], file.name)
            validator_of(schema["title"])
            self.assertIn(f"`{name}`", told, file.name)


if __name__ == "__main__":
    unittest.main()
