#!/usr/bin/env python3
"""A set with nothing hidden is consistent, and one with a turbulent slip of the pump is named. Sensors are exact here.

check.py GENERATOR SEALWATCH"""
import glob
import json
import subprocess
import sys
import tempfile


def explain(generator, sealwatch, stratum, seed):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([generator, "--stratum", stratum, "--seed", str(seed), "--out", folder,
                        "--sensor-tolerance", "0"], check=True)
        subprocess.run([sealwatch, "explain", "--asset", f"{folder}/asset.yaml", "--fit",
                        *sorted(glob.glob(f"{folder}/fit_*.csv")), "--holdout",
                        *sorted(glob.glob(f"{folder}/holdout_*.csv")), "--out", f"{folder}/report"],
                       check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with open(f"{folder}/truth.json", encoding="utf-8") as truth, \
                open(f"{folder}/report/report.json", encoding="utf-8") as report:
            return json.load(truth), json.load(report)


def main(generator, sealwatch):
    _, report = explain(generator, sealwatch, "null", NULL_SEED)
    misfit = report["fit"]["holdout"]["before"]["noise_normalised_rms"]
    assert report["verdict"] == "consistent" and not report["physics"], report["summary"]
    assert all(0.9 < m < 1.1 for m in misfit.values()), misfit
    truth, report = explain(generator, sealwatch, "catalogue", SINGLE_SEED)
    effect = truth["effects"][0]
    claims = [(c["element"], c["id"]) for c in report["physics"]]
    assert report["verdict"] == "mismatch" and claims == [(effect["element"], effect["law"])], (effect, claims)


NULL_SEED = 1002
SINGLE_SEED = 1002

if __name__ == "__main__":
    main(*sys.argv[1:])
