"""A machine with the Debian packages of this build, and a person at it who has nothing of the sources but what these install."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
BUILD = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]).parent
PACKAGES = pathlib.Path(os.environ["KINSHIP_PACKAGES_DIR"])  # made of this build
HOME = pathlib.PurePosixPath("/home/you")
# What a person should not have to open: what the packages install is for programs, but their documents and examples.
OURS = re.compile(r"/usr/(share|lib|include)/(?!doc/)\S*kinship")

# The root of the machine is this one's under an overlay, without the sources and the build.
SET_UP = """
set -e
root=$1/root
mkdir -p $1/upper $1/work $1/empty $root
mount -t overlay overlay -o lowerdir=/,upperdir=$1/upper,workdir=$1/work $root
mount --rbind /dev $root/dev
mount -t proc proc $root/proc
mount -t tmpfs tmpfs $root/tmp
for hidden in "$2" "$3"; do [[ ! -d $root$hidden ]] || mount --bind $1/empty $root$hidden; done
mkdir -p $root/home/you
mkdir $root/tmp/packages
mount --bind $4 $root/tmp/packages
chroot $root sh -c 'cd /tmp/packages && dpkg --install "$@"' sh "${@:5}" >$1/install.log 2>&1 || { cat $1/install.log; exit 1; }
umount $root/tmp/packages
echo installed
exec cat >/dev/null
"""


def can_make_machines() -> bool:
    """Whether mounts, process and network namespaces, and overlays may be made here."""
    with tempfile.TemporaryDirectory() as folder:
        script = f"cd {folder} && mkdir u w m && mount -t overlay overlay -o lowerdir=/,upperdir=u,workdir=w m"
        tried = subprocess.run(["unshare", "--mount", "--pid", "--net", "--fork", "sh", "-c", script], capture_output=True)
        return tried.returncode == 0 and shutil.which("ip") is not None


class InstalledMachine:
    """Use as a context: at its end its processes end, and all that was written on it is gone."""

    def __init__(self, *names: str):
        """:param names: of the packages to install."""
        files = [next(PACKAGES.glob(f"{name}_*.deb")).name for name in names]
        self._folder = tempfile.TemporaryDirectory(prefix="kinship-machine-")
        self.folder = pathlib.Path(self._folder.name)
        self._holder = subprocess.Popen(
            ["unshare", "--mount", "--pid", "--net", "--fork", "--kill-child", "bash", "-c", SET_UP, "bash", self.folder, SOURCE, BUILD,
             PACKAGES, *files], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        first = self._holder.stdout.readline()
        if first != "installed\n":
            raise RuntimeError(f"{names} cannot be installed: {first}{self._holder.stdout.read()}")
        self.pid = int(pathlib.Path(f"/proc/{self._holder.pid}/task/{self._holder.pid}/children").read_text().split()[0])
        self.run_as_root("ip link set lo up")

    def command(self, script: str) -> "list[str]":
        """For subprocess: a script in a shell of this machine, in the person's folder."""
        return ["nsenter", "--target", str(self.pid), "--mount", "--pid", "--net", "chroot", str(self.folder / "root"),
                "env", "--ignore-environment", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", f"HOME={HOME}", "LANG=C.UTF-8", "COLUMNS=80",
                "bash", "-c", f"cd {HOME}; {script}"]

    def run_as_root(self, script: str) -> None:
        done = subprocess.run(self.command(script), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode != 0:
            raise RuntimeError(f"{script}: exit code {done.returncode}\n{done.stdout}")

    def connect(self, other: "InstalledMachine", address: str, other_address: str) -> None:
        """A cable between two machines: eth0 on both."""
        subprocess.run(["ip", "link", "add", "eth0", "netns", str(self.pid), "type", "veth", "peer", "name", "eth0", "netns",
                        str(other.pid)], check=True)
        for machine, its in ((self, address), (other, other_address)):
            machine.run_as_root(f"ip address add {its}/24 dev eth0 && ip link set eth0 up")

    def home(self) -> pathlib.Path:
        """The person's folder, as seen from outside."""
        return pathlib.Path(f"/proc/{self.pid}/root") / str(self.folder / "root").lstrip("/") / str(HOME).lstrip("/")

    def __enter__(self) -> "InstalledMachine":
        return self

    def __exit__(self, *exception) -> None:
        self._holder.stdin.close()
        self._holder.wait()
        self._holder.stdout.close()
        self._folder.cleanup()


class Person:
    """Who types commands at a machine, and is told what they print."""

    def __init__(self, machine: InstalledMachine, walk: "Walk"):
        self.machine = machine
        self._walk = walk
        self._exports = ""
        self._servers = []

    def export(self, **variables: str) -> None:
        """In the shells from now on."""
        self._exports += "".join(f"export {name}={value}; " for name, value in variables.items())

    def run(self, command: str, exit_code: int = 0) -> str:
        """:return: both outputs."""
        self._walk.require_own(command)
        begun = time.monotonic()
        done = subprocess.run(self.machine.command(self._exports + command), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              stdin=subprocess.DEVNULL)
        self._walk.count(command, time.monotonic() - begun)
        if done.returncode != exit_code:
            raise AssertionError(f"$ {command}\nexit code {done.returncode}, not {exit_code}:\n{done.stdout}")
        return done.stdout

    def serve(self, command: str) -> subprocess.Popen:
        """In a terminal of its own, until it says that it serves; its log goes to kinshipd.log."""
        self._walk.require_own(command)
        begun = time.monotonic()
        server = subprocess.Popen(self.machine.command(f"{self._exports}exec {command} 2>>kinshipd.log"), text=True, stdout=subprocess.PIPE)
        self._servers.append(server)
        line = server.stdout.readline()
        self._walk.count(command, time.monotonic() - begun)
        if not line.startswith("ready "):
            raise AssertionError(f"$ {command}\n{line}{self.read('kinshipd.log')}")
        return server

    def stop(self, server: subprocess.Popen) -> None:
        """Control-C."""
        inside = pathlib.Path(f"/proc/{server.pid}/task/{server.pid}/children").read_text().split()
        os.kill(int(inside[0]) if inside else server.pid, signal.SIGINT)
        if server.wait() != 0:
            raise AssertionError(f"the server ended with {server.returncode}:\n{self.read('kinshipd.log')}")
        server.stdout.close()
        self._servers.remove(server)

    def write(self, name: str, text: str) -> None:
        """With an editor: a file of the person's own."""
        file = self.machine.home() / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def read(self, name: str) -> str:
        return (self.machine.home() / name).read_text()

    def leave(self) -> None:
        for server in list(self._servers):
            self.stop(server)


class Walk:
    """The commands of a walk, and how long each took."""

    def __init__(self, name: str):
        self._name = name
        self._steps = []

    def require_own(self, command: str) -> None:
        if found := OURS.search(command):
            raise AssertionError(f"$ {command}\nneeds a look into a file of ours: {found[0]}")

    def count(self, command: str, seconds: float) -> None:
        self._steps.append((command, seconds))

    @property
    def commands(self) -> int:
        return len(self._steps)

    def told(self) -> str:
        """A line a command with its seconds, and the sum."""
        lines = [f"{seconds:7.1f} s  {' '.join(command.split())[:100]}" for command, seconds in self._steps]
        return "\n".join([*lines, f"{self._name}: {len(self._steps)} commands, {sum(seconds for _, seconds in self._steps):.1f} s"])
