"""From a displacement on a mesh to images: fields, transforms, warped scans."""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)
