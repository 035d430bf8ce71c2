"""Real-time prediction of brain deformation: FE, graph neural networks, error bars.

The names a user needs are here, the commands among them as functions: ``__init__.pyi``
lists them. Each is imported when first asked for, so that ``import physgnn`` costs
nothing and the mechanics run without torch.
"""

from typing import Any

from physgnn.lazy import attach

_exported, __all__ = attach(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version  # reads files: only if asked for

        return version("physgnn")
    return _exported(name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
