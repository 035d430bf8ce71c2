"""FEBio's log of displacements: any delimiter; refused if of other nodes."""

from pathlib import Path

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.io.febio.log import read_febio_log
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.loads.paths import LoadPath

TIMES = np.array([0.5, 1.0])
IDS = np.array([3, 4, 9])
PATH = LoadPath([0], [[0.0, 0.0, 1.0]], TIMES)
LOG = """\
*Step  = 0
*Time  = 0
*Data  = ux;uy;uz
3 0 0 0
4 0 0 0
9 0 0 0
*Step  = 1
*Time  = 0.5
*Data  = ux;uy;uz
3 0 0 0
9 7 8 9e-3
4 1 2 3
"""


def read(folder: Path, text: str) -> np.ndarray:
    (folder / "u.log").write_text(text)
    solution = read_febio_log(folder / "u.log", PATH, times=TIMES, node_ids=IDS)
    assert solution.status.tolist() == [Status.CONVERGED, Status.ITERATION_LIMIT]
    assert (solution.reached, solution.load_factors.tolist()) == (0.5, [0.5, 1.0])
    return solution.displacement


@pytest.mark.parametrize("delimiter", [" ", ",", ", ", "\t"])
def test_rows_go_to_their_nodes(tmp_path: Path, delimiter: str) -> None:
    head = [line for line in LOG.splitlines() if line.startswith("*")]
    body = [line.replace(" ", delimiter) for line in LOG.splitlines()]
    lines = [a if a in head else b for a, b in zip(LOG.splitlines(), body, strict=True)]
    displacement = read(tmp_path, "\n".join(lines))
    assert np.array_equal(displacement[0], [[0, 0, 0], [1, 2, 3], [7, 8, 9e-3]])
    assert not displacement[1].any()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("9 7 8 9e-3\n", "", "has 2 nodes at time 0.5, the model 3"),
        ("9 7", "8 7", "has 3 nodes at time 0.5, the model 3: log all nodes of that"),
        ("9 7", "9 seven", "expected 'id ux uy uz' at time 0.5"),
        ("*Time  = 0.5", "*Time  = 0.37", "time 0.37 ends none of the 2 steps"),
        ("*", "#", "is it a node_data log?"),
    ],
)
def test_what_does_not_fit(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(InputError) as error:
        read(tmp_path, LOG.replace(old, new))
    assert message in str(error.value)


def test_missing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_febio_log(tmp_path / "no", PATH, times=TIMES, node_ids=IDS)
