"""Members of requests, fields of answers and parameters, in C, from the contract.

A parameter `select` whose items have `x-fields: {of: Schema}` accepts the names of the schema's
members, in their order; `with: member` puts the members of that list's items behind it, `without`
leaves some out. `expand` writes the names into the document as an enumeration. In C they are bits
and a list of names.

A schema `…Request` with properties, and each object that it refers to, becomes a struct and a
function that reads it. A type that C decodes by hand is in VALUES; a member of `x-by-hand` is not
in the struct. Sentences of problems stand beside the properties:

    x-by-hand    [member…], or all: then there is a list of the names only
    x-refusals   {member: sentence}: for a value outside its limits, an unknown word, no array
    x-expected   {member: sentence}: for a value that is not an array, if the sentence differs
    x-too-large  {member: sentence}: for a value above its maximum; the problem is too_large then
    x-one-of     {members: [a, b], refusal: sentence}: exactly one of both is there
"""
import re

from document import operations, resolve

# lists that have their own struct
LIST = {"Point": "struct proto_points", "Place": "struct proto_uvs"}
# values decoded by hand-written functions: type, header, decode function, free function
VALUES = {
    "Point": ("struct proto_point", "values/point.h", "proto_point_decode", None),
    "Curve": ("struct proto_curve", "values/curve.h", "proto_curve_decode", "proto_curve_free"),
    "Set": ("struct proto_set", "values/set.h", "proto_set_decode", "proto_set_free"),
    "DirectionRequest": ("struct proto_direction", "values/direction.h", "proto_direction_decode", None),
    "Name": ("struct proto_name", "values/mesh.h", "proto_name_decode", None),
}
HEADERS = {"Point": "values/points.h", "Place": "values/uv.h"}


def snake(name):
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


def upper(*names):
    return "_".join(snake(name).upper().replace("-", "_") for name in names)


def c_string(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def number(value):
    return "INFINITY" if value is None else repr(value)


# --- fields of answers ----------------------------------------------------------------------------


def follow(document, schema):
    """Returns the schema behind references, and the name of the last one."""
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
    """Yields (name, rule, items) of each parameter whose names are those of a schema."""
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
    yield "#ifndef GENERATED_FIELDS_H\n#define GENERATED_FIELDS_H\n"
    for name, rule, _ in field_lists(document):
        names = field_names(document, rule)
        yield f"enum proto_{snake(name)}_field {{"
        yield from (f"    PROTO_{upper(name)}_FIELD_{upper(field)} = 1 << {i}," for i, field in enumerate(names))
        yield f"    PROTO_{upper(name)}_FIELD_ALL = (1 << {len(names)}) - 1\n}};"
        yield f"extern const char *const proto_{snake(name)}_fields[];\n"
    yield "#endif"


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
    """Yields (operation, query parameters) of each operation with some."""
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
    yield "#ifndef GENERATED_PARAMETERS_H\n#define GENERATED_PARAMETERS_H\n"
    yield from (f"extern const char *const proto_{name}_parameters[];" for name, _ in parameter_lists(document))
    for name, listed in parameter_words(document):
        yield f"\nenum proto_{snake(name)} {{"
        yield from (f"    PROTO_{upper(name)}_{upper(word)}," for word in listed)
        yield f"}};\nextern const char *const proto_{snake(name)}_words[];"
    yield "\n#endif"


def parameter_source(document):
    yield '/* Made by generate.py from openapi.yaml. */\n#include "generated/parameters.h"\n\n#include <stddef.h>\n'
    for name, listed in parameter_lists(document):
        yield f"const char *const proto_{name}_parameters[] = {{{', '.join(map(c_string, listed))}, NULL}};"
    for name, listed in parameter_words(document):
        yield f"const char *const proto_{snake(name)}_words[] = {{{', '.join(map(c_string, listed))}, NULL}};"


# --- members of requests --------------------------------------------------------------------------


class Member:
    """A request's property in C."""

    def __init__(self, document, owner, name, schema):
        self.name, self.owner, self.is_required = name, owner, name in schema.get("required", [])
        self.refusal = schema.get("x-refusals", {}).get(name)
        self.too_large = schema.get("x-too-large", {}).get(name)
        self.expected = schema.get("x-expected", {}).get(name)
        self.schema, self.reference = follow(document, schema["properties"][name])
        self.default = self.schema.get("default")
        self.item, self.item_reference = follow(document, self.schema.get("items", {}))
        self.kind = self.find_kind()

    def find_kind(self):
        schema, kind = self.schema, self.schema.get("type")
        if self.reference in VALUES:
            return "value"
        if "enum" in schema:
            return "word"
        if kind == "array" and self.item_reference in LIST:
            return "points"
        if kind == "array" and "minItems" in schema and schema["minItems"] == schema.get("maxItems"):
            return {"number": "numbers", "integer": "indices"}[self.item["type"]]
        if kind == "array" and (self.item_reference in VALUES or self.item.get("type") == "object"):
            return "list"
        if kind == "object":
            return "object"
        return {"number": "number", "integer": "index", "boolean": "flag"}.get(kind) or self.refuse()

    def refuse(self):
        raise SystemExit(f"{self.owner}.{self.name}: C has no decoder for this; name it in x-by-hand, or add one to VALUES")

    @property
    def has_flag(self):
        """Returns whether the struct needs a flag: the member is optional, without a default and
        without a value that means "missing"."""
        return not self.is_required and self.default is None and self.kind not in ("flag", "points", "list")

    def declaration(self):
        count = self.schema.get("minItems")
        reference = self.item_reference or "none"
        return {
            "value": f"{VALUES.get(self.reference, [''])[0]} {self.name};",
            "word": f"unsigned {self.name}; /* PROTO_{upper(self.name)}_… */",
            "points": f"{LIST.get(reference)} {self.name};",
            "numbers": f"double {self.name}[{count}];",
            "indices": f"uint32_t {self.name}[{count}];",
            "list": f"struct proto_{snake(reference)}_list {self.name};",
            "object": f"struct proto_{snake(self.reference or 'none')} {self.name};",
            "number": f"double {self.name};",
            "index": f"uint32_t {self.name};",
            "flag": f"bool {self.name};",
        }[self.kind]

    def initial(self):
        if self.default is None:
            return None
        if self.kind == "word":
            return f".{self.name} = {self.word(self.default)}"
        value = str(self.default).lower() if isinstance(self.default, bool) else self.default
        return f".{self.name} = {value}"

    def word(self, text):
        return f"PROTO_{upper(self.name)}_{upper(text)}"

    def rule(self):
        """Returns the initializer of its struct proto_rule."""
        schema, is_list = self.schema, self.kind in ("points", "list")
        limits = self.item if self.kind == "indices" else schema
        least = schema.get("minItems", 0) if is_list else limits.get("exclusiveMinimum", limits.get("minimum"))
        most = schema.get("maxItems", 0xFFFFFFFF) if is_list else limits.get("maximum")
        parts = [f".name = {c_string(self.name)}"]
        if self.is_required:
            parts.append(".is_required = true")
        if "exclusiveMinimum" in limits:
            parts.append(".is_above = true")
        if is_list or self.kind in ("number", "index", "indices"):
            parts += [f".least = {'-INFINITY' if least is None else number(least)}", f".most = {number(most)}"]
        refusal = self.refusal
        if self.kind == "word":
            parts.append(f".words = proto_{snake(self.name)}_words")
            refusal = refusal or f"{self.name} is " + " or ".join(f'"{word}"' for word in schema["enum"])
        if is_list:
            refusal = refusal or f"expected an array of at least one {'point' if self.item_reference == 'Point' else 'element'}"
        if self.kind in ("number", "index", "indices"):
            refusal = refusal or self.sentence(limits)
        if refusal:
            parts.append(f".refusal = {c_string(refusal)}")
        if self.expected:
            parts.append(f".expected = {c_string(self.expected)}")
        if self.too_large:
            parts.append(f".too_large = {c_string(self.too_large)}")
        return "{" + ", ".join(parts) + "}"

    def sentence(self, limits):
        """Returns a problem's sentence that says which values are valid."""
        what = "a number" if self.kind == "number" else "a whole number"
        if "exclusiveMinimum" in limits:
            return f"{self.name} is {what} of more than {limits['exclusiveMinimum']}"
        if "maximum" in limits:
            return f"{self.name} is {what} from {limits['minimum']} to {limits['maximum']}"
        return f"{self.name} is {what} of at least {limits['minimum']}" if "minimum" in limits else None

    def take(self):
        """Returns the call that reads the member into `read`."""
        rule, target = f"&rules[{upper(self.name)}]", f"&read.{self.name}"
        count = self.schema.get("minItems")
        if self.kind in ("numbers", "indices"):
            return f"proto_take_{self.kind}(object, {rule}, {count}, read.{self.name})"
        names = {"value": snake(self.reference or ""), "object": snake(self.reference or ""), "list": snake(self.item_reference or "") + "_list",
                 "points": {"Point": "points", "Place": "uvs"}.get(self.item_reference)}
        if self.kind in names:
            return f"take_{names[self.kind]}(object, {rule}, {target})"
        return f"proto_take_{self.kind}(object, {rule}, {target})"

    def release(self):
        if self.kind == "value" and VALUES[self.reference][3]:
            return f"{VALUES[self.reference][3]}(&request->{self.name});"
        if self.kind == "points":
            return f"{LIST[self.item_reference].removeprefix('struct ')}_free(&request->{self.name});"
        if self.kind == "list":
            return f"free(request->{self.name}.items);\n    request->{self.name} = (struct proto_{snake(self.item_reference)}_list){{0}};"
        return None


class Request:
    def __init__(self, document, name, schema):
        self.name, self.schema = name, schema
        self.names, by_hand = list(schema["properties"]), schema.get("x-by-hand", [])
        self.is_by_hand = by_hand == "all"
        self.members = [] if self.is_by_hand else [Member(document, name, key, schema) for key in self.names if key not in by_hand]

    @property
    def c_name(self):
        return f"proto_{snake(self.name)}"

    def releases(self):
        return [text for text in (member.release() for member in self.members) if text]


def requests(document):
    """Returns the requests, each after the objects that it refers to."""
    found = {}

    def add(name, schema):
        if name in found:
            return
        request = Request(document, name, schema)
        for member in request.members:
            if member.kind == "object":
                add(member.reference, member.schema)
            if member.kind == "list" and member.item_reference not in VALUES:
                add(member.item_reference, member.item)
        found[name] = request

    for name, schema in document["components"]["schemas"].items():
        if "properties" in schema and (name.endswith("Request") or "x-by-hand" in schema):
            add(name, schema)
    return list(found.values())


def words(all_requests):
    """Returns (member, words) of each enumeration. Members of one name share one enumeration."""
    found = {}
    for member in (member for request in all_requests for member in request.members if member.kind == "word"):
        if found.setdefault(member.name, member).schema["enum"] != member.schema["enum"]:
            raise SystemExit(f"{member.owner}.{member.name}: another enumeration has this name; name it in x-by-hand")
    return found.values()


def limits(request):
    for member in request.members:
        most = member.schema.get("maximum" if member.kind == "index" else "maxItems", 0xFFFFFFFE)
        if member.kind in ("index", "points", "list") and most < 0xFFFFFFFE:
            yield f"#define PROTO_{upper(request.name)}_{upper(member.name)}_MOST {most}"


def lists(all_requests):
    """Returns the types of list items, in C and as a name."""
    found = {}
    for member in (member for request in all_requests for member in request.members if member.kind == "list"):
        reference = member.item_reference
        found[reference] = VALUES[reference][0] if reference in VALUES else f"struct proto_{snake(reference)}"
    return found


def list_struct(reference, kind):
    return f"struct proto_{snake(reference)}_list {{ /* all zero is an empty one */\n    {kind} *items;\n    uint32_t count;\n}};\n"


def request_header(document):
    every = requests(document)
    used = {member.reference for request in every for member in request.members if member.kind == "value"}
    used |= {member.item_reference for request in every for member in request.members if member.kind == "list"} & VALUES.keys()
    headers = {VALUES[name][1] for name in used}
    headers |= {HEADERS[member.item_reference] for request in every for member in request.members if member.kind == "points"}
    yield "/* Made by generate.py from openapi.yaml: requests, and how they are read. Each _decode and _read checks\n * members, types and limits; what spans several members, and the members of x-by-hand, are the caller's. */"
    yield "#ifndef GENERATED_REQUESTS_H\n#define GENERATED_REQUESTS_H\n"
    yield from (f'#include "proto/{header}"' for header in sorted(headers | {"json/object.h"}))
    yield ""
    for member in words(every):
        yield "enum {"
        yield from (f"    {member.word(word)}," for word in member.schema["enum"])
        yield "};"
        yield f"extern const char *const proto_{snake(member.name)}_words[]; /* NULL-terminated */\n"
    printed = set()
    kinds = lists(every)
    for request in every:
        for member in request.members:
            if member.kind == "list" and member.item_reference not in printed:
                printed.add(member.item_reference)
                yield list_struct(member.item_reference, kinds[member.item_reference])
        if request.is_by_hand:
            yield f"extern const char *const {request.c_name}_members[]; /* NULL-terminated */\n"
            continue
        yield from limits(request)
        yield f"struct {request.c_name} {{"
        for member in request.members:
            if member.has_flag:
                yield f"    bool has_{member.name};"
            yield f"    {member.declaration()}"
        yield "};"
        yield f"extern const char *const {request.c_name}_members[]; /* NULL-terminated */"
        yield f"bool {request.c_name}_read(const struct proto_object *object, struct {request.c_name} *out);"
        if request.name.endswith("Request"):
            yield f"bool {request.c_name}_decode(const json_t *document, struct {request.c_name} *out,\n    struct proto_problem *problem);"
        if request.releases():
            yield f"void {request.c_name}_free(struct {request.c_name} *request); /* a second time is harmless */"
        yield ""
    yield "#endif"


def take_value(name, kind, decode):
    return f"""static bool take_{name}(const struct proto_object *object, const struct proto_rule *rule,
    {kind} *out)
{{
    char place[PROTO_PLACE];
    const json_t *value = proto_object_find(object, rule, place);
    return value ? {decode} : !rule->is_required;
}}
"""


def take_object(request):
    name = snake(request.name)
    return f"""static bool decode_{name}(const json_t *value, const char *place, struct {request.c_name} *out,
    struct proto_problem *problem)
{{
    const struct proto_object object = {{value, place, problem}};
    return proto_decode_object(value, place, {request.c_name}_members, problem) &&
           {request.c_name}_read(&object, out);
}}
"""


def take_list(reference, kind, decode):
    return f"""static bool take_{snake(reference)}_list(const struct proto_object *object, const struct proto_rule *rule,
    struct proto_{snake(reference)}_list *out)
{{
    bool ok;
    char place[PROTO_PLACE], item[PROTO_PLACE];
    const json_t *list = proto_object_list(object, rule, place, &ok);
    if (!list) return ok;
    size_t count = json_array_size(list);
    out->items = malloc((count + 1) * sizeof *out->items);
    if (!out->items) return proto_problem_from_status(object->problem, GD_NO_MEMORY, NULL);
    for (; out->count < count; out->count++) {{
        proto_place_of_element(item, place, out->count);
        if (!{decode}(json_array_get(list, out->count), item, &out->items[out->count], object->problem)) return false;
    }}
    return true;
}}
"""


TAKE_POINTS = """static bool take_points(const struct proto_object *object, const struct proto_rule *rule,
    struct proto_points *out)
{
    char place[PROTO_PLACE];
    const json_t *value = proto_object_find(object, rule, place);
    if (!value) return !rule->is_required;
    return proto_points_decode(out, value, place, (uint32_t)rule->most, object->problem) &&
           proto_rule_check(rule, out->count, place, object->problem);
}
"""
TAKE_UVS = """static bool take_uvs(const struct proto_object *object, const struct proto_rule *rule,
    struct proto_uvs *out)
{
    return proto_uvs_decode(object->value, object->place, rule->name, (uint32_t)rule->most, out, object->problem);
}
"""


def take_functions(every):
    """Returns the functions for hand-decoded values and for lists, each before its first use."""
    members = [member for request in every for member in request.members]
    if any(member.kind == "points" and member.item_reference == "Point" for member in members):
        yield TAKE_POINTS
    if any(member.kind == "points" and member.item_reference == "Place" for member in members):
        yield TAKE_UVS
    for name in sorted({member.reference for member in members if member.kind == "value"}):
        kind, _, decode, _ = VALUES[name]
        yield take_value(snake(name), kind, f"{decode}(value, place, out, object->problem)")


def read_function(request):
    yield f"bool {request.c_name}_read(const struct proto_object *object, struct {request.c_name} *out)\n{{"
    yield "    enum { " + ", ".join(upper(member.name) for member in request.members) + " };"
    yield "    static const struct proto_rule rules[] = {"
    yield from (f"        [{upper(member.name)}] = {member.rule()}," for member in request.members)
    yield "    };"
    initial = ", ".join(text for text in (member.initial() for member in request.members) if text) or "0"
    yield f"    struct {request.c_name} read = {{{initial}}};"
    yield from (f"    read.has_{member.name} = proto_object_has(object, {c_string(member.name)});" for member in request.members if member.has_flag)
    calls = [member.take() for member in request.members]
    if "x-one-of" in request.schema:
        rule = request.schema["x-one-of"]
        calls.insert(0, f"proto_object_one_of(object, {', '.join(map(c_string, rule['members']))}, {c_string(rule['refusal'])})")
    yield "    bool ok = " + " &&\n              ".join(calls) + ";"
    yield "    if (ok) *out = read;"
    if request.releases():
        yield f"    if (!ok) {request.c_name}_free(&read);"
    yield "    return ok;\n}\n"


def request_source(document):
    every = requests(document)
    kinds, decoders = lists(every), {name: value[2] for name, value in VALUES.items()}
    yield '/* Made by generate.py from openapi.yaml. */\n#include "generated/requests.h"\n\n#include <math.h>\n#include <stdlib.h>\n'
    for member in words(every):
        yield f"const char *const proto_{snake(member.name)}_words[] = {{{', '.join(map(c_string, member.schema['enum']))}, NULL}};"
    yield ""
    yield from take_functions(every)
    done = set()
    for request in every:
        for member in request.members:
            if member.kind == "list" and member.item_reference not in done:
                done.add(member.item_reference)
                yield take_list(member.item_reference, kinds[member.item_reference], decoders[member.item_reference])
        yield f"/* --- {request.name} --- */\n"
        names = "".join(f"    {c_string(name)},\n" for name in request.names)
        yield f"const char *const {request.c_name}_members[] = {{\n{names}    NULL}};\n"
        if request.is_by_hand:
            continue
        if request.releases():
            yield f"void {request.c_name}_free(struct {request.c_name} *request)\n{{"
            yield from (f"    {text}" for text in request.releases())
            yield "}\n"
        yield from read_function(request)
        if request.name.endswith("Request"):
            yield f"bool {request.c_name}_decode(const json_t *document, struct {request.c_name} *out,\n    struct proto_problem *problem)\n{{"
            yield '    const struct proto_object object = {document, "", problem};'
            yield f'    return proto_decode_object(document, "", {request.c_name}_members, problem) &&\n           {request.c_name}_read(&object, out);\n}}\n'
        else:
            decoders[request.name] = f"decode_{snake(request.name)}"
            yield take_object(request)
            name = snake(request.name)
            if any(member.kind == "object" and member.reference == request.name for other in every for member in other.members):
                yield take_value(name, f"struct {request.c_name}", f"decode_{name}(value, place, out, object->problem)")
