"""Train and predict: finite elements, a network, and an error bound that holds.

    python examples/04_train_and_predict.py [folder]

A small mesh and twelve load paths, so that all takes less than a minute.
"""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np

import physgnn as pg

mpl.use("Agg")
import matplotlib.pyplot as plt

LOADS = """
[point_sets.fixed]
kind = "complement"
of = { kind = "sphere", centre_mm = [39.7, 8.8, 62.5], radius_mm = 70 }

[point_sets.loaded]
kind = "nearest"
point_mm = [39.7, 8.8, 62.5]
count = 20

[loads]
total_force_n = 2.0
paths = 12
levels = 5
"""
TRAINING = """
model = "lifted"
schedule = "cosine"
batch_size = 4
early_stopping = 1000
max_minutes = 0.15
[options]
response_modes = 16
"""


def main(folder: Path) -> dict[str, float]:
    """Return errors on load paths that had no part in the training, mm."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "loads.toml").write_text(LOADS)
    (folder / "training.toml").write_text(TRAINING)
    pg.mesh(folder / "case.vtu", mni152=True, target_points=1200)
    store, _ = pg.simulate(
        folder / "case.vtu",
        folder / "loads.zarr",
        loads=folder / "loads.toml",
        workers=1,
    )
    run = folder / "run"
    pg.train(folder / "loads.zarr", run, config=folder / "training.toml", seed=0)
    held_out = pg.evaluate(run, baselines="linear").models
    errors = {row.name: np.mean([s.mean for s in row.samples]) for row in held_out}

    predictor = pg.Predictor.load(run)
    case = store.load_case(0, store.n_levels - 1)
    prediction = predictor(case)
    u = store.displacement(0)[-1]
    error = np.linalg.norm(prediction.displacement - u, axis=1)
    draw(np.linalg.norm(u, axis=1), error, folder / "picture.png")
    return {
        "network_mm": float(errors["lifted"]),
        "linear_mm": float(errors["linear"]),
        "milliseconds": 1e3 * prediction.seconds,
    }


def draw(length: np.ndarray, error: np.ndarray, file: Path) -> None:
    """Draw every point's error over its displacement."""
    figure, axes = plt.subplots(figsize=(4, 3), layout="constrained")
    axes.loglog(length, error, ".", markersize=2, color="#0f9d7e")
    axes.set(xlabel="displacement, mm", ylabel="network's error, mm")
    axes.set(xlim=(1e-3, None))
    figure.savefig(file, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    found = main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    print(
        f"mean error on unseen load paths: network {found['network_mm']:.4f} mm, "
        f"linear solution {found['linear_mm']:.4f} mm"
    )
