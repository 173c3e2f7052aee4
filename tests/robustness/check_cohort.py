#!/usr/bin/python3
"""What tests/robustness/cohort.sh looks at.

check_cohort.py expected EXPECTED.tsv COHORT     every good case is done and verified, every bad one failed with its reason
check_cohort.py twice COHORT                     by the journal: cases done more than once, cases without a result
check_cohort.py same COHORT COHORT               the same cases, states and mesh bytes; the same reports but for times and machine
check_cohort.py plain PLAN.json EXPECTED.tsv PROGRAM FOLDER COHORT    the meshes are those of plain calls, byte for byte
check_cohort.py overhead PLAN.json EXPECTED.tsv PROGRAM CASES.csv     batch against a plain loop, and two jobs against one
"""
import collections
import csv
import hashlib
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time


def digest(path):
    return hashlib.sha256(open(path, "rb").read()).hexdigest()


def expectations(path):
    return {r[0]: (r[1], r[2]) for r in csv.reader(open(path), delimiter="\t")}


def state_of(cohort, case):
    done, failed = os.path.exists(f"{cohort}/{case}/done"), os.path.exists(f"{cohort}/{case}.failed/failed.json")
    return "both" if done and failed else "done" if done else "failed" if failed else "missing"


def expected(table, cohort):
    wrong, counts = 0, collections.Counter()
    for case, (kind, part) in expectations(table).items():
        state = state_of(cohort, case)
        problem = ""
        if kind == "good":
            if state != "done":
                problem = state + (": " + json.load(open(f"{cohort}/{case}.failed/failed.json"))["reason"] if state == "failed" else "")
            else:
                report = json.load(open(f"{cohort}/{case}/report.json"))
                files = set(os.listdir(f"{cohort}/{case}"))
                if report["volume"]["closure"] != "verified":
                    problem = "closure is " + report["volume"]["closure"]
                elif files != {"mesh.vtu", "report.json", "report.html", "log.txt", "done"}:
                    problem = "its folder holds " + ", ".join(sorted(files))
        elif state != "failed":
            problem = f"a {kind} case is {state}"
        else:
            reason = json.load(open(f"{cohort}/{case}.failed/failed.json"))["reason"]
            if not reason or "\n" in reason or part not in reason:
                problem = f"a {kind} case fails for '{reason}'"
        counts[kind] += not problem
        if problem:
            wrong += 1
            print(f"  {case}: {problem}")
    print(", ".join(f"{n} {k}" for k, n in sorted(counts.items())) + f"; {wrong} wrong")
    return wrong == 0


def twice(cohort):
    ended = collections.Counter()
    started = collections.Counter()
    for row in csv.reader(open(cohort + "/.cohort/journal.tsv"), delimiter="\t"):
        if row[3] in ("done", "failed", "adopted"):
            ended[row[4]] += 1
        started[row[4]] += row[3] == "started"
    plan = [c["id"] for c in json.load(open(cohort + "/.cohort/plan.json"))["cases"]]
    lost = [c for c in plan if state_of(cohort, c) not in ("done", "failed")]
    more = [c for c, n in ended.items() if n > 1]
    print(f"{len(more)} ended twice, {len(lost)} lost, {sum(started.values())} starts for {len(plan)} cases")
    return not lost and not more


def without_times(report):
    for part in ("stages", "peak_rss_mb", "provenance"):
        report.pop(part, None)
    return report


def same(one, other):
    plan = [c["id"] for c in json.load(open(one + "/.cohort/plan.json"))["cases"]]
    equal = different = failed = 0
    for case in plan:
        states = state_of(one, case), state_of(other, case)
        if states[0] != states[1]:
            print(f"  {case}: {states[0]} here, {states[1]} there")
            different += 1
        elif states[0] == "done":
            reports = [json.dumps(without_times(json.load(open(f"{c}/{case}/report.json")))) for c in (one, other)]
            if digest(f"{one}/{case}/mesh.vtu") == digest(f"{other}/{case}/mesh.vtu") and reports[0] == reports[1]:
                equal += 1
            else:
                print(f"  {case}: other bytes")
                different += 1
        else:
            failed += 1
    print(f"{equal} equal, {failed} failed in both, {different} different")
    return different == 0


def words(case, options):
    found = ["--threads", "1", "--progress", "none"]
    for o in options:
        found += ["--" + o["name"] + "=" + v for v in o["values"]] or ["--" + o["name"]]
    return found


def calls(plan, table, program, folder, cohort_plan, count=None):
    """The plain commands of the good cases."""
    kinds = expectations(table)
    options = {c["id"]: c["options"] for c in json.load(open(cohort_plan))["cases"]}
    good = [c for c in json.load(open(plan))["cases"] if kinds[c["id"]][0] == "good"][:count]
    for c in good:
        out = f"{folder}/{c['id']}"
        own = [o for o in options[c["id"]] if o["name"] != "threads"]
        yield c["id"], out, [program, "mesh", *c["inputs"], "-o", out + "/mesh.vtu", "--report", out + "/report.json", "--report", out + "/report.html", *words(c, own)]


def plain(plan, table, program, folder, cohort):
    equal = different = 0
    waiting = list(calls(plan, table, program, folder, cohort + "/.cohort/plan.json"))
    running = []
    while waiting or running:
        while waiting and len(running) < 2:
            case, out, command = waiting.pop(0)
            if not os.path.exists(out + "/mesh.vtu"):
                os.makedirs(out, exist_ok=True)
                running.append(subprocess.Popen(command, stdout=subprocess.DEVNULL))
        running = [r for r in running if r.poll() is None]
        time.sleep(0.02)
    for case, out, _ in calls(plan, table, program, folder, cohort + "/.cohort/plan.json"):
        if state_of(cohort, case) == "done" and digest(out + "/mesh.vtu") == digest(f"{cohort}/{case}/mesh.vtu"):
            equal += 1
        else:
            print(f"  {case}: other bytes")
            different += 1
    print(f"{equal} equal, {different} different")
    return different == 0


def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def overhead(plan, table, program, manifest, count=12, rounds=3):
    """In turn, so that both see the same load; CPU time of all processes, as wall time tells of other users, too."""
    kinds = expectations(table)
    ids = [i for i in kinds if kinds[i][0] == "good"][:count]
    figures = collections.defaultdict(lambda: [0.0, 0.0])
    for _ in range(rounds):
        for what in ("loop", "one", "two"):
            folder = tempfile.mkdtemp()
            wall, used = time.time(), cpu()
            if what == "loop":
                script = ""
                for case, out, command in calls(plan, table, program, folder, "run/.cohort/plan.json", count):
                    script += f"mkdir '{out}'; " + " ".join("'" + w + "'" for w in command) + f" >'{out}/log.txt' 2>&1\n"
                subprocess.run(["bash", "-c", script], check=True)
            else:
                subprocess.run([program, "batch", manifest, "-o", folder + "/cohort", "--no-page", "--quiet", "--jobs", "1" if what == "one" else "2", "--only", ",".join(ids), "--", "--threads", "1"],
                               stdout=subprocess.DEVNULL, check=True)
            figures[what][0] += time.time() - wall
            figures[what][1] += cpu() - used
            shutil.rmtree(folder)
    n, (loop, one, two) = rounds * count, (figures[w] for w in ("loop", "one", "two"))
    print(f"plain loop, s of CPU and wall for {n} cases\t{loop[1]:.1f}, {loop[0]:.1f}")
    print(f"batch --jobs 1, s of CPU and wall\t{one[1]:.1f}, {one[0]:.1f}")
    print(f"batch --jobs 2, s of CPU and wall\t{two[1]:.1f}, {two[0]:.1f}")
    print(f"overhead of batch over the loop, CPU\t{100 * (one[1] / loop[1] - 1):.1f} %")
    print(f"overhead of batch over the loop, wall\t{100 * (one[0] / loop[0] - 1):.1f} %")
    print(f"two jobs against one, wall\t{one[0] / two[0]:.2f} (load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores)")
    return True


if __name__ == "__main__":
    parts = {"expected": expected, "twice": twice, "same": same, "plain": plain, "overhead": overhead}
    if len(sys.argv) < 2 or sys.argv[1] not in parts:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(0 if parts[sys.argv[1]](*sys.argv[2:]) else 1)
