"""The model card: what a run folder's network is, for people."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from physgnn.io.integrity.atomic import write_whole
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.record import learnt_nothing, processor_minutes, read_json

OF_ONE_BODY = (
    "It knows one mesh, its materials and its fixed points; another brain, or another "
    "mesh of this one, needs training anew."
)
OF_A_FAMILY = (
    "It was trained on a family of patients: `physgnn adapt` makes it ready for "
    "another."
)
LIMITS = (
    "Loads unlike those trained on (other nodes, stronger forces) give answers without "
    "warranty; every prediction says whether its load lies outside.",
    "The truth it was trained on is itself a finite-element model with assumed tissue "
    "properties, not a measured brain.",
    "For research; not a medical device.",
)


def write_model_card(run: str | Path, errors: str | None = None) -> None:
    """Write ``model_card.md`` into a run folder, whole or not at all.

    Parameters
    ----------
    run : path
        Folder of a trained model.
    errors : str, optional
        What an evaluation measured, as Markdown; without, the card says that there
        has been none.
    """
    files = RunFolder(Path(run))
    write_whole(files.model_card, card(read_json(files.record), errors))


def card(record: Mapping[str, Any], errors: str | None = None) -> str:
    """Return the card of a run's record as Markdown."""
    config, data, split = record["config"], record["data"], record["split"]
    training = record["training"]
    whose = OF_A_FAMILY if len(data.get("meshes", ())) > 1 else OF_ONE_BODY
    sections = {
        "Data": f"`{data['path']}`, sha256 `{data['hash']}`; mesh `"
        f"{record['mesh_hash']}`.",
        "Split": f"'{split['name']}': {split['train']} training, "
        f"{split['validation']} validation and {split['test']} test samples.",
        "Training": _list(
            {
                "loss": config["loss"],
                "samples a step": config["batch_size"],
                "learning rate": f"{config['learning_rate']:g}, {config['schedule']}",
                "seed": config["seed"],
                "minutes spent": f"{training['minutes']:.1f}",
                "of the processor": f"{processor_minutes(record):.1f} minutes",
                "lowest validation loss": f"{training['best_validation_loss']:.4g}"
                + ", before the first epoch" * learnt_nothing(record),
                **record["versions"],
            }
        ),
        "Errors": errors or "Not evaluated yet: `physgnn evaluate` fills this in.",
        "Limits": "\n".join(f"- {line}" for line in (whose, *LIMITS)),
    }
    options = ", ".join(f"{k} {v}" for k, v in config["options"].items())
    head = (
        f"# {config['model']}\n\nDisplacement of a body under nodal forces. {options}."
    )
    body = "".join(f"\n\n## {title}\n{text}" for title, text in sections.items())
    return f"{head}{body}\n"


def _list(values: Mapping[str, Any]) -> str:
    return "\n".join(f"- {name}: {value}" for name, value in values.items())
