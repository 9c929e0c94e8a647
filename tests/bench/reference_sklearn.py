#!/usr/bin/python3
"""scikit-learn's side of fit_bench; prints CPU milliseconds and the mean log-likelihood.

    reference_sklearn.py em FOLDER D K    an EM iteration from the start in FOLDER
    reference_sklearn.py fit FOLDER D K   a whole fit, at most 50 iterations
"""
import pathlib
import sys
import time
import warnings

import numpy
from sklearn.mixture import GaussianMixture

ITERATIONS = 7


def timed_fit(points, **options):
    model = GaussianMixture(reg_covar=1e-4, **options)
    begin = time.process_time()
    model.fit(points)
    return 1000 * (time.process_time() - begin), model


def main():
    what, folder, d, k = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
    warnings.filterwarnings("ignore")  # that few iterations do not converge
    points = numpy.fromfile(folder / "points").reshape(-1, d)
    if what == "fit":
        ms, model = timed_fit(points, n_components=k, max_iter=50, random_state=0)
        print(ms, model.score(points))
        return
    start = numpy.fromfile(folder / "start")
    weights, means, covariances = start[:k], start[k:k + k * d].reshape(k, d), start[k + k * d:].reshape(k, d, d)
    options = dict(n_components=k, tol=0, weights_init=weights / weights.sum(), means_init=means,
                   precisions_init=numpy.linalg.inv(covariances), init_params="random_from_data")
    few, _ = timed_fit(points, max_iter=2, **options)
    many, model = timed_fit(points, max_iter=ITERATIONS, **options)
    print((many - few) / (ITERATIONS - 2), model.score(points))


main()
