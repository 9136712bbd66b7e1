/* A mesh in OpenMesh's form. Vertices, faces and half-edges have the internal numbers of gd_mesh
 * (mesh/topology.h): half-edge h is side h. Coordinates are in the unit box, because OpenMesh
 * stores priorities as floats.
 *
 * The connectivity is copied from gd_mesh. OpenMesh's add_face is not used, because it takes
 * quadratic time in the valence and may reject a face. */
#pragma once

/* In C a struct and a function may have the same name, but -Wshadow reports this in C++. gcc
 * reports false uninitialised values in OpenMesh's Property::push_back. */
#pragma GCC diagnostic ignored "-Wshadow"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

/* Disables OpenMesh's assertions. They check every handle, which would take half of the run
 * time. */
#ifndef NDEBUG
#define NDEBUG
#endif

#include <algorithm>
#include <new>
#include <stdexcept>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "edit/edited.h"

namespace gd_edit
{

struct Traits : OpenMesh::DefaultTraits {
    typedef OpenMesh::Vec3d Point;
    typedef OpenMesh::Vec3d Normal;
    VertexAttributes(OpenMesh::Attributes::Status);
    EdgeAttributes(OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Status);
    HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
};
typedef OpenMesh::TriMesh_ArrayKernelT<Traits> EditMesh;

/* Thrown to leave OpenMesh when the control stops the call. */
struct Stopped {
    enum gd_status status;
};

/* Checks a control at intervals; throws Stopped. */
class Watch
{
  public:
    Watch(const struct gd_control *control, double steps) : control_(control), steps_(steps)
    {
    }

    /* Counts a step, which takes some microseconds at most. */
    void step()
    {
        if (++done_ % STEPS_A_CHECK == 0) check();
    }

    /* Checks the control at once. Call this after a step that takes milliseconds. */
    void check() const
    {
        const double part = std::min(1.0, (double)done_ / steps_);
        const enum gd_status status = gd_control_check(control_, part);
        if (status) throw Stopped{status};
    }

  private:
    static const uint64_t STEPS_A_CHECK = 512;

    const struct gd_control *control_;
    double steps_; /* expected number of steps of the whole work */
    uint64_t done_ = 0;
};

/* Calls `grow(i)` for i = 1 to SLICES, and checks the control after each call. `grow(i)` extends
 * new arrays to the fraction i / SLICES of their final size. This takes milliseconds for each
 * slice, because the system allocates memory pages at the first write. */
const size_t SLICES = 32;
template <class Grow> void grow_in_slices(const Watch &watch, const Grow &grow)
{
    for (size_t i = 1; i <= SLICES; i++) {
        grow(i);
        watch.check();
    }
}

/* Copies a mesh into an empty EditMesh. */
void copy_mesh(const struct gd_mesh *mesh, Watch &watch, EditMesh &out);

/* Writes the triangles of an edited mesh that are not deleted, in the order of their indices. All
 * vertices of the edited mesh must be vertices of the input. */
enum gd_status keep_rest(const struct gd_mesh *mesh, const EditMesh &edited, Watch &watch,
                         struct gd_edited *out);

/* Runs a body and converts its exceptions to a status. */
template <class Body> enum gd_status guarded(const Body &body) noexcept
{
    try {
        return body();
    } catch (const Stopped &stopped) {
        return stopped.status;
    } catch (const std::bad_alloc &) {
        return GD_NO_MEMORY;
    } catch (const std::length_error &) {
        return GD_NO_MEMORY;
    } catch (...) {
        return GD_INTERNAL;
    }
}

} // namespace gd_edit
