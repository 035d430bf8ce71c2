"""Bias and PReLU, and the way back through them: one pass over the rows, compiled."""

from numba import njit

# Sums in any order, no care for what isn't finite: else nothing is vectorised.
FAST = {"contract", "reassoc", "nsz"}
compiled = njit(cache=True, nogil=True, fastmath=FAST)


@compiled
def activate(z, bias, slope, y):  # type: ignore[no-untyped-def]
    """Add the bias to products, in place, and find PReLU of that.

    Parameters
    ----------
    z : (n, width) array
        In: products. Out: with bias; or if there is no y, PReLU of that.
    bias, slope : (width,) arrays
        What is added, and by what PReLU multiplies negative values.
    y : (n, width) array or None
        Out: PReLU of z.
    """
    zero = z.dtype.type(0)
    for row in range(len(z)):
        for j in range(z.shape[1]):
            value = z[row, j] + bias[j]
            activated = max(value, zero) + slope[j] * min(value, zero)
            if y is None:  # known when it's compiled
                z[row, j] = activated
            else:
                z[row, j] = value
                y[row, j] = activated


@compiled
def activate_back(z, slope, of_y, of_z, of_bias, of_slope):  # type: ignore[no-untyped-def]
    """Take the gradient of y back to z, bias and slope.

    Parameters
    ----------
    z, slope
        As `activate` left them.
    of_y : (n, width) array
        The gradient of y.
    of_z : (n, width) array
        Out: that of z.
    of_bias, of_slope : (width,) arrays
        Added to.
    """
    zero, one = z.dtype.type(0), z.dtype.type(1)
    for row in range(len(z)):
        for j in range(z.shape[1]):
            value, given = z[row, j], of_y[row, j]
            back = given * (one if value > zero else slope[j])
            of_z[row, j] = back
            of_bias[j] += back
            of_slope[j] += given * min(value, zero)
