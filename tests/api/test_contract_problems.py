"""Every problem that the contract documents is provoked, operation by operation, and none comes that it does not document.

A new operation is tried in all situations of contract_situations.py without a line here. Where it documents a problem that none of them brings
about, this test names it, and wants a situation more, or a contract that promises less.
"""
import tempfile
import unittest

import contract_situations
from contract_situations import Situations, documented
from harness import PROGRAM

# Documented, and not to be had in these situations: why, and where it is tested instead.
ELSEWHERE = {
    "store_unavailable": "needs a database that several daemons share",
}
RARE = {
    ("delete", "draining"): "the store's writer would have to be at work on it at the very end of the time to drain",
}


def is_sanitized():
    """Then the daemon has an allocator of its own, and none can be preloaded."""
    program = PROGRAM.read_bytes()
    return any(name in program for name in (b"__asan_init", b"__tsan_init"))


def try_everything(found, place):
    contract_situations.try_plain(found)
    contract_situations.try_crowd(found)
    contract_situations.try_keys(found, place)
    folder = contract_situations.store_large(place)
    for attempt in (contract_situations.try_overload, contract_situations.try_drain, contract_situations.try_haste, contract_situations.try_scarcity,
                    contract_situations.try_damage):
        attempt(found, folder)
    contract_situations.try_refusing_store(found, f"{place}/refusing")
    contract_situations.try_late_removals(found, place)
    if not is_sanitized():
        contract_situations.try_failing_memory(found, place)


class Problems(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.found = Situations()
        with tempfile.TemporaryDirectory() as place:
            try_everything(cls.found, place)

    def test_no_other_answer_comes(self):
        self.assertEqual(sorted(set(self.found.faults)), [])

    def test_every_problem_comes(self):
        missing = [f"{operation}: {status} {code}" for operation, status, code in self.found.missing()
                   if code not in ELSEWHERE and (operation.method, code) not in RARE and not (is_sanitized() and code == "insufficient_memory")]
        self.assertEqual(missing, [], "documented, and no situation brings it about: add one to contract_situations.py, or document less")

    def test_every_other_status_comes(self):
        missing = [f"{operation}: {status}" for operation in self.found.contract.operations for status in operation.responses
                   if status.isdigit() and int(status) < 400 and (int(status), "") not in self.found.seen[operation.name]]
        self.assertEqual(missing, [])

    def test_most_is_provoked(self):
        """The table is about something."""
        provoked = {(operation.name, *pair) for operation in self.found.contract.operations
                    for pair in set(documented(operation)) & self.found.seen[operation.name]}
        self.assertGreater(len(provoked), 850)


if __name__ == "__main__":
    unittest.main()
