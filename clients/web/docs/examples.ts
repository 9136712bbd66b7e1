// Creates the data that the contract's examples refer to: surfaces, meshes that are made from
// smooth surfaces, a field, a job and a batch. The example requests of the contract create these
// data.
import { exampleBody, examplePath, type Contract } from "./contract.ts";

const FIELDS = "/v1/meshes/{name}/fields";
const MESHES = ["/v1/nurbs/{name}/tessellate", "/v1/subdivisions/{name}/tessellate"];
const THERE_ALREADY = 412;

type Headers = Record<string, string>;

async function send(contract: Contract, method: "put" | "post", path: string, headers: Headers): Promise<Response> {
  const operation = contract.paths[path]?.[method];
  if (!operation) throw new Error(`The contract has no ${method} ${path}.`);
  const body = exampleBody(contract, operation);
  const answer = await fetch(examplePath(contract, path), { method, headers: { "Content-Type": "application/json", ...headers }, body });
  if (!answer.ok && answer.status !== THERE_ALREADY) throw new Error(((await answer.json()) as { detail: string }).detail);
  return answer;
}

const surfacesOf = (contract: Contract): string[] =>
  Object.keys(contract.paths).filter((path) => /^\/v1\/[a-z]+\/\{name\}$/.test(path) && contract.paths[path]?.put);

export class Examples {
  /** Maps an id of the contract's examples to the id that the daemon has assigned. */
  private readonly ids = new Map<string, string>();
  private making: Promise<string[]> | undefined;

  constructor(private readonly contract: Contract) {}

  /** Returns whether an address refers to example data. */
  private names(url: string): boolean {
    const path = new URL(url, location.href).pathname;
    const parameters = ["FieldId", "JobId", "BatchId"].map((name) => this.contract.components.parameters[name]!);
    const places = [...this.ids.keys(), ...parameters.map((parameter) => String(parameter.example))];
    const surfaces = surfacesOf(this.contract).map((surface) => examplePath(this.contract, surface));
    return surfaces.some((surface) => path.startsWith(`${surface}/`) || path === surface) || places.some((id) => path.includes(id));
  }

  /**
   * Creates the data on first use and returns the paths. Does not replace a surface that exists.
   * Writes the daemon's ids into the examples of the contract.
   */
  create(key?: string): Promise<string[]> {
    this.making ??= this.make(key).catch((error: Error) => {
      this.making = undefined;
      throw error;
    });
    return this.making;
  }

  /**
   * Creates the data before the first request that needs it, and replaces example ids in the
   * request's address by the daemon's ids.
   */
  async prepare(request: { url: string; method?: string }, key?: string): Promise<void> {
    if (request.method === "PUT" || !this.names(request.url)) return;
    await this.create(key);
    for (const [example, id] of this.ids) request.url = request.url.replace(example, id);
  }

  private async make(key?: string): Promise<string[]> {
    const { contract } = this;
    const access: Headers = key ? { Authorization: `Bearer ${key}` } : {};
    const surfaces = surfacesOf(contract);
    for (const path of surfaces) await send(contract, "put", path, { ...access, "If-None-Match": "*" });
    for (const path of MESHES) await send(contract, "post", path, access);
    const field = await send(contract, "post", FIELDS, access);
    const job = await send(contract, "post", FIELDS, { ...access, Prefer: "respond-async" });
    const batch = await send(contract, "post", "/v1/batches", access);
    const place = (answer: Response): string => answer.headers.get("Location")!;
    const made = { FieldId: place(field), JobId: place(job), BatchId: place(batch) };
    for (const [name, where] of Object.entries(made)) {
      const parameter = contract.components.parameters[name]!;
      const id = where.split("/").pop()!;
      this.ids.set(String(parameter.example), id);
      parameter.example = id;
    }
    return [...surfaces.map((path) => examplePath(contract, path)), ...Object.values(made)];
  }
}
