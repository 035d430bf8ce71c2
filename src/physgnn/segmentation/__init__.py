"""From a scan to a label map: brain, ventricles and tumour."""

from physgnn.segmentation.segment import (
    BRAIN_LABEL as BRAIN_LABEL,
)
from physgnn.segmentation.segment import (
    TUMOUR_LABEL as TUMOUR_LABEL,
)
from physgnn.segmentation.segment import (
    VENTRICLE_LABEL as VENTRICLE_LABEL,
)
from physgnn.segmentation.segment import (
    SegmentOptions as SegmentOptions,
)
from physgnn.segmentation.segment import (
    segment as segment,
)
