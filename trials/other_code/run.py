"""Campaigns whose data another code made, diagnosed by the solver here: run.py OUT SEEDLOOP READER [CAMPAIGN ...]

Runs the decks of `decks.py` for each campaign of `campaigns.toml` at each condition of `conditions.toml`, has the positions read by
the camera and the ruler of the workspace, writes a study for each campaign, has it diagnosed, and prints the tables. Where campaigns
are named, these alone are diagnosed; the data of all are made, for the scatter of a run is pooled over them. Finished runs in OUT are
found again, by the content of their decks. SEEDLOOP and READER are the programs `seedloop` and `read_positions`;
LAMMPS and LIGGGHTS are `lmp` and `liggghts`.
"""
import concurrent.futures
import hashlib
import json
import math
import os
import statistics
import subprocess
import sys
import tomllib

import decks
import tables

HERE = os.path.dirname(os.path.abspath(__file__))
# The declared scenes.
SCENES = os.path.join(HERE, "..", "..", "fixtures", "other-code")
PROGRAMS = {"lammps": ["lmp"], "liggghts": ["liggghts"]}
# Times of turning, over that of `decks.py`, that are tried until the bed is steady.
LONGER = (1, 2, 4)
# Runs at once.
WORKERS = os.cpu_count()


def read_toml(name):
    with open(os.path.join(HERE, name), "rb") as file:
        return tomllib.load(file)


def label(condition):
    return "-".join(str(condition[key]) for key in ("scene", "rpm", "count") if key in condition)


def changes(condition):
    """The condition as settings of the scene."""
    names = {"rpm": "rpm", "count": "seed.0.count"}
    return {names[key]: condition[key] for key in names if key in condition}


def run_other_code(out, reader, campaign, condition, seed):
    """Observables of one run of another code; one whose bed is not steady is done again, and longer."""
    for longer in LONGER:
        files = getattr(decks, campaign["code"])(condition["scene"], condition, campaign["hidden"], seed, longer)
        text = campaign["code"] + "".join(f"{name}\n{text}" for name, text in sorted(files.items()))
        folder = os.path.join(out, "data", hashlib.sha256(text.encode()).hexdigest()[:16])
        result = os.path.join(folder, "observables.json")
        if not os.path.exists(result):
            told = run_deck(folder, files, campaign["code"], reader, condition)
            if "not steady" in told.stderr and longer != LONGER[-1]:
                continue
            if told.returncode != 0:
                raise RuntimeError(f"{folder}: {told.stderr}")
            with open(result, "w") as file:
                file.write(told.stdout)
        with open(result) as file:
            return {name: value["mean"] for name, value in json.load(file).items()}


def run_deck(folder, files, code, reader, condition):
    """Runs a deck, and has its positions read."""
    dump = os.path.join(folder, "bed.dump")
    if not os.path.exists(os.path.join(folder, "done")):
        os.makedirs(folder, exist_ok=True)
        for name, text in files.items():
            with open(os.path.join(folder, name), "w") as file:
                file.write(text)
        with open(os.path.join(folder, "output.log"), "w") as log:
            environment = dict(os.environ, OMP_NUM_THREADS="1")
            command = [*PROGRAMS[code], "-in", "in.deck"]
            subprocess.run(command, cwd=folder, stdout=log, stderr=subprocess.STDOUT, env=environment, check=True)
        open(os.path.join(folder, "done"), "w").close()
    scene = os.path.join(SCENES, condition["scene"] + ".toml")
    settings = [f"{name}={value}" for name, value in changes(condition).items()]
    return subprocess.run([reader, scene, str(decks.INTERVAL_S), dump, *settings], capture_output=True, text=True)


def whole(run, condition, observables):
    """The run, if it gives all that a photo of the condition shows."""
    missing = [name for name in observables[condition["scene"]] if name not in run]
    if missing:
        raise RuntimeError(f"a run at {label(condition)} shows too little of its surface for {', '.join(missing)}")
    return run


def run_here(out, seedloop, condition, seed):
    """Observables of one run of the solver here at the declared values."""
    result = os.path.join(out, "own", f"{label(condition)}-{seed}.json")
    if not os.path.exists(result):
        os.makedirs(os.path.dirname(result), exist_ok=True)
        scene = os.path.join(SCENES, condition["scene"] + ".toml")
        settings = [f"{name}={value}" for name, value in changes(condition).items()]
        command = [seedloop, "simulate", scene, *settings, "--seed", str(seed), "--threads", "1", "--quiet", "--json", result]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(result) as file:
        return {name: value["mean"] for name, value in json.load(file)["observables"].items()}


def pooled_scatter(data, conditions, observables):
    """Standard deviation of a run by condition and observable, over the runs of all campaigns about the mean of each."""
    scatter = {}
    for condition in conditions:
        for name in observables[condition["scene"]]:
            squares, freedom = 0.0, 0
            for runs in (by_condition[label(condition)] for by_condition in data.values()):
                values = [run[name] for run in runs]
                squares += sum((v - statistics.fmean(values)) ** 2 for v in values)
                freedom += len(values) - 1
            scatter[label(condition), name] = math.sqrt(squares / freedom)
    return scatter


def write_study(out, name, measured, scatter, conditions, observables):
    """The study file of a campaign; its path."""
    with open(os.path.join(HERE, "study.toml")) as file:
        text = f'name = "{name}"\n' + file.read().replace("{folder}", os.path.realpath(SCENES))
    for condition in conditions:
        settings = ", ".join(f"\"{key}\" = {value}" for key, value in changes(condition).items())
        text += f'\n[[measured]]\nscene = "{condition["scene"]}"\nrole = "{condition["role"]}"\n'
        text += f"condition = {{ {settings} }}\n"
        runs = measured[label(condition)]
        for observable, reading in observables[condition["scene"]].items():
            mean = statistics.fmean(run[observable] for run in runs)
            # The error of reading is common to all runs of a condition, as that of one camera is.
            sd = math.hypot(scatter[label(condition), observable], reading * math.sqrt(len(runs)))
            text += f"{observable} = {{ mean = {mean:.9g}, sd = {sd:.4g}, n = {len(runs)} }}\n"
    path = os.path.join(out, f"{name}.toml")
    with open(path, "w") as file:
        file.write(text)
    return path


def diagnose(out, seedloop, name, study):
    """The diagnosis of a campaign; all campaigns share the records of runs."""
    folder, runs = os.path.join(out, name), os.path.join(out, "runs")
    os.makedirs(folder, exist_ok=True)
    os.makedirs(runs, exist_ok=True)
    link = os.path.join(folder, "runs")
    if not os.path.lexists(link):
        os.symlink(os.path.join("..", "runs"), link)
    result = os.path.join(folder, "result.json")
    with open(os.path.join(folder, "output.txt"), "w") as output:
        command = [seedloop, "diagnose", study, "--out", folder, "--resume", "--force"]
        # Exit code 1 is an answer.
        if subprocess.run(command, stdout=output, stderr=subprocess.STDOUT).returncode > 1:
            raise RuntimeError(f"the diagnosis of {name} failed: see {folder}/output.txt")
    with open(result) as file:
        return json.load(file)


def main():
    out, seedloop, reader, *wanted = sys.argv[1:]
    out, seedloop, reader = (os.path.abspath(path) for path in (out, seedloop, reader))
    os.makedirs(out, exist_ok=True)
    settings = read_toml("conditions.toml")
    conditions, observables = settings["condition"], settings["observables"]
    campaigns = read_toml("campaigns.toml")["campaign"]
    with concurrent.futures.ThreadPoolExecutor(WORKERS) as pool:
        seeds = lambda first, condition: range(first, first + condition["runs"])
        # Each campaign has seeds of its own.
        other = {
            campaign["name"]: {
                label(c): [
                    pool.submit(run_other_code, out, reader, campaign, c, s)
                    for s in seeds(1000 * sum(map(ord, campaign["name"])), c)
                ]
                for c in conditions
            }
            for campaign in campaigns
        }
        here = {label(c): [pool.submit(run_here, out, seedloop, c, s) for s in range(501, 504)] for c in conditions}
        data, lost = {}, {}
        for name, by_condition in other.items():
            try:
                data[name] = {
                    label(c): [whole(run.result(), c, observables) for run in by_condition[label(c)]] for c in conditions
                }
            except (RuntimeError, subprocess.CalledProcessError) as error:
                lost[name] = str(error)
                print(f"{name} left out: {error}", file=sys.stderr)
        own = {key: [run.result() for run in runs] for key, runs in here.items()}
    scatter = pooled_scatter(data | {"own": own}, conditions, observables)
    with open(os.path.join(out, "agreement.md"), "w") as page:
        page.write(tables.agreement(own, data, scatter, conditions, observables, label))
    rows, smallest = [], {}
    for campaign in campaigns:
        if campaign["name"] not in data or (wanted and campaign["name"] not in wanted):
            continue
        study = write_study(out, campaign["name"], data[campaign["name"]], scatter, conditions, observables)
        result = diagnose(out, seedloop, campaign["name"], study)
        if not campaign["hidden"]:
            smallest[campaign["code"]] = tables.smallest_visible(result)
        rows.append(tables.row(campaign, result, smallest.get(campaign["code"], {})))
        print(rows[-1]["line"], file=sys.stderr, flush=True)
    with open(os.path.join(out, "verdicts.md"), "w") as page:
        page.write(tables.verdicts(rows))
    for name in ("agreement.md", "verdicts.md"):
        with open(os.path.join(out, name)) as page:
            print(page.read())


if __name__ == "__main__":
    main()
