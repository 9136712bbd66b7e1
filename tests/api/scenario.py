"""Helpers of the tests of clients: the scenario that each client runs (clients/scenario.json), and
a busy daemon."""
import contextlib
import http.server
import json
import pathlib
import threading
import time

CLIENTS = pathlib.Path(__file__).resolve().parents[2] / "clients"
STEPS = json.loads((CLIENTS / "scenario.json").read_text())["steps"]


def check(test, answer, expected, where=""):
    """Asserts that the answer has all expected members with the expected values."""
    if isinstance(expected, dict):
        for name, value in expected.items():
            test.assertIn(name, answer, where)
            check(test, answer[name], value, f"{where}/{name}")
    elif isinstance(expected, list):
        test.assertEqual(len(answer), len(expected), where)
        for index, value in enumerate(expected):
            check(test, answer[index], value, f"{where}/{index}")
    elif isinstance(expected, float):
        test.assertAlmostEqual(answer, expected, delta=1e-12 * abs(expected), msg=where)
    else:
        test.assertEqual(answer, expected, where)


class Busy(http.server.BaseHTTPRequestHandler):
    """Answers the first requests with the refusals in the server's `answers`."""
    protocol_version = "HTTP/1.1"

    def do_GET(self):
        self.rfile.read(int(self.headers.get("Content-Length", 0)))
        status, header, body = self.server.answers.pop(0) if self.server.answers else (200, {}, {"version": "1"})
        self.server.seen.append(time.monotonic())
        self.server.paths.append(self.path)
        self.server.keys.append(self.headers.get("Authorization"))
        self.server.codings.append(self.headers.get("Accept-Encoding"))
        if status == 0:  # the status 0 closes the connection without an answer
            self.close_connection = True
            return
        text = body if isinstance(body, bytes) else json.dumps(body).encode()
        self.send_response(status)
        for name, value in {"Content-Length": len(text), **header}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(text)

    do_POST = do_PUT = do_DELETE = do_GET

    def log_message(self, *_):
        pass


@contextlib.contextmanager
def busy(*answers):
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Busy)
    server.answers, server.seen, server.paths, server.keys, server.codings = list(answers), [], [], [], []
    server.handle_error = lambda *_: None  # ignores clients that have disconnected
    # serve_forever looks for the end in this interval of seconds
    threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
    try:
        yield server, "http://127.0.0.1:%d" % server.server_address[1]
    finally:
        server.shutdown()
        server.server_close()
