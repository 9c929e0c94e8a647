"""`import kinship` with credentials of `kinshipd secure`, against a kinshipd with security."""
import contextlib
import os
import pathlib
import shutil
import subprocess
import sys
import time
import unittest
import warnings

import kinship
from kinshipd_process import Kinshipd
from panda_sweeps import attempt

MODELS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "robots" / "models"

ORIGIN = [0, 0, 0, 0, 0, 0, 1]


def secure(*arguments):
    program = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinshipd"
    subprocess.run([program, "secure", *arguments], check=True, stdout=subprocess.DEVNULL)


class SecuredServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(Kinshipd())
        cls.fleet = cls.server.folder / "fleet"
        secure("init", cls.fleet)
        cls.server.start("--security", str(cls.fleet))
        cls.panda = kinship.Robot(MODELS / "panda")

    def add(self, name, *options, fleet=None, role="robot"):
        out = self.server.folder / (name + "_credentials")
        secure("add", name, "--security", fleet or self.fleet, "--role", role, "--out", out, *options)
        return out

    def open_client(self, timeout=20, **options):
        return self.enterContext(kinship.Client(
            domain=self.server.domain, outbox=self.server.folder / self.id(), timeout=timeout, **options))

    def with_environment(self, credentials):
        os.environ["KINSHIP_SECURITY"] = str(credentials)
        self.addCleanup(os.environ.pop, "KINSHIP_SECURITY", None)


class WhoHasCredentials(SecuredServer):
    def register_report_fetch(self, client, task):
        client.register(self.panda)
        for seed in range(4):
            client.report(attempt(self.panda, task, seed))
        state = client.flush(60)
        self.assertEqual((state.pending, state.refused), (0, 0), state.problem)
        distribution = client.fetch(task, self.panda, T_task_base=ORIGIN, deadline=120)
        self.assertEqual(distribution.provenance["sources"][0]["paths"], 4)

    def test_registers_reports_and_fetches(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a year is left
            client = self.open_client(security=self.add("arm_1"))
        self.assertEqual(client.expiry_warning, "")
        self.register_report_fetch(client, "named")
        with self.assertRaisesRegex(kinship.InvalidInput, "admin: not for the role 'robot'"):
            client.tasks()
        client.close()  # a process has one name in a domain
        reader = self.open_client(security=self.add("anna", role="reader"))
        self.assertIn(("named", 4), [(row["task"], row["paths"]) for row in reader.tasks()])

    def test_also_as_the_environment_says(self):
        self.with_environment(self.add("arm_2"))
        self.register_report_fetch(self.open_client(), "by_environment")

    def test_is_warned_thirty_days_ahead(self):
        credentials = self.add("arm_3", "--days", "20")
        with self.assertWarnsRegex(kinship.CredentialsExpire, "'arm_3' expire in (19|20) days.*kinshipd secure renew arm_3"):
            client = self.open_client(security=credentials)
        self.assertIn("'arm_3' expire in", client.expiry_warning)
        with warnings.catch_warnings():
            warnings.simplefilter("error", kinship.CredentialsExpire)
            with self.assertRaises(kinship.CredentialsExpire):
                kinship.Client(domain=self.server.domain, has_outbox=False, security=credentials)


class WhoHasNone(SecuredServer):
    def test_is_told_which_file_is_wrong(self):
        with self.assertRaisesRegex(kinship.NotFound, "nowhere.*key.pem"):
            self.open_client(security=self.server.folder / "nowhere")
        mixed = self.add("arm_4")
        shutil.copy(self.add("arm_5") / "certificate.pem", mixed / "certificate.pem")
        with self.assertRaisesRegex(kinship.InvalidInput, "key.pem: is not the key of certificate.pem"):
            self.open_client(security=mixed)
        self.with_environment(mixed)
        with self.assertRaisesRegex(kinship.InvalidInput, "key.pem: is not the key of certificate.pem"):
            self.open_client()


class WhoLoadedCycloneFirst(SecuredServer):
    def open_in_process(self, *before):
        """What a program says that opens a client after it did `before`."""
        credentials = self.add("arm_" + str(8 + len(before)))
        lines = [*before, "import kinship", "try:",
                 f"    kinship.Client(domain={self.server.domain}, has_outbox=False, security={str(credentials)!r})",
                 "    print('opened')", "except kinship.InvalidInput as error:", "    print(error)"]
        return subprocess.run([sys.executable, "-c", "\n".join(lines)], check=True, text=True,
                              stdout=subprocess.PIPE).stdout

    def test_is_refused_as_nobody_would_check_what_others_say_of_their_writers(self):
        self.assertEqual(self.open_in_process(), "opened\n")
        self.assertIn("cannot join with security: this process loaded Cyclone DDS",
                      self.open_in_process("import ctypes", "ctypes.CDLL('libddsc.so.0debian')"))


class WhoMayNot(SecuredServer):
    def test_is_told_who_what_and_why(self):
        client = self.open_client(security=self.add("arm_6", "--task", "shelf_*"))
        client.register(self.panda)
        with self.assertRaisesRegex(kinship.Refused, "arm_6 .role robot. may not fetch for task 'bin'"):
            client.fetch("bin", self.panda, T_task_base=ORIGIN, deadline=20)
        for ask in (client.fetch, client.guidance):
            with self.assertRaisesRegex(kinship.Refused, "T_task_base is not given.*not for the role 'robot'"):
                ask("shelf_1", self.panda, deadline=20)
        receipt, = client.deliver([attempt(self.panda, "bin", 1)])
        self.assertEqual(receipt.status, "refused")
        self.assertRegex(receipt.message, "arm_6 .role robot. may not report for task 'bin'")

    def test_nor_once_it_is_revoked(self):
        client = self.open_client(security=self.add("arm_7"))
        client.register(self.panda)
        secure("revoke", "arm_7", "--security", self.fleet)
        end = time.monotonic() + 10
        with self.assertRaisesRegex(kinship.Refused, "client 'arm_7': revoked at"):
            while time.monotonic() < end:  # the server looks at records once a second
                with contextlib.suppress(kinship.NoExperience):
                    client.fetch("never_done", self.panda, T_task_base=ORIGIN, deadline=1)
        with self.assertRaisesRegex(kinship.Refused, "client 'arm_7': revoked at"):
            client.register(self.panda)


if __name__ == "__main__":
    unittest.main()
