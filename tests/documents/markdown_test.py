"""A document is taken apart as GitHub shows it."""
import pathlib
import tempfile
import unittest

from markdown import Document

TEXT = """# One `two`: three

See [a](b.md#c), ![d
e](f.svg) and `[no](link.md)`, `in two
lines`.

<!-- exit code 3 -->
```console
$ first \\
  --more
out
$ second
```

1. an item

       that goes on

# One two three

    indented
"""


class Parts(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.path = pathlib.Path(folder) / "text.md"

    def read(self, text):
        self.path.write_text(text, encoding="utf-8")
        return Document(self.path)

    def test_of_blocks_are_commands_with_their_output(self):
        (block,) = self.read(TEXT).blocks
        self.assertEqual((block.line, block.language, block.mark), (8, "console", "exit code 3"))
        first, second = block.commands()
        self.assertEqual((first.line, first.text, first.output, first.output_line), (9, "first \\\n  --more", ["out"], 11))
        self.assertEqual((second.line, second.text, second.output), (12, "second", []))

    def test_outside_are_links_spans_and_headings(self):
        document = self.read(TEXT)
        self.assertEqual(document.links(), [(3, "b.md#c"), (4, "f.svg")])
        self.assertEqual(document.spans(), [(1, "two"), (4, "[no](link.md)"), (4, "in two lines")])
        self.assertEqual(document.anchors(), {"one-two-three", "one-two-three-1"})

    def test_indented_code_is_found_and_items_of_lists_are_not(self):
        self.assertEqual(self.read(TEXT).indented_code(), [(21, "    indented")])

    def test_a_block_without_an_end_is_refused(self):
        with self.assertRaisesRegex(ValueError, "text.md:3"):
            self.read("a\n\n```console\n$ b\n")


if __name__ == "__main__":
    unittest.main()
