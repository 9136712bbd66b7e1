"""Tests the harness itself."""
import time

from harness import TestCase


class Comparisons(TestCase):
    @classmethod
    def setUpClass(cls):
        """These tests need no daemon."""

    @classmethod
    def tearDownClass(cls):
        pass

    def test_large_answers_that_differ_fail_soon(self):
        first, second = ((200, ",".join(f"{i / step:.6f}" for i in range(50000)).encode()) for step in (3, 7))
        begun = time.monotonic()
        with self.assertRaisesRegex(AssertionError, "differ at character 1[0-9] "):
            self.assertEqual(first, second)
        self.assertLess(time.monotonic() - begun, 5)
        self.assertEqual(first, (first[0], first[1]))
