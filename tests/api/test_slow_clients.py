"""Tests clients that are deliberately slow, and large numbers of clients. Deadlines and limits end
their connections, while other clients are served."""
import concurrent.futures
import socket
import time
import unittest

from harness import PATIENCE_SECONDS, Daemon, TestCase, wait_until
from test_hostile import CHUNKED, GET, PUT


class Slow(TestCase):
    """Tests clients that send single bytes and make no progress. Absolute deadlines end their
    connections. All tests run at the same time."""

    flags = ("--http-threads", "1")

    def drip(self, start, byte, interval):
        """Sends `start`, and then one byte at each interval. Returns the seconds until the daemon
        closes the connection."""
        with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=PATIENCE_SECONDS) as connection:
            started = time.monotonic()
            connection.sendall(start)
            connection.settimeout(interval)
            while time.monotonic() - started < 50:
                try:
                    if not connection.recv(4096):
                        break
                except TimeoutError:
                    pass
                except ConnectionError:
                    break
                try:
                    connection.sendall(byte)
                except ConnectionError:
                    break
            return time.monotonic() - started

    def test_slow_clients(self):
        clients = {
            "a request line": (b"GET /", b"a", 1),
            "headers": (GET + b"X: ", b"y", 1),
            "many headers": (GET, b"X: y\r\n", 2),
            "the second request": (b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\nG", b"E", 1),
            "empty lines": (b"\r", b"\n", 60),
            "silence": (b"", b"", 60),
            "a body": (PUT + b"Content-Length: 60000\r\n\r\n", b"v", 1),
            "chunks": (PUT + CHUNKED + b"\r\n", b"1\r\nv\r\n", 1),
        }
        with concurrent.futures.ThreadPoolExecutor(len(clients) * 8) as pool:
            asked = {name: [pool.submit(self.drip, *client) for _ in range(8)] for name, client in clients.items()}
            times = {name: [future.result() for future in futures] for name, futures in asked.items() if time.sleep(0.01) is None}
        for name, seconds in times.items():
            self.assertLess(max(seconds), 40, name)
            if name != "the second request":
                self.assertGreater(min(seconds), 25, name)
        self.assertGreaterEqual(self.daemon.metric("connections_cut_total"), 24)
        wait_until(lambda: self.daemon.metric("connections") <= 1)

    def test_other_clients_are_served(self):
        crowd = [socket.create_connection(("127.0.0.1", self.daemon.port)) for _ in range(200)]
        for connection in crowd:
            connection.sendall(GET + b"X: ")
        started = time.monotonic()
        for _ in range(100):
            self.assertEqual(self.daemon.get("/livez").status, 200)
        self.assertLess(time.monotonic() - started, 5)
        for connection in crowd:
            connection.close()


def is_closed(connection):
    try:
        return connection.recv(1, socket.MSG_PEEK) == b""
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


class Crowds(unittest.TestCase):
    def test_connections_of_one_address(self):
        with Daemon("--max-address-connections", "10") as daemon:
            crowd = [socket.create_connection(("127.0.0.1", daemon.port), timeout=PATIENCE_SECONDS) for _ in range(10)]
            for connection in crowd:
                connection.sendall(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n")
                self.assertTrue(connection.recv(4096).startswith(b"HTTP/1.1 200 "))
            with socket.create_connection(("127.0.0.1", daemon.port), timeout=PATIENCE_SECONDS) as one_too_many:
                try:
                    one_too_many.sendall(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n")
                    self.assertEqual(one_too_many.recv(4096), b"")
                except ConnectionError:
                    pass
            with socket.create_connection(("127.0.0.1", daemon.port), source_address=("127.0.0.2", 0), timeout=PATIENCE_SECONDS) as other:
                other.sendall(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n")
                self.assertTrue(other.recv(4096).startswith(b"HTTP/1.1 200 "))
            for connection in crowd:
                connection.close()
            until = time.monotonic() + PATIENCE_SECONDS
            while True:
                try:
                    if daemon.get("/livez").status == 200:
                        break
                except (ConnectionError, OSError):
                    self.assertLess(time.monotonic(), until)

    def test_connections_of_all(self):
        """If the limit of connections is reached, a new client waits until another client
        disconnects."""
        with Daemon("--max-connections", "4", "--max-address-connections", "0", "--http-threads", "1") as daemon:
            crowd = [socket.create_connection(("127.0.0.1", daemon.port), timeout=PATIENCE_SECONDS) for _ in range(4)]
            for connection in crowd:
                connection.sendall(PUT + b"Content-Length: 60000\r\n\r\nv")
            with socket.create_connection(("127.0.0.1", daemon.port), timeout=1) as waiting:
                waiting.sendall(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n")
                with self.assertRaises(TimeoutError):
                    waiting.recv(4096)
                crowd.pop().close()
                waiting.settimeout(PATIENCE_SECONDS)
                self.assertTrue(waiting.recv(4096).startswith(b"HTTP/1.1 200 "))
            for connection in crowd:
                connection.close()

    def test_one_address_leaves_connections_to_others(self):
        with Daemon("--max-connections", "40", "--http-threads", "1") as daemon:
            crowd = []
            for _ in range(40):
                crowd.append(socket.create_connection(("127.0.0.1", daemon.port), timeout=PATIENCE_SECONDS))
                crowd[-1].sendall(PUT + b"Content-Length: 60000\r\n\r\nv")
                crowd[-1].setblocking(False)
            wait_until(lambda: sum(1 for connection in crowd if is_closed(connection)) >= 10)
            with socket.create_connection(("127.0.0.1", daemon.port), source_address=("127.0.0.2", 0), timeout=PATIENCE_SECONDS) as other:
                other.sendall(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n")
                self.assertTrue(other.recv(4096).startswith(b"HTTP/1.1 200 "))
            for connection in crowd:
                connection.close()


if __name__ == "__main__":
    unittest.main()
