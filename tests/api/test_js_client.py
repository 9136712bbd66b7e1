"""The JavaScript client under Node.js: the scenario, and what it adds to the contract. Skipped without node of version 18 or later."""
import shutil
import subprocess
import unittest

import scenario
from harness import SQUARE, TestCase, sample

NODE = shutil.which("node")


def is_new_enough():
    return NODE and int(subprocess.run([NODE, "--version"], stdout=subprocess.PIPE, text=True).stdout[1:].split(".")[0]) >= 18


@unittest.skipUnless(is_new_enough(), "there is no node of version 18 or later")
class JavaScriptClient(TestCase):
    def run_script(self, script, url=None):
        """Its last lines would tell what was not as expected."""
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
              if (step.upload) return (await client.upload(step.upload, step.file)).describe();
              if (step.delete) return client.mesh(step.delete).delete();
              return client.mesh("scenario").query(step.query, step.body);
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
            assert.deepEqual([start(await (await square.field(0)).file()), start(await square.pathFile(0, 2, "svg"))], ["ply\\n", "<svg"]);
        """)

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
        """)

    def test_a_refused_origin_is_told_from_a_dead_daemon(self):
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

    def test_patience(self):
        with scenario.busy((503, {"Retry-After": "0"}, {}), (429, {}, {}), (0, {}, {})) as (server, url):
            self.run_script('assert.deepEqual(await client.service(), { version: "1" });', url)
            self.assertEqual(len(server.seen), 4)
        with scenario.busy((429, {"Retry-After": "0"}, {}), (0, {}, {})) as (server, url):
            self.run_script('await assert.rejects(client.createBatch({}), geodesicd.ConnectionFailed);', url)
            self.assertEqual(len(server.seen), 2)
        with scenario.busy(*[(503, {"Retry-After": "0"}, {"code": "overloaded"})] * 9) as (server, url):
            self.run_script('await assert.rejects(client.service(), { status: 503, code: "overloaded" });', url)
            self.assertEqual(len(server.seen), 4)
        self.run_script("await assert.rejects(client.service(), geodesicd.ConnectionFailed);", "http://127.0.0.1:1")


class Types(unittest.TestCase):
    def test_they_are_those_of_the_contract(self):
        made = subprocess.run([scenario.CLIENTS / "js" / "generate.py"], check=True, stdout=subprocess.PIPE, text=True).stdout
        self.assertEqual((scenario.CLIENTS / "js" / "types.d.ts").read_text(), made, "run clients/js/generate.py > clients/js/types.d.ts")


if __name__ == "__main__":
    unittest.main()
