# Draws with ezdxf a file of one DXF version that holds every entity popcut reads, and prints what
# ezdxf makes of it: the lines in their order, with their points. An opinion that is not popcut's.
import json
import math
import sys

try:
    import ezdxf
    from ezdxf import path
except ImportError:
    print("skip: python3-ezdxf is not installed")
    sys.exit(0)

version, file = sys.argv[1], sys.argv[2]
old = version == "R12"
document = ezdxf.new(version, setup=True)
document.header["$INSUNITS"] = 4
space = document.modelspace()
number = 0


def on():
    """A layer of its own for the next entity, so that it can be told."""
    global number
    number += 1
    name = f"E{number:02d}"
    document.layers.add(name) if hasattr(document.layers, "add") else document.layers.new(name)
    return {"layer": name}


space.add_line((1, 2), (30, 40), dxfattribs=on())
space.add_circle((50, 50), 20, dxfattribs=on())
space.add_arc((50, 50), 30, 300, 40, dxfattribs=on())
space.add_arc((10, -20), 3, -30, 30, dxfattribs=on())
space.add_circle((50, 50), 8, dxfattribs={**on(), "extrusion": (0, 0, -1)})
space.add_arc((50, 50), 12, 10, 100, dxfattribs={**on(), "extrusion": (0, 0, -1)})
space.add_arc((50, 50, 5), 12, 10, 100, dxfattribs={**on(), "extrusion": (0, 1, 1)})
bulges = [(0, 0, 0.5), (20, 0, 0), (20, 20, -0.3), (0, 30, 1.0)]
space.add_polyline2d(bulges, format="xyb", dxfattribs=on())
space.add_polyline2d(bulges, format="xyb", close=True, dxfattribs=on())
space.add_polyline3d([(0, 0, 1), (5, 1, 2), (9, 9, 3)], dxfattribs=on())
leaf = document.blocks.new("LEAF", base_point=(1, 1))
leaf.add_line((0, 0), (10, 0))
leaf.add_circle((5, 5), 2)
leaf.add_arc((5, 5), 3, 20, 200)
leaf.add_polyline2d([(0, 0, 1), (4, 0, 0), (4, 4, 0)], format="xyb", close=True)
twig = document.blocks.new("TWIG")
twig.add_blockref("LEAF", (3, 0), dxfattribs={"xscale": 2, "yscale": 2, "rotation": 30})
twig.add_blockref("LEAF", (0, 9), dxfattribs={"xscale": -1})
space.add_blockref("LEAF", (100, 0), dxfattribs={**on(), "rotation": 15})
space.add_blockref("LEAF", (100, 50), dxfattribs={**on(), "xscale": 1.5, "yscale": 0.5,
                                                  "rotation": -40})
space.add_blockref("TWIG", (150, 0), dxfattribs={**on(), "xscale": 1.2, "yscale": -1.2,
                                                 "rotation": 70})
space.add_blockref("LEAF", (20, 90), dxfattribs={**on(), "extrusion": (0, 0, -1), "rotation": 25})
space.add_blockref("LEAF", (200, 0), dxfattribs={**on(), "row_count": 2, "column_count": 3,
                                                 "row_spacing": 30, "column_spacing": 20,
                                                 "rotation": 10})
if not old:
    space.add_lwpolyline(bulges, format="xyb", close=True, dxfattribs=on())
    space.add_lwpolyline(bulges, format="xyb", dxfattribs={**on(), "extrusion": (0, 0, -1)})
    space.add_ellipse((40, 40), (20, 10), 0.4, dxfattribs=on())
    space.add_ellipse((40, 40), (0, 10), 0.7, 1.0, 4.0, dxfattribs=on())
    space.add_ellipse((40, 40), (9, 3), 0.7, 5.0, 1.0,
                      dxfattribs={**on(), "extrusion": (0, 0, -1)})
    control = [(0, 0, 0), (10, 30, 0), (30, -20, 0), (40, 20, 0), (60, 0, 0), (70, 15, 0)]
    space.add_open_spline(control, degree=3, dxfattribs=on())
    space.add_spline(dxfattribs=on()).set_closed(control, degree=3)
    space.add_spline(dxfattribs=on()).set_open_rational(control, [1, 3, 1, 0.5, 2, 1], degree=3)
    space.add_open_spline(control, degree=5, dxfattribs=on())
space.add_text("not cut", dxfattribs=on())
space.add_point((5, 5), dxfattribs=on())
document.saveas(file)
document.saveas(file + ".binary", fmt="bin")


def flat(entities):
    for entity in entities:
        kind = entity.dxftype()
        if kind == "INSERT":
            if entity.mcount > 1:
                for one in entity.multi_insert():
                    yield from flat([one])
            else:
                yield from flat(entity.virtual_entities())
        elif kind not in ("TEXT", "POINT"):
            yield entity


lines = []
for entity in space:
    for part in flat([entity]):
        # 1 um: the reader's own tolerance is 20 um, and what they differ by is measured. A path
        # has Bezier curves in the place of arcs, so only polylines are made one.
        exact = part.dxftype() in ("CIRCLE", "ARC", "ELLIPSE", "SPLINE")
        points = part.flattening(0.001) if exact else path.make_path(part).flattening(0.001)
        points = [[p.x, p.y] for p in points]
        # A stretched polyline with bulges comes apart there; its parts are one line again.
        last = lines[-1] if lines else None
        if (last and last["layer"] == entity.dxf.layer and entity.dxftype() == "INSERT"
                and math.dist(last["points"][-1], points[0]) < 1e-9):
            last["points"] += points[1:]
            continue
        lines.append({"layer": entity.dxf.layer, "type": part.dxftype(), "points": points})
print(json.dumps(lines))
