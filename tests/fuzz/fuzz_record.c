/* Fuzzes the records of the store: its manifests and the rows of its database. The first byte
 * selects whether the text is used unchanged or gets the correct checksum. With the correct
 * checksum the fuzzer also reaches the code after the check. Writing a parsed record must produce
 * the same record. */
#include <stdlib.h>
#include <string.h>

#include "server/store/record.h"
#include "server/base/sha256.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const char *text, size_t size)
{
    struct server_record *record, *again;
    if (server_record_read(NULL, text, size, &record) != SERVER_RECORD_READ) return;
    size_t length;
    char *written = server_record_write(record, &length);
    promise(written != NULL);
    promise(server_record_read(NULL, written, length, &again) == SERVER_RECORD_READ);
    promise(server_record_equal(record, again) &&
            strcmp(record->description, again->description) == 0);
    server_record_release(again);
    server_record_release(record);
    free(written);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char word[] = "checksum ";
    char sum[SERVER_SHA256_HEX];
    if (size == 0) return 0;
    bool seal = data[0] & 1;
    size_t body = size - 1, length = body;
    char *text = malloc(body + sizeof word + SERVER_SHA256_HEX + 1);
    promise(text != NULL);
    memcpy(text, data + 1, body);
    if (seal) {
        server_sha256(text, body, sum);
        memcpy(text + length, word, sizeof word - 1);
        length += sizeof word - 1;
        memcpy(text + length, sum, SERVER_SHA256_HEX - 1);
        length += SERVER_SHA256_HEX - 1;
        text[length++] = '\n';
    }
    /* allocates no additional byte, so that overruns are detected */
    char *exact = malloc(length ? length : 1);
    promise(exact != NULL);
    memcpy(exact, text, length);
    free(text);
    check(exact, length);
    free(exact);
    return 0;
}
