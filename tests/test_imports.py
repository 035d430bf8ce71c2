"""What is imported when: nobody waits for what he has not asked for."""

import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import physgnn

SOURCE = Path(physgnn.__file__).parent
PACKAGES = [
    ".".join(("physgnn", *stub.parent.relative_to(SOURCE).parts))
    for stub in sorted(SOURCE.rglob("__init__.pyi"))
]
FOR_OTHERS = {"torch", "matplotlib", "SimpleITK", "nibabel", "skimage", "zarr", "dask"}


def imported_by(program: str) -> set[str]:
    """Return the packages that a program has imported at its end."""
    program += (
        "\nimport sys; print(*{name.split('.')[0] for name in sys.modules}, "
        "*{'scipy.stats'} & set(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize("package", PACKAGES)
def test_what_a_package_exports_is_there(package: str) -> None:
    module = import_module(package)
    assert module.__all__
    for name in module.__all__:
        assert getattr(module, name) is not None


@pytest.mark.parametrize("command", ["", "predict", "register", "train"])
def test_help_imports_no_numerics(command: str) -> None:
    program = f"""
import sys
from physgnn.cli.app import run
sys.argv = ["physgnn", *"{command} --help".split()]
try:
    run()
except SystemExit:
    pass
"""
    assert not imported_by(program) & {"numpy", *FOR_OTHERS}


def test_a_wrong_suffix_is_said_before_the_model_is_loaded(tmp_path: Path) -> None:
    load = tmp_path / "load.json"
    load.write_text("{}")
    program = f"""
import physgnn
try:
    physgnn.predict(None, {str(load)!r}, {str(tmp_path / "out.xyz")!r})
except physgnn.InputError as error:
    assert "out.xyz" in str(error)
"""
    assert not imported_by(program) & {"numba", "scipy", *FOR_OTHERS}


def test_a_registration_imports_nothing_for_networks_or_images() -> None:
    program = """
import physgnn.stages.patient.intraoperative.registration
import physgnn.registration.registrar
"""
    assert not imported_by(program) & {"scipy.stats", *FOR_OTHERS}  # which takes 1 s
