// Makes on the daemon what the contract's examples speak of, by those examples themselves: surfaces, a field of one of them, a job.
import { exampleBody, examplePath, type Contract } from "./contract.ts";

const FIELDS = "/v1/meshes/{name}/fields";

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
  const field = await send(contract, "post", FIELDS, access);
  const job = await send(contract, "post", FIELDS, { ...access, Prefer: "respond-async" });
  const made = { FieldId: field.headers.get("Location")!, JobId: job.headers.get("Location")! };
  for (const [name, place] of Object.entries(made)) contract.components.parameters[name]!.example = place.split("/").pop();
  return [...surfaces.map((path) => examplePath(contract, path)), ...Object.values(made)];
}
