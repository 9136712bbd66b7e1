/* Makes the engine's allocations fail, one after the other, in each of its operations
 * (operations.h). A call must either report missing memory and leave its output unchanged, or give
 * the correct answer to the last bit. Afterwards the engine holds no more memory than before, and
 * the operation works again.
 *
 *     gd_alloc [--short] [--list] [WORD]     tests operations whose name contains this word
 *                                            --list: prints the addresses of failed calls
 *
 * Each call path (stack of return addresses) fails once alone, and once together with all later
 * calls. Without --short, each call also fails by its number. With --short, after the first DENSE
 * trials only every STEP-th new call path fails. A child process runs an operation's
 * trials, so that a crash is counted. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gd/workspace.h"
#include "tests/fault/allocator.h"
#include "tests/fault/operations.h"

enum { OUT_MOST = 1 << 16, PATIENCE_SECONDS = 400, SHOWN = 10, DENSE = 30, STEP = 6 };

/* Counters in memory that the child processes share. */
static struct tally {
    struct allocator_book book;
    unsigned long trials, refused, leaks, wrong, crashes;
    char trial[200];
} * tally;

static bool is_short;

static const struct operations *const suites[] = {
    &file_operations,  &mesh_operations,    &field_operations,      &query_operations,
    &curve_operations, &line_operations,    &parametric_operations, &limit_operations,
    &json_operations,  &picture_operations, &edit_operations,
};

/* --- one trial -------------------------------------------------------------------------------- */

static unsigned char out[OUT_MOST] __attribute__((aligned(64)));

static void say(const struct operation *operation, const char *what)
{
    if (tally->leaks + tally->wrong <= SHOWN)
        printf("wrong: %s, %s: %s\n", operation->name, tally->trial, what);
    fflush(stdout);
}

static void judge(bool is_right, unsigned long *count, const struct operation *operation,
                  const char *what)
{
    if (is_right) return;
    ++*count;
    say(operation, what);
}

static bool is_untouched(size_t size)
{
    for (size_t i = 0; i < size; i++)
        if (out[i] != 0xa5) return false;
    return true;
}

/* The result of a call: the status and the digest of the answer. */
struct result {
    enum gd_status status;
    uint64_t digest;
};

static struct result look_at(const struct operation *operation, enum gd_status status)
{
    struct digest digest = {0xcbf29ce484222325u};
    if (status) {
        judge(is_untouched(operation->answer->size), &tally->wrong, operation,
              "its output was touched");
        return (struct result){status, 0};
    }
    operation->answer->digest(&digest, out);
    if (operation->answer->discard) operation->answer->discard(out);
    return (struct result){status, digest.value};
}

static struct result run_fine(const struct operation *operation)
{
    memset(out, 0xa5, operation->answer->size);
    return look_at(operation, operation->run(out));
}

static void expect(struct result expected, struct result got, const struct operation *operation,
                   const char *when)
{
    char what[100];
    snprintf(what, sizeof what, "%s%s", got.status ? gd_status_name(got.status) : "another answer",
             when);
    judge(got.status == expected.status && got.digest == expected.digest, &tally->wrong, operation,
          what);
}

static void settle(const struct operation *operation)
{
    if (operation->settle) operation->settle();
    gd_spare_memory(0);
}

/* Runs the operation while calls fail by `order`. Returns whether a call failed. */
static bool try_one(const struct operation *operation, struct result expected,
                    struct allocator_order order)
{
    settle(operation);
    struct allocator_live before = allocator_live();
    memset(out, 0xa5, operation->answer->size);
    allocator_arm(order);
    enum gd_status status = operation->run(out);
    bool has_failed = allocator_disarm() > 0;
    struct result result = look_at(operation, status);
    if (has_failed && status == GD_NO_MEMORY)
        tally->refused++;
    else
        expect(expected, result, operation, "");
    if (operation->settle) expect(expected, run_fine(operation), operation, " afterwards");
    settle(operation);
    struct allocator_live after = allocator_live();
    judge(after.blocks == before.blocks && after.mapped == before.mapped, &tally->leaks, operation,
          "memory is left");
    tally->trials += has_failed;
    return has_failed;
}

/* --- all of one operation --------------------------------------------------------------------- */

/* Repeats trials with one kind of `order`. If `order` selects fresh calls, ends when a trial
 * reaches no new call path; otherwise ends when no further call fails. */
static void try_each(const struct operation *operation, struct result expected, const char *kind,
                     struct allocator_order order)
{
    memset(&tally->book.stacks, 0, sizeof tally->book.stacks);
    bool is_numbered = !order.fresh, goes_on = true;
    for (unsigned long number = 0; goes_on; number++) {
        uint32_t reached = tally->book.stacks.count;
        if (is_numbered) order.nth = number + 1;
        if (is_short && number >= DENSE) order.step = STEP;
        snprintf(tally->trial, sizeof tally->trial, "%s %lu", kind, number);
        bool has_failed = try_one(operation, expected, order);
        goes_on = is_numbered ? has_failed : tally->book.stacks.count > reached;
    }
}

static void try_all(const struct operation *operation)
{
    strcpy(tally->trial, "nothing fails");
    struct result expected = run_fine(operation);
    judge(expected.status == operation->status, &tally->wrong, operation,
          gd_status_name(expected.status));
    if (operation->settle) expect(expected, run_fine(operation), operation, " the second time");
    try_each(operation, expected, "way", (struct allocator_order){.fresh = true});
    try_each(operation, expected, "way and all behind it",
             (struct allocator_order){.fresh = true, .lasting = true});
    if (!is_short) try_each(operation, expected, "call", (struct allocator_order){0});
}

static void try_in_child(const struct operation *operation)
{
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        alarm(PATIENCE_SECONDS);
        try_all(operation);
        _exit(0);
    }
    int status;
    if (child < 0 || waitpid(child, &status, 0) < 0 || status == 0) return;
    tally->crashes++;
    printf("wrong: %s, %s: crashed (%s)\n", operation->name, tally->trial,
           WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "exit");
}

/* --- all of all ------------------------------------------------------------------------------- */

/* Prints the addresses of failed calls for addr2line. */
static void list_sites(void)
{
    extern const char __executable_start[];
    for (uint32_t i = 0; i < STACKS_SLOTS; i++)
        if (tally->book.sites.keys[i])
            printf("site %lx\n",
                   (unsigned long)(tally->book.sites.keys[i] - 1 - (uintptr_t)__executable_start));
}

static int report(unsigned operations)
{
    unsigned long sites = tally->book.sites.count,
                  faults = tally->crashes + tally->leaks + tally->wrong;
    printf("# figure {\"promise\": \"allocation failures in the engine, %u operations\", "
           "\"asked\": \"0 crashes, 0 "
           "leaks, 0 wrong answers\", "
           "\"measured\": \"%lu call sites, %lu failures (%lu refused, the others did without), "
           "%lu crashes, %lu "
           "leaks, %lu wrong answers\", "
           "\"ok\": %s}\n",
           operations, sites, tally->trials, tally->refused, tally->crashes, tally->leaks,
           tally->wrong, faults ? "false" : "true");
    printf("%s alloc_engine\n", faults || !sites ? "not ok" : "ok");
    return faults || !sites;
}

int main(int count, char **arguments)
{
    const char *word = "";
    bool is_listed = false;
    for (int i = 1; i < count; i++) {
        if (strcmp(arguments[i], "--short") == 0)
            is_short = true;
        else if (strcmp(arguments[i], "--list") == 0)
            is_listed = true;
        else
            word = arguments[i];
    }
    tally = mmap(NULL, sizeof *tally, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (tally == MAP_FAILED) return 1;
    allocator_open(&tally->book);
    unsigned operations = 0;
    for (uint32_t s = 0; s < COUNT(suites); s++) {
        suites[s]->open();
        for (uint32_t i = 0; i < suites[s]->count; i++) {
            if (!strstr(suites[s]->items[i].name, word)) continue;
            try_in_child(&suites[s]->items[i]);
            operations++;
        }
    }
    if (is_listed) list_sites();
    return report(operations);
}
