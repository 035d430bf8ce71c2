"""A method of your own: the displacement of the training load most like the one asked.

physgnn train loads.zarr --model method:NearestLoad -o run/
physgnn evaluate run/ --baselines zero,linear
"""

import numpy as np
from physgnn.learning.surrogate import Surrogate


class NearestLoad(Surrogate):
    """Takes the training load of the most similar direction, and scales what it did."""

    zero_without_load = True

    def __init__(self, body, *, keep=1000):
        super().__init__(body)
        self.keep = keep
        self.forces = self.displacement = np.zeros((0, body.mesh.n_points, 3), "f4")

    def fit(self, store, samples, seed=0):
        some = samples[np.linspace(0, len(samples) - 1, self.keep).astype(int)]
        rows = np.unique(some, axis=0).tolist()
        cases = [store.load_case(path, level) for path, level in rows]
        forces = [case.on_points(self.body.mesh.n_points) for case in cases]
        known = [store.displacement(path)[level] for path, level in rows]
        self.forces, self.displacement = np.stack(forces), np.stack(known)

    def predict(self, load_case):
        force = load_case.on_points(self.body.mesh.n_points)
        work = np.tensordot(self.forces, force, axes=2)
        squared = (self.forces**2).sum(axis=(1, 2))
        best = np.argmax(work / np.sqrt(squared))
        return work[best] / squared[best] * self.displacement[best].astype(float)

    def arrays(self):
        return {"forces": self.forces, "displacement": self.displacement}

    def restore(self, arrays):
        self.forces, self.displacement = arrays["forces"], arrays["displacement"]
