"""Pages of the site that live at the repository's root, where readers look for them."""

from pathlib import Path

import mkdocs_gen_files

ROOT = Path(__file__).parents[2]
PAGES = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changes.md"}

for source, page in PAGES.items():
    with mkdocs_gen_files.open(f"project/{page}", "w") as file:
        file.write((ROOT / source).read_text("utf-8"))
