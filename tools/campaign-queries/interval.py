"""Clopper and Pearson's exact interval of a rate, and the number of runs that a bound takes.

The lower end p has P(at least k hits in n | p) = 2.5 %, the upper end P(at most k | p) = 2.5 %. It holds for independent runs whose
number was fixed before. The tails are regularised incomplete beta functions, by their continued fraction (Numerical Recipes, 6.4);
bisection inverts them. `cophase campaign` uses another implementation, so that a comparison of both means something.
"""
from math import exp, lgamma, log, log1p

OUTSIDE = 0.05
TINY = 1e-300


def _fraction(a, b, x):
    """The continued fraction of the incomplete beta function, by Lentz's method."""
    c, d = 1.0, 1 / (1 - (a + b) * x / (a + 1) or TINY)
    result = d
    for m in range(1, 100_000):
        for numerator in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)), -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d = 1 / (1 + numerator * d or TINY)
            c = 1 + numerator / c or TINY
            result *= c * d
        if abs(c * d - 1) < 1e-15:
            return result
    raise ArithmeticError(f'no convergence at a = {a}, b = {b}, x = {x}')


def beta(a, b, x):
    """Regularised incomplete beta function I_x(a, b)."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log1p(-x))
    if x < (a + 1) / (a + b + 2):
        return front * _fraction(a, b, x) / a
    return 1 - front * _fraction(b, a, 1 - x) / b


def _inverse(a, b, part):
    low, high = 0.0, 1.0
    while (middle := (low + high) / 2) not in (low, high):
        low, high = (middle, high) if beta(a, b, middle) < part else (low, middle)
    return middle


def lower(hits, of, outside=OUTSIDE):
    """Lower end of the two-sided interval that does not hold in `outside` of all cases, at most."""
    return 0.0 if hits == 0 else _inverse(hits, of - hits + 1, outside / 2)


def upper(hits, of, outside=OUTSIDE):
    """Upper end of it."""
    return 1.0 if hits == of else _inverse(hits + 1, of - hits, 1 - outside / 2)


def runs_for(bound, hits=0, outside=OUTSIDE):
    """The least number of runs whose upper end is at most `bound`, with so many hits in them."""
    low, high = hits, max(hits, 1)
    while upper(hits, high, outside) > bound:
        low, high = high, high * 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if upper(hits, middle, outside) <= bound else (middle, high)
    return high
