"""The files of a run that a page shows: a robot that planned the same problems with uniform and with guided sampling."""
import os
from typing import Any

from . import comparison
from .page_figures import page_figures

Words = dict[str, list[str]]  # of the command line, by option
_PROBLEMS, _RESULTS = ".problems.jsonl", ".results.jsonl"
_OF_ROBOT = {"problems": _PROBLEMS, "uniform": "-uniform" + _RESULTS, "guided": "-guided" + _RESULTS,
             "uniform-searches": "-uniform.searches.jsonl", "guided-searches": "-guided.searches.jsonl"}
_OF_FOLDER = {"distribution": "distribution.json", "advice": "advice.json"}
_NEEDED = {"model": ("the robot's model", "(--models)/ROBOT"), "problems": ("its problems", "ROBOT" + _OF_ROBOT["problems"]),
           "uniform": ("results of uniform sampling", "ROBOT" + _OF_ROBOT["uniform"]),
           "guided": ("results of guided sampling", "ROBOT" + _OF_ROBOT["guided"]),
           "distribution": ("the distribution", _OF_FOLDER["distribution"])}
_ALONE = ("mixture", "ways", "retreat")  # guides, in the order in which a page has them


class IncompleteRun(Exception):
    """Names everything that a run lacks."""


def find_run(words: Words) -> dict[str, Any]:
    """Looks in the folder for files that are not named (kinship results page --help has their names).

    Returns "files" by option, "also" as pairs of name and file, "teachers" as [model, problems, results]. Raises IncompleteRun with
    everything that is missing, and how it is named; ValueError for what is written wrongly.
    """
    def value(name: str) -> str:
        return words.get(name, [""])[0]

    folder, models = value("run"), value("models")
    if folder and not os.path.isdir(folder):
        raise IncompleteRun(f"--run '{folder}' is no folder")
    names = sorted(os.listdir(folder)) if folder else []

    def found(name: str) -> str:
        return os.path.join(folder, name) if name in names else ""

    files = {name: value(name) for name in ("model", *_OF_ROBOT, *_OF_FOLDER)}
    also = [_parse_also(text) for text in words.get("also", [])]
    robot = value("robot") or _only_robot(folder, names)
    if robot:
        files |= {name: files[name] or found(robot + ending) for name, ending in _OF_ROBOT.items()}
        alone = {guide: found(f"{robot}-{guide}{_RESULTS}") for guide in _ALONE}
        also = also or [(f"{guide} alone", file) for guide, file in alone.items() if file]
        files["model"] = files["model"] or (os.path.join(models, robot) if models else "")
    files |= {name: files[name] or found(file) for name, file in _OF_FOLDER.items()}
    teachers = [_parse_teacher(text) for text in words.get("teacher", [])]
    others = [name for name in _with_all(names, _PROBLEMS, _RESULTS) if name != robot and models]
    teachers += [[os.path.join(models, name), *(os.path.join(folder, name + ending) for ending in (_PROBLEMS, _RESULTS))]
                 for name in words.get("teachers", others)]
    run = {"files": files, "also": also, "teachers": teachers}
    missing = _missing(run, folder)
    if missing:
        raise IncompleteRun("this run lacks what a page tells of:" + "".join(f"\n  {each}" for each in missing))
    return run


def _with_all(names: list[str], *endings: str) -> list[str]:
    """Beginnings of names, each of which has all of the endings."""
    beginnings = [name.removesuffix(endings[0]) for name in names if name.endswith(endings[0])]
    return [each for each in beginnings if each and all(each + ending in names for ending in endings)]


def _only_robot(folder: str, names: list[str]) -> str:
    robots = _with_all(names, _OF_ROBOT["uniform"], _OF_ROBOT["guided"])
    if len(robots) > 1:
        raise ValueError(f"--run '{folder}' has runs of several robots: say --robot ({', '.join(robots)})")
    return robots[0] if robots else ""


def _parse_also(text: str) -> tuple[str, str]:
    if "=" not in text:
        raise ValueError(f"--also '{text}' is not NAME=FILE")
    return comparison.parse_named(text)


def _parse_teacher(text: str) -> list[str]:
    parts = text.split(",")
    if len(parts) != 3 or not all(parts):
        raise ValueError(f"--teacher '{text}' is not MODEL,PROBLEMS,RESULTS")
    return parts


def _missing(run: dict[str, Any], folder: str) -> list[str]:
    files, missing = run["files"], []
    for name, (what, usual) in _NEEDED.items():
        if not files[name]:
            missing.append(f"{what}: name it with --{name}" + (f", or call it {usual} in '{folder}'" if folder else ""))
        elif not os.path.exists(files[name]):
            missing.append(f"{what}: there is no '{files[name]}'")
    other = [("of a teacher: ", file) for teacher in run["teachers"] for file in teacher]
    other += [("", file) for name, file in files.items() if file and name not in _NEEDED]
    other += [(f"of '{name}': ", file) for name, file in run["also"]]
    return missing + [f"{whose}there is no '{file}'" for whose, file in other if not os.path.exists(file)]


def described(run: dict[str, Any]) -> dict[str, Any]:
    """What kinship draws: the files, the problem that is shown, and the figures. Raises ValueError for files that do not
    belong together."""
    files = run["files"]
    uniform, guided = (comparison.read_results(files[side]) for side in ("uniform", "guided"))
    compared = comparison.named(f"{files['uniform']} and {files['guided']}", uniform, guided)
    figures = page_figures(uniform, guided, compared, comparison.compare_also(uniform, run["also"]))
    shown = figures["typical"]["problem"] if figures["typical"] else uniform[0]["name"]
    return {"files": files, "teachers": run["teachers"], "shown": shown, "figures": figures}
