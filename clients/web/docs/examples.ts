// Makes on the daemon what the contract's examples speak of, by those examples themselves: surfaces, meshes made of the smooth ones, a field, a job, a
// batch.
import { exampleBody, examplePath, type Contract } from "./contract.ts";

const FIELDS = "/v1/meshes/{name}/fields";
const MESHES = ["/v1/nurbs/{name}/tessellate", "/v1/subdivisions/{name}/tessellate"];

type Headers = Record<string, string>;

async function send(contract: Contract, method: "put" | "post", path: string, headers: Headers): Promise<Response> {
  const operation = contract.paths[path]?.[method];
  if (!operation) throw new Error(`The contract has no ${method} ${path}.`);
  const body = exampleBody(contract, operation);
  const answer = await fetch(examplePath(contract, path), { method, headers: { "Content-Type": "application/json", ...headers }, body });
  if (!answer.ok) throw new Error(((await answer.json()) as { detail: string }).detail);
  return answer;
}

/** Makes them, and writes the ids that the daemon gave into the contract. Returns the paths of what was made. */
export async function makeExamples(contract: Contract, key?: string): Promise<string[]> {
  const access: Headers = key ? { Authorization: `Bearer ${key}` } : {};
  const surfaces = Object.keys(contract.paths).filter((path) => /^\/v1\/[a-z]+\/\{name\}$/.test(path) && contract.paths[path]?.put);
  for (const path of surfaces) await send(contract, "put", path, access);
  for (const path of MESHES) await send(contract, "post", path, access);
  const field = await send(contract, "post", FIELDS, access);
  const job = await send(contract, "post", FIELDS, { ...access, Prefer: "respond-async" });
  const batch = await send(contract, "post", "/v1/batches", access);
  const place = (answer: Response) => answer.headers.get("Location")!;
  const made = { FieldId: place(field), JobId: place(job), BatchId: place(batch) };
  for (const [name, where] of Object.entries(made)) contract.components.parameters[name]!.example = where.split("/").pop();
  return [...surfaces.map((path) => examplePath(contract, path)), ...Object.values(made)];
}
