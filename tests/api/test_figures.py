"""Tests figures of meshes by POST …/picture. Compares positions of lines and points with
projections by figure_case. Also tests colours of pixels, labels, jobs, limits, and refusals that
name the layer."""
import json
import math
import re
import threading
import time
import unittest

from figure_case import Figure, FigureCase, Projection, SIDE, distance_to_line, dot, length_of, linear, plate, positions_of, subpaths, unit
from harness import sample, TWO_TRIANGLES
from test_pictures import SVG, Png


class FigureTests(FigureCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.meshes = {"plate": plate(), "sphere": sample("icosphere", level=4), "apart": TWO_TRIANGLES}
        cls.put_all(cls.meshes)

    def png(self, layers, mesh="plate", **members):
        document = {"layers": layers, "camera": {"view": "front"}, "legend": False, "width": 200, "height": 200, **members}
        return Png(self.posted(document, mesh, "png").body)

    def projection(self, mesh="plate", direction=(0, 0, 1), width=400, height=400):
        return Projection(positions_of(self.meshes[mesh]), direction, width, height)

    # --- one scene ---

    def test_get_and_post_are_one_scene(self):
        layers = [{"field": {"points": [{"vertex": 0}]}}, {"isolines": {"count": 10}}, {"surface": {"edges": True}}]
        for form in ("png", "svg"):
            posted = self.posted({"layers": layers, "camera": {"view": "iso"}, "width": 300, "height": 240}, "sphere", form).body
            got = self.daemon.request("GET", f"/v1/meshes/sphere/picture.{form}?source=v:0&view=iso&edges=true&size=300x240", None, {}).body
            self.assertEqual(posted, got)

    def test_a_figure_without_layers_is_the_surface(self):
        got = self.daemon.request("GET", "/v1/meshes/sphere/picture.png", None, {}).body
        self.assertEqual(self.posted({"layers": []}, "sphere", "png").body, got)

    # --- layers against computations of this file ---

    def test_a_path_is_where_its_points_project(self):
        direction = (1, 0.7, 2)
        pair = {"from": {"vertex": 0}, "to": {"vertex": 1000}}
        figure = self.figure([{"path": pair}], "sphere", camera={"direction": direction})
        points = [point["xyz"] for point in self.asked("sphere", "path", pair)["path"]["points"]]
        project, towards = self.projection("sphere", direction), unit(direction)
        seen, hidden = figure.lines(0), figure.lines(0, dashed=True)
        self.assert_drawn(points, seen + hidden, project)
        for line in seen:  # points of the unit sphere are visible on the camera's side
            for place in line:
                self.assertTrue(any(math.dist(place, project(p)) < 40 and dot(p, towards) > -0.2 for p in points))
        ends = figure.discs(0)
        self.assertEqual(len(ends), 4)  # a ring and a disc
        for disc, point in zip(ends[::2], (points[0], points[-1])):
            self.assertLess(math.dist(disc[:2], project(point)), 0.02)
        self.assertEqual(self.figure([{"path": pair, "ends": False}], "sphere").discs(0), [])

    def test_a_hidden_path_is_dashed_or_left_out_or_shown(self):
        pair = {"from": {"xyz": [0.3, 0.2, -1]}, "to": {"xyz": [-0.3, 0.1, -1]}}
        for hidden, seen_lines, dashed_lines in (("faint", 0, 1), ("none", 0, 0), ("shown", 1, 0)):
            figure = self.figure([{"path": pair, "hidden": hidden, "ends": False}], "sphere")
            self.assertEqual((len(figure.lines(0)), len(figure.lines(0, dashed=True))), (seen_lines, dashed_lines), hidden)

    def test_a_fan_has_a_line_for_each_direction(self):
        figure = self.figure([{"trace": {"start": {"xyz": [2, 2, 0]}, "fan": 12, "length": 1.5}}])
        lines, project = figure.lines(0), self.projection()
        self.assertEqual(len(lines), 12)
        for line in lines:
            self.assertLess(math.dist(line[0], project((2, 2, 0))), 0.05)
            self.assertAlmostEqual(math.dist(line[0], line[-1]), 1.5 * project.scale, delta=0.1)
        angles = sorted(math.atan2(line[0][1] - line[-1][1], line[-1][0] - line[0][0]) % (2 * math.pi) for line in lines)
        for a, b in zip(angles, angles[1:]):
            self.assertAlmostEqual(b - a, 2 * math.pi / 12, delta=1e-3)

    def test_exp_draws_the_paths_of_vectors(self):
        figure = self.figure([{"exp": {"start": {"xyz": [1, 1, 0]}, "vectors": [{"direction": [1, 0, 0], "length": 2}, {"direction": [0, 1, 0], "length": 1}]}}])
        self.assertEqual(len(figure.lines(0)), 2)
        self.assert_drawn([(3, 1, 0), (1, 2, 0), (2, 1, 0)], figure.lines(0), self.projection())

    def test_a_spline_its_control_points_and_its_frames(self):
        body = {"points": [{"xyz": [0.5, 1, 0]}, {"xyz": [2, 3, 0]}, {"xyz": [3.5, 1, 0]}], "samples": 8}
        answer, project = self.asked("plate", "spline", body), self.projection()
        plain = self.figure([{"spline": body}])
        self.assert_drawn([point["xyz"] for point in answer["path"]["points"]], plain.lines(0), project)
        self.assertEqual(plain.discs(0), [])
        controls = self.figure([{"spline": body, "controls": True}])
        expected = [project(point["xyz"]) for segment in answer["segments"] for point in segment["control_points"][1:3]]
        drawn = [disc[:2] for disc in controls.discs(0)[1::2]]
        self.assertEqual(len(drawn), len(expected))
        for a, b in zip(drawn, expected):
            self.assertLess(math.dist(a, b), 0.02)
        for segment in answer["segments"]:  # in the plane, control vectors are straight lines
            a, b = segment["control_points"][0]["xyz"], segment["control_points"][1]["xyz"]
            self.assert_drawn([[(p + q) / 2 for p, q in zip(a, b)]], controls.lines(0), project)
        framed = self.figure([{"spline": body, "frames": 4}])
        self.assertEqual(len(framed.groups["layer-0"]), 4)
        self.assertLessEqual({"#c62828", "#1a5fb4", "#1b7f3b"}, set(framed.strokes(0)))
        frames = self.asked("plate", "spline", {**body, "frames": True})["frames"]
        length = 0.04 * math.dist((0, 0, 0), (SIDE, SIDE, 0))
        for frame in frames[::4]:
            for vector in (frame["tangent"], frame["binormal"]):
                self.assert_drawn([[p + length * v for p, v in zip(frame["xyz"], vector)]], framed.lines(0) + sum(
                    (subpaths(path) for group in framed.groups["layer-0"] for path in group.iter(SVG + "path")), []), project)

    def test_the_bisector_of_two_points_is_perpendicular(self):
        a, b = (1, 1.3, 0), (3, 2.2, 0)
        figure = self.figure([{"voronoi": {"set": {"points": [{"xyz": a}, {"xyz": b}]}}}])
        project, lines = self.projection(), figure.lines(0)
        self.assertEqual(len(lines), 1)
        for place in lines[0]:
            self.assertAlmostEqual(math.dist(place, project(a)), math.dist(place, project(b)), delta=0.1)

    def test_the_cut_locus_of_a_square_is_its_diagonals(self):
        body = {"set": {"curves": [{"points": [{"xyz": [x, y, 0]} for x, y in ((1, 1), (3, 1), (3, 3), (1, 3))], "closed": True}]}, "members": "segments"}
        lines, figure = self.asked("plate", "cut-locus?geometry=xyz", body)["lines"], self.figure([{"cut_locus": body, "color": "#00ff00"}])
        self.assertEqual(len(figure.lines(0)), len(lines))
        self.assertEqual(set(figure.strokes(0)), {"#00ff00"})
        self.assert_drawn([(1.2, 1.2, 0), (2, 2, 0), (1.5, 2.5, 0), *(point for line in lines for point in line["points"])], figure.lines(0), self.projection())
        self.assertGreater(min(distance_to_line(self.projection()((2, 1.5, 0)), line) for line in figure.lines(0)), 10)

    def test_layers_without_lines(self):
        """A Voronoi diagram of one member has no bisector, and a flat plate has no cut locus of a
        corner."""
        corner = {"points": [{"vertex": 0}]}
        empty = self.posted({"layers": []}, "plate", "png").body
        for layer in ({"voronoi": {"set": corner}}, {"cut_locus": {"set": corner}}):
            self.assertEqual(self.posted({"layers": [layer]}, "plate", "png").body, empty)
        self.refused([{"path": {"from": "v:0", "to": "v:4"}}], "/layers/0/path/to", "apart")

    def test_isolines_at_levels_are_circles(self):
        levels = [0.5, 1, 1.5]
        figure = self.figure([{"field": {"points": [{"xyz": [2, 2, 0]}]}}, {"isolines": {"levels": levels}, "color": "#ff0000", "width": 2}])
        project = self.projection()
        drawn = [path for path in figure.root.iter(SVG + "path") if path.get("stroke") == "#ff0000"]
        radii = [math.dist(place, project((2, 2, 0))) / project.scale for line in subpaths(drawn[0]) for place in line]
        self.assertEqual(len(drawn), 1)
        for level in levels:
            self.assertTrue(any(abs(radius - level) < 1e-3 for radius in radii))
        self.assertTrue(all(min(abs(radius - level) for level in levels) < 5e-3 for radius in radii))

    def test_curves_and_their_distance(self):
        line = {"points": [{"xyz": [1, 1, 0]}, {"xyz": [1, 3, 0]}]}
        figure = self.figure([{"curve": {"curve": line, "operation": "length"}},
                              {"curve_distance": {"a": line, "b": {"points": [{"xyz": [3, 1.5, 0]}, {"xyz": [3.5, 2, 0]}]}, "measure": "min"}}])
        self.assert_drawn([(1, 1, 0), (1, 2, 0), (1, 3, 0)], figure.lines(0), self.projection())
        self.assert_drawn([(1, 1.5, 0), (2, 1.5, 0), (3, 1.5, 0)], figure.lines(1), self.projection())

    def test_points_have_labels_that_do_not_overlap(self):
        places = [(2 + 0.2 * i, 2 + 0.15 * j, 0) for i in range(4) for j in range(3)]
        names = [f"P{i}" for i in range(len(places))]
        names[3], names[5] = "a<b & c>d", ""
        figure = self.figure([{"points": [{"xyz": place} for place in places], "labels": names, "color": "#123456", "radius": 3}])
        project, discs = self.projection(), figure.discs(0)[1::2]
        self.assertEqual([disc[3] for disc in discs], ["#123456"] * len(places))
        for disc, place in zip(discs, places):
            self.assertLess(math.dist(disc[:2], project(place)), 0.02)
        self.assertEqual([text[0] for text in figure.texts()], [name for name in names if name])
        crowded = [text for text in figure.texts() if re.fullmatch(r"P\d", text[0])]
        for i, a in enumerate(crowded):
            for b in crowded[:i]:
                self.assertTrue(abs(a[1] - b[1]) > 10 or abs(a[2] - b[2]) > 8, (a, b))

    def test_hidden_points_are_faint(self):
        points = [{"xyz": [0, 0, 1]}, {"xyz": [0.1, 0.1, -1]}]
        opacities = {hidden: [disc[4] for disc in self.figure([{"points": points, "hidden": hidden}], "sphere").discs(0)[1::2]]
                     for hidden in ("faint", "none", "shown")}
        self.assertEqual(opacities, {"faint": [1, 0.4], "none": [1], "shown": [1, 1]})

    def test_colours_of_pixels(self):
        line = {"curve": {"curve": {"points": [{"xyz": [0.5, 2, 0]}, {"xyz": [3.5, 2, 0]}]}, "operation": "length"}, "color": "#00c8ff", "width": 6}
        png, project = self.png([line]), self.projection(width=200, height=200)
        for x in (1, 2, 3):
            at = project((x, 2, 0))
            self.assertEqual(png.at(int(at[0]), int(at[1])), (0, 0xc8, 0xff))
        self.assertEqual(self.png([], background="dark").at(0, 0), (23, 26, 31))
        grey, blue = self.png([]).at(100, 60), self.png([{"surface": {}, "color": "#0000ff"}]).at(100, 60)
        self.assertLess(max(grey) - min(grey), 16)
        self.assertTrue(blue[0] == blue[1] == 0 and blue[2] > 100, blue)

    def test_lines_without_colour_differ(self):
        trace = {"start": {"xyz": [2, 2, 0]}, "fan": 3, "length": 1}
        figure = self.figure([{"trace": trace}, {"trace": trace, "color": "#777777"}, {"trace": trace}, {"points": [{"vertex": 0}]}])
        colours = [figure.strokes(layer)[-1] for layer in range(3)]
        self.assertEqual((colours[0], colours[1], len(set(colours))), ("#d1121f", "#777777", 3))

    def test_zoom_and_target(self):
        target = (1, 3, 0)
        figure = self.figure([{"points": [{"xyz": target}, {"xyz": [2, 3, 0]}]}], camera={"view": "front", "zoom": 5, "target": target})
        (x, y, *_), (x2, y2, *_) = figure.discs(0)[1::2]
        self.assertLess(math.dist((x, y), (200, 200)), 0.02)
        self.assertAlmostEqual(x2 - x, 5 * self.projection().scale, delta=0.05)
        far = self.figure([{"trace": {"start": {"xyz": target}, "fan": 8, "length": 4}}], camera={"view": "front", "zoom": 100, "target": target})
        places = [place for line in far.lines(0) for place in line]
        self.assertTrue(places and all(-401 < value < 802 for place in places for value in place))

    def test_arrows_beyond_the_surface_are_in_the_figure(self):
        body = {"points": [{"xyz": [0, 0, 1]}, {"xyz": [1, 0, 0]}, {"xyz": [0, 0, -1]}], "samples": 4}
        figure = self.figure([{"spline": body, "frames": 1}], "sphere", camera={"direction": [0, 1, 0]})
        places = [place for group in figure.groups["layer-0"] for path in group.iter(SVG + "path") for line in subpaths(path) for place in line]
        self.assertTrue(all(0 < value < 400 for place in places for value in place))

    # --- legend ---

    def test_names_stand_in_the_legend(self):
        trace = {"start": {"xyz": [2, 2, 0]}, "fan": 3, "length": 1}
        layers = [{"trace": trace, "label": f"a bundle of traces number {i}"} for i in range(7)] + [{"points": [{"vertex": 0}], "label": "a corner"}]
        document = {"layers": layers, "camera": {"view": "front"}, "width": 500, "height": 400}
        names = [text for text in Figure(self.posted(document).body).texts()]
        self.assertEqual([name for name, _, _ in names], [layer["label"] for layer in layers])
        self.assertTrue(all(0 < x < 500 - 100 and 200 < y < 398 for _, x, y in names))
        self.assertEqual(len({(x, y) for _, x, y in names}), len(names))
        self.assertEqual(Figure(self.posted({**document, "legend": False}).body).texts(), [])
        narrow = Figure(self.posted({"layers": [{"trace": trace, "label": "m" * 40}], "width": 200, "height": 200}).body).texts()
        self.assertRegex(narrow[0][0], r"^m+\.\.$")

    # --- scenes in three dimensions ---

    def test_a_scene_has_the_surface_and_its_distances(self):
        scene = self.scene_of([{"surface": {}, "color": "#336699"}])
        sent = positions_of(self.meshes["plate"])
        self.assertEqual(scene.nodes, {})
        for place, position in zip(scene.places, sent):
            self.assertLess(math.dist(place, position), 1e-6)
        self.assertAlmostEqual(scene.area(), SIDE**2, 5)
        for part, expected in zip(scene.colour, linear("#336699")):
            self.assertAlmostEqual(part, expected, 6)
        levels = [0.5, 1.25]
        scene = self.scene_of([{"field": {"points": [{"xyz": [1, 1.5, 0]}]}}, {"isolines": {"levels": levels}, "color": "#ff8800"}])
        for place, distance in zip(scene.places, scene.distances):
            self.assertAlmostEqual(distance, math.dist(place, (1, 1.5, 0)), 5)
        ends = [end for segment in scene.segments("isolines") for end in segment]
        found = [sum(abs(math.dist(end, (1, 1.5, 0)) - level) < 1e-5 for end in ends) for level in levels]
        self.assertEqual(sum(found), len(ends))
        self.assertTrue(all(found))
        # the lines are circles up to 1e-4 of the diagonal, and the larger circle extends beyond the
        # plate
        self.assertAlmostEqual(length_of(scene.segments("isolines")), 2 * math.pi * 0.5 + 2 * (math.pi - math.acos(1 / 1.25)) * 1.25, 2)
        for part, expected in zip(scene.paint("isolines"), linear("#ff8800")):
            self.assertAlmostEqual(part, expected, 6)

    def test_layers_are_nodes_of_a_scene(self):
        pair = {"from": {"xyz": [0.3, 0.2, 0]}, "to": {"xyz": [3, 2.5, 0]}}
        points = [[1, 1, 0], [2, 3, 0], [0.5, 0.25, 0]]
        layers = [{"trace": {"start": {"xyz": [2, 2, 0]}, "fan": 12, "length": 1.5}, "color": "#1a5fb4", "label": 'a "fan" \\'},
                  {"points": [{"xyz": place} for place in points], "labels": ["A", "", 'B"']}, {"surface": {"edges": True}},
                  {"path": pair, "hidden": "none"}]
        scene = self.scene_of(layers, camera={"view": "top", "zoom": 3})
        self.assertEqual(list(scene.nodes), ["layer-0", "layer-1", "layer-3"])
        self.assertEqual([mesh.get("extras") for name in scene.nodes for mesh in scene.nodes[name]],
                         [{"label": 'a "fan" \\'}, {"labels": ["A", None, 'B"']}, None])
        for place, point in zip(scene.points("layer-1"), points):
            self.assertLess(math.dist(place, point), 1e-6)
        self.assertAlmostEqual(length_of(scene.segments("layer-0")), 12 * 1.5, 4)
        ends = [end for segment in scene.segments("layer-0") for end in segment]
        self.assertLess(max(math.dist(end, (2, 2, 0)) for end in ends), 1.5 + 1e-6)
        path = scene.segments("layer-3")
        self.assertAlmostEqual(length_of(path), math.dist(*(pair[end]["xyz"] for end in pair)), 5)
        for (_, end), (begin, _) in zip(path, path[1:]):
            self.assertEqual(end, begin)
        for part, expected in zip(scene.paint("layer-0"), linear("#1a5fb4")):
            self.assertAlmostEqual(part, expected, 6)

    def test_a_scene_is_a_mesh_file_too(self):
        body = self.posted({"layers": [{"trace": {"start": {"xyz": [0, 0, 1]}, "fan": 5, "length": 1}}, {"points": [{"vertex": 0}]}]}, "sphere", "glb").body
        self.assertEqual(self.daemon.put("again", body).json["faces"], self.daemon.get("/v1/meshes/sphere").json["faces"])

    # --- cuts ---

    WINDOW = {"curve": {"points": [{"xyz": [x, y, 0]} for x, y in ((1, 1), (3, 1), (3, 3), (1, 3))], "closed": True}}

    def test_the_pieces_of_a_cut_are_apart(self):
        """The cut divides the plate into a window and a frame. The window moves along the normal of
        the plate, and the frame stays."""
        for apart, lift in (({}, 0.15), ({"apart": 0.5}, 0.5), ({"apart": 0}, 0)):
            scene = self.scene_of([{"cut": self.WINDOW, **apart}])
            height = lift * math.dist((0, 0), (SIDE, SIDE))
            self.assertAlmostEqual(scene.area(), SIDE**2, 4)
            for x, y, z in scene.places:
                inside = 1 < x < 3 and 1 < y < 3
                outside = x < 1 or x > 3 or y < 1 or y > 3
                if inside or outside:  # vertices on the curve belong to both pieces
                    self.assertAlmostEqual(z, height if inside else 0, 5)
            lines = scene.segments("layer-0")
            at_height = [segment for segment in lines if abs(segment[0][2] - height) < 1e-5]
            self.assertAlmostEqual(length_of(lines), 4 * SIDE + 2 * 8, 4)
            if height:
                self.assertAlmostEqual(length_of(at_height), 8, 4)

    def test_a_cut_is_where_it_projects(self):
        direction, height = (1, -0.7, 2), 0.3 * math.dist((0, 0), (SIDE, SIDE))
        window = [(x, y, height) for x, y in ((1, 1), (3, 1), (3, 3), (1, 3))]
        figure = self.figure([{"cut": self.WINDOW, "apart": 0.3, "hidden": "shown", "color": "#123456"}], camera={"direction": direction})
        project = Projection(positions_of(self.meshes["plate"]) + window, direction, 400, 400)
        lines = figure.lines(0)
        self.assertEqual((len(lines), set(figure.strokes(0)) >= {"#123456"}), (3, True))
        self.assert_drawn([*window, (0, 0, 0), (SIDE, SIDE, 0), (1, 2, 0), (2, 3, 0)], lines, project)
        self.assertGreater(min(distance_to_line(project((2, 2, height)), line) for line in lines), 10)

    def test_one_piece_of_a_cut(self):
        scene = self.scene_of([{"cut": {**self.WINDOW, "inside": {"xyz": [2, 2, 0]}}, "apart": 1}])
        self.assertAlmostEqual(scene.area(), 4, 5)
        self.assertEqual({round(place[2], 6) for place in scene.places}, {0})

    def test_halves_of_a_sphere_face_away_from_each_other(self):
        ring = [{"xyz": [math.cos(a), math.sin(a), 0.3]} for a in (k * math.pi / 4 for k in range(8))]
        scene = self.scene_of([{"cut": {"curve": {"points": ring, "closed": True}}, "apart": 0.25}], "sphere")
        cap = max(scene.places, key=lambda p: p[2])
        self.assertAlmostEqual(cap[2], 1 + 0.25 * math.sqrt(12), 2)
        self.assertLess(math.hypot(cap[0], cap[1]), 0.1)
        self.assertAlmostEqual(min(place[2] for place in scene.places), -1, 5)

    def test_a_tube_moves_away_from_the_largest_piece(self):
        tube = sample("cylinder")
        self.put_all({"tube": tube})
        positions = positions_of(tube)
        lows, highs = ([side(p[k] for p in positions) for k in range(3)] for side in (min, max))
        axis = max(range(3), key=lambda k: highs[k] - lows[k])
        loops = self.daemon.get("/v1/meshes/tube").json["boundaries"]
        self.assertEqual(len(loops), 2)
        at = lows[axis] + 0.7 * (highs[axis] - lows[axis])
        radius = max(abs(p[(axis + 1) % 3]) for p in positions)
        ring = []
        for k in range(8):
            place = [0, 0, 0]
            place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = at, radius * math.cos(k * math.pi / 4), radius * math.sin(k * math.pi / 4)
            ring.append({"xyz": place})
        scene = self.scene_of([{"cut": {"curve": {"points": ring, "closed": True}}, "apart": 0.2}], "tube")
        reached = sorted(place[axis] for place in scene.places)
        self.assertAlmostEqual(reached[0], lows[axis], 5)
        self.assertAlmostEqual(reached[-1], highs[axis] + 0.2 * math.dist(lows, highs), 5)

    def test_cuts_are_refused(self):
        point = {"vertex": 0}
        self.refused([{"surface": {}}, {"cut": {**self.WINDOW, "names": ["a", "b"]}}], "/layers/1/cut/names")
        self.refused([{"cut": {**self.WINDOW, "select_only": True}}], "/layers/0/cut/select_only")
        self.refused([{"cut": {"curve": {"points": [point, {"vertex": 7777}]}}}], "/layers/0/cut/curve/points/1")
        self.refused([{"cut": {**self.WINDOW, "inside": {"vertex": 7777}}}], "/layers/0/cut/inside")
        self.refused([{"cut": {"curve": {"points": [{"xyz": [1, 1, 0]}, {"xyz": [2, 2, 0]}]}}}], "/layers/0/cut")
        self.refused([{"cut": self.WINDOW}, {"cut": self.WINDOW}], "/layers/1/cut")
        self.assertIn("no field", self.refused([{"cut": self.WINDOW}, {"field": {"points": [point]}}], "/layers/1/field"))
        for apart in (-0.1, 10.5, "far"):
            self.refused([{"cut": self.WINDOW, "apart": apart}], "/layers/0/apart")
        self.assertEqual(self.daemon.get("/v1/meshes/plate-1").status, 404)

    # --- refusals ---

    def test_a_problem_names_the_layer(self):
        point, far = {"vertex": 0}, {"vertex": 7777}
        detail = self.refused([{"tracks": {}}], "/layers/0")
        for kind in ("surface", "field", "isolines", "path", "trace", "exp", "spline", "curve", "curve_distance", "voronoi", "cut_locus", "points"):
            self.assertIn(kind, detail)
        self.refused([{}], "/layers/0")
        self.refused([7], "/layers/0")
        self.refused({"path": {}}, "/layers")
        self.refused([{"points": [point]}, {"trace": {"start": point, "fan": 3, "length": -1}}], "/layers/1/trace/length")
        self.refused([{"trace": 5}], "/layers/0/trace")
        self.refused([{"points": [point]}, {"path": {"from": point, "to": far}}], "/layers/1/path/to")
        self.refused([{"spline": {"points": [point, far]}}], "/layers/0/spline/points/1")
        self.refused([{"points": [point, far]}], "/layers/0/points/1")
        self.refused([{"field": {"points": [far]}}], "/layers/0/field/points/0")
        self.refused([{"voronoi": {"set": {"points": [far]}}}], "/layers/0/voronoi/set/points/0")
        self.refused([{"cut_locus": {"set": {"points": [far]}}}], "/layers/0/cut_locus/set/points/0")
        self.refused([{"cut_locus": {"set": {"points": [point]}, "min_angle": 4}}], "/layers/0/cut_locus/min_angle")
        self.refused([{"isolines": {"count": 3}}], "/layers/0/isolines")
        self.refused([{"field": {"points": [point]}, "max_distance": 1}, {"isolines": {"levels": [0.5, 2]}}], "/layers/1/isolines")
        self.refused([{"field": {"points": [point]}}, {"field": {"points": [point]}}], "/layers/1/field")
        self.refused([{"points": [point], "color": "red"}], "/layers/0/color")
        self.refused([{"points": [point], "color": "#12345g"}], "/layers/0/color")
        self.refused([{"points": [point], "labels": ["\u00e9"]}], "/layers/0/labels/0")
        self.refused([{"points": [point], "labels": ["A", "B"]}], "/layers/0/labels")
        self.refused([{"points": [point], "label": 41 * "x"}], "/layers/0/label")
        self.refused([{"points": [point], "radius": 0}], "/layers/0/radius")
        self.refused([{"points": [point], "width": 3}], "/layers/0/width")
        self.refused([{"path": {"from": point, "to": point}, "width": 51}], "/layers/0/width")
        self.refused([{"path": {"from": point, "to": point}, "hidden": "away"}], "/layers/0/hidden")

    def test_limits_and_the_camera(self):
        self.assertIn("64", self.refused([{"surface": {}}] * 65, "/layers", status=413, code="too_large"))
        self.refused([], "/width", width=4096, height=4096, status=413, code="too_large")
        self.refused([], "/height", height=15)
        self.refused([], "/camera/direction", camera={"direction": [0, 0, 0]})
        self.refused([], "/camera/up", camera={"up": [0, 0, 0]})
        self.refused([], "/camera/zoom", camera={"zoom": 0.5})
        self.assertIn("too far", self.refused([], "/camera/target", camera={"zoom": 2, "target": [1e300, 0, 0]}))
        self.refused([], "/camera/view", camera={"view": "under"})
        self.refused([], "/background", background="red")
        self.refused([{"points": [{"vertex": 0}] * 10001}], "/layers/0/points", status=413, code="too_large")
        trace = {"trace": {"start": {"xyz": [0.2, 0.1, 1]}, "fan": 10000, "length": 60, "step_limit": 1000}}
        problem = self.posted({"layers": [trace]}, "sphere", status=413).json
        self.assertEqual((problem["code"], problem["pointer"], problem["limit"]), ("too_large", "/layers/0/trace", 4000000), problem)

    # --- the request ---

    def test_the_form_is_chosen(self):
        def type_of(query, **headers):
            answer = self.daemon.request("POST", "/v1/meshes/plate/picture" + query, b'{"layers": [], "width": 32, "height": 32}',
                                         {"Content-Type": "application/json", **headers})
            return answer.headers["Content-Type"] if answer.status == 200 else answer.status

        self.assertEqual(type_of(""), "image/png")
        self.assertEqual(type_of("", Accept="image/*"), "image/png")
        self.assertEqual(type_of("", Accept="image/svg+xml"), "image/svg+xml")
        self.assertEqual(type_of("", Accept="image/png;q=0.5, image/svg+xml"), "image/svg+xml")
        self.assertEqual(type_of("?format=svg", Accept="image/png"), "image/svg+xml")
        self.assertEqual(type_of("", Accept="application/json"), 406)
        self.assertEqual(type_of("", Accept="model/gltf-binary"), "model/gltf-binary")
        self.assertEqual(type_of("", Accept="model/*"), "model/gltf-binary")
        self.assertEqual(type_of("?format=glb", Accept="image/png"), "model/gltf-binary")
        self.assertEqual(type_of("?format=svg"), "image/svg+xml")
        self.assertEqual(type_of("?format=gif"), 400)

    def test_as_a_job(self):
        layers = [{"trace": {"start": {"vertex": 0}, "fan": 40, "length": 3}}, {"field": {"points": [{"vertex": 7}]}}]
        answer = self.posted({"layers": layers}, "sphere", "png", status=202, Prefer="respond-async")
        place = answer.headers["Location"]
        while self.daemon.get(place).json["state"] in ("queued", "running"):
            time.sleep(0.01)
        result = self.daemon.get(place + "/result")
        self.assertEqual((result.status, result.headers["Content-Type"]), (200, "image/png"))
        self.assertEqual(result.body, self.posted({"layers": layers}, "sphere", "png").body)

    def test_it_ends_at_its_deadline(self):
        layers = [{"trace": {"start": {"vertex": 0}, "fan": 1000, "length": 30}}, {"field": {"points": [{"vertex": 7}]}}]
        answer = self.daemon.request("POST", "/v1/meshes/sphere/picture?timeout_ms=1", json.dumps({"layers": layers}).encode(), {"Content-Type": "application/json"})
        self.assertEqual(self.assert_problem(answer, 504, "deadline_exceeded").get("pointer"), None)

    def test_layers_that_share_a_field_wait_for_it(self):
        """Requests many figures at once. The layers of each figure need the same new field."""
        answers = []

        def ask(vertex):
            points = [{"vertex": vertex}, {"vertex": vertex + 900}]
            answers.append(self.posted({"layers": [{"voronoi": {"set": {"points": points}}}, {"field": {"points": points}}, {"isolines": {"count": 4}}],
                                        "width": 64, "height": 64}, "sphere", "png"))

        threads = [threading.Thread(target=ask, args=(10 + i // 4,)) for i in range(16)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(answers), 16)

    def test_memory_is_given_back(self):
        trace = {"trace": {"start": {"vertex": 0}, "fan": 100, "length": 3}}
        self.posted({"layers": [trace, {"points": [{"vertex": 3}], "labels": ["x"]}]}, "sphere", "png")
        self.posted({"layers": [trace, {"points": [{"vertex": 99999}]}]}, "sphere", status=400)
        self.daemon.wait_for_flight()


if __name__ == "__main__":
    unittest.main()
