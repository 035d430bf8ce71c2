"""What closing a brain's folds costs and changes: its first even surface, by radius.

    python benchmarks/closing.py ../shared/real/freesurfer_labels_02.nii.gz

Prints a Markdown table: what is filled, points of the surface, and its Dice with the
brain whose folds are filled and with the brain as the map has it.
"""

import argparse

from physgnn.errors import InputError
from physgnn.geometry import check_surface
from physgnn.geometry.segmentation.extract import edge_for
from physgnn.geometry.segmentation.labels.label_tables import label_table
from physgnn.geometry.segmentation.mask_surface import even_surface, level_set
from physgnn.geometry.segmentation.masks import tissue_masks
from physgnn.geometry.segmentation.volume_fit import dice, enclosed_voxels
from physgnn.io.medical.images.formats import read_segmentation


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("map", help="a label map")
    parser.add_argument("--labels", default="freesurfer")
    parser.add_argument("--points", type=int, default=10_000, help="of the mesh")
    parser.add_argument("--finer", type=float, default=1.0, help="of the edge")
    parser.add_argument(
        "--closing-mm", type=float, nargs="+", default=[4.0, 2.0, 1.5, 0.0]
    )
    asked = parser.parse_args()
    labels, table = read_segmentation(asked.map), label_table(asked.labels)
    given = labels.mask([n for ids in table.labels.values() for n in ids])
    ml = labels.grid.voxel_volume_mm3 / 1000.0
    print("| closing, mm | filled, ml | points | Dice: filled, as given | sound |")
    print("|---|---|---|---|---|")
    for closing in asked.closing_mm:
        masks = tissue_masks(labels, table, closing_mm=closing)
        volume = float(masks.brain.sum()) * masks.grid.voxel_volume_mm3
        edge = edge_for(volume, asked.points) * asked.finer
        smoothing = float(labels.grid.voxel_mm.max())
        level = level_set(masks.brain, masks.grid, smoothing)
        try:
            surface = even_surface(level, masks.grid, edge)
            check_surface(surface, "brain")
        except InputError as error:
            print(f"| {closing:g} | {error} | | | no |", flush=True)
            continue
        follows = dice(enclosed_voxels(surface, masks.grid), masks.brain)
        as_given = dice(enclosed_voxels(surface, labels.grid), given)
        print(
            f"| {closing:g} | {volume / 1000.0 - given.sum() * ml:.0f} | "
            f"{surface.n_points} | {follows:.3f}, {as_given:.3f} | yes |",
            flush=True,
        )


if __name__ == "__main__":
    main()
