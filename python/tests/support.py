"""What several tests need: the program, the sample recording and folders that vanish."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["LODELINE_PROGRAM"]
SAMPLE = Path(os.environ["LODELINE_SAMPLE"])
SECONDS = {"source.duration_s": 5}


class FolderTest(unittest.TestCase):
    """A test with a temporary folder."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="lodeline_python_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def program(self, *arguments, exit_code=0):
        """Runs the program, expects an exit code and returns what it printed."""
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, check=False)
        self.assertEqual(done.returncode, exit_code, done.stdout + done.stderr)
        return done.stdout + done.stderr
