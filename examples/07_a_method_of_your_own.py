"""A method of your own: the Surrogate of thirty lines, judged beside the others.

    python examples/07_a_method_of_your_own.py [folder]

`NearestLoad` (docs/templates/method.py) takes the training load of the most similar
direction and scales its displacement. It is trained, saved, loaded and evaluated by its
name, as every method of the package is.
"""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np

import physgnn as pg

mpl.use("Agg")
import matplotlib.pyplot as plt

TEMPLATES = Path(__file__).parents[1] / "docs" / "templates"
METHOD = "method:NearestLoad"
LOADS = """
[point_sets.fixed]
kind = "complement"
of = { kind = "sphere", centre_mm = [39.7, 8.8, 62.5], radius_mm = 70 }

[point_sets.loaded]
kind = "nearest"
point_mm = [39.7, 8.8, 62.5]
count = 20

[loads]
total_force_n = 1.0
cone_deg = 20
paths = 20
levels = 4
"""


def main(folder: Path) -> dict[str, float]:
    """Return every method's mean error on load paths never seen, mm."""
    folder.mkdir(parents=True, exist_ok=True)
    sys.path.insert(0, str(TEMPLATES))  # where Python finds the method
    (folder / "loads.toml").write_text(LOADS)
    pg.mesh(folder / "case.vtu", mni152=True, target_points=1000)
    store, run = folder / "loads.zarr", folder / "run"
    pg.simulate(folder / "case.vtu", store, loads=folder / "loads.toml", workers=1)
    pg.train(store, run, model=METHOD)
    report = pg.evaluate(run, baselines="zero,linear")
    errors = {row.name: np.mean([s.mean for s in row.samples]) for row in report.models}
    figure, axes = plt.subplots(figsize=(4, 3), layout="constrained")
    labels = [name.replace("method:", "") for name in errors]
    axes.barh(labels, list(errors.values()), color="#0f9d7e")
    axes.set(xlabel="mean error, load paths never seen, mm")
    figure.savefig(folder / "picture.png", dpi=150)
    plt.close(figure)
    return {name: float(error) for name, error in errors.items()}


if __name__ == "__main__":
    for name, value in main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")).items():
        print(f"{name}: {value:.4f} mm")
