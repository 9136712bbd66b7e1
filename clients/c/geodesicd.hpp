/* Wraps geodesicd.h for C++17: objects free themselves, and errors are exceptions.
 *
 *     geodesicd::Client client;
 *     auto bunny = client.upload("bunny", vertices, faces);
 *     double distance = bunny.distance(gdc_vertex(12), gdc_near(0.01, 0.12, 0.03));
 *
 * Link with the C library. Every call throws geodesicd::Error on failure. The distance of two points
 * that no path joins is NaN. As in C, only one thread at a time may use a client. */
#ifndef GEODESICD_HPP
#define GEODESICD_HPP

#include "geodesicd.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace geodesicd
{

/* A failed call. what() is the daemon's sentence (gdc_problem.detail). */
struct Error : std::runtime_error {
    Error(gdc_status code, const gdc_problem &told)
        : std::runtime_error(told.detail), status(code), problem(told)
    {
    }
    gdc_status status;
    gdc_problem problem;
};

namespace detail
{
template <typename Value> struct Free {
    void operator()(Value *value) const
    {
        gdc_free(value);
    }
};
template <typename Value> using Owned = std::unique_ptr<Value, Free<Value>>;

/* Calls function(arguments..., &problem). Throws Error if the function fails. */
template <typename Function, typename... Arguments>
void call(Function function, Arguments... arguments)
{
    gdc_problem problem{};
    if (gdc_status status = function(arguments..., &problem)) throw Error(status, problem);
}
} // namespace detail

using Place = std::array<double, 3>;

struct Path {
    double length;
    std::vector<Place> points;
};

/* A mesh of the daemon. The client must outlive it. */
class Mesh
{
  public:
    Mesh(gdc_client *client, std::string name) : client_(client), name_(std::move(name))
    {
    }

    double distance(gdc_point from, gdc_point to) const
    {
        double distance = std::numeric_limits<double>::quiet_NaN();
        try {
            detail::call(gdc_distance, client_, name_.c_str(), from, to, &distance);
        } catch (const Error &error) {
            if (error.status != GDC_NO_PATH) throw;
        }
        return distance;
    }

    Path path(gdc_point from, gdc_point to) const
    {
        gdc_path found{};
        detail::call(gdc_shortest_path, client_, name_.c_str(), from, to, &found);
        detail::Owned<double> xyz(found.xyz);
        Path path{found.length, {}};
        for (std::size_t i = 0; i < found.count; i++)
            path.points.push_back({found.xyz[3 * i], found.xyz[3 * i + 1], found.xyz[3 * i + 2]});
        return path;
    }

    /* Returns the distances by row, one row for each source. */
    std::vector<double> matrix(const std::vector<gdc_point> &sources,
                               const std::vector<gdc_point> &targets, double max_distance = 0) const
    {
        std::vector<double> distances(sources.size() * targets.size());
        const gdc_matrix_points points{sources.data(), targets.data(), sources.size(),
                                       targets.size(), max_distance};
        detail::call(gdc_matrix, client_, name_.c_str(), &points, distances.data());
        return distances;
    }

    /* Returns for each vertex the distance from the nearest source. */
    std::vector<double> field(const std::vector<gdc_point> &sources) const
    {
        double *values;
        std::size_t count;
        detail::call(gdc_field, client_, name_.c_str(), sources.data(), sources.size(), &values,
                     &count);
        detail::Owned<double> owned(values);
        return std::vector<double>(values, values + count);
    }

    /* Sends any query of the contract. Body and answer are JSON. */
    std::string query(const std::string &query, const std::string &body) const
    {
        gdc_answer answer{};
        detail::call(gdc_query, client_, name_.c_str(), query.c_str(), body.c_str(), &answer);
        detail::Owned<char> owned(answer.body);
        return std::string(answer.body, answer.size);
    }

    void remove() const
    {
        detail::call(gdc_delete, client_, name_.c_str());
    }

  private:
    gdc_client *client_;
    std::string name_;
};

class Client
{
  public:
    /* An empty url means $GEODESICD_URL, or http://127.0.0.1:8080 if that is not set. An empty key
     * means $GEODESICD_KEY. */
    explicit Client(const std::string &url = {}, const std::string &key = {})
        : client_(gdc_client_create(url.empty() ? nullptr : url.c_str(),
                                    key.empty() ? nullptr : key.c_str()),
                  gdc_client_destroy)
    {
        if (!client_) throw std::bad_alloc();
    }

    /* Returns the C client, for functions of geodesicd.h. */
    gdc_client *get() const
    {
        return client_.get();
    }

    /* Returns the mesh with this name. Sends no request. */
    Mesh mesh(const std::string &name) const
    {
        return Mesh(get(), name);
    }

    Mesh upload_file(const std::string &name, const std::string &path) const
    {
        detail::call(gdc_upload_file, get(), name.c_str(), path.c_str());
        return mesh(name);
    }

    Mesh upload(const std::string &name, const std::vector<Place> &vertices,
                const std::vector<std::array<std::uint32_t, 3>> &faces) const
    {
        const gdc_arrays arrays{vertices.empty() ? nullptr : vertices[0].data(), vertices.size(),
                                faces.empty() ? nullptr : faces[0].data(), faces.size()};
        detail::call(gdc_upload_arrays, get(), name.c_str(), &arrays);
        return mesh(name);
    }

  private:
    std::unique_ptr<gdc_client, void (*)(gdc_client *)> client_;
};

} // namespace geodesicd

#endif
