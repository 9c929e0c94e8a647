"""What the tests need to know of a Markdown document: fenced blocks, commands, code spans, headings and links."""
import dataclasses
import pathlib
import re

FENCE = re.compile(r"^(```+)\s*(\S*)\s*$")
MARK = re.compile(r"^<!--\s*(.*?)\s*-->$")


@dataclasses.dataclass
class Command:
    """A command of a console block and the output that the document shows for it."""

    line: int  # of its first line, from 1
    text: str  # without prompts, of several lines if it is continued
    output: "list[str]"
    output_line: int  # where the output begins


@dataclasses.dataclass
class Block:
    """A fenced block."""

    line: int  # of its opening fence, from 1
    language: str
    mark: str  # the comment on the line before the fence
    lines: "list[str]"

    def commands(self) -> "list[Command]":
        """Lines that begin with `$ `, continued after a backslash; what follows is their output."""
        commands = []
        for number, line in enumerate(self.lines, self.line + 1):
            if line.startswith("$ "):
                commands.append(Command(number, line[2:], [], number + 1))
            elif commands and commands[-1].text.endswith("\\"):
                commands[-1].text += "\n" + line
                commands[-1].output_line = number + 1
            elif commands:
                commands[-1].output.append(line)
        return commands


class Document:
    """A Markdown file, read once."""

    def __init__(self, path: pathlib.Path):
        self.path = path
        self.lines = path.read_text(encoding="utf-8").splitlines()
        self.blocks = []
        self.prose = []  # (line, text) of what is in no block
        fence, block = "", None
        for number, line in enumerate(self.lines, 1):
            found = FENCE.match(line)
            if block is None and found:
                fence = found[1]
                before = MARK.match(self.lines[number - 2]) if number > 1 else None
                block = Block(number, found[2], before[1] if before else "", [])
            elif block is not None and line.startswith(fence) and not line.strip("`"):
                self.blocks.append(block)
                block = None
            elif block is not None:
                block.lines.append(line)
            else:
                self.prose.append((number, line))
        if block is not None:
            raise ValueError(f"{path}:{block.line}: the block has no end")

    def indented_code(self) -> "list[tuple[int, str]]":
        """Lines of code by indentation; lines that continue an item of a list are not."""
        found, in_list, before = [], False, ""
        for number, line in self.prose:
            if re.match(r"\s{0,3}([-*+]|\d+\.)\s", line):
                in_list = True
            elif line and not line.startswith(" "):
                in_list = False
            is_code = line.startswith("    ") and not in_list and line.strip()
            if is_code and (not before.strip() or found and found[-1][0] == number - 1):
                found.append((number, line))
            before = line
        return found

    def spans(self) -> "list[tuple[int, str]]":
        """(line, text) of each code span; one may go on in the next line."""
        text = "\n".join(prose for _, prose in self.prose)
        return [(self.prose[text.count("\n", 0, found.start())][0], " ".join(found[1].split()))
                for found in re.finditer(r"`((?:[^`\n]|\n(?!\s*\n))+)`", text)]

    def links(self) -> "list[tuple[int, str]]":
        """(line, target) of each link and picture; also across a line's end, and of HTML's tags."""
        text = "\n".join(re.sub(r"`[^`]*`", "", prose) for _, prose in self.prose)
        found = [(match.start(1), match[1]) for pattern in (r"\]\(([^)\s]+)\)", r"(?:src|srcset|href)=\"([^\"]+)\"")
                 for match in re.finditer(pattern, text)]
        return [(self.prose[text.count("\n", 0, start)][0], target) for start, target in found]

    def anchors(self) -> "set[str]":
        """What a link may name behind its #, as GitHub makes it of headings."""
        seen, anchors = {}, set()
        for _, prose in self.prose:
            heading = re.match(r"#+\s+(.*?)\s*#*$", prose)
            if not heading:
                continue
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).lower()
            anchor = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            count = seen[anchor] = seen.get(anchor, -1) + 1
            anchors.add(f"{anchor}-{count}" if count else anchor)
        return anchors


def documents(root: pathlib.Path) -> "list[pathlib.Path]":
    """Every Markdown file of the project; folders of builds and hidden ones are not the project's."""
    return sorted(path for path in root.rglob("*.md")
                  if not any(part.startswith((".", "build")) for part in path.relative_to(root).parts[:-1]))
