"""Sum and maximum over neighbours, compiled."""

import numpy as np
from numba import njit

compiled = njit(cache=True, nogil=True)


@compiled
def total(edges, x, y, rows):  # type: ignore[no-untyped-def]
    """Add up the neighbours' weighted values.

    Parameters
    ----------
    edges : tuple of row start, column and weight
        As :class:`physgnn.learning.graph.Neighbours` has them.
    x : (batch, n_columns, width) array
        Values.
    y : (batch, n_points, width) array
        Out: the sums.
    rows : slice
        The points to do.
    """
    row_start, column, weight = edges
    for sample in range(len(x)):
        for row in range(rows.start, rows.stop):
            sums = y[sample, row]
            sums[:] = 0
            for e in range(row_start[row], row_start[row + 1]):
                values, w = x[sample, column[e]], weight[e]
                for j in range(len(sums)):
                    sums[j] += w * values[j]


@compiled
def largest(edges, x, y, which, rows):  # type: ignore[no-untyped-def]
    """Find the largest of the neighbours' weighted values, column by column.

    Parameters
    ----------
    edges, x, rows
        As in `total`.
    y : (batch, n_points, width) array
        Out: the largest values, or 0 without neighbours.
    which : (batch, n_points, width) array or None
        Out, if wanted: the edges (int32) they came along; of several, the first.
    """
    row_start, column, weight = edges
    width = x.shape[2]
    for sample in range(len(x)):
        for row in range(rows.start, rows.stop):
            best = y[sample, row]
            best[:] = 0
            if which is not None:  # known when it's compiled
                edge = which[sample, row]
                edge[:] = -1
            for e in range(row_start[row], row_start[row + 1]):
                values, w = x[sample, column[e]], weight[e]
                first = e == row_start[row]
                for j in range(width):
                    value = w * values[j]
                    larger = first or value > best[j]
                    best[j] = value if larger else best[j]
                    if which is not None:
                        edge[j] = np.int32(e) if larger else edge[j]


@compiled
def largest_back(edges, of_y, which, of_x, columns):  # type: ignore[no-untyped-def]
    """Add each gradient of y to that of the value it came from.

    Parameters
    ----------
    edges, which
        As in `largest`.
    of_y : (batch, n_points, width) array
        The gradient of y.
    of_x : (batch, n_columns, width) array
        Added to.
    columns : slice
        The columns to do.
    """
    _, column, weight = edges
    for sample in range(len(of_y)):
        for row in range(of_y.shape[1]):
            gradient, edge = of_y[sample, row], which[sample, row]
            for j in range(columns.start, columns.stop):
                e = edge[j]
                if e >= 0:
                    of_x[sample, column[e], j] += weight[e] * gradient[j]
