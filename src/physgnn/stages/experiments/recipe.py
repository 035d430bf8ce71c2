"""The bundled brain, a lifted network on it, and what it is compared with."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from physgnn.dataset import Preset
from physgnn.geometry import Surface, mni152_phantom
from physgnn.stages.experiments.pipeline import Pipeline

if TYPE_CHECKING:
    from physgnn.evaluation.measure.result import Report

SPLIT = "path"
MODEL = "lifted"
RUN = "run"
SETTINGS: dict[str, Any] = {
    "schedule": "cosine",
    "early_stopping": 1000,  # the last, slow steps of a cosine are its best
}


@dataclass(frozen=True)
class Recipe:
    """What to make of the bundled brain.

    Attributes
    ----------
    command : str
        The command that made it, as the record names it.
    surface_points, target_points : int
        About how many points the brain's surface has, and the mesh.
    preset : str or Preset
        What to simulate.
    training_minutes : float
        How long to train.
    options : mapping
        Of the network, where they differ from its defaults.
    peers : tuple of str
        Models to train as long and compare with, at their published settings.
    baselines : str
        What else to compare with: ``quick``, ``all``, or names with commas.
    tolerance_mm : float, optional
        Compare also with predictions that are repaired to keep this.
    """

    command: str
    surface_points: int
    target_points: int
    preset: str | Preset
    training_minutes: float
    options: Mapping[str, Any] = field(default_factory=dict)
    peers: tuple[str, ...] = ()
    baselines: str = "quick"
    tolerance_mm: float | None = None

    def follow(self, pipeline: Pipeline) -> "Report":
        """Do what is not done yet; return the errors on paths never trained on."""
        from physgnn.evaluation.run_evaluation import Comparison
        from physgnn.learning.training.config import TrainingConfig

        pipeline.mesh(self._surfaces, target_points=self.target_points)
        pipeline.simulate(self.preset)
        minutes = self.training_minutes
        runs = [
            pipeline.train(model, SPLIT, TrainingConfig(model, max_minutes=minutes))
            for model in self.peers
        ]
        config = TrainingConfig(
            MODEL, options=dict(self.options), max_minutes=minutes, **SETTINGS
        )
        runs.append(pipeline.train(RUN, SPLIT, config))
        beside = Comparison(self.baselines, self.tolerance_mm)
        return pipeline.evaluate(runs, SPLIT, comparison=beside)

    def _surfaces(self) -> list[Surface]:
        phantom = mni152_phantom(n_points=self.surface_points)
        return [phantom.brain, *phantom.tumours]
