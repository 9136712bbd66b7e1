#include "proto/http/asset.h"

#include <string.h>

const struct proto_asset *proto_asset_find(const struct proto_asset *assets, size_t count,
                                           const char *path)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(assets[i].path, path) == 0) return &assets[i];
    }
    return NULL;
}
