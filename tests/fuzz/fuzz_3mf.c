/* Fuzzes 3MF packages. The input is the XML of the model part, which the fuzzer puts into an
 * archive unchanged. An input that begins like an archive is used as the package itself. */
#include <string.h>

#include "tests/fuzz/reader.h"
#include "tests/unit/io/zip_text.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct zip_bytes zip;
    char text[8192];
    if (size >= sizeof text || (size >= 4 && memcmp(data, "PK\3\4", 4) == 0))
        return fuzz_reader(GD_FORMAT_3MF, data, size);
    memcpy(text, data, size);
    text[size] = '\0';
    zip_write((const struct zip_file[ZIP_FILES]){{"3D/3dmodel.model", text}}, &zip);
    return fuzz_reader(GD_FORMAT_3MF, (const uint8_t *)zip.bytes, zip.size);
}
