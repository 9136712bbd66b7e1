// Formats a request as a curl command line.

import { pathOf, type Request } from "./api.ts";

const quote = (text: string): string =>
  /^[\w./:=@%+,-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;

function payload(request: Request): string[] {
  if (request.json !== undefined) return ["--json", quote(JSON.stringify(request.json))];
  return request.file ? ["-T", quote(request.file.name)] : [];
}

function method(request: Request): string[] {
  const usual = request.json !== undefined ? "POST" : request.file ? "PUT" : "GET";
  return request.method === usual ? [] : ["-X", request.method];
}

/** Writes a shell variable instead of the key, because people share such commands. */
export function curlOf(request: Request, origin: string, hasKey: boolean): string {
  const sent = { ...(request.accept && { Accept: request.accept }), ...request.headers };
  const headers = Object.entries(sent).flatMap(([name, value]) => [
    "-H",
    quote(`${name}: ${value}`),
  ]);
  const output = request.accept === "application/octet-stream" ? ["-o", "answer.bin"] : [];
  const key = hasKey ? ["-H", '"Authorization: Bearer $KEY"'] : [];
  const words = ["curl", ...method(request), ...headers, ...output, ...key, ...payload(request)];
  return [...words, quote(origin + pathOf(request))].join(" ");
}
