"""Tests HTTPS: its versions, certificates that are replaced while the daemon runs, and the rules
that also hold without TLS."""
import http.client
import json
import os
import pathlib
import shutil
import socket
import ssl
import subprocess
import tempfile
import unittest

from harness import PATIENCE_SECONDS, PROGRAM, SQUARE, Daemon, sample


def make_certificate(folder, name):
    """Makes a self-signed certificate of localhost and its key; returns their paths."""
    certificate, key = folder / f"{name}.pem", folder / f"{name}.key"
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                    "-subj", f"/CN={name}", "-addext", "subjectAltName=DNS:localhost", "-keyout", key, "-out", certificate],
                   check=True, capture_output=True)
    return certificate, key


@unittest.skipUnless(shutil.which("openssl"), "certificates are made by openssl")
class Tls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.place.name)
        cls.first, cls.second = make_certificate(cls.folder, "first"), make_certificate(cls.folder, "second")

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def setUp(self):
        self.certificate, self.key = self.folder / "certificate.pem", self.folder / "key.pem"
        self.install(self.first)
        self.daemon = Daemon("--tls-cert", str(self.certificate), "--tls-key", str(self.key))

    def tearDown(self):
        self.assertEqual(self.daemon.stop(), 0)
        self.assertFalse([line for line in self.daemon.log if line["event"] == "not JSON"])

    def test_no_exchange_of_keys_without_forward_secrecy(self):
        certificate, key = self.folder / "rsa.pem", self.folder / "rsa.key"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext",
                        "subjectAltName=DNS:localhost", "-keyout", key, "-out", certificate], check=True, capture_output=True)
        self.install((certificate, key))
        self.assertEqual(self.daemon.reload()["event"], "reloaded")
        for ciphers, is_taken in (("ECDHE-RSA-AES128-GCM-SHA256", True), ("AES128-GCM-SHA256:AES256-GCM-SHA384:AES128-SHA:AES256-SHA", False)):
            context = self.context((certificate, key))
            context.maximum_version = ssl.TLSVersion.TLSv1_2
            context.set_ciphers(ciphers)
            try:
                with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=PATIENCE_SECONDS) as plain:
                    context.wrap_socket(plain, server_hostname="localhost").close()
                self.assertTrue(is_taken, ciphers)
            except (ssl.SSLError, ConnectionError):
                self.assertFalse(is_taken, ciphers)

    def test_a_reload_of_unreadable_files_keeps_the_old_certificate(self):
        for path in (self.certificate, self.key):
            path.unlink()
            os.mkfifo(path)
            told = self.daemon.reload()
            self.assertEqual(told["event"], "reload_failed")
            self.assertIn("it is not a regular file", told["message"])
            path.unlink()
            self.install(self.first)
        self.assertEqual(self.ask(self.first, "GET", "/livez")[0].status, 200)

    def test_an_expired_certificate_is_logged(self):
        def warnings():
            return [line["message"] for line in self.daemon.log if line["event"] == "certificate"]

        self.assertEqual(warnings(), [])
        request = self.folder / "request.pem"
        for command in (["req", "-new", "-key", self.key, "-subj", "/CN=expired", "-out", request],
                        ["x509", "-req", "-in", request, "-signkey", self.key, "-days", "-1", "-out", self.certificate]):
            subprocess.run(["openssl", *command], check=True, capture_output=True)
        self.assertEqual(self.daemon.reload()["event"], "reloaded")
        self.assertRegex(warnings()[0], f"^a certificate of '{self.certificate}' has expired at 20..-..-..T..:..:..Z, so clients reject it")
        self.assertEqual(self.daemon.stop(), 0)
        self.daemon = Daemon("--tls-cert", str(self.certificate), "--tls-key", str(self.key))
        self.assertEqual(len(warnings()), 1)

    def install(self, pair):
        shutil.copy(pair[0], self.certificate)
        shutil.copy(pair[1], self.key)

    def context(self, pair):
        return ssl.create_default_context(cafile=pair[0])

    def connect(self, pair):
        return http.client.HTTPSConnection("localhost", self.daemon.port, timeout=PATIENCE_SECONDS, context=self.context(pair))

    def ask(self, pair, method, path, body=None):
        connection = self.connect(pair)
        connection.request(method, path, body)
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer, content

    def raw(self, text):
        received = b""
        with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=3) as plain:
            with self.context(self.first).wrap_socket(plain, server_hostname="localhost") as connection:
                connection.sendall(text)
                try:
                    while data := connection.recv(65536):
                        received += data
                except (TimeoutError, OSError):
                    pass
        return received

    def test_an_upload_and_a_question(self):
        self.assertEqual([line["protocol"] for line in self.daemon.log if line["event"] == "listening"], ["https"])
        mesh = sample("icosphere", level=5)
        answer, _ = self.ask(self.first, "PUT", "/v1/meshes/m", mesh)
        self.assertEqual(answer.status, 201)
        answer, body = self.ask(self.first, "GET", "/v1/meshes/m/distance?from=v:0&to=v:9")
        self.assertGreater(json.loads(body)["distance"], 0)
        answer, body = self.ask(self.first, "GET", "/v1/meshes/m/content?format=ply")
        self.assertEqual((answer.status, len(body) > 100000), (200, True))

    def test_many_requests_on_one_connection(self):
        connection = self.connect(self.first)
        for number in range(50):
            connection.request("PUT", f"/v1/meshes/m{number % 3}", SQUARE)
            answer = connection.getresponse()
            answer.read()
            self.assertIn(answer.status, (200, 201))
        connection.close()

    def test_versions(self):
        for version, is_spoken in ((ssl.TLSVersion.TLSv1_1, False), (ssl.TLSVersion.TLSv1_2, True), (ssl.TLSVersion.TLSv1_3, True)):
            context = self.context(self.first)
            context.set_ciphers("ALL:@SECLEVEL=0")
            context.minimum_version = context.maximum_version = version
            with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=PATIENCE_SECONDS) as plain:
                if is_spoken:
                    with context.wrap_socket(plain, server_hostname="localhost") as connection:
                        self.assertEqual(connection.version(), {"TLSv1_2": "TLSv1.2", "TLSv1_3": "TLSv1.3"}[version.name])
                else:
                    with self.assertRaises((ssl.SSLError, ConnectionError)):
                        context.wrap_socket(plain, server_hostname="localhost")

    def test_plain_http_is_not_spoken(self):
        self.assertNotIn(b"200", self.daemon.raw(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n"))
        self.assertEqual(self.ask(self.first, "GET", "/livez")[0].status, 200)

    def test_reload(self):
        kept = self.connect(self.first)
        kept.request("GET", "/livez")
        kept.getresponse().read()
        self.install(self.second)
        self.assertEqual(self.daemon.reload()["event"], "reloaded")
        self.assertEqual(self.ask(self.second, "GET", "/livez")[0].status, 200)
        with self.assertRaises(ssl.SSLCertVerificationError):
            self.ask(self.first, "GET", "/livez")
        kept.request("GET", "/livez")  # open connections keep their certificate
        self.assertEqual(kept.getresponse().status, 200)
        kept.close()

    def test_a_bad_reload_changes_nothing(self):
        # installs the second certificate, but leaves the key of the first certificate
        shutil.copy(self.second[0], self.certificate)
        told = self.daemon.reload()
        self.assertEqual((told["event"], told["level"]), ("reload_failed", "error"))
        self.assertIn("is not that of the certificate", told["message"])
        for text in ("", "rubbish"):
            self.certificate.write_text(text)
            self.assertIn(str(self.certificate), self.daemon.reload()["message"])
        self.key.unlink()
        self.assertEqual(self.daemon.reload()["event"], "reload_failed")
        self.assertEqual(self.ask(self.first, "GET", "/livez")[0].status, 200)

    def test_unusable_files(self):
        for certificate, key in ((self.first[0], self.second[1]), (self.first[1], self.first[1]), ("nothing", self.first[1])):
            flags = ["--listen", "127.0.0.1:0", "--store", "memory", "--tls-cert", str(certificate), "--tls-key", str(key)]
            result = subprocess.run([PROGRAM, *flags], capture_output=True, text=True, timeout=PATIENCE_SECONDS)
            self.assertEqual(result.returncode, 1, result)
            self.assertIn("start_failed", result.stderr)

    def test_malformed_requests_are_refused(self):
        """Requests that are refused without TLS are also refused with TLS."""
        hidden = b"GET /v1/meshes/smuggled HTTP/1.1\r\nHost: localhost\r\n\r\n"
        for text in (b"GET /livez HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n", b"GET /livez HTTP/1.1\r\nHost: localhost\r\nX : y\r\n\r\n",
                     b"GET /livez HTTP/1.1\r\nHost: localhost\r\nX: \x01\r\n\r\n",
                     b"PUT /v1/meshes/x HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n5 \r\nhello\r\n0\r\n\r\n"):
            received = self.raw(text + hidden)
            self.assertTrue(received.startswith(b"HTTP/1.1 400 "), received)
            self.assertEqual(received.count(b"\r\nDate: "), 1, received)
        self.assertFalse([line for line in self.daemon.log if "smuggled" in line.get("path", "")])


if __name__ == "__main__":
    unittest.main()
