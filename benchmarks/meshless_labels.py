"""What a lifted network learns from meshless labels, beside finite elements.

    physgnn simulate case.vtu --loads loads.toml --solver mtled -o mtled.zarr
    physgnn simulate case.vtu --loads loads.toml -o fe.zarr
    physgnn train mtled.zarr --max-minutes 4 -o run
    python benchmarks/meshless_labels.py mtled.zarr fe.zarr run

Both stores are of the same mesh and loads. All are judged by the meshless solutions of
split ``path``'s test samples: the finite elements' own solutions, the expansion before
it has learnt, the network, and the network with its worst patches relaxed towards the
finite elements' equilibrium. Prints a Markdown table.
"""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.dataset import Store, named_split
from physgnn.learning.models import build_model
from physgnn.learning.runs.checkpoint import Checkpoint
from tables import table

PATCHES = 8  # as by default


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    for name in ("labels", "elements", "run"):
        parser.add_argument(name, type=Path)
    given = parser.parse_args()
    labels, elements = Store.open(given.labels), Store.open(given.elements)
    if labels.mesh.content_hash != elements.mesh.content_hash:
        raise SystemExit("both stores must be of one mesh")
    split = named_split("path", labels)
    trained = Checkpoint.load(given.run)
    options = trained.record["config"]["options"]

    def lifted(**changed: Any) -> Any:
        return build_model("lifted", trained.model.body, **{**options, **changed})

    untrained, relaxed = lifted(), lifted(relaxed_patches=PATCHES)
    untrained.fit(labels, split.train)
    relaxed.restore(trained.model.arrays())

    def predicted(model: Any) -> Callable[[int, int], FloatArray]:
        model.prepare()
        return lambda path, level: model.predict(labels.load_case(path, level))

    answers: dict[str, Callable[[int, int], FloatArray]] = {
        "finite elements": lambda path, level: elements.displacement(path)[level],
        "expansion, nothing learnt": predicted(untrained),
        "lifted network": predicted(trained.model),
        f"the same, {PATCHES} patches relaxed": predicted(relaxed),
    }
    rows = []
    for name, answer in answers.items():
        errors = []
        for path, level in split.test.tolist():
            off = answer(path, level) - labels.displacement(path)[level]
            errors.append(np.linalg.norm(off, axis=1))
        mean = float(np.mean([error.mean() for error in errors]))
        largest = float(np.mean([error.max() for error in errors]))
        rows.append((name, f"{mean:.3f}", f"{largest:.2f}"))
    table(("", "mean error, mm", "largest, mean over samples"), rows)


if __name__ == "__main__":
    main()
