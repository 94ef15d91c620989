#!/usr/bin/env python3
"""Runs two builds of popcut beside each other on the same random inputs, and says where they differ.

usage: beside.py OLD NEW [--designs N] [--plans N] [--requests N] [--lines N] [--seed S] [--keep FOLDER]

OLD and NEW are build folders of one compiler, such as build/dev of two checkouts: tours, and the order of GLB accessors,
differ between GCC and clang. For each input both programs must
end with the same exit code, write the same files, byte for byte, and print the same on standard output. Of an error the
place (what stands before the first ": ") and all JSON pointers must be equal; its words may differ, and each pair of
words that does is listed once. Times that were measured and random identifiers are left out of the comparison.

Exit code: 0 without a difference, 1 with one, 2 for wrong arguments.
"""
import argparse
import filecmp
import http.client
import json
import os
import random
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.json"))


# Random inputs

def changed_value(rng, value):
    """A value near to one of a spec, or one that is wrong."""
    if isinstance(value, bool):
        return rng.choice([not value, 1, "yes"])
    if isinstance(value, (int, float)):
        if rng.random() < 0.8:
            return round(value * rng.uniform(0.7, 1.4), 3) if isinstance(value, float) else max(1, value + rng.choice([-1, 0, 1, 2]))
        return rng.choice([round(value * rng.uniform(0.6, 1.5), 3), max(1, int(value + rng.choice([-1, 1, 2]))),
                           0, -value, 1e9, str(value), None])
    if isinstance(value, str):
        return rng.choice([value, value + "x", "", value.replace("sin", "cos"), value.replace("30", "34"), 7])
    if isinstance(value, list):
        return rng.choice([value[:-1], value + value[-1:], [], value[::-1]])
    return rng.choice([{}, None, value])


def places(value, at=()):
    """All places of a JSON value, as tuples of keys."""
    out = [at] if at else []
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else []
    for key, child in children:
        out += places(child, at + (key,))
    return out


def random_spec(rng):
    spec = json.loads(rng.choice(EXAMPLES).read_text())
    if isinstance(spec.get("slices"), int):
        spec["slices"] = min(spec["slices"], rng.randint(2, 12))
    for _ in range(rng.choice([0, 1, 1, 1, 2, 3])):
        at = rng.choice(places(spec))
        holder = spec
        for key in at[:-1]:
            holder = holder[key]
        move = rng.random()
        if move < 0.75:
            holder[at[-1]] = changed_value(rng, holder[at[-1]])
        elif move < 0.85:
            del holder[at[-1]]
        elif isinstance(holder, dict):
            holder[rng.choice(["lattice", "min_panel_mm", "card", "scale_mm", "fit", "colour", "widths_mm"])] = rng.choice(
                ["conformal", "levels", "branching", 0.8, 3, False, {"margin_mm": 8}, {"max_error_mm": 1.5}])
    return json.dumps(spec)


def random_drawing(rng):
    """An SVG with cuts and folds of a few kinds, some of it broken."""
    shapes = []
    for _ in range(rng.randint(1, 12)):
        x, y, w, h = (round(rng.uniform(1, 120), 2) for _ in range(4))
        colour = rng.choice(["#000000", "#ff0000", "#0000ff", "black", "red", "none"])
        name = rng.choice(["cut", "mountain", "valley", "score", "outline", "Folds", ""])
        shape = rng.choice([
            f'<rect x="{x}" y="{y}" width="{w}" height="{h}"/>', f'<circle cx="{x}" cy="{y}" r="{w / 4:.2f}"/>',
            f'<path d="M{x} {y} h{w} v{h} h-{w} z"/>', f'<path d="M{x} {y} C{x + w} {y} {x} {y + h} {x + w} {y + h}"/>',
            f'<line x1="{x}" y1="{y}" x2="{x + w:.2f}" y2="{y + h:.2f}" stroke-dasharray="3 2"/>',
            f'<polyline points="{x},{y} {w},{h} {y},{x}"/>', f'<path d="M{x} {y} L oops"/>'])
        shapes.append(f'<g id="{name}" stroke="{colour}" fill="none">{shape}</g>')
    size = rng.choice(['width="200mm" height="160mm" viewBox="0 0 200 160"', 'width="600mm" height="400mm" viewBox="0 0 600 400"',
                       'viewBox="0 0 200 160"', 'width="200" height="160"'])
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(shapes)}</svg>'


def random_plan_options(rng):
    choices = [
        ["--machine", rng.choice(["cameo3", "cameo4", "portrait", "hpgl-generic", "cricut-maker", "none", "nothing"])],
        ["--material", rng.choice(["paper-220", "pp-150", "paper-80", "vinyl", "stone"])],
        ["--mat", rng.choice(["A4", "12x12in", "300x200", "letter", "roll", "0x0", "A3-landscape"])],
        ["--order", rng.choice(["quick", "keep", "fast"])], ["--seed", str(rng.randint(0, 9))],
        ["--scale", rng.choice(["0.5", "1.2", "0", "2"])], ["--rotate", rng.choice(["90", "-30", "400"])],
        ["--width", rng.choice(["80", "150.5", "0"])], ["--per-sheet", rng.choice(["2", "3", "0"])], ["--mirror"],
        ["--folds", rng.choice(["perforate", "score", "light"])], ["--overcut", rng.choice(["0", "0.5", "11"])],
        ["--direction", rng.choice(["any", "cw", "ccw"])], ["--snap", rng.choice(["0", "0.2"])], ["--no-split"],
        ["--weed-box", "4"], ["--svg-profile", rng.choice(["plain", "popcut", "origami-sim", "lightburn", "cricut"])],
        ["--labels", rng.choice(["auto", "pen", "cut", "none"])], ["--mat-free"], ["--finish", "below"], ["--marks"],
        ["--pen", rng.choice(["cut: force=90 passes=2", "red: speed=20", "cut force"])], ["--at", "5,5"]]
    return [word for option in rng.sample(choices, rng.randint(0, 5)) for word in option]


def command_lines(program):
    """All commands of popcut with and without arguments, right and wrong."""
    text = subprocess.run([program, "--help"], capture_output=True, text=True).stdout
    commands = re.findall(r"^  ([a-z]+)  +[A-Z]", text.split("Subcommands:")[1], re.MULTILINE)
    lines = [[], ["--help"], ["--version"], ["--nothing"], ["nothing"], ["--json", "machines"], ["machines"], ["materials"],
             ["design", "--list"], ["design", "--schema"], ["machines", "cameo3"], ["machines", "nothing"],
             ["materials", "--json"], ["design", "--example", "nothing"]]
    for command in commands:
        lines += [[command, "--help"], [command, "--nothing"], [command, "missing.file"], [command, "--json"]]
    for example in EXAMPLES:
        lines.append(["design", "--example", example.stem])
    return [line for line in lines if line[:1] not in (["open"], ["devices"], ["doctor"], ["calibrate"]) or "--help" in line]


# One input, two programs

MEASURED = re.compile(r'"(seconds|elapsed_s|made|created|date)": ?[-0-9.e+"TZ:]+')


def without_times(data):
    try:
        text = data.decode()
    except UnicodeDecodeError:
        return re.sub(rb"/(CreationDate|ModDate) ?\([^)]*\)|/ID ?\[[^\]]*\]", b"", data)
    text = MEASURED.sub(r'"\1": 0', text)
    return re.sub(r"\b\d+(\.\d+)? (ms|s)\b", "N s", text).encode()


def run(program, words, folder):
    folder.mkdir(parents=True, exist_ok=True)
    env = {"PATH": os.environ["PATH"], "HOME": "/nonexistent", "XDG_RUNTIME_DIR": "/nonexistent", "LC_ALL": "C.UTF-8",
           "POPCUT_URL": "/nonexistent/popcut.sock"}
    try:
        done = subprocess.run([program, *words], cwd=folder, env=env, stdin=subprocess.DEVNULL, capture_output=True, timeout=300)
        return done.returncode, done.stdout, done.stderr.decode(errors="replace")
    except subprocess.TimeoutExpired:
        return "timeout", b"", ""


def files_of(folder):
    return {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*")) if path.is_file()}


def relied_on(text):
    """What programs rely on in an error: its place, and the JSON pointers in it."""
    return [(line.split(": ")[:2], re.findall(r"(?<![\w.])/[a-z_][\w/]*", line)) for line in text.splitlines()
            if line.startswith("popcut: ")]


class Comparison:
    def __init__(self):
        self.differences, self.words, self.codes = [], {}, {}

    def add(self, name, old, new, old_files, new_files):
        self.codes[old[0]] = self.codes.get(old[0], 0) + 1
        if old[0] != new[0]:
            self.differences.append(f"{name}: exit {old[0]} became {new[0]}: {old[2].strip()[-200:]} | {new[2].strip()[-200:]}")
            return
        if without_times(old[1]) != without_times(new[1]):
            self.differences.append(f"{name}: prints something else")
        if relied_on(old[2]) != relied_on(new[2]):
            self.differences.append(f"{name}: another place: {old[2].strip()[:200]} | {new[2].strip()[:200]}")
        elif without_times(old[2].encode()) != without_times(new[2].encode()):
            for a, b in zip(old[2].splitlines(), new[2].splitlines()):
                if a != b:
                    self.words.setdefault(re.sub(r"[-0-9.]+", "N", a), b)
        if old_files.keys() != new_files.keys():
            self.differences.append(f"{name}: other files: {sorted(old_files.keys() ^ new_files.keys())}")
        for file in old_files.keys() & new_files.keys():
            if not filecmp.cmp(old_files[file], new_files[file], shallow=False) and \
                    without_times(old_files[file].read_bytes()) != without_times(new_files[file].read_bytes()):
                self.differences.append(f"{name}: {file} differs")

    def print_differences(self, what, count):
        print(f"{what}: {count} inputs, exit codes {dict(sorted(self.codes.items(), key=str))}, "
              f"{len(self.differences)} differences, {len(self.words)} messages in other words")
        for line in self.differences[:40]:
            print("  " + line)
        for old, new in list(self.words.items())[:200]:
            print(f"  was: {old}\n  is:  {new}")
        return len(self.differences)


def beside(what, programs, inputs, folder):
    """Runs each input ({file: text}, words) with both programs in folders of the same name."""
    result = Comparison()

    def one(item):
        k, (files, words) = item
        runs = []
        for side, program in enumerate(programs):
            here = folder / f"{what}-{k}" / "ab"[side] / "here"
            here.mkdir(parents=True)
            for name, text in files.items():
                (here / name).write_text(text)
            runs.append((run(program, words, here), files_of(here)))
        return f"{what} {k} ({' '.join(words)})", runs[0][0], runs[1][0], runs[0][1], runs[1][1]

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for k, row in enumerate(pool.map(one, enumerate(inputs))):
            before = len(result.differences)
            result.add(*row)
            if len(result.differences) == before:
                shutil.rmtree(folder / f"{what}-{k}", ignore_errors=True)
    return result.print_differences(what, len(inputs))


# Requests

class OverSocket(http.client.HTTPConnection):
    def __init__(self, path):
        super().__init__("localhost")
        self.path = path

    def connect(self):
        self.sock = socket.socket(socket.AF_UNIX)
        self.sock.connect(self.path)


def request(path, method, target, body, headers):
    """Status, headers and body of an answer; a refusal for the rate of requests is no answer."""
    for _ in range(5):
        answer = asked(path, method, target, body, headers)
        if answer[0] != 429:
            break
        time.sleep(1.1)
    return answer


def asked(path, method, target, body, headers):
    connection = OverSocket(path)
    connection.request(method, target, body, headers)
    answer = connection.getresponse()
    data = answer.read()
    return answer.status, {k.lower(): v for k, v in answer.getheaders()}, data


VARYING = {"seconds", "elapsed_s", "uptime_s", "etag", "at", "instance", "request_id", "pid", "bytes", "size", "free_bytes"}


def plain(value, names):
    """An answer without identifiers and times; identifiers become their order of appearance."""
    if isinstance(value, dict):
        return {plain(key, names): 0 if key in VARYING and not isinstance(child, (dict, list)) else plain(child, names)
                for key, child in value.items()}
    if isinstance(value, list):
        return [plain(child, names) for child in value]
    if isinstance(value, str):
        value = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z", "TIME", value)
        return re.sub(r"\b[0-9A-HJKMNP-TV-Z]{12,26}\b", lambda m: names.setdefault(m[0], f"id{len(names)}"), value)
    return value


def requests_of(rng, count, routes):
    """Requests of all routes of the description: right ones, and ones with wrong fields, methods and identifiers."""
    out = []
    bodies = ['{}', '[]', '{"name": 5}', '{"name": "card", "design": "none"}', '{"popcut": 1}', '{"a": {"b": [1, 2', 'null',
              EXAMPLES[0].read_text(), (ROOT / "examples/unit.json").read_text(), '{"reason": "' + "x" * 2000 + '"}']
    for k in range(count):
        method, path = routes[k % len(routes)]
        path = re.sub(r"\{[^}]*\}", lambda _: rng.choice(["none", "1", "01M7YXBY9S18", "sim:cameo3", "paper-220"]), path)
        if rng.random() < 0.4:
            path += rng.choice(["?limit=2", "?limit=none", "?cursor=zzz", "?nothing=1", "?after=0&limit=3"])
        body = rng.choice(bodies) if method in ("POST", "PUT", "PATCH") else None
        headers = {"Content-Type": rng.choice(["application/json", "application/json", "text/plain"])} if body else {}
        if body and rng.random() < 0.8:
            headers["Idempotency-Key"] = f"key-{k}"
        if rng.random() < 0.4:
            headers["If-Match"] = rng.choice(['"1"', "*", "oops"])
        out.append((method, path, body, headers))
    return out


def serve(program, folder):
    folder.mkdir(parents=True)
    path = str(folder / "s")
    (folder / "popcutd.toml").write_text('[[device]]\nid = "sim:cameo3"\ntime_scale = 1000\n')
    child = subprocess.Popen([program, "--config", str(folder / "popcutd.toml"), "--state", str(folder / "state"), "--socket", path,
                              "--listen", "127.0.0.1:0"], stdout=subprocess.DEVNULL, stderr=(folder / "log").open("w"))
    for _ in range(600):
        if os.path.exists(path) and child.poll() is None and "serving at" in (folder / "log").read_text():
            return child, path
        time.sleep(0.1)
    sys.exit(f"beside: {program} does not start: {(folder / 'log').read_text()}")


def beside_requests(programs, count, rng, folder):
    served = [serve(program, folder / "ab"[side]) for side, program in enumerate(programs)]
    differences, codes, words = [], {}, {}
    try:
        description = json.loads(request(served[0][1], "GET", "/v1/openapi.json", None, {})[2])
        routes = [(method.upper(), path) for path, item in description["paths"].items() for method in item
                  if method in ("get", "post", "put", "patch", "delete") and path != "/v1/events"]
        routes = [(m, p if p.startswith("/v1") else "/v1" + p) for m, p in routes if "/metrics" not in p and "/events" not in p]
        names = [{}, {}]
        for method, path, body, headers in requests_of(rng, count, routes):
            answers = [request(served[side][1], method, path, body, headers) for side in (0, 1)]
            (a, ah, ad), (b, bh, bd) = answers
            codes[a] = codes.get(a, 0) + 1
            what = f"{method} {path}"
            if a != b or ah.get("content-type") != bh.get("content-type"):
                differences.append(f"{what}: {a} {ah.get('content-type')} became {b} {bh.get('content-type')}: {ad[:160]} | {bd[:160]}")
            elif "json" in ah.get("content-type", ""):
                old, new = (plain(json.loads(d or "null"), names[side]) for side, d in enumerate((ad, bd)))
                if old != new and isinstance(old, dict) and isinstance(new, dict) and "type" in old:
                    if {**old, "detail": 0, "title": 0, "errors": 0} == {**new, "detail": 0, "title": 0, "errors": 0}:
                        words.setdefault(str(old.get("detail")), str(new.get("detail")))
                        continue
                if old != new and path.split("?")[0] not in ("/v1/openapi.json", "/v1/meta", "/v1/health", "/v1/events"):
                    differences.append(f"{what}: {json.dumps(old)[:300]} | {json.dumps(new)[:300]}")
    finally:
        for child, _ in served:
            child.terminate()
        for child, _ in served:
            child.wait()
    print(f"requests: {count}, answers {dict(sorted(codes.items()))}, {len(differences)} differences, "
          f"{len(words)} problems in other words")
    for line in differences[:40]:
        print("  " + line)
    for old, new in words.items():
        print(f"  was: {old}\n  is:  {new}")
    return len(differences)


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n")[0])
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    for what, count in (("designs", 2000), ("plans", 5000), ("requests", 300), ("lines", 1)):
        parser.add_argument(f"--{what}", type=int, default=count)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path)
    wanted = parser.parse_args()
    tools = [str((build / "daemon/popcut/popcut").resolve(strict=True)) for build in (wanted.old, wanted.new)]
    daemons = [str((build / "daemon/popcutd/popcutd").resolve(strict=True)) for build in (wanted.old, wanted.new)]
    rng = random.Random(wanted.seed)
    folder = wanted.keep or Path(tempfile.mkdtemp(prefix="popcut-beside-"))
    count = 0
    if wanted.lines:
        count += beside("lines", tools, [({}, line) for line in command_lines(tools[0])], folder)
    if wanted.requests:
        count += beside_requests(daemons, wanted.requests, rng, folder / "requests")
    if wanted.plans:
        plans = [({"drawing.svg": random_drawing(rng)}, ["plan", "drawing.svg", "-o", "out", *random_plan_options(rng)])
                 for _ in range(wanted.plans)]
        count += beside("plans", tools, plans, folder)
    if wanted.designs:
        designs = [({"spec.json": random_spec(rng)},
                    ["design", "spec.json", "-o", "out", "--formats", rng.choice(["fold,svg,cut,report", "csv,dxf,report,cricut"])])
                   for _ in range(wanted.designs)]
        count += beside("designs", tools, designs, folder)
    if not count and not wanted.keep:
        shutil.rmtree(folder, ignore_errors=True)
    else:
        print(f"what differs is in {folder}")
    sys.exit(1 if count else 0)


if __name__ == "__main__":
    main()
