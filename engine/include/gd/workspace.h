/* Workspace: memory that consecutive long calls reuse. It saves page faults, and the time to
 * allocate and clear memory.
 *
 * Without a workspace, each call allocates and frees its memory. With a workspace (in struct
 * gd_control), the cost of a small query does not grow with the size of the mesh. Only one call at
 * a time may use a workspace, so create one for each worker thread. */
#ifndef GD_WORKSPACE_H
#define GD_WORKSPACE_H

#include <stdbool.h>
#include <stddef.h>

#include "gd/language.h"

GD_EXTERN_C_BEGIN

struct gd_workspace;

/* Creates an empty workspace. Returns NULL if memory is exhausted. */
struct gd_workspace *gd_workspace_create(void);
void gd_workspace_destroy(struct gd_workspace *workspace); /* NULL is allowed */

/* Returns the number of bytes that the workspace holds between calls. */
size_t gd_workspace_bytes(const struct gd_workspace *workspace);

/* Frees the workspace's memory. The workspace can still be used. */
void gd_workspace_trim(struct gd_workspace *workspace);

/* Sets how much memory of released fields the process keeps for later fields, in bytes; initially
 * 0. Thread-safe. */
void gd_spare_memory(size_t bytes);

/* Makes the system provide memory for a later field of the size of the last one, within the limit
 * of gd_spare_memory. Returns false, and does nothing, if there is already enough memory. Call it
 * when the process is idle. Then a later field causes far fewer page faults, if the caller keeps
 * this field. Takes about as long as clearing the memory. Thread-safe. */
bool gd_spare_prepare(void);

GD_EXTERN_C_END

#endif
