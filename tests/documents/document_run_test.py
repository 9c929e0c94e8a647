"""A document whose commands fail, print something else, or are run by nobody does not pass."""
import pathlib
import tempfile
import unittest

from document_run import DocumentRun
from markdown import Document


class Runs(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.path = pathlib.Path(folder) / "operations.md"  # the programs are in its PATH

    def failures(self, text, is_written=False, with_packages=False):
        self.path.write_text(text, encoding="utf-8")
        with DocumentRun(Document(self.path), is_written, with_packages) as run:
            run.run()
        if is_written:
            run.write()
        return run.failures

    def test_commands_share_a_shell_and_the_folder_of_the_repository(self):
        self.assertEqual(self.failures(
            "```console\n$ x=3; cd deploy\n```\n\n```console\n$ echo $x; ls etc/kinshipd.toml\n3\netc/kinshipd.toml\n```\n"), [])

    def test_another_output_is_a_failure_with_its_line(self):
        (failure,) = self.failures("text\n\n```console\n$ true\n$ echo solved 3\nfailed 3\n```\n")
        self.assertRegex(failure, r"(?s)operations.md:5: \$ echo.*-failed #\n\+solved #")

    def test_an_output_that_is_not_shown_is_a_failure(self):
        self.assertEqual(len(self.failures("```console\n$ echo out\n```\n")), 1)

    def test_a_command_that_fails_is_the_last(self):
        (failure,) = self.failures("```console\n$ (exit 3)\n$ touch no\nnothing\n```\n")
        self.assertRegex(failure, "operations.md:2: .*\n.*exit code 3, not 0")
        self.assertEqual(self.failures("<!-- exit code 3 -->\n```console\n$ true\n$ (exit 3)\n```\n"), [])

    def test_nothing_may_pass_for_a_command_that_is_run(self):
        for text in ("```\nkinship status\n```\n", "```sh\n$ kinship status\n```\n", "    kinship status\n",
                     "```console\nkinship status\n```\n", "<!-- not run -->\n```console\n$ kinship status\n```\n",
                     "<!-- not run in the tests: -->\n```console\n$ kinship status\n```\n"):
            self.assertEqual(len(self.failures(text)), 1, text)

    def test_readers_of_sources_and_of_packages_have_blocks_of_their_own(self):
        text = "<!-- with the sources -->\n```console\n$ ls -d deploy\ndeploy\n```\n\n<!-- with the packages -->\n```console\n$ ls -A\n$ echo no\n```\n"
        self.assertIn("operations.md:9", self.failures(text)[0])  # nobody runs this document with packages: all of it is run
        self.path = self.path.with_name("tutorial.md")
        self.assertEqual(self.failures(text), [])
        (failure,) = self.failures(text, with_packages=True)  # there is nothing in the folder
        self.assertIn("tutorial.md:10", failure)

    def test_what_stays_runs_beside_and_is_told_as_a_reader_has_it(self):
        beside = "<!-- in a terminal of its own -->\n```console\n$ kinshipd --store a.db\n...\nready domain=0 store=a.db\n```\n"
        self.assertEqual(self.failures(beside + "\n```console\n$ kinship robots list\n(none)\n```\n"), [])
        failures = self.failures("<!-- in a terminal of its own -->\n```console\n$ echo no\nready\n```\n")
        self.assertRegex(failures[0], r"-ready\n\+no")

    def test_what_stays_can_be_interrupted(self):
        beside = "<!-- in a terminal of its own -->\n```console\n$ bash -c 'trap \"touch ended; exit %d\" INT; echo on; while :; do sleep 0.1; done'\non\n```\n"
        interrupt = "\n<!-- in that terminal -->\n```console\n^C\n```\n\n```console\n$ ls ended\nended\n```\n"
        self.assertEqual(self.failures(beside % 0 + interrupt), [])
        (failure,) = self.failures(beside % 4 + interrupt)
        self.assertRegex(failure, "exit code 4 of what was interrupted")

    def test_json_is_compared_as_json(self):
        text = "<!-- the first line of: echo '[1, 2]' -->\n```json\n[1,\n %s]\n```\n"
        self.assertEqual(self.failures(text % 2), [])
        self.assertEqual(len(self.failures(text % 3)), 1)

    def test_outputs_can_be_written(self):
        self.assertEqual(self.failures("```console\n$ echo a; echo 5\nb\n$ seq 7 9\n...\n1\n```\nend\n", True), [])
        self.assertEqual(self.path.read_text(encoding="utf-8"),
                         "```console\n$ echo a; echo 5\na\n5\n$ seq 7 9\n...\n9\n```\nend\n")


if __name__ == "__main__":
    unittest.main()
