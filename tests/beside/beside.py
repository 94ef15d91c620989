#!/usr/bin/env python3
"""Runs two builds of popcut beside each other on the same random inputs, and says where they differ.

usage: beside.py OLD NEW [--designs N] [--plans N] [--requests N] [--lines N] [--others N] [--files DIR ...] [--seed S] [--keep DIR]

OLD and NEW are build folders of one compiler, such as build/dev of two checkouts: tours, and the order of GLB accessors,
differ between GCC and clang. For each input both programs must end with the same exit code, write the same files, byte
for byte, and print the same on standard output. Of an error the place (what stands before the second ": ") and all JSON
pointers must be equal; its words may differ, and each pair of words that does is listed once. So are sentences of help
and of JSON, and numbers of JSON files that differ in their last figures. Times that were measured and random identifiers
are left out of the comparison. Requests are made of the description that NEW serves, about what both servers made before.

--lines 0 leaves out command lines, and with them what commands do with each file of --files; --others breaks models of the
first of these folders too.

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


MODELS = {".obj", ".stl", ".glb", ".gltf", ".csv"}


def broken(rng, data):
    """A file of which a few bytes, lines or numbers are changed."""
    if rng.random() < 0.3:
        return data
    if rng.random() < 0.3:
        data = data[:rng.randrange(len(data) + 1)]
    lines = data.split(b"\n")
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(lines))
        move = rng.random()
        if move < 0.3:
            lines[at] = re.sub(rb"-?\d+(\.\d+)?", lambda m: rng.choice([b"0", b"-1", b"99", b"1e30", b"nan", b"x", b"", b"5/1/1", m[0]]),
                               lines[at], count=1)
        elif move < 0.45:
            lines.insert(at, rng.choice([b"", b"# a", b"f 1 2 3", b"f -1 -2 -3", b"v 1 2", b"usemtl a", b"endsolid", b"facet", b"\xff\xfe",
                                         b"vt 0.5 0.5", b"mtllib a.mtl", b"v 1 2 3 0.5 0.5 0.5", b"\t", b"{", b",", b"1,2,3"]))
        elif move < 0.6:
            del lines[at]
            lines = lines or [b""]
        elif move < 0.8:
            lines[at] += rng.choice([b" ", b"\r", b" 1", b" \\", b"/", b",", b"\0"])
        elif lines[at]:
            k = rng.randrange(len(lines[at]))
            lines[at] = lines[at][:k] + bytes([rng.randrange(256)]) + lines[at][k + 1:]
    return b"\n".join(lines)


def random_model(rng, examples):
    """The name and the bytes of a model; examples are files of models."""
    kind = rng.choice(["obj", "stl", "csv", "like", "like"])
    if kind == "like" and examples:
        path = rng.choice(examples)
        return path.name, broken(rng, path.read_bytes())
    x, y, z = (rng.randint(20, 60) for _ in range(3))
    if kind == "csv":
        rows = "\n".join(",".join(str(rng.randint(0, z)) for _ in range(rng.randint(3, 6))) for _ in range(rng.randint(2, 6)))
        points = "".join(f"{i},{j},{rng.randint(0, z)}\n" for i in range(4) for j in range(4))
        return "model.csv", broken(rng, rng.choice([rows, "x,y,z\n" + points, points]).encode())
    corners = [(a, b, c) for a in (0, x) for b in (0, y) for c in (0, z)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    if kind == "stl":
        parts = [part for f in faces for part in (f[:3], (f[0], f[2], f[3]))]
        points = ["".join(f"vertex {' '.join(map(str, corners[k - 1]))}\n" for k in part) for part in parts]
        text = "solid a\n" + "".join(f"facet normal 0 0 0\nouter loop\n{three}endloop\nendfacet\n" for three in points) + "endsolid a\n"
        return "model.stl", broken(rng, text.encode())
    text = "".join(f"v {a} {b} {c}\n" for a, b, c in corners) + "".join("f " + " ".join(map(str, f)) + "\n" for f in faces)
    return "model.obj", broken(rng, text.encode())


def random_others(rng, count, folder):
    """Cuts at once, and what else commands do with drawings, models, programs and specs."""
    examples = [path for path in sorted(folder.rglob("*")) if path.suffix in MODELS and path.stat().st_size < 30000] if folder else []
    out = []
    for k in range(count):
        model, data = random_model(rng, examples)
        surface = {"type": "grid" if model.endswith(".csv") else "mesh", "file": model}
        spec = {"popcut": 1, "surface": surface, "fit": "nearest", "rotate_deg": [90, 0, 90], "slices": 4, "units_per_slice": 3,
                "widths_mm": 8}
        if rng.random() < 0.2:
            spec["style"] = "facets"
        kind = rng.choice(["nak", "pause", "unplug", "short write", "stall", "cancel", "silence", "no marks", "none"])
        faults = {"popcut": 1, "faults": [{"at_byte": rng.randint(0, 900), "kind": kind, "seconds": rng.randint(0, 2)}]}
        program = rng.choice(["IN;SP1;PU0,0;PD400,0,400,400;PU;", "\x1b\x04M100,100\x03D300,300\x03D500,100\x03M0,0\x03",
                              "IN;VS10;FS20;PA100,100;PD;PR50,50;PU;SP0;"])
        files = {"drawing.svg": random_drawing(rng), "spec.json": random_spec(rng), model: data, "mesh.json": json.dumps(spec),
                 "faults.json": json.dumps(faults), "program.plt": broken(rng, program.encode())}
        options = random_plan_options(rng)
        device = rng.choice(["sim:cameo3", "sim:cameo4", "sim:portrait", "sim:hpgl-generic", "sim:none", "file:out.bin"])
        cut = ["cut", "drawing.svg", "--direct", "--yes", "-o", "out", "--device", device, *options]
        out.append((files, [
            cut, [*cut, "--faults", "faults.json"], ["cut", "--test", "--direct", "--yes", "-o", "out", "--device", device],
            ["send", "program.plt", "--device", device, "--yes"],
            ["simulate", "program.plt", "-o", "out"], ["simulate", "program.plt", "-o", "out", "--faults", "faults.json"],
            ["simulate", "program.plt", "--expect", "drawing.svg", "-o", "out"],
            ["verify", "drawing.svg", "--dof", "1"], ["verify", "drawing.svg", "--svg-profile", "origami-sim", "--json"],
            ["verify", "drawing.svg", "--target", "mesh.json"], ["verify", "drawing.svg", "--target", "spec.json", "--json"],
            ["deploy", "drawing.svg", "-o", "out", "--frames", "3", "--glb", "--poster"], ["design", "drawing.svg", "-o", "out"],
            ["compare", "drawing.svg", model, "--no-cost", "--pixels", "64"], ["compare", model, model, "--json", "--pixels", "64"],
            ["compare", model, "mesh.json", "--no-cost", "--json", "--pixels", "64", "-o", "out"],
            ["compare", model, "spec.json", "--no-cost", "--json", "--pixels", "64"],
            ["design", "mesh.json", "-o", "out", "--formats", "fold,report,glb"],
            ["design", "mesh.json", "-o", "out", "--place", "--formats", "fold"],
            ["print", "mesh.json", "-o", "out", "--mode", rng.choice(["surface", "view", "flat"]), "--dpi", "40", *options],
            ["print", "mesh.json", "-o", "out", "--model", model, "--dpi", "40"],
            ["plan", "mesh.json", "-o", "out", *options], ["plan", "spec.json", "-o", "out", *options]][k % 23]))
    return out




def file_inputs(folders):
    """What commands do with the files of folders. A file is read where it lies in a copy of its folder."""
    out = []
    for folder in folders:
        files = {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*")) if path.is_file()}
        models = [name for name in files if Path(name).suffix in MODELS]
        for name in files:
            lines = [["verify", name], ["plan", name, "-o", "out"],
                     ["plan", name, "-o", "out", "--machine", "none", "--mat", "1100x1600", "--overcut", "0", "--no-split"],
                     ["plan", name, "-o", "out", "--folds", "score", "--width", "300"], ["simulate", name, "-o", "out"],
                     ["compare", name, name, "--no-cost", "--json"]]
            if Path(name).suffix in MODELS:
                spec = {"popcut": 1, "surface": {"type": "grid" if name.endswith(".csv") else "mesh", "file": name}, "fit": "nearest",
                        "rotate_deg": [90, 0, 90], "slices": 6, "units_per_slice": 4, "widths_mm": 8}
                made = {"spec-of-file.json": json.dumps(spec)}
                lines += [["compare", name, other, "--no-cost", "--json"] for other in models[:1] + models[-1:]]
                out += [(files | made, ["design", "spec-of-file.json", "-o", "out"]),
                        (files | made, ["design", "spec-of-file.json", "-o", "out", "--place"]),
                        (files | {"spec-of-file.json": json.dumps({**spec, "style": "facets"})}, ["design", "spec-of-file.json", "-o", "out"]),
                        (files | made, ["print", "spec-of-file.json", "-o", "out", "--machine", "cricut-maker", "--mode", "surface", "--dpi",
                                        "50", "--shade", "0", "--model", name])]
            else:
                spec = {"popcut": 1, "style": "facets", "surface": {"type": "outline", "file": name, "depth": 20}}
                out.append((files | {"spec-of-file.json": json.dumps(spec)}, ["design", "spec-of-file.json", "-o", "out"]))
                lines.append(["design", name, "-o", "out"])
                lines.append(["deploy", name, "-o", "out"])
            out += [(files, line) for line in lines]
    return out


# One input, two programs

MEASURED = re.compile(r'"(seconds|elapsed_s|made|created|date)": ?[-0-9.e+"TZ:]+')


def without_times(data):
    try:
        text = data.decode()
    except UnicodeDecodeError:
        return re.sub(rb"/(CreationDate|ModDate) ?\([^)]*\)|/ID ?\[[^\]]*\]", b"", data)
    text = MEASURED.sub(r'"\1": 0', text)
    return re.sub(r"\b\d+(\.\d+)? (ms|s)\b", "N s", text).encode()


def without_words(data):
    """Standard output without its sentences: members of JSON that people read."""
    return re.sub(rb'"(why|text|detail|message)": ?"[^"]*"', rb'"\1": 0', without_times(data))


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
    return {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()}


def relied_on(text):
    """What programs rely on in an error: its place, and the JSON pointers in it."""
    return [(line.split(": ")[:2], re.findall(r"(?<![\w.])/[a-z_][\w/]*", line)) for line in text.splitlines()
            if line.startswith("popcut: ")]


ROUNDING = 1e-6  # of a number in a JSON file; depth images of facets are added in another order


class Comparison:
    def __init__(self):
        self.differences, self.words, self.codes, self.rounding = [], {}, {}, {}

    def add(self, name, old, new, old_files, new_files):
        self.codes[old[0]] = self.codes.get(old[0], 0) + 1
        if old[0] != new[0]:
            self.differences.append(f"{name}: exit {old[0]} became {new[0]}: {old[2].strip()[-200:]} | {new[2].strip()[-200:]}")
            return
        if without_times(old[1]) != without_times(new[1]):
            if "--help" in name or without_words(old[1]) == without_words(new[1]):
                for a, b in zip(old[1].decode().splitlines(), new[1].decode().splitlines()):
                    if a != b and without_times(a.encode()) != without_times(b.encode()):
                        self.words.setdefault(re.sub(r"[-0-9.]+", "N", a)[:300], b[:300])
            else:
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
                    without_words(old_files[file].read_bytes()) != without_words(new_files[file].read_bytes()):
                if file.endswith(".json") and self.is_rounding(file, *(json.loads(without_words(files[file].read_bytes()) or b"0")
                                                                       for files in (old_files, new_files))):
                    continue
                self.differences.append(f"{name}: {file} differs")

    def is_rounding(self, file, old, new, at=""):
        """Whether two JSON values differ in the last figures of numbers only; notes by how much."""
        if isinstance(old, dict) and isinstance(new, dict) and old.keys() == new.keys():
            return all(self.is_rounding(file, old[key], new[key], f"{at}/{key}") for key in old)
        if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
            return all(self.is_rounding(file, a, b, f"{at}/*") for a, b in zip(old, new))
        if old == new or not isinstance(old, float) or not isinstance(new, float):
            return old == new
        share = abs(old - new) / max(abs(old), abs(new))
        place = f"{Path(file).name} {at}"
        if share < ROUNDING:
            self.rounding[place] = max(share, self.rounding.get(place, 0))
        return share < ROUNDING

    def print_differences(self, what, count):
        print(f"{what}: {count} inputs, exit codes {dict(sorted(self.codes.items(), key=str))}, "
              f"{len(self.differences)} differences, {len(self.words)} messages in other words")
        for line in self.differences[:200]:
            print("  " + line)
        for place, share in sorted(self.rounding.items()):
            print(f"  {place}: the same number but for {share:.1g} of it")
        for old, new in list(self.words.items())[:200]:
            print(f"  was: {old}\n  is:  {new}")
        return len(self.differences)


def beside(what, programs, inputs, folder):
    """Runs each input ({file: text or path}, words) with both programs in folders of the same name."""
    result = Comparison()

    def one(item):
        k, (files, words) = item
        runs = []
        for side, program in enumerate(programs):
            here = folder / f"{what}-{k}" / "ab"[side] / "here"
            here.mkdir(parents=True)
            for name, text in files.items():
                (here / name).parent.mkdir(parents=True, exist_ok=True)
                if isinstance(text, Path):
                    (here / name).symlink_to(text)
                else:
                    (here / name).write_bytes(text if isinstance(text, bytes) else text.encode())
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


VARYING = {"next_cursor", "seconds", "elapsed_s", "uptime_s", "etag", "at", "instance", "request_id", "pid", "bytes", "size",
           "free_bytes"}


def plain(value, names):
    """An answer without identifiers and times; identifiers become their order of appearance."""
    if isinstance(value, dict):
        return {plain(key, names): 0 if key in VARYING and not isinstance(child, (dict, list)) else plain(child, names)
                for key, child in value.items()}
    if isinstance(value, list):
        return [plain(child, names) for child in value]
    if isinstance(value, str):
        value = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z", "TIME", value)
        value = re.sub(r"^pc_\w+.*", "SECRET", value)
        return re.sub(r"\b[0-9A-HJKMNP-TV-Z]{12,26}\b", lambda m: names.setdefault(m[0], f"id{len(names)}"), value)
    return value


MODEL = "".join(f"v {x} {y} {z}\n" for x in (0, 30) for y in (0, 40) for z in (0, 20)) + \
    "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"


class Requests:
    """Random requests of the routes of a description: right ones, and ones with wrong members, methods, revisions and
    identifiers. What a server made is named by {kind N}, since its identifier differs from server to server."""

    def __init__(self, rng, description):
        self.rng, self.schemas = rng, description["components"]["schemas"]
        self.routes = [(method.upper(), path, operation) for path, item in description["paths"].items()
                       for method, operation in item.items() if method in ("get", "post", "put", "patch", "delete")]
        self.routes = [route for route in self.routes if "/metrics" not in route[1] and "/db/" not in route[1] and
                       "/pair" not in route[1] and route[1] not in ("/v1/events", "/v1/session/one-shot", "/v1/session")]
        self.made = {}
        self.keys = []

    def name(self, kind):
        """A thing that was made, or one that was not."""
        rng, count = self.rng, self.made.get(kind, 0)
        if count and rng.random() < 0.9:
            return f"{{{kind} {rng.randrange(count)}}}"
        return rng.choice(["none", "1", "01M7YXBY9S18AAAAAAAAAAAAAA", "sha256-aa"])

    def part(self, path, parameter):
        rng, kind = self.rng, path.split("/")[2]
        if parameter == "k":
            return rng.choice(["1", "1", "1", "2", "0", "x"])
        if parameter == "name":
            return rng.choice(["pattern.fold", "pattern.svg", "cut.svg", "segments.csv", "report.json", "deploy.glb", "none"])
        if kind == "devices":
            return rng.choice(["sim:cameo3", "sim:cameo3", "sim:none"])
        if kind == "materials":
            return rng.choice(["paper-220", "mine", "mine", "none", "No%20Name"])
        return self.name(kind)

    def value(self, schema, name=""):
        """A value that a schema allows."""
        rng = self.rng
        if "$ref" in schema:
            schema = self.schemas[schema["$ref"].split("/")[-1]]
        if name in ("design", "plan", "job", "before"):
            return self.name({"design": "designs", "plan": "plans"}.get(name, "jobs"))
        if name == "spec":
            return json.loads(random_spec(rng))
        known = {"device": ["sim:cameo3", "sim:none"], "material": ["paper-220", "paper-80", "none"], "machine": ["cameo3", "none"],
                 "site": ["", "attic"], "sheet": [1, 1, 1, 2], "blank": [1, 2], "like": ["paper-220"],
                 "mat": ["A4", "12x12in", "0x0"], "max_minutes": [0.1], "style": ["lattice"]}
        if name in known:
            return rng.choice(known[name])
        if "enum" in schema:
            return rng.choice(schema["enum"])
        kind = schema.get("type", "object")
        kind = rng.choice(kind) if isinstance(kind, list) else kind
        if kind in ("integer", "number"):
            low = schema.get("minimum", 0)
            high = min(schema.get("maximum", 1000), 1000)
            return rng.choice([low, high, rng.randint(int(low), int(max(low, min(high, 4))))])
        if kind == "boolean":
            return rng.random() < 0.5
        if kind == "string":
            most = schema.get("maxLength", 40)
            return rng.choice(["a", "A4", "0.5", "x" * most, "\u00e9" * (most // 2)])
        if kind == "array":
            return [self.value(schema.get("items", {})) for _ in range(rng.choice([0, 1, 2, schema.get("maxItems", 3)]))]
        if kind == "object":
            properties, need = schema.get("properties", {}), schema.get("required", [])
            out = dict(schema.get("example", {})) if not properties else {}
            for key, child in properties.items():
                if key in need or rng.random() < 2 / max(2, len(properties)):
                    out[key] = self.value(child, key)
            return out
        return None

    def wrong(self, body, schema):
        """The same with one member that is missing, unknown, or has a wrong value."""
        rng = self.rng
        at = rng.choice(places(body) or [("name",)])
        holder = body
        for key in at[:-1]:
            holder = holder[key]
        move = rng.random()
        if move < 0.15 and isinstance(holder, dict):
            holder.pop(at[-1], None)
        elif move < 0.3 and isinstance(holder, dict):
            holder[rng.choice(["nothing", "a/b", "~x", ""])] = 1
        else:
            of = schema.get("properties", {}).get(at[0], {}) if len(at) == 1 else {}
            values = [None, 5, -1, 1.5, 1e300, 2 ** 63, True, "", "x", "x" * 3000, "a\tb", "\x7f", "\u0000", [], {}, [1], {"a": 1}]
            values += [of[key] + step for key in ("minimum", "maximum") if key in of for step in (-1, 0, 1)]
            values += ["x" * (of["maxLength"] + step) for step in (0, 1) if "maxLength" in of]
            holder[at[-1]] = rng.choice(values)
        return body

    def body(self, path, operation):
        rng, content = self.rng, operation["requestBody"]["content"]
        if "octet-stream" in str(content) or path == "/v1/designs":
            kind = rng.choice(["application/json", "image/svg+xml", "model/obj", "application/octet-stream", "text/csv"])
            text = {"application/json": random_spec(rng), "image/svg+xml": random_drawing(rng), "text/csv": "0,0,1\n0,1,2\n1,0,3\n1,1,0\n",
                    "application/octet-stream": "solid\nendsolid"}.get(kind, MODEL)
            if path == "/v1/designs" and rng.random() < 0.5:
                kind, text = "application/json", (ROOT / "examples/unit.json").read_text().replace("30", str(rng.randint(25, 40)))
            return text, kind
        schema = content["application/json"]["schema"]
        schema = self.schemas[schema["$ref"].split("/")[-1]] if "$ref" in schema else schema
        value = self.value(schema)
        if path == "/v1/jobs" and rng.random() < 0.5:
            value = {key: child for key, child in value.items() if key in ("copies", "priority", "name", "note", "tags")}
            value.update({"design": self.name("designs"), "copies": rng.randint(1, 2)})
        if rng.random() < 0.4:
            value = self.wrong(value, schema)
        text = json.dumps(value)
        if rng.random() < 0.05:
            text = rng.choice(["[]", "null", '{"a": {"b": [1, 2', "", '{"a": 1, "a": 2}', "\ufeff{}", "[" * 300])
        return text, rng.choice(["application/json"] * 12 + ["text/plain"])

    def next(self):
        """A method, a path, its body, headers, and what the path names: a revision of it goes into If-Match."""
        rng = self.rng
        weight = [1 if method == "GET" or method == "DELETE" else 6 if "actions" in path or "jobs" in path else 3
                  for method, path, _ in self.routes]
        method, route, operation = rng.choices(self.routes, weight)[0]
        if self.made.get("jobs", 0) < 4 and rng.random() < 0.7:
            first = "/v1/designs" if self.made.get("designs", 0) < 4 else "/v1/jobs"
            method, route, operation = next(r for r in self.routes if r[:2] == ("POST", first))
        path = re.sub(r"\{([^}]*)\}", lambda m: self.part(route, m[1]), route)
        thing = path.split("/actions/")[0] if "/queue/" not in path else None
        names = [p["name"] for p in operation.get("parameters", []) if isinstance(p, dict) and p.get("in") == "query"]
        words = []
        for name in names + ["nothing"]:
            if rng.random() < (0.3 if name != "nothing" else 0.03):
                words.append(name + "=" + rng.choice(["1", "2", "0", "none", "zzz", "", "true", "desc", "ready,done", "2026-11-27", "view"]))
        path += "?" + "&".join(words) if words else ""
        if rng.random() < 0.03:
            method = rng.choice(["PUT", "DELETE", "PATCH", "POST"])
        body, headers = None, {}
        if "requestBody" in operation and method != "GET":
            body, headers["Content-Type"] = self.body(route, operation)
            if rng.random() < 0.9:
                self.keys.append(f"key-of-the-request-{len(self.keys)}")
                headers["Idempotency-Key"] = rng.choice([self.keys[-1]] * 15 + [rng.choice(self.keys), "short"])
        if rng.random() < 0.85:
            headers["If-Match"] = rng.choice(["{rev}"] * 15 + ['"1"', '"99"', "*", "oops", ""])
        return method, path, body, headers, thing


def serve(program, folder):
    folder.mkdir(parents=True)
    path = str(folder / "s")
    (folder / "popcutd.toml").write_text('[[device]]\nid = "sim:cameo3"\ntime_scale = 1000\n'
                                        '[limits]\nrate_per_s = 1000\nrate_burst = 1000\n')
    child = subprocess.Popen([program, "--config", str(folder / "popcutd.toml"), "--state", str(folder / "state"), "--socket", path,
                              "--listen", "127.0.0.1:0"], stdout=subprocess.DEVNULL, stderr=(folder / "log").open("w"))
    for _ in range(600):
        if os.path.exists(path) and child.poll() is None and "serving at" in (folder / "log").read_text():
            return child, path
        time.sleep(0.1)
    sys.exit(f"beside: {program} does not start: {(folder / 'log').read_text()}")


class Server:
    """One popcutd, and what it made, by kind."""

    def __init__(self, path):
        self.path, self.made, self.names = path, {}, {}

    def fill(self, text):
        return re.sub(r"\{(\w+) (\d+)\}", lambda m: self.made[m[1]][int(m[2])], text)

    def ask(self, method, path, body, headers, thing):
        headers = dict(headers)
        if "{rev}" in headers.get("If-Match", ""):
            _, answered, _ = request(self.path, "GET", self.fill(thing), None, {}) if thing else (0, {}, b"")
            headers["If-Match"] = answered.get("etag", "*")
        return request(self.path, method, self.fill(path), self.fill(body).encode() if body is not None else None, headers)

    def settle(self):
        """Waits until nothing plans or cuts."""
        for _ in range(100):
            _, _, data = request(self.path, "GET", "/v1/jobs?limit=200", None, {})
            if not re.search(rb'"state": ?"(queued|planning|running|cutting|pausing|cancelling|starting)"', data):
                return
            time.sleep(0.1)


def problem_places(value):
    return [(error.get("pointer"), error.get("code")) for error in value.get("errors", [])]


def beside_requests(programs, count, rng, folder):
    started = [serve(program, folder / "ab"[side]) for side, program in enumerate(programs)]
    servers = [Server(path) for _, path in started]
    differences, codes, kinds, words = [], {}, {}, {}
    try:
        description = json.loads(request(servers[1].path, "GET", "/v1/openapi.json", None, {})[2])
        source = Requests(rng, description)
        for k in range(count):
            method, path, body, headers, thing = source.next()
            (a, ah, ad), (b, bh, bd) = (server.ask(method, path, body, headers, thing) for server in servers)
            codes[a] = codes.get(a, 0) + 1
            what = f"{method} {path} {headers} {(body or '')[:300]}"
            made = [re.match(r"/v1/(\w+)/([^/]+)$", h.get("location", "")) for h in (ah, bh)]
            if all(made):
                for server, match in zip(servers, made):
                    server.made.setdefault(match[1], []).append(match[2])
                source.made[made[0][1]] = source.made.get(made[0][1], 0) + 1
            elif path.startswith("/v1/assets?") or path == "/v1/assets":
                if method == "POST" and a == b == 201:
                    for server, data in zip(servers, (ad, bd)):
                        server.made.setdefault("assets", []).append(json.loads(data)["id"])
                    source.made["assets"] = source.made.get("assets", 0) + 1
            if method != "GET" and a < 300:
                for server in servers:
                    server.settle()
            leave = {"date", "x-request-id", "content-length", "etag", "location", "last-modified"}
            heads = [{key: value for key, value in h.items() if key not in leave} for h in (ah, bh)]
            if a != b or heads[0] != heads[1]:
                differences.append(f"{what}: {a} {sorted(heads[0].items() - heads[1].items())} became {b} "
                                   f"{sorted(heads[1].items() - heads[0].items())}: {ad[:300]} | {bd[:300]}")
            elif "json" in ah.get("content-type", ""):
                old, new = (plain(json.loads(d or "null"), server.names) for server, d in zip(servers, (ad, bd)))
                if isinstance(old, dict) and "type" in old and "problem" in ah["content-type"]:
                    kinds[old["type"]] = kinds.get(old["type"], 0) + 1
                    if problem_places(old) != problem_places(new):
                        differences.append(f"{what}: {problem_places(old)} became {problem_places(new)}")
                    bare = {"detail": 0, "title": 0, "errors": 0}
                    if old != new and {**old, **bare} == {**new, **bare}:
                        words.setdefault(*(f"{value.get('title')}: {value.get('detail')}"[:300] for value in (old, new)))
                        continue
                if old != new and path.split("?")[0] not in ("/v1/openapi.json", "/v1/meta"):
                    differences.append(f"{what}: {unequal(old, new)}")
            elif ad != bd and without_times(ad) != without_times(bd) and not path.split("?")[0] == "/":
                differences.append(f"{what}: other bytes, {len(ad)} and {len(bd)}")
    finally:
        for child, _ in started:
            child.terminate()
        for child, _ in started:
            child.wait()
    print(f"requests: {count}, answers {dict(sorted(codes.items()))}, problems {kinds}, {len(differences)} differences, "
          f"{len(words)} problems in other words")
    for line in differences[:200]:
        print("  " + line)
    for old, new in words.items():
        print(f"  was: {old}\n  is:  {new}")
    return len(differences)


def unequal(old, new, at=""):
    """The places of two JSON values that differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        return [line for key in sorted(old.keys() | new.keys()) if old.get(key) != new.get(key)
                for line in unequal(old.get(key), new.get(key), f"{at}/{key}")]
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        return [line for k, pair in enumerate(zip(old, new)) for line in unequal(*pair, f"{at}/{k}") if pair[0] != pair[1]]
    return [f"{at}: {json.dumps(old)[:120]} | {json.dumps(new)[:120]}"]


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n")[0])
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    for what, count in (("designs", 2000), ("plans", 5000), ("requests", 300), ("lines", 1), ("others", 1000)):
        parser.add_argument(f"--{what}", type=int, default=count)
    parser.add_argument("--files", type=Path, nargs="*", default=[])
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
    if wanted.files and wanted.lines:
        count += beside("files", tools, file_inputs(wanted.files), folder)
    if wanted.requests:
        count += beside_requests(daemons, wanted.requests, rng, folder / "requests")
    if wanted.others:
        others = random_others(rng, wanted.others, wanted.files[0] if wanted.files else None)
        count += beside("others", tools, others, folder)
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
