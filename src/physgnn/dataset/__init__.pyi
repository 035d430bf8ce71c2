"""The names that `physgnn.dataset` exports, and where each is."""

from .generation.pending_paths import SOLVERS as SOLVERS
from .generation.pending_paths import Generation as Generation
from .generation.pending_paths import generate as generate
from .generation.verification import Verification as Verification
from .generation.verification import verification_of as verification_of
from .generation.verification import verify as verify
from .presets import PRESETS as PRESETS
from .presets import Preset as Preset
from .splits.samples import SPLITS as SPLITS
from .splits.samples import Split as Split
from .splits.samples import named_split as named_split
from .splits.samples import split_node as split_node
from .splits.samples import split_path as split_path
from .splits.samples import split_published as split_published
from .storage.store import Store as Store

__all__: list[str]
