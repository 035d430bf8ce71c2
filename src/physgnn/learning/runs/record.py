"""What a run folder says about itself, in plain JSON."""

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.errors import InputError
from physgnn.learning.models import method_name, recorded_options, resolved_options
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.parts import check_part
from physgnn.versions import release

if TYPE_CHECKING:
    from physgnn.dataset.splits.samples import Split
    from physgnn.dataset.storage.store import Store

VERSIONED = ("physgnn", "lightning", "numpy", "torch")
EXTENDABLE = {"clock", "max_epochs", "max_minutes", "memory_mb"}


def record_text(record: Mapping[str, Any]) -> str:
    """Return a record as the text of its file."""
    return json.dumps(record, indent=2, ensure_ascii=False) + "\n"


def read_json(file: Path) -> dict[str, Any]:
    """Return what a run's record file holds, by the names that things have now.

    Raises
    ------
    InputError
        If it cannot be read or is no record.
    """
    if not file.is_file():
        raise InputError(
            f"{file.parent} is no run folder: it has no {file.name}; train one, or "
            "name another"
        )
    try:
        record = json.loads(file.read_text("utf-8"))
        return with_present_names(record)
    except (OSError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"{file} is damaged: {error}") from error


def new_record(
    meshes: "Sequence[tuple[Store, Split]]", config: Mapping[str, Any]
) -> dict[str, Any]:
    """Return what is known before training.

    Parameters
    ----------
    meshes : sequence of (Store, Split)
        One dataset or several, and what of each is used how.
    config : mapping
        The fields of a `physgnn.learning.training.config.TrainingConfig`.
    """
    stores, splits = zip(*meshes, strict=True)
    options = resolved_options(config["model"], config["options"])
    hashes = [store.content_hash() for store in stores]
    return {
        "config": {**config, "options": options},
        "versions": {name: release(name) for name in VERSIONED},
        "data": {
            "path": str(stores[0].path),
            "paths": [str(store.path) for store in stores],
            "hash": _joint(hashes),
            "meshes": [store.mesh.content_hash for store in stores],
        },
        "split": {
            "name": splits[0].name,
            "train": sum(len(split.train) for split in splits),
            "validation": sum(len(split.validation) for split in splits),
            "test": sum(len(split.test) for split in splits),
            "hash": _joint([_split_hash(split) for split in splits]),
            "load_paths": _taught(meshes),
        },
    }


def _taught(meshes: "Sequence[tuple[Store, Split]]") -> list[str]:
    """Return the digests of the load paths that teach or validate, of all datasets."""
    from physgnn.dataset.splits.load_identity import load_digests

    used = (
        load_digests(store, np.concatenate([split.train, split.validation]))
        for store, split in meshes
    )
    return sorted({name for names in used for name in names})


def with_places(
    record: Mapping[str, Any], run: Path, stores: "Sequence[Store]"
) -> dict[str, Any]:
    """Return the record with where its datasets lie, seen from the run and in full."""
    places = [store.path.resolve() for store in stores]
    folder = run.resolve()
    where = [
        {"from_run": os.path.relpath(place, folder), "in_full": str(place)}
        for place in places
    ]
    return {**record, "data": {**record["data"], "stores": where}}


def place_of_store(run: Path, record: Mapping[str, Any]) -> Path:
    """Return where the (first) dataset of a run is.

    It is looked for where it lay, seen from the run, then where it lay in full, then
    under the name it had in the command, which is all that runs before 0.2 say.

    Raises
    ------
    InputError
        If it is at none of these.
    """
    data = record["data"]
    known = next(iter(data.get("stores", ())), None)
    places: list[Path] = []
    if known:
        places = [run / known["from_run"], Path(known["in_full"])]
    places.append(Path(data["path"]))
    for place in places:
        if place.is_dir():
            return place
    raise InputError(
        f"the dataset that {run} was trained on is not there (looked for "
        f"{', '.join(str(place) for place in places)}): name it with --store"
    )


def with_start(record: Mapping[str, Any], start: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of a run that begins with the weights of another.

    The meshes that one was trained on count as its own.
    """
    data = record["data"]
    meshes = dict.fromkeys([*data["meshes"], *trained_meshes(start)])
    earlier = {name: start[name] for name in ("data", "training")}
    return {**record, "data": {**data, "meshes": list(meshes)}, "start": earlier}


def trained_meshes(record: Mapping[str, Any]) -> list[str]:
    """Return the hashes of the meshes a run was trained on."""
    return list(record["data"].get("meshes") or [record["mesh_hash"]])


def with_result(
    record: Mapping[str, Any],
    *,
    loss: float,
    spent: Mapping[str, float],
    epoch: int | None = None,
) -> dict[str, Any]:
    """Return the record with what training reached and what it cost.

    Parameters
    ----------
    record : mapping
        That of `new_record`.
    loss : float
        The lowest validation loss.
    spent : mapping
        Minutes by the wall clock, ``wall``, and of the processor, ``processor``.
    epoch : int, optional
        After which the lowest loss was, 0 before the first; None without epochs.
    """
    training = {
        "best_validation_loss": loss,
        "best_epoch": epoch,
        "minutes": round(spent["wall"], 3),
        "processor_minutes": round(spent["processor"], 3),
    }
    return {**record, "training": training}


def learnt_nothing(record: Mapping[str, Any]) -> bool:
    """Return whether the weights kept are those that the training began with."""
    epoch: int | None = record["training"].get("best_epoch")
    return epoch == 0


def processor_minutes(record: Mapping[str, Any]) -> float:
    """Return what a run's training took of the processor, all threads together.

    Of runs that did not count it, their minutes by the wall clock.
    """
    training = record["training"]
    return float(training.get("processor_minutes", training["minutes"]))


def check_same_run(
    run: Path, record: Mapping[str, Any], defaults: Mapping[str, Any]
) -> None:
    """Raise InputError unless a run can be resumed with this record's data and config.

    Only budget and memory may differ.

    Parameters
    ----------
    run : path
        The folder of the run.
    record : mapping
        That of `new_record`.
    defaults : mapping
        The configuration by default: what an earlier version had no setting for was so.
    """
    file = RunFolder(run).record
    if not file.is_file():
        raise InputError(f"{run} holds no run to resume; start a new one")
    earlier = read_json(file)
    check_part(file)
    for part, what in (("data", "hash"), ("split", "hash")):
        if earlier[part][what] != record[part][what]:
            raise InputError(
                f"{run} was trained on another {part}; resume it with the same, or "
                "start a new run"
            )
    new, old = record["config"], {**defaults, **earlier["config"]}
    for name in sorted(new.keys() - EXTENDABLE):
        if new[name] != old.get(name):
            raise InputError(
                f"{run} was started with {name} = {old.get(name)} (got {new[name]}); "
                "resume it with the same, or start a new run"
            )


def _joint(hashes: Sequence[str]) -> str:
    """Return the hash of several; of one, itself."""
    if len(hashes) == 1:
        return hashes[0]
    return hashlib.sha256("".join(hashes).encode()).hexdigest()


def with_present_names(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return a record whose method and options have the names they have now.

    Options that came later have the value that leaves out what they choose.
    """
    config = record.get("config")
    if not isinstance(config, Mapping) or "model" not in config:
        return dict(record)
    model = config["model"]
    options = recorded_options(model, config.get("options", {}))
    named = {**config, "model": method_name(model), "options": options}
    return {**record, "config": named}


def _split_hash(split: "Split") -> str:
    parts = (split.train, split.validation, split.test)
    rows = np.concatenate([np.append(part, [[-1, -1]], axis=0) for part in parts])
    return hashlib.sha256(rows.astype("<i8").tobytes()).hexdigest()
