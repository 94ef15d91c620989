#!/usr/bin/env python3
"""What popcut weighs: CPU seconds of a build by folder, CPU seconds of the suite by label, lines, and exact counts.

usage: weigh.py reference BUILD          measure the units, and keep them in BUILD/weigh/units.json
       weigh.py report BUILD ... [--budget FILE]
                                         print the weight of each build, and compare it with the budget
       weigh.py lines                    print lines by folder

BUILD is a build folder, such as build/dev. GNU time writes the log files there: BUILD/weigh/build.log, one line for
each compilation, and BUILD/weigh/tests.log, one line for each entry of CTest.

CPU seconds differ by a third from machine to machine, and with what runs beside them. So budgets (budget.json) are in
units: the CPU time that compiling reference_compile.cpp takes for builds, and that running reference_run.cpp takes for
the suite. Both are measured in the same run, as many at once as there are processors.

Exit code: 0 within the budget, 1 beyond it by more than the margin, 2 for wrong arguments.
"""
import json
import os
import re
import statistics
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
ROUNDS = 3


def cpu_seconds(command, **options):
    """User and system seconds of one command and of all its children that it waited for."""
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, **options)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"weigh: {' '.join(map(str, command))} failed with {child.returncode}")
    return usage.ru_utime + usage.ru_stime


def median_cpu(command_of):
    """The median CPU time of a command that runs ROUNDS times on each processor at once."""
    processors = os.cpu_count() or 1
    with ThreadPoolExecutor(processors) as pool:
        times = list(pool.map(lambda k: cpu_seconds(command_of(k)), range(ROUNDS * processors)))
    return statistics.median(times)


def cached(build, name):
    for line in (build / "CMakeCache.txt").read_text().splitlines():
        if line.startswith(name + ":"):
            return line.split("=", 1)[1]
    return ""


def measure_units(build):
    folder = build / "weigh"
    folder.mkdir(exist_ok=True)
    compiler = cached(build, "CMAKE_CXX_COMPILER")
    flags = ["-std=c++20", "-O0", "-isystem", "/usr/include/eigen3"]
    run = folder / "reference_run"
    subprocess.run([compiler, "-std=c++20", "-O1", str(HERE / "reference_run.cpp"), "-o", str(run)], check=True)
    units = {
        "compile_s": median_cpu(
            lambda k: [compiler, *flags, "-c", str(HERE / "reference_compile.cpp"), "-o", str(folder / f"{k}.o")]),
        "run_s": median_cpu(lambda k: [str(run)]),
    }
    (folder / "units.json").write_text(json.dumps(units) + "\n")
    return units


def units_of(build):
    kept = build / "weigh" / "units.json"
    return json.loads(kept.read_text()) if kept.exists() else measure_units(build)


def folder_of(path):
    """The folder of the house that an object or a program belongs to: core/design, daemon/http, tests/unit, ..."""
    parts = path.split("/CMakeFiles/")[0].split("/")
    if path.startswith("CMakeFiles/"):
        return "precompiled headers"
    depth = 3 if parts[:2] == ["core", "design"] else 2
    return "/".join(parts[:depth])


def build_times(build):
    """CPU seconds by what was made; the last time counts for what was made more than once."""
    out = {}
    log = build / "weigh" / "build.log"
    for line in log.read_text(errors="replace").splitlines() if log.exists() else []:
        found = re.match(r"(\d+\.\d+) (\d+\.\d+) .* -o (\S+)", line)
        if found:
            made = found[3].removeprefix(str(build.resolve()) + "/")
            out[made] = float(found[1]) + float(found[2])
    return out


def served_by_ccache(build):
    """How many objects ccache gave back in place of a compilation."""
    log = build / "weigh" / "ccache.log"
    text = log.read_text(errors="replace") if log.exists() else ""
    return len(re.findall(r"^(?:direct|preprocessed)_cache_hit$", text, re.MULTILINE))


def test_times(build):
    """(wall seconds, CPU seconds, label, name) of each entry; the last run counts."""
    out = {}
    log = build / "weigh" / "tests.log"
    for line in log.read_text(errors="replace").splitlines() if log.exists() else []:
        found = re.match(r"(\d+\.\d+) (\d+\.\d+) (\d+\.\d+) (\S+) (.*)", line)
        if found:
            out[found[5]] = (float(found[1]), float(found[2]) + float(found[3]), found[4], found[5])
    return list(out.values())


def inputs_of_objects(build):
    """The files that each compilation of a build read: {object: [file]}, as ninja knows them."""
    deps = subprocess.run(["ninja", "-C", str(build), "-t", "deps"], capture_output=True, text=True, check=True)
    out, current = {}, []
    for line in deps.stdout.splitlines():
        if line.startswith("    "):
            current.append(line.strip())
        elif ": #deps" in line:
            current = out.setdefault(line.split(": #deps")[0], [])
    return out


def lines_compiled(build):
    """Lines of all files that the compilations of a build read.

    A compiler names what a precompiled header holds for each object that uses it. Those lines count once for each
    precompiled header, since the compilation of the object does not read them.
    """
    inputs = inputs_of_objects(build)
    precompiled = {made: set(files) for made, files in inputs.items() if made.endswith((".pch", ".gch"))}
    held = set().union(*precompiled.values()) if precompiled else set()
    lines = {}

    def lines_of(path):
        if path not in lines:
            file = Path(path) if path.startswith("/") else build / path
            is_source = file.suffix not in (".pch", ".gch") and file.is_file()
            lines[path] = sum(1 for _ in file.open("rb")) if is_source else 0
        return lines[path]

    return sum(lines_of(path) for made, files in inputs.items() for path in files
               if made in precompiled or path not in held)


def sources(*patterns):
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z", *patterns], capture_output=True, check=True)
    return [ROOT / name for name in listed.stdout.decode().split("\0") if name and (ROOT / name).is_file()]


def lines_by_folder():
    out = {}
    for file in sources("*.cpp", "*.hpp", "*.ts", "*.mjs", "*.sql", "*.json", "run"):
        parts = file.relative_to(ROOT).parts
        if "corpus" in parts or file.name == "package-lock.json" or parts[0] in ("docs", "examples"):
            continue
        name = "/".join(parts[:2]) if len(parts) > 2 else parts[0]
        kind = "other" if file.suffix not in (".cpp", ".hpp") else "C++"
        out.setdefault(name, {"C++": 0, "other": 0})[kind] += sum(1 for _ in file.open("rb"))
    return out


def long_sleeps():
    """Places in the tests that sleep for a second or more at once."""
    count = 0
    for file in sources("tests/*.cpp", "tests/*.hpp", "tests/*.mjs", "tests/*.py"):
        text = file.read_text(errors="replace")
        count += len(re.findall(r"sleep_for\((?:std::chrono::)?(?:seconds\(|milliseconds\(\d{4,}|\d+s\b|\d{4,}ms\b)", text))
        count += len(re.findall(r"\b(?:sleep|wait_ms|delay)\(\d{4,}\)|\bsleep\([1-9]\d*\);", text))
    return count


def entries(build):
    listed = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1"], capture_output=True, text=True)
    return len(json.loads(listed.stdout)["tests"]) if listed.returncode == 0 else 0


def summed(pairs):
    out = {}
    for name, value in pairs:
        out[name] = out.get(name, 0.0) + value
    return out


class Judge:
    """Compares figures with the budget, prints each, and remembers which are beyond it."""

    def __init__(self, budget):
        self.budget, self.beyond = budget, []

    def judge(self, what, value, allowed, margin, unit=""):
        limit = allowed * (1 + margin)
        if value > limit:
            self.beyond.append(f"{what}: {value:.1f}{unit}, and the budget is {allowed:.1f}{unit}, with margin {limit:.1f}{unit}")

    def times(self, kind, measured, unit_s):
        margin = self.budget["margin"]
        print(f"{'':28}{'CPU s':>9}{'units':>9}{'budget':>9}")
        for name in sorted(measured, key=measured.get, reverse=True):
            value = measured[name] / unit_s
            allowed = self.budget.get(kind, {}).get(name)
            print(f"  {name:26}{measured[name]:9.1f}{value:9.1f}{'' if allowed is None else format(allowed, '9.1f')}")
            if allowed is not None:
                self.judge(f"{kind}, {name}", value, allowed, margin, " units")

    def count(self, name, value):
        allowed = self.budget["counts"].get(name)
        print(f"  {name:46}{value:12,}{'' if allowed is None else format(allowed, '12,')}")
        if allowed is not None:
            self.judge(name, value, allowed, 0.0)


def report_build(judge, build, units):
    times = build_times(build)
    if not times:
        return
    name = build.name
    hits = served_by_ccache(build)
    print(f"\n== build of {name}, by folder (a unit is {units['compile_s']:.2f} s)")
    folders = summed((folder_of(made), seconds) for made, seconds in times.items())
    layers = summed((made.split("/")[0] if "/" in made and not made.startswith("CMakeFiles") else "precompiled headers",
                     seconds) for made, seconds in times.items())
    for folder in sorted(folders, key=folders.get, reverse=True)[:25]:
        print(f"  {folder:26}{folders[folder]:9.1f}")
    if hits:
        print(f"  {hits} objects came from ccache, so the time of this build says nothing, and is not judged")
    else:
        judge.times(f"build {name}", {**layers, "all": sum(layers.values())}, units["compile_s"])


def report_suite(judge, build, units):
    tests = test_times(build)
    if not tests:
        return
    print(f"\n== suite of {build.name}, by label (a unit is {units['run_s']:.2f} s)")
    labels = summed((label, cpu) for _, cpu, label, _ in tests)
    judge.times(f"suite {build.name}", {**labels, "all": sum(labels.values())}, units["run_s"])
    print("  the longest:                  wall s    CPU s")
    for wall, cpu, _, name in sorted(tests, reverse=True)[:10]:
        print(f"  {wall:37.1f}{cpu:9.1f}  {name}")
    # A slow test is small beside the suite: each entry has a budget too, by its label.
    allowed = judge.budget.get(f"entry {build.name}", {})
    for _, cpu, label, name in tests:
        if label in allowed:
            judge.judge(f"entry {build.name}, {name}", cpu / units["run_s"], allowed[label], judge.budget["entry margin"],
                        " units")


def report_lines():
    print("\n== lines by folder                          C++        other")
    folders = lines_by_folder()
    for name in sorted(folders):
        print(f"  {name:36}{folders[name]['C++']:12,}{folders[name]['other']:12,}")
    for layer in ("core", "protocol", "device", "daemon", "tests"):
        here = [lines for name, lines in folders.items() if name.split("/")[0] == layer]
        print(f"  {layer + ', all':36}{sum(h['C++'] for h in here):12,}{sum(h['other'] for h in here):12,}")


def report(builds, budget_file):
    budget = json.loads(budget_file.read_text())
    judge = Judge(budget)
    report_lines()
    for build in builds:
        units = units_of(build)
        report_build(judge, build, units)
        report_suite(judge, build, units)
    print("\n== exact counts                                        now      budget")
    for build in builds:
        judge.count(f"lines that the build of {build.name} reads", lines_compiled(build))
        judge.count(f"entries of the suite of {build.name}", entries(build))
    judge.count("places in tests that sleep a second or more", long_sleeps())
    for line in judge.beyond:
        print(f"weigh: {line}", file=sys.stderr)
    if judge.beyond:
        sys.exit("weigh: make it lighter; a budget in tests/weigh/budget.json is raised only by a commit that says why")


def main(words):
    budget = HERE / "budget.json"
    if words[-2:-1] == ["--budget"]:
        budget = Path(words[-1])
        words = words[:-2]
    if len(words) > 1 and words[0] in ("reference", "report"):
        builds = [Path(word) for word in words[1:]]
        for build in builds:
            if not (build / "CMakeCache.txt").is_file():
                sys.exit(f"weigh: {build} is not a build folder; use: ./run weigh")
        if words[0] == "report":
            report(builds, budget)
        else:
            for build in builds:
                print(f"{build.name}: {measure_units(build)}")
    elif words == ["lines"]:
        report_lines()
    else:
        print(__doc__, file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main(sys.argv[1:])
