"""Where the numbers of a report come from, as names and values people read."""

import os
import platform
from collections.abc import Mapping
from typing import Any

import numpy as np
import torch

from physgnn.dataset.storage.store import Store
from physgnn.evaluation.report.formats import duration
from physgnn.geometry.meshing.cell_quality import quality
from physgnn.geometry.regions import region_name
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.mechanics.materials.table import material_to_config
from physgnn.prediction.error_bounds.calibration import Calibration
from physgnn.versions import release

LIBRARIES = ("physgnn", "numpy", "scipy", "torch", "zarr")


def case_facts(store: Store) -> dict[str, Any]:
    """Return what was simulated: mesh, sets, loads, materials."""
    mesh = store.mesh
    volumes = mesh.cell_volumes
    loads = [store.load_path(i) for i in range(store.n_paths)]
    total = [float(np.linalg.norm(path.forces, axis=1).sum()) for path in loads]
    loaded = np.unique(np.concatenate([path.nodes for path in loads]))
    regions = ", ".join(
        f"{region_name(label)} {volumes[mesh.region == label].sum() / 1e3:.1f} ml"
        for label in np.unique(mesh.region).tolist()
    )
    return {
        "preset": store.provenance.get("preset", "none"),
        "mesh": f"{mesh.n_points} points, {mesh.n_cells} tetrahedra; {regions}",
        "mesh_quality": str(quality(mesh)).removeprefix("quality: "),
        "materials": "; ".join(
            f"{region_name(label)}: {_pairs(material_to_config(material))}"
            for label, material in store.materials.items()
        ),
        "points": f"{len(store.fixed)} fixed, {len(loaded)} loaded in some path",
        "loads": f"{store.n_paths} load paths of {store.n_levels} levels, up to "
        f"{max(total):.3g} N in all; {len(store.samples())} samples converged",
    }


def model_facts(checkpoint: Checkpoint) -> dict[str, Any]:
    """Return what the network is and what training it cost."""
    record = checkpoint.record
    config, training = record["config"], record.get("training", {})
    split = record["split"]
    return {
        "model": config["model"],
        "options": _pairs(config["options"]),
        "weights": f"{checkpoint.model.n_weights:,}",
        "trained_on": f"split '{split['name']}': {split['train']} training and "
        f"{split['validation']} validation samples",
        "training": _pairs(training),
        "optimiser": _pairs(
            {k: v for k, v in config.items() if k not in ("model", "options")}
        ),
    }


def bound_facts(calibration: Calibration | None, groups: str) -> dict[str, Any]:
    """Return what the error bounds promise, for new load paths or patients, and why."""
    if calibration is None:
        return {}
    loads = calibration.trained_range
    return {
        "promise": f"{100 * calibration.coverage:.0f} % of new {groups} like those "
        "trained on, each bound for itself",
        "calibrated_on": f"{calibration.n_samples} validation samples of "
        f"{calibration.n_paths} {groups}, by the {calibration.indicator}",
        "trained_range": f"{len(loads.nodes)} nodes, up to {loads.total_force_n:.3g} N "
        f"in all and {loads.nodal_force_n:.3g} N on one",
    }


def time_facts(store: Store, solver_seconds: float, model_seconds: float) -> Any:
    """Return what a prediction and what the solver cost on this machine."""
    return {
        "prediction": f"{duration(model_seconds)}, median",
        "finite_elements": f"{duration(solver_seconds)} for one load case solved from "
        "rest, median",
        "simulation": f"{duration(float(np.nanmedian(store.seconds)))} for a load path "
        f"of {store.n_levels} levels, median, as simulated for the dataset",
        "ratio": f"{solver_seconds / model_seconds:.0f} predictions in the time of one "
        "finite-element solve",
        "machine": f"{_processor()}, {os.cpu_count()} cores, "
        f"{torch.get_num_threads()} threads for the network",
    }


def provenance_facts(store: Store, checkpoint: Checkpoint, command: str) -> Any:
    """Return versions, seed, hashes and commands."""
    record = checkpoint.record
    return {
        "command": command or "called from Python",
        "seed": record["config"].get("seed"),
        "dataset": f"{store.path}, sha256 {store.content_hash()}",
        "dataset_made_by": _pairs(store.provenance),
        "trained_on_data": f"sha256 {record['data']['hash']}",
        "mesh": f"sha256 {store.mesh.content_hash}",
        "versions": _pairs({name: release(name) for name in LIBRARIES}),
        "python": f"{platform.python_version()} on {platform.platform()}",
    }


def _pairs(values: Mapping[str, Any]) -> str:
    pairs = (f"{name.replace('_', ' ')} {value}" for name, value in values.items())
    return ", ".join(pairs) or "none"


def _processor() -> str:
    """Return the processor's name where Linux tells it, else its architecture."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:  # noqa: PTH123
            for line in lines:
                if line.startswith("model name"):
                    return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
