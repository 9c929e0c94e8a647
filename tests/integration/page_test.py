"""The quickstart's page in a browser: a small real run of deploy/quickstart, clicked through and looked at."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from selenium.webdriver.common.keys import Keys

from browser import Browser, pixels_of, share_drawn, touches_border
from kinshipd_process import reserve_domain

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
INSTANCES = 4
CANVASES = ("#station-figure canvas", "[data-search=uniform] canvas", "[data-search=guided] canvas", "#samples-figure canvas")
# Of page.css, light.
PANDA, HELD, PATH = (47, 111, 222), (201, 146, 46), (217, 115, 13)


def run_quickstart(folder: pathlib.Path) -> None:
    domain, claim = reserve_domain()
    with claim:
        subprocess.run([SOURCE / "deploy" / "quickstart", "--no-build", "--fleet", "4", "--instances", str(INSTANCES),
                        "--folder", folder, "--domain", str(domain)], check=True, capture_output=True,
                       env={**os.environ, "KINSHIP_BIN": os.environ["KINSHIP_BIN_DIR"]})


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory())) / "run"
        run_quickstart(cls.folder)
        cls.browser = cls.enterClassContext(Browser())
        cls.browser.load(cls.folder / "quickstart.html")

    def setUp(self):
        self.browser.prefer("light")
        self.browser.resize(1280, 900)

    def tearDown(self):
        self.browser.check_console(self)

    def scrub(self, figure: str, part: float) -> None:
        self.browser.run("const s = arguments[0]; s.value = arguments[1] * s.max;"
                         "s.dispatchEvent(new Event('input'))", self.browser.element(f"{figure} input[type=range]"), part)
        self.browser.settle()

    def checks(self, search: str) -> int:
        return int(re.sub(r"\D", "", self.browser.text(f"[data-search={search}] .count b")))

    def test_its_table_is_the_terminals(self):
        lines = (self.folder / "comparison.txt").read_text().splitlines()
        terminal = [re.split(r" {2,}", line.strip()) for line in lines[3:14]]
        page = [[cell.text for cell in row.find_elements("css selector", "th, td") if cell.text]
                for row in self.browser.elements("#comparison tbody tr")]
        self.assertEqual(page, terminal)
        tiles = self.browser.text("#tiles")
        for row in (page[1], page[3]):
            self.assertIn(row[0].removesuffix(", mean").split()[-1], tiles)
            self.assertIn(f"uniform {row[1]}, guided {row[2]}", tiles.replace("\u202f", " "))
        self.assertIn("ms of a processor", self.browser.element("#time-bars").get_attribute("innerHTML"))

    def test_says_what_each_guide_alone_would_bring_as_the_terminal_does(self):
        lines = (self.folder / "comparison.txt").read_text().splitlines()
        alone = [re.split(r" {2,}", line.strip()) for line in lines if " alone " in line]
        self.assertEqual([row[0] for row in alone], ["mixture alone", "ways alone", "retreat alone"])
        page = [[cell.text for cell in row.find_elements("css selector", "th, td")]
                for row in self.browser.elements("#alone-table tbody tr")]
        self.assertEqual(page, alone)

    def test_nothing_is_cropped_from_a_phone_to_a_wide_screen(self):
        for width, height in ((360, 700), (2200, 1200)):
            self.browser.resize(width, height)
            self.assertLessEqual(self.browser.run("return document.scrollingElement.scrollWidth"), width)
            for canvas in CANVASES:
                picture = self.browser.picture(canvas)
                self.assertGreater(share_drawn(picture), 0.05, canvas)
                self.assertFalse(touches_border(picture), (canvas, width))

    def test_each_robot_carries_its_part_from_start_to_goal(self):
        canvas = "#station-figure canvas"
        self.browser.click("[data-actor=panda]")
        middle = self.browser.picture(canvas)
        self.assertGreater(pixels_of(middle, PANDA, 60), 500, "the arm")
        self.scrub("#station", 0)
        self.assertEqual(self.browser.text("#station output"), "at the start")
        self.assertFalse((self.browser.picture(canvas) == middle).all())
        parts = []
        for place in (0.1, 0.3, 0.5, 0.7, 0.9):  # the arm or a wall may be before it here or there
            self.scrub("#station", place)
            parts.append(pixels_of(self.browser.picture(canvas), HELD, 40))
        self.assertGreater(max(parts), 20, f"the part on its way: {parts}")
        self.browser.click("[data-actor=ur10e]")
        self.assertLess(pixels_of(self.browser.picture(canvas), PANDA, 30), 50)
        self.assertIn("ur10e, new to the task", self.browser.text("#station .note"))
        self.browser.click("#station button[data-layer=arm]")
        self.browser.click("#station button[data-layer=arm]")

    def test_searches_grow_while_they_are_played_and_scrubbed(self):
        canvas = "[data-search=uniform] canvas"
        self.scrub("#searches", 1)
        whole = self.browser.picture(canvas)
        ends = {search: self.checks(search) for search in ("uniform", "guided")}
        self.assertIn("path found", self.browser.text("[data-search=uniform] .count"))
        self.assertGreater(pixels_of(self.browser.picture("[data-search=guided] canvas"), PATH, 60), 30, "the path")
        self.scrub("#searches", 0)
        self.assertEqual((self.checks("uniform"), self.checks("guided")), (0, 0))
        empty = self.browser.picture(canvas)
        self.assertFalse((empty == whole).all())
        trees = [f"[data-search=uniform] button[data-layer={tree}]" for tree in ("start", "goal")]
        for button in trees:
            self.browser.click(button)
        self.assertTrue((self.browser.picture(canvas) == empty).all(), "nothing of a tree has grown")
        for button in trees:
            self.browser.click(button)
        self.browser.click("#searches .player button")
        count = "Number(document.querySelector('[data-search=uniform] .count b').textContent.replace(/\\D/g, ''))"
        self.browser.wait(f"{count} > 0")
        # Where the browser is slow the search may have ended by itself: then there is nothing to pause.
        self.browser.run("const button = document.querySelector('#searches .player button');"
                         "if (button.textContent.includes('Pause')) button.click();")
        self.assertEqual(self.browser.text("#searches .player button"), "\u25b6 Play", "paused")
        self.scrub("#searches", 1)
        self.assertEqual({search: self.checks(search) for search in ends}, ends)

    def page_of(self, *words: object) -> None:
        """Loads a page of the run's folder that `kinship results page` writes with these options."""
        page = self.folder / "other.html"
        subprocess.run([pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinship", "results", "page", "--run", self.folder, "--models",
                        SOURCE / "robots" / "models", "--robot", "ur10e", "--output", page, *words], check=True)
        self.browser.load(page)

    def test_one_teacher_teaches_and_several_teach(self):
        self.addCleanup(self.browser.load, self.folder / "quickstart.html")
        self.assertIn(" teach ur10e a task", self.browser.text("#title"))
        self.page_of("--teachers", "panda")
        self.assertEqual(self.browser.text("#title"), "panda teaches ur10e a task")

    def test_what_needs_no_experience_is_not_credited_to_it(self):
        """The worth is against the best without it; a run that the retreat alone guided has no teacher."""
        self.addCleanup(self.browser.load, self.folder / "quickstart.html")
        worth = re.search(r"Worth of experience.*: ([0-9.]+) by checks, ([0-9.]+) by time", (self.folder / "comparison.txt").read_text())
        self.assertRegex(self.browser.text("#tiles").replace("\u2009", " "), rf"(?s){worth[1]} ×.*worth of the experience.* by time {worth[2]} ×")
        self.page_of("--guided", self.folder / "ur10e-retreat.results.jsonl")
        self.assertEqual(self.browser.text("#title"), "ur10e plans a task, and nobody\u2019s experience helps")
        self.assertIn("guided by what needs no experience", self.browser.text("#story"))

    def test_says_by_which_rule_its_instance_was_chosen(self):
        note = self.browser.text("#searches-note")
        self.assertRegex(note, f"of {INSTANCES} instances solved both ways its ratio of checks, [0-9.]+, is nearest the median")

    def test_can_be_used_without_a_mouse_and_be_heard(self):
        unnamed = self.browser.run(
            "return [...document.querySelectorAll('canvas, button, input, [role=img]')].filter((e) =>"
            " !e.closest('[aria-hidden=true]') && !e.getAttribute('aria-label') && !e.textContent.trim()).map((e) => e.outerHTML)")
        self.assertEqual(unnamed, [])
        button = "#samples-figure button[data-layer=samples]"
        before = self.browser.picture("#samples-figure canvas")
        self.browser.press(button, Keys.ENTER)
        self.assertEqual(self.browser.element(button).get_attribute("aria-pressed"), "false")
        self.assertFalse((self.browser.picture("#samples-figure canvas") == before).all())
        self.browser.press(button, Keys.ENTER)

    def test_speaks_in_words(self):
        words = self.browser.text("main")
        self.assertRegex(words, "chance alone would bring about")
        self.assertNotRegex(self.browser.text("#tiles"), r"\bp\b")


if __name__ == "__main__":
    unittest.main()
