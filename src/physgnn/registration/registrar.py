"""From what was measured to the displacement everywhere.

The unknown forces are a combination of load modes (`load_modes`), f = B w, with
Gaussian coefficients w ~ N(0, Λ); what is measured is d = P u + noise, P the places and
directions of the measurements (`measurements`). The most probable displacement
minimises

    Σ ρ(d − P u, σ) + wᵀ Λ⁻¹ w    where    f_int(u) = B w,

ρ the logarithm of a density with heavy tails (`inference.heavy_tails`), σ the noise of
each kind of measurement. Both are sought at once (`inference.search`). The data hold
the iteration where the body was seen to be; solving for equilibrium under every w on
the way would not, since soft bodies buckle. A measured surface is matched anew at
every one of the first steps. The first step is linear elasticity; Λ is chosen there.
The posterior of the last step, widened by what simulated shifts say of the model's own
error, is the error bar (`inference.bounds`).
"""

import time
from collections.abc import Sequence

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.dataset.membranes import Membranes
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.cell_kinematics import volume_change_range
from physgnn.mechanics.linear.blas_threads import one_blas_thread
from physgnn.prediction.evidence import Evidence, Verdict, decide
from physgnn.prediction.measured_evidence import MeasurementFit
from physgnn.prediction.prediction import ErrorBound, Prediction
from physgnn.registration.covariances import point_covariance
from physgnn.registration.fit import fit_of
from physgnn.registration.inference.bounds import (
    error_lengths,
    estimate_of,
    factors_of,
    mixed_covariance,
)
from physgnn.registration.inference.search import Reached, Search
from physgnn.registration.load_families import Solve, load_modes
from physgnn.registration.measurements.kinds import (
    DEFAULT_NOISE_MM,
    AnyMeasured,
    Noise,
)
from physgnn.registration.misfits import rms_length
from physgnn.registration.mode_response import ModeResponse
from physgnn.registration.placement import Placed, placed
from physgnn.registration.result import Registration
from physgnn.registration.skull import SUPPORTS, with_membranes
from physgnn.registration.tangent_response import TangentResponse


class Registrar:
    """A body ready to be registered: everything that does not depend on measurements.

    Parameters
    ----------
    body : Body
        Its mesh is the rest state, its fixed points are those at the skull. Only ratios
        of stiffness matter, since displacements are measured, not forces.
    skull : str
        "fixed" if the points at the skull are held there, "sliding" if they may move
        along it (a row of `physgnn.registration.skull.SUPPORTS`).
    causes : sequence of str, optional
        Physiological causes in the prior, rows of
        `physgnn.registration.causes.CAUSES`; by default all that the body has the sets
        for.
    membranes : Membranes
        How falx and tentorium act; by default they are left out.

    Raises
    ------
    InputError
        If there is no such row, the fixed points do not hold the body, or the body
        lacks a membrane or what a named cause acts on.
    """

    def __init__(
        self,
        body: Body,
        *,
        skull: str = "fixed",
        causes: Sequence[str] | None = None,
        membranes: Membranes | None = None,
    ) -> None:
        if skull not in SUPPORTS:
            raise InputError(
                f"skull must be one of {', '.join(SUPPORTS)} (got '{skull}')"
            )
        self.body, self.skull = body, skull
        self.causes, self.membranes = causes, membranes or Membranes()
        support = with_membranes(SUPPORTS[skull](body), body, self.membranes)
        self.tangent = TangentResponse(body, support)
        self.modes = load_modes(
            body.mesh,
            body.fixed,
            self._linear_elasticity(),
            elements=body.elements,
            causes=causes,
        )
        self._respond = ModeResponse(self.tangent, self.modes)
        self._reached: Reached | None = None  # of the last call, whose factor is kept

    @one_blas_thread()
    def __call__(
        self,
        measured: AnyMeasured | Sequence[AnyMeasured],
        *,
        noise_mm: Noise = DEFAULT_NOISE_MM,
        rigid_offset: bool = False,
        after: FloatArray | None = None,
        linear: bool = False,
        coverage: float = 0.9,
        seed: int = 0,
    ) -> Registration:
        """Return the displacement field that the measurements tell of.

        Parameters
        ----------
        measured : PointPairs, Landmarks, SurfacePoints, WholeSurface, or several
            Points of the surface or inside before and after, where the exposed or the
            whole surface lies (a row each of
            `physgnn.registration.measurements.kinds.KINDS`). Among several may be
            bone points, which tell the offset of the navigation: it is corrected.
        noise_mm : float or mapping
            Standard deviation of each coordinate of a measured displacement or point,
            in [0.0001, 20]; of each kind by its name ("pairs", "landmarks", "surface",
            "whole surface", "bone"), 1 mm where it is not named.
        rigid_offset : bool
            Correct a rigid offset of the navigation that only the brain tells of. It is
            looked for either way.
        after : (n_points, 3) array, optional
            The displacement of the state before, mm, where the search begins: the
            result is the same to within a fraction of the noise, in a fraction of the
            time (`physgnn.registration.inference.search`).
        linear : bool
            Stop after the first step, linear elasticity.
        coverage : float
            Probability that an error bound shall hold, in (0, 1).
        seed : int
            Of the draws that the error bounds are counted on.

        Raises
        ------
        InputError
            If something is in another unit than the body or far from it, or a number
            is out of range.
        """
        if not 0 < coverage < 1:
            raise InputError(f"coverage must be in (0, 1) (got {coverage})")
        start = time.perf_counter()
        there = placed(self.body, measured, noise_mm, rigid_offset=rigid_offset)
        search, whole = self._searched(there, after=after, linear=linear)
        fit, rows = search.fit, search.rows()
        offset, alternatives = there.offset(search)
        lengths = error_lengths(alternatives, search.response, seed)
        factors = factors_of(there.kinds, skull=self.skull, corrected=there.corrected)
        estimate = estimate_of(lengths, coverage, factors)
        bone = there.bone_with(search)
        known = fit_of(there.measured, rows, fit, offset, bone)
        verdict = self._verdict(search, estimate, known, whole)
        deviation = factors.of_mean * lengths.deviation_mm
        covariance = point_covariance(
            mixed_covariance(alternatives), search.response, deviation
        )
        seconds = time.perf_counter() - start
        kept = rows.spread((~fit.outliers).astype(float)) > 0
        root = np.sqrt(rows.spread(fit.weights))
        return Registration(
            prediction=Prediction(
                search.u, estimate, verdict.status, seconds, reasons=verdict.reasons
            ),
            deviation_mm=deviation,
            covariance_mm2=covariance,
            forces=self._respond.forces(search.u, search.w),
            misfit_mm=rms_length(fit.misfit * rows.noise, kept, rows),
            held_out_mm=rms_length(
                fit.posterior.held_out / root * rows.noise, kept, rows
            ),
            misfits=there.misfits(search),
            offset=offset,
            bone=bone,
            left_out=there.left_out,
        )

    def _searched(
        self,
        there: Placed,
        *,
        after: FloatArray | None,
        linear: bool,
    ) -> tuple[Search, bool]:
        """Return a search that has ended, and whether it came to rest."""
        given = self._respond, self.modes, there.measured, there.noises
        before = None if after is None or linear else self._at(after)
        self._reached = None
        if before is not None:
            search = Search(*given, start=before, offset=there.prior)
            if search.descend():
                self._reached = search.reached
                return search, True
        search = Search(*given, start=self._at_rest(), offset=there.prior)
        if linear:
            return search, search.linear_step()
        whole = search.descend()
        if whole:
            self._reached = search.reached
        return search, whole

    def _at_rest(self) -> Reached:
        """Return the rest state, whose tangent is factorised again if it was not last.

        The modes' responses are those of the rest state.
        """
        rest = np.zeros_like(self.body.mesh.points)
        self.tangent.linearise(rest)
        return Reached(rest, np.zeros(len(self.modes.family)), self.modes.response)

    def _at(self, displacement: FloatArray) -> Reached | None:
        """Return the state with this displacement; None if the body is not stable.

        Where it is not the last one, nothing is known of growth: it begins with none.
        """
        last = self._reached
        if last is not None and np.array_equal(last.displacement, displacement):
            return last
        rest = np.zeros(len(self.modes.family))
        found = self._respond(displacement, rest)
        return None if found is None else Reached(displacement, rest, found[0])

    def _verdict(
        self,
        search: Search,
        estimate: ErrorBound,
        fit: MeasurementFit,
        converged: bool,
    ) -> Verdict:
        return decide(
            Evidence(
                largest_mm=float(np.linalg.norm(search.u, axis=1).max()),
                bound_mm=estimate.max_mm,
                converged=converged,
                jacobian=volume_change_range(self.body.mesh, search.u),
                fit=fit,
            )
        )

    def _linear_elasticity(self) -> Solve:
        """Return what forces (k, n_points, 3) do by linear elasticity at rest, mm."""
        if self.tangent.linearise(np.zeros_like(self.body.mesh.points)) is None:
            raise InputError(
                "the fixed points don't hold the body: its stiffness matrix is "
                "singular; fix at least three points that are not in line"
            )
        return self.tangent.solve
