# Reads a DXF with ezdxf and prints what it holds as JSON: an opinion that is not popcut's.
import json
import sys

try:
    import ezdxf
    from ezdxf import bbox
except ImportError:
    print("skip: python3-ezdxf is not installed")
    sys.exit(0)

document = ezdxf.readfile(sys.argv[1])
auditor = document.audit()
space = document.modelspace()
extents = bbox.extents(space)
layers = {}
for line in space:
    assert line.dxftype() == "LINE", line.dxftype()
    layers[line.dxf.layer] = layers.get(line.dxf.layer, 0) + 1
print(json.dumps({
    "errors": len(auditor.errors),
    "version": document.dxfversion,
    "units": document.header.get("$INSUNITS", 0),
    "min": list(extents.extmin)[:2],
    "max": list(extents.extmax)[:2],
    "header_min": list(document.header["$EXTMIN"])[:2],
    "header_max": list(document.header["$EXTMAX"])[:2],
    "colours": {layer.dxf.name: layer.dxf.color for layer in document.layers},
    "lines": layers,
}))
