"""Distributions as numpy sees them: arrays, samples, densities."""
import json
import math
import pickle
import unittest

import numpy as np

import kinship

WEIGHTS = [0.3, 0.7]
MEANS = [[-0.5, 0.2, 0.0], [0.6, -0.3, 0.4]]
COVARIANCES = [np.diag([0.04, 0.01, 0.02]), [[0.05, 0.02, 0.0], [0.02, 0.03, 0.01], [0.0, 0.01, 0.02]]]


def document(**others) -> str:
    """A distribution of three joints with wide limits, as `kinship distributions fetch --json` prints it."""
    return json.dumps({
        "id": "ab" * 32, "revision": 3, "store_epoch": "7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55", "task": "sweep",
        "robot": "cd" * 32, "T_task_base": [1, 2, 3, 0, 0, math.sqrt(0.5), math.sqrt(0.5)], "profile": "default",
        "selection": {"sources": [], "weighting": "sources", "since_ms": 0}, "engines": "test", "state": "ready", "reason": "",
        "sources": [], "configurations": 500, "weights": WEIGHTS, "means": MEANS,
        "covariances": np.asarray(COVARIANCES).tolist(), "limits": [[-9, 9]] * 3, "cuts": None, "k_curve": None,
        "held_out_score": None, "recommended_share": 0.75, "guided_share": 0.75, "evidence": "none", "guided": None,
        "control": None, "recent": [], "fitted_ms": 1, "transfer_time_s": 0, "fit_time_s": 0, "fit": None,
        "filters": "", **others})


def density_written_out(q, weights, means, covariances):
    """Bishop, eq. 9.7, as it stands there."""
    total = 0
    for weight, mean, covariance in zip(weights, means, covariances):
        away = q - mean
        scale = math.sqrt((2 * math.pi) ** len(q) * np.linalg.det(covariance))
        total += weight * math.exp(-0.5 * away @ np.linalg.solve(covariance, away)) / scale
    return total


class Arrays(unittest.TestCase):
    def test_have_components_first_and_joints_last(self):
        distribution = kinship.Distribution.from_json(document())
        self.assertEqual(len(distribution), 2)
        np.testing.assert_array_equal(distribution.weights, WEIGHTS)
        np.testing.assert_array_equal(distribution.means, MEANS)
        np.testing.assert_array_equal(distribution.covariances, np.asarray(COVARIANCES))
        np.testing.assert_array_equal(distribution.upper, [9, 9, 9])
        np.testing.assert_allclose(distribution.T_task_base,
                                   [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]], atol=1e-12)

    def test_of_a_shared_covariance_have_it_for_each_component(self):
        distribution = kinship.Distribution.from_json(document(covariances=[np.diag([0.1, 0.2, 0.3]).tolist()]))
        self.assertEqual(distribution.covariances.shape, (2, 3, 3))
        np.testing.assert_array_equal(distribution.covariances[1], np.diag([0.1, 0.2, 0.3]))

    def test_survive_a_pickle_bit_by_bit(self):
        distribution = kinship.Distribution.from_json(document())
        copied = pickle.loads(pickle.dumps(distribution))
        np.testing.assert_array_equal(copied.covariances, distribution.covariances)
        self.assertEqual((copied.id, copied.revision), (distribution.id, 3))

    def test_provenance_is_the_document_without_the_mixture(self):
        provenance = kinship.Distribution.from_json(document()).provenance
        self.assertEqual(provenance["revision"], 3)
        self.assertEqual(provenance["selection"]["weighting"], "sources")
        self.assertNotIn("means", provenance)


class Samples(unittest.TestCase):
    def test_have_the_moments_of_the_mixture(self):
        count = 200_000
        samples = kinship.Distribution.from_json(document()).sample(count, seed=1)
        self.assertEqual(samples.shape, (count, 3))
        mean = np.average(MEANS, axis=0, weights=WEIGHTS)
        spread = np.asarray(MEANS) - mean
        covariance = np.einsum("k,kij->ij", WEIGHTS, np.asarray(COVARIANCES) + spread[:, :, None] * spread[:, None])
        error = np.sqrt(np.diag(covariance) / count)  # of a mean, one standard deviation
        np.testing.assert_array_less(np.abs(samples.mean(axis=0) - mean), 5 * error)
        np.testing.assert_allclose(np.cov(samples.T), covariance, atol=0.005)

    def test_stay_within_the_limits(self):
        samples = kinship.Distribution.from_json(document(limits=[[-0.6, 0.7]] * 3)).sample(5000, seed=2)
        self.assertTrue((np.abs(samples - 0.05) <= 0.65).all())

    def test_of_a_continuous_joint_are_turned(self):
        means = [[3.0, 0.2, 0.0], [3.4, -0.3, 0.4]]
        distribution = kinship.Distribution.from_json(
            document(means=means, limits=[[0, 2 * math.pi], [-9, 9], [-9, 9]], cuts=[0, None, None]))
        turned = distribution.sample(2000, seed=3)[:, 0]
        self.assertLess(turned.min(), -2)
        self.assertLessEqual(np.abs(turned).max(), math.pi)

    def test_are_equal_for_equal_seeds_alone(self):
        distribution = kinship.Distribution.from_json(document())
        np.testing.assert_array_equal(distribution.sample(100, seed=7), distribution.sample(100, seed=7))
        self.assertFalse((distribution.sample(100, seed=7) == distribution.sample(100, seed=8)).any())
        self.assertFalse((distribution.sample(100) == distribution.sample(100)).any())

    def test_of_no_mixture_are_an_error_that_says_why(self):
        failed = kinship.Distribution.from_json(document(
            state="failed", reason="no pose could be reached", weights=None, means=None, covariances=None))
        with self.assertRaisesRegex(kinship.NotFound, "no pose could be reached"):
            failed.sample(1)
        with self.assertRaisesRegex(ValueError, "n is -1"):
            kinship.Distribution.from_json(document()).sample(-1)


class Densities(unittest.TestCase):
    def test_equal_the_formula_written_out(self):
        distribution = kinship.Distribution.from_json(document())
        points = np.random.default_rng(4).uniform(-1, 1, (300, 3))
        expected = [density_written_out(q, WEIGHTS, np.asarray(MEANS), np.asarray(COVARIANCES)) for q in points]
        np.testing.assert_allclose(distribution.density(points), expected, rtol=1e-10)
        self.assertIsInstance(distribution.log_density(points[0]), float)
        self.assertAlmostEqual(distribution.log_density(points[0]), math.log(expected[0]), places=9)

    def test_do_not_change_by_a_turn_of_a_continuous_joint(self):
        distribution = kinship.Distribution.from_json(
            document(means=[[3.0, 0.2, 0.0], [3.4, -0.3, 0.4]], limits=[[0, 2 * math.pi], [-9, 9], [-9, 9]],
                     cuts=[0, None, None]))
        q = np.array([3.2, 0, 0.1])
        self.assertAlmostEqual(distribution.log_density(q - [2 * math.pi, 0, 0]), distribution.log_density(q), places=9)
        self.assertLess(distribution.log_density(q + [0, 2 * math.pi, 0]), distribution.log_density(q) - 10)

    def test_of_the_wrong_number_of_joints_are_refused(self):
        distribution = kinship.Distribution.from_json(document())
        with self.assertRaisesRegex(kinship.InvalidInput, r"shape \(5, 2\): the distribution has 3 joints"):
            distribution.density(np.zeros((5, 2)))


class Documents(unittest.TestCase):
    def test_that_are_none_are_refused_with_the_field(self):
        with self.assertRaisesRegex(kinship.InvalidInput, "recommended_share"):
            kinship.Distribution.from_json(document(recommended_share=2))


if __name__ == "__main__":
    unittest.main()
