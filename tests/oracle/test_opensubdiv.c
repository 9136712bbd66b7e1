/* Compares limit surfaces with OpenSubdiv's, if libosd-dev is installed. OpenSubdiv's limit masks
 * give positions and normals at all vertices of uniform refinements. Its patches of level 10 give
 * positions and derivatives at other points. */
#include "tests/oracle/opensubdiv.h"

#include "tests/unit/subdiv/surfaces.h"

enum { PLACES = 24 };

/* Both surfaces of one control mesh and their largest differences. */
struct pair {
    struct gd_subdivision *ours;
    struct opensubdiv_surface *theirs;
    double size;
    /* The largest differences, relative to the size. At places between vertices, they are the
     * differences of positions, of first derivatives and of second derivatives. At vertices, they
     * are the differences of positions, of unit normals, and of positions that OpenSubdiv
     * approximates. */
    double worst[3];
    size_t count;
};

static void require_opensubdiv(void)
{
    if (opensubdiv_is_available()) return;
    print_message("# skipped: OpenSubdiv is not installed: apt-get install libosd-dev\n");
    skip();
}

static double size_of(const struct gd_polygons *polygons)
{
    double most = 0;
    for (uint32_t i = 0; i < polygons->position_count; i++)
        for (int axis = 0; axis < 3; axis++) most = fmax(most, fabs(polygons->positions[i][axis]));
    return most;
}

static struct pair pair_of(const struct gd_control_mesh *mesh, enum gd_scheme scheme)
{
    struct pair pair = {surface_of(mesh, scheme),
                        opensubdiv_create(mesh, scheme),
                        size_of(&mesh->polygons),
                        {0},
                        0};
    assert_non_null(pair.theirs);
    return pair;
}

static void pair_free(struct pair *pair)
{
    gd_subdivision_release(pair->ours);
    opensubdiv_free(pair->theirs);
}

static void note(struct pair *pair, int which, struct gd_vec3 a, struct gd_vec3 b, double scale)
{
    double off = gd_vec3_distance(a, b) / scale;
    if (!(off <= pair->worst[which])) pair->worst[which] = isnan(off) ? INFINITY : off;
}

/* --- vertices of uniform refinements ---------------------------------------------------------- */

static void compare_vertices(struct pair *pair, int level)
{
    struct opensubdiv_vertex *vertices;
    pair->count = opensubdiv_vertices(pair->theirs, level, &vertices);
    struct gd_limit_point *places = malloc(pair->count * sizeof *places);
    struct gd_limit_jet *jets = malloc(pair->count * sizeof *jets);
    for (size_t i = 0; i < pair->count; i++) places[i] = vertices[i].place;
    struct gd_detail detail = {0};
    check_ok(gd_limit_evaluate_many(pair->ours, &(struct gd_limit_places){places, pair->count},
                                    NULL, jets, &detail),
             &detail);
    for (size_t i = 0; i < pair->count; i++) {
        struct gd_vec3 normal = vertices[i].normal;
        note(pair, vertices[i].is_exact ? 0 : 2, jets[i].position, vertices[i].position,
             pair->size);
        if (vertices[i].has_normal && vertices[i].is_exact)
            note(pair, 1, jets[i].normal, gd_vec3_scale(normal, 1 / gd_vec3_length(normal)), 1);
    }
    free(vertices);
    free(places);
    free(jets);
}

/* --- places between vertices ------------------------------------------------------------------ */

/* Returns a parameter far enough from all corners for OpenSubdiv to be exact. */
static double inside(struct rng *rng)
{
    return rng_between(rng, 0.02, 0.98);
}

/* Returns the sign of OpenSubdiv's second derivatives. A refined triangle has four children. In the
 * middle child, whose axes are turned by half a turn, OpenSubdiv 3.5 gives the wrong sign. The
 * engine's second derivatives agree with finite differences of first derivatives
 * (test_evaluate.c). */
static double sign_of(const struct gd_limit_jet *ours, const struct gd_limit_jet *theirs)
{
    return gd_vec3_dot(ours->dvv, theirs->dvv) < 0 ? -1 : 1;
}

static void compare_places(struct pair *pair, const struct gd_control_mesh *mesh, int count)
{
    struct rng rng = {29};
    bool triangles = gd_subdivision_scheme(pair->ours) == GD_SCHEME_LOOP;
    for (int n = 0; n < count; n++) {
        struct gd_limit_point place = {rng_below(&rng, mesh->polygons.polygon_count), 0,
                                       inside(&rng), inside(&rng)};
        uint32_t corners = gd_polygons_first(&mesh->polygons, place.face + 1) -
                           gd_polygons_first(&mesh->polygons, place.face);
        if (corners != 4 && !triangles) place.corner = rng_below(&rng, corners);
        if (triangles) place.u /= 2, place.v /= 2;
        struct gd_limit_jet ours = jet_at(pair->ours, place.face, place.corner, place.u, place.v),
                            theirs;
        opensubdiv_evaluate(pair->theirs, &place, &theirs);
        note(pair, 0, ours.position, theirs.position, pair->size);
        note(pair, 1, ours.du, theirs.du, pair->size);
        note(pair, 1, ours.dv, theirs.dv, pair->size);
        double sign = triangles ? sign_of(&ours, &theirs) : 1;
        note(pair, 2, ours.duu, gd_vec3_scale(theirs.duu, sign), pair->size);
        note(pair, 2, ours.duv, gd_vec3_scale(theirs.duv, sign), pair->size);
        note(pair, 2, ours.dvv, gd_vec3_scale(theirs.dvv, sign), pair->size);
    }
    pair->count += (size_t)count;
}

/* Permitted rounding errors. Each halving of (u,v) amplifies the errors of derivatives. */
static const double promised[2][3] = {{1e-13, 1e-11, 1e-2}, {1e-13, 1e-11, 1e-9}};

static void check_pair(const char *name, const char *what, struct pair *pair, const double most[3])
{
    for (int k = 0; k < 3; k++) {
        if (!(pair->worst[k] <= most[k]))
            fail_msg("%s, %s: off by %g, %g, %g", name, what, pair->worst[0], pair->worst[1],
                     pair->worst[2]);
        pair->worst[k] = 0;
    }
}

/* The largest differences over a group of surfaces. */
struct tally {
    double vertices[3], places[3];
    size_t surfaces, count;
};

static void add(double total[3], const double worst[3])
{
    for (int k = 0; k < 3; k++) total[k] = fmax(total[k], worst[k]);
}

static void compare(const char *name, const struct gd_control_mesh *mesh, enum gd_scheme scheme,
                    int level, struct tally *tally)
{
    struct pair pair = pair_of(mesh, scheme);
    compare_vertices(&pair, level);
    add(tally->vertices, pair.worst);
    check_pair(name, "vertices", &pair, promised[0]);
    compare_places(&pair, mesh, PLACES);
    add(tally->places, pair.worst);
    check_pair(name, "places", &pair, promised[1]);
    tally->surfaces++;
    tally->count += pair.count;
    pair_free(&pair);
}

static void print_tally(const char *group, const struct tally *tally)
{
    print_message("# OpenSubdiv, %s: %zu surfaces, %zu vertices and places: positions %.1e, "
                  "normals %.1e; between "
                  "vertices positions %.1e, "
                  "derivatives %.1e, second ones %.1e\n",
                  group, tally->surfaces, tally->count, tally->vertices[0], tally->vertices[1],
                  tally->places[0], tally->places[1], tally->places[2]);
}

struct sample {
    const char *name, *text;
    enum gd_scheme scheme;
    enum gd_interpolate_boundary boundary;
};

static void compare_sample(const struct sample *sample, int level, struct tally *tally)
{
    struct gd_control_mesh mesh;
    struct gd_detail detail = {0};
    check_ok(gd_read_control_mesh(sample->text, strlen(sample->text),
                                  &(struct gd_read_options){.format = GD_FORMAT_OBJ}, &mesh,
                                  &detail),
             &detail);
    mesh.boundary = sample->boundary;
    compare(sample->name, &mesh, sample->scheme, level, tally);
    gd_control_mesh_free(&mesh);
}

static void compare_samples(const char *group, const struct sample *samples, size_t count)
{
    struct tally tally = {0};
    for (size_t i = 0; i < count; i++) compare_sample(&samples[i], 4, &tally);
    print_tally(group, &tally);
}

/* --- meshes ----------------------------------------------------------------------------------- */

/* Writes two fans of n faces around vertices 0 and 1, above and below a ring, without symmetry. The
 * faces are triangles, or kites for Catmull-Clark. The other vertices of kites have three faces. */
static void make_fans(uint32_t n, bool triangles, char *text, size_t size)
{
    FILE *out = fmemopen(text, size, "w");
    uint32_t ring = triangles ? n : 2 * n;
    fprintf(out, "v 0.1 0 1.3\nv 0 -0.2 -1.1\n");
    for (uint32_t k = 0; k < ring; k++)
        fprintf(out, "v %g %g %g\n", (1 + 0.2 * sin(5 * k)) * cos(2 * M_PI * k / ring),
                (1 + 0.1 * cos(3 * k)) * sin(2 * M_PI * k / ring),
                (triangles ? 0
                 : k % 2   ? -0.3
                           : 0.3) +
                    0.1 * sin(7 * k));
    for (uint32_t k = 0; k < ring; k += triangles ? 1 : 2) {
        uint32_t a = 3 + k, b = 3 + (k + 1) % ring, c = 3 + (k + 2) % ring;
        if (triangles)
            fprintf(out, "f 1 %u %u\nf 2 %u %u\n", a, b, b, a);
        else
            fprintf(out, "f 1 %u %u %u\nf 2 %u %u %u\n", a, b, c, 3 + (k + 3) % ring, c, b);
    }
    fclose(out);
}

static void make_prism(uint32_t n, char *text, size_t size)
{
    FILE *out = fmemopen(text, size, "w");
    for (uint32_t k = 0; k < 2 * n; k++)
        fprintf(out, "v %g %g %g\n", (1 + 0.2 * sin(5 * k)) * cos(2 * M_PI * k / n),
                (1 + 0.1 * cos(3 * k)) * sin(2 * M_PI * k / n), (k < n ? 0 : 1.4) + 0.2 * sin(k));
    for (uint32_t k = 0; k < n; k++)
        fprintf(out, "f %u %u %u %u\n", k + 1, (k + 1) % n + 1, n + (k + 1) % n + 1, n + k + 1);
    fprintf(out, "f");
    for (uint32_t k = n; k > 0; k--) fprintf(out, " %u", k);
    fprintf(out, "\nf");
    for (uint32_t k = 1; k <= n; k++) fprintf(out, " %u", n + k);
    fprintf(out, "\nt crease 2/1/0 %u %u 1.5\n", n, n + 1);
    fclose(out);
}

/* An L of three bent cells, with a triangle and a pentagon at its ends. */
#define BENT_L                                                                                     \
    "v 0 0 0\nv 1 .1 .2\nv 2 0 -.1\nv 0 1 .3\nv 1.1 1 0\nv 2 1.1 .2\nv 0 2 .1\nv 1 2.1 -.2\nv "    \
    "2.7 .4 .3\n"                                                                                  \
    "v -.3 2.8 0\nv .6 3.2 .4\nv 1.3 2.7 0\n"                                                      \
    "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 3 9 6\nf 7 8 12 11 10\n"

#define FAN_OF_TRIANGLES                                                                           \
    "v 0 0 .4\nv 1 0 0\nv .7 .9 .2\nv -.4 1 -.1\nv -1 .1 .3\nv -.3 -1.1 0\nv .8 -.8 .1\nv 1.9 .9 " \
    "0\n"                                                                                          \
    "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 6\nf 2 8 3\nf 1 6 7\n"

#define CC   GD_SCHEME_CATMULL_CLARK
#define LOOP GD_SCHEME_LOOP

static void tags(void **state)
{
    require_opensubdiv();
    (void)state;
    static const struct sample samples[] = {
        {"smooth", SKEW_CUBE, CC, 0},
        {"crease", SKEW_CUBE "t crease 5/1/0 4 5 7 6 4 10\n", CC, 0},
        {"crease that ends", SKEW_CUBE "t crease 2/1/0 4 5 10\n", CC, 0},
        {"three creases meet",
         SKEW_CUBE "t crease 2/1/0 4 5 10\nt crease 2/1/0 4 6 10\nt crease 2/1/0 4 0 10\n", CC, 0},
        {"semi-sharp", SKEW_CUBE "t crease 3/1/0 4 5 7 2.3\nt crease 3/2/0 0 1 3 0.4 1.7\n", CC, 0},
        {"semi-sharp and for ever",
         SKEW_CUBE "t crease 5/1/0 4 5 7 6 4 10\nt crease 3/1/0 5 1 0 1.4\n", CC, 0},
        {"corner", SKEW_CUBE "t corner 1/1/0 4 10\nt corner 1/1/0 1 2.6\n", CC, 0},
        {"corner on a crease", SKEW_CUBE "t crease 3/1/0 4 5 7 10\nt corner 1/1/0 5 10\n", CC, 0},
        {"Loop, smooth", OCTAHEDRON, LOOP, 0},
        {"Loop, crease", OCTAHEDRON "t crease 5/1/0 0 1 2 3 0 10\n", LOOP, 0},
        {"Loop, crease that ends", OCTAHEDRON "t crease 2/1/0 0 1 10\n", LOOP, 0},
        {"Loop, semi-sharp", OCTAHEDRON "t crease 4/1/0 0 1 2 4 2.3\nt crease 2/1/0 3 5 0.6\n",
         LOOP, 0},
        {"Loop, corner", OCTAHEDRON "t corner 2/1/0 4 1 10 1.5\n", LOOP, 0},
    };
    compare_samples("tags", samples, sizeof samples / sizeof *samples);
}

static void boundaries(void **state)
{
    require_opensubdiv();
    (void)state;
    static const struct sample samples[] = {
        {"boundary, edge only", BENT_L, CC, GD_INTERPOLATE_EDGE_ONLY},
        {"boundary, edge and corner", BENT_L, CC, GD_INTERPOLATE_EDGE_AND_CORNER},
        {"boundary with tags", BENT_L "t crease 3/1/0 1 4 3 10\nt corner 1/1/0 5 10\n", CC,
         GD_INTERPOLATE_EDGE_AND_CORNER},
        {"Loop, boundary, edge only", FAN_OF_TRIANGLES, LOOP, GD_INTERPOLATE_EDGE_ONLY},
        {"Loop, boundary, edge and corner", FAN_OF_TRIANGLES, LOOP, GD_INTERPOLATE_EDGE_AND_CORNER},
    };
    compare_samples("boundaries", samples, sizeof samples / sizeof *samples);
}

static void valences(void **state)
{
    require_opensubdiv();
    (void)state;
    struct tally tally = {0};
    for (uint32_t n = 3; n <= 12; n++) {
        char name[40], text[4096];
        make_fans(n, false, text, sizeof text);
        snprintf(name, sizeof name, "valence %u", n);
        compare_sample(&(struct sample){name, text, CC, 0}, 4, &tally);
        make_fans(n, true, text, sizeof text);
        snprintf(name, sizeof name, "Loop, valence %u", n);
        compare_sample(&(struct sample){name, text, LOOP, 0}, 4, &tally);
    }
    print_tally("valences 3 to 12", &tally);
}

/* Prisms over polygons, with one semi-sharp edge. */
static void polygons(void **state)
{
    require_opensubdiv();
    (void)state;
    struct tally tally = {0};
    for (uint32_t n = 3; n <= 9; n++) {
        char name[40], text[4096];
        make_prism(n, text, sizeof text);
        snprintf(name, sizeof name, "prism of %u sides", n);
        compare_sample(&(struct sample){name, text, CC, 0}, 4, &tally);
    }
    print_tally("polygons of 3 to 9 sides", &tally);
}

/* At the end of a crease OpenSubdiv approximates the limit by the mask of another vertex type. The
 * difference decreases with every level. */
static void approximated(void **state)
{
    require_opensubdiv();
    (void)state;
    struct gd_control_mesh mesh;
    const char *text = SKEW_CUBE "t crease 2/1/0 4 5 10\n";
    check_ok(gd_read_control_mesh(text, strlen(text),
                                  &(struct gd_read_options){.format = GD_FORMAT_OBJ}, &mesh, NULL),
             NULL);
    struct pair pair = pair_of(&mesh, CC);
    double off[7] = {0};
    for (int level = 2; level <= 6; level++) {
        pair.worst[2] = 0;
        compare_vertices(&pair, level);
        off[level] = pair.worst[2];
        assert_true(off[level] > 0 && (level == 2 || off[level] < 0.55 * off[level - 1]));
    }
    print_message("# OpenSubdiv, the end of a crease, which it approximates: off by %.1e at level "
                  "2, %.1e at level 6\n",
                  off[2], off[6]);
    pair_free(&pair);
    gd_control_mesh_free(&mesh);
}

static void compare_file(const char *path, enum gd_scheme scheme, int level)
{
    size_t size;
    char *text = test_read_file(path, &size);
    if (!text) {
        print_message("# %s is not here: skipped\n", path);
        return;
    }
    struct tally tally = {0};
    const char *name = strrchr(path, '/') + 1;
    compare_sample(&(struct sample){name, text, scheme, GD_INTERPOLATE_EDGE_AND_CORNER}, level,
                   &tally);
    print_tally(name, &tally);
    free(text);
}

static void real_meshes(void **state)
{
    require_opensubdiv();
    (void)state;
    compare_file("../shared/meshes/suzanne.obj", CC, 3);
    compare_file("../shared/meshes/beast.obj", CC, 1);
    compare_file("../shared/meshes/rocker-arm.obj", LOOP, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tags),     cmocka_unit_test(boundaries),   cmocka_unit_test(valences),
        cmocka_unit_test(polygons), cmocka_unit_test(approximated), cmocka_unit_test(real_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
