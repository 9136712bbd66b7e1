"""Helpers of the tests of data folders."""
import subprocess

from harness import PATIENCE_SECONDS, PROGRAM, Folder


class Stored(Folder):
    def tool(self, *flags, folder=None):
        return subprocess.run([PROGRAM, "--data-dir", folder or self.folder, *flags], capture_output=True, text=True,
                              timeout=PATIENCE_SECONDS)

    def events(self, daemon):
        return [line["event"] for line in daemon.log]

    def flip(self, path, at=0.5):
        """Damages a byte of a file."""
        content = bytearray(path.read_bytes())
        content[int(at * len(content))] ^= 4
        path.write_bytes(content)

    def objects(self):
        return [path for path in self.folder.glob("objects/*/*")]
