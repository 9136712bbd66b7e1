/* See header_block.h. */
#include "server/http/header_block.h"

#include <assert.h>
#include <string.h>

static char *append(char *at, const char *text, size_t size)
{
    return (char *)memcpy(at, text, size) + size;
}

void server_header_block_join(struct server_header_block *block,
                              const struct server_response *response, const char *date)
{
    char *at = append(block->value, date, strlen(date));
    for (uint32_t i = 0; i < response->header_count; i++) {
        const struct server_response_header *header = &response->headers[i];
        size_t size = strlen(header->name);
        assert(size <= SERVER_HEADER_NAME);
        block->breaks[i] = (size_t)(at - block->value);
        at = append(at, "  ", 2);
        at = append(at, header->name, size);
        at = append(at, ": ", 2);
        at = append(at, header->value, header->size);
    }
    *at = '\0';
    block->break_count = response->header_count;
}

void server_header_block_break(const struct server_header_block *block, char *value)
{
    for (uint32_t i = 0; i < block->break_count; i++) memcpy(value + block->breaks[i], "\r\n", 2);
}
