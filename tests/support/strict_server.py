"""A page of ours as a server with a strict Content-Security-Policy would send it: its styles and programs as files, no inline code."""
import functools
import http.server
import pathlib
import re
import threading


class StrictServer:
    """Serves a folder at a free port of loopback under `default-src 'self'`. Use it in a `with`."""

    def __init__(self, folder: pathlib.Path):
        class Handler(http.server.SimpleHTTPRequestHandler):
            def end_headers(self):
                self.send_header("Content-Security-Policy", "default-src 'self'")
                super().end_headers()

            def log_message(self, *arguments):
                pass

        self._server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=folder))
        self._thread = threading.Thread(target=self._server.serve_forever)
        self.address = f"http://127.0.0.1:{self._server.server_address[1]}"

    def __enter__(self) -> "StrictServer":
        self._thread.start()
        return self

    def __exit__(self, *exception) -> None:
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()


def taken_apart(page: pathlib.Path, folder: pathlib.Path) -> None:
    """Writes a self-contained page as index.html with its styles and programs in files beside it."""
    html = re.sub(r"<meta http-equiv[^>]*>", "", page.read_text())
    files = iter(range(1000))

    def moved(match: "re.Match") -> str:
        kind, text = match.groups()
        name = f"part{next(files)}.{'css' if kind == 'style' else 'js'}"
        (folder / name).write_text(text)
        return f'<link rel="stylesheet" href="{name}">' if kind == "style" else f'<script src="{name}"></script>'

    (folder / "index.html").write_text(re.sub(r"<(style|script)>\n(.*?)\n</\1>", moved, html, flags=re.S))
