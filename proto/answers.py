"""Objects of answers, in C, from the contract.

For each row of ANSWERS the generator makes `proto_<schema>_encode`. This function writes one object
with the members of the schema, in their order, from a C struct. By default a member has the value
of the struct's member of the same name.
"""
import dataclasses

from members import c_string, follow, snake, upper

KINDS = {"number": "number", "boolean": "bool", "string": "string"}


@dataclasses.dataclass
class Answer:
    source: str  # C type that the object is written from; the function's parameter is `from`
    header: str  # header that declares the type
    base: str = "from->"  # C text before a member's name
    own: tuple = ()  # members that are those of `from`, not of `base`
    values: dict = dataclasses.field(default_factory=dict)  # member: C expression
    when: dict = dataclasses.field(default_factory=dict)  # optional member: C condition
    hand: tuple = ()  # members written by proto_<schema>_encode_<member>, by hand
    without: tuple = ()  # members that other code writes
    fields: str = ""  # list of fields: the function writes the fields that its options select


ANSWERS = {
    "BoundaryLoop": Answer("struct gd_boundary", "gd/mesh.h"),
    "Mesh": Answer("struct proto_mesh_description", "proto/values/mesh.h", base="gd_mesh_summary(from->mesh)->",
                   own=("name", "sha256", "memory_bytes", "fields_cached", "created", "etag"),
                   values={"boundary_count": "gd_mesh_summary(from->mesh)->boundaries",
                           "orientation.flipped_faces": "gd_mesh_summary(from->mesh)->flipped_faces",
                           "bounding_box.min": "gd_mesh_summary(from->mesh)->min", "bounding_box.max": "gd_mesh_summary(from->mesh)->max"},
                   when={"boundary_count": "true", "derived_from": "from->derived.mesh"}, hand=("boundaries", "repair", "derived_from"), without=("description",)),
    "Subdivision": Answer("struct proto_subdivision_description", "proto/queries/subdivision.h", base="from->summary.",
                          own=("name", "sha256", "memory_bytes", "created", "etag"),
                          values={"scheme": "proto_scheme_words[gd_subdivision_scheme(from->surface)]",
                                  "vertices": "from->summary.vertex_count", "edges": "from->summary.edge_count", "faces": "from->summary.face_count",
                                  "boundaries": "from->summary.boundary_loops",
                                  "least_level": "gd_limit_mesh_least_level(from->surface)", "usual_level": "gd_limit_mesh_usual_level(from->surface)"},
                          hand=("extraordinary_vertices",), without=("description",)),
    "NurbsAxis": Answer("struct gd_axis", "gd/parametric.h", values={"range": "((double[]){from->low, from->high})", "pieces": "from->line_count + UINT64_C(1)"}),
    "Nurbs": Answer("struct proto_nurbs_description", "proto/queries/nurbs.h",
                    values={"shape": "from->form.shape", "convention": "from->form.convention", "degree": "from->form.degree", "control_points": "from->form.count",
                            "rational": "from->form.is_rational", "domain.u": "*gd_parametric_axis_u(from->surface)", "domain.v": "*gd_parametric_axis_v(from->surface)",
                            "size": "gd_parametric_size(from->surface)", "geodesics": "from->seeding_faces > 0", "reason": "from->obstacle",
                            "outer_loop": "from->has_outer_loop"},
                    when={**dict.fromkeys(("convention", "degree", "control_points", "rational"), "from->form.convention"),
                          "seeding_faces": "from->seeding_faces > 0", "reason": "from->seeding_faces == 0",
                          "trimming_loops": "from->trimming_loops", "outer_loop": "from->trimming_loops"}, without=("description",)),
    "SplineFrame": Answer("struct proto_spline_frame", "proto/values/spline.h", base="from->frame.", values={"xyz": "from->frame.position", "speed": "from->speed"}),
    "SplineJoint": Answer("struct gd_spline_knot", "proto/values/spline.h", hand=("tangent",)),
    "Wedge": Answer("struct gd_wedge", "gd/field.h", when={"linear": "from->linear", "source.vertex": "from->at_vertex", "source.member": "!from->at_vertex"},
                    values={"source.vertex": "from->source", "source.member": "from->source"}),
    "Service": Answer("struct proto_service", "proto/http/service.h", hand=("capabilities",)),
    "FootAnswer": Answer("struct gd_parametric_closest", "gd/parametric.h", values={"uv": "((double[]){from->u, from->v})"}, fields="Foot"),
    "LimitFootAnswer": Answer("struct gd_limit_closest", "gd/limit.h", base="from->place.", own=("distance",),
                              values={"uv": "((double[]){from->place.u, from->place.v})", "xyz": "from->position"},
                              when={"corner": "from->place.corner"}, fields="LimitFoot"),
    "JobResponse": Answer("struct proto_job_answer", "proto/http/job.h", values={"bytes": "from->size"}, hand=("headers",)),
    "Batch": Answer("struct proto_many_state", "proto/queries/many.h", values={"state": "proto_many_state_name(from)", "progress": "(double)from->done / (double)from->items"}),
}


# --- members --------------------------------------------------------------------------------------


def kind_of(schema):
    types = schema.get("type")
    types = [each for each in types if each != "null"] if isinstance(types, list) else [types]
    if schema.get("const") is True:
        return "bool"
    if types == ["string"] and schema.get("format") == "date-time":
        return "time"
    if types == ["integer"]:
        return "uint" if schema.get("minimum") == 0 or schema.get("minimum", 0) > 0 else "int"
    return KINDS.get(types[0])


class Writer:
    """Writes the C function of one answer."""

    def __init__(self, document, name):
        self.document, self.name, self.answer = document, name, ANSWERS[name]
        self.schema = document["components"]["schemas"][name]

    @property
    def c_name(self):
        return f"proto_{snake(self.name.removesuffix('Answer'))}_encode"

    def signature(self):
        options = ",\n    const struct proto_options *options" if self.answer.fields else ""
        return f"void {self.c_name}(struct proto_writer *writer, const {self.answer.source} *from{options})"

    def hand_signatures(self):
        return [f"void {self.c_name}_{snake(member)}(struct proto_writer *writer, const {self.answer.source} *from); /* by hand */"
                for member in self.answer.hand]

    def value(self, path):
        name = path.split(".")[0]
        return self.answer.values.get(path, f"{'from->' if name in self.answer.own else self.answer.base}{path}")

    def write(self, path, schema):
        """Returns statements that write the value of a member."""
        inner, reference = follow(self.document, schema)
        value, items = self.value(path), follow(self.document, inner.get("items", {}))[0]
        if path in self.answer.hand:
            return [f"{self.c_name}_{snake(path)}(writer, from);"]
        if reference == "Vector":
            return [f"proto_xyz_encode(writer, {value});"]
        if reference in ANSWERS:
            return [f"proto_{snake(reference)}_encode(writer, &{value});"]
        if inner.get("type") == "array" and "minItems" in inner and inner["minItems"] == inner.get("maxItems"):
            function = {"number": "numbers", "integer": "indices"}[items["type"]]
            return [f"proto_write_{function}(writer, {value}, {inner['minItems']});"]
        if inner.get("type") == "object":
            return ["proto_write_object_begin(writer);", *self.members(inner, path + "."), "proto_write_object_end(writer);"]
        kind = kind_of(inner)
        if not kind:
            raise SystemExit(f"{self.name}.{path}: no function writes this; name it in `hand`")
        return [f"proto_write_{kind}(writer, {value});"]

    def members(self, schema, prefix=""):
        """Returns statements that write the members of an object."""
        lines = []
        for name, member in schema["properties"].items():
            path = prefix + name
            if path in self.answer.without:
                continue
            if name not in schema.get("required", []) and path not in self.answer.when and not self.answer.fields:
                raise SystemExit(f"{self.name}.{path} is optional: say when it is written")
            lines += self.member(path, name, member)
        return lines

    def member(self, path, name, schema):
        key = f"proto_write_key(writer, {c_string(name)});"
        condition = [self.answer.when[path]] if path in self.answer.when and self.answer.when[path] != "true" else []
        if self.answer.fields and path == name:
            condition.append(f"proto_field(writer, options, PROTO_{upper(self.answer.fields)}_FIELD_{upper(name)})")
            key = ""
        lines = [key] * bool(key) + self.write(path, schema)
        if not condition:
            return lines
        return [f"if ({' && '.join(condition)}) {{", *("    " + line for line in lines), "}"]

    def source(self):
        body = "".join(f"    {line}\n" for line in self.members(self.schema))
        return f"{self.signature()}\n{{\n    proto_write_object_begin(writer);\n{body}    proto_write_object_end(writer);\n}}\n"


# --- files ----------------------------------------------------------------------------------------


def answer_header(document):
    yield "/* Made by generate.py from openapi.yaml: objects of answers (answers.py). */\n#pragma once\n"
    yield '#include "proto/http/options.h"\n#include "proto/json/writer.h"\n'
    writers = [Writer(document, name) for name in ANSWERS]
    yield from (f"{source};" for source in sorted({writer.answer.source for writer in writers}))
    yield ""
    for writer in writers:
        yield f"{writer.signature()};"
        yield from writer.hand_signatures()


def answer_source(document):
    yield '/* Made by generate.py from openapi.yaml. */\n#include "generated/answers.h"\n'
    yield from (f'#include "{header}"' for header in sorted({answer.header for answer in ANSWERS.values()} | {"proto/values/point.h"}))
    yield ""
    yield from (Writer(document, name).source() for name in ANSWERS)
