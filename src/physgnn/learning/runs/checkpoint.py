"""A trained surrogate on disk: its arrays, what they were trained on, and the mesh."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh, write_mesh
from physgnn.io.integrity.digest import Manifest
from physgnn.learning.models import build_model, resolved_options
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.parts import (
    REMEDY,
    Writer,
    check_part,
    check_there,
    note_missing,
    read_manifest,
    write_parts,
)
from physgnn.learning.runs.record import read_json, record_text
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

    @property
    def _config(self) -> dict[str, Any]:
        """The record's, with all options, so that no later default changes them."""
        config = self.record["config"]
        options = resolved_options(config["model"], config.get("options", {}))
        return {**config, "options": options}

    def save(self, run: str | Path) -> None:
        """Write the run folder.

        Each file appears whole or not at all, and whenever the process ends, the files
        that are there are as the manifest says. Error bounds are removed unless the
        weights are those that they were calibrated for.
        """
        files = RunFolder(Path(run))
        files.path.mkdir(parents=True, exist_ok=True)
        body = self.body
        record = {
            "format_version": FORMAT_VERSION,
            "manifest": files.manifest.name,
            "mesh_hash": body.mesh.content_hash,
            "element": body.element,
            "materials": {
                str(region): material_to_config(material)
                for region, material in body.materials.items()
            },
            **self.record,
            "config": self._config,
        }
        arrays = self.model.arrays()
        weights = save({k: np.asarray(v, order="C") for k, v in arrays.items()})
        same = files.weights.is_file() and files.weights.read_bytes() == weights
        parts: dict[Path, Writer] = {
            files.weights: lambda part: part.write_bytes(weights),
            files.record: lambda part: part.write_text(record_text(record), "utf-8"),
        }
        listed = (read_manifest(files.path) or Manifest()).parts
        if files.case.name not in listed or not files.case.is_file():
            mesh = body.mesh.with_point_sets(**{FIXED: body.fixed})
            parts = {files.case: lambda part: write_mesh(part, mesh), **parts}
        write_parts(files.path, parts, *(() if same else files.calibrations))

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
            If the folder is no finished run, of another version, its mesh isn't the
            one the weights were trained on, or a file isn't as its manifest says.
        """
        run = Path(run)
        files = RunFolder(run)
        record = read_record(run)
        mesh = read_mesh(files.case)
        check_mesh(record, mesh, run)
        check_part(files.case)
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
        check_part(files.weights)
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
    """Return a run's record, by present names, checked against its manifest.

    A run of before there were manifests is opened as it is, which is logged.

    Raises
    ------
    InputError
        If the folder is no finished run, or its record isn't as it was written.
    """
    files = RunFolder(run)
    check_there(run, files.record, files.weights, files.case)
    record = read_json(files.record)
    version = record.get("format_version")
    if version is None:
        raise InputError(f"{files.record} is damaged: it has no format_version")
    if version != FORMAT_VERSION:
        raise InputError(
            f"{run} is of version {version}, this program reads {FORMAT_VERSION}: "
            "train again"
        )
    if "manifest" in record and not files.manifest.is_file():
        raise InputError(
            f"{run} has lost its {files.manifest.name}, so its files cannot be "
            f"checked: {REMEDY}"
        )
    check_part(files.record)
    note_missing(run)
    return record
