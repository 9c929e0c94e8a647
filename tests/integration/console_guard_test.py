"""What the console of a real kinshipd keeps out, what it lets change, what it costs, and how it is served to other hosts."""
import contextlib
import http.client
import json
import os
import pathlib
import re
import resource
import socket
import sqlite3
import ssl
import statistics
import subprocess
import threading
import time
import unittest

from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

from browser import Browser
from kinshipd_process import Kinshipd
from served_console import MODELS, Reports, ServedConsole, attempt


def processor_time_s(pid: int) -> float:
    """Of all threads that live, to the nanosecond."""
    return sum(int(file.read_text().split()[0]) for file in pathlib.Path(f"/proc/{pid}/task").glob("*/schedstat")) / 1e9


class Guard(unittest.TestCase):
    """What the console keeps out. A browser's part of it is in the browser, here are its requests."""

    @classmethod
    def setUpClass(cls):
        cls.console = ServedConsole()
        cls.addClassCleanup(cls.console.close)

    def status(self, path: str = "/api/rows/status", **fields: str) -> int:
        return self.console.ask(path, **fields).status

    def test_without_the_token_nothing_is_told(self):
        self.assertEqual(self.status(), 200)
        for cookie in ("", "kinship-console=" + self.console.token, self.console.cookie + "0", self.console.cookie[:-1]):
            for path in ("/", "/assets/console.js", "/api/rows/status", "/api/events", "/api/figures/slow/24"):
                self.assertEqual(self.status(path, Cookie=cookie), 401, path)
        self.assertEqual(self.status("/?token=" + "0" * 64, Cookie=""), 403)

    def test_a_name_that_was_made_to_lead_here_is_not_served(self):
        port = self.console.host.split(":")[1]
        self.assertEqual(self.status(Host="localhost:" + port), 200)
        for host in ("evil.example", "evil.example:" + port, "127.0.0.1.evil.example"):
            self.assertEqual(self.status(Host=host), 421, host)

    def test_other_pages_are_not_answered(self):
        self.assertEqual(self.status(Sec_Fetch_Site="same-site", Sec_Fetch_Mode="no-cors"), 403)
        self.assertEqual(self.status(Sec_Fetch_Site="cross-site", Sec_Fetch_Mode="cors"), 403)
        self.assertEqual(self.status("/", Sec_Fetch_Site="cross-site", Sec_Fetch_Mode="navigate"), 200)

    def test_every_reply_has_the_policy(self):
        for path in ("/", "/api/rows/status", "/api/nothing", "/assets/console.js"):
            for cookie in (self.console.cookie, ""):
                reply = self.console.ask(path, Cookie=cookie)
                self.assertTrue(reply.headers["Content-Security-Policy"].startswith("default-src 'self'; "), path)
                self.assertNotIn("unsafe", reply.headers["Content-Security-Policy"])
                self.assertIsNone(reply.headers["Access-Control-Allow-Origin"])
        cookie = self.console.ask("/?token=" + self.console.token, Cookie="").headers["Set-Cookie"]
        self.assertIn("; HttpOnly; SameSite=Strict;", cookie)

    def test_token_and_link_are_for_their_owner(self):
        store = self.console.server.folder / "store.db"
        for ending in (".console", ".console-token"):
            self.assertEqual(pathlib.Path(str(store) + ending).stat().st_mode & 0o777, 0o600, ending)

    def test_a_thousand_connections_shut_nobody_out(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
        listener = self.console.stream()
        self.assertIn(b"200 OK", listener.recv(100))
        address, port = self.console.host.split(":")
        held = [socket.create_connection((address, int(port)), timeout=30) for _ in range(1000)]
        try:
            self.assertEqual(self.status(), 200)
            self.assertGreater(len(listener.recv(100_000)), 0)
            self.assertLess(len(list(pathlib.Path(f"/proc/{self.console.server.pid}/fd").iterdir())), 400)
        finally:
            for each in [*held, listener]:
                each.close()

    def test_ten_open_pages_cost_little_while_robots_report(self):
        """Two hundred reports a second, with and without ten pages that listen, by turns, as what else runs makes both dearer."""
        self.console.kinship("robots", "register", str(MODELS / "panda"))
        def share_of_a_core() -> float:
            begin, time_s = time.monotonic(), processor_time_s(self.console.server.pid)
            time.sleep(4)
            return (processor_time_s(self.console.server.pid) - time_s) / (time.monotonic() - begin)

        def with_pages() -> float:
            listeners = [self.console.stream() for _ in range(10)]
            read = [0] * len(listeners)

            def drain(i: int) -> None:
                while text := listeners[i].recv(100_000):
                    read[i] += text.count(b"event: status")

            readers = [threading.Thread(target=drain, args=(i,)) for i in range(len(listeners))]
            for reader in readers:
                reader.start()
            try:
                return share_of_a_core()
            finally:
                for listener, reader in zip(listeners, readers):
                    listener.shutdown(socket.SHUT_RDWR)
                    reader.join()
                    listener.close()
                self.assertGreaterEqual(min(read), 3)

        with Reports(self.console.give, 200):
            time.sleep(2)  # until they come evenly
            shares = [(with_pages(), share_of_a_core()) for _ in range(4)]
        paged, bare = (statistics.median(each) for each in zip(*shares))
        print(f"200 reports a second: {100 * paged:.2f} % of a core with ten open pages, {100 * bare:.2f} % without")
        self.assertGreater(int(json.loads(self.console.kinship("status", "--json"))["attempts"]), 4000)
        self.assertLess(paged - bare, 0.01)


class Changes(unittest.TestCase):
    def test_are_confirmed_by_the_name_typed(self):
        console = ServedConsole("--console-admin")
        self.addCleanup(console.close)
        console.kinship("robots", "register", str(MODELS / "panda"))
        console.give([attempt("panda", 1, task="old")])
        own = {"Origin": "http://" + console.host, "Content_Type": "application/json"}

        def reset(confirm: str, **fields: str) -> int:
            return console.ask("/api/rows/reset_task", "POST", json.dumps({"argument": "old", "confirm": confirm}), **{**own, **fields}).status

        self.assertEqual(reset("old", Origin="http://evil.example"), 403)
        self.assertEqual(reset("old", Origin=""), 403)
        self.assertEqual(reset("old", Content_Type="text/plain"), 400)
        self.assertEqual(reset("other"), 400)
        self.assertEqual(console.ask("/api/rows/reset_task?argument=old").status, 405)
        self.assertEqual([row["outcome"] for row in console.rows("audit")], [])
        with Browser() as browser:
            self.let_in(browser, console)
            browser.driver.get(f"http://{console.host}/tasks/old")
            browser.wait("document.querySelector('main[data-ready]')")
            browser.click(".grave")
            go = "dialog .grave"
            browser.press("dialog input", "ol")
            self.assertFalse(browser.element(go).is_enabled())
            browser.press("dialog input", "d")
            browser.click(go)
            browser.wait("!document.querySelector('dialog')")
            browser.check_console(self)
        self.assertEqual([(row["name"], row["verb"], row["target"]) for row in console.rows("audit")][-1], ("console", "reset_task", "old"))

    def test_what_may_be_changed_is_on_its_page(self):
        console = ServedConsole()
        self.addCleanup(console.close)
        console.server.stop()
        self.grow(console.server.folder / "store.db", 200_000_000)  # so that a backup takes a while
        backups = console.server.folder / "backups"
        backups.mkdir()
        console.serve("--console-admin", "--backup-folder", str(backups))
        console.kinship("robots", "register", str(MODELS / "panda"))
        path = attempt("panda", 1, task="old")
        console.give([path])
        with Browser() as browser:
            self.let_in(browser, console)
            self.change(browser, console, f"/paths/{path['report_uuid']}", ".page > .tools .grave", path["report_uuid"])
            browser.wait("document.querySelector('main').dataset.ready === location.pathname")
            self.assertGreater(console.rows("paths", "list")[0]["retired_ms"], 0)
            jobs = [json.loads(console.kinship("backup", f"{day}.db", "--no-wait", "--json"))["id"] for day in ("monday", "tuesday", "wednesday", "thursday", "friday")]
            row = f"//table[@aria-label='Jobs']//tr[th='{jobs[-1]}']"
            self.change(browser, console, "/jobs", f"xpath:{row}//button", jobs[-1])
            browser.wait(f"document.evaluate(\"{row}/td[3]\", document, null, XPathResult.STRING_TYPE).stringValue === 'cancelled'")
            self.assertEqual(browser.run("return document.evaluate(`count(${arguments[0]}//button)`, document, null, XPathResult.NUMBER_TYPE).numberValue", row), 0)
            for job in jobs[:-1]:
                console.kinship("jobs", "cancel", job)
            browser.check_console(self)
        self.assertEqual({row["id"]: row["state"] for row in console.rows("jobs", "list")}[jobs[-1]], "cancelled")
        done = [(row["name"], row["verb"], row["target"]) for row in console.rows("audit")]
        self.assertIn(("console", "retire_path", path["report_uuid"]), done)
        self.assertIn(("console", "cancel_job", jobs[-1]), done)

    def test_undo_and_rename_are_on_their_pages(self):
        console = ServedConsole("--console-admin")
        self.addCleanup(console.close)
        console.kinship("robots", "register", str(MODELS / "panda"))
        path = attempt("panda", 1, task="old")
        console.give([path])

        def in_use() -> list:
            return [row["report_uuid"] for row in console.rows("paths", "list") if row["retired_ms"] == 0]

        with Browser() as browser:
            self.let_in(browser, console)
            pages, here = "/paths/" + path["report_uuid"], "document.querySelector('main').dataset.ready === "
            browser.driver.get(f"http://{console.host}{pages}")
            self.press(browser, "Restore this path", path["report_uuid"])
            browser.wait("document.querySelector('dialog .alarm').textContent !== ''")  # it is in use
            self.change(browser, console, pages, self.button("Retire this path"), path["report_uuid"])
            self.assertEqual(in_use(), [])
            self.change(browser, console, pages, self.button("Restore this path"), path["report_uuid"])
            restored, = in_use()
            browser.wait(f"{here}'/paths/{restored}'")
            self.change(browser, console, "/tasks/old", self.button("Retire all its paths"), "old")
            self.assertEqual(in_use(), [])
            self.change(browser, console, "/tasks/old", self.button("Restore its paths"), "old")
            self.assertEqual(len(in_use()), 1)
            browser.driver.get(f"http://{console.host}/tasks/old")
            self.press(browser, "Rename", "old", "new")
            browser.wait(f"{here}'/tasks/new'")
            self.change(browser, console, "/tasks/new", self.button("Remove"), "new")
            browser.wait(f"{here}'/tasks'")
            browser.check_console(self)
        self.assertEqual(console.rows("tasks", "list"), [])
        done = [(row["verb"], row["target"]) for row in console.rows("audit") if (row["name"], row["outcome"]) == ("console", "done")]
        self.assertIn(("restore_path", path["report_uuid"]), done)
        self.assertIn(("remove_task", "new"), done)
        self.assertEqual([verb for verb, _ in done].count("rename_task"), 1)

    def test_what_could_not_be_restored_stays_said(self):
        console = ServedConsole("--console-admin")
        self.addCleanup(console.close)
        console.kinship("robots", "register", str(MODELS / "panda"))
        console.give([attempt("panda", seed, task="old") for seed in (1, 2)])
        console.kinship("tasks", "reset", "old", "--yes")
        console.server.stop()
        with contextlib.closing(sqlite3.connect(console.server.folder / "store.db")) as database:
            database.execute("CREATE TRIGGER full BEFORE INSERT ON attempt WHEN (SELECT count(*) FROM attempt) > 2"
                             " BEGIN SELECT RAISE(ABORT, 'one is enough'); END")
            database.commit()
        console.serve("--console-admin")
        with Browser() as browser:
            self.let_in(browser, console)
            browser.driver.get(f"http://{console.host}/tasks/old")
            self.press(browser, "Restore its paths", "old")
            browser.wait("document.querySelector('dialog .alarm').textContent !== ''")
            self.assertRegex(browser.element("dialog .alarm").text, "^1 restored, 1 cannot be; the last: path .*one is enough")
            browser.check_console(self)
        self.assertEqual([row["retired_ms"] == 0 for row in console.rows("paths", "list")].count(True), 1)

    @staticmethod
    def button(text: str) -> str:
        return f"xpath://div[@class='page']/div[@class='tools']/button[.='{text} \u2026']"

    def press(self, browser: Browser, text: str, name: str, asked: str = "") -> None:
        """On the page that is shown."""
        WebDriverWait(browser.driver, 60).until(lambda driver: driver.find_elements(By.XPATH, self.button(text)[6:]))[0].click()
        if asked:
            browser.press("dialog input[aria-label='New name']", asked)
            self.assertFalse(browser.element("dialog .grave").is_enabled())
        browser.press("dialog input[aria-label^='Type ']", name)
        browser.click("dialog .grave")

    @staticmethod
    def grow(store: pathlib.Path, size: int) -> None:
        """Free pages, which a copy has too."""
        with contextlib.closing(sqlite3.connect(store)) as database:
            database.execute("CREATE TABLE padding (bytes BLOB)")
            database.execute("INSERT INTO padding VALUES (zeroblob(?))", (size,))
            database.commit()
            database.execute("DROP TABLE padding")
            database.commit()

    @staticmethod
    def let_in(browser: Browser, console: ServedConsole) -> None:
        browser.driver.get(console.link)
        browser.wait("document.querySelector('main[data-ready]')")

    def change(self, browser: Browser, console: ServedConsole, path: str, button: str, name: str) -> None:
        """Opens a page, presses a button, types the name and confirms."""
        browser.driver.get(f"http://{console.host}{path}")
        by = (By.XPATH, button[6:]) if button.startswith("xpath:") else (By.CSS_SELECTOR, button)
        WebDriverWait(browser.driver, 60).until(lambda driver: driver.find_elements(*by))[0].click()
        self.assertFalse(browser.element("dialog .grave").is_enabled())
        browser.press("dialog input", name)
        browser.click("dialog .grave")
        browser.wait("!document.querySelector('dialog')")


class Networks(unittest.TestCase):
    def test_other_networks_are_served_over_tls_alone(self):
        with Kinshipd() as server:
            program = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinshipd"
            plain = subprocess.run([program, "--store", server.folder / "none.db", "--domain", str(server.domain), "--console", "0.0.0.0:0"],
                                   capture_output=True, text=True, timeout=60)
            self.assertEqual(plain.returncode, 2)
            self.assertIn("--console '0.0.0.0:0' is not loopback, and without --security", plain.stderr)
            folder = server.folder / "security"
            subprocess.run([program, "secure", "init", folder], check=True, capture_output=True, timeout=60)
            server.start("--security", str(folder), "--console", "0.0.0.0:0", "--console-host", "cell-3.example")
            link = (server.folder / "store.db.console").read_text()
            port, token = re.fullmatch(r"https://[^/]+:(\d+)/\?token=(\w+)\n", link).groups()
            trusted = ssl.create_default_context(cafile=folder / "server" / "ca.pem")  # checks chain and name

            def shown(name: str, context: ssl.SSLContext) -> "tuple":
                with socket.create_connection(("127.0.0.1", int(port)), timeout=30) as plain, context.wrap_socket(plain, server_hostname=name) as secured:
                    return secured.getpeercert()["subjectAltName"]

            for name in ("localhost", "127.0.0.1", "cell-3.example", socket.gethostname()):
                self.assertIn(name, [value for _, value in shown(name, trusted)])
            with self.assertRaisesRegex(ssl.SSLCertVerificationError, "Hostname mismatch"):
                shown("evil.example", trusted)
            with self.assertRaisesRegex(ssl.SSLCertVerificationError, "unable to get local issuer|self.signed"):
                shown("localhost", ssl.create_default_context())
            connection = http.client.HTTPSConnection("127.0.0.1", int(port), context=trusted, timeout=30)
            connection.request("GET", "/?token=" + token)
            reply = connection.getresponse()
            self.assertEqual(reply.status, 200, reply.read())
            self.assertIn("; Secure", reply.headers["Set-Cookie"])
            connection.close()
            with socket.create_connection(("127.0.0.1", int(port)), timeout=30) as clear:
                clear.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
                self.assertNotIn(b"HTTP/1.1", clear.recv(1000))


if __name__ == "__main__":
    unittest.main()
