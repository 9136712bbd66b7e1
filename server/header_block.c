/* See header_block.h. */
#include "server/header_block.h"

#include <assert.h>
#include <string.h>

static void append(struct server_header_block *block, const char *text)
{
    size_t size = strlen(text);
    assert(size < sizeof block->value - block->size);
    memcpy(block->value + block->size, text, size + 1);
    block->size += size;
}

void server_header_block_join(struct server_header_block *block, const struct server_response *response)
{
    block->name = response->headers[0].name;
    block->size = block->break_count = 0;
    append(block, response->headers[0].value);
    for (uint32_t i = 1; i < response->header_count; i++) {
        block->breaks[block->break_count++] = block->size;
        append(block, "  ");
        append(block, response->headers[i].name);
        append(block, ": ");
        append(block, response->headers[i].value);
    }
}

void server_header_block_break(const struct server_header_block *block, char *value)
{
    for (uint32_t i = 0; i < block->break_count; i++) memcpy(value + block->breaks[i], "\r\n", 2);
}
