"""The rules of deploy/docker/Dockerfile that can be held without a container engine."""
import json
import os
import pathlib
import re
import subprocess
import unittest

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
PROGRAMS = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
KNOWN = {"FROM", "WORKDIR", "COPY", "RUN", "USER", "VOLUME", "STOPSIGNAL", "HEALTHCHECK", "ENTRYPOINT", "EXPOSE"}


def read_stages(text: str) -> "list[list[tuple[str, str]]]":
    """Instructions with their arguments, by stage."""
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    stages = []
    for line in "\n".join(lines).replace("\\\n", " ").splitlines():
        if not line.strip():
            continue
        word, rest = line.split(maxsplit=1)
        if word == "FROM":
            stages.append([])
        stages[-1].append((word, " ".join(rest.split())))
    return stages


def problems_of(text: str) -> "list[str]":
    """What is wrong with a Dockerfile, in words."""
    stages = read_stages(text)
    found = []
    for word, rest in (instruction for stage in stages for instruction in stage):
        if word not in KNOWN:
            found.append(f"{word} is not used here")  # ADD, ENV, ARG: nothing is downloaded, no secret is given
        if word == "FROM" and not re.match(r"\S+:(?!latest\b)\S+( AS \w+)?$", rest):
            found.append(f"FROM {rest}: no tag")
        if word == "RUN" and "apt-get install" in rest:
            found += [f"RUN apt-get install without {part}" for part in
                      ("apt-get update", "--yes", "--no-install-recommends", "rm -rf /var/lib/apt/lists/*")
                      if part not in rest]
        if word == "RUN" and re.search(r"\b(curl|wget|pip|sudo|chmod)\b", rest):
            found.append(f"RUN {rest}: downloads or changes rights")
        if word == "ENTRYPOINT" and not rest.startswith("["):
            found.append("ENTRYPOINT is a shell's: signals do not reach the server")
    last = stages[-1]
    words = [word for word, _ in last]
    found += [f"the last stage has no {word}" for word in ("USER", "VOLUME", "HEALTHCHECK", "ENTRYPOINT") if word not in words]
    if "USER" in words:
        if dict(last)["USER"] in ("root", "0"):
            found.append("it runs as root")
        if "RUN" in words[words.index("USER"):]:
            found.append("something is installed after USER")
    return found


class Dockerfile(unittest.TestCase):
    text = (SOURCE / "deploy" / "docker" / "Dockerfile").read_text()

    def test_keeps_the_rules(self):
        self.assertEqual(problems_of(self.text), [])

    def test_the_rules_see_what_breaks_them(self):
        for good, bad in {"USER kinship\n": "", "USER kinship": "USER root", "debian:12-slim": "debian",
                          " --no-install-recommends": "", "STOPSIGNAL SIGTERM": "ENV TOKEN=x",
                          'ENTRYPOINT ["kinshipd", ': "ENTRYPOINT kinshipd #",
                          "apt-get update": "curl http://here"}.items():
            self.assertIn(good, self.text)
            self.assertNotEqual(problems_of(self.text.replace(good, bad)), [], f"{good!r} -> {bad!r}")

    def test_what_it_names_is_there(self):
        for word, rest in (instruction for stage in read_stages(self.text) for instruction in stage):
            if word == "COPY" and "--from" not in rest:
                for name in rest.split()[:-1]:
                    self.assertTrue((SOURCE / name).exists(), name)
            for name in re.findall(r"deploy/\S+", rest if word == "RUN" else ""):
                self.assertTrue((SOURCE / name).exists(), name)
        packages = re.findall(r"packages/([a-z0-9-]+)_\*\.deb", self.text)
        self.assertEqual(packages, ["kinship-server", "kinship-client"])
        for package in packages:
            self.assertTrue((SOURCE / "deploy" / "debian" / f"{package}.control").exists(), package)

    def test_its_programs_take_what_they_are_given(self):
        last = dict(read_stages(self.text)[-1])
        entry = json.loads(last["ENTRYPOINT"])
        self.assertEqual(entry[:3], ["kinshipd", "--config", "/etc/kinship/kinshipd.toml"])
        folder = entry.index("--backup-folder")
        options = ["--config", str(SOURCE / "deploy" / "etc" / "kinshipd.toml"), "--backup-folder", "/tmp"]
        self.assertEqual([*entry[3:folder], *entry[folder + 2:]], [])
        said = subprocess.run([PROGRAMS / "kinshipd", *options, "--print-config"], capture_output=True, text=True)
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertIn(f'store = "{last["VOLUME"]}/', said.stdout)
        check = json.loads(last["HEALTHCHECK"].split("CMD ")[1])
        asked = subprocess.run([PROGRAMS / check[0], *check[1:], "--help"], capture_output=True, text=True)
        self.assertEqual(asked.returncode, 0, asked.stderr)


if __name__ == "__main__":
    unittest.main()
