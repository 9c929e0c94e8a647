"""`import kinship` against a real kinshipd over DDS."""
import os
import pathlib
import signal
import threading
import time
import unittest

import numpy as np

import kinship
from kinshipd_process import Kinshipd
from panda_sweeps import attempt

MODELS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "robots" / "models"
TASK = "sweep"


class WithServer(unittest.TestCase):
    """One server for the class; its client has an outbox of its own for each test."""

    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(Kinshipd())
        cls.server.start()
        cls.panda = kinship.Robot(MODELS / "panda")
        cls.ur10e = kinship.Robot(MODELS / "ur10e")

    def setUp(self):
        self.client = self.enterContext(self.open_client())

    def open_client(self, **options):
        return kinship.Client(domain=self.server.domain, outbox=self.server.folder / self.id(), timeout=20, **options)

    def report_sweeps(self, task, seeds):
        self.client.register(self.panda)
        for seed in seeds:
            self.client.report(attempt(self.panda, task, seed))
        state = self.client.flush(60)
        self.assertEqual((state.pending, state.refused), (0, 0), state.problem)


class Forked(WithServer):
    def test_a_forked_process_says_at_once_what_to_use_and_ends(self):
        begin = time.monotonic()
        child = os.fork()
        if child == 0:
            code = 1
            try:
                with self.open_client(has_outbox=False):
                    pass
            except kinship.errors.InvalidInput as error:
                code = 0 if "spawn" in str(error) else 2
            try:
                self.client.status()
            except kinship.errors.InvalidInput as error:
                code += 0 if "spawn" in str(error) else 4
            self.client.close()  # waits for none of the threads that did not come along
            os._exit(code)
        while time.monotonic() - begin < 10:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                self.assertEqual(os.waitstatus_to_exitcode(status), 0)
                return
            time.sleep(0.02)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        self.fail("the forked process hangs")


class RoundTrip(WithServer):
    def test_what_one_robot_reports_another_fetches(self):
        self.report_sweeps(TASK, range(6))
        registration = self.client.register(self.ur10e)
        self.assertEqual(registration.robot, self.ur10e.digest)
        distribution = self.client.fetch(TASK, self.ur10e, deadline=120)
        self.assertEqual(distribution.task, TASK)
        self.assertEqual(distribution.robot, self.ur10e.digest)
        self.assertEqual(distribution.means.shape, (len(distribution), 6))
        self.assertEqual(distribution.covariances.shape, (len(distribution), 6, 6))
        sources = distribution.provenance["sources"]
        self.assertEqual([(source["label"], source["paths"]) for source in sources], [("panda", 6)])
        samples = distribution.sample(1000, seed=1)
        self.assertTrue(((samples >= self.ur10e.lower) & (samples <= self.ur10e.upper)).all())
        # Samples of the UR10e put its hand where the Panda's went.
        hands = self.ur10e.fk(samples, frame="transfer")[:, :3, 3]
        ways = np.concatenate([self.panda.fk(attempt(self.panda, TASK, seed).waypoints, frame="transfer")[:, :3, 3]
                               for seed in range(6)])
        distances = np.linalg.norm(hands[:, None] - ways[None], axis=2).min(axis=1)
        self.assertLess(np.median(distances), 0.3)

    def test_the_same_distribution_by_label_and_digest_and_after_json(self):
        self.report_sweeps("by_name", range(4))
        self.client.register(self.ur10e)
        distribution = self.client.fetch("by_name", self.ur10e, deadline=120)
        for name in (self.ur10e.digest, "ur10e"):
            again = self.client.fetch("by_name", name, deadline=120)
            self.assertEqual((again.id, again.revision), (distribution.id, distribution.revision))
        copied = kinship.Distribution.from_json(distribution.to_json())
        np.testing.assert_array_equal(copied.means, distribution.means)
        np.testing.assert_array_equal(copied.sample(50, seed=3), distribution.sample(50, seed=3))

    def test_deliver_says_what_became_of_each(self):
        self.client.register(self.panda)
        attempts = [attempt(self.panda, "delivered", seed) for seed in range(2)]
        unsolved = kinship.Attempt("delivered", self.panda, planning_time_s=1, outcome="timeout")
        first = self.client.deliver(attempts + [unsolved])
        self.assertEqual([receipt.status for receipt in first], ["stored", "stored", "recorded"])
        self.assertEqual([receipt.report_uuid for receipt in first[:2]], [a.report_uuid for a in attempts])
        again = self.client.deliver(attempts)
        self.assertEqual([receipt.status for receipt in again], ["duplicate", "duplicate"])
        task, = [row for row in self.client.tasks() if row["task"] == "delivered"]
        self.assertEqual(task["paths"], 2)

    def test_a_follower_gets_what_is_reported_later(self):
        self.client.register(self.panda)
        with self.client.follow("followed", self.panda) as follower:
            self.assertIsNone(follower.newest())
            self.report_sweeps("followed", range(4))
            newest = follower.wait_for_newer(timeout=120)
            self.assertIsNotNone(newest, follower.reason)
            self.assertEqual(newest.task, "followed")
            self.assertEqual(follower.status, "ready")
            self.assertIs(follower.newest(), follower.newest())
            self.assertIs(follower.wait_for_newer(newest, timeout=0.1), newest)
        with self.assertRaisesRegex(kinship.InvalidInput, "closed"):
            follower.newest()


class Planning(WithServer):
    START = [-0.9, -1.4, 1.9, -2.07, -1.57, 0]
    GOAL = [0.9, -1.4, 1.9, -2.07, -1.57, 0]

    def test_with_what_the_fleet_knows_and_reporting_what_came_of_it(self):
        self.report_sweeps("planned", range(6))
        self.client.register(self.ur10e)
        guidance = self.client.guidance("planned", self.ur10e, deadline=120, control_share=0)
        self.assertRegex(guidance.message, "components fitted.*panda .6 paths.; .* stored ways of the hand")
        self.assertIsNotNone(guidance.distribution_id)
        self.assertEqual(set(guidance.way_sources), {self.panda.digest})
        # The ways are those of the Panda's hand.
        starts = np.array([way[0, :3, 3] for way in guidance.ways])
        hands = np.array([self.panda.fk(attempt(self.panda, "planned", seed).waypoints[0], frame="transfer")[:3, 3]
                          for seed in range(6)])
        nearest = np.linalg.norm(starts[:, None] - hands[None], axis=2).min(axis=1)
        self.assertLess(nearest.max(), 1e-3)
        scene = kinship.Scene()
        scene.add_cylinder("post", [0.75, 0, 0.5, 0, 0, 0, 1], 0.05, 1.0)
        plan = kinship.plan(self.ur10e, kinship.Problem("post", self.START, self.GOAL, scene=scene), guidance)
        self.assertTrue(plan.solved, plan.reason)
        self.assertEqual((plan.sampling_mode, plan.guide), ("guided", guidance.guide))
        with self.assertRaisesRegex(kinship.InvalidInput, "T_task_base is 1 0 0 0 0 0 1, the guidance was made for 0 0 0 0 0 0 1"):
            kinship.plan(self.ur10e, kinship.Problem("off", self.START, self.GOAL, T_task_base=[1, 0, 0, 0, 0, 0, 1]), guidance)
        self.client.report(plan.attempt("planned"))
        state = self.client.flush(60)
        self.assertEqual((state.pending, state.refused), (0, 0), state.problem)
        task, = [row for row in self.client.tasks() if row["task"] == "planned"]
        self.assertEqual((task["paths"], len(task["robots"])), (7, 2))

    def test_a_robot_stands_where_it_stood_when_it_last_reported(self):
        here = [0.1, 0.2, 0, 0, 0, 0, 1]
        self.client.register(self.panda)
        for seed in range(4):
            placed = attempt(self.panda, "placed", seed)
            placed.T_task_base = here
            self.client.report(placed)
        self.assertEqual(self.client.flush(60).accepted, 4)
        guidance = self.client.guidance("placed", self.panda, deadline=120)
        np.testing.assert_allclose(guidance.T_task_base[:3, 3], here[:3])
        with self.client.follow("placed", self.panda) as follower:
            followed = follower.wait_for_newer(timeout=60)
            self.assertIsNotNone(followed, follower.reason)
            np.testing.assert_allclose(followed.T_task_base[:3, 3], here[:3])
        with self.assertRaisesRegex(kinship.InvalidInput, "T_task_base is not given, so identity, the guidance was made for 0.1"):
            kinship.plan(self.panda, kinship.Problem("forgotten", placed.waypoints[0], placed.waypoints[-1]), guidance)

    def test_a_rehearsal_is_waited_for(self):
        self.report_sweeps("rehearsed", range(200))
        self.client.register(self.ur10e)
        guidance = self.client.guidance("rehearsed", self.ur10e, deadline=120, rehearsed=True)
        self.assertRegex(guidance.message, "rehearsed on [0-9]+ recorded queries: guide ")

    def around_a_post(self, seed):
        """Both a little elsewhere for each seed: the post, and the goal behind it."""
        draws = np.random.default_rng(seed).uniform(-1, 1, 7)
        scene = kinship.Scene()
        scene.add_cylinder("post", [0.75 + 0.05 * draws[0], 0.1 * draws[1], 0.5, 0, 0, 0, 1], 0.05, 1.0)
        goal = np.array(self.GOAL) + 0.1 * np.append(draws[2:], 0)
        return kinship.Problem(f"post {seed}", self.START, goal, scene=scene, seed=seed)

    def test_whole_paths_are_recalled_by_a_checker_of_ones_own(self):
        self.client.register(self.ur10e)
        for seed in range(8):
            plan = kinship.plan(self.ur10e, self.around_a_post(seed))
            self.assertTrue(plan.solved, plan.reason)
            self.client.report(plan.attempt("recalled"))
        self.client.flush(60)
        guidance = self.client.guidance("recalled", self.ur10e, deadline=120, rehearsed=True)
        found = {"checked": 0, "proven": 0}
        for problem in map(self.around_a_post, range(100, 106)):
            world = kinship.World.of_problem(self.ur10e, problem)
            asked = []
            checked = guidance.recall(problem, lambda qs: asked.append(qs) or world.free(qs), step=0.1)
            if checked is not None:
                found["checked"] += 1
                steps = np.concatenate([np.linspace(a, b, 1 + int(np.ceil(np.linalg.norm(b - a) / 0.1)))
                                        for a, b in zip(checked, checked[1:])])
                gaps = np.linalg.norm(steps[:, None] - np.concatenate(asked)[None], axis=2).min(axis=1)
                self.assertLess(gaps.max(), 1e-6, "each configuration was asked")
            proven = guidance.recall(problem, world.free, world.path_free)
            if proven is not None:
                found["proven"] += 1
                np.testing.assert_array_equal(proven[[0, -1]], [self.START, problem.goal_configurations[0]])
                self.assertTrue(world.path_free(proven))
            self.assertIsNone(guidance.recall(problem, world.free, lambda path: False))
        self.assertGreater(min(found.values()), 0, found)
        with self.assertRaisesRegex(ValueError, "free answers not with one bool for each of"):
            guidance.recall(problem, lambda qs: True)
        with self.assertRaises(ZeroDivisionError):
            guidance.recall(problem, lambda qs: 1 // 0)
        with self.assertRaisesRegex(kinship.InvalidInput, "joints"):
            guidance.recall(kinship.Problem("five", self.START[1:], self.GOAL[1:]), world.free)

    def test_without_experience_there_is_no_guidance(self):
        self.client.register(self.ur10e)
        with self.assertRaisesRegex(kinship.NoExperience, "never_done"):
            self.client.guidance("never_done", self.ur10e)


class Administration(WithServer):
    def test_what_happens_is_heard_of(self):
        with self.client.watch() as events:
            kinds = []

            def listen():
                for event in events:
                    if event["task"] == "watched":
                        kinds.append(event["kind"])

            waiting = threading.Thread(target=listen)
            waiting.start()
            deadline = time.monotonic() + 60
            for seed in range(100):  # who has just begun to listen may miss some
                self.report_sweeps("watched", [seed])
                if kinds or time.monotonic() > deadline:
                    break
            events.close()
            waiting.join(30)
            self.assertFalse(waiting.is_alive())
        self.assertEqual(kinds[0], "report")

    def test_a_retired_path_is_out_of_every_fit(self):
        self.report_sweeps("retired", range(2))
        wrong = attempt(self.panda, "retired", 3)
        self.client.deliver([wrong])
        self.assertEqual(self.client.retire(wrong.report_uuid)["paths"], 1)
        self.assertEqual(self.client.retire(wrong.report_uuid)["paths"], 0)
        task, = [row for row in self.client.tasks() if row["task"] == "retired"]
        self.assertEqual(task["paths"], 2)
        self.assertEqual(self.client.reset("retired")["paths"], 2)
        with self.assertRaises(kinship.NotFound):
            self.client.retire("00000000-0000-4000-8000-000000000000")

    def test_a_backup_is_a_store(self):
        self.report_sweeps("backed_up", range(2))
        job = self.client.backup("monday.db", deadline=60)
        self.assertEqual((job["verb"], job["state"]), ("backup", "done"))
        copy, = self.server.folder.rglob("monday.db")
        self.assertEqual(copy.read_bytes()[:15], b"SQLite format 3")
        with self.assertRaisesRegex(kinship.Error, "monday.db"):
            self.client.backup("monday.db", deadline=60)  # it is there


class Errors(WithServer):
    def test_of_a_task_without_experience(self):
        self.client.register(self.panda)
        with self.assertRaisesRegex(kinship.NoExperience, "task 'nobody_did_it'.*no experience"):
            self.client.fetch("nobody_did_it", self.panda)

    def test_of_robots_that_the_server_does_not_know(self):
        iiwa = kinship.Robot(MODELS / "iiwa7")
        with self.assertRaisesRegex(kinship.UnknownRobot, iiwa.digest[:12]):
            self.client.fetch(TASK, iiwa)
        with self.assertRaisesRegex(kinship.NotFound, "no_such_robot"):
            self.client.fetch(TASK, "no_such_robot")

    def test_of_what_the_server_refuses(self):
        self.client.register(self.panda)
        taken = kinship.Robot(MODELS / "iiwa14", label="panda")
        with self.assertRaisesRegex(kinship.Refused, "label"):
            self.client.register(taken)
        with self.assertRaisesRegex(kinship.Error, "no_such_profile"):
            self.client.fetch(TASK, self.panda, profile="no_such_profile")

    def test_of_values_that_break_a_rule(self):
        wrong = attempt(self.panda, TASK, 1)
        wrong.task = "no such name"
        with self.assertRaisesRegex(kinship.InvalidInput, "task"):
            self.client.report(wrong)
        self.client.register(self.panda)
        wrong = kinship.Attempt(TASK, self.panda, np.zeros((2, 6)))
        with self.assertRaisesRegex(ValueError, r"robot 'panda' \(.*\) has 7 joints, the report's path has 6"):
            self.client.report(wrong)
        iiwa = kinship.Robot(MODELS / "iiwa7")
        with self.assertRaisesRegex(LookupError, f"robot {iiwa.digest[:12]}.* register it before its first report"):
            self.client.report(kinship.Attempt(TASK, iiwa, np.zeros((2, 7))))
        with self.assertRaisesRegex(ValueError, "resend 'some' is neither 'all' nor 'none'"):
            self.open_client(resend="some")
        with self.assertRaisesRegex(ValueError, "weighting: 'robots' is not one of sources, paths"):
            self.client.fetch(TASK, self.panda, weighting="robots")
        with self.assertRaisesRegex(ValueError, "deadline: -1 s"):
            self.client.fetch(TASK, self.panda, deadline=-1)
        self.assertEqual(self.client.outbox.pending, 0)

    def test_of_a_client_that_is_closed(self):
        self.client.close()
        with self.assertRaisesRegex(kinship.InvalidInput, "the client is closed"):
            self.client.fetch(TASK, self.panda)


class WithoutServer(unittest.TestCase):
    """Nobody listens in the domain: a fetch waits until its deadline."""

    def setUp(self):
        self.server = self.enterContext(Kinshipd())
        self.client = self.enterContext(
            kinship.Client(domain=self.server.domain, outbox=self.server.folder / "outbox"))
        self.panda = kinship.Robot(MODELS / "panda")

    def test_other_threads_run_while_a_fetch_waits(self):
        ticks, is_over = [], threading.Event()

        def tick():
            while not is_over.wait(0.01):
                ticks.append(time.monotonic())

        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.monotonic()
        with self.assertRaisesRegex(kinship.NoServer, f"no server answered.*domain {self.server.domain}.*2000 ms"):
            self.client.fetch(TASK, self.panda, deadline=2, T_task_base=[0, 0, 0, 0, 0, 0, 1])
        end = time.monotonic()
        is_over.set()
        thread.join()
        self.assertGreaterEqual(end - begin, 1.9)
        during = [at for at in ticks if begin < at < end]
        self.assertGreater(len(during), 50, "the thread stood still while the fetch waited")

    def test_control_c_ends_a_fetch_that_waits(self):
        previous = signal.signal(signal.SIGALRM, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGALRM, previous)
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            self.client.fetch(TASK, self.panda, deadline=60)
        self.assertLess(time.monotonic() - begin, 30)

    def test_control_c_ends_what_waits_for_one_answer_and_the_client_goes_on(self):
        client = self.enterContext(kinship.Client(domain=self.server.domain, has_outbox=False, timeout=60))
        calls = {"register": lambda: client.register(self.panda), "status": client.status,
                 "robots by name": lambda: client.fetch(TASK, "panda", deadline=60),
                 "deliver": lambda: client.deliver([attempt(self.panda, TASK, 1)]),
                 "backup": lambda: client.backup("monday.db")}
        for name, call in calls.items():
            with self.subTest(name):
                threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
                begin = time.monotonic()
                with self.assertRaises(KeyboardInterrupt):
                    call()
                self.assertLess(time.monotonic() - begin, 20)
        self.server.start()
        self.assertEqual(client.register(self.panda).robot, self.panda.digest)

    def test_control_c_ends_a_wait_for_events(self):
        with self.client.watch() as events:
            threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
            with self.assertRaises(KeyboardInterrupt):
                next(events)
            events.close()
            self.assertEqual(list(events), [])

    def test_a_closed_watch_leaves_no_thread(self):
        def threads():
            return len(os.listdir("/proc/self/task"))

        with self.client.watch():
            with_one = threads()
        closed = [self.client.watch() for _ in range(5)]
        self.assertGreater(threads(), with_one)
        for events in closed:
            events.close()
        deadline = time.monotonic() + 10  # a joined thread may be listed for a moment
        while threads() > with_one and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertLessEqual(threads(), with_one)

    def test_closing_ends_the_fetch_of_another_thread(self):
        errors = []

        def fetch():
            try:
                self.client.fetch(TASK, self.panda, deadline=60)
            except kinship.Error as error:
                errors.append(error)

        thread = threading.Thread(target=fetch)
        thread.start()
        self.client.close()
        thread.join(30)
        self.assertFalse(thread.is_alive())
        self.assertEqual(len(errors), 1)

    def test_reports_wait_for_the_server(self):
        with kinship.Client(domain=self.server.domain, outbox=self.server.folder / "outbox", timeout=0.2) as first:
            with self.assertRaises(kinship.NoServer):
                first.register(self.panda)
        self.client.report(attempt(self.panda, TASK, 1))
        self.assertEqual(self.client.flush(0.1).pending, 1)
        with self.assertRaises(kinship.NoServer):
            kinship.Client(domain=self.server.domain, has_outbox=False, timeout=0.2).register(self.panda)
        self.server.start()
        self.client.register(self.panda)
        state = self.client.flush(60)
        self.assertEqual((state.pending, state.accepted), (0, 1), state.problem)

    def test_a_refused_report_is_told_with_its_reason(self):
        self.server.start()
        self.client.register(self.panda)
        beyond = kinship.Attempt(TASK, self.panda, np.full((2, 7), 3.5))
        self.client.report(beyond)
        state = self.client.flush(60)
        self.assertEqual((state.pending, state.refused, state.kept), (0, 1, {}))
        self.assertRegex(state.last_refusal, "robot 'panda': joint .* exceeds")


if __name__ == "__main__":
    unittest.main()
