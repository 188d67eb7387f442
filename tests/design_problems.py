"""Problems of optimization with known answers, as design problems."""

import numpy as np

from chromanoise.apps.design.pareto_front import Evaluated, Linearized, Problem

STEP = 1e-30


def problem_of(function, low, high, *, better=("lower", "lower"), constraints=(), **fields):
    """A problem from complex values (m d) to lists of objectives and of violations (m,)."""

    def rows(values):
        objectives, violation = function(*values.T)
        empty = np.empty((len(values), 0))
        return (
            np.stack(objectives, axis=1) + np.zeros((len(values), 1)),
            np.stack(violation, axis=1) if violation else empty,
        )

    def evaluate(values):
        objectives, violation = rows(values)
        return Evaluated(objectives=objectives, violation=violation)

    def gradient(values):
        at, (m, d) = evaluate(values), values.shape
        copies = (values[:, None] + 1j * STEP * np.eye(d)).reshape(m * d, d)
        slopes = [part.imag.reshape(m, d, -1).swapaxes(1, 2) / STEP for part in rows(copies)]
        return Linearized(
            objectives=at.objectives,
            violation=at.violation,
            objectives_jacobian=slopes[0],
            violation_jacobian=slopes[1].reshape(m, len(constraints), d),
            constraint=np.arange(len(constraints)),
        )

    return Problem(
        names=tuple(f"x{i}" for i in range(len(low))),
        low=np.array(low, dtype=float),
        high=np.array(high, dtype=float),
        objectives=tuple(f"f{i + 1}" for i in range(len(better))),
        better=better,
        constraints=constraints,
        evaluate=evaluate,
        gradient=gradient,
        **fields,
    )


def same(one, other):
    """Whether two fronts have the same bits."""
    names = "values", "objectives", "violation"
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)


def zdt1(count=10):
    """Zitzler, Deb & Thiele (2000): the front is f2 = 1 - sqrt(f1)."""

    def function(first, *others):
        g = 1 + 9 * sum(others) / len(others)
        return [first, g * (1 - np.sqrt(first / g))], []

    return problem_of(function, [0.0] * count, [1.0] * count)


def dtlz2(count=7):
    """Deb, Thiele, Laumanns & Zitzler (2002): the front is the unit sphere."""

    def function(a, b, *others):
        g = 1 + sum((one - 0.5) ** 2 for one in others)
        a, b = np.pi / 2 * a, np.pi / 2 * b
        return [g * np.cos(a) * np.cos(b), g * np.cos(a) * np.sin(b), g * np.sin(a)], []

    return problem_of(function, [0.0] * count, [1.0] * count, better=("lower",) * 3)


def bnh():
    """Binh & Korn (1997): x1 = x2 from 0 to 3, then x2 = 3 and x1 from 3 to 5."""

    def function(a, b):
        return (
            [4 * a**2 + 4 * b**2, (a - 5) ** 2 + (b - 5) ** 2],
            [(a - 5) ** 2 + b**2 - 25, 7.7 - (a - 8) ** 2 - (b + 3) ** 2],
        )

    return problem_of(function, [0.0, 0.0], [5.0, 3.0], constraints=("c1", "c2"))


def bowl(**fields):
    """Two parameters, lowest at (0.3, -0.2), where its value is 1."""
    return problem_of(
        lambda a, b: ([1 + (a - 0.3) ** 2 + 3 * (b + 0.2) ** 2], []),
        [-1.0, -1.0],
        [1.0, 1.0],
        better=("lower",),
        **fields,
    )


def rosenbrock():
    """Rosenbrock (1960): lowest at (1, 1), where it is 0."""
    return problem_of(
        lambda a, b: ([100 * (b - a**2) ** 2 + (1 - a) ** 2], []),
        [-2.0, -2.0],
        [2.0, 2.0],
        better=("lower",),
    )


def half_plane():
    """The highest a + b on the disk of radius 1 with b at most 0.6 is 1.4, at (0.8, 0.6)."""
    return problem_of(
        lambda a, b: ([a + b], [a**2 + b**2 - 1, b - 0.6, a - 5]),
        [-1.0, -1.0],
        [1.0, 1.0],
        better=("higher",),
        constraints=("disk", "b at most 0.6", "a at most 5"),
    )
