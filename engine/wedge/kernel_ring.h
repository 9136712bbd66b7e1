/* Part of kernel_lanes.h: ways through a ring's vertices. Single precision is enough for bounds. */
static struct gd__ring_way ring(const struct gd__ring_group *first, const struct gd__ring_group *end,
                                struct gd__place p)
{
    const floats px = floats_all(p.x), py = floats_all(p.y), pz = floats_all(p.z);
    floats way = floats_all(GD__RING_NOWHERE), away = way;
    for (const struct gd__ring_group *g = first; g < end; g++)
        for (int i = 0; i < GD__RING_LANES; i += FLOATS) {
            floats x = floats_load(g->x + i) - px, y = floats_load(g->y + i) - py, z = floats_load(g->z + i) - pz,
                   d = floats_root(x * x + y * y + z * z);
            way = floats_lesser(way, d + floats_load(g->lower + i));
            away = floats_lesser(away, d);
        }
    return (struct gd__ring_way){floats_least(way), floats_least(away)};
}
