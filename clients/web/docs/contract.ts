// Types of the parts of the contract that this page reads, and functions on them.

export interface Parameter {
  name: string;
  in: string;
  required?: boolean;
  example?: unknown;
}

export interface Body {
  content: Record<string, { schema?: Record<string, unknown>; example?: unknown; examples?: Record<string, { value: unknown }> }>;
}

export interface Operation {
  tags: string[];
  requestBody?: Body | Reference;
}

export interface PathItem {
  parameters?: (Parameter | Reference)[];
  get?: Operation;
  put?: Operation;
  post?: Operation;
}

export interface Contract {
  info: { version: string };
  paths: Record<string, PathItem>;
  components: { parameters: Record<string, Parameter>; requestBodies: Record<string, Body> };
}

interface Reference {
  $ref: string;
}

/** Returns the component that a reference names, or the value itself. */
export function resolve<Value extends object>(contract: Contract, value: Value | Reference): Value {
  if (!("$ref" in value)) return value;
  const parts = value.$ref.split("/").slice(1);
  return parts.reduce((node, part) => (node as Record<string, unknown>)[part], contract as unknown) as Value;
}

/** Returns the path with its parameters replaced by their examples. */
export function examplePath(contract: Contract, path: string): string {
  return (contract.paths[path]?.parameters ?? [])
    .map((parameter) => resolve(contract, parameter))
    .filter((parameter) => parameter.in === "path")
    .reduce((text, parameter) => text.replace(`{${parameter.name}}`, encodeURIComponent(String(parameter.example))), path);
}

/** Returns the first JSON example of the operation's body. */
export function exampleBody(contract: Contract, operation: Operation): string {
  const media = operation.requestBody && resolve(contract, operation.requestBody).content["application/json"];
  return JSON.stringify(media?.example ?? Object.values(media?.examples ?? {})[0]?.value);
}
