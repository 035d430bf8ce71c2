"""The offset of a navigation as points of the bone tell it.

Bone does not move with a brain. So what the navigation finds of it elsewhere than the
scan has it is an offset of the navigation, and nothing else: a rotation R and a
translation, found by weighted least squares (Kabsch, "A solution for the best rotation
to relate two sets of vectors", Acta Crystallographica A 32, 1976, 922-923) with the
weights of noise with heavy tails (`physgnn.registration.inference.heavy_tails`). It is
taken out of everything measured before anything else is done, whatever its size. What
is left of it is small and Gaussian, and its covariance, which grows with the distance
from the bone points (Fitzpatrick, West & Maurer, "Predicting error in rigid-body
point-based registration", IEEE Transactions on Medical Imaging 17, 1998, 694-702), is
the prior of the offset in the search: the brain cannot bend what the bone says.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, islice

import numpy as np
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.geometry.measured import BonePoints
from physgnn.prediction.measured_evidence import (
    FEWEST_BONE_POINTS,
    LEAST_SPREAD_MM,
    RigidOffset,
)
from physgnn.registration.inference.gaussian import Posterior
from physgnn.registration.inference.heavy_tails import (
    ITERATIONS,
    LAST_ITERATIONS,
    NU,
    STARTS,
    RobustFit,
    log_density,
    reweighted,
    student_weights,
)
from physgnn.registration.inference.rigid_offset import (
    HYPOTHESES,
    MISPLACED,
    OffsetPrior,
    log_ratio_of,
    probabilities_of,
)
from physgnn.registration.inference.rows import MeasuredRows, turning

MOST = 1000  # threes of bone points looked at: all there are of up to nineteen


@dataclass(frozen=True, eq=False)
class RigidMotion:
    """y to R (y - centre) + centre + shift.

    Attributes
    ----------
    turn : Rotation
        R.
    shift_mm, centre_mm : (3,) arrays
    """

    turn: Rotation
    shift_mm: FloatArray
    centre_mm: FloatArray

    def __call__(self, points: FloatArray) -> FloatArray:
        """Return where points go, (n, 3), mm."""
        moved: FloatArray = self.turn.apply(points - self.centre_mm)
        return moved + self.centre_mm + self.shift_mm

    def undone(self, points: FloatArray) -> FloatArray:
        """Return where points came from, (n, 3), mm."""
        back = self.turn.inv().apply(points - self.centre_mm - self.shift_mm)
        found: FloatArray = back + self.centre_mm
        return found


def best_motion(
    source: FloatArray, target: FloatArray, weights: FloatArray
) -> RigidMotion:
    """Return the rigid motion that takes points nearest to others.

    What they do not tell is left out: points in a line do not turn about it, and a
    single one does not turn at all.

    Parameters
    ----------
    source, target : (n, 3) arrays
        mm.
    weights : (n,) array
        Of each pair, positive.
    """
    middle = np.average(source, axis=0, weights=weights)
    to = np.average(target, axis=0, weights=weights)
    a, b = source - middle, target - to
    each = weights / weights.sum()
    _, size, axes = np.linalg.svd(np.sqrt(each)[:, None] * a)
    spread = np.append(size, np.zeros(3))[:2]
    if spread[1] >= LEAST_SPREAD_MM:
        turn, _ = Rotation.align_vectors(b, a, weights=each)
    elif spread[0] >= LEAST_SPREAD_MM:
        along = (each * (a @ axes[0])) @ b
        turn, _ = Rotation.align_vectors(along, axes[0])  # the shortest turn
    else:
        turn = Rotation.identity()
    return RigidMotion(turn, to - middle, middle)


@dataclass(frozen=True, eq=False)
class BoneOffset:
    """An offset of the navigation that was measured.

    Attributes
    ----------
    bone : BonePoints
        What was measured.
    motion : RigidMotion
        From the scan to where the navigation finds it.
    rows : MeasuredRows
        What is left of the offset, in six columns about the motion's centre.
    fit : RobustFit
        Of these: its mean is nearly zero.
    """

    bone: BonePoints
    motion: RigidMotion
    rows: MeasuredRows
    fit: RobustFit

    @property
    def in_scan(self) -> BonePoints:
        """The points, found without the offset."""
        return replace(self.bone, target=self.motion.undone(self.bone.target))

    @property
    def misfit_mm(self) -> float:
        """Root mean square distance of the points that are no outliers."""
        away = (self.fit.misfit * self.rows.noise).reshape(-1, 3)
        kept = away[~self.fit.outliers]
        return float(np.sqrt((kept**2).sum(axis=1).mean())) if len(kept) else np.nan

    def prior_about(self, centre: FloatArray) -> OffsetPrior:
        """Return what is left of the offset, as translation and turn about a centre."""
        C = self._covariance_about(centre)
        root = np.linalg.cholesky(C).astype(np.float64)
        return OffsetPrior(np.ones(6), root)

    def _covariance_about(self, centre: FloatArray) -> FloatArray:
        to_centre = np.eye(6)
        away = centre - self.motion.centre_mm
        to_centre[:3, 3:] = np.cross(np.eye(3), away).T  # w x away
        covariance: FloatArray = to_centre @ self.fit.posterior.covariance @ to_centre.T
        return covariance

    def reported(self, left: Posterior, centre: FloatArray) -> RigidOffset:
        """Return the whole offset.

        Parameters
        ----------
        left : Posterior
            Of what was left of it, given the brain too: the last six coefficients, of
            the prior about the centre.
        centre : (3,) array
            The middle of what was measured of the brain, without the offset, mm.
        """
        axes = self.prior_about(centre).axes
        mean = axes @ left.mean[-6:]
        spread = axes @ left.covariance[-6:, -6:] @ axes.T
        moved = self.motion((centre + mean[:3])[None])[0] - centre
        turn = self.motion.turn * Rotation.from_rotvec(mean[3:])
        R = self.motion.turn.as_matrix()
        deviations = [
            np.sqrt(np.maximum((R @ part @ R.T).diagonal(), 0.0))
            for part in (spread[:3, :3], spread[3:, 3:])
        ]
        offset = np.concatenate([moved, turn.as_rotvec()])
        evidence = self._evidence(offset, centre)
        return RigidOffset(
            translation_mm=moved,
            rotation_deg=np.rad2deg(turn.as_rotvec()),
            deviation_mm=deviations[0],
            deviation_deg=np.rad2deg(deviations[1]),
            centre_mm=centre,
            log_ratio=log_ratio_of(evidence),
            probability=float(probabilities_of(evidence)[1:].sum()),
            change_mm=float("nan"),
            unknown_mm=0.0,
            corrected=True,
        )

    def _evidence(self, offset: FloatArray, centre: FloatArray) -> FloatArray:
        """Return the logarithm of the probability of an offset by each hypothesis."""
        C = self._covariance_about(centre)
        found = []
        for one in HYPOTHESES:
            variances = one.variances if len(one.variances) else np.zeros(6)
            spread = C + np.diag(variances)
            _, log_det = np.linalg.slogdet(2 * np.pi * spread)
            found.append(-(log_det + offset @ np.linalg.solve(spread, offset)) / 2)
        return np.array(found)


def offset_from_bone(bone: BonePoints, noise_mm: float) -> BoneOffset:
    """Return the offset that points of the bone tell of.

    Parameters
    ----------
    bone : BonePoints
        The points.
    noise_mm : float
        Standard deviation of each coordinate of their displacement.
    """
    every = np.ones(len(bone.source))
    begun = [(every, scales) for scales in STARTS]
    if len(every) > FEWEST_BONE_POINTS:
        begun.append((_weights_of_three(bone, noise_mm), STARTS[-1]))
    found = [_descended(bone, noise_mm, *start) for start in begun]
    variances = MISPLACED.variances
    return max(found, key=lambda one: log_density(one.rows, variances, one.fit))


def _weights_of_three(bone: BonePoints, noise_mm: float) -> FloatArray:
    """Return the weights by the three points that the others agree with best.

    Of a handful of points two that are swapped bend every fit to all (random sample
    consensus: Fischler & Bolles, Communications of the ACM 24, 1981, 381-395; here
    every three, as far as they are not too many).
    """
    n = len(bone.source)
    best = np.inf
    for some in islice(combinations(np.random.default_rng(0).permutation(n), 3), MOST):
        of = list(some)
        motion = best_motion(bone.source[of], bone.target[of], np.ones(3))
        away = (motion.undone(bone.target) - bone.source) / noise_mm
        cost = float(np.log1p((away**2).sum(axis=1) / NU).sum())
        if cost < best:
            best, weights = cost, student_weights((away**2).ravel(), ((n, 3),))
    return weights


def _descended(
    bone: BonePoints, noise_mm: float, weights: FloatArray, scales: Sequence[float]
) -> BoneOffset:
    """Return the offset after these scales of the noise, one after the other."""
    for scale in scales:
        for _ in range(LAST_ITERATIONS if scale == scales[-1] else ITERATIONS):
            found = _weighted(bone, noise_mm, weights, scale)
            weights = found.fit.weights
    return found


def _weighted(
    bone: BonePoints, noise_mm: float, weights: FloatArray, scale: float
) -> BoneOffset:
    """Return the offset with these weights, and the weights that follow from it.

    Where points tell nothing, the tracker may be misplaced.
    """
    motion = best_motion(bone.source, bone.target, weights)
    back = motion.undone(bone.target)
    axes = np.tile(np.eye(3), (len(back), 1, 1))
    A = turning(axes, back - motion.centre_mm)
    d = (back - bone.source).ravel()
    rows = MeasuredRows(
        A / noise_mm, d / noise_mm, np.full(len(d), noise_mm), ((len(back), 3),)
    )
    fit = reweighted(rows, MISPLACED.variances, weights, 1, scale=scale)
    return BoneOffset(bone, motion, rows, fit)
