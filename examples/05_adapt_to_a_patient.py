"""Adapt to a patient: a network for a brain it never saw, without a single simulation.

    python examples/05_adapt_to_a_patient.py [folder]

Two synthetic patients teach the local, physical part of the network. For a third one
`adapt` finds a few equilibria on the new mesh. Real families have two dozen patients
and train for minutes; here everything takes less than a minute.
"""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np

import physgnn as pg

mpl.use("Agg")
import matplotlib.pyplot as plt

LOADS = """
[loads]
total_force_n = 4.0
cone_deg = 60
paths = 3
levels = 2
"""
FAMILY = """
model = "lifted"
batch_size = 2
learning_rate = 0.002
schedule = "cosine"
early_stopping = 1000
max_minutes = 0.1
[options]
anchors = 3
"""


def main(folder: Path) -> dict[str, float]:
    """Return errors on the patient never seen, by finite elements' word, mm."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "loads.toml").write_text(LOADS)
    (folder / "family.toml").write_text(FAMILY)
    *family, patient = pg.anatomies(folder / "family", count=4, seed=0)
    stores = [case.with_suffix(".zarr") for case in family]
    for case, store in zip(family, stores, strict=True):
        pg.simulate(case, store, loads=folder / "loads.toml", workers=1)
    pg.train(stores, folder / "run", config=folder / "family.toml", seed=0)

    pg.adapt(folder / "run", patient, folder / "patient", loads=folder / "loads.toml")
    predictor = pg.Predictor.load(folder / "patient")
    case = one_load(predictor.body.mesh)
    network = predictor(case).displacement
    linear = pg.RestState(predictor.body).solve(case.on_points(len(network)))
    truth = predictor(case, tolerance_mm=1e-4).displacement
    errors = {
        "adapted network": np.linalg.norm(network - truth, axis=1),
        "linear solution": np.linalg.norm(linear - truth, axis=1),
    }
    draw(errors, folder / "picture.png")
    return {name: float(error.mean()) for name, error in errors.items()}


def one_load(mesh: pg.TetMesh) -> pg.LoadCase:
    """Return 3 N on the craniotomy, inwards."""
    nodes = mesh.point_set("loaded")
    inward = mesh.points.mean(axis=0) - mesh.points[nodes].mean(axis=0)
    force = 3.0 / len(nodes) * inward / np.linalg.norm(inward)
    return pg.LoadCase(nodes=nodes, forces=np.tile(force, (len(nodes), 1)))


def draw(errors: dict[str, np.ndarray], file: Path) -> None:
    """Draw how many of the free points have an error below a value."""
    figure, axes = plt.subplots(figsize=(4, 3), layout="constrained")
    for name, error in errors.items():
        free = np.sort(error[error > 0])  # the skull holds the others
        axes.semilogx(free, np.linspace(0, 100, len(free)), label=name)
    axes.set(xlabel="error, mm", ylabel="points below it, %")
    axes.legend(frameon=False)
    figure.savefig(file, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    for name, value in main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")).items():
        print(f"{name}: mean error {value:.4f} mm")
