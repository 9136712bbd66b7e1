#!/usr/bin/env python3
"""Makes what the daemon compiles in from the contract, openapi.yaml. Output is the same for the same input.

    generate.py routes openapi.yaml              the route table, C, for proto/http/route.h
    generate.py handlers openapi.yaml            the handlers' declarations, C, for server/query/handlers.h
    generate.py assets openapi.yaml [folder...]  openapi.json and the files below the folders, C, for proto/http/asset.h
    generate.py check openapi.yaml problem.h     nothing but complaints; exit status 1 if there are any

Each of them refuses a document that breaks a rule of check_document.
"""
import gzip
import hashlib
import json
import pathlib
import re
import sys

import yaml

METHODS = ("get", "put", "post", "delete")  # what the table knows; head is answered wherever get is
MAX_SEGMENTS = 6  # PROTO_ROUTE_SEGMENTS
MAX_CAPTURES = 2  # PROTO_ROUTE_CAPTURES
IDENTIFIER = re.compile(r"[a-z][a-z0-9_]*")
# queries about meshes with handlers of their own
OWN_HANDLERS = {"batch", "picture_png", "picture_svg", "get_mesh_parameters", "get_mesh_places"}
CAPTURE = re.compile(r"\{([a-z_]+)\}")
PREFER = {"$ref": "#/components/parameters/Prefer"}
ROLES = ("read", "write")  # of keys, as the security requirements name them

MEDIA_TYPES = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".ico": "image/x-icon",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
    ".wasm": "application/wasm",
    ".webp": "image/webp",
    ".woff2": "font/woff2",
}

# What a page may load: its own files; Swagger UI's style has its icons as data, and it shows pictures that were answered as blobs.
PAGE_POLICY = "default-src 'self'; object-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
POLICIES = {"/docs/": PAGE_POLICY + "; img-src 'self' data: blob:"}


# --- the document ---------------------------------------------------------------------------------------------------


class UniqueKeyLoader(yaml.SafeLoader):
    """YAML lets a key stand twice and keeps the last one; here that is a mistake."""


def construct_unique_mapping(loader, node):
    keys = [loader.construct_object(key, deep=True) for key, _ in node.value]
    for key in keys:
        if keys.count(key) > 1:
            raise yaml.constructor.ConstructorError(None, None, f"the key {key!r} stands twice", node.start_mark)
    return yaml.SafeLoader.construct_mapping(loader, node, deep=True)


UniqueKeyLoader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, construct_unique_mapping)


def load_document(path):
    with open(path, encoding="utf-8") as file:
        return yaml.load(file, Loader=UniqueKeyLoader)


def operations(document):
    """(path, path item, method, operation) of each operation in the order of the document, head included."""
    for path, item in document["paths"].items():
        for method in (*METHODS, "head"):
            if method in item:
                yield path, item, method, item[method]


def segments(path):
    return path[1:].split("/") if path != "/" else []


def values(node, place="#"):
    """(place, value) of every value in the document."""
    yield place, node
    pairs = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in pairs:
        yield from values(value, f"{place}/{str(key).replace('~', '~0').replace('/', '~1')}")


def resolve(document, reference):
    """The value that a reference within the document points at; LookupError if there is none."""
    if not reference.startswith("#/"):
        raise LookupError(reference)
    node = document
    for part in reference[2:].split("/"):
        node = node[part.replace("~1", "/").replace("~0", "~")]
    return node


# --- its rules ------------------------------------------------------------------------------------------------------


def check_references(document):
    used = set()
    for place, value in values(document):
        if not isinstance(value, dict) or not isinstance(value.get("$ref"), str):
            continue
        used.add(value["$ref"])
        try:
            resolve(document, value["$ref"])
        except LookupError:
            yield f"{place}: {value['$ref']} does not exist"
        if "/properties/" in value["$ref"]:
            yield f"{place}: {value['$ref']} points into a schema, which code generators refuse; name the part"
    for kind, components in document["components"].items():
        for name in components:
            if f"#/components/{kind}/{name}" not in used and kind != "securitySchemes":  # those are named, not referenced
                yield f"#/components/{kind}/{name} is not used"


def check_enumerations(document):
    """YAML 1.1 reads the bare words off, on, yes and no as booleans."""
    for place, value in values(document):
        if isinstance(value, dict) and value.get("type") == "string":
            for word in [*value.get("enum", []), *([value["const"]] if "const" in value else [])]:
                if not isinstance(word, str):
                    yield f"{place}: {word!r} is no string; quote it"


def reachable(document, node, found):
    """Adds the schemas that the node refers to, directly or not, to `found`: reference to schema."""
    for _, value in values(node):
        reference = value.get("$ref") if isinstance(value, dict) else None
        if isinstance(reference, str) and reference not in found:
            found[reference] = resolve(document, reference)
            reachable(document, found[reference], found)
    return found


def object_schemas(nodes):
    for place, node in nodes.items():
        for inner, value in values(node, place):
            if isinstance(value, dict) and "object" in value.get("type", "") and "properties" in value:
                yield inner, value


def check_objects(document):
    """Requests are closed: an unknown member is refused. Answers are open: a new member breaks no client."""
    requests, answers = {}, {}
    for path, item, method, operation in operations(document):
        place = f"{method} {path}"
        requests[place] = [item.get("parameters", []), operation.get("parameters", []), operation.get("requestBody", {})]
        answers[place] = operation.get("responses", {})
    for nodes, is_closed in ((requests, True), (answers, False)):
        for place, value in object_schemas({**nodes, **reachable(document, list(nodes.values()), {})}):
            if is_closed and value.get("additionalProperties") is not False:
                yield f"{place}: a request, and additionalProperties is not false"
            if not is_closed and "additionalProperties" in value:
                yield f"{place}: an answer, and it has additionalProperties"
            for name in value.get("required", []):
                if name not in value["properties"]:
                    yield f"{place}: required {name} is no property"


def check_path_parameters(document, path, item, operation):
    parameters = [*item.get("parameters", []), *operation.get("parameters", [])]
    parameters = [resolve(document, p["$ref"]) if "$ref" in p else p for p in parameters]
    declared = sorted(p["name"] for p in parameters if p["in"] == "path")
    if declared != sorted(CAPTURE.findall(path)):
        yield f"declares the path parameters {declared}"


def takes_preference(item, operation):
    """True when the operation may be answered by a job."""
    return PREFER in [*item.get("parameters", []), *operation.get("parameters", [])]


def access(method, operation):
    """The role that a key needs, or None where none is needed. What changes things asks for `write`, what asks for `read`, unless
    the operation says otherwise: [] or [{key: [role]}]."""
    if "security" in operation:
        return operation["security"][0]["key"][0] if operation["security"] else None
    asks = method in ("get", "head") or (method == "post" and "queries" in operation["tags"])
    return "read" if asks else "write"


def check_security(operation):
    allowed = [[], *([{"key": [role]}] for role in ROLES)]
    if operation.get("security", []) not in allowed:
        yield f"has a security requirement other than {allowed}"


def check_operation(document, path, item, operation):
    yield from check_security(operation)
    yield from check_path_parameters(document, path, item, operation)
    if takes_preference(item, operation) != ("202" in operation.get("responses", {})):
        yield "has one of the parameter Prefer and the response 202 without the other"
    for field in ("summary", "tags", "responses"):
        if not operation.get(field):
            yield f"has no {field}"
    for name in (operation.get("operationId", ""), handler(operation)):
        if not IDENTIFIER.fullmatch(name):
            yield f"has the name {name!r}"
    if len(segments(path)) > MAX_SEGMENTS or len(CAPTURE.findall(path)) > MAX_CAPTURES:
        yield "has a path too long for the table"


def check_operations(document):
    seen = set()
    for path, item, method, operation in operations(document):
        for complaint in check_operation(document, path, item, operation):
            yield f"{method} {path}: {complaint}"
        if operation.get("operationId") in seen:
            yield f"{method} {path}: the operationId stands twice"
        seen.add(operation.get("operationId"))


def check_document(document):
    """Complaints about the document, one string each."""
    yield from check_references(document)
    yield from check_enumerations(document)
    yield from check_objects(document)
    yield from check_operations(document)


def check_problems(document, header):
    """The problems of the contract are those of the code."""
    text = pathlib.Path(header).read_text(encoding="utf-8")
    coded = re.findall(r'X\(\d{3}, \w+, (\w+), "', text)
    documented = document["components"]["schemas"]["Problem"]["properties"]["code"]["enum"]
    if coded != documented:
        yield f"the problem codes differ from {header}: {sorted(set(coded) ^ set(documented)) or 'their order'}"


# --- C --------------------------------------------------------------------------------------------------------------


def c_string(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def c_bytes(name, data):
    """An array as a string literal, read faster by compilers than a list of numbers. Its final NUL does not count."""
    lines = []
    for start in range(0, len(data), 64):
        lines.append('    "' + "".join(f"\\{byte:03o}" for byte in data[start : start + 64]) + '"')
    return f"static const unsigned char {name}[] =\n" + "\n".join(lines or ['    ""']) + ";\n"


# --- routes ---------------------------------------------------------------------------------------------------------


def handler(operation):
    return operation.get("x-handler", operation.get("operationId", ""))


def query_name(path, method, operation):
    """Queries are counted by their POST form, which each of them has; those of other surfaces than meshes with the kind's plural."""
    if method != "post" or "queries" not in operation["tags"]:
        return None
    kind, name = segments(path)[1], segments(path)[-1]
    return name if kind == "meshes" else f"{kind}/{name}"


def literals_first(route):
    path, method = route[0], route[2]
    return [(bool(CAPTURE.fullmatch(part)), part) for part in segments(path)], METHODS.index(method)


def is_query(path, item, operation):
    """Queries about meshes need no handlers of their own; what makes meshes, pictures or lines of answers does."""
    parameters = [*item.get("parameters", []), *operation.get("parameters", [])]
    names = {parameter.get("$ref", "").split("/")[-1] for parameter in parameters}
    return path.startswith("/v1/meshes/") and "TimeoutMs" in names and handler(operation) not in OWN_HANDLERS


def route_row(path, item, method, operation):
    parts = [None if CAPTURE.fullmatch(part) else part for part in segments(path)]
    query = query_name(path, method, operation)
    fields = {
        "method": f"PROTO_METHOD_{method.upper()}",
        "access": f"PROTO_ACCESS_{(access(method, operation) or 'public').upper()}",
        "has_body": "true" if "requestBody" in operation else "false",
        "is_async": "true" if takes_preference(item, operation) else "false",
        "operation": c_string(operation["operationId"]),
        "path": c_string(path),
        "query": c_string(query) if query else "NULL",
        "segment_count": str(len(parts)),
        "segments": "{" + ", ".join(c_string(part) if part else "NULL" for part in parts or [None]) + "}",
        "handle": "server_handle_query" if is_query(path, item, operation) else f"server_handle_{handler(operation)}",
        "kind": f"&server_query_{handler(operation)}" if is_query(path, item, operation) else "NULL",
    }
    return "    {" + ", ".join(f".{name} = {value}" for name, value in fields.items()) + "},"


def print_routes(document):
    routes = sorted((route for route in operations(document) if route[2] != "head"), key=literals_first)
    print('/* Made by generate.py from openapi.yaml. */\n#include "proto/http/route.h"\n\n#include "generated/handlers.h"\n')
    print("const struct proto_route proto_routes[] = {")
    for path, item, method, operation in routes:
        print(route_row(path, item, method, operation))
    print("};\n\nconst size_t proto_route_count = sizeof proto_routes / sizeof proto_routes[0];")


def print_handlers(document):
    print("/* Made by generate.py from openapi.yaml. */\nstruct server_exchange;\nstruct server_query_kind;\n\nvoid server_handle_query(struct server_exchange *exchange);")
    for name in sorted({handler(operation) for path, item, method, operation in operations(document) if method != "head" and not is_query(path, item, operation)}):
        print(f"void server_handle_{name}(struct server_exchange *exchange);")
    for name in sorted({handler(operation) for path, item, _, operation in operations(document) if is_query(path, item, operation)}):
        print(f"extern const struct server_query_kind server_query_{name};")


# --- assets ---------------------------------------------------------------------------------------------------------


def published(node):
    """The document without the extension that is the generator's own."""
    if isinstance(node, dict):
        return {key: published(value) for key, value in node.items() if key != "x-handler"}
    if isinstance(node, list):
        return [published(value) for value in node]
    return node


def static_files(arguments):
    """(path on the server, bytes) of all files below the folders that the arguments name: a folder is the server's root."""
    for root in map(pathlib.Path, arguments):
        for file in sorted(root.rglob("*")):
            if file.is_file():
                yield "/" + file.relative_to(root).as_posix(), file.read_bytes()


def media_type(path):
    suffix = pathlib.PurePosixPath(path).suffix
    if suffix not in MEDIA_TYPES:
        sys.exit(f"generate.py: {path}: no media type is known for {suffix!r}")
    return MEDIA_TYPES[suffix]


def policy(path):
    return next((text for folder, text in POLICIES.items() if path.startswith(folder)), PAGE_POLICY)


def aliases(path):
    """What a browser may ask for it: an index is its folder, with or without the slash."""
    folder = path.removesuffix("/index.html")
    return [path] if folder == path else sorted({path, folder or "/", folder + "/"})


def asset_rows(path, number, data, compressed):
    etag = '"' + hashlib.sha256(data).hexdigest()[:32] + '"'
    packed = f"gzip_{number}, {len(compressed)}" if compressed else "NULL, 0"
    content = f"{c_string(media_type(path))}, {c_string(etag)}, {c_string(policy(path))}, bytes_{number}, {len(data)}, {packed}"
    for alias in aliases(path):
        yield f"    {{{c_string(alias)}, {content}}},"


def state_security(document):
    """Writes out the rule of `access`; the alternative {} is a daemon without keys."""
    for _, _, method, operation in operations(document):
        role = access(method, operation)
        operation["security"] = [{"key": [role]}, {}] if role else []


def print_assets(document, arguments):
    state_security(document)
    text = json.dumps(published(document), ensure_ascii=False, separators=(",", ":"))
    assets = [("/openapi.json", text.encode("utf-8")), *static_files(arguments)]
    rows = []
    print('/* Made by generate.py from openapi.yaml and the pages of the viewer. */\n#include "proto/http/asset.h"\n')
    for number, (path, data) in enumerate(assets):
        compressed = gzip.compress(data, compresslevel=9, mtime=0)
        compressed = compressed if len(compressed) < len(data) else None
        print(c_bytes(f"bytes_{number}", data))
        if compressed:
            print(c_bytes(f"gzip_{number}", compressed))
        rows += asset_rows(path, number, data, compressed)
    print("const struct proto_asset proto_assets[] = {", *rows, "};", sep="\n")
    print("\nconst size_t proto_asset_count = sizeof proto_assets / sizeof proto_assets[0];")


# --- command line ---------------------------------------------------------------------------------------------------


def main(arguments):
    if len(arguments) < 2 or arguments[0] not in ("routes", "handlers", "assets", "check"):
        sys.exit(__doc__.strip())
    mode, path, *rest = arguments
    document = load_document(path)
    complaints = list(check_document(document))
    if mode == "check":
        for header in rest:
            complaints += check_problems(document, header)
    if complaints:
        sys.exit("\n".join(f"{path}: {complaint}" for complaint in complaints))
    if mode == "routes":
        print_routes(document)
    elif mode == "handlers":
        print_handlers(document)
    elif mode == "assets":
        print_assets(document, rest)


if __name__ == "__main__":
    main(sys.argv[1:])
