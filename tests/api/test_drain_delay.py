"""Tests a stopping daemon from the view of a load balancer. First /readyz returns 503; later the
daemon refuses connections."""
import time
import unittest

from harness import SQUARE, Daemon

DELAY_MS = 1500


class DrainDelay(unittest.TestCase):
    def test_requests_are_served_while_readyz_answers_503(self):
        daemon = Daemon("--drain-delay-ms", str(DELAY_MS))
        self.assertEqual(daemon.put("square", SQUARE).status, 201)
        self.assertEqual(daemon.get("/readyz").status, 200)
        begun = time.monotonic()
        daemon.terminate()
        while daemon.get("/readyz").status == 200:
            self.assertLess(time.monotonic() - begun, DELAY_MS / 1000)
        answer = daemon.get("/v1/meshes/square/distance?from=v:0&to=v:2")
        self.assertEqual((answer.status, answer.headers["Connection"]), (200, "close"))
        self.assertEqual(daemon.put("other", SQUARE).status, 201)
        self.assertEqual(daemon.get("/readyz").json["status"], "draining")
        self.assertEqual(daemon.get("/livez").status, 200)
        self.assertLess(time.monotonic() - begun, DELAY_MS / 1000)
        self.assertEqual(daemon.stop(), 0)  # stop() sends the signal again, which has no effect
        self.assertGreaterEqual(time.monotonic() - begun, DELAY_MS / 1000)
        self.assertRaises(ConnectionRefusedError, daemon.get, "/livez")

    def test_without_a_delay_the_daemon_ends_at_once(self):
        daemon = Daemon()
        begun = time.monotonic()
        self.assertEqual(daemon.stop(), 0)
        self.assertLess(time.monotonic() - begun, DELAY_MS / 1000)
        self.assertNotIn("standing_aside", [line["event"] for line in daemon.log])


if __name__ == "__main__":
    unittest.main()
