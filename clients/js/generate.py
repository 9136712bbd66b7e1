#!/usr/bin/env python3
"""Generates the types of the JavaScript client (types.d.ts) from the contract.

usage: clients/js/generate.py [openapi.yaml] > clients/js/types.d.ts
"""
import json
import pathlib
import re
import sys
import textwrap

import yaml

CONTRACT = pathlib.Path(__file__).resolve().parents[2] / "proto" / "openapi.yaml"
PLAIN = {"integer": "number", "number": "number", "string": "string", "boolean": "boolean", "null": "null"}
TUPLE_MOST = 9
COLUMNS = 100
IDENTIFIER = re.compile(r"[A-Za-z_]\w*")


def comment(schema, indent):
    """Returns the description as a comment: one line, or a block wrapped at COLUMNS."""
    text = " ".join(schema.get("description", "").split()).replace("*/", "* /")
    line = f"{indent}/** {text} */\n"
    if not text or len(line) <= COLUMNS + 1:
        return line if text else ""
    lines = textwrap.wrap(text, COLUMNS - len(indent) - 3, break_long_words=False, break_on_hyphens=False)
    return f"{indent}/**\n" + "".join(f"{indent} * {each}\n" for each in lines) + f"{indent} */\n"


def together(parts, sign):
    parts = list(dict.fromkeys(part for part in parts if part))
    return parts[0] if len(parts) == 1 else "(" + sign.join(parts) + ")" if parts else "unknown"


def object_type(schema, indent):
    properties, required = schema.get("properties", {}), schema.get("required", [])
    extra = schema.get("additionalProperties", True)
    if not properties:
        inner = type_of(extra, indent) if isinstance(extra, dict) else "unknown"
        return f"Record<string, {inner}>"
    deeper = indent + "  "
    lines = ["{\n"]
    for name, value in properties.items():
        key = name if IDENTIFIER.fullmatch(name) else json.dumps(name)
        lines.append(f"{comment(value, deeper)}{deeper}{key}{'' if name in required else '?'}: {type_of(value, deeper)};\n")
    return "".join(lines) + indent + "}"


def array_type(schema, indent):
    item = type_of(schema.get("items", {}), indent)
    size = schema.get("minItems")
    if size and size == schema.get("maxItems") and size <= TUPLE_MOST:
        return "[" + ", ".join([item] * size) + "]"
    return f"{item}[]" if IDENTIFIER.fullmatch(item) or item.startswith("(") else f"Array<{item}>"


def own_type(schema, indent):
    """Returns the schema's type without its allOf, oneOf and anyOf parts; "" if there is none."""
    if "enum" in schema or "const" in schema:
        return together([json.dumps(value) for value in schema.get("enum", [schema.get("const")])], " | ")
    kinds = schema.get("type", "object" if "properties" in schema else [])
    made = []
    for kind in [kinds] if isinstance(kinds, str) else kinds:
        if kind == "object" and not (schema.keys() & {"oneOf", "anyOf", "allOf"} and "properties" not in schema):
            made.append(object_type(schema, indent))
        elif kind == "array":
            made.append(array_type(schema, indent))
        elif kind in PLAIN:
            made.append(PLAIN[kind])
    return together(made, " | ") if made else ""


def reference_type(reference):
    """Returns the name of the type to which a reference points. The reference is to a schema or to
    a property of a schema."""
    name, *inner = reference.removeprefix("#/components/schemas/").split("/")
    return name + "".join(f"[{json.dumps(part)}]" for part in inner if part != "properties")


def type_of(schema, indent=""):
    if "$ref" in schema:
        return reference_type(schema["$ref"])
    parts = [own_type(schema, indent), *(type_of(part, indent) for part in schema.get("allOf", []))]
    for choice in ("oneOf", "anyOf"):
        if choice in schema:
            parts.append(together([type_of(part, indent) for part in schema[choice] if part.keys() != {"required"}], " | "))
    return together([part for part in parts if part != "unknown"], " & ")


def answer_type(operation):
    for status in ("200", "201"):
        content = operation["responses"].get(status, {}).get("content", {})
        if "application/json" in content:
            return type_of(content["application/json"]["schema"], "  ")
    return "unknown"


def print_queries(document, kind, interface):
    """Prints an interface for one kind of surface. Its members are the POST queries that take a
    JSON body."""
    print(f"/** The queries of `/v1/{kind}/{{name}}` by name: request and answer. */\nexport interface {interface} {{")
    for path, item in document["paths"].items():
        before, _, name = path.partition(f"/v1/{kind}/{{name}}/")
        content = item.get("post", {}).get("requestBody", {}).get("content", {})
        if before or not name or "{" in name or "application/json" not in content:
            continue
        print(comment({"description": item["post"]["summary"]}, "  ") + f"  {json.dumps(name)}: {{")
        print(f"    body: {type_of(content['application/json']['schema'], '    ')};")
        print(f"    answer: {answer_type(item['post'])};\n  }};")
    print("}\n")


def main():
    document = yaml.safe_load(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else CONTRACT).read_text())
    print("// generate.py makes this file from proto/openapi.yaml; do not edit it.\n")
    for name, schema in document["components"]["schemas"].items():
        print(f"{comment(schema, '')}export type {name} = {type_of(schema)};\n")
    for kind, interface in (("meshes", "MeshQueries"), ("subdivisions", "SubdivisionQueries"), ("nurbs", "NurbsQueries")):
        print_queries(document, kind, interface)


if __name__ == "__main__":
    main()
