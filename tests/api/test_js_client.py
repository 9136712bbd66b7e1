"""Tests the JavaScript client under Node.js: the scenario and the client's own features. Skipped
without node 18 or later."""
import json
import pathlib
import shutil
import subprocess
import tarfile
import tempfile
import unittest

import scenario
from harness import PROGRAM, SQUARE, TestCase, sample

NODE = shutil.which("node")
MODULES = PROGRAM.parent / "web" / "node_modules"  # the viewer's packages: three.js, TypeScript
PACKAGE = scenario.CLIENTS / "js"


def is_new_enough():
    return NODE and int(subprocess.run([NODE, "--version"], stdout=subprocess.PIPE, text=True).stdout[1:].split(".")[0]) >= 18


@unittest.skipUnless(is_new_enough(), "there is no node of version 18 or later")
class JavaScriptClient(TestCase):
    def run_script(self, script, url=None):
        """Runs a script; on failure shows its output."""
        text = f"""
            import assert from "node:assert/strict";
            import fs from "node:fs";
            import * as geodesicd from "{(scenario.CLIENTS / "js" / "index.js").as_uri()}";
            const client = new geodesicd.Client("{url or "http://" + self.daemon.address}", {{ retries: 3 }});
            {script}
        """
        done = subprocess.run([NODE, "--input-type=module"], input=text, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_scenario(self):
        self.run_script(f"""
            const steps = JSON.parse(fs.readFileSync("{scenario.CLIENTS / "scenario.json"}", "utf8")).steps;
            function check(answer, expected, where) {{
              if (typeof expected === "number") assert(Math.abs(answer - expected) <= 1e-12 * Math.abs(expected), `${{where}}: ${{answer}}`);
              else if (expected === null || typeof expected !== "object") assert.equal(answer, expected, where);
              else for (const name of Object.keys(expected)) check(answer[name], expected[name], `${{where}}/${{name}}`);
            }}
            async function run(step) {{
              const mesh = client.mesh("scenario");
              const typed = step.arrays && {{ vertices: Float64Array.from(step.arrays.vertices.flat()), faces: Uint32Array.from(step.arrays.faces.flat()) }};
              if (step.upload) return (await client.upload(step.upload, typed ?? step.file, step.edits)).describe();
              if (step.call === "matrix") return client.mesh(step.mesh).matrix(step.sources, step.targets);
              if (step.call === "field") return (await client.mesh(step.mesh).field(step.sources)).values();
              if (step.delete) return client.mesh(step.delete).delete();
              if (step.derive) return (await mesh.derive(step.derive, step.operations)).describe();
              if (step.split) return Promise.all((await mesh.split(step.split, step.operations)).map((part) => part.describe()));
              if (step.preview) return Buffer.from(await mesh.preview({{ faces: step.faces }})).toString("latin1", 0, 4);
              return mesh.query(step.query, step.body);
            }}
            assert(steps.length > 10);
            for (const step of steps) {{
              const where = JSON.stringify(step);
              if (!step.problem) check(await run(step), step.expect ?? undefined, where);
              else await assert.rejects(run(step), (error) => {{
                check({{ ...error.problem, status: error.status }}, step.problem, where);
                return error instanceof geodesicd.ProblemError;
              }});
            }}
        """)

    def test_queries(self):
        self.daemon.put("square", SQUARE)
        self.run_script("""
            const square = client.mesh("square");
            for (const point of [2, "v:2", [1, 1, 0], { vertex: 2 }, "p:1,1,0", "e:1-2:1", "f:0:0,0,1", await square.nearest([1, 1, 7])])
              assert(Math.abs((await square.distance(0, point)) - Math.SQRT2) < 1e-12);
            assert.throws(() => geodesicd.toPoint("w:2"), TypeError);
            await assert.rejects(square.distance(0, [1, NaN, 0]), /NaN is not a finite number/);
            assert.deepEqual(await square.path(0, 1), { length: 1, points: [[0, 0, 0], [1, 0, 0]] });
            assert.equal(await square.distance(1, 3, { via: [0] }), 2);
            assert.deepEqual((await square.matrix([0, 1], [1, 0])).map((row) => [...row]), [[1, 0], [0, 1]]);
            const field = await square.field([0, 1]);
            assert.deepEqual([...(await field.values())], [0, 0, 1, 1]);
            assert.deepEqual(await field.distances([2, "v:0"]), [1, 0]);
            assert.equal((await field.isolines([0.5])).length, 1);
            assert.match(Buffer.from(await field.isolinesFile([0.5], "csv", { tolerance: 0.1 })).toString(), /^line,point,x,y,z,along,level/);
            await field.delete();
            await assert.rejects(field.describe(), { status: 404, code: "not_found" });
            assert.equal(await square.exists(), true);
            assert.equal(await client.mesh("nobody").exists(), false);
            const triangle = await client.upload(null, { vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces: [[0, 1, 2]] });
            assert.equal((await triangle.describe()).faces, 1);
            const names = [];
            for await (const mesh of client.meshes()) names.push(mesh.name);
            assert(names.includes("square") && names.includes(triangle.name));
            assert.match(await square.content(), /^f 1 2 3$/m);
            const start = (buffer) => Buffer.from(buffer).toString("latin1", 0, 4);
            assert.deepEqual([start(await square.content("glb")), start(await square.picture("png", { source: "v:0", size: "64x64" }))], ["glTF", "\\x89PNG"]);
            assert.equal(start(await square.figure([{ points: [{ vertex: 0 }] }], { width: 32, height: 32 })), "\\x89PNG");
            assert.equal(start(await square.figure([], { form: "svg", camera: { view: "top" } })), "<svg");
            assert.deepEqual([start(await (await square.field(0)).file()), start(await square.pathFile(0, 2, "svg"))], ["ply\\n", "<svg"]);
        """)

    def test_arrays(self):
        self.run_script("""
            const vertices = Float32Array.of(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0), faces = Uint16Array.of(0, 1, 2, 0, 2, 3);
            const square = await client.upload("typed", { vertices, faces });
            assert.deepEqual(await square.arrays(), { vertices: Float64Array.from(vertices), faces: Uint32Array.from(faces) });
            const rows = async (...points) => (await square.matrix(...points)).map((row) => [...row]);
            assert.deepEqual(await rows(Uint32Array.of(0), vertices.subarray(3)), [[1, Math.SQRT2, 1]]);
            assert.deepEqual(await rows([Float64Array.of(1, 0, 0), { isVector3: true, x: 0, y: 1, z: 0 }], [0]), [[1], [1]]);
            for (const mixed of [{ vertices: [...vertices], faces: [...faces] }, { vertices, faces: [...faces] }, { vertices, faces: [[0, 1, 2, 3]] }])
              assert.deepEqual((await (await client.upload("mixed", mixed)).describe()).faces, 2);
            await assert.rejects(client.upload("mixed", undefined), TypeError);
            assert.throws(() => new geodesicd.Client("localhost:8080"), TypeError);
            const pairs = async (...ends) => [...(await square.pairs(...ends))];
            assert.deepEqual(await pairs(Int32Array.of(0, 1), [2]), [Math.SQRT2, 1]);
            assert.deepEqual(await pairs([[0, 0, 0], { isVector3: true, x: 1, y: 1, z: 0 }], [1, 1]), [1, 1]);
            await assert.rejects(pairs([-1], [0]), TypeError);
            const field = await square.field(Uint8Array.of(0, 1));
            assert.deepEqual(await field.distances(vertices.subarray(6)), [1, 1]);
            assert.deepEqual((await square.field(vertices.subarray(0, 6))).id, (await square.field([[0, 0, 0], [1, 0, 0]])).id);
            const lines = await field.isolineArrays(3);
            assert.equal(lines.first.at(-1) * 3, lines.points.length);
            assert.equal((await field.isolines(4, { geometry: "none" })).length, 4);
            assert.equal((await square.queryArrays("voronoi", { set: geodesicd.toSet([0, 2]) })).constructor, Object);
        """)

    @unittest.skipUnless((MODULES / "three").is_dir(), "three.js is not installed")
    def test_geometries_of_three(self):
        self.run_script(f"""
            const {{ BoxGeometry, SphereGeometry, Vector3 }} = await import("{(MODULES / 'three/build/three.module.js').as_uri()}");
            const box = new BoxGeometry(1, 1, 1), cube = await client.upload("cube", box);
            const {{ vertices, faces, components }} = await cube.describe();
            assert.deepEqual([box.getAttribute("position").count, vertices, faces, components], [24, 8, 12, 1]);
            const {{ index }} = geodesicd.fromGeometry(box), values = await (await cube.field(new Vector3(0.5, 0.5, 0.5))).values();
            const distances = Array.from(index, (vertex) => values[vertex]);
            assert.equal(distances.filter((distance) => distance === 0).length, 3); // a corner is in three sides
            const ball = await client.upload("ball", new SphereGeometry(1, 16, 12).toNonIndexed());
            const {{ euler_characteristic, boundary_count }} = await ball.describe();
            assert.deepEqual([euler_characteristic, boundary_count], [2, 0]);
        """)

    def test_every_call_can_be_aborted(self):
        self.daemon.put("square", SQUARE)
        with scenario.busy(*[(503, {"Retry-After": "9"}, {})] * 9) as (server, url):
            self.run_script("""
                const square = client.mesh("square"), field = new geodesicd.Field(square, { id: "f" });
                const job = new geodesicd.Job(client, { id: "j", state: "running", progress: 0 });
                const calls = {
                  client: (o) => [client.job("j", o), client.service(o), client.createBatch({}, o), client.batch("b", o), client.waitBatch("b", undefined, o),
                    client.deleteBatch("b", o), client.meshes(o).next(), client.batchResults("b", o).next(), client.batchResults("b", { wait: true, ...o }).next(),
                    client.upload("u", "", o)],
                  job: (o) => [job.wait(undefined, o), job.response(o), job.cancel(o)],
                  square: (o) => [square.query("distance", {}, o), square.queryArrays("voronoi", {}, o), square.describe(o), square.delete(o), square.exists(o),
                    square.distance(0, 1, o), square.path(0, 1, o), square.pathFile(0, 1, "obj", o), square.picture("png", o), square.nearest(0, o),
                    square.pairs(Uint32Array.of(0), Uint32Array.of(1), o), square.nearestPoints(Float64Array.of(0, 0, 0), o), square.matrix([0], [1], o),
                    square.field(0, o), square.content("obj", o), square.arrays(o), square.derive("d", [], o), square.split("d", [], o), square.origins(o),
                    square.preview(o)],
                  field: (o) => [field.values(o), field.file("ply", o), field.distances([0], o), field.isolines(3, o), field.isolineArrays(3, o),
                    field.isolinesFile(3, "obj", o)],
                };
                const aborted = { signal: AbortSignal.abort() };
                for (const some of Object.values(calls))
                  for (const call of some(aborted)) await assert.rejects(call, { name: "AbortError" });
                const began = Date.now();
                await assert.rejects(client.service({ signal: AbortSignal.timeout(2500) }), { name: "TimeoutError" });
                assert(Date.now() - began < 8500); // while it waits before another try
            """, url)
            self.assertEqual(len(server.seen), 1)

    def test_the_daemon_serves_the_client(self):
        answer = self.daemon.get("/client.js")
        self.assertEqual(answer.body, (PACKAGE / "index.js").read_bytes())
        self.assertIn("javascript", answer.headers["Content-Type"])

    def test_jobs(self):
        self.daemon.put("sphere", sample("icosphere", level=5))
        self.run_script("""
            const sphere = client.mesh("sphere"), seen = [];
            const field = await sphere.field(0, { onProgress: (progress) => seen.push(progress) });
            assert(field.max > 2 && seen.at(-1) === 1);
            const many = Array.from({ length: 500 }, (_, i) => ({ vertex: i }));
            const job = await client.submit("POST", sphere.location + "/matrix", { body: { sources: many, targets: many } });
            await job.cancel();
            await assert.rejects((await job.wait()).response(), geodesicd.JobCancelled);
            const started = await client.submit("POST", sphere.location + "/fields", { body: { set: { points: ["v:77"] } } });
            assert.equal((await client.job(started.id, { wait: 60 })).state, "done");
        """)

    def test_a_refused_origin_differs_from_a_dead_daemon(self):
        self.run_script("""
            const answered = globalThis.fetch;
            let isThere = true;
            globalThis.location = { origin: "https://elsewhere.example", href: "https://elsewhere.example/page" };
            globalThis.fetch = async (url, { mode } = {}) => { // as browsers do
              if (mode !== "no-cors" || !isThere) throw new TypeError("Failed to fetch");
              assert(url.endsWith("/livez"));
              return { type: "opaque" };
            };
            await assert.rejects(client.service(), (error) => error instanceof geodesicd.OriginRefused && /--cors-origin https:\\/\\/elsewhere/.test(error.message));
            isThere = false;
            const impatient = new geodesicd.Client(client.url, { retries: 0 });
            await assert.rejects(impatient.service(), (error) => error instanceof geodesicd.ConnectionFailed && !(error instanceof geodesicd.OriginRefused));
            globalThis.fetch = answered;
        """)

    def test_lists_by_prefix(self):
        for name in ("a-1", "a-2", "b-1"):
            self.daemon.put(name, SQUARE)
        self.run_script("""
            const names = [];
            for await (const { name } of client.meshes({ prefix: "a-" })) names.push(name);
            assert.deepEqual(names, ["a-1", "a-2"]);
        """)

    def test_batches(self):
        self.daemon.put("square", SQUARE)
        self.run_script("""
            const ended = async (batch) => {
              for (const until = Date.now() + 30000; batch.state === "running" && Date.now() < until; batch = await client.batch(batch.id))
                await new Promise((resume) => setTimeout(resume, 20));
              return batch;
            };
            const pairs = await ended(await client.createBatch({ query: "all-pairs", mesh: "square", vertices: [0, 1] })), rows = [];
            assert.deepEqual([pairs.state, pairs.items, pairs.done, pairs.failed], ["done", 2, 2, 0]);
            for await (const { vertex, answer } of client.batchResults(pairs.id)) rows.push([vertex, answer.distances[0]]);
            assert.deepEqual(rows, [[0, [0, 1]], [1, [1, 0]]]);
            await client.deleteBatch(pairs.id);
            await assert.rejects(client.batch(pairs.id), { status: 404, code: "not_found" });
            const followed = await client.createBatch({ query: "all-pairs", mesh: "square", vertices: [0, 1, 2] }), seen = [], told = [];
            for await (const { item } of client.batchResults(followed.id, { wait: true })) seen.push(item);
            assert.deepEqual(seen.sort(), [0, 1, 2]);
            assert.equal((await client.waitBatch(followed.id, (part) => told.push(part))).state, "done");
            assert.equal(told.at(-1), 1);
            await client.deleteBatch(followed.id);
            const many = await ended(await client.createBatch({ query: "fields", meshes: Array(150).fill("nobody"), set: { points: [{ vertex: 0 }] } })), items = [];
            for await (const { item, problem } of client.batchResults(many.id)) items.push(problem.code === "not_found" ? item : problem);
            assert.deepEqual(items, Array.from({ length: 150 }, (_, item) => item)); // of more than one page
            await client.deleteBatch(many.id);
        """)

    def test_requests_are_repeated_if_the_daemon_is_busy(self):
        with scenario.busy((503, {"Retry-After": "0"}, {}), (429, {}, {}), (0, {}, {})) as (server, url):
            self.run_script('assert.deepEqual(await client.service(), { version: "1" });', url)
            self.assertEqual(len(server.seen), 4)
        with scenario.busy((429, {"Retry-After": "0"}, {}), (0, {}, {})) as (server, url):
            self.run_script('await assert.rejects(client.createBatch({}), geodesicd.ConnectionFailed);', url)
            self.assertEqual(len(server.seen), 2)
        # without Retry-After the batch may exist
        with scenario.busy((503, {}, {"code": "store_unavailable"})) as (server, url):
            self.run_script('await assert.rejects(client.createBatch({}), { status: 503 });', url)
            self.assertEqual(len(server.seen), 1)
        with scenario.busy(*[(503, {"Retry-After": "0"}, {"code": "overloaded"})] * 9) as (server, url):
            self.run_script('await assert.rejects(client.service(), { status: 503, code: "overloaded" });', url)
            self.assertEqual(len(server.seen), 4)
        with scenario.busy((503, {"Retry-After": "86400"}, {"code": "overloaded"})) as (_, url):
            self.run_script('await assert.rejects(client.service(), { status: 503, code: "overloaded" });', url)
        self.run_script("await assert.rejects(client.service(), geodesicd.ConnectionFailed);", "http://127.0.0.1:1")

    def test_an_aborted_call_cancels_its_job(self):
        with scenario.busy((202, {}, {"id": "j", "state": "queued", "progress": 0})) as (server, url):
            self.run_script("""
                const control = new AbortController();
                const call = client.call("POST", "/v1/meshes/m/fields", { onProgress: () => control.abort(), signal: control.signal });
                await assert.rejects(call, { name: "AbortError" });
            """, url)
            self.assertEqual(server.paths[1:], ["/v1/jobs/j"])

    def test_pauses_leave_no_listeners(self):
        with scenario.busy(*[(503, {"Retry-After": "0"}, {})] * 3) as (_, url):
            self.run_script("""
                const { getEventListeners } = await import("node:events");
                const { signal } = new AbortController();
                await client.service({ signal });
                assert(getEventListeners(signal, "abort").length <= 4); // fetch itself may leave one for each request
            """, url)

    def test_a_job_is_followed_if_its_stream_breaks(self):
        running, done = ({"id": "j", "state": state, "progress": 0.5} for state in ("running", "done"))
        part = (200, {"Content-Length": 999, "Connection": "close"}, b'data: {"state": "running", "progress": 0.25}\n\n')
        with scenario.busy((202, {}, running), part, (200, {}, running), (200, {}, b""), (200, {}, done)) as (server, url):
            self.run_script("""
                const seen = [], job = await client.submit("POST", "/v1/meshes/m/fields", { body: {} });
                assert.equal((await job.wait((part) => seen.push(part))).state, "done");
                assert.deepEqual(seen, [0.5, 0.25, 0.5, 0.5]);
            """, url)
            self.assertEqual(server.paths[1:], ["/v1/jobs/j/events", "/v1/jobs/j?wait=1"] * 2)

    def test_odd_answers_are_errors_of_the_library(self):
        answers = [(200, {"Content-Length": 100, "Connection": "close"}, {}), (200, {}, b"<html>"), (204, {}, b"")]
        for answer, error in zip(answers, ("ConnectionFailed", "GeodesicError", "GeodesicError")):
            with self.subTest(error), scenario.busy(answer) as (_, url):
                self.run_script(f"await assert.rejects(client.service(), {{ constructor: geodesicd.{error} }});", url)


class Types(unittest.TestCase):
    PROGRAM = """
        import { Client, newest, type Mesh } from "geodesicd";
        import "geodesicd/viewer.js";
        const client = new Client();
        const mesh: Mesh = await client.upload("a", { vertices: new Float32Array(9), faces: Uint32Array.of(0, 1, 2) });
        const area: number = (await mesh.describe()).area, max: number | null = (await mesh.field(0)).max;
        const { distances } = await mesh.query("matrix", { sources: [{ vertex: 0 }], targets: [{ vertex: 1 }] });
        const first: number | null = distances[0]![0]!;
        const lengths: number[] = (await mesh.query("trace", { start: { vertex: 0 }, fan: 8, length: 1 })).paths.map((path) => path.length);
        const follow = newest((x: number, signal) => mesh.distance(0, x, { signal }), (distance) => console.log(distance, area, max, first, lengths));
        follow(3);
        // @ts-expect-error: a member that no answer has
        (await mesh.describe()).aera;
    """

    @unittest.skipUnless(NODE and (MODULES / "typescript").is_dir(), "TypeScript is not installed")
    def test_the_package_in_a_strict_program(self):
        """Tests the package as npm packs it: its files, its entries, its types. The type check
        finds a deliberate mistake."""
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            packed = subprocess.run(["npm", "pack", "--json", "--pack-destination", folder], cwd=PACKAGE, check=True, stdout=subprocess.PIPE,
                                    stderr=subprocess.DEVNULL, text=True).stdout
            [about] = json.loads(packed[packed.index("[\n"):])
            self.assertLessEqual({"LICENSE", "README.md", "index.js", "index.d.ts", "types.d.ts", "viewer.js", "viewer.d.ts"},
                                 {file["path"] for file in about["files"]})
            with tarfile.open(place / about["filename"]) as archive:
                archive.extractall(place)
            (place / "node_modules").mkdir()
            (place / "package").rename(place / "node_modules" / "geodesicd")
            options = ["--strict", "--noUncheckedIndexedAccess", "--noEmit", "--target", "es2022", "--module", "nodenext"]
            (place / "program.mts").write_text(self.PROGRAM)
            done = subprocess.run([NODE, MODULES / "typescript/bin/tsc", *options, "program.mts"], cwd=place, stdout=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0, done.stdout)
            script = 'import { Client } from "geodesicd"; import "geodesicd/viewer.js"; new Client();'
            subprocess.run([NODE, "--input-type=module", "-e", script], cwd=place, check=True)
        self.assertFalse((PACKAGE / "LICENSE").exists())

    def test_types_are_those_of_the_contract(self):
        made = subprocess.run([scenario.CLIENTS / "js" / "generate.py"], check=True, stdout=subprocess.PIPE, text=True).stdout
        self.assertEqual((scenario.CLIENTS / "js" / "types.d.ts").read_text(), made, "run clients/js/generate.py > clients/js/types.d.ts")


if __name__ == "__main__":
    unittest.main()
