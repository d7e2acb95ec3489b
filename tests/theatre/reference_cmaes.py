#!/usr/bin/python3
"""Runs an independent CMA-ES over standard functions and writes how many evaluations each run needed to reach its target.

    apt-get install python3-cmaes python3-numpy
    /usr/bin/python3 tests/theatre/reference_cmaes.py > tests/theatre/reference_cmaes.txt      (minutes)

cma_es_test.cpp runs theatre::CmaEs on the same cases and compares the two samples. Each line holds a case and then its sorted counts, in
whole generations times the population; `inf` is a run that ended without reaching the target.
"""
import math
import multiprocessing

import cmaes
import numpy as np

SEEDS = 51


def sphere(x):
    return float(x @ x)


def ellipsoid(x):
    return float(10 ** (6 * np.arange(len(x)) / (len(x) - 1)) @ (x * x))


def rotated_ellipsoid(x):
    """The ellipsoid in axes mirrored along (1, 2, ..., n): every axis mixes all coordinates."""
    v = np.arange(1.0, len(x) + 1)
    return ellipsoid(x - 2 * (v @ x) / (v @ v) * v)


def cigar(x):
    return float(x[0] ** 2 + 1e6 * (x[1:] @ x[1:]))


def rosenbrock(x):
    return float(np.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2))


def rastrigin(x):
    return float(np.sum(x * x + 10 - 10 * np.cos(2 * math.pi * x)))


# function, dimensions, population, every coordinate of the start, sigma, target, most evaluations,
# whether with negative weights
CASES = [(f, n, 40, start, sigma, 1e-8, 400_000, 1)
         for f, start, sigma in ((sphere, 3, 2), (ellipsoid, 3, 2), (rotated_ellipsoid, 3, 2), (rosenbrock, 0, 0.5))
         for n in (5, 10, 20)]
CASES += [
    (sphere, 10, 10, 3, 2, 1e-8, 100_000, 1),
    (ellipsoid, 10, 10, 3, 2, 1e-8, 100_000, 1),
    (cigar, 10, 10, 3, 2, 1e-8, 100_000, 1),
    # Steps far too short at first: this is what h_sigma is for.
    (rotated_ellipsoid, 10, 10, 3, 1e-4, 1e-8, 100_000, 1),
    (cigar, 20, 40, 3, 1e-4, 1e-8, 100_000, 1),
    # Some runs end in a local minimum.
    (rastrigin, 3, 40, 3, 2, 1e-8, 20_000, 1),
    (rastrigin, 5, 40, 3, 2, 1e-8, 20_000, 1),
]
CASES += [case[:-1] + (0,) for case in CASES if case[1] in (3, 10)]


def evaluations(case, seed):
    function, n, population, start, sigma, target, most, negative = case
    search = cmaes.CMA(mean=np.full(n, float(start)), sigma=sigma, population_size=population, seed=seed)
    if not negative:
        search._weights = np.maximum(search._weights, 0)
    for count in range(population, most + 1, population):
        points = [search.ask() for _ in range(population)]
        values = [function(x) for x in points]
        if min(values) < target:
            return count
        search.tell(list(zip(points, values)))
        if search.should_stop():
            break
    return math.inf


def main():
    print(f"# Made by tests/theatre/reference_cmaes.py with python3-cmaes {cmaes.__version__}, seeds 1 to {SEEDS}.")
    print("# function dimensions population start sigma target most negative | evaluations of each run")
    with multiprocessing.Pool() as pool:
        for case in CASES:
            counts = sorted(pool.starmap(evaluations, [(case, seed) for seed in range(1, SEEDS + 1)]))
            print(case[0].__name__, *(f"{value:g}" for value in case[1:6]), *case[6:], "|", *counts, flush=True)


if __name__ == "__main__":
    main()
