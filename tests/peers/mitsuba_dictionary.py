"""Mitsuba 3's own Cornell box, which is a dictionary in its Python package, as a scene file.

usage: mitsuba_dictionary.py FILE.xml     then: mitsuba_pictures.py ETENDUE FILE.xml
"""
import sys
import mitsuba as mi, numpy as np
from xml.sax.saxutils import quoteattr

mi.set_variant("scalar_rgb")
KINDS = {"path": "integrator", "perspective": "sensor", "hdrfilm": "film", "independent": "sampler", "diffuse": "bsdf", "area": "emitter",
         "rectangle": "shape", "cube": "shape", "gaussian": "rfilter"}


def element(name, value, depth):
    """The XML of one entry."""
    pad, of = "  " * depth, quoteattr(name)
    if isinstance(value, bool):
        return f'{pad}<boolean name={of} value="{str(value).lower()}"/>'
    if isinstance(value, (int, float)):
        kind = "integer" if isinstance(value, int) else "float"
        return f'{pad}<{kind} name={of} value="{value}"/>'
    if isinstance(value, str):
        return f"{pad}<string name={of} value={quoteattr(value)}/>"
    if not isinstance(value, dict):
        rows = " ".join(repr(float(x)) for x in np.array(value.matrix).ravel())
        return f'{pad}<transform name={of}><matrix value="{rows}"/></transform>'
    if value["type"] == "ref":
        return f"{pad}<ref id={quoteattr(value['id'])}/>"
    if value["type"] == "rgb":
        rgb = " ".join(str(x) for x in np.atleast_1d(value["value"]))
        return f'{pad}<rgb name={of} value="{rgb}"/>'
    kind = KINDS[value["type"]]
    inside = [element(k, v, depth + 1) for k, v in value.items() if k != "type"]
    return "\n".join([f"{pad}<{kind} type={quoteattr(value['type'])} id={of}>", *inside, f"{pad}</{kind}>"])


scene = mi.cornell_box()
parts = [element(name, value, 1) for name, value in scene.items() if name != "type"]
with open(sys.argv[1], "w") as file:
    file.write("\n".join(['<scene version="3.0.0">', *parts, "</scene>\n"]))
