"""What has been done for a patient, and from what: ``patient.json`` in its folder.

A step's digest is that of its arguments, with each file's content in place of its name.
A step is done if its digest and that of its result are those recorded.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

from physgnn.io.integrity.atomic import write_whole
from physgnn.io.integrity.digest import digest_of, digest_of_file
from physgnn.learning.runs.folder import RunFolder
from physgnn.stages.cohort.planning import Call
from physgnn.stages.cohort.step_table import Figures

FORMAT, VERSION = "physgnn-patient", 1
FILE = "patient.json"


@dataclass
class PatientRecord:
    """The steps done in a patient's folder.

    Attributes
    ----------
    folder : Path
    steps : mapping
        Command → digests of what it was made from and of what it made, and figures.
    """

    folder: Path
    steps: dict[str, dict[str, Any]] = field(default_factory=dict)

    @classmethod
    def read(cls, folder: Path) -> "PatientRecord":
        """Return the record in a folder; an empty one if there is none to be read."""
        try:
            values = json.loads((folder / FILE).read_text("utf-8"))
            if (values["format"], values["version"]) != (FORMAT, VERSION):
                return cls(folder)
            steps = {str(k): dict(v) for k, v in values["steps"].items()}
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return cls(folder)  # what is not known to be done is done anew
        return cls(folder, steps)

    def figures_of(self, call: Call) -> Figures | None:
        """Return what a call made, if it is done, and made from the same.

        A stage that resumes is called again: it knows what has changed.
        """
        if call.resumes:
            return None
        done = self.steps.get(call.step.command, {})
        if not all(file.exists() for file in call.files):
            return None
        if done.get("inputs") != inputs_digest(call):
            return None
        if done.get("output") != content_digest(call.out):
            return None
        figures = done.get("figures")
        return dict(figures) if isinstance(figures, Mapping) else None

    def begin(self, call: Call) -> None:
        """Forget a step that is about to be done anew."""
        if self.steps.pop(call.step.command, None) is not None:
            self._write()

    def end(self, call: Call, figures: Figures) -> None:
        """Note that a step is done."""
        self.steps[call.step.command] = {
            "inputs": inputs_digest(call),
            "output": content_digest(call.out),
            "figures": figures,
        }
        self._write()

    def _write(self) -> None:
        values = {"format": FORMAT, "version": VERSION, "steps": self.steps}
        write_whole(self.folder / FILE, json.dumps(values, indent=1, allow_nan=False))


def inputs_digest(call: Call) -> str:
    """Return the digest of all that a call's result follows from."""
    files = {str(path): content_digest(path) for path in call.inputs}

    def content(value: Any) -> Any:
        if isinstance(value, list):
            return [content(one) for one in value]
        return files.get(str(value), None if value is None else str(value))

    arguments = {name: content(value) for name, value in call.arguments.items()}
    return digest_of({"of": call.step.command, "by": version("physgnn"), **arguments})


def content_digest(path: Path) -> str:
    """Return the digest of a file, or of what is in a folder.

    Of a run folder what predictions depend on counts, not what they leave there.
    """
    if path.is_file():
        return digest_of_file(path)
    run = RunFolder(path)
    parts = [run.manifest, *run.calibrations] if run.manifest.is_file() else []
    files = [file for file in parts or sorted(path.rglob("*")) if file.is_file()]
    return digest_of(
        {file.relative_to(path).as_posix(): digest_of_file(file) for file in files}
    )
