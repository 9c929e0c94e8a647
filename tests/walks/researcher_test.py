"""A researcher: Python and OMPL. He compares planners with and without a fleet's experience, and ends with a table and a page."""
import walk

DOCUMENTS = "/usr/share/doc/kinship"
# His own script: guidance once, then each query with and without it.
STUDY = '''
import kinship

robot = kinship.Robot("{documents}/robots/models/ur10e")
problems = kinship.read_problems("ur10e.problems.jsonl")
with kinship.Client() as client:
    client.register(robot)
    guidance = client.guidance("load_machine", robot, T_task_base=problems[0].T_task_base, deadline=60)
checks = {{"guided": 0, "uniform": 0}}
for problem in problems[:8]:
    checks["guided"] += kinship.plan(robot, problem, guidance, sampling_mode="guided").collision_checks
    checks["uniform"] += kinship.plan(robot, problem).collision_checks
print(checks["guided"], checks["uniform"])
'''


class Researcher(walk.WalkTest):
    def test_python_and_ompl_to_a_comparison(self):
        me = self.person(self.machine("kinship-server", "kinship-client", "kinship-doc", "libkinship-dev", "python3-kinship"))
        me.serve("kinshipd --store fleet.db")
        me.run(f'{DOCUMENTS}/docs/tutorial/problems.py "-0.35 0 0 0 0 0 1" > my_arm.problems.jsonl')
        me.run(f'{DOCUMENTS}/docs/tutorial/problems.py "-0.7 0 0.1 0 0 0 1" > ur10e.problems.jsonl')
        me.run(f"kinship-plan my_arm.problems.jsonl --robot {DOCUMENTS}/docs/tutorial/my_arm --task load_machine --report --output fleet.jsonl")

        me.write("study.py", STUDY.format(documents=DOCUMENTS))
        guided, uniform = (int(checks) for checks in me.run("python3 study.py").split())
        self.assertLess(guided, uniform)

        for guidance, options in (("none", ""), ("always", "--task load_machine --rehearsed")):
            me.run(f"kinship-plan ur10e.problems.jsonl --robot ur10e --planner ompl:RRTConnect --guidance {guidance} {options} "
                   f"--output {guidance}.jsonl")
        table = me.run("kinship results compare none.jsonl always.jsonl")
        self.assertRegex(table, r"24 problems, each planned with both")
        self.assertRegex(table, r"collision checks, mean")

        # A planner of OMPL in a program of his own: the examples are where he begins.
        me.run(f"cp -r {DOCUMENTS}/examples mine && cmake -S mine -B build && "
               "cmake --build build --target 01_report_a_path 03_guide_an_ompl_planner")
        me.run(f"for seed in 0 1 2 3; do build/01_report_a_path {DOCUMENTS}/robots/models $seed; done")
        self.assertRegex(me.run(f"build/03_guide_an_ompl_planner {DOCUMENTS}/robots/models"), r"(?m)^solved with")
        self.assertLessEqual(self.walk.commands, 11)


if __name__ == "__main__":
    walk.main()
