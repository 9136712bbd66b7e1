#include "tests/oracle/opensubdiv.h"

#if __has_include(<opensubdiv/bfr/refinerSurfaceFactory.h>)

#include <cstdlib>
#include <memory>
#include <vector>

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

using namespace OpenSubdiv;

namespace
{

/* Three coordinates with the interface that OpenSubdiv's refiner needs. */
struct Triple {
    double x[3];

    void Clear()
    {
        x[0] = x[1] = x[2] = 0;
    }
    void AddWithWeight(const Triple &other, double weight)
    {
        for (int k = 0; k < 3; k++) x[k] += weight * other.x[k];
    }
    gd_vec3 vector() const
    {
        return {x[0], x[1], x[2]};
    }
};

struct Place {
    double u, v;
};

/* A face of a refinement level with the parameters of its corners. */
struct Piece {
    gd_limit_point first; /* the face and the corner in the control mesh */
    std::vector<Place> corners;
};

Place middle(Place a, Place b)
{
    return {(a.u + b.u) / 2, (a.v + b.v) / 2};
}

} // namespace

struct opensubdiv_surface {
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::vector<Triple> points;
    gd_scheme scheme;

    int regular() const
    {
        return scheme == GD_SCHEME_LOOP ? 3 : 4;
    }
};

namespace
{

std::unique_ptr<Far::TopologyRefiner> refiner_of(const gd_control_mesh *mesh, gd_scheme scheme)
{
    const gd_polygons *polygons = &mesh->polygons;
    std::vector<int> counts, corners, creases, corner_vertices;
    std::vector<float> crease_weights, corner_weights;
    for (uint32_t face = 0; face < polygons->polygon_count; face++)
        counts.push_back(
            int(gd_polygons_first(polygons, face + 1) - gd_polygons_first(polygons, face)));
    for (uint32_t i = 0; i < gd_polygons_corner_count(polygons); i++)
        corners.push_back(int(polygons->corners[i]));
    for (uint32_t i = 0; i < mesh->crease_count; i++) {
        for (uint32_t vertex : mesh->creases[i].vertices) creases.push_back(int(vertex));
        crease_weights.push_back(float(mesh->creases[i].sharpness));
    }
    for (uint32_t i = 0; i < mesh->corner_count; i++) {
        corner_vertices.push_back(int(mesh->corners[i].vertex));
        corner_weights.push_back(float(mesh->corners[i].sharpness));
    }

    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = int(polygons->position_count);
    descriptor.numFaces = int(polygons->polygon_count);
    descriptor.numVertsPerFace = counts.data();
    descriptor.vertIndicesPerFace = corners.data();
    descriptor.numCreases = int(mesh->crease_count);
    descriptor.creaseVertexIndexPairs = creases.data();
    descriptor.creaseWeights = crease_weights.data();
    descriptor.numCorners = int(mesh->corner_count);
    descriptor.cornerVertexIndices = corner_vertices.data();
    descriptor.cornerWeights = corner_weights.data();

    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(mesh->boundary == GD_INTERPOLATE_EDGE_ONLY
                                            ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                            : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    Factory::Options made(scheme == GD_SCHEME_LOOP ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK,
                          options);
    made.validateFullTopology = true;
    return std::unique_ptr<Far::TopologyRefiner>(Factory::Create(descriptor, made));
}

/* Returns the control mesh's faces. Polygons that are split into quads have no corner parameters
 * yet; children_of computes the parameters of their parts. */
std::vector<Piece> pieces_of(const Far::TopologyLevel &level, int regular)
{
    static const Place quad[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                       triangle[3] = {{0, 0}, {1, 0}, {0, 1}};
    std::vector<Piece> pieces;
    for (int face = 0; face < level.GetNumFaces(); face++) {
        Piece piece = {{uint32_t(face), 0, 0, 0}, {}};
        if (level.GetFaceVertices(face).size() == regular)
            piece.corners.assign(regular == 4 ? quad : triangle,
                                 (regular == 4 ? quad : triangle) + regular);
        pieces.push_back(piece);
    }
    return pieces;
}

/* Returns the parameters of a child's corner: a corner of the parent, or the middle of an edge or
 * of the face. */
Place place_in(const Far::TopologyLevel &level, int face, const Piece &parent, int vertex)
{
    Far::ConstIndexArray corners = level.GetFaceVertices(face), edges = level.GetFaceEdges(face);
    int count = corners.size();
    for (int k = 0; k < count; k++) {
        if (level.GetVertexChildVertex(corners[k]) == vertex) return parent.corners[k];
        if (level.GetEdgeChildVertex(edges[k]) == vertex)
            return middle(parent.corners[k], parent.corners[(k + 1) % count]);
    }
    return middle(parent.corners[0], parent.corners[2]);
}

/* Returns the parameters of a corner of a polygon's part. The part's corners are the polygon's
 * corner, the middle of the next edge, the polygon's middle, and the middle of the previous
 * edge. */
Place place_in_polygon(const Far::TopologyLevel &level, int face, int corner, int vertex)
{
    Far::ConstIndexArray corners = level.GetFaceVertices(face), edges = level.GetFaceEdges(face);
    if (level.GetVertexChildVertex(corners[corner]) == vertex) return {0, 0};
    if (level.GetEdgeChildVertex(edges[corner]) == vertex) return {1, 0};
    return level.GetFaceChildVertex(face) == vertex ? Place{1, 1} : Place{0, 1};
}

std::vector<Piece> children_of(const Far::TopologyLevel &level, const Far::TopologyLevel &next,
                               const std::vector<Piece> &parents)
{
    std::vector<Piece> pieces(size_t(next.GetNumFaces()));
    for (int face = 0; face < level.GetNumFaces(); face++) {
        const Piece &parent = parents[size_t(face)];
        Far::ConstIndexArray children = level.GetFaceChildFaces(face);
        for (int k = 0; k < children.size(); k++) {
            Piece &child = pieces[size_t(children[k])];
            child.first = parent.first;
            if (parent.corners.empty()) child.first.corner = uint32_t(k);
            for (int vertex : next.GetFaceVertices(children[k]))
                child.corners.push_back(parent.corners.empty()
                                            ? place_in_polygon(level, face, k, vertex)
                                            : place_in(level, face, parent, vertex));
        }
    }
    return pieces;
}

/* Returns whether the vertex is smooth or on a regular boundary. */
bool has_normal(const Far::TopologyLevel &level, int vertex, int regular)
{
    int edges = level.GetVertexEdges(vertex).size();
    if (level.IsVertexBoundary(vertex) && edges != regular / 2 + 1) return false;
    if (level.GetVertexSharpness(vertex) > 0) return false;
    for (int edge : level.GetVertexEdges(vertex))
        if (level.GetEdgeSharpness(edge) > 0 && !level.IsEdgeBoundary(edge)) return false;
    return true;
}

/* Returns whether OpenSubdiv uses the correct mask at the vertex. At ends of creases, OpenSubdiv
 * uses the mask of smooth vertices. At vertices of two edges, it uses the mask of corners. */
bool is_exact(const Far::TopologyLevel &level, int vertex)
{
    int sharp = 0;
    for (int edge : level.GetVertexEdges(vertex)) sharp += level.GetEdgeSharpness(edge) > 0;
    return sharp != 1 && level.GetVertexEdges(vertex).size() > 2;
}

} // namespace

bool opensubdiv_is_available(void)
{
    return true;
}

struct opensubdiv_surface *opensubdiv_create(const struct gd_control_mesh *mesh,
                                             enum gd_scheme scheme)
{
    std::unique_ptr<opensubdiv_surface> surface(
        new opensubdiv_surface{refiner_of(mesh, scheme), {}, scheme});
    for (uint32_t i = 0; i < mesh->polygons.position_count; i++) {
        const double *p = mesh->polygons.positions[i];
        surface->points.push_back({{p[0], p[1], p[2]}});
    }
    return surface->refiner ? surface.release() : nullptr;
}

void opensubdiv_free(struct opensubdiv_surface *surface)
{
    delete surface;
}

size_t opensubdiv_vertices(const struct opensubdiv_surface *surface, int level,
                           struct opensubdiv_vertex **out)
{
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Far::TopologyRefinerFactory<Far::TopologyDescriptor>::Create(*surface->refiner));
    Far::TopologyRefiner::UniformOptions options(level);
    options.fullTopologyInLastLevel = true;
    refiner->RefineUniform(options);
    Far::PrimvarRefinerReal<double> primvars(*refiner);
    std::vector<Triple> points = surface->points;
    std::vector<Piece> pieces = pieces_of(refiner->GetLevel(0), surface->regular());
    for (int i = 1; i <= level; i++) {
        std::vector<Triple> next(size_t(refiner->GetLevel(i).GetNumVertices()));
        primvars.Interpolate(i, points, next);
        pieces = children_of(refiner->GetLevel(i - 1), refiner->GetLevel(i), pieces);
        points = next;
    }
    std::vector<Triple> limit(points.size()), x(points.size()), y(points.size());
    primvars.Limit(points, limit, x, y);

    const Far::TopologyLevel &last = refiner->GetLevel(level);
    std::vector<opensubdiv_vertex> found;
    for (int face = 0; face < last.GetNumFaces(); face++) {
        Far::ConstIndexArray corners = last.GetFaceVertices(face);
        for (int k = 0; k < corners.size(); k++) {
            size_t i = size_t(corners[k]);
            gd_limit_point place = pieces[size_t(face)].first;
            place.u = pieces[size_t(face)].corners[size_t(k)].u;
            place.v = pieces[size_t(face)].corners[size_t(k)].v;
            bool normal = has_normal(last, corners[k], surface->scheme == GD_SCHEME_LOOP ? 6 : 4);
            found.push_back({place, limit[i].vector(), gd_vec3_cross(x[i].vector(), y[i].vector()),
                             normal, is_exact(last, corners[k])});
        }
    }
    *out = static_cast<opensubdiv_vertex *>(std::malloc(found.size() * sizeof **out));
    std::copy(found.begin(), found.end(), *out);
    return found.size();
}

void opensubdiv_evaluate(const struct opensubdiv_surface *surface,
                         const struct gd_limit_point *place, struct gd_limit_jet *out)
{
    Bfr::SurfaceFactory::Options options;
    options.SetApproxLevelSmooth(OPENSUBDIV_LEVEL);
    options.SetApproxLevelSharp(OPENSUBDIV_LEVEL);
    Bfr::RefinerSurfaceFactory<> factory(*surface->refiner, options);
    Bfr::Surface<double> patch;
    factory.InitVertexSurface(int(place->face), &patch);
    std::vector<double> points(3 * size_t(patch.GetNumPatchPoints()));
    patch.PreparePatchPoints(surface->points[0].x, Bfr::Surface<double>::PointDescriptor(3),
                             points.data(), Bfr::Surface<double>::PointDescriptor(3));
    Bfr::Parameterization domain = patch.GetParameterization();
    double uv[2] = {place->u, place->v}, scale = 1;
    if (domain.HasSubFaces()) { /* OpenSubdiv maps parts of polygons to squares of side 1/2 */
        const double inside[2] = {place->u, place->v};
        domain.ConvertNormalizedSubFaceToCoord(int(place->corner), inside, uv);
        scale = 0.5;
    }
    double p[6][3];
    patch.Evaluate(uv, points.data(), Bfr::Surface<double>::PointDescriptor(3), p[0], p[1], p[2],
                   p[3], p[4], p[5]);
    gd_vec3 *vectors[6] = {&out->position, &out->du, &out->dv, &out->duu, &out->duv, &out->dvv};
    for (int i = 0; i < 6; i++) {
        gd_vec3 vector = {p[i][0], p[i][1], p[i][2]};
        *vectors[i] = gd_vec3_scale(vector, i == 0 ? 1 : i < 3 ? scale : scale * scale);
    }
}

#else

bool opensubdiv_is_available(void)
{
    return false;
}

struct opensubdiv_surface *opensubdiv_create(const struct gd_control_mesh *, enum gd_scheme)
{
    return nullptr;
}

void opensubdiv_free(struct opensubdiv_surface *)
{
}

size_t opensubdiv_vertices(const struct opensubdiv_surface *, int, struct opensubdiv_vertex **)
{
    return 0;
}

void opensubdiv_evaluate(const struct opensubdiv_surface *, const struct gd_limit_point *,
                         struct gd_limit_jet *)
{
}

#endif
