"""The tasks: what is measured, on which data, with which samples held out.

A task's name and version fix all of it. Whoever changes a task raises its version, so
that no old result stands beside a new one as if they were of the same task.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from physgnn.dataset.presets import BRAIN_AND_TUMOUR, Preset
from physgnn.dataset.splits.samples import MESH
from physgnn.errors import InputError
from physgnn.geometry.point_sets import HalfSpace, Nearest
from physgnn.geometry.regions import BRAIN, TUMOUR
from physgnn.mechanics.loads.sampling import (
    all_node_paths,
    single_node_paths,
    traction_paths,
)
from physgnn.mechanics.materials import Ogden

SIZES = ("tiny", "full")
OVER_ALL, OVER_TUMOUR = "all points", "the tumour"
# Tonutti et al. 2017 (Artif. Intell. Med. 80): the law of both regions in the FEBio
# model that they published with the paper.
TONUTTI_LAW = Ogden((1044.0, 1183.0), (4.309, 7.736), 100_000.0)
TONUTTI_MATERIALS = {BRAIN: TONUTTI_LAW, TUMOUR: TONUTTI_LAW}
BELOW_N = 0.99  # their loads stay below 1 N
# The bundled brain, held and opened as preset ``demo`` has it.
HELD = HalfSpace((23.0, -35.0), (0.0, 0.0, 0.0), "<", 30.0)
OPENING_MM = (39.7, 8.8, 62.5)


@dataclass(frozen=True)
class Task:
    """One row of the benchmark.

    Attributes
    ----------
    version : int
        Raised whenever anything of the task changes.
    about : str
        What is measured, in one sentence.
    split : str
        How samples are held out, as in `physgnn.dataset.SPLITS`, or ``mesh``; of
        registrations ``shifts``, since every shift is held out.
    needs : str
        The file or folder that size ``full`` takes from the user's data; empty if it
        takes none.
    preset : str
        What that dataset must have been simulated with; empty if it is made here.
    tiny : Preset or None
        The same, small, on the bundled brain; None for registrations.
    over : str
        Where the error that ranks the methods is taken.
    published : str
        What a paper reports on it.
    measured : str
        What a registration is given, ``pairs`` or ``surface``; empty where a load is.
    """

    version: int
    about: str
    split: str
    needs: str
    preset: str = ""
    tiny: Preset | None = None
    over: str = OVER_ALL
    published: str = ""
    measured: str = ""


SINGLE_NODES = Preset(
    BRAIN_AND_TUMOUR,
    partial(single_node_paths, force_n=1.0, n_levels=3),
    fixed=HELD,
    loaded=Nearest(OPENING_MM, 4),
)
ALL_NODES = Preset(
    BRAIN_AND_TUMOUR,
    partial(all_node_paths, total_force_n=4.0, n_levels=4, n_paths=20),
    fixed=HELD,
    loaded=Nearest(OPENING_MM, 12),
)
TONUTTI_SMALL = Preset(
    TONUTTI_MATERIALS,
    partial(single_node_paths, force_n=BELOW_N, n_levels=3),
    fixed=HELD,
    loaded=Nearest(OPENING_MM, 2),
)
TONUTTI = Preset(
    TONUTTI_MATERIALS, partial(single_node_paths, force_n=BELOW_N, n_levels=10)
)
FAMILY = Preset(
    BRAIN_AND_TUMOUR,
    partial(traction_paths, traction_pa=1000.0, n_levels=3, n_paths=4),
    fixed=HELD,
    loaded=Nearest(OPENING_MM, 20),
)
REGISTRATION = partial(Task, version=1, split="shifts")

TASKS: Mapping[str, Task] = {
    "dataset-1-paths": Task(
        version=2,
        about="One loaded point at a time (dataset 1 of PhysGNN), load paths never "
        "trained on.",
        split="path",
        needs="paper-1.zarr",
        preset="paper-1",
        tiny=SINGLE_NODES,
    ),
    "dataset-1-nodes": Task(
        version=2,
        about="One loaded point at a time (dataset 1 of PhysGNN), points never loaded "
        "in training.",
        split="node",
        needs="paper-1.zarr",
        preset="paper-1",
        tiny=SINGLE_NODES,
    ),
    "dataset-2-paths": Task(
        version=2,
        about="A hundred loaded points at once (dataset 2 of PhysGNN), load paths "
        "never trained on.",
        split="path",
        needs="paper-2.zarr",
        preset="paper-2",
        tiny=ALL_NODES,
    ),
    "tonutti-2017": Task(
        version=2,
        about="The experiment of Tonutti et al. 2017: one of their force points at a "
        "time, forces below 1 N, errors over the tumour, load paths never trained on.",
        split="path",
        needs="tonutti2017.npz",
        tiny=TONUTTI_SMALL,
        over=OVER_TUMOUR,
        published="0.191 ± 0.201 mm (their network, their split, absolute position "
        "error)",
    ),
    "mesh-never-seen": Task(
        version=2,
        about="A body that nothing was trained on; training had others.",
        split=MESH,
        needs="mesh-never-seen",
        preset="family",
        tiny=FAMILY,
    ),
    "registration-pairs": REGISTRATION(
        about="From 50 measured pairs of the exposed surface to the displacement "
        "everywhere. Shifts are simulated on a finer mesh, with other tissue, support "
        "and loads than the registration knows, and measured with 0.5 to 1 mm of noise "
        "a coordinate. The loaded region is within 10 mm of the exposed surface.",
        needs="",
        measured="pairs",
    ),
    "registration-surface": REGISTRATION(
        about="The same shifts from 2000 points of the exposed surface, without "
        "telling which point is which.",
        needs="mesh-never-seen",
        preset="family",
        measured="surface",
    ),
}


def named_tasks(text: str) -> tuple[str, ...]:
    """Return the tasks that a name or ``all`` stands for.

    Raises
    ------
    InputError
        If there is no such task.
    """
    if text == "all":
        return tuple(TASKS)
    if text not in TASKS:
        raise InputError(f"no task '{text}' (there are: {', '.join(TASKS)}; or all)")
    return (text,)
