"""How response modes carry a network's forces through the body: Φ Φᵀ f."""

from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True, eq=False)
class CarriedForces:
    """Response modes, and the part of them where the forces act.

    Attributes
    ----------
    modes : (n_modes, n_points, 3) tensor
        Φ, mm / √(N mm).
    at : (n_loaded,) int64 tensor
        Rows of the network's points at which its forces count.
    there : (3 n_loaded, n_modes) tensor
        Φᵀ at these.
    """

    modes: Tensor
    at: Tensor
    there: Tensor

    @classmethod
    def of(cls, modes: Tensor, loaded: Tensor, points: Tensor) -> "CarriedForces":
        """Cut the modes to those of a network's points that may carry a force.

        Parameters
        ----------
        modes : (n_modes, n_points, 3) tensor
        loaded : (n_points,) boolean tensor
        points : (n,) int64 tensor
            The network's.
        """
        with torch.inference_mode(False):  # a prediction's must serve training, too
            at = torch.nonzero(loaded[points])[:, 0]
            there = modes[:, points[at]].flatten(1).T.contiguous()
        return cls(modes, at, there)

    def __call__(self, forces: Tensor) -> Tensor:
        """Return Φ Φᵀ f, (batch, n_points, 3) mm, f being (batch, n, 3) in N."""
        shares = forces[:, self.at].flatten(1) @ self.there
        moved: Tensor = torch.tensordot(shares, self.modes, dims=1)
        return moved
