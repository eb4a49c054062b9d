"""Runs every example in a temporary folder."""

import importlib.util
import subprocess
import sys
import unittest
from pathlib import Path

from support import SAMPLE, FolderTest

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
ARGUMENTS = {
    "1_run_recording.py": [SAMPLE, "out", "5"],
    "2_feed_readings.py": [SAMPLE, "5"],
    "3_evaluate_and_plot.py": [SAMPLE, "plots", "5"],
    "4_sensor_noise.py": ["plots"],
    "5_calibrate_magnetometer.py": ["plots"],
}


class ExamplesTest(FolderTest):
    def test_all_are_run(self):
        self.assertEqual(sorted(ARGUMENTS), sorted(file.name for file in EXAMPLES.glob("*.py")))

    def run_example(self, name):
        if "plots" in ARGUMENTS[name] and importlib.util.find_spec("matplotlib") is None:
            self.skipTest("matplotlib is missing: apt-get install python3-matplotlib")
        done = subprocess.run([sys.executable, EXAMPLES / name, *map(str, ARGUMENTS[name])], cwd=self.folder,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(done.stdout.strip())
        if "plots" in ARGUMENTS[name]:
            pictures = list((self.folder / "plots").glob("*.png"))
            self.assertTrue(pictures)
            self.assertTrue(all(picture.stat().st_size > 10_000 for picture in pictures))


for example in ARGUMENTS:
    setattr(ExamplesTest, "test_" + example[:-3], lambda self, name=example: self.run_example(name))


if __name__ == "__main__":
    unittest.main()
