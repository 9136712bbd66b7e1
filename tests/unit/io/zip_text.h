/* Makes zip archives of stored (uncompressed) files for tests. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define ZIP_FILES 4

struct zip_file {
    const char *name, *text;
};

struct zip_bytes {
    char bytes[65536];
    size_t size;
    bool is_zip64; /* sizes are in extra fields */
};

#define ZIP_EXTRA 20 /* size in bytes of an extra field with the sizes */

static inline void zip_put(struct zip_bytes *zip, uint64_t value, int size)
{
    for (int i = 0; i < size; i++) zip->bytes[zip->size++] = (char)(value >> 8 * i);
}

static inline void zip_put_text(struct zip_bytes *zip, const char *text)
{
    memcpy(zip->bytes + zip->size, text, strlen(text));
    zip->size += strlen(text);
}

/* Writes the fields that the local header and the directory entry share, from "version needed"
 * on. */
static inline void zip_put_description(struct zip_bytes *zip, const struct zip_file *file)
{
    size_t size = strlen(file->text);
    zip_put(zip, 20, 2);
    zip_put(zip, zip->is_zip64 ? 8 : 0, 8); /* flags, method, time, date */
    zip_put(zip, crc32(0, (const unsigned char *)file->text, (unsigned)size), 4);
    zip_put(zip, zip->is_zip64 ? UINT32_MAX : size, 4);
    zip_put(zip, zip->is_zip64 ? UINT32_MAX : size, 4);
    zip_put(zip, strlen(file->name), 2);
    zip_put(zip, zip->is_zip64 ? ZIP_EXTRA : 0, 2);
}

static inline void zip_put_extra(struct zip_bytes *zip, const struct zip_file *file)
{
    if (!zip->is_zip64) return;
    zip_put(zip, 1, 2);
    zip_put(zip, ZIP_EXTRA - 4, 2);
    zip_put(zip, strlen(file->text), 8);
    zip_put(zip, strlen(file->text), 8);
}

/* Writes an archive of the files that precede the first file without a name. The caller sets
 * `out->is_zip64`. */
static inline void zip_write(const struct zip_file files[ZIP_FILES], struct zip_bytes *out)
{
    uint64_t offsets[ZIP_FILES], count = 0, directory;
    out->size = 0;
    for (; count < ZIP_FILES && files[count].name; count++) {
        offsets[count] = out->size;
        zip_put(out, 0x04034b50, 4);
        zip_put_description(out, &files[count]);
        zip_put_text(out, files[count].name);
        zip_put_extra(out, &files[count]);
        zip_put_text(out, files[count].text);
    }
    directory = out->size;
    for (uint64_t i = 0; i < count; i++) {
        zip_put(out, 0x02014b50, 4);
        zip_put(out, 20, 2);
        zip_put_description(out, &files[i]);
        zip_put(out, 0, 2); /* comment, disk, attributes */
        zip_put(out, 0, 8);
        zip_put(out, offsets[i], 4);
        zip_put_text(out, files[i].name);
        zip_put_extra(out, &files[i]);
    }
    uint64_t size = out->size - directory;
    zip_put(out, 0x06054b50, 4);
    zip_put(out, 0, 4);
    zip_put(out, count, 2);
    zip_put(out, count, 2);
    zip_put(out, size, 4);
    zip_put(out, directory, 4);
    zip_put(out, 0, 2);
}
