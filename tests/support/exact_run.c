#include "tests/support/exact_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gd/io.h"
#include "gd/query.h"
#include "tests/support/test.h"

enum { JOBS_MOST = 64, CASES_TOLD = 5, TEXT = 256 };

/* Settings and counters of the report of failures. */
static struct {
    const char *section, *folder; /* if `folder` is NULL, the report goes to standard output */
    bool verbose, quiet;
    uint64_t told[2]; /* number of all reported failures, and number of failures near the source */
    uint64_t scene;
} report;

/* --- points as text --------------------------------------------------------------------------- */

static void write_point(const struct exact_scene *scene, const struct gd_point *point,
                        char out[TEXT])
{
    struct gd_point_description at;
    gd_point_describe(scene->mesh, point, &at);
    if (at.kind == GD_POINT_VERTEX)
        snprintf(out, TEXT, "v:%u", at.vertex.index);
    else
        snprintf(out, TEXT, "f:%u,%.17g,%.17g,%.17g", at.face.index, at.barycentric[0],
                 at.barycentric[1], at.barycentric[2]);
}

static bool read_point(const struct exact_scene *scene, const char *text, struct gd_point *out)
{
    uint32_t a, b;
    double w[3];
    struct gd_detail detail = {0};
    enum gd_status status = GD_SYNTAX;
    if (sscanf(text, "v:%u", &a) == 1)
        status = gd_point_at_vertex(scene->mesh, (struct gd_vertex){a}, out, &detail);
    if (sscanf(text, "e:%u,%u,%lf", &a, &b, w) == 3)
        status = gd_point_on_edge(scene->mesh, (struct gd_vertex[]){{a}, {b}}, w[0], out, &detail);
    if (sscanf(text, "f:%u,%lf,%lf,%lf", &a, w, w + 1, w + 2) == 4)
        status = gd_point_in_face(scene->mesh, (struct gd_face){a}, w, out, &detail);
    if (status) fprintf(stderr, "%s: %s %s\n", text, gd_status_name(status), detail.text);
    return !status;
}

/* --- units ------------------------------------------------------------------------------------ */

void exact_law(struct exact_unit *unit, const struct gd_point *point, double answered,
               double expected, double excess)
{
    struct exact_answer *worst =
        expected < 1e-6 * unit->scene->mean_edge ? &unit->nearby : &unit->worst;
    if (isnan(excess)) excess = answered == expected ? 0 : INFINITY;
    if (excess > worst->excess)
        *worst = (struct exact_answer){excess, exact_relative(answered, expected), answered,
                                       expected, *point};
}

void exact_answer(struct exact_unit *unit, struct exact_truth *truth, const struct gd_point *point,
                  double distance)
{
    double error = exact_error(truth, point, distance);
    exact_law(unit, point, distance, exact_distance(truth, point), error / EXACT_PROMISE);
}

void exact_failure(struct exact_unit *unit, const char *call, enum gd_status status,
                   const struct gd_point *point)
{
    if (unit->failure) return;
    unit->failure = call;
    unit->status = status;
    unit->failed_at = *point;
}

static void write_mesh(const struct exact_scene *scene, const char *path)
{
    FILE *file = fopen(path, "w");
    if (!file) return;
    for (uint32_t i = 0; i < scene->polygons.position_count; i++) {
        const double *p = scene->polygons.positions[i];
        fprintf(file, "v %.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (uint32_t i = 0; i < scene->polygons.polygon_count; i++) {
        const uint32_t *corner = &scene->polygons.corners[3 * i];
        fprintf(file, "f %u %u %u\n", corner[0] + 1, corner[1] + 1, corner[2] + 1);
    }
    fclose(file);
}

/* Opens the list of failures: a file of the folder, or standard output. Returns NULL if enough
 * failures were listed. */
static FILE *open_list(bool is_nearby)
{
    if (report.quiet) return NULL;
    uint64_t most = report.folder ? 4 * CASES_TOLD : CASES_TOLD;
    if (!report.verbose && report.told[is_nearby]++ >= most) return NULL;
    if (!report.folder) return stdout;
    char path[1024];
    snprintf(path, sizeof path, "%s/%s%s.txt", report.folder, report.section,
             is_nearby ? "-nearby" : "");
    FILE *file = fopen(path, "a");
    return file ? file : stdout;
}

static void list_points(FILE *list, const struct exact_unit *unit, const struct gd_point *to)
{
    char text[TEXT];
    for (uint32_t i = 0; i < unit->seed_count; i++) {
        write_point(unit->scene, &unit->seeds[i].point, text);
        fprintf(list, " %s", text);
        if (unit->seeds[i].offset > 0) fprintf(list, "+%.17g", unit->seeds[i].offset);
    }
    write_point(unit->scene, to, text);
    fprintf(list, " --to %s", text);
}

static void tell(const struct exact_unit *unit)
{
    static const char *const kinds[] = {"terrain", "sphere", "torus", "graded", "tube"};
    bool is_nearby = !unit->failure && unit->worst.excess <= 1;
    const struct exact_answer *worst = is_nearby ? &unit->nearby : &unit->worst;
    FILE *list = open_list(is_nearby);
    if (!list) return;
    char path[1024] = "MESH";
    if (report.folder) {
        snprintf(path, sizeof path, "%s/%s-%llu.obj", report.folder, report.section,
                 (unsigned long long)report.scene);
        write_mesh(unit->scene, path);
    }
    fprintf(list, "# --replay %s %llu (%s): --ask %s", report.section,
            (unsigned long long)report.scene, kinds[unit->scene->kind], path);
    list_points(list, unit, unit->failure ? &unit->failed_at : &worst->point);
    if (unit->failure)
        fprintf(list, ": %s: %s\n", unit->failure, gd_status_name(unit->status));
    else
        fprintf(list, ": %.17g, not %.17g: relative error %.1e\n", worst->answered, worst->expected,
                worst->error);
    if (list != stdout) fclose(list);
}

/* Returns the error. A law may allow more than EXACT_PROMISE, because of absolute rounding. The
 * error is then scaled by EXACT_PROMISE divided by the allowed error. */
static double weighed(const struct exact_answer *answer)
{
    return fmin(answer->error, answer->excess * EXACT_PROMISE);
}

void exact_conclude(struct exact_unit *unit, struct exact_tally *tally)
{
    tally->asked++;
    bool is_wrong = unit->worst.excess > 1, is_wrong_near = unit->nearby.excess > 1;
    if (unit->failure)
        tally->failed++;
    else if (is_wrong)
        tally->wrong++;
    else if (is_wrong_near)
        tally->wrong_near++;
    tally->worst = fmax(tally->worst, weighed(&unit->worst));
    tally->worst_near = fmax(tally->worst_near, weighed(&unit->nearby));
    if (unit->failure || is_wrong || is_wrong_near) tell(unit);
}

/* --- runs ------------------------------------------------------------------------------------- */

struct options {
    bool is_long, verbose;
    uint64_t count, first;
    uint32_t jobs;
    uint32_t section_count;
    const char *sections[16];
};

static void run_job(const struct exact_section *section, uint64_t count, uint64_t first,
                    uint32_t step, struct exact_tally *tally)
{
    report.section = section->name;
    report.told[0] = report.told[1] = 0;
    for (uint64_t scene = first; tally->asked < count; scene += step) {
        tally->scene = report.scene = scene;
        section->run(scene, tally);
    }
}

static void add_tally(struct exact_tally *sum, const struct exact_tally *tally)
{
    sum->asked += tally->asked;
    sum->failed += tally->failed;
    sum->wrong += tally->wrong;
    sum->wrong_near += tally->wrong_near;
    sum->worst = fmax(sum->worst, tally->worst);
    sum->worst_near = fmax(sum->worst_near, tally->worst_near);
}

/* Waits for a job. A crash counts as a failure of the job's current scene. */
static void wait_for(pid_t child, struct exact_tally *tally)
{
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
    tally->failed++;
    printf("# %s: the process ended by status %d in scene %llu\n", report.section, status,
           (unsigned long long)tally->scene);
}

static struct exact_tally run_section(const struct exact_section *section,
                                      const struct options *options)
{
    struct exact_tally sum = {0};
    uint64_t count = options->count ? options->count : section->long_count;
    struct exact_tally *shared = mmap(NULL, JOBS_MOST * sizeof *shared, PROT_READ | PROT_WRITE,
                                      MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) abort();
    pid_t child[JOBS_MOST];
    report.section = section->name;
    fflush(stdout);
    for (uint32_t job = 0; job < options->jobs; job++) {
        child[job] = fork();
        if (child[job] != 0) continue;
        run_job(section, (count + options->jobs - 1) / options->jobs, options->first + job,
                options->jobs, &shared[job]);
        fflush(stdout);
        _exit(0);
    }
    for (uint32_t job = 0; job < options->jobs; job++) {
        if (child[job] < 0) abort();
        wait_for(child[job], &shared[job]);
        add_tally(&sum, &shared[job]);
    }
    munmap(shared, JOBS_MOST * sizeof *shared);
    return sum;
}

static void measured(const struct exact_tally *tally, char out[TEXT])
{
    snprintf(
        out, TEXT,
        "%llu wrong, %llu failed of %llu, %llu more wrong nearby; worst errors %.1e, nearby %.1e",
        (unsigned long long)tally->wrong, (unsigned long long)tally->failed,
        (unsigned long long)tally->asked, (unsigned long long)tally->wrong_near, tally->worst,
        tally->worst_near);
}

static bool holds(const struct exact_section *section, const struct exact_tally *tally)
{
    return tally->wrong == 0 && tally->wrong_near == 0 &&
           (section->flag == EXACT_MAY_FAIL || tally->failed == 0);
}

/* Prints a line for tests/fault/table.py. Returns whether the section passed. */
static bool print_row(const struct exact_section *section, const struct exact_tally *tally)
{
    char text[TEXT];
    bool is_held = holds(section, tally);
    measured(tally, text);
    printf(
        "# figure {\"promise\": \"%s: %s\", \"asked\": \"%s\", \"measured\": \"%s\", \"ok\": %s}\n",
        section->name, section->promise,
        section->flag == EXACT_MAY_FAIL ? "0 wrong" : "0 wrong, 0 failed", text,
        is_held ? "true" : "false");
    printf("%s %s\n", is_held ? "ok" : "not ok", section->name);
    fflush(stdout);
    return is_held;
}

static bool is_chosen(const struct options *options, const char *name)
{
    bool found = options->section_count == 0;
    for (uint32_t i = 0; i < options->section_count; i++)
        found |= strcmp(options->sections[i], name) == 0;
    return found;
}

/* --- one question ----------------------------------------------------------------------------- */

static bool open_mesh(const char *path, struct exact_scene *scene)
{
    size_t size = 0;
    struct gd_polygons polygons;
    char *bytes = test_read_file(path, &size);
    bool is_read = bytes && gd_read_polygons(bytes, size, NULL, &polygons, NULL) == GD_OK;
    free(bytes);
    if (is_read)
        exact_scene_from(polygons, scene);
    else
        fprintf(stderr, "%s can't be read\n", path);
    return is_read;
}

static void ask_field(const struct exact_scene *scene, const struct gd_seed *seeds, uint32_t count,
                      const struct gd_point *to)
{
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    struct gd_field_request request = {.seeds = seeds, .seed_count = count};
    enum gd_status status = gd_field_build(scene->mesh, &request, NULL, &field, &detail);
    double distance = NAN;
    struct gd_path path = {0};
    if (!status) status = gd_field_distance(field, to, &distance);
    printf("field          %.17g  %s %s\n", distance, gd_status_name(status), detail.text);
    if (field) {
        status = gd_field_path(field, to, &path);
        printf("field's path   %.17g  %s\n", status ? NAN : path.length, gd_status_name(status));
        gd_path_free(&path);
    }
    gd_field_release(field);
}

static void ask_pair(const struct exact_scene *scene, const char *name, const struct gd_point *from,
                     const struct gd_point *to)
{
    struct gd_pair_answer answer = {0};
    struct gd_detail detail = {0};
    enum gd_status status = gd_pair_solve(
        scene->mesh, &(struct gd_pair_request){.from = from, .to = to}, NULL, &answer, &detail);
    printf("%s       %.17g  %s %s\n", name, status ? NAN : answer.distance, gd_status_name(status),
           detail.text);
    gd_pair_answer_free(&answer);
    status = gd_pair_solve(
        scene->mesh, &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH},
        NULL, &answer, &detail);
    printf("%s, path %.17g  %s %s\n", name, status ? NAN : answer.path.length,
           gd_status_name(status), detail.text);
    gd_pair_answer_free(&answer);
}

static void ask_solver(const struct exact_scene *scene, const struct gd_seed *seeds, uint32_t count,
                       const struct gd_point *to)
{
    struct exact_truth truth;
    exact_truth_open(scene, seeds, count, INFINITY, &truth);
    printf("extended       %.17g\n", exact_distance(&truth, to));
    exact_error(&truth, to, -1); /* makes the exact solver switch to quadruple precision */
    printf("quadruple      %.17g\n", exact_distance(&truth, to));
    exact_truth_close(&truth);
}

static int ask(int argc, char **argv)
{
    struct exact_scene scene;
    struct gd_seed seeds[16] = {0};
    struct gd_point to = {0};
    uint32_t count = 0;
    bool has_target = false;
    if (argc < 5 || !open_mesh(argv[2], &scene)) return 2;
    for (int i = 3; i < argc; i++) {
        const char *offset = strchr(argv[i], '+');
        if (strcmp(argv[i], "--to") == 0 && i + 1 < argc) {
            has_target = read_point(&scene, argv[++i], &to);
        } else if (count < 16 && read_point(&scene, argv[i], &seeds[count].point)) {
            seeds[count++].offset = offset ? strtod(offset + 1, NULL) : 0;
        }
    }
    if (count > 0 && has_target) {
        ask_field(&scene, seeds, count, &to);
        if (count == 1) ask_pair(&scene, "pair   ", &seeds[0].point, &to);
        if (count == 1) ask_pair(&scene, "swapped", &to, &seeds[0].point);
        ask_solver(&scene, seeds, count, &to);
    }
    exact_scene_close(&scene);
    return count > 0 && has_target ? 0 : 2;
}

/* --- main ------------------------------------------------------------------------------------- */

static void short_form(void **state)
{
    const struct exact_section *section = *state;
    struct exact_tally tally = {0};
    char text[TEXT];
    run_job(section, section->short_count, 1, 1, &tally);
    measured(&tally, text);
    print_message("# %s\n", text);
    assert_true(holds(section, &tally));
}

static int run_short(const struct exact_section *sections, uint32_t count)
{
    struct CMUnitTest tests[16];
    for (uint32_t i = 0; i < count; i++)
        tests[i] =
            (struct CMUnitTest){sections[i].name, short_form, NULL, NULL, (void *)&sections[i]};
    return _cmocka_run_group_tests("exact", tests, count, NULL, NULL);
}

static int run_long(const struct exact_section *sections, uint32_t count,
                    const struct options *options)
{
    bool held = true;
    for (uint32_t i = 0; i < count; i++) {
        if (!is_chosen(options, sections[i].name)) continue;
        struct exact_tally tally = run_section(&sections[i], options);
        held &= print_row(&sections[i], &tally);
    }
    return held ? 0 : 1;
}

static int replay(const struct exact_section *sections, uint32_t count, const char *name,
                  const char *scene)
{
    char text[TEXT];
    report.verbose = true;
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(sections[i].name, name) != 0) continue;
        struct exact_tally tally = {0};
        report.section = name;
        report.scene = strtoull(scene, NULL, 10);
        sections[i].run(report.scene, &tally);
        measured(&tally, text);
        printf("%s\n", text);
        return holds(&sections[i], &tally) ? 0 : 1;
    }
    fprintf(stderr, "there is no section %s\n", name);
    return 2;
}

int exact_main(int argc, char **argv, const struct exact_section *sections, uint32_t count)
{
    struct options options = {.jobs = (uint32_t)sysconf(_SC_NPROCESSORS_ONLN), .first = 1};
    if (argc == 1) return run_short(sections, count);
    if (strcmp(argv[1], "--ask") == 0) return ask(argc, argv);
    for (int i = 1; i < argc; i++) {
        const char *next = i + 1 < argc ? argv[i + 1] : "0";
        if (strcmp(argv[i], "--replay") == 0 && i + 2 < argc)
            return replay(sections, count, argv[i + 1], argv[i + 2]);
        if (strcmp(argv[i], "--long") == 0)
            options.is_long = true;
        else if (strcmp(argv[i], "--count") == 0)
            options.count = strtoull(next, NULL, 10), i++;
        else if (strcmp(argv[i], "--first") == 0)
            options.first = strtoull(next, NULL, 10), i++;
        else if (strcmp(argv[i], "--jobs") == 0)
            options.jobs = (uint32_t)strtoul(next, NULL, 10), i++;
        else if (strcmp(argv[i], "--cases") == 0)
            report.folder = next, i++;
        else if (options.section_count < 16)
            options.sections[options.section_count++] = argv[i];
    }
    if (options.jobs < 1 || options.jobs > JOBS_MOST) options.jobs = 1;
    return run_long(sections, count, &options);
}
