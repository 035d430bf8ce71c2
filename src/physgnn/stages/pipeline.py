"""From the bundled surfaces to a trained and evaluated network, step by step.

Each step leaves its result under its final name only when it is whole, so a second run
does what is missing and nothing else.
"""

import os
import shutil
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from physgnn import stages
from physgnn.dataset import Preset
from physgnn.geometry import mni152_phantom
from physgnn.io import read_mesh, write_mesh
from physgnn.io.atomic import whole_file
from physgnn.progress import Progress

if TYPE_CHECKING:
    from physgnn.evaluation.result import Report

Show = Callable[[str], AbstractContextManager[Progress]]
"""From a title to a context that yields a progress callback."""
Log = Callable[[str], None]
"""Told what is there already."""

SPLIT = "path"
MODEL = "lifted"
SETTINGS: dict[str, Any] = {
    "schedule": "cosine",
    "early_stopping": 1000,  # the last, slow steps of a cosine are its best
}
REPORT = "report.html"


@dataclass(frozen=True)
class Recipe:
    """What sets one way through the pipeline apart from another.

    Attributes
    ----------
    command : str
        For the record.
    surface_points, target_points : int
        About how many points the brain's surface has, and the mesh.
    preset : str or Preset
        What to simulate.
    training_minutes : float
        How long to train.
    peers : tuple of str
        Models to train as long and compare with, at their published settings.
    baselines : str
        What else to compare with: ``quick``, ``all``, or names with commas.
    tolerance_mm : float, optional
        Compare also with answers that are made to keep this.
    """

    command: str
    surface_points: int
    target_points: int
    preset: str | Preset
    training_minutes: float
    peers: tuple[str, ...] = ()
    baselines: str = "quick"
    tolerance_mm: float | None = None


@dataclass(frozen=True)
class Pipeline:
    """A recipe and the folder its results go to.

    Attributes
    ----------
    folder : Path
        Gets case.vtu, loads.zarr, run/, the peers' runs and report.html.
    recipe : Recipe
        What to do.
    show : callable
        From a title to a context that yields a progress callback.
    log : callable
        Told what is there already.
    """

    folder: Path
    recipe: Recipe
    show: Show
    log: Log

    def run(self) -> "Report":
        """Do what is not done yet; returns the errors on paths never trained on."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._mesh()
        self._simulate()
        for model in self.recipe.peers:
            self._train(model, self.folder / model)
        self._train(MODEL, self.trained, **SETTINGS)
        return self._evaluate()

    @property
    def case(self) -> Path:
        """The mesh."""
        return self.folder / "case.vtu"

    @property
    def store(self) -> Path:
        """The simulations."""
        return self.folder / "loads.zarr"

    @property
    def trained(self) -> Path:
        """The run folder."""
        return self.folder / "run"

    @property
    def report(self) -> Path:
        """The page to read."""
        return self.folder / REPORT

    def is_there(self, path: Path) -> bool:
        """Return whether a step's result is there, and say so if it is."""
        if path.exists():
            self.log(f"{path}: there already")
        return path.exists()

    def _mesh(self) -> None:
        if self.is_there(self.case):
            return
        with self.show("meshing"):
            phantom = mni152_phantom(n_points=self.recipe.surface_points)
            mesh = stages.mesh_surfaces(
                phantom.brain,
                phantom.tumours,
                target_points=self.recipe.target_points,
                log=self.log,
            )
            write_mesh(self.case, mesh)

    def _simulate(self) -> None:
        with self.show("simulating") as progress:
            _, did = stages.simulate(
                read_mesh(self.case),
                self.recipe.preset,
                self.store,
                workers=os.cpu_count() or 1,
                source={"mesh": str(self.case), "command": self.recipe.command},
                progress=progress,
            )
        if did.solved == 0:
            self.log(f"{self.store}: there already")

    def _train(self, model: str, run: Path, **settings: Any) -> None:
        from physgnn.learning.training_config import TrainingConfig

        if self.is_there(run):
            return
        unfinished = run.with_name(f"{run.name}-unfinished")
        minutes = self.recipe.training_minutes
        config = TrainingConfig(model=model, max_minutes=minutes, **settings)
        with self.show(f"training {model}") as progress:
            stages.train(
                self.store,
                SPLIT,
                config,
                unfinished,
                progress=progress,
                resume=(unfinished / "last.ckpt").exists(),
            )
        unfinished.rename(run)

    def _evaluate(self) -> "Report":
        from physgnn.evaluation.result import Report
        from physgnn.evaluation.run import Comparison, evaluate_runs

        made = self.trained / f"evaluation-{SPLIT}"
        if self.is_there(self.report):
            return Report.read(made / "metrics.json")
        recipe = self.recipe
        beside = Comparison(recipe.baselines, recipe.tolerance_mm)
        runs = [*(self.folder / model for model in recipe.peers), self.trained]
        with self.show("evaluating") as progress:
            errors = evaluate_runs(
                runs,
                self.store,
                SPLIT,
                comparison=beside,
                command=recipe.command,
                progress=progress,
            )
        with whole_file(self.report) as part:
            shutil.copyfile(made / REPORT, part)
        return errors
