"""What tests of the pages share: where they are, and the blocks of code in them."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [
    *sorted(DOCS.rglob("*.md")),
    *(
        ROOT / name
        for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "THIRD_PARTY.md")
    ),
    ROOT / "benchmarks" / "README.md",
]
FENCE = re.compile(
    r"^(?:<!-- (?P<note>[^\n]*) -->\n)?^```(?P<language>\w*)(?P<rest>[^\n]*)\n"
    r"(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
SNIPPET = re.compile(r'^--8<-- "([^"]+)"$', re.MULTILINE)
TITLE = re.compile(r'title="([^"]+)"')


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, text, title, and the comment in the line before."""

    language: str
    text: str
    title: str | None
    note: str
    line: int


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def blocks(page: Path) -> list[Block]:
    """Return the fenced blocks of a page, in order."""
    text = SNIPPET.sub(
        lambda file: (ROOT / file[1]).read_text("utf-8").rstrip(),
        page.read_text("utf-8"),
    )
    found = []
    for match in FENCE.finditer(text):
        title = TITLE.search(match["rest"])
        found.append(
            Block(
                match["language"],
                match["text"],
                title[1] if title else None,
                match["note"] or "",
                text[: match.start()].count("\n") + 1,
            )
        )
    return found


def command_lines(block: Block) -> Iterator[list[str]]:
    """Yield the words of every command of a block, comments and line ends joined."""
    for line in block.text.replace("\\\n", " ").splitlines():
        if words := shlex.split(line, comments=True):
            yield words
