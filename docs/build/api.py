"""One page for each module of the package, found when the site is built."""

from pathlib import Path

import mkdocs_gen_files

ROOT = Path(__file__).parents[2] / "src"
HOME = Path("reference/api")

nav = mkdocs_gen_files.Nav()
for source in sorted((ROOT / "physgnn").rglob("*.py")):
    parts = list(source.relative_to(ROOT).with_suffix("").parts)
    if parts[-1] == "__init__":
        parts.pop()
    if any(part.startswith("_") for part in parts) or parts[1:2] == ["cli"]:
        continue
    is_package = source.name == "__init__.py"
    page = Path(*parts, "index.md") if is_package else Path(*parts).with_suffix(".md")
    nav[tuple(parts)] = page.as_posix()
    with mkdocs_gen_files.open(HOME / page, "w") as file:
        print(f"::: {'.'.join(parts)}", file=file)
    mkdocs_gen_files.set_edit_path(HOME / page, source)

with mkdocs_gen_files.open(HOME / "SUMMARY.md", "w") as file:
    file.writelines(nav.build_literate_nav())
