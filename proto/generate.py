#!/usr/bin/env python3
"""Makes sources of the daemon from the contract, openapi.yaml. Equal inputs give equal outputs.

    generate.py sources openapi.yaml folder
        writes the C sources to the folder, except those that are already equal: routes.c
        (proto/http/route.h), handlers.h (server/query/handlers.h), and those of members.py,
        query_strings.py, bodies.py and answers.py
    generate.py assets openapi.yaml [folder...]
        prints openapi.json and the files below the folders as C, for proto/http/asset.h
    generate.py document openapi.yaml
        prints openapi.json
    generate.py check openapi.yaml problem.h
        prints complaints; exit status 1 if there are any

Each command rejects a document that breaks a rule of check_document.
"""
import datetime
import gzip
import hashlib
import json
import pathlib
import re
import sys

sys.dont_write_bytecode = True
import answers  # noqa: E402
import bodies  # noqa: E402
import members  # noqa: E402
import query_strings  # noqa: E402
from document import (  # noqa: E402
    CAPTURE,
    METHODS,
    access,
    check_document,
    check_problems,
    deprecated_parameters,
    handler,
    is_follow_up,
    load_document,
    operations,
    segments,
    takes_preference,
)
from members import c_string  # noqa: E402

# queries that have their own handlers
OWN_HANDLERS = {"batch", "picture", "picture_png", "picture_svg"}

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

# A page may load its own files. Swagger UI's style sheet has its icons as data: URLs; the pictures
# of answers are blob: URLs.
PAGE_POLICY = "default-src 'self'; object-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
POLICIES = {"/docs/": PAGE_POLICY + "; img-src 'self' data: blob:"}


# --- C --------------------------------------------------------------------------------------------


def c_bytes(name, data):
    """Returns a C array, written as a string literal, which compilers read faster. Its final NUL
    does not count."""
    lines = []
    for start in range(0, len(data), 64):
        lines.append('    "' + "".join(f"\\{byte:03o}" for byte in data[start : start + 64]) + '"')
    return f"static const unsigned char {name}[] =\n" + "\n".join(lines or ['    ""']) + ";\n"


# --- routes ---------------------------------------------------------------------------------------


def query_name(path, method, operation):
    """Returns the query's name in metrics, which is the name of its POST form. For surfaces other
    than meshes, the plural of the kind precedes the name."""
    if method != "post" or "queries" not in operation["tags"]:
        return None
    kind, name = segments(path)[1], segments(path)[-1]
    return name if kind == "meshes" else f"{kind}/{name}"


def literals_first(route):
    path, method = route[0], route[2]
    return [(bool(CAPTURE.fullmatch(part)), part) for part in segments(path)], METHODS.index(method)


def is_query(path, item, operation):
    """Returns whether the operation is a query without a handler of its own."""
    parameters = [*item.get("parameters", []), *operation.get("parameters", [])]
    names = {parameter.get("$ref", "").split("/")[-1] for parameter in parameters}
    return "TimeoutMs" in names and handler(operation) not in OWN_HANDLERS


def deprecation(old, new, since):
    seconds = int(datetime.datetime.fromisoformat(since).replace(tzinfo=datetime.timezone.utc).timestamp())
    return f"{{{c_string(old)}, {c_string(new)}, {seconds}}}"


def deprecation_fields(document, path, item, method, operation):
    """Returns the fields for the Deprecation headers of the route's own path and of its
    parameters."""
    fields = {}
    if operation.get("deprecated"):
        row = deprecation(path, operation["x-replaced-by"], operation["x-deprecated-since"])
        fields["deprecation"] = f"&(const struct proto_deprecation){row}"
        operation = document["paths"][operation["x-replaced-by"]][method]
    rows = [deprecation(each["name"], each["x-replaced-by"], each["x-deprecated-since"]) for each in deprecated_parameters(document, item, operation)]
    if rows:
        fields["deprecated_parameters"] = f"(const struct proto_deprecation[]){{{', '.join([*rows, '{0}'])}}}"
    if fields:
        fields["documentation"] = c_string(f"/docs/#/{operation['tags'][0]}/{operation['operationId']}")
    return fields


def route_row(document, path, item, method, operation):
    parts = [None if CAPTURE.fullmatch(part) else part for part in segments(path)]
    query = query_name(path, method, operation)
    fields = {
        "method": f"PROTO_METHOD_{method.upper()}",
        "access": f"PROTO_ACCESS_{(access(method, operation) or 'public').upper()}",
        "is_follow_up": "true" if is_follow_up(method, operation) else "false",
        "has_body": "true" if "requestBody" in operation else "false",
        "is_async": "true" if takes_preference(item, operation) else "false",
        "operation": c_string(operation["operationId"]),
        "path": c_string(path),
        "query": c_string(query) if query else "NULL",
        "fields": members.fields_of(document, item, operation) or "NULL",
        "has_lines": "true" if members.has_lines(document, item, operation) else "false",
        "parameters": f"proto_{operation['operationId']}_parameters" if members.query_names(document, item, operation) else "NULL",
        "segment_count": str(len(parts)),
        "segments": "{" + ", ".join(c_string(part) if part else "NULL" for part in parts or [None]) + "}",
        "handle": "server_handle_query" if is_query(path, item, operation) else f"server_handle_{handler(operation)}",
        "kind": f"&server_query_{handler(operation)}" if is_query(path, item, operation) else "NULL",
        **deprecation_fields(document, path, item, method, operation),
    }
    return "    {" + ", ".join(f".{name} = {value}" for name, value in fields.items()) + "},"


def route_source(document):
    routes = sorted((route for route in operations(document) if route[2] != "head"), key=literals_first)
    yield '/* Made by generate.py from openapi.yaml. */\n#include "proto/http/route.h"\n\n#include "generated/fields.h"\n#include "generated/handlers.h"\n#include "generated/parameters.h"\n'
    yield "const struct proto_route proto_routes[] = {"
    for path, item, method, operation in routes:
        yield route_row(document, path, item, method, operation)
    yield "};\n\nconst size_t proto_route_count = sizeof proto_routes / sizeof proto_routes[0];"


def handler_header(document):
    yield "/* Made by generate.py from openapi.yaml. */\nstruct server_exchange;\nstruct server_query_kind;\n\nvoid server_handle_query(struct server_exchange *exchange);"
    for name in sorted({handler(operation) for path, item, method, operation in operations(document) if method != "head" and not is_query(path, item, operation)}):
        yield f"void server_handle_{name}(struct server_exchange *exchange);"
    for name in sorted({handler(operation) for path, item, _, operation in operations(document) if is_query(path, item, operation)}):
        yield f"extern const struct server_query_kind server_query_{name};"


SOURCES = {
    "routes.c": route_source,
    "handlers.h": handler_header,
    "fields.h": members.field_header,
    "fields.c": members.field_source,
    "parameters.h": members.parameter_header,
    "parameters.c": members.parameter_source,
    "values.h": bodies.value_header,
    "values.c": bodies.value_source,
    "requests.h": bodies.request_header,
    "requests.c": bodies.request_source,
    "queries.h": query_strings.query_header,
    "queries.c": query_strings.query_source,
    "answers.h": answers.answer_header,
    "answers.c": answers.answer_source,
}


def write_sources(document, folder):
    """Writes the sources. An unchanged source keeps its time, so that nothing is recompiled."""
    for name, source in SOURCES.items():
        path, text = pathlib.Path(folder, name), "\n".join(source(document)) + "\n"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


# --- assets ---------------------------------------------------------------------------------------


PUBLISHED_EXTENSIONS = ("x-replaced-by", "x-deprecated-since")


def published(node):
    """Returns the document without the generator's own extensions."""
    if isinstance(node, dict):
        return {key: published(value) for key, value in node.items() if key in PUBLISHED_EXTENSIONS or not key.startswith("x-")}
    if isinstance(node, list):
        return [published(value) for value in node]
    return node


def static_files(arguments):
    """Yields (path on the server, bytes) of all files below the folders; each folder is a root."""
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
    """Returns the paths that serve an asset: an index also has its folder's path, with and without
    the slash."""
    folder = path.removesuffix("/index.html")
    return [path] if folder == path else sorted({path, folder or "/", folder + "/"})


def asset_rows(path, number, data, compressed):
    etag = '"' + hashlib.sha256(data).hexdigest()[:32] + '"'
    packed = f"gzip_{number}, {len(compressed)}" if compressed else "NULL, 0"
    content = f"{c_string(media_type(path))}, {c_string(etag)}, {c_string(policy(path))}, bytes_{number}, {len(data)}, {packed}"
    for alias in aliases(path):
        yield f"    {{{c_string(alias)}, {content}}},"


def state_security(document):
    """Adds the result of `access` to each operation. The alternative {} represents a daemon without
    keys."""
    for _, _, method, operation in operations(document):
        role = access(method, operation)
        operation["security"] = [{"key": [role]}, {}] if role else []


def document_text(document):
    """Returns the published document."""
    state_security(document)
    return json.dumps(published(document), ensure_ascii=False, separators=(",", ":"))


def print_assets(document, arguments):
    assets = [("/openapi.json", document_text(document).encode("utf-8")), *static_files(arguments)]
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


# --- command line ---------------------------------------------------------------------------------


def main(arguments):
    if len(arguments) < 2 or arguments[0] not in ("sources", "assets", "document", "check"):
        sys.exit(__doc__.strip())
    mode, path, *rest = arguments
    document = load_document(path)
    complaints = list(check_document(document))
    if mode == "check":
        for header in rest:
            complaints += check_problems(document, header)
    if complaints:
        sys.exit("\n".join(f"{path}: {complaint}" for complaint in complaints))
    members.expand(document)
    if mode == "sources":
        write_sources(document, rest[0])
    elif mode == "assets":
        print_assets(document, rest)
    elif mode == "document":
        print(document_text(document))


if __name__ == "__main__":
    main(sys.argv[1:])
