"""Write every format to a disk that ends after so many bytes; print what came of it.

    python full_disk.py FOLDER BYTES

With BYTES 0 there is room for all. A process of its own, since the limit is the
process's: writing beyond it is the error EFBIG, at the same place in the writers as a
full disk's ENOSPC.
"""

import io
import json
import resource
import signal
import sys
from pathlib import Path
from types import SimpleNamespace

import nibabel as nib
import numpy as np
import SimpleITK as sitk
from matplotlib.figure import Figure
from safetensors import SafetensorError
from safetensors.numpy import save_file

from physgnn.dataset import Store
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_load_case, write_mesh
from physgnn.io.febio.model_writer import write_febio
from physgnn.io.integrity.atomic import whole_file, whole_folder, write_whole
from physgnn.io.medical.images.formats import write_image
from physgnn.io.medical.images.nifti import save_nifti
from physgnn.io.medical.transforms import save_transform
from physgnn.io.plans.formats import write_plan
from physgnn.io.plans.plan import Plan
from physgnn.io.simulation import Simulation, solution_of
from physgnn.io.vtk.prediction_file import write_deformed
from physgnn.io.vtk.series import write_series
from physgnn.io.vtk.vtu import write_prediction
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase, LoadPath
from physgnn.mechanics.materials import NeoHookean

RNG = np.random.default_rng(0)


def mesh_of_cubes() -> TetMesh:
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from meshes import block_mesh

    return block_mesh(12, jitter=0.15)


MESH = mesh_of_cubes()
FIXED, LOADED = MESH.point_set("fixed"), MESH.point_set("loaded")
MATERIALS = {region: NeoHookean(3000.0, 0.45) for region in np.unique(MESH.region)}
BODY = Body(MESH, MATERIALS, FIXED)
SHIFT = RNG.normal(size=MESH.points.shape)
IMAGE = nib.Nifti1Image(RNG.normal(size=(32, 32, 32)).astype(np.float32), np.eye(4))

LABELS = Image(RNG.integers(0, 30_000, size=(32, 32, 32)), np.eye(4))


def transform(path: Path) -> None:
    field = sitk.GetImageFromArray(RNG.normal(size=(20, 20, 20, 3)), isVector=True)
    shift = sitk.DisplacementFieldTransform(field)
    save_transform(path, shift, n_vectors=20**3)


def tracts(path: Path) -> None:
    from nibabel.streamlines import Tractogram, TrkFile

    lines = [RNG.normal(size=(900, 3)).astype(np.float32) for _ in range(9)]
    held = io.BytesIO()
    TrkFile(Tractogram(lines, affine_to_rasmm=np.eye(4))).save(held)
    write_plan(path, Plan(np.concatenate(lines), lambda _: held.getvalue()))


def points(path: Path) -> None:
    places = RNG.normal(size=(3000, 3))
    table = "\n".join(",".join(map(str, row)) for row in places)
    write_plan(path, Plan(places, lambda _: table.encode()))


def picture(path: Path) -> None:
    figure = Figure()
    figure.subplots().imshow(RNG.normal(size=(200, 200)), interpolation="nearest")
    with whole_file(path) as part:
        figure.savefig(part)


def weights(path: Path) -> None:
    with whole_file(path, refused=(SafetensorError,)) as part:
        save_file({"w": RNG.normal(size=9000)}, part)


def arrays(path: Path) -> None:
    with whole_file(path) as part:
        np.savez(part, a=RNG.normal(size=9000))


def torch_weights(path: Path) -> None:
    import torch

    with whole_file(path, refused=(RuntimeError,)) as part:
        torch.save({"w": torch.zeros(9000, dtype=torch.float64)}, part)


def training_state(path: Path) -> None:
    import torch
    from lightning.fabric.plugins import TorchCheckpointIO

    from physgnn.learning.training.callbacks import KeepState

    def save(part: Path) -> None:
        content = {"w": torch.zeros(9000, dtype=torch.float64)}
        TorchCheckpointIO().save_checkpoint(content, part)

    KeepState(path, None)._save(
        SimpleNamespace(is_global_zero=True, save_checkpoint=save)
    )


def network(path: Path) -> None:
    """Write what an exporter would; the real one is no part of every installation."""
    from unittest import mock

    import torch

    from physgnn.learning.graph import graph_of
    from physgnn.learning.physgnn.network import PhysGNN
    from physgnn.learning.runs.onnx import write_onnx

    def export(*given: object, **_: object) -> None:
        Path(str(given[2])).write_bytes(bytes(range(256)) * 400)

    with mock.patch.object(torch.onnx, "export", export):
        write_onnx(PhysGNN(), graph_of(BODY), path)


def febio_model(path: Path) -> None:
    load = LoadPath(LOADED, np.full((len(LOADED), 3), 1e-4), np.array([0.5, 1.0]))
    write_febio(path, Body(MESH, MATERIALS, FIXED), load)


def store(path: Path) -> None:
    loads = LoadPath(LOADED, np.full((len(LOADED), 3), 1e-4), np.array([0.5, 1.0]))
    Store.create(path, Body(MESH, MATERIALS, FIXED), [loads], provenance={})


def series(path: Path) -> None:
    loads = LoadPath(LOADED, np.full((len(LOADED), 3), 1e-4), np.array([0.5, 1.0]))
    displacement = np.stack([0.5 * SHIFT, SHIFT])
    displacement[:, FIXED] = 0.0
    solution = solution_of(displacement, loads.load_factors)
    write_series(
        path, Simulation("here", MESH, FIXED, loads, MATERIALS, lambda: solution)
    )


def run_folder(path: Path) -> None:
    from physgnn.learning.models import build_model
    from physgnn.learning.runs.checkpoint import Checkpoint

    with whole_folder(path) as part:
        Checkpoint(build_model("linear", BODY), {"config": {"model": "linear"}}).save(
            part
        )


FOLDERS = {"store.zarr": store, "series": series, "run": run_folder}
FILES = {
    "mesh.vtu": lambda path: write_mesh(path, MESH),
    "rest.vtu": lambda path: write_prediction(path, MESH, {"displacement_mm": SHIFT}),
    "deformed.vtp": lambda path: write_deformed(path, MESH, SHIFT),
    "deformed.vtu": lambda path: write_deformed(path, MESH, SHIFT),
    "field.nii.gz": lambda path: save_nifti(path, IMAGE),
    "field.nii": lambda path: save_nifti(path, IMAGE),
    "labels.nrrd": lambda path: write_image(path, LABELS),
    "labels.mha": lambda path: write_image(path, LABELS),
    "labels.mgz": lambda path: write_image(path, LABELS),
    "plan.trk": tracts,
    "plan.csv": points,
    "transform.h5": transform,
    "picture.png": picture,
    "weights.safetensors": weights,
    "weights.pt": torch_weights,
    "arrays.npz": arrays,
    "load.json": lambda path: write_load_case(
        path, LoadCase(np.arange(2000), RNG.normal(size=(2000, 3)))
    ),
    "last.ckpt": training_state,
    "model.onnx": network,
    "model.feb": febio_model,
    "report.html": lambda path: write_whole(path, "<p>" * 30_000 + "</html>"),
}


def main(folder: Path, n_bytes: int) -> None:
    if n_bytes:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
        resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, hard))
    results = {}
    for name, write in {**FILES, **FOLDERS}.items():
        try:
            write(folder / name)
            results[name] = "written"
        except InputError as error:
            results[name] = str(error)
        except Exception as error:
            results[name] = f"escaped: {type(error).__name__}: {error}"
    print(json.dumps(results))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
