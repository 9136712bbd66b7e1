// The contract as Swagger UI can show it and try it out.
import { type Contract, type Operation, resolve } from "./contract.ts";

/** Swagger UI asks for a file where a schema has a media type; what has an example is text to begin from. */
function showAsText(contract: Contract, operation: Operation): void {
  if (!operation.requestBody) return;
  for (const media of Object.values(resolve(contract, operation.requestBody).content)) {
    if (media.example !== undefined) delete media.schema?.["contentMediaType"];
  }
}

/** Changes it so that each operation stands there once, with its example, and is answered at once: every example is sent, `Prefer` too. */
export function adapt(contract: Contract): void {
  delete contract.components.parameters["Prefer"]!.example;
  for (const item of Object.values(contract.paths)) {
    for (const operation of [item.put, item.post]) {
      if (!operation) continue;
      operation.tags.splice(1);
      showAsText(contract, operation);
    }
  }
}

/** Swagger UI quotes a text whose media type ends in `json`, such as lines of JSON; no operation takes a quoted text. */
export function unquote(request: { body?: unknown }): unknown {
  if (typeof request.body === "string" && request.body.startsWith('"')) request.body = JSON.parse(request.body);
  return request;
}
