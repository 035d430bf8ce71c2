"""Turned weights answer what the network does when all that it sees is turned."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor
from torch.func import functional_call

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.lifted.any_axes import random_axes, turned_weights
from physgnn.learning.lifted.network import LiftedNetwork, NetworkRegion
from physgnn.mechanics.body import Body
from physgnn.mechanics.materials import NeoHookean


@pytest.fixture
def body(block: TetMesh) -> Body:
    fixed = np.flatnonzero(block.points[:, 2] == block.points[:, 2].min())
    soft, hard = NeoHookean(3000.0, 0.45), NeoHookean(9000.0, 0.45)
    return Body(block, {0: soft, 1: hard}, fixed)


def network_of(*, forces: bool, imbalance: bool) -> LiftedNetwork:
    torch.manual_seed(1)
    network = LiftedNetwork(8, 2, forces=forces, imbalance=imbalance)
    with torch.no_grad():
        for weight in network.parameters():
            weight.copy_(0.3 * torch.randn_like(weight))
    return network


def seen_along(body: Body, axes: Tensor) -> Body:
    """Return a body turned, or mirrored: then its cells are numbered the other way."""
    mirrored = bool(torch.linalg.det(axes) < 0)
    order = [1, 0, 2, 3] if mirrored else [0, 1, 2, 3]
    points = body.mesh.points @ axes.double().numpy().T
    return replace(
        body, mesh=replace(body.mesh, points=points, cells=body.mesh.cells[:, order])
    )


@pytest.mark.parametrize("forces", [True, False])
@pytest.mark.parametrize("imbalance", [True, False])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_they_answer_as_if_the_body_were_turned(
    body: Body, sign: float, *, forces: bool, imbalance: bool
) -> None:
    network = network_of(forces=forces, imbalance=imbalance)
    n = body.mesh.n_points
    axes = random_axes()
    axes = sign * torch.sign(torch.linalg.det(axes)) * axes
    terms, force = torch.randn(2, n, 9), 0.01 * torch.randn(2, n, 3 + 3 * imbalance)
    size, near = torch.rand(2, 1, 1) + 0.1, np.ones(n, dtype=bool)
    region = NetworkRegion.of(body, near)
    found = functional_call(
        network, turned_weights(network, axes), (terms, force, size, region)
    )
    turned = [
        (field.unflatten(-1, (-1, 3)) @ axes.T).flatten(-2) for field in (terms, force)
    ]
    there = network(*turned, size, NetworkRegion.of(seen_along(body, axes), near))
    as_it_is = network(terms, force, size, region)
    for of_weights, of_body, other in zip(found, there, as_it_is, strict=True):
        if of_weights.numel():
            expected = of_body @ axes
            torch.testing.assert_close(of_weights, expected, atol=1e-4, rtol=1e-4)
            assert (of_weights - other).abs().max() > 0.01


def test_axes_are_orthonormal_mirrored_or_not_and_point_anywhere() -> None:
    torch.manual_seed(0)
    drawn = torch.stack([random_axes() for _ in range(4000)])
    torch.testing.assert_close(
        drawn @ drawn.transpose(1, 2), torch.eye(3).expand(4000, 3, 3)
    )
    mirrored = (torch.linalg.det(drawn) < 0).float().mean()
    assert mirrored == pytest.approx(0.5, abs=0.05)
    # the moments of a uniform direction: mean 0, and 1/3 of each square
    assert drawn.mean(0).abs().max() < 0.04
    torch.testing.assert_close(
        (drawn**2).mean(0), torch.full((3, 3), 1 / 3), atol=0.03, rtol=0
    )
