/* The solver for one number type. naive_windows.c includes this file once for each precision,
 * after it defines these macros:
 *
 *     REAL            the type
 *     REAL_SQRT(x)    its square root
 *     REAL_SLACK      a few rounding units: directions closer than this angle count as equal
 *     NAME(name)      the name with the precision's suffix */

struct NAME(vector) {
    REAL x, y;
};

/* The shape of a face, described from each side k. Side k is the vector from corner k to the next
 * corner. The third corner is at corner k, plus along[k] times this vector, plus across[k] times
 * the same vector turned by a right angle into the face. `length` has the sides' lengths. */
struct NAME(shape) {
    REAL length[3], along[3], across[3];
};

/* The part of a face's side that a source sees between two directions. The source is at the
 * origin. */
struct NAME(window) {
    struct NAME(vector) right, left; /* ends of the side */
    /* the vector from the right to the left end; it is stored, because left - right loses digits if
       the edge is short and far from the source */
    struct NAME(vector) edge;
    /* the first and last direction that the source sees, as vectors to the unfolded vertices that
       limit the view */
    struct NAME(vector) from, to;
    REAL sigma;          /* distance of the window's source from the field's source */
    uint32_t origin;     /* vertex of the source, or NONE */
    uint32_t parent;     /* the window on the previous face, or NONE */
    uint32_t face, side; /* the face that the window enters, and its side */
    bool swapped;        /* true if `right` is the corner number side + 1 */
    uint32_t next;       /* the next window that entered the same face, or NONE */
};

/* A source, described in one of the faces that contain it. */
struct NAME(seed) {
    uint32_t face;
    REAL weight[3];
    REAL offset;
};

/* A window to propagate, or a vertex that becomes a source. */
struct NAME(event) {
    REAL key; /* lower bound of the distances that the event can produce */
    uint32_t index;
    bool is_vertex;
};

struct NAME(solver) {
    const struct naive_mesh *mesh;
    struct NAME(shape) * shape;
    /* the distances of vertices; they are upper bounds until the end, and then exact */
    REAL *distance;
    struct NAME(window) * window;
    uint32_t window_count, window_capacity;
    struct NAME(event) * heap;
    uint32_t heap_count, heap_capacity;
    struct NAME(seed) * seed;
    uint32_t seed_count;
    uint32_t *entered; /* for each face, the first window that entered the face, or NONE */
    bool failed;
};

/* --- the plane -------------------------------------------------------------------------------- */

static struct NAME(vector) NAME(add)(struct NAME(vector) a, struct NAME(vector) b)
{
    return (struct NAME(vector)){a.x + b.x, a.y + b.y};
}

static struct NAME(vector) NAME(subtract)(struct NAME(vector) a, struct NAME(vector) b)
{
    return (struct NAME(vector)){a.x - b.x, a.y - b.y};
}

static struct NAME(vector) NAME(scaled)(REAL factor, struct NAME(vector) a)
{
    return (struct NAME(vector)){factor * a.x, factor * a.y};
}

static REAL NAME(cross)(struct NAME(vector) a, struct NAME(vector) b)
{
    return a.x * b.y - a.y * b.x;
}

static REAL NAME(dot)(struct NAME(vector) a, struct NAME(vector) b)
{
    return a.x * b.x + a.y * b.y;
}

static REAL NAME(length)(struct NAME(vector) a)
{
    return REAL_SQRT(NAME(dot)(a, a));
}

/* Returns whether b is to the left of direction a by more than the angle `slack`. A negative slack
 * allows b to be to the right by up to that angle. */
static bool NAME(is_left)(struct NAME(vector) a, struct NAME(vector) b, REAL slack)
{
    REAL sine = NAME(cross)(a, b);
    bool is_beyond = sine * sine > slack * slack * NAME(dot)(a, a) * NAME(dot)(b, b);
    return sine > 0 ? slack < 0 || is_beyond : slack < 0 && !is_beyond;
}

/* --- faces laid flat -------------------------------------------------------------------------- */

static void NAME(measure_face)(const struct naive_mesh *mesh, uint32_t face,
                               struct NAME(shape) * shape)
{
    for (uint32_t k = 0; k < 3; k++) {
        const double *a = mesh->position[mesh->corner[face][k]],
                     *b = mesh->position[mesh->corner[face][(k + 1) % 3]],
                     *c = mesh->position[mesh->corner[face][(k + 2) % 3]];
        REAL u[3], v[3], square = 0, product = 0, area = 0;
        for (int i = 0; i < 3; i++) u[i] = (REAL)b[i] - a[i], v[i] = (REAL)c[i] - a[i];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3;
            square += u[i] * u[i];
            product += u[i] * v[i];
            area += (u[i] * v[j] - u[j] * v[i]) * (u[i] * v[j] - u[j] * v[i]);
        }
        shape->length[k] = REAL_SQRT(square);
        shape->along[k] = product / square;
        shape->across[k] = REAL_SQRT(area) / square;
    }
}

/* Returns the corner with the largest weight. */
static int NAME(nearest_corner)(const REAL weight[3])
{
    int k = weight[1] > weight[0] ? 1 : 0;
    return weight[2] > weight[k] ? 2 : k;
}

/* Computes the corners of a face, counter-clockwise, relative to the point with these weights. */
static void NAME(lay_around)(const struct NAME(shape) * shape, const REAL weight[3],
                             struct NAME(vector) out[3])
{
    int a = NAME(nearest_corner)(weight), b = (a + 1) % 3, c = (a + 2) % 3;
    struct NAME(vector) to_b = {shape->length[a], 0};
    struct NAME(vector)
        to_c = {shape->along[a] * shape->length[a], shape->across[a] * shape->length[a]};
    out[a] =
        NAME(scaled)(-1, NAME(add)(NAME(scaled)(weight[b], to_b), NAME(scaled)(weight[c], to_c)));
    out[b] = NAME(add)(out[a], to_b);
    out[c] = NAME(add)(out[a], to_c);
}

/* Returns the distance of two points of one face. */
static REAL NAME(distance_in_face)(const struct NAME(shape) * shape, const REAL p[3],
                                   const REAL q[3])
{
    REAL sum[3] = {p[0] + q[0], p[1] + q[1], p[2] + q[2]};
    int a = NAME(nearest_corner)(sum), b = (a + 1) % 3, c = (a + 2) % 3;
    struct NAME(vector) to_b = {shape->length[a], 0};
    struct NAME(vector)
        to_c = {shape->along[a] * shape->length[a], shape->across[a] * shape->length[a]};
    return NAME(length)(
        NAME(add)(NAME(scaled)(p[b] - q[b], to_b), NAME(scaled)(p[c] - q[c], to_c)));
}

/* Returns the vector from the right end of the window's side to the third corner of the face that
 * the window enters. */
static struct NAME(vector)
    NAME(right_to_apex)(const struct NAME(solver) * solver, const struct NAME(window) * window)
{
    const struct NAME(shape) *shape = &solver->shape[window->face];
    REAL along = shape->along[window->side], across = shape->across[window->side];
    if (window->swapped) along = 1 - along;
    struct NAME(vector) away = {window->edge.y, -window->edge.x};
    return NAME(add)(NAME(scaled)(along, window->edge), NAME(scaled)(across, away));
}

/* Computes the indices of the face's corners: right, left, apex. */
static void NAME(corners_entered)(const struct NAME(window) * window, uint32_t out[3])
{
    out[0] = window->swapped ? (window->side + 1) % 3 : window->side;
    out[1] = window->swapped ? window->side : (window->side + 1) % 3;
    out[2] = (window->side + 2) % 3;
}

/* --- the queue -------------------------------------------------------------------------------- */

static bool NAME(grow)(struct NAME(solver) * solver, void **array, uint32_t *capacity, size_t size)
{
    uint32_t more = *capacity ? 2 * *capacity : 256;
    void *grown = more > 2 * NAIVE_WINDOWS_MOST ? NULL : realloc(*array, more * size);
    if (!grown) {
        solver->failed = true;
        return false;
    }
    *array = grown;
    *capacity = more;
    return true;
}

static void NAME(push)(struct NAME(solver) * solver, struct NAME(event) event)
{
    if (solver->heap_count == solver->heap_capacity &&
        !NAME(grow)(solver, (void **)&solver->heap, &solver->heap_capacity, sizeof *solver->heap))
        return;
    uint32_t i = solver->heap_count++;
    for (; i > 0 && event.key < solver->heap[(i - 1) / 2].key; i = (i - 1) / 2)
        solver->heap[i] = solver->heap[(i - 1) / 2];
    solver->heap[i] = event;
}

static struct NAME(event) NAME(pop)(struct NAME(solver) * solver)
{
    struct NAME(event) first = solver->heap[0], last = solver->heap[--solver->heap_count];
    uint32_t i = 0;
    for (uint32_t child = 1; child < solver->heap_count; child = 2 * i + 1) {
        if (child + 1 < solver->heap_count && solver->heap[child + 1].key < solver->heap[child].key)
            child++;
        if (!(solver->heap[child].key < last.key)) break;
        solver->heap[i] = solver->heap[child];
        i = child;
    }
    solver->heap[i] = last;
    return first;
}

/* --- windows ---------------------------------------------------------------------------------- */

/* Returns the parameter at which the direction meets the window's side. The parameter is 0 at the
 * right end and 1 at the left end. */
static REAL NAME(place_on_side)(const struct NAME(window) * window, struct NAME(vector) direction)
{
    REAL t = -NAME(cross)(direction, window->right) / NAME(cross)(direction, window->edge);
    return !(t > 0) ? 0 : t < 1 ? t : 1;
}

/* Compares two paths at all points of the window: the path to one end of the side and then along
 * the side, and the path through the window. Returns whether the first path is shorter at every
 * point, for at least one end. By the triangle inequality, it suffices to test the point of the
 * window that is farthest from this end. */
static bool NAME(is_useless)(const struct NAME(solver) * solver, const struct NAME(window) * window,
                             REAL begin, REAL end)
{
    uint32_t corner[3];
    NAME(corners_entered)(window, corner);
    const uint32_t *vertex = solver->mesh->corner[window->face];
    REAL length = solver->shape[window->face].length[window->side], margin = 1 + 8 * REAL_SLACK;
    REAL to_end = NAME(length)(NAME(add)(window->right, NAME(scaled)(end, window->edge)));
    if ((solver->distance[vertex[corner[0]]] + end * length) * margin < window->sigma + to_end)
        return true;
    REAL to_begin = NAME(length)(NAME(add)(window->right, NAME(scaled)(begin, window->edge)));
    return (solver->distance[vertex[corner[1]]] + (1 - begin) * length) * margin <
           window->sigma + to_begin;
}

/* Returns the smallest distance from the window's source to the part of the side between two
 * parameters. */
static REAL NAME(least_on_side)(const struct NAME(window) * window, REAL begin, REAL end)
{
    REAL t = -NAME(dot)(window->right, window->edge) / NAME(dot)(window->edge, window->edge);
    t = t > begin ? t < end ? t : end : begin;
    return NAME(length)(NAME(add)(window->right, NAME(scaled)(t, window->edge)));
}

/* Returns whether the window has already passed through the face. A shortest path enters a face
 * only once. */
static bool NAME(returns)(const struct NAME(solver) * solver, const struct NAME(window) * window)
{
    uint32_t first = window->side, at = window->face;
    for (uint32_t i = window->parent; i != NONE; i = solver->window[i].parent) {
        if (solver->window[i].face == window->face) return true;
        first = solver->window[i].side;
        at = solver->window[i].face;
    }
    return solver->mesh->across[at][first].face == window->face;
}

/* Queues the window that leaves a face through this side. Omits windows that are useless, and
 * windows that would enter a face which they have already crossed. */
static void NAME(offer)(struct NAME(solver) * solver, uint32_t face, uint32_t side,
                        uint32_t right_corner, struct NAME(window) window)
{
    struct naive_side across = solver->mesh->across[face][side];
    if (across.face == NONE) return;
    window.face = across.face;
    window.side = across.side;
    window.swapped =
        solver->mesh->corner[across.face][across.side] != solver->mesh->corner[face][right_corner];
    window.next = NONE;
    REAL begin = NAME(place_on_side)(&window, window.from),
         end = NAME(place_on_side)(&window, window.to);
    if (NAME(is_useless)(solver, &window, begin, end) || NAME(returns)(solver, &window)) return;
    if (solver->window_count >= NAIVE_WINDOWS_MOST) solver->failed = true;
    if (solver->window_count == solver->window_capacity &&
        !NAME(grow)(solver, (void **)&solver->window, &solver->window_capacity,
                    sizeof *solver->window))
        return;
    solver->window[solver->window_count] = window;
    NAME(push)
    (solver, (struct NAME(event)){window.sigma + NAME(least_on_side)(&window, begin, end),
                                  solver->window_count++, false});
}

static void NAME(improve)(struct NAME(solver) * solver, uint32_t vertex, REAL distance)
{
    if (!(distance < solver->distance[vertex])) return;
    solver->distance[vertex] = distance;
    if (!solver->mesh->is_convex[vertex])
        NAME(push)(solver, (struct NAME(event)){distance, vertex, true});
}

/* Emits windows from a source in a face, or on its border, through the sides that do not contain
 * the source. */
static void NAME(emit_into_face)(struct NAME(solver) * solver, uint32_t face, const REAL weight[3],
                                 REAL sigma, uint32_t origin)
{
    struct NAME(vector) corner[3];
    NAME(lay_around)(&solver->shape[face], weight, corner);
    for (uint32_t k = 0; k < 3; k++)
        NAME(improve)(solver, solver->mesh->corner[face][k], sigma + NAME(length)(corner[k]));
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t next = (k + 1) % 3;
        if (weight[(k + 2) % 3] == 0) continue;
        struct NAME(window) window = {
            .right = corner[k], .left = corner[next], .from = corner[k], .to = corner[next]};
        window.edge = NAME(subtract)(corner[next], corner[k]);
        window.sigma = sigma;
        window.origin = origin;
        window.parent = NONE;
        NAME(offer)(solver, face, k, k, window);
    }
}

static void NAME(emit_from_vertex)(struct NAME(solver) * solver, uint32_t vertex)
{
    for (uint32_t face = 0; face < solver->mesh->face_count; face++) {
        for (uint32_t k = 0; k < 3; k++) {
            if (solver->mesh->corner[face][k] != vertex) continue;
            REAL weight[3] = {k == 0, k == 1, k == 2};
            NAME(emit_into_face)(solver, face, weight, solver->distance[vertex], vertex);
        }
    }
}

/* Queues the parts of the window on the other two sides of the face, unless they are useless.
 * `reach` and `back` are the vectors from the right and from the left end to the apex. */
static void NAME(offer_children)(struct NAME(solver) * solver, const struct NAME(window) * window,
                                 const uint32_t corner[3], struct NAME(vector) apex,
                                 struct NAME(vector) reach, struct NAME(vector) back)
{
    bool is_left_of_from = NAME(is_left)(window->from, apex, REAL_SLACK);
    bool is_right_of_to = NAME(is_left)(apex, window->to, REAL_SLACK);
    if (is_left_of_from) {
        struct NAME(window) child = *window;
        child.left = apex;
        child.edge = reach;
        if (is_right_of_to) child.to = apex;
        NAME(offer)
        (solver, window->face, (window->side + (window->swapped ? 1 : 2)) % 3, corner[0], child);
    }
    if (is_right_of_to) {
        struct NAME(window) child = *window;
        child.right = apex;
        child.edge = NAME(scaled)(-1, back);
        if (is_left_of_from) child.from = apex;
        NAME(offer)
        (solver, window->face, (window->side + (window->swapped ? 2 : 1)) % 3, corner[2], child);
    }
}

/* Propagates a window through the face that it enters. */
static void NAME(propagate)(struct NAME(solver) * solver, uint32_t index)
{
    struct NAME(window) window = solver->window[index];
    bool is_stale = window.origin != NONE && solver->distance[window.origin] < window.sigma;
    if (is_stale || NAME(is_useless)(solver, &window, NAME(place_on_side)(&window, window.from),
                                     NAME(place_on_side)(&window, window.to)))
        return;
    solver->window[index].next = solver->entered[window.face];
    solver->entered[window.face] = index;

    uint32_t corner[3];
    NAME(corners_entered)(&window, corner);
    struct NAME(vector) reach = NAME(right_to_apex)(solver, &window),
                        back = NAME(subtract)(reach, window.edge);
    struct NAME(vector) apex =
        window.swapped ? NAME(add)(window.left, back) : NAME(add)(window.right, reach);
    if (NAME(is_left)(window.from, apex, -REAL_SLACK) &&
        NAME(is_left)(apex, window.to, -REAL_SLACK))
        NAME(improve)
    (solver, solver->mesh->corner[window.face][corner[2]], window.sigma + NAME(length)(apex));
    window.parent = index;
    NAME(offer_children)(solver, &window, corner, apex, reach, back);
}

static void NAME(propagate_all)(struct NAME(solver) * solver, long double radius)
{
    while (solver->heap_count > 0 && solver->heap[0].key <= radius && !solver->failed) {
        struct NAME(event) event = NAME(pop)(solver);
        if (!event.is_vertex)
            NAME(propagate)(solver, event.index);
        else if (!(solver->distance[event.index] < event.key))
            NAME(emit_from_vertex)(solver, event.index);
    }
}

/* --- sources ---------------------------------------------------------------------------------- */

/* Computes the weights. The largest weight is 1 minus the others. Returns the number of zero
 * weights. */
static int NAME(complete)(const struct naive_point *point, REAL out[3])
{
    REAL weight[3] = {point->weight[0], point->weight[1], point->weight[2]};
    int k = NAME(nearest_corner)(weight), zeros = 0;
    weight[k] = 1 - weight[(k + 1) % 3] - weight[(k + 2) % 3];
    for (int i = 0; i < 3; i++) zeros += weight[i] == 0;
    memcpy(out, weight, sizeof weight);
    return zeros;
}

static void NAME(add_seed)(struct NAME(solver) * solver, struct NAME(seed) seed)
{
    solver->seed[solver->seed_count++] = seed;
    NAME(emit_into_face)(solver, seed.face, seed.weight, seed.offset, NONE);
}

static void NAME(add_source)(struct NAME(solver) * solver, const struct naive_source *source)
{
    struct NAME(seed) seed = {.face = source->point.face, .offset = source->offset};
    int zeros = NAME(complete)(&source->point, seed.weight);
    const uint32_t *corner = solver->mesh->corner[seed.face];
    if (zeros == 2) {
        uint32_t vertex = corner[NAME(nearest_corner)(seed.weight)];
        if (!(seed.offset < solver->distance[vertex])) return;
        solver->distance[vertex] = seed.offset;
        NAME(push)(solver, (struct NAME(event)){seed.offset, vertex, true});
        return;
    }
    NAME(add_seed)(solver, seed);
    uint32_t side = 0;
    while (side < 3 && seed.weight[(side + 2) % 3] != 0) side++;
    if (side == 3 || solver->mesh->across[seed.face][side].face == NONE) return;
    struct naive_side across = solver->mesh->across[seed.face][side];
    struct NAME(seed) other = {.face = across.face, .offset = seed.offset};
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t j = 0; j < 3; j++)
            if (solver->mesh->corner[across.face][k] == corner[j]) other.weight[k] = seed.weight[j];
    NAME(add_seed)(solver, other);
}

/* --- the field -------------------------------------------------------------------------------- */

static void NAME(close)(struct NAME(solver) * solver)
{
    if (!solver) return;
    free(solver->shape);
    free(solver->distance);
    free(solver->window);
    free(solver->heap);
    free(solver->seed);
    free(solver->entered);
    free(solver);
}

static struct NAME(solver) * NAME(open)(const struct naive_mesh *mesh, uint32_t source_count)
{
    struct NAME(solver) *solver = calloc(1, sizeof *solver);
    if (!solver) return NULL;
    solver->mesh = mesh;
    solver->shape = calloc(mesh->face_count, sizeof *solver->shape);
    solver->distance = calloc(mesh->vertex_count, sizeof *solver->distance);
    solver->seed = calloc(2 * (size_t)source_count, sizeof *solver->seed);
    solver->entered = malloc(mesh->face_count * sizeof *solver->entered);
    if (!solver->shape || !solver->distance || !solver->seed || !solver->entered) {
        NAME(close)(solver);
        return NULL;
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        NAME(measure_face)(mesh, f, &solver->shape[f]);
        solver->entered[f] = NONE;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) solver->distance[v] = INFINITY;
    return solver;
}

static struct NAME(solver) * NAME(solve)(const struct naive_mesh *mesh,
                                         const struct naive_source *sources, uint32_t source_count,
                                         long double radius)
{
    struct NAME(solver) *solver = NAME(open)(mesh, source_count);
    if (!solver) return NULL;
    for (uint32_t i = 0; i < source_count; i++) NAME(add_source)(solver, &sources[i]);
    NAME(propagate_all)(solver, radius);
    if (!solver->failed) return solver;
    NAME(close)(solver);
    return NULL;
}

/* Returns the distance through a window, or INFINITY if the window does not see the point.
 * `weight` are the point's weights in the face that the window enters. */
static REAL NAME(through_window)(const struct NAME(solver) * solver,
                                 const struct NAME(window) * window, const REAL weight[3])
{
    uint32_t corner[3];
    NAME(corners_entered)(window, corner);
    REAL right = weight[corner[0]], left = weight[corner[1]], top = weight[corner[2]];
    struct NAME(vector) reach = NAME(right_to_apex)(solver, window),
                        back = NAME(subtract)(reach, window->edge), at;
    if (right >= left && right >= top)
        at = NAME(add)(window->right,
                       NAME(add)(NAME(scaled)(left, window->edge), NAME(scaled)(top, reach)));
    else if (left >= top)
        at = NAME(add)(window->left,
                       NAME(add)(NAME(scaled)(-right, window->edge), NAME(scaled)(top, back)));
    else
        at = NAME(subtract)(NAME(add)(window->right, reach),
                            NAME(add)(NAME(scaled)(right, reach), NAME(scaled)(left, back)));
    if (!NAME(is_left)(window->from, at, -REAL_SLACK) ||
        !NAME(is_left)(at, window->to, -REAL_SLACK))
        return INFINITY;
    return window->sigma + NAME(length)(at);
}

static REAL NAME(distance)(const struct NAME(solver) * solver, const struct naive_point *point)
{
    REAL weight[3], least = INFINITY;
    if (NAME(complete)(point, weight) == 2)
        return solver->distance[solver->mesh->corner[point->face][NAME(nearest_corner)(weight)]];
    const struct NAME(shape) *shape = &solver->shape[point->face];
    for (uint32_t k = 0; k < 3; k++) {
        REAL corner[3] = {k == 0, k == 1, k == 2};
        REAL distance = solver->distance[solver->mesh->corner[point->face][k]] +
                        NAME(distance_in_face)(shape, weight, corner);
        if (distance < least) least = distance;
    }
    for (uint32_t i = 0; i < solver->seed_count; i++) {
        if (solver->seed[i].face != point->face) continue;
        REAL distance =
            solver->seed[i].offset + NAME(distance_in_face)(shape, weight, solver->seed[i].weight);
        if (distance < least) least = distance;
    }
    for (uint32_t i = solver->entered[point->face]; i != NONE; i = solver->window[i].next) {
        REAL distance = NAME(through_window)(solver, &solver->window[i], weight);
        if (distance < least) least = distance;
    }
    return least;
}

#undef REAL
#undef REAL_SQRT
#undef REAL_SLACK
#undef NAME
