"""Nothing half written under its name when the disk is full, by every writer."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("full_disk.py")
OLD = b"an older good file"


def write_all(folder: Path, n_bytes: int) -> tuple[dict[str, str], str]:
    done = subprocess.run(
        [sys.executable, str(SCRIPT), str(folder), str(n_bytes)],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    results: dict[str, str] = json.loads(done.stdout)
    return results, done.stderr


def test_with_room_everything_is_written(tmp_path: Path) -> None:
    results, err = write_all(tmp_path, 0)
    assert set(results.values()) == {"written"}
    assert {file.name for file in tmp_path.iterdir()} == set(results)
    assert err == ""


@pytest.mark.skipif(sys.platform == "win32", reason="no limit on file sizes")
@pytest.mark.parametrize("n_bytes", [1, 700, 20_000])
def test_a_disk_that_ends_leaves_the_older_file(tmp_path: Path, n_bytes: int) -> None:
    names, _ = write_all(tmp_path, 0)
    files = {name for name in names if (tmp_path / name).is_file()}
    for name in names:
        if name in files:
            (tmp_path / name).write_bytes(OLD)
        else:  # a folder is never replaced
            shutil.rmtree(tmp_path / name)
    results, err = write_all(tmp_path, n_bytes)
    for name, result in results.items():
        start = f"cannot write {tmp_path / name}"
        assert re.match(re.escape(start) + r"(/[\w./-]+)?: ", result), (name, result)
        assert "\n" not in result
        assert name not in files or (tmp_path / name).read_bytes() == OLD
    assert {file.name for file in tmp_path.iterdir()} == files
    assert err == ""


@pytest.fixture
def tiny(tmp_path: Path) -> Path:
    """A file system of 64 kB, if this machine lets us mount one."""
    folder = tmp_path / "tiny"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)]
    if os.name != "posix" or os.geteuid() != 0:
        pytest.skip("only root may mount a small file system")
    if subprocess.run(mount, capture_output=True).returncode != 0:
        pytest.skip("this machine mounts no small file system")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_small_file_system(tiny: Path) -> None:
    results, err = write_all(tiny, 0)
    for name, result in results.items():
        assert result == "written" or result.startswith(f"cannot write {tiny / name}")
    refused = [name for name, result in results.items() if result != "written"]
    assert refused
    there = {file.name for file in tiny.iterdir()}
    assert there == set(results) - set(refused)
    assert err == ""
