from pathlib import Path

import pytest

from physgnn.errors import InputError
from physgnn.geometry import volume
from physgnn.io import read_surface

POINTS = "v 0.1 0 0\nv 1 0 0 1.0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvt 0 0\n"
FACES = {
    "plain": "f 2 3 4\nf 1 4 3\nf 1 2 4\nf 1 3 2\n",
    "slashes": "f 2/1 3/1 4/1\nf 1//1 4//1 3//1\nf 1/1/1 2/1/1 4/1/1\nf 1 3 2\n",
    "negative": "f -3 -2 -1\nf -4 -1 -2\nf -4 -3 -1\nf -4 -2 -3\n",
}


@pytest.mark.parametrize("kind", FACES)
def test_every_way_to_name_a_corner(tmp_path: Path, kind: str) -> None:
    content = f"# by hand\no thing\n{POINTS}usemtl x\ns off\n{FACES[kind]}"
    (tmp_path / "a.obj").write_text(content)
    surface = read_surface(tmp_path / "a.obj")
    assert (surface.n_points, surface.n_faces) == (4, 4)
    assert volume(surface) == pytest.approx(0.9 / 6)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (POINTS, "no 'v' and 'f' lines"),
        (POINTS + "f 1 2 9\n", "must index 0…3"),
        (POINTS + "f 1 2 -9\n", "must index 0…3"),
        (POINTS + "f a b c\n", "cannot be read"),
        (POINTS + "v 1 2 x\nf 1 2 3\n", "cannot be read"),
        (POINTS + "v 1 2 nan\nf 1 2 3\n", "finite"),
    ],
)
def test_wrong_lines_are_refused(tmp_path: Path, content: str, message: str) -> None:
    (tmp_path / "a.obj").write_text(content)
    with pytest.raises(InputError, match=message) as caught:
        read_surface(tmp_path / "a.obj")
    assert str(caught.value).startswith(str(tmp_path / "a.obj"))
