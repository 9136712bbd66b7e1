#!/usr/bin/env python3
"""Generates the types of the Python client's answers (geodesicd/answers.py) from the contract.

usage: clients/python/generate.py [openapi.yaml] > clients/python/geodesicd/answers.py
"""
import json
import pathlib
import sys

import yaml

CONTRACT = pathlib.Path(__file__).resolve().parents[2] / "proto" / "openapi.yaml"
# Types are printed for these schemas and for the objects that they contain.
ROOTS = ["Batch", "Field", "Isoline", "Job", "Mesh", "Result", "Service"]
PLAIN = {"integer": "int", "number": "float", "string": "str", "boolean": "bool", "null": "None",
         "object": "Dict[str, Any]"}


class Types:
    """Prints each object type once, after the types of its members."""

    def __init__(self, schemas):
        self.schemas, self.printed = schemas, set()

    def union(self, parts):
        parts = list(dict.fromkeys(parts))
        return parts[0] if len(parts) == 1 else f"Union[{', '.join(parts)}]"

    def object(self, name, schema):
        if name not in self.printed:
            self.printed.add(name)
            members = {key: self.type(value, name + key.title().replace("_", "")) for key, value in schema["properties"].items()}
            required = {key: members.pop(key) for key in list(members) if key in schema.get("required", [])}
            if required:
                self.print_class(f"_{name}" if members else name, "TypedDict", required)
            if members:
                self.print_class(name, f"_{name}, total=False" if required else "TypedDict, total=False", members)
        return name

    @staticmethod
    def print_class(name, bases, members):
        print(f"\n\nclass {name}({bases}):\n" + "\n".join(f"    {key}: {type}" for key, type in members.items()))

    def type(self, schema, name):
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[1]
            return self.type(self.schemas[name], name)
        if "enum" in schema:
            return f"Literal[{', '.join(json.dumps(value) for value in schema['enum'])}]"
        for choice in ("oneOf", "anyOf", "allOf"):
            if choice in schema and "properties" not in schema:
                return self.union(self.type(part, name) for part in schema[choice])
        if schema.get("properties"):
            return self.object(name, schema)
        if schema.get("type") == "array":
            return f"List[{self.type(schema['items'], name + 'Item')}]"
        kinds = schema.get("type", "any")
        return self.union(PLAIN.get(kind, "Any") for kind in ([kinds] if isinstance(kinds, str) else kinds))


def main():
    document = yaml.safe_load(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else CONTRACT).read_text())
    print('"""Types of the answers. generate.py makes this file from proto/openapi.yaml; do not edit it."""\n'
          "from typing import Any, Dict, List, Literal, TypedDict, Union")
    types = Types(document["components"]["schemas"])
    for root in ROOTS:
        types.type({"$ref": f"#/components/schemas/{root}"}, root)


if __name__ == "__main__":
    main()
