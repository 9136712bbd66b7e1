"""Loads the contract, openapi.yaml, and checks the rules of its form."""
import pathlib
import re
import sys

try:
    import yaml
except ImportError:
    sys.exit("python3's module yaml is missing; Debian's package is python3-yaml: run 'make setup'")

# methods of the route table; a GET route also answers HEAD
METHODS = ("get", "put", "post", "patch", "delete")
MAX_SEGMENTS = 6  # PROTO_ROUTE_SEGMENTS
MAX_CAPTURES = 2  # PROTO_ROUTE_CAPTURES
IDENTIFIER = re.compile(r"[a-z][a-z0-9_]*")
CAPTURE = re.compile(r"\{([a-z_]+)\}")
DATE = re.compile(r"\d{4}-\d{2}-\d{2}")
PREFER = {"$ref": "#/components/parameters/Prefer"}
ROLES = ("read", "write")  # roles of keys, as named in security requirements


# --- the document ---------------------------------------------------------------------------------


class UniqueKeyLoader(yaml.SafeLoader):
    """Rejects duplicate keys. Without this check, YAML would keep the last of them."""


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
    """Yields (path, path item, method, operation) of each operation, in order, head included."""
    for path, item in document["paths"].items():
        for method in (*METHODS, "head"):
            if method in item:
                yield path, item, method, item[method]


def segments(path):
    return path[1:].split("/") if path != "/" else []


def values(node, place="#"):
    """Yields (JSON Pointer, value) of every value in the document."""
    yield place, node
    pairs = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in pairs:
        yield from values(value, f"{place}/{str(key).replace('~', '~0').replace('/', '~1')}")


def resolve(document, reference):
    """Returns the value that a reference within the document points at. Raises LookupError if there
    is none."""
    if not reference.startswith("#/"):
        raise LookupError(reference)
    node = document
    for part in reference[2:].split("/"):
        node = node[part.replace("~1", "/").replace("~0", "~")]
    return node


# --- its rules ------------------------------------------------------------------------------------


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
            # security schemes are named, not referenced
            if f"#/components/{kind}/{name}" not in used and kind != "securitySchemes":
                yield f"#/components/{kind}/{name} is not used"


def check_enumerations(document):
    """Complains about enumerations with booleans. YAML 1.1 reads the unquoted words off, on, yes
    and no as booleans."""
    for place, value in values(document):
        if isinstance(value, dict) and value.get("type") == "string":
            for word in [*value.get("enum", []), *([value["const"]] if "const" in value else [])]:
                if not isinstance(word, str):
                    yield f"{place}: {word!r} is no string; quote it"


def reachable(document, node, found):
    """Adds to `found` (reference to schema) all schemas that the node refers to."""
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
    """Checks that requests reject unknown members. Checks that answers allow them, so that a new
    member breaks no client."""
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
    """Returns whether the operation accepts Prefer: respond-async."""
    return PREFER in [*item.get("parameters", []), *operation.get("parameters", [])]


def access(method, operation):
    """Returns the role that a key needs, or None. Changes need `write` and other operations `read`;
    an operation overrides this by `security: []` or [{key: [role]}]."""
    if "security" in operation:
        return operation["security"][0]["key"][0] if operation["security"] else None
    asks = method in ("get", "head") or (method == "post" and "queries" in operation["tags"])
    return "read" if asks else "write"


def is_follow_up(method, operation):
    """Returns whether the operation only reads or ends jobs or batches."""
    return method in ("get", "head", "delete") and bool({"jobs", "batches"} & {*operation["tags"]})


def check_security(operation):
    allowed = [[], *([{"key": [role]}] for role in ROLES)]
    if operation.get("security", []) not in allowed:
        yield f"has a security requirement other than {allowed}"


def check_operation(document, path, item, operation):
    yield from check_security(operation)
    yield from check_path_parameters(document, path, item, operation)
    accepted = operation.get("responses", {}).get("202", {}).get("$ref", "").endswith("/Accepted")
    if takes_preference(item, operation) != accepted:
        yield "has one of the parameter Prefer and the response 202, Accepted, without the other"
    for field in ("summary", "tags", "responses"):
        if not operation.get(field):
            yield f"has no {field}"
    for name in (operation.get("operationId", ""), handler(operation)):
        if not IDENTIFIER.fullmatch(name):
            yield f"has the name {name!r}"
    if len(segments(path)) > MAX_SEGMENTS or len(CAPTURE.findall(path)) > MAX_CAPTURES:
        yield "has a path too long for the table"


def parameters(document, item, operation):
    """Returns the parameters of the operation, including those of its path."""
    return [resolve(document, each["$ref"]) if "$ref" in each else each for each in (*item.get("parameters", []), *operation.get("parameters", []))]


def deprecated_parameters(document, item, operation):
    return [each for each in parameters(document, item, operation) if each.get("deprecated")]


def check_deprecations(document, path, item, method, operation):
    """Checks that a deprecated name has a date and a replacement that exists beside it."""
    names = {each["name"] for each in parameters(document, item, operation) if not each.get("deprecated")}
    for parameter in deprecated_parameters(document, item, operation):
        if parameter["in"] != "query" or parameter.get("x-replaced-by") not in names or not DATE.fullmatch(parameter.get("x-deprecated-since", "")):
            yield f"has the deprecated parameter {parameter['name']} without x-replaced-by and x-deprecated-since"
    if not operation.get("deprecated"):
        return
    replacement = operation.get("x-replaced-by", "")
    if method not in document["paths"].get(replacement, {}) or CAPTURE.findall(replacement) != CAPTURE.findall(path):
        yield f"is deprecated, and {replacement or 'no path'} replaces it"
    if not DATE.fullmatch(operation.get("x-deprecated-since", "")):
        yield "is deprecated without x-deprecated-since"


def check_operations(document):
    seen = set()
    for path, item, method, operation in operations(document):
        for complaint in check_operation(document, path, item, operation):
            yield f"{method} {path}: {complaint}"
        for complaint in check_deprecations(document, path, item, method, operation):
            yield f"{method} {path}: {complaint}"
        if operation.get("operationId") in seen:
            yield f"{method} {path}: the operationId stands twice"
        seen.add(operation.get("operationId"))


def check_document(document):
    """Yields complaints about the document, one string each."""
    yield from check_references(document)
    yield from check_enumerations(document)
    yield from check_objects(document)
    yield from check_operations(document)


def check_problems(document, header):
    """Checks that contract and code list the same problems."""
    text = pathlib.Path(header).read_text(encoding="utf-8")
    coded = re.findall(r'X\(\d{3}, \w+, (\w+), "', text)
    documented = document["components"]["schemas"]["Problem"]["properties"]["code"]["enum"]
    if coded != documented:
        yield f"the problem codes differ from {header}: {sorted(set(coded) ^ set(documented)) or 'their order'}"


def handler(operation):
    return operation.get("x-handler", operation.get("operationId", ""))
