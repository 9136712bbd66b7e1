#include "tests/fuzz/promise.h"

#include <jansson.h>
#include <stdlib.h>

#define SENTENCE_BYTES 65536

void promise(int holds)
{
    if (!holds) abort();
}

void promise_json(struct proto_writer *writer)
{
    json_t *back = json_loadb(writer->data, writer->size, JSON_REJECT_DUPLICATES, NULL);
    promise(back != NULL);
    json_decref(back);
    proto_writer_free(writer);
}

void promise_sentence(const struct proto_problem *problem)
{
    struct proto_writer writer;
    promise(problem->detail[0] != '\0');
    proto_writer_init(&writer, SENTENCE_BYTES);
    proto_problem_encode(&writer, problem);
    promise_json(&writer);
}
