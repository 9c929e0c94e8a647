"""A page in headless Chromium for tests in Python: load it, click, wait for a condition, look at the picture.

What the page's programs throw or log as an error fails the test that did it, see Browser.check_console.
"""
import base64
import io
import pathlib
import tempfile
import unittest

import numpy as np
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

_FLAGS = ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", "--disable-quic",
          "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
          "--disable-extensions", "--disable-default-apps", "--force-color-profile=srgb")
_WEBGL = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
_NO_WEBGL = ("--disable-gpu", "--disable-3d-apis")
_PATIENCE_S = 120  # WebGL without a graphics card, beside other tests


class Browser:
    """One Chromium with a profile of its own, which goes with it. Use it in a `with`."""

    def __init__(self, width: int = 1280, height: int = 900, webgl: bool = True):
        self._profile = tempfile.TemporaryDirectory(prefix="kinship-browser-")
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for flag in _FLAGS + (_WEBGL if webgl else _NO_WEBGL):
            options.add_argument(flag)
        options.add_argument(f"--user-data-dir={self._profile.name}")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.driver.set_script_timeout(_PATIENCE_S)
        self.driver.set_page_load_timeout(_PATIENCE_S)
        self.resize(width, height)

    def __enter__(self) -> "Browser":
        return self

    def __exit__(self, *exception) -> None:
        self.driver.quit()
        self._profile.cleanup()

    def load(self, page: pathlib.Path) -> None:
        """Opens a file; its programs have run when this returns."""
        self.driver.get(page.resolve().as_uri())

    def resize(self, width: int, height: int, scale: float = 1) -> None:
        """The inside of the window, in CSS pixels; returns when the page has laid itself out anew."""
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": scale, "mobile": False})
        self.settle()

    def prefer(self, scheme: str = "light", reduced_motion: bool = False) -> None:
        """What the reader's system asks for."""
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
            {"name": "prefers-color-scheme", "value": scheme},
            {"name": "prefers-reduced-motion", "value": "reduce" if reduced_motion else "no-preference"}]})
        self.settle()

    def settle(self) -> None:
        """Returns when the browser has drawn twice: what resizing or a click brought about is there."""
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));")

    def run(self, script: str, *arguments):
        """What a script `return`s."""
        return self.driver.execute_script(script, *arguments)

    def element(self, selector: str):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def elements(self, selector: str) -> list:
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def text(self, selector: str) -> str:
        return self.element(selector).text

    def click(self, selector: str) -> None:
        """As a reader does: brings it into view; fails if something lies over it."""
        element = self.element(selector)
        self.run("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", element)
        element.click()
        self.settle()

    def press(self, selector: str, *keys: str) -> None:
        """Types into an element, which gets the focus."""
        self.element(selector).send_keys(*keys)
        self.settle()

    def wheel(self, selector: str, down: int) -> None:
        """Turns the wheel over the middle of an element, by pixels."""
        place = self.run("const r = arguments[0].getBoundingClientRect();"
                         "return [r.x + r.width / 2, r.y + r.height / 2]", self.element(selector))
        self.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
            "type": "mouseWheel", "x": place[0], "y": place[1], "deltaX": 0, "deltaY": down})
        self.settle()

    def wait(self, condition: str, seconds: float = _PATIENCE_S):
        """Waits until a JavaScript expression is true. \return  its value."""
        return WebDriverWait(self.driver, seconds, poll_frequency=0.05).until(
            lambda driver: driver.execute_script(f"return {condition}"), f"never true: {condition}")

    def picture(self, selector: "str | None" = None) -> np.ndarray:
        """What is seen of the window, or of one element brought into view: height x width x 3, 0 to 255."""
        if selector is None:
            png = self.driver.get_screenshot_as_png()
        else:
            element = self.element(selector)
            self.run("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", element)
            self.settle()
            png = element.screenshot_as_png
        return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))

    def save_page(self, file: pathlib.Path) -> None:
        """The whole page as a PNG, for people to look at."""
        size = self.driver.execute_cdp_cmd("Page.getLayoutMetrics", {})["cssContentSize"]
        png = self.driver.execute_cdp_cmd("Page.captureScreenshot", {
            "captureBeyondViewport": True,
            "clip": {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}})
        pathlib.Path(file).write_bytes(base64.b64decode(png["data"]))

    def console_errors(self) -> "list[str]":
        """What went wrong since this was asked last: exceptions, errors, what the page was forbidden to load."""
        return [entry["message"] for entry in self.driver.get_log("browser")
                if entry["level"] == "SEVERE" and "favicon" not in entry["message"]]

    def check_console(self, test) -> None:
        """For a unittest's tearDown: fails the test if the console holds errors."""
        test.assertEqual(self.console_errors(), [], "errors in the browser's console")


class BrowserTest(unittest.TestCase):
    """Tests of pages by one browser for all of a class; each begins in the same window, and fails by errors in the console.
    Files are pages of `folder`, which a class sets."""

    folder = pathlib.Path()

    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Browser())

    def setUp(self):
        self.browser.resize(1280, 900)
        self.browser.prefer("light")

    def tearDown(self):
        self.browser.check_console(self)

    def load(self, page: str) -> dict:
        """\return  the data that the page carries."""
        self.browser.load(self.folder / page)
        self.browser.settle()
        return self.browser.run("return kinshipPage.data")


def pixels_of(picture: np.ndarray, color: "tuple[int, int, int]", tolerance: int = 24) -> int:
    """How many pixels have about this colour, each of red, green and blue within the tolerance."""
    return int((np.abs(picture.astype(int) - np.array(color)).max(axis=2) <= tolerance).sum())


def drawn(picture: np.ndarray, tolerance: int = 8) -> np.ndarray:
    """Which pixels are not background, the colour of most: height x width."""
    colors, counts = np.unique(picture.reshape(-1, 3), axis=0, return_counts=True)
    background = colors[counts.argmax()].astype(int)
    return np.abs(picture.astype(int) - background).max(axis=2) > tolerance


def share_drawn(picture: np.ndarray) -> float:
    """Of the pixels that are not background, 0 to 1: a blank region has 0."""
    return float(drawn(picture).mean())


def touches_border(picture: np.ndarray, inset: int = 4, corner: int = 16) -> bool:
    """Whether something is drawn at the picture's edges, as what is cropped would be; `inset` pixels are its frame, which
    has round corners."""
    there = drawn(picture)[inset:-inset, inset:-inset]
    return bool(np.concatenate([there[0, corner:-corner], there[-1, corner:-corner], there[corner:-corner, 0],
                                there[corner:-corner, -1]]).any())
