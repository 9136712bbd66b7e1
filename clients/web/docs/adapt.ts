// Adapts the contract to Swagger UI.
import { type Contract, type Operation, resolve } from "./contract.ts";

/**
 * Removes the media type from the schema of a body that has an example. Such a body is text, but
 * Swagger UI would show a file input.
 */
function showAsText(contract: Contract, operation: Operation): void {
  if (!operation.requestBody) return;
  for (const media of Object.values(resolve(contract, operation.requestBody).content)) {
    if (media.example !== undefined) delete media.schema?.["contentMediaType"];
  }
}

/**
 * Adapts the contract. Keeps only the first tag of each operation, so that the page lists it once.
 * Removes the example of the `Prefer` header, because Swagger UI sends every example and this one
 * would turn each request into a job.
 */
export function adapt(contract: Contract): void {
  delete contract.components.parameters["Prefer"]!.example;
  for (const item of Object.values(contract.paths)) {
    for (const operation of [item.get, item.put, item.post]) {
      if (!operation) continue;
      operation.tags.splice(1);
      showAsText(contract, operation);
    }
  }
}

/**
 * Removes the quotes that Swagger UI adds to text whose media type ends in `json`. No operation
 * accepts a quoted text.
 */
export function unquote(request: { body?: unknown }): unknown {
  if (typeof request.body === "string" && request.body.startsWith('"')) request.body = JSON.parse(request.body);
  return request;
}
