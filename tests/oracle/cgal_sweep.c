/* gd_sweep [--sources N] MESH...: compares the engine with CGAL by the distances of all vertices
 * from N random vertices. A MESH is a file, or a sample as "name:key=value,key=value". Non-manifold
 * parts are separated (repair_split) for both. Where the distances differ by more than 1e-9, the
 * paths decide (cgal_polyline.h). Prints `ok`, `not ok` or `skip` for each mesh. `not ok` means
 * that the engine was wrong, or that the paths could not decide. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "gd/io.h"
#include "tests/oracle/cgal_distances.h"
#include "tests/samples/argument.h"
#include "tests/samples/random.h"
#include "tests/support/test.h"

static const double promise = 1e-9;

enum { EXIT_USAGE = 2, LISTED = 5, DEFAULT_SOURCES = 20, MAX_SOURCES = 100000, MAX_WORDS = 256 };

static const char usage[] = "usage: gd_sweep [--sources N] FILE-OR-SAMPLE...\n";

/* Which solver is right about a distance on which they differ. */
enum verdict {
    CGAL_TOO_LONG,
    CGAL_TOO_SHORT,
    ENGINE_TOO_LONG,
    ENGINE_TOO_SHORT,
    UNDECIDED,
    VERDICTS
};

static const char *const verdict_texts[VERDICTS] = {"CGAL is too long", "CGAL is too short",
                                                    "the engine is too long",
                                                    "the engine is too short", "undecided"};

struct sweep {
    const char *name;
    const struct gd_mesh *mesh;
    struct gd_polygons triangles; /* the engine's triangles, which are oriented and repaired */
    struct cgal_surface *cgal;
    double *ours, *theirs;
    uint64_t compared, unreachable, exceptions[VERDICTS];
    double worst_agreement, worst_exception[VERDICTS];
    uint64_t our_ns, their_ns;
    uint32_t listed, given_up;
};

/* --- meshes ----------------------------------------------------------------------------------- */

static enum gd_status read_file(const char *path, struct gd_polygons *out, struct gd_detail *detail)
{
    size_t size = 0;
    char *bytes = test_read_file(path, &size);
    if (!bytes)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "there is neither a sample nor a file \"%s\"",
                       path);
    enum gd_status status = gd_read_polygons(bytes, size, NULL, out, detail);
    free(bytes);
    return status;
}

/* Generates the sample "name" or "name:key=value,key=value". *known is false if it does not
 * exist. */
static enum gd_status generate(const char *text, struct gd_polygons *out, bool *known)
{
    char words[MAX_WORDS], *rest = NULL;
    double values[SAMPLE_PARAMETERS];
    snprintf(words, sizeof words, "%s", text);
    const char *name = strtok_r(words, ":", &rest);
    const struct sample *sample = name ? sample_find(name) : NULL;
    *known = sample;
    if (!sample) return GD_INVALID_ARGUMENT;
    sample_defaults(sample, values);
    for (char *word; (word = strtok_r(NULL, ",", &rest));)
        if (!sample_set("gd_sweep", sample, word, values)) return GD_INVALID_ARGUMENT;
    return sample->generate(values, out);
}

static enum gd_status load(const char *name, struct gd_mesh **out, struct gd_detail *detail)
{
    struct gd_polygons polygons = {0};
    bool is_sample;
    enum gd_status status = generate(name, &polygons, &is_sample);
    if (!is_sample) status = read_file(name, &polygons, detail);
    const struct gd_mesh_options options = {.repair_split = true};
    if (!status) status = gd_mesh_build(&polygons, &options, NULL, out, detail);
    gd_polygons_free(&polygons);
    return status;
}

/* --- judgement -------------------------------------------------------------------------------- */

static long double our_length(const struct sweep *sweep, const struct gd_field *field,
                              uint32_t source, uint32_t target)
{
    struct gd_point point;
    struct gd_path path = {0};
    struct polyline line = {0};
    if (gd_point_at_vertex(sweep->mesh, (struct gd_vertex){target}, &point, NULL)) return NAN;
    if (gd_field_path(field, &point, &path)) return NAN;
    for (uint32_t i = 0; i < path.count; i++) {
        struct gd_point_description at;
        gd_point_describe(sweep->mesh, &path.points[i], &at);
        if (at.kind == GD_POINT_VERTEX)
            polyline_add(&line, (struct polyline_point){at.vertex.index, at.vertex.index, 0});
        else
            polyline_add(&line, (struct polyline_point){at.edge[0].index, at.edge[1].index, at.t});
        /* a path between vertices never bends inside a face */
        line.failed |= at.kind == GD_POINT_FACE;
    }
    gd_path_free(&path);
    long double length = polyline_length(&line, &sweep->triangles, source, target);
    polyline_free(&line);
    return length;
}

static long double their_length(const struct sweep *sweep, uint32_t source, uint32_t target)
{
    struct polyline line = {0};
    long double length = NAN;
    if (cgal_surface_path(sweep->cgal, target, &line))
        length = polyline_length(&line, &sweep->triangles, source, target);
    polyline_free(&line);
    return length;
}

static double difference(double a, double b)
{
    if (a == b) return 0;
    return isinf(a) || isinf(b) ? 1 : fabs(a - b) / fmax(a, b);
}

/* Decides which distance is wrong. The length of the shorter path is the reference. A distance
 * below this length is wrong too, because no path is so short. */
static enum verdict judge(double ours, double theirs, long double our_path, long double their_path)
{
    double best = (double)fminl(our_path, their_path);
    bool we_have_it = difference(ours, best) <= promise,
         they_have_it = difference(theirs, best) <= promise;
    if (we_have_it && !they_have_it) return theirs > best ? CGAL_TOO_LONG : CGAL_TOO_SHORT;
    if (they_have_it && !we_have_it) return ours > best ? ENGINE_TOO_LONG : ENGINE_TOO_SHORT;
    return UNDECIDED;
}

static void settle(struct sweep *sweep, const struct gd_field *field, uint32_t source,
                   uint32_t target)
{
    double ours = sweep->ours[target], theirs = sweep->theirs[target];
    long double our_path = our_length(sweep, field, source, target),
                their_path = their_length(sweep, source, target);
    enum verdict verdict = judge(ours, theirs, our_path, their_path);
    sweep->exceptions[verdict]++;
    sweep->worst_exception[verdict] =
        fmax(sweep->worst_exception[verdict], difference(ours, theirs));
    if (sweep->listed++ < LISTED || verdict >= ENGINE_TOO_LONG)
        printf("# %s: from vertex %u to %u: engine %.17g, CGAL %.17g (%.2g); paths of %.20Lg and "
               "%.20Lg: %s\n",
               sweep->name, source, target, ours, theirs, difference(ours, theirs), our_path,
               their_path, verdict_texts[verdict]);
}

/* --- the sweep -------------------------------------------------------------------------------- */

static struct gd_field *solve(struct sweep *sweep, uint32_t source)
{
    struct gd_seed seed = {0};
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    if (gd_point_at_vertex(sweep->mesh, (struct gd_vertex){source}, &seed.point, NULL)) return NULL;
    uint64_t start = gd_now_ns();
    enum gd_status status =
        gd_field_build(sweep->mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                       NULL, &field, &detail);
    sweep->our_ns += gd_now_ns() - start;
    if (status) printf("# %s: %s: %s\n", sweep->name, gd_status_name(status), detail.text);
    return field;
}

static bool compare(struct sweep *sweep, uint32_t source)
{
    struct gd_field *field = solve(sweep, source);
    if (!field) return false;
    gd_field_vertex_distances(field, sweep->ours);
    uint64_t start = gd_now_ns();
    bool solved = cgal_surface_solve(sweep->cgal, source, sweep->theirs);
    sweep->their_ns += gd_now_ns() - start;
    if (!solved) sweep->given_up++;
    for (uint32_t v = 0; solved && v < sweep->triangles.position_count; v++) {
        if (isnan(sweep->ours[v])) continue;
        sweep->compared++;
        sweep->unreachable += isinf(sweep->ours[v]) != 0;
        double error = difference(sweep->ours[v], sweep->theirs[v]);
        if (error <= promise)
            sweep->worst_agreement = fmax(sweep->worst_agreement, error);
        else
            settle(sweep, field, source, v);
    }
    gd_field_release(field);
    return true;
}

static void report(const struct sweep *sweep, uint32_t sources)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(sweep->mesh);
    uint64_t exceptions = 0;
    for (int i = 0; i < VERDICTS; i++) exceptions += sweep->exceptions[i];
    printf("# %s: %u vertices, %u faces, %u sources: %" PRIu64 " of %" PRIu64
           " distances agree, to %.2g; a source takes %.1f ms, CGAL %.1f ms\n",
           sweep->name, summary->vertices, summary->faces, sources, sweep->compared - exceptions,
           sweep->compared, sweep->worst_agreement, 1e-6 * (double)sweep->our_ns / sources,
           1e-6 * (double)sweep->their_ns / sources);
    if (sweep->unreachable)
        printf("# %s: %" PRIu64 " of them are infinite: in other components\n", sweep->name,
               sweep->unreachable);
    if (sweep->given_up) printf("# %s: CGAL gave up on %u sources\n", sweep->name, sweep->given_up);
    for (int i = 0; i < VERDICTS; i++)
        if (sweep->exceptions[i])
            printf("# %s: %" PRIu64 " times, by up to %.2g: %s\n", sweep->name,
                   sweep->exceptions[i], sweep->worst_exception[i], verdict_texts[i]);
}

static bool run(struct sweep *sweep, uint32_t sources)
{
    struct rng rng = {sweep->triangles.polygon_count};
    uint32_t corners = 3 * sweep->triangles.polygon_count;
    for (uint32_t i = 0; i < sources; i++)
        if (!compare(sweep, sweep->triangles.corners[rng_below(&rng, corners)])) return false;
    report(sweep, sources);
    return !sweep->exceptions[ENGINE_TOO_LONG] && !sweep->exceptions[ENGINE_TOO_SHORT] &&
           !sweep->exceptions[UNDECIDED];
}

static bool sweep_mesh(const char *name, const struct gd_mesh *mesh, uint32_t sources)
{
    const char *file = strrchr(name, '/');
    struct sweep sweep = {.name = file ? file + 1 : name, .mesh = mesh};
    bool passed = false;
    if (gd_mesh_polygons(mesh, &sweep.triangles) == GD_OK) {
        sweep.cgal = cgal_surface_create(&sweep.triangles);
        sweep.ours = calloc(sweep.triangles.position_count, sizeof *sweep.ours);
        sweep.theirs = calloc(sweep.triangles.position_count, sizeof *sweep.theirs);
        if (!sweep.cgal) printf("# %s: CGAL does not take it\n", sweep.name);
        passed = sweep.cgal && sweep.ours && sweep.theirs && run(&sweep, sources);
    }
    cgal_surface_free(sweep.cgal);
    gd_polygons_free(&sweep.triangles);
    free(sweep.ours);
    free(sweep.theirs);
    return passed;
}

/* Returns 0 if the mesh passed. */
static int sweep_named(const char *name, uint32_t sources)
{
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    enum gd_status status = load(name, &mesh, &detail);
    if (status) printf("# %s: %s: %s\n", name, gd_status_name(status), detail.text);
    bool passed = !status && sweep_mesh(name, mesh, sources);
    gd_mesh_release(mesh);
    printf("%s sweep of %s\n", passed ? "ok" : "not ok", name);
    fflush(stdout);
    return !passed;
}

int main(int argc, char **argv)
{
    uint32_t sources = DEFAULT_SOURCES;
    int first = 1, failed = 0;
    if (argc > 2 && strcmp(argv[1], "--sources") == 0) {
        long wanted = strtol(argv[2], NULL, 10);
        if (wanted < 1 || wanted > MAX_SOURCES) first = argc;
        sources = (uint32_t)wanted;
        first += 2;
    }
    if (first >= argc) {
        fputs(usage, stderr);
        return EXIT_USAGE;
    }
    if (!cgal_is_available()) {
        printf("# skipped: CGAL (libcgal-dev) is not installed\nskip sweep\n");
        return EXIT_SUCCESS;
    }
    for (int i = first; i < argc; i++) failed |= sweep_named(argv[i], sources);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
