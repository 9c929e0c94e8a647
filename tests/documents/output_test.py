"""Words of an output count, numbers do not."""
import unittest

from output import match, normalised


class Outputs(unittest.TestCase):
    def test_that_differ_in_numbers_are_the_same(self):
        for one, other in [
                ("solved 12 of 24", "solved   9 of 24"), ("took 812 ms", "took 1.2 s"), ("-0.1 1e-05", "3 0"),
                ("id 3f9a0c11", "id 44120991"), ("12 % (-3)", "9 % (2.5)"), ("------ -", "--- -"),
                ("at 2026-11-25 10:00:01", "at 2025-01-01 09:00:00"), ("checks  2 306  0.1", "checks  812  0.1"),
                ("a  1.93  chosen", "a  0.9"), ("2.23  2.26*", "2.23*  2.26"),
                ("7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55", "00112233-4455-6677-8899-aabbccddeeff")]:
            self.assertEqual(normalised(one), normalised(other))

    def test_that_differ_in_words_are_not(self):
        for one, other in [("solved 1", "failed 1"), ("joint_1", "joint_2"), ("ur10e", "ur5e"), ("facade", "deface"),
                           ("12 checks", "checks"), ("1  2", "1")]:
            self.assertNotEqual(normalised(one), normalised(other))

    def test_dots_stand_for_lines_and_for_the_rest_of_one(self):
        lines = ["a", "b", "c", "d"]
        self.assertEqual(match(["a", "...", "d"], lines), [0, None, 3])
        self.assertEqual(match(["...", "c", "..."], lines), [None, 2, None])
        self.assertEqual(match(["a", "...", "b", "c", "d"], lines), [0, None, 1, 2, 3])
        self.assertEqual(match(["...", "x"], lines), None)
        self.assertEqual(match(["a", "b", "c"], lines), None)
        self.assertEqual(match(lines + ["e"], lines), None)
        self.assertEqual(match(["wait..."], ["wait for 3 s"]), [0])
        self.assertEqual(match(["wait..."], ["go"]), None)
        self.assertEqual(match([], []), [])


if __name__ == "__main__":
    unittest.main()
