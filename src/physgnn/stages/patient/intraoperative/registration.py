"""From what was measured in the operating theatre to the displacement of a brain."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.errors import InputError
from physgnn.io.displacement_files import form_of
from physgnn.io.medical.images.formats import read_image, suffix_of
from physgnn.progress import Log, no_log
from physgnn.stages.option_rules import check_options
from physgnn.stages.outputs import FOLDER, Output, writes
from physgnn.stages.patient.intraoperative.measured_files import (
    NOTHING,
    MeasuredFiles,
)
from physgnn.stages.patient.intraoperative.one_state import (
    HowToRegister,
    register_state,
    write_state,
)
from physgnn.stages.patient.intraoperative.patient_body import (
    HowItIsHeld,
    PatientBody,
    checked_registrar,
    patient_of,
    ready_patient,
)
from physgnn.stages.patient.intraoperative.registration_report import (
    page_in,
    registered_case,
    write_page,
)
from physgnn.stages.patient.intraoperative.scan_surface import ScanOptions
from physgnn.stages.patient.intraoperative.state_series import (
    StateResult,
    register_states,
)
from physgnn.stages.patient.intraoperative.state_table import StateRow, read_states

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.registration.registrar import Registrar
from physgnn.registration.result import Registration


@writes(
    out=Output(folder_with="series"),
    misfits=Output((".csv",)),
    picture=Output((".png",)),
    report=FOLDER,
)
def register(
    mesh: str | Path,
    out: str | Path,
    *,
    points: str | Path | None = None,
    target: str | Path | None = None,
    landmarks: str | Path | None = None,
    landmarks_target: str | Path | None = None,
    surface: str | Path | None = None,
    whole_surface: str | Path | None = None,
    intraoperative: str | Path | None = None,
    bone: str | Path | None = None,
    bone_target: str | Path | None = None,
    series: str | Path | None = None,
    initial_transform: str | Path | None = None,
    transformed: str = "both",
    noise_mm: float = 1.0,
    landmark_noise_mm: float | None = None,
    surface_noise_mm: float | None = None,
    whole_surface_noise_mm: float | None = None,
    bone_noise_mm: float | None = None,
    rigid_offset: bool = False,
    backend: str = "auto",
    contrast: str = "t1",
    any_size: bool = False,
    picture: str | Path | None = None,
    skull: str = "fixed",
    remove: str | None = None,
    causes: str | None = None,
    membranes: str | Path | None = None,
    materials: str | Path | None = None,
    form: str | None = None,
    image: str | Path | None = None,
    affine: str | None = None,
    misfits: str | Path | None = None,
    report: str | Path | None = None,
    registrar: "Registrar | None" = None,
    log: Log = no_log,
) -> "Registration | tuple[StateResult, ...]":
    """Find the displacement of a whole brain from what was measured of it.

    It is written whatever its status is, with the status and the reasons for it inside.
    Everything that is given counts, each with its own noise.

    Parameters
    ----------
    mesh : path
        VTU with the point set of the skull.
    out : path
        Where the displacement goes; `physgnn warp` takes a VTU. Of a series, its
        folder.
    points, target : path
        Points of the surface before and after: see
        `physgnn.io.medical.markups.read_point_pairs`.
    landmarks, landmarks_target : path
        The same of points inside the brain, such as those seen by ultrasound.
    surface : path
        Where the exposed surface lies now: see
        `physgnn.io.medical.measured_surface.read_surface_points`.
    whole_surface : path
        The whole surface of the brain now, as a mesh.
    intraoperative : path
        An MR scan of the head now, whose brain is segmented and taken as the whole
        surface; or a label map of it.
    bone, bone_target : path, optional
        Points of the bone in the scan and where the navigation finds them now, as
        `points` and `target`. They don't move with the brain, so they tell the rigid
        offset of the navigation, which is then corrected in everything measured.
    series : path, optional
        CSV with a row for each state of the operation, which are registered one after
        the other: columns ``name`` or ``time``, and the arguments above that name what
        was measured. What is given here counts in every state that names no other.
    initial_transform : path
        From the space of what was measured to that of the scan: see
        `physgnn.io.medical.linear_transforms.read_rigid_transform`.
    transformed : str
        "both" ends of pairs are measured in that space, or those "after" alone, those
        before being of the scan (a row of
        `physgnn.stages.patient.intraoperative.measured_files.TRANSFORMED`).
    noise_mm : float
        Standard deviation of each coordinate measured, mm.
    landmark_noise_mm, surface_noise_mm, whole_surface_noise_mm, bone_noise_mm : float
        Of these kinds; by default `noise_mm`.
        An intraoperative scan is a whole surface: its default is 2 mm if `noise_mm` is
        less.
    rigid_offset : bool
        Correct a rigid offset of the navigation that the brain alone tells of. Without
        `bone`, one into the brain can't be told from a brain that sank.
    backend, contrast, any_size
        Of an intraoperative scan: see `physgnn.segment`.
    picture : path, optional
        Where the outline of an intraoperative brain goes, PNG; by default beside `out`.
    skull : str
        How the skull holds the brain: see `physgnn.registration.registrar.Registrar`.
    remove : str, optional
        A region that was resected, by name or number, such as "tumour". The
        displacement is then that of the rest, and the file says what is gone.
    causes : str, optional
        Rows of `physgnn.registration.causes.CAUSES` with commas between them, or
        "none"; by default all that the body has the sets for.
    membranes : path, optional
        TOML with a table ``[membranes]``; by default falx and tentorium are left out.
    materials : path, optional
        TOML with ``[materials.<region>]`` tables; by default the tissues of the
        published work. Only ratios of stiffness matter.
    form, image, affine
        See `physgnn.stages.predict`.
    misfits : path, optional
        Where a CSV goes of how far each measured place is off, and its weight.
    report : path, optional
        Folder where ``report.html`` goes: before and after (of `image`, where one is
        given), uncertainty, misfit by point, the status and why. Made if it is missing.
    registrar : Registrar, optional
        Ready for this mesh, from an earlier call of
        `ready_registrar` in the module `patient_body` beside this one.
    log : callable
        Called with which measured points were left out, and why, with the outliers,
        with what the image's header leaves open, and where no bone checked the
        navigation.

    Returns
    -------
    Registration
        The displacement that was written, mm, with its deviation, bound and status. Of
        a series, a tuple of `StateResult`, one a state.

    Raises
    ------
    InputError
        If a file cannot be used, what was measured is far from the brain, or a point
        lies in tissue that was removed.
    """
    from physgnn.registration.misfits import write_misfits

    files = MeasuredFiles(
        points=points,
        target=target,
        landmarks=landmarks,
        landmarks_target=landmarks_target,
        surface=surface,
        whole_surface=whole_surface,
        intraoperative=intraoperative,
        bone=bone,
        bone_target=bone_target,
        initial_transform=initial_transform,
    )
    noises = {
        "landmarks": landmark_noise_mm,
        "surface": surface_noise_mm,
        "whole surface": whole_surface_noise_mm,
        "bone": bone_noise_mm,
    }
    how = HowToRegister(
        noise_mm=noise_mm,
        noises={kind: one for kind, one in noises.items() if one is not None},
        rigid_offset=rigid_offset,
        transformed=transformed,
        scan=ScanOptions(backend, contrast, any_size, affine),
    )
    held = HowItIsHeld(skull, remove, causes, membranes, materials)
    if series is not None:
        _refuse(form=form, image=image, misfits=misfits, report=report, picture=picture)
        states = read_states(series, files)
        _check_used(states, how)
        patient = _patient(mesh, held, registrar, log)
        return register_states(patient, states, Path(out), how, log=log)
    written = form_of(out, form)
    if report is None:
        written.check_image(out, image)
    write = written.write
    drawn = _picture(picture, intraoperative, Path(out))
    page = None if report is None else page_in(report)
    scan = None if image is None else read_image(image, affine=affine, log=log)
    if not files.paths:
        raise InputError(NOTHING)
    patient = _patient(mesh, held, registrar, log)
    state = register_state(
        patient.make(),
        files,
        how,
        resection=patient.resection,
        picture=drawn,
        log=log,
    )
    found, case = state.found, patient.body.mesh
    write_state(Path(out), patient, found, write, None if scan is None else scan.grid)
    if misfits is not None:
        write_misfits(misfits, found.misfits)
    if page is not None:
        write_page(page, registered_case(case, found, state.measured, noise_mm, scan))
    return found


def _patient(
    mesh: str | Path, held: HowItIsHeld, registrar: "Registrar | None", log: Log
) -> PatientBody:
    if registrar is None:
        return patient_of(mesh, held, log=log)
    return ready_patient(checked_registrar(registrar, mesh, held))


def _refuse(**options: object) -> None:
    """Raise InputError if an option of one state is given with a series."""
    given = [f"--{name}" for name, value in options.items() if value is not None]
    if given:
        raise InputError(
            f"{', '.join(given)} is for one state: leave it out of a series, which has "
            "files of its own"
        )


def _check_used(states: Sequence[StateRow], how: HowToRegister) -> None:
    """Raise InputError if no state of a series uses an option that is not usual."""
    usual = {**vars(HowToRegister()), **vars(ScanOptions())}
    chosen = {**vars(how), **vars(how.scan)}
    given = {name for name, value in chosen.items() if value != usual[name]}
    noises = {f"{kind.replace(' ', '_')}_noise_mm" for kind in how.noises}
    measured = {role for state in states for role in state.files.paths}
    check_options(
        "register",
        given | noises | measured,
        lambda name: f"--{name.replace('_', '-')}",
    )


def _picture(
    picture: str | Path | None, scan: str | Path | None, out: Path
) -> Path | None:
    """Return where the outline of an intraoperative brain goes."""
    if scan is None:
        if picture is not None:
            raise InputError("--picture shows an intraoperative scan: give one")
        return None
    name = out.name[: -len(suffix_of(out))] if suffix_of(out) else out.stem
    drawn = out.with_name(f"{name}.png") if picture is None else Path(picture)
    return drawn
