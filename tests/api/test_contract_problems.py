"""Provokes every problem that the contract documents, operation by operation, and checks that no
undocumented problem occurs.

A new operation is tried in all situations of contract_situations.py without a change here. If it
documents a problem that no situation causes, this test names it: then add a situation, or remove
the problem from the contract.
"""
import tempfile
import unittest

import contract_situations
from contract_situations import Situations, documented
from harness import PROGRAM

# Documented problems that these situations can't cause, each with the reason and the test that
# covers it.
ELSEWHERE = {
    "store_unavailable": "needs a database that several daemons share",
}
RARE = {
    (method, "draining"): "the store's writer would have to work on it when the time to drain ends"
    for method in ("delete", "patch")
} | {
    (name, "draining"): "the thread that reads batches would have to work on it when the time to drain ends"
    for name in ("get_batch", "get_batch_results")
} | {
    ("post_derive", "invalid_mesh"): "an edit would have to make a surface that is none",
}


def is_sanitized():
    """Returns whether the daemon runs under a sanitizer. The sanitizer's allocator excludes a
    preloaded allocator."""
    program = PROGRAM.read_bytes()
    return any(name in program for name in (b"__asan_init", b"__tsan_init"))


def try_everything(found, place):
    contract_situations.try_plain(found)
    contract_situations.try_crowd(found)
    contract_situations.try_keys(found, place)
    folder = contract_situations.store_large(place)
    for attempt in (contract_situations.try_overload, contract_situations.try_drain, contract_situations.try_haste, contract_situations.try_waits,
                    contract_situations.try_scarcity, contract_situations.try_damage):
        attempt(found, folder)
    contract_situations.try_refusing_store(found, f"{place}/refusing")
    contract_situations.try_late_changes(found, place)
    if not is_sanitized():
        contract_situations.try_failing_memory(found, place)


class Problems(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.found = Situations()
        with tempfile.TemporaryDirectory() as place:
            try_everything(cls.found, place)

    def test_no_undocumented_answer_occurs(self):
        self.assertEqual(sorted(set(self.found.faults)), [])

    def test_every_documented_problem_occurs(self):
        missing = [f"{operation}: {status} {code}" for operation, status, code in self.found.missing()
                   if code not in ELSEWHERE and not {(operation.method, code), (operation.name, code)} & RARE.keys() and not (is_sanitized() and code == "insufficient_memory")]
        self.assertEqual(missing, [], "documented, and no situation brings it about: add one to contract_situations.py, or document less")

    def test_every_other_documented_status_occurs(self):
        missing = [f"{operation}: {status}" for operation in self.found.contract.operations for status in operation.responses
                   if status.isdigit() and int(status) < 400 and (int(status), "") not in self.found.seen[operation.name]]
        self.assertEqual(missing, [])

    def test_most_documented_problems_are_provoked(self):
        """Checks that the situations cause most of the documented problems."""
        provoked = {(operation.name, *pair) for operation in self.found.contract.operations
                    for pair in set(documented(operation)) & self.found.seen[operation.name]}
        self.assertGreater(len(provoked), 850)


if __name__ == "__main__":
    unittest.main()
