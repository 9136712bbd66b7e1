"""Tests figures of subdivision and NURBS surfaces by POST …/picture. Compares positions with
answers of `evaluate`, and fields with distances on the mesh that is drawn. Also tests refusals."""
import json
import math
import unittest

from figure_case import FigureCase, distance_to_segment, plate, subpaths
from harness import TETRAHEDRON
from subdivisions import PRISM
from test_pictures import SVG


class SmoothCase(FigureCase):
    """Figures of smooth surfaces. Two points with known positions determine the projection, because
    the view also depends on the other layers."""

    def asked_of(self, query, document):
        answer = self.daemon.request("POST", f"/v1/{self.kind}/s/{query}", json.dumps(document).encode(), {"Content-Type": "application/json"})
        self.assertEqual(answer.status, 200, answer)
        return answer.json

    def scene(self, layers, ends):
        """Draws the layers and two points with these positions, from the front. Returns the figure
        and the projection."""
        places, positions = zip(*ends)
        figure = self.figure([*layers, {"points": places, "hidden": "shown"}], "s")
        (x, y, *_), (x2, y2, *_) = figure.discs(len(layers))[1::2]
        (px, py, _), (qx, qy, _) = positions
        scale = math.dist((x, y), (x2, y2)) / math.dist((px, py), (qx, qy))
        return figure, lambda p: (x + scale * (p[0] - px), y - scale * (p[1] - py))


class SubdivisionFigures(SmoothCase):
    kind = "subdivisions"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cube = ("v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")
        sheet = "".join(f"v {x} {y} 0\n" for y in range(5) for x in range(5)) + "".join(
            f"f {i} {i + 1} {i + 6} {i + 5}\n" for i in (5 * y + x + 1 for y in range(4) for x in range(4)))
        for name, body in (("s", cube.encode()), ("sheet", sheet.encode()), ("prism", PRISM), ("tetrahedron", TETRAHEDRON)):
            assert cls.daemon.request("PUT", f"/v1/subdivisions/{name}", body, {}).status == 201

    def ends(self):
        places = [{"face": 1, "uv": [0.3, 0.4]}, {"face": 1, "uv": [0.8, 0.7]}]
        return list(zip(places, (point["xyz"] for point in self.asked_of("evaluate", {"points": places})["points"])))

    def test_traces_and_paths_are_where_they_project(self):
        trace = {"start": {"face": 1, "uv": [0.5, 0.5]}, "fan": 7, "length": 0.6}
        pair = {"from": {"face": 1, "uv": [0.3, 0.4]}, "to": {"face": 4, "uv": [0.5, 0.5]}}
        figure, project = self.scene([{"trace": trace}, {"path": pair}], self.ends())
        lines = figure.lines(0)
        self.assertEqual(len(lines), 7)
        for path in self.asked_of("trace", trace)["paths"]:
            self.assert_drawn([point["xyz"] for point in path["points"]], lines, project)
        points = [point["xyz"] for point in self.asked_of("path", pair)["path"]["points"]]
        self.assert_drawn(points, figure.lines(1) + figure.lines(1, dashed=True), project)

    def test_the_control_net_has_the_edges_of_the_control_mesh(self):
        figure, project = self.scene([{"control_net": {}, "hidden": "shown"}], self.ends())
        corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        edges = [(a, b) for a in corners for b in corners if a < b and math.dist(a, b) == 2]
        scene = self.scene_of([{"control_net": {}, "color": "#777777"}], "s")
        self.assertEqual({tuple(sorted(segment)) for segment in scene.segments("layer-0")}, set(edges))
        self.assertEqual(sorted(scene.points("layer-0")), corners)
        discs = [disc[:2] for disc in figure.discs(0)[1::2]]
        self.assertEqual(len(discs), 8)
        for corner in corners:
            self.assertLess(min(math.dist(disc, project(corner)) for disc in discs), 0.05)
        lines = [line for group in figure.groups["layer-0"] for path in group.iter(SVG + "path") for line in subpaths(path)]
        self.assert_drawn([[(p + q) / 2 for p, q in zip(*edge)] for edge in edges], lines, project)
        self.assertEqual(self.figure([{"control_net": {"points": False}}], "s").discs(0), [])

    def test_the_control_net_of_polygons(self):
        """Polygons of a control mesh are divided into base faces. The drawn net has only the
        polygons' edges."""
        scene = self.scene_of([{"control_net": {}}], "prism")
        bottom, top = [(1, 0, 0), (0, 1, 0), (-1, -1, 0)], [(1, 0, 2), (0, 1, 2), (-1, -1, 2)]
        edges = [(a, b) for ring in (bottom, top) for a, b in zip(ring, ring[1:] + ring[:1])] + list(zip(bottom, top))
        self.assertEqual(sorted(tuple(sorted(segment)) for segment in scene.segments("layer-0")), sorted(tuple(sorted(edge)) for edge in edges))
        self.assertEqual(sorted(scene.points("layer-0")), sorted(bottom + top))

    def test_a_control_net_is_in_the_figure(self):
        discs = self.figure([{"control_net": {}, "hidden": "shown"}], "tetrahedron", camera={"direction": [1, 2, 4]}).discs(0)[1::2]
        self.assertEqual(len(discs), 4)
        self.assertTrue(all(0 < value < 400 for disc in discs for value in disc[:2]), discs)

    def test_a_field_is_the_distance_on_the_discretization(self):
        """The limit surface of a flat control mesh is flat, so distances are lengths of straight
        lines."""
        places = [{"face": 0, "uv": [0.3, 0.4]}, {"face": 10, "uv": [0.9, 0.1]}]
        seeds = [point["xyz"] for point in self.daemon.request("POST", "/v1/subdivisions/sheet/evaluate", json.dumps({"points": places}).encode(),
                                                               {"Content-Type": "application/json"}).json["points"]]
        scene = self.scene_of([{"field": {"points": places}}, {"isolines": {"levels": [0.75]}}], "sheet")
        self.assertGreater(len(scene.places), 10000)
        for place, distance in zip(scene.places, scene.distances):
            self.assertAlmostEqual(distance, min(math.dist(place, seed) for seed in seeds), 5)
        for segment in scene.segments("isolines"):
            self.assertAlmostEqual(min(math.dist(segment[0], seed) for seed in seeds), 0.75, 5)
        near = self.scene_of([{"field": {"points": places[:1]}, "max_distance": 1}], "sheet")
        for place, distance in zip(near.places, near.distances):
            far = math.dist(place, seeds[0])
            self.assertTrue(distance == -1 if far > 1 + 1e-5 else far > 1 - 1e-5 or abs(distance - far) < 1e-5, (distance, far))
        curved = self.scene_of([{"field": {"points": [{"face": 1, "uv": [0.5, 0.5]}]}}], "s")
        to = {"face": 0, "uv": [0.5, 0.5]}
        pair = self.asked_of("distance", {"from": {"face": 1, "uv": [0.5, 0.5]}, "to": to})
        [opposite] = self.asked_of("evaluate", {"points": [to]})["points"]
        nearest = min(range(len(curved.places)), key=lambda i: math.dist(curved.places[i], opposite["xyz"]))
        self.assertAlmostEqual(curved.distances[nearest], pair["mesh_distance"], 5)

    def test_problems(self):
        detail = self.refused([{"voronoi": {"set": {"points": [{"vertex": 0}]}}}], "/layers/0/voronoi", "s")
        self.assertIn("surface, field, isolines, path, trace, points, control_net", detail)
        self.refused([{"field": {"points": [{"vertex": 0}]}}], "/layers/0/field/points/0/vertex", "s")
        self.refused([{"surface": {}}, {"field": {"points": [{"face": 0, "uv": [0, 0]}, {"face": 99, "uv": [0, 0]}]}}], "/layers/1/field/points/1/face", "s")
        self.refused([{"field": {"points": []}}], "/layers/0/field/points", "s")
        self.refused([{"field": 7}], "/layers/0/field", "s")
        self.refused([{"field": {"points": [{"face": 0, "uv": [0, 0]}] * 1001}}], "/layers/0/field/points", "s", status=413, code="too_large")
        self.refused([{"isolines": {"count": 3}}], "/layers/0/isolines", "s")
        self.refused([{"cut": {"curve": {"points": []}}}], "/layers/0/cut", "s")
        self.refused([{"surface": {}}, {"points": [{"face": 99, "uv": [0, 0]}]}], "/layers/1/points/0/face", "s")
        self.refused([{"trace": {"start": {"face": 99, "uv": [0, 0]}, "fan": 3, "length": 1}}], "/layers/0/trace/start/face", "s")
        self.refused([{"isoparametric": {}}], "/layers/0/isoparametric", "s")


class NurbsFigures(SmoothCase):
    kind = "nurbs"
    points = [[[x, y, math.sin(2 * x) * math.cos(y)] for y in range(4)] for x in range(5)]

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        patch = {"degreeU": 2, "degreeV": 2, "knotsU": [0, 0, 0, 1, 2, 3, 3, 3], "knotsV": [0, 0, 0, 1, 2, 2, 2], "controlPoints": cls.points}
        hole = [[0.4, 0.2], [0.6, 0.2], [0.6, 0.8], [0.4, 0.8], [0.4, 0.2]]
        plate = {"parametric": {"graph": {"coefficients": [[0]], "u": [0, 1], "v": [0, 1]}}, "trims": {"holes": [[{"polyline": hole}]]}}
        for name, body in (("s", patch), ("torus", {"parametric": {"torus": {"major": 2, "minor": 1}}}), ("plate", plate)):
            answer = cls.daemon.request("PUT", f"/v1/nurbs/{name}", json.dumps(body).encode(), {"Content-Type": "application/json"})
            assert answer.status == 201, answer

    def positions(self, places):
        return [point["xyz"] for point in self.asked_of("evaluate", {"uv": places})["points"]]

    def ends(self):
        places = [[0.5, 0.5], [2.5, 1.75]]
        return list(zip(places, self.positions(places)))

    def test_lines_of_constant_parameters(self):
        figure, project = self.scene([{"isoparametric": {"u": 3, "v": 2}, "hidden": "shown"}], self.ends())
        self.assertEqual(len(figure.groups["layer-0"]), 2)
        lines = [line for group in figure.groups["layer-0"] for line in subpaths(list(group.iter(SVG + "path"))[-1])]
        self.assertEqual(len(lines), 4 + 3)
        self.assert_drawn(self.positions([[u, v / 7] for u in (0, 1, 2, 3) for v in range(15)]), lines[:4], project)
        self.assert_drawn(self.positions([[u / 5, v] for v in (0, 1, 2) for u in range(16)]), lines[4:], project)
        closed = self.figure([{"isoparametric": {"u": 6, "v": 0}, "hidden": "shown"}], "torus")
        self.assertEqual(len(subpaths(list(closed.groups["layer-0"][0].iter(SVG + "path"))[-1])), 6)

    def test_lines_of_constant_parameters_end_at_trimming_loops(self):
        figure = self.figure([{"isoparametric": {"u": 4, "v": 4}, "hidden": "shown"}], "plate")
        lines = [subpaths(list(group.iter(SVG + "path"))[-1]) for group in figure.groups["layer-0"]]
        self.assertEqual([len(each) for each in lines], [5 + 1, 5 + 3])
        (u, below), (_, above) = [[line[0], line[-1]] for line in lines[0][2:4]]
        width = math.dist(lines[0][0][0], lines[0][0][-1])
        self.assertAlmostEqual(math.dist(u, below) / width, 0.2, 2)
        self.assertAlmostEqual(math.dist(below, lines[0][3][0]) / width, 0.6, 2)
        self.assertAlmostEqual(math.dist(u, above) / width, 1, 2)

    def test_the_control_net(self):
        figure, project = self.scene([{"control_net": {}, "hidden": "shown"}], self.ends())
        discs = [disc[:2] for disc in figure.discs(0)[1::2]]
        self.assertEqual(len(discs), 20)
        flat = [point for row in self.points for point in row]
        for disc, point in zip(discs, flat):
            self.assertLess(math.dist(disc, project(point)), 0.05)
        lines = [line for group in figure.groups["layer-0"] for path in group.iter(SVG + "path") for line in subpaths(path)]
        middles = [[(a + b) / 2 for a, b in zip(p, q)] for p, q in zip(self.points[1], self.points[1][1:])]
        middles += [[(a + b) / 2 for a, b in zip(p[2], q[2])] for p, q in zip(self.points, self.points[1:])]
        self.assert_drawn(middles, lines, project)
        self.assertEqual(self.figure([{"control_net": {"points": False}}], "s").discs(0), [])
        self.refused([{"control_net": {}}], "/layers/0/control_net", "torus")

    def test_paths(self):
        pair = {"from": [0.2, 0.3], "to": [2.8, 1.6]}
        curve = {"point": [0.2, 0.3], "curve": {"iso": "u", "value": 2}}
        figure, project = self.scene([{"path": pair}, {"point_curve_distance": curve}], self.ends())
        for layer, query, body in ((0, "path", pair), (1, "point-curve-distance", curve)):
            path = self.asked_of(query, body)
            self.assert_drawn([point["xyz"] for point in path["points"]], figure.lines(layer) + figure.lines(layer, dashed=True), project)

    def test_curves_in_the_domain(self):
        corners = [[0.3, 0.2], [1.5, 1.7], [2.7, 0.4]]
        scene = self.scene_of([{"curve": {"polyline": corners, "closed": True}}, {"curve": {"iso": "u", "value": 1.25}},
                               {"curve": {"bspline": {"degree": 2, "knots": [0, 0, 0, 1, 1, 1], "control_points": corners}}}], "s")
        ring = [*corners, corners[0]]
        places = [[p + k / 8 * (q - p) for p, q in zip(a, b)] for a, b in zip(ring, ring[1:]) for k in range(8)]
        parabola = [[(1 - t)**2 * a + 2 * t * (1 - t) * b + t * t * c for a, b, c in zip(*corners)] for t in (0, 0.25, 0.5, 0.75, 1)]
        for name, expected in (("layer-0", places), ("layer-1", [[1.25, 2 * k / 8] for k in range(9)]), ("layer-2", parabola)):
            for position in self.positions(expected):
                self.assertLess(min(distance_to_segment(position, segment) for segment in scene.segments(name)), 5e-5, name)
        for corner in self.positions(corners):  # the drawing has exactly these corners
            self.assertLess(min(math.dist(corner, begin) for begin, _ in scene.segments("layer-0")), 1e-6)
        self.assertEqual(scene.segments("layer-0")[0][0], scene.segments("layer-0")[-1][1])
        self.refused([{"surface": {}}, {"curve": {"polyline": [[0, 0], [9, 9]]}}], "/layers/1/curve/polyline/1", "s", status=422, code="point_not_on_surface")
        self.refused([{"curve": {"polyline": [[0, 0]]}}], "/layers/0/curve", "s")
        self.refused([{"curve": {"points": []}}], "/layers/0/curve", "s")
        self.refused([{"curve": 5}], "/layers/0/curve", "s")

    def test_a_field_is_the_distance_on_the_tessellation(self):
        """In a flat domain with a hole, the distance is the length of a straight line, or of a
        polyline around the hole."""
        source, hole = (0.2, 0.45), ((0.4, 0.2), (0.6, 0.2), (0.6, 0.8), (0.4, 0.8))

        def is_free(a, b):
            """Returns whether the hole leaves the segment free, at many points of the segment."""
            places = [[p + k / 400 * (q - p) for p, q in zip(a, b)] for k in range(401)]
            return not any(0.4 + 1e-6 < x < 0.6 - 1e-6 and 0.2 + 1e-6 < y < 0.8 - 1e-6 for x, y in places)

        def expected(place):
            if is_free(source, place):
                return math.dist(source, place)
            turns = [[a] for a in hole] + [[hole[0], hole[1]], [hole[3], hole[2]]]
            routes = ([source, *turn, place] for turn in turns)
            return min(sum(map(math.dist, route, route[1:])) for route in routes if all(map(is_free, route, route[1:])))

        scene = self.scene_of([{"field": {"points": [source]}}, {"isolines": {"levels": [0.3]}}], "plate")
        behind = 0
        for place, distance in list(zip(scene.places, scene.distances))[::37]:
            self.assertAlmostEqual(distance, expected(place[:2]), 5)
            behind += distance > math.dist(source, place[:2]) + 1e-3
        self.assertGreater(behind, 50)
        for begin, _ in scene.segments("isolines"):
            self.assertAlmostEqual(expected(begin[:2]), 0.3, 5)

    def test_a_field_in_a_closed_direction(self):
        """Parameters of a closed direction may be any number. The nearest point is the source."""
        [source] = self.daemon.request("POST", "/v1/nurbs/torus/evaluate", json.dumps({"uv": [[1, 2]]}).encode(), {"Content-Type": "application/json"}).json["points"]
        for u in (1, 1 + 2 * math.pi, 1 - 4 * math.pi):
            scene = self.scene_of([{"field": {"points": [[u, 2]]}}], "torus")
            place = scene.places[scene.distances.index(min(scene.distances))]
            self.assertLess(math.dist(place, source["xyz"]), 0.1)

    def test_problems(self):
        self.refused([{"field": {"points": [[0.1, 0.2], [9, 9]]}}], "/layers/0/field/points/1", "s", status=422, code="point_not_on_surface")
        self.refused([{"field": {"points": [[0.5, 0.5]]}}], "/layers/0/field/points/0", "plate", status=422, code="point_not_on_surface")
        self.refused([{"field": {"uv": [[0.1, 0.2]]}}], "/layers/0/field/uv", "s")
        self.refused([{"field": {"points": [[0.1, 0.2]] * 1001}}], "/layers/0/field/points", "s", status=413, code="too_large")
        self.refused([{"points": [[0.1, 0.2], [9, 9]]}], "/layers/0/points/1", "s", status=422, code="point_not_on_surface")
        self.refused([{"path": {"from": [0, 0]}}], "/layers/0/path/to", "s")
        self.refused([{"trace": {}}], "/layers/0/trace", "s")
        self.refused([{"isoparametric": {"u": 201}}], "/layers/0/isoparametric/u", "s")


if __name__ == "__main__":
    unittest.main()
