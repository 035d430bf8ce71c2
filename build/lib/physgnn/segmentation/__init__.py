"""From a scan to a label map: brain, ventricles and tumour."""

from physgnn.segmentation.scan_labels import (
    BRAIN_LABEL,
    TUMOUR_LABEL,
    VENTRICLE_LABEL,
    SegmentOptions,
    segment,
)

__all__ = [
    "BRAIN_LABEL", "TUMOUR_LABEL", "VENTRICLE_LABEL", "SegmentOptions", "segment",
]  # fmt: skip
