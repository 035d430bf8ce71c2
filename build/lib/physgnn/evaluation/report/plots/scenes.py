"""Three-dimensional views, rendered off screen to images with a clear background."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.evaluation.report.style import BRAIN, FIXED, LOADED, TUMOUR
from physgnn.geometry import regions
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.paths import LoadCase

Pixels = NDArray[np.uint8]

SIZE = (1200, 1100)  # pixels
ARROW_SHARE = 0.18  # longest force arrow over the size of the body, one arrow alone


@dataclass(frozen=True, eq=False)
class View:
    """Where to look from so that a load is in sight.

    Attributes
    ----------
    towards : (3,) array
        Unit vector from the body's centre to the camera, for views from outside.
    cut_normal : (3,) array
        Normal of a cut that holds the line from the centre to the load.
    up : (3,) array
    """

    towards: FloatArray
    cut_normal: FloatArray
    up: FloatArray

    @classmethod
    def of(cls, mesh: TetMesh, nodes: IntArray) -> "View":
        """Return the view on a load at these nodes, z up."""
        centre = mesh.points.mean(axis=0)
        load = mesh.points[nodes].mean(axis=0) - centre
        load /= max(float(np.linalg.norm(load)), 1e-12)
        up = np.array([0.0, 0.0, 1.0])
        normal = np.cross(load, up)
        if np.linalg.norm(normal) < 0.35:  # a load from above: look from the side
            normal = np.cross(load, np.array([0.0, 1.0, 0.0]))
        normal /= np.linalg.norm(normal)
        towards = 0.75 * load + 0.65 * normal + 0.2 * up
        return cls(towards / np.linalg.norm(towards), normal, up)


def render_case(mesh: TetMesh, case: LoadCase, view: View) -> Pixels:
    """Draw surface, tumour, fixed and loaded points, and the forces."""
    plotter = _plotter()
    brain = grid(mesh).extract_surface(algorithm=None)
    plotter.add_mesh(
        brain, color=BRAIN, opacity=0.45, smooth_shading=True, specular=0.1
    )
    plotter.add_mesh(brain, style="wireframe", color="#7c746c", opacity=0.22)
    _add_tumour(plotter, grid(mesh))
    size = _diameter(mesh)
    for name, paint in (("fixed", FIXED), ("loaded", LOADED)):
        if name in mesh.point_sets and len(mesh.point_sets[name]):
            _add_points(plotter, mesh.points[mesh.point_sets[name]], paint, size)
    _add_forces(plotter, mesh, case, size)
    return _shot(plotter, mesh, view.towards, view.up)


def render_cut(mesh: TetMesh, view: View) -> Pixels:
    """Draw the tetrahedra behind a cut through the tumour (or the body's centre)."""
    plotter = _plotter()
    half = grid(mesh).clip(
        normal=view.cut_normal, origin=_middle(mesh, mesh.points), crinkle=True
    )
    for region, paint in (
        (regions.BRAIN, BRAIN),
        (regions.TUMOUR, TUMOUR),
        (regions.VENTRICLE, FIXED),
    ):
        part = half.extract_cells(half.cell_data["region"] == region)
        if part.n_cells:
            plotter.add_mesh(
                part, color=paint, show_edges=True, edge_color="#5b544d", line_width=1
            )
    return _shot(plotter, mesh, view.cut_normal, view.up)


def render_surface(
    mesh: TetMesh, displacement: FloatArray, values: FloatArray, **colours: Any
) -> Pixels:
    """Draw the deformed surface, coloured by a value a point.

    `colours` takes `view` (View), `limits` (low, high) and `map` (a colour map).
    """
    plotter = _plotter()
    surface = grid(mesh, displacement, values).extract_surface(algorithm=None)
    _add_coloured(plotter, surface, colours)
    view: View = colours["view"]
    return _shot(plotter, mesh, view.towards, view.up)


def render_deformed_cut(
    mesh: TetMesh, displacement: FloatArray, values: FloatArray, **colours: Any
) -> Pixels:
    """Draw the deformed body behind a cut, its tumour whole, the rest shape around it.

    `colours` as in `render_surface`.
    """
    plotter = _plotter()
    view: View = colours["view"]
    origin = _middle(mesh, mesh.points + displacement)
    deformed = grid(mesh, displacement, values)
    brain = deformed.extract_cells(mesh.region != regions.TUMOUR)
    _add_coloured(plotter, brain.clip(normal=view.cut_normal, origin=origin), colours)
    _add_tumour(plotter, deformed)
    rest = grid(mesh).extract_surface(algorithm=None)
    outline = rest.slice(normal=view.cut_normal, origin=origin)
    plotter.add_mesh(outline, color="#7f8893", line_width=5)
    return _shot(plotter, mesh, view.cut_normal, view.up)


def grid(
    mesh: TetMesh,
    displacement: FloatArray | None = None,
    values: FloatArray | None = None,
) -> pv.UnstructuredGrid:
    """Return the mesh for PyVista, deformed if asked, with `region` and `value`."""
    points = mesh.points if displacement is None else mesh.points + displacement
    made = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, points)
    made.cell_data["region"] = mesh.region
    if values is not None:
        made.point_data["value"] = values
    return made


def _plotter() -> pv.Plotter:
    with pv.vtk_verbosity("off"):  # VTK would warn that there is no X server
        plotter = pv.Plotter(off_screen=True, window_size=list(SIZE))
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def _add_coloured(
    plotter: pv.Plotter, body: pv.DataSet, colours: dict[str, Any]
) -> None:
    plotter.add_mesh(
        body,
        scalars="value",
        cmap=colours["map"],
        clim=colours["limits"],
        show_scalar_bar=False,
        smooth_shading=False,
        specular=0.15,
    )


def _add_tumour(plotter: pv.Plotter, body: pv.UnstructuredGrid) -> None:
    tumour = body.extract_cells(body.cell_data["region"] == regions.TUMOUR)
    if tumour.n_cells:
        surface = tumour.extract_surface(algorithm=None)
        plotter.add_mesh(surface, color=TUMOUR, smooth_shading=True, specular=0.3)


def _add_points(
    plotter: pv.Plotter, points: FloatArray, paint: str, size: float
) -> None:
    ball = pv.Sphere(radius=0.0085 * size, theta_resolution=12, phi_resolution=12)
    balls = pv.PolyData(points).glyph(geom=ball, scale=False, orient=False)
    plotter.add_mesh(balls, color=paint, smooth_shading=True)


def _add_forces(
    plotter: pv.Plotter, mesh: TetMesh, case: LoadCase, size: float
) -> None:
    """Draw an arrow to every loaded point, its length in proportion to the force."""
    largest = np.linalg.norm(case.forces, axis=1).max()
    longest = ARROW_SHARE * size / len(case.nodes) ** 0.2  # many would hide the body
    arrows = case.forces * (longest / largest)
    tails = pv.PolyData(mesh.points[case.nodes] - arrows)
    tails["force"] = arrows
    shape = pv.Arrow(tip_length=0.3, tip_radius=0.06, shaft_radius=0.018)
    plotter.add_mesh(
        tails.glyph(geom=shape, orient="force", scale="force", factor=1.0),
        color=LOADED,
    )


def _middle(mesh: TetMesh, points: FloatArray) -> FloatArray:
    """Return the tumour's centre, or the body's if it has none."""
    tumour = mesh.cells[mesh.region == regions.TUMOUR]
    middle: FloatArray = points[tumour if len(tumour) else mesh.cells].mean(axis=(0, 1))
    return middle


def _diameter(mesh: TetMesh) -> float:
    return float(np.linalg.norm(np.ptp(mesh.points, axis=0)))


def _shot(
    plotter: pv.Plotter, mesh: TetMesh, towards: FloatArray, up: FloatArray
) -> Pixels:
    """Take the picture with the same camera distance for every view of a mesh."""
    centre = (mesh.points.min(axis=0) + mesh.points.max(axis=0)) / 2
    plotter.camera.parallel_projection = True
    plotter.camera.focal_point = centre
    plotter.camera.position = centre + 3 * _diameter(mesh) * towards
    plotter.camera.up = up
    plotter.camera.parallel_scale = 0.46 * _diameter(mesh)
    plotter.renderer.ResetCameraClippingRange()
    shot = plotter.screenshot(None, transparent_background=True, return_img=True)
    plotter.close()
    return np.asarray(shot, dtype=np.uint8)
