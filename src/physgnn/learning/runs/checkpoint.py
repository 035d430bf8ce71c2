"""A trained surrogate on disk: its arrays, what they were trained on, and the mesh."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh, write_mesh
from physgnn.io.atomic import whole_file
from physgnn.learning.models import build_model
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.materials.table import material_from_config, material_to_config

FORMAT_VERSION = 1
FIXED = "fixed"


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """A surrogate and the record of how it came about.

    Parameters
    ----------
    model : Surrogate
        Bound to its body.
    record : mapping
        What JSON can hold; ``record["config"]`` is the resolved training
        configuration, ``record["training"]`` what training it cost and reached.
    """

    model: Surrogate
    record: Mapping[str, Any]

    @property
    def body(self) -> Body:
        """Mesh, materials and fixed points."""
        return self.model.body

    def save(self, run: str | Path) -> None:
        """Write the run folder; each file appears whole or not at all."""
        files = RunFolder(Path(run))
        files.path.mkdir(parents=True, exist_ok=True)
        body = self.body
        if not files.case.exists():
            write_mesh(files.case, body.mesh.with_point_sets(**{FIXED: body.fixed}))
        record = {
            "format_version": FORMAT_VERSION,
            "mesh_hash": body.mesh.content_hash,
            "element": body.element,
            "materials": {
                str(region): material_to_config(material)
                for region, material in body.materials.items()
            },
            **self.record,
        }
        arrays = self.model.arrays()
        with whole_file(files.weights, refused=(SafetensorError,)) as part:
            save_file({k: np.asarray(v, order="C") for k, v in arrays.items()}, part)
        with whole_file(files.record) as part:
            part.write_text(json.dumps(record, indent=2, ensure_ascii=False) + "\n")

    @classmethod
    def load(cls, run: str | Path) -> Self:
        """Read a run folder.

        Returns
        -------
        Checkpoint
            Its arrays as they were saved, bit for bit; a network's are on the CPU.

        Raises
        ------
        InputError
            If the folder is no finished run, of another version, or its mesh isn't
            the one the weights were trained on.
        """
        run = Path(run)
        files = RunFolder(run)
        record = read_record(run)
        mesh = read_mesh(files.case)
        check_mesh(record, mesh, run)
        materials = {
            int(region): material_from_config(values)
            for region, values in record["materials"].items()
        }
        element = record.get("element", DEFAULT_ELEMENT)
        fixed, factors = mesh.point_set(FIXED), files.factors
        body = Body(mesh, materials, fixed, element=element, factors=factors)
        config = record["config"]
        model = build_model(config["model"], body, **config["options"])
        try:
            model.restore(load_file(files.weights))
        except (OSError, SafetensorError, RuntimeError, LookupError) as error:
            raise InputError(
                f"{files.weights} doesn't hold the weights that {files.record.name} "
                f"describes ({str(error).splitlines()[0]}); train again"
            ) from error
        return cls(model, record)


def check_mesh(record: Mapping[str, Any], mesh: TetMesh, run: Path) -> None:
    """Raise InputError if a mesh isn't the one a run was trained on."""
    if mesh.content_hash != record["mesh_hash"]:
        raise InputError(
            f"{run} was trained on another mesh ({record['mesh_hash'][:12]}…, got "
            f"{mesh.content_hash[:12]}…): use its own "
            f"{RunFolder(run).case.name}, or train on this one"
        )


def read_record(run: Path) -> dict[str, Any]:
    """Return a run's record; InputError if the folder is no finished run."""
    files = RunFolder(run)
    needed = (files.record, files.weights, files.case)
    missing = [file.name for file in needed if not file.is_file()]
    if missing:
        raise InputError(f"{run} is no finished run: it has no {', '.join(missing)}")
    try:
        record = json.loads(files.record.read_text())
        version = record["format_version"]
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{files.record} is damaged: {error}") from error
    if version != FORMAT_VERSION:
        raise InputError(
            f"{run} is of version {version}, this program reads {FORMAT_VERSION}: "
            "train again"
        )
    return dict(record)
