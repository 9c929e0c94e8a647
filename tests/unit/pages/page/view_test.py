"""What every page has, in a browser: the figure of the station (view.js), its legend, its camera, a chart."""
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
from selenium.webdriver.common.keys import Keys

from browser import Browser, drawn, pixels_of, share_drawn, touches_border

CLOUD = (184, 51, 106)  # --goal of page.css, light


def write_page(folder: str) -> pathlib.Path:
    page = pathlib.Path(folder) / "sample.html"
    program = pathlib.Path(os.environ["KINSHIP_TESTS_DIR"]) / "sample_page"
    page.write_bytes(subprocess.run([program], check=True, capture_output=True).stdout)
    return page


class View(unittest.TestCase):
    sizes = ((360, 640), (900, 340), (1280, 900), (3840, 2160))

    @classmethod
    def setUpClass(cls):
        folder = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.page = write_page(folder)
        cls.browser = cls.enterClassContext(Browser())

    def setUp(self):
        self.browser.prefer("light")
        self.browser.resize(1280, 900)
        self.browser.load(self.page)

    def tearDown(self):
        self.browser.check_console(self)

    def figure(self) -> np.ndarray:
        return self.browser.picture("#view canvas")

    def test_draws_with_webgl(self):
        self.assertTrue(self.browser.run("return Boolean(document.createElement('canvas').getContext('webgl'))"))
        self.assertGreater(share_drawn(self.figure()), 0.05)
        self.assertGreater(pixels_of(self.figure(), CLOUD), 100)

    def test_nothing_is_cropped_at_any_size_and_the_picture_is_full(self):
        for width, height in self.sizes:
            self.browser.resize(width, height)
            picture = self.figure()
            self.assertFalse(touches_border(picture), (width, height))
            rows, columns = (np.flatnonzero(drawn(picture)[4:-4, 4:-4].any(axis=axis)) for axis in (1, 0))
            filled = max((rows[-1] - rows[0]) / picture.shape[0], (columns[-1] - columns[0]) / picture.shape[1])
            self.assertGreater(filled, 0.85, (width, height))

    def test_the_legend_hides_and_shows_by_click_and_by_keyboard(self):
        button = "#view button[data-layer=cloud]"
        before = self.figure()
        self.browser.click(button)
        self.assertEqual(self.browser.element(button).get_attribute("aria-pressed"), "false")
        self.assertEqual(pixels_of(self.figure(), CLOUD), 0)
        self.browser.press(button, Keys.SPACE)
        self.assertEqual(self.browser.element(button).get_attribute("aria-pressed"), "true")
        self.assertEqual(pixels_of(self.figure(), CLOUD), pixels_of(before, CLOUD))

    def test_the_legend_does_not_lie_over_the_picture(self):
        for width in (360, 1280):
            self.browser.resize(width, 800)
            legend, stage = (self.browser.element(f"#view {part}").rect for part in (".legend", ".stage"))
            self.assertLessEqual(legend["y"] + legend["height"], stage["y"])

    def test_the_wheel_scrolls_the_page_until_the_figure_has_the_focus(self):
        before = self.figure()
        self.browser.run("window.scrollTo(0, 0)")
        self.browser.wheel("#view canvas", 200)
        self.browser.wait("window.scrollY >= 150")
        self.assertTrue((self.figure() == before).all())
        self.browser.click("#view canvas")
        there = self.browser.run("return window.scrollY")
        self.browser.wheel("#view canvas", -200)
        self.assertEqual(self.browser.run("return window.scrollY"), there)
        self.assertGreater(np.mean(self.figure() != before), 0.01, "zoomed")

    def test_keys_turn_it_and_reset_it(self):
        before = self.figure()
        self.browser.press("#view canvas", Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        self.assertGreater(np.mean(self.figure() != before), 0.01, "turned")
        self.browser.press("#view canvas", "0")
        self.browser.run("document.activeElement.blur()")
        self.browser.settle()
        self.assertLess(np.mean(self.figure() != before), 0.001)

    def test_has_a_text_for_who_does_not_see_it(self):
        self.assertEqual(self.browser.element("#view canvas").get_attribute("aria-label"), "An arm before a post")
        self.assertEqual(self.browser.element("#chart").get_attribute("aria-label"), "One bar")

    def test_a_layer_can_be_replaced_and_colours_follow_the_scheme(self):
        self.browser.run("sample.replace('cloud', {points: []})")
        self.browser.settle()
        self.assertEqual(pixels_of(self.figure(), CLOUD), 0)
        light = self.figure()
        self.browser.prefer("dark")
        dark = self.figure()
        self.assertLess(np.median(dark), 60)
        self.assertGreater(np.median(light), 200)
        self.assertGreater(pixels_of(self.browser.picture("#chart"), (63, 193, 184)), 1000, "the chart too")


class WithoutWebGl(unittest.TestCase):
    """The still drawing has all of it but what turns."""

    def test_draws_all_layers_and_hides_them(self):
        with tempfile.TemporaryDirectory() as folder, Browser(360, 640, webgl=False) as browser:
            page = write_page(folder)
            browser.load(page)
            self.assertFalse(browser.run("return Boolean(document.createElement('canvas').getContext('webgl'))"))
            picture = browser.picture("#view canvas")
            self.assertFalse(touches_border(picture))
            self.assertGreater(share_drawn(picture), 0.05)
            self.assertGreater(pixels_of(picture, CLOUD), 50)
            self.assertIn("no WebGL", browser.text("#view .hint"))
            browser.click("#view button[data-layer=cloud]")
            self.assertEqual(pixels_of(browser.picture("#view canvas"), CLOUD), 0)
            browser.check_console(self)


if __name__ == "__main__":
    unittest.main()
