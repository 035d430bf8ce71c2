"""Compiled kernels go when a source file is newer, and stay when none is."""

import os

from physgnn.mechanics.kernel_cache import drop_stale_kernels


def test_only_stale_kernels_are_dropped(tmp_path):
    source, other = tmp_path / "element.py", tmp_path / "materials" / "table.py"
    cached = tmp_path / "__pycache__" / "element.force-1.py311.nbi"
    for file, time in ((source, 100), (other, 100), (cached, 200)):
        file.parent.mkdir(exist_ok=True)
        file.write_text("")
        os.utime(file, (time, time))
    assert drop_stale_kernels(tmp_path) == 0 and cached.exists()
    os.utime(other, (300, 300))
    assert drop_stale_kernels(tmp_path) == 1 and not cached.exists()
    assert source.exists() and other.exists()
