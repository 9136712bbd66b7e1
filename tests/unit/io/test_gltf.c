#include <math.h>

#include "tests/unit/io/gltf_text.h"

/* The buffer contains the corners of a square as floats, and two triangles as indices of 16, 8 and
 * 32 bits. It also contains the square as bytes, and the indices and values of a sparse accessor
 * that moves two corners. */
static const struct __attribute__((packed)) {
    float corners[4][3];
    uint16_t shorts[6];
    uint8_t bytes[8];
    uint32_t words[6];
    int8_t quantized[4][4];
    uint16_t sparse[2];
    float elsewhere[2][3];
} data = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
          {0, 1, 2, 0, 2, 3},
          {0, 1, 2, 0, 2, 3, 0, 0},
          {0, 1, 2, 0, 2, 3},
          {{0, 0, 0, 0}, {127, 0, 0, 0}, {127, 127, 0, 0}, {0, -128, 0, 0}},
          {1, 3},
          {{5, 0, 0}, {0, 7, 0}}};

/* Accessors: 0 corners; 1, 2, 3 indices of 16, 8 and 32 bits; 4 the first five byte indices; 5 the
 * square as normalised bytes, 6 as plain bytes; 7 the corners with two moved (sparse); 8 zeros with
 * two moved (sparse); 9 the byte indices from the second on. */
#define DATA                                                                                       \
    "{'asset':{'version':'2.0'},'buffers':[{'byteLength':136,'uri':'@'}],"                         \
    "'bufferViews':[{'buffer':0,'byteLength':48},"                                                 \
    "{'buffer':0,'byteOffset':48,'byteLength':12},"                                                \
    "{'buffer':0,'byteOffset':60,'byteLength':8},"                                                 \
    "{'buffer':0,'byteOffset':68,'byteLength':24},"                                                \
    "{'buffer':0,'byteOffset':92,'byteLength':16,'byteStride':4},"                                 \
    "{'buffer':0,'byteOffset':108,'byteLength':4},"                                                \
    "{'buffer':0,'byteOffset':112,'byteLength':24}],"                                              \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"                  \
    "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'},"                             \
    "{'bufferView':2,'componentType':5121,'count':6,'type':'SCALAR'},"                             \
    "{'bufferView':3,'componentType':5125,'count':6,'type':'SCALAR'},"                             \
    "{'bufferView':2,'componentType':5121,'count':5,'type':'SCALAR'},"                             \
    "{'bufferView':4,'componentType':5120,'normalized':true,'count':4,'type':'VEC3'},"             \
    "{'bufferView':4,'componentType':5120,'count':4,'type':'VEC3'},"                               \
    "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3','sparse':{'count':2,"            \
    "'indices':{'bufferView':5,'componentType':5123},'values':{'bufferView':6}}},"                 \
    "{'componentType':5126,'count':4,'type':'VEC3','sparse':{'count':2,"                           \
    "'indices':{'bufferView':5,'componentType':5123},'values':{'bufferView':6}}},"                 \
    "{'bufferView':2,'byteOffset':1,'componentType':5121,'count':5,'type':'SCALAR'}]"
#define PRIMITIVES(primitives) DATA ",'meshes':[{'primitives':[" primitives "]}]"
#define SQUARE                 "{'attributes':{'POSITION':0},'indices':1}"
#define MESH(primitives)       PRIMITIVES(primitives) "}"
#define SCENE(rest)            PRIMITIVES(SQUARE) "," rest "}"

static void check_both(const char *document, const char *mesh)
{
    check_file(gltf_file(document, &data, sizeof data), mesh);
    check_file(glb_file(document, &data, sizeof data), mesh);
}

/* --- primitives ------------------------------------------------------------------------------- */

static void reads_every_mode(void **state)
{
    (void)state;
    check_both(MESH(SQUARE), "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 0 2 3");
    check_both(MESH("{'attributes':{'POSITION':0},'mode':4,'indices':2}"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 0 2 3");
    check_both(MESH("{'attributes':{'POSITION':0},'indices':3}"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 0 2 3");
    check_both(MESH("{'attributes':{'POSITION':0},'mode':5}"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 1 3 2");
    check_both(MESH("{'attributes':{'POSITION':0},'mode':6}"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 1 2 0; 2 3 0");
    check_both(MESH("{'attributes':{'POSITION':0},'indices':9,'mode':6}"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 2 0 1; 0 2 1; 2 3 1");
    /* the indices are 0 1 2 0 2; in a strip or fan the last triangle repeats a corner and is
       dropped */
    check_both(MESH("{'attributes':{'POSITION':0},'indices':4,'mode':5}"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 1 0 2");
    check_both(MESH("{'attributes':{'POSITION':0},'indices':4,'mode':6}"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 1 2 0");
}

static void leaves_points_and_lines_out(void **state)
{
    (void)state;
    check_both(
        MESH("{'attributes':{'POSITION':0},'mode':0},{'attributes':{'POSITION':0},'mode':3}," SQUARE
             ",{'attributes':{'NORMAL':0}},{'mode':4}"),
        "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 0 2 3");
}

/* Two primitives share an accessor, and a third primitive repeats a position. Equal positions
 * become one vertex. */
static void welds_equal_positions(void **state)
{
    (void)state;
    check_both(MESH("{'attributes':{'POSITION':0},'indices':1},{'attributes':{'POSITION':0},'"
                    "indices':2,'mode':6},"
                    "{'attributes':{'POSITION':6},'mode':6}"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0; 127 0 0; 127 127 0; 0 -128 0 | 0 1 2; 0 2 3; 1 2 0; 2 "
               "3 0; 4 5 0; 5 6 0");
}

static void reads_whole_numbers(void **state)
{
    (void)state;
    check_both(MESH("{'attributes':{'POSITION':5},'mode':6}"),
               "0 0 0; 1 0 0; 1 1 0; 0 -1 0 | 1 2 0; 2 3 0");
    check_both(MESH("{'attributes':{'POSITION':6},'mode':6}"),
               "0 0 0; 127 0 0; 127 127 0; 0 -128 0 | 1 2 0; 2 3 0");
}

static void reads_sparse_accessors(void **state)
{
    (void)state;
    check_both(MESH("{'attributes':{'POSITION':7},'mode':6}"),
               "0 0 0; 5 0 0; 1 1 0; 0 7 0 | 1 2 0; 2 3 0");
    check_both(MESH("{'attributes':{'POSITION':8},'mode':6}"),
               "0 0 0; 5 0 0; 0 7 0 | 1 0 0; 0 2 0");
}

/* --- nodes ------------------------------------------------------------------------------------ */

static void chooses_the_scene(void **state)
{
    (void)state;
    const char *at_0 = "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 0 2 3",
               *at_5 = "5 0 0; 6 0 0; 6 1 0; 5 1 0 | 0 1 2; 0 2 3";
    const char *both =
        "0 0 0; 1 0 0; 1 1 0; 0 1 0; 5 0 0; 6 0 0; 6 1 0; 5 1 0 | 0 1 2; 0 2 3; 4 5 6; 4 6 7";
#define NODES "'nodes':[{'mesh':0},{'mesh':0,'translation':[5,0,0]}]"
    check_both(SCENE(NODES ",'scene':1,'scenes':[{'nodes':[0]},{'nodes':[1]}]"), at_5);
    check_both(SCENE(NODES ",'scenes':[{'nodes':[0]},{'nodes':[1]}]"), at_0);
    check_both(SCENE(NODES), both);
    check_both(SCENE("'nodes':[]"), at_0);
#undef NODES
}

static struct gd_polygons read_scene(const char *document)
{
    struct gd_polygons polygons;
    struct gd_detail detail = {.text = ""};
    struct file file = gltf_file(document, &data, sizeof data);
    if (read_file(&file, &polygons, &detail) != GD_OK) fail_msg("%s", detail.text);
    free(file.bytes);
    return polygons;
}

static void check_corner(const struct gd_polygons *mesh, uint32_t vertex, double x, double y,
                         double z)
{
    const double expected[3] = {x, y, z};
    for (int axis = 0; axis < 3; axis++)
        assert_true(fabs(mesh->positions[vertex][axis] - expected[axis]) <=
                    1e-15 * (1 + fabs(expected[axis])));
}

/* Uses a mesh that is rotated by 90 degrees about z, scaled and translated, in a parent that is
 * rotated about x. Expected positions were computed by hand. Quaternions are rounded as in real
 * files. */
static void places_by_nodes(void **state)
{
    (void)state;
    struct gd_polygons mesh = read_scene(SCENE(
        "'nodes':[{'children':[2],'rotation':[0.70710677,0,0,0.70710677],'translation':[100,0,0]},"
        "{'camera':0},{'mesh':0,'rotation':[0,0,0.70710677,0.70710677],'scale':[2,3,4],"
        "'translation':[10,20,30]}],'scene':0,'scenes':[{'nodes':[0,1]}]"));
    /* (x,y,0) -> (10 - 3y, 20 + 2x, 30) -> (110 - 3y, -30, 20 + 2x) */
    check_corner(&mesh, 0, 110, -30, 20);
    check_corner(&mesh, 1, 110, -30, 22);
    check_corner(&mesh, 2, 107, -30, 22);
    check_corner(&mesh, 3, 107, -30, 20);
    gd_polygons_free(&mesh);
    check_both(SCENE("'nodes':[{'mesh':0,'matrix':[0,2,0,0,-3,0,0,0,0,0,4,0,10,20,30,1]}]"),
               "10 20 30; 10 22 30; 7 22 30; 7 20 30 | 0 1 2; 0 2 3");
    check_both(SCENE("'nodes':[{'mesh':0,'skin':0,'translation':[10,20,30]}]"),
               "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 0 2 3");
}

/* A mirroring transformation reverses the orientation of the faces, so that the outside stays
 * outside. */
static void turns_mirrored_faces(void **state)
{
    (void)state;
    check_both(SCENE("'nodes':[{'mesh':0,'scale':[-1,1,1]}]"),
               "0 0 0; -1 0 0; -1 1 0; 0 1 0 | 0 2 1; 0 3 2");
    check_both(SCENE("'nodes':[{'children':[1],'scale':[-1,1,1]},{'mesh':0,'scale':[1,-1,1]}]"),
               "0 0 0; -1 0 0; -1 -1 0; 0 -1 0 | 0 1 2; 0 2 3");
}

static void ignores_other_content(void **state)
{
    (void)state;
    const char *square = "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2; 0 2 3";
    check_both(SCENE("'extensionsUsed':['KHR_draco_mesh_compression'],'extensionsRequired':['KHR_"
                     "mesh_quantization',"
                     "'KHR_materials_unlit','KHR_technique_webgl'],'extras':{'a\\\"b':[1,[2,{'c':"
                     "null}],true]}"),
               square);
    check_both(SCENE("'n\\u006Fdes':[{'\\u006desh':0}]"), square);
    check_both(SCENE("'materials':[{'name':'\\u00e4 { [ \\\" '}],'images':[{'uri':'picture.png'}]"),
               square);
    /* the document has Draco data and the same data uncompressed; the reader uses the uncompressed
       data */
    check_both(MESH("{'attributes':{'POSITION':0},'indices':1,'extensions':{'KHR_draco_mesh_"
                    "compression':{}}}"),
               square);
    struct file file = glb_file(MESH(SQUARE), &data, sizeof data);
    file.bytes = realloc(file.bytes, file.size + 3);
    memcpy(file.bytes + file.size, "xyz", 3);
    check_file((struct file){file.bytes, file.size + 3}, square);
}

/* --- errors ----------------------------------------------------------------------------------- */

static const struct {
    const char *find, *by; /* replacement in a valid document */
    enum gd_status status;
    const char *says;
} mistakes[] = {
    {"{'asset'", "{'accessories'", GD_SYNTAX, "not glTF"},
    {"'2.0'", "'1.0'", GD_UNSUPPORTED, "version 2"},
    {"'2.0'", "'2.1','minVersion':'2.1'", GD_UNSUPPORTED, "version 2"},
    {"'2.0'", "'2.1','minVersion':'2.0'", GD_OK, NULL},
    {"'2.0'", "'1.0','minVersion':'2.0'", GD_UNSUPPORTED, "version 2"},
    {"'version'", "'revision'", GD_SYNTAX, "not glTF"},
    {"'uri':'@'", "'uri':'square.bin'", GD_UNSUPPORTED, "another file, 'square.bin'"},
    {"'uri':'@'", "'uri':'data:text/plain,abc'", GD_UNSUPPORTED, "not encoded in base64"},
    {"'uri':'@'", "'uri':'data:;base64,AA*A'", GD_SYNTAX, "base64"},
    {"'uri':'@'", "'uri':'data:;base64,AAAA'", GD_TRUNCATED, "the buffer has only 3 bytes"},
    {"'uri':'@'", "'uri':17", GD_SYNTAX, "'uri' is not a string"},
    {",'uri':'@'", "", GD_UNSUPPORTED, "has no bytes"},
    {"'byteLength':136", "'byteLength':137", GD_TRUNCATED, "137"},
    {"'byteLength':136", "'byteLength':135", GD_OK, NULL},
    {"'byteLength':136", "'byteLength':59", GD_TRUNCATED, "view ends at byte 60"},
    {"'byteLength':136", "'byteLength':-1", GD_SYNTAX, "'byteLength'"},
    {"'byteLength':136", "'byteLength':1.5", GD_SYNTAX, "'byteLength'"},
    {"'byteLength':136", "'byteLength':'136'", GD_SYNTAX, "'byteLength'"},
    {"'byteLength':136", "'byteLength':1e300", GD_SYNTAX, "'byteLength'"},
    {"'buffer':0,'byteLength':48", "'byteLength':48", GD_SYNTAX, "lacks the member 'buffer'"},
    {"'buffer':0,'byteLength':48", "'buffer':1,'byteLength':48", GD_SYNTAX,
     "number 1 of the 'buffers'"},
    {"'buffer':0,'byteLength':48", "'buffer':0,'byteLength':47", GD_TRUNCATED,
     "4 elements end at byte 48, but their buffer view has 47 bytes"},
    {"'buffer':0,'byteLength':48", "'buffer':0,'byteLength':9007199254740992", GD_TRUNCATED,
     "view ends"},
    {"'buffer':0,'byteLength':48", "'buffer':0,'byteOffset':9007199254740992,'byteLength':48",
     GD_TRUNCATED, "view ends"},
    {"'buffer':0,'byteLength':48", "'buffer':0,'byteLength':48,'byteStride':11", GD_SYNTAX,
     "'byteStride' is 11"},
    {"'buffer':0,'byteLength':48", "'buffer':0,'byteLength':48,'byteStride':16", GD_TRUNCATED,
     "60"},
    {"'buffer':0,'byteLength':48",
     "'extensions':{'EXT_meshopt_compression':{}},'buffer':0,'byteLength':48", GD_UNSUPPORTED,
     "meshopt"},
    {"'bufferView':0,'componentType':5126", "'bufferView':7,'componentType':5126", GD_SYNTAX,
     "only 7"},
    {"'bufferView':0,'componentType':5126", "'bufferView':0,'byteOffset':1,'componentType':5126",
     GD_TRUNCATED, "49"},
    {"'bufferView':0,'componentType':5126", "'bufferView':0,'componentType':5125", GD_SYNTAX,
     "VEC3"},
    {"'bufferView':0,'componentType':5126", "'bufferView':0,'componentType':5130", GD_SYNTAX,
     "VEC3"},
    {"'bufferView':0,'componentType':5126", "'bufferView':0", GD_SYNTAX, "VEC3"},
    {"'count':4,'type':'VEC3'", "'count':4,'type':'VEC4'", GD_SYNTAX, "VEC3"},
    {"'count':4,'type':'VEC3'", "'count':0,'type':'VEC3'", GD_SYNTAX, "at least 1"},
    {"'count':4,'type':'VEC3'", "'type':'VEC3'", GD_SYNTAX, "at least 1"},
    {"'count':4,'type':'VEC3'", "'count':5,'type':'VEC3'", GD_TRUNCATED, "5 elements"},
    {"'count':4,'type':'VEC3'", "'count':4294967295,'type':'VEC3'", GD_SYNTAX, "'count'"},
    {"'count':4,'type':'VEC3'", "'count':3,'type':'VEC3'", GD_INDEX, "vertex 3"},
    {"'bufferView':1,'componentType':5123", "'bufferView':1,'componentType':5122", GD_SYNTAX,
     "SCALAR"},
    {"'bufferView':1,'componentType':5123", "'bufferView':1,'componentType':5126", GD_SYNTAX,
     "SCALAR"},
    {"'bufferView':1,'componentType':5123", "'bufferView':1,'componentType':5125", GD_TRUNCATED,
     "24"},
    {"'count':6,'type':'SCALAR'", "'count':5,'type':'SCALAR'", GD_SYNTAX, "5 corners"},
    {"'count':6,'type':'SCALAR'", "'count':6,'type':'VEC3'", GD_SYNTAX, "SCALAR"},
    {"'POSITION':0", "'POSITION':10", GD_SYNTAX, "only 10"},
    {"'POSITION':0", "'POSITION':0.5", GD_SYNTAX, "'accessors'"},
    {"'POSITION':0", "'POSITION':1", GD_SYNTAX, "VEC3"},
    {"'POSITION':0", "'NORMAL':0", GD_EMPTY, "1 primitives are points or lines"},
    {"'indices':1}]}]", "'indices':0}]}]", GD_SYNTAX, "4 corners"},
    {"'indices':1}]}]", "'indices':99}]}]", GD_SYNTAX, "only 10"},
    {"'indices':1}]}]", "'indices':1,'mode':7}]}]", GD_SYNTAX, "'mode'"},
    {"'indices':1}]}]", "'indices':1,'mode':2}]}]", GD_EMPTY, "points or lines"},
    {"'primitives':[", "'primitives':{},'p':[", GD_SYNTAX, "'primitives'"},
    {"'meshes':[", "'meshes':7,'m':[", GD_SYNTAX, "'meshes' is not an array"},
    {"'nodes':[", "'nodes':{},'n':[", GD_SYNTAX, "'nodes' is not an array"},
    {"'mesh':0", "'mesh':1", GD_SYNTAX, "'meshes'"},
    {"'mesh':0", "'mesh':0,'rotation':[0,0,0,0]", GD_SYNTAX, "rotation"},
    {"'mesh':0", "'mesh':0,'rotation':[0,0,1]", GD_SYNTAX, "4 numbers"},
    {"'mesh':0", "'mesh':0,'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0]", GD_SYNTAX, "16 numbers"},
    {"'mesh':0", "'mesh':0,'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1,1]", GD_SYNTAX, "16 numbers"},
    {"'mesh':0", "'mesh':0,'translation':[1,2,'3']", GD_SYNTAX, "3 numbers"},
    {"'mesh':0", "'mesh':0,'translation':[1e999,2,3]", GD_NON_FINITE, "not a finite number"},
    {"'mesh':0", "'mesh':0,'children':[0]", GD_SYNTAX, "below itself"},
    {"'mesh':0", "'mesh':0,'children':[1,1]", GD_SYNTAX, "node 1 is in the scene twice"},
    {"'mesh':0", "'mesh':0,'children':[2]", GD_SYNTAX, "only 2"},
    {"'mesh':0", "'mesh':0,'children':7", GD_SYNTAX, "'children' is not an array"},
    {"'scene':0", "'scene':1", GD_SYNTAX, "'scenes'"},
    {"'scenes':[{'nodes':[0]}]", "'scenes':[{'nodes':[]}]", GD_EMPTY, NULL},
    {"'scenes':[{'nodes':[0]}]", "'scenes':[{'nodes':[0,0]}]", GD_SYNTAX, "twice"},
    {"'scenes':[{'nodes':[0]}]",
     "'scenes':[{'nodes':[0]}],'extensionsRequired':['KHR_draco_mesh_compression']", GD_UNSUPPORTED,
     "Draco"},
    {"'scenes':[{'nodes':[0]}]",
     "'scenes':[{'nodes':[0]}],'extensionsRequired':['EXT_meshopt_compression']", GD_UNSUPPORTED,
     "meshopt"},
    {"'scenes':[{'nodes':[0]}]",
     "'scenes':[{'nodes':[0]}],'extensionsRequired':['EXT_mesh_gpu_instancing']", GD_UNSUPPORTED,
     "EXT_mesh_gpu_instancing"},
    {"'scenes':[{'nodes':[0]}]", "'scenes':[{'nodes':[0]}],'extensionsRequired':[7]", GD_SYNTAX,
     "not a string"},
    {"'scene':0,", "'scene':0,,", GD_SYNTAX, "a key"},
};

#define GOOD SCENE("'nodes':[{'mesh':0},{}],'scene':0,'scenes':[{'nodes':[0]}]")

/* Reads the document with `find` replaced by `by`. */
static enum gd_status read_replaced(const char *document, const char *find, const char *by,
                                    struct gd_detail *detail)
{
    char *text = replaced(document, find, by);
    struct file file = gltf_file(text, &data, sizeof data);
    struct gd_polygons polygons = {0};
    enum gd_status status =
        read_copy(file.bytes, file.size, GD_FORMAT_GLTF, NULL, &polygons, detail);
    gd_polygons_free(&polygons);
    free(file.bytes);
    free(text);
    return status;
}

static void refuses_mistakes(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(mistakes); i++) {
        struct gd_detail detail = {.text = ""};
        enum gd_status status = read_replaced(GOOD, mistakes[i].find, mistakes[i].by, &detail);
        if (status != mistakes[i].status)
            fail_msg("%zu: '%s': %s (%s)", i, mistakes[i].by, gd_status_name(status), detail.text);
        if (status &&
            (!detail.text[0] || (mistakes[i].says && !strstr(detail.text, mistakes[i].says))))
            fail_msg("%zu: '%s': it says '%s'", i, mistakes[i].by, detail.text);
    }
}

/* Uses five corners with indices, and four corners without indices. The last corners belong to no
 * whole triangle. */
static void skips_excess_corners(void **state)
{
    (void)state;
    static const char *const documents[] = {MESH("{'attributes':{'POSITION':0},'indices':4}"),
                                            MESH("{'attributes':{'POSITION':0}}")};
    for (size_t i = 0; i < COUNT_OF(documents); i++) {
        struct file file = gltf_file(documents[i], &data, sizeof data);
        const char *place = strstr(file.bytes, "{\"attributes\"");
        const struct skipped_input input = {file.bytes, file.size,
                                            "0 0 0; 1 0 0; 1 1 0; 0 1 0 | 0 1 2", 1,
                                            (uint32_t)(place - file.bytes)};
        check_skipped(GD_FORMAT_GLTF, &input, 1);
        free(file.bytes);
    }
}

static void refuses_many_elements_without_data(void **state)
{
    (void)state;
    struct gd_detail detail = {.text = ""};
    enum gd_status status = read_replaced(MESH("{'attributes':{'POSITION':8},'mode':6}"),
                                          "{'componentType':5126,'count':4",
                                          "{'componentType':5126,'count':400000000", &detail);
    assert_int_equal(status, GD_SYNTAX);
    if (!strstr(detail.text, "no 'bufferView'")) fail_msg("it says '%s'", detail.text);
}

static void refuses_broken_sparse_accessors(void **state)
{
    (void)state;
    static const struct {
        const char *find, *by, *says;
    } broken[] = {
        {"'sparse':{'count':2", "'sparse':{'count':5", "'count'"},
        {"'sparse':{'count':2", "'sparse':{'count':3",
         "end at byte 6, but their buffer view has 4 bytes"},
        {"'indices':{'bufferView':5,", "'indices':{'bufferView':2,",
         "sparse indices must increase"},
        {"'indices':{'bufferView':5,'componentType':5123}",
         "'indices':{'bufferView':5,'componentType':5122}", "must be 5121, 5123 or 5125"},
        {"'indices':{'bufferView':5,", "'indices':{", "'bufferView' is missing"},
        {"'values':{'bufferView':6}", "'valued':{}", "'values' is missing"},
        {"'values':{'bufferView':6}", "'values':{'bufferView':5}",
         "end at byte 24, but their buffer view has 4 bytes"},
    };
    for (size_t i = 0; i < COUNT_OF(broken); i++) {
        struct gd_detail detail = {.text = ""};
        enum gd_status status = read_replaced(MESH("{'attributes':{'POSITION':7},'mode':6}"),
                                              broken[i].find, broken[i].by, &detail);
        assert_true(status == GD_SYNTAX || status == GD_TRUNCATED);
        if (!strstr(detail.text, broken[i].says)) fail_msg("%zu: it says '%s'", i, detail.text);
    }
}

static void refuses_broken_containers(void **state)
{
    (void)state;
    static const struct bad_input bad[] = {
        {BYTES("glTF"), GD_TRUNCATED, 0, "begins with"},
        {BYTES("glTF\1\0\0\0\24\0\0\0abcdefgh"), GD_UNSUPPORTED, 4, "version 1"},
        {BYTES("glTF\2\0\0\0\25\0\0\0abcdefgh"), GD_TRUNCATED, 8, "declares 21 bytes"},
        {BYTES("glTF\2\0\0\0\4\0\0\0abcdefgh"), GD_TRUNCATED, 8, "declares 4 bytes"},
        {BYTES("glTF\2\0\0\0\14\0\0\0"), GD_TRUNCATED, 12, "where a chunk should be"},
        {BYTES("glTF\2\0\0\0\24\0\0\0\1\0\0\0JSON"), GD_TRUNCATED, 12, "a chunk of 1 bytes"},
        {BYTES("glTF\2\0\0\0\30\0\0\0\4\0\0\0BIN\0abcd"), GD_SYNTAX, 12, "must be JSON"},
        {BYTES("glTF\2\0\0\0\30\0\0\0\4\0\0\0JSONabcd"), GD_SYNTAX, 20, NULL},
        {BYTES("glTF\2\0\0\0\30\0\0\0\4\0\0\0JSON{}  "), GD_SYNTAX, 20, "not glTF"},
    };
    check_bad(GD_FORMAT_GLB, bad, COUNT_OF(bad));
}

/* Every prefix, and every document with one byte changed, is read or refused with a message. */
static void survives_damage(void **state)
{
    (void)state;
    const char *documents[] = {GOOD, MESH("{'attributes':{'POSITION':7},'mode':6}")};
    for (size_t i = 0; i < COUNT_OF(documents); i++) {
        struct file file = glb_file(documents[i], &data, sizeof data);
        struct good_input input = {file.bytes, file.size, NULL};
        check_truncations(GD_FORMAT_GLB, &input, 1);
        for (size_t at = 0; at < file.size; at++) {
            char kept = file.bytes[at];
            file.bytes[at] = (char)(kept ^ 1 << at % 8);
            struct gd_polygons polygons = {0};
            struct gd_detail detail = {.text = ""};
            enum gd_status status = read_file(&file, &polygons, &detail);
            assert_true(status == GD_OK || (detail.text[0] != '\0' && status != GD_INTERNAL));
            gd_polygons_free(&polygons);
            file.bytes[at] = kept;
        }
        free(file.bytes);
    }
}

/* --- cost ------------------------------------------------------------------------------------- */

/* The cost and the limits count a mesh once for each of its placements. */
static void counts_each_placement_of_a_mesh(void **state)
{
    (void)state;
    enum { PLACES = 1000 };
    char *document = NULL;
    size_t size;
    FILE *stream = open_memstream(&document, &size);
    fprintf(stream, "%s,'nodes':[", PRIMITIVES(SQUARE));
    for (int i = 0; i < PLACES; i++)
        fprintf(stream, "%s{'mesh':0,'translation':[%d,0,0]}", i ? "," : "", 2 * i);
    fprintf(stream, "]}");
    fclose(stream);
    struct file file = gltf_file(document, &data, sizeof data);
    struct gd_polygons polygons;
    struct gd_detail detail = {.text = ""};
    assert_int_equal(read_file(&file, &polygons, &detail), GD_OK);
    assert_int_equal(polygons.polygon_count, 2 * PLACES);
    assert_int_equal(polygons.position_count, 4 * PLACES);
    gd_polygons_free(&polygons);
    size_t cost = gd_read_cost(file.bytes, file.size, NULL);
    assert_in_range(cost, PLACES * (2 * 12 + 4 * 24) + file.size, 10 * PLACES * (2 * 12 + 4 * 40));
    struct gd_read_options limits = {.max_faces = 2 * PLACES - 1};
    assert_int_equal(read_copy(file.bytes, file.size, GD_FORMAT_ANY, &limits, &polygons, &detail),
                     GD_TOO_LARGE);
    free(file.bytes);
    free(document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_every_mode),
        cmocka_unit_test(leaves_points_and_lines_out),
        cmocka_unit_test(welds_equal_positions),
        cmocka_unit_test(reads_whole_numbers),
        cmocka_unit_test(reads_sparse_accessors),
        cmocka_unit_test(chooses_the_scene),
        cmocka_unit_test(places_by_nodes),
        cmocka_unit_test(turns_mirrored_faces),
        cmocka_unit_test(ignores_other_content),
        cmocka_unit_test(refuses_mistakes),
        cmocka_unit_test(skips_excess_corners),
        cmocka_unit_test(refuses_broken_sparse_accessors),
        cmocka_unit_test(refuses_many_elements_without_data),
        cmocka_unit_test(refuses_broken_containers),
        cmocka_unit_test(survives_damage),
        cmocka_unit_test(counts_each_placement_of_a_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
