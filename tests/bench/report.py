"""The report of tests/bench/run.py as text, as Markdown and as a page of its own."""
import html as markup
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "client" / "experiments"))
from analysis.markdown import wrapped  # noqa: E402: after the path


def number(value):
    """Three digits or more, thousands apart."""
    if value == 0 or abs(value) >= 100:
        return f"{value:,.0f}".replace(",", " ")
    return f"{value:.3g}"


def spread(summary):
    """Median, and least to greatest of several runs."""
    text = number(summary["median"])
    if summary["min"] != summary["max"]:
        text += f" ({number(summary['min'])} to {number(summary['max'])})"
    return text


def budget(figure):
    at = "at most" if figure["better"] == "lower" else "at least"
    limits = [f"{at} {number(figure[key])}{suffix}" for key, suffix in
              (("budget", " " + figure["unit"]), ("ratio_budget", " x")) if key in figure]
    return ", ".join(limits)


def verdict(figure):
    return {True: "kept", False: "missed", None: ""}[figure["is_kept"]]


def columns(figure):
    reference = figure.get("reference")
    return [figure["name"],
            f"{spread(figure['value'])} {figure['unit']}",
            f"{reference['name']}: {number(reference['value'])}" if reference else "",
            spread(figure["ratio"]) if "ratio" in figure else "",
            budget(figure),
            verdict(figure),
            figure["note"]]


HEADINGS = ["What", "Value", "Reference", "Value / reference", "Budget", "", "Note"]


def in_a_line(figure):
    return " | ".join(text for text in columns(figure) if text)


def machine(document):
    modified = ", with changes that are not committed" if document["is_modified"] else ""
    return [f"{document['date']}, commit {document['commit']}{modified}",
            f"{document['cpu']}, {document['cores']} cores, {document['memory_gb']} GB; {document['system']}, "
            f"Linux {document['kernel']}",
            f"load {document['load_before']} before, {document['load_after']} after; {document['seconds']} s"]


def state(bench):
    return (f"{bench['runs']} run{'s' if bench['runs'] > 1 else ''}, {bench['seconds']} s, load {bench['load_before']} "
            f"before, {bench['load_after']} after")


def alone(bench):
    """Why some rows have no reference."""
    if "failure" in bench or all("reference" in figure for figure in bench["figures"]):
        return ""
    return f". Without a reference: {bench['alone'] or 'not said'}."


INTRODUCTION = ("Each figure is a median, with least and greatest where there were several runs, then its reference, measured in the "
                "same runs, their ratio (value / reference), and the budget. A note is of the last run. Other work of the machine "
                "shows in the load: the runs themselves bring it to 1 or 2.")


#: What a reader wants first: benchmark and figure.
FIRST = [("planning", "panda, CPU time of a plan"),
         ("planning-upright", "panda, CPU time of a plan"),
         ("collision", "panda, near a start, side by side"),
         ("proof-planning", "furniture, mean"),
         ("inverse", "panda"),
         ("cold-fetch", "500 paths for panda"),
         ("cached-fetch", "30 KB from memory, p50"),
         ("durable-report", "durable reports, 16 clients"),
         ("em", "EM iteration, K = 50, to scikit-learn"),
         ("command", "kinship status, p50")]


def measured(document):
    """Title and figure by benchmark and name."""
    return {(bench["bench"], figure["name"]): (bench["title"], figure)
            for bench in document["benches"] for figure in bench["figures"]}


def first(document):
    """Title and figure of each of FIRST that was measured."""
    found = measured(document)
    return [found[each] for each in FIRST if each in found]


def faults(document):
    """What a report with references must not have: names of FIRST that were not measured by a benchmark which ran, and
    rows without a reference or a reason."""
    found = measured(document)
    return [f"{name} has no figure '{figure}', which report.py puts first" for name, figure in FIRST
            if (name, figure) not in found and name in {bench for bench, _ in found}] + [
        f"{bench['bench']} does not say why '{figure['name']}' has no reference" for bench in document["benches"]
        for figure in bench["figures"] if "reference" not in figure and not bench["alone"]]


def item(figure, title=""):
    """The figure as an item of a list: value; reference; their ratio; budget and verdict. Note."""
    name, value, reference, ratio, limit, kept, note = columns(figure)
    told = [value, reference, f"ratio {ratio}" if ratio else "", f"{limit}: {kept}" if kept else limit]
    return f"- {title}{name}: " + "; ".join(text for text in told if text) + (f". {note}" if note else "") + "\n"


def markdown(document):
    """Lists: names, references and notes are longer than the columns of a table may be."""
    text = "# What was measured\n\nMade by `deploy/bench`; do not edit.\n\n"
    text += "".join(f"- {line}\n" for line in machine(document)) + f"\n{INTRODUCTION}\n\n## Summary\n\n"
    text += "".join(item(figure | {"note": ""}, f"{title}, ") for title, figure in first(document))
    for bench in document["benches"]:
        text += f"\n## {bench['title']}\n\n`deploy/bench {bench['bench']}`: {state(bench)}{alone(bench)}\n\n"
        text += f"FAILED: {bench['failure']}\n" if "failure" in bench else "".join(map(item, bench["figures"]))
    return wrapped(text)


STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 1150px; padding: 0 1em; color: #222; }
table { border-collapse: collapse; width: 100%; } td, th { padding: .3em .6em; text-align: left; vertical-align: top; }
tr { border-bottom: 1px solid #ddd; } h2 { margin: 1.6em 0 0; } p { margin: .3em 0; } .note, .state { color: #666; }
.bar { width: 160px; height: .8em; background: #eee; position: relative; display: inline-block; }
.bar i { position: absolute; left: 0; top: 0; bottom: 0; } .bar b { position: absolute; top: -.2em; bottom: -.2em; width: 2px;
background: #222; } .kept i { background: #3a8f5c; } .missed i { background: #c8553d; }
"""


def bar(figure):
    """How much of the budget is used, where there is one; the mark is the budget."""
    key, of = ("ratio_budget", "ratio") if "ratio_budget" in figure else ("budget", "value")
    limit = figure.get(key)
    if figure["is_kept"] is None or not limit or of not in figure or figure[of]["median"] <= 0:
        return ""
    used = figure[of]["median"] / limit
    if figure["better"] == "higher":
        used = 1 / used
    scale = 100 / max(1.25, used)
    return (f'<span class="bar {verdict(figure)}" title="{100 * used:.0f} % of the budget"><i style="width:{used * scale:.1f}%">'
            f'</i><b style="left:{scale:.1f}%"></b></span> {100 * used:.0f} %')


def html(document):
    parts = ["<!DOCTYPE html><html lang='en'><meta charset='utf-8'><title>Kinship: what was measured</title>",
             f"<style>{STYLE}</style><h1>Kinship: what was measured</h1>"]
    parts += [f"<p>{markup.escape(line)}</p>" for line in machine(document)]
    parts.append(f"<p>{INTRODUCTION} A bar shows how much of its budget a figure uses; the mark is the budget.</p>")
    for bench in document["benches"]:
        parts.append(f"<h2>{markup.escape(bench['title'])}</h2><p class='state'>{markup.escape(state(bench) + alone(bench))}</p>")
        if "failure" in bench:
            parts.append(f"<p class='missed'>FAILED: {markup.escape(bench['failure'])}</p>")
            continue
        headings = HEADINGS[:-1] + ["Of the budget"]
        parts.append("<table><tr>" + "".join(f"<th>{h}</th>" for h in headings) + "</tr>")
        for figure in bench["figures"]:
            cells = [markup.escape(cell) for cell in columns(figure)]
            name = f"{cells[0]}<br><small class='note'>{cells[-1]}</small>"
            parts.append("<tr>" + "".join(f"<td>{c}</td>" for c in [name, *cells[1:-1], bar(figure)]) + "</tr>")
        parts.append("</table>")
    return "\n".join(parts) + "</html>\n"
