"""Members of requests, in C, from the contract.

A schema `…Request` with properties, and each object that it refers to, becomes a struct and a
function that reads it. A type that C decodes by hand is in VALUES; a member of `x-by-hand` is not
in the struct. The contract has the sentences of problems beside the properties:

    x-by-hand    [member…], or all: then the generator makes only the list of their names
    x-unchecked  [member…]: C checks the limits of these members
    x-check      true: proto_<name>_check, written by hand, runs after all members are read
    x-refusals   {member: sentence}: for a value outside its limits, an unknown word, no array
    x-expected   {member: sentence}: for a value that is not an array, if the sentence differs
    x-too-large  {member: sentence}: for a value above its maximum; the problem is too_large then
    x-one-of     {members: [a, b], refusal: sentence}: exactly one of the two is present

A `oneOf` of objects with `x-forms: {refusal: sentence}` becomes a struct with the member `form`,
and a function that reads it. A form has the name of its first required member.

    first: true      the first form that is present decides; else exactly one may be present
    more: [name…]    forms that only C makes
    place: true      the struct keeps the JSON Pointer of the value as `place`
    x-foreign        in a form, {member: sentence}: for a member of another form
"""
from members import c_string, follow, snake, upper

# lists that have their own struct: the struct, its header, and the name of its functions
LISTS = {"Point": ("struct proto_points", "values/points.h", "points"), "Place": ("struct proto_uvs", "values/uv.h", "uvs"),
         "Interval": ("struct proto_uvs", "values/uv.h", "uvs")}
# values that hand-written functions decode: type, header, decode function, free function
VALUES = {
    "Set": ("struct proto_set", "values/set.h", "proto_set_decode", "proto_set_free"),
    "DirectionRequest": ("struct proto_direction", "values/direction.h", "proto_direction_decode", None),
    "Name": ("struct proto_name", "values/mesh.h", "proto_name_decode", None),
    "PictureColor": ("uint32_t", "values/pen.h", "proto_color_decode", None),
    "PictureLabel": ("struct proto_label", "values/pen.h", "proto_label_decode", None),
    "SplineCurve": ("struct proto_spline", "values/spline.h", "proto_spline_curve_decode", "proto_spline_free"),
}
# forms that hand-written headers need; the generator puts them into values.h
EARLY = ("Point",)
# forms that may also be a text: the function that reads the text, and its header
TEXTS = {"Point": ("proto_point_parse", "values/point.h")}

DECODE = "(const json_t *value, const char *place, struct {name} *out,\n    struct proto_problem *problem)"


def number(value):
    return "INFINITY" if value is None else repr(value)


def texts(names):
    return "{" + ", ".join([*map(c_string, names), "NULL"]) + "}"


# --- members --------------------------------------------------------------------------------------


class Member:
    """A request's property in C."""

    def __init__(self, document, owner, name, schema):
        self.document, self.name, self.owner, self.c_name = document, name, owner, snake(name)
        self.is_required, self.is_unchecked = name in schema.get("required", []), name in schema.get("x-unchecked", [])
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
        if kind == "array" and self.item_reference in LISTS:
            return "points"
        if kind == "array" and "minItems" in schema and schema["minItems"] == schema.get("maxItems"):
            return {"number": "numbers", "integer": "indices"}[self.item["type"]]
        if kind == "array" and (self.item_reference in VALUES or self.item.get("type") == "object" or "x-forms" in self.item):
            return "list"
        if kind == "array" and self.item.get("type") in ("number", "integer"):
            return {"number": "reals", "integer": "index_list"}[self.item["type"]]
        if kind == "object" or "x-forms" in schema:
            return "object"
        return {"number": "number", "integer": "index", "boolean": "flag"}.get(kind) or self.refuse()

    def refuse(self):
        raise SystemExit(f"{self.owner}.{self.name}: C has no decoder for this; name it in x-by-hand, or add one to VALUES")

    @property
    def has_flag(self):
        """Returns whether the struct needs a flag, that is, whether the member is optional and has
        neither a default nor a value that means "missing"."""
        return not self.is_required and self.default is None and self.kind not in ("flag", "points", "list", "reals", "index_list")

    @property
    def is_numbers(self):
        """Returns whether the member is a list of numbers, or of pairs of them."""
        return self.kind in ("reals", "index_list") or self.kind == "points" and LISTS[self.item_reference][2] == "uvs"

    def declaration(self):
        count, name = self.schema.get("minItems"), self.c_name
        return {
            "value": f"{VALUES.get(self.reference, [''])[0]} {name};",
            "word": f"unsigned {name}; /* PROTO_{upper(name)}_… */",
            "points": f"{LISTS.get(self.item_reference, [''])[0]} {name};",
            "numbers": f"double {name}[{count}];",
            "indices": f"uint32_t {name}[{count}];",
            "reals": f"struct proto_reals {name};",
            "index_list": f"struct proto_indices {name};",
            "list": f"struct proto_{snake(self.item_reference or 'none')}_list {name};",
            "object": f"struct proto_{snake(self.reference or 'none')} {name};",
            "number": f"double {name};",
            "index": f"uint32_t {name};",
            "flag": f"bool {name};",
        }[self.kind]

    def declarations(self):
        return [f"bool has_{self.c_name};"] * self.has_flag + [self.declaration()]

    def initial(self):
        """Returns the default as a C expression, or None."""
        if self.default is None:
            return None
        if self.kind == "word":
            return self.word(self.default)
        return str(self.default).lower() if isinstance(self.default, bool) else str(self.default)

    def word(self, text):
        return f"PROTO_{upper(self.name)}_{upper(text)}"

    # --- its rule ---

    def limits(self):
        """Returns the least and the greatest value or length, and whether the least is excluded."""
        if self.is_unchecked:
            return None, None, False
        if self.is_numbers:
            return min(1, self.schema.get("minItems", 0)), self.schema.get("maxItems", 0xFFFFFFFF), False
        if self.kind in ("points", "list"):
            return self.schema.get("minItems", 0), self.schema.get("maxItems", 0xFFFFFFFF), False
        schema = self.item if self.kind == "indices" else self.schema
        return schema.get("exclusiveMinimum", schema.get("minimum")), schema.get("maximum"), "exclusiveMinimum" in schema

    def rule(self):
        """Returns the initializer of its struct proto_rule."""
        least, most, is_above = self.limits()
        parts = [f".name = {c_string(self.name)}"]
        if self.is_required:
            parts.append(".is_required = true")
        if is_above:
            parts.append(".is_above = true")
        if self.kind in ("points", "list", "reals", "index_list", "number", "index", "indices"):
            parts += [f".least = {'-INFINITY' if least is None else number(least)}", f".most = {number(most)}"]
        if self.kind == "word":
            parts.append(f".words = proto_{snake(self.name)}_words")
        for name, sentence in (("refusal", self.refusal or self.sentence()), ("expected", self.expected), ("too_large", self.too_large or self.excess())):
            if sentence:
                parts.append(f".{name} = {c_string(sentence)}")
        return "{" + ", ".join(parts) + "}"

    def excess(self):
        most = self.limits()[1]
        has_limit = self.is_numbers and not self.refusal and most not in (None, 0xFFFFFFFF)
        return f"at most {most} elements are taken here; send fewer" if has_limit else None

    def sentence(self):
        """Returns the sentence of a problem with the valid values, or None."""
        least, most, is_above = self.limits()
        if self.kind == "word":
            return f"{self.name} is " + " or ".join(f'"{word}"' for word in self.schema["enum"])
        if self.is_numbers and not least:
            return "expected an array of numbers"
        if self.kind in ("points", "list", "reals", "index_list"):
            return f"expected an array of at least one {'point' if self.item_reference == 'Point' else 'element'}"
        if self.kind not in ("number", "index", "indices"):
            return None
        what = "a number" if self.kind == "number" else "a whole number"
        if is_above:
            return f"{self.name} is {what} of more than {least}"
        if most is not None:
            return f"{self.name} is {what} from {least} to {most}"
        return f"{self.name} is {what} of at least {least}" if least is not None else None

    # --- its code ---

    def take(self):
        """Returns the call that reads the member into `read`."""
        rule, target, count = f"&rules[{upper(self.name)}]", f"&read->{self.c_name}", self.schema.get("minItems")
        if self.kind in ("numbers", "indices"):
            return f"proto_take_{self.kind}(object, {rule}, {count}, read->{self.c_name})"
        names = {"value": snake(self.reference or ""), "object": snake(self.reference or ""), "list": snake(self.item_reference or "") + "_list",
                 "points": LISTS.get(self.item_reference, ["", "", ""])[2]}
        prefix = "take_" if self.kind in names and names[self.kind] != "uvs" else "proto_take_"
        return f"{prefix}{names.get(self.kind, self.kind)}(object, {rule}, {target})"

    def release_items(self, member):
        """Returns the statement that frees what the items of a list own."""
        if self.item_reference in VALUES or not made(self.document, self.item_reference, self.item).releases():
            return []
        return [f"for (uint32_t i = 0; i < {member}.count; i++) proto_{snake(self.item_reference)}_free(&{member}.items[i]);"]

    def release(self):
        """Returns the statements that free the member."""
        member = f"request->{self.c_name}"
        if self.kind == "value" and VALUES[self.reference][3]:
            return [f"{VALUES[self.reference][3]}(&{member});"]
        if self.kind == "points":
            return [f"proto_{LISTS[self.item_reference][2]}_free(&{member});"]
        if self.kind in ("reals", "index_list"):
            return [f"proto_{'reals' if self.kind == 'reals' else 'indices'}_free(&{member});"]
        if self.kind == "list":
            return [*self.release_items(member), f"free({member}.items);", f"{member} = (struct proto_{snake(self.item_reference)}_list){{0}};"]
        if self.kind == "object" and made(self.document, self.reference, self.schema).releases():
            return [f"proto_{snake(self.reference)}_free(&{member});"]
        return []


# --- requests and forms ---------------------------------------------------------------------------


class Object:
    """A schema with properties."""

    def __init__(self, document, name, schema):
        self.name, self.schema = name, schema
        self.names, by_hand = list(schema["properties"]), schema.get("x-by-hand", [])
        self.is_by_hand = by_hand == "all"
        self.members = [] if self.is_by_hand else [Member(document, name, key, schema) for key in self.names if key not in by_hand]
        self.has_check, self.is_form = schema.get("x-check", False), False

    @property
    def c_name(self):
        return f"proto_{snake(self.name)}"

    def releases(self):
        return [text for member in self.members for text in member.release()]

    def structure(self):
        return [text for member in self.members for text in member.declarations()]


class Form(Object):
    """A oneOf of objects."""

    def __init__(self, document, name, schema):
        rule, self.name, self.schema, self.is_by_hand, self.is_form = schema["x-forms"], name, schema, False, True
        self.refusal, self.is_first, self.has_place, self.has_check = rule["refusal"], rule.get("first"), rule.get("place"), schema.get("x-check", False)
        branches = [follow(document, branch) for branch in schema["oneOf"]]
        self.branches = [Object(document, reference, branch) for branch, reference in branches if branch.get("type") == "object"]
        self.names = list(dict.fromkeys(name for branch in self.branches for name in branch.names))
        self.members = list({member.name: member for branch in self.branches for member in branch.members}.values())
        self.forms = [branch.schema["required"][0] for branch in self.branches] + rule.get("more", [])

    def structure(self):
        """Returns the declarations. Forms without common or owned members share their memory."""
        lines = [f"enum {self.c_name}_form form;"]
        if self.has_place:
            lines.append("char place[PROTO_KEPT_PLACE];")
        if self.releases() or len(self.members) < sum(len(branch.members) for branch in self.branches):
            return lines + super().structure()
        inner = [f"    struct {{ {' '.join(branch.structure())} }};" for branch in self.branches]
        return [*lines, "union {", *inner, "};"]


def made(document, name, schema):
    return (Form if "x-forms" in schema else Object)(document, name, schema)


def requests(document):
    """Returns the requests and forms, each after the objects that it refers to."""
    found = {}

    def add(name, schema):
        if name in found:
            return
        request = made(document, name, schema)
        for member in request.members:
            if member.kind == "object":
                add(member.reference, member.schema)
            if member.kind == "list" and member.item_reference not in VALUES:
                add(member.item_reference, member.item)
            if member.kind == "points" and member.item_reference in EARLY:
                add(member.item_reference, member.item)
        found[name] = request

    branches = {branch.get("$ref", "").split("/")[-1] for schema in document["components"]["schemas"].values() if "x-forms" in schema for branch in schema["oneOf"]}
    for name, schema in document["components"]["schemas"].items():
        if name in branches:
            continue
        if "x-forms" in schema or "properties" in schema and (name.endswith("Request") or "x-by-hand" in schema or "x-check" in schema):
            add(name, schema)
    return list(found.values())


def is_early(document, request):
    """Returns whether the request is in values.h: a form of EARLY, or an object of such a form."""
    inner = {member.reference for name in EARLY for member in Form(document, name, document["components"]["schemas"][name]).members}
    return request.name in EARLY or request.name in inner


def words(all_requests):
    """Returns (member, words) of each enumeration. Members of one name share one enumeration."""
    found = {}
    for member in (member for request in all_requests for member in request.members if member.kind == "word"):
        if found.setdefault(member.name, member).schema["enum"] != member.schema["enum"]:
            raise SystemExit(f"{member.owner}.{member.name}: another enumeration has this name; name it in x-by-hand")
    return found.values()


def item_types(all_requests):
    """Returns the types of list items by their names."""
    found = {}
    for member in (member for request in all_requests for member in request.members if member.kind == "list"):
        reference = member.item_reference
        found[reference] = VALUES[reference][0] if reference in VALUES else f"struct proto_{snake(reference)}"
    return found


# --- the header -----------------------------------------------------------------------------------


def limits(request):
    for member in request.members:
        most = member.schema.get("maximum" if member.kind == "index" else "maxItems", 0xFFFFFFFE)
        if member.kind in ("index", "points", "list", "reals", "index_list") and most < 0xFFFFFFFE:
            yield f"#define PROTO_{upper(request.name)}_{upper(member.name)}_MOST {most}"


def list_struct(reference, kind):
    return f"struct proto_{snake(reference)}_list {{ /* all zero is an empty one */\n    {kind} *items;\n    uint32_t count;\n}};\n"


def request_declarations(request):
    yield from limits(request)
    if request.is_form:
        yield f"enum {request.c_name}_form {{"
        yield from (f"    PROTO_{upper(request.name)}_{upper(form)}," for form in request.forms)
        yield "};"
    yield f"struct {request.c_name} {{"
    yield from (f"    {text}" for text in request.structure())
    yield "};"
    yield f"extern const char *const {request.c_name}_members[]; /* NULL-terminated */"
    if request.is_form:
        yield f"extern const char *const {request.c_name}_forms[]; /* by form; NULL-terminated */"
    if request.is_form:
        yield f"bool {request.c_name}_decode{DECODE.format(name=request.c_name)};"
    else:
        yield f"bool {request.c_name}_read(const struct proto_object *object, struct {request.c_name} *out);"
    if request.name.endswith("Request"):
        yield f"bool {request.c_name}_decode(const json_t *document, struct {request.c_name} *out,\n    struct proto_problem *problem);"
    if request.has_check:
        yield f"bool {request.c_name}_check(const struct proto_object *object, struct {request.c_name} *read); /* by hand */"
    if request.releases():
        yield f"void {request.c_name}_free(struct {request.c_name} *request); /* a second time is harmless */"
    yield ""


def header(headers, every):
    yield "/* Made by generate.py from openapi.yaml: requests, and how they are read. Each _decode and _read checks\n * members, types and limits. The caller checks conditions on several members, and reads the members of\n * x-by-hand. */\n#pragma once\n"
    yield from (f'#include "{each}"' for each in sorted(headers))
    yield ""
    for member in words(every):
        yield "enum {"
        yield from (f"    {member.word(word)}," for word in member.schema["enum"])
        yield "};"
        yield f"extern const char *const proto_{snake(member.name)}_words[]; /* NULL-terminated */\n"
    kinds, printed = item_types(every), set()
    for request in every:
        for member in request.members:
            if member.kind == "list" and member.item_reference not in printed:
                printed.add(member.item_reference)
                yield list_struct(member.item_reference, kinds[member.item_reference])
        if request.is_by_hand:
            yield f"extern const char *const {request.c_name}_members[]; /* NULL-terminated */\n"
        else:
            yield from request_declarations(request)


def early_and_late(document):
    every = requests(document)
    early = [request for request in every if is_early(document, request)]
    return early, [request for request in every if request not in early]


def value_header(document):
    return header(["proto/json/object.h"], early_and_late(document)[0])


def request_header(document):
    every = early_and_late(document)[1]
    members = [member for request in every for member in request.members]
    used = {member.reference for member in members if member.kind == "value"}
    used |= {member.item_reference for member in members if member.kind == "list"} & VALUES.keys()
    headers = {VALUES[name][1] for name in used} | {LISTS[member.item_reference][1] for member in members if member.kind == "points"}
    return header(["generated/values.h", "proto/json/object.h", *(f"proto/{each}" for each in headers)], every)


# --- the source -----------------------------------------------------------------------------------


def take_value(name, kind, decode):
    return f"""static bool take_{name}(const struct proto_object *object, const struct proto_rule *rule,
    {kind} *out)
{{
    char place[PROTO_PLACE];
    const json_t *value = proto_object_find(object, rule, place);
    return value ? {decode}(value, place, out, object->problem) : !rule->is_required;
}}
"""


def decode_object(request):
    return f"""static bool decode_{snake(request.name)}{DECODE.format(name=request.c_name)}
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


def rules(members):
    yield "    enum { " + ", ".join(upper(member.name) for member in members) + " };"
    yield "    static const struct proto_rule rules[] = {"
    yield from (f"        [{upper(member.name)}] = {member.rule()}," for member in members)
    yield "    };"


def fill(request):
    """Returns the statements that set defaults and flags in `read`, and the calls that read the
    members."""
    lines = [f"    read->{member.c_name} = {member.initial()};" for member in request.members if member.initial() is not None]
    lines += [f"    read->has_{member.c_name} = proto_object_has(object, {c_string(member.name)});" for member in request.members if member.has_flag]
    calls = [member.take() for member in request.members]
    if "x-one-of" in request.schema:
        rule = request.schema["x-one-of"]
        calls.insert(0, f"proto_object_one_of(object, {', '.join(map(c_string, rule['members']))}, {c_string(rule['refusal'])})")
    return lines, calls


def read_function(request):
    lines, calls = fill(request)
    if request.has_check:
        calls.append(f"{request.c_name}_check(object, read)")
    yield f"bool {request.c_name}_read(const struct proto_object *object, struct {request.c_name} *out)\n{{"
    if request.members:
        yield from rules(request.members)
    yield f"    struct {request.c_name} filled = {{0}}, *read = &filled;"
    yield from lines
    yield "    bool ok = " + " &&\n              ".join(calls) + ";"
    yield "    if (ok) *out = filled;"
    if request.releases():
        yield f"    if (!ok) {request.c_name}_free(read);"
    yield "    return ok;\n}\n"


def form_function(form, branch):
    """Returns the function that reads one form's members."""
    lines, calls = fill(branch)
    yield f"static bool read_{snake(branch.name)}(const struct proto_object *object, struct {form.c_name} *read)\n{{"
    yield f"    static const char *const members[] = {texts(branch.names)};"
    yield from rules(branch.members) if branch.members else ["    (void)read;"]
    for name, sentence in branch.schema.get("x-foreign", {}).items():
        yield f"    if (proto_object_has(object, {c_string(name)}))\n        return proto_problem_refuse_member(object->problem, object->place, {c_string(name)}, \"%s\", {c_string(sentence)});"
    yield from lines
    yield "    return " + " &&\n           ".join(["proto_decode_object(object->value, object->place, members, object->problem)", *calls]) + ";\n}\n"


def forms_function(form):
    """Returns the function that finds the form and reads it."""
    for branch in form.branches:
        yield from form_function(form, branch)
    yield f"const char *const {form.c_name}_forms[] = {texts(form.forms[:len(form.branches)])};\n"
    yield f"bool {form.c_name}_decode{DECODE.format(name=form.c_name)}\n{{"
    yield "    const struct proto_object object = {value, place, problem};"
    yield f"    struct {form.c_name} read = {{0}};\n    unsigned form;\n    bool ok = false;"
    if form.name in TEXTS:
        yield f"    if (json_is_string(value)) return {TEXTS[form.name][0]}(json_string_value(value), place, out, problem);"
    known = "NULL" if form.is_first else f"{form.c_name}_members"
    yield f"    if (!proto_object_form(&object, {known}, {form.c_name}_forms, {c_string(form.refusal)}, &form)) return false;"
    yield f"    read.form = (enum {form.c_name}_form)form;"
    if form.has_place:
        yield "    proto_place_keep(read.place, place);"
    yield "    switch (read.form) {"
    for branch, name in zip(form.branches, form.forms):
        yield f"    case PROTO_{upper(form.name)}_{upper(name)}:\n        ok = read_{snake(branch.name)}(&object, &read);\n        break;"
    for name in form.forms[len(form.branches):]:
        yield f"    case PROTO_{upper(form.name)}_{upper(name)}:\n        break;"
    yield "    }"
    if form.has_check:
        yield f"    ok = ok && {form.c_name}_check(&object, &read);"
    yield "    if (ok) *out = read;"
    if form.releases():
        yield f"    if (!ok) {form.c_name}_free(&read);"
    yield "    return ok;\n}\n"


def request_functions(request):
    yield f"/* --- {request.name} --- */\n"
    names = "".join(f"    {c_string(name)},\n" for name in request.names)
    yield f"const char *const {request.c_name}_members[] = {{\n{names}    NULL}};\n"
    if request.is_by_hand:
        return
    if request.releases():
        yield f"void {request.c_name}_free(struct {request.c_name} *request)\n{{"
        yield from (f"    {text}" for text in request.releases())
        yield "}\n"
    yield from (forms_function if request.is_form else read_function)(request)
    if request.name.endswith("Request"):
        yield f"bool {request.c_name}_decode(const json_t *document, struct {request.c_name} *out,\n    struct proto_problem *problem)\n{{"
        yield '    const struct proto_object object = {document, "", problem};'
        yield f'    return proto_decode_object(document, "", {request.c_name}_members, problem) &&\n           {request.c_name}_read(&object, out);\n}}\n'


def decoders(document, every):
    """Returns (type, decode function) of each value and object that a member refers to."""
    found = {name: (kind, decode) for name, (kind, _, decode, _) in VALUES.items()}
    for request in every:
        prefix = "proto_" if request.is_form else "decode_"
        if request.name not in VALUES:
            found[request.name] = (f"struct {request.c_name}", f"{prefix}{snake(request.name)}" + ("_decode" if request.is_form else ""))
    return found


def source(document, name, every, headers):
    known = decoders(document, requests(document))
    members = [member for request in every for member in request.members]
    used = {member.item_reference for member in members if member.kind == "list"} | {member.reference for member in members if member.kind in ("value", "object")}
    yield f'/* Made by generate.py from openapi.yaml. */\n#include "generated/{name}.h"\n\n#include <math.h>\n#include <stdlib.h>\n'
    yield from (f'#include "proto/{each}"' for each in headers)
    yield ""
    for member in words(every):
        yield f"const char *const proto_{snake(member.name)}_words[] = {texts(member.schema['enum'])};"
    yield ""
    if any(member.item_reference == "Point" for member in members):
        yield TAKE_POINTS
    done = set()
    for request in every:
        for member in request.members:
            reference, key = (member.item_reference, "list") if member.kind == "list" else (member.reference, "value")
            if member.kind in ("list", "value", "object") and (reference, key) not in done:
                done.add((reference, key))
                yield (take_list if key == "list" else take_value)(reference if key == "list" else snake(reference), *known[reference])
        yield from request_functions(request)
        if request.name in used and not request.is_form and not request.is_by_hand:
            yield decode_object(request)


def value_source(document):
    return source(document, "values", early_and_late(document)[0], sorted({path for _, path in TEXTS.values()}))


def request_source(document):
    return source(document, "requests", early_and_late(document)[1], [])
