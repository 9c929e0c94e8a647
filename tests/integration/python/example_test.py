"""The example of client/python does what it says, beside a real kinshipd."""
import os
import pathlib
import subprocess
import sys
import unittest

import kinship
from kinshipd_process import Kinshipd
from panda_sweeps import attempt

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
PROGRAM = SOURCE / "client" / "python" / "examples" / "plot_distribution.py"


class PlotDistribution(unittest.TestCase):
    def setUp(self):
        self.server = self.enterContext(Kinshipd())
        self.picture = self.server.folder / "distribution.png"

    def run_example(self, *arguments):
        return subprocess.run(
            [sys.executable, "-B", PROGRAM, SOURCE / "robots" / "models" / "ur10e", "sweep", self.picture,
             "--domain", str(self.server.domain), *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)

    def test_draws_what_the_fleet_knows(self):
        import matplotlib.image

        self.server.start()
        with kinship.Client(domain=self.server.domain, outbox=self.server.folder / "outbox", timeout=20) as client:
            panda = kinship.Robot(SOURCE / "robots" / "models" / "panda")
            client.register(panda)
            for seed in range(6):
                client.report(attempt(panda, "sweep", seed))
            self.assertEqual(client.flush(60).pending, 0)
        run = self.run_example("--deadline", "120")
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertRegex(run.stdout, r"components.*ur10e")
        self.assertRegex(run.stdout, r"panda: 6 paths")
        pixels = matplotlib.image.imread(self.picture)[..., :3]
        self.assertGreater(min(pixels.shape[:2]), 400)
        self.assertGreater(pixels.std(), 0.05, "the picture is blank")

    def test_says_that_there_is_no_server(self):
        run = self.run_example("--deadline", "1")
        self.assertEqual(run.returncode, 1)
        self.assertFalse(self.picture.exists())
        self.assertNotIn("Traceback", run.stdout)
        self.assertRegex(run.stdout, "plot_distribution.py: .*server")


if __name__ == "__main__":
    unittest.main()
