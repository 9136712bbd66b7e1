"""Makes the C code for fields of answers and for parameters of query strings from the contract.

A parameter `select` whose items have `x-fields: {of: Schema}` accepts the names of the schema's
members, in their order. `with: member` names a list whose items have members; the names of these
members follow the list's name. `without` omits names. `expand` writes the names into the document
as an enumeration. In C the names are a list, and each name has a bit.
"""
import re

from document import operations, resolve


def snake(name):
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


def upper(*names):
    return "_".join(snake(name).upper().replace("-", "_") for name in names)


def c_string(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


# --- fields of answers ----------------------------------------------------------------------------


def follow(document, schema):
    """Follows references to a schema. Returns the schema and the name of the last reference."""
    name = None
    while "$ref" in schema or len(schema.get("allOf", [])) == 1:
        schema = schema if "$ref" in schema else schema["allOf"][0]
        if "$ref" in schema:
            name = schema["$ref"].split("/")[-1]
            schema = resolve(document, schema["$ref"])
    return schema, name


def field_names(document, rule):
    names = []
    for name, member in follow(document, {"$ref": f"#/components/schemas/{rule['of']}"})[0]["properties"].items():
        names.append(name)
        if name == rule.get("with"):
            names += follow(document, follow(document, member)[0]["items"])[0]["properties"]
    return [name for name in names if name not in rule.get("without", [])]


def field_lists(document):
    """Yields (name, rule, items) of each parameter that accepts the names of a schema's members."""
    for name, parameter in document["components"]["parameters"].items():
        items = parameter.get("schema", {}).get("items", {})
        if "x-fields" in items:
            yield name.removesuffix("Fields"), items["x-fields"], items


def expand(document):
    """Writes the names of fields into the document."""
    for _, rule, items in field_lists(document):
        items["enum"] = field_names(document, rule)
    return document


def field_header(document):
    yield "/* Made by generate.py from openapi.yaml: fields of answers, as bits of proto_options.fields, and their\n * names, NULL-terminated. */"
    yield "#pragma once\n"
    for name, rule, _ in field_lists(document):
        names = field_names(document, rule)
        yield f"enum proto_{snake(name)}_field {{"
        yield from (f"    PROTO_{upper(name)}_FIELD_{upper(field)} = 1 << {i}," for i, field in enumerate(names))
        yield f"    PROTO_{upper(name)}_FIELD_ALL = (1 << {len(names)}) - 1\n}};"
        yield f"extern const char *const proto_{snake(name)}_fields[];\n"


def field_source(document):
    yield '/* Made by generate.py from openapi.yaml. */\n#include "generated/fields.h"\n\n#include <stddef.h>\n'
    for name, rule, _ in field_lists(document):
        names = "".join(f"    {c_string(field)},\n" for field in field_names(document, rule))
        yield f"const char *const proto_{snake(name)}_fields[] = {{\n{names}    NULL}};\n"


# --- parameters -----------------------------------------------------------------------------------


def query_names(document, item, operation):
    """Returns the operation's query parameters without former names."""
    parameters = [follow(document, parameter)[0] for parameter in [*item.get("parameters", []), *operation.get("parameters", [])]]
    return [parameter["name"] for parameter in parameters if parameter["in"] == "query" and not parameter.get("deprecated")]


def fields_of(document, item, operation):
    """Returns the name of the list of an operation's fields, or None."""
    for parameter in [*item.get("parameters", []), *operation.get("parameters", [])]:
        name = parameter.get("$ref", "").split("/")[-1]
        if name.endswith("Fields") and "x-fields" in follow(document, parameter)[0]["schema"]["items"]:
            return f"proto_{snake(name.removesuffix('Fields'))}_fields"
    return None


def has_lines(document, item, operation):
    """Returns whether `geometry` can omit the points of lines."""
    parameters = [follow(document, parameter)[0] for parameter in [*item.get("parameters", []), *operation.get("parameters", [])]]
    return any(parameter["name"] == "geometry" and "none" in parameter["schema"]["enum"] for parameter in parameters)


def parameter_lists(document):
    """Yields (operation, query parameters) of each operation that has query parameters."""
    for _, item, method, operation in operations(document):
        names = query_names(document, item, operation)
        if names and method != "head":
            yield snake(operation["operationId"]), names


def parameter_words(document):
    """Yields (name, words) of each enumeration among the components' parameters."""
    for name, parameter in document["components"]["parameters"].items():
        if "enum" in parameter.get("schema", {}):
            yield name, parameter["schema"]["enum"]


def parameter_header(document):
    yield "/* Made by generate.py from openapi.yaml: parameters of query strings, and words that they take. All lists\n * are NULL-terminated. */"
    yield "#pragma once\n"
    yield from (f"extern const char *const proto_{name}_parameters[];" for name, _ in parameter_lists(document))
    for name, listed in parameter_words(document):
        yield f"\nenum proto_{snake(name)} {{"
        yield from (f"    PROTO_{upper(name)}_{upper(word)}," for word in listed)
        yield f"}};\nextern const char *const proto_{snake(name)}_words[];"


def parameter_source(document):
    yield '/* Made by generate.py from openapi.yaml. */\n#include "generated/parameters.h"\n\n#include <stddef.h>\n'
    for name, listed in parameter_lists(document):
        yield f"const char *const proto_{name}_parameters[] = {{{', '.join(map(c_string, listed))}, NULL}};"
    for name, listed in parameter_words(document):
        yield f"const char *const proto_{snake(name)}_words[] = {{{', '.join(map(c_string, listed))}, NULL}};"
