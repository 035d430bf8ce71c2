"""What people wait for, beside peers: the benchmarks of speed, one after another.

    python benchmarks/bench.py -o bench --references febio/ --published paper/

Each runs in a process of its own, one after another; nothing else should run. Of each
the folder keeps what was printed and a JSON file: the command, the machine, seconds and
tables. What is there already is not run again. What needs files that were not named is
named instead. `--quick` leaves out the meshes of 100,000 points. Prints the tables.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tables import machine, table

HERE = Path(__file__).parent
REFERENCES, PUBLISHED = "--references", "--published"


@dataclass(frozen=True)
class Speed:
    """One benchmark of the row.

    Attributes
    ----------
    name : str
    what : str
        What is timed, and beside what.
    script : str
        Its file.
    arguments : tuple of str
        ``{references}``, ``{published}`` and ``{out}`` stand for these folders.
    quick : tuple of str, optional
        In place of the arguments, where there is little time.
    """

    name: str
    what: str
    script: str
    arguments: tuple[str, ...] = ()
    quick: tuple[str, ...] | None = None

    def needs(self) -> str | None:
        """Return the option without which it cannot run."""
        for option in (REFERENCES, PUBLISHED):
            if any(f"{{{option.strip('-')}}}" in word for word in self.arguments):
                return option
        return None


ROWS = (
    Speed(
        "commands",
        "from command to file, beside Python's own start; predictions, beside the "
        "linear solution",
        "waiting.py",
    ),
    Speed("estimates", "both error estimates of a prediction", "estimates.py"),
    Speed(
        "paths",
        "load paths, beside full Newton; in bulk",
        "fe.py",
        ("{references}", "--paths", "16"),
        quick=("{references}", "--paths", "4"),
    ),
    Speed(
        "laws",
        "laws, averaged tetrahedra beside linear ones, loads",
        "fe_costs.py",
        ("{references}/febio_ds2_path1.npz",),
    ),
    Speed(
        "growth",
        "load paths on finer and finer meshes",
        "fe_growth.py",
        quick=("--sizes", "10000", "30000"),
    ),
    Speed(
        "command-growth",
        "commands on finer and finer meshes",
        "command_growth.py",
        ("--out", "{out}/command-growth"),
        quick=("--out", "{out}/command-growth", "--sizes", "3000", "10000", "30000"),
    ),
    Speed(
        "physgnn",
        "PhysGNN, beside PyTorch Geometric",
        "physgnn_speed.py",
        ("{published}",),
    ),
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("bench"))
    parser.add_argument(
        REFERENCES, type=Path, help="reference cases, as fe.py takes them"
    )
    parser.add_argument(
        PUBLISHED, type=Path, help="published weights, as physgnn_speed.py takes them"
    )
    parser.add_argument("--only", nargs="+", choices=[row.name for row in ROWS])
    parser.add_argument("--quick", action="store_true")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    print(machine())
    for row in ROWS:
        if given.only and row.name not in given.only:
            continue
        print(f"\n## {row.name}: {row.what}\n", flush=True)
        needs = row.needs()
        if needs and getattr(given, needs.strip("-")) is None:
            print(f"Not run: it needs {needs} FOLDER.")
            continue
        show(measured(row, given))


def measured(row: Speed, given: argparse.Namespace) -> dict[str, Any]:
    """Return what a benchmark printed, of an earlier run if there was one."""
    kept = given.out / f"{row.name}.json"
    arguments = row.quick if given.quick and row.quick is not None else row.arguments
    folders = {
        name: getattr(given, name) for name in ("references", "published", "out")
    }
    command = [row.script, *(word.format(**folders) for word in arguments)]
    if kept.is_file():
        result: dict[str, Any] = json.loads(kept.read_text())
        if result["command"] == command:
            return result
    result = run(row, command, given.out / f"{row.name}.txt")
    fresh = kept.with_suffix(".part")
    fresh.write_text(json.dumps(result, indent=1))
    fresh.replace(kept)
    return result


def run(row: Speed, command: Sequence[str], printed: Path) -> dict[str, Any]:
    """Run a benchmark and read the tables that it prints."""
    start, load = time.perf_counter(), os.getloadavg()[0]
    with printed.open("w") as out:
        subprocess.run(
            [sys.executable, str(HERE / command[0]), *command[1:]],
            stdout=out,
            check=True,
        )
    return {
        **asdict(row),
        "command": list(command),
        "machine": machine(),
        "load_average_before": load,
        "seconds": round(time.perf_counter() - start, 1),
        "tables": list(tables_in(printed.read_text().splitlines())),
    }


def tables_in(lines: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Yield the Markdown tables of a text: the title above, columns, rows."""
    title, columns, rows = "", [], []
    for line in [*lines, ""]:
        if line.startswith("|"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if not columns:
                columns = cells
            elif not all(set(cell) <= set("-:") for cell in cells):
                rows.append(cells)
            continue
        if columns:
            yield {"title": title, "columns": columns, "rows": rows}
            title, columns, rows = "", [], []
        title = line.strip("# ") or title


def show(result: dict[str, Any]) -> None:
    """Print the tables of a result."""
    for kept in result["tables"]:
        print(f"{kept['title']}\n")
        table(kept["columns"], kept["rows"])
        print()
    print(f"{result['seconds']:.0f} s for all of it", flush=True)


if __name__ == "__main__":
    main()
