"""What the figures share: a block, the bundled brain, one look, and where they go."""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pyvista as pv

mpl.use("Agg")
import matplotlib.pyplot as plt

import physgnn as pg
from physgnn.geometry import mni152_phantom

OUT = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "images"
TEAL, ORANGE, PURPLE, GREY = "#0f9d7e", "#d9861a", "#6a4fb3", "#8b929c"
CRANIOTOMY = np.array([39.7, 8.8, 62.5])

plt.rcParams.update(
    {
        "font.size": 10,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#e3e6ea",
        "axes.axisbelow": True,
        "legend.frameon": False,
        "svg.hashsalt": "physgnn",  # the same figure twice is the same file
        "figure.constrained_layout.use": True,
    }
)
pv.OFF_SCREEN = True


def save(figure: plt.Figure, name: str) -> None:
    """Write a figure as SVG on white, so that it can be read on a dark page too."""
    figure.savefig(OUT / f"{name}.svg", facecolor="white", metadata={"Date": None})


def block(n: int, shape: tuple[float, float, float] = (1, 1, 1)) -> pg.TetMesh:
    """Return a block of 40 mm, n³ cubes of six tetrahedra; its bottom is fixed."""
    axes = [np.linspace(0.0, 40.0 * s, n + 1) for s in shape]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    index = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    low = index[:-1, :-1, :-1].ravel()
    x, y, z = (n + 1) ** 2, n + 1, 1
    turns = [(x, x + y), (x + y, y), (y, y + z), (y + z, z), (z, z + x), (z + x, x)]
    cells = [np.stack([low, low + a, low + b, low + x + y + z], -1) for a, b in turns]
    top = points[:, 2].max()
    return pg.TetMesh(
        points=points,
        cells=np.concatenate(cells),
        region=np.zeros(6 * n**3),
        point_sets={
            "fixed": np.flatnonzero(points[:, 2] == 0),
            "top": np.flatnonzero(points[:, 2] == top),
        },
    )


def brain(n_points: int = 700, volume_mm3: float = 900.0) -> pg.TetMesh:
    """Return the bundled brain, held by the skull but for a craniotomy."""
    phantom = mni152_phantom(n_points=n_points)
    mesh = pg.tetrahedralize(phantom.brain, phantom.tumours, max_volume_mm3=volume_mm3)
    outer = grid(mesh).extract_surface(algorithm=None)["vtkOriginalPointIds"]
    surface = np.unique(np.array(outer, dtype=np.int64))
    distance = np.linalg.norm(mesh.points[surface] - CRANIOTOMY, axis=1)
    return mesh.with_point_sets(
        fixed=surface[distance > 60.0], loaded=surface[np.argsort(distance)[:40]]
    )


def materials(poissons_ratio: float = 0.49) -> dict[int, pg.NeoHookean]:
    """Return the published materials of brain and tumour."""
    return {
        region: pg.NeoHookean(youngs_modulus_pa=e, poissons_ratio=poissons_ratio)
        for region, e in enumerate((3000.0, 7500.0))
    }


def push(mesh: pg.TetMesh, newton: float, levels: int) -> pg.LoadPath:
    """Return a push on the craniotomy, inward, growing in equal levels."""
    nodes = mesh.point_set("loaded")
    inward = np.array([-0.55, -0.35, -0.75])
    forces = np.tile(newton / len(nodes) * inward, (len(nodes), 1))
    factors = np.arange(1, levels + 1) / levels
    return pg.LoadPath(nodes=nodes, forces=forces, load_factors=factors)


def grid(
    mesh: pg.TetMesh, displacement: np.ndarray | None = None
) -> pv.UnstructuredGrid:
    """Return the mesh for PyVista, moved by a displacement if there is one."""
    points = mesh.points if displacement is None else mesh.points + displacement
    made = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, points)
    made["region"] = mesh.region
    if displacement is not None:
        made["mm"] = np.linalg.norm(displacement, axis=1)
    return made


def scene(panels: int, width: int = 1200, height: int = 430) -> pv.Plotter:
    """Return a plotter of panels side by side."""
    plotter = pv.Plotter(
        shape=(1, panels),
        window_size=(width, height),
        border=False,
        lighting="three lights",
    )
    plotter.set_background("white")
    return plotter


def write(plotter: pv.Plotter, name: str) -> None:
    """Write a scene as a PNG of few colours, which is small."""
    from PIL import Image

    picture = Image.fromarray(plotter.screenshot(return_img=True))
    picture.quantize(160).save(OUT / f"{name}.png", optimize=True)
