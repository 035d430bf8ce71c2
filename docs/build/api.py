"""One page for each module of the package, found when the site is built.

The page of a package begins with the names that it exports, each with its first line
and a link to the module that defines it: they are imported there, so mkdocstrings
itself shows none of them.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

import mkdocs_gen_files

ROOT = Path(__file__).parents[2] / "src"
HOME = Path("reference/api")
DEFINITIONS = (ast.FunctionDef, ast.ClassDef)


def interface(folder: Path) -> Path:
    """Return the file that says what a package exports."""
    typed = folder / "__init__.pyi"
    return typed if typed.exists() else folder / "__init__.py"


def exports(folder: Path) -> Iterator[tuple[str, Path, str]]:
    """Yield the names of a package, where each comes from, and its name there."""
    text = interface(folder).read_text("utf-8")
    for node in ast.parse(text).body if "__all__" in text else ():
        if not isinstance(node, ast.ImportFrom) or node.module is None:
            continue
        if node.level == 0 and not node.module.startswith("physgnn."):
            continue
        source = (folder if node.level else ROOT) / node.module.replace(".", "/")
        for alias in node.names:
            if alias.name == "*":
                yield from exports(source)
            elif not (alias.asname or alias.name).startswith("_"):
                yield alias.asname or alias.name, source, alias.name


def definition(source: Path, name: str) -> tuple[str, str] | None:
    """Return where a name is defined, dotted, and its first line of documentation.

    None for what is no function or class, or is not documented.
    """
    if source.is_dir():
        again = [row for row in exports(source) if row[0] == name]
        return definition(*again[0][1:]) if again else None
    for node in ast.parse(source.with_suffix(".py").read_text("utf-8")).body:
        if isinstance(node, DEFINITIONS) and node.name == name:
            text = ast.get_docstring(node)
            where = ".".join([*source.relative_to(ROOT).parts, name])
            return None if text is None else (where, text.splitlines()[0])
    return None


def exported_names(folder: Path) -> Iterator[str]:
    """Yield the lines of a table of what a package exports."""
    rows = {name: definition(*origin) for name, *origin in exports(folder)}
    if rows:
        yield from ("", "| name | |", "|---|---|")
    for name, found in sorted(rows.items()):
        if found is None:
            yield f"| `{name}` | |"
        else:
            where, text = found
            text = text.replace("|", "\\|")
            yield f"| [`{name}`][{where}] | {text} |"


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
        if is_package:
            file.writelines(f"{line}\n" for line in exported_names(source.parent))
    mkdocs_gen_files.set_edit_path(HOME / page, source)

with mkdocs_gen_files.open(HOME / "SUMMARY.md", "w") as file:
    file.writelines(nav.build_literate_nav())
