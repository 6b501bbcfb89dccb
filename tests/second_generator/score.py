#!/usr/bin/env python3
"""Judges `sealwatch explain` on sets of the second generator.

score.py --out DIR [--strata null,catalogue] [--seeds 1-40] [--jobs 1] [--bin sealwatch] [--generator second_generator]
         [--time-limit 60] [--resume] [--sensor-tolerance 0.005]

Writes DIR/scores.tsv, one line a set, and prints a table, one line a stratum. A set that is there is kept as it is with
--resume, else generated and analysed again. Exit status 1 where a set failed.
"""
import argparse
import concurrent.futures
import glob
import json
import os
import shutil
import subprocess
import sys
import time

STRATA = ["null", "null_source", "catalogue", "other_form", "pair", "several", "sensor", "recording", "value",
          "same_element", "change"]
COLUMNS = ["stratum", "seed", "hidden", "status", "verdict", "p_value", "alarm", "claimed", "element_first", "places",
           "law_in_set", "laws_too_many", "value_inside", "R_CL_off", "set_size", "misfit_before", "misfit_after",
           "wall_s", "cpu_s"]
NOT_LAWS = ("datasheet", "between_tests")  # explain says them in words, not as physics


def main():
    options = arguments()
    tasks = [(stratum, seed) for stratum in options.strata for seed in options.seeds]
    os.makedirs(options.out, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        rows = []
        for row in pool.map(lambda task: judge(options, *task), tasks):
            rows.append(row)
            print("\t".join(str(row[c]) for c in COLUMNS), file=sys.stderr, flush=True)
    with open(os.path.join(options.out, "scores.tsv"), "w", encoding="utf-8") as file:
        file.write("\t".join(COLUMNS) + "\n")
        for row in rows:
            file.write("\t".join(str(row[c]) for c in COLUMNS) + "\n")
    print_table(rows)
    return 1 if any(row["status"] not in (0, 1) for row in rows) else 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True)
    parser.add_argument("--strata", type=lambda text: text.split(","), default=STRATA)
    parser.add_argument("--seeds", type=seeds, default=seeds("1-40"), help="A-B or one number")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--bin", default="build/release/bin/sealwatch")
    parser.add_argument("--generator", default="build/release/tests/second_generator/second_generator")
    parser.add_argument("--time-limit", type=float, default=60.0)
    parser.add_argument("--sensor-tolerance", type=float, default=0.005,
                        help="half width within which the sensors' gains and offsets are drawn")
    parser.add_argument("--resume", action="store_true")
    options = parser.parse_args()
    unknown = [s for s in options.strata if s not in STRATA]
    if unknown:
        parser.error(f"no stratum {', '.join(unknown)}: there are {', '.join(STRATA)}")
    return options


def seeds(text):
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def judge(options, stratum, seed):
    folder = os.path.join(options.out, f"{stratum}-{seed}")
    finished = os.path.join(folder, "run.json")
    if not (options.resume and os.path.exists(finished)):
        shutil.rmtree(folder, ignore_errors=True)
        run = analyse(options, stratum, seed, folder)
        with open(finished, "w", encoding="utf-8") as file:
            json.dump(run, file)
    with open(finished, encoding="utf-8") as file:
        run = json.load(file)
    row = dict.fromkeys(COLUMNS, "")
    row.update(stratum=stratum, seed=seed, **run)
    if run["status"] in (0, 1):
        with open(os.path.join(folder, "truth.json"), encoding="utf-8") as file:
            truth = json.load(file)
        with open(os.path.join(folder, "report", "report.json"), encoding="utf-8") as file:
            row.update(score(truth, json.load(file)))
    return row


def analyse(options, stratum, seed, folder):
    """Generates the set and analyses it; exit status, and wall and processor seconds of the analysis."""
    generated = subprocess.run([options.generator, "--stratum", stratum, "--seed", str(seed), "--out", folder,
                                "--sensor-tolerance", str(options.sensor_tolerance)], check=False)
    if generated.returncode != 0:
        os.makedirs(folder, exist_ok=True)
        return {"status": f"generator {generated.returncode}", "wall_s": "", "cpu_s": ""}
    command = [options.bin, "explain", "--asset", f"{folder}/asset.yaml", "--fit", *recordings(folder, "fit"),
               "--holdout", *recordings(folder, "holdout"), "--out", f"{folder}/report",
               "--time-limit", str(options.time_limit)]
    begin = time.monotonic()
    with open(f"{folder}/log.txt", "w", encoding="utf-8") as log:
        child = subprocess.Popen(command, stdout=log, stderr=log)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    return {"status": child.returncode, "wall_s": round(time.monotonic() - begin, 2),
            "cpu_s": round(usage.ru_utime + usage.ru_stime, 2)}


def recordings(folder, kind):
    return sorted(glob.glob(f"{folder}/{kind}_*.csv"))


def score(truth, report):
    """What of the truth the report says. Yes and no are 1 and 0; empty where a question does not arise."""
    hidden = truth["effects"]
    laws = [e for e in hidden if e["element"] not in NOT_LAWS]
    claimed = report["physics"]
    matched = [match(effect, claimed) for effect in laws]
    used = [id(m) for m in matched if m is not None]
    row = {
        "hidden": "+".join(f"{e['element']}:{e['law'] if e['law'] != 'datasheet_value' else e['value']}"
                           for e in hidden) or "nothing",
        "verdict": report["verdict"],
        "p_value": f"{report['p_value']:.2g}",
        "alarm": int(report["p_value"] < 0.01),
        "claimed": "+".join(f"{c['element']}:{c['id']}" for c in claimed) or "nothing",
        "laws_too_many": sum(id(c) not in used for c in claimed),
        "misfit_before": worst(report, "before"),
        "misfit_after": worst(report, "after"),
    }
    if laws and claimed:
        elements = {e["element"] for e in laws}
        row["element_first"] = int(claimed[0]["element"] in elements)
        row["places"] = f"{sum(any(e['element'] in places(c) for c in claimed) for e in laws)}/{len(laws)}"
        row["law_in_set"] = f"{sum(m is not None for m in matched)}/{len(laws)}"
        row["set_size"] = 1 + len(claimed[0]["indistinguishable_from"])
    inside = [value_inside(e, m) for e, m in zip(laws, matched) if m is not None]
    inside = [i for i in inside if i is not None]
    if inside:
        row["value_inside"] = f"{sum(inside)}/{len(inside)}"
    row["R_CL_off"] = seal_off(truth, report)
    return row


def places(claim):
    return [claim["element"], *claim.get("indistinguishable_elements", [])]


def match(effect, claimed):
    """The claim that names the effect's place and, in its set, one of the laws that describe it."""
    names = {effect["law"], *effect["also"]}
    if effect["law"] == "none of the catalogue":
        names.add("unlisted")
    for claim in claimed:
        if effect["element"] in places(claim) and names & {claim["id"], *claim["indistinguishable_from"]}:
            return claim
    return None


def value_inside(effect, claim):
    for parameter in claim["parameters"]:
        if effect["law"] == claim["id"] and effect["parameter"] and parameter["name"] == effect["parameter"]:
            if parameter["std_error"] is None:
                return None
            return int(abs(parameter["value"] - effect["strength"]) <= 1.96 * parameter["std_error"])
    return None


def seal_off(truth, report):
    """By how much R_CL of the last model is off, as a share of the true one."""
    parameters = report["parameters"]
    value = (parameters.get("after") or parameters.get("before") or {}).get("R_CL")
    return "" if value is None else f"{value / truth['R_CL'] - 1:+.3f}"


def worst(report, when):
    """The largest misfit of a held-out channel, in noise standard deviations."""
    rms = (report["fit"]["holdout"].get(when) or {}).get("noise_normalised_rms") or {}
    numbers = [v for v in rms.values() if v is not None]
    return f"{max(numbers):.3g}" if numbers else ""


def print_table(rows):
    print(f"{'stratum':13}{'sets':>5}{'failed':>7}{'consist.':>9}{'mismatch':>9}{'undeterm.':>10}{'alarm':>6}{'claims':>7}"
          f"{'element 1st':>12}{'laws':>8}{'too many':>9}{'values':>8}{'wall s':>8}{'longest':>8}{'cpu s':>7}")
    for stratum in dict.fromkeys(row["stratum"] for row in rows):
        sets = [row for row in rows if row["stratum"] == stratum]
        done = [row for row in sets if row["status"] in (0, 1)]
        if not done:
            print(f"{stratum:13}{len(sets):5d}{len(sets):7d}")
            continue
        verdicts = [sum(row["verdict"] == v for row in done) for v in ("consistent", "mismatch", "undetermined")]
        claims = [row for row in done if row["claimed"] != "nothing"]
        located = [row["element_first"] for row in claims if row["element_first"] != ""]
        wall, cpu = sorted(row["wall_s"] for row in done), sorted(row["cpu_s"] for row in done)
        print(f"{stratum:13}{len(sets):5d}{len(sets) - len(done):7d}{verdicts[0]:9d}{verdicts[1]:9d}{verdicts[2]:10d}"
              f"{sum(row['alarm'] for row in done):6d}{len(claims):7d}{f'{sum(located)}/{len(located)}':>12}"
              f"{fractions(claims, 'law_in_set'):>8}{sum(row['laws_too_many'] > 0 for row in claims):9d}"
              f"{fractions(claims, 'value_inside'):>8}{wall[len(wall) // 2]:8.1f}{wall[-1]:8.1f}{cpu[len(cpu) // 2]:7.1f}")


def fractions(rows, column):
    pairs = [row[column].split("/") for row in rows if row[column]]
    return f"{sum(int(a) for a, _ in pairs)}/{sum(int(b) for _, b in pairs)}"


if __name__ == "__main__":
    sys.exit(main())
