#include "io/zip.h"

#include <minizip/unzip.h> /* includes zlib.h */
#include <stdlib.h>
#include <string.h>

#include "io/endian.h"

#define IS_ENCRYPTED 1u /* this bit of a file's flags means that the file is encrypted */
#define IGNORE_CASE  2  /* argument of unzLocateFile */

struct gd__zip {
    const char *bytes;
    size_t size, at;
    unzFile file;
    bool is_open;  /* true if a file of the archive is open and readable */
    uint64_t left; /* declared bytes of the open file that are not yet read */
    uLong sum, declared_sum;
};

/* --- the archive as minizip's file ------------------------------------------------------------ */

static voidpf open_archive(voidpf user, const void *name, int mode)
{
    (void)name;
    (void)mode;
    return user;
}

/* Reads bytes of the archive for minizip. While a file of the archive is open, returns zeros after
 * the end of the archive. This is needed because minizip always requests whole buffers if it does
 * not know the compressed size (Zip64). Without the zeros it would fail at the end of the
 * archive. */
static uLong read_archive(voidpf user, voidpf stream, void *out, uLong size)
{
    struct gd__zip *zip = stream;
    size_t left = zip->size - zip->at, copied = size < left ? size : left;
    (void)user;
    if (copied) memcpy(out, zip->bytes + zip->at, copied);
    zip->at += copied;
    if (!zip->is_open || copied == size) return copied;
    memset((char *)out + copied, 0, size - copied);
    return size;
}

static uLong refuse_write(voidpf user, voidpf stream, const void *bytes, uLong size)
{
    (void)user;
    (void)stream;
    (void)bytes;
    (void)size;
    return 0;
}

static ZPOS64_T tell_archive(voidpf user, voidpf stream)
{
    (void)user;
    return ((struct gd__zip *)stream)->at;
}

static long seek_archive(voidpf user, voidpf stream, ZPOS64_T offset, int origin)
{
    struct gd__zip *zip = stream;
    size_t base = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                  : origin == ZLIB_FILEFUNC_SEEK_CUR ? zip->at
                                                     : zip->size;
    (void)user;
    size_t target = base + (size_t)offset; /* a negative offset wraps around as intended */
    if (target > zip->size) return -1;
    zip->at = target;
    return 0;
}

static int close_archive(voidpf user, voidpf stream)
{
    (void)user;
    (void)stream;
    return 0;
}

struct gd__zip *gd__zip_open(const void *bytes, size_t size)
{
    struct gd__zip *zip = malloc(sizeof *zip);
    if (!zip) return NULL;
    *zip = (struct gd__zip){.bytes = bytes, .size = size};
    zlib_filefunc64_def functions = {.zopen64_file = open_archive,
                                     .zread_file = read_archive,
                                     .zwrite_file = refuse_write,
                                     .ztell64_file = tell_archive,
                                     .zseek64_file = seek_archive,
                                     .zclose_file = close_archive,
                                     .zerror_file = close_archive,
                                     .opaque = zip};
    zip->file = unzOpen2_64(NULL, &functions);
    if (zip->file) return zip;
    free(zip);
    return NULL;
}

void gd__zip_close(struct gd__zip *zip)
{
    if (!zip) return;
    unzClose(zip->file);
    free(zip);
}

/* --- files of the archive --------------------------------------------------------------------- */

/* Returns the size that Zip64 declares in an extra field. minizip before 1.3 ignores that field. */
static uint64_t size_of_zip64(const char *extra, size_t length)
{
    size_t at = 0;
    while (length - at >= 4) {
        size_t size = (size_t)gd__load_unsigned(extra + at + 2, 2, false);
        bool is_zip64 = gd__load_unsigned(extra + at, 2, false) == 1;
        at += 4;
        if (size > length - at) break;
        if (is_zip64 && size >= 8) return gd__load_unsigned(extra + at, 8, false);
        at += size;
    }
    return UINT32_MAX;
}

bool gd__zip_begin(struct gd__zip *zip, const char *name, uint64_t *size)
{
    unz_file_info64 info;
    char extra[1024];
    if (unzLocateFile(zip->file, name, IGNORE_CASE) != UNZ_OK ||
        unzGetCurrentFileInfo64(zip->file, &info, NULL, 0, extra, sizeof extra, NULL, 0) != UNZ_OK)
        return false;
    size_t length = info.size_file_extra < sizeof extra ? info.size_file_extra : sizeof extra;
    *size = info.uncompressed_size;
    if (*size == UINT32_MAX) *size = size_of_zip64(extra, length);
    zip->left = *size;
    zip->sum = 0;
    zip->declared_sum = info.crc;
    zip->is_open = !(info.flag & IS_ENCRYPTED) && unzOpenCurrentFile(zip->file) == UNZ_OK;
    return true;
}

bool gd__zip_read(struct gd__zip *zip, void *out, size_t room, size_t *read)
{
    if (room > zip->left) room = (size_t)zip->left;
    int got = zip->is_open ? unzReadCurrentFile(zip->file, out, (unsigned)room) : UNZ_BADZIPFILE;
    *read = got > 0 ? (size_t)got : 0;
    zip->left -= *read;
    zip->sum = crc32(zip->sum, out, (uInt)*read);
    return got >= 0;
}

bool gd__zip_end(struct gd__zip *zip)
{
    bool is_good = zip->left || zip->sum == zip->declared_sum;
    if (zip->is_open) unzCloseCurrentFile(zip->file);
    zip->is_open = false;
    return is_good;
}
