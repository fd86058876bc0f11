"""Writes `etendue/types.py` from the JSON schema of scene files: `python write_types.py ../docs/scene.schema.json`."""

import json
import sys
from keyword import iskeyword
from pathlib import Path

PLAIN = {"number": "float", "integer": "int", "string": "str", "boolean": "bool", "null": "None"}


def in_one_line(node):
    """What a node of the schema is, without the breaks of its lines in Rust."""
    return node.get("description", "").replace("\n", " ")


def name_of(reference: str) -> str:
    return reference.rsplit("/", 1)[1]


def kind(node: dict, owner: str) -> str:
    """The type of a node of the schema; objects in it get classes of their own."""
    if "$ref" in node:
        return f'"{name_of(node["$ref"])}"'
    if "const" in node:
        return f"Literal[{json.dumps(node['const'])}]"
    for union in ("oneOf", "anyOf"):
        if union in node:
            return f"Union[{', '.join(kind(option, owner) for option in node[union])}]"
    given = node.get("type")
    if given == "object":
        return f'"{written(node, owner)}"'
    if isinstance(given, list):
        return f"Union[{', '.join(kind({**node, 'type': one}, owner) for one in given)}]"
    if given == "array":
        # An array of one kind is all there is, also where its places have words of their own.
        return f"Sequence[{kind(node.get('items') or node['prefixItems'][0], owner)}]"
    return PLAIN[given]


def written(node: dict, name: str) -> str:
    """Writes the class of an object; returns its name."""
    fields = node.get("properties", {})
    # A variant is an object with one field of its name.
    if len(fields) == 1 and node.get("required") == list(fields):
        name += next(iter(fields))
    needed = node.get("required", [])
    if any(iskeyword(field) for field in fields):
        # What is a keyword of Python cannot be written as a field of a class.
        inner = {field: kind(content, name + "Fields").replace('"', "") for field, content in fields.items()}
        quoted = (f'"{f}": "{k}"' if f in needed else f'"{f}": "NotRequired[{k}]"' for f, k in inner.items())
        classes[name] = f'{name} = TypedDict("{name}", {{{", ".join(quoted)}}})'
        return name
    lines = [f"class {name}(TypedDict):"]
    if "description" in node:
        lines.append(f'    """{in_one_line(node)}"""\n')
    for field, content in fields.items():
        inner = kind(content, name + "Fields")
        lines.append(f"    {field}: {inner}" if field in needed else f"    {field}: NotRequired[{inner}]")
        words = ". ".join(filter(None, [in_one_line(content).rstrip("."), content.get("x-range", "")]))
        if words:
            lines.append(f'    """{words}"""')
    classes[name] = "\n".join(lines)
    return name


classes: dict[str, str] = {}
schema = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
aliases = []
for name, node in sorted(schema["$defs"].items()):
    if node.get("type") == "object" and "oneOf" not in node:
        written(node, name)
    else:
        words = f'\n"""{in_one_line(node)}"""' if "description" in node else ""
        aliases.append(f"{name} = {kind(node, name)}{words}")
written({**schema, "description": "A scene file as a tree."}, "Scene")
text = '''"""The fields of a scene as types: written by `write_types.py` from the JSON schema, as `etendue schema` prints it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, TypedDict, Union

if TYPE_CHECKING:
    from typing_extensions import NotRequired
'''
blocks = ["\n\n\n".join(classes[name] for name in sorted(classes)), *aliases]
out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).with_name("etendue") / "types.py"
out.write_text(text + "\n\n" + "\n\n".join(blocks) + "\n", encoding="utf-8")
