"""A few bytes must not ask for much: bombs of every kind, and the bound on them."""

import gzip
import zipfile
from pathlib import Path

import nibabel as nib
import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.io import read_mesh, read_surface
from physgnn.io.febio.model_reader import read_febio
from physgnn.io.medical.images.formats import read_image, write_image
from physgnn.io.untrusted.compressed import read_npz, read_unpacked
from physgnn.io.untrusted.limits import VARIABLE, allowed_bytes, check_size


def test_a_user_can_raise_the_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"x")
    with pytest.raises(InputError, match=f"{VARIABLE}=3.03 if it is meant"):
        check_size(path, 3e9)
    monkeypatch.setenv(VARIABLE, "4")
    check_size(path, 3e9)
    for wrong in ("x", "0", "-1", "nan", "inf"):
        monkeypatch.setenv(VARIABLE, wrong)
        with pytest.raises(InputError, match=VARIABLE):
            allowed_bytes(path)


def test_a_file_may_hold_what_it_weighs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, "1e-6")
    (tmp_path / "a").write_bytes(bytes(5000))
    assert len(read_unpacked(tmp_path / "a")) == 5000
    (tmp_path / "a.gz").write_bytes(gzip.compress(bytes(5000)))
    with pytest.raises(InputError, match="what it unpacks to would take"):
        read_unpacked(tmp_path / "a.gz")
    np.savez_compressed(tmp_path / "a.npz", a=np.zeros(5000))
    with pytest.raises(InputError, match="its arrays would take"):
        read_npz(tmp_path / "a.npz")


def test_a_nifti_that_declares_gigabytes(tmp_path: Path) -> None:
    for name in ("a.nii", "a.nii.gz"):
        path = tmp_path / name
        write_image(path, LabelVolume(np.ones((3, 3, 3), np.int32), np.eye(4)))
        header = bytearray(read_unpacked(path))
        header[42:48] = np.array([3000, 3000, 3000], "<i2").tobytes()
        path.write_bytes(
            bytes(header) if path.suffix == ".nii" else gzip.compress(header)
        )
        with pytest.raises(InputError, match="the image would take 108 GB"):
            read_image(path)


@pytest.mark.parametrize("name", ["a.nii.gz", "a.mgz"])
def test_what_a_packed_header_declares_is_refused_before_it_is_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """All of the bound was unpacked first, and the line asked for a little more."""
    path = tmp_path / name
    write_image(path, LabelVolume(np.ones((300, 300, 300), np.int32), np.eye(4)))
    monkeypatch.setenv(VARIABLE, "0.01")
    with pytest.raises(InputError, match=rf"would take 0\.108 GB.*{VARIABLE}=0\.109"):
        read_image(path)
    monkeypatch.setenv(VARIABLE, "0.109")
    assert read_image(path).data.shape == (300, 300, 300)


def test_a_ply_of_nothing_a_billion_times(tmp_path: Path) -> None:
    for rows in ("", "property float x\n"):
        (tmp_path / "a.ply").write_text(
            f"ply\nformat ascii 1.0\nelement vertex 1000000000\n{rows}end_header\n0\n"
        )
        with pytest.raises(InputError, match=r"a\.ply"):
            read_surface(tmp_path / "a.ply")


def test_blank_lines_of_an_stl_take_linear_time(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_bytes(b"solid\n" + b" \n" * 500_000 + b"endsolid\n")
    with pytest.raises(InputError, match=r"a\.stl"):
        read_surface(tmp_path / "a.stl")


def test_xml_that_grows(tmp_path: Path) -> None:
    entities = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(9))
    bomb = f'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY e0 "x">{entities}]><a>&e9;</a>'
    for name, read in (("a.feb", read_febio), ("a.vtu", read_mesh)):
        text = bomb.replace("<a>", '<VTKFile type="UnstructuredGrid">')
        (tmp_path / name).write_text(text if name == "a.vtu" else bomb)
        with pytest.raises(InputError, match="must not define entities"):
            read(tmp_path / name)


def test_npz_of_objects_and_of_other_sizes(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", a=np.array([{}], dtype=object))
    with pytest.raises(InputError, match="holds Python objects"):
        read_npz(tmp_path / "a.npz")
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (10**9,), }".ljust(117)
    for shape in ("1000000000", "-1"):
        text = header.replace("10**9", shape) + "\n"
        content = b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()
        with zipfile.ZipFile(tmp_path / "b.npz", "w") as archive:
            archive.writestr("a.npy", content + bytes(8))
        with pytest.raises(InputError, match="does not fit its 8 bytes"):
            read_npz(tmp_path / "b.npz")
    with zipfile.ZipFile(tmp_path / "c.npz", "w", zipfile.ZIP_BZIP2) as archive:
        archive.writestr("a.npy", b"")
    with pytest.raises(InputError, match="NumPy does not write"):
        read_npz(tmp_path / "c.npz")


def test_a_gzip_file_is_read_to_its_checksum(tmp_path: Path) -> None:
    path = tmp_path / "a.nii.gz"
    nib.save(nib.Nifti1Image(np.ones((9, 9, 9), np.float32), np.eye(4)), path)
    whole = bytearray(path.read_bytes())
    whole[-6] ^= 1  # in the checksum
    path.write_bytes(whole)
    with pytest.raises(InputError, match="CRC"):
        read_image(path)
