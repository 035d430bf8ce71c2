"""Rules of point sets in TOML: what is read, and one clear line for each mistake."""

from pathlib import Path

import pytest

from physgnn.config import read_point_sets
from physgnn.errors import InputError
from physgnn.geometry import Complement, HalfSpace, Nearest, Sphere, Union


def test_rules(tmp_path: Path) -> None:
    file = tmp_path / "sets.toml"
    file.write_text(
        """
        [point_sets.fixed]
        kind = "complement"
        of = { kind = "sphere", centre_mm = [5, 5, 10], radius_mm = 6 }
        [[point_sets.loaded.of]]
        kind = "nearest"
        point_mm = [5, 5, 10]
        count = 3
        [[point_sets.loaded.of]]
        kind = "half_space"
        rotation_deg = [0, 0]
        offset_mm = [0, 0, 0]
        keep = ">="
        limit_mm = 10
        [point_sets.loaded]
        kind = "union"
        [other]
        key = 1
        """
    )
    top = HalfSpace((0, 0), (0, 0, 0), ">=", 10)
    assert read_point_sets(file) == {
        "fixed": Complement(Sphere((5, 5, 10), 6)),
        "loaded": Union((Nearest((5, 5, 10), 3), top)),
    }


SPHERE = 'kind = "sphere"\ncentre_mm = [0, 0, 0]\nradius_mm = 1\n'
HALF_SPACE = (
    'kind = "half_space"\nrotation_deg = [0, 0]\noffset_mm = [0, 0, 0]\n'
    'keep = "<"\nlimit_mm = 0\n'
)


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("", r"\[point_sets.a\] in .* needs kind = one of half_space, sphere, nearest"),
        ('kind = "cube"', "one of .*'cube'"),
        (SPHERE + "radius = 3", "unknown key 'radius'.*'radius_mm'.*kind, centre_mm"),
        ('kind = "sphere"\nradius_mm = 3', "needs the key 'centre_mm'"),
        (SPHERE.replace("= 1", "= 0"), "radius_mm must be > 0"),
        (SPHERE.replace("= 1", '= "big"'), "radius_mm .* must be float"),
        (SPHERE.replace("= 1", "= nan"), "finite"),
        (SPHERE.replace("[0, 0, 0]", "[0, 0]"), "centre_mm .* must be a list of 3 num"),
        (
            SPHERE.replace("0, 0]", '0, "x"]'),
            "centre_mm .* must be a list of 3 numbers",
        ),
        (SPHERE.replace("0, 0]", "0, inf]"), "3 finite numbers"),
        (HALF_SPACE.replace('"<"', '"=="'), "keep must be one of <, <=, >, >="),
        (
            HALF_SPACE.replace("[0, 0]", "[0, 0, 0]"),
            "rotation_deg .* list of 2 numbers",
        ),
        ('kind = "nearest"\npoint_mm = [0, 0, 0]\ncount = 0', "count must be"),
        ('kind = "nearest"\npoint_mm = [0, 0, 0]\ncount = 2.5', "count .* must be int"),
        ('kind = "union"\nof = []', "one rule or more"),
        ('kind = "union"\nof = [{ kind = "cube" }]', "within needs kind .*'cube'"),
        ('kind = "complement"\nof = 3', "got 3"),
    ],
)
def test_mistakes(rule: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "sets.toml"
    file.write_text(f"[point_sets.a]\n{rule}")
    with pytest.raises(InputError, match=message) as raised:
        read_point_sets(file)
    assert "\n" not in str(raised.value)
