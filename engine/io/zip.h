/* Zip: reads the files of an archive in memory one after the other. Uses minizip; opens no file of
 * the system. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/status.h"

struct gd__zip;

/* Opens an archive. Borrows its bytes. Returns NULL if the bytes are not an archive or there is no
 * memory. */
struct gd__zip *gd__zip_open(const void *bytes, size_t size);
void gd__zip_close(struct gd__zip *zip);

/* Begins to read the file with that name, ignoring the case of letters. `*size` is the file's
 * declared size. gd__zip_read never returns more bytes. Returns false if there is no such file. */
bool gd__zip_begin(struct gd__zip *zip, const char *name, uint64_t *size);

/* Reads up to `room` bytes of the file. At the end of the file, `*read` is 0. Returns false if the
 * data is damaged, encrypted, or compressed by another method than deflate. */
bool gd__zip_read(struct gd__zip *zip, void *out, size_t room, size_t *read);

/* Closes the file that gd__zip_begin opened. Returns false if the whole file was read and its
 * checksum is wrong. */
bool gd__zip_end(struct gd__zip *zip);
