#!/usr/bin/python3
"""EM of Kinship, scikit-learn and Armadillo on the same points from the same starts, in one run.

    fit_compare.py build/bench/bin

Needs Debian's python3-sklearn; without armadillo_compare beside fit_compare that column stays
empty. CPU time of the process, all threads.
"""
import pathlib
import subprocess
import sys
import tempfile
import time
import warnings

import numpy
from sklearn.mixture import GaussianMixture

ITERATIONS = 7


def read_case(folder, d, k):
    points = numpy.fromfile(folder / f"points_{d}.bin").reshape(-1, d)
    start = numpy.fromfile(folder / f"start_{d}_{k}.bin")
    return points, start[:k], start[k:k + k * d].reshape(k, d), start[k + k * d:].reshape(k, d, d)


def run_sklearn(case, iterations):
    points, weights, means, covariances = case
    model = GaussianMixture(
        len(weights), reg_covar=1e-4, tol=0, max_iter=iterations, weights_init=weights / weights.sum(),
        means_init=means, precisions_init=numpy.linalg.inv(covariances), init_params="random_from_data")
    begin = time.process_time()
    model.fit(points)
    return time.process_time() - begin, model


def armadillo_ms(program, folder, d, k):
    if not program.exists():
        return float("nan")
    return float(subprocess.run([program, folder, str(d), str(k)], check=True, capture_output=True,
                                text=True).stdout)


def main():
    binaries = pathlib.Path(sys.argv[1])
    warnings.filterwarnings("ignore")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        lines = subprocess.run([binaries / "fit_compare", folder], check=True, capture_output=True,
                               text=True).stdout.splitlines()
        ours = {(what, int(d), int(k)): (float(ms), float(likelihood))
                for what, d, k, ms, likelihood in (line.split() for line in lines)}
        print("  d    K   pruned    dense   sklearn  armadillo   ratios         likelihood - sklearn's")
        for (what, d, k), (pruned, likelihood) in ours.items():
            if what != "pruned":
                continue
            case = read_case(folder, d, k)
            short, _ = run_sklearn(case, 2)
            long, model = run_sklearn(case, ITERATIONS)
            sklearn = 1000 * (long - short) / (ITERATIONS - 2)
            armadillo = armadillo_ms(binaries / "armadillo_compare", folder, d, k)
            print(f"{d:3d} {k:4d} {pruned:8.2f} {ours['dense', d, k][0]:8.2f} {sklearn:9.1f} {armadillo:10.1f}"
                  f"   {sklearn / pruned:5.0f} {armadillo / pruned:5.0f}"
                  f"   {likelihood - model.score(case[0]):.1e}", flush=True)
        for (what, d, k), (ms, likelihood) in ours.items():
            if what.startswith("fit"):
                print(f"{what}: K = {k}, {ms:.0f} ms, log-likelihood {likelihood:.4f}")
        points = read_case(folder, 7, 50)[0]
        begin = time.process_time()
        model = GaussianMixture(50, reg_covar=1e-4, max_iter=50, random_state=0).fit(points)
        print(f"sklearn: K = 50, {1000 * (time.process_time() - begin):.0f} ms, log-likelihood "
              f"{model.score(points):.4f}, {model.n_iter_} iterations")


main()
