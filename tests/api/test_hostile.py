"""Tests hostile HTTP: requests that two parsers could understand differently, and bodies that
expand beyond the limit. The daemon continues to answer valid requests in order on the same
connections."""
import concurrent.futures
import ctypes
import gzip
import hashlib
import io
import itertools
import json
import re
import socket
import time
import unittest
import zlib

from harness import PATIENCE_SECONDS, SQUARE, TestCase

HOST = b"Host: localhost\r\n"
GET = b"GET /v1 HTTP/1.1\r\n" + HOST
PUT = b"PUT /v1/meshes/attack HTTP/1.1\r\n" + HOST
POST = b"POST /v1/meshes/square/distance HTTP/1.1\r\n" + HOST
CHUNKED = b"Transfer-Encoding: chunked\r\n"
LAST = b"GET /livez HTTP/1.1\r\n" + HOST + b"Connection: close\r\n\r\n"
HIDDEN = b"GET /v1/meshes/smuggled HTTP/1.1\r\nHost: localhost\r\n\r\n"
LIBRARY = ctypes.CDLL("libmicrohttpd.so.12")
LIBRARY.MHD_get_version.restype = ctypes.c_char_p
# version 1.0 of the library refuses some requests before the daemon sees them
LIBRARY_REFUSES = LIBRARY.MHD_get_version() >= b"1"


def chunks(*pieces):
    return b"".join(b"%x\r\n%b\r\n" % (len(piece), piece) for piece in pieces) + b"0\r\n\r\n"


def lines(first, *headers):
    return b"".join(line + b"\r\n" for line in (first, *headers)) + b"\r\n"


def both(head, *codings):
    """Returns requests that have both a Content-Length and a transfer coding, with each order of
    the two headers."""
    for coding in codings:
        yield head + b"Content-Length: 5\r\n" + coding + b"\r\n\r\n0\r\n\r\n"
        yield head + coding + b"\r\nContent-Length: 5\r\n\r\n0\r\n\r\n"


# Malformed requests, grouped by the reason for which the daemon refuses them. After each malformed
# request the test sends a second request, which the daemon must not read.
ATTACKS = {
    "length and coding": [
        *both(PUT, b"Transfer-Encoding: chunked", b"transfer-encoding: Chunked", b"Transfer-Encoding:chunked",
              b"Transfer-Encoding:\tchunked", b"Transfer-Encoding: identity", b"Transfer-Encoding: chunked, identity"),
        *both(POST, b"Transfer-Encoding: chunked", b"Transfer-Encoding: gzip, chunked"),
        *both(GET, b"Transfer-Encoding: chunked"),
    ],
    "codings that hide": [
        head + coding + b"\r\n\r\n" + chunks(b"hello")
        for head in (PUT, GET)
        for coding in (
            b"Transfer-Encoding : chunked", b"Transfer-Encoding\t: chunked", b" Transfer-Encoding: chunked",
            b"Transfer-Encoding: \x0bchunked", b"Transfer-Encoding: \x0cchunked",
            b"Transfer-Encoding: \x00chunked", b"Transfer-Encoding: xchunked",
            b"Transfer-Encoding: chunkedx", b"Transfer-Encoding: \"chunked\"", b"Transfer-Encoding: chunked;a=b",
            b"Transfer-Encoding: chunked, chunked", b"Transfer-Encoding: ,chunked", b"Transfer-Encoding: chunked,",
            b"Transfer-Encoding: gzip", b"Transfer-Encoding: identity", b"Transfer-Encoding: chunk", b"Transfer-Encoding:",
            b"Transfer-Encoding: chunked\r\nTransfer-Encoding: identity",
            b"Transfer-Encoding: identity\r\nTransfer-Encoding: chunked",
            b"Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked", b"X: y\rTransfer-Encoding: chunked", b"X: y\r\n\tTransfer-Encoding: chunked", b"Transfer-Encoding: \xe3\x8f\x8f",
            b"Transfer\xadEncoding: chunked", b"Transfer-Encoding\x00: chunked", b"Foo: bar\r\n\rTransfer-Encoding: chunked")
    ],
    "lengths": [
        head + length + b"\r\n\r\nhello"
        for head in (PUT, GET)
        for length in (
            b"Content-Length: 5\r\nContent-Length: 5", b"Content-Length: 5\r\nContent-Length: 0",
            b"Content-Length: 0\r\nContent-Length: 5", b"Content-Length: 5\r\ncontent-length: 6", b"Content-Length: 5, 5",
            b"Content-Length: 5,", b"Content-Length: +5", b"Content-Length: -5", b"Content-Length: 0x5", b"Content-Length: 5.0",
            b"Content-Length: 5e0", b"Content-Length: 5 5", b"Content-Length: 5;", b"Content-Length: '5'",
            b"Content-Length:", b"Content-Length: ", b"Content-Length: five", b"Content-Length : 5", b"Content-Length\t: 5",
            b" Content-Length: 5", b"Content-Length: \x0b5", b"Content-Length: \xd9\xa5", b"Content-Length: 18446744073709551621",
            b"Content-Length: 9223372036854775808",
            b"X: y\rContent-Length: 5")
    ],
    "chunks": [
        PUT + CHUNKED + b"\r\n" + body
        for body in (
            b"0x5\r\nhello\r\n0\r\n\r\n", b"+5\r\nhello\r\n0\r\n\r\n", b"-5\r\nhello\r\n0\r\n\r\n", b" 5\r\nhello\r\n0\r\n\r\n",
            b"5 \r\nhello\r\n0\r\n\r\n", b"5\t\r\nhello\r\n0\r\n\r\n", b"5,\r\nhello\r\n0\r\n\r\n", b"5.\r\nhello\r\n0\r\n\r\n",
            b"g\r\nhello\r\n0\r\n\r\n", b"\r\nhello\r\n0\r\n\r\n", b";a=b\r\nhello\r\n0\r\n\r\n", b"5\r\nhello\r0\r\n\r\n", b"5\rhello\r\n0\r\n\r\n", b"5\r\nhello0\r\n\r\n",
            b"5\r\nhelloXX\r\n0\r\n\r\n", b"4\r\nhello\r\n0\r\n\r\n", b"5\r\nhello\r\n0\r\n\rX", b"10000000000000005\r\nhello\r\n0\r\n\r\n", b"5;a\nb\r\nhello\r\n0\r\n\r\n",
            b"5;\n5\r\nhello\r\n0\r\n\r\n", b"5;a=b\r hello\r\n0\r\n\r\n",)
    ],
    "lines": [ GET + b"\r\r\n", GET + b"X: y\r\r\n\r\n",
        b"\x00" + GET + b"\r\n", b" " + GET + b"\r\n", GET + b"rubbish\r\n\r\n", GET + b"X Y: z\r\n\r\n",
        GET + b"X : y\r\n\r\n", GET + b"X\x00: y\r\n\r\n", GET + b"X\x7f: y\r\n\r\n", GET + b"X\xff: y\r\n\r\n",
        GET + b"(X): y\r\n\r\n", GET + b"X: y\x08z\r\n\r\n", GET + b"X: y\x7f\r\n\r\n",
        GET + b"X: y\rZ: w\r\n\r\n",
    ],
    "request lines": [
        lines(line, b"Host: localhost")
        for line in ( b"GET /v1  HTTP/1.1", b"GET\t/v1\tHTTP/1.1", b"GET /v1 HTTP/1.1 ", b"GET /v1 HTTP/1.1\t",
            b"GET /v1 HTTP/1.1 HTTP/1.1", b"GET /a b HTTP/1.1", b"GET /v1", b"GET", b"GET /v1 ", b"GET HTTP/1.1", b"/v1 HTTP/1.1",
            b"GET /v1 HTTP/1.2", b"GET /v1 HTTP/1.10", b"GET /v1 HTTP/01.1", b"GET /v1 HTTP/11", b"GET /v1 HTTP/2.0",
            b"GET /v1 HTTP/0.9", b"GET /v1 HTTP/3", b"GET /v1 http/1.1", b"GET /v1 HTTPS/1.1", b"GET /v1 XTTP/1.1",
            b"GET /v1 HTTP/1,1", b"GET /v1 HTTP 1.1", b"GET /v1\x01 HTTP/1.1", b"GET /v1\x7f HTTP/1.1",
            b"GET /v1\xc3\xa9 HTTP/1.1", b"GET /v1#x HTTP/1.1", b"G(T /v1 HTTP/1.1", b"G\xc3T /v1 HTTP/1.1",
            b"PRI * HTTP/2.0", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03")
    ],
    "hosts": [
        lines(b"GET /v1 HTTP/1.1"), lines(b"GET /v1 HTTP/1.1", b"Host: localhost", b"Host: localhost"),
        lines(b"GET /v1 HTTP/1.1", b"Host: localhost", b"host: evil.example"),
        lines(b"GET /v1 HTTP/1.1", b"Host : localhost"), lines(b"GET /v1 HTTP/1.1", b" Host: localhost"),
    ],
    "old versions": [
        b"PUT /v1/meshes/attack HTTP/1.0\r\n" + HOST + CHUNKED + b"\r\n" + chunks(b"hello"),
        b"PUT /v1/meshes/attack HTTP/1.0\r\n" + HOST + b"Connection: keep-alive\r\n" + CHUNKED + b"\r\n" + chunks(b"hello"),
    ],
}

SPLIT = PUT + CHUNKED + b"\r\n"  # the head of a body in chunks
WHOLE = b"5\r\nhello\r\n0\r\n"  # its chunks, up to the trailers

# Requests that libmicrohttpd 0.9.75 reads leniently. The keys are the statuses of the answers to
# such a request and to the request that follows it. No proxy writes such bytes: HAProxy refuses or
# rewrites them (tests/cluster). Later versions of the library refuse most of them.
LENIENT = {
    (b"200", b"404"): [
        # a bare LF ends a line
        b"GET /v1 HTTP/1.1\nHost: localhost\n\n", b"GET /v1 HTTP/1.1\n" + HOST + b"\r\n", GET + b"\n", GET + b"X: y\n\r\n", GET + b"X: y\n\n",
        # any number of empty lines before a request, and any number of blanks before a target
        b"\n\n" + GET + b"\r\n", b"\r\n\r\n\r\n" + GET + b"\r\n", lines(b"GET  /v1 HTTP/1.1", b"Host: localhost"),
        # a folded line continues the header before it
        GET + b"X: y\r\n z\r\n\r\n", GET + b"X:\r\n\ty\r\n\r\n", GET + b" \r\n\r\n",
        # a line without a name ends the head
        GET + b": y\r\n\r\n",
        # a NUL ends a value, a target, a method
        GET + b"X: y\x00z\r\n\r\n", lines(b"GET /v1\x00 HTTP/1.1", b"Host: localhost"),
    ],
    (b"405", b"404"): [lines(b"G\x00T /v1 HTTP/1.1", b"Host: localhost"), lines(b"A" * 100 + b" /v1 HTTP/1.1", b"Host: localhost")],
    (b"422", b"404"): [
        *(PUT + framing + b"\r\n\r\nhello" for framing in (b"Content-Length: 5\x00", b"X: y\nContent-Length: 5", b"Content-Length: 00000000000000000005")),
        *(PUT + framing + b"\r\n\r\n" + chunks(b"hello") for framing in (b"Transfer-Encoding: chunked\x00", b"X: y\nTransfer-Encoding: chunked")),
        # later versions strip blanks at the end of a value, as RFC 9110 requires
        PUT + b"Content-Length: 5 \r\n\r\nhello",
        *(PUT + b"Transfer-Encoding: chunked" + blank + b"\r\n\r\n" + chunks(b"hello") for blank in (b" ", b"\t")),
        # a bare LF in chunks
        *(SPLIT + body for body in (b"5\nhello\r\n0\r\n\r\n", b"5\r\nhello\n0\r\n\r\n", b"5\r\nhello\r\n0\r\n\n", b"5\r\nhello\r\n0\n\r\n", b"5\r\nhello\r\n0\n\n")),
        # chunk extensions and zeros before a size, however long
        *(SPLIT + body + b"\r\nhello\r\n0\r\n\r\n" for body in (b"00000000000000005", b"5;a=\x01", b"5;" + b"a" * 2000)),
        SPLIT + b"5\r\nhello\r\n0;a=b\r\r\n\r\n", SPLIT + b"5\r\nhello\r\n0;a\r@\r\n\r\n",
        # trailers, which are ignored
        *(SPLIT + WHOLE + trailer for trailer in (b"Content-Length: 5\r\n\r\n", b"Transfer-Encoding: chunked\r\n\r\n", b"Host: other\r\n\r\n",
                                                  b"X : y\r\n\r\n", b"X: y\r\n z\r\n\r\n", b"X: y\n\n", b": y\r\n\r\n")),
    ],
    # the library ignores a folded Content-Length or Transfer-Encoding, so the daemon reads the
    # intended body as a second request, and refuses it
    (b"411", b"405"): [PUT + length + b"\r\n\r\nhello" for length in (b"Content-Length:\r\n 5", b"Content-Length: 5\r\n 5")],
    (b"200", b"405"): [GET + length + b"\r\n\r\nhello" for length in (b"Content-Length:\r\n 5", b"Content-Length: 5\r\n 5")],
    (b"411",): [PUT + b"Transfer-Encoding:" + end + b" chunked\r\n\r\n" + chunks(b"hello") for end in (b"\r\n", b"\n")],
    (b"200",): [GET + b"Transfer-Encoding:" + end + b" chunked\r\n\r\n" + chunks(b"hello") for end in (b"\r\n", b"\n")],
}
# Targets in absolute form (RFC 9112, 3.2.2), by the status of the answer. The daemon ignores the
# Host of such a request. Targets of 404 are not in absolute form, or no route has their path.
ABSOLUTE = {
    b"200": [b"http://localhost/livez", b"HTTP://127.0.0.1:80/livez?", b"https://[::1]/livez", b"http://localhost", b"http://localhost?a=b"],
    b"400": [b"http://localhost/%2f", b"http://localhost/%"],
    b"403": [b"http://example.com/livez", b"http:///livez", b"http://", b"http://localhost@example.com/livez", b"http://localhost:80:80/livez"],
    b"404": [b"http://localhost//livez", b"ftp://localhost/livez", b"http:/livez", b"/http://localhost/livez", b"http://localhost/http://localhost/livez"],
}
REFUSALS = {b"400", b"413", b"505"}


def is_refused(answers):
    """Returns whether one request was refused. libmicrohttpd 0.9.75 itself answers requests with a
    wrong length or without a Host, and writes the head of such an answer twice."""
    return len(set(answers)) <= 1 and len(answers) <= 2 and set(answers) <= REFUSALS


class Smuggling(TestCase):
    def answers(self, received):
        return [status for status in re.findall(rb"HTTP/1\.1 (\d{3}) ", received) if status != b"100"]

    def attack(self, text):
        """Returns the statuses of the answers. Asserts that the connection is closed at once: later
        bytes must not be read."""
        with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=PATIENCE_SECONDS) as connection:
            connection.sendall(text)
            return self.read_answers(connection)

    def read_answers(self, connection):
        received = b""
        try:
            while data := connection.recv(65536):
                received += data
        except ConnectionResetError:
            pass
        return self.answers(received)

    def assert_nothing_happened(self):
        seen = [line for line in self.daemon.log if "smuggled" in line.get("path", "")]
        self.assertFalse(seen)
        self.assertEqual(self.daemon.get("/v1/meshes").json["meshes"], [])

    def attack_all(self, texts):
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            return list(pool.map(lambda text: self.attack(text + HIDDEN), texts))

    def test_nothing_is_accepted(self):
        attacks = [text for texts in ATTACKS.values() for text in texts]
        self.assertGreaterEqual(len(attacks), 150)
        self.assertEqual(len(set(attacks)), len(attacks))
        answered = self.attack_all(attacks)
        self.assertEqual([pair for pair in zip(attacks, answered) if not is_refused(pair[1])], [])
        self.assert_nothing_happened()
        silent = sum(answers == [] for answers in answered)
        print(f"      {len(attacks)} cases, {len(attacks) - silent} answered with a refusal, {silent} hung up on, 0 accepted")

    def test_what_the_library_reads_leniently(self):
        """The daemon reads each lenient request as one request or refuses it. No lenient request
        hides a second request."""
        cases = [(text, expected) for expected, texts in LENIENT.items() for text in texts]
        behind = lines(b"GET /v1/meshes/behind HTTP/1.1", b"Host: localhost", b"Connection: close")
        for (text, expected), answers in zip(cases, [self.attack(text + behind) for text, _ in cases]):
            with self.subTest(text):
                self.assertTrue(tuple(answers) == expected or is_refused(answers), answers)

    def test_attacks_sent_byte_by_byte_are_refused(self):
        """The result does not depend on how the bytes are split."""
        attacks = [text for texts in ATTACKS.values() for text in texts[::4] if len(text) < 400]

        def dribble(text):
            received = b""
            with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=PATIENCE_SECONDS) as connection:
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                try:
                    for at in range(len(text)):
                        connection.sendall(text[at : at + 1])
                        time.sleep(0.0003)
                    while data := connection.recv(65536):
                        received += data
                except (BrokenPipeError, ConnectionResetError):
                    pass
            return self.answers(received)

        with concurrent.futures.ThreadPoolExecutor(16) as pool:
            answered = list(pool.map(lambda text: dribble(text + HIDDEN), attacks))
        self.assertEqual([pair for pair in zip(attacks, answered) if not is_refused(pair[1])], [])
        self.assert_nothing_happened()

    def test_every_byte_spoiled(self):
        """Replaces one byte after the other in a request that uses all features of chunked bodies.
        The daemon must read at most two requests, and do so quickly."""
        body = b"30;ext=\"a b\"\r\n%b\r\n0;x=y\r\nTrailer: x\r\n\r\n" % SQUARE
        text = PUT.replace(b"attack", b"spoiled") + CHUNKED + b"Expect: 100-continue\r\n\r\n" + body
        self.addCleanup(lambda: [self.daemon.request("DELETE", f"/v1/meshes/{mesh['name']}") for mesh in self.daemon.get("/v1/meshes").json["meshes"]])

        def ask(spoiled):
            begun = time.monotonic()
            with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=PATIENCE_SECONDS) as connection:
                connection.sendall(spoiled + LAST)
                connection.shutdown(socket.SHUT_WR)
                return self.read_answers(connection), time.monotonic() - begun

        cases = [text[:at] + bytes([byte]) + text[at + 1 :] for at in range(len(text)) for byte in b"\r\n\0 @;"]
        with concurrent.futures.ThreadPoolExecutor(16) as pool:
            answered = list(pool.map(ask, cases))
        known = {b"200", b"201", b"400", b"403", b"404", b"405", b"411", b"415", b"422", b"503", b"505"}
        self.assertEqual([pair for pair in zip(cases, answered) if len(pair[1][0]) > 2 or not set(pair[1][0]) <= known or pair[1][1] > 10], [])
        self.assertGreater(sum(is_refused(answers) for answers, _ in answered), 200)

    def test_requests_before_an_attack_are_answered(self):
        """A fault affects its own request and later requests, but not earlier requests."""
        good = b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n"
        for bad, refusal in ((GET + HOST + b"\r\n", [b"400"]), (GET + b"X : y\r\n\r\n", [b"400"]), (b"rubbish\r\n\r\n", [])):
            self.assertEqual(self.attack(good * 3 + bad + HIDDEN), [b"200"] * 3 + refusal)
        self.assert_nothing_happened()

    def test_the_fault_is_named(self):
        for text, words in ((GET + HOST + b"\r\n", "Host"), (GET + b"X: \x01\r\n\r\n", "control"),
                            (PUT + b"Content-Length: 5\r\nContent-Length: 5\r\n\r\n", "twice"), (lines(b"GET /v1 HTTP/1.2", b"Host: localhost"), "version"),
                            (lines(b"GET /v1#x HTTP/1.1", b"Host: localhost"), "percent-encoded")):
            received = self.daemon.raw(text)
            self.assertIn(b"application/problem+json", received)
            self.assertIn(words, json.loads(received.partition(b"\r\n\r\n")[2])["detail"])

    def test_the_fault_is_named_by_daemon_or_library(self):
        """libmicrohttpd 1.0 refuses these requests before the daemon sees them."""
        for text, word in ((GET + b"X : y\r\n\r\n", b"colon"), (PUT + CHUNKED + b"Content-Length: 5\r\n\r\n", b"both")):
            received = self.daemon.raw(text)
            self.assertEqual(self.answers(received), [b"400"])
            self.assertIn(word, received)
            self.assertEqual(b"application/problem+json" in received, not LIBRARY_REFUSES)

    def test_unusual_valid_requests_are_answered(self):
        """Unusual but valid HTTP is answered."""
        for text in (b"\r\n" + GET + b"\r\n", GET + b"X:\r\nY: \t z \r\nZ: \xe9\r\n\r\n", b"HEAD /livez HTTP/1.0\r\n\r\n",
                     GET.replace(b"Host", b"hOsT") + b"\r\n", GET + b"Content-Length: 0\r\n\r\n"):
            last = text[:-2] + b"Connection: close\r\n\r\n"
            self.assertEqual(self.answers(self.daemon.raw(last)), [b"200"], text)
        self.assertEqual(len(SQUARE), 0x30)
        head = PUT.replace(b"attack", b"right") + CHUNKED + b"Connection: close\r\n\r\n"
        for body in (b"30\r\n%b\r\n0\r\nTrailer: x\r\n\r\n", b"0030\r\n%b\r\n0\r\n\r\n", b"30\r\n%b\r\n000\r\n\r\n"):
            self.assertIn(self.answers(self.daemon.raw(head + body % SQUARE)), ([b"201"], [b"200"]))
        extended = b"30;ext=\"a b\"\r\n%b\r\n0\r\nTrailer: x\r\n\r\n"
        self.assertEqual(self.answers(self.daemon.raw(head + extended % SQUARE)), [b"400" if LIBRARY_REFUSES else b"200"])
        self.assertEqual(self.daemon.request("DELETE", "/v1/meshes/right").status, 204)

    def test_absolute_targets(self):
        for status, targets in ABSOLUTE.items():
            hosts = (b"localhost",) if status == b"404" else (b"localhost", b"example.com")
            for target, host in itertools.product(targets, hosts):
                text = lines(b"GET " + target + b" HTTP/1.1", b"Host: " + host, b"Connection: close")
                self.assertEqual(self.answers(self.daemon.raw(text)), [status], text)
        self.assertEqual(set(self.answers(self.daemon.raw(lines(b"GET http://localhost/livez HTTP/1.1", b"Connection: close")))), {b"400"})

    def test_malformed_requests_are_counted(self):
        before = self.daemon.metric("malformed_requests_total")
        self.attack(GET + HOST + b"\r\n")
        self.assertEqual(self.daemon.metric("malformed_requests_total"), before + 1)


class KeepAlive(TestCase):
    def test_uploads_and_queries_sent_at_once(self):
        """Fifty requests of all kinds, sent at once in pieces of every length, are answered in
        order, each once."""
        def request(number):
            mark = b"X-Request-Id: n%d\r\n" % number
            size = b"Content-Length: %d\r\n\r\n" % len(SQUARE)
            return (b"PUT /v1/meshes/m HTTP/1.1\r\n" + HOST + mark + size + SQUARE,
                    b"PUT /v1/meshes/m HTTP/1.1\r\n" + HOST + mark + CHUNKED + b"\r\n" + chunks(SQUARE[:7], SQUARE[7:]),
                    b"GET /v1/meshes/m/distance?from=v:0&to=v:2 HTTP/1.1\r\n" + HOST + mark + b"\r\n",
                    b"HEAD /v1/meshes/m HTTP/1.1\r\n" + HOST + mark + b"\r\n",
                    b"GET /nowhere HTTP/1.1\r\n" + HOST + mark + b"\r\n")[number % 5]

        text = b"".join(request(number) for number in range(50))
        for piece in (len(text), 1000, 97, 11):
            with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=PATIENCE_SECONDS) as connection:
                for at in range(0, len(text), piece):
                    connection.sendall(text[at : at + piece])
                received = b""
                while received.count(b"X-Request-Id: ") < 50:
                    received += connection.recv(65536)
            ids = [line.split()[1] for line in received.split(b"\r\n") if line.startswith(b"X-Request-Id")]
            self.assertEqual(ids, [b"n%d" % number for number in range(50)])

    def test_errors_keep_the_connection(self):
        connection = self.daemon.connect()
        for method, path, status in (("GET", "/nowhere", 404), ("POST", "/v1", 405), ("GET", "/v1?x=1", 400), ("PATCH", "/v1/meshes", 405),
                                     ("OPTIONS", "/v1", 204), ("HEAD", "/v1", 200), ("GET", "/livez", 200)):
            answer = self.daemon.request(method, path, connection=connection)
            self.assertEqual((answer.status, answer.headers["Connection"]), (status, None), (method, path))
        connection.close()

    def assert_head(self, path):
        head, get = self.daemon.request("HEAD", path), self.daemon.get(path)
        self.assertEqual((head.status, head.body), (200, b""))
        self.assertEqual(head.headers["Content-Type"], get.headers["Content-Type"])

    def test_head_and_allow(self):
        for path in ("/v1", "/livez", "/v1/meshes", "/metrics", "/"):
            self.assert_head(path)
        answer = self.daemon.request("POST", "/v1/meshes/x")
        self.assert_problem(answer, 405, "method_not_allowed")
        self.assertEqual(answer.headers["Allow"], "GET, HEAD, PUT, PATCH, DELETE, OPTIONS")

    def test_security_headers(self):
        for path in ("/", "/v1", "/nowhere"):
            headers = self.daemon.get(path).headers
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertIn("frame-ancestors 'none'", headers["Content-Security-Policy"])

    def test_pages_have_heads_and_security_headers(self):
        self.skip_without_pages()
        for path in ("/", "/app.js"):
            self.assert_head(path)
            headers = self.daemon.get(path).headers
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertIn("frame-ancestors 'none'", headers["Content-Security-Policy"])
            self.assertEqual(headers["Referrer-Policy"], "no-referrer")
            self.assertEqual(headers["Cross-Origin-Resource-Policy"], "same-origin")


class Sizes(TestCase):
    flags = ("--max-body", "64KiB")

    def head(self, extra):
        return b"PUT /v1/meshes/x HTTP/1.1\r\n" + HOST + extra + b"\r\n"

    def test_an_announced_body_is_refused_before_it_arrives(self):
        received = self.daemon.raw(self.head(b"Content-Length: 65537\r\nExpect: 100-continue\r\n"))
        self.assertTrue(received.startswith(b"HTTP/1.1 413 "), received)
        self.assertNotIn(b"100 Continue", received)
        self.assertEqual(received.count(b"HTTP/1.1 "), 1)
        received = self.daemon.raw(self.head(b"Content-Length: 65536\r\nExpect: 100-continue\r\n"))
        self.assertTrue(received.startswith(b"HTTP/1.1 100 Continue\r\n\r\n"), received)

    def test_long_targets_and_headers(self):
        for text in (b"GET /" + b"a" * 300000 + b" HTTP/1.1\r\n" + HOST + b"\r\n", GET + b"X: " + b"y" * 300000 + b"\r\n\r\n",
                     GET + b"X" * 300000, GET + b"X: y\r\n" * 100000, b"\r\n" * 100000, b"A" * 100000,
                     GET + b"".join(b"X-%d: y\r\n" % number for number in range(64)) + b"\r\n"):
            received = self.daemon.raw(text)
            self.assertIn(received[9:12], (b"400", b"414", b"431", b""), received[:100])
        self.assertEqual(self.daemon.get("/livez").status, 200)

    def test_heads_have_room_for_so_much(self):
        """A head that just fits is answered. The daemon answers a longer head with a problem that
        names the limit. Near the library's own limit, the library answers with 431."""
        def get(target=b"/livez", *headers):
            received = self.daemon.raw(b"GET " + target + b" HTTP/1.1\r\n" + HOST + b"".join(headers) + b"Connection: close\r\n\r\n")
            head, _, body = received.partition(b"\r\n\r\n")
            return received[9:12], body if b"application/problem+json" in head else b""

        long = b"/livez?x=%s"
        self.assertIn(b'"parameter":"x"', get(long % (b"a" * (8192 - 9)))[1])
        self.assertIn(b"more than 8192 bytes", get(long % (b"a" * (8192 - 8)))[1])
        self.assertEqual(get(b"/livez", b"X: %s\r\n" % (b"y" * 12000))[0], b"200")
        self.assertEqual(get(b"/livez", *[b"X-%d: %s\r\n" % (i, b"y" * 190) for i in range(10, 70)])[0], b"200")
        for size in (12300, 13000, 15000):
            self.assertIn(b"more than 12288 bytes", get(b"/livez", b"X: %s\r\n" % (b"y" * size))[1])
        for size in (16300, 20000):
            self.assertEqual(get(b"/livez", b"X: %s\r\n" % (b"y" * size))[0], b"431")
        self.assertIn(b"more than 12288 bytes", get(b"/livez", *[b"X%s:\r\n" % (b"y" * 1000)] * 13)[1])
        self.assertIn(b"more than 64 headers", get(b"/livez", *[b"X: y\r\n"] * 63)[1])
        self.assertEqual(get(b"/livez", *[b"X: y\r\n"] * 62)[0], b"200")

    def put_packed(self, body, **headers):
        return self.daemon.put("packed", body, Content_Encoding="gzip", **headers)

    def test_packed_bodies(self):
        self.assertIn(self.put_packed(gzip.compress(SQUARE)).status, (200, 201))
        self.assertEqual(self.daemon.get("/v1/meshes/packed").json["sha256"], hashlib.sha256(SQUARE).hexdigest())
        self.assertEqual(self.put_packed(gzip.compress(SQUARE[:9]) + gzip.compress(SQUARE[9:])).status, 200)
        self.assertEqual(self.put_packed(iter([gzip.compress(SQUARE)])).status, 200)
        question = gzip.compress(b'{"from": {"vertex": 0}, "to": {"vertex": 2}}')
        headers = {"Content-Encoding": "gzip", "Content-Type": "application/json"}
        for extra in ({}, {"Prefer": "respond-async"}):
            answer = self.daemon.request("POST", "/v1/meshes/packed/distance", question, {**headers, **extra})
            self.assertIn(answer.status, (200, 202), answer)

    def test_invalid_gzip_bodies(self):
        packed = gzip.compress(SQUARE)
        for body in (SQUARE, b"", packed[:-1], packed[:10], packed + b"x", packed[:-8] + bytes(8), zlib.compress(SQUARE)):
            self.assert_problem(self.put_packed(body), 400, "invalid_request")
        for coding in ("br", "deflate", "zstd", "gzip, gzip", "compress", ""):
            answer = self.daemon.put("packed", packed, Content_Encoding=coding)
            self.assert_problem(answer, 415, "unsupported_media_type")
        self.assertEqual(self.daemon.put("plain", SQUARE, Content_Encoding="identity").status, 201)

    def test_bombs(self):
        fits = self.put_packed(gzip.compress(SQUARE + b"#" * (65536 - len(SQUARE))))
        self.assertNotIn(fits.status, (400, 413), fits)
        problem = self.assert_problem(self.put_packed(gzip.compress(SQUARE + b"#" * 65536)), 413, "too_large")
        self.assertEqual(problem["limit"], 65536)
        layers = gzip.compress(gzip.compress(bytes(10 << 20)))
        self.assertIn(self.put_packed(layers).status, (413, 422))


class Bombs(TestCase):
    """Tests a daemon with a large size limit. The compression ratio then limits a body."""

    flags = ("--memory-budget", "256MiB", "--max-body", "200MiB")

    def test_ratio(self):
        packed = io.BytesIO()
        with gzip.GzipFile(fileobj=packed, mode="wb") as file:
            for _ in range(100):
                file.write(bytes(1 << 20))
        self.assertLess(len(packed.getvalue()), 200000)
        started = time.monotonic()
        answer = self.daemon.put("bomb", packed.getvalue(), Content_Encoding="gzip")
        self.assertIn("100 times", self.assert_problem(answer, 413, "too_large")["detail"])
        self.assertLess(time.monotonic() - started, 5)
        self.assertEqual(self.daemon.get("/livez").status, 200)


if __name__ == "__main__":
    unittest.main()
