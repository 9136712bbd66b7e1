/* Tests that are the same for every reader. They use tables of valid and invalid input, and
 * truncated input. */
#pragma once

#include "tests/unit/io/reading.h"

struct reader {
    enum gd_format format;
    const struct good_input *good;
    size_t good_count;
    const struct bad_input *bad;
    size_t bad_count;
};

static void reads_good_input(void **state)
{
    const struct reader *reader = *state;
    check_good(reader->format, reader->good, reader->good_count);
}

static void refuses_bad_input(void **state)
{
    const struct reader *reader = *state;
    check_bad(reader->format, reader->bad, reader->bad_count);
}

static void survives_truncation(void **state)
{
    const struct reader *reader = *state;
    check_truncations(reader->format, reader->good, reader->good_count);
}

/* Entries for a table of tests. `reader` must outlive the table. */
#define READER_TESTS(reader)                                                                       \
    cmocka_unit_test_prestate(reads_good_input, reader),                                           \
        cmocka_unit_test_prestate(refuses_bad_input, reader),                                      \
        cmocka_unit_test_prestate(survives_truncation, reader)
