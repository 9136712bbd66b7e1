#include "gd/cut.h"

#include <stdlib.h>

#include "base/share.h"
#include "cut/refine.h"
#include "line/turn.h"
#include "mesh/union_find.h"

/* --- pieces ----------------------------------------------------------------------------------- */

/* Pieces: converts the regions of a refined mesh to the result of a cut. */

struct cutting {
    struct gd__refined *refined;
    const struct gd_cut_request *request;
    struct gd__arena *arena;
    struct gd_detail *detail;
    struct gd_cut cut;
    uint32_t *piece; /* for each triangle, its piece */
    /* for each corner that represents a vertex, the number of this vertex in its piece; for other
       corners GD_NONE */
    uint32_t *number;
    uint32_t wanted; /* the only piece that is returned, or GD_NONE if all pieces are returned */
};

static void free_piece(struct gd_cut_piece *piece)
{
    gd_polygons_free(&piece->polygons);
    free(piece->vertex_map);
    free(piece->face_map);
    *piece = (struct gd_cut_piece){0};
}

void gd_cut_free(struct gd_cut *cut)
{
    if (!cut) return;
    for (uint32_t i = 0; i < cut->piece_count; i++) free_piece(&cut->pieces[i]);
    free(cut->pieces);
    *cut = (struct gd_cut){0};
}

/* Allocates an array of `count` items of `size` bytes, which the caller of the cut will own. */
static void *cut_pieces_take(struct cutting *cutting, size_t count, size_t size,
                             enum gd_status *status)
{
    if (*status) return NULL;
    *status = gd__budget_take(&cutting->arena->budget, count * size);
    void *array = *status ? NULL : calloc(count ? count : 1, size);
    if (!array && !*status) *status = GD_NO_MEMORY;
    if (!*status) cutting->cut.bytes += count * size;
    return array;
}

static bool is_wanted(const struct cutting *cutting, uint32_t piece)
{
    return cutting->wanted == GD_NONE || cutting->wanted == piece;
}

/* --- regions ---------------------------------------------------------------------------------- */

static enum gd_status number_regions(struct cutting *cutting)
{
    struct gd__refined *refined = cutting->refined;
    enum gd_status status = GD_OK;
    for (uint32_t t = 0; t < refined->count; t++) {
        /* `root` is the lowest triangle of the region */
        uint32_t root = gd__union_find_root(refined->region, t);
        cutting->piece[t] = root == t ? cutting->cut.piece_count++ : cutting->piece[root];
    }
    cutting->cut.separates = cutting->cut.piece_count > refined->mesh->summary.components;
    cutting->cut.pieces =
        cut_pieces_take(cutting, cutting->cut.piece_count, sizeof *cutting->cut.pieces, &status);
    if (status) cutting->cut.piece_count = 0;
    return status;
}

static double area_of_face(const struct gd_mesh *mesh, uint32_t face)
{
    const struct gd_side *side = &mesh->side[mesh->face_side[face][0]];
    return side->length * side->left_length * side->left_y / 2;
}

/* Sums the area of each piece. Uses compensated summation, because the sums have as many terms as
 * the mesh has faces. */
static enum gd_status cut_pieces_measure(struct cutting *cutting)
{
    const struct gd__refined *refined = cutting->refined;
    double unit = refined->mesh->unit;
    double *lost = gd__arena_zeroed(cutting->arena, cutting->cut.piece_count, sizeof *lost);
    if (!lost) return cutting->arena->status;
    for (uint32_t t = 0; t < refined->count; t++) {
        double *area = &cutting->cut.pieces[cutting->piece[t]].area,
               *rest = &lost[cutting->piece[t]];
        double term =
            gd__refined_share(refined, t) * area_of_face(refined->mesh, refined->face[t]) - *rest;
        double sum = *area + term;
        *rest = (sum - *area) - term;
        *area = sum;
    }
    for (uint32_t i = 0; i < cutting->cut.piece_count; i++)
        cutting->cut.pieces[i].area *= unit * unit;
    return GD_OK;
}

/* --- the piece that contains a point ---------------------------------------------------------- */

static bool holds(const struct gd__refined *refined, uint32_t triangle, struct gd__site point)
{
    struct gd__site site[3];
    for (int k = 0; k < 3; k++)
        site[k] =
            gd__node_site(refined->nodes, refined->face[triangle], refined->node[triangle][k]);
    return gd__site_turn(site[0], site[1], point) >= 0 &&
           gd__site_turn(site[1], site[2], point) >= 0 &&
           gd__site_turn(site[2], site[0], point) >= 0;
}

/* Searches for the request's point in the triangles of a face, and sets *found to its piece.
 * Returns false if *found is already another piece. */
static bool look_in_face(const struct cutting *cutting, uint32_t face, uint32_t *found)
{
    const struct gd__refined *refined = cutting->refined;
    if (face == GD_NONE) return true;
    struct gd__site point = gd__site_of_point(refined->mesh, face, cutting->request->inside);
    for (uint32_t i = 0; i < refined->in_face[face]; i++) {
        uint32_t t = refined->of_face[face] + i;
        if (!holds(refined, t, point)) continue;
        if (*found != GD_NONE && *found != cutting->piece[t]) return false;
        *found = cutting->piece[t];
    }
    return true;
}

/* Finds the piece that contains the request's point. */
static enum gd_status find_inside(struct cutting *cutting)
{
    const struct gd_mesh *mesh = cutting->refined->mesh;
    const struct gd_point *point = cutting->request->inside;
    bool ok = true;
    if (point->kind == GD_POINT_FACE) ok = look_in_face(cutting, point->element, &cutting->wanted);
    for (uint32_t h = 2 * point->element;
         point->kind == GD_POINT_EDGE && h < 2 * point->element + 2; h++)
        ok = ok && look_in_face(cutting, mesh->side_face[h], &cutting->wanted);
    if (point->kind == GD_POINT_VERTEX)
        for (uint32_t i = mesh->fan_first[point->element]; i < mesh->fan_first[point->element + 1];
             i++)
            ok = ok && look_in_face(cutting, mesh->side_face[mesh->fan[i].side], &cutting->wanted);
    if (ok) return cutting->wanted == GD_NONE ? GD_INTERNAL : GD_OK;
    return gd_fail(
        cutting->detail, GD_INVALID_ARGUMENT,
        "the point inside lies on the curve; choose one that is clearly on one side of it");
}

/* Removes all pieces except the wanted one. */
static void leave_wanted(struct cutting *cutting)
{
    struct gd_cut *cut = &cutting->cut;
    if (cutting->wanted == GD_NONE) return;
    struct gd_cut_piece wanted = cut->pieces[cutting->wanted];
    cut->pieces[cutting->wanted] = (struct gd_cut_piece){0};
    cut->pieces[0] = wanted;
    cut->piece_count = 1;
}

/* --- faces of a selection --------------------------------------------------------------------- */

/* Returns the piece that has the largest part of a face's area. In a tie, returns the first one.
 * `area` is scratch memory with one entry for each piece, all zero before and after the call. */
static uint32_t owner_of_face(const struct cutting *cutting, uint32_t face, double *area)
{
    const struct gd__refined *refined = cutting->refined;
    uint32_t first = refined->of_face[face], end = first + refined->in_face[face],
             owner = cutting->piece[first];
    for (uint32_t t = first; t < end; t++) area[cutting->piece[t]] += gd__refined_share(refined, t);
    for (uint32_t t = first; t < end; t++) {
        uint32_t piece = cutting->piece[t];
        if (area[piece] > area[owner] || (area[piece] == area[owner] && piece < owner))
            owner = piece;
    }
    for (uint32_t t = first; t < end; t++) area[cutting->piece[t]] = 0;
    return owner;
}

static enum gd_status select_faces(struct cutting *cutting)
{
    const struct gd_mesh *mesh = cutting->refined->mesh;
    uint32_t indices = mesh->summary.face_index_count;
    uint32_t *owner = gd__arena_take(cutting->arena, indices, sizeof *owner);
    double *area = gd__arena_zeroed(cutting->arena, cutting->cut.piece_count, sizeof *area);
    enum gd_status status = cutting->arena->status;
    for (uint32_t i = 0; i < indices && !status; i++) {
        uint32_t face = mesh->face_of_index[i];
        owner[i] = face == GD_NONE ? GD_NONE : owner_of_face(cutting, face, area);
        if (face != GD_NONE) cutting->cut.pieces[owner[i]].face_count++;
    }
    for (uint32_t p = 0; p < cutting->cut.piece_count && !status; p++) {
        struct gd_cut_piece *piece = &cutting->cut.pieces[p];
        if (is_wanted(cutting, p))
            piece->face_map =
                cut_pieces_take(cutting, piece->face_count, sizeof(uint32_t), &status);
        piece->face_count = 0;
    }
    for (uint32_t i = 0; i < indices && !status; i++) {
        if (owner[i] == GD_NONE || !is_wanted(cutting, owner[i])) continue;
        struct gd_cut_piece *piece = &cutting->cut.pieces[owner[i]];
        piece->face_map[piece->face_count++] = i;
    }
    return status;
}

/* --- meshes ----------------------------------------------------------------------------------- */

/* Returns the sort key of a vertex. Vertices of the original mesh are sorted by index; new vertices
 * follow. */
static uint32_t cut_pieces_key_of(const struct gd__refined *refined, uint32_t node)
{
    const struct gd_mesh *mesh = refined->mesh;
    return node < mesh->vertex_count ? mesh->index_of_vertex[node]
                                     : mesh->summary.index_count + (node - mesh->vertex_count);
}

/* Sorts the corners that represent vertices by key (counting sort). `begin` has one entry for each
 * key and one more, all zero before the call. After the call, the corners of key k are
 * sorted[begin[k - 1]] to sorted[begin[k] - 1]. */
static void sort_vertices(const struct gd__refined *refined, uint32_t keys, uint32_t *begin,
                          uint32_t *sorted)
{
    for (uint32_t c = 0; c < 3 * refined->count; c++)
        if (refined->vertex[c] == c)
            begin[cut_pieces_key_of(refined, refined->node[c / 3][c % 3]) + 1]++;
    for (uint32_t k = 0; k < keys; k++) begin[k + 1] += begin[k];
    for (uint32_t c = 0; c < 3 * refined->count; c++)
        if (refined->vertex[c] == c)
            sorted[begin[cut_pieces_key_of(refined, refined->node[c / 3][c % 3])]++] = c;
}

static enum gd_status allocate_piece(struct cutting *cutting, struct gd_cut_piece *piece)
{
    enum gd_status status = GD_OK;
    struct gd_polygons *polygons = &piece->polygons;
    polygons->polygon_count = piece->face_count;
    piece->face_map = cut_pieces_take(cutting, piece->face_count, sizeof *piece->face_map, &status);
    polygons->corners =
        cut_pieces_take(cutting, 3 * (size_t)piece->face_count, sizeof *polygons->corners, &status);
    polygons->positions =
        cut_pieces_take(cutting, polygons->position_count, sizeof *polygons->positions, &status);
    piece->vertex_map =
        cut_pieces_take(cutting, polygons->position_count, sizeof *piece->vertex_map, &status);
    return status;
}

static void place_vertex(struct cutting *cutting, uint32_t corner)
{
    const struct gd__refined *refined = cutting->refined;
    struct gd_cut_piece *piece = &cutting->cut.pieces[cutting->piece[corner / 3]];
    uint32_t node = refined->node[corner / 3][corner % 3], i = piece->polygons.position_count++;
    const struct gd_point point = gd__node_point(refined->nodes, node);
    struct gd_vec3 position = gd_point_position(refined->mesh, &point);
    cutting->number[corner] = i;
    piece->polygons.positions[i][0] = position.x;
    piece->polygons.positions[i][1] = position.y;
    piece->polygons.positions[i][2] = position.z;
    piece->vertex_map[i] =
        point.kind == GD_POINT_VERTEX ? refined->mesh->index_of_vertex[node] : GD_NONE;
}

static void place_triangle(struct cutting *cutting, uint32_t t)
{
    struct gd__refined *refined = cutting->refined;
    struct gd_cut_piece *piece = &cutting->cut.pieces[cutting->piece[t]];
    uint32_t i = piece->face_count++;
    piece->face_map[i] = refined->mesh->index_of_face[refined->face[t]];
    for (uint32_t k = 0; k < 3; k++)
        piece->polygons.corners[3 * i + k] = cutting->number[refined->vertex[3 * t + k]];
}

/* Counts the elements of each piece, allocates memory, and resets the counts to zero. */
static enum gd_status allocate_pieces(struct cutting *cutting)
{
    struct gd__refined *refined = cutting->refined;
    enum gd_status status = GD_OK;
    for (uint32_t t = 0; t < refined->count; t++)
        cutting->cut.pieces[cutting->piece[t]].face_count++;
    for (uint32_t c = 0; c < 3 * refined->count; c++) {
        refined->vertex[c] = gd__union_find_root(refined->vertex, c);
        if (refined->vertex[c] == c)
            cutting->cut.pieces[cutting->piece[c / 3]].polygons.position_count++;
    }
    for (uint32_t p = 0; p < cutting->cut.piece_count && !status; p++)
        if (is_wanted(cutting, p)) status = allocate_piece(cutting, &cutting->cut.pieces[p]);
    for (uint32_t p = 0; p < cutting->cut.piece_count; p++)
        cutting->cut.pieces[p].face_count = cutting->cut.pieces[p].polygons.position_count = 0;
    return status;
}

static enum gd_status make_meshes(struct cutting *cutting)
{
    struct gd__refined *refined = cutting->refined;
    size_t corners = 3 * (size_t)refined->count,
           keys = refined->mesh->summary.index_count + (size_t)refined->nodes->count;
    enum gd_status status = allocate_pieces(cutting);
    if (status) return status;
    uint32_t *begin = gd__arena_zeroed(cutting->arena, keys + 1, sizeof *begin),
             *sorted = gd__arena_take(cutting->arena, corners, sizeof *sorted);
    cutting->number = gd__arena_take(cutting->arena, corners, sizeof *cutting->number);
    if (cutting->arena->status) return cutting->arena->status;
    sort_vertices(refined, (uint32_t)keys, begin, sorted);
    for (uint32_t i = 0; i < begin[keys]; i++)
        if (is_wanted(cutting, cutting->piece[sorted[i] / 3])) place_vertex(cutting, sorted[i]);
    for (uint32_t t = 0; t < refined->count; t++)
        if (is_wanted(cutting, cutting->piece[t])) place_triangle(cutting, t);
    return GD_OK;
}

/* Fills in the requested pieces, `separates` and `bytes`. Errors: GD_INVALID_ARGUMENT (`inside`
 * lies on the curve), GD_NO_MEMORY, GD_BUDGET. Linear time. */
static enum gd_status pieces_make(struct gd__refined *refined, const struct gd_cut_request *request,
                                  struct gd__arena *arena, struct gd_cut *out,
                                  struct gd_detail *detail)
{
    struct cutting cutting = {.refined = refined,
                              .request = request,
                              .arena = arena,
                              .detail = detail,
                              .wanted = GD_NONE};
    cutting.piece = gd__arena_take(arena, refined->count, sizeof *cutting.piece);
    enum gd_status status = cutting.piece ? number_regions(&cutting) : arena->status;
    if (!status) status = cut_pieces_measure(&cutting);
    if (!status && request->inside) status = find_inside(&cutting);
    if (!status) status = request->select_only ? select_faces(&cutting) : make_meshes(&cutting);
    if (status) {
        gd_cut_free(&cutting.cut);
        return status;
    }
    leave_wanted(&cutting);
    *out = cutting.cut;
    return GD_OK;
}

/* --- the curve -------------------------------------------------------------------------------- */

/* Rejects an open curve whose ends are not on the boundary, unless both ends are the same point. */
static enum gd_status check_ends(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                 struct gd_detail *detail)
{
    const struct gd_point *first = &curve->points[0], *last = &curve->points[curve->count - 1];
    if (curve->closed || (curve->count > 1 && gd_point_equal(first, last))) return GD_OK;
    bool is_first = gd__turn_is_closed(mesh, first);
    if (!is_first && !gd__turn_is_closed(mesh, last)) return GD_OK;
    return gd_fail(detail, GD_INVALID_ARGUMENT,
                   "the %s point of the open curve is not on a boundary; close the curve, or move "
                   "both ends to boundary edges",
                   is_first ? "first" : "last");
}

/* --- attempts --------------------------------------------------------------------------------- */

/* One attempt to refine the mesh, with one snap distance. `refined` borrows from `arrangement`.
 * `arena` has the arrays. */
struct attempt {
    struct gd__arena arena;
    struct gd__arrangement arrangement;
    struct gd__seam seam;
    struct gd__refined refined;
    uint32_t flat_face;
};

static void cut_clear(struct attempt *attempt)
{
    gd__arena_free(&attempt->arena);
    attempt->flat_face = GD_NONE;
}

static enum gd_status try(struct attempt *attempt, const struct gd_mesh *mesh,
                          const struct gd_curve *curve, double snap, struct gd_detail *detail)
{
    cut_clear(attempt);
    enum gd_status status =
        gd__arrange(mesh, curve, snap, &attempt->arena, &attempt->arrangement, detail);
    if (!status) status = gd__seam_make(&attempt->arrangement, &attempt->arena, &attempt->seam);
    if (!status && attempt->seam.cuts == 0)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the curve cuts nothing, because it encloses no area or follows the "
                       "boundary; choose another curve");
    return status ? status
                  : gd__refine(&attempt->arrangement, &attempt->seam, &attempt->arena,
                               &attempt->refined, &attempt->flat_face);
}

/* Tries increasing snap distances until an attempt succeeds. */
static enum gd_status try_snaps(struct attempt *attempt, const struct gd_mesh *mesh,
                                const struct gd_curve *curve, struct gd_detail *detail)
{
    enum gd_status status = GD_RUNAWAY;
    for (double snap = GD_TOL_SEAM; snap < GD_TOL_SEAM_MOST && status == GD_RUNAWAY;
         snap *= GD_TOL_SEAM_STEP)
        status = try(attempt, mesh, curve, snap, detail);
    if (status != GD_RUNAWAY) return status;
    if (attempt->flat_face == GD_NONE)
        return gd_fail(detail, GD_TOO_LARGE,
                       "the curve crosses itself too often; cut along several simpler curves, one "
                       "after the other");
    return gd_fail(detail, GD_INVALID_ARGUMENT,
                   "the curve cuts the sliver face %u into pieces whose area is too small; avoid "
                   "that face, or upload the mesh with repair=split",
                   mesh->index_of_face[attempt->flat_face]);
}

enum gd_status gd_cut_along(const struct gd_mesh *mesh, const struct gd_cut_request *request,
                            const struct gd_control *control, struct gd_cut *out,
                            struct gd_detail *detail)
{
    struct gd__share attempts = {.control = control, .total = 1};
    const struct gd_control own = gd__share_control(&attempts, 0);
    struct attempt attempt = {.arena.budget.control = &own};
    struct gd_cut cut = {0};
    enum gd_status status = check_ends(mesh, request->curve, detail);
    if (!status) status = try_snaps(&attempt, mesh, request->curve, detail);
    double shift = attempt.arrangement.nodes.shift * mesh->unit;
    if (!status) status = pieces_make(&attempt.refined, request, &attempt.arena, &cut, detail);
    cut_clear(&attempt);
    if (status) return status;
    *out = cut;
    out->largest_shift = shift;
    return GD_OK;
}
