"""From what is measured on the exposed surface to the displacement everywhere.

The unknown forces are a combination of load modes (`load_modes`), f = B w, with
Gaussian coefficients w ~ N(0, Λ); what is measured is d = P u + noise, P the places and
directions of the measurement (`measurement`). The most probable displacement minimises

    |d − P u|² / σ² + wᵀ Λ⁻¹ w    where    f_int(u) = B w.

Both are sought at once (Gauss–Newton on u and w together): about u, equilibrium is
u + K(u)⁻¹ (B w − f_int(u)), linear in w, so that the best w is that of a Gaussian
regression (`gaussian`) and the new u follows. The data hold the iteration where the
body was seen to be; solving for equilibrium under every w on the way would not, since
soft bodies buckle. A measured surface is matched anew while steps are long. The first
step is linear elasticity; Λ is chosen there. The posterior of the last step, widened by
what simulated shifts say of the model's own error and where held-out points call for
more, is the error bar.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_points
from physgnn.geometry.measured import PointPairs, SurfacePoints
from physgnn.geometry.plausibility import check_same_units
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import deformation_gradient
from physgnn.mechanics.body import Body
from physgnn.prediction.evidence import Evidence, decide
from physgnn.prediction.prediction import ErrorBound, Prediction
from physgnn.registration.fit import fit_of
from physgnn.registration.gaussian import Posterior, choose_variances, condition
from physgnn.registration.load_families import load_modes
from physgnn.registration.measurement import (
    MeasuredPairs,
    MeasuredSurface,
    Measurement,
    Observation,
)
from physgnn.registration.skull import SUPPORTS
from physgnn.registration.tangent_response import TangentResponse

Fields = NDArray[np.float32]

MAX_STEPS = 20
LONGEST_STEP_MM = 5.0  # longer ones leave the range where linear elasticity holds
MAX_HALVINGS = 6
STEP_TOLERANCE_MM = 0.02  # far below what a tracked pointer measures
# After a step as short as this, or half of all, a measured surface keeps its matching:
# points that change from face to face would never come to rest.
MATCHED_MM = 0.3
N_DRAWS = 100
# What the posterior does not know of: other materials, another line along which the
# skull holds. Errors over their bounds at the 90th percentile of 60 (the first) and 20
# simulated shifts (benchmarks/registration.py --first-seed 200, run with factors of 1).
# Where only the surface is measured, what may slide within it is overestimated.
MODEL_ERROR: Mapping[tuple[str, str], float] = {
    ("pairs", "fixed"): 1.75,
    ("pairs", "sliding"): 1.7,
    ("surface", "fixed"): 0.65,
    ("surface", "sliding"): 0.7,
}


@dataclass(frozen=True, eq=False)
class Registration:
    """A whole displacement field from measured points.

    Attributes
    ----------
    prediction : Prediction
        Displacement, error estimate, status with its reasons, and time.
    deviation_mm : (n_points,) array
        Standard deviation of each point's displacement (root of the trace).
    forces : (n_points, 3) array
        The nodal forces that explain the measurement, N; not unique.
    misfit_mm : float
        Root mean square distance between measured and registered points; of a
        measured surface, from it.
    held_out_mm : float
        The same for points that were left out, each predicted from the others.
    """

    prediction: Prediction
    deviation_mm: FloatArray
    forces: FloatArray
    misfit_mm: float
    held_out_mm: float


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

    Raises
    ------
    InputError
        If there is no such row, or the fixed points do not hold the body.
    """

    def __init__(self, body: Body, *, skull: str = "fixed") -> None:
        if skull not in SUPPORTS:
            raise InputError(
                f"skull must be one of {', '.join(SUPPORTS)} (got '{skull}')"
            )
        self.body, self.skull = body, skull
        self.tangent = TangentResponse(body, SUPPORTS[skull](body))
        self.modes = load_modes(body.mesh, body.fixed, self._at_rest)

    def __call__(
        self,
        measured: PointPairs | SurfacePoints,
        *,
        noise_mm: float = 1.0,
        linear: bool = False,
        coverage: float = 0.9,
        seed: int = 0,
    ) -> Registration:
        """Return the displacement field that the measured points tell of.

        Parameters
        ----------
        measured : PointPairs or SurfacePoints
            Points of the surface before and after, or where the exposed surface lies.
        noise_mm : float
            Standard deviation of each coordinate of a measured displacement or point,
            in (0, 20].
        linear : bool
            Stop after the first step, linear elasticity.
        coverage : float
            Probability that an error bound shall hold, in (0, 1).
        seed : int
            Of the draws that the error bounds are counted on.

        Raises
        ------
        InputError
            If the points are in another unit than the body, one is far from the
            surface, or a number is out of range.
        """
        if not 0 < noise_mm <= 20 or not 0 < coverage < 1:
            raise InputError(
                "noise_mm must be in (0, 20] and coverage in (0, 1) "
                f"(got {noise_mm}, {coverage})"
            )
        start = time.perf_counter()
        _check_units(self.body.mesh, measured)
        measurement: Measurement = (
            MeasuredPairs(self.body.mesh, measured)
            if isinstance(measured, PointPairs)
            else MeasuredSurface(self.body.mesh, self.body.fixed, measured)
        )
        search = _Search(self, measurement, noise_mm)
        whole = search.linear_step() if linear else search.descend()
        lengths = _error_lengths(search.posterior, search.response, seed)
        lengths *= MODEL_ERROR[measurement.kind, self.skull]
        estimate = _estimate(lengths, coverage)
        verdict = decide(
            Evidence(
                largest_mm=float(np.linalg.norm(search.u, axis=1).max()),
                bound_mm=estimate.max_mm,
                converged=whole,
                jacobian=_volume_changes(self.body.mesh, search.u),
                fit=fit_of(measurement, search.u, search.posterior),
            )
        )
        seconds = time.perf_counter() - start
        return Registration(
            prediction=Prediction(
                search.u, estimate, verdict.status, seconds, reasons=verdict.reasons
            ),
            deviation_mm=np.sqrt((lengths**2).mean(axis=0)),
            forces=_combined(self.modes.forces, search.w),
            misfit_mm=_rms(measurement.observe(search.u).missing),
            held_out_mm=_rms(search.posterior.held_out),
        )

    def _at_rest(self, forces: FloatArray) -> FloatArray:
        """Return what forces (k, n_points, 3) do by linear elasticity, mm."""
        rest = np.zeros_like(self.body.mesh.points)
        found = self.tangent(rest, forces.astype(np.float32))
        if found is None:
            raise InputError(
                "the fixed points don't hold the body: its stiffness matrix is "
                "singular; fix at least three points that are not in line"
            )
        return found[0].astype(np.float64)


def _check_units(mesh: TetMesh, measured: PointPairs | SurfacePoints) -> None:
    if isinstance(measured, PointPairs):
        check_same_units(measured.source, mesh.points, "measured points")
    else:
        surface = mesh.points[boundary_points(mesh)]
        check_same_units(measured.points, surface, "measured surface")


class _Search:
    """One descent from the rest state to the most probable displacement."""

    def __init__(
        self, registrar: Registrar, measurement: Measurement, noise: float
    ) -> None:
        self._registrar, self._measurement = registrar, measurement
        self._noise = noise
        self.u = np.zeros_like(registrar.body.mesh.points)
        self.response: Fields = registrar.modes.response
        self._backward = np.zeros_like(self.u)
        self._seen, self._matches = measurement.observe(self.u), True
        A, d = _matrix(self._seen, self.response), self._seen.missing
        self._prior = choose_variances(A, d.ravel(), registrar.modes.family, noise)
        self.posterior: Posterior = condition(A, d, self._prior, noise)

    @property
    def w(self) -> FloatArray:
        """The coefficients that go with `u` when the search has ended."""
        return self.posterior.mean

    def linear_step(self) -> bool:
        """Take the displacement of linear elasticity."""
        self.u = self._step()
        return True

    def descend(self) -> bool:
        """Step until steps are short; False if that was not reached."""
        for count in range(MAX_STEPS):
            step = self._step()
            length = float(np.linalg.norm(step, axis=1).max())
            self._matches = length > MATCHED_MM and count < MAX_STEPS // 2
            if not self._advance(step * min(1.0, LONGEST_STEP_MM / length)):
                return False
            if length < STEP_TOLERANCE_MM:
                return True
        return False

    def _step(self) -> FloatArray:
        return self._backward + _combined(self.response, self.w)

    def _advance(self, step: FloatArray) -> bool:
        """Go along a step, a half, a quarter … of it, to where the body is stable."""
        for halvings in range(MAX_HALVINGS):
            u = self.u + step / 2**halvings
            found = self._registrar.tangent(u, self._registrar.modes.forces)
            if found is not None:
                self._seen = (
                    self._measurement.observe(u)
                    if self._matches
                    else self._seen.after(u - self.u)
                )
                self.u, (self.response, self._backward) = u, found
                self.posterior = condition(
                    _matrix(self._seen, self.response),
                    self._seen.missing - self._seen.of(self._backward),
                    self._prior,
                    self._noise,
                )
                return True
        return False


def _matrix(seen: Observation, response: Fields) -> FloatArray:
    """Return what each mode does to each measured component, A = P K⁻¹ B."""
    rows = [seen.of(u.astype(np.float64)).ravel() for u in response]
    return np.array(rows).T


def _error_lengths(posterior: Posterior, response: Fields, seed: int) -> FloatArray:
    """Return the lengths of errors drawn from the posterior, (n_draws, n_points)."""
    variances, axes = np.linalg.eigh(posterior.covariance)
    z = np.random.default_rng(seed).standard_normal((N_DRAWS, len(variances)))
    draws = (z * np.sqrt(np.maximum(variances, 0.0))) @ axes.T
    errors = np.tensordot(draws.astype(np.float32), response, 1)
    lengths: FloatArray = np.linalg.norm(errors, axis=2).astype(np.float64)
    return lengths * max(1.0, posterior.surprise)


def _estimate(lengths: FloatArray, coverage: float) -> ErrorBound:
    """Return bounds on the mean and the largest error."""
    mean, largest = (
        float(np.quantile(size, coverage))
        for size in (lengths.mean(axis=1), lengths.max(axis=1))
    )
    return ErrorBound(mean, largest, coverage)


def _combined(fields: Fields, w: FloatArray) -> FloatArray:
    return np.tensordot(w, fields, 1).astype(np.float64)


def _volume_changes(mesh: TetMesh, u: FloatArray) -> tuple[float, float]:
    """Return the smallest and the largest det F over cells."""
    J = np.linalg.det(deformation_gradient(mesh, u))
    return float(J.min()), float(J.max())


def _rms(missing: FloatArray) -> float:
    """Root mean square length of rows."""
    return float(np.sqrt((missing**2).sum(axis=1).mean()))
