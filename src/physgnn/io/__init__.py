"""Files in and out: surfaces, meshes with their point sets, load cases, predictions.

Every reader raises InputError for a file that is not what its name says; every
writer leaves a whole file or none.
"""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)
