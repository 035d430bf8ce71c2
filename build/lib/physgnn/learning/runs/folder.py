"""The files of a run folder: what each is called, and nothing about what is in it."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Folder:
    """Where files of known names lie.

    Parameters
    ----------
    path : path
        The folder; it need not exist yet.
    """

    path: Path

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", Path(self.path))


@dataclass(frozen=True)
class RunFolder(Folder):
    """Where a trained model is kept."""

    @property
    def record(self) -> Path:
        """How the model came about, JSON."""
        return self.path / "run.json"

    @property
    def weights(self) -> Path:
        """The weights with the lowest validation loss."""
        return self.path / "weights.safetensors"

    @property
    def case(self) -> Path:
        """The mesh, with its fixed points."""
        return self.path / "case.vtu"

    @property
    def manifest(self) -> Path:
        """The digests of the files that predictions depend on, JSON."""
        return self.path / "manifest.json"

    @property
    def state(self) -> Path:
        """What an interrupted training goes on from; written every few minutes."""
        return self.path / "last.ckpt"

    @property
    def metrics(self) -> Path:
        """Losses and learning rate of every epoch, CSV."""
        return self.path / "metrics.csv"

    @property
    def model_card(self) -> Path:
        """What the model is, for people."""
        return self.path / "model_card.md"

    @property
    def calibration(self) -> Path:
        """The quick error bounds."""
        return self.path / "calibration.json"

    @property
    def relaxation(self) -> Path:
        """The error bounds that follow from the physical estimate."""
        return self.path / "calibration-relaxation.json"

    @property
    def calibrations(self) -> tuple[Path, ...]:
        """The files of all error bounds."""
        return self.calibration, self.relaxation

    @property
    def factors(self) -> Path:
        """Matrix factors that are used again; made when first needed."""
        return self.path / "factors"

    def evaluation(self, split: str) -> "EvaluationFolder":
        """Return where an evaluation on a split goes if nothing else is said."""
        return EvaluationFolder(self.path / f"evaluation-{split}")


@dataclass(frozen=True)
class EvaluationFolder(Folder):
    """Where an evaluation is kept."""

    @property
    def metrics(self) -> Path:
        """Every figure, per sample included, JSON."""
        return self.path / "metrics.json"

    @property
    def error_bars(self) -> Path:
        """Estimates and bounds beside true errors, JSON."""
        return self.path / "error-bars.json"

    @property
    def figures(self) -> Path:
        """The folder of pictures."""
        return self.path / "figures"

    @property
    def rows(self) -> Path:
        """The folder of what was measured, a file for each row of the table."""
        return self.path / "rows"

    @property
    def report(self) -> Path:
        """The page to read, which is written last."""
        return self.path / "report.html"
