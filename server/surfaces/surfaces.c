/* See surfaces.h. */
#include "server/surfaces/surfaces.h"

#include <stdio.h>

#include "server/base/disk.h"

#define PERSIST_NS UINT64_C(10000000000) /* for writing fields, which can be computed again */

static struct server_store *surfaces_open_store(const struct server_config *config, char *error,
                                                size_t error_size)
{
    if (config->store == SERVER_STORE_KIND_MEMORY) return server_store_memory_create();
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        return server_store_postgres_open(config->store_url, error, error_size);
    return server_store_local_open(config->data_dir, error, error_size);
}

/* Beside a database the folder, if one is given, is for what can be computed again. */
static bool surfaces_open_field_store(struct server_surfaces *surfaces,
                                      const struct server_surfaces_parts *parts, char *error,
                                      size_t error_size)
{
    const struct server_config *config = parts->config;
    if (!*config->data_dir || config->store == SERVER_STORE_KIND_MEMORY) return true;
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        (void)server_disk_make_folder(config->data_dir);
    surfaces->field_store =
        server_field_store_open(config->data_dir, server_workspaces_budget(parts->workspaces));
    if (surfaces->field_store)
        server_field_store_follow(surfaces->field_store, surfaces->registry);
    else
        snprintf(error, error_size, "there is no room or memory for the folder of fields in %s",
                 config->data_dir);
    return surfaces->field_store != NULL;
}

static bool surfaces_create_landmarks(struct server_surfaces *surfaces,
                                      const struct server_surfaces_parts *parts)
{
    if (!parts->config->landmarks) return true;
    surfaces->landmarks = server_landmarks_create(
        &(struct server_landmarks_parts){.workers = parts->workers,
                                         .workspaces = parts->workspaces,
                                         .metrics = parts->metrics,
                                         .registry = surfaces->registry,
                                         .field_store = surfaces->field_store,
                                         .count = (uint32_t)parts->config->landmarks});
    return surfaces->landmarks != NULL;
}

static bool surfaces_create_loader(struct server_surfaces *surfaces,
                                   const struct server_surfaces_parts *parts)
{
    surfaces->loader = server_loader_create(&(struct server_loader_parts){
        .budget = server_workspaces_budget(parts->workspaces),
        .workers = parts->workers,
        .cache = surfaces->cache,
        .registry = surfaces->registry,
        .field_store = parts->config->persist_fields ? surfaces->field_store : NULL,
        .max_faces = (uint32_t)parts->config->max_faces});
    return surfaces->loader && server_loader_preload(surfaces->loader);
}

static bool surfaces_create_scrub(struct server_surfaces *surfaces,
                                  const struct server_surfaces_parts *parts)
{
    const struct server_config *config = parts->config;
    if (!config->scrub_s || !server_registry_store(surfaces->registry)->verify) return true;
    surfaces->scrub = server_scrub_create(surfaces->registry, parts->workers, config->scrub_s,
                                          config->scrub_rate);
    return surfaces->scrub != NULL;
}

bool server_surfaces_create(struct server_surfaces *surfaces,
                            const struct server_surfaces_parts *parts, char *error,
                            size_t error_size)
{
    const struct server_config *config = parts->config;
    struct server_budget *budget = server_workspaces_budget(parts->workspaces);
    surfaces->cache = server_cache_create(budget, parts->workers);
    if (!surfaces->cache) return false;
    struct server_store *store = surfaces_open_store(config, error, error_size);
    if (store) surfaces->registry = server_registry_create(store, budget);
    surfaces->writer = server_workers_create(1, UINT32_MAX);
    surfaces->lister = server_workers_create(1, UINT32_MAX);
    if (!surfaces->registry || !surfaces->writer || !surfaces->lister || !surfaces_open_field_store(surfaces, parts, error, error_size))
        return false;
    surfaces->discretizations =
        server_discretizations_create(parts->workspaces, (uint32_t)config->max_faces);
    return surfaces->discretizations && surfaces_create_landmarks(surfaces, parts) &&
           surfaces_create_loader(surfaces, parts) && surfaces_create_scrub(surfaces, parts);
}

void server_surfaces_persist(struct server_surfaces *surfaces, bool saves_fields)
{
    server_scrub_destroy(surfaces->scrub);
    surfaces->scrub = NULL;
    server_loader_stop(surfaces->loader);
    server_registry_note_uses(surfaces->registry);
    if (saves_fields)
        server_field_store_save(surfaces->field_store, surfaces->registry,
                                gd_now_ns() + PERSIST_NS);
}

void server_surfaces_destroy(struct server_surfaces *surfaces)
{
    server_scrub_destroy(surfaces->scrub);
    server_loader_destroy(surfaces->loader);
    server_workers_destroy(surfaces->writer);
    server_workers_destroy(surfaces->lister);
    server_registry_destroy(surfaces->registry);
    server_discretizations_destroy(surfaces->discretizations);
    server_landmarks_destroy(surfaces->landmarks);
    server_field_store_close(surfaces->field_store);
    server_cache_destroy(surfaces->cache);
}
