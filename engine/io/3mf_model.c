/* Parses the XML of a 3MF package with expat while the archive is inflated. See 3mf.h. */
#include <expat.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/number.h"
#include "io/3mf.h"

#define CHUNK_BYTES   65536
#define LONGEST_TOKEN ((XML_Index)65536) /* largest size of a tag or a comment, in bytes */
#define DEPTH         64                 /* largest depth of nested elements */
#define NO_OBJECT     UINT32_MAX

struct model {
    struct gd__3mf *package;
    uint32_t part;
    const char *name; /* name of the part, for errors */
    XML_Parser parser;
    enum gd_status status; /* the reason why the parser was stopped */
    unsigned depth;
    size_t prefix;   /* length of the namespace prefix of core elements, including its colon */
    uint32_t object; /* the open object, or NO_OBJECT */
    char *root;      /* while relationships are read: the name of the model; otherwise NULL */
};

/* --- memory of the parser --------------------------------------------------------------------- */

/* Bytes that the parser of this thread has allocated. A thread parses one part at a time. The bytes
 * are limited because the parser keeps the names of all elements until it is freed, so that a
 * document could fill the memory with names. */
static _Thread_local size_t xml_bytes;

union block {
    size_t size;
    max_align_t alignment;
};

static void *xml_realloc(void *old, size_t size)
{
    union block *block = old ? (union block *)old - 1 : NULL;
    size_t before = block ? block->size : 0;
    if (size > GD__3MF_XML_BYTES || xml_bytes - before > GD__3MF_XML_BYTES - size) return NULL;
    block = realloc(block, sizeof *block + size);
    if (!block) return NULL;
    xml_bytes = xml_bytes - before + size;
    block->size = size;
    return block + 1;
}

static void *xml_malloc(size_t size)
{
    return xml_realloc(NULL, size);
}

static void xml_free(void *old)
{
    union block *block = old ? (union block *)old - 1 : NULL;
    if (block) xml_bytes -= block->size;
    free(block);
}

static const XML_Memory_Handling_Suite memory = {xml_malloc, xml_realloc, xml_free};

/* --- errors ----------------------------------------------------------------------------------- */

static void fail(struct model *model, enum gd_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Stops the parser with "3D/3dmodel.model, line 17: <sentence>". Only the first failure is
 * reported. */
static void fail(struct model *model, enum gd_status status, const char *format, ...)
{
    char sentence[GD_DETAIL_TEXT];
    struct gd_detail *detail = model->package->detail;
    unsigned long long line = XML_GetCurrentLineNumber(model->parser);
    va_list arguments;
    if (model->status != GD_OK) return;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    struct gd__word name = {model->name, strlen(model->name)};
    model->status =
        gd_fail(detail, status, "%s, line %llu: %s", gd__excerpt(name).text, line, sentence);
    if (detail) gd_detail_add(detail, GD_ELEMENT_LINE, line, 0);
    XML_StopParser(model->parser, XML_FALSE);
}

static void fail_memory(struct model *model)
{
    fail(model, GD_NO_MEMORY, "the system is out of memory");
}

/* --- attributes ------------------------------------------------------------------------------- */

/* Returns the name without its prefix. Existing files use prefixes of undeclared namespaces, so
 * prefixes are not resolved. */
static const char *local_name(const char *name)
{
    const char *colon = strchr(name, ':');
    return colon ? colon + 1 : name;
}

static const char *attribute(const char **attributes, const char *name)
{
    for (; attributes[0]; attributes += 2)
        if (strcmp(local_name(attributes[0]), name) == 0) return attributes[1];
    return NULL;
}

static const char *skip_space(const char *text)
{
    return text + strspn(text, " \t\r\n");
}

/* Parses `count` numbers that are separated by space. Returns false if the text contains anything
 * else. */
static bool parse_numbers(const char *text, unsigned count, double *out)
{
    const char *end = text + strlen(text);
    for (unsigned i = 0; i < count; i++) {
        const char *begin = skip_space(text);
        text = gd_number_parse(begin, end, &out[i]);
        if (!text || (*text && skip_space(text) == text)) return false;
    }
    return *skip_space(text) == '\0';
}

static double number_of(struct model *model, const char **attributes, const char *name)
{
    const char *text = attribute(attributes, name);
    double number = 0;
    if (!text || !parse_numbers(text, 1, &number))
        fail(model, GD_SYNTAX, "the attribute %s is not a number", name);
    else if (!isfinite(number))
        fail(model, GD_NON_FINITE, "%s is not a finite number", name);
    return number;
}

static uint32_t whole_of(struct model *model, const char **attributes, const char *name)
{
    const char *text = attribute(attributes, name);
    double number = -1;
    if (!text || !parse_numbers(text, 1, &number) || !(number >= 0 && number < UINT32_MAX) ||
        number != floor(number)) {
        fail(model, GD_SYNTAX, "the attribute %s is not a whole number", name);
        return 0;
    }
    return (uint32_t)number;
}

/* --- elements --------------------------------------------------------------------------------- */

static struct gd__3mf_object *open_object(const struct model *model)
{
    return model->object == NO_OBJECT ? NULL : &model->package->objects[model->object];
}

static void begin_model(struct model *model, const char **attributes)
{
    static const struct {
        const char *name;
        double millimetres;
    } units[] = {{"micron", 0.001}, {"millimeter", 1}, {"centimeter", 10},
                 {"inch", 25.4},    {"foot", 304.8},   {"meter", 1000}};
    struct gd__3mf_part *part = &model->package->parts[model->part];
    const char *unit = attribute(attributes, "unit");
    part->unit = unit ? 0 : 1;
    for (size_t i = 0; unit && i < sizeof units / sizeof units[0]; i++)
        if (strcmp(unit, units[i].name) == 0) part->unit = units[i].millimetres;
    if (part->unit == 0)
        fail(model, GD_SYNTAX,
             "the unit is unknown; use micron, millimeter, centimeter, inch, foot or meter");
}

static void begin_object(struct model *model, const char **attributes)
{
    struct gd__3mf *package = model->package;
    const char *type = attribute(attributes, "type");
    bool is_left_out = type && (strcmp(type, "support") == 0 || strcmp(type, "other") == 0 ||
                                strcmp(type, "solidsupport") == 0);
    struct gd__3mf_object object = {.part = model->part,
                                    .id = whole_of(model, attributes, "id"),
                                    .is_left_out = is_left_out,
                                    .first_vertex = package->vertex_count,
                                    .first_triangle = package->triangle_count,
                                    .first_use = package->use_count};
    if (package->object_count == GD__3MF_OBJECTS)
        return fail(model, GD_UNSUPPORTED, "the file has more than %d objects; merge some of them",
                    GD__3MF_OBJECTS);
    if (!gd__3mf_grow((void **)&package->objects, package->object_count, &package->object_capacity,
                      sizeof object))
        return fail_memory(model);
    model->object = package->object_count;
    package->objects[package->object_count++] = object;
}

static void begin_vertex(struct model *model, const char **attributes)
{
    struct gd__3mf *package = model->package;
    static const char *const axes[] = {"x", "y", "z"};
    double xyz[3];
    for (int axis = 0; axis < 3; axis++) xyz[axis] = number_of(model, attributes, axes[axis]);
    if (package->vertex_count == package->limits.max_vertices)
        return fail(model, GD_TOO_LARGE,
                    "the file has more than the configured maximum of %u vertices",
                    package->limits.max_vertices);
    if (!package->is_counting) {
        if (!gd__3mf_grow((void **)&package->positions, package->vertex_count,
                          &package->vertex_capacity, sizeof xyz))
            return fail_memory(model);
        memcpy(package->positions[package->vertex_count], xyz, sizeof xyz);
    }
    package->vertex_count++;
    open_object(model)->vertex_count++;
}

static void begin_triangle(struct model *model, const char **attributes)
{
    struct gd__3mf *package = model->package;
    static const char *const names[] = {"v1", "v2", "v3"};
    uint32_t corners[3], vertices = open_object(model)->vertex_count;
    for (int k = 0; k < 3; k++) {
        corners[k] = whole_of(model, attributes, names[k]);
        if (corners[k] >= vertices)
            fail(model, GD_INDEX,
                 "a triangle refers to vertex %u, but its object has %u vertices, numbered from 0",
                 corners[k], vertices);
    }
    if (package->triangle_count == package->limits.max_faces)
        return fail(model, GD_TOO_LARGE,
                    "the file has more than the configured maximum of %u triangles",
                    package->limits.max_faces);
    if (!package->is_counting) {
        if (!gd__3mf_grow((void **)&package->triangles, package->triangle_count,
                          &package->triangle_capacity, sizeof corners))
            return fail_memory(model);
        memcpy(package->triangles[package->triangle_count], corners, sizeof corners);
    }
    package->triangle_count++;
    open_object(model)->triangle_count++;
}

/* Reads a transform. 3MF stores the rows of a 4x3 matrix that multiplies row vectors. Each row is a
 * column of struct gd__place. */
static void read_place(struct model *model, const char **attributes, struct gd__place *out)
{
    const char *text = attribute(attributes, "transform");
    double numbers[12];
    *out = gd__unmoved;
    if (!text) return;
    if (!parse_numbers(text, 12, numbers))
        return fail(model, GD_SYNTAX, "the attribute transform does not have twelve numbers");
    for (int i = 0; i < 12; i++)
        if (!isfinite(numbers[i]))
            return fail(model, GD_NON_FINITE,
                        "the attribute transform has a number that is not finite");
    memcpy(out->columns, numbers, sizeof numbers);
}

/* Adds a component or an item. */
static void add_use(struct model *model, const char **attributes)
{
    struct gd__3mf *package = model->package;
    const char *path = attribute(attributes, "path");
    struct gd__3mf_use use = {.part = model->part, .id = whole_of(model, attributes, "objectid")};
    read_place(model, attributes, &use.place);
    if (path && model->part != 0)
        return fail(model, GD_UNSUPPORTED, "only the root model part may refer to other parts");
    if (package->use_count == GD__3MF_OBJECTS)
        return fail(model, GD_UNSUPPORTED,
                    "the file has more than %d components and items; merge some of them",
                    GD__3MF_OBJECTS);
    enum gd_status status = path ? gd__3mf_name_part(package, path, &use.part) : GD_OK;
    if (status == GD_OK && !gd__3mf_grow((void **)&package->uses, package->use_count,
                                         &package->use_capacity, sizeof use))
        status = GD_NO_MEMORY;
    if (status == GD_NO_MEMORY) return fail_memory(model);
    if (status != GD_OK)
        return fail(model, status,
                    "the file refers to too many parts, or the path of a part is too long");
    package->uses[package->use_count++] = use;
}

static void begin_item(struct model *model, const char **attributes)
{
    struct gd__3mf *package = model->package;
    if (model->part != 0) return;
    if (package->item_count++ == 0) package->first_item = package->use_count;
    add_use(model, attributes);
}

/* Returns true if the name has the same prefix as the first element. In nearly all files this
 * prefix is empty. */
static bool is_core(const struct model *model, const char *name)
{
    return (size_t)(local_name(name) - name) == model->prefix;
}

static void XMLCALL begin_element(void *user, const char *name, const char **attributes)
{
    struct model *model = user;
    const char *local = local_name(name);
    if (++model->depth > DEPTH)
        return fail(model, GD_UNSUPPORTED, "elements are nested more than %d deep", DEPTH);
    if (model->depth == 1) model->prefix = (size_t)(local - name);
    if (model->status != GD_OK || !is_core(model, name)) return;
    struct gd__3mf_object *object = open_object(model);
    if (model->depth == 1 && strcmp(local, "model") == 0) return begin_model(model, attributes);
    if (!object && strcmp(local, "object") == 0) return begin_object(model, attributes);
    if (!object && strcmp(local, "item") == 0) return begin_item(model, attributes);
    if (!object) return;
    if (strcmp(local, "vertex") == 0) return begin_vertex(model, attributes);
    if (strcmp(local, "triangle") == 0) return begin_triangle(model, attributes);
    if (strcmp(local, "component") != 0) return;
    object->use_count++;
    add_use(model, attributes);
}

static void XMLCALL end_element(void *user, const char *name)
{
    struct model *model = user;
    model->depth--;
    if (is_core(model, name) && strcmp(local_name(name), "object") == 0) model->object = NO_OBJECT;
}

/* Rejects document type declarations, which 3MF forbids. So a file cannot define entities. */
static void XMLCALL refuse_doctype(void *user, const char *name, const char *system,
                                   const char *public, int has_subset)
{
    (void)name;
    (void)system;
    (void)public;
    (void)has_subset;
    fail((struct model *)user, GD_UNSUPPORTED,
         "3MF does not allow a document type declaration; remove the DOCTYPE line");
}

static void XMLCALL begin_relationship(void *user, const char *name, const char **attributes)
{
    static const char wanted[] = "/3dmodel";
    struct model *model = user;
    const char *type = attribute(attributes, "Type"), *target = attribute(attributes, "Target");
    size_t length = type ? strlen(type) : 0;
    (void)name;
    if (++model->depth > DEPTH)
        return fail(model, GD_UNSUPPORTED, "elements are nested more than %d deep", DEPTH);
    if (model->root[0] || !target || length < sizeof wanted ||
        strcmp(type + length - (sizeof wanted - 1), wanted) != 0)
        return;
    if (strlen(target) >= GD__3MF_PATH)
        return fail(model, GD_UNSUPPORTED, "the path of the model is too long");
    strcpy(model->root, target);
}

/* --- parts ------------------------------------------------------------------------------------ */

static void fail_xml(struct model *model)
{
    enum XML_Error error = XML_GetErrorCode(model->parser);
    if (error == XML_ERROR_NO_MEMORY)
        fail(model, GD_TOO_LARGE, "the names of elements and attributes take more than %zu bytes",
             GD__3MF_XML_BYTES);
    else
        fail(model, GD_SYNTAX, "the XML is not well-formed: %s", XML_ErrorString(error));
}

/* Parses a part to its end. */
static void parse(struct model *model)
{
    struct gd__zip *zip = model->package->zip;
    size_t size = 1;
    XML_Index done = 0;
    while (model->status == GD_OK && size > 0) {
        void *buffer = XML_GetBuffer(model->parser, CHUNK_BYTES);
        enum gd_status control = gd_control_check(model->package->limits.control, 0);
        if (control != GD_OK) model->status = control;
        if (!buffer || model->status != GD_OK) break;
        if (!gd__zip_read(zip, buffer, CHUNK_BYTES, &size))
            return fail(model, GD_SYNTAX,
                        "this part of the archive is damaged, encrypted, or not compressed by "
                        "deflate; write the file again");
        done += (XML_Index)size;
        if (XML_ParseBuffer(model->parser, (int)size, size == 0) == XML_STATUS_ERROR)
            return fail_xml(model);
        if (done - XML_GetCurrentByteIndex(model->parser) > LONGEST_TOKEN)
            return fail(model, GD_UNSUPPORTED, "a tag is longer than %ld bytes",
                        (long)LONGEST_TOKEN);
    }
    if (model->status == GD_OK && size > 0) fail_memory(model);
    if (model->status == GD_OK && !gd__zip_end(zip))
        fail(model, GD_SYNTAX,
             "the archive is damaged: the checksum of this part does not match; send the file "
             "again");
}

/* Parses the file of the archive whose name is the part's name. Error: GD_EMPTY (there is no such
 * file). */
static enum gd_status read_part(struct model *model, XML_StartElementHandler begin)
{
    struct gd__3mf *package = model->package;
    uint64_t size;
    if (!gd__zip_begin(package->zip, model->name, &size)) return GD_EMPTY;
    if (size / GD__3MF_INFLATION > package->size)
        return gd_fail(package->detail, GD_TOO_LARGE,
                       "the archive has %zu bytes, but one of its parts expands to %llu bytes; at "
                       "most %d times the archive's size is allowed",
                       package->size, (unsigned long long)size, GD__3MF_INFLATION);
    xml_bytes = 0;
    model->parser = XML_ParserCreate_MM(NULL, &memory, NULL);
    if (!model->parser) return gd_fail_status(package->detail, GD_NO_MEMORY);
    XML_SetHashSalt(model->parser, (unsigned long)gd_now_ns() | 1);
    XML_SetUserData(model->parser, model);
    XML_SetElementHandler(model->parser, begin, end_element);
    XML_SetStartDoctypeDeclHandler(model->parser, refuse_doctype);
    parse(model);
    gd__zip_end(package->zip);
    XML_ParserFree(model->parser);
    return model->status;
}

enum gd_status gd__3mf_find_model(struct gd__3mf *package, char *out)
{
    char found[GD__3MF_PATH] = "";
    struct model model = {
        .package = package, .name = "_rels/.rels", .object = NO_OBJECT, .root = found};
    enum gd_status status = read_part(&model, begin_relationship);
    if (status == GD_OK && found[0]) strcpy(out, found);
    return status == GD_EMPTY ? GD_OK : status;
}

enum gd_status gd__3mf_read_model(struct gd__3mf *package, uint32_t part)
{
    char name[GD__3MF_PATH];
    /* parsing may reallocate the array of parts, so the name is copied */
    strcpy(name, package->parts[part].name);
    struct model model = {.package = package, .part = part, .name = name, .object = NO_OBJECT};
    enum gd_status status = read_part(&model, begin_element);
    if (status != GD_EMPTY) return status;
    struct gd__word word = {name, strlen(name)};
    return gd_fail(package->detail, GD_SYNTAX,
                   "the archive lacks the part '%s', to which the model refers",
                   gd__excerpt(word).text);
}
