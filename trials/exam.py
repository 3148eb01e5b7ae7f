"""Runs the loop on measured data sets about which a fact is known, and compares its answers with this fact.

Usage: python3 exam.py [SET ...]

Runs the named sets (by default all) in out/exam/SET. Finished runs are reused, so a set can be interrupted and resumed.
The answer of a set is kept with its date and command in docs/exam/SET.json. docs/exam.md is made from all these files.
`page` as the only SET makes only the page.
"""

import datetime
import json
import pathlib
import resource
import subprocess
import sys

from runs import program

KEPT = pathlib.Path("docs/exam")
PAGE = pathlib.Path("docs/exam.md")
WORK = pathlib.Path("out/exam")

# Sets of beads ask for many runs of the same dry columns; they keep them in one folder.
BEADS = "water-beads-runs"

# Name: what is measured, what is known and kept from the file, the right answer (an effect, or "none"), the command and its
# study, the folder of shared runs.
SETS = {
    "cotton": (
        "cotton seeds: ten bench values and the drum",
        "each seed is one body",
        "whole-seed-damping",
        ["calibrate", "fixtures/cotton/study.toml"],
        None,
    ),
    "beads-dry": (
        "dry beads, 4 and 8 mm",
        "nothing",
        "none",
        ["diagnose", "fixtures/water-beads/dry.toml"],
        BEADS,
    ),
    **{
        f"beads-{content}": (
            f"beads, 4 and 8 mm, {content} % of water",
            "the water",
            "liquid-bridges",
            ["diagnose", f"fixtures/water-beads/wet-{content}.toml"],
            BEADS,
        )
        for content in (1, 3, 5)
    },
    "beads-3-rolling": (
        "the same at 3 %, rolling friction a free parameter",
        "the water",
        "liquid-bridges",
        ["diagnose", "fixtures/water-beads/wet-3-rolling.toml"],
        BEADS,
    ),
    "beads-3-declared": (
        "the same at 3 %, water declared",
        "more bulk than dry, as the areas showed afterwards",
        "seed-count",
        ["diagnose", "fixtures/water-beads/wet-3.toml", "--profile", "declared"],
        BEADS,
    ),
    **{
        f"beads-{content}-filling": (
            f"the same at {content} %, filling uncertain",
            "the water",
            "liquid-bridges",
            ["diagnose", f"fixtures/water-beads/wet-{content}-filling.toml"],
            BEADS,
        )
        for content in (1, 3, 5)
    },
}

# Sets whose effects were not searched, with the reason.
LEFT_OUT = {
    "cellulose spheres in a drum": "two values for two parameters; [calibrated](real-data.md)",
    "plastic spheres in a slot hopper": "[fitted](../fixtures/slot-hopper/README.md); effects would take hours",
}


def command(name):
    """The command of a set, as words."""
    return [*SETS[name][3], "--resume", "--out", str(WORK / name)]


def run(seedloop, name):
    """Runs a set and keeps its answer. Exit code 1 is an answer too."""
    folder, shared = WORK / name, SETS[name][4]
    folder.mkdir(parents=True, exist_ok=True)
    if shared and not (folder / "runs").exists():
        (WORK / shared).mkdir(exist_ok=True)
        (folder / "runs").symlink_to(pathlib.Path("..") / shared)
    try:
        code = subprocess.run([seedloop, *command(name)], check=False).returncode
    finally:
        count_time(folder)
    if code not in (0, 1):
        sys.exit(f"{name}: seedloop ended with {code}; `{' '.join(command(name))}` resumes it")
    result = json.loads((folder / "result.json").read_text())
    KEPT.mkdir(exist_ok=True)
    answer = answer_of(name, result)
    (KEPT / f"{name}.json").write_text(json.dumps(answer, indent=1) + "\n")


def count_time(folder):
    """Adds the processor time of the last program to that of the calls before."""
    kept = folder / "cpu_s"
    before = float(kept.read_text()) if kept.exists() else 0.0
    now = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    kept.write_text(str(before + now - count_time.counted))
    count_time.counted = now


count_time.counted = 0.0


def answer_of(name, result):
    """What the page needs of a result."""
    stage = result["diagnosis"]
    study = stage if stage["state"] == "done" else None
    models = [study["after"], *study["rivals"]] if study else []
    return {
        "date": datetime.date.today().isoformat(),
        "command": "seedloop " + " ".join(command(name)),
        "version": result["version"],
        "met": result.get("met"),
        "cpu_s": float((WORK / name / "cpu_s").read_text()),
        "reason": stage.get("reason"),
        "verdict": study and study["diagnosis"]["verdict"],
        "effects": study and study["diagnosis"]["effects"],
        "suspects": study and study["diagnosis"]["suspects"],
        "p": study and study["diagnosis"]["structured_residual"]["p"],
        "fitted": study and study["fitted"],
        "errors_before": study and study["errors_before"],
        "models": [
            {key: model[key] for key in ("effects", "estimates", "fitted", "errors")} for model in models if model
        ],
    }


def mark(right, answer):
    """How an answer stands to the right one."""
    verdict, names = answer["verdict"], answer["effects"] or []
    if verdict in (None, "refused", "not-testable"):
        return "no answer"
    if verdict in ("unknown", "recheck"):
        return "unknown"
    if verdict == "none":
        return "right" if right == "none" else "missed"
    if right not in names:
        return "**wrong name**"
    return "right" if len(names) <= 2 else f"open: a tie of {len(names)}"


def words(answer):
    """The answer as people read it."""
    if answer["verdict"] is None:
        state = {True: "met", False: "not met", None: ""}[answer["met"]]
        return f"{state}; no diagnosis"
    names = answer["effects"] or answer["suspects"] or []
    said = answer["verdict"] if answer["verdict"] != "named" else ""
    help_of = " (would help: " if not answer["effects"] and names else " "
    return f"{said}{help_of}{', '.join(names)}{')' if help_of.startswith(' (') else ''}".strip()


def minutes(cpu_s):
    """Processor minutes; nothing where other work hid them."""
    return f"{cpu_s / 60.0:.1f}" if cpu_s else ""


def kept_error(answer):
    """Mean square over noise on kept values, before and with the best model."""

    def value(errors):
        kept = errors["kept"] if errors["kept"] else errors["used"]
        return f"{kept['whitened_mse']:.1f}" + ("" if errors["kept"] else " (fit)")

    if not answer["errors_before"]:
        return ""
    # Of an unknown answer, that of the suspect.
    suspected = [model for model in answer["models"] if set(model["effects"]) <= set(answer["suspects"] or [])]
    models = suspected or answer["models"]
    after = f", {value(models[0]['errors'])}" if models else ""
    return value(answer["errors_before"]) + after


def lines(texts):
    """One text a line."""
    return "\n".join(texts)


def page():
    """The page of all that is kept."""
    rows = []
    for name, (what, hidden, right, _, _) in SETS.items():
        file = KEPT / f"{name}.json"
        if not file.exists():
            rows.append(f"| {what} | {hidden} | {right} | no answer yet | | | | |")
            continue
        answer = json.loads(file.read_text())
        rows.append(
            f"| {what} | {hidden} | {right} | {words(answer)} | {mark(right, answer)} | {kept_error(answer)} | "
            f"{minutes(answer['cpu_s'])} | {answer['date']} |"
        )
    rows += [f"| {what} | | | no diagnosis: {why} | | | | |" for what, why in LEFT_OUT.items()]
    text = f"""# The exam

This page compares the answers of the diagnosis with known facts about published data (`just exam`). [exam](exam)
has the whole answers. A wrong name is worse than `unknown`. Error: mean square over noise on values
outside the fit, without and with the effect. Time: processor minutes, except runs shared with sets above.

| set | hidden from the study | right | answer | | error | time | date |
|---|---|---|---|---|---|--:|---|
{lines(rows)}
"""
    PAGE.write_text(text)


def main():
    """Runs what is named, then writes the page."""
    names = sys.argv[1:]
    unknown = [name for name in names if name not in SETS and name != "page"]
    if unknown:
        sys.exit(f"unknown set {unknown[0]}; expected one of {', '.join(SETS)}, or page")
    asked = [name for name in names or SETS if name != "page"]
    seedloop = asked and program("seedloop")
    for name in asked:
        run(seedloop, name)
    page()


if __name__ == "__main__":
    main()
