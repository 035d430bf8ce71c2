"""What `make setup` would install, and the list of what it installs."""

import os
import re
import shutil
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, distribution

import pytest

from documented_pages import DOCS, ROOT

sys.path.append(str(DOCS / "build"))  # scripts of the site, which are no package
import third_party

CPU_INDEX = "https://download.pytorch.org/whl/cpu"
ROW = re.compile(r"^\| ([\w.-]+) \| ([\w.]+) \| (.+) \|$", re.MULTILINE)
LISTED = {
    name: (version, licence)
    for name, version, licence in ROW.findall(third_party.PAGE.read_text("utf-8"))
    if name != "package"  # the head of the table
}


def setup_would_run(*arguments: str) -> str:
    make = shutil.which("make")
    if make is None:
        pytest.skip("no make on this machine")
    command = [make, "--dry-run", "--always-make", "setup", *arguments]
    # nothing of the `make test TORCH=pypi` that may have started this
    ours = {k: v for k, v in os.environ.items() if not k.startswith(("MAKE", "TORCH"))}
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=True, env=ours
    ).stdout


def test_setup_takes_the_cpu_build_of_torch_if_its_index_is_there() -> None:
    found = setup_would_run()
    tried = found.index(f'urlopen("{CPU_INDEX}/torch/"')
    taken = found.index(f'&& echo "--extra-index-url {CPU_INDEX}"')
    assert tried < taken < found.index("pip install")


def test_setup_takes_what_pypi_has_if_told_to() -> None:
    assert "download.pytorch.org" not in setup_would_run("TORCH=pypi")


def test_the_list_of_third_party_packages_is_current() -> None:
    versions = {name: version for name, (version, _) in LISTED.items()}
    assert versions == third_party.pinned(), "run docs/build/third_party.py"


@pytest.mark.parametrize("name", LISTED)
def test_a_licence_is_the_one_that_the_package_states(name: str) -> None:
    version, stated = LISTED[name]
    try:
        found = distribution(name)
    except PackageNotFoundError:
        pytest.skip("not installed here")
    if found.version.partition("+")[0] != version:
        pytest.skip("another version is installed here")
    named = third_party.BY_HAND.get(name)
    assert stated == (named or third_party.licence(found))
