/* The kinds that there are. Nothing else stands here, so that a test can have a table of its own.
 */
#include "server/store/kind.h"

const struct server_kind *const server_kinds[] = {&server_kind_mesh, &server_kind_nurbs,
                                                  &server_kind_subdivision, NULL};
