"""Kill a command at random moments until it ends, and compare what it leaves.

    python tests/faults/kills.py --count 300

`simulate` is killed on a small mesh, with one process and with two; the store that is
left must have the content of one that nobody disturbed. The demonstration's pipeline is
killed the same way with ``--what demo``; it must end, and its files be there.
"""

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from meshes import block_mesh
from physgnn.dataset import Store, verification_of
from physgnn.io import write_mesh

LOADS = """
[materials.brain]
youngs_modulus_pa = 3000
poissons_ratio = 0.45
[materials.tumour]
youngs_modulus_pa = 7500
poissons_ratio = 0.45
[loads]
total_force_n = 0.002
paths = {paths}
levels = 3
seed = 1
"""
PHYSGNN = (sys.executable, "-c", "from physgnn.cli import command; command()")


@dataclass(frozen=True)
class Outcome:
    """What so many kills left: how many there were, and what is wrong, if anything."""

    kills: int
    faults: tuple[str, ...]


def run_once(command: list[str], seconds: float | None) -> int:
    """Run a command; kill it and its processes after some seconds, unless None.

    Returns the exit status, negative if it was killed.
    """
    run = subprocess.Popen(
        command,
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        _, said = run.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        os.killpg(run.pid, signal.SIGKILL)
        run.communicate()
        return -signal.SIGKILL
    if run.returncode:
        raise AssertionError(f"{' '.join(command)} ended with {run.returncode}: {said}")
    return run.returncode


def killed_until_done(
    command: list[str], rng: random.Random, most: int, longest: float
) -> int:
    """Run a command, killed after 0 to `longest` seconds, until it ends.

    After `most` kills it runs undisturbed. Returns how often it was killed.
    """
    for kills in range(most):
        if run_once(command, rng.uniform(0.0, longest)) == 0:
            return kills
    run_once(command, None)
    return most


def kill_simulate(count: int, seed: int, folder: Path, *, paths: int = 24) -> Outcome:
    """Kill `simulate` so many times, over as many stores as that takes."""
    mesh, loads = folder / "block.vtu", folder / "loads.toml"
    write_mesh(mesh, block_mesh(3, jitter=0.15))
    loads.write_text(LOADS.format(paths=paths))

    def command(store: Path, workers: int) -> list[str]:
        given = (mesh, "--loads", loads, "-o", store, "--workers", workers)
        return [*PHYSGNN, "simulate", *map(str, given)]

    undisturbed = folder / "undisturbed.zarr"
    begun = time.monotonic()
    run_once(command(undisturbed, 1), None)
    longest = 1.2 * (time.monotonic() - begun)
    expected = Store.open(undisturbed)
    rng, kills, faults = random.Random(seed), 0, []
    for number in range(count):
        if kills >= count:
            break
        store = folder / f"{number}.zarr"
        workers = 1 + number % 2
        most = min(5, count - kills)
        kills += killed_until_done(command(store, workers), rng, most, longest)
        faults += differences(Store.open(store), expected)
        faults += [f"{left}: left over" for left in strays(folder)]
        print(f"{number + 1} stores, {kills} kills, {len(faults)} faults", flush=True)
        shutil.rmtree(store)
    return Outcome(kills, tuple(faults))


def differences(store: Store, expected: Store) -> list[str]:
    """Return what is wrong with a store that was made under kills."""
    checked, all_checked = verification_of(store), verification_of(expected)
    reasons = (
        (len(store.pending()), "paths are pending"),
        (store.content_hash() != expected.content_hash(), "the content differs"),
        (len(checked.samples) != len(all_checked.samples), "paths are not checked"),
        (
            any(
                (store.displacement(i) != expected.displacement(i)).any()
                for i in range(store.n_paths)
            ),
            "displacements differ",
        ),
    )
    return [f"{store.path}: {reason}" for wrong, reason in reasons if wrong]


def strays(folder: Path) -> list[Path]:
    """Return what writers left beside its place, now that the last run has ended.

    Zarr's unfinished chunks, under random names, are removed once they are a minute
    old, by the next run that writes to the store.
    """
    return [*folder.glob(".*")]


def kill_demo(count: int, seed: int, folder: Path) -> Outcome:
    """Kill the demonstration so many times, then let it end."""
    out = folder / "demo"
    command = [*PHYSGNN, "demo", str(out)]
    kills = killed_until_done(command, random.Random(seed), count, 60.0)
    faults = () if (out / "report.html").is_file() else (f"{out}: no report.html",)
    return Outcome(kills, faults)


def main() -> None:
    """Parse, kill, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300, help="How many kills.")
    parser.add_argument("--seed", type=int, default=0, help="Of their moments.")
    parser.add_argument("--what", choices=("simulate", "demo"), default="simulate")
    given = parser.parse_args()
    kill = kill_simulate if given.what == "simulate" else kill_demo
    with tempfile.TemporaryDirectory(prefix="physgnn-kills-") as folder:
        outcome = kill(given.count, given.seed, Path(folder))
    print(f"{outcome.kills} kills, {len(outcome.faults)} faults")
    print(*outcome.faults, sep="\n")
    sys.exit(bool(outcome.faults))


if __name__ == "__main__":
    main()
