"""Pages of the site that live elsewhere in the repository."""

from pathlib import Path

import mkdocs_gen_files

ROOT = Path(__file__).parents[2]
PAGES = {
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changes.md",
    "THIRD_PARTY.md": "third_party.md",
    "benchmarks/README.md": "benchmarks.md",
}

for source, page in PAGES.items():
    text = (ROOT / source).read_text("utf-8")
    for link, target in (*PAGES.items(), ("../docs/", "../"), ("docs/", "../")):
        text = text.replace(f"]({link}", f"]({target}")
    with mkdocs_gen_files.open(f"project/{page}", "w") as file:
        file.write(text)
