"""From surfaces to evaluated networks, step by step.

Each step leaves its result under its final name only when it is whole, so a second run
does what is missing and nothing else.
"""

import json
import math
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.dataset import Preset
from physgnn.geometry import Surface
from physgnn.io import read_mesh, write_mesh
from physgnn.learning.runs.folder import RunFolder
from physgnn.progress import Log, Show, no_log, no_show
from physgnn.stages.datasets.simulation import processes, simulate_mesh
from physgnn.stages.networks.training import train_run
from physgnn.stages.patient.preoperative.surface_meshing import mesh_surfaces

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.evaluation.measure.result import Report
    from physgnn.evaluation.run_evaluation import Comparison
    from physgnn.learning.training.config import TrainingConfig


@dataclass(frozen=True)
class Pipeline:
    """The steps, and the folder their results go to.

    Attributes
    ----------
    folder : Path
        Gets case.vtu, loads.zarr and a run folder for each network.
    command : str
        The command that made it, as the record names it.
    show : callable
        From a title to a context that yields a progress callback.
    log : callable
        Receives a line on what is there already.
    """

    folder: Path
    command: str
    show: Show = no_show
    log: Log = no_log

    @property
    def case(self) -> Path:
        """The mesh."""
        return self.folder / "case.vtu"

    @property
    def store(self) -> Path:
        """The simulations."""
        return self.folder / "loads.zarr"

    def run(self, name: str) -> RunFolder:
        """Return the folder of a trained network."""
        return RunFolder(self.folder / name)

    def is_there(self, path: Path) -> bool:
        """Return whether a step's result is there, and log it if it is."""
        if path.exists():
            self.log(f"{path}: there already")
        return path.exists()

    def mesh(
        self,
        surfaces: Callable[[], Sequence[Surface]],
        *,
        target_points: int | None = None,
    ) -> None:
        """Mesh a brain and what is in it.

        Parameters
        ----------
        surfaces : callable
            Returns the brain's surface and those inside it.
        target_points : int, optional
            About how many points the mesh shall have; by default the published rule.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        if self.is_there(self.case):
            return
        with self.show("meshing"):
            brain, *inner = surfaces()
            made = mesh_surfaces(
                brain, inner, target_points=target_points, log=self.log
            )
            write_mesh(self.case, made)

    def simulate(self, preset: str | Preset) -> None:
        """Solve the load paths of a preset."""
        with self.show("simulating") as progress:
            _, did = simulate_mesh(
                read_mesh(self.case),
                preset,
                self.store,
                workers=processes(),
                source={"mesh": str(self.case), "command": self.command},
                progress=progress,
            )
        if did.solved == 0:
            self.log(f"{self.store}: there already")

    def train(self, name: str, split: str, config: "TrainingConfig") -> RunFolder:
        """Train a network; one that was given less time before is trained on."""
        run, part = self.run(name), self.run(f"{name}-unfinished")
        if _is_trained(run, config):
            self.log(f"{run.path}: there already")
            return run
        if run.path.exists():
            run.path.rename(part.path)
        part.evaluation(split).report.unlink(missing_ok=True)  # of earlier weights
        resume = can_resume(part)
        with self.show(f"training {config.model}, split '{split}'") as progress:
            train_run(
                self.store, split, config, part.path, progress=progress, resume=resume
            )
        part.path.rename(run.path)
        return run

    def evaluate(
        self,
        runs: Sequence[RunFolder],
        split: str,
        *,
        comparison: "Comparison | None" = None,
    ) -> "Report":
        """Measure networks on what none of them was trained on; the last is judged."""
        from physgnn.evaluation.measure.result import Report
        from physgnn.evaluation.run_evaluation import Comparison, evaluate_runs

        made = runs[-1].evaluation(split)
        if self.is_there(made.report):
            return Report.read(made.metrics)
        with self.show("evaluating") as progress:
            return evaluate_runs(
                [run.path for run in runs],
                self.store,
                split,
                comparison=comparison or Comparison(),
                command=self.command,
                progress=progress,
            )


def can_resume(run: RunFolder) -> bool:
    """Return whether a run left a state; if not, clear away what it did leave."""
    if run.state.exists():
        return True
    shutil.rmtree(run.path, ignore_errors=True)
    return False


def _is_trained(run: RunFolder, config: "TrainingConfig") -> bool:
    """Return whether a run is whole, its error bounds too, and had the time asked."""
    if not all(file.exists() for file in (run.record, *run.calibrations)):
        return False
    record = json.loads(run.record.read_text("utf-8"))
    given = record["config"]["max_minutes"] or math.inf
    return bool(given >= (config.max_minutes or math.inf))
