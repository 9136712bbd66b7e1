/* Workspace: memory that a long call leaves behind for the next one, so that it need not be taken
 * from the system, cleared and faulted in again.
 *
 * Without one each call takes what it needs and gives it back. With one (struct gd_control) small
 * queries on large meshes cost what they touch, not what the mesh holds. One call at a time; give
 * each worker thread its own. */
#ifndef GD_WORKSPACE_H
#define GD_WORKSPACE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

struct gd_workspace;

/* An empty one; NULL without memory. */
struct gd_workspace *gd_workspace_create(void);
void gd_workspace_destroy(struct gd_workspace *workspace); /* NULL is harmless */

/* Bytes that it holds between calls. */
size_t gd_workspace_bytes(const struct gd_workspace *workspace);

/* Gives its memory back; it stays usable. */
void gd_workspace_trim(struct gd_workspace *workspace);

/* Memory of fields that were released is kept for the next ones, up to so many bytes in the whole
 * process; 0, as at first, keeps none. Thread-safe. */
void gd_spare_memory(size_t bytes);

#ifdef __cplusplus
}
#endif

#endif
