#!/usr/bin/env python3
"""The guard of weigh.py finds a planted heavy header, a planted slow compilation and a planted slow test.

usage: weigh_test.py COMPILER FOLDER
"""
import json
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = """cmake_minimum_required(VERSION 3.25)
project(small LANGUAGES CXX)
enable_testing()
set(timed /usr/bin/time -q -a -o ${CMAKE_BINARY_DIR}/weigh)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/weigh)
set(CMAKE_CXX_COMPILER_LAUNCHER ${timed}/build.log -f "%U %S %C")
add_executable(small small.cpp)
add_test(NAME small COMMAND ${timed}/tests.log -f "%e %U %S cpu small" $<TARGET_FILE:small>)
"""
LIGHT = "#include <cstdio>\nint main() { return std::puts(\"small\") < 0; }\n"
HEAVY = "#include <nlohmann/json.hpp>\n" + LIGHT + "std::string text() { return nlohmann::json::parse(\"[1]\").dump(); }\n"
SLOW = "int main() { for (volatile long k = 0; k < 4000000000; ++k) {} }\n"


def report(compiler, folder, source):
    """What weigh.py says of a small project with that source: its exit code and its text."""
    build = folder / "build"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "CMakeLists.txt").write_text(PROJECT)
    (folder / "small.cpp").write_text(source)
    log = build / "weigh" / "build.log"
    if log.exists():
        log.unlink()
    subprocess.run(["cmake", "-G", "Ninja", "-S", folder, "-B", build, f"-DCMAKE_CXX_COMPILER={compiler}"], check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", build], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ctest", "--test-dir", build], check=True, stdout=subprocess.DEVNULL)
    (build / "weigh" / "units.json").write_text(json.dumps({"compile_s": 1.0, "run_s": 1.0}))
    done = subprocess.run([sys.executable, HERE / "weigh.py", "report", build, "--budget", folder / "budget.json"],
                          capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def check(holds, what):
    if not holds:
        sys.exit(f"weigh_test: {what}")


def main(compiler, folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    budget = folder / "budget.json"
    empty = {"margin": 0.25, "counts": {}}
    budget.write_text(json.dumps(empty))
    code, text = report(compiler, folder, LIGHT)
    check(code == 0 and "entries of the suite of build" in text, f"a budget without figures does not pass: {text}")
    lines = int(next(line for line in text.splitlines() if "reads" in line).split()[-1].replace(",", ""))
    # Seconds of compiling and running that a small program never takes, and that the planted ones do.
    budget.write_text(json.dumps({**empty, "counts": {"lines that the build of build reads": lines},
                                  "build build": {"all": 0.5}, "suite build": {"all": 0.5}}))
    code, text = report(compiler, folder, LIGHT)
    check(code == 0, f"the same project is beyond its own budget: {text}")
    code, text = report(compiler, folder, HEAVY)
    check(code == 1 and "reads: 1" in text, f"a heavy header passes: {text}")
    check("build build, all" in text, f"a slow compilation passes: {text}")
    code, text = report(compiler, folder, SLOW)
    check(code == 1 and "suite build, all" in text, f"a slow test passes: {text}")
    budget.write_text(json.dumps({**empty, "entry margin": 0.5, "entry build": {"cpu": 0.5}}))
    code, text = report(compiler, folder, SLOW)
    check(code == 1 and "entry build, small" in text, f"one slow entry passes: {text}")
    check("raised only by a commit that says why" in text, f"nobody says what to do: {text}")


main(sys.argv[1], Path(sys.argv[2]))
