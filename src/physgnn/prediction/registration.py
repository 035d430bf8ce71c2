"""From a few measured points on the exposed surface to the displacement everywhere.

The unknown forces are a combination of load modes (`load_modes`), f = B w, with
Gaussian coefficients w ~ N(0, Λ); the measured displacements are d = P u + noise. The
most probable answer minimises

    |d − P u|² / σ² + wᵀ Λ⁻¹ w    where    f_int(u) = B w.

Both are sought at once (Gauss–Newton on u and w together): about u, equilibrium is
u + K(u)⁻¹ (B w − f_int(u)), linear in w, so that the best w is that of a Gaussian
regression (`gaussian`) and the new u follows. The data hold the iteration where the
body was seen to be; solving for equilibrium under every w on the way would not, since
soft bodies buckle. The first step is linear elasticity; Λ is chosen there. The
posterior of the last step, widened by what simulated shifts say of the model's own
error and where held-out points call for more, is the error bar.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from physgnn.errors import InputError
from physgnn.geometry.point_pairs import PointPairs
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.rest_state import RestState
from physgnn.prediction.gaussian import Posterior, choose_variances, condition
from physgnn.prediction.load_modes import load_modes
from physgnn.prediction.measurement import surface_interpolation
from physgnn.prediction.prediction import ErrorEstimate, Prediction, PredictionStatus
from physgnn.prediction.tangent_response import TangentResponse

FloatArray = NDArray[np.float64]
Fields = NDArray[np.float32]

MAX_STEPS = 20
LONGEST_STEP_MM = 5.0  # longer ones leave the range where linear elasticity holds
MAX_HALVINGS = 6
STEP_TOLERANCE_MM = 0.02  # far below what a tracked pointer measures
N_DRAWS = 100
# What the posterior does not know of: other materials, another line along which the
# skull holds. Errors over their bounds at the 90th percentile of 60 simulated shifts
# (benchmarks/registration.py --first-seed 200 --cases 60, run with a factor of 1).
MODEL_ERROR = 1.75


@dataclass(frozen=True, eq=False)
class Registration:
    """A whole displacement field from measured points.

    Attributes
    ----------
    prediction : Prediction
        Displacement, error estimate, status and time.
    deviation_mm : (n_points,) array
        Standard deviation of each point's displacement (root of the trace).
    forces : (n_points, 3) array
        The nodal forces that explain the measurement, N; not unique.
    misfit_mm : float
        Root mean square distance between measured and registered points.
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
    mesh : TetMesh
        The rest state.
    materials : mapping of region label to Material
        Only ratios of stiffness matter, since displacements are measured, not forces.
    fixed : str or integer array
        Points held by the skull.
    element : str
        See `physgnn.mechanics.SolverOptions`.

    Raises
    ------
    InputError
        If materials or fixed points do not fit the mesh.
    """

    def __init__(
        self,
        mesh: TetMesh,
        materials: Mapping[int, Material],
        fixed: str | NDArray[np.int64] = "fixed",
        *,
        element: str = "tet4",
    ) -> None:
        rest = RestState(mesh, materials, fixed, element=element)
        self.mesh = mesh
        self.modes = load_modes(mesh, rest)
        self.tangent = TangentResponse(mesh, materials, rest.fixed, element)

    def __call__(
        self,
        pairs: PointPairs,
        *,
        noise_mm: float = 1.0,
        linear: bool = False,
        coverage: float = 0.9,
        seed: int = 0,
    ) -> Registration:
        """Return the displacement field that the measured points tell of.

        Parameters
        ----------
        pairs : PointPairs
            Measured before and after, on the surface.
        noise_mm : float
            Standard deviation of each coordinate of a displacement, in (0, 20].
        linear : bool
            Stop after the first step, linear elasticity.
        coverage : float
            Probability that an error bound shall hold, in (0, 1).
        seed : int
            Of the draws that the error bounds are counted on.

        Raises
        ------
        InputError
            If a point is far from the surface, or a number out of range.
        """
        if not 0 < noise_mm <= 20 or not 0 < coverage < 1:
            raise InputError(
                "noise_mm must be in (0, 20] and coverage in (0, 1) "
                f"(got {noise_mm}, {coverage})"
            )
        start = time.perf_counter()
        search = _Search(self, pairs, noise_mm)
        whole = search.linear_step() if linear else search.descend()
        deviation, estimate = _spread(search.posterior, search.response, coverage, seed)
        status = PredictionStatus.OK if whole else PredictionStatus.TOLERANCE_NOT_MET
        seconds = time.perf_counter() - start
        return Registration(
            prediction=Prediction(search.u, estimate, status, seconds),
            deviation_mm=deviation,
            forces=_combined(self.modes.forces, search.w),
            misfit_mm=_rms(search.misfit(search.u)),
            held_out_mm=_rms(search.posterior.held_out),
        )


class _Search:
    """One descent from the rest state to the most probable displacement."""

    def __init__(self, body: Registrar, pairs: PointPairs, noise: float) -> None:
        self._body, self._noise = body, noise
        self._d = pairs.displacement.ravel()
        self._P: csr_array = surface_interpolation(body.mesh, pairs.source)
        self.u = np.zeros_like(body.mesh.points)
        self.response: Fields = body.modes.response
        self._back = np.zeros_like(self.u)
        A = self._at_points()
        self._prior = choose_variances(A, self._d, body.modes.family, noise)
        self.posterior: Posterior = condition(A, self._d, self._prior, noise)

    @property
    def w(self) -> FloatArray:
        """The coefficients that go with `u` when the search has ended."""
        return self.posterior.mean

    def misfit(self, u: FloatArray) -> FloatArray:
        """Return measured minus registered displacement, (3n,)."""
        residual: FloatArray = self._d - (self._P @ u).ravel()
        return residual

    def linear_step(self) -> bool:
        """Take the answer of linear elasticity."""
        self.u = self._step()
        return True

    def descend(self) -> bool:
        """Step until steps are short; False if that was not reached."""
        for _ in range(MAX_STEPS):
            step = self._step()
            length = float(np.linalg.norm(step, axis=1).max())
            if not self._advance(step * min(1.0, LONGEST_STEP_MM / length)):
                return False
            if length < STEP_TOLERANCE_MM:
                return True
        return False

    def _step(self) -> FloatArray:
        return self._back + _combined(self.response, self.w)

    def _advance(self, step: FloatArray) -> bool:
        """Go along a step, a half, a quarter … of it, to where the body is stable."""
        for halvings in range(MAX_HALVINGS):
            u = self.u + step / 2**halvings
            found = self._body.tangent(u, self._body.modes.forces)
            if found is not None:
                self.u, (self.response, self._back) = u, found
                unexplained = self.misfit(self.u + self._back)
                self.posterior = condition(
                    self._at_points(), unexplained, self._prior, self._noise
                )
                return True
        return False

    def _at_points(self) -> FloatArray:
        """Return what each mode does to each measured coordinate, A = P K⁻¹ B."""
        rows = [(self._P @ u).ravel() for u in self.response]
        return np.array(rows, dtype=np.float64).T


def _spread(
    posterior: Posterior, response: Fields, coverage: float, seed: int
) -> tuple[FloatArray, ErrorEstimate]:
    """Return each point's deviation, and bounds on the mean and largest error."""
    variances, axes = np.linalg.eigh(posterior.covariance)
    z = np.random.default_rng(seed).standard_normal((N_DRAWS, len(variances)))
    draws = (z * np.sqrt(np.maximum(variances, 0.0))) @ axes.T
    errors = np.tensordot(draws.astype(np.float32), response, 1)
    lengths = np.linalg.norm(errors, axis=2).astype(np.float64)
    lengths *= MODEL_ERROR * max(1.0, posterior.surprise)
    mean, largest = (
        float(np.quantile(size, coverage))
        for size in (lengths.mean(axis=1), lengths.max(axis=1))
    )
    deviation: FloatArray = np.sqrt((lengths**2).mean(axis=0))
    return deviation, ErrorEstimate(mean, largest, coverage)


def _combined(fields: Fields, w: FloatArray) -> FloatArray:
    return np.tensordot(w, fields, 1).astype(np.float64)


def _rms(residual: FloatArray) -> float:
    """Root mean square length of the vectors whose components these are."""
    return float(np.sqrt(3 * (residual**2).mean()))
