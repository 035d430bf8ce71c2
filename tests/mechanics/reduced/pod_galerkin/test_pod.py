"""Modes of fields whose span is known."""

import numpy as np
import pytest

from physgnn.mechanics.reduced.pod_galerkin.pod import leading_modes


@pytest.mark.parametrize("n_modes", [3, 5])
def test_modes_span_what_they_were_made_from(n_modes: int) -> None:
    rng = np.random.default_rng(0)
    shapes = rng.normal(size=(3, 20, 3))
    fields = np.tensordot(rng.normal(size=(30, 3)), shapes, axes=1)
    modes = leading_modes(fields, n_modes)
    share = np.einsum("fpi,mpi->fm", fields, modes)
    np.testing.assert_allclose(np.tensordot(share, modes, axes=1), fields, atol=1e-6)
    gram = np.einsum("mpi,npi->mn", modes, modes)
    expected = np.diag([1.0] * 3 + [0.0] * (n_modes - 3))
    np.testing.assert_allclose(gram, expected, atol=1e-7)


def test_the_first_mode_holds_most() -> None:
    rng = np.random.default_rng(0)
    fields = rng.normal(size=(50, 20, 3)) * np.linspace(3, 0.1, 20)[:, None]
    modes = leading_modes(fields, 6)
    held = (np.einsum("fpi,mpi->fm", fields, modes) ** 2).sum(axis=0)
    assert (np.diff(held) <= 1e-9).all()
