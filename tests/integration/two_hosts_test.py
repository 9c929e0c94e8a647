"""docs/operations.md, "Two hosts, from nothing to a secured fetch": its commands, each on its host. A host is a network namespace with
a folder of its own; a pair of virtual interfaces is the cable. And what another host may do without security."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
import unittest
from typing import NamedTuple

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
PROGRAMS = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
CHAPTER = "Two hosts, from nothing to a secured fetch"
UNSHARED = "KINSHIP_TEST_IS_UNSHARED"


def commands_of_hosts() -> "list[list[str]]":
    """Of the chapter's blocks: first the server's, then the robot's."""
    text = (SOURCE / "docs" / "operations.md").read_text()
    chapter = re.search(rf"^## {CHAPTER}\n(.*?)^## ", text, re.M | re.S).group(1)
    return [re.findall(r"^\$ (.*)$", block, re.M) for block in re.findall(r"```console\n(.*?)```", chapter, re.S)]


class Host:
    """A network namespace, held by a process that waits for its input to end."""

    def __init__(self, folder: pathlib.Path, address: str):
        self.folder = folder
        self.holder = subprocess.Popen(["unshare", "--net", "sh", "-c", "echo here; exec cat >/dev/null"],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.holder.stdout.readline()  # it is in its namespace
        self.address = address
        folder.mkdir()
        for name in ("docs", "robots"):
            (folder / name).symlink_to(SOURCE / name)
        # The other host's folder stands for its disk.
        (folder / "scp").write_text('#!/bin/sh\nexec cp -r "$2" "../${3%%:*}/${3#*:}"\n')
        (folder / "scp").chmod(0o755)
        self.shell = None

    def command(self, script: str) -> "list[str]":
        return ["nsenter", "--target", str(self.holder.pid), "--net", "bash", "-e", "-c", script]

    def environment(self) -> "dict[str, str]":
        return {"PATH": f"{self.folder}:{PROGRAMS}:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": str(self.folder)}

    def run(self, script: str, timeout: float = 120) -> subprocess.CompletedProcess:
        return subprocess.run(self.command(script), cwd=self.folder, env=self.environment(), text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=timeout)

    def configure_network(self) -> None:
        done = self.run(f"ip address add {self.address}/24 dev eth0 && ip link set eth0 up && ip link set lo up")
        if done.returncode != 0:
            raise RuntimeError(done.stdout)

    def wait_for_link(self) -> None:
        """The kernel notes up to a second late that a cable is there. A node of Fast DDS that starts before never uses it."""
        self.run("until ip -brief link show eth0 | grep -q ' UP '; do sleep 0.02; done", timeout=30)

    def end(self) -> None:
        self.holder.stdin.close()
        self.holder.wait()
        self.holder.stdout.close()


# Prints what a command says, and the packets of RTPS that its host receives meanwhile, also from itself, in the kernel's order.
# (Cyclone DDS captures a packet after it has sent it: another thread's, sent after the answer, may be captured before.)
CAPTURE = """
import json, socket, subprocess, sys
capture = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(0x0800))  # IPv4
capture.settimeout(0.2)
command = subprocess.Popen(sys.argv[1:], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
packets, is_over = [], False
while not is_over:
    has_ended = command.poll() is not None
    try:
        packet = capture.recv(65536)
        if packet[28:32] == b"RTPS":
            packets.append((int.from_bytes(packet[22:24], "big"), packet[28:].hex()))
    except socket.timeout:
        is_over = has_ended
print(json.dumps({"said": command.stdout.read(), "packets": packets}))
"""


class Capture(NamedTuple):
    said: str
    sent: "list[tuple[int, bytes]]"  # port of the server, packet
    server: bytes                    # its GUID prefix


def capture(host: Host, command: str) -> Capture:
    """A client's command on a host. `sent` is empty if the server runs on another one."""
    (host.folder / "capture.py").write_text(CAPTURE)
    captured = json.loads(host.run(f"python3 capture.py {command}").stdout)
    packets = [(port, bytes.fromhex(packet)) for port, packet in captured["packets"]]
    is_to_server = [7400 <= port < 7500 for port, _ in packets]  # a client has a port that the kernel chose
    return Capture(captured["said"], [packet for packet, sent in zip(packets, is_to_server) if sent],
                   [packet[8:20] for (_, packet), sent in zip(packets, is_to_server) if not sent][-1])


# As blind as an attacker without an answer; slowly enough for a busy server to follow.
REPLAY = """
import socket, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
for port, packet in {packets!r}:
    sender.sendto(bytes.fromhex(packet), ("10.77.0.1", port))
    time.sleep(0.02)
"""


class TwoHosts(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        root = pathlib.Path(temporary.name)
        self.server = Host(root / "10.77.0.1", "10.77.0.1")
        self.addCleanup(self.server.end)
        self.robot = Host(root / "10.77.0.2", "10.77.0.2")
        self.addCleanup(self.robot.end)
        subprocess.run(["ip", "link", "add", "eth0", "netns", str(self.server.holder.pid), "type", "veth", "peer", "name",
                        "eth0", "netns", str(self.robot.holder.pid)], check=True)
        for host in (self.server, self.robot):
            host.configure_network()
        for host in (self.server, self.robot):
            host.wait_for_link()
        self.of_server, self.of_robot = commands_of_hosts()

    def start_server(self) -> None:
        *before, serve = self.of_server
        done = self.server.run("\n".join(before))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.serve(serve)

    def serve(self, serve: str, host: "Host | None" = None) -> None:
        host = host or self.server
        log = open(host.folder / "kinshipd.log", "w")
        self.addCleanup(log.close)
        kinshipd = subprocess.Popen(host.command("exec " + serve), cwd=host.folder, stdout=subprocess.PIPE,
                                    env=host.environment(), stderr=log, text=True)
        self.addCleanup(kinshipd.stdout.close)
        self.addCleanup(kinshipd.wait)
        self.addCleanup(kinshipd.terminate)
        first_line = kinshipd.stdout.readline()
        self.assertTrue(first_line.startswith("ready "), first_line + (host.folder / "kinshipd.log").read_text())

    def test_commands_lead_to_a_secured_fetch(self):
        self.start_server()
        done = self.robot.run("\n".join(self.of_robot))
        self.assertEqual(done.returncode, 0, done.stdout)
        guided = [json.loads(line) for line in (self.robot.folder / "guided.jsonl").read_text().splitlines()]
        self.assertTrue(any(result["guidance"] for result in guided), guided[0])
        key = self.robot.folder / "arm_7" / "key.pem"
        self.assertEqual(key.stat().st_mode & 0o777, 0o600)
        self.assertFalse((self.robot.folder / "arm_7" / "ca.key").exists(), "who holds it admits anybody")

    def test_without_credentials_there_is_no_server(self):
        self.start_server()
        status = "kinship --server 10.77.0.1 --timeout 3 status"
        self.server.run("kinshipd secure add desk --security security --role reader --out ../10.77.0.2/desk")
        self.assertEqual(self.robot.run("kinship --security desk " + status.removeprefix("kinship ")).returncode, 0)
        wrong_role = self.robot.run("kinship --security arm_7 " + status.removeprefix("kinship "))
        self.assertEqual(wrong_role.returncode, 2, wrong_role.stdout)
        self.assertIn("role 'robot'", wrong_role.stdout)
        self.assertEqual(self.robot.run(status).returncode, 4)
        made = self.robot.run("kinshipd secure init rogue; kinshipd secure add arm_7 --security rogue --role admin --out forged")
        self.assertEqual(made.returncode, 0, made.stdout)
        forged = self.robot.run("kinship --security forged " + status.removeprefix("kinship "))
        self.assertEqual(forged.returncode, 4, forged.stdout)

    def test_without_security_another_host_reads_and_reports_and_changes_nothing(self):
        (self.server.folder / "backups").mkdir()
        self.serve("kinshipd --interface eth0 --insecure --backup-folder backups --store fleet.db")
        of_robot = [command for command in self.of_robot if "guided" not in command]
        done = self.robot.run("\n".join(of_robot).replace("KINSHIP_SECURITY=", "UNUSED="))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.robot.run("kinship --server 10.77.0.1 distributions fetch --robot ur10e --task load_machine --wait 30")

        def listed(noun: str) -> "list[dict]":
            return json.loads(self.robot.run(f"kinship --server 10.77.0.1 {noun} list --json").stdout)["rows"]

        paths, distributions = listed("paths"), listed("distributions")
        self.assertTrue(paths and distributions, "it has reported and fetched")
        changes = [f"paths retire {paths[0]['report_uuid']} --yes",
                   f"paths restore {paths[0]['report_uuid']}", f"distributions evict {distributions[0]['id']}",
                   "backup night.db", "robots rename ur10e arm", "tasks reset load_machine --yes",
                   "robots remove ur10e --yes"]
        for host in (self.robot, self.server):  # also on the server's own machine
            for change in changes:
                refused = host.run(f"kinship --server 10.77.0.1 {change}")
                self.assertNotIn(refused.returncode, (0, 4), change)
                self.assertIn("this server serves other hosts without security, where that needs its token", refused.stdout)
        self.assertEqual((listed("paths"), listed("distributions")), (paths, distributions))
        self.assertEqual(list((self.server.folder / "backups").iterdir()), [])
        self.assertEqual([robot["label"] for robot in listed("robots")], ["ur10e"])
        # With a copy of the token each of them is done, from wherever.
        token = self.server.folder / "fleet.db.token"
        self.assertEqual(token.stat().st_mode & 0o777, 0o600)
        shutil.copy(token, self.robot.folder / "token")
        for host, shown, change in zip((self.robot, self.server) * 4, ("token", "fleet.db.token") * 4, changes):
            done = host.run(f"KINSHIP_TOKEN={shown} kinship --server 10.77.0.1 {change.replace('remove ur10e', 'remove arm')}")
            self.assertEqual(done.returncode, 0, f"{change}: {done.stdout}")
        self.assertEqual(listed("robots"), [])
        self.assertTrue((self.server.folder / "backups" / "night.db").exists())
        (self.robot.folder / "token").write_text("0" * 64 + "\n")
        wrong = self.robot.run("kinship --server 10.77.0.1 --token token tasks reset load_machine --yes")
        self.assertIn("the proof of the token is wrong", wrong.stdout)
        said = self.server.run("kinship --server 10.77.0.1 audit -o wide").stdout
        self.assertIn("address 10.77.0.2, token shown", said)
        self.assertIn("this machine, by packet address 10.77.0.1, token shown", said)

    def test_ros_nodes_of_another_host_are_found_by_multicast(self):
        """Neither side is told the other's address."""
        self.serve("kinshipd --interface eth0 --insecure --ros2 --ros2-domain 5 --store fleet.db")
        for seed, middleware in enumerate(("cyclone", "fastdds")):
            node = f"ROS_LOCALHOST_ONLY=0 {PROGRAMS.parent}/tests/ros_peer_{middleware} 5"
            done = self.robot.run(f"{node} register urdf=robots/models/ur10e/robot.urdf label=arm base=base_link tip=tool0")
            self.assertEqual(done.returncode, 0, middleware + ": " + done.stdout)
            _, status, robot, joints = done.stdout.split()
            self.assertIn(status, ("0", "1"), "stored, or known since the other one")
            done = self.robot.run(f"{node} report robot={robot} joints={joints} seed={seed}")
            self.assertTrue(done.stdout.startswith("receipt 0 "), middleware + ": " + done.stdout)

    def test_replayed_packets_of_a_lab_are_not_of_the_servers_machine(self):
        """The robot's host captures how a reset is done on the server's machine, in a lab of its own with the server's address."""
        serve = "kinshipd --interface eth0 --insecure --store fleet.db"
        self.serve(serve)
        of_robot = [command for command in self.of_robot if "guided" not in command]
        report = "\n".join(of_robot).replace("KINSHIP_SECURITY=", "UNUSED=")
        done = self.robot.run(report)
        self.assertEqual(done.returncode, 0, done.stdout)
        paths = self.robot.run("kinship --server 10.77.0.1 paths list --json").stdout
        self.assertNotEqual(json.loads(paths)["rows"], [])
        target = capture(self.robot, "kinship --server 10.77.0.1 status")

        lab = Host(self.robot.folder.parent / "lab", "10.77.0.1")
        self.addCleanup(lab.end)
        lab.run("ip link add eth0 type veth peer name eth1 && ip link set eth1 up")
        lab.configure_network()
        self.serve(serve, lab)
        done = lab.run(report)
        self.assertEqual(done.returncode, 0, done.stdout)
        captured = capture(lab, "kinship --server 10.77.0.1 tasks reset load_machine --yes")
        self.assertIn("a client on this machine may not reset tasks", captured.said)
        # Each of the server's ports has a thread of its own: its order is kept, and that of the first port is discovery's. What
        # takes something back (DATA with a key and without data) comes last.
        in_order = sorted(captured.sent, key=lambda each: (bool(re.search(rb"\x15\x0b..\0\0\x10\0", each[1], re.S)), each[0]))
        replay = [(port, packet.replace(captured.server, target.server)) for port, packet in in_order]
        (self.robot.folder / "replay.py").write_text(REPLAY.format(packets=[(port, packet.hex()) for port, packet in replay]))

        def acts() -> "list[dict]":
            return json.loads(self.server.run("kinship --server 10.77.0.1 audit --json").stdout)["rows"]

        end = time.monotonic() + 20
        while not acts() and time.monotonic() < end:  # a busy server may miss what comes only once
            done = self.robot.run("python3 replay.py")
            self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual(self.robot.run("kinship --server 10.77.0.1 paths list --json").stdout, paths)
        self.assertEqual({(act["verb"], act["outcome"], act["is_local"]) for act in acts()}, {("reset_task", "refused", False)})
        self.assertIn(", address 10.77.0.2", acts()[0]["client"])


if __name__ == "__main__":
    if not os.environ.get(UNSHARED):
        # Who is not root is, among namespaces of his own, where the kernel lets him.
        alone = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--map-root-user", "--net"]
        if not shutil.which("ip") or subprocess.run([*alone, "true"], stderr=subprocess.DEVNULL).returncode != 0:
            print("SKIPPED: no network namespace may be made here")
            raise SystemExit(77)
        os.execvpe(alone[0], [*alone, "python3", "-B", __file__], {**os.environ, UNSHARED: "1"})
    unittest.main()
