"""What the live view does for a patient, by the functions of the commands.

`init` writes the case file and `register` the displacement, so that what is kept of the
page is what the command line writes.
"""

import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry import TetMesh, boundary_surface
from physgnn.geometry.point_sets import select
from physgnn.geometry.regions import TUMOUR
from physgnn.io import read_mesh, write_mesh
from physgnn.io.integrity.atomic import whole_file, whole_folder, write_whole
from physgnn.scratch import scratch_folder
from physgnn.stages.patient.intraoperative.patient_body import (
    ready_patient,
    ready_registrar,
)
from physgnn.stages.patient.live_view.case_states import (
    how_to_register,
    registered,
)
from physgnn.stages.patient.live_view.page_options import (
    CHOICES,
    ROLES,
    SUFFIXES,
    roles_for,
)
from physgnn.stages.patient.preoperative.adaptation import adapt
from physgnn.stages.patient.preoperative.case_file import case_text, craniotomy_at

if TYPE_CHECKING:
    from physgnn.registration.registrar import Registrar
    from physgnn.serving.patient.desk import (
        FailedState,
        MeasuredState,
        Menu,
        Opening,
        RegisteredShift,
        RegisterOptions,
    )

CASE, MESH = "case.toml", "case.vtu"
FIRST_RADIUS_MM = 30.0
METHODS = "Linear elasticity and finite elements; no network was trained on this case."
ADAPTED = "The network that comes with the package, adapted to this case."


class CaseDesk:
    """A case on show: its craniotomy, its registrations, and a folder to keep them in.

    Where the mesh has no point set "fixed", the skull is taken to be open over the
    tumour, or at the top of the head, until another craniotomy is clicked.

    Parameters
    ----------
    case : path
        VTU.
    folder : path, optional
        Where to keep things; without one nothing is written.

    Raises
    ------
    InputError
        If the case cannot be read, or the folder is not there.
    """

    def __init__(self, case: str | Path, folder: str | Path | None = None) -> None:
        self._case, self._mesh_file = Path(case), Path(case)
        self._folder = None if folder is None else Path(folder)
        if self._folder is not None and not self._folder.is_dir():
            raise InputError(f"--save must name a folder that is there (got {folder})")
        self._count = 0  # of runs
        self._ready: Registrar | None = None  # of the mesh, held as it is
        self._mesh = read_mesh(case)
        self._surface = boundary_surface(self._mesh)
        self._cortex = self._surface.points[np.unique(self._surface.faces)]
        self._tree = KDTree(self._cortex)
        self._note, self._text = METHODS, ""
        with ExitStack() as unless_all_is_well:
            self._scratch = scratch_folder("case")
            unless_all_is_well.callback(self._scratch.cleanup)
            if "fixed" not in self._mesh.point_sets:
                self._open_somewhere()
            unless_all_is_well.pop_all()

    def _open_somewhere(self) -> None:
        """Lay the cortex open where nothing says where, and say so."""
        place, where = self._first_place()
        self._hold(self.opening(place, FIRST_RADIUS_MM))
        self._note += f" The skull is taken to be open {where}: click the craniotomy."

    @property
    def note(self) -> str:
        """What stands in for what the case does not say."""
        return self._note

    @property
    def saves(self) -> bool:
        """Whether there is a folder to save in."""
        return self._folder is not None

    @property
    def adapts(self) -> bool:
        """Whether the network of the package can be adapted and is not yet."""
        return self._text != "" and self._note != ADAPTED

    @property
    def roles(self) -> Mapping[str, str]:
        """What a measured file may be → its name on the page."""
        return {role: row.name for role, row in ROLES.items()}

    @property
    def suffixes(self) -> Sequence[str]:
        """How measured files may end."""
        return SUFFIXES

    @property
    def menus(self) -> "Mapping[str, Menu]":
        """What is chosen where some files are there."""
        from physgnn.serving.patient.desk import Menu

        return {
            name: Menu(row.name, row.values, roles_for(name))
            for name, row in CHOICES.items()
        }

    @property
    def mesh(self) -> TetMesh:
        """The mesh, with the points that are held and laid open."""
        return self._mesh

    def opening(self, point: FloatArray, radius_mm: float) -> "Opening":
        """Return the craniotomy about the cortex nearest to a point.

        Raises
        ------
        InputError
            If it leaves nothing to the skull.
        """
        from physgnn.serving.patient.desk import Opening

        middle = np.asarray(self._cortex[self._tree.query(point)[1]])
        found = craniotomy_at(self._surface, middle, radius_mm)
        return Opening(
            centre_mm=found.centre_mm,
            loaded=select(self._mesh, found.loaded),
            fixed=select(self._mesh, found.fixed),
            area_mm2=found.area_mm2,
            text=case_text(self._mesh, found, self._case.name, CASE),
        )

    def open(self, opening: "Opening") -> list[str]:
        """Hold and load the mesh so from now on; return the files that say so."""
        self._hold(opening)
        self._note = METHODS
        if self._folder is None:
            return []
        write_whole(self._folder / CASE, opening.text)
        return [CASE, *self._keep_mesh()]

    def adapt(self) -> Path:
        """Return a run folder of the package's network, ready for the case.

        Raises
        ------
        InputError
            If no craniotomy was clicked or taken, or the network does not fit the case.
        """
        if not self._text:
            raise InputError("click the craniotomy first: it says what loads to expect")
        loads = Path(self._scratch.name) / CASE
        write_whole(loads, self._text)
        self._count += 1
        run = Path(self._scratch.name) / f"run-{self._count}"
        adapt(None, self._mesh_file, run, loads=loads)
        self._note = ADAPTED
        return run

    def register(
        self,
        states: "Sequence[MeasuredState]",
        folder: Path,
        options: "RegisterOptions",
    ) -> "Iterator[RegisteredShift | FailedState]":
        """Register states one after the other, each from where the last one ended.

        The folder, which must be there, gets what `register` writes of a series. A
        state of a series that fails does not stop the others.

        Raises
        ------
        InputError
            If what was measured cannot be used, or together means nothing.
        """
        how = how_to_register(states, options)
        self._ready = self._ready or ready_registrar(self._mesh_file)
        yield from registered(ready_patient(self._ready), states, folder, how)

    def save(self, states: "Sequence[RegisteredShift | FailedState]") -> list[str]:
        """Keep what `register` wrote of the states; return the names of the files.

        Raises
        ------
        InputError
            If there is no folder, or it cannot be written.
        """
        from physgnn.serving.patient.desk import RegisteredShift

        if self._folder is None:
            raise InputError(
                "there is no folder: start physgnn view with --save FOLDER"
            )
        names = self._keep_mesh()
        shifts = [state for state in states if isinstance(state, RegisteredShift)]
        if len(states) > 1:
            return [*names, self._keep_series(self._folder, shifts[0].file.parent)]
        picture = shifts[0].file.with_suffix(".png")  # of a scan's brain
        for file in (shifts[0].file, shifts[0].misfits, picture):
            if file.is_file():
                with whole_file(self._folder / file.name, may_be_empty=True) as part:
                    shutil.copyfile(file, part)
                names.append(file.name)
        return names

    def close(self) -> None:
        """Delete what is not kept."""
        self._scratch.cleanup()

    def _hold(self, opening: "Opening") -> None:
        mesh = self._mesh.with_point_sets(fixed=opening.fixed, loaded=opening.loaded)
        file = Path(self._scratch.name) / MESH
        write_mesh(file, mesh)
        self._mesh, self._mesh_file, self._text = mesh, file, opening.text
        self._ready = None

    def _keep_mesh(self) -> list[str]:
        """Keep the mesh where its point sets are not those of the case."""
        if self._folder is None or self._mesh_file == self._case:
            return []
        with whole_file(self._folder / MESH) as part:
            shutil.copyfile(self._mesh_file, part)
        return [MESH]

    def _keep_series(self, folder: Path, states: Path) -> str:
        """Keep the folder of a series under a name that is free; return that."""
        names = chain(["states"], (f"states-{number}" for number in count(2)))
        name = next(name for name in names if not (folder / name).exists())
        with whole_folder(folder / name) as part:
            shutil.copytree(states, part)
        return f"{name}/"

    def _first_place(self) -> tuple[FloatArray, str]:
        cells = self._mesh.cells[self._mesh.region == TUMOUR]
        if not len(cells):
            return self._cortex[self._cortex[:, 2].argmax()], "at the top of the head"
        inside = self._mesh.points[np.unique(cells)]
        distance, _ = KDTree(inside).query(self._cortex)
        return self._cortex[distance.argmin()], "over the tumour"
