"""Registrations of a brain with ventricles, from a real label map.

    OMP_NUM_THREADS=1 python benchmarks/registration_ventricles.py \
        freesurfer_labels_02.nii.gz --labels freesurfer

The map is meshed as `physgnn mesh` does by default, opened on its upper right as
`physgnn init` would, and pushed by the loads of that. Of each load path three levels
are measured by 40 pairs within 30 mm of the craniotomy's middle, with 0.7 mm of noise a
coordinate, and registered. Mesh and materials are those of the truth, so that what is
asked is whether the search comes to rest, not how good the model is. What the log has
is not registered again. Prints Markdown.
"""

import argparse
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from held_out import USABLE, Log
from physgnn import stages
from physgnn.arrays import FloatArray
from physgnn.dataset.storage.store import Store
from physgnn.geometry import boundary_surface
from physgnn.geometry.measured import PointPairs
from physgnn.io import read_mesh
from physgnn.registration.registrar import Registrar
from registration_bounds import held
from tables import machine, table

NOISE_MM, N_PAIRS, NEAR_MM = 0.7, 40, 30.0
OUTWARD = np.array([0.45, 0.25, 0.85])  # to where the skull is opened
LEVELS = (2, 5, 9)  # of 10
STEPS_MM = ((0.0, 8.0), (8.0, 16.0), (16.0, 30.0))


def made(label_map: str, labels: str, folder: Path) -> tuple[Store, FloatArray]:
    """Mesh, open and simulate, as far as that is not done; the store and the middle."""
    case, toml, point = (folder / name for name in ("case.vtu", "case.toml", "at.csv"))
    folder.mkdir(parents=True, exist_ok=True)
    if not case.is_file():
        stages.mesh(case, segmentation=label_map, labels=labels, log=print)
    if not toml.is_file():
        points = boundary_surface(read_mesh(case)).points
        middle = points[(points @ OUTWARD).argmax()]
        point.write_text(",".join(map(str, middle)) + "\n", "utf-8")
        stages.init(case, toml, craniotomy=point, log=print)
    store = folder / "loads.zarr"
    stages.simulate(case, store, loads=toml)
    return Store.open(store), np.loadtxt(point, delimiter=",")


def pairs(store: Store, middle: FloatArray, u: FloatArray, seed: int) -> PointPairs:
    """Measure a displacement on the cortex that was laid open."""
    mesh, rng = store.body.mesh, np.random.default_rng(seed)
    cortex = np.unique(boundary_surface(mesh).faces)
    away = np.linalg.norm(mesh.points[cortex] - middle, axis=1)
    seen = rng.permutation(cortex[away < NEAR_MM])[:N_PAIRS]
    noise = NOISE_MM * rng.normal(size=(len(seen), 3))
    return PointPairs(mesh.points[seen], mesh.points[seen] + u[seen] + noise)


def rows(log: Log) -> Iterator[list[str]]:
    """Yield a row for each range of largest displacements, and for all."""
    for low, high in (*STEPS_MM, (0.0, np.inf)):
        of = [r for r in log.records if low <= r["moved"] < high]
        if of:
            ended = Counter(r["status"].lower().replace("_", " ") for r in of)
            name = f"{low:g} to {high:g} mm" if np.isfinite(high) else "all of them"
            yield [
                name,
                str(len(of)),
                str(sum(r["status"] in USABLE for r in of)),
                f"{np.mean([r['mean'] for r in of]):.2f}",
                held(of, "mean"),
                held(of, "max"),
                f"{np.median([r['seconds'] for r in of]):.1f}",
                ", ".join(f"{n} {status}" for status, n in ended.most_common()),
            ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("label_map")
    parser.add_argument("--labels", default="freesurfer")
    parser.add_argument("--folder", type=Path, default=Path("ventricles"))
    parser.add_argument("--paths", type=int, default=20)
    options = parser.parse_args()
    print(machine())
    store, middle = made(options.label_map, options.labels, options.folder)
    log, register = Log(options.folder / "registrations.jsonl"), Registrar(store.body)
    for path in range(options.paths):
        for _, level in log.missing([(path, level) for level in LEVELS], "pairs"):
            u = store.displacement(path)[level].astype(np.float64)
            seen = pairs(store, middle, u, 100 * path + level)
            found = register(seen, noise_mm=NOISE_MM).prediction
            error = np.linalg.norm(found.displacement - u, axis=1)
            bound = found.error_estimate_mm
            assert bound is not None
            log.add(
                path=path,
                level=level + 1,
                what="pairs",
                status=found.status.name,
                moved=float(np.linalg.norm(u, axis=1).max()),
                mean=float(error.mean()),
                max=float(error.max()),
                bound_mean=bound.mean_mm,
                bound_max=bound.max_mm,
                seconds=found.seconds,
            )
    head = ("largest displacement", "cases", "usable", "mean error, mm")
    head = (*head, "mean bound held, of error", "largest", "seconds", "ended")
    table(head, rows(log))


if __name__ == "__main__":
    main()
