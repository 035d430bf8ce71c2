"""The commands as functions: paths in, files out, the same arguments.

``physgnn simulate case.vtu --preset demo -o loads.zarr`` is
``physgnn.simulate("case.vtu", "loads.zarr", preset="demo")``, and so for every command.
``__init__.pyi`` is their table. How a command's words become its function's stands in
`physgnn.stages.naming`.
"""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)


def __dir__() -> list[str]:
    return __all__
