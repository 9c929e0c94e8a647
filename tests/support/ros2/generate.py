#!/usr/bin/env python3
"""Runs rosidl on client/ros2/kinship_msgs and the messages of other packages that it uses.

generate.py OUT KINSHIP_MSGS FOREIGN makes in OUT
  messages.c        all C sources that rosidl's generators make, in one
  messages.h        all their headers
  ros_messages.idl  rosidl's IDL as DDS names the types, with a service's identity, for idlc
  copies.hpp        copy(ROS structure, idlc's structure), member by member, by the names in the .msg files
"""

import pathlib
import re
import shutil
import subprocess
import sys

ORDER = ["builtin_interfaces", "unique_identifier_msgs", "std_msgs", "geometry_msgs", "shape_msgs", "trajectory_msgs",
         "kinship_msgs"]
IDENTITY = "uint64 guid;\n      int64 sequence_number;\n"


def run(folder, *words):
    done = subprocess.run(["rosidl", *words], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)


def sources_of(folder, suffixes):
    return sorted(str(each.relative_to(folder)) for each in folder.rglob("*") if each.suffix in suffixes)


def generate(share, generated, package):
    folder = share / package
    run(folder, "translate", "--to", "idl", "-o", ".", package, *sources_of(folder, {".msg", ".srv"}))
    run(folder, "generate", "-o", str(generated / package), "-t", "c", "-ts", "introspection_c", "-I", str(share),
        package, *sources_of(folder, {".idl"}))


def snake(name):
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def fields(text):
    """Names of the members of a .msg text."""
    lines = (line.split("#")[0].strip() for line in text.splitlines())
    return [line.split()[1] for line in lines if line and not re.match(r"\w+ +\w+ *=", line)]


def structures(share):
    """(package, kind, name, members) of all messages, in order of use."""
    for package in ORDER:
        for file in sorted((share / package).glob("msg/*.msg")):
            yield package, "msg", file.stem, fields(file.read_text())
    for file in sorted((share / "kinship_msgs").glob("srv/*.srv")):
        for part, text in zip(("Request", "Response"), file.read_text().split("---\n")):
            yield "kinship_msgs", "srv", f"{file.stem}_{part}", fields(text)


def idlc_name(package, kind, name):
    if package == "kinship_msgs":
        return f"{package}_{kind}_dds__{name}_"
    return f"{package}_{kind}_{name}" + ("_" if name == "UUID" else "")


def copies(all_structures):
    pairs = [(f"{p}__{k}__{n}", idlc_name(p, k, n), members) for p, k, n, members in all_structures]
    head = "".join(f"void copy(const {ros}& from, {idlc}& to);\n" for ros, idlc, _ in pairs)
    body = "".join(f"inline void copy(const {ros}& from, {idlc}& to) {{\n" +
                   "".join(f"  copy(from.{member}, to.{member});\n" for member in members) + "}\n"
                   for ros, idlc, members in pairs)
    return head, body


def dds_idl(share):
    """rosidl's files one after the other, each before those that name it."""
    placed, text = set(), []

    def place(path):
        if path in placed:
            return
        placed.add(path)
        source = (share / path).read_text()
        for needed in re.findall(r'#include "(.*)"', source):
            place(needed)
        source = re.sub(r"^(#include|//).*$", "", source, flags=re.M)
        source = re.sub(r"module \w+_Constants \{.*?\n    \};\n", "", source, flags=re.S)
        source = re.sub(r"@verbatim \(.*?\)\n", "", source, flags=re.S)
        source = re.sub(r"@default \(.*?\)\n", "", source)
        if path.startswith("kinship_msgs"):
            source = re.sub(r"struct (\w+) \{", r"struct \1_ {", source)
            source = re.sub(r"(struct \w+_(?:Request|Response)_ \{\n)", r"\1      " + IDENTITY, source)
            source = re.sub(r"kinship_msgs::msg::(\w+)", r"kinship_msgs::msg::dds_::\1_", source)
            source = re.sub(r"(module (?:msg|srv) \{)", r"\1 module dds_ {", source)
            source = source.rstrip() + " };\n"
        text.append(source)

    for path in sorted((share / "kinship_msgs").rglob("*.idl")):
        place(str(path.relative_to(share)))
    typedefs = set()

    def once(match):
        is_first = match[0] not in typedefs
        typedefs.add(match[0])
        return match[0] if is_first else ""

    joined = re.sub(r"\bUUID\b", "UUID_", "".join(text))  # a name of proto/ros2's, with no member that differs in case
    return re.sub(r"^ *typedef .*\n", once, joined, flags=re.M)


def main():
    out, own, foreign = (pathlib.Path(each).resolve() for each in sys.argv[1:4])
    share, generated = out / "share", out / "generated"
    shutil.rmtree(share, ignore_errors=True)
    shutil.rmtree(generated, ignore_errors=True)
    shutil.copytree(foreign, share)
    for kind in ("msg", "srv"):
        shutil.copytree(own / kind, share / "kinship_msgs" / kind)
    for package in ORDER:
        generate(share, generated, package)
    headers = []
    for package, kind, name, _ in structures(share):
        file = snake(re.sub("_(Request|Response)$", "", name))
        headers += [f'#include "{package}/{kind}/{file}.h"',
                    f'#include "{package}/{kind}/detail/{file}__rosidl_typesupport_introspection_c.h"']
    parts = [f'#include "{each}"' for each in sorted(generated.rglob("*.c"))]
    (out / "messages.h").write_text("\n".join(dict.fromkeys(headers)) + "\n")
    (out / "messages.c").write_text("\n".join(parts) + "\n")
    (out / "ros_messages.idl").write_text(dds_idl(share))
    head, body = copies(list(structures(share)))
    (out / "copies.hpp").write_text(head + '#include "tests/support/ros2/copy.hpp"\n' + body)
    # One folder for the headers: generators put each kind of source into one of its own.
    include = out / "include"
    shutil.rmtree(include, ignore_errors=True)
    for package in ORDER:
        for kind in ("c", "introspection_c"):
            shutil.copytree(generated / package / kind, include / package, dirs_exist_ok=True)


main()
